//! The call, and the files that it writes.

use serde_json::Value;

use super::bench::{Bench, GOOD, unusable};

// the call

#[test]
fn unknown_options_are_usage_errors() {
    let bench = Bench::with(GOOD);
    unusable(&bench, &["p.nc", "--speed", "1"], &["--speed"]);
    unusable(&bench, &["p.nc", "q.nc"], &["q.nc"]);
    unusable(&bench, &["p.nc", "--format", "dxf"], &["auto, gcode, nc1973"]);
    unusable(&bench, &["p.nc", "--set", "x.pulse_nm"], &["NAME=VALUE"]);
    unusable(&bench, &["p.nc", "--picture", "p.jpg"], &[".svg or .png"]);
}

#[test]
fn a_missing_file_is_unreadable() {
    unusable(&Bench::new(), &["none.nc", "--report", "r.json"], &["none.nc"]);
}

#[test]
fn a_folder_is_unreadable() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("d")).unwrap();
    unusable(&bench, &["d"], &["d: is a folder"]);
}

#[test]
fn a_missing_machine_file_is_unreadable() {
    unusable(&Bench::with(GOOD), &["p.nc", "--machine", "none.toml"], &["none.toml"]);
}

#[test]
fn an_output_that_is_a_folder_is_unwritable() {
    let bench = Bench::with(GOOD);
    std::fs::create_dir(bench.path("d")).unwrap();
    for option in ["--trace", "--report"] {
        unusable(&bench, &["p.nc", option, "d"], &["d: is a folder"]);
    }
}

#[test]
fn one_unwritable_output_leaves_no_other() {
    let bench = Bench::with(GOOD);
    for (good, bad) in [("--trace", "--report"), ("--report", "--trace")] {
        unusable(&bench, &["p.nc", good, "good", bad, "p.nc/bad"], &["p.nc/bad"]);
    }
    unusable(&bench, &["p.nc", "--trace", "t", "--report", "r", "--picture", "p.nc/p.svg"], &["p.nc/p.svg"]);
}

#[test]
fn an_old_output_survives_a_refusal() {
    let bench = Bench::with("G1 X1 F0\nM30\n");
    bench.put("r.json", "old");
    assert_eq!(bench.turn(&["p.nc", "--report", "r.json"]).code, 1);
    assert_eq!(bench.read("r.json"), "old");
}

#[test]
fn an_old_output_is_replaced() {
    let bench = Bench::with(GOOD);
    bench.put("r.json", "old");
    assert_eq!(bench.report(&[])["pulses"]["x"], 800);
}

#[test]
fn folders_of_outputs_are_made() {
    let bench = Bench::with(GOOD);
    assert_eq!(bench.turn(&["p.nc", "--report", "a/b/r.json"]).code, 0);
    assert_eq!(bench.files(), ["a", "a/b", "a/b/r.json", "p.nc"]);
}

#[test]
fn a_failed_call_leaves_no_new_folder() {
    unusable(&Bench::with(GOOD), &["p.nc", "--trace", "new/t.csv", "--report", "p.nc/r.json"], &["p.nc/r.json"]);
}

#[test]
fn an_output_onto_the_program_is_refused() {
    let bench = Bench::with(GOOD);
    assert_eq!(bench.turn(&["p.nc", "--report", "p.nc"]).code, 2);
    assert_eq!(bench.read("p.nc"), GOOD);
}

#[test]
fn two_outputs_of_one_name_are_refused() {
    unusable(&Bench::with(GOOD), &["p.nc", "--trace", "same", "--report", "same"], &["same"]);
}

#[cfg(unix)]
#[test]
fn an_output_never_replaces_what_is_no_file() {
    use std::os::unix::fs::FileTypeExt;
    let bench = Bench::with(GOOD);
    let _socket = std::os::unix::net::UnixListener::bind(bench.path("s")).unwrap();
    let _ = bench.turn(&["p.nc", "--report", "s"]);
    assert!(std::fs::symlink_metadata(bench.path("s")).unwrap().file_type().is_socket());
}

#[cfg(unix)]
#[test]
fn an_output_through_a_link_writes_what_it_points_to() {
    let bench = Bench::with(GOOD);
    bench.put("target.json", "old");
    std::os::unix::fs::symlink("target.json", bench.path("r.json")).unwrap();
    assert_eq!(bench.report(&[])["pulses"]["x"], 800);
    assert!(std::fs::symlink_metadata(bench.path("r.json")).unwrap().file_type().is_symlink());
    assert_ne!(bench.read("target.json"), "old");
}

#[test]
fn standard_input_is_a_program() {
    let bench = Bench::with(GOOD);
    let file = bench.report(&[]);
    assert_eq!(bench.pipe(&["-", "--report", "s.json"], GOOD.as_bytes()).code, 0);
    assert_eq!(bench.json("s.json"), file);
}

#[test]
fn a_reader_that_goes_away_loses_no_output() {
    let bench = Bench::with(GOOD);
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let output = bench.command().args(["turn", "p.nc", "--report", "r.json"]).stdout(writer).output().unwrap();
    let err = String::from_utf8_lossy(&output.stderr);
    assert!(!err.contains("panicked"), "{err}");
    assert!(bench.path("r.json").exists());
}

#[test]
fn an_empty_standard_input_is_refused() {
    let bench = Bench::new();
    let outcome = bench.pipe(&["-"], b"");
    assert_eq!(outcome.code, 1);
    outcome.says(&["stdin:1:1", "empty program"]);
    assert!(bench.files().is_empty());
}

// outputs

#[test]
fn without_arguments_the_demo_is_turned_and_drawn() {
    let bench = Bench::new();
    let outcome = bench.run::<&str>(&[]);
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    assert_eq!(bench.files(), ["out", "out/handle.png", "out/handle.svg"]);
    assert!(outcome.out.contains("machine time"));
    let png = std::fs::read(bench.path("out/handle.png")).unwrap();
    assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
    assert!(bench.read("out/handle.svg").starts_with("<svg"));
}

#[test]
fn turn_without_a_file_is_the_demo() {
    let bench = Bench::new();
    assert_eq!(bench.turn(&["--report", "r.json"]).code, 0);
    let report = bench.json("r.json");
    assert_eq!(bench.files(), ["r.json"]);
    assert_eq!(report["warnings"], Value::Array(vec![]));
    assert!(report["deviation_pulses"]["walked"].as_f64().unwrap() <= 0.5);
    assert!(report["feed_error_percent"]["max"].as_f64().unwrap() <= 0.5);
}

#[test]
fn pictures_go_to_out_by_the_programs_name() {
    let bench = Bench::new();
    bench.put("part.one.nc", GOOD);
    assert_eq!(bench.turn(&["part.one.nc"]).code, 0);
    assert_eq!(bench.files(), ["out", "out/part.one.png", "out/part.one.svg", "part.one.nc"]);
}

#[test]
fn only_what_was_asked_for_is_written() {
    for (option, name) in [("--trace", "t.csv"), ("--report", "r.json"), ("--picture", "z.svg"), ("--picture", "z.png")]
    {
        let bench = Bench::with(GOOD);
        assert_eq!(bench.turn(&["p.nc", option, name]).code, 0);
        assert_eq!(bench.files(), ["p.nc", name]);
    }
}

#[test]
fn a_picture_is_1600_pixels_wide() {
    let bench = Bench::with(GOOD);
    assert_eq!(bench.turn(&["p.nc", "--picture", "z.png"]).code, 0);
    let png = std::fs::read(bench.path("z.png")).unwrap();
    assert_eq!(png[16..20], 1_600_u32.to_be_bytes());
}

#[test]
fn a_name_with_markup_makes_a_well_formed_picture() {
    let bench = Bench::new();
    bench.put("a&<b>.nc", GOOD);
    assert_eq!(bench.turn(&["a&<b>.nc", "--picture", "z.svg"]).code, 0);
    let text = bench.read("z.svg");
    roxmltree::Document::parse(&text).unwrap();
}

#[test]
fn the_report_has_the_keys_of_the_issue_in_order() {
    fn keys(value: &Value) -> Vec<&str> {
        value.as_object().unwrap().keys().map(String::as_str).collect()
    }
    let report = Bench::with(GOOD).report(&[]);
    assert_eq!(
        keys(&report),
        [
            "blocks",
            "events",
            "pulses",
            "time_s",
            "train_hash",
            "deviation_pulses",
            "max_rate_hz",
            "max_accel",
            "feed_error_percent",
            "lost_pulses",
            "collisions",
            "surface_error_um",
            "cycle",
            "volume_mm3",
            "volume_left_mm3",
            "air_cut_percent",
            "warnings"
        ]
    );
    for axes in ["pulses", "max_rate_hz", "max_accel", "lost_pulses"] {
        assert_eq!(keys(&report[axes]), ["x", "z"]);
    }
    assert_eq!(keys(&report["deviation_pulses"]), ["walked", "programmed"]);
    assert_eq!(keys(&report["feed_error_percent"]), ["mean", "max"]);
    assert!(report["warnings"].is_array());
}

#[test]
fn the_hash_is_sixteen_hexadecimal_digits() {
    let report = Bench::with(GOOD).report(&[]);
    let hash = report["train_hash"].as_str().unwrap();
    assert!(hash.len() == 16 && hash.chars().all(|c| c.is_ascii_digit() || ('a'..='f').contains(&c)), "{hash}");
}

#[test]
fn two_runs_have_one_report_and_one_trace() {
    let bench = Bench::with("G1 X1 Z-2 F100\nG2 X2 Z-1 R1\nG0 X0 Z0\nM30\n");
    let (first, second) = (bench.report(&[]), bench.report(&[]));
    assert_eq!(first, second);
    assert_eq!(bench.trace(&[]), bench.trace(&[]));
}

#[test]
fn the_trace_begins_at_zero() {
    assert_eq!(Bench::with(GOOD).trace(&[])[0], [0, 0, 0]);
}

#[test]
fn the_trace_begins_at_the_start() {
    // 25.001 mm is 20000.8 pulses, -0.00125 mm half a pulse below zero, which rounds up
    let trace = Bench::with(GOOD).trace(&["--set", "start=25.001,-0.00125"]);
    assert_eq!(trace[0], [0, 20_001, 0]);
}

#[test]
fn every_line_of_the_trace_steps_later_than_the_last() {
    let trace = Bench::with("G1 X1 Z-2 F100\nG2 X2 Z-1 R1\nG0 X0 Z0\nM30\n").trace(&[]);
    for pair in trace.windows(2) {
        let [time, x, z] = std::array::from_fn(|at| pair[1][at] - pair[0][at]);
        assert!(time > 0 && x.abs() <= 1 && z.abs() <= 1 && (x, z) != (0, 0), "{pair:?}");
    }
}

#[test]
fn the_trace_ends_at_the_rounded_end() {
    let trace = Bench::with("G1 X1.0006 Z-2.0012 F100\nM30\n").trace(&[]);
    // 800.48 and -800.48 pulses
    assert_eq!(trace.last().unwrap()[1..], [800, -800]);
}

#[test]
fn pulses_of_report_and_trace_agree() {
    let bench = Bench::with("G1 X1 Z-2 F100\nG3 X1 Z-2 I-1 K0\nM30\n");
    let (report, trace) = (bench.report(&[]), bench.trace(&[]));
    let count = |axis: usize| trace.windows(2).filter(|pair| pair[0][axis] != pair[1][axis]).count();
    assert_eq!(report["pulses"]["x"], count(1));
    assert_eq!(report["pulses"]["z"], count(2));
}
