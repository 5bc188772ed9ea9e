//! What a program asks of the lathe: one [`Item`] an action, in execution order.

use interp_core::drive::gearing::Lead;
use interp_core::units::{Feedrate, Length, Point, Sense};

use super::decimal::Distance;

/// Speed of a motion along its path, in radius coordinates.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Feed {
    /// As fast as the axes allow: the limiting axis at its maximum, still along the path.
    Rapid,
    /// F word under G94.
    PerMinute(Feedrate),
    /// F word under G95: path a turn of the spindle.
    PerTurn(Lead),
    /// G32, G33: bound to the spindle's angle. Lines only.
    Thread {
        /// A turn of the spindle moves the axis that goes farther (X as a radius) by this.
        lead: Lead,
        /// Behind the index, in 2^-16 of a turn.
        start: u16,
    },
}

/// Centre of an arc; it may lie further out than a [`Point`]: within ±6.3 m.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Centre {
    /// Cross slide, radius.
    pub x: Distance,
    /// Carriage.
    pub z: Distance,
}

/// What the spindle shall do.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum SpindleCommand {
    /// M3.
    Forward,
    /// M4.
    Reverse,
    /// M5.
    Stop,
}

/// Spindle speed, in thousandths of a turn a minute, up to 100 000 turns a minute; zero is a speed.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SpindleSpeed(u32);

impl SpindleSpeed {
    /// Largest speed: 100 000 turns a minute.
    pub const LIMIT_MILLI_RPM: u32 = 100_000_000;

    /// `None` above 100 000 turns a minute.
    pub const fn from_milli_rpm(milli_rpm: u32) -> Option<Self> {
        if milli_rpm > Self::LIMIT_MILLI_RPM { None } else { Some(Self(milli_rpm)) }
    }

    /// Thousandths of a turn a minute.
    pub const fn milli_rpm(self) -> u32 {
        self.0
    }
}

/// How corners are taken (G61, G61.1, G64).
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub enum PathControl {
    /// G61: along the programmed path, as fast as each corner allows.
    #[default]
    Exact,
    /// G61.1: the tool comes to a stand at the end of every motion.
    Stop,
    /// G64: an arc in place of each corner between two feeds.
    Blend {
        /// How far it may leave the corner, above zero; `None` (G64 without P) as far as the feed needs.
        tolerance: Option<Length>,
    },
}

impl PathControl {
    /// Largest tolerance of a blend: 1 mm.
    pub const LIMIT_NM: i32 = 1_000_000;

    /// Blends within a tolerance; without one, zero, the exact path.
    pub const fn within(tolerance: Length) -> Self {
        if tolerance.nm() > 0 { Self::Blend { tolerance: Some(tolerance) } } else { Self::Exact }
    }
}

/// One action.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Action {
    /// Straight line from where the tool is. It may have no length.
    Line {
        /// Where it ends.
        end: Point,
        /// How fast.
        feed: Feed,
    },
    /// Arc from where the tool is. `end` equal to the start means a full circle.
    Arc {
        /// Where it ends; as far from the centre as the start, within the tolerance of the settings.
        end: Point,
        /// Rounded to the nanometre; at least 1 nm and at most 4.2 m from the start.
        centre: Centre,
        /// Seen with Z to the right and X upward, whichever side the tool post is on.
        sense: Sense,
        /// How fast. [`Feed::Rapid`] only from F0 of the 1973 format.
        feed: Feed,
    },
    /// Wait with the axes at rest.
    Dwell {
        /// Milliseconds.
        ms: u32,
    },
    /// Start or stop the spindle.
    Spindle(SpindleCommand),
    /// Set the spindle speed.
    SpindleSpeed(SpindleSpeed),
    /// Call a tool with its offset.
    Tool {
        /// 0 to 99.
        number: u16,
        /// 0 to 99; 0 is none.
        offset: u16,
    },
    /// M0: wait for cycle start.
    Stop,
    /// M1: wait for cycle start if the operator asks for it.
    OptionalStop,
    /// M2, M30: the program is over.
    End,
}

/// Action with the line that asks for it.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Item {
    /// From 1.
    pub line: u32,
    /// What to do.
    pub action: Action,
    /// How the corners at its ends are taken.
    pub control: PathControl,
}
