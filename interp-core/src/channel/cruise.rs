//! Where a motion keeps its speed, no tick needs to ask whether it must brake.
//!
//! That question costs roots and divisions. So a motion at its target speed remembers a distance before its end from
//! which it can brake even to standstill: as long as more is left, a tick is spent at that speed unasked. The
//! distance is found by halving, one look in each tick that asks anyway. What is left out could not have changed
//! anything, so the train is the same.

use crate::block::{Motion, Speed};

/// Ticks at the speed kept within which the distance is found: to find it closer would cost more than it saves.
const CLOSE: u64 = 8;

/// How long a speed can be kept.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) struct Cruise {
    /// The speed that this is about.
    speed: Speed,
    /// Where at least this much is left, it can be kept for a tick; nm with 12 fraction bits.
    calm: u64,
    /// Where this much is left or less, it is not known to be.
    tight: u64,
}

impl Cruise {
    /// Nothing is known.
    pub(super) const fn new() -> Self {
        Self { speed: 0, calm: u64::MAX, tight: 0 }
    }

    /// Whether `speed` can be kept for a tick, `left` before the end.
    #[inline]
    pub(super) const fn holds(&self, speed: Speed, left: u64) -> bool {
        left >= self.calm && speed == self.speed
    }

    /// Looks at one distance, where `speed` was kept for a tick, `left` before the end.
    pub(super) fn learn(&mut self, motion: &Motion, speed: Speed, left: u64) {
        if speed != self.speed {
            *self = Self { speed, ..Self::new() };
        }
        let doubt = left.saturating_sub(self.tight);
        if doubt < u64::from(speed).wrapping_mul(CLOSE) {
            return;
        }
        let middle = self.tight.saturating_add(doubt / 2);
        if motion.can_keep(speed, middle) {
            self.calm = middle;
        } else {
            self.tight = middle;
        }
    }
}
