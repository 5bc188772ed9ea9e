//! Whole programs under each pulse method, measured by the independent checker.
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

use host_tests::programs::{cases, machine, pieces, program};
use host_tests::run;
use interp_core::curve::method::Method;
use proptest::prelude::*;

/// Lines at every slope, arcs through many quadrants, full circles, small ones, sharp corners and a run of short lines.
const PROGRAM: &str = "G18 G21 G90 G94 F500
G0 X4 Z3
G1 X9 Z-11
G3 X9 Z-11 I-3 K4
G2 X9.5 Z-11 R7
G1 X9.51 Z-11.003
X9.5 Z-11.02
G3 X8 Z-9 R1.5
G2 X8 Z-9 I0.02 K0.01
G1 X8 Z4 F3000
X-3
G2 X-3 Z4 I5 K0
G0 X0 Z0
M30
";

#[test]
fn every_method_keeps_the_limits_and_its_distance_and_ends_where_it_must() {
    for method in Method::ALL {
        for (x, z) in [("1250", "2500"), ("1000", "1000"), ("5000", "10000/7")] {
            let name = method.name();
            let set = [("method", name), ("x.pulse_nm", x), ("z.pulse_nm", z)];
            let run = run(PROGRAM, &set).unwrap();
            let report = &run.report;
            assert_eq!(report.faults.total(), 0, "{name} {x} {z}: {:?}", report.faults.first());
            let (bound, off) = (bound(method), report.walked.pulses);
            assert!(off <= bound + 1e-6, "{name} {x} {z}: {off} pulses");
        }
    }
}

/// How far a method may leave the walked curve, coarser pulses.
fn bound(method: Method) -> f64 {
    match method {
        Method::MinimumDeviation => 0.5,
        // rounded chord ends, half a diagonal, and half a pulse of the chord's own walk
        Method::TimeDivision => 0.5_f64.hypot(0.5) + 0.5,
        // a step over an axis of a small circle counts on its far side, too
        Method::PointComparison | Method::Dda | Method::RateMultiplier | Method::Fraction => 1.01,
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(60), failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn random_programs_under_every_method(
        pieces in pieces(3.0), set in machine(), method in prop::sample::select(&Method::ALL[1..])
    ) {
        let text = program(&pieces, 60.0);
        let mut set = set;
        set.push(("method", method.name()));
        let run = run(&text, &set).map_err(|errors| TestCaseError::fail(format!("{errors:?}\n{text}")))?;
        let report = &run.report;
        prop_assert_eq!(report.faults.total(), 0, "{:?}\n{:?}\n{}", report.faults.first(), set, text);
        let off = report.walked.pulses;
        prop_assert!(off <= bound(method) + 1e-6, "{:?} {:?}\n{}", report.walked, set, text);
    }
}
