//! A tick of a thread's stages: what is done in each, and which one follows.

use super::MOST_BLOCKS;
use crate::channel::crank::Crank;
use crate::channel::{Channel, Current, Memory, State};
use crate::drive::follower::Bounds;
use crate::drive::{ThreadStage, Trouble};
use crate::math::to_u32;
use crate::train::Train;
use core::borrow::BorrowMut;

impl<const N: usize, M: BorrowMut<Memory<N>>> Channel<N, M> {
    /// A tick of what a thread needs besides its path. True where the path has no part in it.
    pub(in crate::channel) fn tend_thread(&mut self, out: &mut impl Train) -> bool {
        match self.crank.thread.stage {
            ThreadStage::None => false,
            ThreadStage::Waiting => self.tend_start(),
            ThreadStage::Cutting => self.tend_cut(),
            ThreadStage::Leaving => self.tend_way_out(),
            ThreadStage::Left => {
                let thread = &mut self.crank.thread;
                let out =
                    !thread.retract.is_live() && thread.retract.pulses() == thread.distance && thread.distance != 0;
                if matches!(self.state, State::Running) && out {
                    thread.stage = ThreadStage::Returning;
                }
                true
            }
            ThreadStage::Returning => {
                self.return_to_start(out);
                true
            }
            ThreadStage::Entering => {
                if !matches!(self.state, State::Running) {
                    self.pull_out();
                    self.crank.thread.stage = ThreadStage::Left;
                } else if !self.crank.thread.retract.is_live() {
                    self.crank.ungear();
                    let Crank { thread, spindle, .. } = &mut self.crank;
                    thread.wait(spindle);
                }
                true
            }
        }
    }

    fn tend_start(&mut self) -> bool {
        if !matches!(self.state, State::Running) || !self.crank.thread.threading.guarded {
            return false;
        }
        let Crank { thread, spindle, .. } = &mut self.crank;
        let trouble = thread.look_out(spindle);
        if thread.waited > 0 || spindle.as_ref().is_none_or(|spindle| spindle.zero().is_none()) {
            // what was geared to it begins anew
            self.crank.ungear();
        }
        if let Some(trouble) = trouble {
            self.fail(trouble);
        }
        trouble.is_some()
    }

    fn tend_cut(&mut self) -> bool {
        let running = matches!(self.state, State::Running);
        if running && self.crank.thread.threading.guarded {
            let Crank { thread, spindle, gearing, .. } = &mut self.crank;
            // stopped in the groove, and X could not be pulled out
            let stuck = gearing.is_none().then_some(Trouble::NoWayBack);
            let trouble = thread.fault.or(stuck).or(spindle.as_ref().and_then(|spindle| thread.look(spindle)));
            if let Some(trouble) = trouble {
                self.fail(trouble);
            }
        }
        if matches!(self.state, State::Holding | State::Resetting) && self.leads_z() {
            let thread = &mut self.crank.thread;
            if thread.distance != 0 && thread.blocks <= MOST_BLOCKS {
                (thread.stage, thread.brakes) = (ThreadStage::Leaving, false);
                self.pull_out();
            }
        }
        false
    }

    fn tend_way_out(&mut self) -> bool {
        let at_end = matches!(self.current, Current::Nothing);
        let out = !self.crank.thread.retract.is_live();
        self.crank.thread.brakes = out;
        if out && (at_end || self.speed == 0) {
            self.speed = 0;
            self.crank.ungear();
            self.crank.thread.stage = ThreadStage::Left;
        }
        at_end || self.crank.thread.stage == ThreadStage::Left
    }

    fn pull_out(&mut self) {
        let thread = &mut self.crank.thread;
        let pace = match &self.current {
            Current::Motion(active) => thread.pace_beside(active, self.speed),
            Current::Nothing | Current::Dwell(_) => thread.pace,
        };
        thread.retract.out(thread.distance, pace);
    }

    /// A tick of the way back, by time.
    fn return_to_start(&mut self, out: &mut impl Train) {
        let tool = self.crank.tool;
        if tool <= 0 {
            self.speed = 0;
            self.crank.ungear();
            if matches!(self.state, State::Running) {
                self.crank.thread.retract.home();
                self.crank.thread.stage = ThreadStage::Entering;
            }
            return;
        }
        let running = matches!(self.state, State::Running);
        if running && !self.enter(true) {
            return self.fail(Trouble::NoWayBack);
        }
        let Current::Motion(active) = &self.current else { return };
        let bounds = Bounds { speed: active.motion.limit, accel: active.motion.accel };
        let before = self.crank.follower.advance();
        let advance = if running {
            self.crank.follower.follow(tool.wrapping_neg(), 0, bounds, 0)
        } else {
            before.saturating_add(i64::from(bounds.accel)).min(0)
        };
        let advance = self.within_path(advance);
        let left = self.walk(advance, out);
        let made = advance.wrapping_sub(left);
        self.crank.follower.set(made);
        self.crank.tool = tool.wrapping_add(made);
        self.speed = to_u32(made.unsigned_abs());
    }
}
