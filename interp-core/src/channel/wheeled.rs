//! The contour wheel drives the path: the feed governor with an end that the wheel moves.
//!
//! The wheel asks for a distance along the path, to either side. That is an end like any other: the governor runs toward
//! it within the limits, brakes so that it stands there exactly, shares the acceleration with the bends, and is bound by
//! the joints on the way, going back as well as forward. Where the wheel turns round, or asks for less than braking needs,
//! the path brakes to a stand first and then goes the other way. Where the path ends, what is left is dropped and told.
//!
//! A [pull](super::Pull) asks for the end of the path, at a speed of its own: a joystick's.
//!
//! It sets off with the speed of one tick's acceleration, not with the jump that motors allow: a wheel is turned gently.

use super::Memory;
use super::trail::Trail;
use super::{Channel, Current, Pull, State};
use crate::block::{Motion, Output, Speed};
use crate::config::TICK_CLOCKS;
use crate::drive::BackEnd;
use crate::drive::wheel::Click;
use crate::governor::square;
use crate::math::root;
use crate::times::Stretch;
use crate::train::Train;
use core::borrow::BorrowMut;

impl<const N: usize, M: BorrowMut<Memory<N>>> Channel<N, M> {
    /// A tick of the wheel.
    pub(super) fn turn_wheel(&mut self, click: Click, counts: i16, out: &mut impl Train) -> Option<Output> {
        let travel = i64::from(self.speed);
        let signed = |length: i64, back: bool| if back { length.wrapping_neg() } else { length };
        let braking = match &self.current {
            Current::Motion(active) => square(self.speed).checked_div(u64::from(active.motion.accel) << 1).unwrap_or(0),
            Current::Nothing | Current::Dwell(_) => 0,
        };
        let back = self.crank.back;
        if self.speed == 0 && matches!(self.crank.pull, Some(Pull { speed: 0, .. })) {
            self.crank.pull = None;
        }
        self.crank.driven.dropped = if let (Some(pull), State::Running) = (self.crank.pull, self.state) {
            self.crank.wheel.ask(far(pull));
            i32::from(counts)
        } else if matches!(self.state, State::Running) {
            self.crank.wheel.turn(click, counts, signed(braking.cast_signed(), back), travel)
        } else {
            // a hold brakes, whatever the wheel asks for
            self.crank.wheel.stop(click).saturating_add(i32::from(counts))
        };
        let mut clock = 0_u32;
        while clock < TICK_CLOCKS {
            if self.crank.in_thread {
                // begun in this tick: the spindle drives it, from its start
                self.drop_rest(click);
                return None;
            }
            if self.speed == 0 && !self.set_off(click) {
                let forward = self.crank.wheel.to_go() > 0 && clock == 0 && !self.crank.back;
                return if forward { self.end_of_path(click) } else { None };
            }
            match self.wheel_on(clock, out) {
                Some(used) => clock = clock.wrapping_add(used),
                None => break,
            }
        }
        None
    }

    /// Begins to move where the wheel asks for it and the path leads there.
    fn set_off(&mut self, click: Click) -> bool {
        let to_go = self.crank.wheel.to_go();
        let stands = self.crank.pull.is_some_and(|pull| pull.speed == 0);
        if to_go == 0 || stands || !matches!(self.state, State::Running) {
            return false;
        }
        let end = self.crank.along.room(to_go < 0);
        if end == 0 {
            self.drop_rest(click);
            return false;
        }
        self.crank.back = to_go < 0;
        if !self.enter(self.crank.back) {
            // without an end the motion before is not ready yet: it waits
            if let (true, Some(end)) = (self.crank.back, self.end_of_way_back()) {
                // what pulls asks for the end: it has it
                self.crank.driven.back_end = Some(end).filter(|_| self.crank.pull.is_none());
                self.drop_rest(click);
            }
            return false;
        }
        let Current::Motion(active) = &self.current else { return false };
        let motion = &active.motion;
        let pace = self.crank.pull.map_or(Speed::MAX, |pull| pull.speed);
        let most = root(motion.reachable(to_go.unsigned_abs().min(end), 0));
        self.speed = motion.accel.min(motion.top()).min(most).min(pace).max(1);
        if !self.fence.is_calm(self.tool()) && self.is_fenced(self.crank.back) {
            self.speed = 0;
        }
        self.speed > 0
    }

    /// Why the way back ends here.
    fn end_of_way_back(&self) -> Option<BackEnd> {
        let trail = &self.memory.borrow().trail;
        let thread = trail.here().is_some_and(|(_, motion)| motion.feed.is_thread());
        if thread && !self.crank.in_thread { Some(BackEnd::Thread) } else { trail.end() }
    }

    /// Pushed on where no motion follows: other work is done, else what is left is dropped.
    fn end_of_path(&mut self, click: Click) -> Option<Output> {
        if self.memory.borrow().trail.is_behind() {
            return None;
        }
        let output = self.other_work();
        if output.is_none() && matches!(self.current, Current::Nothing) {
            self.drop_rest(click);
        }
        output
    }

    /// Drops what the wheel has still to go, and tells.
    pub(super) fn drop_rest(&mut self, click: Click) {
        let dropped = self.crank.wheel.stop(click);
        // what pulls asks for the end: nothing is lost there
        let dropped = if self.crank.pull.is_some() { 0 } else { dropped };
        self.crank.driven.dropped = self.crank.driven.dropped.saturating_add(dropped);
    }

    /// The motion that follows in a sense.
    pub(super) fn neighbour(&self, back: bool) -> Option<&Motion> {
        let Memory { ahead, trail } = self.memory.borrow();
        if back {
            return trail.previous();
        }
        if trail.is_behind() {
            return trail.next();
        }
        ahead.next().and_then(|(block, _)| super::lookahead::as_motion(block))
    }

    /// Moves inside the present motion from `clock` on; the clocks used, or `None` where it stands for the rest of the tick.
    fn wheel_on(&mut self, clock: u32, out: &mut impl Train) -> Option<u32> {
        let back = self.crank.back;
        let room = self.room(back);
        let Current::Motion(active) = &self.current else { return None };
        let motion = &active.motion;
        let Memory { ahead, trail } = self.memory.borrow();
        let planned = if back { trail.exit_back() } else { trail.exit(ahead, motion, false) };
        // what is left of the motion, and the squared speed to leave it with, where the path is to stand after such a length
        let ending = |length: u64| match length.checked_sub(room) {
            None | Some(0) => (length, 0),
            Some(beyond) => (room, self.neighbour(back).map_or(planned, |next| planned.min(next.reachable(beyond, 0)))),
        };
        let to_go = self.crank.wheel.to_go();
        let end = self.crank.along.room(back);
        let asked = u64::try_from(if back { to_go.wrapping_neg() } else { to_go }).unwrap_or(0).min(end);
        let (mut left, mut exit) = ending(asked);
        let pace = self.crank.pull.map_or(Speed::MAX, |pull| pull.speed).min(motion.top());
        let stops = asked > 0 && pace > 0 && motion.reachable(left, exit) >= square(self.speed);
        let target = if stops { self.hands.cap(pace) } else { 0 };
        if !stops {
            (left, exit) = ending(end);
            if self.speed <= motion.accel {
                self.speed = 0;
                return None;
            }
        }
        let budget = TICK_CLOCKS.wrapping_sub(clock);
        let advance = motion.advance(self.speed, left, exit, target, budget);
        self.speed = advance.speed;
        let by = advance.length.min(room);
        let signed = if back { by.cast_signed().wrapping_neg() } else { by.cast_signed() };
        self.crank.wheel.went(signed);
        self.crank.along.went(signed);
        self.pass(back, by, Stretch { from: clock, clocks: advance.clocks }, out);
        if advance.done {
            self.over_joint(back);
        }
        Some(advance.clocks)
    }

    /// Where a stretch is over: at the wheel's end it stands, at a joint it goes on at the joint's speed at most.
    fn over_joint(&mut self, back: bool) {
        let border = |trail: &Trail, motion: &Motion| if trail.stands_before() { 0 } else { motion.joint };
        let joint = match &self.current {
            Current::Motion(active) => border(&self.memory.borrow().trail, &active.motion),
            Current::Nothing | Current::Dwell(_) => crate::block::Speed::MAX,
        };
        if self.crank.wheel.to_go() == 0 || self.room(back) > 0 || !self.enter(back) {
            self.speed = 0;
            return;
        }
        let Current::Motion(active) = &self.current else { return };
        let joint = if back { joint } else { border(&self.memory.borrow().trail, &active.motion) };
        self.speed = self.speed.min(joint).min(active.motion.top());
    }
}

/// The end of the path, as a distance that no path has: nm with 12 fraction bits.
const fn far(pull: Pull) -> i64 {
    const FAR: i64 = 1 << 50;
    match pull {
        Pull { speed: 0, .. } => 0,
        Pull { back: true, .. } => -FAR,
        Pull { back: false, .. } => FAR,
    }
}
