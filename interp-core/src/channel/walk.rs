//! Moves along the path by a given length in a tick, both ways and over joints: for drives whose advance is known from
//! elsewhere.
//!
//! The governor decides an advance block by block, as each has limits of its own. A drive that follows something else (a
//! spindle, a plan that runs ahead) knows only how far the path advances in the tick; here it is divided among the
//! blocks that it leads through, each with the part of the tick that its length has in the whole. Backward it leads over
//! joints into the motions of the [trail](super::trail), and ends exactly at its start.

use super::Memory;
use super::lead::Lead;
use super::lookahead::Overrides;
use super::runner::{Runner, Sink, share};
use super::{Active, Channel, Current};
use crate::block::{Motion, Work};
use crate::config::{FRACTION_BITS, TICK_CLOCKS};
use crate::times::Stretch;
use crate::train::Train;
use crate::units::Lattice;
use core::borrow::BorrowMut;

/// What is added to a length before its steps are made: the timeline rounds down, by up to 2 nm where a curve is 2 m
/// long, and a wheel stops on lattice lines, whose steps are to be made then.
const FINE: u64 = 4 << FRACTION_BITS;

impl Active {
    /// The length whose steps are made where the path is at `done`.
    fn rounded(&self) -> u64 {
        if self.done == 0 { 0 } else { self.done.saturating_add(FINE).min(self.motion.length) }
    }

    /// At the end of `motion`.
    #[inline(never)]
    pub(super) fn at_end(motion: &Motion, overrides: Overrides, at: Lattice) -> Self {
        let end = motion.curve.end();
        let from = Lattice { x: at.x.wrapping_sub(end.0), z: at.z.wrapping_sub(end.1) };
        let runner = Runner::at_end(&motion.curve, motion.length);
        Self { runner, done: motion.length, ..Self::new(motion, overrides, from) }
    }
}

impl<const N: usize, M: BorrowMut<Memory<N>>> Channel<N, M> {
    /// Moves by `by` (nm, 12 fraction bits; below 0 back) during the whole tick, evenly. Returns what is left of it where
    /// the path ends; it ends there exactly.
    pub(super) fn walk(&mut self, by: i64, out: &mut impl Train) -> i64 {
        let back = by < 0;
        let (mut left, mut clock) = (by.unsigned_abs(), 0_u32);
        while left > 0 {
            let mut room = self.room(back);
            if room == 0 {
                if !self.enter(back) {
                    break;
                }
                room = self.room(back);
            }
            let budget = TICK_CLOCKS.wrapping_sub(clock);
            let clocks = if left < room { budget } else { share(budget, room, left) };
            let by = left.min(room);
            self.pass(back, by, Stretch { from: clock, clocks }, out);
            clock = clock.wrapping_add(clocks);
            left = left.wrapping_sub(by);
        }
        let left = left.cast_signed();
        if back { left.wrapping_neg() } else { left }
    }

    /// Length of the present motion that is left in a sense.
    pub(super) const fn room(&self, back: bool) -> u64 {
        match &self.current {
            Current::Motion(active) if back => active.done,
            Current::Motion(active) => active.motion.length.wrapping_sub(active.done),
            Current::Nothing | Current::Dwell(_) => 0,
        }
    }

    /// Moves inside the present motion by `by`, at most its [`room`](Self::room); the end or the start is met whole.
    pub(super) fn pass(&mut self, back: bool, by: u64, stretch: Stretch, out: &mut impl Train) {
        let Current::Motion(active) = &mut self.current else { return };
        let mut sink =
            Sink { shaper: &mut self.shaper, position: &mut self.position, superposed: &mut self.superposed, out };
        if back {
            active.done = active.done.wrapping_sub(by);
            active.runner.retreat(active.rounded(), stretch, &mut sink);
        } else {
            active.done = active.done.wrapping_add(by);
            active.runner.advance(active.rounded(), stretch, &mut sink);
            if active.done == active.motion.length {
                active.runner.finish(stretch.from.wrapping_add(stretch.clocks), &mut sink);
                self.current = Current::Nothing;
            }
        }
    }

    /// Goes over a joint where the present motion has no room in a sense. False where there is no motion.
    pub(super) fn enter(&mut self, back: bool) -> bool {
        if self.room(back) > 0 {
            return true;
        }
        match &self.current {
            Current::Dwell(_) => false,
            Current::Motion(_) => back && self.memory.borrow_mut().trail.go_back() && self.enter_from_behind(),
            Current::Nothing if back => self.enter_from_behind(),
            Current::Nothing if self.memory.borrow().trail.is_behind() => {
                self.memory.borrow_mut().trail.go_on() && self.enter_again()
            }
            Current::Nothing => self.begin_motion(),
        }
    }

    /// Begins the next block where it is a motion. Threads have a drive of their own: it is not walked on into one, nor
    /// out of one.
    fn begin_motion(&mut self) -> bool {
        let Memory { ahead, trail } = self.memory.borrow_mut();
        let Some((block, _)) = ahead.next() else { return false };
        let Work::Motion(ref motion) = block.work else { return false };
        let (thread, in_thread) = (motion.feed.is_thread(), self.crank.in_thread);
        if in_thread && !thread {
            return false;
        }
        self.line = block.line;
        trail.push(block.line, motion);
        self.current = Current::Motion(Active::new(motion, self.overrides, self.position));
        ahead.skip();
        self.begun();
        thread == in_thread
    }

    /// Enters the trail's present motion from its end. What is a thread is not gone back into.
    fn enter_from_behind(&mut self) -> bool {
        let Some((line, motion)) = self.memory.borrow().trail.here() else { return false };
        if motion.feed.is_thread() && !self.crank.in_thread {
            return false;
        }
        self.current = Current::Motion(Active::at_end(motion, self.overrides, self.position));
        self.line = line;
        true
    }

    /// Enters the trail's present motion from its start.
    pub(super) fn enter_again(&mut self) -> bool {
        let Some((line, motion)) = self.memory.borrow().trail.here() else { return false };
        self.current = Current::Motion(Active::new(motion, self.overrides, self.position));
        self.line = line;
        self.lead = Lead::new();
        true
    }
}
