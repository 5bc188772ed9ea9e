//! Axis-parallel ellipse and parabola by minimum deviation: exact integer walks, both ways.
//!
//! On the lattice both are the conic that a circle is there, `F = a x^2 + b z^2 - c x - d z + f`, and so the walk of an
//! [`Arc`](super::arc) serves them: an ellipse with semi-axes S_x, S_z has `a : b = (p_x S_z)^2 : (p_z S_x)^2`, and a
//! parabola `x^2 = 2 p z` along Z has `a = p_x^2`, `b = 0`, `d = 2 p p_z` about its vertex. The ratio is exact where 55 bits
//! hold the gradient, else the nearest.
//!
//! The curve stays where it was programmed: moved or sized so that it passes through both rounded ends, a flat ellipse or a
//! steep parabola would be off it elsewhere by half a pulse times its axes' ratio or its slope. So the ends are up to half
//! a pulse off the curve each way, and the walk is led to them (`leads.rs`).
//!
//! Where, and [part by part](super::conic_part) in which order; when is told by [`Pieces`](crate::block::Pieces), which
//! cuts a conic into parts with a timeline.

use super::arc::{Arc, Timeline};
use super::conic_part::{Leg, MAX_LEGS};
use super::leads::{Leads, Shape};
use super::octants::{Octants, lowest, minor_at};
use super::prepare_arc::Reach;
use crate::math::{Wide, scale, to_i64};
use crate::units::{Axis, Lattice, Length, PulseSize, Sense};

/// An axis-parallel ellipse; coordinates in nm.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Ellipse {
    /// Centre, X and Z.
    pub centre: (i64, i64),
    /// Half axes along X and along Z.
    pub half_axes: (Length, Length),
}

/// A parabola that opens along an axis; coordinates in nm.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Parabola {
    /// Vertex, X and Z.
    pub vertex: (i64, i64),
    /// The axis along which it opens.
    pub axis: Axis,
    /// Twice the focal length: `across^2 = 2 parameter along`; negative where it opens toward minus.
    pub parameter: Length,
}

/// Why a conic is not walked.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum ConicRefusal {
    /// A half axis is not positive, or the parameter is 0.
    Flat,
    /// Start and end are the same lattice point, and no whole turn is meant.
    NoPulse,
    /// The start or the end is off the curve by more than two pulses.
    OffCurve,
    /// So small or flat, measured in pulses, that no chain of lattice points follows it.
    TooSmall,
    /// A coordinate leaves the range of 2^29 pulses.
    OutOfRange,
}

impl core::fmt::Display for ConicRefusal {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Flat => "a half axis or the parameter is zero: give a positive one",
            Self::NoPulse => "start and end round to the same pulse: leave the curve out",
            Self::OffCurve => "an end is more than two pulses off the curve: correct the end or the curve",
            Self::TooSmall => "the curve is smaller than the pulses can follow: use a line",
            Self::OutOfRange => "the curve leaves the range of the axes: bring it nearer",
        })
    }
}

/// A prepared ellipse or parabola.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Conic {
    /// `F = a x^2 + b z^2 - c x - d z + f`, coordinates from the start, without a common divisor.
    conic: [i64; 5],
    /// The same in figures as large as 64 bits bear.
    #[cfg(feature = "methods")]
    fine: [i64; 5],
    /// Its centre, X and Z, pulses with 16 fraction bits.
    centre: [i64; 2],
    pub(crate) sense: Sense,
    end: (i32, i32),
    legs: [Leg; MAX_LEGS],
    count: u8,
}

impl Conic {
    /// The end, X then Z, pulses from the start.
    pub const fn end(&self) -> (i32, i32) {
        self.end
    }

    /// What it is walked in.
    pub(crate) fn legs(&self) -> &[Leg] {
        self.legs.get(..usize::from(self.count)).unwrap_or(&[])
    }

    /// Its coefficients with gradients of up to 57 bits.
    #[cfg(feature = "methods")]
    pub(crate) const fn fine(&self) -> [i64; 5] {
        self.fine
    }

    /// Coefficients, `F` and centre with coordinates from another lattice point of the walk.
    pub(crate) fn seen_from(&self, (x, z): (i32, i32)) -> ([i64; 4], i64, [i64; 2]) {
        let [a, b, c, d, f] = self.conic;
        let (x, z) = (i64::from(x), i64::from(z));
        let along = |weight: i64, centre: i64, at: i64| weight.wrapping_mul(at).wrapping_sub(centre);
        let (along_x, along_z) = (along(a, c, x), along(b, d, z));
        // near the curve it fits, whatever its parts do
        let offset = along_x.wrapping_mul(x).wrapping_add(along_z.wrapping_mul(z)).wrapping_add(f);
        let moved = |weight: i64, along: i64, at: i64| weight.wrapping_mul(at).wrapping_add(along).wrapping_neg();
        let centre = [self.centre[0].wrapping_sub(x << 16), self.centre[1].wrapping_sub(z << 16)];
        ([a, b, moved(a, along_x, x), moved(b, along_z, z)], offset, centre)
    }

    /// Where the walk of a leg is after its joint and some steps from a point of it.
    pub(crate) fn ahead(&self, leg: &Leg, from: (i32, i32), (joint, steps): ((i8, i8), u32)) -> (i32, i32) {
        let to = (from.0.wrapping_add(i32::from(joint.0)), from.1.wrapping_add(i32::from(joint.1)));
        if steps == 0 {
            return to;
        }
        let (sign_x, sign_z) = Arc::signs(leg.octant, self.sense);
        let line = |from: i32, sign: i8| from.wrapping_add(i32::from(sign).wrapping_mul(steps.cast_signed()));
        let (x, z) = (line(to.0, sign_x), line(to.1, sign_z));
        match (leg.shape, Arc::major(leg.octant)) {
            (Shape::Diagonal, _) => (x, z),
            (Shape::Straight, Axis::X) => (x, to.1),
            (Shape::Straight, Axis::Z) => (to.0, z),
            (Shape::Near, Axis::X) => (x, minor_at(self.conic.map(i128::from), leg.octant, x)),
            (Shape::Near, Axis::Z) => (minor_at(self.conic.map(i128::from), leg.octant, z), z),
        }
    }

    fn new(octants: Option<Octants>) -> Result<Self, ConicRefusal> {
        let mut octants = octants.ok_or(ConicRefusal::TooSmall)?;
        // the walker asks for the centre only to know the far side of the curve; a parabola's is far away
        let centre = |weight: i128, twice: i128| {
            if weight == 0 {
                to_i64(twice.signum()) << 46
            } else {
                to_i64(scale(twice, 1 << 16, weight.wrapping_mul(2)))
            }
        };
        let centre = [centre(octants.a, octants.c), centre(octants.b, octants.d)];
        let arc = octants.arc(Timeline::default()).ok_or(ConicRefusal::TooSmall)?;
        let fine = [octants.a, octants.b, octants.c, octants.d, octants.f].map(to_i64);
        let mut made = Self {
            conic: lowest(fine),
            #[cfg(feature = "methods")]
            fine,
            centre,
            sense: arc.sense,
            end: arc.end,
            legs: [Leg::default(); MAX_LEGS],
            count: 0,
        };
        made.lay(&arc, octants.leads);
        Ok(made)
    }

    /// Divides the octants into legs.
    fn lay(&mut self, arc: &Arc, leads: Leads) {
        let mut octant = arc.octant;
        let mut at = (0, 0);
        for piece in 0..arc.pieces {
            let index = usize::from(piece);
            let all = arc.steps.get(index).copied().unwrap_or(0);
            let joint = index.checked_sub(1).and_then(|before| arc.joints.get(before)).copied().unwrap_or((0, 0));
            let first = if piece == 0 { leads.start } else { (Shape::Near, 0) };
            let last = if piece.wrapping_add(1) == arc.pieces { leads.end } else { (Shape::Near, 0) };
            let near = all.saturating_sub(first.1).saturating_sub(last.1);
            at = self.leg(Leg { from: at, joint: (0, 0), octant, steps: first.1, shape: first.0 });
            at = self.leg(Leg { from: at, joint, octant, steps: near, shape: Shape::Near });
            at = self.leg(Leg { from: at, joint: (0, 0), octant, steps: last.1, shape: last.0 });
            octant = Arc::octant_after(octant, arc.sense);
        }
    }

    /// Appends a leg, unless it is none; gives where it ends.
    fn leg(&mut self, leg: Leg) -> (i32, i32) {
        if leg.steps == 0 && leg.joint == (0, 0) {
            return leg.from;
        }
        if let Some(slot) = self.legs.get_mut(usize::from(self.count)) {
            *slot = leg;
            self.count = self.count.wrapping_add(1);
        }
        self.ahead(&leg, leg.from, (leg.joint, leg.steps))
    }
}

/// A pulse size as numerator and denominator.
fn ratio(pulse: PulseSize) -> (i128, i128) {
    (i128::from(pulse.numerator()), i128::from(pulse.denominator()))
}

/// From the start to a point (nm), as pulses: numerator and denominator.
fn pulses(pulse: PulseSize, to: i64, start: i32) -> (i128, i128) {
    let (num, den) = ratio(pulse);
    (i128::from(to).times(den).wrapping_sub(i128::from(start).times(num)), num)
}

/// The difference of two lattice points; `None` past 2^29 pulses.
fn delta(start: Lattice, end: Lattice) -> Option<(i32, i32)> {
    let part = |from: i32, to: i32| to.checked_sub(from).filter(|d| d.unsigned_abs() <= 1 << 29);
    Some((part(start.x, end.x)?, part(start.z, end.z)?))
}

/// Bits of a magnitude.
const fn bits(value: i128) -> u32 {
    128_u32.wrapping_sub(value.unsigned_abs().leading_zeros())
}

/// Two positive numbers in their ratio, with at most `most` bits.
fn shortened(a: i128, b: i128, most: u32) -> (i128, i128) {
    let (mut p, mut q) = (a, b);
    while let Some(rest) = p.rest(q) {
        (p, q) = (q, rest);
    }
    let (a, b) = (a.quotient(p).unwrap_or(1), b.quotient(p).unwrap_or(1));
    let cut = bits(a.max(b)).saturating_sub(most);
    (a.wrapping_shr(cut).max(1), b.wrapping_shr(cut).max(1))
}

/// Fraction bits of a coordinate in pulses, and of its square.
const FINE: u32 = 30;
const SQUARED: u32 = 40;

/// A weight times the square of a coordinate.
fn raised(weight: i128, coordinate: i128) -> i128 {
    weight.times(coordinate.squared() >> (2 * FINE - SQUARED))
}

/// The squares of a coordinate that is two pulses nearer to 0 and two pulses further from it.
fn squares_beside(coordinate: i128, pulse: PulseSize) -> (i128, i128) {
    let (distance, two) = (coordinate.saturating_abs(), size(pulse).wrapping_mul(2));
    (distance.wrapping_sub(two).max(0).squared(), distance.wrapping_add(two).squared())
}

impl Ellipse {
    /// Prepares the way from `start` to `end`; `reach` says whether it is the way round of at most half a turn or the
    /// other one; the same end as start is a whole turn then.
    pub fn arc(
        &self,
        (x, z): (PulseSize, PulseSize),
        start: Lattice,
        end: Lattice,
        (sense, reach): (Sense, Reach),
    ) -> Result<Conic, ConicRefusal> {
        let (half_x, half_z) = (i128::from(self.half_axes.0.nm()), i128::from(self.half_axes.1.nm()));
        if half_x <= 0 || half_z <= 0 {
            return Err(ConicRefusal::Flat);
        }
        let to = delta(start, end).ok_or(ConicRefusal::OutOfRange)?;
        if to == (0, 0) && reach == Reach::Short {
            return Err(ConicRefusal::NoPulse);
        }
        // half axes in pulses, 16 fraction bits
        let ((nx, dx), (nz, dz)) = (ratio(x), ratio(z));
        let (rx, rz) = (scale(half_x, dx << 16, nx), scale(half_z, dz << 16, nz));
        if rx.max(rz) >> 16 > 1 << 28 {
            return Err(ConicRefusal::OutOfRange);
        }
        if rx.min(rz) < 1 << 16 {
            return Err(ConicRefusal::TooSmall);
        }
        // a : b = (p_x S_z)^2 : (p_z S_x)^2, below 2^67 each before the square
        let (p, q) = shortened(nx.times(dz).times(half_z), nz.times(dx).times(half_x), 60);
        let (a, b) = (p.times(p), q.times(q));
        // the largest gradient, 2 a r_x or 2 b r_z, below 2^56
        let reach_bits = |weight: i128, r: i128| bits(weight).wrapping_add(bits(r >> 16));
        let excess = reach_bits(a, rx).max(reach_bits(b, rz)).saturating_sub(55);
        let room = 55_u32.saturating_sub(reach_bits(a, rx).max(reach_bits(b, rz)));
        let fit = |weight: i128| {
            let half = if excess > 0 { 1_i128.wrapping_shl(excess.wrapping_sub(1)) } else { 0 };
            weight.wrapping_add(half).wrapping_shr(excess).max(1).wrapping_shl(room)
        };
        let (a, b) = (fit(a), fit(b));
        if self.is_off((x, z), start) || self.is_off((x, z), end) {
            return Err(ConicRefusal::OffCurve);
        }
        let ((ox, ux), (oz, uz)) = (pulses(x, self.centre.0, start.x), pulses(z, self.centre.1, start.z));
        let (c, d) = (scale(a.wrapping_mul(2), ox, ux), scale(b.wrapping_mul(2), oz, uz));
        // F is 0 where x or z alone is the half axis: f = a x^2 + b z^2 - a r_x^2; of the larger half axis, as a rounded
        // ratio is off by more there
        let (weight, half) =
            if rx > rz { (a, scale(half_x, dx << FINE, nx)) } else { (b, scale(half_z, dz << FINE, nz)) };
        let near = raised(a, scale(ox, 1 << FINE, ux)).wrapping_add(raised(b, scale(oz, 1 << FINE, uz)));
        let f = scale(near.wrapping_sub(raised(weight, half)), 1, 1 << SQUARED);
        Conic::new(Octants::beside([a, b, c, d, f], to, (sense, reach)))
    }

    /// Whether the ellipse passes a lattice point by more than two pulses: outside the rectangle of two pulses each way
    /// about it. What two pulses change by the gradient alone is too little at the end of a slim axis.
    fn is_off(&self, (x, z): (PulseSize, PulseSize), at: Lattice) -> bool {
        let (u, v) = (place(x, at.x, self.centre.0), place(z, at.z, self.centre.1));
        if u.abs().max(v.abs()) >= 1 << 32 {
            return true;
        }
        // u^2 S_z^2 + v^2 S_x^2 beside S_x^2 S_z^2, below 2^127
        let (square_x, square_z) =
            (i128::from(self.half_axes.0.nm()).squared(), i128::from(self.half_axes.1.nm()).squared());
        let ((near_u, far_u), (near_v, far_v)) = (squares_beside(u, x), squares_beside(v, z));
        let reach = |u: i128, v: i128| u.times(square_z).saturating_add(v.times(square_x));
        let whole = square_x.times(square_z);
        reach(near_u, near_v) > whole || reach(far_u, far_v) < whole
    }
}

/// A pulse in nm, rounded up.
fn size(pulse: PulseSize) -> i128 {
    let (num, den) = ratio(pulse);
    num.quotient(den).unwrap_or(0).wrapping_add(1)
}

/// From a point (nm) to a lattice line, nm.
fn place(pulse: PulseSize, at: i32, from: i64) -> i128 {
    let (num, den) = ratio(pulse);
    scale(i128::from(at), num, den).wrapping_sub(i128::from(from))
}

impl Parabola {
    /// Prepares the way from `start` to `end`.
    pub fn arc(&self, (x, z): (PulseSize, PulseSize), start: Lattice, end: Lattice) -> Result<Conic, ConicRefusal> {
        let parameter = i128::from(self.parameter.nm());
        if parameter == 0 {
            return Err(ConicRefusal::Flat);
        }
        let to = delta(start, end).ok_or(ConicRefusal::OutOfRange)?;
        // across is squared, along is not
        let (pulse_across, pulse_along) = if self.axis == Axis::Z { (x, z) } else { (z, x) };
        let (vertex_across, start_across, to_across) = match self.axis {
            Axis::Z => (self.vertex.0, start.x, to.0),
            Axis::X => (self.vertex.1, start.z, to.1),
        };
        if to_across == 0 {
            return Err(ConicRefusal::NoPulse);
        }
        let ((n, d), (m, k)) = (ratio(pulse_across), ratio(pulse_along));
        // (n / d)^2 u^2 = 2 p (m / k) v: n^2 k below 2^60, 2 p m d^2 below 2^80
        let (a, e) = shortened(n.times(n).times(k), parameter.abs().wrapping_mul(2).times(m).times(d).times(d), 90);
        let (off, unit) = pulses(pulse_across, vertex_across, start_across);
        let far = off.abs().max(off.wrapping_sub(i128::from(to_across).times(unit)).abs());
        let far = far.quotient(unit).unwrap_or(0).wrapping_add(1);
        if far > 1 << 29 {
            return Err(ConicRefusal::OutOfRange);
        }
        // both gradients, 2 a u and e, below 2^56
        let size = bits(a).wrapping_add(bits(far)).wrapping_add(1).max(bits(e));
        let (excess, room) = (size.saturating_sub(56), 56_u32.saturating_sub(size));
        let half = if excess > 0 { 1_i128.wrapping_shl(excess.wrapping_sub(1)) } else { 0 };
        let fit = |weight: i128| weight.wrapping_add(half).wrapping_shr(excess).wrapping_shl(room);
        let (a, e) = (fit(a), fit(e));
        if a == 0 || e == 0 {
            return Err(ConicRefusal::TooSmall);
        }
        let c = scale(a.wrapping_mul(2), off, unit);
        let e = if parameter < 0 { e.wrapping_neg() } else { e };
        // seen from the side that it is open to, the way across is clockwise or not
        let falls = to_across < 0;
        if self.is_off((x, z), start) || self.is_off((x, z), end) {
            return Err(ConicRefusal::OffCurve);
        }
        // F is 0 at the vertex: f = a u^2 + e v
        let (vertex_along, start_along) = match self.axis {
            Axis::Z => (self.vertex.1, start.z),
            Axis::X => (self.vertex.0, start.x),
        };
        let (off_along, unit_along) = pulses(pulse_along, vertex_along, start_along);
        let along = e.times(scale(off_along, 1 << FINE, unit_along)) << (SQUARED - FINE);
        let f = scale(raised(a, scale(off, 1 << FINE, unit)).wrapping_add(along), 1, 1 << SQUARED);
        let (conic, counter) = match self.axis {
            Axis::Z => ([a, 0, c, e, f], falls == (e > 0)),
            Axis::X => ([0, a, e, c, f], falls != (e > 0)),
        };
        let sense = if counter { Sense::CounterClockwise } else { Sense::Clockwise };
        Conic::new(Octants::beside(conic, to, (sense, Reach::Short)))
    }

    /// Whether the parabola passes a lattice point by more than two pulses, as for an ellipse.
    fn is_off(&self, (x, z): (PulseSize, PulseSize), at: Lattice) -> bool {
        let (dx, dz) = (place(x, at.x, self.vertex.0), place(z, at.z, self.vertex.1));
        let (across, along, along_pulse) = match self.axis {
            Axis::Z => (squares_beside(dx, x), dz, z),
            Axis::X => (squares_beside(dz, z), dx, x),
        };
        let twice = i128::from(self.parameter.nm()).wrapping_mul(2);
        let (opens, two) = (twice.times(along), twice.saturating_abs().times(size(along_pulse).wrapping_mul(2)));
        across.0 > opens.saturating_add(two) || across.1 < opens.saturating_sub(two)
    }
}

#[cfg(test)]
#[path = "conic_tests.rs"]
mod tests;
