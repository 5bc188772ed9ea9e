//! The feed: what is exact must show as exact, what is wrong by 2 % as 2 %.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "helpers of tests may panic as tests do")]

mod common;

use common::{
    Step, arc, at, changes, check, circle_points, jumpy, line, line_steps, play, retimed, round_steps, ticks, trapezoid,
};
use measure::{Checker, FaultKind, FeedError, Motion, PerAxis, Report, Setup};

fn feed(report: &Report) -> FeedError {
    report.feed_error_percent.unwrap()
}

/// 4:3, 5 mm at `speed` um/s; programmed are 120 mm/min, 2000 um/s.
fn played_at(speed: f64) -> Report {
    let steps = line_steps(3_000, 4_000, speed);
    play(jumpy(), &[line(3_000_000, 4_000_000, 120.0)], &steps)
}

#[test]
fn exact_feed_shows_no_error() {
    let error = feed(&played_at(2_000.0));
    // Edges are on whole clocks: one in 600 000 a window.
    assert!(error.max < 2e-4 && error.mean < 1e-4, "{error:?}");
    // 2.5 s in windows of 50 ms, some an edge longer; what is left at the end is none.
    assert!((47..=50).contains(&error.windows), "{error:?}");
    assert_eq!((error.unsteady, error.limited), (0, 0));
}

#[test]
fn feed_wrong_by_two_percent_shows_two_percent() {
    for (speed, percent) in [(2_040.0, 2.0), (1_960.0, 2.0), (2_002.0, 0.1), (1_000.0, 50.0)] {
        let error = feed(&played_at(speed));
        assert!((error.mean - percent).abs() < 1e-3, "{speed} {error:?}");
        assert!((error.max - percent).abs() < 1e-3, "{speed} {error:?}");
        assert_eq!(error.line, 1);
    }
}

#[test]
fn slow_feed_is_exact_from_edge_to_edge() {
    // 0.6 mm/min, 10 pulses a second: a window is one pulse.
    let steps = line_steps(0, 30, 10.0);
    let error = feed(&play(jumpy(), &[line(0, 30_000, 0.6)], &steps));
    assert!(error.max < 2e-4 && error.windows > 20, "{error:?}");
}

#[test]
fn rapid_has_no_feed() {
    let steps = line_steps(3_000, 4_000, 2_000.0);
    let motion = Motion { feed_mm_min: None, ..line(3_000_000, 4_000_000, 0.0) };
    assert!(play(jumpy(), &[motion], &steps).feed_error_percent.is_none());
}

#[test]
fn ramps_do_not_count_and_the_plateau_does() {
    let mut setup = jumpy();
    setup.limits.x.max_accel = 10.0;
    setup.limits.z.max_accel = 10.0;
    // 5 mm; to 2 mm/s with 8 mm/s², 0.25 s and 0.25 mm.
    for speed in [2_000.0, 2_040.0] {
        let steps = line_steps(3_000, 4_000, 2_000.0);
        let steps = retimed(&steps, 2_000.0, trapezoid(5_000.0, speed, 8_000.0));
        let report = play(setup, &[line(3_000_000, 4_000_000, 120.0)], &steps);
        assert_eq!(report.faults.total(), 0, "{report}");
        let error = feed(&report);
        let percent = speed / 20.0 - 100.0;
        assert!((error.max - percent).abs() < 2e-3, "{error:?}");
        assert!(error.windows > 30, "{error:?}");
    }
}

/// 0.79 mm with 0.2 mm of ramp at either end: no window is farther than 0.4 mm from both, but some are
/// steady.
#[test]
fn short_plateau_counts_where_it_is_steady() {
    let mut setup = jumpy();
    setup.limits.x.max_accel = 10.0;
    setup.limits.z.max_accel = 10.0;
    let profile = trapezoid(790.0, 1_960.0, 1e4);
    let steps = retimed(&line_steps(0, 790, 2_000.0), 2_000.0, profile);
    let error = feed(&play(setup, &[line(0, 790_000, 120.0)], &steps));
    assert!((error.max - 2.0).abs() < 1e-2, "{error:?}");
}

#[test]
fn motion_too_short_for_its_feed_is_not_judged() {
    let mut setup = jumpy();
    setup.limits.x.max_accel = 10.0;
    setup.limits.z.max_accel = 10.0;
    // 0.3 mm with 10 mm/s²: at most 1.7 of 10 mm/s.
    let steps = retimed(&line_steps(0, 300, 2_000.0), 2_000.0, trapezoid(300.0, 1e4, 1e4));
    let report = play(setup, &[line(0, 300_000, 600.0)], &steps);
    assert!(report.feed_error_percent.is_none(), "{report}");
}

/// A feed that swings by 5 % with a period of 0.2 s is never steady; it can't hide.
#[test]
fn wavering_feed_shows() {
    let swing = std::f64::consts::TAU / 0.2;
    let time = |s: f64| {
        // Solves s = 2000 (t + 0.05 sin(w t) / w) by fixed-point steps.
        (0..40).fold(0.0, |t: f64, _| s / 2_000.0 - 0.05 * (swing * t).sin() / swing)
    };
    let steps = retimed(&line_steps(3_000, 4_000, 2_000.0), 2_000.0, time);
    let error = feed(&play(jumpy(), &[line(3_000_000, 4_000_000, 120.0)], &steps));
    // The mean of a cosine over a quarter of its period is at most 0.9.
    assert!(error.max > 4.0 && error.max < 4.51, "{error:?}");
    assert!(error.unsteady > 40, "{error:?}");
}

#[test]
fn what_the_axes_allow_bounds_the_reference() {
    let mut setup = jumpy();
    setup.limits.z.max_feed = 96.0; // 1.6 mm/s; along 4:3 that is 2 mm/s
    let steps = line_steps(3_000, 4_000, 2_000.0);
    let error = feed(&play(setup, &[line(3_000_000, 4_000_000, 300.0)], &steps));
    assert!(error.max < 2e-4, "{error:?}");
    assert_eq!(error.limited, error.windows);
}

fn circle(setup: Setup, feed_mm_min: f64, speed: f64) -> Report {
    circle_from_x(0, setup, feed_mm_min, speed)
}

/// A full circle from (0, 1000), or from (1000, 0) for `x` of 1000.
fn circle_from_x(x: i32, setup: Setup, feed_mm_min: f64, speed: f64) -> Report {
    let mut points = circle_points(1_000);
    points.pop();
    let first = points.iter().position(|point| *point == (x, 1_000 - x)).unwrap();
    points.rotate_left(first);
    points.push(points[0]);
    let steps = round_steps(&points, 1_000.0, speed);
    let end = (i64::from(x) * 1_000, i64::from(1_000 - x) * 1_000);
    let setup = Setup { start: PerAxis { x, z: 1_000 - x }, start_nm: PerAxis { x: end.0, z: end.1 }, ..setup };
    let report = play(setup, &[arc((0, 0), end, false, feed_mm_min)], &steps);
    for kind in [FaultKind::StartOffLattice, FaultKind::EndMissed] {
        assert_eq!(report.faults.count(kind), 0, "{report}");
    }
    report
}

#[test]
fn feed_on_a_circle_is_measured_along_it() {
    // Each window is 100 pulses; a foot is off by half a pulse at most.
    for (speed, percent) in [(2_000.0, 0.0), (2_040.0, 2.0)] {
        let error = feed(&circle(jumpy(), 120.0, speed));
        assert!((error.mean - percent).abs() < 0.3, "{error:?}");
        assert!((error.max - percent).abs() < 1.0, "{error:?}");
        assert!(error.windows > 50, "{error:?}");
    }
}

#[test]
fn radius_and_acceleration_bound_the_feed() {
    let mut setup = jumpy();
    setup.limits.x.max_accel = 4.0;
    let error = feed(&circle(setup, 500.0, 2_000.0)); // sqrt(4 mm/s² 1 mm) = 2 mm/s
    assert!(error.mean < 0.3 && error.max < 1.0, "{error:?}");
    assert_eq!(error.limited, error.windows);
}

/// Each axis's feed bounds a circle's, wherever on the circle the axis has all of it.
#[test]
fn slower_axis_bounds_the_feed_of_a_circle() {
    for x in [0, 1_000] {
        let (mut slow_x, mut slow_z) = (jumpy(), jumpy());
        slow_x.limits.x.max_feed = 96.0;
        slow_z.limits.z.max_feed = 96.0;
        for setup in [slow_x, slow_z] {
            let error = feed(&circle_from_x(x, setup, 120.0, 1_600.0));
            assert!(error.mean < 0.3 && error.max < 1.0, "{error:?}");
            assert_eq!(error.limited, error.windows);
        }
    }
}

#[test]
fn override_scales_the_reference() {
    let steps = line_steps(3_000, 4_000, 1_000.0);
    let played = ticks(&changes(&steps));
    let run = |percent| {
        let mut checker = Checker::new(jumpy()).unwrap();
        checker.motion(line(3_000_000, 4_000_000, 120.0));
        checker.override_percent(percent);
        for tick in &played {
            checker.tick(tick);
        }
        checker.finish()
    };
    assert!(feed(&run(50)).max < 2e-4);
    assert!((feed(&run(100)).max - 50.0).abs() < 1e-3);
    assert!(run(0).feed_error_percent.is_none());
}

#[test]
fn override_in_motion_is_followed_from_then_on() {
    // 2 mm/s for 1 s, then 1 mm/s.
    let time = |s: f64| {
        if s < 2_000.0 { s / 2_000.0 } else { 1.0 + (s - 2_000.0) / 1_000.0 }
    };
    let steps = retimed(&line_steps(0, 4_000, 2_000.0), 2_000.0, time);
    let mut checker = Checker::new(jumpy()).unwrap();
    checker.motion(line(0, 4_000_000, 120.0));
    for (tick, count) in ticks(&changes(&steps)).iter().zip(0..) {
        if count == 1_001 {
            checker.override_percent(50);
        }
        checker.tick(tick);
    }
    let error = feed(&checker.finish());
    assert!(error.max < 2e-4 && error.windows > 50, "{error:?}");
}

/// Windows don't reach over joints: two motions with feeds of their own.
#[test]
fn each_motion_is_held_against_its_own_feed() {
    let mut steps = line_steps(0, 1_000, 2_000.0);
    steps.extend((1..=1_000).map(|pulse| Step { clocks: at(0.5 + f64::from(pulse) / 500.0), x: 1, z: 0 }));
    let played = ticks(&changes(&steps));
    let motions = |second| [line(0, 1_000_000, 120.0), line(1_000_000, 1_000_000, second)];
    assert!(feed(&check(jumpy(), &motions(30.0), &played)).max < 2e-4);
    let wrong = feed(&check(jumpy(), &motions(29.7), &played));
    assert!((wrong.max - 1.0101).abs() < 1e-3, "{wrong:?}");
}
