//! A part of an ellipse or a parabola inside one octant, with a timeline of its own.
//!
//! The part walks the very same conic as the whole, so the parts of a [`Conic`](super::conic::Conic) together make the
//! steps that it makes. Along an ellipse the coordinate is no elementary function of the length, so the timeline is a
//! cubic: place and slope of the major coordinate are exact at both ends (Hermite), and the part is so short that the
//! cubic is within a 24th of a pulse between them.

use super::arc::{Arc, MAX_PIECES, Timeline};
use super::arc_walker::ArcWalker;
use super::method::Method;
use super::proportion::Proportion;
use crate::units::{Axis, Sense};

/// A part of a conic.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct ConicPiece {
    /// `F = a x^2 + b z^2 - c x - d z`, coordinates from the whole conic's start.
    pub(crate) conic: [i64; 4],
    /// Its centre, X and Z, pulses with 16 fraction bits.
    pub(crate) centre: [i64; 2],
    /// Where the part begins, pulses from the conic's start.
    pub(crate) from: (i32, i32),
    /// Where it ends, pulses from `from`.
    pub(crate) end: (i32, i32),
    /// Steps of the major axis behind the joint.
    pub(crate) steps: u32,
    /// The way from the octant before to the first point of this one.
    pub(crate) joint: (i8, i8),
    pub(crate) octant: u8,
    pub(crate) sense: Sense,
    /// The major coordinate in the direction of travel, from `from`, pulses with 16 fraction bits: coefficients of the
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
        self.end
    }

    /// A walker at the part's start.
    pub fn walk(&self) -> ArcWalker {
        self.arc().walk_from(self.from)
    }

    /// A walker at the part's end.
    pub fn walk_from_end(&self) -> ArcWalker {
        self.arc().walk_back_to(self.from)
    }

    fn arc(&self) -> Arc {
        let [a, b, c, d] = self.conic;
        let (mut steps, mut joints) = ([0; MAX_PIECES], [(0, 0); MAX_PIECES - 1]);
        // a joint leads from an octant to the next, here from one without steps
        let [first, second, ..] = &mut steps;
        let (octant, pieces) = if self.joint == (0, 0) {
            *first = self.steps;
            (self.octant, 1)
        } else {
            let [joint, ..] = &mut joints;
            (*second, *joint) = (self.steps, self.joint);
            (Arc::octant_before(self.octant, self.sense), 2)
        };
        let timeline = Timeline { centre: self.centre, ..Timeline::default() };
        let (sense, method, end) = (self.sense, Method::MinimumDeviation, self.end);
        Arc { a, b, c, d, steps, joints, octant, pieces, sense, method, timeline, end }
    }

    /// The major coordinate `length` along the part.
    pub(crate) fn coordinate(&self, length: u64) -> i64 {
        let part = self.share.of(length).min(1 << 30).cast_signed();
        let [first, second, third, fourth] = self.cubic;
        let times = |value: i64| value.wrapping_mul(part) >> 30;
        first.wrapping_add(times(second.wrapping_add(times(third.wrapping_add(times(fourth))))))
    }

    /// The coordinate of the first point behind the joint, from `from` in the direction of travel.
    pub(crate) fn target(&self) -> i64 {
        let (x, z) = Arc::signs(self.octant, self.sense);
        let lines = match Arc::major(self.octant) {
            Axis::X => i64::from(self.joint.0).wrapping_mul(i64::from(x)),
            Axis::Z => i64::from(self.joint.1).wrapping_mul(i64::from(z)),
        };
        lines << 16
    }

    /// Steps of the joint.
    pub(crate) fn gap(&self) -> u32 {
        u32::from(self.joint.0.unsigned_abs().max(self.joint.1.unsigned_abs()))
    }
}
