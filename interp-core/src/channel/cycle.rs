//! Begins, holds and ends what a channel executes.

use super::lead::Lead;
use super::{Channel, Current, Memory, State};
use crate::drive::BackEnd;
use core::borrow::BorrowMut;

impl<const N: usize, M: BorrowMut<Memory<N>>> Channel<N, M> {
    /// Starts a cycle, or goes on after a hold or a programmed stop. False where there is nothing to start.
    pub fn start(&mut self) -> bool {
        match self.state {
            State::Idle | State::Ended => {
                self.complete = false;
                self.closed = false;
                // another path's motions are no way back
                self.memory.borrow_mut().trail.clear(BackEnd::Start);
                self.waited = 0;
                self.single.pass_all();
                self.state = State::Filling;
                true
            }
            State::Holding | State::Stopped => {
                self.pass_single();
                self.crank.thread.go_on();
                self.state = State::Running;
                true
            }
            State::Filling | State::Running | State::Resetting => false,
        }
    }

    /// Brakes along the path to standstill, then forgets all blocks. The position stays true.
    pub fn reset(&mut self) {
        self.state = match self.state {
            State::Idle | State::Ended => State::Idle,
            State::Filling | State::Running | State::Holding | State::Stopped | State::Resetting => State::Resetting,
        };
    }

    /// Stops at once, from any speed, and forgets all blocks: for an emergency. The position is that of the last pulse
    /// planned; where the tool is nobody knows.
    pub fn abandon(&mut self) {
        self.speed = 0;
        // a pulse that is owed is not made any more: the place is that of the pins
        let owed = self.superposed.abandon();
        self.position.x = self.position.x.wrapping_sub(owed.0);
        self.position.z = self.position.z.wrapping_sub(owed.1);
        self.compensation.stop(self.tool());
        self.hands.abandon();
        self.forget();
    }

    /// Forgets all blocks of a path that stands. What the hands and the compensation do goes on. False, and nothing changes,
    /// while the path moves.
    pub fn drop_path(&mut self) -> bool {
        let stands = self.speed == 0 && !self.crank.thread.is_busy();
        if stands {
            self.forget();
        }
        stands
    }

    /// Feed hold: brakes along the path to standstill, or does not begin to move. False where nothing runs.
    pub fn hold(&mut self) -> bool {
        let runs = matches!(self.state, State::Running | State::Filling);
        if runs {
            self.state = State::Holding;
        }
        runs
    }

    /// Forgets all blocks after a reset.
    pub(super) fn forget(&mut self) {
        self.memory.borrow_mut().clear();
        // X stands where a thread has left it
        self.position.x = self.position.x.wrapping_add(self.crank.thread.take());
        self.crank.stand();
        self.window.clear();
        self.lead = Lead::new();
        self.current = Current::Nothing;
        self.complete = false;
        self.line = 0;
        self.state = State::Idle;
    }
}
