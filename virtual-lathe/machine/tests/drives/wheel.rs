//! The contour wheel: along curves of every method, both ways, over joints.

use crate::bench::{Bench, lathe, per_minute, point, program};
use interp_core::block::{Block, Path, Work};
use interp_core::config::Machine;
use interp_core::curve::method::Method;
use interp_core::drive::Drive;
use interp_core::drive::wheel::Click;
use interp_core::units::{Lattice, Point, Sense};
use proptest::prelude::*;
use std::collections::{BTreeSet, VecDeque};

/// A contour of nine motions: lines, arcs either way, one of more than half a turn, corners.
fn contour(machine: &Machine) -> VecDeque<Block> {
    let arc = |x: i64, z: i64, sense| Path::Arc { centre: (x, z), sense };
    let (left, right) = (Sense::CounterClockwise, Sense::Clockwise);
    let motions: [(Path, Point); 9] = [
        (Path::Line, point(700_000, -900_000)),
        (Path::Line, point(700_000, -2_400_000)),
        (arc(1_900_000, -2_400_000, left), point(1_900_000, -3_600_000)),
        (arc(1_900_000, -3_000_000, right), point(2_500_000, -3_000_000)),
        (Path::Line, point(2_501_250, -3_000_000)),
        (arc(3_401_250, -3_000_000, right), point(3_401_250, -2_100_000)),
        (Path::Line, point(4_000_000, -4_800_000)),
        (arc(4_600_000, -4_800_000, left), point(4_600_000, -5_400_000)),
        (Path::Line, point(4_600_000, -7_000_000)),
    ];
    program(machine, &motions.map(|(path, end)| (path, end, per_minute(400))))
}

/// Distance of a lattice point from the contour, in coarser pulses; its ends and centres lie on the lattice, so the walked
/// curve is the programmed one.
fn off(at: Lattice) -> f64 {
    let (x, z) = (f64::from(at.x) * 1.25, f64::from(at.z) * 2.5);
    let lines: [[f64; 4]; 5] = [
        [0.0, 0.0, 700.0, -900.0],
        [700.0, -900.0, 700.0, -2400.0],
        [2500.0, -3000.0, 2501.25, -3000.0],
        [3401.25, -2100.0, 4000.0, -4800.0],
        [4600.0, -5400.0, 4600.0, -7000.0],
    ];
    let circles: [[f64; 3]; 4] =
        [[1900.0, -2400.0, 1200.0], [1900.0, -3000.0, 600.0], [3401.25, -3000.0, 900.0], [4600.0, -4800.0, 600.0]];
    let straight = lines.iter().map(|[x0, z0, x1, z1]| {
        let (dx, dz) = (x1 - x0, z1 - z0);
        let part = (((x - x0) * dx + (z - z0) * dz) / (dx * dx + dz * dz)).clamp(0.0, 1.0);
        (x - x0 - part * dx).hypot(z - z0 - part * dz)
    });
    let round = circles.iter().map(|[cx, cz, radius]| ((x - cx).hypot(z - cz) - radius).abs());
    straight.chain(round).fold(f64::MAX, f64::min) / 2.5
}

pub(crate) fn click(um: u32) -> Drive {
    Drive::Wheel(Click::from_nm(um * 1_000).unwrap())
}

fn bench(machine: &Machine, um: u32) -> Bench {
    let mut bench = Bench::new(machine, contour(machine));
    bench.channel.set_drive(click(um)).unwrap();
    bench.channel.start();
    bench.rest(5);
    bench
}

/// Every lattice point of the contour, by time.
fn points(machine: &Machine) -> Vec<Lattice> {
    let mut bench = Bench::new(machine, contour(machine));
    bench.channel.start();
    let mut points = vec![Lattice::default()];
    for _ in 0..20_000 {
        bench.rest(1);
        points.extend(bench.pulses.iter().map(|pulse| pulse.at));
    }
    points
}

fn end(machine: &Machine) -> Lattice {
    let motions = contour(machine);
    motions.iter().fold(Lattice::default(), |at, block| match &block.work {
        Work::Motion(motion) => Lattice { x: at.x + motion.curve.end().0, z: at.z + motion.curve.end().1 },
        _ => at,
    })
}

proptest! {
    // more by the environment: PROPTEST_CASES
    #![proptest_config(ProptestConfig { cases: std::env::var("PROPTEST_CASES").map_or(24, |cases| cases.parse().unwrap()), ..ProptestConfig::default() })]

    /// Wherever the wheel turns round, the points are those of the way forward, one after the other; wound back it is
    /// exactly home, and on to the end exactly there.
    #[test]
    fn there_and_back_is_home_over_the_same_points(
        turns in prop::collection::vec((-30_i16..40, 1_u32..60), 1..60), um in prop::sample::select(vec![1_u32, 10, 100]), method in 0_usize..6
    ) {
        there_and_back(&turns, um, Method::ALL[method], 12.0)?;
    }
}

/// Where so many counts lead straight.
fn direct(machine: &Machine, um: u32, counts: i64) -> Lattice {
    let mut bench = bench(machine, um);
    let mut left = counts;
    while left > 0 {
        let asked = left.min(4) as i16;
        left -= i64::from(asked) - i64::from(bench.wheel(asked).driven.dropped);
        // at the end until it rests: what is dropped there is asked for again
        for _ in 0..if left > 0 { 6 } else { 400 } {
            left += i64::from(bench.wheel(0).driven.dropped);
        }
    }
    bench.at
}

/// Runs random moves; `slack` in pulses for what a corner and rounding make of a second difference.
fn there_and_back(turns: &[(i16, u32)], um: u32, method: Method, slack: f64) -> Result<(), TestCaseError> {
    let machine = lathe(method);
    let mut bench = bench(&machine, um);
    let exact = matches!(method, Method::MinimumDeviation | Method::RateMultiplier | Method::Fraction);
    let way = points(&machine);
    let (mut index, mut net, mut places) = (BTreeSet::from([0]), 0_i64, Vec::new());
    let step = |bench: &mut Bench, counts: i16, index: &mut BTreeSet<usize>, places: &mut Vec<[i32; 2]>| {
        let report = bench.wheel(counts);
        for pulse in &bench.pulses {
            // minimum deviation half a pulse, classic methods one, time division 1.21
            let most = if exact {
                0.86
            } else if method == Method::TimeDivision {
                1.22
            } else {
                1.01
            };
            prop_assert!(off(pulse.at) <= most, "{:?} is {} pulses off", pulse.at, off(pulse.at));
            if exact {
                // where the contour turns back on itself, more than one place of it may be meant
                let next = index.iter().flat_map(|&index| [index.checked_sub(1), Some(index + 1)]).flatten();
                let next: BTreeSet<usize> = next.filter(|&next| way.get(next) == Some(&pulse.at)).collect();
                prop_assert!(!next.is_empty(), "off the points: {:?} at {:?}", pulse.at, index);
                *index = next;
            }
        }
        places.push([bench.at.x, bench.at.z]);
        Ok(i64::from(counts) - i64::from(report.driven.dropped))
    };
    for (counts, ticks) in turns {
        for tick in 0..*ticks {
            let counts = if tick % 3 == 0 { *counts } else { 0 };
            net += step(&mut bench, counts, &mut index, &mut places)?;
        }
    }
    // let it come to rest, then wind back what was taken, slowly
    for _ in 0..400 {
        net += step(&mut bench, 0, &mut index, &mut places)?;
    }
    prop_assert!(net >= 0, "{net}");
    if exact {
        prop_assert_eq!(bench.at, direct(&machine, um, net), "where it is depends on how it came there");
    }
    let mut left = net;
    while left > 0 {
        let counts = left.min(4) as i16;
        left += step(&mut bench, -counts, &mut index, &mut places)?;
        if um == 100 {
            for _ in 0..6 {
                left += step(&mut bench, 0, &mut index, &mut places)?;
            }
        }
    }
    for _ in 0..400 {
        step(&mut bench, 0, &mut index, &mut places)?;
    }
    prop_assert_eq!(bench.at, Lattice::default());
    // to the end
    bench.channel.set_drive(click(100)).unwrap();
    let last = end(&machine);
    for _ in 0..6_000 {
        step(&mut bench, 3, &mut index, &mut places)?;
        if bench.at == last {
            break;
        }
    }
    prop_assert_eq!(bench.at, last);
    for (axis, pulse) in [(0, 1250.0), (1, 2500.0)] {
        let places: Vec<i32> = places.iter().map(|place| place[axis]).collect();
        limits(&places, pulse, slack)?;
    }
    Ok(())
}

/// Speed and acceleration over windows, joints within 2 mm/s on either side.
fn limits(places: &[i32], pulse_nm: f64, slack: f64) -> Result<(), TestCaseError> {
    let (v, a, jump) = (5000.0 / 60.0 * 1e3 / pulse_nm, 500.0 / pulse_nm, 2_000.0 / pulse_nm);
    for h in (0..9).map(|n| 1_usize << n) {
        for at in 2 * h..places.len() {
            let [first, middle, last] = [places[at - 2 * h], places[at - h], places[at]].map(f64::from);
            let (travel, bend) = ((last - middle).abs(), (last - 2.0 * middle + first).abs());
            prop_assert!(travel <= v * h as f64 + 2.0, "tick {at}: {travel} pulses in {h} ticks");
            // up to two corners in a window
            let most = a * (h * h) as f64 + 2.0 * jump * h as f64 + slack;
            prop_assert!(bend <= most, "tick {at}: {bend} over {h} ticks, {most} allowed");
        }
    }
    Ok(())
}

#[test]
fn it_runs_on_by_braking_a_click_and_a_tick_at_most() {
    for (um, counts) in [(10, 8), (100, 1), (100, 4), (100, 40)] {
        let machine = lathe(Method::MinimumDeviation);
        let blocks = program(&machine, &[(Path::Line, point(0, -400_000_000), per_minute(100))]);
        let mut bench = Bench::new(&machine, blocks);
        bench.channel.set_drive(click(um)).unwrap();
        bench.channel.start();
        bench.rest(5);
        let mut speed = 0;
        for _ in 0..400 {
            speed = bench.wheel(counts).speed;
        }
        let stopped = bench.at.z;
        bench.rest(600);
        let (run_on, speed) = (f64::from(stopped - bench.at.z) * 2.5, f64::from(speed) / 4096.0);
        // um, with a of 0.5 um/tick2; the tick that was being made is part of what is on its way
        let most = speed / 1e3 * speed / 1e3 / (2.0 * 0.5) + f64::from(um) + 2.0 * speed / 1e3 + 2.5;
        assert!(run_on <= most, "{um} um, {counts} counts a tick: {run_on} um, at most {most}");
        assert!(speed > 1000.0);
    }
}

#[test]
fn a_click_moves_within_two_ticks_and_exactly() {
    let machine = lathe(Method::MinimumDeviation);
    let blocks = program(&machine, &[(Path::Line, point(0, -400_000_000), per_minute(100))]);
    let mut bench = Bench::new(&machine, blocks);
    bench.channel.set_drive(click(100)).unwrap();
    bench.channel.start();
    bench.rest(5);
    bench.wheel(4);
    bench.rest(2);
    assert!(bench.at.z < 0, "it moves within two ticks after the reading's");
    bench.rest(100);
    assert_eq!(bench.at.z, -40);
    for detent in 1..=7 {
        bench.wheel(-1);
        bench.rest(60);
        assert_eq!(bench.at.z, -40 + 10 * detent.min(4), "a quarter of a click each, and no further than the start");
    }
}

/// Back over joints, exactly to the start of the path.
#[test]
fn the_way_back_ends_exactly_at_the_start() {
    let machine = lathe(Method::MinimumDeviation);
    let steps: Vec<_> = (1..=20).map(|n| (Path::Line, point(n * 100_000, -n * 250_000), per_minute(400))).collect();
    let mut bench = Bench::new(&machine, program(&machine, &steps));
    bench.channel.set_drive(click(100)).unwrap();
    bench.channel.start();
    bench.rest(5);
    // into the fifteenth: 14.5 x 0.269 mm
    for _ in 0..39 {
        bench.wheel(4);
        bench.rest(10);
    }
    bench.rest(300);
    assert!((-3_750..-3_500).contains(&(bench.at.z * 5 / 2)), "{:?}", bench.at);
    let mut dropped = 0;
    for _ in 0..45 {
        dropped += bench.wheel(-4).driven.dropped;
        for _ in 0..10 {
            dropped += bench.wheel(0).driven.dropped;
        }
    }
    bench.rest(300);
    assert_eq!((bench.at.x, bench.at.z), (0, 0));
    assert!(dropped < 0, "{dropped}");
}
