//! A part of an ellipse or a parabola with a timeline.
//!
//! Along an ellipse the coordinate is no elementary function of the length, so the timeline is a cubic: place and slope of
//! the major coordinate are exact at both ends (Hermite), and the part is so short that the cubic is within a 24th of a
//! pulse between them.

use super::arc::Arc;
use super::arc_walker::ArcWalker;
use super::conic_part::ConicPart;
use super::proportion::Proportion;
use crate::units::Axis;

/// A part of a conic that can be run.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct ConicPiece {
    pub(crate) part: ConicPart,
    /// The major coordinate in the direction of travel, from the part's start, pulses with 16 fraction bits: coefficients of the
    /// powers of the part of the length covered.
    pub(crate) cubic: [i64; 4],
    /// From a length to the part of the whole that it is, 30 fraction bits.
    pub(crate) share: Proportion,
    /// Least radius of curvature, nm with 12 fraction bits.
    pub(crate) radius: u64,
    /// From a length to the angle that it turns on that radius, 30 fraction bits.
    pub(crate) angle: Proportion,
}

impl ConicPiece {
    /// The end, X then Z, pulses from the part's start.
    pub const fn end(&self) -> (i32, i32) {
        self.part.end
    }

    /// A walker at the part's start.
    pub fn walk(&self) -> ArcWalker {
        self.part.walk()
    }

    /// A walker at the part's end.
    pub fn walk_from_end(&self) -> ArcWalker {
        self.part.walk_from_end()
    }

    /// Steps of the major axis behind the joint.
    pub(crate) const fn steps(&self) -> u32 {
        self.part.steps
    }

    /// The major coordinate `length` along the part.
    pub(crate) fn coordinate(&self, length: u64) -> i64 {
        let part = self.share.of(length).min(1 << 30).cast_signed();
        let [first, second, third, fourth] = self.cubic;
        let times = |value: i64| value.wrapping_mul(part) >> 30;
        first.wrapping_add(times(second.wrapping_add(times(third.wrapping_add(times(fourth))))))
    }

    /// The coordinate of the first point behind the joint, from the part's start in the direction of travel.
    pub(crate) fn target(&self) -> i64 {
        let (x, z) = Arc::signs(self.part.octant, self.part.sense);
        let lines = match Arc::major(self.part.octant) {
            Axis::X => i64::from(self.part.joint.0).wrapping_mul(i64::from(x)),
            Axis::Z => i64::from(self.part.joint.1).wrapping_mul(i64::from(z)),
        };
        lines << 16
    }

    /// Steps of the joint.
    pub(crate) fn gap(&self) -> u32 {
        u32::from(self.part.joint.0.unsigned_abs().max(self.part.joint.1.unsigned_abs()))
    }
}
