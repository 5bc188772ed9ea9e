//! Motors behind a whole run: stalls are found where they were made, told by line and axis, and only there.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "tests, and helpers of tests, which may panic")]

use std::path::PathBuf;

use serde_json::Value;
use virtual_lathe::options::{Programs, Setup};
use virtual_lathe::turn::{self, Job};

/// Runs a program, the demo without one; exit code and report.
fn run(text: Option<&str>, set: &[(&str, &str)]) -> (u8, Value) {
    let folder = tempfile::tempdir().unwrap();
    let (program, report): (PathBuf, PathBuf) = (folder.path().join("p.nc"), folder.path().join("r.json"));
    if let Some(text) = text {
        std::fs::write(&program, text).unwrap();
    }
    let set = set.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect();
    let file = text.map(|_| program);
    let programs = Programs { setup: Setup { machine: None, set }, ..Programs::default() };
    let code = turn::turn(&Job { file, programs, report: Some(report.clone()), ..Job::default() });
    let json = std::fs::read_to_string(report).map_or(Value::Null, |text| serde_json::from_str(&text).unwrap());
    (code, json)
}

fn lost(report: &Value) -> (u64, u64) {
    (report["lost_pulses"]["x"].as_u64().unwrap(), report["lost_pulses"]["z"].as_u64().unwrap())
}

const THREE_MOVES: &str = "G21 G90\nG1 X2 F400\nG0 Z-80\nG1 X0 F400\nM30\n";

#[test]
fn the_demo_loses_nothing_on_the_default_machine() {
    let (code, report) = run(None, &[]);
    assert_eq!((code, lost(&report)), (0, (0, 0)));
    assert_eq!(report["warnings"].as_array().unwrap().len(), 0);
}

#[test]
fn a_weak_supply_stalls_the_fast_axis_and_only_in_its_line() {
    let (_, sound) = run(Some(THREE_MOVES), &[]);
    assert_eq!(lost(&sound), (0, 0));
    let (code, report) = run(Some(THREE_MOVES), &[("driver.z.supply_v", "15")]);
    let (x, z) = lost(&report);
    assert_eq!((code, x), (0, 0));
    // four full steps are 40 pulses of 2.5 um
    assert!(z > 0 && z.is_multiple_of(40), "{z}");
    let warnings = report["warnings"].as_array().unwrap();
    assert_eq!(warnings.len(), 1);
    let warning = warnings[0].as_str().unwrap();
    for word in ["line 3: ", "motor of Z", " s: ", " rpm ", &format!("{z} pulses lost"), "z.max_feed"] {
        assert!(warning.contains(word), "{warning}");
    }
    // the pulses themselves are the same
    assert_eq!(report["train_hash"], sound["train_hash"]);
}

#[test]
fn too_much_acceleration_stalls_the_axis_that_has_it() {
    let set = [("x.max_accel", "40000"), ("x.max_jump", "20")];
    let (_, report) = run(Some("G21 G90\nG0 Z-5\nG0 X60\nG0 Z0\nM30\n"), &set);
    let (x, z) = lost(&report);
    assert!(x > 0 && x.is_multiple_of(80) && z == 0, "{x} {z}");
    assert!(report["warnings"][0].as_str().unwrap().starts_with("line 3: the motor of X stalls"));
}

#[test]
fn every_speed_and_acceleration_of_the_defaults_is_followed_in_every_direction() {
    // rapids and feeds along both axes and across, arcs, reversals at full speed
    let text = "G21 G90\nG0 X40 Z-60\nG0 X0 Z0\nG0 X3\nG0 X0\nG0 Z-40\nG0 Z0\nG1 X20 Z-20 F5000\nG3 X20 Z-20 I-10 K0 F3000\n\
                G2 X0 Z-40 I-20 K0\nG1 Z-40.01 F4000\nG1 Z-39\nG1 Z-41\nG1 X0.01\nG0 X0 Z0\nM30\n";
    let (code, report) = run(Some(text), &[]);
    assert_eq!((code, lost(&report)), (0, (0, 0)), "{}", report["warnings"]);
}

#[test]
fn a_driver_that_needs_longer_pulses_is_told() {
    let (code, report) = run(Some(THREE_MOVES), &[("driver.x.pulse_width_ns", "8000")]);
    let (x, z) = lost(&report);
    assert_eq!((code, z), (0, 0));
    assert_eq!(x, report["pulses"]["x"].as_u64().unwrap());
    let warning = report["warnings"][0].as_str().unwrap();
    assert!(
        warning.starts_with("line 2: the driver of X misreads") && warning.contains("x.pulse_width_ns"),
        "{warning}"
    );
}

#[test]
fn figures_that_contradict_are_refused_before_anything_runs() {
    for set in [("driver.x.microsteps", "16"), ("motor.z.steps", "201"), ("spindle.load_nm", "8"), ("motor.x.foo", "1")]
    {
        assert_eq!(run(Some(THREE_MOVES), &[set]), (turn::REFUSED, Value::Null), "{}", set.0);
    }
}

#[test]
fn the_book_lists_every_parameter_as_the_command_does() {
    let book = include_str!("../../docs/src/using-turn.md");
    for line in virtual_lathe::report::parameters().lines() {
        assert!(book.lines().any(|written| written == line.trim_end()), "using-turn.md lacks: {line}");
    }
}
