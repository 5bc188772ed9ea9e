//! Threads and feeds a turn through the whole lathe: text, blocks, train, spindle.
#![allow(clippy::unwrap_used, reason = "a test")]

use handcnc::foreground::Command;
use handcnc::foreground::alarm::Alarm;
use host_tests::{parameters, run, run_with};
use virtual_lathe::lathe::{self, Alarmed};
use virtual_lathe::program::Program;

const PASSES: &str = "\
S600 M3
G0 X10 Z5
G33 Z-20 K1.5
G0 X12
Z5
X9.5
G33 Z-15 X10 K1.5
G0 X12
Z5
M30";

#[test]
fn passes_of_a_thread_break_no_rule_of_the_checker() {
    let run = run(PASSES, &[]).unwrap();
    assert_eq!(run.report.faults.total(), 0, "{:?}", run.report.faults.first());
    assert_eq!(run.report.motions, 8);
    // pulses: X 10 + 2 + 2.5 + 0.5 + 2 of 1.25 um, Z 5 + 25 + 25 + 20 + 20 of 2.5 um
    assert_eq!((run.report.pulses.x, run.report.pulses.z), (13_600, 38_000));
    // two seconds and 1.33 of the passes at 15 mm/s, and what the rest takes
    assert!((4.0..6.5).contains(&run.report.time_s), "{}", run.report.time_s);
}

#[test]
fn a_feed_a_turn_takes_as_long_as_its_turns() {
    // 27 mm at 0.15 mm a turn are 180 turns: 18 s at 600/min
    let run = run("S600 M3\nG4 P1\nG95 F0.15 G1 Z-27\nM30", &[]).unwrap();
    assert_eq!(run.report.faults.total(), 0, "{:?}", run.report.faults.first());
    assert!((run.report.time_s - 19.0).abs() < 0.2, "{}", run.report.time_s);
}

#[test]
fn a_thread_is_cut_by_every_method_and_law_and_beside_blends() {
    for set in [("method", "dda"), ("method", "point-comparison"), ("accel", "sine"), ("corner_um", "50")] {
        let run = run(PASSES, &[set]).unwrap();
        assert_eq!(run.report.faults.total(), 0, "{set:?}: {:?}", run.report.faults.first());
        assert_eq!(run.report.motions, 8, "{set:?}");
    }
}

/// The alarm that ends a program, and its line.
fn alarmed(text: &str) -> (Alarm, u32) {
    struct Nobody;
    impl lathe::Observer for Nobody {
        fn tick(&mut self, _: &[u32], _: &interp_core::channel::Report) -> std::io::Result<()> {
            Ok(())
        }
    }
    let parameters = parameters(&[]);
    let machine = parameters.machine().unwrap();
    let program = Program::Text { name: "test".into(), text: text.as_bytes().to_vec() };
    let format = program.detect().unwrap();
    let error = lathe::run(&program, format, &parameters, &machine, &[], &mut Nobody).unwrap_err();
    let alarmed: &Alarmed = error.get_ref().unwrap().downcast_ref().unwrap();
    (alarmed.alarm, alarmed.line)
}

#[test]
fn what_waits_for_a_spindle_that_stands_ends_with_an_alarm() {
    assert_eq!(alarmed("G0 X5\nG33 Z-20 K1.5\nM30"), (Alarm::NoSpindle, 2));
    assert_eq!(alarmed("S600 M3\nG4 P1\nM5\nG4 P5\nG95 F1 G1 Z-20\nM30"), (Alarm::NoSpindle, 5));
}

#[test]
fn a_program_whose_thread_cannot_be_cut_is_refused() {
    let refused = |text: &str| run(text, &[]).err().unwrap();
    assert_eq!(
        refused("S4000 M3\nG33 Z-20 K1.5\nM30"),
        ["2: lead times S is 6000.00 mm/min, and the axes make 5000.00"]
    );
}

#[test]
fn a_hold_in_a_thread_repeats_the_pass_and_ends_where_the_program_does() {
    let straight = run(PASSES, &[]).unwrap();
    let held = run_with(PASSES, &[], &[(1_500, Command::Hold), (2_500, Command::Start)]).unwrap();
    // X out and in once more, 2 mm of 1.25 um
    assert_eq!(held.report.pulses.x, straight.report.pulses.x + 3_200);
    assert!(held.report.pulses.z > straight.report.pulses.z && held.report.time_s > straight.report.time_s + 1.0);
    assert_eq!((held.report.beyond.x, held.report.beyond.z), (0, 0));
    assert_eq!(held.report.faults.total(), 0, "{:?}", held.report.faults.first());
}
