//! Corner blends: an arc tangent to both segments of a corner takes the corner's place.
//!
//! With e for the distance from the corner to the arc and phi for the angle between two lines, the arc's radius is
//! `R = e / (1 / sin(phi / 2) - 1)`, and `R / tan(phi / 2)` of each line is cut off. Where a segment is an arc, the
//! blend's centre lies where the curves at the distance R from both segments meet; it is found by Newton's method from
//! the corner, and R is made smaller until the departure and what is cut off are allowed. At most half of a segment is
//! cut off at each end, so two corners never meet.
//!
//! A corner stays sharp where the blend would be below three pulses of the coarser axis in radius (reversals, too),
//! where the machine passes it at full speed without a jump above `max_jump`, and where an arc of more than half a turn
//! has radii that differ by more than 2 nm: it is no one circle.
//!
//! Whole nanometres in and out, inside 16 fraction bits; directions have 40, angles 60. It runs in the background.

use crate::block::{Builder, Path, Speed};
use crate::config::Machine;
use crate::math::{Wide, angle_of, root_wide, to_i64};
use crate::units::{Length, Point, Sense};

/// Fraction bits of places.
const PLACE: u32 = 16;
/// Fraction bits of directions.
const UNIT: u32 = 40;
const ONE: i128 = 1 << UNIT;
/// A nanometre as a place.
const NM: i128 = 1 << PLACE;
/// What rounding to the nanometre may add to a departure or take from a segment.
const ROUNDING: i128 = 2 * NM;
/// Largest radius of a blend, and of an arc that is blended, nm.
const LARGEST: (i128, i128) = (2_100_000_000, 4_200_000_000);
/// Radii that are tried.
const TRIES: usize = 16;

/// A programmed feed, from end to end.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Segment {
    /// Where it starts.
    pub start: Point,
    /// Where it ends.
    pub end: Point,
    /// Its curve.
    pub path: Path,
}

/// How far a blend may leave its corner.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Allowance {
    /// At most so far.
    Within(Length),
    /// As far as it must so that this speed can be kept.
    Keeping(Speed),
}

/// The arc in place of a corner.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Blend {
    /// Where it begins, on the first segment.
    pub from: Point,
    /// Where it ends, on the second segment.
    pub to: Point,
    /// Its centre, X and Z in nm.
    pub centre: (i64, i64),
    /// Its sense.
    pub sense: Sense,
    /// The segments' curves for what is left of them: an arc's centre is moved onto the bisector of its programmed ends,
    /// where the walked circle has it.
    pub paths: [Path; 2],
}

/// Blends corners of one machine.
#[derive(Copy, Clone, Debug)]
pub struct Corners {
    machine: Machine,
    /// Smallest radius.
    least: i128,
}

#[derive(Copy, Clone, Debug, PartialEq, Eq)]
struct Vector {
    z: i128,
    x: i128,
}

impl Vector {
    const ZERO: Self = Self { z: 0, x: 0 };

    /// From the corner, nm.
    fn between(from: Point, to: Point) -> Self {
        let part = |from: Length, to: Length| i128::from(i64::from(to.nm()).wrapping_sub(i64::from(from.nm())));
        Self { z: part(from.z, to.z), x: part(from.x, to.x) }
    }

    fn plus(self, other: Self) -> Self {
        Self { z: self.z.wrapping_add(other.z), x: self.x.wrapping_add(other.x) }
    }

    fn minus(self, other: Self) -> Self {
        self.plus(other.reversed(true))
    }

    fn reversed(self, really: bool) -> Self {
        if really { Self { z: self.z.wrapping_neg(), x: self.x.wrapping_neg() } } else { self }
    }

    fn lifted(self, bits: u32) -> Self {
        Self { z: self.z.wrapping_shl(bits), x: self.x.wrapping_shl(bits) }
    }

    /// `self * by / whole`, rounded down.
    fn share(self, by: i128, whole: i128) -> Self {
        Self { z: ratio(self.z, by, whole), x: ratio(self.x, by, whole) }
    }

    fn dot(self, other: Self) -> i128 {
        self.z.times(other.z).wrapping_add(self.x.times(other.x))
    }

    /// Above zero where `other` is to the left.
    fn cross(self, other: Self) -> i128 {
        self.z.times(other.x).wrapping_sub(self.x.times(other.z))
    }

    fn left(self) -> Self {
        Self { z: self.x.wrapping_neg(), x: self.z }
    }

    /// Length, with the fraction bits of the parts.
    fn length(self) -> i128 {
        i128::from(root_wide(self.dot(self).unsigned_abs()))
    }

    /// The same direction with length one; `None` for the zero vector.
    fn unit(self) -> Option<Self> {
        let longest = self.z.unsigned_abs().max(self.x.unsigned_abs());
        let long = self.lifted(longest.leading_zeros().saturating_sub(68));
        let length = long.length();
        (length > 0).then(|| long.share(ONE, length))
    }
}

/// `a * b / c`, rounded down; 0 where c is not positive.
fn ratio(a: i128, b: i128, c: i128) -> i128 {
    if c > 0 { a.times(b).quotient(c).unwrap_or(0) } else { 0 }
}

#[derive(Copy, Clone, Debug)]
enum Shape {
    Line,
    Arc {
        centre: Vector,
        radius: i128,
        /// Counter-clockwise.
        left: bool,
    },
}

/// A segment seen from the corner.
#[derive(Copy, Clone, Debug)]
struct Side {
    shape: Shape,
    path: Path,
    /// Direction of travel at the corner.
    heading: Vector,
    /// What may be cut off.
    room: i128,
}

/// A circle that touches both sides.
#[derive(Copy, Clone, Debug)]
struct Touch {
    centre: Vector,
    feet: [Vector; 2],
    cut: [i128; 2],
}

impl Side {
    fn new(segment: &Segment, corner: Point) -> Option<Self> {
        let (start, end) = (Vector::between(corner, segment.start), Vector::between(corner, segment.end));
        let (shape, path, heading, length) = match segment.path {
            Path::Line => {
                let way = end.minus(start);
                (Shape::Line, Path::Line, way.unit()?, way.lifted(PLACE).length())
            }
            Path::Arc { centre: (x, z), sense } => {
                let part = |centre: i64, corner: Length| i128::from(centre).wrapping_sub(i128::from(corner.nm()));
                let centre = Vector { z: part(z, corner.z), x: part(x, corner.x) };
                let left = sense == Sense::CounterClockwise;
                let centre = circle(start, end, centre, left)?;
                let (from, to) = (start.lifted(PLACE).minus(centre), end.lifted(PLACE).minus(centre));
                let radius = from.length();
                if radius > LARGEST.1.wrapping_shl(PLACE) {
                    return None;
                }
                let turned = i128::from(angle(from, to, left));
                let sweep = match turned {
                    _ if start == end => TURN,
                    1.. => turned,
                    _ => turned.wrapping_add(TURN),
                };
                let heading = centre.reversed(true).left().reversed(!left).unit()?;
                let place = |part: i128, corner: Length| to_i64(round(part).wrapping_add(i128::from(corner.nm())));
                let path = Path::Arc { centre: (place(centre.x, corner.x), place(centre.z, corner.z)), sense };
                (Shape::Arc { centre, radius, left }, path, heading, radius.times(sweep) >> 60)
            }
        };
        let room = (length >> 1).wrapping_sub(ROUNDING);
        (room > 0).then_some(Self { shape, path, heading, room })
    }

    /// How far `at` lies to the `left` (or to the right) of the curve, and the direction in which that grows.
    fn offset(&self, at: Vector, left: bool) -> Option<(i128, Vector)> {
        match self.shape {
            Shape::Line => {
                let across = self.heading.left().reversed(!left);
                Some((across.dot(at) >> UNIT, across))
            }
            Shape::Arc { centre, radius, left: turns_left } => {
                let out = at.minus(centre);
                let distance = out.length();
                let inside = left == turns_left;
                let off = distance.wrapping_sub(radius);
                let across = out.share(ONE, distance).reversed(inside);
                (distance > 0).then_some((if inside { off.wrapping_neg() } else { off }, across))
            }
        }
    }

    /// The point of the curve nearest to `at`, and how far along the curve it lies from the corner: `before` it (the
    /// first side) or behind it.
    fn foot(&self, at: Vector, before: bool) -> (Vector, i128) {
        match self.shape {
            Shape::Line => {
                let along = self.heading.dot(at) >> UNIT;
                (self.heading.share(along, ONE), if before { along.wrapping_neg() } else { along })
            }
            Shape::Arc { centre, radius, left } => {
                let out = at.minus(centre);
                let foot = out.share(radius, out.length());
                let turned = angle(centre.reversed(true), foot, left != before);
                (centre.plus(foot), radius.times(i128::from(turned)) >> 60)
            }
        }
    }
}

/// A whole turn, 60 fraction bits.
const TURN: i128 = (crate::math::HALF_TURN_Q60 as i128) * 2;

/// From one vector to another, counted to the left or to the right: -pi to pi.
fn angle(from: Vector, to: Vector, left: bool) -> i64 {
    let across = from.cross(to);
    angle_of(from.dot(to), if left { across } else { across.wrapping_neg() })
}

/// Centre of the circle that an arc is on: the programmed one moved onto the bisector of its ends; with fraction bits.
fn circle(start: Vector, end: Vector, centre: Vector, left: bool) -> Option<Vector> {
    let (from, to) = (start.minus(centre), end.minus(centre));
    let across = if left { from.cross(to) } else { to.cross(from) };
    if across > 0 || (across == 0 && from.dot(to) < 0) {
        let (sum, chord) = (start.plus(end), end.minus(start).left());
        let square = chord.dot(chord);
        let along = chord.dot(centre.lifted(1).minus(sum));
        let place = |sum: i128, chord: i128| {
            let twice = sum.times(square).wrapping_add(chord.times(along));
            twice.wrapping_shl(PLACE).quotient(square.wrapping_shl(1))
        };
        return Some(Vector { z: place(sum.z, chord.z)?, x: place(sum.x, chord.x)? });
    }
    let apart = from.lifted(PLACE).length().wrapping_sub(to.lifted(PLACE).length());
    (apart.unsigned_abs() <= ROUNDING.unsigned_abs()).then(|| centre.lifted(PLACE))
}

/// To the nanometre, a half upward.
const fn round(place: i128) -> i128 {
    place.wrapping_add(NM / 2) >> PLACE
}

impl Corners {
    /// Of a machine.
    pub fn new(machine: &Machine) -> Self {
        let three = |pulse: crate::units::PulseSize| {
            ratio(NM.wrapping_mul(3), i128::from(pulse.numerator()), i128::from(pulse.denominator()))
        };
        Self { machine: *machine, least: three(machine.x.pulse).max(three(machine.z.pulse)) }
    }

    /// The blend between two segments, of which the second starts where the first ends; `None` where the corner stays
    /// sharp.
    pub fn blend(&self, first: &Segment, second: &Segment, allowed: Allowance) -> Option<Blend> {
        let corner = first.end;
        let sides = [Side::new(first, corner)?, Side::new(second, corner)?];
        let [before, behind] = [sides[0].heading, sides[1].heading];
        if self.is_straight(before, behind) {
            return None;
        }
        let left = before.cross(behind) > 0;
        // sine and cosine of half the angle by which the path turns
        let sine = behind.minus(before).length() >> 1;
        let cosine = behind.plus(before).length() >> 1;
        let largest = LARGEST.0.wrapping_shl(PLACE);
        // what two lines would allow, and the most that is asked for
        let (tolerance, most, asked) = match allowed {
            Allowance::Within(tolerance) => {
                let tolerance = i128::from(tolerance.nm()).wrapping_shl(PLACE).wrapping_sub(ROUNDING);
                // e c / (1 - c), without the difference
                let one_and = cosine.times(ONE.wrapping_add(cosine));
                (tolerance, ratio(tolerance, one_and, sine.squared()), largest)
            }
            Allowance::Keeping(speed) => {
                let accel = i128::from(self.machine.x.accel.min(self.machine.z.accel));
                let square = i128::from(speed).squared();
                // speed squared has 24 fraction bits, an acceleration 12
                let radius = ratio(square.wrapping_shl(4), 1000, accel.wrapping_mul(998)).min(largest);
                (largest, radius, radius)
            }
        };
        let room = ratio(sides[0].room.min(sides[1].room), cosine, sine);
        // the largest radius that was found good, the smallest that was found bad
        let (mut good, mut bad, mut found) = (self.least, asked.wrapping_add(1), None);
        let mut radius = most.min(room).min(asked);
        for _ in 0..TRIES {
            if radius < self.least {
                break;
            }
            let mut next = 0;
            match touch(&sides, radius, left) {
                Some(touch) => {
                    let departure = touch.centre.length().wrapping_sub(radius);
                    let limits = [(departure, tolerance), (touch.cut[0], sides[0].room), (touch.cut[1], sides[1].room)];
                    let scaled =
                        |(value, limit): (i128, i128)| if value > 0 { ratio(radius, limit, value) } else { asked };
                    next = limits.map(scaled).into_iter().min().unwrap_or(0).min(asked);
                    if limits.iter().all(|(value, limit)| *value <= limit.wrapping_add(NM)) {
                        (good, found) = (radius, Some(touch));
                        if next.wrapping_sub(radius) <= radius >> 4 {
                            break;
                        }
                    } else {
                        bad = radius;
                    }
                }
                None => bad = radius,
            }
            if bad.wrapping_sub(good) <= bad >> 4 {
                break;
            }
            next = next.wrapping_sub(next >> 6);
            radius = if good < next && next < bad { next } else { good.wrapping_add(bad) >> 1 };
        }
        finish(corner, &sides, &found?, left)
    }

    /// Whether the machine passes the corner at full speed.
    fn is_straight(&self, before: Vector, behind: Vector) -> bool {
        let direction = |v: Vector| (to_i64(v.x >> 10), to_i64(v.z >> 10));
        let (x, z) = (&self.machine.x, &self.machine.z);
        let speed = |heading| Builder::least(x.speed, z.speed, direction(heading)).0;
        let change = behind.minus(before);
        change == Vector::ZERO
            || Builder::least(x.jump, z.jump, direction(change)).0 >= speed(before).min(speed(behind))
    }
}

/// The circle of this radius that touches both sides near the corner.
fn touch(sides: &[Side; 2], radius: i128, left: bool) -> Option<Touch> {
    const ROUNDS: usize = 12;
    const FAR: i128 = 1 << 52;
    let [first, second] = sides;
    let mut centre = Vector::ZERO;
    for _ in 0..ROUNDS {
        let (off, across) = first.offset(centre, left)?;
        let (other_off, other_across) = second.offset(centre, left)?;
        let (lack, other_lack) = (radius.wrapping_sub(off), radius.wrapping_sub(other_off));
        let sine = across.cross(other_across) >> UNIT;
        let part = |a: i128, b: i128, c: i128, d: i128| {
            let whole = a.times(b).wrapping_sub(c.times(d));
            if sine < 0 { whole.wrapping_neg() } else { whole }.quotient(sine.saturating_abs())
        };
        let move_by = Vector {
            z: part(lack, other_across.x, other_lack, across.x)?,
            x: part(other_lack, across.z, lack, other_across.z)?,
        };
        centre = centre.plus(move_by);
        let step = move_by.z.unsigned_abs().max(move_by.x.unsigned_abs());
        if step > FAR.unsigned_abs() {
            return None;
        }
        // less than a 4096th of a nanometre
        if step < 16 {
            let ((foot, cut), (other_foot, other_cut)) = (first.foot(centre, true), second.foot(centre, false));
            let turn = foot.minus(centre).cross(other_foot.minus(centre));
            let fits = cut > 0 && other_cut > 0 && turn != 0 && (turn > 0) == left;
            return fits.then_some(Touch { centre, feet: [foot, other_foot], cut: [cut, other_cut] });
        }
    }
    None
}

/// Rounds to the nanometre.
fn finish(corner: Point, sides: &[Side; 2], touch: &Touch, left: bool) -> Option<Blend> {
    let whole = |place: i128, corner: Length| to_i64(round(place).wrapping_add(i128::from(corner.nm())));
    let point = |at: Vector| {
        Some(Point { x: Length::from_nm(whole(at.x, corner.x))?, z: Length::from_nm(whole(at.z, corner.z))? })
    };
    let (from, to) = (point(touch.feet[0])?, point(touch.feet[1])?);
    let centre = (whole(touch.centre.x, corner.x), whole(touch.centre.z, corner.z));
    let sense = if left { Sense::CounterClockwise } else { Sense::Clockwise };
    Some(Blend { from, to, centre, sense, paths: [sides[0].path, sides[1].path] })
}
