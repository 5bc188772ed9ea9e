//! What is left of a bar against formulas.
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

mod common;

use std::f64::consts::{PI, TAU};

use common::{BAR, CENTRE, NEUTRAL, SIDE, at, cut, line};
use stock::{Bar, BarData, Contour, Curve, Point, Sweep, Tool, ToolData};

/// Outermost radius at the column nearest to `z`.
fn radius(bar: &Bar, z: f64) -> (f64, f64) {
    let column = (0..bar.len()).min_by(|a, b| (bar.z(*a) - z).abs().total_cmp(&(bar.z(*b) - z).abs())).unwrap();
    (bar.z(column), bar.outside(column))
}

#[track_caller]
fn near(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() <= within, "{found} is not {expected} within {within}");
}

#[test]
fn a_cylinder_has_the_programmed_radius_and_volume() {
    let bar = cut(BAR, SIDE, &[at(2.0, 12.0), at(-60.0, 12.0)]);
    for column in 0..bar.len() - 1000 {
        near(bar.outside(column + 1000), 12.0, 1e-9);
    }
    // all but the corner that the nose leaves at the far end, beyond the bar here
    let bar = cut(BAR, SIDE, &[at(2.0, 12.0), at(-70.0, 12.0)]);
    near(bar.volume(), PI * 144.0 * 60.0, 1e-4);
}

#[test]
fn a_shoulder_has_a_fillet_of_the_nose() {
    let bar = cut(BAR, SIDE, &[at(2.0, 12.0), at(-30.0, 12.0), at(-30.0, 20.0)]);
    for k in 1..40 {
        let (z, x) = radius(&bar, -30.0 + 0.01 * f64::from(k));
        let from = z - -29.6;
        near(x, 12.4 - (0.16 - from * from).sqrt(), 1e-9);
    }
    near(radius(&bar, -30.01).1, 16.0, 1e-12);
}

#[test]
fn a_cone_turned_by_a_nose_is_offset_by_half_angle_formula() {
    // the imaginary tip goes along a cone of angle a: the nose stays off it by r (1 - tan(a/2)) along X
    let slope = 10.0_f64.to_radians();
    let end = at(-40.0, 8.0 + 42.0 * slope.tan());
    let bar = cut(BAR, SIDE, &[at(2.0, 8.0), end]);
    let above = 0.4 * (1.0 - (1.0 / slope.cos() - slope.tan()));
    for z in [-5.0, -12.34, -30.0] {
        let (z, x) = radius(&bar, z);
        // centre's line, offset by r along its normal: x = tip line + r (1 - 1/cos a + tan a)
        near(x, 8.0 + (2.0 - z) * slope.tan() + above, 1e-9);
    }
}

#[test]
fn the_frustum_left_by_a_centre_path_has_the_volume_of_the_formula() {
    // path of the nose's centre, offset by the nose along the normal
    let slope = 6.0_f64.to_radians();
    let off = 0.4 / slope.cos();
    let at_z = |z: f64| 6.0 - z * slope.tan();
    let bar = cut(BAR, CENTRE, &[at(5.0, at_z(5.0) + off), at(-65.0, at_z(-65.0) + off)]);
    let (small, great) = (at_z(0.0), at_z(-60.0));
    near(bar.volume(), PI * 60.0 / 3.0 * (small * small + small * great + great * great), 1e-3);
}

/// Places along a circle.
fn circle(centre: Point, radius: f64, from: f64, to: f64) -> Vec<Point> {
    (0..=4000).map(|k| centre + Point::at_degrees(from + (to - from) * f64::from(k) / 4000.0) * radius).collect()
}

#[test]
fn a_ball_cut_by_the_centre_of_a_nose_is_a_ball_and_a_cap_has_its_volume() {
    // front half of a ball of radius 15
    let path = circle(at(-15.0, 0.0), 15.4, 0.0, 90.0);
    let bar = cut(BAR, CENTRE, &path);
    for column in 0..bar.len() {
        let z = bar.z(column);
        if z > -14.5 {
            near((z + 15.0).hypot(bar.outside(column)), 15.0, 2e-6);
        }
    }
    // a cap of height h: pi h² (3 R - h) / 3; what is cut off in front of it is the bar less the cap
    let h = 10.0;
    let cap: f64 = (0..bar.len())
        .filter(|column| bar.z(*column) > -h)
        .map(|column| PI * bar.outside(column).powi(2) * bar.width())
        .sum();
    near(cap, PI * h * h * (45.0 - h) / 3.0, 0.05);
}

#[test]
fn a_round_groove_takes_the_volume_of_pappus() {
    // a plunge by a sharp wide wedge leaves a triangle: area times the way of its centroid
    let wedge = ToolData { nose: 0.0, tip: 9, front: 135.0, back: 45.0, edge: 20.0 };
    let bar = cut(BAR, wedge, &[at(-30.0, 20.0), at(-30.0, 12.0)]);
    let taken = Bar::new(BAR).volume() - bar.volume();
    // height 4, half width 4: area 16, centroid at 2/3 of the height
    near(taken, 16.0 * TAU * (12.0 + 4.0 * 2.0 / 3.0), 1e-3);
}

#[test]
fn an_undercut_is_limited_by_the_back_edge() {
    // falling at 40 degrees behind a tool whose back edge rises at 5: the edge makes the surface
    let bar = cut(BAR, SIDE, &[at(-10.0, 16.5), at(-20.0, 16.5 - 10.0 * 40.0_f64.to_radians().tan())]);
    let tip = at(-20.0, 16.5 - 10.0 * 40.0_f64.to_radians().tan());
    let centre = tip + at(0.4, 0.4);
    let (sine, cosine) = 5.0_f64.to_radians().sin_cos();
    for z in [-19.0, -15.0, -5.0] {
        let (z, x) = radius(&bar, z);
        let edge = centre.x + ((z - centre.z) * sine - 0.4) / cosine;
        near(x, edge.min(16.0), 1e-9);
    }
}

#[test]
fn the_front_edge_leaves_its_own_slope_at_a_shoulder() {
    // a front edge that leans back leaves material hanging over, in two stretches of a column
    let leaning = ToolData { front: 80.0, ..SIDE };
    let bar = cut(BAR, leaning, &[at(2.0, 12.0), at(-30.0, 12.0)]);
    let (z, _) = radius(&bar, -29.5);
    let column = (0..bar.len()).find(|column| (bar.z(*column) - z).abs() < 1e-9).unwrap();
    let [core, hanging] = *bar.material(column) else { unreachable!() };
    let (sine, cosine) = 80.0_f64.to_radians().sin_cos();
    let edge = 12.4 + ((z - -29.6) * sine + 0.4) / cosine;
    near(hanging[0], edge, 1e-9);
    near(hanging[1], 16.0, 1e-12);
    assert!(core[1] < 12.4);
}

#[test]
fn a_bore_is_turned_from_inside_by_the_same_tool_mirrored() {
    let tube = BarData { bore: 5.0, ..BAR };
    let bar = cut(tube, ToolData { tip: 2, ..SIDE }, &[at(2.0, 7.0), at(-70.0, 7.0)]);
    near(bar.volume(), PI * (256.0 - 49.0) * 60.0, 1e-3);
}

#[test]
fn a_face_groove_leaves_two_stretches() {
    let tool = ToolData { nose: 0.4, tip: 7, front: 100.0, back: 80.0, edge: 11.0 };
    let bar = cut(BAR, tool, &[at(1.0, 10.0), at(-2.0, 10.0)]);
    let column = (0..bar.len()).find(|column| bar.z(*column) > -1.0).unwrap();
    let [core, rim] = *bar.material(column) else { unreachable!() };
    let half = {
        let (sine, cosine) = 10.0_f64.to_radians().sin_cos();
        ((bar.z(column) - -1.6) * sine + 0.4) / cosine
    };
    near(core[1], 10.0 - half, 1e-9);
    near(rim[0], 10.0 + half, 1e-9);
}

#[test]
fn tips_lie_where_controls_number_them() {
    let place = at(3.0, 4.0);
    for (tip, z, x) in [
        (1, 1.0, 1.0),
        (2, -1.0, 1.0),
        (3, -1.0, -1.0),
        (4, 1.0, -1.0),
        (5, 1.0, 0.0),
        (6, 0.0, 1.0),
        (7, -1.0, 0.0),
        (8, 0.0, -1.0),
        (9, 0.0, 0.0),
    ] {
        let tool = Tool::new(ToolData { tip, ..NEUTRAL }).unwrap();
        let towards = place - tool.centre(place);
        near(towards.z, 0.4 * z, 1e-12);
        near(towards.x, 0.4 * x, 1e-12);
    }
}

#[test]
fn mirrored_tools_cut_mirrored_shapes() {
    let [right, left] = [3, 4].map(|tip| {
        let sign = if tip == 3 { 1.0 } else { -1.0 };
        cut(BAR, ToolData { tip, ..SIDE }, &[at(-30.0, 20.0), at(-30.0 - sign, 13.0), at(-30.0 - 5.0 * sign, 13.5)])
    });
    for column in 0..right.len() {
        near(right.outside(column), left.outside(left.len() - 1 - column), 1e-9);
    }
}

#[test]
fn a_long_move_is_the_hull_of_short_ones() {
    for (front, back, to) in
        [(107.5, 72.5, at(-14.0, 12.0)), (85.0, 5.0, at(-13.0, 14.5)), (95.0, 15.0, at(-9.0, 17.5))]
    {
        let tool = Tool::new(ToolData { front, back, ..SIDE }).unwrap();
        let from = at(-10.0, 14.0);
        let whole = Sweep::new(&tool, from, to);
        let mut one = Bar::new(BAR);
        one.cut(&whole, |_| {});
        let mut many = Bar::new(BAR);
        many.cut(&Sweep::new(&tool, from, from), |_| {});
        let count = 20_000;
        for k in 0..count {
            let [a, b] = [k, k + 1].map(|k| from + (to - from) * (f64::from(k) / f64::from(count)));
            many.cut(&Sweep::new(&tool, a, b), |_| {});
        }
        for column in 0..one.len() {
            let (a, b) = (one.material(column), many.material(column));
            assert_eq!(a.len(), b.len(), "{column}: {a:?} {b:?}");
            for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
                near(*a, *b, 2e-6);
            }
        }
    }
}

#[test]
fn a_contour_is_the_path_offset_by_the_nose() {
    let tool = Tool::new(CENTRE).unwrap();
    let ball = Curve { line: 7, from: at(0.4, 0.0), to: at(-15.0, 15.4), arc: Some((at(-15.0, 0.0), false)) };
    let contour = Contour::new(&[ball], &tool, BAR);
    assert!(contour.samples().len() > 2000, "{}", contour.samples().len());
    for sample in contour.samples() {
        near((sample.place - at(-15.0, 0.0)).length(), 15.0, 1e-9);
        assert_eq!(sample.line, 7);
    }
    let weight: f64 = contour.samples().iter().map(|sample| sample.weight).sum();
    near(weight, 15.4 * 90.0_f64.to_radians(), 0.02);
}

#[test]
fn only_the_last_of_several_passes_is_the_contour() {
    let tool = Tool::new(SIDE).unwrap();
    let pass = |x: f64| line(at(2.0, x), at(-20.0, x));
    let contour = Contour::new(&[pass(15.0), pass(13.0), pass(12.0)], &tool, BAR);
    assert!(contour.samples().iter().all(|sample| (sample.place.x - 12.0).abs() < 1e-9));
}
