//! A pass over the blocks to come, from the last one known to the nearest, some of them a tick.
//!
//! A new block at the end may raise the entries of all before it, and hundreds of instructions a block are too many for one tick. A
//! sweep goes on where it stopped in the tick before; the next one begins when it is over. Meanwhile what it has not come
//! to stands as it was planned last, for the end that was known then: who keeps that keeps the new plan, too, as every new
//! block only takes an end away. A block that no sweep has come to counts as not there.
//!
//! Where that does not hold all is planned at once: where feeds are set, where another law plans, where lines come to
//! be begun from standstill.

use crate::block::{Curve, Motion};

/// What a sweep does in a tick under an S law: a line takes one of it. So a new block acts after six ticks at most where 72 have
/// to be planned, and behind a sweep that is under way after twelve.
pub(in crate::channel) const WORK: u32 = 12;

/// The same near a soft limit, where a tick has more to do.
pub(in crate::channel) const LESS_WORK: u32 = 8;

/// How many times as many blocks fit in a tick under the linear law, which has no margins.
pub(super) const LINEAR: u32 = 3;

/// What an arc takes more than a line: sines and roots.
const ROUND: u32 = 3;

/// How far a sweep has come.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) struct Sweep {
    /// Blocks, from the nearest, that it has still to come to; 0 where none is under way.
    left: usize,
    /// Blocks that were planned, as they stand, before it began.
    known: usize,
    /// Blocks that were there when it began.
    end: usize,
    /// Blocks whose plan acts: a sweep that had come to them was over.
    settled: usize,
    /// All is to be planned at once.
    hurries: bool,
}

/// A sweep's part of a tick.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) struct Pass {
    /// What may still be done.
    work: u32,
    /// It is a sweep's first.
    pub(super) begins: bool,
}

impl Pass {
    /// A motion is planned.
    pub(super) const fn costs(&mut self, motion: &Motion) {
        match motion.curve {
            Curve::Line(..) => {}
            #[cfg(feature = "methods")]
            Curve::ClassicLine(..) => {}
            Curve::Arc(_) => self.work = self.work.saturating_sub(ROUND),
            #[cfg(feature = "methods")]
            Curve::Conic(_) => self.work = self.work.saturating_sub(ROUND),
        }
    }
}

impl Sweep {
    /// Of no block: all zero.
    pub(super) const NONE: Self = Self { left: 0, known: 0, end: 0, settled: 0, hurries: false };

    /// A tick's part, so much `work`, of the one that is under way or due, of so many blocks. One is due where the overrides have `changed`, too; with
    /// another law all is planned at once.
    pub(super) fn set_out(&mut self, blocks: usize, work: u32, changed: bool, law: bool) -> Option<Pass> {
        let at_once = self.hurries || law;
        let begins = at_once || self.left == 0;
        if begins {
            if !at_once && !changed && self.settled >= blocks {
                return None;
            }
            let known = if at_once || changed { 0 } else { self.settled };
            *self = Self { left: blocks, known, end: blocks, hurries: false, ..*self };
        }
        Some(Pass { work: if at_once { u32::MAX } else { work }, begins })
    }

    /// The block to be planned next, if any in this tick.
    pub(super) fn next(&mut self, pass: &mut Pass) -> Option<usize> {
        let Some(here) = self.left.checked_sub(1) else {
            self.finish();
            return None;
        };
        pass.work = pass.work.checked_sub(1)?;
        self.left = here;
        Some(here)
    }

    /// Blocks, from the nearest, that it has still to come to.
    pub(super) const fn left(&self) -> usize {
        self.left
    }

    /// Whether a block was planned before: if it stays the same, so do all before it.
    pub(super) const fn knew(&self, block: usize) -> bool {
        block < self.known
    }

    /// The sweep is over.
    pub(super) const fn finish(&mut self) {
        self.left = 0;
        self.settled = self.end;
    }

    /// The nearest block is taken away.
    pub(super) const fn skip(&mut self) {
        let last = self.left == 1;
        self.left = self.left.saturating_sub(1);
        self.known = self.known.saturating_sub(1);
        self.end = self.end.saturating_sub(1);
        self.settled = self.settled.saturating_sub(1);
        if last {
            self.finish();
        }
    }

    /// All is to be planned at once.
    pub(super) const fn hurry(&mut self) {
        self.hurries = true;
    }

    /// Plans anew what lies before a block, at once.
    pub(super) const fn again_before(&mut self, block: usize) {
        if self.left > 0 && self.left <= block {
            self.hurries = true;
        }
    }

    /// Whether there is nothing to do with so many blocks.
    pub(super) const fn is_over(&self, blocks: usize) -> bool {
        self.left == 0 && self.settled >= blocks && !self.hurries
    }

    /// The first of so many blocks whose plan does not act yet on what leads up to block `next`.
    pub(super) const fn pending(&self, next: usize, blocks: usize) -> Option<usize> {
        let acts = self.left > 0 && self.left <= next;
        if acts || self.settled >= blocks { None } else { Some(self.settled) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sweep_comes_to_each_block_once_and_the_next_one_to_what_is_new() {
        let mut sweep = Sweep::NONE;
        let (mut seen, mut ticks) = (0_usize, 0_u32);
        while !sweep.is_over(50) {
            let mut pass = sweep.set_out(50, WORK, false, false).unwrap();
            assert_eq!(pass.begins, ticks == 0);
            while let Some(here) = sweep.next(&mut pass) {
                seen += 1;
                assert_eq!(here, 50 - seen);
                assert!(!sweep.knew(here));
            }
            ticks += 1;
        }
        assert_eq!((seen, ticks), (50, 5));
        assert_eq!(sweep.set_out(50, WORK, false, false), None);
        // three are taken away and five come
        (0..3).for_each(|_| sweep.skip());
        assert_eq!(sweep.pending(0, 52), Some(47));
        let mut pass = sweep.set_out(52, WORK, false, false).unwrap();
        let (_, here) = (0..5).map(|n| (n, sweep.next(&mut pass))).last().unwrap();
        assert_eq!(here, Some(47));
        assert!(!sweep.knew(47) && sweep.knew(46));
        sweep.finish();
        assert!(sweep.is_over(52));
    }

    #[test]
    fn what_hurries_is_planned_in_one_tick() {
        let mut sweep = Sweep::NONE;
        sweep.hurry();
        let mut pass = sweep.set_out(64, WORK, false, false).unwrap();
        while sweep.next(&mut pass).is_some() {}
        assert!(sweep.is_over(64));
    }
}
