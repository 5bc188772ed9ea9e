//! What is being executed.

use super::cruise::Cruise;
use super::lookahead::smooth::is_smoothed;
use super::lookahead::{Overrides, pace};
use super::runner::Runner;
use crate::block::{Motion, Speed};
use crate::units::Lattice;

/// A motion being executed.
#[derive(Clone, Debug)]
pub(super) struct Active {
    pub(super) motion: Motion,
    /// Where it begins.
    pub(super) from: Lattice,
    pub(super) runner: Runner,
    /// Length covered.
    pub(super) done: u64,
    /// Its speed under the overrides `paced_at`.
    pub(super) pace: Speed,
    pub(super) paced_at: Overrides,
    pub(super) cruise: Cruise,
    /// It goes by the linear law, whatever its feed is now: a spindle has paced it while it moved.
    pub(super) linear: bool,
}

impl Active {
    /// At the start of `motion`.
    #[inline(always)]
    pub(super) fn new(motion: &Motion, overrides: Overrides, from: Lattice) -> Self {
        Self {
            from,
            linear: !is_smoothed(motion),
            runner: Runner::new(&motion.curve, motion.length),
            done: 0,
            pace: pace(motion, overrides),
            paced_at: overrides,
            cruise: Cruise::new(),
            motion: *motion,
        }
    }
}

/// What is being executed.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "one exists a channel, and there is no allocation")]
pub(super) enum Current {
    Nothing,
    Motion(Active),
    /// Clocks left.
    Dwell(u64),
}
