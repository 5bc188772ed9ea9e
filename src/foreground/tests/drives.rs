//! Linked feed and retrace: the contour wheel.

use super::contour::Contour;
use super::*;
use interp_core::drive::BackEnd;
use interp_core::drive::wheel::Click;
use interp_core::units::{Length, Point, Sense};

fn um(x: i32, z: i32) -> Point {
    Point { x: Length::from_um(x).unwrap(), z: Length::from_um(z).unwrap() }
}

#[test]
fn the_contour_wheel_leads_along_an_arc_and_back_and_never_off_it() {
    let mut bench = Bench::mode(Mode::Linked);
    bench.ask(Command::Scale(Some(Click::DECADES[2]))).unwrap();
    let arc = Contour::Arc { end: um(2000, -2000), centre: um(2000, 0), sense: Sense::Clockwise };
    bench.ask(Command::Contour(arc)).unwrap();
    bench.turn_contour(3, 300);
    bench.settle();
    assert_eq!(bench.at, Lattice { x: 1600, z: -800 });
    assert!(bench.shown().dropped_contour > 0);
    bench.turn_contour(-2, 300);
    bench.settle();
    assert_eq!(bench.at, Lattice::default());
    for at in &bench.track {
        let (x, z) = (f64::from(at.x) * 1.25 - 2000.0, f64::from(at.z) * 2.5);
        assert!((x.hypot(z) - 2000.0).abs() <= 1.3, "{at:?}");
    }
    bench.keep_limits();
}

#[test]
fn linked_feed_without_a_contour_is_refused_by_name() {
    let mut bench = Bench::mode(Mode::Linked);
    bench.turn_contour(3, 3);
    bench.settle();
    assert_eq!((bench.at, bench.refused()), (Lattice::default(), Some(Refusal::NoContour)));
    assert_eq!(bench.shown().dropped_contour, 9);
}

#[test]
fn a_program_is_run_by_the_wheel_forward_and_back_over_its_joints() {
    let mut bench = Bench::mode(Mode::Linked);
    bench.ask(Command::Scale(Some(Click::DECADES[2]))).unwrap();
    bench.load("G1 X1 Z-1 F100\nG1 Z-3\nG1 X2\nM2");
    bench.ask(Command::Start).unwrap();
    bench.turn_contour(2, 600);
    bench.settle();
    assert_eq!(bench.at, Lattice { x: 1600, z: -1200 });
    bench.turn_contour(-2, 600);
    bench.settle();
    assert_eq!(bench.at, Lattice::default());
    bench.turn_contour(2, 600);
    bench.settle();
    assert_eq!(bench.at, Lattice { x: 1600, z: -1200 });
    bench.keep_limits();
}

#[test]
fn a_held_program_is_retraced_and_goes_on_from_anywhere() {
    let mut bench = Bench::new();
    bench.ask(Command::Scale(Some(Click::DECADES[2]))).unwrap();
    bench.load("G0 X5\nG1 Z-3 F600\nG1 X6\nG1 Z-6\nG0 X8\nM2");
    bench.ask(Command::Start).unwrap();
    bench.ticks(1_000);
    assert_eq!(bench.ask(Command::Mode(Mode::Retrace)), Err(Refusal::Moving));
    bench.ask(Command::Hold).unwrap();
    bench.settle();
    let held = bench.at;
    bench.ask(Command::Mode(Mode::Retrace)).unwrap();
    bench.turn_contour(-1, 300);
    bench.settle();
    assert_ne!(bench.at, held);
    assert_eq!(bench.ask(Command::Start), Err(Refusal::WrongMode(Mode::Automatic)));
    bench.ask(Command::Mode(Mode::Automatic)).unwrap();
    bench.ask(Command::Start).unwrap();
    bench.settle();
    assert_eq!((bench.at, bench.shown().state), (Lattice { x: 6400, z: -2400 }, State::Ended));
    bench.keep_limits();
}

/// Retraced and run on, with an offset: the limit is looked for where the path goes now, not where the wheel led it last.
#[test]
fn behind_a_retrace_a_limit_ahead_is_seen() {
    let mut bench = Bench::with(&[("x.limit_plus_mm", "6")]);
    bench.ask(Command::Scale(Some(Click::DECADES[2]))).unwrap();
    // short blocks: what is before the tool matters, not only the one that it is in
    let mut text = std::string::String::from("G1 Z-1 F3000\n");
    for tenth in 1..60 {
        text += &std::format!("G1 X{}.{}\n", tenth / 10, tenth % 10);
    }
    bench.load(&text);
    bench.ask(Command::Start).unwrap();
    bench.ticks(30);
    bench.ask(Command::Hold).unwrap();
    bench.settle();
    for _ in 0..3 {
        bench.turn(Axis::X, 4, 1);
        bench.ticks(60);
    }
    bench.settle();
    assert_eq!(bench.shown().offset.x, 240);
    bench.ask(Command::Mode(Mode::Retrace)).unwrap();
    bench.turn_contour(-1, 30);
    bench.settle();
    bench.ask(Command::Mode(Mode::Automatic)).unwrap();
    bench.ask(Command::Start).unwrap();
    bench.settle();
    assert_eq!((bench.shown().state, bench.refused()), (State::Holding, Some(Refusal::Limit(Axis::X, true))));
    assert!(bench.track.iter().all(|at| at.x <= 4_800), "{:?}", bench.at);
    bench.keep_limits();
}

/// Behind a dwell the path waits for the wheel to be turned again; what it had asked for before is told as dropped.
#[test]
fn what_the_wheel_asked_for_before_a_dwell_sets_nothing_off_behind_it() {
    let mut bench = Bench::mode(Mode::Linked);
    bench.ask(Command::Scale(Some(Click::DECADES[2]))).unwrap();
    bench.load("G1 X0.5 F100\nG4 P2\nG1 X3\nM2");
    bench.ask(Command::Start).unwrap();
    bench.turn_contour(4, 200);
    bench.settle();
    assert_eq!(bench.at.x, 400);
    bench.ticks(3_000);
    assert_eq!(bench.at.x, 400);
    assert!(bench.shown().dropped_contour > 0);
    bench.turn_contour(4, 200);
    bench.settle();
    assert!(bench.at.x > 400);
}

/// Runs a program by the contour wheel for so many ticks, then back until that is refused: and why it is.
fn led_back(text: &str, ticks: u32) -> (Bench, Option<Refusal>) {
    let mut bench = Bench::mode(Mode::Linked);
    bench.ask(Command::Scale(Some(Click::DECADES[2]))).unwrap();
    bench.rate = COUNTS / 60.0; // 1000 turns a minute
    bench.ticks(800);
    bench.load(text);
    bench.ask(Command::Start).unwrap();
    bench.turn_contour(2, ticks);
    assert_eq!(bench.refused(), None);
    let mut refused = None;
    for _ in 0..20_000 {
        bench.turn_contour(-3, 1);
        refused = bench.refused();
        if refused.is_some() {
            break;
        }
    }
    bench.settle();
    bench.keep_limits();
    (bench, refused)
}

#[test]
fn the_way_back_ends_at_the_start_by_name() {
    let (bench, refused) = led_back("G1 X1 Z-1 F600\nG1 Z-3\nM2", 100);
    assert_eq!(refused, Some(Refusal::WayBackEnds(BackEnd::Start)));
    assert_eq!((bench.at, refused.unwrap().name()), (Lattice::default(), "way-back-start"));
}

#[test]
fn the_way_back_ends_at_an_output_by_name() {
    let (bench, refused) = led_back("G1 X1 F600\nM3 S100\nG1 X4\nM2", 400);
    assert_eq!(refused, Some(Refusal::WayBackEnds(BackEnd::Output)));
    assert_eq!((bench.at, refused.unwrap().name()), (Lattice { x: 800, z: 0 }, "way-back-output"));
}

#[test]
fn the_way_back_ends_behind_a_thread_by_name() {
    let (bench, refused) = led_back("G33 Z-10 K1\nG1 X1 F600\nM2", 2_000);
    assert_eq!(refused, Some(Refusal::WayBackEnds(BackEnd::Thread)));
    assert_eq!((bench.at, refused.unwrap().name()), (Lattice { x: 0, z: -4000 }, "way-back-thread"));
}

#[test]
fn there_is_no_way_back_during_a_dwell_by_name() {
    let (bench, refused) = led_back("G1 X1 F600\nG4 P3\nG1 X2\nM2", 400);
    assert_eq!(refused, Some(Refusal::WayBackEnds(BackEnd::Dwell)));
    assert_eq!((bench.at, refused.unwrap().name()), (Lattice { x: 800, z: 0 }, "way-back-dwell"));
}

#[test]
fn the_way_back_ends_where_no_more_is_kept_by_name() {
    let text: std::string::String =
        (1..=1100).map(|line| std::format!("G1 X{} F600\n", f64::from(line) / 100.0)).collect();
    let (bench, refused) = led_back(&text, 2_000);
    assert_eq!(refused, Some(Refusal::WayBackEnds(BackEnd::Full)));
    // 1024 of 1100 blocks of 8 pulses
    assert_eq!((bench.at, refused.unwrap().name()), (Lattice { x: 76 * 8, z: 0 }, "way-back-full"));
}
