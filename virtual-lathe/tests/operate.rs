//! The command `operate` as scripts and newcomers use it: exit codes, messages, files.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "tests, and helpers of tests, which may panic")]

use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

/// Runs a scenario in a folder of its own.
fn operate(script: &str, options: &[&str]) -> (TempDir, i32, String, String) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.txt"), script).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_virtual-lathe"));
    let Output { status, stdout, stderr } =
        command.current_dir(&folder).args(["operate", "s.txt"]).args(options).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (folder, status.code().unwrap(), text(stdout), text(stderr))
}

fn state(out: &str) -> Value {
    serde_json::from_str(out).unwrap()
}

#[test]
fn the_final_state_is_json_with_every_key_of_the_language() {
    let (folder, code, out, err) = operate("0.1 wheel x +10 over 0.2\n", &[]);
    assert_eq!((code, err.contains("failed")), (0, false), "{err}");
    let state = state(&out);
    for key in [
        "mode",
        "position",
        "programmed",
        "offset",
        "dropped",
        "distance_to_go",
        "feed",
        "alarms",
        "refusals",
        "block",
        "verified",
        "spindle",
        "tick",
        "train_hash",
    ] {
        assert!(state.get(key).is_some(), "{key}");
    }
    assert_eq!((&state["position"]["x"], &state["verified"]["z"]), (&80.into(), &true.into()));
    let names = ["out/s.csv", "out/s.svg", "out/s.png"].map(|name| folder.path().join(name).is_file());
    assert_eq!(names, [true; 3]);
}

#[test]
fn the_trace_has_every_pulse_and_leads_to_the_position() {
    let (folder, _, out, _) = operate("0.1 wheel x +10 over 0.2\n0.1 wheel z -4\n", &["--trace", "t.csv"]);
    let trace = std::fs::read_to_string(folder.path().join("t.csv")).unwrap();
    let rows: Vec<Vec<i64>> =
        trace.lines().skip(1).map(|line| line.split(',').map(|part| part.parse().unwrap()).collect()).collect();
    assert_eq!(trace.lines().next(), Some("time_ns,x,z"));
    assert_eq!(rows.first(), Some(&vec![0, 0, 0]));
    assert!(rows.is_sorted_by(|a, b| a[0] <= b[0]) && rows.windows(2).all(|two| (two[1][1] - two[0][1]).abs() <= 1));
    let last = rows.last().unwrap();
    assert_eq!((last[1], last[2]), (80, -16));
    assert_eq!(state(&out)["position"], serde_json::json!({"x": 80, "z": -16}));
    assert!(!folder.path().join("out").exists());
}

#[test]
fn every_expectation_that_fails_is_told_with_line_key_found_and_wanted() {
    let script =
        "0.1 wheel x +1\n0.5 expect position.x == 9\n0.5 expect mode == handwheel\n0.6 expect alarms == emergency\n";
    let (_, code, out, err) = operate(script, &["--report", "r.json"]);
    assert_eq!(code, 1, "{err}");
    assert!(
        err.contains("s.txt:2: position.x is 8, wanted == 9") && err.contains("0.5 expect position.x == 9"),
        "{err}"
    );
    assert!(err.contains("s.txt:4: alarms is an empty list, wanted == emergency"), "{err}");
    assert_eq!(err.matches("failed").count(), 2, "{err}");
    assert_eq!(state(&out)["position"]["x"], 8);
}

#[test]
fn all_errors_of_a_script_are_told_and_nothing_is_run() {
    let cases = [
        ("1 jump", "s.txt:1:3: jump is nothing that happens", "write one of load, mode"),
        ("x mode auto", "s.txt:1:1: x is no time", "seconds"),
        ("-1 mode auto", "s.txt:1:1: -1 is no time", "seconds"),
        ("1", "what happens is missing", "write one of"),
        ("1 mode fast", "s.txt:1:8: fast is no mode", "handwheel, power, linked, auto, mdi, home, retrace"),
        ("1 wheel y +1", "y is no wheel", "x, z, contour"),
        ("1 wheel x 1.5.2", "1.5.2 is no number", "-100000 to 100000"),
        ("1 wheel x +1 within 2", "within is no time to turn over", "over SECONDS"),
        ("1 wheel x +1 over", "the time is missing", ""),
        ("1 scale 5", "5 is no scale of the wheels", "1, 10, 100, speed"),
        ("1 joystick up", "up is no way of the joystick", "path+"),
        ("1 single maybe", "maybe is no position of a switch", "on, off"),
        ("1 feed 250", "250 is out of range", "0 to 200 %"),
        ("1 feed-rate 100", "unit of a feed is missing", "mm/min, mm/rev"),
        ("1 feed-rate 0.0001 mm/min", "the feed is out of range", ""),
        ("1 taper 1", "way of Z is missing", ""),
        ("1 arc 1 2 3 4 left", "left is no sense of an arc", "cw, ccw"),
        ("1 stop-at x there", "there is no place", "here"),
        ("1 zero x far", "far is no place", ""),
        ("1 set feed_override", "the parameter's value is missing", "set NAME VALUE"),
        ("1 set feed_overdrive 5", "there is no parameter of this name", "parameters"),
        ("1 set feed_override 500", "feed_override goes from 0 to 200", "parameters"),
        ("1 set start 5,5", "start can't change while the machine is on", "second 0"),
        ("1 spindle fast", "fast is no speed", "stop"),
        ("1 limit x+ broken", "broken is no state of a limit switch", ""),
        ("1 noise lamp 5", "lamp is no source of noise", "wheel-x"),
        ("1 expect mode", "the relation is missing", "expect KEY OP VALUE"),
        ("1 expect mode = auto", "= is no relation", "=="),
        ("1 expect feed < fast", "fast is no number", "words"),
        ("1 expect feed ~ 5", "+- is missing", "~ V +- T"),
        ("1 expect speed == 5", "the state has no speed", "position"),
        ("1 expect position.y == 5", "the state has no position.y", ""),
        ("1 hold now", "now is one word too many", "#"),
        ("1 end\n2 hold", "s.txt:2:1: the scenario ends before this, in line 1", ""),
        ("1 load", "the program's name is missing", "load FILE"),
    ];
    for (script, cause, remedy) in cases {
        let (folder, code, out, err) = operate(script, &[]);
        assert_eq!((code, out.as_str()), (2, ""), "{script}: {err}");
        let line = script.lines().last().unwrap();
        assert!(
            err.contains(cause) && err.contains(remedy) && err.contains(line) && err.contains('^'),
            "{script}: {err}"
        );
        assert!(!folder.path().join("out").exists());
    }
    let together: String = cases.iter().take(20).map(|(script, ..)| format!("{script}\n")).collect();
    let (_, code, _, err) = operate(&together, &[]);
    assert_eq!((code, err.matches("error: ").count()), (2, 20), "{err}");
    assert!(err.contains("20 error(s); nothing was run"));
}

#[test]
fn a_script_that_is_not_there_or_no_text_is_an_error() {
    let (folder, ..) = operate("", &[]);
    let run = |name: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_virtual-lathe"));
        let output = command.current_dir(&folder).args(["operate", name]).output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let (code, err) = run("nowhere.txt");
    assert!(code == Some(2) && err.contains("nowhere.txt"), "{err}");
    std::fs::write(folder.path().join("b.txt"), [0xFF, 0xFE]).unwrap();
    let (code, err) = run("b.txt");
    assert!(code == Some(2) && err.contains("no text in UTF-8"), "{err}");
    assert_eq!(run(".").0, Some(2));
}

#[test]
fn an_output_never_lands_on_the_script() {
    let (folder, code, _, err) = operate("0 hold\n", &["--trace", "s.txt"]);
    assert!(code == 2 && err.contains("read or written by this call already"), "{err}");
    assert_eq!(std::fs::read_to_string(folder.path().join("s.txt")).unwrap(), "0 hold\n");
}

#[test]
fn wrong_parameters_of_the_call_are_told() {
    let (_, code, _, err) = operate("0 hold\n", &["--set", "feed_overdrive=5"]);
    assert!(code == 2 && err.contains("--set feed_overdrive=5"), "{err}");
}

#[test]
fn seconds_are_rounded_up_to_a_tick_and_lines_of_one_time_keep_their_order() {
    let script = "# out of order\n0.0021 mode power # this one comes last\n0.002 expect mode == handwheel\n\
                  0.0021 expect mode == power\n0.002 expect tick == 2\n0.0021 expect tick == 3\n\n   \n";
    let (_, code, _, err) = operate(script, &["--report", "r.json"]);
    assert_eq!(code, 0, "{err}");
}

#[test]
fn the_same_scenario_gives_the_same_train() {
    let script = "0 noise wheel-z 30\n0 spindle-wobble 20 2\n0 spindle 500\n0.1 wheel x +30 over 1\n2 end\n";
    let run = || operate(script, &["--report", "r.json"]).2;
    let (first, second) = (run(), run());
    assert_eq!(first, second);
    assert_ne!(state(&first)["train_hash"], "cbf29ce484222325");
}

#[test]
fn what_never_ends_is_ended_and_said() {
    let script = "0 mode power\n0 feed-rate 0.5 mm/min\n0.1 joystick z-\n";
    let (_, code, out, err) = operate(script, &["--report", "r.json"]);
    assert!(code == 0 && err.contains("write an end"), "{err}");
    assert_eq!(state(&out)["tick"], 60_100);
}
