//! `$` commands.

use super::*;

#[test]
fn settings_are_listed_under_numbers_and_names() {
    let mut bench = Bench::with(&[("z.pulse_nm", "15875/8")]);
    let list = bench.ask("$$\n");
    for line in [
        "$100=800.000",
        "$102=503.937",
        "$110=5000",
        "$122=500",
        "$x.pulse_nm=1250",
        "$z.pulse_nm=15875/8",
        "$start=0,0",
        "$format=gcode",
    ] {
        assert!(list.lines().any(|listed| listed == line), "{line} is not in\n{list}");
    }
    assert!(list.ends_with("\r\nok\r\n") && list.matches("ok").count() == 1);
    assert_eq!(list.lines().count(), 6 + crate::background::parameters::DEFINITIONS.len() + 1 + 1);
    // what was listed may be sent back, and changes nothing
    for line in list.lines().filter(|line| line.starts_with('$') && !line.starts_with("$start")) {
        bench.ticks(3);
        assert_eq!(bench.ask(&[line, "\n"].concat()), "ok\r\n", "{line}");
    }
    bench.ticks(3);
    assert_eq!(bench.ask("$$\n"), list);
}

#[test]
fn the_queries_of_senders_are_answered() {
    let mut bench = Bench::new();
    let help = bench.ask("$\n");
    assert!(help.starts_with("[HLP:$$ $G $I $X $name=value $format=gcode ~ ! ? ctrl-x]\r\n[HLP:$mode= "), "{help}");
    assert!(help.ends_with(" $confirm-position]\r\nok\r\n"), "{help}");
    assert_eq!(bench.ask("$G\n"), "[GC:G0 G8 G18 G21 G90 G94 M5 T0 F0.000 S0]\r\nok\r\n");
    bench.ask("G1 X0 G7 G91 G20 F2 S500 M4 T0102\n");
    assert_eq!(bench.ask("$g\n"), "[GC:G1 G7 G18 G20 G91 G94 M4 T1 F2.000 S500]\r\nok\r\n");
    let info = bench.ask("$I\n");
    assert!(info.starts_with("[VER:1.1h.20190830:HandCNC ") && info.ends_with("[OPT:V,16,512]\r\nok\r\n"), "{info}");
    assert_eq!(bench.ask("$X\n"), "ok\r\n");
    for (command, answer) in
        [("$C", "error:3"), ("$N", "error:3"), ("$J=X1F1", "error:3"), ("$H", "error:5"), ("$RST=$", "error:3")]
    {
        let text = bench.ask(&[command, "\n"].concat());
        assert!(text.starts_with("[MSG:") && text.ends_with(&[answer, "\r\n"].concat()), "{text}");
    }
}

#[test]
fn parameters_are_set_only_while_idle() {
    let mut bench = Bench::new();
    bench.tick();
    bench.ask("G1 X1 F100\n");
    for line in ["$x.max_feed=1000\n", "$100=400\n", "$format=nc1973\n"] {
        assert_eq!(bench.ask(line), "[MSG:only while the machine is idle]\r\nerror:8\r\n");
    }
    bench.send("!");
    bench.ticks(1_000);
    assert!(bench.ask("$x.max_feed=1000\n").ends_with("error:8\r\n"));
    bench.send("~");
    bench.until_idle();
    assert_eq!(bench.ask("$X.max_feed=1000\n"), "ok\r\n");
    assert!(bench.ask("$$\n").contains("$110=1000\r\n"));
}

#[test]
fn a_parameter_that_cannot_be_is_refused_and_stays() {
    let mut bench = Bench::new();
    bench.ticks(3);
    let list = bench.ask("$$\n");
    for (line, number) in [
        ("$=1", 3),
        ("$x.speed=1", 3),
        ("$999=1", 3),
        ("$x.max_feed=fast", 2),
        ("$110=", 2),
        ("$110=0", 52),
        ("$110=29000", 52),
        ("$100=0", 2),
        ("$100=-5", 2),
        ("$100=0.5", 52),
        ("$100=787.4016", 52),
        ("$start=1,1", 53),
        ("$format=fanuc", 3),
    ] {
        let text = bench.ask(&[line, "\n"].concat());
        assert!(text.starts_with("[MSG:") && text.ends_with(&std::format!("error:{number}\r\n")), "{line}: {text}");
    }
    assert_eq!(bench.ask("$$\n"), list);
}

#[test]
fn a_machine_that_was_set_is_the_machine_that_turns() {
    let set = [("x.max_feed", "2000"), ("z.pulse_width_ns", "9000"), ("x.max_jump", "1"), ("z.pulse_nm", "1984.375")];
    let program = "G91 G0 X5 Z3\nG1 X-1 Z1 F1500\nM30\n";
    let mut bench = Bench::new();
    bench.ticks(3);
    for (name, value) in set {
        assert_eq!(bench.ask(&std::format!("${name}={value}\n")), "ok\r\n");
        bench.ticks(3);
    }
    bench.stream(program.as_bytes());
    bench.until_idle();
    let mut other = Bench::with(&set);
    other.ticks(3);
    other.stream(program.as_bytes());
    other.until_idle();
    assert_eq!(bench.train, other.train);
    assert_ne!(bench.train.hash, without_link(program).hash);
}

#[test]
fn modal_codes_outlive_a_parameter() {
    let mut bench = Bench::new();
    bench.ask("G7 G91\n");
    bench.ticks(3);
    assert_eq!(bench.ask("$x.max_accel=400\nG0 X2\n"), "ok\r\nok\r\n");
    bench.until_idle();
    assert_eq!(bench.status(), "Idle|MPos:1.000,0.000,0.000");
}

#[test]
fn another_pulse_size_leaves_the_pulses_where_they_are() {
    let mut bench = Bench::new();
    bench.ask("G0 X1\n");
    bench.until_idle();
    assert_eq!(bench.ask("$100=400\n"), "ok\r\nok\r\n".get(4..).unwrap());
    bench.ticks(3);
    assert_eq!(bench.status(), "Idle|MPos:2.000,0.000,0.000");
    bench.ask("G0 X3\n");
    bench.until_idle();
    assert_eq!(bench.snapshot.position.x, 1_200);
}

#[test]
fn the_format_of_1973_is_read_after_it_was_chosen() {
    let mut bench = Bench::new();
    bench.ticks(3);
    assert_eq!(bench.ask("$format=nc1973\nN1 G01 G91 X100 Y-50 F1\nM30\n"), "ok\r\nok\r\nok\r\n");
    bench.until_idle();
    assert_eq!(bench.status(), "Idle|MPos:-0.500,0.000,1.000");
}
