//! Real-time bytes.

use super::*;

#[test]
fn the_banner_and_the_reports_follow_grbl() {
    let mut bench = Bench::with(&[("start", "12.5,-3")]);
    bench.link.banner(&mut bench.out);
    bench.tick();
    bench.send("??");
    let mut lines = bench.out.lines();
    assert_eq!(lines.next(), Some(""));
    assert_eq!(lines.next(), Some("Grbl 1.1h ['$' for help]"));
    assert_eq!(lines.next(), Some("<Idle|MPos:12.500,0.000,-3.000|Bf:16,512|FS:0,0|WCO:0.000,0.000,0.000>"));
    assert_eq!(lines.next(), Some("<Idle|MPos:12.500,0.000,-3.000|Bf:16,512|FS:0,0|Ov:100,100,100>"));
    bench.out.clear();
    bench.send("????????????????????");
    let with = |field: &str| {
        let places = bench.out.lines().enumerate().filter(|(_, line)| line.contains(field));
        places.map(|(at, _)| at).collect::<Vec<_>>()
    };
    assert_eq!((with("WCO"), with("Ov")), (std::vec![8, 18], std::vec![9, 19]));
}

#[test]
fn a_report_in_motion_shows_line_feed_and_spindle() {
    let mut bench = Bench::new();
    bench.ask("G97\nS1200 M3\nG1 Z50 F900\nM30\n");
    bench.ticks(600);
    bench.out.clear();
    bench.send("??");
    let second = bench.out.lines().nth(1).unwrap();
    assert!(second.starts_with("<Run|MPos:0.000,0.000,"), "{second}");
    assert!(second.ends_with("|Bf:16,512|Ln:3|FS:900,1200|Ov:100,100,100|A:S>"), "{second}");
}

#[test]
fn hold_brakes_and_start_goes_on_to_the_same_end() {
    let mut bench = Bench::under_way();
    bench.send("!");
    bench.tick();
    bench.tick();
    assert!(bench.status().starts_with("Hold:1|"));
    bench.ticks(500);
    let held = bench.status();
    assert!(held.starts_with("Hold:0|"));
    bench.ticks(500);
    assert_eq!(bench.status(), held);
    bench.send("~");
    bench.until_idle();
    assert_eq!(bench.status(), "Idle|MPos:0.000,0.000,0.000");
    assert_eq!(bench.train.pulses, 2 * (40_000 + 20_000));
}

#[test]
fn a_hold_before_the_start_keeps_everything_still() {
    let mut bench = Bench::new();
    bench.send("G0 X5\n!");
    bench.ticks(300);
    assert_eq!((bench.status().as_str(), bench.train.pulses), ("Hold:0|MPos:0.000,0.000,0.000", 0));
    bench.send("~");
    bench.until_idle();
    assert_eq!(bench.status(), "Idle|MPos:5.000,0.000,0.000");
}

#[test]
fn a_hold_while_the_look_ahead_fills_is_kept() {
    let mut bench = Bench::new();
    bench.ask("G0 X5\n");
    bench.ticks(10);
    assert_eq!(bench.snapshot.state, State::Filling);
    bench.send("!");
    bench.ticks(300);
    assert_eq!((bench.status().as_str(), bench.train.pulses), ("Hold:0|MPos:0.000,0.000,0.000", 0));
    bench.send("~");
    bench.until_idle();
    assert_eq!(bench.status(), "Idle|MPos:5.000,0.000,0.000");
}

#[test]
fn a_programmed_stop_waits_for_start() {
    for (stop, set) in [("M0", "false"), ("M1", "true")] {
        let mut bench = Bench::with(&[("optional_stop", set)]);
        bench.ask(&std::format!("G0 X1\n{stop}\nG0 X2\nM30\n"));
        bench.ticks(2_000);
        assert_eq!(bench.status(), "Hold:0|MPos:1.000,0.000,0.000");
        bench.send("~");
        bench.until_idle();
        assert_eq!(bench.status(), "Idle|MPos:2.000,0.000,0.000");
    }
}

#[test]
fn an_optional_stop_is_passed_by_until_it_is_switched_on() {
    let mut bench = Bench::new();
    bench.ask("G0 X1\nM1\nG0 X2\nM30\n");
    bench.until_idle();
    assert_eq!(bench.status(), "Idle|MPos:2.000,0.000,0.000");
    assert_eq!(bench.ask("$optional_stop=true\n"), "ok\r\n");
    bench.ask("G0 X1\nM1\nG0 X0\nM30\n");
    bench.ticks(2_000);
    assert_eq!(bench.status(), "Hold:0|MPos:1.000,0.000,0.000");
}

#[test]
fn the_spindle_follows_the_program_and_stops_at_its_end_and_at_a_reset() {
    let mut bench = Bench::new();
    bench.ask("M3 S100\nG1 X1 F600\nM4\nG4 P0.2\nM3\nX0\nM30\n");
    let spindle = |bench: &Bench| bench.foreground.outputs().spindle;
    assert!(!spindle(&bench));
    bench.ticks(100);
    assert!(spindle(&bench));
    // no board has a pin for the sense: a reverse is not a forward
    bench.ticks(150);
    assert!(!spindle(&bench));
    bench.until_idle();
    assert!(!spindle(&bench) && bench.foreground.outputs().motors);
    bench.ask("M3\nG1 X5 F600\n");
    bench.ticks(200);
    assert!(spindle(&bench));
    bench.send("\x18");
    bench.tick();
    assert!(!spindle(&bench));
}

#[test]
fn an_override_of_nothing_stands_still_and_goes_on() {
    let mut bench = Bench::new();
    bench.ticks(3);
    assert_eq!(bench.ask("$feed_override=0\n"), "ok\r\n");
    bench.ticks(3);
    bench.ask("G1 X1 F600\nM30\n");
    bench.ticks(500);
    assert_eq!((bench.pulses, bench.snapshot.feed_override), (0, 0));
    bench.send(b"\x90");
    bench.until_idle();
    assert_eq!(bench.status(), "Idle|MPos:1.000,0.000,0.000");
}

#[test]
fn a_reset_brakes_forgets_and_goes_on_from_where_the_tool_is() {
    let mut bench = Bench::under_way();
    bench.send("G0 X9\nG0 X1\x18G91\nG0 X1.25\nG0");
    bench.tick();
    bench.work();
    assert_eq!(bench.out, "", "neither banner nor answer while it brakes");
    assert!(bench.status().starts_with("Hold:1|"));
    while bench.out.is_empty() {
        bench.tick();
        assert!(bench.ticks < 5_000);
    }
    assert_eq!(bench.out, "\r\nGrbl 1.1h ['$' for help]\r\nok\r\nok\r\n");
    let stood = bench.snapshot.position;
    assert!(stood.x > 0 && stood == bench.counted);
    bench.until_idle();
    let moved = Lattice { x: stood.x + 1_000, z: stood.z };
    assert_eq!((bench.snapshot.position, bench.counted), (moved, moved));
}

#[test]
fn a_reset_at_rest_answers_with_the_banner_and_keeps_the_programmed_place() {
    let mut bench = Bench::new();
    // a third of a pulse off the lattice, twice, is nearer to the next
    bench.ask("G91 G0 X0.0004\n");
    bench.until_idle();
    bench.out.clear();
    bench.send("\x18");
    bench.ticks(5);
    assert_eq!(bench.out, "\r\nGrbl 1.1h ['$' for help]\r\n");
    bench.ask("G91 G0 X0.0004\n");
    bench.until_idle();
    assert_eq!(bench.snapshot.position.x, 1);
}

#[test]
fn resets_come_through_a_full_queue_of_commands_and_repeat_harmlessly() {
    let mut bench = Bench::under_way();
    bench.send("!~!~!~!~!~!~!~!~!~\x18!~!~\x18");
    bench.ticks(1_000);
    assert_eq!(bench.out.matches("Grbl").count(), 1);
    assert!(bench.status().starts_with("Idle|"));
    assert_eq!(bench.counted, bench.snapshot.position);
}

#[test]
fn the_override_is_set_in_steps_within_its_range() {
    let mut bench = Bench::under_way();
    let show = |bench: &mut Bench, bytes: &[u8]| {
        bench.send(bytes);
        bench.ticks(3);
        bench.snapshot.feed_override
    };
    assert_eq!(show(&mut bench, b"\x91\x91\x93"), 121);
    assert_eq!(show(&mut bench, b"\x92\x94\x94"), 109);
    assert_eq!(show(&mut bench, b"\x90"), 100);
    assert_eq!(show(&mut bench, &[0x91; 30]), 200);
    assert_eq!(show(&mut bench, &[0x92; 30]), 10);
    bench.out.clear();
    bench.send("?");
    assert!(bench.out.contains("|Ov:10,100,100"), "{}", bench.out);
    bench.send("\x18");
    bench.ticks(1_000);
    assert_eq!(bench.snapshot.feed_override, 100);
}

#[test]
fn real_time_bytes_act_while_a_line_waits_for_the_queue() {
    let mut bench = Bench::new();
    let lines: String = (0..100).map(|at| std::format!("G1 X{}.5 F100\n", at % 9)).collect();
    bench.send(&lines[..400]);
    bench.ticks(1_000);
    let answered = bench.answers().len();
    bench.send("!");
    bench.ticks(500);
    let held = bench.status();
    bench.ticks(3_000);
    assert_eq!((bench.status(), held.starts_with("Hold:0|"), bench.answers().len()), (held.clone(), true, 0));
    assert!(answered < 34);
}
