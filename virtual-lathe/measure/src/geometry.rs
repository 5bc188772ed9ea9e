//! Lines and arcs in the plane, in nanometres as `f64`.
//!
//! Coordinates stay below 10^12 nm, so a distance is right to about 10^-4 nm, 10^-7 of a pulse.
//! Seen with Z to the right and X upward; counter-clockwise turns are positive.

use std::ops::{Add, Mul, Sub};

/// A point or a vector, in nm.
#[derive(Copy, Clone, Debug, Default, PartialEq)]
pub(crate) struct Vector {
    pub(crate) z: f64,
    pub(crate) x: f64,
}

impl Add for Vector {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { z: self.z + other.z, x: self.x + other.x }
    }
}

impl Sub for Vector {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { z: self.z - other.z, x: self.x - other.x }
    }
}

impl Mul<f64> for Vector {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self { z: self.z * factor, x: self.x * factor }
    }
}

impl Vector {
    pub(crate) fn dot(self, other: Self) -> f64 {
        self.z * other.z + self.x * other.x
    }

    pub(crate) fn cross(self, other: Self) -> f64 {
        self.z * other.x - self.x * other.z
    }

    pub(crate) fn length(self) -> f64 {
        self.dot(self).sqrt()
    }

    /// Turned by a quarter, counter-clockwise.
    pub(crate) fn left(self) -> Self {
        Self { z: -self.x, x: self.z }
    }

    /// Of length one; zero stays zero.
    pub(crate) fn unit(self) -> Self {
        let length = self.length();
        if length > 0.0 { self * (1.0 / length) } else { Self::default() }
    }
}

/// A straight piece with its ends.
#[derive(Copy, Clone, Debug, PartialEq)]
pub(crate) struct Segment {
    pub(crate) start: Vector,
    pub(crate) end: Vector,
    /// Unit vector of travel, zero if the ends coincide.
    pub(crate) along: Vector,
    pub(crate) length: f64,
}

impl Segment {
    pub(crate) fn new(start: Vector, end: Vector) -> Self {
        let chord = end - start;
        Self { start, end, along: chord.unit(), length: chord.length() }
    }

    #[inline]
    fn distance(&self, point: Vector) -> f64 {
        let from = point - self.start;
        let progress = from.dot(self.along);
        if progress <= 0.0 {
            from.length()
        } else if progress > self.length {
            (point - self.end).length()
        } else {
            from.cross(self.along).abs()
        }
    }
}

/// A circular piece with its ends. Its sweep is above 0 and below 360 degrees.
///
/// Everything is told from the middle of the arc, so no angle needs unwrapping: a point of the arc
/// lies within half the sweep of `middle`, on either side.
#[derive(Copy, Clone, Debug, PartialEq)]
pub(crate) struct Arc {
    pub(crate) start: Vector,
    pub(crate) end: Vector,
    pub(crate) centre: Vector,
    pub(crate) radius: f64,
    /// Unit vector from the centre to the middle of the arc.
    pub(crate) middle: Vector,
    /// Unit vector of travel at the middle; it is that of the chord, too.
    pub(crate) along: Vector,
    pub(crate) clockwise: bool,
    /// Half of the sweep in radians, and its cosine.
    half: f64,
    cos_half: f64,
}

impl Arc {
    /// The arc from `start` to `end` about `centre` moved along the chord onto the perpendicular
    /// bisector of the ends. `None` if the ends coincide.
    pub(crate) fn new(start: Vector, end: Vector, centre: Vector, clockwise: bool) -> Option<Self> {
        let chord = end - start;
        let half_chord = chord.length() / 2.0;
        if half_chord <= 0.0 {
            return None;
        }
        let along = chord.unit();
        let chord_middle = (start + end) * 0.5;
        // A counter-clockwise arc bulges to the right of its chord.
        let middle = if clockwise { along.left() } else { along.left() * -1.0 };
        // The centre's place on the bisector: how far it lies back from the chord. Below zero, the
        // arc is longer than half a turn.
        let back = (chord_middle - centre).dot(middle);
        let radius = back.hypot(half_chord);
        Some(Self {
            start,
            end,
            centre: chord_middle - middle * back,
            radius,
            middle,
            along,
            clockwise,
            half: half_chord.atan2(back),
            cos_half: back / radius,
        })
    }

    /// The whole circle about `centre` from `start` on; `None` if that is the centre.
    pub(crate) fn whole(start: Vector, centre: Vector, clockwise: bool) -> Option<Self> {
        let radius = (start - centre).length();
        if radius <= 0.0 {
            return None;
        }
        // the middle of the sweep is across the circle
        let middle = (start - centre).unit() * -1.0;
        let along = if clockwise { middle.left() * -1.0 } else { middle.left() };
        let half = std::f64::consts::PI;
        Some(Self { start, end: start, centre, radius, middle, along, clockwise, half, cos_half: -1.0 })
    }

    pub(crate) fn length(&self) -> f64 {
        2.0 * self.half * self.radius
    }

    /// Whether the ray from the centre along `direction` meets the arc.
    #[inline]
    pub(crate) fn spans(&self, direction: Vector, length: f64) -> bool {
        direction.dot(self.middle) >= self.cos_half * length
    }

    #[inline]
    fn distance(&self, point: Vector) -> f64 {
        let from = point - self.centre;
        let radius = from.length();
        if self.spans(from, radius) {
            (radius - self.radius).abs()
        } else {
            let start = (point - self.start).length();
            start.min((point - self.end).length())
        }
    }

    /// Length of arc from the start to the point of the circle at `from` the centre, in nm; below
    /// zero before the start.
    fn progress(&self, from: Vector) -> f64 {
        let angle = from.dot(self.along).atan2(from.dot(self.middle));
        (angle + self.half) * self.radius
    }
}

/// A line or an arc.
#[derive(Copy, Clone, Debug, PartialEq)]
pub(crate) enum Curve {
    Line(Segment),
    Arc(Arc),
}

/// Where a point stands along a curve.
#[derive(Copy, Clone, Debug, PartialEq)]
pub(crate) struct Foot {
    /// Length of curve from the start to the foot, in nm.
    pub(crate) progress: f64,
    /// Whether X has more pulses per unit of curve here than Z.
    pub(crate) x_is_major: bool,
    /// Whether the major axis is the same for two coarser pulses around. Else the point may belong to
    /// the other axis's walk, and its foot is off by what that axis rounds.
    pub(crate) settled: bool,
}

impl Curve {
    pub(crate) fn length(&self) -> f64 {
        match self {
            Self::Line(line) => line.length,
            Self::Arc(arc) => arc.length(),
        }
    }

    /// Distance from `point` to the curve, its ends included, in nm.
    #[inline]
    pub(crate) fn distance(&self, point: Vector) -> f64 {
        match self {
            Self::Line(line) => line.distance(point),
            Self::Arc(arc) => arc.distance(point),
        }
    }

    /// Whether `step`, which led to `point`, went back along the curve by `least` nm or more. On arcs
    /// within the deviation over the radius.
    #[inline]
    pub(crate) fn goes_back(&self, point: Vector, step: Vector, least: f64) -> bool {
        match self {
            Self::Line(line) => step.dot(line.along) <= -least,
            Self::Arc(arc) => {
                let turn = (point - arc.centre).cross(step);
                let forward = if arc.clockwise { -turn } else { turn };
                forward <= -least * arc.radius
            }
        }
    }

    /// Vector of travel at the foot of `point`, of length one.
    fn travel(&self, point: Vector) -> Vector {
        match self {
            Self::Line(line) => line.along,
            Self::Arc(arc) => {
                let turn = if arc.clockwise { -1.0 } else { 1.0 };
                (point - arc.centre).unit().left() * turn
            }
        }
    }

    /// The point of the curve that has the major coordinate of `point`: its foot in the direction of
    /// the minor axis. `pulse_x` and `pulse_z` are the pulse equivalents in nm.
    pub(crate) fn foot(&self, point: Vector, pulse_x: f64, pulse_z: f64) -> Foot {
        let travel = self.travel(point);
        let lead = travel.x.abs() * pulse_z - travel.z.abs() * pulse_x;
        let x_is_major = lead > 0.0;
        let settled = match self {
            Self::Line(_) => true,
            // over a length s of arc the lead changes by at most s / R times the root of both squares
            Self::Arc(arc) => lead.abs() * arc.radius > 2.0 * pulse_x.max(pulse_z) * pulse_x.hypot(pulse_z),
        };
        let progress = match self {
            Self::Line(line) => {
                let from = point - line.start;
                if x_is_major { from.x / line.along.x } else { from.z / line.along.z }
            }
            Self::Arc(arc) => {
                let from = point - arc.centre;
                let other = |kept: f64| (arc.radius * arc.radius - kept * kept).max(0.0).sqrt();
                arc.progress(if x_is_major {
                    Vector { z: other(from.x).copysign(from.z), x: from.x }
                } else {
                    Vector { z: from.z, x: other(from.z).copysign(from.x) }
                })
            }
        };
        Foot { progress, x_is_major, settled }
    }

    /// Largest part that X and Z take of the speed anywhere on the curve, 0 to 1 each.
    pub(crate) fn largest_parts(&self) -> (f64, f64) {
        match self {
            Self::Line(line) => (line.along.x.abs(), line.along.z.abs()),
            Self::Arc(arc) => {
                let (first, last) = (self.travel(arc.start), self.travel(arc.end));
                let meets = |z: f64, x: f64| arc.spans(Vector { z, x }, 1.0) || arc.spans(Vector { z: -z, x: -x }, 1.0);
                // Travel is along X where the radius is along Z.
                let part = |all: bool, a: f64, b: f64| if all { 1.0 } else { a.abs().max(b.abs()) };
                (part(meets(1.0, 0.0), first.x, last.x), part(meets(0.0, 1.0), first.z, last.z))
            }
        }
    }
}
