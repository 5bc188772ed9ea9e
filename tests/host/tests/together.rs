//! Speed laws, blended corners, compensation and methods in one program, at random, measured by the independent checker.
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

use handcnc::foreground::Command;
use host_tests::programs::{cases, machine, pieces, program};
use host_tests::run_with;
use proptest::prelude::*;

/// What an operator does, and at which tick of the cycle.
fn deeds() -> impl Strategy<Value = Vec<(u64, Command)>> {
    let what = prop_oneof![
        3 => (0_u16..=200).prop_map(Command::FeedOverride),
        1 => Just(Command::Hold),
        2 => Just(Command::Start),
    ];
    prop::collection::vec((0_u64..3_000, what), 0..6).prop_map(|mut deeds| {
        deeds.sort_by_key(|(tick, _)| *tick);
        // whatever was held goes on in the end
        deeds.extend([(3_100, Command::FeedOverride(100)), (3_101, Command::Start)]);
        deeds
    })
}

fn choice(
    words: &'static [(&'static str, &'static str)],
) -> impl Strategy<Value = Option<(&'static str, &'static str)>> {
    prop::option::of(prop::sample::select(words))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(100), failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn everything_together_breaks_no_rule(
        pieces in pieces(3.0),
        set in machine(),
        law in choice(&[("accel", "sine"), ("accel", "parabolic")]),
        corner in choice(&[("corner_um", "20"), ("corner_um", "200")]),
        play in choice(&[("x.backlash_um", "20"), ("x.backlash_um", "300")]),
        distance in choice(&[("x.backlash_distance_um", "0"), ("x.backlash_distance_um", "400")]),
        warm in choice(&[("z.thermal_um_per_m_k", "11.5")]),
        method in choice(&[("method", "time-division"), ("method", "point-comparison")]),
        deeds in deeds(),
    ) {
        let text = program(&pieces, 60.0);
        let mut all = set;
        all.extend([law, corner, play, distance, warm, method].into_iter().flatten());
        all.push(("max_jerk", "200000"));
        all.extend([("z.backlash_um", if play.is_some() { "30" } else { "0" }), ("temperature_c", "40")]);
        let run = run_with(&text, &all, &deeds).map_err(|errors| TestCaseError::fail(format!("{errors:?}\n{text}")))?;
        let report = &run.report;
        prop_assert_eq!(report.faults.total(), 0, "{:?}\n{:?} {:?}\n{}", report.faults.first(), all, deeds, text);
        let most = if method.is_some() { 1.21 } else { 0.5 };
        prop_assert!(report.walked.pulses <= most + 1e-6, "{:?} {:?} {:?}\n{}", report.walked, all, deeds, text);
    }
}

/// A step at the end of its tick cancels nothing, and the pulse that was owed is made somewhat before it: told later, made earlier.
#[test]
fn a_pulse_made_before_one_that_was_told_of_earlier_is_known() {
    let text = "G21 G90 G94 F600\nG2 X-1.5224 Z-0.6828 I0.0000 K-2.0387\nG3 X-1.4796 Z-1.6865 I-0.8100 K-0.5373\n\
                G1 X-1.4551 Z-1.6865\nM30\n";
    let set = [
        ("x.max_feed", "2000"),
        ("z.max_jump", "8"),
        ("feed_override", "150"),
        ("accel", "sine"),
        ("max_jerk", "200000"),
        ("x.backlash_um", "300"),
        ("z.backlash_um", "30"),
    ];
    let report = run_with(text, &set, &[]).unwrap().report;
    assert_eq!(report.faults.total(), 0, "{:?}", report.faults.first());
}
