//! A pass over the blocks to come, from the last one known to the nearest, some of them a tick.
//!
//! A new block at the end may raise the entries of all before it, and hundreds of instructions a block are too many for one tick. A
//! sweep goes on where it stopped in the tick before; the next one begins when it is over. Meanwhile what it has not come
//! to stands as it was planned last, for the end that was known then: who keeps that keeps the new plan, too, as every new
//! block only takes an end away. A block that no sweep has come to counts as not there.
//!
//! Where that does not hold a sweep is urgent: where another law plans, where lines come to be begun from standstill. Until it
//! is over the lead brakes, and what stands stays. That is safe whatever the old plan was for: braking as hard as allowed
//! meets every joint that is met from there at all.

use crate::block::{Curve, Motion};

/// What a sweep does in a tick under an S law: a line takes one of it. So a new block acts after nine ticks at most where 72
/// lines have to be planned, and behind a sweep that is under way after eighteen. A tick begins one.
pub(in crate::channel) const WORK: u32 = 8;

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
    /// What was planned is for something else: nothing goes on by it.
    urgent: bool,
    /// It is to begin with the last block again.
    again: bool,
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
    pub(super) const NONE: Self = Self { left: 0, known: 0, end: 0, settled: 0, urgent: false, again: false };

    /// A tick's part, so much `work`, of the one that is under way or due, of so many blocks. One is due where the overrides
    /// have `changed`, too; with another law it is urgent.
    pub(super) fn set_out(&mut self, blocks: usize, work: u32, changed: bool, law: bool) -> Option<Pass> {
        let anew = self.again || law;
        let begins = anew || self.left == 0;
        if begins {
            if !anew && !changed && self.settled >= blocks {
                return None;
            }
            let known = if anew || changed { 0 } else { self.settled };
            *self = Self { left: blocks, known, end: blocks, urgent: self.urgent || law, again: false, ..*self };
        }
        Some(Pass { work, begins })
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
        self.urgent = self.again && self.urgent;
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

    /// All is to be planned anew, from the last block on: `urgent`, where nothing may go on by what was planned.
    pub(super) const fn again(&mut self, urgent: bool) {
        self.again = true;
        self.urgent |= urgent;
    }

    /// What lies before a block is to be planned anew, urgently, where a sweep has come past it.
    pub(super) const fn again_before(&mut self, block: usize) {
        if self.left > 0 && self.left <= block {
            (self.left, self.known, self.urgent) = (block, 0, true);
        }
    }

    /// Whether nothing may go on by what was planned.
    pub(super) const fn is_urgent(&self) -> bool {
        self.urgent
    }

    /// Whether there is nothing to do with so many blocks.
    pub(super) const fn is_over(&self, blocks: usize) -> bool {
        self.left == 0 && self.settled >= blocks && !self.again
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
        assert_eq!((seen, ticks), (50, 7));
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

    /// A tick's part of 50 blocks; the last one planned.
    fn part(sweep: &mut Sweep, law: bool) -> Option<usize> {
        let mut pass = sweep.set_out(50, WORK, false, law)?;
        core::iter::from_fn(|| sweep.next(&mut pass)).last()
    }

    #[test]
    fn an_urgent_sweep_comes_to_all_and_is_urgent_to_its_end() {
        for law in [false, true] {
            let mut sweep = Sweep { settled: 50, end: 50, ..Sweep::NONE };
            assert!(sweep.is_over(50) && part(&mut sweep, false).is_none());
            if !law {
                sweep.again(true);
            }
            assert_eq!(part(&mut sweep, law), Some(42));
            for last in [34, 26, 18, 10, 2] {
                assert!(sweep.is_urgent() && !sweep.is_over(50) && !sweep.knew(0));
                assert_eq!(part(&mut sweep, false), Some(last));
            }
            assert_eq!(part(&mut sweep, false), Some(0));
            assert!(!sweep.is_urgent() && sweep.is_over(50));
        }
    }

    #[test]
    fn what_a_sweep_has_come_past_is_planned_anew_from_there_on() {
        let mut sweep = Sweep { settled: 50, end: 50, ..Sweep::NONE };
        sweep.again(false);
        assert_eq!(part(&mut sweep, false), Some(42));
        // where it has not come to it needs nothing more
        sweep.again_before(41);
        assert!(!sweep.is_urgent());
        sweep.again_before(45);
        assert!(sweep.is_urgent());
        assert_eq!(part(&mut sweep, false), Some(37));
        // what comes to be urgent meanwhile begins with the last block
        sweep.again(true);
        assert_eq!(part(&mut sweep, false), Some(42));
        while !sweep.is_over(50) {
            assert!(sweep.is_urgent());
            part(&mut sweep, false);
        }
        assert!(!sweep.is_urgent());
    }
}
