//! The command line as scripts and newcomers use it: exit codes, messages, files; the built program, in a folder of
//! its own.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    missing_docs,
    reason = "tests, and helpers of tests, which may panic"
)]

use std::ffi::OsStr;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;
use tempfile::TempDir;

const GOOD: &str = "G21 G90\nG1 X1 Z-2 F100\nM30\n";
const SAMPLE_1973: &str = "N01 G91\nN02 G01 X+5000 F0\nN03 X+7000 F1\nN04 G02 X+2000 Y0 I0 J2000\n\
                           N05 X0 Y-2000 I2000 J0\nN06 G01 X-7000\nN07 G02 X-2000 Y0 I0 J2000\n\
                           N08 X0 Y+2000 I2000 J0\nN09 G01 X-5000 F0\n";

/// A folder to run in.
struct Bench(TempDir);

/// What a run left.
struct Outcome {
    code: i32,
    out: String,
    err: String,
}

impl Bench {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn with(program: impl AsRef<[u8]>) -> Self {
        let bench = Self::new();
        bench.put("p.nc", program);
        bench
    }

    fn put(&self, name: &str, text: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), text).unwrap();
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    fn json(&self, name: &str) -> Value {
        serde_json::from_str(&self.read(name)).unwrap()
    }

    /// All files and folders below, sorted.
    fn files(&self) -> Vec<String> {
        fn below(folder: &Path, base: &Path, found: &mut Vec<String>) {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                found.push(path.strip_prefix(base).unwrap().to_string_lossy().into_owned());
                if path.is_dir() {
                    below(&path, base, found);
                }
            }
        }
        let mut found = Vec::new();
        below(self.0.path(), self.0.path(), &mut found);
        found.sort();
        found
    }

    fn command(&self) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_virtual-lathe"));
        command.current_dir(self.0.path());
        command
    }

    fn run<S: AsRef<OsStr>>(&self, arguments: &[S]) -> Outcome {
        Outcome::of(&self.command().args(arguments).stdin(Stdio::null()).output().unwrap())
    }

    fn turn(&self, arguments: &[&str]) -> Outcome {
        self.run(&[&["turn"], arguments].concat())
    }

    fn pipe(&self, arguments: &[&str], input: &[u8]) -> Outcome {
        let mut command = self.command();
        command.arg("turn").args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        child.stdin.take().unwrap().write_all(input).unwrap();
        Outcome::of(&child.wait_with_output().unwrap())
    }

    /// Runs `p.nc`; its report.
    fn report(&self, arguments: &[&str]) -> Value {
        let outcome = self.turn(&[&["p.nc", "--report", "r.json"], arguments].concat());
        assert_eq!(outcome.code, 0, "{}", outcome.err);
        self.json("r.json")
    }

    /// Runs `p.nc`; lines of its trace: time, X, Z.
    fn trace(&self, arguments: &[&str]) -> Vec<[i64; 3]> {
        let outcome = self.turn(&[&["p.nc", "--trace", "t.csv"], arguments].concat());
        assert_eq!(outcome.code, 0, "{}", outcome.err);
        let text = self.read("t.csv");
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some("time_ns,x,z"));
        lines
            .map(|line| {
                let parts: Vec<i64> = line.split(',').map(|part| part.parse().unwrap()).collect();
                parts.try_into().unwrap()
            })
            .collect()
    }
}

impl Outcome {
    fn of(output: &std::process::Output) -> Self {
        Self {
            code: output.status.code().unwrap_or(-1),
            out: String::from_utf8_lossy(&output.stdout).into_owned(),
            err: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }

    #[track_caller]
    fn says(&self, parts: &[&str]) {
        for part in parts {
            assert!(self.err.contains(part), "{part:?} is not in:\n{}", self.err);
        }
    }
}

/// A program is refused with exit code 1, the message has all `parts`, and nothing is written.
#[track_caller]
fn refused_with(program: impl AsRef<[u8]>, arguments: &[&str], parts: &[&str]) {
    for outputs in [&["--trace", "t.csv", "--report", "r.json", "--picture", "p.svg"][..], &[]] {
        let bench = Bench::with(program.as_ref());
        let outcome = bench.turn(&[&["p.nc"], arguments, outputs].concat());
        assert_eq!(outcome.code, 1, "{}{}", outcome.out, outcome.err);
        outcome.says(parts);
        outcome.says(&["nothing was run"]);
        assert_eq!(bench.files(), ["p.nc"]);
        assert_eq!(outcome.out, "");
    }
}

#[track_caller]
fn refused(program: impl AsRef<[u8]>, parts: &[&str]) {
    refused_with(program, &[], parts);
}

/// Parameters are refused with exit code 1, and nothing is written.
#[track_caller]
fn refused_setting(setting: &str, parts: &[&str]) {
    let bench = Bench::with(GOOD);
    let outcome = bench.turn(&["p.nc", "--report", "r.json", "--set", setting]);
    assert_eq!(outcome.code, 1, "{}{}", outcome.out, outcome.err);
    outcome.says(parts);
    assert_eq!(bench.files(), ["p.nc"]);
}

/// A machine file is refused with exit code 1, and nothing is written.
#[track_caller]
fn refused_machine(text: &str, parts: &[&str]) {
    let bench = Bench::with(GOOD);
    bench.put("m.toml", text);
    let outcome = bench.turn(&["p.nc", "--report", "r.json", "--machine", "m.toml"]);
    assert_eq!(outcome.code, 1, "{}{}", outcome.out, outcome.err);
    outcome.says(parts);
    assert_eq!(bench.files(), ["m.toml", "p.nc"]);
}

/// The call is no good (exit code 2) and leaves the folder as it was.
#[track_caller]
fn unusable(bench: &Bench, arguments: &[&str], parts: &[&str]) {
    let before = bench.files();
    let outcome = bench.turn(arguments);
    assert_eq!(outcome.code, 2, "{}{}", outcome.out, outcome.err);
    outcome.says(parts);
    assert_eq!(bench.files(), before);
}

// programs that are refused

#[test]
fn an_empty_file_is_refused() {
    refused("", &["p.nc:1:1", "empty program", "write a program"]);
}

#[test]
fn a_file_of_comments_is_refused() {
    refused("%\n(nothing)\n%\n", &["empty program"]);
}

#[test]
fn binary_garbage_is_refused() {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    for _ in 0..4 {
        let bytes: Vec<u8> = std::iter::repeat_with(|| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            state.to_le_bytes()[3]
        })
        .take(4_000)
        .collect();
        refused(bytes, &["p.nc:1:", "error"]);
    }
}

#[test]
fn zero_bytes_are_refused() {
    refused([0; 100], &["p.nc:1:1", "byte 00", "delete it"]);
}

#[test]
fn a_line_of_a_megabyte_is_refused() {
    let line = format!("G1 X1 F100 {}\nM30\n", "X".repeat(1_000_000));
    refused(line, &["p.nc:1:1", "line of 1000011 bytes", "at most 256"]);
}

#[test]
fn a_message_about_a_megabyte_is_short() {
    let bench = Bench::with("X1".repeat(500_000));
    assert!(bench.turn(&["p.nc"]).err.len() < 2_000);
}

#[test]
fn a_motion_without_an_end_point_is_refused() {
    refused("G1 F100\nM30\n", &["p.nc:1:1", "G1 without an end point", "1 | G1 F100", "write the end point"]);
}

#[test]
fn an_arc_without_an_end_point_is_refused() {
    refused("G2 R5 F100\nM30\n", &["p.nc:1:1", "G2 without an end point"]);
}

#[test]
fn an_arc_without_a_centre_is_refused() {
    refused("G2 X5 Z5 F100\nM30\n", &["p.nc:1:1", "without a centre", "write I and K"]);
}

#[test]
fn an_arc_whose_radius_is_too_small_is_refused() {
    refused("G2 X10 Z-10 R2 F100\nM30\n", &["p.nc:1:13", "R2 is too small", "at least 7.071068 mm"]);
}

#[test]
fn an_arc_whose_radii_differ_is_refused() {
    refused("G2 X10 Z-10 I3 K0 F100\nM30\n", &["p.nc:1:13", "3 mm from the centre", "tolerance 0.01 mm"]);
}

#[test]
fn a_full_circle_by_radius_is_refused() {
    refused("G2 X0 Z0 R5 F100\nM30\n", &["p.nc:1:10", "R5", "write I and K instead of R"]);
}

#[test]
fn a_feed_of_zero_is_refused() {
    refused("G1 X1 F0\nM30\n", &["p.nc:1:7", "F0 is no feed above zero", "write F above zero"]);
}

#[test]
fn a_negative_feed_is_refused() {
    refused("G1 X1 F-5\nM30\n", &["p.nc:1:7", "F-5 is no feed above zero"]);
}

#[test]
fn a_missing_feed_is_refused() {
    refused("G1 X1\nM30\n", &["p.nc:1:1", "G1 without a feed", "write F"]);
}

#[test]
fn a_feed_above_the_machine_is_refused() {
    refused("G1 X1 F5000.1\nM30\n", &["p.nc:1:7", "F5000.1", "X 5000, Z 5000 mm/min", "up to 5000 mm/min"]);
}

#[test]
fn a_number_past_the_range_is_refused() {
    refused("G0 Z-2100.1\nM30\n", &["p.nc:1:4", "Z-2100.1", "2100 mm"]);
}

#[test]
fn an_incremental_number_that_leads_past_the_range_is_refused() {
    refused("G0 X2000\nU200\nM30\n", &["p.nc:2:1", "U200 leads X past 2100 mm"]);
}

#[test]
fn a_number_of_too_many_digits_is_refused() {
    refused("G0 X9999999999999999999999\nM30\n", &["p.nc:1:4", "more than 18 digits"]);
}

#[test]
fn an_unknown_g_is_refused() {
    refused("G1 X1 F100\nG5 X2\nM30\n", &["p.nc:2:1", "G5 is not supported", "2 | G5 X2", "G0 G1 G2 G3 G4"]);
}

#[test]
fn an_unknown_m_is_refused() {
    refused("M98\nM30\n", &["p.nc:1:1", "M98 is not supported", "M0 M1 M2"]);
}

#[test]
fn an_unknown_letter_is_refused() {
    refused("G1 X1.0 Y2 F100\nM30\n", &["p.nc:1:9", "Y2", "a lathe moves X and Z"]);
}

#[test]
fn two_words_of_one_modal_group_are_refused() {
    for (line, words) in [
        ("G0 G1 X1 F100", "G0 and G1"),
        ("G90 G91 G1 X1 F100", "G90 and G91"),
        ("G20 G21 G1 X1 F100", "G20 and G21"),
        ("G7 G8 G1 X1 F100", "G7 and G8"),
        ("M3 M4", "M3 and M4"),
        ("M2 M30", "M2 and M30"),
    ] {
        refused(format!("{line}\nM30\n"), &["p.nc:1:", words, "exclude each other", "delete one"]);
    }
}

#[test]
fn a_word_given_twice_is_refused() {
    refused("G1 X1 X2 F100\nM30\n", &["p.nc:1:7", "X1 and X2 in one block"]);
}

#[test]
fn x_with_u_is_refused() {
    refused("G1 X1 U1 F100\nM30\n", &["p.nc:1:7", "X with U", "write X (absolute) or U (incremental)"]);
}

#[test]
fn z_with_w_is_refused() {
    refused("G1 Z1 W1 F100\nM30\n", &["p.nc:1:7", "Z with W"]);
}

#[test]
fn an_open_comment_is_refused() {
    refused("G1 X1 F100 (abc\nM30\n", &["p.nc:1:12", "comment without )"]);
}

#[test]
fn a_dwell_without_time_is_refused() {
    refused("G4\nM30\n", &["p.nc:1:1", "G4 without P", "seconds"]);
}

#[test]
fn all_errors_of_a_file_are_told() {
    refused("G1 X\nG5\nG1 X1 U1 F100\nM30\n", &["p.nc:1:4", "p.nc:2:1", "p.nc:3:7", "3 error(s)"]);
}

#[test]
fn errors_past_a_hundred_are_counted() {
    refused("G5\n".repeat(1_000), &["p.nc:100:1", "1000 error(s)", "900 of them not shown"]);
}

#[test]
fn the_word_is_marked_under_the_line() {
    refused("G1 X1 F0\nM30\n", &[" 1 | G1 X1 F0\n   |       ^^\n"]);
}

#[test]
fn a_tabulator_keeps_the_mark_under_the_word() {
    refused("G1\tX1\tF0\nM30\n", &[" 1 | G1 X1 F0\n   |       ^^\n"]);
}

#[test]
fn what_stands_behind_the_end_is_not_read() {
    let bench = Bench::with("G1 X1 F100\nM30\nG5 @\n");
    assert_eq!(bench.report(&[])["pulses"]["x"], 800);
}

// parameters

#[test]
fn an_unknown_parameter_is_refused() {
    refused_setting("x.pulse=1", &["x.pulse=1", "no parameter of this name", "nothing was run"]);
}

#[test]
fn parameters_out_of_range_are_refused() {
    for (setting, range) in [
        ("x.pulse_nm=9", "10 nm to 1 mm"),
        ("x.pulse_nm=1000001", "10 nm to 1 mm"),
        ("x.pulse_nm=1/3", "10 nm to 1 mm"),
        ("x.pulse_nm=1250/0", "10 nm to 1 mm"),
        ("z.max_feed=0", "z.max_feed goes from"),
        ("z.max_feed=-1", "z.max_feed goes from"),
        ("x.max_accel=0", "x.max_accel goes from"),
        ("x.max_jump=0", "x.max_jump goes from"),
        ("z.pulse_width_ns=0", "z.pulse_width_ns goes from"),
        ("event_min_ns=0", "event_min_ns goes from"),
        ("feed_override=201", "0 to 200 %"),
        ("feed_override=-1", "0 to 200 %"),
        ("arc_tolerance_um=-1", "arc_tolerance_um goes from"),
        ("f1=0", "f1 goes from"),
        ("start=2100.1,0", "-2100 to 2100 mm"),
    ] {
        refused_setting(setting, &[setting, range]);
    }
}

#[test]
fn malformed_parameters_are_refused() {
    for (setting, form) in [
        ("x.pulse_nm=", "15875/8"),
        ("z.max_accel=fast", "a number of mm/s2"),
        ("front_post=yes", "true or false"),
        ("method=dda", "one of minimum-deviation"),
        ("start=1", "with a comma between"),
        ("start=1,2,3", "with a comma between"),
    ] {
        refused_setting(setting, &[setting, form]);
    }
}

#[test]
fn a_feed_that_the_pulse_width_forbids_is_refused() {
    refused_setting("x.max_feed=30000", &["x.max_feed needs 400000 pulses a second", "allow 99200"]);
}

#[test]
fn a_feed_override_of_zero_is_refused() {
    refused_setting("feed_override=0", &["feed_override"]);
}

#[test]
fn all_bad_parameters_are_told() {
    let bench = Bench::with(GOOD);
    let outcome = bench.turn(&["p.nc", "--set", "a=1", "--set", "x.pulse_nm=0"]);
    assert_eq!(outcome.code, 1);
    outcome.says(&["a=1", "x.pulse_nm=0"]);
}

#[test]
fn every_parameter_takes_its_default() {
    let bench = Bench::with(GOOD);
    let plain = bench.report(&[]);
    let list = bench.run(&["parameters"]);
    assert_eq!(list.code, 0);
    let settings: Vec<String> = list
        .out
        .lines()
        .map(|line| {
            let mut words = line.split_whitespace();
            format!("{}={}", words.next().unwrap(), words.next().unwrap())
        })
        .collect();
    let names = [
        "x.pulse_nm=1250",
        "z.pulse_nm=2500",
        "x.max_feed=5000",
        "z.max_feed=5000",
        "x.max_accel=500",
        "z.max_accel=500",
        "x.max_jump=2",
        "z.max_jump=2",
        "x.pulse_width_ns=5000",
        "x.dir_setup_ns=5000",
        "x.dir_hold_ns=10000",
        "x.min_space_ns=5000",
        "z.pulse_width_ns=5000",
        "z.dir_setup_ns=5000",
        "z.dir_hold_ns=10000",
        "z.min_space_ns=5000",
        "event_min_ns=2000",
        "feed_override=100",
        "arc_tolerance_um=10",
        "corner_um=0",
        "method=minimum-deviation",
        "front_post=false",
        "block_delete=true",
    ];
    for name in names {
        assert!(settings.iter().any(|setting| setting == name), "{name}");
    }
    for number in 1..=9 {
        assert!(settings.iter().any(|setting| setting.starts_with(&format!("f{number}="))));
    }
    let arguments: Vec<&str> = settings.iter().flat_map(|setting| ["--set", setting]).collect();
    assert_eq!(bench.report(&arguments), plain);
}

#[test]
fn a_machine_file_equals_settings() {
    let bench = Bench::with("G1 X1 Z-2 F100\nG2 X2 Z-1 R1\nM30\n");
    bench.put(
        "m.toml",
        "start = [0.5, -1]\nfront_post = true\nfeed_override = 150\n[x]\npulse_nm = \"15875/8\"\nmax_jump = 0.5\n[z]\npulse_nm = 1984.375\n",
    );
    let by_file = bench.report(&["--machine", "m.toml"]);
    let settings = [
        "start=0.5,-1",
        "front_post=true",
        "feed_override=150",
        "x.pulse_nm=15875/8",
        "x.max_jump=0.5",
        "z.pulse_nm=1984.375",
    ];
    let arguments: Vec<&str> = settings.iter().flat_map(|setting| ["--set", setting]).collect();
    assert_eq!(by_file, bench.report(&arguments));
    assert_ne!(by_file["train_hash"], bench.report(&[])["train_hash"]);
}

#[test]
fn dotted_keys_of_a_machine_file_equal_tables() {
    let bench = Bench::with(GOOD);
    bench.put("a.toml", "x.pulse_nm = 5000\nx.max_feed = 700.5\n");
    bench.put("b.toml", "[x]\npulse_nm = \"5000\"\nmax_feed = 700.5\n");
    assert_eq!(bench.report(&["--machine", "a.toml"]), bench.report(&["--machine", "b.toml"]));
}

#[test]
fn a_setting_beats_the_machine_file() {
    let bench = Bench::with(GOOD);
    bench.put("m.toml", "x.pulse_nm = 5000\n");
    assert_eq!(bench.report(&["--machine", "m.toml", "--set", "x.pulse_nm=1250"]), bench.report(&[]));
}

#[test]
fn bad_toml_is_refused_with_its_place() {
    refused_machine("x.pulse_nm = = 3\n", &["m.toml", "line 1, column 14"]);
}

#[test]
fn an_unknown_name_in_a_machine_file_is_refused_with_its_line() {
    refused_machine("\nhello = 1\n", &["m.toml:2", "hello", "no parameter of this name"]);
}

#[test]
fn a_value_out_of_range_in_a_machine_file_is_refused_with_its_line() {
    refused_machine("[x]\npulse_nm = 0\n", &["m.toml:2", "x.pulse_nm", "10 nm to 1 mm"]);
}

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

#[test]
fn a_long_line_takes_the_time_of_its_feed() {
    // 60 mm at 600 mm/min and the ramps: 6 s and at most 10 mm/s / 500 mm/s2
    let trace = Bench::with("G1 Z-60 F600\nM30\n").trace(&[]);
    let time = trace.last().unwrap()[0];
    assert!((6_000_000_000..6_020_000_000).contains(&time), "{time}");
}

#[test]
fn feed_override_doubles_the_speed() {
    let bench = Bench::with("G1 Z-6 F60\nM30\n");
    let time = |set: &str| *bench.trace(&["--set", set]).last().unwrap().first().unwrap();
    let (half, whole) = (time("feed_override=200"), time("feed_override=100"));
    assert!((2 * half - whole).abs() < 20_000_000, "{half} {whole}");
}

#[test]
fn g2_is_clockwise_seen_with_z_to_the_right_and_x_upward() {
    // from the top of the circle to its right
    let trace = Bench::with("G0 X1\nG2 X0 Z1 R1 F100\nM30\n").trace(&[]);
    assert!(trace.iter().any(|[_, x, z]| *x > 500 && *z > 250));
}

#[test]
fn front_post_mirrors_the_senses() {
    let behind = Bench::with("G0 X1\nG2 X0 Z1 R1 F100\nM30\n").report(&[]);
    let front = Bench::with("G0 X1\nG3 X0 Z1 R1 F100\nM30\n").report(&["--set", "front_post=true"]);
    assert_eq!(behind["train_hash"], front["train_hash"]);
}

#[test]
fn block_delete_skips_lines_until_it_is_switched_off() {
    let bench = Bench::with("/G1 X5 F100\nG1 X1 F100\nM30\n");
    assert_eq!(bench.report(&[])["pulses"]["x"], 800);
    assert_eq!(bench.report(&["--set", "block_delete=false"])["pulses"]["x"], 4_000 + 3_200);
}

#[test]
fn g7_reads_x_as_diameter_and_g8_as_radius() {
    assert_eq!(Bench::with("G7 G0 X2\nM30\n").report(&[])["pulses"]["x"], 800);
    assert_eq!(Bench::with("G8 G0 X2\nM30\n").report(&[])["pulses"]["x"], 1_600);
    assert_eq!(Bench::with("G7 G0 U2\nM30\n").report(&[])["pulses"]["x"], 800);
}

#[test]
fn g20_reads_inches() {
    assert_eq!(Bench::with("G20 G0 X0.1 Z-0.1\nM30\n").report(&[])["pulses"]["x"], 2_032);
}

#[test]
fn u_is_incremental_in_absolute_programs() {
    let trace = Bench::with("G90 G0 X1 Z1\nU-0.5 W1\nM30\n").trace(&[]);
    assert_eq!(trace.last().unwrap()[1..], [400, 800]);
}

#[test]
fn carriage_returns_small_letters_and_semicolons_change_nothing() {
    let plain = Bench::with(GOOD).report(&[]);
    let other = Bench::with("g21g90 ; as sent by a PC\r\ng01 x+1.0 z-2. f100.\r\nm30\r\n").report(&[]);
    assert_eq!(plain["train_hash"], other["train_hash"]);
}

#[test]
fn a_program_without_end_code_runs_with_a_warning() {
    let report = Bench::with("G1 X1 F100\n").report(&[]);
    let warnings = report["warnings"].as_array().unwrap();
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0].as_str().unwrap().contains("without M2 or M30"), "{warnings:?}");
}

#[test]
fn a_feed_that_one_axis_cannot_reach_is_limited_with_a_warning() {
    let bench = Bench::with("G1 X10 F2000\nM30\n");
    let report = bench.report(&["--set", "x.max_feed=1000"]);
    let warning = report["warnings"][0].as_str().unwrap();
    assert!(warning.contains("line 1") && warning.contains('X'), "{warning}");
    let rate = report["max_rate_hz"]["x"].as_f64().unwrap();
    assert!(rate < 13_400.0, "{rate}");
}

#[test]
fn a_limited_feed_is_told_in_mm_per_minute() {
    let report = Bench::with("G1 X10 F2000\nM30\n").report(&["--set", "x.max_feed=1000"]);
    let warning = report["warnings"][0].as_str().unwrap();
    assert!(warning.contains(" 1000.0 mm/min") || warning.contains(" 999.9 mm/min"), "{warning}");
}

// the sample of 1973

#[test]
fn the_sample_of_1973_is_known_by_itself() {
    let bench = Bench::with(SAMPLE_1973);
    assert_eq!(bench.report(&[]), bench.report(&["--format", "nc1973"]));
}

#[test]
fn the_sample_of_1973_spans_110_by_40_mm_and_comes_home() {
    let trace = Bench::with(SAMPLE_1973).trace(&["--set", "f1=600"]);
    let span = |axis: usize| {
        let values = trace.iter().map(|line| line[axis]);
        (values.clone().min().unwrap(), values.max().unwrap())
    };
    // X from -40 mm to 0; Z from 0 to 140 mm, of which the first 30 are approach
    assert_eq!(span(1), (-32_000, 0));
    assert_eq!(span(2), (0, 56_000));
    assert_eq!(trace.last().unwrap()[1..], [0, 0]);
}

#[test]
fn the_sample_of_1973_is_no_g_code() {
    refused_with(SAMPLE_1973, &["--format", "gcode"], &["p.nc:4:16", "Y0", "letter Y is not supported"]);
}

#[test]
fn g_code_is_not_the_format_of_1973() {
    refused_with(GOOD, &["--format", "nc1973"], &["letter Z is not supported"]);
}

#[test]
fn an_unset_feed_code_of_1973_is_refused() {
    refused_with("G91\nG01 X100 F10\n", &["--format", "nc1973"], &["p.nc:2:10", "F10 is no feed code"]);
}

// exactness, as far as the report tells

/// Runs without a fault, with at most half a pulse from the walked curve.
#[track_caller]
fn exact(program: &str, settings: &[&str]) {
    let bench = Bench::with(program);
    let arguments: Vec<&str> = settings.iter().flat_map(|setting| ["--set", setting]).collect();
    let report = bench.report(&arguments);
    let walked = report["deviation_pulses"]["walked"].as_f64().unwrap();
    assert!(walked <= 0.5 + 1e-6, "{walked} pulses");
}

#[test]
fn pulses_of_a_micrometre_run_at_the_feed_that_the_check_lets_pass() {
    // 83 333 pulses a second, of which width and space allow 100 000
    exact("G0 X36 Z2\nM30\n", &["x.pulse_nm=1000"]);
}

#[test]
fn fine_pulses_on_a_long_arc_keep_their_space() {
    exact("G2 X0 Z0.1 R-1 F500\nM30\n", &["z.pulse_nm=100", "z.max_feed=540"]);
}

#[test]
fn a_reversal_with_a_small_jump_keeps_it() {
    exact("G1 X-0.08 F3000\nX0\nM30\n", &["x.pulse_nm=5000", "x.max_jump=0.1"]);
}

#[test]
fn an_arc_of_a_few_coarse_pulses_is_refused_where_the_pulses_are_very_unequal() {
    for (program, pulses) in [
        ("G2 X0.001 Z0.01 R0.004 F60", ["x.pulse_nm=10000/3", "z.pulse_nm=100", "z.max_feed=540"]),
        ("G2 X0.01 Z0 I0.01 K-0.0023 F60", ["x.pulse_nm=5000", "z.pulse_nm=100", "z.max_feed=540"]),
        ("G2 X-0.002 Z0 R-0.003 F60", ["x.pulse_nm=5000", "z.pulse_nm=100", "z.max_feed=270"]),
    ] {
        let bench = Bench::with(format!("{program}\nM30\n"));
        let mut arguments = vec!["p.nc", "--report", "r.json"];
        for pulse in &pulses {
            arguments.extend(["--set", pulse]);
        }
        let run = bench.turn(&arguments);
        assert_eq!(run.code, 1, "{program}");
        assert!(run.err.contains("below three pulses of the coarser axis"), "{}", run.err);
        assert!(run.err.contains("write a line in its place"), "{}", run.err);
    }
}

#[test]
fn arcs_with_the_end_a_hair_beside_the_start_run() {
    exact("G0 X10\nG2 X10 Z0.0024 I-10 K0.0012 F900\nM30\n", &[]);
    exact("G0 X10\nG3 X10 Z0.0024 I-10 K0.0012 F900\nM30\n", &[]);
}

#[test]
fn pulses_from_ten_nanometres_to_a_millimetre_run() {
    let program = "G1 X0.03 Z-0.02 F20\nG2 X0.05 Z0 I0.02 K0\nM30\n";
    let fine = ["x.pulse_nm=10", "z.pulse_nm=10", "x.max_feed=30", "z.max_feed=30"];
    exact(program, &fine);
    exact("G1 X300 Z-200 F2000\nG2 X500 Z0 I200 K0\nM30\n", &["x.pulse_nm=1000000", "z.pulse_nm=1000000"]);
}

/// DESIGN: "the walked curve joins rounded ends"; here the ends are lattice points, so it is the programmed circle.
#[test]
#[expect(clippy::cast_precision_loss, reason = "pulses")]
fn three_quarters_of_a_circle_between_lattice_points_stay_within_half_a_pulse() {
    let trace = Bench::with("G1 X10 F400\nG2 X0 Z10 R-10\nM30\n").trace(&[]);
    // the arc turns about X10 Z10
    let worst = trace
        .iter()
        .filter(|[_, _, z]| *z != 0)
        .map(|[_, x, z]| {
            let (x, z) = (*x as f64 * 1.25 - 10_000.0, *z as f64 * 2.5 - 10_000.0);
            (x.hypot(z) - 10_000.0).abs() / 2.5
        })
        .fold(0.0, f64::max);
    assert!(worst <= 0.5 + 1e-6, "{worst} pulses");
}

#[test]
fn a_short_slow_arc_keeps_its_feed_within_half_a_percent() {
    let report = Bench::with("F60\nG3 X-0.0083 Z0.009 R-0.041\nM30\n").report(&["--set", "z.max_accel=50"]);
    let worst = report["feed_error_percent"]["max"].as_f64().unwrap();
    assert!(worst <= 0.5, "{worst} %");
}
