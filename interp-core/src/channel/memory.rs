//! What takes room: the blocks to come, and the motions begun.

use super::lookahead::Lookahead;
use super::trail::Trail;
use crate::drive::BackEnd;

/// The blocks of a [channel](super::Channel): a look-ahead of `N`, and the way back. A channel has a memory of its own, or is
/// lent one: on a chip it lies among the statics, as it is too much to pass over the stack.
// the look-ahead's own figures stand at its front, the trail's likewise
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Memory<const N: usize> {
    pub(super) ahead: Lookahead<N>,
    pub(super) trail: Trail,
}

impl<const N: usize> Default for Memory<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Memory<N> {
    /// Of no block.
    // all of it is zero: where it is a static, flash holds none of it
    pub const fn new() -> Self {
        Self { ahead: Lookahead::new(), trail: Trail::new() }
    }

    /// Forgets all.
    pub(super) fn clear(&mut self) {
        self.ahead.clear();
        self.trail.clear(BackEnd::Start);
    }
}
