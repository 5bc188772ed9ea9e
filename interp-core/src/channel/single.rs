//! Single block: the path comes to a stand before each line of the program, and waits for cycle start.
//!
//! A line may make several blocks; they belong together. A stop needs its way: a motion that is too fast to stop at the end of
//! its line when single block is switched on goes on into the next.

use super::lookahead::Lookahead;
use super::{Channel, Current, Memory};
use core::borrow::BorrowMut;

/// Single block.
#[derive(Copy, Clone, Debug)]
pub(super) struct Single {
    on: bool,
    /// The line that cycle start has let pass, 0 for whatever comes first.
    passed: u32,
}

impl Single {
    pub(super) const fn new() -> Self {
        Self { on: false, passed: 0 }
    }

    #[inline]
    pub(super) const fn is_on(&self) -> bool {
        self.on
    }

    /// Lets the first line pass.
    pub(super) const fn pass_all(&mut self) {
        self.passed = 0;
    }

    /// Whether the path has to stand at the end of what belongs to `line`: the next block belongs to another one.
    #[inline]
    pub(super) fn stops<const N: usize>(&self, ahead: &Lookahead<N>, line: u32) -> bool {
        self.on && ahead.next().is_none_or(|(block, _)| block.line != line)
    }
}

impl<const N: usize, M: BorrowMut<Memory<N>>> Channel<N, M> {
    /// Switches single block on or off. It acts from the next line on.
    pub fn set_single_block(&mut self, on: bool) {
        if on && !self.single.on {
            self.single.passed = self.line;
            let (first, speed) = self.lead_brakes();
            self.memory.borrow_mut().ahead.stand_lines(self.line, first, speed);
        }
        self.single.on = on;
    }

    /// Whether single block is on.
    pub const fn single_block(&self) -> bool {
        self.single.on
    }

    /// Cycle start lets the next line pass, where the path stands before it. Where it stands in a line, after a hold, or has been
    /// led back, it goes on to the end of the line that was begun last.
    pub(super) fn pass_single(&mut self) {
        let Memory { ahead, trail } = self.memory.borrow();
        self.single.passed = match (ahead.next(), &self.current) {
            _ if trail.is_behind() => trail.line(),
            (Some((block, _)), Current::Nothing) => block.line,
            (None, Current::Nothing) => self.single.passed,
            (_, Current::Motion(_) | Current::Dwell(_)) => self.line,
        };
    }

    /// Whether the block that comes next waits for cycle start.
    pub(super) fn stops_single(&mut self) -> bool {
        let Some((block, _)) = self.memory.borrow().ahead.next() else { return false };
        let line = block.line;
        if self.single.passed == 0 {
            self.single.passed = line;
        }
        let ends = matches!(block.work, crate::block::Work::End);
        self.single.on && line != self.single.passed && !ends && !self.memory.borrow().trail.is_behind()
    }
}
