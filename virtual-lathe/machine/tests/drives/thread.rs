//! Threads: pulses against the spindle's true angle.

use crate::bench::{Bench, PULSES, Turning, keep_limits, lathe, point, program, turns};
use interp_core::block::{Pace, Path};
use interp_core::channel::State;
use interp_core::curve::method::Method;
use interp_core::drive::gearing::Lead;
use interp_core::drive::{Inputs, Trouble};
use std::f64::consts::TAU;

/// What a run of a thread showed.
#[derive(Debug, Default)]
pub(crate) struct Seen {
    /// Largest phase error of a locked pulse, Z pulses.
    pub(crate) worst: f64,
    pub(crate) locked_pulses: u32,
    /// Place of the tool at the end of each tick, pulses.
    pub(crate) places: Vec<i32>,
    pub(crate) trouble: Option<Trouble>,
    /// Locked at the end of each tick.
    pub(crate) locked: Vec<bool>,
    pub(crate) ended: bool,
}

pub(crate) struct Cut {
    pub(crate) lead_nm: u64,
    pub(crate) per: u32,
    pub(crate) start: u16,
    pub(crate) length_nm: i64,
}

/// Cuts a thread with a spindle whose speed is `rpm(seconds)`, after a second to run up.
pub(crate) fn cut(cut: &Cut, seconds: f64, rpm: impl Fn(f64) -> f64) -> Seen {
    let machine = lathe(Method::MinimumDeviation);
    let lead = Lead::new(cut.lead_nm, cut.per).unwrap();
    let blocks = program(&machine, &[(Path::Line, point(0, cut.length_nm), Pace::Thread { lead, start: cut.start })]);
    let mut bench = Bench::new(&machine, blocks);
    assert!(bench.channel.set_encoder(Some(4096)));
    let (mut turning, mut seen) = (Turning::new(), Seen::default());
    let lead_pulses = cut.lead_nm as f64 / f64::from(cut.per) / f64::from(PULSES[1]);
    let sign = cut.length_nm.signum() as f64;
    let mut due: Vec<(u32, i32)> = Vec::new();
    let ticks = (seconds * 1e3) as u32;
    for tick in 0..ticks {
        // pulses made in the last tick are played now
        for (clock, travel) in due.drain(..) {
            let angle = turning.spindle.angle_after(f64::from(clock) / 12e6);
            let sense = if rpm(1.0) < 0.0 { -1.0 } else { 1.0 };
            let line = (turns(angle) * sense - f64::from(cut.start) / 65_536.0) * lead_pulses;
            let off = line - f64::from(travel);
            let off = off - (off / lead_pulses).round() * lead_pulses;
            seen.worst = seen.worst.max(off.abs());
            seen.locked_pulses += 1;
        }
        if tick == 1000 {
            bench.channel.start();
        }
        let reading = turning.reading();
        let report = bench.tick(&Inputs { spindle: Some(reading), wheel: 0 });
        if report.driven.locked {
            // a step back leaves a place at the line where it came to it
            due.extend(bench.pulses.iter().map(|pulse| {
                let travel = pulse.at.z * sign as i32;
                let back = pulse.moved[1] * (sign as i32) < 0;
                (pulse.clock, travel + i32::from(back))
            }));
        }
        seen.trouble = seen.trouble.or(report.driven.trouble);
        seen.places.push(bench.at.z);
        seen.locked.push(report.driven.locked);
        seen.ended = matches!(report.state, State::Ended);
        turning.spindle.command(rpm(f64::from(tick) * 1e-3));
        turning.spindle.tick();
    }
    seen
}

fn wobbling(rpm: f64, part: f64, hertz: f64) -> impl Fn(f64) -> f64 {
    move |time| rpm * (1.0 + part * (TAU * hertz * time).sin())
}

#[test]
fn every_locked_pulse_is_within_one_and_a_half_of_the_spindle_angle() {
    let mut told = String::new();
    for (lead_um, speeds) in [
        (250, [30.0, 400.0, 1000.0, 2000.0]),
        (1_000, [30.0, 400.0, 1000.0, 2000.0]),
        (1_500, [30.0, 400.0, 1000.0, 2000.0]),
        (2_000, [30.0, 400.0, 1000.0, 2000.0]),
        (3_000, [30.0, 400.0, 1000.0, 1370.0]),
        (6_000, [30.0, 120.0, 400.0, 690.0]),
    ] {
        for rpm in speeds {
            for hertz in [0.3, 1.0, 2.0] {
                let lead_nm = lead_um * 1_000;
                let length_nm = -((rpm / 60.0 * 1.5 * lead_nm as f64) as i64 + 30_000_000);
                let seen =
                    cut(&Cut { lead_nm, per: 1, start: 0, length_nm }, 3.0 + 200.0 / rpm, wobbling(rpm, 0.2, hertz));
                assert!(seen.locked_pulses > 20, "{lead_um} um, {rpm}/min: {} pulses", seen.locked_pulses);
                assert_eq!(seen.trouble, None, "{lead_um} um, {rpm}/min, {hertz} Hz");
                told += &format!("{lead_um} um {rpm}/min {hertz} Hz: {:.2}\n", seen.worst);
                assert!(seen.worst <= 1.5, "{lead_um} um, {rpm}/min, {hertz} Hz: {} pulses\n{told}", seen.worst);
                keep_limits(&seen.places, 2500.0, 3.0);
            }
        }
    }
    println!("{told}");
}

#[test]
fn smoothness_at_an_even_speed_is_that_of_a_feed_by_time() {
    for (lead_um, rpm) in [(1_500, 97.3), (1_500, 1203.7), (3_000, 31.7), (6_000, 97.3), (6_000, 611.0)] {
        let lead_nm = lead_um * 1_000;
        let length_nm = (rpm / 60.0 * 2.0 * lead_nm as f64) as i64 + 10_000_000;
        let seen = cut(&Cut { lead_nm, per: 1, start: 0, length_nm }, 3.0 + 200.0 / rpm, |_| rpm);
        let settled: Vec<i32> = (300..seen.places.len())
            .filter(|&at| seen.locked[at - 300..at].iter().all(|locked| *locked))
            .map(|at| seen.places[at])
            .collect();
        assert!(settled.len() > 500, "{lead_um} um {rpm}/min: {} ticks", settled.len());
        let bends = settled.windows(3).map(|p| (p[2] - 2 * p[1] + p[0]).abs());
        // an even feed by time has 1: the pulses of a tick are the floor or the ceiling of a number
        let most = bends.max().unwrap();
        println!("{lead_um} um {rpm}/min: second difference of at most {most} pulses");
        assert!(most <= 2, "{lead_um} um {rpm}/min: {most}");
    }
}

#[test]
fn either_sense_of_rotation_cuts_the_same_thread() {
    for rpm in [-300.0, 300.0] {
        let seen = cut(&Cut { lead_nm: 1_500_000, per: 1, start: 0, length_nm: -30_000_000 }, 3.0, |_| rpm);
        // backward the index is met at its other edge: a count, 0.15 pulses
        assert!(seen.worst < 0.6 && seen.locked_pulses > 1000, "{rpm}: {} {}", seen.worst, seen.locked_pulses);
    }
}

#[test]
fn starts_and_inch_threads_keep_their_phase() {
    for (start, nm, per) in [(0, 25_400_000, 11), (16_384, 6_000_000, 1), (43_690, 25_400_000 * 2, 20)] {
        let seen = cut(&Cut { lead_nm: nm, per, start, length_nm: -40_000_000 }, 3.0, |_| 400.0);
        assert!(seen.worst < 0.8 && seen.locked_pulses > 2000, "{start}: {} {}", seen.worst, seen.locked_pulses);
    }
}

#[test]
fn a_spindle_that_stops_runs_back_and_goes_on_is_followed_in_phase() {
    let seen = cut(&Cut { lead_nm: 1_000_000, per: 1, start: 0, length_nm: -60_000_000 }, 7.0, |time| {
        // a drive's ramp
        let part = |at: f64, before: f64, after: f64| before + (after - before) * ((time - at) / 0.2).clamp(0.0, 1.0);
        match time {
            ..2.0 => 400.0,
            ..3.0 => part(2.0, 400.0, 0.0),
            ..3.6 => part(3.0, 0.0, -200.0),
            ..4.5 => part(3.6, -200.0, 0.0),
            _ => part(4.5, 0.0, 300.0),
        }
    });
    assert_eq!(seen.trouble, None);
    assert!(seen.worst <= 1.0, "{}", seen.worst);
    // it ran back: a good millimetre
    let (far, back) = (seen.places[3000], seen.places[4400]);
    assert!(far < 0 && back - far > 500, "{far} {back}");
    assert!(*seen.places.last().unwrap() < far, "it went on");
    assert_eq!(seen.places[3_950], seen.places[4_490], "it stands with the spindle");
    keep_limits(&seen.places, 2500.0, 3.0);
}

#[test]
fn a_spindle_too_fast_or_too_rough_is_told_and_the_limits_hold() {
    let seen = cut(&Cut { lead_nm: 6_000_000, per: 1, start: 0, length_nm: -60_000_000 }, 2.5, |_| 1000.0);
    assert!(matches!(seen.trouble, Some(Trouble::TooFast { .. })), "{:?}", seen.trouble);
    assert_eq!(seen.locked_pulses, 0, "no pulse is said to be in phase");
    keep_limits(&seen.places, 2500.0, 3.0);
    // 60 mm/s that wobble by 40 % at 4 Hz have 603 mm/s2
    let seen =
        cut(&Cut { lead_nm: 3_000_000, per: 1, start: 0, length_nm: -90_000_000 }, 3.0, wobbling(1200.0, 0.38, 4.0));
    assert!(matches!(seen.trouble, Some(Trouble::TooHard { .. })), "{:?}", seen.trouble);
    keep_limits(&seen.places, 2500.0, 3.0);
}

#[test]
fn the_end_of_a_thread_is_exact_and_met_within_the_limits() {
    let seen =
        cut(&Cut { lead_nm: 2_000_000, per: 1, start: 0, length_nm: -20_000_000 }, 4.0, wobbling(900.0, 0.2, 1.3));
    assert!(seen.ended);
    assert_eq!(seen.places.last(), Some(&-8_000));
    assert!(seen.places.windows(2).all(|p| p[1] <= p[0]), "it never goes back");
    keep_limits(&seen.places, 2500.0, 3.0);
}
