//! Lays a conic between two lattice points out octant by octant: coefficients in, an [`Arc`] without a timeline's
//! figures out.
//!
//! The conic is `F = a x^2 + b z^2 - c x - d z + f`, coordinates in pulses from the start: a circle or an axis-parallel
//! ellipse, and with `a` or `b` 0 a parabola, an ellipse whose centre is infinitely far away. It knows no millimetres: an
//! ellipse is a circle on a lattice with other pulse sizes. Octants are numbered as in [`super::arc`].
//!
//! A circle goes through both points, so its f is 0. Another conic stays where it was programmed, and its rounded ends
//! are up to a pulse off along the minor axis. There the walk is [led](Leads): it stays between what can be reached from
//! the start, and what the end can be reached from, by minor steps in the direction of travel only.

use super::arc::{Arc, MAX_PIECES, Timeline};
use super::leads::Leads;
use super::method::Method;
use super::prepare_arc::Reach;
use crate::math::{Wide, root_wide, scale, to_i32, to_i64};
use crate::units::{Axis, Sense};

/// Integers in the same ratio without a common divisor.
pub(crate) fn lowest<const N: usize>(values: [i64; N]) -> [i64; N] {
    let mut common = 0_u64;
    for value in values {
        let mut rest = value.unsigned_abs();
        while let Some(next) = common.checked_rem(rest) {
            (common, rest) = (rest, next);
        }
    }
    values.map(|value| value.checked_div(i64::try_from(common).unwrap_or(1)).unwrap_or(value))
}

/// A conic from (0, 0) to a lattice point.
#[derive(Clone, Debug)]
pub(crate) struct Octants {
    pub(crate) sense: Sense,
    pub(crate) reach: Reach,
    pub(crate) end: (i32, i32),
    pub(crate) a: i128,
    pub(crate) b: i128,
    pub(crate) c: i128,
    pub(crate) d: i128,
    pub(crate) f: i128,
    pub(crate) leads: Leads,
    /// It does not pass through the ends.
    pub(super) loose: bool,
    /// Gradient of `F`, both components, at the tangent points.
    tangent: i128,
}

/// Octants being laid out.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Layout {
    arc: Arc,
    /// Where those laid out lead.
    at: (i32, i32),
    /// The next octant, and its number.
    octant: u8,
    piece: u8,
}

impl Layout {
    /// Whether all are laid out.
    pub(crate) const fn is_done(&self) -> bool {
        self.piece >= self.arc.pieces
    }

    /// The arc, where all are laid out and lead to its end.
    pub(crate) fn arc(&self) -> Option<Arc> {
        (self.is_done() && self.at == self.arc.end).then_some(self.arc)
    }
}

impl Octants {
    /// The circle with these coefficients, its centre moved so that it passes through `end`. `None` for a point.
    pub(crate) fn through([a, b, c, d]: [i128; 4], end: (i32, i32), way: (Sense, Reach)) -> Option<Self> {
        // move the centre along the chord until F is zero at the end
        let (dx, dz) = (i128::from(end.0), i128::from(end.1));
        let (reach_x, reach_z) = (a.times(dx), b.times(dz));
        let chord = reach_x.times(dx).wrapping_add(reach_z.times(dz));
        let miss = chord.wrapping_sub(c.times(dx)).wrapping_sub(d.times(dz));
        let bits = 128_u32.wrapping_sub(miss.unsigned_abs().leading_zeros());
        let shift = bits.saturating_sub(60);
        let moved = |centre: i128, reach: i128| {
            centre.wrapping_add(scale(reach, miss.wrapping_shr(shift), chord.wrapping_shr(shift).max(1)))
        };
        Self::new([a, b, moved(c, reach_x), moved(d, reach_z), 0], end, way)
    }

    /// The conic with these coefficients, as it is. `None` for a point.
    pub(crate) fn beside(conic: [i128; 5], end: (i32, i32), way: (Sense, Reach)) -> Option<Self> {
        Some(Self { loose: true, ..Self::new(conic, end, way)? })
    }

    fn new([a, b, c, d, f]: [i128; 5], end: (i32, i32), (sense, reach): (Sense, Reach)) -> Option<Self> {
        // where |dF/dx| = |dF/dz| = g on the curve: g^2 = (b c^2 + a d^2 - 4 a b f) / (a + b)
        let longest = c.unsigned_abs().max(d.unsigned_abs());
        let weight = 128_u32.wrapping_sub(a.max(b).leading_zeros());
        let kept = 40_u32.min(126_u32.wrapping_sub(weight) >> 1);
        let spare = 128_u32.wrapping_sub(longest.leading_zeros()).saturating_sub(kept);
        let (cs, ds) = (c.wrapping_shr(spare), d.wrapping_shr(spare));
        let sum = b.saturating_mul(cs.times(cs)).saturating_add(a.saturating_mul(ds.times(ds)));
        let lowered = scale(a, b, a.wrapping_add(b)).times(f).wrapping_mul(4).wrapping_shr(spare.wrapping_mul(2));
        let square = sum.over(a.wrapping_add(b))?.wrapping_sub(lowered).max(0);
        let tangent = i128::from(root_wide(square.unsigned_abs())).wrapping_shl(spare);
        let whole = Self { sense, reach, end, a, b, c, d, f, leads: Leads::default(), loose: false, tangent };
        (tangent > 0).then_some(whole)
    }

    /// The first octant.
    pub(crate) fn first(&self) -> u8 {
        Self::octant(self.gradient(0, 0), self.sense)
    }

    /// Gradient of `F` at a lattice point: X, Z.
    pub(crate) fn gradient(&self, x: i32, z: i32) -> (i128, i128) {
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
        if weight != 0 {
            return (centre.wrapping_add(off), weight.wrapping_mul(2));
        }
        // a parabola along this axis, whose tangent points are where the other coordinate's gradient is +-d: there
        // a x^2 - c x + f = d z gives z = (d^2 - c^2 + 4 a f) / 4 a d
        let (c, d, a) = match axis {
            Axis::X => (self.d, self.c, self.b),
            Axis::Z => (self.c, self.d, self.a),
        };
        let num = d.times(d).wrapping_sub(c.times(c)).wrapping_add(a.times(self.f).wrapping_mul(4));
        let den = a.times(d).wrapping_mul(4);
        if den < 0 { (num.wrapping_neg(), den.wrapping_neg()) } else { (num, den) }
    }

    pub(super) fn minor_at(&self, octant: u8, major: i32) -> i32 {
        minor_at([self.a, self.b, self.c, self.d, self.f], octant, major)
    }

    /// The octants laid out; `None` where they do not lead to the end.
    pub(crate) fn arc(&mut self, timeline: Timeline) -> Option<Arc> {
        let mut layout = self.layout(timeline)?;
        while !layout.is_done() {
            self.lay(&mut layout)?;
        }
        layout.arc()
    }

    /// Begins to lay the octants out; `None` where they do not lead to the end.
    pub(crate) fn layout(&self, timeline: Timeline) -> Option<Layout> {
        let first = self.first();
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
        // the same curve in smaller numbers; with its centre on the lattice in very small ones, cheaper to walk
        let [a, b, c, d] = lowest([to_i64(self.a), to_i64(self.b), to_i64(self.c), to_i64(self.d)]);
        let arc = Arc {
            a,
            b,
            c,
            d,
            steps: [0; MAX_PIECES],
            joints: [(0, 0); MAX_PIECES - 1],
            octant: first,
            pieces: turns.wrapping_add(1),
            sense: self.sense,
            method: Method::MinimumDeviation,
            timeline,
            end: self.end,
        };
        Some(Layout { arc, at: (0, 0), octant: first, piece: 0 })
    }

    /// Counts the lattice points of the next octant. `None` where they do not lead to the end.
    pub(crate) fn lay(&mut self, layout: &mut Layout) -> Option<()> {
        let Layout { arc, at, octant, piece } = layout;
        let axis = Arc::major(*octant);
        let (sign_x, sign_z) = Arc::signs(*octant, self.sense);
        let (sign, here, end) = match axis {
            Axis::X => (sign_x, at.0, self.end.0),
            Axis::Z => (sign_z, at.1, self.end.1),
        };
        let final_piece = piece.wrapping_add(1) == arc.pieces;
        let last = if final_piece {
            end
        } else {
            let (num, den) = self.border(*octant, axis, Arc::ends_at_tangent(*octant, self.sense));
            let last = Self::before(num, den, sign);
            // the end, off the curve, may lie before the border of its own octant: not past it and back
            let beyond = last.wrapping_sub(end).wrapping_mul(i32::from(sign)) > 0;
            if self.loose && beyond && piece.wrapping_add(2) == arc.pieces { end } else { last }
        };
        // the first lattice line of this octant
        let (from, enters) = if *piece == 0 {
            (here, false)
        } else {
            let earlier = Arc::octant_before(*octant, self.sense);
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
            let lines = steps.max(0).unsigned_abs();
            if self.loose && *piece == 0 {
                self.leads.start = self.lead(*octant, (from, last), *at, true);
            }
            if self.loose && final_piece && steps >= 0 {
                self.leads.end = self.lead(*octant, (last, from), self.end, false);
                if *piece == 0 && !self.share(*octant, lines) {
                    return None;
                }
            }
            if enters {
                let to = if steps < 0 {
                    self.end
                } else if final_piece {
                    self.led(*octant, (from, lines), self.leads.end, self.end, false)
                } else {
                    Self::point(axis, from, self.minor_at(*octant, from))
                };
                let joint = (i8::try_from(to.0.wrapping_sub(at.0)), i8::try_from(to.1.wrapping_sub(at.1)));
                let (Ok(x), Ok(z)) = joint else { return None };
                if let Some(slot) = arc.joints.get_mut(usize::from(*piece).wrapping_sub(1)) {
                    *slot = (x, z);
                }
                *at = to;
            }
            if let (Some(slot), true) = (arc.steps.get_mut(usize::from(*piece)), steps > 0) {
                *slot = lines;
                *at = if self.loose && final_piece {
                    self.end
                } else if *piece == 0 {
                    self.led(*octant, (last, lines), self.leads.start, *at, true)
                } else {
                    Self::point(axis, last, self.minor_at(*octant, last))
                };
            }
        } else if final_piece {
            return None;
        }
        *octant = Arc::octant_after(*octant, self.sense);
        *piece = piece.wrapping_add(1);
        Some(())
    }

    pub(super) const fn point(axis: Axis, major: i32, minor: i32) -> (i32, i32) {
        match axis {
            Axis::X => (major, minor),
            Axis::Z => (minor, major),
        }
    }

    /// The last lattice line before `num / den` when travelling with `sign`, or on it.
    fn before(num: i128, den: i128, sign: i8) -> i32 {
        let floor = num.quotient(den).unwrap_or(0);
        let line = if sign > 0 || floor.times(den) == num { floor } else { floor.wrapping_add(1) };
        to_i32(to_i64(line))
    }
}

/// The lattice line of the minor axis nearest to a conic at `major`, half toward plus infinity.
pub(crate) fn minor_at([a, b, c, d, f]: [i128; 5], octant: u8, major: i32) -> i32 {
    let m = i128::from(major);
    let (am, cm, an, cn, above) = match Arc::major(octant) {
        Axis::X => (a, c, b, d, octant.wrapping_add(2) & 7 < 4),
        Axis::Z => (b, d, a, c, octant < 4),
    };
    // an n^2 - cn n + (am m^2 - cm m + f) = 0, so 2 an n - cn = +- root(cn^2 - 4 an (am m^2 - cm m + f))
    let rest = am.times(m).wrapping_sub(cm).times(m).wrapping_add(f);
    if an == 0 {
        // cn n = am m^2 - cm m + f, floor(n + 1/2)
        let (top, bottom) = if cn < 0 { (rest.wrapping_neg(), cn.wrapping_neg()) } else { (rest, cn) };
        let doubled = top.wrapping_mul(2).wrapping_add(bottom);
        return to_i32(to_i64(doubled.quotient(bottom.wrapping_mul(2)).unwrap_or(0)));
    }
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
