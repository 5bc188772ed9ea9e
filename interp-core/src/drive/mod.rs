//! Drives: what turns the crank. Time is the channel's own; spindle and contour wheel are here.
//!
//! A drive gives the advance along the path for a tick, and knows nothing of curves: any drive runs any curve. Inputs
//! come as values ([`Inputs`]), one set a tick, so a tick stays a function of state, commands and readings.

pub mod follower;
pub mod gearing;
pub mod spindle;
pub mod wheel;

use crate::block::Speed;
use gearing::Lead;
use wheel::Click;

/// What turns the crank.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub enum Drive {
    /// The feed governor.
    #[default]
    Time,
    /// The spindle: so much path a turn, forward and back, on every motion. Without phase; threads have their own lead.
    Spindle(Lead),
    /// The contour wheel.
    Wheel(Click),
}

/// What was read at the start of a tick.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Inputs {
    /// The spindle's encoder, where there is one.
    pub spindle: Option<spindle::Reading>,
    /// Counts of the contour wheel since the last tick, 4 a detent.
    pub wheel: i16,
}

/// What a drive could not do in a tick. It is told in every tick that it lasts.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Trouble {
    /// Lead times spindle speed is more than the motion allows. The phase is lost until it is less.
    TooFast {
        /// Speed along the path that the spindle asks for.
        needed: Speed,
        /// What the motion allows.
        limit: Speed,
    },
    /// The spindle's speed changes faster than the axes can follow. The phase is lost until they have caught up.
    TooHard {
        /// Acceleration along the path that the spindle asks for, nm a tick squared with 12 fraction bits.
        needed: u32,
        /// What the motion allows.
        limit: u32,
    },
    /// The index came so many counts from where it should: counts or an index pulse got lost, or there is noise.
    Index {
        /// Counts, positive for too many.
        off: i32,
    },
    /// The spindle turned by one and a half turns without an index pulse.
    IndexLost,
    /// The spindle stopped in a thread.
    Stopped,
    /// The spindle turned round in a thread.
    Reversed,
    /// A thread or a feed a turn waits for a spindle that does not turn, or has no encoder.
    NoSpindle,
    /// The pass can't be repeated: it is longer than the way back that is known.
    NoWayBack,
}

/// Where a thread is.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub enum ThreadStage {
    /// Nowhere: no thread is being cut.
    #[default]
    None,
    /// The tool stands at its start: the spindle does not turn, its index was not seen, or the groove is still to come.
    Waiting,
    /// The path follows the spindle.
    Cutting,
    /// Held, or the spindle failed: X is pulled out while the path goes on in step, then the path brakes.
    Leaving,
    /// X is out and the path stands.
    Left,
    /// Back to the start, with X out.
    Returning,
    /// X goes in at the start.
    Entering,
}

/// Why the way back along the path ends.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum BackEnd {
    /// The cycle began here.
    Start,
    /// An output was set here: spindle and tool do not run backward.
    Output,
    /// A thread begins or ends here: it is run from its start only.
    Thread,
    /// A dwell is under way.
    Dwell,
    /// A curve was run before that is not kept: it was made part by part.
    Curve,
    /// What was run before is no longer kept: there were too many blocks since.
    Full,
}

impl core::fmt::Display for BackEnd {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Start => "the way back ends here: the cycle began at this place",
            Self::Output => "the way back ends here: spindle and tool do not run backward",
            Self::Thread => "the way back ends here: a thread is run from its start only",
            Self::Dwell => "there is no way back during a dwell: let it end",
            Self::Curve => "the way back ends here: the curve before was made part by part and is not kept",
            Self::Full => "the way back ends here: the blocks before are no longer kept",
        })
    }
}

/// What the drive did in a tick.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Driven {
    /// Counts of the wheel that were dropped.
    pub dropped: i32,
    /// The path keeps the spindle's phase.
    pub locked: bool,
    /// What could not be done.
    pub trouble: Option<Trouble>,
    /// Where a thread is.
    pub stage: ThreadStage,
    /// The wheel asked to go farther back, and why that can't be.
    pub back_end: Option<BackEnd>,
}

impl Driven {
    /// Nothing.
    pub const NONE: Self = Self { dropped: 0, locked: false, trouble: None, stage: ThreadStage::None, back_end: None };
}

/// Why the drive was not switched.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum DriveRefusal {
    /// The path is not at a standstill.
    Moving,
    /// A thread is being cut: its drive is the spindle until its end.
    InThread,
    /// There is no spindle encoder.
    NoEncoder,
}

impl core::fmt::Display for DriveRefusal {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Moving => "the drive is switched at standstill only: hold first",
            Self::InThread => "a thread keeps the spindle as its drive: let it end, or reset",
            Self::NoEncoder => "there is no spindle encoder: set its counts a turn",
        })
    }
}
