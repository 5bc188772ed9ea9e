//! Blocks: one motion with its limits, ready to execute. A block is all that the foreground gets; the [`Builder`] makes
//! them of programmed curves, in the background.

pub(crate) mod again;
mod builder;
#[cfg(feature = "methods")]
mod chain;
#[cfg(feature = "methods")]
mod pieces;
#[cfg(feature = "methods")]
pub use chain::Chain;
#[cfg(feature = "methods")]
pub use pieces::Pieces;
pub mod shoulder;
mod split;

pub use builder::Builder;
pub use split::{Split, split};

use crate::curve::arc::{Arc, NO_EXTREMES};
#[cfg(feature = "methods")]
use crate::curve::conic_piece::ConicPiece;
use crate::curve::line::Line;
#[cfg(feature = "methods")]
use crate::curve::method::Method;
use crate::curve::proportion::Proportion;
use crate::drive::gearing::Lead;
use crate::math::to_u32;
use crate::units::{Axis, Feedrate, Sense};
use again::Source;
use heapless::Vec;

/// Speed in nanometres a tick, 12 fraction bits.
pub type Speed = u32;

/// How fast a block is to be run.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Pace {
    /// As fast as the limits allow.
    Rapid,
    /// Along the path, times the feed override.
    Feed(Feedrate),
    /// Along the path for each turn of the spindle, times the feed override; without phase.
    PerTurn(Lead),
    /// A thread: the axis that goes farther by the lead a turn, from the index on.
    Thread {
        /// Pitch times starts.
        lead: Lead,
        /// Behind the index, in 2^-16 of a turn: the start of a multiple thread.
        start: u16,
    },
}

/// What sets the speed of a motion.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Feed {
    /// The limits.
    Rapid,
    /// Time: path a tick.
    PerTick(Speed),
    /// The spindle's speed: path a turn.
    PerTurn(Lead),
    /// The spindle's angle: path a turn, and the start of the thread behind the index.
    Thread(Lead, u16),
}

impl Feed {
    /// Whether the path is bound to the spindle's angle.
    pub const fn is_thread(self) -> bool {
        matches!(self, Self::Thread(..))
    }
}

/// A programmed curve, from where the last one ended.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Path {
    /// Straight to the end.
    Line,
    /// About `centre` (X, Z, nm); a full circle where the end is the start.
    Arc {
        /// Centre, X and Z in nm.
        centre: (i64, i64),
        /// Sense of travel.
        sense: Sense,
    },
}

/// Where a block goes.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Curve {
    /// Straight; from length to steps of the major axis, 16 fraction bits.
    Line(Line, Proportion),
    /// Round, by the method that the arc names.
    Arc(Arc),
    /// Straight by a classic method; from length to pulses of the major axis, 16 fraction bits.
    #[cfg(feature = "methods")]
    ClassicLine(Line, Proportion, Method),
    /// A part of an ellipse or a parabola.
    #[cfg(feature = "methods")]
    Conic(ConicPiece),
}

impl Curve {
    /// The end, X then Z, pulses from the start.
    pub const fn end(&self) -> (i32, i32) {
        match self {
            Self::Line(line, _) => line.end(),
            Self::Arc(arc) => arc.end(),
            #[cfg(feature = "methods")]
            Self::ClassicLine(line, ..) => line.end(),
            #[cfg(feature = "methods")]
            Self::Conic(piece) => piece.end(),
        }
    }

    /// The least and the greatest coordinates, X then Z, pulses from the start; a pulse more where an arc passes an extreme.
    pub fn extent(&self) -> ((i32, i32), (i32, i32)) {
        let ((x, z), (least, most)) = (self.end(), self.extremes(0, u64::MAX));
        ((least.0.min(x).min(0), least.1.min(z).min(0)), (most.0.max(x).max(0), most.1.max(z).max(0)))
    }

    /// The extremes that it passes between two lengths: the least and the greatest coordinates, X then Z, pulses from the start,
    /// and a pulse more. Where there is none the least is the largest number, and the greatest the smallest.
    pub(crate) fn extremes(&self, from: u64, until: u64) -> ((i32, i32), (i32, i32)) {
        match self {
            Self::Arc(arc) => arc.extremes(from, until),
            Self::Line(..) => NO_EXTREMES,
            #[cfg(feature = "methods")]
            Self::ClassicLine(..) | Self::Conic(_) => NO_EXTREMES,
        }
    }
}

/// One motion with its limits.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Motion {
    /// Where to.
    pub curve: Curve,
    /// Length of the walked curve, nm with 12 fraction bits, never 0.
    pub length: u64,
    /// What sets its speed.
    pub feed: Feed,
    /// Largest speed on this block, whatever the override.
    pub limit: Speed,
    /// Largest acceleration along the path, nm a tick squared with 12 fraction bits.
    pub accel: u32,
    /// Largest speed over the joint with the block before, where that one is a motion.
    pub joint: Speed,
    /// Speed at which it may begin from standstill.
    pub start: Speed,
    /// Speed at which it may end in standstill.
    pub stop: Speed,
    /// The programmed curve goes on in the next block (an arc of more than half a turn).
    pub continues: bool,
    /// What it can be made of again.
    pub(crate) source: Source,
}

impl Motion {
    /// The largest speed that is ever asked for: the limit, and so that it takes a tick at least. To begin a block costs
    /// thousands of instructions, which must not come by the dozen in a tick. A thread goes as the spindle turns.
    pub(crate) const fn top(&self) -> Speed {
        if self.length >= self.limit as u64 || matches!(self.feed, Feed::Thread(..)) {
            self.limit
        } else {
            to_u32(self.length)
        }
    }

    /// Sets the feed, but of a thread.
    pub const fn set_feed(&mut self, feed: Feed) {
        if !matches!(self.feed, Feed::Thread(..)) {
            self.feed = feed;
        }
    }
}

/// What the channel executes.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Block {
    /// Line of the program, from 1.
    pub line: u32,
    /// What to do.
    pub work: Work,
}

/// What a block does.
#[expect(clippy::large_enum_variant, reason = "nearly all are motions, and there is no allocation")]
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Work {
    /// Moves.
    Motion(Motion),
    /// Stands still for this many ticks.
    Dwell(u32),
    /// An output changes while all stands still.
    Output(Output),
    /// The program waits for cycle start.
    Stop,
    /// Like `Stop`, where the operator has switched optional stops on.
    OptionalStop,
    /// The program is over.
    End,
}

/// Outputs that a program sets.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Output {
    /// Spindle forward.
    SpindleForward,
    /// Spindle backward.
    SpindleReverse,
    /// Spindle off.
    SpindleStop,
    /// Spindle speed, thousandths of a turn a minute.
    SpindleSpeed(u32),
    /// Tool and offset number.
    Tool(u16, u16),
}

/// A feed that an axis's maximum cut down on a block.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Limited {
    /// The axis whose maximum it was.
    pub axis: Axis,
    /// The speed that is left.
    pub speed: Speed,
}

/// Why an arc can't be walked.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum ArcRefusal {
    /// It leaves the range of [`Length`](crate::units::Length) between its ends.
    OutOfRange,
    /// Its radius is below three pulses of the coarser axis, and the pulse sizes differ more than fourfold: there is
    /// no lattice point near most of it.
    TooSmall,
    /// It turns by more than half a turn about less than a pulse: nothing would move.
    NoPulse,
}

/// What became of a programmed curve.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Built {
    /// The blocks: none where the ends round to one lattice point.
    pub motions: Vec<Motion, 2>,
    /// Where an axis can't reach the programmed feed.
    pub limited: Option<Limited>,
    /// Why nothing was built; the position is as before then.
    pub refused: Option<ArcRefusal>,
}
