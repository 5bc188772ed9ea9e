//! Threads by hand.

use super::command::PickUpStep;
use super::shown::PickUp;
use super::*;
use interp_core::drive::gearing::Lead;
use interp_core::drive::wheel::Click;

const RPM: f64 = COUNTS / 60_000.0;

fn spinning(rpm: f64) -> Bench {
    let mut bench = Bench::mode(Mode::Power);
    bench.ask(Command::FeedRate(Feed::PerTurn(Lead::new(1_500_000, 1).unwrap()))).unwrap();
    bench.rate = rpm * RPM;
    bench.ticks(800);
    bench
}

/// Where in its lead the groove is that is being cut now: the part of a lead by which the tool is beyond the spindle's angle.
fn groove(bench: &Bench) -> f64 {
    // the tick just made is played while the next but one reading is taken
    let turns = (bench.spindle + 2.0 * bench.rate) / COUNTS;
    (f64::from(bench.at.z) * 2.5e-3 / 1.5 + turns).rem_euclid(1.0)
}

fn apart(a: f64, b: f64) -> f64 {
    let apart = (a - b).rem_euclid(1.0);
    apart.min(1.0 - apart)
}

#[test]
fn the_lever_engages_in_the_same_groove_wherever_it_is() {
    let mut bench = spinning(300.0);
    bench.ask(Command::Scale(Some(Click::DECADES[2]))).unwrap();
    bench.ask(Command::Lever(true)).unwrap();
    bench.ticks(1_500);
    assert!(bench.shown().lever);
    let first = groove(&bench);
    for _ in 0..3 {
        bench.ticks(217);
        // a Z pulse and a half
        assert!(apart(groove(&bench), first) * 600.0 <= 1.5, "{} {first}", groove(&bench));
    }
    bench.ask(Command::Lever(false)).unwrap();
    bench.settle();
    assert!(!bench.shown().lever);
    // pulled out by 2 mm, and the position says so
    assert_eq!((bench.at.x, bench.shown().position), (1600, bench.at));
    for detents in [35, 12, 8] {
        for _ in 0..detents {
            bench.turn(Axis::Z, 4, 1);
            bench.ticks(60);
        }
        bench.settle();
        bench.ask(Command::Lever(true)).unwrap();
        bench.ticks(1_000);
        assert!(apart(groove(&bench), first) * 600.0 <= 1.5, "{} {first}", groove(&bench));
        bench.ask(Command::Lever(false)).unwrap();
        bench.settle();
    }
    // another lead is another thread
    bench.ask(Command::FeedRate(Feed::PerTurn(Lead::new(1_000_000, 1).unwrap()))).unwrap();
    bench.ask(Command::Lever(true)).unwrap();
    bench.ticks(1_000);
    assert!(bench.shown().lever);
}

#[test]
fn a_thread_that_is_there_is_picked_up_where_it_was_captured() {
    let mut bench = spinning(300.0);
    // the index was seen; now the spindle is turned by hand to some angle, and the tool wound to some place
    bench.rate = 0.0;
    bench.spindle = (bench.spindle / COUNTS).floor() * COUNTS + 1_234.0;
    bench.ticks(100);
    assert_eq!(bench.ask(Command::PickUp(PickUpStep::Go)), Err(Refusal::NothingToPickUp));
    assert_eq!(bench.ask(Command::PickUp(PickUpStep::Capture)), Err(Refusal::NothingToPickUp));
    bench.ask(Command::PickUp(PickUpStep::Begin)).unwrap();
    bench.ask(Command::Scale(Some(Click::DECADES[1]))).unwrap();
    for _ in 0..37 {
        bench.turn(Axis::Z, -4, 1);
        bench.ticks(40);
    }
    bench.settle();
    let captured = (f64::from(bench.at.z) * 2.5e-3 / 1.5 + (bench.spindle + 0.5) / COUNTS).rem_euclid(1.0);
    bench.ask(Command::PickUp(PickUpStep::Capture)).unwrap();
    bench.ask(Command::PickUp(PickUpStep::Go)).unwrap();
    assert_eq!(bench.shown().pick_up, PickUp::Active);
    // from elsewhere, at speed
    for _ in 0..90 {
        bench.turn(Axis::Z, 4, 1);
        bench.ticks(40);
    }
    bench.settle();
    bench.rate = 200.0 * RPM;
    bench.ticks(1_000);
    bench.ask(Command::Lever(true)).unwrap();
    bench.ticks(1_500);
    assert!(apart(groove(&bench), captured) * 600.0 <= 1.5, "{} {captured}", groove(&bench));
}

#[test]
fn the_lever_asks_for_a_lead_and_pick_up_for_the_index() {
    let mut bench = Bench::mode(Mode::Power);
    assert_eq!(bench.ask(Command::Lever(true)), Err(Refusal::NoLead));
    bench.ask(Command::PickUp(PickUpStep::Begin)).unwrap();
    bench.ticks(5);
    assert_eq!(bench.ask(Command::PickUp(PickUpStep::Capture)), Err(Refusal::NoIndex));
    let mut bench = Bench::mode(Mode::Handwheel);
    assert_eq!(bench.ask(Command::Lever(true)), Err(Refusal::WrongMode(Mode::Power)));
}

#[test]
fn a_hold_in_a_programs_thread_pulls_out_in_step_and_the_pass_is_repeated() {
    let mut bench = Bench::new();
    bench.rate = 300.0 * RPM;
    bench.load("M3 S300\nG0 X5 Z2\nG33 Z-10 K1.5\nG0 X7\nM2");
    bench.ask(Command::Start).unwrap();
    while bench.at.z > -1_600 {
        bench.tick();
    }
    let first = groove(&bench);
    bench.ask(Command::Hold).unwrap();
    bench.settle();
    assert_eq!(bench.shown().state, State::Holding);
    assert_eq!((bench.at.x, bench.shown().position), (4_000 + 1_600, bench.at));
    bench.ask(Command::Start).unwrap();
    // back to the start of the pass, and through it again
    while bench.at.z < 700 {
        bench.tick();
    }
    while bench.at.z > -1_600 {
        bench.tick();
    }
    assert!(apart(groove(&bench), first) * 600.0 <= 2.0, "{} {first}", groove(&bench));
    bench.settle();
    assert_eq!((bench.at, bench.shown().state), (Lattice { x: 5_600, z: -4_000 }, State::Ended));
}

#[test]
fn a_spindle_that_stops_in_a_thread_is_an_alarm_by_name_and_the_tool_is_out() {
    let mut bench = Bench::new();
    bench.rate = 300.0 * RPM;
    bench.load("M3 S300\nG0 X5 Z2\nG33 Z-30 K1.5\nM2");
    bench.ask(Command::Start).unwrap();
    while bench.at.z > -1_600 {
        bench.tick();
    }
    for _ in 0..400 {
        bench.rate *= 0.985;
        bench.tick();
    }
    bench.rate = 0.0;
    bench.settle();
    bench.ticks(300);
    assert_eq!(bench.shown().alarm, Some(Alarm::SpindleStopped));
    assert_eq!(bench.at.x, 4_000 + 1_600);
}
