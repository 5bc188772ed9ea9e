//! Where the path led: the motions begun last, so that drives which go back can.
//!
//! The newest stands last. Where the tool is back inside an earlier one, `behind` tells by how many. Only motions that
//! follow one another without anything between them are kept: what stands between two of them (a dwell, an output, a
//! stop) can't be undone, and there the way back ends.

use super::lookahead::Lookahead;
use crate::block::Motion;
use crate::governor::square;
use heapless::Deque;

/// Motions kept: the present one and eight before it. Every one costs its size in RAM.
const TRAIL: usize = 9;

/// A motion with its line of the program.
#[derive(Clone, Debug)]
struct Trod {
    line: u32,
    motion: Motion,
}

/// The motions begun last.
#[derive(Clone, Debug)]
pub(super) struct Trail {
    behind: usize,
    motions: Deque<Trod, TRAIL>,
}

impl Trail {
    pub(super) const fn new() -> Self {
        Self { motions: Deque::new(), behind: 0 }
    }

    /// Notes a motion that begins.
    pub(super) fn push(&mut self, line: u32, motion: &Motion) {
        // threads are not gone back into from elsewhere, nor left backward
        if self.motions.back().is_some_and(|last| last.motion.feed.is_thread() != motion.feed.is_thread()) {
            self.motions.clear();
        }
        if self.motions.is_full() {
            let _ = self.motions.pop_front();
        }
        // there is room now
        let _ = self.motions.push_back(Trod { line, motion: *motion });
        self.behind = 0;
    }

    /// Forgets all: the way back ends here.
    pub(super) fn clear(&mut self) {
        self.motions.clear();
        self.behind = 0;
    }

    /// Whether the tool is back in an earlier motion, or at its end.
    pub(super) const fn is_behind(&self) -> bool {
        self.behind > 0
    }

    /// The motion so many before the newest.
    fn before_newest(&self, behind: usize) -> Option<&Trod> {
        let index = self.motions.len().checked_sub(behind.checked_add(1)?)?;
        self.motions.get(index)
    }

    /// The motion that the tool is in, or at whose end it is; with its line.
    pub(super) fn here(&self) -> Option<(u32, &Motion)> {
        self.before_newest(self.behind).map(|trod| (trod.line, &trod.motion))
    }

    /// The motion before.
    pub(super) fn previous(&self) -> Option<&Motion> {
        self.before_newest(self.behind.checked_add(1)?).map(|trod| &trod.motion)
    }

    /// The motion after, where it was begun before.
    pub(super) fn next(&self) -> Option<&Motion> {
        self.before_newest(self.behind.checked_sub(1)?).map(|trod| &trod.motion)
    }

    /// The motions before the one that the tool is in, the nearest first.
    pub(super) fn earlier(&self) -> impl Iterator<Item = &Motion> {
        self.motions.iter().rev().skip(self.behind.saturating_add(1)).map(|trod| &trod.motion)
    }

    /// The motions behind the one that the tool is in that were begun before, the nearest first.
    pub(super) fn later(&self) -> impl Iterator<Item = &Motion> {
        self.motions.iter().skip(self.motions.len().saturating_sub(self.behind)).map(|trod| &trod.motion)
    }

    /// Goes to the motion before. False where there is none.
    pub(super) fn go_back(&mut self) -> bool {
        let goes = self.previous().is_some();
        if goes {
            self.behind = self.behind.wrapping_add(1);
        }
        goes
    }

    /// Goes to the motion after, where it was begun before.
    pub(super) const fn go_on(&mut self) -> bool {
        let goes = self.behind > 0;
        if goes {
            self.behind = self.behind.wrapping_sub(1);
        }
        goes
    }

    /// Squared speed at which the present motion has to end going forward.
    pub(super) fn exit<const N: usize>(&self, ahead: &Lookahead<N>, motion: &Motion) -> u64 {
        let Some(newest) = self.before_newest(0) else { return ahead.exit(motion) };
        let mut exit = ahead.exit(&newest.motion);
        for behind in 0..self.behind {
            let Some(Trod { motion: later, .. }) = self.before_newest(behind) else { break };
            let Some(Trod { motion: earlier, .. }) = self.before_newest(behind.wrapping_add(1)) else { break };
            exit = later.reachable(later.length, exit).min(joint(earlier, later));
        }
        exit
    }

    /// Squared speed at which the present motion has to be left at its start going back.
    pub(super) fn exit_back(&self) -> u64 {
        let Some(oldest) = self.motions.front() else { return 0 };
        let mut exit = square(oldest.motion.start);
        let mut index = 1_usize;
        while let (Some(earlier), Some(later)) = (self.motions.get(index.wrapping_sub(1)), self.motions.get(index)) {
            if index.wrapping_add(self.behind) >= self.motions.len() {
                break;
            }
            exit = earlier.motion.reachable(earlier.motion.length, exit).min(joint(&earlier.motion, &later.motion));
            index = index.wrapping_add(1);
        }
        exit
    }
}

/// Largest squared speed over the joint of two motions.
fn joint(earlier: &Motion, later: &Motion) -> u64 {
    square(later.joint.min(earlier.limit).min(later.limit))
}
