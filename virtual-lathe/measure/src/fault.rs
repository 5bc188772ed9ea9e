//! Broken rules: what, where, when; the first few are kept, all are counted.

use crate::setup::{Axis, PerAxis};
use std::fmt;

/// Which rule was broken. What `found` and `bound` of a [`Fault`] mean is said with each.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum FaultKind {
    /// The intervals of a tick don't add up to 12 000 clocks. Sum and 12 000.
    TickSum,
    /// An interval is shorter than the board can play. Clocks, and the least of them.
    EventTooShort,
    /// A step pin was high for too short. Clocks, and the least of them.
    PulseTooShort,
    /// A step pin was low for too short between two pulses. Clocks, and the least of them.
    SpaceTooShort,
    /// A rising edge too soon after a change of direction. Clocks, and the least of them.
    DirectionSetup,
    /// A change of direction too soon after a rising edge. Clocks, and the least of them.
    DirectionHold,
    /// The train ended with a step pin high. Clocks so far, and the least of them.
    PulseNotEnded,
    /// Moved farther in h = `ticks` ticks than v h + 1 pulses, v h + 2 for a minor axis (and what waiting
    /// edges make of it, see the crate's page). Pulses, and the most of them.
    Speed,
    /// Second difference over h = `ticks` ticks above a h² + 2 pulses, a h² + 4 for a minor axis (likewise).
    /// Pulses, and the most of them.
    Acceleration,
    /// The same with n joints, starts or stops in the window, which allow for n j h pulses more. Pulses,
    /// and the most of them.
    Jump,
    /// A pulse while every motion told so far was complete. No numbers.
    PulseWithoutMotion,
    /// A step of both axes went past the end of a motion without standing on it. No numbers.
    EndSkipped,
    /// The programmed start doesn't round to the position before the first event. X and Z of the
    /// rounded one.
    StartOffLattice,
    /// The last position isn't the last rounded end. X and Z of the rounded end.
    EndMissed,
    /// A pulse beyond the program was declared that the pins don't show, or show otherwise. Pulses of X and Z declared.
    NotAdded,
    /// Motions were left that should have made pulses. How many, and 0.
    MotionsLeft,
}

const KINDS: usize = FaultKind::MotionsLeft as usize + 1;
/// So many faults are kept with their place; the others are counted only.
pub const FAULTS_KEPT: usize = 20;

/// One broken rule.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The rule.
    pub kind: FaultKind,
    /// The axis, for rules of an axis.
    pub axis: Option<Axis>,
    /// Program line in work; 0 before the first motion.
    pub line: u32,
    /// Position in pulses.
    pub at: PerAxis<i32>,
    /// Time in train clocks since the start of the train.
    pub clocks: u64,
    /// h of a window in ticks, else 0.
    pub ticks: u16,
    /// What was found.
    pub found: i64,
    /// What was allowed, or asked for.
    pub bound: i64,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.kind)?;
        if let Some(axis) = self.axis {
            write!(f, " {axis}")?;
        }
        if self.ticks > 0 {
            write!(f, " over {} ticks", self.ticks)?;
        }
        write!(
            f,
            ": found {}, bound {}, line {}, clock {}, X {} Z {}",
            self.found, self.bound, self.line, self.clocks, self.at.x, self.at.z
        )
    }
}

/// The faults of a train.
#[derive(Clone, Debug, Default)]
pub struct Faults {
    first: Vec<Fault>,
    counts: [u64; KINDS],
}

impl Faults {
    /// The first [`FAULTS_KEPT`] faults, in the order of finding.
    #[must_use]
    pub fn first(&self) -> &[Fault] {
        &self.first
    }

    /// How often a rule was broken.
    #[must_use]
    pub fn count(&self, kind: FaultKind) -> u64 {
        self.counts.get(kind as usize).copied().unwrap_or(0)
    }

    /// How many faults there were.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.counts.iter().sum()
    }

    pub(crate) fn add(&mut self, fault: Fault) {
        if let Some(count) = self.counts.get_mut(fault.kind as usize) {
            *count = count.saturating_add(1);
        }
        if self.first.len() < FAULTS_KEPT {
            self.first.push(fault);
        }
    }
}

/// Where and when the checker stands; rules are reported from here.
#[derive(Copy, Clone, Debug, Default)]
pub(crate) struct Here {
    pub(crate) line: u32,
    pub(crate) at: PerAxis<i32>,
    pub(crate) clocks: u64,
}

impl Here {
    /// A fault of `kind` here.
    pub(crate) fn fault(self, kind: FaultKind, axis: Option<Axis>, found: i64, bound: i64) -> Fault {
        Fault { kind, axis, line: self.line, at: self.at, clocks: self.clocks, ticks: 0, found, bound }
    }
}
