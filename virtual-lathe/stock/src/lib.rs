#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod bar;
mod collision;
mod contour;
mod cut;
mod geometry;
mod reach;
mod setup;
mod sweep;
mod tool;

pub use bar::{Bar, BarData, Taken};
pub use collision::{Collision, Touched};
pub use contour::{Contour, Curve, Sample};
pub use cut::{Cutting, Jaws, Kind, Motion, Outcome, Setup, SurfaceError};
pub use geometry::Point;
pub use reach::ContourError;
pub use setup::{Clamped, FIGURES, SetupError};
pub use sweep::Sweep;
pub use tool::{Part, Tool, ToolData, ToolError};
