//! Power feed.

use super::command::Stop;
use super::contour::Contour;
use super::*;
use interp_core::config::speed_of;
use interp_core::drive::wheel::Click;
use interp_core::units::{Feedrate, Length};

fn feed(mm_per_min: u64) -> Feed {
    Feed::PerTick(speed_of(Feedrate::from_nm_per_min(mm_per_min * 1_000_000).unwrap()))
}

fn mm(mm: i32) -> Length {
    Length::from_um(mm * 1000).unwrap()
}

fn power() -> Bench {
    let mut bench = Bench::mode(Mode::Power);
    bench.ask(Command::FeedRate(feed(300))).unwrap();
    bench
}

#[test]
fn the_joystick_feeds_to_the_stop_and_no_further_and_returns() {
    let mut bench = power();
    bench.ask(Command::StopAt(Axis::Z, Stop::At(mm(-2)))).unwrap();
    bench.inputs.joystick = Joystick::Axis(Axis::Z, false);
    bench.ticks(200);
    // 300 mm/min are 2 pulses a tick
    let before = bench.at.z;
    bench.ticks(100);
    assert!((before - bench.at.z - 200).abs() <= 2, "{}", before - bench.at.z);
    bench.settle();
    assert_eq!(bench.at, Lattice { x: 0, z: -800 });
    bench.inputs.joystick = Joystick::Off;
    bench.ticks(5);
    bench.ask(Command::Return).unwrap();
    bench.settle();
    assert_eq!(bench.at, Lattice::default());
    bench.keep_limits();
}

#[test]
fn letting_go_brakes_and_the_feed_is_changed_while_it_moves_from_nothing_to_rapid() {
    let mut bench = power();
    bench.ask(Command::FeedOverride(0)).unwrap();
    bench.inputs.joystick = Joystick::Axis(Axis::X, true);
    bench.ticks(300);
    assert_eq!(bench.at, Lattice::default());
    bench.ask(Command::FeedOverride(100)).unwrap();
    bench.ticks(300);
    let slow = bench.at.x;
    assert!(slow > 900, "{slow}");
    bench.ask(Command::FeedRate(feed(600))).unwrap();
    bench.ticks(100);
    let at = bench.at.x;
    bench.ticks(100);
    assert!((bench.at.x - at - 800).abs() <= 3, "{}", bench.at.x - at);
    bench.inputs.rapid = true;
    bench.ticks(300);
    let at = bench.at.x;
    bench.ticks(100);
    // 5000 mm/min
    assert!((bench.at.x - at - 6667).abs() <= 20, "{}", bench.at.x - at);
    bench.inputs.rapid = false;
    bench.ticks(300);
    bench.inputs.joystick = Joystick::Off;
    bench.settle();
    let at = bench.at;
    bench.settle();
    assert_eq!(bench.at, at);
    bench.keep_limits();
}

#[test]
fn feeds_are_repeated_there_and_back_as_often_as_asked_for() {
    let mut bench = power();
    bench.ask(Command::StopAt(Axis::Z, Stop::At(mm(-1)))).unwrap();
    bench.ask(Command::Repeat(3)).unwrap();
    bench.inputs.joystick = Joystick::Axis(Axis::Z, false);
    bench.settle();
    assert_eq!(bench.at, Lattice::default());
    let ends = bench.track.windows(2).filter(|pair| pair[0].z != -400 && pair[1].z == -400).count();
    assert_eq!(ends, 3);
    bench.ticks(500);
    assert_eq!(bench.at, Lattice::default());
    bench.keep_limits();
}

#[test]
fn the_other_slide_is_the_operators_while_power_feeds_one() {
    let mut bench = power();
    bench.ask(Command::Scale(Some(Click::DECADES[1]))).unwrap();
    bench.inputs.joystick = Joystick::Axis(Axis::Z, false);
    bench.ticks(200);
    for _ in 0..40 {
        bench.turn(Axis::X, 1, 1);
        bench.ticks(10);
    }
    bench.turn(Axis::Z, 5, 1);
    bench.inputs.joystick = Joystick::Off;
    bench.settle();
    // ten detents of 10 um
    assert_eq!((bench.at.x, bench.shown().dropped.z), (80, 5));
    assert_eq!(bench.shown().programmed, bench.at);
    bench.keep_limits();
}

#[test]
fn the_joystick_leads_along_a_taper_and_back() {
    let mut bench = power();
    let end = interp_core::units::Point { x: mm(1), z: mm(-3) };
    bench.ask(Command::Contour(Contour::Taper(end))).unwrap();
    bench.inputs.joystick = Joystick::Path(true);
    bench.ticks(500);
    bench.inputs.joystick = Joystick::Off;
    bench.settle();
    let part = bench.at;
    assert!(part.z < -200 && part.z > -1200, "{part:?}");
    // on the line: x / 800 = z / -1200, half a pulse of Z at most off
    assert!((part.x * 1200 + part.z * 800).abs() <= 1200, "{part:?}");
    bench.inputs.joystick = Joystick::Path(true);
    bench.settle();
    assert_eq!(bench.at, Lattice { x: 800, z: -1200 });
    bench.inputs.joystick = Joystick::Path(false);
    bench.inputs.rapid = true;
    bench.settle();
    assert_eq!(bench.at, Lattice::default());
    bench.keep_limits();
}

/// Where the tool is on a taper to (800, -1200): half a pulse of each axis off at most.
fn on_taper(at: Lattice) -> bool {
    (at.x * 1200 + at.z * 800).abs() <= 1000
}

#[test]
fn a_taper_is_fed_along_to_the_shoulder_and_back_as_often_as_asked_for() {
    for law in ["linear", "sine"] {
        let mut bench = Bench::with(&[("accel", law)]);
        bench.ask(Command::Mode(Mode::Power)).unwrap();
        bench.ask(Command::FeedRate(feed(3_000))).unwrap();
        let end = interp_core::units::Point { x: mm(1), z: mm(-3) };
        bench.ask(Command::Contour(Contour::Taper(end))).unwrap();
        bench.ask(Command::StopAt(Axis::Z, Stop::At(mm(-2)))).unwrap();
        bench.ask(Command::Repeat(3)).unwrap();
        bench.inputs.joystick = Joystick::Path(true);
        bench.settle();
        bench.ticks(500);
        assert_eq!(bench.at, Lattice::default(), "{law}");
        assert_eq!(bench.shown().state, State::Holding);
        let ends = bench.track.windows(2).filter(|pair| pair[0].z != -800 && pair[1].z == -800).count();
        assert_eq!(ends, 3, "{law}");
        assert!(bench.track.iter().all(|at| at.z >= -800 && on_taper(*at)));
        // the joystick led back and forth by hand: it ends at the contour's begin, and at the shoulder again
        bench.inputs.joystick = Joystick::Path(false);
        bench.ticks(300);
        assert_eq!(bench.at, Lattice::default());
        bench.inputs.joystick = Joystick::Path(true);
        bench.settle();
        assert_eq!(bench.at, Lattice { x: 533, z: -800 });
        bench.keep_limits();
    }
}

#[test]
fn a_guard_that_is_opened_ends_the_way_back_and_return_goes_on() {
    let mut bench = power();
    let end = interp_core::units::Point { x: mm(10), z: mm(-30) };
    bench.ask(Command::FeedRate(feed(5_000))).unwrap();
    bench.ask(Command::Contour(Contour::Taper(end))).unwrap();
    bench.inputs.joystick = Joystick::Path(true);
    bench.settle();
    bench.inputs.joystick = Joystick::Off;
    bench.ticks(3);
    bench.ask(Command::Return).unwrap();
    bench.ticks(100);
    bench.inputs.guard = true;
    bench.settle();
    let at = bench.at;
    assert!(at.z > -12_000 && at.z < -1_000, "{at:?}");
    bench.inputs.guard = false;
    bench.ticks(300);
    assert_eq!(bench.at, at);
    bench.ask(Command::Return).unwrap();
    bench.settle();
    assert_eq!(bench.at, Lattice::default());
    bench.keep_limits();
}

#[test]
fn a_push_along_the_contour_waits_for_the_hands() {
    let mut bench = power();
    let end = interp_core::units::Point { x: mm(40), z: mm(-2) };
    bench.ask(Command::Contour(Contour::Taper(end))).unwrap();
    bench.ask(Command::Scale(Some(Click::DECADES[2]))).unwrap();
    bench.inputs.joystick = Joystick::Path(true);
    bench.ticks(300);
    bench.inputs.joystick = Joystick::Off;
    bench.ticks(200);
    // held on the contour the wheels have all of the acceleration: a push waits until they have used it
    bench.turn(Axis::X, 20, 20);
    bench.inputs.joystick = Joystick::Path(true);
    let mut waited = 0;
    while bench.shown().state != State::Running {
        bench.tick();
        waited += 1;
        assert!(waited < 1_000);
    }
    let offset = bench.shown().offset.x;
    assert!(waited > 20 && offset > 200, "{waited} {offset}");
    bench.ticks(1_000);
    assert_eq!(bench.shown().offset.x, offset);
    bench.keep_limits();
}

/// Fed along Z to -3 mm, and let go.
fn fed() -> Bench {
    let mut bench = power();
    bench.ask(Command::FeedRate(feed(5_000))).unwrap();
    bench.ask(Command::StopAt(Axis::Z, Stop::At(mm(-3)))).unwrap();
    bench.inputs.joystick = Joystick::Axis(Axis::Z, false);
    bench.settle();
    assert_eq!(bench.at.z, -1200);
    bench.inputs.joystick = Joystick::Off;
    bench.ticks(5);
    bench
}

/// From Z -3 mm: with a shoulder at -1 mm, and on without it.
fn return_over_a_shoulder(bench: &mut Bench) {
    bench.ask(Command::StopAt(Axis::Z, Stop::At(mm(-1)))).unwrap();
    for _ in 0..2 {
        bench.ask(Command::Return).unwrap();
        bench.settle();
        assert_eq!(bench.at.z, -400);
    }
    bench.ask(Command::StopAt(Axis::Z, Stop::Off)).unwrap();
    bench.ask(Command::Return).unwrap();
    bench.settle();
}

#[test]
fn a_way_back_ends_at_a_shoulder_that_was_set_between() {
    let mut bench = fed();
    return_over_a_shoulder(&mut bench);
    assert_eq!(bench.at.z, 0);
}

#[test]
fn a_way_back_along_the_contour_ends_at_a_shoulder_that_was_set_between() {
    let mut bench = power();
    bench.ask(Command::FeedRate(feed(5_000))).unwrap();
    bench.ask(Command::Contour(Contour::Taper(interp_core::units::Point { x: mm(1), z: mm(-3) }))).unwrap();
    bench.inputs.joystick = Joystick::Path(true);
    bench.settle();
    bench.inputs.joystick = Joystick::Off;
    bench.ticks(5);
    return_over_a_shoulder(&mut bench);
    assert_eq!(bench.at, Lattice::default());
}

#[test]
fn what_a_hand_leads_beside_the_contour_does_not_turn_a_shoulder_round() {
    let mut bench = fed();
    bench.ask(Command::Mode(Mode::Linked)).unwrap();
    bench.ask(Command::Scale(Some(Click::DECADES[1]))).unwrap();
    bench.ask(Command::Contour(Contour::Taper(interp_core::units::Point { x: mm(1), z: mm(-3) }))).unwrap();
    // off to plus, but the program came to the shoulder from plus and stands on it
    bench.turn(Axis::Z, 5, 1);
    bench.settle();
    assert!(bench.shown().offset.z > 0);
    bench.inputs.contour = 400;
    bench.settle();
    assert_eq!(bench.shown().programmed, Lattice { x: 0, z: -1200 });
}

#[test]
fn home_takes_a_shoulder_along_and_ends_the_way_back() {
    let mut bench = fed();
    bench.ask(Command::Zero(Axis::Z, mm(7))).unwrap();
    bench.ask(Command::StopAt(Axis::Z, Stop::At(mm(9)))).unwrap();
    bench.inputs.joystick = Joystick::Axis(Axis::Z, true);
    bench.ticks(20);
    bench.inputs.joystick = Joystick::Off;
    bench.settle();
    let pins = bench.at.z;
    bench.ask(Command::Mode(Mode::Homing)).unwrap();
    // at the switch, and off it
    bench.inputs.ends.z.plus = true;
    bench.tick();
    bench.ask(Command::Home(Axis::Z)).unwrap();
    bench.ticks(50);
    bench.inputs.ends.z.plus = false;
    bench.settle();
    assert!(bench.shown().verified.z && bench.at.z < pins && bench.shown().programmed.z > -100);
    bench.ask(Command::Mode(Mode::Power)).unwrap();
    assert_eq!(bench.ask(Command::Return), Err(Refusal::NothingToReturnFrom));
    bench.inputs.joystick = Joystick::Axis(Axis::Z, true);
    bench.settle();
    // 2 mm to plus of where it was 7 mm
    assert_eq!(bench.at.z, -1200 + 800);
}

#[test]
fn machine_lock_leaves_a_shoulder_where_it_was_and_ends_the_way_back() {
    let mut bench = fed();
    bench.ask(Command::StopAt(Axis::Z, Stop::At(mm(-1)))).unwrap();
    bench.ask(Command::MachineLock(true)).unwrap();
    bench.ask(Command::Zero(Axis::Z, mm(50))).unwrap();
    bench.inputs.joystick = Joystick::Axis(Axis::Z, false);
    bench.ticks(50);
    bench.inputs.joystick = Joystick::Off;
    bench.settle();
    assert_eq!(bench.at.z, -1200);
    bench.ask(Command::MachineLock(false)).unwrap();
    assert_eq!(bench.shown().programmed.z, -1200);
    assert_eq!(bench.ask(Command::Return), Err(Refusal::NothingToReturnFrom));
    bench.inputs.joystick = Joystick::Axis(Axis::Z, true);
    bench.settle();
    assert_eq!(bench.at.z, -400);
}
