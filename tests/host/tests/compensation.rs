//! Whole programs with compensation live: the checker finds the program on its curves and the motors within their limits.
#![allow(clippy::panic, missing_docs, reason = "a test")]

use handcnc::foreground::Command;
use host_tests::run_with;

const COMPENSATED: [(&str, &str); 6] = [
    ("x.backlash_um", "20"),
    ("z.backlash_um", "45"),
    ("x.backlash_distance_um", "15"),
    ("x.thermal_um_per_m_k", "11.5"),
    ("z.thermal_um_per_m_k", "12"),
    ("temperature_c", "31"),
];

/// Arcs in all quadrants, reversals at speed, short blocks, a dwell.
const PROGRAM: &str = "G21 G90 G94\nG0 X20 Z10\nG1 X22 Z5 F600\nG2 X22 Z5 I-4 K3 F900\nG3 X12 Z5 I-5 K0\nG1 X25 Z-5\nG4 P0.05\n\
                       G1 X24.9 Z-5.1\nX25 Z-5\nX24.95 Z-5.2\nX25.2 Z-5.1 F2000\nG0 X0 Z0\nX10\nX0\nZ30\nZ-30\nM30\n";

#[test]
fn a_compensated_program_keeps_every_rule() {
    let holds = [
        (300, Command::Hold),
        (800, Command::Start),
        (1500, Command::FeedOverride(40)),
        (3000, Command::FeedOverride(130)),
    ];
    for commands in [&[][..], &holds] {
        for method in ["minimum-deviation", "dda", "time-division"] {
            let set = [&COMPENSATED[..], &[("method", method)]].concat();
            let run = run_with(PROGRAM, &set, commands).unwrap_or_else(|errors| panic!("{errors:?}"));
            let faults = &run.report.faults;
            assert_eq!(faults.total(), 0, "{method}: {:?}", faults.first());
            assert!(method != "minimum-deviation" || run.report.walked.pulses <= 0.5 + 1e-6);
            // X came back in minus, and so did Z; the rest is heat
            let beyond = run.report.beyond;
            assert!((-17..=-15).contains(&beyond.x) && (-16..=-13).contains(&beyond.z), "{beyond:?}");
        }
    }
}
