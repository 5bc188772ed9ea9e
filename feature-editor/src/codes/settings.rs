//! Settings of the interpreter, and the two formats.

use interp_core::units::{Feedrate, Length, Point};

/// How program text is read. See the module for both.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Format {
    /// Word address, the lathe's G-code.
    Gcode,
    /// The sample of 1973: pulses of 0.01 mm, arcs by quadrants.
    Nc1973,
}

/// What the machine and its operator fix before a program is read.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Settings {
    /// The tool post is on the operator's side: G2 and G3 change places. The 1973 format does not heed it.
    pub front_post: bool,
    /// Lines that begin with `/` are skipped.
    pub block_delete: bool,
    /// How far the two radii of an arc may differ; negative counts as zero.
    pub arc_tolerance: Length,
    /// Feeds of the codes F1 to F9 of the 1973 format, in this order.
    pub tape_feeds: [Option<Feedrate>; 9],
    /// How far a blend may leave a corner until the program says otherwise; zero or less for the exact path.
    pub corner: Length,
    /// Where the tool is when the program starts.
    pub start: Point,
    /// Fastest feed of the cross slide.
    pub max_feed_x: Feedrate,
    /// Fastest feed of the carriage.
    pub max_feed_z: Feedrate,
}

impl Settings {
    /// Rear tool post, no block delete, 0.01 mm for arcs, no tape feeds, no blends, start at the zero point.
    pub const fn new(max_feed_x: Feedrate, max_feed_z: Feedrate) -> Self {
        Self {
            front_post: false,
            block_delete: false,
            arc_tolerance: match Length::from_um(10) {
                Some(tolerance) => tolerance,
                None => Length::ZERO,
            },
            tape_feeds: [None; 9],
            corner: Length::ZERO,
            start: Point { x: Length::ZERO, z: Length::ZERO },
            max_feed_x,
            max_feed_z,
        }
    }

    /// Tolerance of arcs in nanometres, at least zero.
    pub(crate) fn tolerance_nm(&self) -> i64 {
        i64::from(self.arc_tolerance.nm()).max(0)
    }
}
