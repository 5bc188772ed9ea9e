//! Look-ahead: the blocks to come and the speed at which each may be entered.
//!
//! Going from the last block known to the first, a block may be entered at the speed from which the next one's entry
//! can still be met, at most at its joint's speed and at the feeds on both sides. The last block known is planned to
//! end in standstill, so that a program that stops arriving stops the tool and breaks nothing.
//!
//! Braking as hard as allowed from any planned state meets every joint; a change of the override therefore needs no
//! more than a new pass, and a feed that is suddenly too high is approached gradually.

pub(super) mod smooth;

use super::margins::Margins;
use crate::block::{Block, Feed, Motion, Speed, Work};
use crate::governor::square;
use heapless::Deque;

/// A block to come.
#[derive(Copy, Clone, Debug)]
struct Planned {
    block: Block,
    /// Squared speed at which it is to be entered.
    entry: u64,
    /// Under an S law: margins before its start.
    margins: Margins,
    /// Under an S law: it is begun from standstill, whatever is before it.
    stands: bool,
}

/// The blocks to come, at most `N`.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Lookahead<const N: usize> {
    /// How many at the back have not been planned.
    fresh: usize,
    /// Planned with.
    overrides: Overrides,
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
    let percent = |speed: Speed, percent: u16| {
        let scaled = u64::from(speed).wrapping_mul(u64::from(percent)) / 100;
        crate::math::to_u32(scaled).min(motion.limit)
    };
    match motion.feed {
        Feed::PerTurn(_) | Feed::Thread(..) => motion.limit,
        Feed::Rapid if overrides.rapid == 100 => motion.limit,
        Feed::Rapid => percent(motion.limit, overrides.rapid),
        Feed::PerTick(_) if overrides.feed == Overrides::AT_LIMIT.feed => motion.limit,
        Feed::PerTick(feed) => percent(feed, overrides.feed),
    }
}

impl<const N: usize> Lookahead<N> {
    /// None known: all zero.
    pub const fn new() -> Self {
        Self { blocks: Deque::new(), fresh: 0, overrides: Overrides { feed: 0, rapid: 0 } }
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

    /// Adds a block; it is planned by the next [`plan`](Self::plan).
    pub fn push(&mut self, block: Block) {
        // the caller asked `has_room`; a full queue would show as a missing block, so it must not be full
        if self.blocks.push_back(Planned { block, entry: 0, margins: Margins::EMPTY, stands: false }).is_ok() {
            self.fresh = self.fresh.wrapping_add(1);
        }
    }

    /// The next block, with the squared speed at which it may be entered.
    pub fn next(&self) -> Option<(&Block, u64)> {
        self.blocks.front().map(|next| (&next.block, next.entry))
    }

    /// The blocks, the nearest first.
    pub fn blocks(&self) -> impl Iterator<Item = &Block> {
        self.blocks.iter().map(|planned| &planned.block)
    }

    /// Sets the feed of all motions, but of threads.
    pub fn set_feed(&mut self, feed: Feed) {
        for planned in &mut self.blocks {
            if let Work::Motion(motion) = &mut planned.block.work {
                motion.set_feed(feed);
            }
        }
        self.fresh = self.blocks.len();
    }

    /// Takes the next block away.
    pub fn skip(&mut self) {
        let _ = self.blocks.pop_front();
        self.fresh = self.fresh.min(self.blocks.len());
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        self.blocks.clear();
        self.fresh = 0;
    }

    /// The squared speed at which `motion`, the one being executed, has to end.
    pub fn exit(&self, motion: &Motion) -> u64 {
        match self.blocks.front() {
            Some(Planned { block: Block { work: Work::Motion(_), .. }, entry, .. }) => *entry,
            _ => square(motion.stop),
        }
    }

    /// Whether the next block is a motion, so that the one being executed need not stop.
    pub fn continues(&self) -> bool {
        self.blocks.front().is_some_and(|next| as_motion(&next.block).is_some())
    }

    /// Plans the entry speeds anew as far as they change. `active` is the motion being executed.
    pub fn plan(&mut self, active: Option<&Motion>, overrides: Overrides) {
        let all = overrides != self.overrides;
        if !all && self.fresh == 0 {
            return;
        }
        self.overrides = overrides;
        let known = self.blocks.len().saturating_sub(if all { self.blocks.len() } else { self.fresh });
        self.fresh = 0;
        let mut exit: Option<u64> = None;
        let mut index = self.blocks.len();
        while let Some(here) = index.checked_sub(1) {
            index = here;
            let before = match here.checked_sub(1) {
                Some(i) => self.blocks.get(i).and_then(|p| as_motion(&p.block)).copied(),
                None => active.copied(),
            };
            let Some(planned) = self.blocks.get_mut(here) else { return };
            let Some(motion) = as_motion(&planned.block) else {
                exit = None;
                continue;
            };
            let entry = linear_entry(before.as_ref(), motion, exit.unwrap_or(square(motion.stop)), overrides);
            if entry == planned.entry && here < known {
                return;
            }
            planned.entry = entry;
            exit = Some(entry);
        }
    }
}

impl<const N: usize> Default for Lookahead<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// Squared speed at which `motion`, behind `before`, may be entered under the linear law so that its exit can be met.
fn linear_entry(before: Option<&Motion>, motion: &Motion, exit: u64, overrides: Overrides) -> u64 {
    let own = pace(motion, overrides);
    let most = match before {
        Some(before) => motion.joint.min(own).min(pace(before, overrides)),
        None => motion.start.min(own),
    };
    motion.reachable(motion.length, exit).min(square(most))
}

/// The motion of a block that moves.
pub const fn as_motion(block: &Block) -> Option<&Motion> {
    match &block.work {
        Work::Motion(motion) => Some(motion),
        Work::Dwell(_) | Work::Output(_) | Work::Stop | Work::OptionalStop | Work::End => None,
    }
}
