//! Spindle and encoder against closed forms.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::panic,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    dead_code,
    unreachable_pub,
    missing_docs,
    reason = "tests, and helpers of tests, which may panic"
)]

mod common;

use std::f64::consts::TAU;

use common::figures;
use machine::{Angle, Encoder, Spindle};

fn spindle(set: &[(&str, &str)]) -> Spindle {
    Spindle::new(&figures(set)).unwrap()
}

/// Ticks until the spindle has a speed to a millionth, and the work of its motor on the way, J.
fn until(spindle: &mut Spindle, rpm: f64) -> (u32, f64) {
    let mut work = 0.0;
    for tick in 0..100_000 {
        if (spindle.rpm() - rpm).abs() < 1e-6 * rpm.abs().max(1.0) {
            return (tick, work);
        }
        let (torque, before) = (spindle.motor_torque(), spindle.rpm());
        spindle.tick();
        work += torque * (before + spindle.rpm()) / 2.0 * TAU / 60.0 * 1e-3;
    }
    panic!("the spindle does not get to {rpm}, only {}", spindle.rpm());
}

#[test]
fn a_slow_ramp_is_kept_exactly() {
    // 1000 rpm a second
    let mut spindle = spindle(&[]);
    spindle.command(1200.0);
    let (ticks, _) = until(&mut spindle, 1200.0);
    assert!(ticks.abs_diff(1200) <= 1, "{ticks}");
    // 0.6 s x 1200 rpm = 12 turns, and a tick for the command
    let angle = spindle.angle_after(0.0);
    assert!((angle.turns as f64 + angle.part - 12.0).abs() < 0.02, "{angle:?}");
    spindle.command(-600.0);
    let (ticks, _) = until(&mut spindle, -600.0);
    assert!(ticks.abs_diff(1800) <= 1, "{ticks}");
}

#[test]
fn a_steep_ramp_is_what_torque_and_inertia_make_of_it() {
    let mut spindle = spindle(&[("spindle.ramp_rpm_s", "1e6"), ("spindle.load_nm", "1.7")]);
    spindle.command(1500.0);
    let speed = 1500.0 * TAU / 60.0;
    let (ticks, work) = until(&mut spindle, 1500.0);
    // t = J w / (T - T_drag - T_load) = 0.015 x 157.08 / 5
    assert!((f64::from(ticks) - 0.015 * speed / 5.0 * 1e3).abs() <= 2.0, "{ticks}");
    // the motor's work is J w2 / 2 and what friction and cut took: 2 Nm over the angle
    let angle = spindle.angle_after(0.0);
    let turned = (angle.turns as f64 + angle.part) * TAU;
    assert!((work - (0.015 * speed * speed / 2.0 + 2.0 * turned)).abs() < 1e-6 * work, "{work}");
    // faster than the base speed the power is constant: J w dw = (P - T w) dt has no more than P
    spindle.command(3000.0);
    let before = 0.015 * speed * speed / 2.0;
    let (ticks, work) = until(&mut spindle, 3000.0);
    assert!(work <= 7.0 * speed * f64::from(ticks) * 1e-3 * 1.001 && work >= 3.0 * before, "{work}");
}

#[test]
fn a_stopped_spindle_stands_and_friction_alone_never_turns_it() {
    let mut spindle = spindle(&[("spindle.drag_nm", "5"), ("spindle.load_nm", "1")]);
    for _ in 0..1000 {
        spindle.tick();
    }
    assert_eq!(spindle.angle_after(0.0), Angle::default());
    spindle.command(800.0);
    until(&mut spindle, 800.0);
    // more than the motor has
    spindle.set_load(50.0);
    let mut last = spindle.rpm();
    for _ in 0..1000 {
        spindle.tick();
        assert!(spindle.rpm() <= last && spindle.rpm() >= -1e-9, "{}", spindle.rpm());
        last = spindle.rpm();
    }
    assert!(last.abs() < 1e-6);
    spindle.set_load(0.0);
    // free again, it goes on to where its drive's ramp is, and down with it
    spindle.command(0.0);
    for _ in 0..2000 {
        spindle.tick();
    }
    assert!(spindle.rpm().abs() <= 0.0);
    let angle = spindle.angle_after(0.0);
    for _ in 0..1000 {
        spindle.tick();
    }
    assert_eq!(spindle.angle_after(0.0), angle);
}

#[test]
fn a_command_beyond_the_motor_gets_its_greatest_speed() {
    let mut spindle = spindle(&[]);
    spindle.command(f64::NAN);
    spindle.command(9000.0);
    until(&mut spindle, 3000.0);
}

#[test]
fn an_encoder_has_four_counts_a_line_and_one_index_a_turn_in_both_senses() {
    for (lines, degrees) in [(1024_i64, 0.0), (600, 123.4), (1, 90.0)] {
        let text = (lines.to_string(), degrees.to_string());
        let encoder = Encoder::new(&figures(&[("encoder.lines", &text.0), ("encoder.index_deg", &text.1)])).unwrap();
        let begin = Angle::default();
        for turns in [1.0, -1.0, 7.0, -7.0] {
            assert_eq!(encoder.counts(begin.turned(turns)), (turns as i64) * 4 * lines);
        }
        let mut before = begin.turned(-2.0);
        let (mut edges, mut index) = (0, Vec::new());
        // sixteen samples a count, over four turns
        let samples = 4 * 4 * lines * 16;
        for sample in 1..=samples {
            let angle = begin.turned(-2.0 + (sample as f64 + 0.5) / (4 * lines * 16) as f64);
            let (was, is) = (encoder.channels(before), encoder.channels(angle));
            let changes = u32::from(was.a != is.a) + u32::from(was.b != is.b);
            assert!(changes <= 1, "both channels at once");
            edges += i64::from(changes);
            assert_eq!(changes == 1, encoder.counts(before) != encoder.counts(angle));
            // forward A leads: it rises while B is low
            assert!(was.a || !is.a || !is.b);
            if is.index {
                index.push(encoder.counts(angle));
            }
            before = angle;
        }
        assert_eq!(edges, 4 * 4 * lines);
        index.dedup();
        // at the same place of each turn
        let place = (degrees / 360.0 * (4 * lines) as f64).floor() as i64;
        let expected: Vec<i64> = (-2..=2).map(|turn| turn * 4 * lines + place).collect();
        assert!(index == expected[..4] || index == expected[1..] || index == expected, "{index:?} {expected:?}");
    }
}

#[test]
fn the_encoder_follows_the_spindle_within_a_tick() {
    let mut machine = common::machine(&[]);
    machine.spindle_mut().command(600.0);
    let low = interp_core::train::Levels::LOW;
    common::wait(&mut machine, low, 12_000 * 1000);
    let before = machine.encoder_counts();
    // 10 turns a second: a quarter of a tick is 10.24 counts
    let mut counts = Vec::new();
    for _ in 0..400 {
        common::wait(&mut machine, low, 3_000);
        counts.push(machine.encoder_counts());
    }
    assert_eq!(counts[399] - before, 4096);
    assert!(counts.windows(2).all(|pair| (10..=11).contains(&(pair[1] - pair[0]))), "{counts:?}");
}
