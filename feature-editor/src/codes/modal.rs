//! What stays in force from line to line.

use interp_core::drive::gearing::Lead;
use interp_core::units::{Feedrate, Point, Sense};

use super::item::{Feed, PathControl};
use super::settings::Settings;

/// Motion mode, as programmed (not yet mirrored).
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) enum Motion {
    /// G0.
    Rapid,
    /// G1.
    Line,
    /// G2, G3.
    Arc(Sense),
    /// G32, G33.
    Thread(ThreadCode),
}

/// How a thread's lead is written.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) enum ThreadCode {
    /// G32: F.
    ByFeed,
    /// G33: K, or I where X goes farther.
    ByAxis,
}

/// What is in force, to be shown to an operator.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Modal {
    /// 0 to 3 for G0 to G3, 32, 33; `None` before the first.
    pub motion: Option<u8>,
    /// G7.
    pub diameter: bool,
    /// G20.
    pub inch: bool,
    /// G91.
    pub incremental: bool,
    /// G95.
    pub per_turn: bool,
    /// The last F under G94.
    pub feed: Option<Feedrate>,
    /// The last F under G95.
    pub feed_per_turn: Option<Lead>,
}

/// Modal state.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) struct State {
    /// Where the program has led the tool.
    pub(crate) position: Point,
    /// None until one was written.
    pub(crate) motion: Option<Motion>,
    /// G7: X and U are diameters.
    pub(crate) diameter: bool,
    /// G20.
    pub(crate) inch: bool,
    /// G91.
    pub(crate) incremental: bool,
    /// G95.
    pub(crate) per_turn: bool,
    /// None until one was written, in the feed mode in force. [`Feed::Rapid`] only in the 1973 format.
    pub(crate) feed: Option<Feed>,
    /// The last F of G32.
    pub(crate) lead: Option<Lead>,
    /// G61, G61.1, G64.
    pub(crate) control: PathControl,
}

impl State {
    /// State at the start of a program.
    pub(crate) const fn new(settings: &Settings) -> Self {
        Self {
            position: settings.start,
            motion: None,
            diameter: false,
            inch: false,
            incremental: false,
            per_turn: false,
            feed: None,
            lead: None,
            control: PathControl::within(settings.corner),
        }
    }

    /// Puts G94 or G95 into force. An F of the other one is no feed any more.
    pub(crate) fn set_per_turn(&mut self, per_turn: bool) {
        if self.per_turn != per_turn {
            (self.per_turn, self.feed) = (per_turn, None);
        }
    }

    /// For display.
    pub(crate) const fn shown(&self) -> Modal {
        Modal {
            motion: match self.motion {
                None => None,
                Some(Motion::Rapid) => Some(0),
                Some(Motion::Line) => Some(1),
                Some(Motion::Arc(Sense::Clockwise)) => Some(2),
                Some(Motion::Arc(Sense::CounterClockwise)) => Some(3),
                Some(Motion::Thread(ThreadCode::ByFeed)) => Some(32),
                Some(Motion::Thread(ThreadCode::ByAxis)) => Some(33),
            },
            diameter: self.diameter,
            inch: self.inch,
            incremental: self.incremental,
            per_turn: self.per_turn,
            feed: match self.feed {
                Some(Feed::PerMinute(feed)) => Some(feed),
                _ => None,
            },
            feed_per_turn: match self.feed {
                Some(Feed::PerTurn(lead)) => Some(lead),
                _ => None,
            },
        }
    }

    /// Nanometres of a written 1: of a length along the path, of Z, of a radius.
    pub(crate) const fn unit_nm(&self) -> u32 {
        if self.inch { 25_400_000 } else { 1_000_000 }
    }

    /// Nanometres of radius of a written 1 of X or U. This is the only place of the factor two.
    pub(crate) const fn unit_x_nm(&self) -> u32 {
        if self.diameter { self.unit_nm() >> 1 } else { self.unit_nm() }
    }
}
