//! The rules of the pins, each kept to the clock and broken by one clock; hash, counts and times.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "helpers of tests may panic as tests do")]

mod common;

use common::{Step, X, X_PLUS, Z, Z_PLUS, at, check, jumpy, line, line_steps, play, setup, ticks};
use measure::{Axis, Checker, FaultKind, PerAxis, Report, Setup, Trace};

/// Plays changes of the port, X to `x` pulses and Z to `z`.
fn pins(x: i64, z: i64, changes: &[(u64, u32)]) -> Report {
    let motion = line(x * 1_000, z * 1_000, 60.0);
    check(strict(), &[motion], &ticks(changes))
}

/// Forgives jumps, not short events.
fn strict() -> Setup {
    Setup { event_min_ns: 2_000, ..jumpy() }
}

/// Width and space 2 us are 24 clocks, set-up and hold 5 us are 60.
fn fault(report: &Report, kind: FaultKind, axis: Axis, found: i64, bound: i64) {
    assert_eq!(report.faults.total(), 1, "{report}");
    let first = report.faults.first()[0];
    assert_eq!((first.kind, first.axis), (kind, Some(axis)));
    assert_eq!((first.found, first.bound), (found, bound));
}

#[test]
fn rules_kept_to_the_clock_are_no_faults() {
    let report = pins(
        1,
        0,
        &[
            (12_000, X_PLUS),
            (12_060, X_PLUS | X), // +1
            (12_084, X_PLUS),
            (12_108, X_PLUS | X), // +2
            (12_132, X_PLUS),
            (12_168, 0),
            (12_228, X), // +1
            (12_252, 0),
        ],
    );
    assert_eq!(report.faults.count(FaultKind::PulseWithoutMotion), 2);
    assert_eq!(report.faults.total(), 2, "{report}");
    assert_eq!(report.pulses, PerAxis { x: 3, z: 0 });
    assert!((report.max_rate_hz.x - 250_000.0).abs() < 1e-9); // 48 clocks; the turn doesn't count
    assert!(report.max_rate_hz.z.abs() < 1e-9);
}

/// The turn is nearer than the pulses of one direction, and doesn't count.
#[test]
fn rate_is_that_of_one_direction() {
    let plus = [(12_060, X_PLUS | X), (12_100, X_PLUS), (12_260, X_PLUS | X)];
    let turn = [(12_300, X_PLUS), (12_320, 0), (12_380, X), (12_420, 0)];
    let changes: Vec<(u64, u32)> = [(12_000, X_PLUS)].into_iter().chain(plus).chain(turn).collect();
    assert!((pins(1, 0, &changes).max_rate_hz.x - 60_000.0).abs() < 1e-9);
}

#[test]
fn short_pulse_is_named() {
    let report = pins(-1, 0, &[(12_000, X), (12_023, 0)]);
    assert_eq!(report.faults.count(FaultKind::EventTooShort), 1);
    assert_eq!(report.faults.count(FaultKind::PulseTooShort), 1);
    let of_z = pins(0, -1, &[(12_000, Z), (12_012, Z | Z_PLUS), (12_023, Z_PLUS)]);
    assert_eq!(of_z.faults.count(FaultKind::PulseTooShort), 1);
}

#[test]
fn short_space_is_named() {
    let mut setup = strict();
    setup.limits.x.min_space_ns = 2_001; // 25 clocks
    let changes = [(12_000, X), (12_030, 0), (12_054, X), (12_090, 0)];
    let report = check(setup, &[line(-2_000, 0, 60.0)], &ticks(&changes));
    fault(&report, FaultKind::SpaceTooShort, Axis::X, 24, 25);
    assert_eq!(report.faults.first()[0].clocks, 12_054);
}

#[test]
fn short_set_up_is_named() {
    let changes = [(12_000, Z_PLUS), (12_059, Z_PLUS | Z), (12_100, Z_PLUS)];
    fault(&pins(0, 1, &changes), FaultKind::DirectionSetup, Axis::Z, 59, 60);
    let together = [(12_000, Z_PLUS | Z), (12_100, Z_PLUS)];
    fault(&pins(0, 1, &together), FaultKind::DirectionSetup, Axis::Z, 0, 60);
}

#[test]
fn short_hold_is_named() {
    let changes = [(12_000, X), (12_030, 0), (12_059, X_PLUS)];
    fault(&pins(-1, 0, &changes), FaultKind::DirectionHold, Axis::X, 59, 60);
}

#[test]
fn pulse_left_high_is_named() {
    let report = pins(-1, 0, &[(12_000, X)]);
    assert_eq!(report.faults.count(FaultKind::PulseNotEnded), 1);
    assert_eq!(report.faults.total(), 1);
}

#[test]
fn wrong_sum_of_a_tick_is_named() {
    let report = check(setup(), &[], &[vec![12_000], vec![6_000, 5_999], vec![12_000]]);
    assert_eq!(report.faults.total(), 1);
    let first = report.faults.first()[0];
    assert_eq!((first.kind, first.found, first.bound), (FaultKind::TickSum, 11_999, 12_000));
    assert_eq!(first.clocks, 23_999);
}

#[test]
fn short_event_is_named_even_if_it_changes_nothing() {
    let report = check(setup(), &[], &[vec![23, 11_977]]);
    assert_eq!(report.faults.count(FaultKind::EventTooShort), 1);
    assert_eq!(report.faults.total(), 1);
    assert_eq!(check(setup(), &[], &[vec![24, 11_976]]).faults.total(), 0);
}

#[test]
fn first_twenty_faults_are_kept_and_all_counted() {
    let report = check(setup(), &[], &vec![vec![1, 11_999]; 100]);
    assert_eq!(report.faults.first().len(), 20);
    assert_eq!(report.faults.total(), 100);
}

/// Bits of other lathes are none of ours.
#[test]
fn other_lathes_pass() {
    let report = check(setup(), &[], &[vec![0xFFF0_0000 | 6_000, 6_000]]);
    assert_eq!((report.faults.total(), report.pulses), (0, PerAxis { x: 0, z: 0 }));
}

/// FNV-1a written with shifts: the prime is 2^40 + 2^8 + 0xb3.
fn fnv(ticks: &[Vec<u32>]) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for byte in ticks.iter().flatten().flat_map(|event| event.to_le_bytes()) {
        hash ^= u64::from(byte);
        hash = (hash << 40).wrapping_add(hash << 8).wrapping_add(hash.wrapping_mul(0xb3));
    }
    hash
}

#[test]
fn hash_events_and_time_end_with_the_last_tick_that_moves() {
    // The pulse rises in tick 2 and falls in tick 3.
    let played = ticks(&[(3 * 12_000 - 10, X), (3 * 12_000 + 30, 0)]);
    let motion = [line(-1_000, 0, 60.0)];
    let report = check(strict(), &motion, &played);
    assert_eq!(report.faults.total(), 1, "{report}"); // an event of 10 clocks
    assert_eq!(report.train_hash, fnv(&played[..3]));
    assert_eq!(report.events, 4);
    assert!((report.time_s - 0.003).abs() < 1e-12);
    let mut longer = played.clone();
    longer.push(vec![12_000]);
    assert_eq!(check(jumpy(), &motion, &longer).train_hash, report.train_hash);
    let still = check(setup(), &[], &[vec![12_000]]);
    assert_eq!((still.train_hash, still.events), (fnv(&[]), 0));
}

#[test]
fn trace_has_a_line_for_each_rising_edge() {
    let mut checker = Checker::new(jumpy()).unwrap();
    checker.motion(line(1_000, 2_000, 60.0));
    let mut trace = Trace::new(Vec::new()).unwrap();
    let steps = [(at(0.0), 0), (at(0.000_5), 1)].map(|(clocks, x)| Step { clocks, x, z: 1 });
    for tick in ticks(&common::changes(&steps)) {
        checker.tick_traced(&tick, &mut |clocks, x, z| trace.step(clocks, x, z));
    }
    let text = String::from_utf8(trace.finish().unwrap()).unwrap();
    assert_eq!(text, "time_ns,x,z\n1000000,0,1\n1500000,1,2\n");
    assert_eq!(checker.position(), PerAxis { x: 1, z: 2 });
}

#[test]
fn rate_is_that_of_the_closest_pulses() {
    let steps = line_steps(0, 400, 2_000.0);
    let report = play(jumpy(), &[line(0, 400_000, 120.0)], &steps);
    assert!((report.max_rate_hz.z - 2_000.0).abs() < 1e-9);
}
