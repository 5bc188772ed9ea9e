//! Hold, start, override and reset at any tick: the path stays the path.
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

use handcnc::foreground::Command;
use host_tests::{run, run_with};
use proptest::prelude::*;

/// Lines, arcs of both senses, short blocks, a dwell; 8 mm/s and more.
const PROGRAM: &str = "G18 G21 G90 G94
G0 X5 Z1
G1 X5.4 Z-3 F900
G3 X9 Z-8 R7
G2 X9.4 Z-8.3 R0.5
G1 X9.45 Z-8.32
G1 X9.5 Z-8.36
G1 X9.5 Z-8.45
G4 P0.02
G2 X9.5 Z-8.45 I2 K0
G1 X12 Z-20 F3000
G0 X20 Z2
M30
";

#[derive(Clone, Debug)]
struct Reach(Vec<(u64, Command)>);

fn commands() -> impl Strategy<Value = Reach> {
    let command = prop_oneof![
        Just(Command::Hold),
        Just(Command::Start),
        (0_u16..=200).prop_map(Command::FeedOverride),
        Just(Command::OptionalStop(true)),
    ];
    prop::collection::vec((1_u64..400, command), 1..12).prop_map(|gaps| {
        let mut at = 0;
        let mut list: Vec<(u64, Command)> = gaps
            .into_iter()
            .map(|(gap, command)| {
                at += gap;
                (at, command)
            })
            .collect();
        // whatever was held or slowed to nothing goes on in the end
        list.push((at + 300, Command::FeedOverride(100)));
        list.push((at + 301, Command::Start));
        Reach(list)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn no_command_at_any_tick_changes_the_path_or_breaks_a_rule(
        reach in commands(),
        law in prop_oneof![2 => Just("linear"), 1 => Just("sine"), 1 => Just("parabolic")],
    ) {
        let set = [("accel", law), ("max_jerk", "60000")];
        let calm = run(PROGRAM, &set).unwrap().report;
        let report = run_with(PROGRAM, &set, &reach.0).unwrap().report;
        prop_assert_eq!(report.faults.total(), 0, "{:?} {:?}", report.faults.first(), reach);
        prop_assert_eq!(report.pulses, calm.pulses);
        prop_assert!(report.walked.pulses <= 0.5 + 1e-6, "{:?}", report.walked);
        if let Some(feed) = &report.feed_error_percent {
            prop_assert!(feed.max <= 0.5, "{:?} {:?}", feed, reach);
        }
    }
}

#[test]
fn a_reset_brakes_within_the_limits_and_leaves_the_rest_undone() {
    for law in ["linear", "sine", "parabolic"] {
        reset(&[("accel", law), ("max_jerk", "60000")]);
    }
}

fn reset(set: &[(&str, &str)]) {
    let calm = run(PROGRAM, set).unwrap().report;
    for at in [3_u64, 200, 900, 1500] {
        let report = run_with(PROGRAM, set, &[(at, Command::Reset)]).unwrap().report;
        assert!(report.pulses.x + report.pulses.z < calm.pulses.x + calm.pulses.z);
        // the checker misses the motions that were dropped, and nothing else
        let kinds: Vec<_> = report.faults.first().iter().map(|fault| fault.kind).collect();
        let dropped = [measure::FaultKind::MotionsLeft, measure::FaultKind::EndMissed];
        assert!(kinds.iter().all(|kind| dropped.contains(kind)), "{kinds:?}");
        // braking from 83 mm/s at 500 mm/s2 takes 167 ms, at 7/8 of it 190 ms and the mean's 33 ms
        #[allow(clippy::cast_precision_loss, reason = "a few thousand ticks")]
        let begun = at as f64 / 1e3;
        assert!(report.time_s <= begun + 0.23, "{} s after {begun}", report.time_s);
    }
}
