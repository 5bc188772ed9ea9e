//! Motors: where they stall, and where they do not.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    dead_code,
    unreachable_pub,
    missing_docs,
    reason = "tests, and helpers of tests, which may panic"
)]

mod common;

use std::f64::consts::{PI, TAU};

use common::{machine, play, ramp, wait};
use interp_core::train::{Event, Levels};
use interp_core::units::Axis;
use machine::Axes;

/// A motor with 1 Nm at every speed.
const EVEN: &[(&str, &str)] = &[("motor.x.pull_out", "0:1;10000:1")];

/// Acceleration in mm/s2 at which `J a + T_friction` is 1 Nm on the default cross slide; by hand.
fn limit() -> f64 {
    let per_radian = 5e-3 / TAU;
    let inertia = 440e-7 + 7850.0 * PI / 32.0 * 0.016_f64.powi(4) * 0.3;
    // (J + m k2 / eta) a / k + drag + (friction + force) k / eta = 1
    let left = 1.0 - 0.05 - 130.0 * per_radian / 0.9;
    left / ((inertia + 8.0 * per_radian * per_radian / 0.9) / per_radian) * 1e3
}

#[test]
fn an_acceleration_just_below_pull_out_is_followed_and_one_just_above_is_not() {
    let limit = limit();
    assert!((5_000.0..20_000.0).contains(&limit), "{limit}");
    for plus in [true, false] {
        for (part, stalls) in [(0.97, false), (1.03, true)] {
            let mut machine = machine(EVEN);
            // braking asks for less, as friction helps
            play(&mut machine, Axis::X, plus, ramp(4.0, 1250.0, limit * part, 60.0, limit * 0.5).into_iter());
            assert_eq!(machine.axis(Axis::X).peak() > 1.0, stalls, "{part}");
            if stalls {
                assert!(machine.lost_pulses().x > 0);
            } else {
                assert_eq!(machine.lost_pulses().x, 0);
                assert!((machine.axis(Axis::X).peak() - part).abs() < 0.03, "{}", machine.axis(Axis::X).peak());
                assert!((machine.axis(Axis::X).at().abs() - 4e6).abs() < 1e-3);
            }
            assert_eq!(machine.lost_pulses().z, 0);
        }
    }
}

#[test]
fn braking_asks_for_less_than_speeding_up() {
    let limit = limit();
    let mut machine = machine(EVEN);
    play(&mut machine, Axis::X, true, ramp(4.0, 1250.0, limit * 0.5, 60.0, limit * 1.1).into_iter());
    assert_eq!(machine.lost_pulses(), Axes { x: 0, z: 0 });
}

#[test]
fn a_stalled_motor_loses_whole_periods_of_four_full_steps_and_goes_on() {
    let mut machine = machine(&[("motor.x.pull_out", "0:1;700:1;720:0.1")]);
    // 60 mm/s is 720 turns a minute: too fast to follow
    play(&mut machine, Axis::X, true, ramp(30.0, 1250.0, 500.0, 60.0, 500.0).into_iter());
    let lost = machine.lost_pulses().x;
    // 4 full steps are 80 pulses of 1.25 um
    assert!(lost >= 80 && lost.is_multiple_of(80), "{lost}");
    assert!((machine.axis(Axis::X).at() - (24_000.0 - lost as f64) * 1250.0).abs() < 1e-3);
    let first = machine.first_loss();
    let loss = first.x.unwrap();
    // 60 mm/s are reached after 0.12 s, and the move began after 1 ms
    assert!((0.110..0.125).contains(&(loss.clocks as f64 / 12e6)), "{}", loss.clocks as f64 / 12e6);
    assert!(loss.load.stalled && loss.load.asked > loss.load.available);
    assert_eq!(first.z, None);
    // the next slow move is true again
    let before = machine.axis(Axis::X).at();
    play(&mut machine, Axis::X, true, ramp(1.0, 1250.0, 500.0, 5.0, 500.0).into_iter());
    assert!((machine.axis(Axis::X).at() - before - 1e6).abs() < 1e-3);
    assert_eq!(machine.lost_pulses().x, lost);
    // a second stall the same way, and one the other way: the losses add up, the place tells the difference
    play(&mut machine, Axis::X, true, ramp(30.0, 1250.0, 500.0, 60.0, 500.0).into_iter());
    let second = machine.lost_pulses().x - lost;
    assert!(second >= 80);
    let expected = 24_000.0 + 800.0 + 24_000.0 - (lost + second) as f64;
    assert!((machine.axis(Axis::X).at() - expected * 1250.0).abs() < 1e-3);
    play(&mut machine, Axis::X, false, ramp(30.0, 1250.0, 500.0, 60.0, 500.0).into_iter());
    let third = machine.lost_pulses().x - lost - second;
    assert!(third >= 80 && third.is_multiple_of(80));
    assert!((machine.axis(Axis::X).at() - (expected - 24_000.0 + third as f64) * 1250.0).abs() < 1e-3);
}

#[test]
fn a_stalled_rotor_is_caught_when_the_field_is_below_pull_in_and_not_before() {
    let mut machine = machine(&[("motor.x.pull_out", "0:1;700:1;720:0.1")]);
    let axis = machine.axis(Axis::X);
    let pull_in = axis.motor().pull_in(axis.screw().total_inertia(), axis.screw().steady_torque());
    let mm_s = pull_in * 5.0 / TAU;
    assert!((2.0..60.0).contains(&mm_s), "{mm_s}");
    let mut stalled_at = Vec::new();
    let times = ramp(30.0, 1250.0, 500.0, 60.0, 500.0);
    let mut now = 0;
    let low = Levels::LOW.with_plus(Axis::X, true);
    wait(&mut machine, low, 1200);
    for time in times {
        let at = (time * 12e6).round() as u64;
        wait(&mut machine, low, at.saturating_sub(now));
        machine.play(Event::new(low.with_step(Axis::X, true), 60));
        now = now.max(at) + 60;
        let load = machine.axis(Axis::X).load();
        if load.stalled {
            stalled_at.push(load.speed);
        }
    }
    let last = *stalled_at.last().unwrap();
    // a tick's worth of braking below it at most
    assert!(last > pull_in && last < pull_in + 2.0 * 0.5 * TAU / 5.0, "{last} {pull_in}");
}

#[test]
fn a_jump_that_no_motor_makes_stalls_and_one_that_every_motor_makes_does_not() {
    for (mm_s, stalls) in [(2.0, false), (60.0, true)] {
        let mut machine = machine(&[]);
        play(&mut machine, Axis::X, true, (0..4000).map(|n| f64::from(n) * 1.25e-3 / mm_s));
        assert_eq!(machine.lost_pulses().x > 0, stalls, "{mm_s}");
    }
}

#[test]
fn a_cutting_force_that_the_motor_cannot_overcome_stalls_it() {
    // 60 mm/s: 720 turns a minute
    for (newtons, stalls) in [(400.0, false), (1500.0, true)] {
        let mut machine = machine(&[]);
        machine.axis_mut(Axis::X).set_force(newtons);
        play(&mut machine, Axis::X, true, ramp(30.0, 1250.0, 500.0, 60.0, 500.0).into_iter());
        assert_eq!(machine.lost_pulses().x > 0, stalls, "{newtons}");
    }
}

#[test]
fn pins_that_are_too_fast_for_the_driver_lose_what_its_table_says() {
    let mut machine = machine(&[("driver.z.pulse_width_ns", "6000")]);
    // 60 clocks are 5 us
    play(&mut machine, Axis::Z, true, (0..10).map(|n| f64::from(n) * 1e-3));
    assert_eq!(machine.lost_pulses(), Axes { x: 0, z: 10 });
    assert!(machine.axis(Axis::Z).at().abs() < 1e-9);
    assert!(!machine.first_loss().z.unwrap().load.stalled);
}

#[test]
fn coarse_microsteps_do_not_stall_a_slow_motor() {
    // a pulse is a full step of 25 um
    let control = machine::Control { pulse_nm: Axes { x: 25_000.0, z: 25_000.0 }, ..common::CONTROL };
    for rate in [3.0, 30.0, 80.0] {
        let mut machine = machine::Machine::new(&common::figures(&[]), control).unwrap();
        play(&mut machine, Axis::Z, true, (0..100).map(|n| f64::from(n) / rate));
        assert_eq!(machine.lost_pulses().z, 0, "{rate}");
    }
}
