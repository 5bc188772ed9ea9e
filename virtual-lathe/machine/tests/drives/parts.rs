//! Threads of several parts, tapers, starts, and a spindle that comes and goes between passes.

use crate::bench::{Bench, PULSES, Turning, keep_limits, point, program, turns};
use crate::hold::guarded;
use interp_core::block::{Pace, Path};
use interp_core::channel::State;
use interp_core::drive::Inputs;
use interp_core::drive::gearing::Lead;
use interp_core::units::Point;
use std::f64::consts::TAU;

/// A Z pulse: when it was played, the spindle's angle then, and where it led.
struct Made {
    seconds: f64,
    turns: f64,
    z: i32,
    locked: bool,
}

struct Seen {
    made: Vec<Made>,
    places: Vec<[i32; 2]>,
    ended: bool,
}

/// Runs motions with a spindle of `rpm(seconds)`; the cycle starts after half a second.
fn run(motions: &[(Path, Point, Pace)], seconds: u32, percent: u16, rpm: impl Fn(f64) -> f64) -> Seen {
    let machine = guarded(2_000);
    let mut bench = Bench::new(&machine, program(&machine, motions));
    let mut turning = Turning::new();
    let mut seen = Seen { made: Vec::new(), places: Vec::new(), ended: false };
    let mut due: Vec<(u32, i32, bool)> = Vec::new();
    bench.channel.set_feed_override(percent);
    for tick in 0..seconds * 1_000 {
        for (clock, z, locked) in due.drain(..) {
            let into = f64::from(clock) / 12e6;
            let turns = turns(turning.spindle.angle_after(into));
            seen.made.push(Made { seconds: f64::from(tick) / 1e3 + into, turns, z, locked });
        }
        if tick == 500 {
            bench.channel.start();
        }
        let reading = turning.reading();
        let report = bench.tick(&Inputs { spindle: Some(reading), wheel: 0 });
        assert_eq!(bench.channel.fault(), None, "tick {tick}");
        let z = bench.pulses.iter().filter(|pulse| pulse.moved[1] != 0);
        due.extend(z.map(|pulse| (pulse.clock, pulse.at.z, report.driven.locked)));
        seen.places.push([bench.at.x, bench.at.z]);
        seen.ended |= report.state == State::Ended;
        turning.spindle.command(rpm(f64::from(tick) * 1e-3));
        turning.spindle.tick();
    }
    assert!(seen.ended);
    // a rapid begins with a jump, which other tests look at
    for axis in (0..2).filter(|_| motions.iter().all(|(.., pace)| !matches!(pace, Pace::Rapid))) {
        let places: Vec<i32> = seen.places.iter().map(|place| place[axis]).collect();
        keep_limits(&places, f64::from(PULSES[axis]), 5.0);
    }
    seen
}

fn thread(lead_nm: u64, start: u16) -> Pace {
    Pace::Thread { lead: Lead::new(lead_nm, 1).unwrap(), start }
}

fn wobbling(rpm: f64) -> impl Fn(f64) -> f64 {
    move |time| rpm * (1.0 + 0.2 * (TAU * 1.7 * time).sin())
}

/// How far locked pulses are off the groove `place(turns)` in pulses, whatever groove it is.
fn worst<'m>(made: impl Iterator<Item = &'m Made>, lead_nm: u64, start: f64) -> f64 {
    let lead = lead_nm as f64 / f64::from(PULSES[1]);
    let off = |made: &Made| {
        let off = (made.turns - start) * lead - f64::from(-made.z);
        (off - (off / lead).round() * lead).abs()
    };
    let (worst, count) = made.fold((0.0_f64, 0), |(worst, count), made| (worst.max(off(made)), count + 1));
    assert!(count > 3_000, "{count} pulses");
    worst
}

#[test]
fn parts_of_one_thread_are_one_groove() {
    // a cylinder, a taper of 1 in 16, a cylinder: the lead is along Z in all of them
    let motions = [
        (Path::Line, point(0, -12_000_000), thread(2_000_000, 0)),
        (Path::Line, point(500_000, -20_000_000), thread(2_000_000, 0)),
        (Path::Line, point(500_000, -32_000_000), thread(2_000_000, 0)),
    ];
    for rpm in [200.0, 600.0] {
        let seen = run(&motions, 15, 100, wobbling(rpm));
        // all of it but falling in and braking
        let inside = seen.made.iter().filter(|made| made.z < -300 && made.z > -12_500);
        let worst = worst(inside, 2_000_000, 0.0);
        assert!(worst <= 1.5, "{rpm}: {worst}");
    }
}

#[test]
fn a_lead_that_changes_is_the_next_part_s() {
    // 1 mm a turn, then 1.03: at 600/min a jump of 0.3 mm/s
    let (first, second) = (1_000_000, 1_030_000);
    let motions =
        [(Path::Line, point(0, -10_000_000), thread(first, 0)), (Path::Line, point(0, -30_000_000), thread(second, 0))];
    let seen = run(&motions, 8, 100, |_| 600.0);
    let at = seen.made.iter().find(|made| made.z == -4_000).unwrap().turns;
    let mut count = 0;
    for made in seen.made.iter().filter(|made| made.z < -4_000 && made.z > -11_800) {
        let place = 4_000.0 + (made.turns - at) * second as f64 / f64::from(PULSES[1]);
        assert!((place + f64::from(made.z)).abs() <= 1.5, "{place} {}", made.z);
        count += 1;
    }
    assert_eq!(count, 7_799);
}

#[test]
fn a_lead_that_jumps_keeps_the_limits() {
    let motions = [
        (Path::Line, point(0, -10_000_000), thread(1_000_000, 0)),
        (Path::Line, point(0, -40_000_000), thread(3_000_000, 0)),
    ];
    // `run` checks them
    let seen = run(&motions, 8, 100, |_| 600.0);
    let late = seen.made.iter().filter(|made| made.z < -8_000 && made.locked);
    assert!(late.count() > 3_000, "and the second lead is fallen in with");
    assert_eq!(seen.places.last(), Some(&[0, -16_000]));
}

#[test]
fn a_taper_leads_along_z_and_x_goes_with_it() {
    for (x, rpm) in [(1_000_000, 600.0), (10_000_000, 300.0), (-30_000_000, 120.0)] {
        let seen = run(&[(Path::Line, point(x, -32_000_000), thread(2_000_000, 0))], 12, 100, wobbling(rpm));
        let worst = worst(seen.made.iter().filter(|made| made.locked), 2_000_000, 0.0);
        assert!(worst <= 1.5, "{x}: {worst}");
        // radius in proportion, to the pulse
        for [px, pz] in &seen.places {
            let want = f64::from(*pz) / -12_800.0 * x as f64 / 1_250.0;
            assert!((f64::from(*px) - want).abs() <= 1.5 + x.abs() as f64 / 16e6, "{px} {pz}");
        }
    }
}

#[test]
fn starts_lie_a_part_of_a_turn_apart() {
    for (start, part) in [(0, 0.0), (21_845, 1.0 / 3.0), (43_691, 2.0 / 3.0)] {
        let motions = [
            (Path::Line, point(0, -32_000_000), thread(3_000_000, start)),
            (Path::Line, point(0, 0), Pace::Rapid),
            (Path::Line, point(0, -32_000_000), thread(3_000_000, start)),
        ];
        let seen = run(&motions, 14, 100, wobbling(400.0));
        let worst = worst(seen.made.iter().filter(|made| made.locked), 3_000_000, part);
        assert!(worst <= 1.5, "{start}: {worst}");
    }
}

#[test]
fn a_spindle_stopped_between_passes_finds_the_groove_at_any_speed() {
    let motions = [
        (Path::Line, point(0, -30_000_000), thread(2_000_000, 0)),
        (Path::Line, point(0, 0), Pace::Rapid),
        (Path::Line, point(0, -30_000_000), thread(2_000_000, 0)),
    ];
    // the first pass is over after 2.5 s; then it stands, goes back a little, and turns at another speed
    let seen = run(&motions, 12, 100, |time| match time {
        ..2.6 => 600.0,
        ..3.2 => 0.0,
        ..3.4 => -50.0,
        ..4.0 => 0.0,
        _ => 311.0,
    });
    let second = seen.made.iter().filter(|made| made.seconds > 4.0 && made.locked);
    let worst = worst(second, 2_000_000, 0.0);
    assert!(worst <= 1.5, "{worst}");
}

#[test]
fn the_override_is_ignored() {
    let motions = [(Path::Line, point(0, -32_000_000), thread(2_000_000, 0))];
    let places = [0, 30, 100, 200].map(|percent| run(&motions, 6, percent, wobbling(400.0)).places);
    assert!(places.iter().all(|other| *other == places[2]));
}
