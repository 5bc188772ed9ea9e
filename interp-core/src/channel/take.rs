//! Takes blocks from the source into the look-ahead, and has them planned.

use super::lookahead::sweep::WORK;
use super::{Channel, Current, Memory, State};
use crate::block::{Block, Work};
use crate::drive::Drive;
use core::borrow::BorrowMut;

/// Blocks taken in one tick while a cycle fills the look-ahead.
const FILL_PER_TICK: usize = 16;

/// Ticks without a new block after which a cycle begins although neither the look-ahead is full nor the program's end
/// known: the sender waits. Where there is no block at all the channel is idle again.
const FILL_PATIENCE: u32 = 50;

impl<const N: usize, M: BorrowMut<Memory<N>>> Channel<N, M> {
    /// Takes blocks and plans.
    pub(super) fn take(&mut self, source: &mut impl FnMut() -> Option<Block>) {
        if matches!(self.state, State::Idle | State::Ended | State::Resetting) {
            return;
        }
        let mut taken = 0_usize;
        while !self.complete && self.memory.borrow().ahead.has_room() && taken < FILL_PER_TICK {
            let Some(block) = source() else {
                self.complete = self.closed;
                if !self.closed && !matches!(self.state, State::Filling) {
                    self.starved = self.starved.saturating_add(1);
                }
                break;
            };
            self.complete = matches!(block.work, Work::End);
            let parts = self.hands.parts_of(&block);
            self.memory.borrow_mut().ahead.push(block, parts);
            if self.single.is_on() {
                self.memory.borrow_mut().ahead.stand_last();
            }
            taken = taken.wrapping_add(1);
        }
        self.waited = if taken > 0 { 0 } else { self.waited.saturating_add(1) };
        if self.window.ticks() > 0 {
            self.stand_late();
        }
        let planned = self.crank.planned_with(self.overrides);
        if self.memory.borrow().ahead.is_planned_with(planned) {
            return;
        }
        let Memory { ahead, trail } = self.memory.borrow_mut();
        let active = match &self.current {
            // what comes follows the motion begun last, wherever the tool is
            _ if trail.is_behind() => match trail.newest() {
                Some(newest) => Some(newest).filter(|_| !trail.stands_behind()),
                // it is planned for when the tool comes near
                None => return,
            },
            _ if trail.stands_behind() => None,
            Current::Motion(active) => Some(&active.motion),
            Current::Nothing | Current::Dwell(_) => None,
        };
        match (self.window.ticks(), self.crank.drive) {
            (0, _) | (_, Drive::Spindle(_) | Drive::Wheel(_)) => ahead.plan(active, planned, WORK),
            (ticks, Drive::Time) => ahead.plan_smooth(active, planned, WORK, ticks),
        }
    }

    /// Begins to run once enough is known and planned, or gives up.
    pub(super) fn fill(&mut self) {
        let patient = self.waited < FILL_PATIENCE;
        let Memory { ahead, trail } = self.memory.borrow();
        if ahead.is_empty() {
            if self.complete && !self.closed {
                self.state = State::Running;
            } else if self.closed || !patient {
                self.line = 0;
                self.state = State::Idle;
            }
        } else if (self.complete || !ahead.has_room() || !patient) && (ahead.is_planned() || trail.is_behind()) {
            self.state = State::Running;
        }
    }
}
