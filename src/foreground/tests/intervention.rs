//! Intervention: the handwheels beside a program.

use super::*;
use interp_core::drive::wheel::Click;

const PROGRAM: &str = "G0 X10 Z0\nG1 Z-20 F600\nG2 X15 Z-25 R5\nG1 X20\nG0 X25 Z0\nM2";

fn running(set: &[(&str, &str)]) -> Bench {
    let mut bench = Bench::with(set);
    bench.ask(Command::Scale(Some(Click::DECADES[2]))).unwrap();
    bench.load(PROGRAM);
    bench.ask(Command::Start).unwrap();
    bench
}

/// Turns X by detents, slowly enough that none is dropped.
fn click(bench: &mut Bench, detents: i32) {
    for _ in 0..detents.abs() {
        bench.turn(Axis::X, if detents < 0 { -4 } else { 4 }, 1);
        bench.ticks(60);
    }
}

const END: Lattice = Lattice { x: 20_000, z: 0 };

#[test]
fn a_tool_backed_off_and_wound_in_again_ends_exactly_where_the_program_does() {
    for start in [5, 300, 900, 2_400] {
        let mut bench = running(&[]);
        bench.ticks(start);
        for _ in 0..50 {
            bench.turn(Axis::X, 1, 1);
            bench.ticks(7);
        }
        bench.ticks(100);
        assert_eq!(bench.shown().offset, Lattice { x: 50 * 20, z: 0 });
        for _ in 0..50 {
            bench.turn(Axis::X, -1, 1);
            bench.ticks(7);
        }
        bench.settle();
        assert_eq!((bench.at, bench.shown().offset, bench.shown().state), (END, Lattice::default(), State::Ended));
        bench.keep_limits();
    }
}

#[test]
fn wild_wheels_on_both_axes_keep_the_limits_and_the_offset_is_what_was_added() {
    let mut bench = running(&[]);
    bench.ticks(100);
    let mut seed = 7_u32;
    for _ in 0..4_000 {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        bench.inputs.wheels.x = (seed >> 24) as i16 % 9 - 4;
        bench.inputs.wheels.z = (seed >> 16) as i16 % 7 - 3;
        bench.tick();
    }
    bench.settle();
    let shown = bench.shown();
    assert_eq!(shown.state, State::Ended);
    assert_eq!(shown.programmed, END);
    let sum = Lattice { x: END.x + shown.offset.x, z: END.z + shown.offset.z };
    assert_eq!((bench.at, shown.position), (sum, sum));
    bench.keep_limits();
}

#[test]
fn an_offset_goes_no_further_than_its_bound() {
    let mut bench = running(&[("x.hand_plus_mm", "0.5")]);
    bench.ticks(300);
    bench.turn(Axis::X, 8, 200);
    bench.ticks(200);
    assert_eq!(bench.shown().offset.x, 400);
    assert!(bench.shown().dropped.x > 1000);
    assert_eq!(bench.refused(), Some(Refusal::Bound(Axis::X, true)));
    bench.settle();
    assert_eq!(bench.at, Lattice { x: END.x + 400, z: 0 });
}

#[test]
fn an_offset_is_nulled_at_a_safe_speed_kept_or_booked_as_wear() {
    let mut bench = running(&[]);
    bench.ticks(300);
    click(&mut bench, 10);
    assert_eq!(bench.shown().offset.x, 800);
    bench.ask(Command::NullOffset).unwrap();
    bench.ticks(100);
    let at = bench.shown().offset.x;
    bench.ticks(10);
    // 300 mm/min are 4 pulses of X a tick
    assert!((at - bench.shown().offset.x - 40).abs() <= 1, "{at} {}", bench.shown().offset.x);
    bench.settle();
    assert_eq!((bench.at, bench.shown().offset), (END, Lattice::default()));
    for wear in [false, true] {
        let mut bench = running(&[]);
        bench.ticks(300);
        click(&mut bench, 3);
        bench.ask(if wear { Command::BookWear } else { Command::KeepOffset }).unwrap();
        assert_eq!(bench.shown().offset, Lattice::default());
        assert_eq!(if wear { bench.shown().wear } else { bench.shown().kept }, Lattice { x: 240, z: 0 });
        bench.settle();
        assert_eq!((bench.at, bench.shown().position), (Lattice { x: END.x + 240, z: 0 }, bench.at));
    }
}

#[test]
fn it_works_in_a_hold_and_at_no_feed() {
    for stop in [Command::Hold, Command::FeedOverride(0)] {
        let mut bench = running(&[]);
        bench.ticks(400);
        bench.ask(stop).unwrap();
        bench.settle();
        let at = bench.at;
        click(&mut bench, 10);
        bench.settle();
        assert_eq!(bench.at, Lattice { x: at.x + 800, z: at.z });
        click(&mut bench, -10);
        bench.settle();
        assert_eq!(bench.at, at);
        match stop {
            Command::Hold => bench.ask(Command::Start).unwrap(),
            _ => bench.ask(Command::FeedOverride(100)).unwrap(),
        }
        bench.settle();
        assert_eq!(bench.at, END);
        bench.keep_limits();
    }
}

#[test]
fn a_path_that_would_pass_a_limit_with_its_offset_is_held_before_it() {
    let mut bench = running(&[("x.limit_plus_mm", "25.2")]);
    bench.ticks(300);
    click(&mut bench, 5);
    assert_eq!(bench.shown().offset.x, 400);
    bench.settle();
    assert_eq!(bench.shown().state, State::Holding);
    assert_eq!(bench.refused(), Some(Refusal::Limit(Axis::X, true)));
    assert!(bench.track.iter().all(|at| at.x <= 20_160));
    assert_eq!(bench.shown().offset.x, 400);
    // wound back it goes on
    click(&mut bench, -5);
    bench.settle();
    bench.ask(Command::Start).unwrap();
    bench.settle();
    assert_eq!((bench.at, bench.shown().state), (END, State::Ended));
    bench.keep_limits();
}
