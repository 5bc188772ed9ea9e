//! Speed, acceleration and jumps: kept limits are no faults, broken ones are.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "helpers of tests may panic as tests do")]

mod common;

use common::{Step, at, changes, check, line, line_steps, play, retimed, setup, ticks, trapezoid};
use measure::{Checker, FaultKind, Report, Setup};

/// Limits of `setup` with short events forgiven, and an acceleration of `accel` mm/s².
fn limited(accel: f64) -> Setup {
    let mut setup = Setup { event_min_ns: 0, ..setup() };
    setup.limits.x.max_accel = accel;
    setup.limits.z.max_accel = accel;
    setup
}

/// 20 mm along Z from rest to rest, to `speed` mm/s with `accel` mm/s².
fn ramped(speed: f64, accel: f64) -> Report {
    let steps = line_steps(0, 20_000, 1e3);
    let steps = retimed(&steps, 1e3, trapezoid(20_000.0, speed * 1e3, accel * 1e3));
    play(limited(1_000.0), &[line(0, 20_000_000, speed * 60.0)], &steps)
}

#[test]
fn acceleration_at_the_limit_is_no_fault_and_is_measured() {
    let report = ramped(80.0, 1_000.0);
    assert_eq!(report.faults.total(), 0, "{report}");
    // 64 pulses in 8 ticks; low by up to 4 pulses of 15.6 mm/s², never high.
    assert!(report.max_accel.z <= 1_000.0 && report.max_accel.z > 937.0, "{report}");
    assert!(report.max_accel.x.abs() < 1e-9 && report.bend_excess.z.abs() < 1e-9);
}

#[test]
fn acceleration_above_the_limit_is_named() {
    let report = ramped(80.0, 1_100.0);
    assert!(report.faults.count(FaultKind::Acceleration) > 0, "{report}");
    assert!(report.max_accel.z > 1_030.0 && report.max_accel.z <= 1_100.0);
    assert!(report.bend_excess.z > 1.0);
    assert_eq!(report.faults.count(FaultKind::Speed), 0);
}

#[test]
fn speed_above_the_limit_is_named() {
    assert_eq!(ramped(100.0, 1_000.0).faults.total(), 0);
    let report = ramped(101.0, 1_000.0);
    assert!(report.faults.count(FaultKind::Speed) > 0, "{report}");
    assert_eq!(report.faults.total(), report.faults.count(FaultKind::Speed));
}

/// Constant `speed` in um/s from the first tick to the last.
fn sudden(speed: f64) -> Report {
    let steps = line_steps(0, 4_000, speed);
    play(limited(1_000.0), &[line(0, 4_000_000, speed * 0.06)], &steps)
}

#[test]
fn start_and_stop_within_the_jump_are_no_faults() {
    assert_eq!(sudden(2_000.0).faults.total(), 0);
}

#[test]
fn start_above_the_jump_is_named() {
    let report = sudden(10_000.0);
    assert!(report.faults.count(FaultKind::Jump) > 0, "{report}");
    assert_eq!(report.faults.count(FaultKind::Acceleration), 0, "{report}");
    // Starts and stops are left out of the acceleration.
    assert!(report.max_accel.z < 1e-9, "{report}");
    let first = report.faults.first()[0];
    assert!(first.clocks < 20 * 12_000, "{first}");
}

#[test]
fn stop_above_the_jump_is_named_though_the_train_ends() {
    // Ramps up, and breaks off at 40 mm/s.
    let half = trapezoid(40_000.0, 4e4, 1e6);
    let steps = retimed(&line_steps(0, 20_000, 1e3), 1e3, half);
    let played = ticks(&changes(&steps));
    let played = &played[..played.len() - 2];
    let report = check(limited(1_000.0), &[line(0, 20_000_000, 2_400.0)], played);
    assert!(report.faults.count(FaultKind::Jump) > 0, "{report}");
    assert_eq!(report.faults.count(FaultKind::Acceleration), 0, "{report}");
}

/// A sudden change of speed within a motion is no joint.
#[test]
fn jump_within_a_motion_is_an_acceleration() {
    let time = |s: f64| {
        if s < 2_000.0 { s / 1e3 } else { 2.0 + (s - 2_000.0) / 2e3 }
    };
    let steps = retimed(&line_steps(0, 4_000, 1e3), 1e3, time);
    let report = play(limited(50.0), &[line(0, 4_000_000, 60.0)], &steps);
    assert!(report.faults.count(FaultKind::Acceleration) > 0, "{report}");
    assert_eq!(report.faults.count(FaultKind::Jump), 0, "{report}");
}

/// 2 mm/s out and 2 mm/s back, with a rest between them.
fn reversal(rest: f64, pause: bool, accel: f64) -> Report {
    let mut steps = line_steps(0, 400, 2_000.0);
    steps.extend((1..=400).map(|pulse| Step { clocks: at(0.2 + rest + f64::from(pulse) / 2_000.0), x: 0, z: -1 }));
    let mut checker = Checker::new(limited(accel)).unwrap();
    checker.motion(line(0, 400_000, 120.0));
    if pause {
        checker.pause();
    }
    checker.motion(line(0, 0, 120.0));
    for tick in &ticks(&changes(&steps)) {
        checker.tick(tick);
    }
    checker.finish()
}

#[test]
fn joint_allows_one_jump_and_a_rest_two() {
    // From 2 to -2 mm/s is a jump of 4; stopping and starting are two of 2.
    let through = reversal(0.0, false, 100.0);
    assert!(through.faults.count(FaultKind::Jump) > 0, "{through}");
    assert_eq!(through.faults.count(FaultKind::Acceleration), 0, "{through}");
    // With less acceleration long windows tell more.
    for accel in [100.0, 5.0] {
        assert_eq!(reversal(0.0, true, accel).faults.total(), 0);
        assert_eq!(reversal(0.03, false, accel).faults.total(), 0);
        assert_eq!(reversal(5.0, false, accel).faults.total(), 0);
    }
}

#[test]
fn hold_within_a_motion_is_a_rest() {
    for hold in [0.03, 3.0] {
        let time = |s: f64| if s < 200.0 { s / 2e3 } else { s / 2e3 + hold };
        let steps = retimed(&line_steps(0, 400, 2e3), 2e3, time);
        let report = play(limited(100.0), &[line(0, 400_000, 120.0)], &steps);
        assert_eq!(report.faults.total(), 0, "{report}");
    }
}

/// The rules hold in every direction, and at any place.
#[test]
fn ramps_of_many_speeds_keep_the_bounds() {
    for speed in [1.0, 3.3, 17.0, 61.7] {
        for accel in [100.0, 333.0, 1_000.0] {
            for (x, z) in [(0, 4_000), (-3_999, 4_000), (1_234, 4_000)] {
                let length = f64::from(x).hypot(f64::from(z));
                let profile = trapezoid(length, speed * 1e3, accel * 1e3);
                let steps = retimed(&line_steps(x, z, 1e3), 1e3, profile);
                let motion = line(i64::from(x) * 1_000, i64::from(z) * 1_000, speed * 60.0);
                let report = play(limited(accel), &[motion], &steps);
                assert_eq!(report.faults.total(), 0, "{speed} {accel} {x} {z} {report}");
            }
        }
    }
}
