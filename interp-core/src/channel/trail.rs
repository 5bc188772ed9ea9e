//! Where the path led: the motions begun since the last output, so that drives which go back can.
//!
//! Every motion begun is noted in a [history], 32 bytes of which it can be made again. Around the tool a **window** of
//! motions stands ready; it slides along the history as the tool goes back and forward again. Motions that come into it
//! are made again, one at a time and a step of a few thousand instructions a tick: a line takes two steps, an arc about
//! fifteen. Where the window ends the path is planned to stand, so a tool that comes there before the next motion is
//! ready brakes and waits, within all limits; it never runs beyond.
//!
//! The way back ends where something stands between two motions that can't be undone ([`BackEnd`]). Dwells and programmed
//! stops can: the path only stands there for a moment.

mod history;
pub(super) mod maker;
mod record;
#[cfg(test)]
mod tests;

use super::lookahead::Lookahead;
use crate::block::again::Outline;
use crate::block::{Motion, Speed};
use crate::drive::BackEnd;
use crate::governor::square;
use heapless::Deque;
use history::History;
use maker::Maker;
use record::Kept;

/// Motions that stand ready. Every one costs its size in RAM.
pub(super) const WINDOW: usize = 12;

/// How many of them are wanted where the tool goes to, and how many at least where it comes from.
const TOWARD: usize = 8;
const FROM: usize = 2;

/// A motion with its line of the program and its place in the ring.
#[derive(Clone, Debug)]
struct Trod {
    place: u32,
    line: u32,
    /// The path stands before it.
    apart: bool,
    motion: Motion,
}

/// The motions begun last.
// what each tick asks for stands before the motions
#[derive(Clone, Debug)]
#[repr(C)]
pub(super) struct Trail {
    /// How many motions of the window are newer than the one that the tool is in, or at whose end it is.
    behind: usize,
    /// The window does not reach to the motion begun last.
    short: bool,
    /// The path has stood since the last motion.
    apart: bool,
    /// Why the way back ends before the oldest motion kept.
    end: BackEnd,
    window: Deque<Trod, WINDOW>,
    history: History,
}

impl Trail {
    /// Of no motion: all zero.
    pub(super) const fn new() -> Self {
        Self {
            behind: 0,
            short: false,
            apart: false,
            end: BackEnd::Start,
            window: Deque::new(),
            history: History::new(),
        }
    }

    /// Notes a motion that begins.
    pub(super) fn push(&mut self, line: u32, motion: &Motion) {
        // threads are not gone back into from elsewhere, nor left backward; a pass that begins here is a thread of its own
        let thread = motion.feed.is_thread();
        if self.window.back().is_some_and(|last| last.motion.feed.is_thread() != thread || thread && self.apart) {
            self.clear(BackEnd::Thread);
        }
        let apart = core::mem::take(&mut self.apart);
        let (place, full) = self.history.push(&Kept { line, apart, outline: Outline::of(motion) });
        if full {
            self.end = BackEnd::Full;
        }
        if self.window.is_full() {
            let _ = self.window.pop_front();
        }
        // there is room now
        let _ = self.window.push_back(Trod { place, line, apart, motion: *motion });
        self.behind = 0;
    }

    /// The path stands here, and what it stands for can be passed on the way back.
    pub(super) const fn stand(&mut self) {
        self.apart = true;
    }

    /// Whether the path stands between the motion begun last and the one to come.
    pub(super) const fn stands_behind(&self) -> bool {
        self.apart
    }

    /// Forgets all: the way back ends here.
    pub(super) fn clear(&mut self, end: BackEnd) {
        self.history.clear();
        self.window.clear();
        (self.behind, self.short, self.apart) = (0, false, false);
        self.end = end;
    }

    /// Whether the tool is back in an earlier motion, or at its end.
    #[inline]
    pub(super) const fn is_behind(&self) -> bool {
        self.behind > 0 || self.short
    }

    /// The motion begun last; `None` where there is none, and where the tool is so far back that it is not at hand.
    pub(super) fn newest(&self) -> Option<&Motion> {
        self.window.back().filter(|_| !self.short).map(|last| &last.motion)
    }

    /// The line of the motion begun last, where there is one.
    pub(super) fn line(&self) -> u32 {
        self.history.line()
    }

    /// The motion so many before the newest of the window.
    fn before_newest(&self, behind: usize) -> Option<&Trod> {
        let index = self.window.len().checked_sub(behind.checked_add(1)?)?;
        self.window.get(index)
    }

    /// The motion that the tool is in, or at whose end it is; with its line.
    pub(super) fn here(&self) -> Option<(u32, &Motion)> {
        self.before_newest(self.behind).map(|trod| (trod.line, &trod.motion))
    }

    /// Whether the path stands before the motion that the tool is in.
    pub(super) fn stands_before(&self) -> bool {
        self.before_newest(self.behind).is_some_and(|trod| trod.apart)
    }

    /// The motion before, where it is ready.
    pub(super) fn previous(&self) -> Option<&Motion> {
        self.before_newest(self.behind.checked_add(1)?).map(|trod| &trod.motion)
    }

    /// The motion after, where it was begun before and is ready.
    pub(super) fn next(&self) -> Option<&Motion> {
        self.before_newest(self.behind.checked_sub(1)?).map(|trod| &trod.motion)
    }

    /// The motions before the one that the tool is in, the nearest first, as far as they are ready: there the path stands.
    pub(super) fn earlier(&self) -> impl Iterator<Item = &Motion> {
        self.window.iter().rev().skip(self.behind.saturating_add(1)).map(|trod| &trod.motion)
    }

    /// The motions behind the one that the tool is in that were begun before, the nearest first, as far as they are ready.
    pub(super) fn later(&self) -> impl Iterator<Item = &Motion> {
        self.window.iter().skip(self.window.len().saturating_sub(self.behind)).map(|trod| &trod.motion)
    }

    /// Whether all motions that were begun before lie behind the tool's up to the look-ahead's: else the path stands before it.
    pub(super) const fn is_whole(&self) -> bool {
        !self.short
    }

    /// The speed at which the path may leave the motions at hand in a sense, where there is more behind them that was begun before
    /// and is not made yet.
    pub(super) fn leaves(&self, back: bool) -> Option<Speed> {
        if back {
            let oldest = self.window.front()?;
            self.history.before(oldest.place).map(|_| oldest.motion.start)
        } else {
            self.window.back().filter(|_| self.short).map(|newest| newest.motion.stop)
        }
    }

    /// Goes to the motion before. False where there is none, or it is not ready.
    pub(super) fn go_back(&mut self) -> bool {
        let goes = self.previous().is_some();
        if goes {
            self.behind = self.behind.wrapping_add(1);
        }
        goes
    }

    /// Goes to the motion after, where it was begun before and is ready.
    pub(super) const fn go_on(&mut self) -> bool {
        let goes = self.behind > 0;
        if goes {
            self.behind = self.behind.wrapping_sub(1);
        }
        goes
    }

    /// Whether the tool may run on from its motion into the next; `None` where that is the look-ahead's first one and
    /// nothing stands between. With `rest` the newest is begun from standstill.
    pub(super) fn runs_on(&self, rest: bool) -> Option<bool> {
        if self.is_behind() {
            let next = self.behind.checked_sub(1).and_then(|behind| self.before_newest(behind));
            return Some(next.is_some_and(|next| !next.apart && !self.is_rest(next, rest)));
        }
        self.apart.then_some(false)
    }

    /// Whether a motion is the newest, and that is begun from standstill.
    fn is_rest(&self, trod: &Trod, rest: bool) -> bool {
        rest && trod.place == self.history.newest()
    }

    /// Why the way back ends at the start of the motion that the tool is in; `None` where it does not, or only until the one
    /// before is ready.
    pub(super) fn end(&self) -> Option<BackEnd> {
        let Some(here) = self.before_newest(self.behind) else { return Some(self.end) };
        if self.previous().is_some() {
            return None;
        }
        match self.history.before(here.place) {
            None => Some(self.end),
            Some(before) if !self.history.can_be_made(before) || self.is_held() => Some(BackEnd::Curve),
            Some(_) => None,
        }
    }

    /// Whether the window can't slide back, as its newest motion could not be made again.
    fn is_held(&self) -> bool {
        self.window.is_full() && self.window.back().is_some_and(|last| !self.history.can_be_made(last.place))
    }

    /// Squared speed at which the present motion has to end going forward; with `rest` the newest is begun from standstill.
    #[inline]
    pub(super) fn exit<const N: usize>(&self, ahead: &Lookahead<N>, motion: &Motion, rest: bool) -> u64 {
        if !self.is_behind() && !self.apart {
            return ahead.exit(motion);
        }
        self.exit_behind(ahead, motion, rest)
    }

    /// The same where the tool is in an earlier motion, or the path stands behind the newest.
    // apart from the usual case, which every tick has
    #[inline(never)]
    fn exit_behind<const N: usize>(&self, ahead: &Lookahead<N>, motion: &Motion, rest: bool) -> u64 {
        let Some(newest) = self.before_newest(0) else { return ahead.exit(motion) };
        let runs_on = !self.short && !self.apart;
        let mut exit = if runs_on { ahead.exit(&newest.motion) } else { square(newest.motion.stop) };
        for behind in 0..self.behind {
            let Some(later) = self.before_newest(behind) else { break };
            let Some(earlier) = self.before_newest(behind.wrapping_add(1)) else { break };
            exit = if later.apart || self.is_rest(later, rest) {
                square(earlier.motion.stop)
            } else {
                later.motion.reachable(later.motion.length, exit).min(joint(&earlier.motion, &later.motion))
            };
        }
        exit
    }

    /// Squared speed at which the present motion has to be left at its start going back.
    pub(super) fn exit_back(&self) -> u64 {
        let Some(oldest) = self.window.front() else { return 0 };
        let mut exit = square(oldest.motion.start);
        let mut index = 1_usize;
        while let (Some(earlier), Some(later)) = (self.window.get(index.wrapping_sub(1)), self.window.get(index)) {
            if index.wrapping_add(self.behind) >= self.window.len() {
                break;
            }
            exit = if later.apart {
                square(later.motion.start)
            } else {
                earlier.motion.reachable(earlier.motion.length, exit).min(joint(&earlier.motion, &later.motion))
            };
            index = index.wrapping_add(1);
        }
        exit
    }

    /// A tick's step toward a window that reaches far enough both ways, first where the tool goes to.
    pub(super) fn slide(&mut self, back: bool, maker: &mut Maker) {
        if self.history.is_within(self.window.len()) {
            return;
        }
        let Some(place) = self.wanted(back) else { return };
        if let Some(trod) = maker.step(place, &self.history) {
            self.insert(trod);
        }
    }

    /// The place of the motion that is to be made next.
    fn wanted(&self, back: bool) -> Option<u32> {
        let (front, last) = (self.window.front()?, self.window.back()?);
        let (older, newer) = (self.window.len().saturating_sub(self.behind.wrapping_add(1)), self.behind);
        let (most_older, most_newer) = if back { (TOWARD, FROM) } else { (FROM, TOWARD) };
        let before =
            || self.history.before(front.place).filter(|place| self.history.can_be_made(*place) && !self.is_held());
        let after = || self.history.after(last.place);
        let older = || if older < most_older { before() } else { None };
        let newer = || if self.short && newer < most_newer { after() } else { None };
        if back { older().or_else(newer) } else { newer().or_else(older) }
    }

    /// Puts a motion at the window's end; where it is full the farthest one on the other side makes room.
    fn insert(&mut self, trod: Trod) {
        let older = self.window.front().is_some_and(|front| self.history.before(front.place) == Some(trod.place));
        let newer = self.window.back().is_some_and(|last| self.history.after(last.place) == Some(trod.place));
        if older {
            if self.window.is_full() {
                let _ = self.window.pop_back();
                self.behind = self.behind.saturating_sub(1);
                self.short = true;
            }
            let _ = self.window.push_front(trod);
        } else if newer {
            if self.window.is_full() {
                let _ = self.window.pop_front();
            }
            self.short = trod.place != self.history.newest();
            let _ = self.window.push_back(trod);
            self.behind = self.behind.wrapping_add(1);
        }
    }
}

/// Largest squared speed over the joint of two motions.
fn joint(earlier: &Motion, later: &Motion) -> u64 {
    square(later.joint.min(earlier.top()).min(later.top()))
}
