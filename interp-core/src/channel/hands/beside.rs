//! Hands beside a path: what the path takes of an axis's speed, and what the hands leave of the path's.
//!
//! A hand beside a path brakes with its own share of the acceleration only, and a path that turns may ask for more of an axis than
//! the hand can give back in a tick. So both look at the **way** that the path may go until the hands could stand, and at the
//! largest part `E` of the path's speed `v` that each axis has anywhere on it. With the axis's largest speed S:
//!
//! ```text
//! its hand h:         at most   S - v E - a      a: what the path may gain in a tick
//! the path gains to:  at most   (S - h - b) / E  b: what the hand may gain in a tick
//! ```
//!
//! Where a motion with a larger part comes into the way, the hand begins to brake, and has done so when the path is there; meanwhile
//! the path gains nothing, since the part counts for it, too. So `v E + h` stays within S.
//!
//! A line's part is its own. An arc's is bounded by the angle to where it runs along the other axis. No axis has more than what keeps
//! it within its largest speed at the motion's own. What is not known counts as all of the path's speed.

use super::super::lookahead::as_motion;
use super::super::swath::{Groups, Parts};
use super::super::{Channel, Current, Memory, State};
use super::{ALL, AxisHand, Hands};
use crate::block::{Block, Curve, Motion, Speed};
use crate::config::FRACTION_BITS;
use crate::curve::PART_BITS;
use crate::drive::follower::Bounds;
use crate::drive::{Drive, ThreadStage};
use crate::math::to_u32;
use core::borrow::BorrowMut;

/// Blocks that are looked at behind the present motion: a tick has no time for more.
const BLOCKS: usize = 24;

/// Ticks that are added to those in which the hands come to a stand: the one that comes, and what division cuts off.
const TICKS: u32 = 3;

/// All of the path's speed.
const WHOLE: u32 = 1 << PART_BITS;

/// What is not known.
const UNKNOWN: Parts = Parts { x: WHOLE, z: WHOLE, limit: Speed::MAX };

/// A path that may move in the tick to come.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) struct Path {
    parts: Parts,
    /// More than its speed, but for what the hands allow it to gain.
    speed: Speed,
    /// Speed of X on its way out of a thread, or back: nm a tick, 12 fraction bits.
    retract: Speed,
}

impl Path {
    fn takes(&self, part: u32) -> Speed {
        let taken = u64::from(self.speed).wrapping_mul(part.into()).wrapping_add(u64::from(WHOLE - 1));
        to_u32(taken >> PART_BITS)
    }
}

impl AxisHand {
    /// What it may do in a tick, beside a path that takes so much of its speed; `None` where that stands.
    fn bounds(&self, taken: Option<Speed>) -> Bounds {
        let (speed, accel) = match taken {
            None => (self.speed, self.accel.saturating_add(self.by_hand)),
            Some(taken) => (self.speed.saturating_sub(taken).saturating_sub(self.accel), self.by_hand),
        };
        Bounds { speed: speed.min(self.pace), accel: accel.max(1) }
    }

    /// The speed of a path that it leaves room for, where its axis has such a part of it.
    fn leaves(&self, part: u32) -> Speed {
        let taken = self.hand.advance().unsigned_abs().saturating_add(self.by_hand.into());
        let left = u64::from(self.speed).saturating_sub(taken) << PART_BITS;
        to_u32(left.checked_div(part.into()).unwrap_or(ALL.into()))
    }

    /// Ticks in which it comes to a stand, at most 2^16.
    fn ticks(&self) -> u32 {
        let advance = to_u32(self.hand.advance().unsigned_abs());
        advance.checked_div(self.share()).unwrap_or(0).min(1 << 16)
    }

    /// Its part of a motion that leads the axis so many pulses far.
    fn part(&self, pulses: i32, motion: &Motion) -> u32 {
        let nm = u64::from(pulses.unsigned_abs()).wrapping_mul(self.pulse.numerator().into());
        // 2^32 nm at most, with 12 bits of both
        ratio(nm.wrapping_shl(FRACTION_BITS), motion.length.wrapping_mul(self.pulse.denominator().into()))
    }
}

impl Hands {
    /// What X and Z may do beside a path, or by themselves.
    pub(super) fn bounds(&self, path: Option<Path>) -> (Bounds, Bounds) {
        let x = path.map(|path| path.takes(path.parts.x).saturating_add(path.retract));
        (self.x.bounds(x), self.z.bounds(path.map(|path| path.takes(path.parts.z))))
    }

    /// The speed of the path that they leave room for.
    pub(super) fn leave(&self, path: Path) -> Speed {
        self.x.leaves(path.parts.x).min(self.z.leaves(path.parts.z))
    }

    /// The parts that X and Z have of a block.
    pub(in super::super) fn parts_of(&self, block: &Block) -> Parts {
        as_motion(block).map_or(Parts::NONE, |motion| self.parts(motion, 0, motion.length))
    }

    /// The parts that X and Z have of a motion between two lengths along it.
    fn parts(&self, motion: &Motion, from: u64, until: u64) -> Parts {
        let straight = |(x, z): (i32, i32)| (self.x.part(x, motion), self.z.part(z, motion));
        // the motion's limit was found so that neither axis passes its own
        let within = |axis: &AxisHand, part: u32| part.min(ratio(axis.speed.into(), motion.limit.into()));
        let bent = |(x, z): (u32, u32)| (within(&self.x, x), within(&self.z, z));
        let (x, z) = match &motion.curve {
            Curve::Line(line, _) => straight(line.end()),
            Curve::Arc(arc) => bent(arc.parts(from, until)),
            #[cfg(feature = "methods")]
            Curve::ClassicLine(line, ..) => straight(line.end()),
            #[cfg(feature = "methods")]
            Curve::Conic(_) => bent((WHOLE, WHOLE)),
        };
        Parts { x, z, limit: motion.limit }
    }
}

impl<const N: usize, M: BorrowMut<Memory<N>>> Channel<N, M> {
    /// The path as it may move in the tick to come, X out of a thread or not; `None` where it stands.
    pub(super) fn path(&self, retracts: bool) -> Option<Path> {
        let thread = &self.crank.thread;
        let runs = matches!(self.state, State::Running | State::Filling);
        if self.speed == 0 && !runs && !retracts {
            return None;
        }
        // only time and the wheel leave the hands the way that they need
        let (time, wheel) = (!self.crank.turns, matches!(self.crank.drive, Drive::Wheel(_)));
        let yields = !self.crank.in_thread && (time || wheel);
        let most = self.speed.max(self.window.longest());
        let mut fastest = most;
        if let (Current::Motion(active), false) = (&self.current, yields) {
            fastest = most.max(active.motion.limit);
        }
        let ticks = self.hands.x.ticks().max(self.hands.z.ticks()).wrapping_add(TICKS);
        // below 2^33 2^17, and what a window holds
        let way = u64::from(fastest).wrapping_add(self.hands.accel().into()).wrapping_mul(ticks.into());
        let parts = self.parts_on(way.wrapping_add(self.window.owed()));
        Some(Path { parts, speed: if yields { most } else { most.max(parts.limit) }, retract: thread.speed() })
    }

    /// The parts that X and Z have on so much of the way.
    fn parts_on(&self, way: u64) -> Parts {
        let (mut left, mut parts) = (way, Parts::NONE);
        let Memory { ahead, trail } = self.memory.borrow();
        let back = self.crank.back || matches!(self.crank.thread.stage(), ThreadStage::Returning);
        if let Current::Motion(active) = &self.current {
            let (done, room) = (active.done, self.room(back));
            let from = if back { done.saturating_sub(way) } else { done };
            parts = self.hands.parts(&active.motion, from, if back { done } else { done.wrapping_add(way) });
            if left <= room {
                return parts;
            }
            left = left.wrapping_sub(room);
        }
        if back || trail.is_behind() {
            return UNKNOWN;
        }
        let mut index = 0_usize;
        while let Some((block, swath)) = ahead.swath(index) {
            if index >= BLOCKS {
                return UNKNOWN;
            }
            if let Some(group) = ahead.group(index).filter(|group| group.length < left) {
                parts = parts.and(group.parts);
                left = left.wrapping_sub(group.length);
                index = index.wrapping_add(Groups::<N>::SIZE);
                continue;
            }
            // what is no motion may be over at once
            if let Some(motion) = as_motion(block) {
                if motion.feed.is_thread() != self.crank.in_thread {
                    // it stands there
                    return parts;
                }
                if left <= motion.length {
                    // only a part of it counts
                    return parts.and(match motion.curve {
                        Curve::Arc(_) => self.hands.parts(motion, 0, left),
                        _ => swath.parts,
                    });
                }
                parts = parts.and(swath.parts);
                left = left.wrapping_sub(motion.length);
            }
            index = index.wrapping_add(1);
        }
        if self.complete { parts } else { UNKNOWN }
    }
}

/// A part of a whole, [`PART_BITS`] fraction bits, rounded up, at most [`WHOLE`]. One division of words tells it, to 15 bits.
fn ratio(part: u64, whole: u64) -> u32 {
    if part == 0 {
        return 0;
    }
    let cut = 64_u32.wrapping_sub(whole.leading_zeros()).saturating_sub(16);
    let (part, whole) = (part.wrapping_shr(cut).saturating_add(1), to_u32(whole.wrapping_shr(cut)));
    let part = to_u32(part.min((1 << 16) - 1));
    (part << PART_BITS).checked_div(whole).map_or(WHOLE, |ratio| ratio.saturating_add(1).min(WHOLE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_ratio_is_never_too_small_and_hardly_too_large(part: u64, whole: u64, cut in (0_u32..64, 0_u32..64)) {
            let (part, whole) = (part >> cut.0, (whole >> cut.1).max(1));
            let exact = (u128::from(part) << PART_BITS).div_ceil(u128::from(whole)).min(u128::from(WHOLE));
            let found = u128::from(ratio(part, whole));
            // a small whole is known to a unit
            let rough = 4 + (u128::from(WHOLE) / u128::from(whole.min(1 << 15)));
            prop_assert!(found >= exact && found <= exact + rough, "{found} {exact}");
            prop_assert_eq!(found == 0, part == 0);
        }
    }
}
