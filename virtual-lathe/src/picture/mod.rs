#![doc = include_str!("README.md")]
//!
//! Inside, lengths in mm are `[z, x]`, and lengths on the sheet are `[right, down]` in *units* (see [`Drawing::svg`]).
//!
//! Left out: nothing here knows programs, machines or time. Colours and line weights are fixed.

mod arrows;
mod axes;
mod balloon;
mod block;
mod chart;
mod curve;
mod film;
mod inset;
mod laws;
mod layout;
mod main_view;
mod methods;
mod number;
pub mod operation;
mod page;
mod pen;
mod raster;
mod requests;
mod room;
mod section;
mod text;
mod thin;
mod view;

pub use chart::{Chart, Look, Series, Strip};
pub use film::{Film, Form};
pub use laws::{LawPanel, laws};
pub use methods::{Panel, methods, polyline};
pub use raster::{PictureError, png};
pub use thin::Thinner;

/// What a track was cut with.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Fast traverse; drawn thin and dashed.
    Rapid,
    /// Straight feed; drawn dark.
    Feed,
    /// Circular feed; drawn heavy in a second colour.
    Arc,
    /// Feed bound to the spindle; drawn in dots and dashes.
    Thread,
}

/// A stretch of the path travelled in one way.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// How it was travelled.
    pub kind: Kind,
    /// Positions played, in order, as `[z, x]` in mm. What is not finite, or
    /// beyond a kilometre, is left out of the drawing.
    pub points: Vec<[f64; 2]>,
}

/// A place of the path under magnification.
#[derive(Clone, Debug, PartialEq)]
pub struct Inset {
    /// Heading of the panel; shortened if it is too long.
    pub title: String,
    /// Middle of the panel, `[z, x]` in mm. Without a finite one there is no panel.
    pub centre: [f64; 2],
    /// Half the width of the panel along Z, in mm. Its height follows, since both axes have one scale. Ten pulses
    /// if it is not between 1e-7 and 1e5.
    pub half_width: f64,
    /// Size of one pulse, `[z, x]` in mm. Without sizes between 1e-6 and 1000 there is no lattice.
    pub pulse: [f64; 2],
    /// Lattice points visited, `[z, x]` in pulses, in order; those outside the panel do no harm. Successive points
    /// more than one pulse apart are taken as a gap and not joined.
    pub visited: Vec<[i32; 2]>,
    /// What the points follow.
    pub curves: Vec<TrueCurve>,
}

/// A curve as the block asked for it, `[z, x]` in mm.
#[derive(Copy, Clone, Debug, PartialEq)]
pub enum TrueCurve {
    /// A straight line.
    Line {
        /// Where it begins.
        from: [f64; 2],
        /// Where it ends.
        to: [f64; 2],
    },
    /// Part of a circle whose radius is the distance of `from` to `centre`; a full turn if `from` is `to`.
    Arc {
        /// Middle of the circle.
        centre: [f64; 2],
        /// Where it begins.
        from: [f64; 2],
        /// Where it ends; only its direction from the centre counts.
        to: [f64; 2],
        /// As seen in the drawing, Z to the right and X upward.
        clockwise: bool,
    },
}

/// All that the drawing shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Name in the title block.
    pub title: String,
    /// Facts in the title block: time, pulses, deviation. Wrapped to fit; line breaks are kept.
    pub subtitle: String,
    /// The path, in order.
    pub tracks: Vec<Track>,
    /// Where the path starts, `[z, x]` in mm.
    pub start: [f64; 2],
    /// Where it ends.
    pub end: [f64; 2],
    /// Places to magnify. The sheet is made for none to three.
    pub insets: Vec<Inset>,
    /// The work, drawn in half section under the path.
    pub section: Option<Section>,
}

/// The work as cut, the bar it was cut from, and the tool. All in mm, `[z, x]`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Section {
    /// Back and front end of the bar, along Z.
    pub bar_z: [f64; 2],
    /// Bore and outside of the bar, as radii.
    pub bar_x: [f64; 2],
    /// The outside of what is left, from the back to the front.
    pub outside: Vec<[f64; 2]>,
    /// Its bore, likewise.
    pub inside: Vec<[f64; 2]>,
    /// The tool's outline.
    pub tool: Vec<[f64; 2]>,
    /// What is written under the work, each with the place of the surface that it belongs to.
    pub dimensions: Vec<Dimension>,
}

/// A size of the work.
#[derive(Clone, Debug, PartialEq)]
pub struct Dimension {
    /// As written: a diameter, a radius, an angle, a position.
    pub text: String,
    /// Place of the surface.
    pub place: [f64; 2],
}
