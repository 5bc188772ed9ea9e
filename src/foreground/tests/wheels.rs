//! Handwheels.

use super::*;
use interp_core::drive::wheel::Click;

const X10: i32 = 80; // pulses of 1250 nm in ten detents of 10 um

#[test]
fn detents_move_the_slides_by_what_they_are_worth_at_every_scale_and_in_both_senses() {
    for (scale, um) in Click::DECADES.into_iter().zip([1, 10, 100]) {
        for (axis, nm) in [(Axis::X, 1250), (Axis::Z, 2500)] {
            let mut bench = Bench::mode(Mode::Handwheel);
            bench.ask(Command::Scale(Some(scale))).unwrap();
            for sense in [1, 1, -1] {
                // 25 detents, a count every eighth tick: slower than anything is dropped
                for _ in 0..100 {
                    bench.turn(axis, sense, 1);
                    bench.ticks(25);
                }
            }
            bench.settle();
            let pulses = (25 * um * 1000 * 2 / nm + 1) / 2;
            assert_eq!(desk::part(bench.at, axis), pulses, "{axis:?} {um} um");
            assert_eq!(bench.shown().dropped, PerAxis::default());
            assert_eq!((bench.shown().position, bench.shown().offset), (bench.at, Lattice::default()));
        }
    }
}

#[test]
fn a_reading_moves_the_axis_within_two_ticks() {
    let mut bench = Bench::mode(Mode::Handwheel);
    bench.ask(Command::Scale(Some(Click::DECADES[2]))).unwrap();
    bench.ticks(10);
    bench.turn(Axis::Z, 4, 1);
    let first = bench.at;
    bench.tick();
    assert!(first.z != 0 || bench.at.z != 0, "{first:?} {:?}", bench.at);
}

#[test]
fn a_wheel_spun_wild_keeps_the_limits_and_runs_on_no_further_than_braking_and_a_click() {
    let mut bench = Bench::mode(Mode::Handwheel);
    bench.ask(Command::Scale(Some(Click::DECADES[2]))).unwrap();
    bench.turn(Axis::X, 9, 400);
    bench.turn(Axis::Z, -7, 300);
    let at = bench.at;
    let speed = f64::from(bench.at.z - bench.track[bench.track.len() - 11].z).abs() / 10.0 * 2.5;
    bench.settle();
    // um a tick, um a tick squared: 500 mm/s2
    let allowed = speed * speed / 2.0 / 0.5 + 2.0 * speed + 100.0;
    let ran_on = f64::from((bench.at.z - at.z).abs()) * 2.5;
    assert!(ran_on <= allowed, "{ran_on} um of {allowed} um");
    let dropped = bench.shown().dropped;
    assert!(dropped.x > 0 && dropped.z < 0, "{dropped:?}");
    // counts are moved or dropped, never lost: 25 um each
    assert_eq!(i64::from(bench.at.x) * 1250, i64::from(9 * 400 - dropped.x) * 25_000);
    assert_eq!(i64::from(bench.at.z) * 2500, i64::from(-7 * 300 - dropped.z) * 25_000);
    bench.keep_limits();
}

#[test]
fn soft_limits_are_met_exactly_from_any_speed_and_left_freely() {
    let mut bench = Bench::with(&[("x.limit_plus_mm", "3"), ("x.limit_minus_mm", "-1")]);
    bench.ask(Command::Mode(Mode::Handwheel)).unwrap();
    bench.ask(Command::Scale(Some(Click::DECADES[2]))).unwrap();
    bench.turn(Axis::X, 12, 700);
    bench.settle();
    assert_eq!(bench.at.x, 2400);
    assert_eq!(bench.refused(), Some(Refusal::Limit(Axis::X, true)));
    assert!(bench.track.iter().all(|at| at.x <= 2400));
    bench.turn(Axis::X, -4, 1);
    bench.settle();
    assert_eq!(bench.at.x, X10 * 2400 / 80 - 80);
    bench.turn(Axis::X, -20, 700);
    bench.settle();
    assert_eq!(bench.at.x, -800);
    assert_eq!(bench.refused(), Some(Refusal::Limit(Axis::X, false)));
    bench.keep_limits();
}

#[test]
fn wheels_do_nothing_where_they_may_not_and_their_counts_are_shown() {
    let mut bench = Bench::mode(Mode::Homing);
    bench.turn(Axis::X, 3, 5);
    bench.turn_contour(2, 5);
    bench.settle();
    assert_eq!((bench.at, bench.shown().dropped.x, bench.shown().dropped_contour), (Lattice::default(), 15, 10));
    let mut bench = Bench::with(&[("handwheels", "false")]);
    bench.ask(Command::Mode(Mode::Handwheel)).unwrap();
    bench.turn(Axis::X, 3, 5);
    bench.settle();
    assert_eq!((bench.at, bench.refused()), (Lattice::default(), Some(Refusal::WheelsOff)));
}

#[test]
fn a_limit_switch_that_is_run_into_is_an_alarm_and_may_be_left() {
    let mut bench = Bench::mode(Mode::Handwheel);
    bench.ask(Command::Scale(Some(Click::DECADES[2]))).unwrap();
    bench.turn(Axis::Z, 4, 50);
    bench.inputs.ends.z.plus = true;
    bench.turn(Axis::Z, 4, 2);
    bench.settle();
    assert_eq!(bench.shown().alarm, Some(Alarm::LimitSwitchZ));
    let at = bench.at;
    bench.turn(Axis::Z, -4, 20);
    bench.settle();
    assert_eq!(bench.at, at);
    bench.ask(Command::Unlock).unwrap();
    bench.turn(Axis::Z, 4, 5);
    bench.settle();
    assert_eq!((bench.at, bench.shown().alarm), (at, None));
    bench.turn(Axis::Z, -4, 1);
    bench.settle();
    assert_eq!(bench.at.z, at.z - 40);
}
