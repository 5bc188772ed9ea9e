//! Executes what comes: one block after the other, each for its part of the tick.
//!
//! Time drives the path here, by the linear law. Where an S law plans ahead, or something else turns the crank, the tick is theirs
//! ([`follow`](super::lead), [`turn_crank`](super::crank)), and only what is no motion is done here.

use super::active::{Active, Current};
use super::lookahead;
use super::lookahead::smooth::is_smoothed;
use super::runner::Sink;
use super::{Channel, Memory, State};
use crate::block::{Output, Work};
use crate::config::TICK_CLOCKS;
use crate::drive::BackEnd;
use crate::governor::{Advance, square};
use crate::math::root;
use crate::times::Stretch;
use crate::train::Train;
use core::borrow::BorrowMut;

/// What became of the block that came next.
pub(super) enum Next {
    /// Something was begun, or is over already.
    Goes,
    /// Nothing comes.
    Stands,
    /// An output changes at the end of this tick.
    Output(Output),
}

impl<const N: usize, M: BorrowMut<Memory<N>>> Channel<N, M> {
    /// A tick's step toward having the motions at hand that were gone back over: before anybody looks where the path leads.
    #[inline]
    pub(super) fn slide(&mut self) {
        let trail = &mut self.memory.borrow_mut().trail;
        if self.crank.turns || trail.is_behind() {
            trail.slide(self.crank.turns && self.crank.back, &mut self.maker);
        }
    }

    /// Executes for one tick.
    pub(super) fn run(&mut self, out: &mut impl Train) -> Option<Output> {
        if self.crank.turns {
            return self.turn_crank(out);
        }
        if self.window.ticks() > 0 && !self.memory.borrow().trail.is_behind() && self.follows() {
            if self.window.is_drained() && matches!(self.current, Current::Nothing) && self.stops_single() {
                self.state = State::Stopped;
                self.speed = 0;
                return None;
            }
            self.follow(out);
            return None;
        }
        let mut clock = 0_u32;
        while clock < TICK_CLOCKS && matches!(self.state, State::Running | State::Holding | State::Resetting) {
            let left = TICK_CLOCKS.wrapping_sub(clock);
            match &mut self.current {
                Current::Motion(_) => match self.go(clock, out) {
                    Some(used) => clock = clock.wrapping_add(used),
                    None => break,
                },
                Current::Dwell(_) if !matches!(self.state, State::Running) => break,
                Current::Dwell(clocks) => {
                    let used = crate::math::to_u32((*clocks).min(u64::from(left)));
                    *clocks = clocks.wrapping_sub(u64::from(used));
                    clock = clock.wrapping_add(used);
                    if *clocks == 0 {
                        self.current = Current::Nothing;
                    }
                }
                Current::Nothing => match self.next_block() {
                    Next::Goes if self.crank.turns => break,
                    Next::Goes => {}
                    Next::Stands => break,
                    Next::Output(output) => return Some(output),
                },
            }
        }
        None
    }

    /// Begins what comes next.
    // apart from `run`, so that a tick inside a block pays nothing for it
    #[inline(never)]
    pub(super) fn next_block(&mut self) -> Next {
        // a hold brakes on over joints; it ends where the program stands anyway
        if !matches!(self.state, State::Running) && self.speed == 0 {
            return Next::Stands;
        }
        if self.memory.borrow().trail.is_behind() {
            // what is not ready yet is waited for
            let goes = self.memory.borrow_mut().trail.go_on() && self.enter_again();
            // from standstill it begins with the next tick: a stop and a start are two jumps; and an S law's lead sets off there
            return if goes && self.speed > 0 { Next::Goes } else { Next::Stands };
        }
        // the tool is where it should be before the program stands; and only a cycle moves what is added
        let moves = self.memory.borrow().ahead.next().is_some_and(|(block, _)| lookahead::as_motion(block).is_some());
        if !moves && !self.settled() {
            return Next::Stands;
        }
        if self.speed == 0 && self.stops_single() {
            self.state = State::Stopped;
            return Next::Goes;
        }
        let Memory { ahead, trail } = self.memory.borrow_mut();
        let Some((block, entry)) = ahead.next() else {
            self.state = State::Filling;
            return Next::Stands;
        };
        self.line = block.line;
        // a motion is large: it is copied once, from the look-ahead to where it is executed
        match block.work {
            // by what was planned for something else nothing sets off
            Work::Motion(_) if self.speed == 0 && ahead.is_urgent() => return Next::Stands,
            // under an S law it begins with the next tick
            Work::Motion(ref motion) if self.window.ticks() > 0 && is_smoothed(motion) => {
                self.speed = 0;
                return Next::Stands;
            }
            Work::Motion(ref motion) => {
                self.speed = if self.speed == 0 {
                    // planned to be entered at speed, it may come to be begun from a stand: single block, a hold at its joint
                    self.hands.cap(root(entry).min(motion.start))
                } else {
                    // what braking could not shed of a lowered feed goes on; what the machine can't take does not
                    self.speed.min(motion.joint).min(motion.limit)
                };
                self.current = Current::Motion(Active::new(motion, self.overrides, self.position));
                trail.push(block.line, motion);
                ahead.skip();
                self.begun();
                return Next::Goes;
            }
            Work::Dwell(ticks) => {
                self.current = Current::Dwell(u64::from(ticks).wrapping_mul(u64::from(TICK_CLOCKS)));
            }
            Work::Output(output) => {
                trail.clear(BackEnd::Output);
                ahead.skip();
                return Next::Output(output);
            }
            Work::Stop => self.state = State::Stopped,
            Work::OptionalStop if self.optional_stop => self.state = State::Stopped,
            Work::OptionalStop => {}
            Work::End => {
                self.state = State::Ended;
                self.line = 0;
                trail.clear(BackEnd::Start);
            }
        }
        trail.stand();
        ahead.skip();
        Next::Goes
    }

    /// Advances the motion from `clock` on; the clocks used, or `None` where it stands for the rest of the tick.
    fn go(&mut self, clock: u32, out: &mut impl Train) -> Option<u32> {
        let holding = !matches!(self.state, State::Running);
        // an S law takes over where the tool is in the motion begun last, from standstill
        let smooth = self.window.ticks() > 0;
        let Memory { ahead, trail } = self.memory.borrow();
        let Current::Motion(active) = &mut self.current else { return None };
        if active.paced_at != self.overrides {
            active.repace(self.overrides, &self.crank);
        }
        let target = if holding { 0 } else { self.hands.cap(active.pace) };
        if self.speed == 0 {
            if target == 0 || ahead.is_urgent() {
                self.await_spindle();
                return None;
            }
            self.speed = target.min(self.rest).max(1);
        } else if target == 0 && self.speed <= self.rest {
            self.speed = 0;
            return None;
        }
        // no advance leads past the end
        let left = active.motion.length.wrapping_sub(active.done);
        let steady = self.speed == target && clock == 0;
        let advance = if steady && active.cruise.holds(target, left) {
            Advance { length: u64::from(target), clocks: TICK_CLOCKS, speed: target, done: false }
        } else {
            let exit = if self.single.stops(ahead, self.line) {
                square(active.motion.stop)
            } else {
                trail.exit(ahead, &active.motion, smooth)
            };
            let budget = TICK_CLOCKS.wrapping_sub(clock);
            let advance = active.motion.advance(self.speed, left, exit, target, budget);
            if steady && advance.speed == target && !advance.done {
                active.cruise.learn(&active.motion, target, left);
            }
            advance
        };
        active.done = active.done.wrapping_add(advance.length);
        self.speed = advance.speed;
        let mut sink =
            Sink { shaper: &mut self.shaper, position: &mut self.position, superposed: &mut self.superposed, out };
        let stretch = Stretch { from: clock, clocks: advance.clocks };
        active.runner.advance(active.done, stretch, &mut sink);
        if advance.done {
            active.runner.finish(clock.wrapping_add(advance.clocks), &mut sink);
            let stops = self.single.stops(ahead, self.line) && self.speed <= active.motion.stop;
            let goes_on = trail.runs_on(smooth).unwrap_or_else(|| ahead.continues()) && !stops;
            self.current = Current::Nothing;
            if !goes_on {
                self.speed = 0;
            }
        }
        Some(advance.clocks)
    }
}
