//! Which motion a pulse belongs to, and what is missing or too much.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "helpers of tests may panic as tests do")]

mod common;

use common::{Step, at, jumpy, line, line_steps, play};
use measure::{FaultKind, Motion, Report};

fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-6, "{found} is not {expected}");
}

fn clean(report: &Report) {
    assert_eq!(report.faults.total(), 0, "{report}");
}

#[test]
fn missing_last_pulse_is_named() {
    let mut steps = line_steps(300, 400, 2_000.0);
    steps.pop();
    let report = play(jumpy(), &[line(300_000, 400_000, 120.0)], &steps);
    assert_eq!(report.faults.count(FaultKind::EndMissed), 1);
    assert_eq!(report.faults.count(FaultKind::MotionsLeft), 1);
    assert_eq!(report.motions, 0);
    let fault = report.faults.first()[1];
    assert_eq!((fault.found, fault.bound), (300, 400));
}

#[test]
fn pulse_too_many_is_named() {
    let steps = line_steps(0, 401, 2_000.0);
    let report = play(jumpy(), &[line(0, 400_000, 120.0)], &steps);
    assert_eq!(report.faults.count(FaultKind::PulseWithoutMotion), 1);
    assert_eq!(report.faults.count(FaultKind::EndMissed), 1);
    close(report.walked.pulses, 1.0);
}

#[test]
fn motion_never_played_is_counted() {
    let steps = line_steps(0, 400, 2_000.0);
    let motions = [
        line(0, 400_000, 120.0),
        line(400, 400_400, 120.0), // rounds to where it starts
        line(0, 401_000, 120.0),
        line(0, 400_000, 120.0),
    ];
    let report = play(jumpy(), &motions, &steps);
    assert_eq!(report.faults.count(FaultKind::MotionsLeft), 1);
    assert_eq!(report.faults.first()[0].found, 2);
    // It stands on the last end, though.
    assert_eq!(report.faults.count(FaultKind::EndMissed), 0);
}

/// There and back on the same points: only the order tells.
#[test]
fn reversal_on_the_same_line_is_two_motions() {
    let mut steps = line_steps(0, 100, 2_000.0);
    steps.extend((0..100).map(|pulse| Step { clocks: at(0.1 + f64::from(pulse) / 2_000.0), x: 0, z: -1 }));
    let motions = [line(0, 100_000, 120.0), line(0, 0, 120.0)];
    let report = play(jumpy(), &motions, &steps);
    clean(&report);
    assert_eq!((report.motions, report.backward_steps), (2, 0));
    let report = play(jumpy(), &motions[..1], &steps);
    assert_eq!(report.faults.count(FaultKind::PulseWithoutMotion), 100);
    assert_eq!(report.backward_steps, 100);
}

#[test]
fn overrun_counts_as_deviation_and_the_following_goes_on() {
    // Along Z to 100, two pulses too far and back, then along X.
    let mut steps = line_steps(0, 102, 2_000.0);
    let mut clocks = 0.1;
    for (x, z) in [(0, -1), (0, -1)].into_iter().chain([(1, 0); 50]) {
        let time = at(clocks);
        steps.push(Step { clocks: time, x, z });
        clocks += 1.0 / 2_000.0;
    }
    let motions = [line(0, 100_000, 120.0), line(50_000, 100_000, 120.0)];
    let report = play(jumpy(), &motions, &steps);
    clean(&report);
    close(report.walked.pulses, 2.0);
    assert_eq!(report.motions, 2);
}

#[test]
fn end_passed_by_a_step_of_both_axes_is_named() {
    // Along Z to 10, then along X, with the corner cut by one diagonal step.
    let mut steps = line_steps(0, 10, 2_000.0);
    let last = steps.len() - 1;
    steps[last].x = 1;
    let corner = steps[last].clocks;
    steps.extend((1..10).map(|pulse| Step { clocks: corner + 6_000 * pulse, x: 1, z: 0 }));
    let motions = [line(0, 10_000, 120.0), line(10_000, 10_000, 120.0)];
    let report = play(jumpy(), &motions, &steps);
    assert_eq!(report.faults.count(FaultKind::EndSkipped), 1);
    assert_eq!(report.faults.total(), 1, "{report}");
    close(report.walked.pulses, 0.0);
}

/// Steps one after the other, 0.5 ms apart, after `steps`.
fn go_on(steps: &mut Vec<Step>, moves: &[(i32, i32)]) {
    for (x, z) in moves {
        let clocks = steps.last().map_or(12_000, |step| step.clocks) + 6_000;
        steps.push(Step { clocks, x: *x, z: *z });
    }
}

#[test]
fn step_before_the_start_is_as_far_off_as_it_is() {
    let mut steps = Vec::new();
    go_on(&mut steps, &[(0, -1), (0, -1), (0, -1)]);
    go_on(&mut steps, &[(0, 1); 13]);
    let report = play(jumpy(), &[line(0, 10_000, 120.0)], &steps);
    close(report.walked.pulses, 3.0);
    assert_eq!((report.motions, report.backward_steps), (1, 3));
}

/// At an acute corner the points of the new motion are close to the old one, too.
#[test]
fn step_from_a_corner_belongs_to_what_follows() {
    let mut steps = line_steps(0, 100, 2_000.0);
    go_on(&mut steps, &[(0, -1), (1, -1)]);
    let second = Motion { line: 2, ..line(1_000, 98_000, 120.0) };
    let report = play(jumpy(), &[line(0, 100_000, 120.0), second], &steps);
    clean(&report);
    // (0, 99) is on the old line, and half a pulse of X off the new one with its slope of 1:2.
    close(report.walked.pulses, 1.0 / 5.0_f64.sqrt());
    assert_eq!(report.walked.line, 2);
}

/// Off both, a point belongs to the nearer one; on a tie to what follows.
#[test]
fn point_off_both_belongs_to_the_nearer() {
    // Along Z to 100 with X 0, then to X -50; in between out to X 3.
    let mut steps = line_steps(0, 100, 2_000.0);
    go_on(&mut steps, &[(1, -1), (1, 0), (0, 1), (1, 0)]);
    go_on(&mut steps, &[(-1, 0); 53]);
    let second = Motion { line: 2, ..line(-50_000, 100_000, 120.0) };
    let report = play(jumpy(), &[line(0, 100_000, 120.0), second], &steps);
    close(report.walked.pulses, 3.0);
    assert_eq!((report.walked.line, report.motions), (2, 2));
}
