//! Whole programs at random, measured by the independent checker: DESIGN's invariants 1, 2 and 4, the feed, the time.
#![allow(clippy::unwrap_used, clippy::panic, missing_docs, reason = "tests")]

use host_tests::programs::{cases, machine, pieces, program};
use host_tests::{optimum, run};
use proptest::prelude::*;

/// Deviation from the programmed curve that rounded ends may cause: on a line at most sqrt(5) / 2 = 1.118 (both ends
/// off by half a pulse in both axes, and the walk by half a pulse of the minor axis), on an arc 1 / sqrt(2) + 1/2, and a
/// 16th more on a long one whose centre moves.
const PROGRAMMED: f64 = 1.2697;

fn examine(text: &str, set: &[(&str, &str)]) -> Result<(), TestCaseError> {
    let run = run(text, set).map_err(|errors| TestCaseError::fail(format!("{errors:?}\n{text}")))?;
    let report = &run.report;
    prop_assert_eq!(report.faults.total(), 0, "{:?}\n{:?}\n{}", report.faults.first(), set, text);
    prop_assert!(report.walked.pulses <= 0.5 + 1e-6, "{:?} {:?}\n{}", report.walked, set, text);
    prop_assert!(report.programmed.pulses <= PROGRAMMED, "{:?} {:?}\n{}", report.programmed, set, text);
    if let Some(feed) = &report.feed_error_percent {
        prop_assert!(feed.max <= 0.5, "{:?} {:?}\n{}", feed, set, text);
    }
    let least = optimum::seconds(&run.items, &run.parameters);
    // two ticks for the quantum of time, as a program of a few pulses has little else
    prop_assert!(report.time_s <= 1.05 * least + 0.002, "{} s, optimum {} {:?}\n{}", report.time_s, least, set, text);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(150), failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn random_programs_are_exact_and_fast(pieces in pieces(8.0), set in machine()) {
        examine(&program(&pieces, 60.0), &set)?;
    }
}
