//! The stock as scripts and newcomers meet it: parameters, refusals, collisions, report, pictures, examples; the built
//! program, in a folder of its own.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic, missing_docs, reason = "tests, which may panic")]

use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use tempfile::TempDir;

/// A shaft of 24 mm, 30 mm long, from the right; the nose rests on the shoulder.
const SHAFT: &str = "G7 G21 G90\nG0 X40 Z5\nX24 Z2\nG1 Z-30 F300\nX36\nG0 X40\nZ5\nM30\n";
/// A bar for it.
const BAR: [&str; 3] = ["stock.diameter_mm=32", "stock.length_mm=60", "start=20,5"];

struct Bench(TempDir);

impl Bench {
    fn with(program: &str) -> Self {
        let bench = Self(tempfile::tempdir().unwrap());
        std::fs::write(bench.path("p.nc"), program).unwrap();
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, arguments: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_virtual-lathe"));
        command.current_dir(self.0.path()).args(arguments).stdin(Stdio::null()).output().unwrap()
    }

    fn turn(&self, set: &[&str], arguments: &[&str]) -> Output {
        let set: Vec<&str> = set.iter().flat_map(|pair| ["--set", pair]).collect();
        self.run(&[&["turn", "p.nc"], &set[..], arguments].concat())
    }

    fn report(&self, set: &[&str]) -> Value {
        let output = self.turn(set, &["--report", "r.json"]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_str(&std::fs::read_to_string(self.path("r.json")).unwrap()).unwrap()
    }
}

fn number(report: &Value, path: &str) -> f64 {
    report.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path} in {report}"))
}

/// Collisions as their words and lines.
fn collisions(report: &Value) -> Vec<(String, u64)> {
    let list = report["collisions"].as_array().unwrap();
    list.iter().map(|found| (found["what"].as_str().unwrap().into(), found["line"].as_u64().unwrap())).collect()
}

#[track_caller]
fn refused(program: &str, set: &[&str], parts: &[&str]) {
    let bench = Bench::with(program);
    let output = bench.turn(set, &["--report", "r.json", "--picture", "p.svg"]);
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{told}");
    for part in parts.iter().chain(&["nothing was run"]) {
        assert!(told.contains(part), "{part:?} is not in:\n{told}");
    }
    assert!(!bench.path("r.json").exists() && !bench.path("p.svg").exists());
}

#[test]
fn a_shaft_is_cut_to_its_formula() {
    let report = Bench::with(SHAFT).report(&BAR);
    assert_eq!(collisions(&report), []);
    // the ring of 24 to 32 mm down to Z-30, less what stays in the corner: the fillet of the nose, 0.4, and the sliver
    // under a front edge of 87 degrees, which the way out takes
    let ring = std::f64::consts::PI * (16.0_f64.powi(2) - 12.0_f64.powi(2)) * 30.0;
    let fillet = 0.4 * 0.4 * (1.0 - std::f64::consts::FRAC_PI_4) * std::f64::consts::TAU * 12.09;
    let volume = number(&report, "/volume_mm3");
    assert!((volume - (ring - fillet)).abs() < 1.5, "{volume} {ring} {fillet}");
    let bar = std::f64::consts::PI * 256.0 * 60.0;
    assert!((volume + number(&report, "/volume_left_mm3") - bar).abs() < 1e-3);
    assert!(number(&report, "/surface_error_um/max") <= 1.253);
    assert_eq!(report["lost_pulses"]["x"], 0);
}

#[test]
fn times_of_the_cycle_add_up() {
    let bench = Bench::with(&SHAFT.replace("X36\n", "G4 P0.5\nG1 X36\n"));
    let report = bench.report(&BAR);
    let [cut, rapid, idle] = ["cut_s", "rapid_s", "idle_s"].map(|name| number(&report, &format!("/cycle/{name}")));
    assert!((idle - 0.5).abs() < 0.02, "{idle}");
    // 32 mm and 6 mm at 5 mm/s
    assert!((cut - 7.6).abs() < 0.1, "{cut}");
    assert!((cut + rapid + idle - number(&report, "/time_s")).abs() < 0.02);
    // of the feeds, 2 mm before the face are in the air, and all above where the nose's centre leaves the bar
    let air = number(&report, "/air_cut_percent");
    assert!((air - 100.0 * 4.4 / 38.0).abs() < 1.0, "{air}");
}

#[test]
fn a_rapid_through_the_stock_is_told_with_line_time_and_place() {
    let bench = Bench::with(&SHAFT.replace("X24 Z2\n", "X24 Z2\nG0 Z-1\n"));
    let report = bench.report(&BAR);
    assert_eq!(collisions(&report), [("rapid".into(), 4)]);
    let found = &report["collisions"][0];
    assert!((number(found, "/z_mm") - 0.0).abs() < 0.05 && number(found, "/x_mm") > 12.0);
    assert!(number(found, "/time_s") > 0.0 && number(found, "/depth_mm") > 3.0);
    let told = String::from_utf8(bench.turn(&BAR, &["--report", "r.json"]).stdout).unwrap();
    assert!(told.contains("line 4: rapid through the stock"), "{told}");
}

#[test]
fn the_chuck_is_a_collision_where_the_program_meets_it() {
    let set = [&BAR[..], &["chuck.z_mm=-25"]].concat();
    let report = Bench::with(SHAFT).report(&set);
    assert!(collisions(&report).contains(&("chuck".into(), 4)), "{report}");
}

#[test]
fn a_bar_smaller_than_the_part_is_refused_by_name() {
    refused(
        SHAFT,
        &["stock.diameter_mm=20", "stock.length_mm=60"],
        &[
            "p.nc: line 4: the part needs a diameter of 24.000 mm, the bar has 20.000 mm",
            "make stock.diameter_mm larger",
        ],
    );
    let two = SHAFT.replace("Z-30 F300\n", "Z-10 F300\nX26 Z-11\nZ-30\n");
    refused(&two, &["stock.diameter_mm=32", "stock.length_mm=10"], &["the part needs material down to Z-"]);
}

#[test]
fn a_part_that_ends_outside_the_stock_is_a_warning() {
    let report = Bench::with(SHAFT).report(&["stock.diameter_mm=32", "stock.length_mm=20", "start=20,5"]);
    let warnings = report["warnings"].as_array().unwrap();
    assert!(warnings.iter().any(|text| text.as_str().unwrap().contains("ends outside the stock")), "{warnings:?}");
}

#[test]
fn tool_data_that_is_missing_or_none_is_refused_by_name() {
    refused(SHAFT, &["tool.nose_mm=-0.4"], &["tool.nose_mm goes from 0 to 50 mm"]);
    refused(SHAFT, &["tool.nose_mm="], &["tool.nose_mm is a number of mm, such as 0.4"]);
    refused(SHAFT, &["tool.tip=10"], &["tool.tip goes from 1 to 9"]);
    refused(SHAFT, &["tool.tip=left"], &["tool.tip is a whole number"]);
    refused(SHAFT, &["tool.front_deg=50"], &["front edge at 50 and back edge at 52 degrees enclose no tool"]);
    refused(SHAFT, &["tool.nose_mm=12"], &["cutting edges of 11 mm with a nose radius of 12 mm"]);
    refused(SHAFT, &["stock.diameter_mm=-1"], &["stock.diameter_mm goes from 0 to 1000 mm"]);
}

#[test]
fn figures_that_contradict_are_refused_by_name() {
    let bar = ["stock.diameter_mm=32", "stock.length_mm=60"];
    for (extra, part) in [
        ("stock.bore_mm=32", "the bore must be smaller than the bar"),
        ("chuck.z_mm=0", "nothing of the bar stands out of the chuck"),
        ("chuck.z_mm=-61", "the chuck does not hold the bar"),
        ("chuck.diameter_mm=30", "the chuck can't hold it"),
    ] {
        let chuck = if extra.starts_with("chuck.d") { "chuck.z_mm=-50" } else { "stock.face_mm=0" };
        refused(SHAFT, &[&bar[..], &[extra, chuck]].concat(), &[part]);
    }
}

#[test]
fn a_slope_that_the_tool_cannot_reach_is_refused_only_for_a_tool_that_was_given() {
    let waist = "G7 G21 G90\nG0 X40 Z5\nX30 Z2\nG1 Z-10 F300\nX20 Z-15\nZ-20\nX40\nM30\n";
    refused(waist, &["tool.back_deg=5", "start=20,5"], &["line 5: the tool can't reach", "tool.back_deg"]);
    assert_eq!(collisions(&Bench::with(waist).report(&["start=20,5"])), []);
}

#[test]
fn a_program_without_a_bar_given_gets_one() {
    let report = Bench::with(SHAFT).report(&["start=20,5"]);
    assert!(number(&report, "/volume_left_mm3") > 0.0);
    let nothing = Bench::with("G21 G90\nG0 X10 Z-3\nM30\n").report(&[]);
    assert!(nothing["volume_mm3"].is_null() && nothing["surface_error_um"]["max"].is_null());
}

#[test]
fn what_the_machine_gets_wrong_shows_on_the_work() {
    // the cross slide comes down to its diameter, and stays short of it by the play of its screw
    let set = [&BAR[..], &["slide.x.backlash_um=20"]].concat();
    let report = Bench::with(SHAFT).report(&set);
    assert!((number(&report, "/surface_error_um/max") - 20.0).abs() < 1.0, "{report}");
    // a motor that stalls on the way to the work loses pulses, and the part is off by far more
    let weak = [&BAR[..2], &["start=60,5", "x.max_accel=40000", "x.max_jump=20"]].concat();
    let report = Bench::with(SHAFT).report(&weak);
    assert!(number(&report, "/lost_pulses/x") > 0.0, "{report}");
    assert!(number(&report, "/surface_error_um/max") > 100.0, "{report}");
}

/// Width and height of a PNG.
fn size(png: &[u8]) -> [u32; 2] {
    assert_eq!(png[1..4], *b"PNG");
    [16, 20].map(|at| u32::from_be_bytes(png[at..at + 4].try_into().unwrap()))
}

#[test]
fn all_pictures_are_drawn_and_the_svg_ones_are_well_formed() {
    let bench = Bench::with(SHAFT);
    let outputs = [
        &["--picture", "part.svg", "--error-picture", "error.svg", "--motion-picture", "motion.svg"][..],
        &["--animate", "cut.gif"],
    ]
    .concat();
    assert!(bench.turn(&BAR, &outputs).status.success());
    for name in ["part.svg", "error.svg", "motion.svg"] {
        let text = std::fs::read_to_string(bench.path(name)).unwrap();
        roxmltree::Document::parse(&text).unwrap();
    }
    let part = std::fs::read_to_string(bench.path("part.svg")).unwrap();
    for word in ["⌀24.000", "Z−30.00", "bar before the cut", "part, in section"] {
        assert!(part.contains(word), "{word}");
    }
    let gif = std::fs::read(bench.path("cut.gif")).unwrap();
    assert_eq!(gif[..6], *b"GIF89a");
    assert!(bench.turn(&BAR, &["--animate", "cut.png", "--error-picture", "error.png"]).status.success());
    let film = std::fs::read(bench.path("cut.png")).unwrap();
    assert_eq!(size(&film)[0], 800);
    let reader = png::Decoder::new(std::io::Cursor::new(&film)).read_info().unwrap();
    let frames = reader.info().animation_control.unwrap().num_frames;
    assert!((32..=130).contains(&frames), "{frames}");
    assert_eq!(size(&std::fs::read(bench.path("error.png")).unwrap())[0], 1_600);
    let told = bench.turn(&BAR, &["--animate", "cut.svg"]);
    assert_eq!(told.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&told.stderr).contains("must end in .gif or .png"));
}

#[test]
fn the_demo_is_cut_from_bar_without_touching_anything() {
    let bench = Bench::with("");
    let output = bench.run(&["turn", "--report", "r.json"]);
    assert!(output.status.success());
    let report: Value = serde_json::from_str(&std::fs::read_to_string(bench.path("r.json")).unwrap()).unwrap();
    assert_eq!(collisions(&report), []);
    assert_eq!(report["warnings"].as_array().unwrap().len(), 0);
    // half a coarser pulse, and the cusp that the nose leaves between two pulses 3 um apart: 3 nm
    assert!(number(&report, "/surface_error_um/max") <= 1.253, "{report}");
    assert!(number(&report, "/time_s") < 240.0);
    assert!(number(&report, "/volume_mm3") > 39_000.0);
}

#[test]
fn the_examples_are_one_page_with_all_pictures_in_it() {
    let bench = Bench::with("");
    let output = bench.run(&["examples", "--page", "x/page.html"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let told = String::from_utf8(output.stdout).unwrap();
    assert!(!told.contains("collision") && !told.contains("warning"), "{told}");
    let page = std::fs::read_to_string(bench.path("x/page.html")).unwrap();
    for name in ["handle.nc", "shaft.nc", "ball.nc", "taper.nc"] {
        assert!(page.contains(&format!("<h2>{name}</h2>")));
    }
    assert_eq!(page.matches("<svg").count(), 12);
    assert_eq!(page.matches("data:image/gif;base64,R0lGOD").count(), 4);
    assert!(!page.contains("src=\"http") && !page.contains("href="));
    assert_eq!(bench.0.path().join("x").read_dir().unwrap().count(), 1);
}
