//! Deviation from the curves, against integers and brute force.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "helpers of tests may panic as tests do")]

mod common;

use common::{arc, circle_points, jumpy, line, line_steps, play, round_steps};
use measure::{FaultKind, Motion, PerAxis, Report, Setup};

/// A set-up that starts on (x, z) pulses of 1 um.
fn starting(x: i32, z: i32) -> Setup {
    Setup { start: PerAxis { x, z }, start_nm: PerAxis { x: i64::from(x) * 1_000, z: i64::from(z) * 1_000 }, ..jumpy() }
}

fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-6, "{found} is not {expected}");
}

fn clean(report: &Report) {
    assert_eq!(report.faults.total(), 0, "{report}");
}

/// 4:3: X is off by 0.25 or 0.5 pulses, and 4/5 of that is square to the line.
#[test]
fn line_four_to_three_is_off_by_two_fifths_of_a_pulse() {
    let steps = line_steps(300, 400, 2_000.0);
    let report = play(jumpy(), &[line(300_000, 400_000, 120.0)], &steps);
    clean(&report);
    close(report.walked.pulses, 0.4);
    close(report.programmed.pulses, 0.4);
    assert_eq!(report.pulses, PerAxis { x: 300, z: 400 });
    assert_eq!((report.motions, report.backward_steps), (1, 0));
    assert!((report.time_s - 0.252).abs() < 1e-9); // 0.25 s from 1 ms on, the end of its tick
}

/// Ends off the lattice: (299.6, 400.4) rounds to (300, 400). The last point is off the programmed line
/// by the distance of the ends, 0.4 by 0.4.
#[test]
fn programmed_curve_keeps_its_own_ends() {
    let steps = line_steps(300, 400, 2_000.0);
    let report = play(jumpy(), &[line(299_600, 400_400, 120.0)], &steps);
    clean(&report);
    close(report.walked.pulses, 0.4);
    // Farthest of all points from the line through the origin along (299.6, 400.4).
    let mut place = (0, 0);
    let farthest = steps
        .iter()
        .map(|step| {
            place = (place.0 + step.x, place.1 + step.z);
            let cross = f64::from(place.0) * 400.4 - f64::from(place.1) * 299.6;
            cross.abs() / 299.6_f64.hypot(400.4)
        })
        .fold(0.0, f64::max);
    assert!(farthest > 0.6);
    close(report.programmed.pulses, farthest);
}

#[test]
fn coarser_pulse_is_the_measure() {
    let mut setup = jumpy();
    setup.pulse_nm.x.num = 2_000;
    // The slope is 3:4 in pulses, 6:4 in um: half a pulse of X is 1 um, square to the line 4/sqrt(52).
    let steps = line_steps(300, 400, 2_000.0);
    let report = play(setup, &[line(600_000, 400_000, 120.0)], &steps);
    close(report.walked.pulses, 4.0 / 52.0_f64.sqrt() / 2.0);
}

#[test]
fn quarter_circle_is_off_by_its_farthest_point() {
    for radius in [1, 2, 3, 5, 25, 100, 1_000] {
        let all = circle_points(radius);
        let end = all.iter().position(|point| *point == (radius, 0)).unwrap();
        let points = &all[..=end];
        let steps = round_steps(points, f64::from(radius), 2_000.0);
        let motion = arc((0, 0), (i64::from(radius) * 1_000, 0), false, 120.0);
        let report = play(starting(0, radius), &[motion], &steps);
        clean(&report);
        // d = |r² - R²| / (r + R), another formula than a difference of roots.
        let farthest = points
            .iter()
            .map(|(x, z)| {
                let off = f64::from((x * x + z * z - radius * radius).abs());
                off / (f64::from(x * x + z * z).sqrt() + f64::from(radius))
            })
            .fold(0.0, f64::max);
        close(report.walked.pulses, farthest);
        close(report.programmed.pulses, farthest);
        assert!(farthest <= 0.5);
    }
}

/// Ends off the lattice move the walked arc: through the rounded ends, about a moved centre. The programmed one
/// stays about the programmed centre.
#[test]
fn moved_centre_is_on_the_bisector_of_the_rounded_ends() {
    // From (0, 100.4) to (100.3, 0) pulses about the origin; rounded (0, 100), (100, 0). The bisector is
    // z = x; the centre (0, 0) is on it: so the walked circle has a radius of 100, and all is as before.
    let mut setup = starting(0, 100);
    setup.start_nm.z = 100_400;
    let points: Vec<(i32, i32)> = circle_points(100);
    let end = points.iter().position(|point| *point == (100, 0)).unwrap();
    let steps = round_steps(&points[..=end], 100.0, 2_000.0);
    let motion = arc((0, 0), (100_400, 0), false, 120.0);
    let report = play(setup, &[motion], &steps);
    let whole = play(starting(0, 100), &[arc((0, 0), (100_000, 0), false, 120.0)], &steps);
    clean(&report);
    close(report.walked.pulses, whole.walked.pulses);
    // The programmed radius is 100.4: the innermost point is farthest from it.
    let innermost =
        points[..=end].iter().map(|(x, z)| f64::from(*x).hypot(f64::from(*z))).fold(f64::INFINITY, f64::min);
    close(report.programmed.pulses, 100.4 - innermost);

    // One end moved by a whole pulse in Z, to (100, 1): chord (100, -99), middle (50, 50.5). The centre's place
    // on the bisector is found here from equal distances: (0, 0) + s (100, -99) with
    // |c - (0, 100)| = |c - (100, 1)|.
    let mut points = points[..=end].to_vec();
    points.retain(|(_, z)| *z >= 1);
    points.push((100, 1));
    points.dedup();
    let mut motion = arc((0, 0), (100_000, 1_400), false, 120.0);
    motion.end_nm.z = 1_400; // rounds to 1
    let report = play(starting(0, 100), &[motion], &round_steps(&points, 100.0, 2_000.0));
    clean(&report);
    // c = s (100, -99): (100 s)² + (100 + 99 s)² = (100 s - 100)² + (99 s + 1)²
    // 100² + 2 99 100 s = 100² - 2 100² s + 1 + 2 99 s, so s (19800 + 20000 - 198) = 1.
    let s = 1.0 / 39_602.0;
    let centre = (100.0 * s, -99.0 * s);
    let radius = f64::hypot(centre.0, 100.0 - centre.1);
    let farthest = points
        .iter()
        .map(|(x, z)| {
            let off = (f64::from(*x) - centre.0).hypot(f64::from(*z) - centre.1) - radius;
            off.abs()
        })
        .fold(0.0, f64::max);
    close(report.walked.pulses, farthest);
}

#[test]
fn displaced_pulse_shows_where_it_is() {
    let mut steps = line_steps(0, 400, 2_000.0);
    // X goes out by one pulse at Z = 200, and back at Z = 201.
    steps[199].x = 1;
    steps[200].x = -1;
    let report = play(jumpy(), &[line(0, 400_000, 120.0)], &steps);
    close(report.walked.pulses, 1.0);
    close(report.programmed.pulses, 1.0);
    assert_eq!(report.walked.at, PerAxis { x: 1, z: 200 });
    assert_eq!(report.walked.clocks, steps[199].clocks);
    assert_eq!(report.faults.count(FaultKind::EndMissed), 0);
}

/// Plays the circle with `radius` counter-clockwise from its point `from` to its point `to`.
fn round(radius: i32, from: usize, to: usize, clockwise: bool) -> (Report, Vec<(i32, i32)>) {
    let mut all = circle_points(radius);
    all.pop();
    let count = if to > from { to - from } else { all.len() - from + to };
    let mut points: Vec<(i32, i32)> = all.iter().cycle().skip(from).take(count + 1).copied().collect();
    if clockwise {
        points.reverse();
    }
    let (start, end) = (points[0], points[points.len() - 1]);
    let motion: Motion = arc((0, 0), (i64::from(end.0) * 1_000, i64::from(end.1) * 1_000), clockwise, 120.0);
    let steps = round_steps(&points, f64::from(radius), 500.0);
    (play(starting(start.0, start.1), &[motion], &steps), points)
}

#[test]
fn full_circles_go_all_the_way_round() {
    for radius in [1, 2, 3, 4, 10, 100] {
        let quarters = circle_points(radius);
        for axis in [(0, radius), (radius, 0), (0, -radius), (-radius, 0)] {
            let from = quarters.iter().position(|point| *point == axis).unwrap();
            for clockwise in [false, true] {
                let (report, points) = round(radius, from, from, clockwise);
                clean(&report);
                assert_eq!(report.motions, 1);
                let farthest = points
                    .iter()
                    .map(|(x, z)| (f64::from(*x).hypot(f64::from(*z)) - f64::from(radius)).abs())
                    .fold(0.0, f64::max);
                close(report.walked.pulses, farthest);
            }
        }
    }
}

#[test]
fn circle_half_played_is_not_complete() {
    let points = circle_points(50);
    let half = points.iter().position(|point| *point == (0, -50)).unwrap();
    let steps = round_steps(&points[..=half], 50.0, 500.0);
    let report = play(starting(0, 50), &[arc((0, 0), (0, 50_000), false, 120.0)], &steps);
    assert_eq!(report.faults.count(FaultKind::MotionsLeft), 1);
    assert_eq!(report.faults.count(FaultKind::EndMissed), 1);
}

/// The wrong way round is a diameter off, half the way.
#[test]
fn wrong_sense_of_rotation_shows() {
    let points = circle_points(50);
    let steps = round_steps(&points, 50.0, 500.0);
    let report = play(starting(0, 50), &[arc((0, 0), (0, 50_000), true, 120.0)], &steps);
    // the same points, but each of them the wrong way
    assert!(report.backward_steps > 100, "{}", report.backward_steps);
}

/// 300 degrees about a centre off the lattice: the halves meet at the nearest point to the middle.
#[test]
fn halves_meet_at_the_nearest_lattice_point() {
    // Centre (0.3, 0.2) pulses, radius 10, from 30 to 330 degrees: the middle is (0.3, -9.8), rounded
    // (0, -10), X across.
    let place = |degrees: f64| {
        let angle = degrees.to_radians();
        (0.3 + 10.0 * angle.sin(), 0.2 + 10.0 * angle.cos())
    };
    let walk = |through: (i32, i32)| {
        let mut points: Vec<(i32, i32)> = Vec::new();
        for tenth in 300..=3_300 {
            let (x, z) = place(f64::from(tenth) / 10.0);
            let nearest = (-20..=20)
                .flat_map(|x| (-20..=20).map(move |z| (x, z)))
                .min_by(|a, b| {
                    let off = |p: &(i32, i32)| (f64::from(p.0) - x).hypot(f64::from(p.1) - z);
                    off(a).total_cmp(&off(b))
                })
                .unwrap();
            if points.last() != Some(&nearest) {
                points.push(nearest);
            }
        }
        assert!(points.contains(&(0, -10)));
        points.retain(|point| *point != (0, -10) || *point == through);
        points
    };
    let nm = |value: f64| format!("{:.0}", value * 1_000.0).parse::<i64>().unwrap();
    let (start, end) = (place(30.0), place(330.0));
    let points = walk((0, -10));
    let mut setup = starting(points[0].0, points[0].1);
    setup.start_nm = PerAxis { x: nm(start.0), z: nm(start.1) };
    let motion = arc((300, 200), (nm(end.0), nm(end.1)), false, 120.0);
    let steps = round_steps(&points, 10.0, 500.0);
    let report = play(setup, &[motion], &steps);
    clean(&report);
    assert!(report.walked.pulses < 1.0);
    assert!(report.programmed.pulses < 0.75);
    // Without that point the first half never ends.
    let without = walk((99, 99));
    let report = play(setup, &[motion], &round_steps(&without, 10.0, 500.0));
    assert_eq!(report.faults.count(FaultKind::MotionsLeft), 1);
}

#[test]
fn start_off_the_lattice_is_named() {
    let mut setup = jumpy();
    setup.start_nm.x = 501;
    let report = play(setup, &[line(0, 10_000, 120.0)], &line_steps(0, 10, 2_000.0));
    assert_eq!(report.faults.count(FaultKind::StartOffLattice), 1);
}
