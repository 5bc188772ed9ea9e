//! Parameters and machine files.

use super::bench::{Bench, GOOD, refused_machine, refused_setting};

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
        ("method=spiral", "one of minimum-deviation"),
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
