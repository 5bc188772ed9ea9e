//! From a programmed motion to the curves that the train is held against.
//!
//! * **Walked curve**: joins the rounded ends. An arc's programmed centre is moved along the chord onto
//!   the perpendicular bisector of the rounded ends.
//! * **Programmed curve**: the same with the ends as programmed; for equal radii it is the circle about
//!   the programmed centre.
//! * **Piece**: what is walked in one go. An arc that turns by more than 180 degrees is one piece if moving its
//!   centre onto the bisector moves it by at most a 16th of the coarser pulse (full circles always are: they
//!   have no chord). Else it has two pieces, which meet
//!   at the lattice point nearest to the programmed point at half the sweep (its radius is the mean of
//!   start and end radius; like any programmed point it is a whole number of nanometres). A piece whose rounded ends coincide makes no pulses and is left out.
//!
//! Whether an arc turns by more than 180 degrees is told from the programmed points, in integers.

use crate::geometry::{Arc, Curve, Segment, Vector};
use crate::setup::{PerAxis, Setup};

/// Shape of a programmed motion.
#[derive(Copy, Clone, Debug, PartialEq)]
pub enum Shape {
    /// Straight to the end.
    Line,
    /// Round the centre; an end equal to the start is a full circle.
    Arc {
        /// Programmed centre in nm.
        centre_nm: PerAxis<i64>,
        /// Turning clockwise, seen with Z to the right and X upward.
        clockwise: bool,
    },
}

/// A programmed motion; it starts where the last one ended.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Motion {
    /// Line of the program, for the report.
    pub line: u32,
    /// Line or arc.
    pub shape: Shape,
    /// Programmed end in nm.
    pub end_nm: PerAxis<i64>,
    /// Programmed feed in mm/min; `None` for a rapid.
    pub feed_mm_min: Option<f64>,
}

/// The part of a set-up that makes curves of motions.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Scale {
    setup: Setup,
    pub(crate) nm_x: f64,
    pub(crate) nm_z: f64,
    /// The coarser pulse equivalent, in nm.
    pub(crate) coarser: f64,
}

impl Scale {
    pub(crate) fn new(setup: Setup) -> Self {
        let (nm_x, nm_z) = (setup.pulse_nm.x.nm(), setup.pulse_nm.z.nm());
        Self { setup, nm_x, nm_z, coarser: nm_x.max(nm_z) }
    }

    /// Place of a lattice point, in nm.
    #[inline]
    pub(crate) fn place(&self, at: PerAxis<i32>) -> Vector {
        Vector { z: f64::from(at.z) * self.nm_z, x: f64::from(at.x) * self.nm_x }
    }

    /// The nearest lattice point, half a pulse toward plus infinity.
    pub(crate) fn nearest(&self, nm: PerAxis<i64>) -> PerAxis<i64> {
        PerAxis { x: self.setup.pulse_nm.x.nearest(nm.x), z: self.setup.pulse_nm.z.nearest(nm.z) }
    }

    /// A place as a program would say it: to the nanometre, a half toward plus infinity. What is 1e-4 nm
    /// short of a half is one, as the place is right to 1e-5 nm.
    #[expect(clippy::cast_possible_truncation, reason = "saturates; a place is far below 2^53 nm")]
    fn to_nanometre(place: Vector) -> PerAxis<i64> {
        let round = |nm: f64| (nm + 0.5 + 1e-4).floor() as i64;
        PerAxis { x: round(place.x), z: round(place.z) }
    }

    /// Whether a long arc between these rounded ends is walked whole: moving its centre along the chord onto their
    /// bisector moves it by at most a 16th of the coarser pulse, (r1 - r0) R / chord.
    fn keeps_centre(&self, start: PerAxis<i64>, end: PerAxis<i64>, centre: Vector) -> bool {
        let (start, end) = (self.wide_place(start), self.wide_place(end));
        let (first, last) = ((start - centre).length(), (end - centre).length());
        (last - first).abs() * first <= (end - start).length() * self.coarser / 16.0
    }

    /// Place of a lattice point that may lie outside the range of positions.
    #[expect(clippy::cast_precision_loss, reason = "ends are far below 2^53 pulses")]
    fn wide_place(&self, at: PerAxis<i64>) -> Vector {
        Vector { z: at.z as f64 * self.nm_z, x: at.x as f64 * self.nm_x }
    }

    /// Highest speed (mm/s) and the acceleration along the path (mm/s²) that the axes allow on
    /// `curves`: each axis's own limit in the least favourable direction met, and sqrt(a R) on arcs,
    /// where a is the smaller axis acceleration (where the speed is a mean, 7/8 of it, which it is planned with).
    fn allowed(&self, curves: [Option<&Curve>; 2]) -> (f64, f64) {
        let (x, z) = (self.setup.limits.x, self.setup.limits.z);
        let smaller = x.max_accel.min(z.max_accel);
        let (mut speed, mut accel) = (f64::INFINITY, f64::INFINITY);
        for curve in curves.into_iter().flatten() {
            let (part_x, part_z) = curve.largest_parts();
            speed = speed.min(x.max_feed / 60.0 / part_x).min(z.max_feed / 60.0 / part_z);
            match curve {
                Curve::Line(_) => {
                    accel = accel.min(x.max_accel / part_x).min(z.max_accel / part_z);
                }
                Curve::Arc(arc) => {
                    let planned = if self.setup.smoothed_ticks > 0 { 7.0 / 8.0 * smaller } else { smaller };
                    speed = speed.min((planned * arc.radius / 1e6).sqrt());
                    accel = accel.min(smaller);
                }
            }
        }
        (speed, accel)
    }
}

/// What is walked in one go.
#[derive(Copy, Clone, Debug, PartialEq)]
pub(crate) struct Piece {
    pub(crate) curve: Curve,
    /// Rounded end, in pulses.
    pub(crate) end: PerAxis<i64>,
    /// Length of the motion before this piece, in nm.
    pub(crate) before: f64,
}

/// A motion made ready.
#[derive(Copy, Clone, Debug, PartialEq)]
pub(crate) struct Path {
    pub(crate) line: u32,
    /// The piece walked first, and what follows it.
    pub(crate) first: Piece,
    pub(crate) second: Option<Piece>,
    programmed: (Curve, Option<Curve>),
    /// Length of the walked curve, in mm.
    pub(crate) length_mm: f64,
    /// Programmed feed in mm/s; `None` for a rapid.
    pub(crate) feed: Option<f64>,
    /// Speed that the axes allow on the programmed curve, in mm/s.
    pub(crate) allowed: f64,
    /// Acceleration along the path that the axes allow, in mm/s².
    pub(crate) accel: f64,
}

/// Where motions meet: as programmed, and the lattice point.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Waypoint {
    pub(crate) nm: PerAxis<i64>,
    pub(crate) at: PerAxis<i64>,
}

#[expect(clippy::cast_precision_loss, reason = "programmed places are far below 2^53 nm")]
fn exact(nm: PerAxis<i64>) -> Vector {
    Vector { z: nm.z as f64, x: nm.x as f64 }
}

/// Whether the arc turns by more than 180 degrees. Exact.
fn turns_past_half(start: PerAxis<i64>, end: PerAxis<i64>, centre: PerAxis<i64>, cw: bool) -> bool {
    if start == end {
        return true;
    }
    let from = |nm: PerAxis<i64>| (i128::from(nm.z) - i128::from(centre.z), i128::from(nm.x) - i128::from(centre.x));
    let ((sz, sx), (ez, ex)) = (from(start), from(end));
    let cross = sz * ex - sx * ez;
    if cw { cross > 0 } else { cross < 0 }
}

/// The programmed point at half the sweep, for a sweep of 180 degrees and more.
fn half_way(start: Vector, end: Vector, centre: Vector, clockwise: bool) -> Vector {
    let (start, end) = (start - centre, end - centre);
    let radius = (start.length() + end.length()) / 2.0;
    let (a, b) = (start.unit(), end.unit());
    // The longer of the two is sharp: the sum past 270 degrees, the difference before.
    let (sum, difference) = (a + b, a - b);
    let direction = if sum.length() > difference.length() {
        sum * -1.0
    } else if clockwise {
        difference.left() * -1.0
    } else {
        difference.left()
    };
    centre + direction.unit() * radius
}

impl Path {
    /// The path of `motion` from `from`; `None` if it makes no pulses. The rounded end comes with it.
    pub(crate) fn new(scale: &Scale, from: Waypoint, motion: &Motion) -> (Option<Self>, Waypoint) {
        let to = Waypoint { nm: motion.end_nm, at: scale.nearest(motion.end_nm) };
        let (start_nm, end_nm) = (exact(from.nm), exact(to.nm));
        let curve = |start: Vector, end: Vector| match motion.shape {
            Shape::Line => Curve::Line(Segment::new(start, end)),
            Shape::Arc { centre_nm, clockwise } => Arc::new(start, end, exact(centre_nm), clockwise)
                .map_or_else(|| Curve::Line(Segment::new(start, end)), Curve::Arc),
        };
        let round = |start: PerAxis<i64>, end: PerAxis<i64>, centre_nm: PerAxis<i64>, clockwise: bool| {
            let (start_at, end_at) = (scale.wide_place(start), scale.wide_place(end));
            let arc = if start == end {
                // a whole turn about less than a pulse stays where it is
                let turns = (start_at - exact(centre_nm)).length() >= scale.coarser;
                if turns { Arc::whole(start_at, exact(centre_nm), clockwise) } else { None }
            } else {
                Arc::new(start_at, end_at, exact(centre_nm), clockwise)
            };
            arc.map(|arc| Piece { curve: Curve::Arc(arc), end, before: 0.0 })
        };
        let piece = |start: PerAxis<i64>, end: PerAxis<i64>| {
            (start != end).then(|| Piece {
                curve: curve(scale.wide_place(start), scale.wide_place(end)),
                end,
                before: 0.0,
            })
        };
        let past_half = match motion.shape {
            Shape::Line => false,
            Shape::Arc { centre_nm, clockwise } => turns_past_half(from.nm, to.nm, centre_nm, clockwise),
        };
        let (pieces, programmed) = match motion.shape {
            Shape::Arc { centre_nm, clockwise } if past_half => {
                let half_nm = half_way(start_nm, end_nm, exact(centre_nm), clockwise);
                let programmed = (curve(start_nm, half_nm), Some(curve(half_nm, end_nm)));
                if scale.keeps_centre(from.at, to.at, exact(centre_nm)) {
                    ([round(from.at, to.at, centre_nm, clockwise), None], programmed)
                } else {
                    let half = scale.nearest(Scale::to_nanometre(half_nm));
                    ([piece(from.at, half), piece(half, to.at)], programmed)
                }
            }
            Shape::Line | Shape::Arc { .. } => ([piece(from.at, to.at), None], (curve(start_nm, end_nm), None)),
        };
        let [first, second] = pieces;
        let Some(first) = first.or(second) else {
            return (None, to);
        };
        let second =
            second.filter(|_| pieces[0].is_some()).map(|piece| Piece { before: first.curve.length(), ..piece });
        let length = first.curve.length() + second.map_or(0.0, |piece| piece.curve.length());
        let (allowed, accel) = scale.allowed([Some(&programmed.0), programmed.1.as_ref()]);
        let path = Self {
            line: motion.line,
            first,
            second,
            programmed,
            length_mm: length / 1e6,
            feed: motion.feed_mm_min.map(|feed| feed / 60.0),
            allowed,
            accel,
        };
        (Some(path), to)
    }

    /// Distance from `point` to the whole programmed curve, in nm.
    #[inline]
    pub(crate) fn programmed_distance(&self, point: Vector) -> f64 {
        let first = self.programmed.0.distance(point);
        match &self.programmed.1 {
            None => first,
            Some(second) => first.min(second.distance(point)),
        }
    }

    /// The piece walked last.
    pub(crate) fn last(&self) -> &Piece {
        self.second.as_ref().unwrap_or(&self.first)
    }
}

#[cfg(test)]
mod tests {
    use super::{half_way, turns_past_half};
    use crate::geometry::Vector;
    use crate::setup::PerAxis;
    use proptest::prelude::proptest;

    proptest! {
        /// Against angles from the arc tangent, which is another way to get there.
        #[test]
        fn half_way_point_is_at_half_the_angle(
            angle in 0_u32..3600, sweep in 1_u32..3600, cw: bool,
        ) {
            let place = |tenths: f64| {
                let angle = (tenths / 10.0).to_radians();
                Vector { z: 5e8 * angle.cos(), x: 5e8 * angle.sin() }
            };
            let turn = if cw { -1.0 } else { 1.0 };
            let (angle, sweep) = (f64::from(angle), f64::from(sweep) * turn);
            let (start, end) = (place(angle), place(angle + sweep));
            #[expect(clippy::cast_possible_truncation, reason = "half a metre in nm")]
            let exact = |at: Vector| PerAxis { x: at.x.round() as i64, z: at.z.round() as i64 };
            if sweep.abs() > 1_800.5 {
                assert!(turns_past_half(exact(start), exact(end), PerAxis { x: 0, z: 0 }, cw));
                let half = half_way(start, end, Vector::default(), cw);
                assert!((half - place(angle + sweep / 2.0)).length() < 1e-4);
            } else if sweep.abs() < 1_799.5 {
                assert!(!turns_past_half(exact(start), exact(end), PerAxis { x: 0, z: 0 }, cw));
            }
        }
    }
}
