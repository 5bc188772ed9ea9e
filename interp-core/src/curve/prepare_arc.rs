//! Turns two lattice points and a centre into an [`Arc`]: coefficients, octants, joints and timeline.
//!
//! The centre is moved along the chord onto the perpendicular bisector of the two ends, so the walked circle passes
//! through both. In pulses that circle is `a x^2 + b z^2 - c x - d z = 0`. `a : b` is the exact ratio of the squared
//! pulse sizes where 44 bits hold it, else the nearest one; `c` and `d` are rounded to a 2^-17th of a pulse or finer.
//! Everything here may take 128 bits: it runs in the background, once a block.

use super::arc::Arc;
use super::preparation::{Preparation, Round, Step};
use crate::math::{HALF_TURN_Q60, RADIAN_Q30, Wide, angle_of, cosine_from_sine, scale, sine, to_i64};
use crate::units::{Lattice, PulseSize, Sense};

/// What the two pulse sizes mean for every arc of a machine.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Metric {
    pub(super) x: PulseSize,
    pub(super) z: PulseSize,
    /// Pulse sizes over their greatest common measure.
    pub(super) across: i128,
    pub(super) along: i128,
    /// Angle from the middle to the end of a zone with major X, 60 fraction bits.
    pub(super) half_width_x: i64,
}

/// A curve of an arc's two rounded ends.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Prepared {
    /// The ends are the same lattice point: no pulse.
    Nothing,
    /// An arc, and how it turns.
    Arc(Arc, Turn),
    /// So short or so small that the arc is its chord, to within a pulse.
    Chord,
}

/// Which of the two ways round an arc takes.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Reach {
    /// At most half a turn.
    Short,
    /// More than half a turn, up to a whole one.
    Long,
}

/// Angles of an arc, radians with 60 fraction bits.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Turn {
    /// Angle of the start from the Z axis, counter-clockwise.
    pub start: i64,
    /// How far it turns, not negative.
    pub sweep: i64,
    /// Which way.
    pub sense: Sense,
}

impl Turn {
    fn along(&self, angle: i64) -> i64 {
        match self.sense {
            Sense::CounterClockwise => angle,
            Sense::Clockwise => angle.wrapping_neg(),
        }
    }

    /// Direction of travel after turning by `swept`: X and Z parts of a unit vector, 30 fraction bits.
    pub fn heading(&self, swept: i64) -> (i64, i64) {
        let whole = i128::from(HALF_TURN_Q60).wrapping_mul(2);
        let angle = i128::from(self.start).wrapping_add(i128::from(self.along(swept)));
        let (sine, cosine) = unit(to_i64(angle.rest(whole).unwrap_or(0)));
        (self.along(cosine), self.along(sine.wrapping_neg()))
    }

    /// The largest X part and the largest Z part that the direction of travel has anywhere on the arc.
    pub fn extent(&self) -> (i64, i64) {
        let (first, last) = (self.heading(0), self.heading(self.sweep));
        let mut x = first.0.wrapping_abs().max(last.0.wrapping_abs());
        let mut z = first.1.wrapping_abs().max(last.1.wrapping_abs());
        for quarter in -6..=6_i128 {
            let off = quarter.times(i128::from(HALF_TURN_Q60 >> 1)).wrapping_sub(i128::from(self.start));
            let swept = if self.sense == Sense::CounterClockwise { off } else { off.wrapping_neg() };
            if (0..=i128::from(self.sweep)).contains(&swept) {
                if quarter & 1 == 0 { x = RADIAN_Q30 } else { z = RADIAN_Q30 }
            }
        }
        (x, z)
    }
}

/// Sine and cosine of any angle (60 fraction bits), with 30 fraction bits.
fn unit(angle: i64) -> (i64, i64) {
    let quarter = HALF_TURN_Q60 >> 1;
    let quarters = angle.wrapping_add(quarter >> 1).checked_div_euclid(quarter).unwrap_or(0);
    let rest = angle.wrapping_sub(quarters.wrapping_mul(quarter)) >> 30;
    let s = sine(rest);
    let c = cosine_from_sine(s.wrapping_abs());
    match quarters & 3 {
        0 => (s, c),
        1 => (c, s.wrapping_neg()),
        2 => (s.wrapping_neg(), c.wrapping_neg()),
        _ => (c.wrapping_neg(), s),
    }
}

impl Metric {
    /// The metric of two pulse sizes.
    pub fn new(x: PulseSize, z: PulseSize) -> Self {
        let across = u64::from(x.numerator()).wrapping_mul(u64::from(z.denominator()));
        let along = u64::from(z.numerator()).wrapping_mul(u64::from(x.denominator()));
        let (mut p, mut q) = (across, along);
        while let Some(rest) = p.checked_rem(q) {
            (p, q) = (q, rest);
        }
        let across = i128::from(across.checked_div(p).unwrap_or(1));
        let along = i128::from(along.checked_div(p).unwrap_or(1));
        Self { x, z, across, along, half_width_x: angle_of(across, along) }
    }

    /// Coordinate of a lattice line, nm with 12 fraction bits, rounded to nearest.
    pub(super) fn place(pulse: PulseSize, pulses: i32) -> i128 {
        scale(i128::from(pulses), i128::from(pulse.numerator()) << 12, i128::from(pulse.denominator()))
    }

    /// Weights of X and Z for arcs of `radius` (nm, 12 fraction bits): as large as 64 bits bear.
    pub(super) fn weights(&self, radius: i128) -> (i128, i128) {
        let (x2, z2) = (self.across.times(self.across), self.along.times(self.along));
        let largest = x2.max(z2);
        let coarser = if self.across > self.along { self.x } else { self.z };
        let size = i128::from(coarser.numerator()) << 12;
        let pulses = scale(radius, i128::from(coarser.denominator()), size).saturating_add(2);
        let most = (1_i128 << 56).over(pulses).unwrap_or(1).min(1 << 44);
        match most.over(largest) {
            Some(times) if times >= 4096 => (x2.times(times), z2.times(times)),
            _ => (scale(x2, most, largest).max(1), scale(z2, most, largest).max(1)),
        }
    }

    /// Prepares the arc from `start` to `end` about `centre` (X, Z in nm). `reach` says whether it is the way round
    /// of at most half a turn or the other one; the same end as start is a whole turn then.
    pub fn arc(&self, start: Lattice, end: Lattice, centre: (i64, i64), sense: Sense, reach: Reach) -> Prepared {
        let delta = (end.x.wrapping_sub(start.x), end.z.wrapping_sub(start.z));
        if delta == (0, 0) && matches!(reach, Reach::Short) {
            return Prepared::Nothing;
        }
        let mut preparation = Preparation::new(self.round(start, centre, reach), delta, sense);
        let radius = preparation.find_radius(self);
        let coarser = if self.across > self.along { self.x } else { self.z };
        // a whole turn about less than a pulse stays where it is
        if delta == (0, 0) && radius < Self::place(coarser, 1) {
            return Prepared::Nothing;
        }
        let near = delta.0.unsigned_abs() <= 1 && delta.1.unsigned_abs() <= 1;
        if matches!(reach, Reach::Short) && near && radius > Self::place(coarser, 3) {
            return Prepared::Chord;
        }
        loop {
            match preparation.step(self) {
                Step::More => {}
                Step::Done(arc, turn) => return Prepared::Arc(arc, turn),
                Step::Fails => return Prepared::Chord,
            }
        }
    }

    /// What the preparation of an arc from `start` about `centre` needs.
    pub(crate) fn round(&self, start: Lattice, (x, z): (i64, i64), reach: Reach) -> Round {
        let off = |pulse: PulseSize, centre: i64, start: i32| {
            let (num, den) = (i128::from(pulse.numerator()), i128::from(pulse.denominator()));
            to_i64(i128::from(centre).times(den).wrapping_sub(i128::from(start).times(num)))
        };
        Round { about: (off(self.x, x, start.x), off(self.z, z, start.z)), reach }
    }
}
