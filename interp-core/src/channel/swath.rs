//! What the blocks to come lead through: figures that the fence asks for in every tick near it, found once, when a block comes.
//!
//! The fence follows the path until it would stand, through dozens of blocks where they are short. So an eighth of the look-ahead at a
//! time has figures of its own, and what is passed as a whole is passed in one step.

use super::fence::{Span, end, plus, whole};
use super::lookahead::as_motion;
use crate::block::{Block, Motion, Speed};
use crate::units::Lattice;
use heapless::Deque;

/// The largest parts of the path's speed that X and Z have, [`PART_BITS`](crate::curve::PART_BITS) fraction bits, and the largest
/// speed of the motions.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) struct Parts {
    pub(super) x: u32,
    pub(super) z: u32,
    pub(super) limit: Speed,
}

impl Parts {
    /// Of no motion.
    pub(super) const NONE: Self = Self { x: 0, z: 0, limit: 0 };

    /// Of both.
    pub(super) fn and(self, other: Self) -> Self {
        Self { x: self.x.max(other.x), z: self.z.max(other.z), limit: self.limit.max(other.limit) }
    }
}

/// What a path leads through, from where it begins.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) struct Swath {
    /// Its places.
    pub(super) span: Span,
    /// Where it ends.
    pub(super) end: Lattice,
    /// Its length, nm with 12 fraction bits.
    pub(super) length: u64,
    /// What braking sheds of the squared speed from its start to its end.
    pub(super) sheds: u64,
    /// The axes' parts of it.
    pub(super) parts: Parts,
}

const HERE: Lattice = Lattice { x: 0, z: 0 };

impl Swath {
    const NONE: Self = Self { span: Span::at(HERE), end: HERE, length: 0, sheds: 0, parts: Parts::NONE };

    /// Of a block; what is no motion is so long that nothing passes it as a whole.
    pub(super) fn of(block: &Block, parts: Parts) -> Self {
        match as_motion(block) {
            Some(motion) => Self {
                span: whole(HERE, motion),
                end: end(motion),
                length: motion.length,
                sheds: motion.length.saturating_mul(shed(motion)),
                parts,
            },
            None => Self { length: u64::MAX, sheds: u64::MAX, ..Self::NONE },
        }
    }

    /// The same and what follows.
    fn and(&self, next: &Self) -> Self {
        Self {
            span: self.span.and(next.span.moved(self.end)),
            end: plus(self.end, next.end),
            length: self.length.saturating_add(next.length),
            sheds: self.sheds.saturating_add(next.sheds),
            parts: self.parts.and(next.parts),
        }
    }
}

/// What braking sheds of the squared speed for each unit of length.
pub(super) fn shed(motion: &Motion) -> u64 {
    motion.brakes().saturating_mul(2).max(1)
}

/// Groups that a look-ahead has at most.
const GROUPS: usize = 9;

/// Groups of blocks, of a look-ahead of `N`.
#[derive(Clone, Debug)]
pub(super) struct Groups<const N: usize> {
    /// Blocks before the first whole group.
    first: usize,
    whole: Deque<Swath, GROUPS>,
    /// The group that the next block belongs to, and its blocks so far.
    open: Swath,
    filled: usize,
}

impl<const N: usize> Groups<N> {
    /// Blocks of a group.
    pub(super) const SIZE: usize = N.div_ceil(GROUPS - 1);

    /// Of no block: all zero.
    pub(super) const fn new() -> Self {
        Self { first: 0, whole: Deque::new(), open: Swath::NONE, filled: 0 }
    }

    /// A block comes.
    pub(super) fn push(&mut self, swath: &Swath) {
        self.open = self.open.and(swath);
        self.filled = self.filled.wrapping_add(1);
        if self.filled >= Self::SIZE {
            // of N blocks there are never more
            let _ = self.whole.push_back(self.open);
            (self.open, self.filled) = (Swath::NONE, 0);
        }
    }

    /// The nearest block is taken away: what is left of its group stands alone.
    pub(super) fn skip(&mut self) {
        if let Some(first) = self.first.checked_sub(1) {
            self.first = first;
        } else if self.whole.pop_front().is_some() {
            self.first = Self::SIZE.saturating_sub(1);
        } else {
            self.first = self.filled.saturating_sub(1);
            (self.open, self.filled) = (Swath::NONE, 0);
        }
    }

    /// The whole group that begins with a block, counted from the nearest.
    #[inline]
    pub(super) fn at(&self, block: usize) -> Option<&Swath> {
        let behind = block.checked_sub(self.first)?;
        if behind.is_multiple_of(Self::SIZE) { self.whole.get(behind.checked_div(Self::SIZE)?) } else { None }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use proptest::prelude::*;
    use std::collections::VecDeque;

    fn swath() -> impl Strategy<Value = Swath> {
        (-50_i32..50, -50_i32..50, 0_i32..20, 1_u64..100, 0_u64..1000).prop_map(|(x, z, more, length, sheds)| {
            let parts = Parts { x: x.unsigned_abs(), z: z.unsigned_abs(), limit: more.unsigned_abs() };
            let end = Lattice { x, z };
            let least = Lattice { x: x.min(0) - more, z: z.min(0) };
            let most = Lattice { x: x.max(0), z: z.max(0) + more };
            Swath { span: Span { least, most }, end, length, sheds, parts }
        })
    }

    proptest! {
        /// Whatever comes and goes: a group is the sum of its blocks, and of eight and seven more there is a whole one.
        #[test]
        fn a_group_is_the_sum_of_its_blocks(come in prop::collection::vec((swath(), 0_usize..3), 1..200)) {
            let (mut groups, mut blocks) = (Groups::<64>::new(), VecDeque::new());
            for (swath, gone) in come {
                if blocks.len() < 64 {
                    groups.push(&swath);
                    blocks.push_back(swath);
                }
                for _ in 0..gone.min(blocks.len()) {
                    blocks.pop_front();
                    groups.skip();
                }
                let mut found = 0;
                for first in 0..blocks.len() {
                    let Some(group) = groups.at(first) else { continue };
                    let own: std::vec::Vec<_> = blocks.iter().skip(first).take(8).collect();
                    prop_assert_eq!(own.len(), 8);
                    prop_assert_eq!(group.length, own.iter().map(|swath| swath.length).sum::<u64>());
                    prop_assert_eq!(group.sheds, own.iter().map(|swath| swath.sheds).sum::<u64>());
                    let (mut x, mut least, mut most) = (0, i32::MAX, i32::MIN);
                    for swath in own {
                        (least, most) = (least.min(x + swath.span.least.x), most.max(x + swath.span.most.x));
                        x += swath.end.x;
                    }
                    prop_assert_eq!((group.end.x, group.span.least.x, group.span.most.x), (x, least.min(0), most.max(0)));
                    found += 1;
                }
                prop_assert!(found >= (blocks.len().saturating_sub(14)) / 8, "{} of {}", found, blocks.len());
            }
        }
    }
}
