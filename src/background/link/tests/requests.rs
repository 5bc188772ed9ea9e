//! The operator's requests: what is obeyed, what is refused and under which name, and that programs begin where the tool
//! then is.

use super::super::requests::command;
use super::*;
use crate::foreground::command::{PickUpStep, Stop};
use crate::foreground::contour::Contour;
use crate::foreground::inputs::{Inputs, Joystick, PerAxis};
use crate::foreground::mode::Mode;
use interp_core::block::Feed;
use interp_core::drive::gearing::Lead;
use interp_core::drive::wheel::Click;
use interp_core::units::{Length, Point, Sense};
use std::format;

impl Bench {
    /// Sends a line, and ticks until it is answered.
    fn request(&mut self, line: &str) -> String {
        let mut answer = self.ask(&format!("{line}\n"));
        for _ in 0..10 {
            self.tick();
            answer.push_str(&core::mem::take(&mut self.out));
        }
        answer
    }

    /// With figures of operation, as a board has them, and handwheels.
    fn operated() -> Self {
        let mut bench = Self::new();
        let mut parameters = Parameters::new();
        parameters.set("handwheels", "true").unwrap();
        bench.foreground.obey(Command::Settle(parameters.operation(&parameters.machine().unwrap())));
        bench
    }

    /// In a mode.
    fn in_mode(mode: Mode) -> Self {
        let mut bench = Self::new();
        bench.obeys(&format!("$mode={}", mode.name()));
        assert_eq!(bench.snapshot.mode, mode);
        bench
    }

    fn obeys(&mut self, line: &str) {
        self.out.clear();
        assert_eq!(self.request(line), "ok\r\n", "{line}");
    }

    fn refuses(&mut self, line: &str, number: u8, words: &str) {
        let answer = self.request(line);
        let end = format!("]\r\nerror:{number}\r\n");
        assert!(answer.starts_with("[MSG:") && answer.contains(words) && answer.ends_with(&end), "{line}: {answer}");
        assert_eq!(answer.lines().count(), 2, "{answer}");
    }

    /// Ticks with readings, wheels turned by so many counts in each.
    fn with_inputs(&mut self, inputs: &Inputs, ticks: usize) {
        for _ in 0..ticks {
            self.foreground.read(inputs);
            self.tick();
        }
    }
}

fn um(x: i32, z: i32) -> Point {
    Point { x: Length::from_um(x).unwrap(), z: Length::from_um(z).unwrap() }
}

#[test]
fn each_mode_is_entered_from_each_other_at_rest_and_is_in_the_report() {
    let modes = || Mode::ALL.into_iter().filter(|mode| *mode != Mode::Retrace);
    for (from, to) in modes().flat_map(|from| modes().map(move |to| (from, to))) {
        let mut bench = Bench::in_mode(from);
        bench.refuses("$mode=retrace", 205, "nothing-to-retrace: ");
        assert_eq!(bench.snapshot.mode, from);
        bench.obeys(&format!("$mode={}", to.name()));
        assert_eq!(bench.snapshot.mode, to);
        bench.send("?");
        let field = format!("|Mode:{}|", to.name());
        assert_eq!(bench.out.contains(&field), to != Mode::Automatic, "{}", bench.out);
    }
}

#[test]
fn lines_of_programs_are_refused_outside_automatic_and_manual_data_and_nothing_moves_later() {
    for mode in [Mode::Handwheel, Mode::Power, Mode::Linked, Mode::Homing] {
        let mut bench = Bench::in_mode(mode);
        for line in ["G1 X1 F100", "M3 S100", "(comment)", "%", "F100"] {
            bench.refuses(line, 206, &format!("mode {} runs no program: $mode=auto first", mode.name()));
        }
        bench.obeys("");
        bench.obeys("$mode=auto");
        bench.ticks(500);
        assert_eq!((bench.counted, bench.pulses), (Lattice::default(), 0));
        // no feed has stayed in force either
        bench.refuses("G1 X1", 22, "");
    }
    let mut bench = Bench::in_mode(Mode::ManualData);
    bench.obeys("G1 Z1 F1000");
    bench.until_idle();
    assert_eq!(bench.counted, Lattice { x: 0, z: 400 });
}

#[test]
fn a_program_behind_the_handwheels_goes_to_its_coordinates_from_where_they_have_led_the_tool() {
    let mut bench = Bench::new();
    bench.obeys("G91");
    bench.obeys("$mode=handwheel");
    for (scale, um) in [("1", 1), ("10", 10), ("100", 100)] {
        let before = bench.counted;
        bench.obeys(&format!("$scale={scale}"));
        // 10 detents of 4 counts
        for _ in 0..10 {
            bench.ticks(100);
            bench.with_inputs(&Inputs { wheels: PerAxis { x: 1, z: 0 }, ..Inputs::NONE }, 4);
        }
        bench.refuses("$mode=auto", 8, "moving: ");
        bench.ticks(1_000);
        let by = f64::from(bench.counted.x - before.x) * 1.25;
        assert!((by - f64::from(um * 10)).abs() <= 1.25, "x{scale}: {by} um");
    }
    bench.obeys("$mode=auto");
    bench.obeys("G1 X2 Z1 F1000");
    bench.until_idle();
    // G91 was of the program before
    assert_eq!(bench.counted, Lattice { x: 1_600, z: 400 });
}

#[test]
fn power_feed_goes_to_its_stop_by_the_joystick_and_returns() {
    let mut bench = Bench::in_mode(Mode::Power);
    bench.obeys("$feed-rate=300 mm/min");
    bench.obeys("$stop-at=z -2");
    let push = Inputs { joystick: Joystick::Axis(Axis::Z, false), ..Inputs::NONE };
    bench.with_inputs(&push, 200);
    let before = bench.counted.z;
    bench.with_inputs(&push, 100);
    // 300 mm/min are 2 pulses a tick
    assert!((before - bench.counted.z - 200).abs() <= 2, "{}", before - bench.counted.z);
    bench.refuses("$mode=auto", 8, "moving: ");
    bench.with_inputs(&push, 500);
    assert_eq!(bench.counted, Lattice { x: 0, z: -800 });
    bench.with_inputs(&Inputs::NONE, 5);
    bench.obeys("$return");
    bench.ticks(1_000);
    assert_eq!(bench.counted, Lattice::default());
    bench.obeys("$repeat=2");
    bench.with_inputs(&push, 100);
    bench.with_inputs(&push, 5_000);
    assert_eq!(bench.counted, Lattice::default());
    assert!(bench.pulses >= 6 * 800, "there and back three times: {}", bench.pulses);
}

#[test]
fn the_contour_wheel_leads_along_the_taper_and_automatic_goes_on_from_there() {
    let mut bench = Bench::in_mode(Mode::Linked);
    bench.obeys("$scale=100");
    bench.obeys("$taper=1 -2");
    bench.with_inputs(&Inputs { contour: 3, ..Inputs::NONE }, 300);
    bench.ticks(1_000);
    assert_eq!(bench.counted, Lattice { x: 800, z: -800 });
    bench.obeys("$mode=auto");
    bench.obeys("G1 X0 Z0 F1000");
    bench.until_idle();
    assert_eq!(bench.counted, Lattice::default());
}

#[test]
fn a_touch_off_counts_for_the_next_line() {
    let mut bench = Bench::new();
    bench.obeys("G1 X1 Z1 F1000");
    bench.until_idle();
    bench.obeys("$zero=x 20");
    bench.obeys("$zero=z");
    assert_eq!(bench.status(), "Idle|MPos:20.000,0.000,0.000");
    // what is modal stays in force
    bench.obeys("X21 Z1");
    bench.until_idle();
    assert_eq!(bench.counted, Lattice { x: 1_600, z: 800 });
}

#[test]
fn home_begins_in_its_mode_only_and_finds_the_switch() {
    for mode in Mode::ALL.into_iter().filter(|mode| !matches!(mode, Mode::Homing | Mode::Retrace)) {
        Bench::in_mode(mode).refuses("$home=z", 205, "wrong-mode: that belongs to the mode home");
    }
    let mut bench = Bench::operated();
    bench.obeys("$mode=home");
    bench.refuses("$H", 5, "$mode=home");
    bench.obeys("$home=z");
    bench.ticks(500);
    assert!(bench.counted.z > 0 && bench.counted.x == 0, "{:?}", bench.counted);
    bench.refuses("$mode=auto", 8, "moving: ");
    let mut met = Inputs::NONE;
    met.ends.z.plus = true;
    bench.with_inputs(&met, 2_000);
    bench.foreground.read(&Inputs::NONE);
    bench.ticks(2_000);
    bench.obeys("$mode=auto");
    assert!(bench.snapshot.alarm.is_none() && bench.snapshot.position.z.abs() < 10, "{:?}", bench.snapshot);
}

#[test]
fn an_offset_of_the_handwheels_stays_beside_the_program_until_it_is_nulled_or_booked() {
    for (request, after) in [("$null-offset", 0), ("$keep-offset", 80), ("$book-wear", 80)] {
        let mut bench = Bench::operated();
        bench.obeys("$scale=10");
        bench.with_inputs(&Inputs { wheels: PerAxis { x: 1, z: 0 }, ..Inputs::NONE }, 40);
        bench.ticks(500);
        assert_eq!(bench.counted.x, 80);
        bench.obeys(request);
        bench.ticks(1_000);
        assert_eq!(bench.counted.x, after, "{request}");
        bench.obeys("G1 X1 F1000");
        bench.until_idle();
        assert_eq!(bench.counted.x, 800 + after, "{request}");
    }
}

#[test]
fn retrace_and_back_is_for_a_program_that_stands() {
    let mut bench = Bench::under_way();
    bench.refuses("$mode=retrace", 8, "moving: ");
    bench.send("!");
    bench.ticks(500);
    let held = bench.counted;
    bench.refuses("$mode=handwheel", 8, "cycle-under-way: ");
    bench.obeys("$mode=retrace");
    bench.obeys("$scale=100");
    bench.with_inputs(&Inputs { contour: -3, ..Inputs::NONE }, 100);
    bench.ticks(500);
    assert!(bench.counted.z < held.z - 100, "{:?} {held:?}", bench.counted);
    bench.obeys("$mode=auto");
    bench.send("~");
    bench.until_idle();
    assert_eq!(bench.counted, Lattice::default());
}

#[test]
fn what_would_shift_waiting_blocks_is_refused_while_they_wait() {
    let mut bench = Bench::new();
    bench.send("!");
    bench.ticks(3);
    bench.obeys("G1 Z1 F1000");
    for line in [
        "$mode=handwheel",
        "$zero=x",
        "$home=x",
        "$taper=1 1",
        "$pick-up=begin",
        "$dry-run=on",
        "$lock=on",
        "$mode=auto",
    ] {
        bench.refuses(line, 8, "blocks of a program wait");
    }
    bench.obeys("$single=off");
    bench.send("~");
    bench.until_idle();
    assert_eq!(bench.counted, Lattice { x: 0, z: 400 });
}

#[test]
fn while_a_program_runs_only_what_says_how_is_obeyed() {
    let mut bench = Bench::under_way();
    for line in
        ["$zero=x", "$lock=on", "$dry-run=on", "$taper=1 1", "$pick-up=begin", "$motors=off", "$confirm-position"]
    {
        bench.refuses(line, 8, "moving: ");
    }
    for line in ["$home=x", "$return", "$repeat=1"] {
        bench.refuses(line, 205, "wrong-mode: ");
    }
    for line in ["$scale=speed", "$feed-rate=0.1 mm/rev", "$stop-at=x here", "$rapid-override=50", "$mode=auto"] {
        bench.obeys(line);
    }
    bench.until_idle();
    assert_eq!(bench.counted, Lattice::default());
}

#[test]
fn single_block_dry_run_and_lock_are_switched() {
    let mut bench = Bench::new();
    bench.obeys("$single=on");
    bench.send("G1 Z1 F1000\nZ2\nM30\n");
    bench.ticks(1_000);
    assert_eq!(bench.counted.z, 400);
    bench.send("~");
    bench.ticks(1_000);
    assert_eq!(bench.counted.z, 800);
    bench.send("~");
    bench.until_idle();
    bench.obeys("$single=off");
    bench.obeys("$lock=on");
    bench.obeys("G1 Z3 F1000");
    bench.until_idle();
    bench.out.clear();
    assert_eq!(bench.counted.z, 800);
    assert_eq!(bench.status(), "Idle|MPos:0.000,0.000,3.000");
    bench.obeys("$lock=off");
    assert_eq!(bench.status(), "Idle|MPos:0.000,0.000,2.000");
    bench.obeys("G1 Z1");
    bench.until_idle();
    assert_eq!(bench.counted.z, 400);
}

#[test]
fn motors_that_were_off_need_a_confirmed_position_and_a_start() {
    let mut bench = Bench::new();
    bench.obeys("$motors=off");
    bench.obeys("G1 Z1 F1000");
    bench.ticks(500);
    bench.obeys("$motors=on");
    bench.obeys("$confirm-position");
    bench.ticks(500);
    assert_eq!(bench.pulses, 0, "begins by itself");
    bench.send("~");
    bench.until_idle();
    assert_eq!(bench.counted.z, 400);
}

#[test]
fn an_answer_is_that_of_its_request_and_not_of_a_byte_behind_it() {
    let mut bench = Bench::new();
    // a hold of nothing is refused by the foreground
    bench.send("$mode=power\n!");
    bench.ticks(10);
    assert_eq!(bench.answers(), ["ok"]);
    bench.send("~$mode=retrace\n!");
    bench.ticks(10);
    assert_eq!(bench.answers(), ["error:205"]);
    bench.send("$return\n\x18$scale=1\n");
    bench.ticks(10);
    // the reset has made its answer pointless
    assert_eq!(bench.answers(), ["ok"]);
}

#[test]
fn an_alarm_is_named_and_modes_may_be_changed_to_leave_it() {
    let mut bench = Bench::new();
    bench.open = true;
    bench.ticks(3);
    bench.out.clear();
    for line in ["$zero=x", "$null-offset"] {
        bench.refuses(line, 9, "alar_: the machine is locked (emergency stop");
    }
    bench.obeys("$mode=handwheel");
    bench.refuses("G1 X1 F100", 9, "locked");
}

#[test]
fn words_become_requests() {
    let mm = |mm: i32| Length::from_um(mm * 1_000).unwrap();
    for (name, value, wanted) in [
        ("mode", "Retrace", Command::Mode(Mode::Retrace)),
        ("MODE", " home ", Command::Mode(Mode::Homing)),
        ("scale", "1", Command::Scale(Some(Click::DECADES[0]))),
        ("scale", "speed", Command::Scale(None)),
        ("feed-rate", "60 mm/min", Command::FeedRate(Feed::PerTick(4_096_000))),
        ("feed-rate", "1.5,mm/rev", Command::FeedRate(Feed::PerTurn(Lead::new(1_500_000, 1).unwrap()))),
        ("taper", "-1.5 2", Command::Contour(Contour::Taper(um(-1_500, 2_000)))),
        ("home", "X", Command::Home(Axis::X)),
        ("zero", "x", Command::Zero(Axis::X, Length::ZERO)),
        ("zero", "z -3", Command::Zero(Axis::Z, mm(-3))),
        ("stop-at", "x 3", Command::StopAt(Axis::X, Stop::At(mm(3)))),
        ("stop-at", "z here", Command::StopAt(Axis::Z, Stop::Here)),
        ("stop-at", "z off", Command::StopAt(Axis::Z, Stop::Off)),
        ("return", "", Command::Return),
        ("repeat", "10000", Command::Repeat(10_000)),
        ("pick-up", "begin", Command::PickUp(PickUpStep::Begin)),
        ("pick-up", "capture", Command::PickUp(PickUpStep::Capture)),
        ("pick-up", "go", Command::PickUp(PickUpStep::Go)),
        ("keep-offset", "", Command::KeepOffset),
        ("null-offset", "", Command::NullOffset),
        ("book-wear", "", Command::BookWear),
        ("single", "on", Command::SingleBlock(true)),
        ("dry-run", "off", Command::DryRun(false)),
        ("lock", "on", Command::MachineLock(true)),
        ("rapid-override", "100", Command::RapidOverride(100)),
        ("motors", "off", Command::Motors(false)),
        ("confirm-position", "", Command::ConfirmPosition),
    ] {
        assert_eq!(command(name, value), Some(Ok(wanted)), "{name}={value}");
    }
    let arc = |sense| Command::Contour(Contour::Arc { end: um(1_000, 2_000), centre: um(3_000, 4_000), sense });
    assert_eq!(command("arc", "1 2 3 4 cw"), Some(Ok(arc(Sense::Clockwise))));
    assert_eq!(command("arc", "1,2, 3,4 CCW"), Some(Ok(arc(Sense::CounterClockwise))));
    assert_eq!(command("format", "gcode"), None);
}

#[test]
fn bad_input_is_told_by_name_place_and_remedy_and_changes_nothing() {
    let mut bench = Bench::new();
    for (line, number, words) in [
        ("$mode", 2, "$mode takes handwheel, power, linked, auto, mdi, home or retrace: a word is missing"),
        ("$mode=", 2, "a word is missing"),
        ("$mode=jog", 3, "word 1 of the value is another"),
        ("$mode=power feed", 3, "there is a word too many"),
        ("$modes=power", 3, "there is no parameter of this name"),
        ("$go", 3, "there is no such command"),
        ("$scale=1000", 3, "$scale takes 1, 10, 100 or speed"),
        ("$feed-rate=100", 2, "a word is missing"),
        ("$feed-rate=fast mm/min", 2, "word 1 of the value is no such number"),
        ("$feed-rate=0 mm/min", 52, "word 1 of the value is out of range"),
        ("$feed-rate=-1 mm/rev", 52, "word 1"),
        ("$feed-rate=30001 mm/min", 52, "word 1"),
        ("$feed-rate=1001 mm/rev", 52, "word 1"),
        ("$feed-rate=1 inch", 3, "word 2 of the value is another"),
        ("$taper=1", 2, "$taper takes DX DZ in mm: a word is missing"),
        ("$taper=1 2 3", 3, "too many"),
        ("$taper=1 99999", 52, "word 2 of the value is out of range"),
        ("$taper=1 1e3", 2, "word 2 of the value is no such number"),
        ("$arc=1 2 3 4", 2, "a word is missing"),
        ("$arc=1 2 3 4 left", 3, "word 5 of the value is another"),
        ("$home=y", 3, "$home takes x or z"),
        ("$zero=5", 3, "word 1"),
        ("$zero=x 1 2", 3, "too many"),
        ("$stop-at=x there", 2, "word 2"),
        ("$return=x", 3, "$return takes no value: there is a word too many"),
        ("$repeat=10001", 52, "word 1"),
        ("$repeat=1.5", 52, "word 1"),
        ("$rapid-override=101", 52, "word 1"),
        ("$rapid-override=999999999999999999999", 2, "word 1"),
        ("$single=1", 3, "$single takes on or off"),
        ("$pick-up=stop", 3, "word 1"),
    ] {
        bench.refuses(line, number, words);
    }
    let mut fresh = Bench::new();
    assert_eq!(bench.foreground.shown(), fresh.foreground.shown());
    let list = fresh.request("$");
    for name in ["$mode=", "$zero=", " $return ", "$confirm-position]"] {
        assert!(list.contains(name), "{list}");
    }
}
