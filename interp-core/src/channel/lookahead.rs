//! Look-ahead: the blocks to come and the speed at which each may be entered.
//!
//! Going from the last block known to the first, a block may be entered at the speed from which the next one's entry
//! can still be met, at most at its joint's speed and at the feeds on both sides. The last block known is planned to
//! end in standstill, so that a program that stops arriving stops the tool and breaks nothing.
//!
//! Braking as hard as allowed from any planned state meets every joint; a change of the override therefore needs no
//! more than a new pass, and a feed that is suddenly too high is approached gradually.
//!
//! A pass over all blocks takes longer than a tick has; it is a sweep of some blocks a tick.

pub(super) mod smooth;
pub(super) mod sweep;

use super::margins::Margins;
use super::swath::{Groups, Parts, Swath};
use crate::block::{Block, Feed, Motion, Speed, Work};
use crate::governor::{UNLIMITED, square};
use crate::math::percent;
use heapless::Deque;
use sweep::{LINEAR, Pass, Sweep};

/// A block to come.
#[derive(Copy, Clone, Debug)]
struct Planned {
    block: Block,
    /// Squared speed at which it is to be entered; [`NOT_YET`] planned.
    entry: u64,
    /// Under an S law: margins before its start.
    margins: Margins,
    /// Under an S law: it is begun from standstill, whatever is before it.
    stands: bool,
    /// Turning takes a part of the acceleration.
    bent: bool,
    swath: Swath,
}

/// The entry of a block that no sweep has come to. Whatever leads up to it ends as if it were not there.
const NOT_YET: u64 = u64::MAX;

impl Planned {
    const fn is_planned(&self) -> bool {
        self.entry != NOT_YET
    }

    /// The largest squared speed, `room` before the end of its `motion`, from which `exit` can be met.
    #[inline]
    fn reachable(&self, motion: &Motion, room: u64, exit: u64) -> u64 {
        if room == motion.length && !self.bent {
            // what braking sheds on the whole of it is known
            exit.saturating_add(self.swath.sheds).min(UNLIMITED)
        } else {
            motion.reachable(room, exit)
        }
    }

    /// The same, at most `most`.
    fn reachable_up_to(&self, most: u64, motion: &Motion, room: u64, exit: u64) -> u64 {
        if self.bent && motion.plainly_reaches(room, exit, most) {
            most
        } else {
            self.reachable(motion, room, exit).min(most)
        }
    }
}

/// The blocks to come, at most `N`.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Lookahead<const N: usize> {
    /// Planned with.
    overrides: Overrides,
    sweep: Sweep,
    groups: Groups<N>,
    blocks: Deque<Planned, N>,
}

/// What the operator makes of the program's speeds, percent.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Overrides {
    /// Of feeds, 0 to 200.
    pub feed: u16,
    /// Of rapids, 0 to 100.
    pub rapid: u16,
}

impl Overrides {
    /// As programmed.
    pub const NONE: Self = Self { feed: 100, rapid: 100 };

    /// No feed at all but the limits: for drives that have a feed of their own.
    pub const AT_LIMIT: Self = Self { feed: u16::MAX, rapid: 100 };
}

/// Speed of a motion under overrides; that of one that follows the spindle is not known, and planned with its limit.
pub fn pace(motion: &Motion, overrides: Overrides) -> Speed {
    let top = motion.top();
    match motion.feed {
        Feed::PerTurn(_) | Feed::Thread(..) => top,
        Feed::Rapid if overrides.rapid == 100 => top,
        Feed::Rapid => percent(motion.limit, overrides.rapid).min(top),
        Feed::PerTick(_) if overrides.feed == Overrides::AT_LIMIT.feed => top,
        Feed::PerTick(feed) => percent(feed, overrides.feed).min(top),
    }
}

impl<const N: usize> Lookahead<N> {
    /// None known: all zero.
    pub const fn new() -> Self {
        Self {
            blocks: Deque::new(),
            sweep: Sweep::NONE,
            groups: Groups::new(),
            overrides: Overrides { feed: 0, rapid: 0 },
        }
    }

    /// Whether another block fits.
    pub fn has_room(&self) -> bool {
        !self.blocks.is_full()
    }

    /// How many blocks are known.
    pub fn len(&self) -> usize {
        self.blocks.len()
    }

    /// Whether none is known.
    pub fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// Adds a block with the axes' parts of it; it is planned by the next pass.
    pub(super) fn push(&mut self, block: Block, parts: Parts) {
        // the caller asked `has_room`; a full queue would show as a missing block, so it must not be full
        let swath = Swath::of(&block, parts);
        let bent = as_motion(&block).is_some_and(Motion::is_bent);
        let planned = Planned { block, entry: NOT_YET, margins: Margins::EMPTY, stands: false, bent, swath };
        if self.blocks.push_back(planned).is_ok() {
            self.groups.push(&swath);
        }
    }

    /// The next block, with the squared speed at which it may be entered.
    pub fn next(&self) -> Option<(&Block, u64)> {
        self.blocks.front().map(|next| (&next.block, if next.is_planned() { next.entry } else { 0 }))
    }

    /// The blocks, the nearest first.
    pub fn blocks(&self) -> impl Iterator<Item = &Block> {
        self.blocks.iter().map(|planned| &planned.block)
    }

    /// A block, counted from the nearest, with what it leads through.
    pub(super) fn swath(&self, index: usize) -> Option<(&Block, &Swath)> {
        self.blocks.get(index).map(|planned| (&planned.block, &planned.swath))
    }

    /// What the group of blocks leads through that begins with one, if one does.
    pub(super) fn group(&self, index: usize) -> Option<&Swath> {
        self.groups.at(index)
    }

    /// Sets the feed of all motions, but of threads.
    pub fn set_feed(&mut self, feed: Feed) {
        let mut law = false;
        for planned in &mut self.blocks {
            if let Work::Motion(motion) = &mut planned.block.work {
                let was = smooth::is_smoothed(motion);
                motion.set_feed(feed);
                law |= smooth::is_smoothed(motion) != was;
            }
        }
        self.sweep.again(law);
    }

    /// Takes the next block away.
    pub fn skip(&mut self) {
        if self.blocks.pop_front().is_some() {
            self.sweep.skip();
            self.groups.skip();
        }
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        self.blocks.clear();
        self.sweep = Sweep::NONE;
        self.groups = Groups::new();
    }

    /// The squared speed at which `motion`, the one being executed, has to end.
    pub fn exit(&self, motion: &Motion) -> u64 {
        match self.blocks.front() {
            Some(Planned { block: Block { work: Work::Motion(_), .. }, entry, .. }) if *entry != NOT_YET => *entry,
            _ => square(motion.stop),
        }
    }

    /// Whether the next block is a motion, so that the one being executed need not stop.
    pub fn continues(&self) -> bool {
        self.blocks.front().is_some_and(|next| as_motion(&next.block).is_some() && next.is_planned())
    }

    /// Plans the entry speeds anew as far as they change: a tick's part of it, so much `work`. `active` is the motion being
    /// executed.
    pub(super) fn plan(&mut self, active: Option<&Motion>, overrides: Overrides, work: u32) {
        let Some(mut pass) = self.set_out(overrides, work.saturating_mul(LINEAR)) else { return };
        let overrides = self.overrides;
        while let Some(here) = self.sweep.next(&mut pass) {
            let next = self.blocks.get(here.wrapping_add(1));
            let exit = next.filter(|next| as_motion(&next.block).is_some()).map(|next| next.entry);
            let before = match here.checked_sub(1) {
                Some(before) => self.blocks.get(before).and_then(|planned| as_motion(&planned.block)),
                None => active,
            };
            let before = before.map(|before| pace(before, overrides));
            let Some(planned) = self.blocks.get_mut(here) else { return };
            let Some(motion) = as_motion(&planned.block) else {
                planned.entry = 0;
                continue;
            };
            pass.costs(motion);
            let reachable = planned.reachable(motion, motion.length, exit.unwrap_or(square(motion.stop)));
            let entry = linear_entry(before, motion, reachable, overrides);
            if entry == planned.entry && self.sweep.knew(here) {
                self.sweep.finish();
                return;
            }
            planned.entry = entry;
        }
    }

    /// A tick's part of a sweep with these overrides, where one is under way or due.
    fn set_out(&mut self, overrides: Overrides, work: u32) -> Option<Pass> {
        let changed = overrides != self.overrides;
        // what is planned at its limits is planned by another law
        let law = changed && [overrides, self.overrides].iter().any(|those| those.feed == Overrides::AT_LIMIT.feed);
        let pass = self.sweep.set_out(self.blocks.len(), work, changed, law);
        if pass.is_some_and(|pass| pass.begins) {
            self.overrides = overrides;
        }
        pass
    }

    /// Whether all is planned, with these overrides: as in most ticks.
    #[inline]
    pub(super) fn is_planned_with(&self, overrides: Overrides) -> bool {
        overrides == self.overrides && self.is_planned()
    }

    /// Whether nothing may go on by what was planned, until it is planned anew.
    #[inline]
    pub(super) const fn is_urgent(&self) -> bool {
        self.sweep.is_urgent()
    }

    /// Whether all is planned.
    pub(super) const fn is_planned(&self) -> bool {
        self.sweep.is_over(self.blocks.len())
    }
}

impl<const N: usize> Default for Lookahead<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// Squared speed at which `motion`, behind one that is run at `before`, may be entered under the linear law where its exit can be
/// met from `reachable`.
fn linear_entry(before: Option<Speed>, motion: &Motion, reachable: u64, overrides: Overrides) -> u64 {
    let own = pace(motion, overrides);
    let most = match before {
        Some(before) => motion.joint.min(own).min(before),
        None => motion.start.min(own),
    };
    reachable.min(square(most))
}

/// The motion of a block that moves.
pub const fn as_motion(block: &Block) -> Option<&Motion> {
    match &block.work {
        Work::Motion(motion) => Some(motion),
        Work::Dwell(_) | Work::Output(_) | Work::Stop | Work::OptionalStop | Work::End => None,
    }
}
