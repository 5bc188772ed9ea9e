//! Whole programs at random, measured by the independent checker: DESIGN's invariants 1, 2 and 4, the feed, the time.
#![allow(clippy::unwrap_used, clippy::panic, missing_docs, reason = "tests")]

use host_tests::programs::{Piece, cases, machine, pieces, program};
use host_tests::{Run, optimum, run};
use proptest::prelude::*;

/// Deviation from the programmed curve that rounded ends may cause: on a line at most sqrt(5) / 2 = 1.118 (both ends
/// off by half a pulse in both axes, and the walk by half a pulse of the minor axis), on an arc 1 / sqrt(2) + 1/2, and a
/// 16th more on a long one whose centre moves.
const PROGRAMMED: f64 = 1.2697;

fn examine(text: &str, set: &[(&str, &str)]) -> Result<(), TestCaseError> {
    let run = exact(text, set)?;
    let least = optimum::seconds(&run.items, &run.parameters);
    // two ticks for the quantum of time, as a program of a few pulses has little else
    let time = run.report.time_s;
    prop_assert!(time <= 1.05 * least + 0.002, "{} s, optimum {} {:?}\n{}", time, least, set, text);
    Ok(())
}

/// Runs a program, which must break no rule.
fn exact(text: &str, set: &[(&str, &str)]) -> Result<Run, TestCaseError> {
    let run = run(text, set).map_err(|errors| TestCaseError::fail(format!("{errors:?}\n{text}")))?;
    let report = &run.report;
    prop_assert_eq!(report.faults.total(), 0, "{:?}\n{:?}\n{}", report.faults.first(), set, text);
    prop_assert!(report.walked.pulses <= 0.5 + 1e-6, "{:?} {:?}\n{}", report.walked, set, text);
    prop_assert!(report.programmed.pulses <= PROGRAMMED, "{:?} {:?}\n{}", report.programmed, set, text);
    if let Some(feed) = &report.feed_error_percent {
        prop_assert!(feed.max <= 0.5, "{:?} {:?}\n{}", feed, set, text);
    }
    Ok(run)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(150), failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn random_programs_are_exact_and_fast(pieces in pieces(8.0), set in machine()) {
        examine(&program(&pieces, 60.0), &set)?;
    }

    /// Lines and dwells: what is planned is the optimum but for ticks.
    #[test]
    fn lines_take_at_most_a_hundredth_or_two_ticks_more_than_the_optimum(pieces in pieces(8.0), set in machine()) {
        let straight = |piece: &Piece| !matches!(piece, Piece::Arc(..) | Piece::Run(..));
        let pieces: Vec<_> = pieces.into_iter().filter(straight).collect();
        let text = program(&pieces, 60.0);
        let run = exact(&text, &set)?;
        let (time, least) = (run.report.time_s, optimum::seconds(&run.items, &run.parameters));
        prop_assert!(time <= (1.01 * least).max(least + 0.002), "{} s, optimum {} {:?}\n{}", time, least, set, text);
    }

    #[test]
    fn random_programs_are_exact_under_the_s_laws(
        pieces in pieces(8.0),
        set in machine(),
        law in prop_oneof![Just("sine"), Just("parabolic")],
        jerk in prop_oneof![Just("200000"), Just("400000"), Just("1000000")],
    ) {
        let mut set = set;
        set.extend([("accel", law), ("max_jerk", jerk)]);
        exact(&program(&pieces, 60.0), &set)?;
    }
}
