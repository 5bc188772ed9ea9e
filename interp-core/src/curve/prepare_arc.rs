//! Turns two lattice points and a centre into an [`Arc`]: coefficients, octants, joints and timeline.
//!
//! The centre is moved along the chord onto the perpendicular bisector of the two ends, so the walked circle passes
//! through both. In pulses that circle is `a x^2 + b z^2 - c x - d z = 0`. `a : b` is the exact ratio of the squared
//! pulse sizes where 44 bits hold it, else the nearest one; `c` and `d` are rounded to a 2^-17th of a pulse or finer.
//! Everything here may take 128 bits: it runs in the background, once a block.

use super::arc::{Arc, MAX_PIECES, Timeline};
use super::proportion::Proportion;
use crate::math::{
    HALF_TURN_Q60, RADIAN_Q30, Wide, angle_of, cosine_from_sine, root_wide, scale, sine, to_i32, to_i64, to_u64,
};
use crate::units::{Axis, Lattice, PulseSize, Sense};

/// What the two pulse sizes mean for every arc of a machine.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Metric {
    x: PulseSize,
    z: PulseSize,
    /// Pulse sizes over their greatest common measure.
    across: i128,
    along: i128,
    /// Angle from the middle to the end of a zone with major X, 60 fraction bits.
    half_width_x: i64,
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
    fn place(pulse: PulseSize, pulses: i32) -> i128 {
        scale(i128::from(pulses), i128::from(pulse.numerator()) << 12, i128::from(pulse.denominator()))
    }

    /// Weights of X and Z for arcs of `radius` (nm, 12 fraction bits): as large as 64 bits bear.
    fn weights(&self, radius: i128) -> (i128, i128) {
        let (x2, z2) = (self.across.times(self.across), self.along.times(self.along));
        let largest = x2.max(z2);
        let coarser = if self.across > self.along { self.x } else { self.z };
        let size = i128::from(coarser.numerator()) << 12;
        let pulses = scale(radius, i128::from(coarser.denominator()), size).saturating_add(2);
        let most = (1_i128 << 56).checked_div(pulses).unwrap_or(1).min(1 << 44);
        match most.checked_div(largest) {
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
        let off_x = Self::place(self.x, start.x).wrapping_sub(i128::from(centre.0) << 12);
        let off_z = Self::place(self.z, start.z).wrapping_sub(i128::from(centre.1) << 12);
        let square = off_x.squared().saturating_add(off_z.squared());
        let radius = i128::from(root_wide(square.unsigned_abs()));
        let coarser = if self.across > self.along { self.x } else { self.z };
        // a whole turn about less than a pulse stays where it is
        if delta == (0, 0) && radius < Self::place(coarser, 1) {
            return Prepared::Nothing;
        }
        let near = delta.0.unsigned_abs() <= 1 && delta.1.unsigned_abs() <= 1;
        if matches!(reach, Reach::Short) && near && radius > Self::place(coarser, 3) {
            return Prepared::Chord;
        }
        match Preparation::new(self, start, delta, centre, radius, (sense, reach)).and_then(|p| p.arc()) {
            Some((arc, turn)) => Prepared::Arc(arc, turn),
            None => Prepared::Chord,
        }
    }
}

/// Integers in the same ratio without a common divisor.
fn lowest(values: [i64; 4]) -> [i64; 4] {
    let mut common = 0_u64;
    for value in values {
        let mut rest = value.unsigned_abs();
        while let Some(next) = common.checked_rem(rest) {
            (common, rest) = (rest, next);
        }
    }
    values.map(|value| value.checked_div(i64::try_from(common).unwrap_or(1)).unwrap_or(value))
}

/// The conic of one arc, on the way to an [`Arc`].
struct Preparation<'m> {
    metric: &'m Metric,
    sense: Sense,
    reach: Reach,
    end: (i32, i32),
    a: i128,
    b: i128,
    c: i128,
    d: i128,
    /// Gradient of `F`, both components, at the tangent points.
    tangent: i128,
}

impl<'m> Preparation<'m> {
    fn new(
        metric: &'m Metric,
        start: Lattice,
        end: (i32, i32),
        centre: (i64, i64),
        radius: i128,
        (sense, reach): (Sense, Reach),
    ) -> Option<Self> {
        let (a, b) = metric.weights(radius);
        // 2 a (centre / pulse - start)
        let about = |pulse: PulseSize, weight: i128, centre: i64, start: i32| {
            let (num, den) = (i128::from(pulse.numerator()), i128::from(pulse.denominator()));
            let off = i128::from(centre).times(den).wrapping_sub(i128::from(start).times(num));
            scale(weight.wrapping_mul(2), off, num)
        };
        let mut c = about(metric.x, a, centre.0, start.x);
        let mut d = about(metric.z, b, centre.1, start.z);
        // move the centre along the chord until F is zero at the end
        let (dx, dz) = (i128::from(end.0), i128::from(end.1));
        let (reach_x, reach_z) = (a.times(dx), b.times(dz));
        let chord = reach_x.times(dx).wrapping_add(reach_z.times(dz));
        let miss = chord.wrapping_sub(c.times(dx)).wrapping_sub(d.times(dz));
        let bits = 128_u32.wrapping_sub(miss.unsigned_abs().leading_zeros());
        let shift = bits.saturating_sub(60);
        c = c.wrapping_add(scale(reach_x, miss.wrapping_shr(shift), chord.wrapping_shr(shift).max(1)));
        d = d.wrapping_add(scale(reach_z, miss.wrapping_shr(shift), chord.wrapping_shr(shift).max(1)));
        // where |dF/dx| = |dF/dz| = g on the curve: g^2 = (b c^2 + a d^2) / (a + b)
        let longest = c.unsigned_abs().max(d.unsigned_abs());
        let spare = 128_u32.wrapping_sub(longest.leading_zeros()).saturating_sub(40);
        let (cs, ds) = (c.wrapping_shr(spare), d.wrapping_shr(spare));
        let sum = b.saturating_mul(cs.times(cs)).saturating_add(a.saturating_mul(ds.times(ds)));
        let square = sum.checked_div(a.wrapping_add(b))?;
        let tangent = i128::from(root_wide(square.unsigned_abs())).wrapping_shl(spare);
        (tangent > 0).then_some(Self { metric, sense, reach, end, a, b, c, d, tangent })
    }

    /// Gradient of `F` at a lattice point: X, Z.
    fn gradient(&self, x: i32, z: i32) -> (i128, i128) {
        let along_x = self.a.wrapping_mul(2).times(i128::from(x)).wrapping_sub(self.c);
        let along_z = self.b.wrapping_mul(2).times(i128::from(z)).wrapping_sub(self.d);
        (along_x, along_z)
    }

    /// Octant of a gradient; on a border the one that `sense` enters.
    fn octant(gradient: (i128, i128), sense: Sense) -> u8 {
        let counter_clockwise = |x: i128, z: i128| {
            if x >= 0 && z > 0 {
                u8::from(x >= z)
            } else if x > 0 {
                2_u8.wrapping_add(u8::from(z.wrapping_neg() >= x))
            } else if z < 0 {
                4_u8.wrapping_add(u8::from(x <= z))
            } else {
                6_u8.wrapping_add(u8::from(z >= x.wrapping_neg()))
            }
        };
        match sense {
            Sense::CounterClockwise => counter_clockwise(gradient.0, gradient.1),
            Sense::Clockwise => 7_u8.wrapping_sub(counter_clockwise(gradient.0.wrapping_neg(), gradient.1)),
        }
    }

    /// The border that travel meets at the end of `octant`, on the octant's major axis, as numerator and
    /// denominator of a coordinate.
    fn border(&self, octant: u8, axis: Axis, tangent: bool) -> (i128, i128) {
        let (centre, weight, positive) = match axis {
            Axis::X => (self.c, self.a, octant < 4),
            Axis::Z => (self.d, self.b, octant.wrapping_add(2) & 7 < 4),
        };
        let off = match (tangent, positive) {
            (false, _) => 0,
            (true, true) => self.tangent,
            (true, false) => self.tangent.wrapping_neg(),
        };
        (centre.wrapping_add(off), weight.wrapping_mul(2))
    }

    /// The lattice line of the minor axis nearest to the curve at `major`, half toward plus infinity.
    fn minor_at(&self, octant: u8, major: i32) -> i32 {
        let m = i128::from(major);
        let (am, cm, an, cn, above) = match Arc::major(octant) {
            Axis::X => (self.a, self.c, self.b, self.d, octant.wrapping_add(2) & 7 < 4),
            Axis::Z => (self.b, self.d, self.a, self.c, octant < 4),
        };
        // an n^2 - cn n + (am m^2 - cm m) = 0, so 2 an n - cn = +- root(cn^2 - 4 an (am m^2 - cm m))
        let rest = am.times(m).wrapping_sub(cm).times(m);
        let square = cn.times(cn).wrapping_sub(an.wrapping_mul(4).times(rest)).max(0).unsigned_abs();
        let floor = root_wide(square);
        let exact = u128::from(floor).wrapping_mul(u128::from(floor)) == square;
        let gradient = i128::from(floor);
        // floor(n + 1/2); a root cut off must be cut toward minus infinity
        let top =
            if above { cn.wrapping_add(gradient) } else { cn.wrapping_sub(gradient).wrapping_sub(i128::from(!exact)) };
        let doubled = an.wrapping_mul(2);
        to_i32(to_i64(top.wrapping_add(an).quotient(doubled).unwrap_or(0)))
    }

    fn arc(&self) -> Option<(Arc, Turn)> {
        let first = Self::octant(self.gradient(0, 0), self.sense);
        // the end belongs to the octant that it leaves: the one that the opposite sense would enter
        let last = Self::octant(self.gradient(self.end.0, self.end.1), self.sense.mirrored());
        let between = match self.sense {
            Sense::CounterClockwise => last.wrapping_sub(first) & 7,
            Sense::Clockwise => first.wrapping_sub(last) & 7,
        };
        // half a turn passes four octant borders; rounded ends may add or take one
        let turns = match self.reach {
            Reach::Short if between > 5 => return None,
            Reach::Long if between < 3 => between.wrapping_add(8),
            Reach::Short | Reach::Long => between,
        };
        if usize::from(turns) >= MAX_PIECES {
            return None;
        }
        let (timeline, turn) = self.timeline(first)?;
        // the same curve in smaller numbers; with its centre on the lattice in very small ones, cheaper to walk
        let [a, b, c, d] = lowest([to_i64(self.a), to_i64(self.b), to_i64(self.c), to_i64(self.d)]);
        let mut arc = Arc {
            a,
            b,
            c,
            d,
            steps: [0; MAX_PIECES],
            joints: [(0, 0); MAX_PIECES - 1],
            octant: first,
            pieces: turns.wrapping_add(1),
            sense: self.sense,
            timeline,
            end: self.end,
        };
        self.enumerate(&mut arc).then_some((arc, turn))
    }

    /// Counts the lattice points of every octant visited. False where they do not lead to the end.
    fn enumerate(&self, arc: &mut Arc) -> bool {
        let mut at = (0_i32, 0_i32);
        let mut octant = arc.octant;
        for piece in 0..arc.pieces {
            let axis = Arc::major(octant);
            let (sign_x, sign_z) = Arc::signs(octant, self.sense);
            let (sign, here, end) = match axis {
                Axis::X => (sign_x, at.0, self.end.0),
                Axis::Z => (sign_z, at.1, self.end.1),
            };
            let final_piece = piece.wrapping_add(1) == arc.pieces;
            let last = if final_piece {
                end
            } else {
                let (num, den) = self.border(octant, axis, Arc::ends_at_tangent(octant, self.sense));
                Self::before(num, den, sign)
            };
            // the first lattice line of this octant
            let (from, enters) = if piece == 0 {
                (here, false)
            } else {
                let earlier = Arc::octant_before(octant, self.sense);
                let tangent = Arc::ends_at_tangent(earlier, self.sense);
                let (num, den) = self.border(earlier, axis, tangent);
                let reached = Self::before(num, den, sign.wrapping_neg());
                // a point on an extreme belongs to the octant before it
                let on_border = i128::from(reached).times(den) == num;
                let skip = if !tangent && on_border { i32::from(sign) } else { 0 };
                (reached.wrapping_add(skip), true)
            };
            let steps = last.wrapping_sub(from).wrapping_mul(i32::from(sign));
            if steps >= 0 || (final_piece && enters) {
                if enters {
                    let to = match (steps >= 0, axis) {
                        (false, _) => self.end,
                        (true, Axis::X) => (from, self.minor_at(octant, from)),
                        (true, Axis::Z) => (self.minor_at(octant, from), from),
                    };
                    let joint = (i8::try_from(to.0.wrapping_sub(at.0)), i8::try_from(to.1.wrapping_sub(at.1)));
                    let (Ok(x), Ok(z)) = joint else { return false };
                    if let Some(slot) = arc.joints.get_mut(usize::from(piece).wrapping_sub(1)) {
                        *slot = (x, z);
                    }
                    at = to;
                }
                if let (Some(slot), true) = (arc.steps.get_mut(usize::from(piece)), steps > 0) {
                    *slot = steps.unsigned_abs();
                    let minor = self.minor_at(octant, last);
                    at = match axis {
                        Axis::X => (last, minor),
                        Axis::Z => (minor, last),
                    };
                }
            } else if final_piece {
                return false;
            }
            octant = Arc::octant_after(octant, self.sense);
        }
        at == self.end
    }

    /// The last lattice line before `num / den` when travelling with `sign`, or on it.
    fn before(num: i128, den: i128, sign: i8) -> i32 {
        let floor = num.quotient(den).unwrap_or(0);
        let line = if sign > 0 || floor.times(den) == num { floor } else { floor.wrapping_add(1) };
        to_i32(to_i64(line))
    }

    fn timeline(&self, octant: u8) -> Option<(Timeline, Turn)> {
        let metric = self.metric;
        // X : Z of the radius vector in mm is (gradient x / pulse x) : (gradient z / pulse z)
        let angle = |(x, z): (i128, i128)| angle_of(z.times(metric.across), x.times(metric.along));
        let start = angle(self.gradient(0, 0));
        let stop = angle(self.gradient(self.end.0, self.end.1));
        let whole = i128::from(HALF_TURN_Q60).wrapping_mul(2);
        let travel: i128 = match self.sense {
            Sense::CounterClockwise => 1,
            Sense::Clockwise => -1,
        };
        let swept = i128::from(stop).wrapping_sub(i128::from(start)).times(travel);
        let swept = swept.rest(whole)?;
        // a whole turn and a little less or more: the angles alone can't tell
        let lacks = matches!(self.reach, Reach::Long) && swept < whole >> 2;
        let sweep = if lacks { swept.wrapping_add(whole) } else { swept };
        let span = |pulse: PulseSize, centre: i128, weight: i128| {
            let den = weight.wrapping_mul(2).times(i128::from(pulse.denominator()));
            scale(centre, i128::from(pulse.numerator()) << 12, den)
        };
        let (x, z) = (span(metric.x, self.c, self.a), span(metric.z, self.d, self.b));
        let square = x.squared().saturating_add(z.squared());
        let radius = root_wide(square.unsigned_abs());
        if radius == 0 {
            return None;
        }
        let length = to_u64(i128::from(radius).times(sweep) >> 60);
        let middle = i128::from(octant.wrapping_add(1) >> 1 & 3).times(i128::from(HALF_TURN_Q60) >> 1);
        let mut off = i128::from(start).wrapping_sub(middle).rest(whole)?;
        if off > i128::from(HALF_TURN_Q60) {
            off = off.wrapping_sub(whole);
        }
        let in_pulses = |pulse: PulseSize| {
            to_u64(scale(i128::from(radius), i128::from(pulse.denominator()) << 4, i128::from(pulse.numerator())))
        };
        let quarter = HALF_TURN_Q60 >> 1;
        let timeline = Timeline {
            radius,
            angle: Proportion::new(1 << 30, radius, length),
            radius_pulses: [in_pulses(metric.x), in_pulses(metric.z)],
            centre: [
                to_i64(scale(self.c, 1 << 16, self.a.wrapping_mul(2))),
                to_i64(scale(self.d, 1 << 16, self.b.wrapping_mul(2))),
            ],
            start_angle: to_i32(to_i64(off.times(travel) >> 30)),
            half_width: [to_i32(metric.half_width_x >> 30), to_i32(quarter.wrapping_sub(metric.half_width_x) >> 30)],
            length,
        };
        Some((timeline, Turn { start, sweep: to_i64(sweep), sense: self.sense }))
    }
}
