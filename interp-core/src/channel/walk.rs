//! Moves along the path by a given length in a tick, over joints: for drives whose advance is known from elsewhere.
//!
//! The governor decides an advance block by block, as each has limits of its own. A drive that follows something else (a
//! spindle, a wheel, a plan that runs ahead) knows only how far the path advances in the tick; here it is divided among
//! the blocks that it leads through, each with the part of the tick that its length has in the whole.

use super::runner::{Sink, share};
use super::{Active, Channel, Current};
use crate::block::Work;
use crate::config::TICK_CLOCKS;
use crate::times::Stretch;
use crate::train::Train;

impl<const N: usize> Channel<N> {
    /// Moves on by `by` (nm, 12 fraction bits) during the whole tick, evenly. Returns what is left of it where no motion
    /// follows: the path ends there, exactly.
    pub(super) fn walk(&mut self, by: u64, out: &mut impl Train) -> u64 {
        let (mut left, mut clock) = (by, 0_u32);
        while left > 0 {
            if matches!(self.current, Current::Nothing) && !self.begin_motion() {
                return left;
            }
            let Current::Motion(active) = &mut self.current else { return left };
            let mut sink = Sink { shaper: &mut self.shaper, position: &mut self.position, out };
            let budget = TICK_CLOCKS.wrapping_sub(clock);
            let room = active.motion.length.wrapping_sub(active.done);
            if left < room {
                active.done = active.done.wrapping_add(left);
                active.runner.advance(active.done, Stretch { from: clock, clocks: budget }, &mut sink);
                return 0;
            }
            let clocks = share(budget, room, left);
            active.runner.advance(active.motion.length, Stretch { from: clock, clocks }, &mut sink);
            clock = clock.wrapping_add(clocks);
            active.runner.finish(clock, &mut sink);
            self.current = Current::Nothing;
            left = left.wrapping_sub(room);
        }
        0
    }

    /// Begins the next block where it is a motion.
    fn begin_motion(&mut self) -> bool {
        let Some((block, _)) = self.ahead.next() else { return false };
        let Work::Motion(ref motion) = block.work else { return false };
        self.line = block.line;
        self.current = Current::Motion(Active::new(motion, self.feed_override));
        self.ahead.skip();
        true
    }
}
