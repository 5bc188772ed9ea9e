//! Every pulse is counted: what is shown is where the pins have led, and what a wheel asked for is moved or told as dropped.

use super::contour::Contour;
use super::*;
use interp_core::drive::wheel::Click;
use interp_core::units::Length;

const PLAY: [(&str, &str); 4] =
    [("x.backlash_um", "60"), ("z.backlash_um", "60"), ("x.max_accel", "100"), ("z.max_accel", "100")];

/// In the mode, with play on both axes, and a detent worth 0.1 mm.
fn with_play(mode: Mode) -> Bench {
    let mut bench = Bench::with(&PLAY);
    bench.ask(Command::Mode(mode)).unwrap();
    bench.ask(Command::Scale(Some(Click::DECADES[2]))).unwrap();
    bench
}

/// The place shown less that of the pins, which are beyond it by what compensates.
fn off(bench: &Bench) -> Lattice {
    let (shown, foreground) = (bench.shown().position, &bench.foreground);
    Lattice {
        x: shown.x - (bench.at.x - foreground.compensation(Axis::X)),
        z: shown.z - (bench.at.z - foreground.compensation(Axis::Z)),
    }
}

const NONE: Lattice = Lattice { x: 0, z: 0 };

/// Other figures that change nothing of the motion.
fn configure(bench: &mut Bench) {
    let machine = bench.parameters.machine().unwrap();
    bench.ask(Command::Configure(machine)).unwrap();
}

fn line(x_um: i32, z_um: i32) -> Contour {
    let length = |um: i32| Length::from_um(um).unwrap();
    Contour::Taper(Point { x: length(x_um), z: length(z_um) })
}

#[test]
fn play_is_taken_up_after_the_wheel_has_come_to_rest() {
    let mut bench = with_play(Mode::Handwheel);
    bench.turn(Axis::Z, -4, 3);
    bench.settle();
    // 60 um at 2.5 um a pulse
    assert_eq!((bench.foreground.compensation(Axis::Z), off(&bench)), (-24, NONE));
}

#[test]
fn a_parameter_set_after_an_emergency_stop_loses_no_play_that_is_to_be_taken_up() {
    for ticks in 1..40 {
        let mut bench = with_play(Mode::Handwheel);
        bench.turn(Axis::Z, -4, 3);
        bench.ticks(ticks);
        bench.open = true;
        bench.ticks(3);
        bench.open = false;
        bench.ticks(3);
        bench.ask(Command::Unlock).unwrap();
        let given = bench.foreground.compensation(Axis::Z);
        configure(&mut bench);
        assert_eq!((bench.foreground.compensation(Axis::Z), off(&bench)), (given, NONE), "{ticks} ticks");
        // what is missing comes with the next move
        bench.turn(Axis::Z, -4, 3);
        bench.settle();
        assert_eq!((bench.foreground.compensation(Axis::Z), off(&bench)), (-24, NONE), "{ticks} ticks");
    }
}

#[test]
fn an_emergency_stop_ends_all_pulses_and_shows_where_the_pins_have_led() {
    for ticks in 0..200 {
        let mut bench = with_play(Mode::Automatic);
        bench.load("G1 X10 Z-5 F900\nX2 Z3");
        bench.ask(Command::Start).unwrap();
        bench.ticks(60 + ticks);
        bench.turn(Axis::Z, if ticks % 2 == 0 { 3 } else { -3 }, 3);
        bench.ticks(3);
        bench.open = true;
        let before = bench.at;
        bench.foreground.watch(Faults::default(), true);
        let Bench { foreground, levels, at, .. } = &mut bench;
        let mut clocks = 0;
        foreground.tick(&mut |event: Event| {
            let now = event.levels();
            for axis in inputs::AXES.into_iter().filter(|axis| now.step(*axis) && !levels.step(*axis)) {
                // only what the tick before had no room for is still made: nothing waits any more
                assert!(clocks < 1_000, "{axis:?} at clock {clocks}, {ticks} ticks");
                *desk::part_mut(at, axis) += if now.plus(axis) { 1 } else { -1 };
            }
            *levels = now;
            clocks += event.interval();
        });
        let stands = bench.at;
        assert!((stands.x - before.x).abs() <= 6 && (stands.z - before.z).abs() <= 6);
        bench.ticks(30);
        assert_eq!((bench.at, off(&bench)), (stands, NONE), "{ticks} ticks");
    }
}

#[test]
fn machine_lock_takes_up_no_play() {
    let mut bench = with_play(Mode::Handwheel);
    bench.ask(Command::MachineLock(true)).unwrap();
    bench.turn(Axis::Z, -4, 5);
    bench.ticks(500);
    assert!(bench.shown().position.z < 0);
    bench.ask(Command::MachineLock(false)).unwrap();
    assert_eq!((bench.at, bench.foreground.compensation(Axis::Z), off(&bench)), (NONE, 0, NONE));
    // the slide is where it was: the first move in minus takes the play up
    bench.turn(Axis::Z, -4, 1);
    bench.settle();
    assert_eq!((bench.foreground.compensation(Axis::Z), off(&bench)), (-24, NONE));
}

#[test]
fn machine_lock_that_is_asked_for_twice_still_ends() {
    let mut bench = with_play(Mode::Handwheel);
    bench.ask(Command::MachineLock(true)).unwrap();
    bench.turn(Axis::Z, -4, 5);
    bench.settle();
    bench.ticks(500);
    bench.ask(Command::MachineLock(true)).unwrap();
    bench.ask(Command::MachineLock(false)).unwrap();
    assert_eq!((bench.at, bench.shown().position), (NONE, NONE));
    // pulses are made again
    bench.turn(Axis::Z, -4, 1);
    bench.settle();
    assert_ne!(bench.at.z, 0);
    assert_eq!(off(&bench), NONE);
}

/// Beside a creeping wheel, whose path stands between two counts: no pulse comes when the motors are off.
#[test]
fn motors_go_off_only_when_the_contour_wheel_has_led_where_it_was_asked_to() {
    let (mut off, mut refused) = (0, 0);
    for ticks in 0..120 {
        let mut bench = with_play(Mode::Linked);
        bench.ask(Command::Scale(Some(Click::DECADES[1]))).unwrap();
        bench.ask(Command::Contour(line(-3_000, 5_000))).unwrap();
        bench.turn_contour(1, 1 + ticks % 4);
        bench.ticks(ticks);
        match bench.ask(Command::Motors(false)) {
            Ok(()) => {
                off += 1;
                let stands = bench.at;
                bench.ticks(100);
                assert_eq!(bench.at, stands, "{ticks} ticks");
            }
            Err(refusal) => {
                refused += 1;
                assert_eq!(refusal, Refusal::Moving);
            }
        }
    }
    assert!(off > 0 && refused > 0, "{off} {refused}");
}

#[test]
fn motors_go_off_only_when_the_play_is_taken_up() {
    let mut bench = with_play(Mode::Handwheel);
    bench.turn(Axis::Z, -4, 3);
    while !bench.foreground.hands_rest() {
        bench.tick();
    }
    assert_ne!(bench.foreground.compensation(Axis::Z), -24);
    assert_eq!(bench.ask(Command::Motors(false)), Err(Refusal::Moving));
    bench.settle();
    assert_eq!(bench.ask(Command::Motors(false)), Ok(()));
}

/// Counts that are stopped on their way are told, whatever stops them: moved and dropped are what was turned, to the count
/// that was begun.
#[test]
fn what_a_stopped_wheel_had_asked_for_is_told_as_dropped() {
    for by_alarm in [false, true] {
        for ticks in 0..60 {
            let mut bench = with_play(Mode::Handwheel);
            bench.turn(Axis::Z, 3, 40);
            bench.ticks(ticks);
            if by_alarm {
                bench.open = true;
            } else {
                bench.ask(Command::Reset).unwrap();
            }
            bench.settle();
            let shown = bench.shown();
            // 10 pulses a count
            let moved = f64::from(shown.position.z) / 10.0;
            let told = f64::from(shown.dropped.z);
            assert!((moved + told - 120.0).abs() <= 1.0, "{ticks} ticks: {moved} counts moved, {told} dropped");
        }
    }
}

#[test]
fn a_turn_that_takes_an_axis_over_drops_only_what_was_turned() {
    let mut bench = with_play(Mode::Automatic);
    bench.turn(Axis::Z, 4, 200);
    bench.settle();
    let before = bench.shown().dropped.z;
    bench.ask(Command::NullOffset).unwrap();
    bench.ticks(50);
    bench.turn(Axis::Z, 1, 1);
    bench.settle();
    let dropped = bench.shown().dropped.z - before;
    assert!(bench.shown().offset.z > 100 && (0..=1).contains(&dropped), "{dropped} counts of one");
}

#[test]
fn what_the_contour_wheel_loses_is_told_once() {
    let mut bench = with_play(Mode::Linked);
    bench.ask(Command::Contour(line(10_000, -20_000))).unwrap();
    bench.turn_contour(4, 200);
    bench.ask(Command::Reset).unwrap();
    bench.settle();
    let dropped = bench.shown().dropped_contour;
    bench.ticks(100);
    assert!(dropped > 0 && dropped < 800, "{dropped}");
    assert_eq!(bench.shown().dropped_contour, dropped);
}

#[test]
fn a_parameter_is_in_force_though_a_path_of_the_machine_s_own_stood_in_the_channel() {
    let mut bench = Bench::mode(Mode::Power);
    bench.ask(Command::Contour(line(8_000, 500))).unwrap();
    bench.inputs.joystick = Joystick::Path(false);
    bench.ticks(3);
    bench.inputs.joystick = Joystick::Off;
    bench.settle();
    bench.parameters.set("z.max_accel", "50").unwrap();
    configure(&mut bench);
    bench.track.clear();
    bench.ask(Command::Scale(Some(Click::DECADES[2]))).unwrap();
    bench.turn(Axis::Z, -4, 400);
    bench.settle();
    bench.keep_limits();
}

#[test]
fn a_path_that_is_left_does_not_stop_a_wheel_at_once() {
    let mut bench = Bench::with(&[("z.max_accel", "100")]);
    bench.ask(Command::Mode(Mode::Power)).unwrap();
    bench.ask(Command::Scale(Some(Click::DECADES[2]))).unwrap();
    bench.ask(Command::Contour(line(8_000, 500))).unwrap();
    bench.inputs.joystick = Joystick::Path(true);
    bench.ticks(2);
    bench.inputs.joystick = Joystick::Off;
    bench.settle();
    bench.turn(Axis::Z, 4, 300);
    bench.inputs.joystick = Joystick::Axis(Axis::X, true);
    bench.turn(Axis::Z, 4, 100);
    bench.inputs.joystick = Joystick::Off;
    bench.settle();
    bench.keep_limits();
}

/// Under an S law, too: the program is run back by the wheel, and from there on to its exact end.
#[test]
fn a_program_goes_on_after_a_retrace_under_an_s_law() {
    for (hold, back) in [(900, 30), (900, 200), (1_500, 400), (2_500, 60)] {
        let mut bench = Bench::with(&[("accel", "parabolic")]);
        bench.ask(Command::Scale(Some(Click::DECADES[2]))).unwrap();
        bench.load("G0 X10 Z0\nG1 Z-20 F600\nG2 X15 Z-25 R5\nG1 X20\nG0 X25 Z0\nM2");
        bench.ask(Command::Start).unwrap();
        bench.ticks(hold);
        bench.ask(Command::Hold).unwrap();
        bench.settle();
        bench.ask(Command::Mode(Mode::Retrace)).unwrap();
        let there = bench.at;
        bench.turn_contour(-4, back);
        bench.settle();
        assert_ne!(bench.at, there);
        bench.ask(Command::Mode(Mode::Automatic)).unwrap();
        bench.ask(Command::Start).unwrap();
        bench.settle();
        assert_eq!((bench.shown().state, bench.at), (State::Ended, Lattice { x: 20_000, z: 0 }), "{hold} {back}");
        bench.keep_limits();
    }
}

#[test]
fn a_start_that_waits_for_the_wheels_is_not_given_twice_and_no_contour_takes_its_place() {
    let mut bench = with_play(Mode::Linked);
    bench.ask(Command::Contour(line(10_000, -20_000))).unwrap();
    bench.turn(Axis::Z, 4, 20);
    bench.load("G1 X10 Z-2 F300");
    bench.ask(Command::Start).unwrap();
    assert_eq!(bench.ask(Command::Start), Err(Refusal::Running));
    bench.turn_contour(4, 300);
    bench.settle();
    // ten pulses of X one of Z, as the program has it; the contour has one
    let at = bench.shown().programmed;
    assert!(at.x > 100 && at.z < 0 && at.x > -5 * at.z, "{at:?}");
}
