//! What programs do: feeds, arcs, codes and formats.

use super::bench::{Bench, GOOD, SAMPLE_1973, refused_with};

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
