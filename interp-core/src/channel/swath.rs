//! What each block to come leads through: figures that the fence asks for in every tick near it, found once.

use super::fence::{Span, end, whole};
use super::lookahead::as_motion;
use crate::block::{Block, Motion};
use crate::units::Lattice;

/// What a motion leads through, from where it begins; nothing where a block is none.
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
}

impl Swath {
    pub(super) fn of(block: &Block) -> Self {
        let here = Lattice { x: 0, z: 0 };
        match as_motion(block) {
            Some(motion) => Self {
                span: whole(here, motion),
                end: end(motion),
                length: motion.length,
                sheds: motion.length.saturating_mul(shed(motion)),
            },
            None => Self { span: Span::at(here), end: here, length: 0, sheds: 0 },
        }
    }
}

/// What braking sheds of the squared speed for each unit of length.
pub(super) fn shed(motion: &Motion) -> u64 {
    motion.brakes().saturating_mul(2).max(1)
}
