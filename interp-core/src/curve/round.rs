//! Where a point is that goes round an arc, as a function of the length: in both axes, from quarter to quarter.

use super::arc::Arc;
use super::proportion::Proportion;
use crate::math::{QUARTER_Q30, sine};
use crate::units::Axis;

/// A point that goes round an arc.
#[derive(Clone, Debug)]
pub(crate) struct Round {
    pub(crate) angle: Proportion,
    /// Angle of the start from an axis of the circle, 30 fraction bits.
    pub(crate) start: i64,
    /// The axis that travel moves along there, and the signs of its travel and of the other one's coordinate.
    pub(crate) axis: Axis,
    pub(crate) signs: (i8, i8),
    /// Radius in pulses of that axis and of the other, 16 fraction bits less `cut`, which fit 32 bits.
    pub(crate) radius: [i64; 2],
    pub(crate) cut: u32,
    /// Centre, X and Z, pulses from the start, 16 fraction bits.
    pub(crate) centre: [i64; 2],
    /// Of the whole arc.
    pub(crate) length: u64,
}

impl Round {
    pub(crate) fn new(arc: &Arc) -> Self {
        let timeline = &arc.timeline;
        let axis = Arc::major(arc.octant);
        let (sign_x, sign_z) = Arc::signs(arc.octant, arc.sense);
        let [radius_x, radius_z] = timeline.radius_pulses;
        let (radius, signs) = match axis {
            Axis::X => ([radius_x, radius_z], (sign_x, sign_z)),
            Axis::Z => ([radius_z, radius_x], (sign_z, sign_x)),
        };
        // before the extreme the other axis moves outward, behind it inward
        let inward = Arc::ends_at_tangent(arc.octant, arc.sense);
        let signs = if inward { (signs.0, signs.1.wrapping_neg()) } else { signs };
        let longest = radius_x.max(radius_z);
        let cut = 64_u32.wrapping_sub(longest.leading_zeros()).saturating_sub(32);
        Self {
            angle: timeline.angle,
            start: i64::from(timeline.start_angle),
            axis,
            signs,
            radius: radius.map(|radius| radius.wrapping_shr(cut).cast_signed()),
            cut,
            centre: timeline.centre,
            length: timeline.length,
        }
    }

    /// Quarter turns to the angle at a length, and the rest.
    pub(crate) fn quarters(&self, length: u64) -> (i64, i64) {
        let angle = self.start.wrapping_add(self.angle.of(length).cast_signed());
        let quarters = angle.checked_div_euclid(QUARTER_Q30).unwrap_or(0);
        (quarters, angle.wrapping_sub(quarters.wrapping_mul(QUARTER_Q30)))
    }

    /// Quarter turns to the angle at a length, the sine of the rest, and its cosine.
    pub(crate) fn turned(&self, length: u64) -> (i64, i64, i64) {
        let (quarters, rest) = self.quarters(length);
        (quarters, sine(rest), sine(QUARTER_Q30.wrapping_sub(rest)))
    }

    /// A sine times a radius: pulses, 16 fraction bits.
    pub(crate) const fn part(&self, sine: i64, radius: i64) -> i64 {
        sine.wrapping_mul(radius).wrapping_shr(30_u32.wrapping_sub(self.cut))
    }

    /// The coordinate of an axis at an angle, pulses from the start, 16 fraction bits.
    pub(crate) fn coordinate(&self, axis: Axis, (quarters, rest): (i64, i64)) -> i64 {
        let ([first, second], [centre_x, centre_z]) = (self.radius, self.centre);
        // the other axis is a quarter turn ahead
        let (quarters, radius, sign) = if axis == self.axis {
            (quarters, first, self.signs.0)
        } else {
            (quarters.wrapping_add(1), second, self.signs.1)
        };
        let turned = sine(if quarters & 1 == 0 { rest } else { QUARTER_Q30.wrapping_sub(rest) });
        let turned = if quarters & 2 == 0 { turned } else { turned.wrapping_neg() };
        let centre = if matches!(axis, Axis::X) { centre_x } else { centre_z };
        centre.wrapping_add(self.part(turned, radius).wrapping_mul(i64::from(sign)))
    }
}
