//! The spindle as a drive of plain motions, and feed a turn.

use crate::bench::{Bench, Turning, keep_limits, lathe, per_minute, point, program, turns};
use interp_core::block::{Pace, Path};
use interp_core::curve::method::Method;
use interp_core::drive::gearing::Lead;
use interp_core::drive::{Drive, Inputs, Trouble};
use interp_core::units::Sense;

/// Runs with the spindle; the last report's trouble.
fn run(bench: &mut Bench, turning: &mut Turning, ticks: u32, rpm: f64, places: &mut Vec<i32>) -> Option<Trouble> {
    let mut trouble = None;
    for _ in 0..ticks {
        let reading = turning.reading();
        let report = bench.tick(&Inputs { spindle: Some(reading), wheel: 0 });
        trouble = trouble.or(report.driven.trouble);
        places.push(bench.at.z);
        turning.spindle.command(rpm);
        turning.spindle.tick();
    }
    trouble
}

#[test]
fn the_spindle_turns_the_crank_of_any_path_both_ways() {
    let machine = lathe(Method::MinimumDeviation);
    let turn = Sense::Clockwise;
    let blocks = program(
        &machine,
        &[
            (Path::Line, point(0, -10_000_000), per_minute(100)),
            (
                Path::Arc { centre: (5_000_000, -10_000_000), sense: turn },
                point(5_000_000, -15_000_000),
                per_minute(100),
            ),
            (Path::Line, point(20_000_000, -15_000_000), per_minute(100)),
        ],
    );
    let mut bench = Bench::new(&machine, blocks);
    bench.channel.set_encoder(Some(4096));
    let mut turning = Turning::new();
    bench.channel.set_drive(Drive::Spindle(Lead::new(1_000_000, 1).unwrap())).unwrap();
    bench.channel.start();
    let mut places = Vec::new();
    run(&mut bench, &mut turning, 200, 0.0, &mut places);
    assert_eq!((bench.at.x, bench.at.z), (0, 0), "it stands with the spindle");
    let begin = turns(turning.spindle.angle_after(0.0));
    run(&mut bench, &mut turning, 3_000, 300.0, &mut places);
    run(&mut bench, &mut turning, 1_000, 0.0, &mut places);
    // about 15 turns at a millimetre: on the arc
    let path = turns(turning.spindle.angle_after(0.0)) - begin;
    assert!((12.0..17.0).contains(&path), "{path}");
    assert!(bench.at.x > 0 && bench.at.z < -4_000, "{:?}", bench.at);
    run(&mut bench, &mut turning, 2_000, -200.0, &mut places);
    let angle = turns(turning.spindle.angle_after(0.0)) - begin;
    let off = f64::from(-bench.at.z) * 0.0025 - angle;
    assert!(bench.at.x == 0 && off.abs() < 0.05, "{off} mm of {angle} while it turns back");
    // and beyond the start of the path: it stands there, exactly
    run(&mut bench, &mut turning, 4_000, -300.0, &mut places);
    assert_eq!((bench.at.x, bench.at.z), (0, 0));
    keep_limits(&places, 2500.0, 5.0);
    // and on to its end
    run(&mut bench, &mut turning, 9_000, 600.0, &mut places);
    assert_eq!((bench.at.x, bench.at.z), (16_000, -6_000));
}

#[test]
fn feed_a_turn_follows_the_spindle_without_phase() {
    let machine = lathe(Method::MinimumDeviation);
    let lead = Lead::new(200_000, 1).unwrap();
    let blocks = program(&machine, &[(Path::Line, point(0, -50_000_000), Pace::PerTurn(lead))]);
    let mut bench = Bench::new(&machine, blocks);
    bench.channel.set_encoder(Some(4096));
    let mut turning = Turning::new();
    bench.channel.start();
    let mut places = Vec::new();
    run(&mut bench, &mut turning, 500, 0.0, &mut places);
    assert_eq!(bench.at.z, 0, "no turn, no feed");
    run(&mut bench, &mut turning, 1_000, 600.0, &mut places);
    let (z, angle) = (bench.at.z, turns(turning.spindle.angle_after(0.0)));
    run(&mut bench, &mut turning, 5_000, 600.0, &mut places);
    let (went, turned) = (f64::from(z - bench.at.z) * 0.0025, turns(turning.spindle.angle_after(0.0)) - angle);
    assert!((went - turned * 0.2).abs() < 0.004, "{went} mm in {turned} turns");
    bench.channel.set_feed_override(50);
    let (z, angle) = (bench.at.z, turns(turning.spindle.angle_after(0.0)));
    run(&mut bench, &mut turning, 5_000, 600.0, &mut places);
    let (went, turned) = (f64::from(z - bench.at.z) * 0.0025, turns(turning.spindle.angle_after(0.0)) - angle);
    assert!((went - turned * 0.1).abs() < 0.01, "{went} mm in {turned} turns");
    keep_limits(&places, 2500.0, 3.0);
}

#[test]
fn counts_that_get_lost_are_told() {
    let machine = lathe(Method::MinimumDeviation);
    let lead = Lead::new(1_000_000, 1).unwrap();
    let blocks = program(&machine, &[(Path::Line, point(0, -90_000_000), Pace::Thread { lead, start: 0 })]);
    let mut bench = Bench::new(&machine, blocks);
    bench.channel.set_encoder(Some(4096));
    let (mut turning, mut lost) = (Turning::new(), None);
    bench.channel.start();
    for tick in 0..4_000 {
        let mut reading = turning.reading();
        if tick >= 2_000 {
            // twelve counts were missed
            reading.counts = reading.counts.wrapping_sub(12);
            reading.index = reading.index.map(|index| index.wrapping_sub(12));
        }
        let report = bench.tick(&Inputs { spindle: Some(reading), wheel: 0 });
        lost = lost.or(report.driven.trouble.map(|trouble| (tick, trouble)));
        turning.spindle.command(400.0);
        turning.spindle.tick();
    }
    // at 400 turns a minute the index comes within 150 ticks
    assert!(matches!(lost, Some((2_000..2_152, Trouble::Index { off: -12 }))), "{lost:?}");
}
