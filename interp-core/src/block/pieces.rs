//! An axis-parallel ellipse or parabola as motions, one at a time.
//!
//! [`Pieces`] cuts the legs of a prepared conic into parts with a timeline ([`ConicPiece`]). It runs in the background and
//! holds one point of the curve, which is on the major line of the walk's. What a step is off the curve by along the minor
//! axis, at an end that is rounded as elsewhere, changes nothing in its time.
//!
//! From a point with the gradient (Gm, Gn), n being the minor axis, the curve at the major coordinate `m + u` is at `n + v`
//! with
//!
//! ```text
//! v = -2 (am u^2 + Gm u) / (Gn + r)       r^2 = Gn^2 - 4 an (am u^2 + Gm u), r with the sign of Gn
//! ```
//!
//! and r is the gradient there: nothing cancels, and with an = 0 it is a parabola. A part's eight eighths give its length,
//! chord sums of two, four and eight chords extrapolated twice (Romberg), its tangents, and the radius of its curvature,
//! which is that of the quarter that turns most for its length. Parts are as long as the cubic timeline allows: within
//! a 24th of a pulse at the quarters, else half as long.

use super::builder::{CURVATURE_SHARE, Direction, Run};
use super::chain::{angle_between, extent, unit};
use super::{Builder, Curve, Limited, Motion, Pace};
use crate::curve::arc::Arc;
use crate::curve::conic::{Conic, ConicRefusal, Ellipse, Parabola};
use crate::curve::conic_part::ConicPart;
use crate::curve::conic_piece::ConicPiece;
use crate::curve::prepare_arc::Reach;
use crate::curve::proportion::Proportion;
use crate::math::{Wide, root_wide, scale, to_i64, to_u32, to_u64};
use crate::units::{Axis, Point, PulseSize, Sense};

/// Steps of a part at most: its timeline fits 64 bits.
const MOST_STEPS: u32 = 1 << 12;

/// A 24th of a pulse, 16 fraction bits.
const CLOSE: u64 = 2730;

/// Where the second extrapolation changes a length by less than its 2^-20th, what it leaves is below 1e-7.
const CONVERGED: u32 = 20;

/// Bits by which gradients are finer than the conic's coefficients.
const FINER: u32 = 3;

/// A point of the curve.
#[derive(Copy, Clone, Debug)]
struct Spot {
    /// X and Z, pulses from the conic's start, 32 fraction bits.
    place: (i128, i128),
    /// Gradient, X and Z.
    gradient: (i128, i128),
}

/// A conic on its way into motions.
#[derive(Clone, Debug)]
pub struct Pieces {
    conic: Conic,
    end: Point,
    pace: Pace,
    limited: Option<Limited>,
    /// The present leg.
    leg: usize,
    /// Steps of it that are done.
    done: u32,
    /// Where the walk is, and the point of the curve there.
    at: (i32, i32),
    spot: Spot,
    /// Steps to try next.
    span: u32,
}

impl Pieces {
    /// The ellipse from where the builder stands to `end`; `reach` says whether it is the way round of at most half a turn
    /// or the other one: the same end as start is a whole turn then.
    ///
    /// # Errors
    /// Those of [`Ellipse::arc`].
    pub fn ellipse(
        builder: &Builder,
        ellipse: &Ellipse,
        end: Point,
        (sense, reach): (Sense, Reach),
        pace: Pace,
    ) -> Result<Self, ConicRefusal> {
        let (pulses, to) = ((builder.machine.x.pulse, builder.machine.z.pulse), builder.rounded(end));
        let conic = ellipse.arc(pulses, builder.lattice, to, (sense, reach))?;
        Ok(Self::new(conic, end, pace))
    }

    /// The parabola from where the builder stands to `end`.
    ///
    /// # Errors
    /// Those of [`Parabola::arc`].
    pub fn parabola(builder: &Builder, parabola: &Parabola, end: Point, pace: Pace) -> Result<Self, ConicRefusal> {
        let (pulses, to) = ((builder.machine.x.pulse, builder.machine.z.pulse), builder.rounded(end));
        let conic = parabola.arc(pulses, builder.lattice, to)?;
        Ok(Self::new(conic, end, pace))
    }

    fn new(conic: Conic, end: Point, pace: Pace) -> Self {
        let axis = conic.legs().first().map_or(Axis::X, |leg| Arc::major(leg.octant));
        let spot = Spot::first(&conic, axis);
        Self { conic, end, pace, limited: None, leg: 0, done: 0, at: (0, 0), spot, span: 64 }
    }

    /// The feed that an axis's maximum cut down most, on what was made so far.
    pub const fn limited(&self) -> Option<Limited> {
        self.limited
    }

    /// The next motion; `None` behind the last one.
    pub fn next_motion(&mut self, builder: &mut Builder) -> Option<Motion> {
        let leg = *self.conic.legs().get(self.leg)?;
        let joint = if self.done == 0 { leg.joint } else { (0, 0) };
        let left = leg.steps.wrapping_sub(self.done);
        let mut steps = left.min(self.span).min(MOST_STEPS);
        let (draft, to) = loop {
            let to = self.conic.ahead(&leg, self.at, (joint, steps));
            let draft = self.draft(leg.octant, to, builder);
            if draft.holds || steps <= 1 {
                break (draft, to);
            }
            steps >>= 1;
        };
        self.span = steps.saturating_mul(2).max(8);
        let part = self.conic.part(&leg, self.at, (joint, steps));
        let motion = self.motion(&draft, part, builder);
        (self.at, self.spot) = (to, draft.end);
        self.done = self.done.wrapping_add(steps);
        if self.done == leg.steps {
            (self.leg, self.done) = (self.leg.wrapping_add(1), 0);
        }
        let last = self.leg == self.conic.legs().len();
        if last {
            builder.at = self.end;
        }
        motion.map(|motion| Motion { continues: !last, ..motion })
    }

    /// The motion over a part that was found short enough.
    fn motion(&mut self, draft: &Draft, part: ConicPart, builder: &mut Builder) -> Option<Motion> {
        let (length, radius) = (draft.length, draft.radius);
        let piece = ConicPiece {
            part,
            cubic: draft.cubic,
            share: Proportion::new(1 << 30, length, length),
            radius,
            angle: Proportion::new(1 << 30, radius, length.min(radius)),
        };
        builder.lattice.x = builder.lattice.x.wrapping_add(part.end.0);
        builder.lattice.z = builder.lattice.z.wrapping_add(part.end.1);
        let by_axis = builder.speed_limit(draft.extent);
        let accel = builder.machine.x.accel.min(builder.machine.z.accel);
        // v^2 = 0.998 a R
        let square = u128::from(accel).saturating_mul(u128::from(radius)).saturating_mul(CURVATURE_SHARE) / 1000;
        let run = Run {
            length,
            reach: length,
            entry: draft.entry,
            exit: draft.exit,
            by_axis,
            by_bend: to_u32(root_wide(square)),
            accel,
        };
        builder.chained(Curve::Conic(piece), &run, self.pace, &mut self.limited)
    }

    /// Looks at the part up to the curve on a lattice point's major line.
    fn draft(&self, octant: u8, to: (i32, i32), builder: &Builder) -> Draft {
        let axis = Arc::major(octant);
        let (sign_x, sign_z) = Arc::signs(octant, self.conic.sense);
        let pulses = (builder.machine.x.pulse, builder.machine.z.pulse);
        let (line, begun, line_from, sign, pulse) = match axis {
            Axis::X => (to.0, self.spot.place.0, self.at.0, sign_x, pulses.0),
            Axis::Z => (to.1, self.spot.place.1, self.at.1, sign_z, pulses.1),
        };
        // none back, where an end is so near a border of octants that its line lies before that
        let ahead = (i128::from(line) << 32).wrapping_sub(begun).wrapping_mul(i128::from(sign)).max(0);
        let way = ahead.wrapping_mul(i128::from(sign));
        let eighths = |from: Spot, way: i128| {
            let mut spots = [from; 9];
            for (eighths, spot) in (0_i128..).zip(&mut spots) {
                *spot = from.further(self.conic.fine(), axis, way.wrapping_mul(eighths) >> 3);
            }
            spots
        };
        let spots = eighths(self.spot, way);
        let mut lengths = Lengths::new(&spots, pulses);
        let coarse = lengths.more.unsigned_abs() > lengths.whole() >> CONVERGED;
        if coarse {
            // a bend of a few pulses: each eighth is divided again
            let mut parts = spots.map(|spot| Lengths::new(&eighths(spot, way >> 3), pulses).whole());
            parts[8] = 0;
            lengths = Lengths::of_eighths(&parts);
        }
        let tangent = |spot: &Spot| spot.tangent(axis, sign, pulses);
        let quarters = [0, 2, 4, 6, 8].map(|k: usize| spots.get(k).map_or((0, 0), tangent));
        let [entry, .., exit] = quarters;
        let mut radius = u64::MAX;
        let mut most = (0, 0);
        for (pair, quarter) in quarters.windows(2).zip(lengths.quarters) {
            let [a, b] = pair else { continue };
            let turn = i128::from(angle_between(*a, *b));
            if turn > 0 {
                radius = radius.min(to_u64(scale(i128::from(quarter >> 12), 1 << 60, turn)));
            }
            let part = extent(*a, *b);
            most = (part.0.max(most.0), part.1.max(most.1));
        }
        // a 64th less for what the average over a quarter hides; past 2^48, 68 km, it is straight
        let radius = radius.min(1 << 48);
        let radius = radius.wrapping_sub(radius >> 6).max(1);
        let length = (lengths.whole().wrapping_add(1 << 11) >> 12).max(1);
        // along the travel from the lattice line where the part begins, 16 fraction bits
        let along = |spot: &Spot| {
            let place = if axis == Axis::X { spot.place.0 } else { spot.place.1 };
            to_i64(place.wrapping_sub(i128::from(line_from) << 32).wrapping_mul(i128::from(sign)) >> 16)
        };
        let slope = |tangent: Direction| {
            let part = if axis == Axis::X { tangent.0 } else { tangent.1 };
            let along = i128::from(part).wrapping_mul(i128::from(sign)).times(i128::from(length));
            // 12 and 30 fraction bits to 16
            to_i64(scale(along, i128::from(pulse.denominator()), i128::from(pulse.numerator()) << 26))
        };
        let cubic = hermite((along(&spots[0]), along(&spots[8])), (slope(entry), slope(exit)));
        let end = spots[8];
        let near = |reached: u64, spot: &Spot| {
            let part = to_i64(scale(i128::from(reached), 1 << 30, i128::from(lengths.whole().max(1))));
            value(cubic, part).abs_diff(along(spot)) <= CLOSE
        };
        let [first, second, third, _] = lengths.quarters;
        let half = first.wrapping_add(second);
        let holds = near(first, &spots[2]) && near(half, &spots[4]) && near(half.wrapping_add(third), &spots[6]);
        Draft { holds, end, length, entry, exit, radius, extent: most, cubic }
    }
}

/// A part on trial.
struct Draft {
    holds: bool,
    end: Spot,
    length: u64,
    entry: Direction,
    exit: Direction,
    radius: u64,
    extent: Direction,
    cubic: [i64; 4],
}

/// Coefficients of the cubic with these values and slopes at 0 and 1.
fn hermite((from, to): (i64, i64), (begin, end): (i64, i64)) -> [i64; 4] {
    let way = to.wrapping_sub(from);
    let square = way.wrapping_mul(3).wrapping_sub(begin.wrapping_mul(2)).wrapping_sub(end);
    [from, begin, square, begin.wrapping_add(end).wrapping_sub(way.wrapping_mul(2))]
}

/// A cubic at a part of one, 30 fraction bits.
fn value([a, b, c, d]: [i64; 4], part: i64) -> i64 {
    let times = |value: i64| to_i64(i128::from(value).times(i128::from(part)) >> 30);
    a.wrapping_add(times(b.wrapping_add(times(c.wrapping_add(times(d))))))
}

/// From a point along the minor axis to where `F`, 32 fraction bits, is 0: the way, 32 fraction bits, and the gradient there;
/// the weight and the gradient of the axis given.
fn sideways((an, gn): (i128, i128), product: i128) -> (i128, i128) {
    let square = gn.times(gn).wrapping_sub(an.wrapping_mul(4).times(product >> 32)).max(0);
    let root = i128::from(root_wide(square.unsigned_abs())).wrapping_mul(if gn < 0 { -1 } else { 1 });
    let sum = gn.wrapping_add(root);
    (scale(product.wrapping_mul(if sum < 0 { 2 } else { -2 }), 1, sum.saturating_abs()), root)
}

impl Spot {
    /// The point of the curve on the start's line of a major axis.
    fn first(conic: &Conic, axis: Axis) -> Self {
        let [a, b, c, d, f] = conic.fine().map(|value| i128::from(value) << FINER);
        let (an, gm, gn) = match axis {
            Axis::X => (b, c.wrapping_neg(), d.wrapping_neg()),
            Axis::Z => (a, d.wrapping_neg(), c.wrapping_neg()),
        };
        let (sideways, root) = sideways((an, gn), f << 32);
        match axis {
            Axis::X => Self { place: (0, sideways), gradient: (gm, root) },
            Axis::Z => Self { place: (sideways, 0), gradient: (root, gm) },
        }
    }

    /// The point of the curve whose major coordinate is `way` further, 32 fraction bits.
    fn further(&self, [a, b, ..]: [i64; 5], axis: Axis, way: i128) -> Self {
        let (a, b) = (i128::from(a) << FINER, i128::from(b) << FINER);
        let (am, an, gm, gn) = match axis {
            Axis::X => (a, b, self.gradient.0, self.gradient.1),
            Axis::Z => (b, a, self.gradient.1, self.gradient.0),
        };
        let lift = am.times(way) >> 32;
        let product = gm.wrapping_add(lift).times(way);
        let (sideways, root) = sideways((an, gn), product);
        let gradient = gm.wrapping_add(lift.wrapping_mul(2));
        let (x, z) = self.place;
        match axis {
            Axis::X => Self { place: (x.wrapping_add(way), z.wrapping_add(sideways)), gradient: (gradient, root) },
            Axis::Z => Self { place: (x.wrapping_add(sideways), z.wrapping_add(way)), gradient: (root, gradient) },
        }
    }

    /// Direction of travel: square to the gradient in mm, along the major axis with `sign`.
    fn tangent(&self, axis: Axis, sign: i8, (x, z): (PulseSize, PulseSize)) -> Direction {
        let size = |p: PulseSize, q: PulseSize| i128::from(p.numerator()).times(i128::from(q.denominator()));
        let (gx, gz) = (self.gradient.0 >> 10, self.gradient.1 >> 10);
        let (along_x, along_z) = (gz.times(size(x, z)), gx.times(size(z, x)).wrapping_neg());
        let major = if axis == Axis::X { along_x } else { along_z };
        let (x, z) = unit((along_x, along_z)).unwrap_or((0, 0));
        if (major < 0) == (sign < 0) { (x, z) } else { (x.wrapping_neg(), z.wrapping_neg()) }
    }
}

/// Lengths of a part's quarters, nm with 24 fraction bits.
struct Lengths {
    quarters: [u64; 4],
    /// What the second extrapolation adds to the whole.
    more: i64,
}

impl Lengths {
    fn new(spots: &[Spot; 9], (x, z): (PulseSize, PulseSize)) -> Self {
        let nm = |off: i128, pulse: PulseSize| {
            scale(off, i128::from(pulse.numerator()), i128::from(pulse.denominator()) << 8)
        };
        let reach = |a: usize, b: usize| {
            let (Some(a), Some(b)) = (spots.get(a), spots.get(b)) else { return 0 };
            let (dx, dz) = (b.place.0.wrapping_sub(a.place.0), b.place.1.wrapping_sub(a.place.1));
            i128::from(root_wide(nm(dx, x).squared().saturating_add(nm(dz, z).squared()).unsigned_abs()))
        };
        let once = |coarse: i128, fine: i128| fine.wrapping_add(scale(fine.wrapping_sub(coarse), 1, 3));
        let quarter = |k: usize| {
            let (a, b, c) = (k, k.wrapping_add(1), k.wrapping_add(2));
            once(reach(a, c), reach(a, b).wrapping_add(reach(b, c)))
        };
        let quarters = [quarter(0), quarter(2), quarter(4), quarter(6)];
        let half = |k: usize| {
            let (a, b, c) = (k, k.wrapping_add(2), k.wrapping_add(4));
            let two = once(reach(a, c), reach(a, b).wrapping_add(reach(b, c)));
            let four = quarter(a).wrapping_add(quarter(b));
            scale(four.wrapping_sub(two), 1, 15)
        };
        Self { quarters: quarters.map(to_u64), more: to_i64(half(0).wrapping_add(half(4))) }
    }

    fn of_eighths(parts: &[u64; 9]) -> Self {
        let quarter = |k: usize| parts.iter().skip(k).take(2).fold(0, |sum, part| u64::wrapping_add(sum, *part));
        Self { quarters: [0, 2, 4, 6].map(quarter), more: 0 }
    }

    fn whole(&self) -> u64 {
        self.quarters.iter().fold(0, |sum, quarter| u64::wrapping_add(sum, *quarter)).saturating_add_signed(self.more)
    }
}
