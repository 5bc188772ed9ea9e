#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod bounce;
mod contact;
mod drive;
mod driver;
mod encoder;
mod handwheel;
mod lathe;
mod motor;
mod rate;
mod read;
mod scale;
mod screw;
mod slide;
mod spindle;
pub mod table;

pub use contact::{Edge, Switch};
pub use drive::{Drive, Load, Loss};
pub use encoder::{Channels, Encoder};
pub use handwheel::{Handwheel, WheelEdge};
pub use lathe::{Axes, Control, Machine, Place};
pub use motor::Motor;
pub use scale::Scale;
pub use screw::Screw;
pub use slide::Slide;
pub use spindle::{Angle, Spindle};

/// The figures of the machine.
pub const TABLES: &[&[figures::Definition]] = &[&table::CROSS_SLIDE, &table::CARRIAGE, &table::OTHERS];

/// A number that is whole already, as an integer; saturates.
#[expect(clippy::cast_possible_truncation, reason = "whole by its callers; a cast saturates, and NaN becomes 0")]
pub(crate) const fn whole(number: f64) -> i64 {
    number as i64
}
