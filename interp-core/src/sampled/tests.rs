//! Sampled curves against their equations in `f64`: points, ends, and the distance of every chord.
#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "oracles in f64"
)]

use super::curves::{Hyperbola, SineWave, Spiral, TiltedEllipse, TiltedParabola};
use super::end_test::{ArcEnd, LineEnd};
use super::nurbs::{Nurbs, Weight};
use super::spline::Spline;
use super::*;
extern crate std;
use core::f64::consts::{PI, TAU};
use std::vec::Vec;

const RADIAN: f64 = (1_u64 << 60) as f64;

fn radians(angle: f64) -> i64 {
    (angle * RADIAN) as i64
}

fn um(value: i32) -> Length {
    Length::from_um(value).unwrap()
}

fn at(x: i32, z: i32) -> Point {
    Point { x: um(x), z: um(z) }
}

fn nm((x, z): Place) -> (f64, f64) {
    (x as f64 / 4096.0, z as f64 / 4096.0)
}

#[test]
fn sine_and_cosine_agree_with_f64_all_around() {
    for k in -4000..4000_i32 {
        let angle = f64::from(k) * 0.0061;
        let (s, c) = sine_cosine(((angle * (1_u64 << 52) as f64) as i128) << 8);
        assert!(
            (s as f64 / RADIAN - angle.sin()).abs() < 1e-14 && (c as f64 / RADIAN - angle.cos()).abs() < 1e-14,
            "{angle}"
        );
    }
}

/// The curve's points are those of `exact` (parameter 0 to 1, nm), and no chord leaves `exact` by more than the tolerance,
/// looked at 64 times a chord; all for several tolerances.
fn follows<C: Sampled + Clone>(name: &str, curve: &C, exact: impl Fn(f64) -> (f64, f64)) {
    for k in 0..=1000 {
        let parameter = WHOLE * k / 1000;
        let (x, z) = nm(curve.at(parameter));
        let (ex, ez) = exact(parameter as f64 / WHOLE as f64);
        assert!((x - ex).hypot(z - ez) < 1.0, "{name} at {k}: {x} {z}, not {ex} {ez}");
    }
    for tolerance in [20_u32, 500, 5000] {
        let mut chords = Chords::new(curve.clone(), tolerance);
        let (mut from, mut began, mut count) = (nm(curve.at(0)), 0_u64, 0);
        while let Some(to) = chords.next() {
            let to = to.unwrap();
            let to = (f64::from(to.x.nm()), f64::from(to.z.nm()));
            let (dx, dz) = (to.0 - from.0, to.1 - from.1);
            let length = dx.hypot(dz).max(1e-9);
            for part in 0..=64_u32 {
                let parameter = began as f64 + (chords.parameter - began) as f64 * f64::from(part) / 64.0;
                let (x, z) = exact(parameter / WHOLE as f64);
                let off = ((x - from.0) * dz - (z - from.1) * dx).abs() / length;
                // chord ends are rounded to whole nm
                assert!(off <= f64::from(tolerance) + 2.0, "{name} chord {count}: {off} of {tolerance}");
            }
            (from, began) = (to, chords.parameter);
            count += 1;
            assert!(count < 2_000_000, "{name} ends");
        }
        let (ex, ez) = exact(1.0);
        assert!((from.0 - ex).hypot(from.1 - ez) < 1.5, "{name} ends at {from:?}, not {ex} {ez}");
    }
}

#[test]
fn ellipses_at_any_angle_follow_their_equation() {
    for (half_u, half_v, tilt, from, to) in
        [(30_000, 8_000, 0.5, 0.0, TAU), (5_000, 90_000, -2.2, 1.0, -3.0), (7_000, 7_000, 0.0, 0.3, 0.31)]
    {
        let curve = TiltedEllipse::new(
            (um(3000), um(-20_000)),
            (um(half_u), um(half_v)),
            radians(tilt),
            (radians(from), radians(to)),
        )
        .unwrap();
        follows("ellipse", &curve, |t| {
            let angle = from + (to - from) * t;
            let (u, v) = (f64::from(half_u) * 1e3 * angle.cos(), f64::from(half_v) * 1e3 * angle.sin());
            (3e6 + u * tilt.sin() + v * tilt.cos(), -2e7 + u * tilt.cos() - v * tilt.sin())
        });
    }
}

#[test]
fn hyperbola_and_parabola_follow_their_equations() {
    let tilt = 1.1_f64;
    let place = |u: f64, v: f64| (1e6 + u * tilt.sin() + v * tilt.cos(), 2e6 + u * tilt.cos() - v * tilt.sin());
    let way = (um(-40_000), um(25_000));
    let v = |t: f64| -4e7 + 6.5e7 * t;
    let curve = Hyperbola::new((um(1000), um(2000)), (um(10_000), um(3_000)), radians(tilt), way).unwrap();
    follows("hyperbola", &curve, |t| place(1e7 * (1.0 + (v(t) / 3e6).powi(2)).sqrt(), v(t)));
    let curve = TiltedParabola::new((um(1000), um(2000)), um(15_000), radians(tilt), way).unwrap();
    follows("parabola", &curve, |t| place(v(t).powi(2) / 3e7, v(t)));
}

/// A parabola with a radius of 1 um at its tip, by chords that may leave it by far more: the direction `atan(v / p)`
/// changes by at most so much along a chord as two ends may that lean from it by a quarter; but for the corner, which is
/// the tip where the tolerance is large, and there only.
#[test]
fn no_chord_bends_sharply_but_a_corner() {
    for (tolerance, corners) in [(5_000, false), (400_000, true)] {
        let curve = TiltedParabola::new((um(0), um(0)), um(1), radians(0.3), (um(-700), um(900))).unwrap();
        let mut chords = Chords::new(curve, tolerance);
        let (mut began, mut seen) = (0, false);
        while let Some(end) = chords.next() {
            end.unwrap();
            let across = |parameter: u64| 1600.0 * parameter as f64 / WHOLE as f64 - 700.0;
            let (from, to) = (across(began), across(chords.parameter()));
            let turn = to.atan() - from.atan();
            if chords.is_corner() {
                // the chord is no longer than a 64th of the tolerance
                let reach = f64::from(tolerance) / 64e3;
                assert!(turn > 0.4 && from > -reach - 1.0 && to < reach + 1.0, "{from} to {to}");
            } else {
                assert!(turn < 0.6, "{from} to {to} turns by {turn}");
            }
            (began, seen) = (chords.parameter(), seen | chords.is_corner());
        }
        assert_eq!((began, seen), (WHOLE, corners), "{tolerance}");
    }
}

#[test]
fn sine_and_spiral_follow_their_equations() {
    let curve = SineWave::new((um(20_000), um(0)), um(2_000), um(7_000), radians(0.4), um(-50_000)).unwrap();
    follows("sine", &curve, |t| (2e7 + 2e6 * (0.4 + TAU * (-5e7 * t).rem_euclid(7e6) / 7e6).sin(), -5e7 * t));
    let sweep = -7.3 * TAU;
    let small = |angle: f64| (angle * (1_u64 << 30) as f64) as i64;
    let curve = Spiral::new((um(0), um(1000)), (um(0), um(30_000)), small(0.7), small(sweep)).unwrap();
    follows("spiral", &curve, |t| {
        let (radius, angle) = (3e7 * t, 0.7 + sweep * t);
        (radius * angle.sin(), 1e6 + radius * angle.cos())
    });
}

#[test]
fn a_spline_passes_its_points_smoothly() {
    let points = [at(0, 0), at(3000, -5000), at(9000, -4000), at(9500, -20_000), at(4000, -21_000), at(4100, -21_100)];
    let spline = Spline::<8>::new(&points).unwrap();
    let mut knots = Vec::from([0.0]);
    for pair in points.windows(2) {
        let chord = f64::from(pair[1].x.nm() - pair[0].x.nm()).hypot(f64::from(pair[1].z.nm() - pair[0].z.nm()));
        knots.push(knots[knots.len() - 1] + chord);
    }
    let length = knots[knots.len() - 1];
    let place = |along: f64| nm(spline.at((along / length * WHOLE as f64) as u64));
    for (point, along) in points.iter().zip(&knots) {
        let (x, z) = place(*along);
        assert!((x - f64::from(point.x.nm())).hypot(z - f64::from(point.z.nm())) < 20.0, "{point:?}: {x} {z}");
    }
    // the second derivative is the same from both sides of an inner knot, and none at the ends
    let step = 1e4;
    let bend = |a: f64| {
        let (p, q, r) = (place(a - step), place(a), place(a + step));
        ((p.0 - 2.0 * q.0 + r.0) / step / step, (p.1 - 2.0 * q.1 + r.1) / step / step)
    };
    for knot in &knots[1..knots.len() - 2] {
        let (left, right) = (bend(knot - 2.0 * step), bend(knot + 2.0 * step));
        assert!((left.0 - right.0).hypot(left.1 - right.1) < 1e-7, "{left:?} {right:?}");
    }
    let end = bend(step);
    assert!(end.0.hypot(end.1) < 1e-8, "{end:?}");
    // its own samples are the oracle of its chords
    follows("spline", &spline, |t| nm(spline.at((t * WHOLE as f64).round() as u64)));
}

#[test]
fn a_nurbs_quarter_is_a_circle() {
    let weights = ["1", "0.70710678118654752", "1"].map(|text| Weight::parse(text).unwrap());
    let control = [(at(0, 20_000), weights[0]), (at(20_000, 20_000), weights[1]), (at(20_000, 0), weights[2])];
    let curve = Nurbs::new(2, &control, &[0, 0, 0, 1 << 16, 1 << 16, 1 << 16]).unwrap();
    for k in 0..=1000 {
        let (x, z) = nm(curve.at(WHOLE * k / 1000));
        assert!((x.hypot(z) - 2e7).abs() < 0.5, "{k}: {}", x.hypot(z));
    }
    follows("nurbs", &curve, |t| nm(curve.at((t * WHOLE as f64).round() as u64)));
}

#[test]
fn a_nurbs_of_equal_weights_is_the_polynomial() {
    // one cubic piece: Bernstein's form
    let points = [at(0, 0), at(10_000, 3_000), at(-4_000, 9_000), at(2_000, -12_000)];
    let control = points.map(|point| (point, Weight::ONE));
    let curve = Nurbs::new(3, &control, &[5, 5, 5, 5, 77, 77, 77, 77]).unwrap();
    follows("bezier", &curve, |t| {
        let b = [(1.0 - t).powi(3), 3.0 * t * (1.0 - t).powi(2), 3.0 * t * t * (1.0 - t), t.powi(3)];
        let sum = |pick: fn(&Point) -> f64| points.iter().zip(b).map(|(point, b)| pick(point) * b).sum::<f64>();
        (sum(|p| f64::from(p.x.nm())), sum(|p| f64::from(p.z.nm())))
    });
}

#[test]
fn end_tests_find_the_end_of_lines_and_of_arcs_past_half_a_turn() {
    let line = LineEnd::new((0, 0), (3 << 20, -4 << 20)).unwrap();
    assert_eq!(line.remaining((0, 0)), 5 << 20);
    assert_eq!(line.remaining((3 << 18, -4 << 18)), 15 << 18);
    assert_eq!(LineEnd::new((7, 7), (7, 7)), None);
    for sweep in [0.2, 1.0, 3.0, PI, 3.3, 4.0, 5.0, 6.2] {
        let place = |angle: f64| ((1e9 * angle.sin()) as i64, (1e9 * angle.cos()) as i64);
        let advance = 0.01;
        let mut end = ArcEnd::new(place(0.0), place(sweep), sweep > PI);
        let mut angle = 0.0;
        while !end.arrives(place(angle), (1e9 * advance) as u64) {
            angle += advance;
            assert!(angle < sweep, "{sweep}: passed");
        }
        assert!(angle >= sweep - 1.01 * advance, "{sweep}: arrived at {angle}");
    }
}

#[test]
fn degenerate_curves_are_refused_by_name() {
    let o = (um(0), um(0));
    let sweep = (0, radians(1.0));
    assert_eq!(TiltedEllipse::new(o, (um(0), um(5)), 0, sweep), Err(CurveRefusal::Degenerate));
    assert_eq!(TiltedEllipse::new(o, (um(5), um(5)), 0, (7, 7)), Err(CurveRefusal::Degenerate));
    assert_eq!(Hyperbola::new(o, (um(5), um(-5)), 0, (um(0), um(1))), Err(CurveRefusal::Degenerate));
    assert_eq!(TiltedParabola::new(o, um(5), 0, (um(1), um(1))), Err(CurveRefusal::Degenerate));
    assert_eq!(SineWave::new(o, um(5), um(0), 0, um(1)), Err(CurveRefusal::Degenerate));
    assert_eq!(Spiral::new(o, (um(0), um(0)), 0, 9), Err(CurveRefusal::Degenerate));
    assert_eq!(Spline::<4>::new(&[at(0, 0)]), Err(CurveRefusal::Points));
    assert_eq!(Spline::<2>::new(&[at(0, 0), at(1, 1), at(2, 0)]), Err(CurveRefusal::Points));
    assert_eq!(Spline::<4>::new(&[at(0, 0), at(1, 1), at(1, 1)]), Err(CurveRefusal::RepeatedPoint));
    let control = [(at(0, 0), Weight::ONE), (at(1, 0), Weight::ONE), (at(1, 1), Weight::ONE)];
    assert_eq!(Nurbs::new(2, &control, &[0, 0, 0, 1, 1]), Err(CurveRefusal::Knots));
    assert_eq!(Nurbs::new(2, &control, &[0, 0, 3, 1, 1, 1]), Err(CurveRefusal::Knots));
    assert_eq!(Nurbs::new(2, &control, &[0; 6]), Err(CurveRefusal::Knots));
    assert_eq!(Nurbs::new(3, &control, &[0; 7]), Err(CurveRefusal::Points));
    assert_eq!(Nurbs::new(2, &[control[0]; 3], &[0, 0, 0, 1, 1, 1]), Err(CurveRefusal::RepeatedPoint));
    for text in ["", ".", "NaN", "inf", "-0.5", "0.0", "1e3", "65537", "99999999999999999999", "0.000000001"] {
        assert_eq!(Weight::parse(text), Err(CurveRefusal::Weight), "{text}");
    }
}

/// A curve that swells past the range ends with a refusal and no wrap.
#[test]
fn curves_past_the_range_are_refused_where_they_leave_it() {
    let metre = |m: i32| Length::from_um(m * 1_000_000).unwrap();
    let curve = TiltedEllipse::new((metre(2), metre(2)), (metre(2), metre(2)), 0, (0, radians(TAU))).unwrap();
    let points: Vec<_> = Chords::new(curve, 100_000).collect();
    assert_eq!(points.last(), Some(&Err(CurveRefusal::OutOfRange)));
    let curve = TiltedParabola::new((metre(0), metre(0)), um(1), 0, (metre(-2), metre(2))).unwrap();
    assert_eq!(Chords::new(curve, 1).next(), Some(Err(CurveRefusal::OutOfRange)));
}
