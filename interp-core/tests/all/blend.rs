//! Blends against closed forms and against geometry in `f64`.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::unwrap_used,
    missing_docs,
    reason = "a test whose oracle is in f64"
)]

use interp_core::blend::{Allowance, Blend, Corners, Segment};
use interp_core::block::{Builder, Pace, Path};
use interp_core::config::{AxisConfig, Config, Machine};
use interp_core::units::{Feedrate, Length, Point, PulseSize, Sense};
use proptest::prelude::*;

/// Z and X, nm.
type V = (f64, f64);

fn machine(x_nm: u32, z_nm: u32, jump: u32) -> Machine {
    let axis = |nm: u32| AxisConfig {
        pulse: PulseSize::new(nm, 1).unwrap(),
        max_feed: Feedrate::from_nm_per_min(5_000_000_000).unwrap(),
        max_accel: 500_000,
        max_jump: jump,
        pulse_width_ns: 2_000,
        dir_setup_ns: 5_000,
        dir_hold_ns: 5_000,
        min_space_ns: 2_000,
    };
    Config { x: axis(x_nm), z: axis(z_nm), event_min_ns: 1_000 }.check().unwrap()
}

fn point((z, x): V) -> Point {
    let length = |nm: f64| Length::from_nm(nm.round() as i64).unwrap();
    Point { x: length(x), z: length(z) }
}

fn v(point: Point) -> V {
    (f64::from(point.z.nm()), f64::from(point.x.nm()))
}

fn minus(a: V, b: V) -> V {
    (a.0 - b.0, a.1 - b.1)
}

fn cross(a: V, b: V) -> f64 {
    a.0 * b.1 - a.1 * b.0
}

fn dot(a: V, b: V) -> f64 {
    a.0 * b.0 + a.1 * b.1
}

fn length(a: V) -> f64 {
    a.0.hypot(a.1)
}

fn line(start: V, end: V) -> Segment {
    Segment { start: point(start), end: point(end), path: Path::Line }
}

fn within(nm: i64) -> Allowance {
    Allowance::Within(Length::from_nm(nm).unwrap())
}

/// Angle swept from `a` to `b` in a sense, 0 to a whole turn.
fn swept(a: V, b: V, sense: Sense) -> f64 {
    let turned = cross(a, b).atan2(dot(a, b)) * if sense == Sense::CounterClockwise { 1.0 } else { -1.0 };
    if turned > 0.0 { turned } else { turned + std::f64::consts::TAU }
}

/// A programmed curve in floating point: a circle through both ends where it is an arc.
#[derive(Clone, Copy, Debug)]
struct Curve {
    start: V,
    end: V,
    round: Option<(V, Sense)>,
}

impl Curve {
    fn new(segment: &Segment) -> Self {
        let (start, end) = (v(segment.start), v(segment.end));
        let round = match segment.path {
            Path::Line => None,
            Path::Arc { centre, sense } => {
                let centre = (centre.1 as f64, centre.0 as f64);
                let (from, to) = (minus(start, centre), minus(end, centre));
                let chord = minus(end, start);
                // along the chord onto the bisector
                let off = if swept(from, to, sense) < std::f64::consts::PI {
                    let half = ((start.0 + end.0) / 2.0, (start.1 + end.1) / 2.0);
                    dot(minus(half, centre), chord) / dot(chord, chord)
                } else {
                    0.0
                };
                Some(((centre.0 + chord.0 * off, centre.1 + chord.1 * off), sense))
            }
        };
        Self { start, end, round }
    }

    fn length(&self) -> f64 {
        match self.round {
            None => length(minus(self.end, self.start)),
            Some((centre, sense)) => {
                let (from, to) = (minus(self.start, centre), minus(self.end, centre));
                length(from) * swept(from, to, sense)
            }
        }
    }

    /// Distance of a point from the curve, and the length of curve from its start to the nearest point.
    fn nearest(&self, at: V) -> (f64, f64) {
        let ends = [(length(minus(at, self.start)), 0.0), (length(minus(at, self.end)), self.length())];
        let inner = match self.round {
            None => {
                let way = minus(self.end, self.start);
                let along = dot(minus(at, self.start), way) / length(way);
                (0.0..=self.length())
                    .contains(&along)
                    .then(|| (cross(way, minus(at, self.start)).abs() / length(way), along))
            }
            Some((centre, sense)) => {
                let (from, out) = (minus(self.start, centre), minus(at, centre));
                let along = swept(from, out, sense) * length(from);
                (along <= self.length()).then(|| ((length(out) - length(from)).abs(), along))
            }
        };
        ends.into_iter().chain(inner).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
    }

    /// Direction of travel at a point of it.
    fn heading(&self, at: V) -> V {
        let way = match self.round {
            None => minus(self.end, self.start),
            Some((centre, sense)) => {
                let out = minus(at, centre);
                if sense == Sense::CounterClockwise { (-out.1, out.0) } else { (out.1, -out.0) }
            }
        };
        (way.0 / length(way), way.1 / length(way))
    }
}

/// What every blend must be; its departure, radius, and what it cuts off, nm.
fn check(first: &Segment, second: &Segment, blend: &Blend, tolerance: f64) -> (f64, f64, [f64; 2]) {
    let (before, behind) = (Curve::new(first), Curve::new(second));
    let (from, to, corner) = (v(blend.from), v(blend.to), v(first.end));
    let arc = Curve::new(&Segment {
        start: blend.from,
        end: blend.to,
        path: Path::Arc { centre: blend.centre, sense: blend.sense },
    });
    let centre = arc.round.unwrap().0;
    let radius = length(minus(from, centre));
    // its ends are on the segments, at most half of each away from the corner, to the rounding
    let ((off, along), (other_off, other_along)) = (before.nearest(from), behind.nearest(to));
    assert!(off < 1.0 && other_off < 1.0, "ends {off} and {other_off} nm off");
    let cut = [before.length() - along, other_along];
    assert!(cut[0] > 0.0 && cut[0] <= before.length() / 2.0, "{cut:?} of {}", before.length());
    assert!(cut[1] > 0.0 && cut[1] <= behind.length() / 2.0, "{cut:?} of {}", behind.length());
    // its tangents are theirs; a nanometre in the centre or an end turns them
    for (curve, at, cut) in [(before, from, cut[0]), (behind, to, cut[1])] {
        let (a, b) = (curve.heading(at), arc.heading(at));
        let arc_radius = curve.round.map_or(f64::INFINITY, |(centre, _)| length(minus(at, centre)));
        assert!(
            dot(a, b) > 0.0 && cross(a, b).abs() < 4.0 / radius.min(arc_radius).min(cut),
            "tangents differ by {}",
            cross(a, b)
        );
    }
    // it turns by less than half a turn
    assert!(arc.length() < radius * std::f64::consts::PI);
    // no point of it is further from the path than the tolerance, nor the corner from it
    let from_angle = minus(from, centre);
    let turned = arc.length() / radius * if blend.sense == Sense::CounterClockwise { 1.0 } else { -1.0 };
    for k in 0..=64 {
        let (sin, cos) = (turned * f64::from(k) / 64.0).sin_cos();
        let at =
            (centre.0 + from_angle.0 * cos - from_angle.1 * sin, centre.1 + from_angle.0 * sin + from_angle.1 * cos);
        let off = before.nearest(at).0.min(behind.nearest(at).0);
        assert!(off <= tolerance + 1e-3, "{off} nm off the path at {k}");
    }
    let departure = arc.nearest(corner).0;
    assert!(departure <= tolerance + 1e-3, "{departure} nm from the corner, {tolerance} allowed");
    (departure, radius, cut)
}

#[test]
fn two_lines_have_the_closed_form() {
    let corners = Corners::new(&machine(1_250, 2_500, 2_000));
    for degrees in 1..180_u32 {
        for tolerance in [5_000_u32, 50_000, 1_000_000] {
            for reach in [1e6, 1e8] {
                let turn = f64::from(degrees).to_radians();
                for turn in [turn, -turn] {
                    let first = line((-reach, 0.0), (0.0, 0.0));
                    let second = line((0.0, 0.0), (2.0 * reach * turn.cos(), 2.0 * reach * turn.sin()));
                    // phi is the angle between the lines
                    let half = (std::f64::consts::PI - turn.abs()) / 2.0;
                    let by_tolerance = f64::from(tolerance) / (1.0 / half.sin() - 1.0);
                    let by_length = reach / 2.0 * half.tan();
                    let radius = by_tolerance.min(by_length).min(2.1e9);
                    match corners.blend(&first, &second, within(tolerance.into())) {
                        Some(blend) => {
                            let (departure, found, cut) = check(&first, &second, &blend, tolerance.into());
                            // rounding takes 2 nm, and as much as it takes of the radius
                            let rounded = 4.0 / (1.0 / half.sin() - 1.0).min(1.0 / half.tan()) + 4.0;
                            assert!(
                                found <= radius + rounded && found > radius - rounded,
                                "{degrees}: {found} {radius}"
                            );
                            let (e, t) = (radius * (1.0 / half.sin() - 1.0), radius / half.tan());
                            assert!((departure - e).abs() < 5.0, "{degrees} {tolerance}: {departure} {e}");
                            assert!(
                                cut.iter().all(|cut| (cut - t).abs() < 5.0 + t * 4.0 / f64::from(tolerance)),
                                "{degrees} {tolerance} {reach} {radius}: {cut:?} {t}"
                            );
                            assert_eq!(blend.sense == Sense::CounterClockwise, turn > 0.0);
                            assert_eq!(blend.paths, [Path::Line; 2]);
                        }
                        // below three pulses of 2.5 um, or passed at 83 mm/s with a jump of 2 mm/s
                        None => assert!(radius < 7_500.0 + 10.0 || degrees <= 1, "{degrees} {tolerance} {reach}"),
                    }
                }
            }
        }
    }
}

/// A line along Z that meets a circle of 10 mm: the blend's centre is R beside the line, and R + 10 mm or 10 mm - R from
/// the circle's centre. R is the one whose departure is the tolerance.
#[test]
fn a_line_and_an_arc_have_the_radius_of_the_two_offset_curves() {
    let corners = Corners::new(&machine(1_000, 1_000, 2_000));
    let first = line((-1e8, 0.0), (0.0, 0.0));
    for degrees in (20..=160).step_by(10) {
        for (sense, tolerance) in [(Sense::Clockwise, 20e3), (Sense::CounterClockwise, 20e3), (Sense::Clockwise, 2e5)] {
            // the path turns left by so much
            let turn = f64::from(degrees).to_radians();
            let right = if sense == Sense::Clockwise { 1.0 } else { -1.0 };
            let out = ((turn.sin() * right * 1e7).round(), (-turn.cos() * right * 1e7).round());
            let end = point((out.0 * 2.0, out.1 * 2.0));
            let second = Segment {
                start: Point::default(),
                end,
                path: Path::Arc { centre: (out.1 as i64, out.0 as i64), sense },
            };
            let rho = length(out);
            let departure = |radius: f64| {
                let reach = rho + radius * right;
                let z = out.0 - right * (reach * reach - (radius - out.1).powi(2)).sqrt();
                z.hypot(radius) - radius
            };
            let (mut low, mut high) = (0.0, 4e7);
            for _ in 0..60 {
                let middle = (low + high) / 2.0;
                // past the largest circle between both there is no root
                if departure(middle) <= tolerance { low = middle } else { high = middle }
            }
            let blend = corners.blend(&first, &second, within(tolerance as i64)).unwrap();
            let (_, found, _) = check(&first, &second, &blend, tolerance);
            assert!(found < low * 1.001 && found > low * 0.85, "{degrees} {sense:?}: {found} of {low}");
        }
    }
}

#[test]
fn degenerate_corners_stay_sharp() {
    let corners = Corners::new(&machine(1_000, 1_000, 2_000));
    let first = line((-1e7, 0.0), (0.0, 0.0));
    let blend = |second: &Segment, tolerance: i64| corners.blend(&first, second, within(tolerance));
    // on, and back
    assert_eq!(blend(&line((0.0, 0.0), (1e7, 0.0)), 100_000), None);
    assert_eq!(blend(&line((0.0, 0.0), (-1e7, 0.0)), 100_000), None);
    assert_eq!(blend(&line((0.0, 0.0), (-1e7, 1.0)), 100_000), None);
    // nowhere
    assert_eq!(blend(&line((0.0, 0.0), (0.0, 0.0)), 100_000), None);
    // tangent arc, and one that comes back on itself
    let arc = |centre: (i64, i64), end: V, sense| Segment {
        start: Point::default(),
        end: point(end),
        path: Path::Arc { centre, sense },
    };
    assert_eq!(blend(&arc((5_000_000, 0), (5e6, 5e6), Sense::CounterClockwise), 100_000), None);
    assert_eq!(blend(&arc((5_000_000, 0), (-5e6, 5e6), Sense::Clockwise), 100_000), None);
    // a full circle that begins square to the line is blended
    let circle = arc((0, 5_000_000), (0.0, 0.0), Sense::Clockwise);
    let found = blend(&circle, 20_000).unwrap();
    check(&first, &circle, &found, 20_000.0);
    // three pulses of radius: at a right angle R = e / (sqrt 2 - 1)
    let right = line((0.0, 0.0), (0.0, 1e7));
    assert_eq!(blend(&right, 1_243), None);
    assert!(blend(&right, 1_246).is_some());
    // a long arc whose radii differ is no one circle
    let long = |end: f64| arc((0, 5_000_000), (5e6, end), Sense::CounterClockwise);
    assert!(blend(&long(5e6), 20_000).is_some());
    assert_eq!(blend(&long(5e6 - 1_000.0), 20_000), None);
}

#[test]
fn a_blend_that_keeps_a_speed_has_the_radius_that_the_speed_needs() {
    let machine = machine(1_000, 1_000, 2_000);
    let corners = Corners::new(&machine);
    let (first, second) = (line((-1e8, 0.0), (0.0, 0.0)), line((0.0, 0.0), (3e7, 8e7)));
    // 20 mm/s and 500 mm/s2: v^2 / 0.998 a
    let blend = corners.blend(&first, &second, Allowance::Keeping(20_000 << 12)).unwrap();
    let (_, radius, _) = check(&first, &second, &blend, f64::INFINITY);
    let exact = 400.0 / 0.998 / 500.0 * 1e6;
    assert!((radius - exact).abs() < 10.0, "{radius} {exact}");
    let mut builder = Builder::new(&machine, blend.from);
    let path = Path::Arc { centre: blend.centre, sense: blend.sense };
    let built = builder.motion(path, blend.to, Pace::Rapid);
    let limit = f64::from(built.motions[0].limit) / 4096e3;
    assert!((limit - 20.0).abs() < 0.02, "{limit} mm/s");
}

/// A segment from or to the origin.
fn segment(ends_here: bool) -> impl Strategy<Value = Segment> {
    // a round number of nanometres, as programs have, or any
    let place = (4.0..9.3_f64, 0.0..std::f64::consts::TAU).prop_map(|(size, angle)| {
        let size = 10_f64.powf(size).min(2e9);
        ((size * angle.cos()).round(), (size * angle.sin()).round())
    });
    (place.clone(), place, any::<bool>(), 0_u32..4).prop_filter_map(
        "ends too far",
        move |(other, centre, sense, kind)| {
            let sense = if sense { Sense::Clockwise } else { Sense::CounterClockwise };
            let (far, path) = match kind {
                0 => (other, Path::Line),
                _ => {
                    // a place on the circle about `centre` in the direction of `other`
                    let way = minus(other, centre);
                    let size = length(centre) / length(way);
                    let far = ((centre.0 + way.0 * size).round(), (centre.1 + way.1 * size).round());
                    (far, Path::Arc { centre: (centre.1 as i64, centre.0 as i64), sense })
                }
            };
            let fits = far.0.abs() < 2.1e9 && far.1.abs() < 2.1e9 && length(far) > 10.0;
            let (start, end) = if ends_here { (far, (0.0, 0.0)) } else { ((0.0, 0.0), far) };
            fits.then(|| Segment { start: point(start), end: point(end), path })
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    #[test]
    fn every_blend_is_tangent_within_its_tolerance_and_its_halves(
        first in segment(true),
        second in segment(false),
        tolerance in 3.0..6.0_f64,
    ) {
        let corners = Corners::new(&machine(1_250, 2_500, 2_000));
        let tolerance = 10_f64.powf(tolerance).round();
        if let Some(blend) = corners.blend(&first, &second, within(tolerance as i64)) {
            let (_, radius, _) = check(&first, &second, &blend, tolerance);
            prop_assert!(radius >= 7_499.0);
        }
    }
}
