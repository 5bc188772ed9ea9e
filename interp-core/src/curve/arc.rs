//! Circular arc on a lattice whose two pulse sizes may differ: an axis-parallel conic with integer coefficients.
//!
//! With coordinates in pulses from the arc's start the curve is `F(x, z) = a x^2 + b z^2 - c x - d z = 0`, where
//! `a : b` is the ratio of the squared pulse sizes and `(c / 2a, d / 2b)` the centre. `F` passes through the start
//! exactly; the rounded end lies within a 2^-17th of a pulse of it. `F` grows with X on the upper half and with Z on
//! the right half.
//!
//! **Octants** are numbered counter-clockwise from the Z axis and separated, in turn, by the points where both axes
//! take the same number of pulses per unit of curve (odd borders, here called *tangent points*) and by the extremes
//! of the curve (even borders):
//!
//! ```text
//!            X          octant   major  gradient of F
//!        3 \ 2 | 1 /    0, 7, 3, 4   X  steeper in Z
//!       4 ---- + ---- 0 ..
//!        5 / 6 | 7 \    1, 2, 5, 6   Z  steeper in X
//! ```
//!
//! An arc turns by at most a whole turn and so visits at most nine octants. Two neighbouring octants with one major
//! axis are a *zone*.

use super::PART_BITS;
use super::method::Method;
use super::proportion::Proportion;
use crate::math::{QUARTER_Q30, RADIAN_Q30, to_u32};
use crate::units::{Axis, Sense};

/// Largest number of octants that an arc visits.
pub const MAX_PIECES: usize = 9;

/// The extremes of a curve that passes none.
pub(crate) const NO_EXTREMES: ((i32, i32), (i32, i32)) = ((i32::MAX, i32::MAX), (i32::MIN, i32::MIN));

/// Angle, 30 fraction bits, that the place on an arc is known to: a 4096th of a radian off an extreme, an arc differs from it by
/// less than a 2^24th of its radius.
const NEAR: i64 = 1 << 18;

/// A prepared arc of at most a whole turn.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Arc {
    /// Weight of X: `F = a x^2 + b z^2 - c x - d z`.
    pub(crate) a: i64,
    /// Weight of Z.
    pub(crate) b: i64,
    /// `2 a` times the centre's X.
    pub(crate) c: i64,
    /// `2 b` times the centre's Z.
    pub(crate) d: i64,
    /// Steps of the major axis inside each octant visited.
    pub(crate) steps: [u32; MAX_PIECES],
    /// From the last point of an octant to the first of the next: X, Z pulses.
    pub(crate) joints: [(i8, i8); MAX_PIECES - 1],
    /// First octant.
    pub(crate) octant: u8,
    /// Octants visited.
    pub(crate) pieces: u8,
    /// Sense of travel.
    pub(crate) sense: Sense,
    /// How it is walked; methods that know no arcs leave that to minimum deviation.
    pub(crate) method: Method,
    /// Where the tool is on the timeline.
    pub(crate) timeline: Timeline,
    /// The end, pulses.
    pub(crate) end: (i32, i32),
}

/// What turns path length into the continuous coordinate of the major axis.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Timeline {
    /// Radius, nm with 12 fraction bits.
    pub(crate) radius: u64,
    /// From length along the arc to angle turned, 30 fraction bits.
    pub(crate) angle: Proportion,
    /// Radius in pulses of X and of Z, 16 fraction bits.
    pub(crate) radius_pulses: [u64; 2],
    /// Centre in pulses from the start, X and Z, 16 fraction bits.
    pub(crate) centre: [i64; 2],
    /// Angle of the start from the middle of its zone, against the travel negative, 30 fraction bits.
    pub(crate) start_angle: i32,
    /// Angle from the middle of a zone to its end: zones with major X, zones with major Z; 30 fraction bits.
    pub(crate) half_width: [i32; 2],
    /// Length of the whole arc, nm with 12 fraction bits.
    pub(crate) length: u64,
}

impl Arc {
    /// The extremes that it passes between two lengths, nm with 12 fraction bits: the least and the greatest coordinates, X then
    /// Z, pulses from the start, and a pulse more; [`NO_EXTREMES`] where there is none.
    ///
    /// Extremes are a quarter turn apart, and the first one is where the zone of the start has its middle.
    pub(crate) fn extremes(&self, from: u64, until: u64) -> ((i32, i32), (i32, i32)) {
        let (mut least, mut most) = NO_EXTREMES;
        #[expect(clippy::cast_possible_truncation, reason = "a curve is within 2^30 pulses")]
        let pulses = |fine: i64| (fine >> 16) as i32;
        let Timeline { centre: [cx, cz], radius_pulses: [rx, rz], length, .. } = self.timeline;
        let (rx, rz) = (rx.cast_signed(), rz.cast_signed());
        let angle = |length: u64| self.timeline.angle.of(length).cast_signed();
        let (from, until) = (angle(from).wrapping_sub(NEAR), angle(until.min(length)).wrapping_add(NEAR));
        let mut octant = self.octant;
        // where the first one is met
        let mut at = i64::from(self.timeline.start_angle).wrapping_neg();
        if Self::ends_at_tangent(octant, self.sense) {
            at = at.wrapping_add(QUARTER_Q30);
        }
        for _ in 1..self.pieces {
            let next = Self::octant_after(octant, self.sense);
            let border = if matches!(self.sense, Sense::CounterClockwise) { next } else { octant };
            if border & 1 == 0 {
                let passed = at >= from && at <= until;
                at = at.wrapping_add(QUARTER_Q30);
                match border {
                    0 if passed => most.1 = most.1.max(pulses(cz.wrapping_add(rz)).wrapping_add(1)),
                    2 if passed => most.0 = most.0.max(pulses(cx.wrapping_add(rx)).wrapping_add(1)),
                    4 if passed => least.1 = least.1.min(pulses(cz.wrapping_sub(rz)).wrapping_sub(1)),
                    6 if passed => least.0 = least.0.min(pulses(cx.wrapping_sub(rx)).wrapping_sub(1)),
                    _ => {}
                }
            }
            octant = next;
        }
        (least, most)
    }

    /// The largest parts of the length that lead along X and Z anywhere between two lengths, or somewhat more: [`PART_BITS`]
    /// fraction bits. In the middle of a zone the tool moves along its major axis; an angle off that, the other axis has its sine of
    /// the length, which is less than the angle.
    pub(crate) fn parts(&self, from: u64, until: u64) -> (u32, u32) {
        let angle =
            |length: u64| i64::from(self.timeline.start_angle).wrapping_add_unsigned(self.timeline.angle.of(length));
        let (from, until) = (angle(from).wrapping_sub(NEAR), angle(until.min(self.timeline.length)).wrapping_add(NEAR));
        let half_turn = QUARTER_Q30.wrapping_mul(2);
        // the largest angle off the middles, half a turn apart, of which one is at `middle`
        let off = |middle: i64| {
            let by = middle.wrapping_sub(half_turn);
            let (mut from, mut until) = (from.wrapping_sub(by), until.wrapping_sub(by));
            while until > QUARTER_Q30 {
                (from, until) = (from.wrapping_sub(half_turn), until.wrapping_sub(half_turn));
            }
            let all = RADIAN_Q30.unsigned_abs();
            let off = if from < -QUARTER_Q30 { all } else { until.unsigned_abs().max(from.unsigned_abs()).min(all) };
            to_u32(off >> (30 - PART_BITS)).saturating_add(1)
        };
        match Self::major(self.octant) {
            Axis::X => (off(QUARTER_Q30), off(0)),
            Axis::Z => (off(0), off(QUARTER_Q30)),
        }
    }

    /// Length of the walked arc, nm with 12 fraction bits.
    pub const fn length(&self) -> u64 {
        self.timeline.length
    }

    /// Radius of the walked arc, nm with 12 fraction bits.
    pub const fn radius(&self) -> u64 {
        self.timeline.radius
    }

    /// The end, X then Z, pulses from the start.
    pub const fn end(&self) -> (i32, i32) {
        self.end
    }

    /// The octant after `octant` in the sense of travel.
    pub(crate) const fn octant_after(octant: u8, sense: Sense) -> u8 {
        match sense {
            Sense::CounterClockwise => octant.wrapping_add(1) & 7,
            Sense::Clockwise => octant.wrapping_add(7) & 7,
        }
    }

    /// The octant before `octant` in the sense of travel.
    pub(crate) const fn octant_before(octant: u8, sense: Sense) -> u8 {
        Self::octant_after(octant, sense.mirrored())
    }

    /// Whether the border that travel meets at the end of `octant` is a tangent point, where the major axis changes.
    pub(crate) const fn ends_at_tangent(octant: u8, sense: Sense) -> bool {
        match sense {
            Sense::CounterClockwise => octant & 1 == 0,
            Sense::Clockwise => octant & 1 == 1,
        }
    }

    /// The axis that steps every time in `octant`.
    pub(crate) const fn major(octant: u8) -> Axis {
        match octant & 3 {
            0 | 3 => Axis::X,
            _ => Axis::Z,
        }
    }

    /// Signs of travel in `octant`: X, Z.
    pub(crate) const fn signs(octant: u8, sense: Sense) -> (i8, i8) {
        // counter-clockwise X rises on the right half (octants 6, 7, 0, 1), Z falls on the upper half (0..=3)
        let x: i8 = if octant.wrapping_add(2) & 7 < 4 { 1 } else { -1 };
        let z: i8 = if octant < 4 { -1 } else { 1 };
        match sense {
            Sense::CounterClockwise => (x, z),
            Sense::Clockwise => (x.wrapping_neg(), z.wrapping_neg()),
        }
    }

    /// `F` at a lattice point, modulo 2^64: exact wherever the true value fits, which it does near the curve.
    pub(crate) const fn residual(&self, x: i32, z: i32) -> i64 {
        let (x, z) = (x as i64, z as i64);
        let across = self.a.wrapping_mul(x).wrapping_sub(self.c).wrapping_mul(x);
        let along = self.b.wrapping_mul(z).wrapping_sub(self.d).wrapping_mul(z);
        across.wrapping_add(along)
    }

    /// The in-between point on the way over a gap from `from` to `to`, two lattice points that are not neighbours:
    /// of the neighbours of `from` that come nearer to `to`, the one nearest the curve, whose `F` is `offset` at (0, 0).
    pub(crate) fn bridge(&self, from: (i32, i32), to: (i32, i32), offset: i64) -> (i32, i32) {
        let (gap_x, gap_z) = (to.0.wrapping_sub(from.0), to.1.wrapping_sub(from.1));
        let far = gap_x.unsigned_abs().max(gap_z.unsigned_abs());
        if far <= 1 {
            return to;
        }
        let mut best = to;
        let mut least = u64::MAX;
        let mut x = -1_i32;
        while x <= 1 {
            let mut z = -1_i32;
            while z <= 1 {
                let left_x = gap_x.wrapping_sub(x).unsigned_abs();
                let left_z = gap_z.wrapping_sub(z).unsigned_abs();
                let point = (from.0.wrapping_add(x), from.1.wrapping_add(z));
                let off = self.residual(point.0, point.1).wrapping_add(offset).unsigned_abs();
                if left_x.max(left_z) < far && off < least {
                    least = off;
                    best = point;
                }
                z = z.wrapping_add(1);
            }
            x = x.wrapping_add(1);
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::block::{Builder, Curve, Pace, Path};
    use crate::config::{AxisConfig, Config};
    use crate::units::{Feedrate, Length, Point, PulseSize};
    use proptest::prelude::*;

    proptest! {
        /// The tangent of the programmed circle, looked at in many places: nowhere more, and less than the angle over the sine.
        #[test]
        fn the_parts_are_those_of_the_tangent_or_somewhat_more(
            radius in 2.0_f64..20.0, start in 0.0_f64..6.3, turn in 0.1_f64..6.2, counter: bool,
            ends in (0.0_f64..=1.0, 0.0_f64..=1.0)
        ) {
            let axis = |nm: u32| AxisConfig {
                pulse: PulseSize::new(nm, 1).unwrap(), max_feed: Feedrate::from_nm_per_min(3_000_000_000).unwrap(),
                max_accel: 500_000, max_jump: 5_000, pulse_width_ns: 2_500, dir_setup_ns: 2_500, dir_hold_ns: 2_500,
                min_space_ns: 2_500,
            };
            let machine = Config { x: axis(500), z: axis(1_250), event_min_ns: 2_000 }.check().unwrap();
            let sign = if counter { 1.0 } else { -1.0 };
            // counter-clockwise from Z to X
            let at = |angle: f64| (radius * angle.sin(), radius * angle.cos());
            #[allow(clippy::cast_possible_truncation, reason = "a sample")]
            let nm = |mm: f64| (mm * 1e6).round() as i64;
            let point = |(x, z): (f64, f64)| Point {
                x: Length::from_nm(nm(x)).unwrap(), z: Length::from_nm(nm(z)).unwrap(),
            };
            let sense = if counter { Sense::CounterClockwise } else { Sense::Clockwise };
            let mut builder = Builder::new(&machine, point(at(start)));
            let path = Path::Arc { centre: (0, 0), sense };
            let built = builder.motion(path, point(at(start + sign * turn)), Pace::Rapid);
            prop_assume!(built.motions.len() == 1);
            let motion = &built.motions[0];
            let Curve::Arc(arc) = &motion.curve else { return Err(TestCaseError::reject("no arc")) };
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss, reason = "a sample")]
            let length = |part: f64| (motion.length as f64 * part) as u64;
            let (from, until) = (ends.0.min(ends.1), ends.0.max(ends.1));
            let parts = arc.parts(length(from), length(until));
            let angles = (0..=1000).map(|n| start + sign * turn * (from + (until - from) * f64::from(n) / 1e3));
            let most = angles.fold((0.0_f64, 0.0_f64), |(x, z), angle| (x.max(angle.cos().abs()), z.max(angle.sin().abs())));
            for (part, most) in [(parts.0, most.0), (parts.1, most.1)] {
                let part = f64::from(part) / f64::from(1 << PART_BITS);
                // rounded ends lie up to a pulse off
                prop_assert!(part >= most - 2e-3 && part <= (most * core::f64::consts::FRAC_PI_2).min(1.0) + 2e-3, "{part} {most}");
            }
        }
    }
}
