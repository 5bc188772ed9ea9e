//! What the tool touched that it should not have.

use std::fmt;

use crate::geometry::Point;
use crate::tool::Part;

/// What the tool touched that it should not have.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Touched {
    /// A rapid went through material.
    Rapid,
    /// What lies behind the cutting edges was in the work.
    Holder,
    /// The tool was in the chuck.
    Chuck,
    /// The nose cut below the contour.
    Deep,
    /// The front or the back edge cut below the contour.
    Edge(Part),
}

impl Touched {
    /// A word for reports.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Rapid => "rapid",
            Self::Holder => "holder",
            Self::Chuck => "chuck",
            Self::Deep | Self::Edge(Part::Nose) => "over-deep",
            Self::Edge(Part::Front) => "front edge",
            Self::Edge(Part::Back) => "back edge",
        }
    }
}

impl fmt::Display for Touched {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Rapid => "rapid through the stock",
            Self::Holder => "the holder is in the work",
            Self::Chuck => "the tool is in the chuck",
            Self::Deep | Self::Edge(Part::Nose) => "cut below the contour",
            Self::Edge(Part::Front) => "the front edge cuts below the contour",
            Self::Edge(Part::Back) => "the back edge cuts below the contour",
        })
    }
}

/// One collision: a stretch of one line's motion.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Collision {
    /// What was touched.
    pub touched: Touched,
    /// When it began, ns since the start of the cycle.
    pub time_ns: u64,
    /// Line of the program.
    pub line: u32,
    /// Where it began: a place of the work, mm.
    pub place: Point,
    /// How deep, mm.
    pub depth: f64,
}
