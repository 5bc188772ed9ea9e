//! What the path leads through before it could stand: for limits that it must not pass.

use super::{Active, Channel, Current, Memory, lookahead};
use crate::block::Motion;
use crate::units::Lattice;
use core::borrow::BorrowMut;

/// Moves from one lattice point to another.
const fn plus(at: Lattice, (x, z): (i32, i32)) -> Lattice {
    Lattice { x: at.x.wrapping_add(x), z: at.z.wrapping_add(z) }
}

/// Where a motion begins that ends at `end`.
const fn begin(end: Lattice, motion: &Motion) -> Lattice {
    let (x, z) = motion.curve.end();
    plus(end, (x.wrapping_neg(), z.wrapping_neg()))
}

/// The least and the greatest place of a motion that begins at `from`.
fn extent(from: Lattice, motion: &Motion) -> (Lattice, Lattice) {
    let (least, most) = motion.curve.extent();
    (plus(from, least), plus(from, most))
}

impl<const N: usize, M: BorrowMut<Memory<N>>> Channel<N, M> {
    /// Tells `see` of each motion that the path is in or comes to before it could stand, the way that it goes, the least and the
    /// greatest place, in the program's pulses: of the motion as a whole.
    pub fn extents(&self, mut see: impl FnMut(Lattice, Lattice)) {
        let mut tell = |from: Lattice, motion: &Motion| {
            let (least, most) = extent(from, motion);
            see(least, most);
        };
        let Memory { ahead, trail } = self.memory.borrow();
        let (back, far) = (self.crank.back, self.braking());
        let (mut begins, mut ends) = (self.position, self.position);
        if let Current::Motion(Active { from, motion, .. }) = &self.current {
            tell(*from, motion);
            (begins, ends) = (*from, plus(*from, motion.curve.end()));
        }
        let mut way = self.room(back);
        if back {
            for earlier in trail.earlier() {
                if way > far {
                    return;
                }
                begins = begin(begins, earlier);
                tell(begins, earlier);
                way = way.saturating_add(earlier.length);
            }
            return;
        }
        let ahead = ahead.blocks().take_while(|_| trail.is_whole()).map_while(lookahead::as_motion);
        for later in trail.later().chain(ahead) {
            if way > far {
                return;
            }
            tell(ends, later);
            ends = plus(ends, later.curve.end());
            way = way.saturating_add(later.length);
        }
    }
}
