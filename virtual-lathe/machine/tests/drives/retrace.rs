//! The way back: through a thousand blocks and forward again, by wheel and by time, and where it ends.

use crate::bench::{Bench, Turning, lathe, lathe_with, per_minute};
use crate::follower::{Follower, Item, blocks, items};
use crate::wheel::click;
use interp_core::block::{Block, Builder, Output, Pace, Path, Work};
use interp_core::channel::State;
use interp_core::config::Machine;
use interp_core::curve::method::Method;
use interp_core::drive::gearing::Lead;
use interp_core::drive::{BackEnd, Drive, Inputs};
use interp_core::law::SpeedLaw;
use interp_core::units::{Lattice, Length, Point, Sense};
use proptest::prelude::*;
use std::collections::{BTreeSet, VecDeque};

/// Short lines and arcs along Z, `count` of them.
fn row(count: i64) -> Vec<Item> {
    let item = |n: i64| match n % 5 {
        0 => Item::Line(200_000, -300_000, 1_500),
        1 => Item::Quarter(250_000, 1, Sense::CounterClockwise, 900),
        2 => Item::Line(-180_000, -50_000 - n % 7 * 10_000, 2_000),
        3 => Item::Quarter(120_000, 0, Sense::Clockwise, 1_200),
        _ => Item::Line(13_000, -7_000, 400),
    };
    (0..count).map(item).collect()
}

#[test]
fn a_thousand_blocks_are_retraced_to_the_start_and_run_on_to_the_end() {
    let machine = lathe(Method::MinimumDeviation);
    let mut follower = Follower::new(&machine, &blocks(&machine, &row(1_100)));
    follower.bench.channel.start();
    // to block 1010 or so, by time
    while follower.tick(0).line < 1_010 {}
    follower.hold();
    let there = *follower.index.first().unwrap();
    assert_eq!(follower.by_wheel(-40, 100_000), Some(BackEnd::Start));
    assert_eq!((follower.bench.at, follower.index.first()), (Lattice::default(), Some(&0)));
    // there again, and on into what had only been looked ahead to
    let mut ticks = 0;
    follower.bench.channel.set_drive(click(100)).unwrap();
    while *follower.index.first().unwrap() < there || follower.tick(0).line < 1_050 {
        follower.tick(40);
        ticks += 1;
        assert!(ticks < 100_000, "it does not come back");
    }
    follower.rest();
    // back over a hundred blocks, and by time to the end
    assert_eq!(follower.by_wheel(-40, 2_000), None);
    follower.by_time(100_000);
    assert_eq!((follower.bench.at, follower.bench.channel.state()), (follower.last(), State::Ended));
    follower.check_limits([1250.0, 2500.0]);
}

#[test]
fn a_long_way_back_is_as_fast_as_the_wheel_where_blocks_are_long_enough() {
    let machine = lathe(Method::MinimumDeviation);
    let lines: Vec<_> = (0..200).map(|_| Item::Line(0, -1_000_000, 3_000)).collect();
    let mut follower = Follower::new(&machine, &blocks(&machine, &lines));
    follower.bench.channel.start();
    while follower.tick(0).line < 190 {}
    follower.hold();
    follower.bench.channel.set_drive(click(1_000)).unwrap();
    let speeds: Vec<_> = (0..2_000).map(|_| follower.tick(-40).speed).collect();
    // 5000 mm/min
    assert!(speeds[1_000..].iter().all(|speed| speed >> 12 == 83_333), "{:?}", &speeds[1_000..1_020]);
}

/// More by the environment: PROPTEST_CASES. A program of a thousand blocks takes half a second, so little is shrunk.
fn cases(usual: u32, max_shrink_iters: u32) -> ProptestConfig {
    let cases = std::env::var("PROPTEST_CASES").map_or(usual, |cases| cases.parse().unwrap());
    ProptestConfig { cases, max_shrink_iters, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(cases(6, 16))]

    /// More than a thousand lines and arcs there by time, back and forth by the wheel, all the way back, and there again: each
    /// pulse back is one of the way there, undone in order.
    #[test]
    fn more_than_a_thousand_blocks_are_undone_pulse_by_pulse(
        items in prop::collection::vec(short(), 1_001..1_024), turns in prop::collection::vec((-60_i16..60, 1_usize..500), 8),
        pulses in prop::sample::select(vec![[1250, 2500], [1000, 1000], [5000, 1000]]), law: bool,
    ) {
        let machine = lathe_with(pulses, Method::MinimumDeviation);
        let machine = if law { machine.with_law(SpeedLaw::Sine, 50_000).unwrap() } else { machine };
        let mut follower = Follower::new(&machine, &blocks(&machine, &items));
        follower.bench.channel.start();
        while follower.tick(0).line <= 1_000 {}
        follower.hold();
        let there = follower.bench.at;
        for (counts, ticks) in turns {
            let end = follower.by_wheel(counts, ticks);
            prop_assert!(matches!(end, None | Some(BackEnd::Start)), "{end:?}");
        }
        prop_assert_eq!(follower.by_wheel(-40, 100_000), Some(BackEnd::Start));
        prop_assert_eq!((follower.bench.at, follower.index.first()), (Lattice::default(), Some(&0)));
        let mut ticks = 0;
        while follower.tick(40).line <= 1_000 {
            ticks += 1;
            prop_assert!(ticks < 100_000, "it does not come back to {:?}", there);
        }
        follower.rest();
        follower.by_time(100_000);
        prop_assert_eq!((follower.bench.at, follower.bench.channel.state()), (follower.last(), State::Ended));
        follower.check_limits(pulses.map(f64::from));
    }
}

/// Lines and quarters of circles of a few pulses to a few hundred.
fn short() -> impl Strategy<Value = Item> {
    let nm = || prop_oneof![-20_000_i64..20_000, -150_000_i64..150_000];
    let feed = || 300_u64..3_000;
    prop_oneof![
        2 => (nm(), nm(), feed()).prop_map(|(x, z, feed)| Item::Line(x, z, feed)),
        1 => (20_000_i64..150_000, 0_u8..4, any::<bool>(), feed()).prop_map(|(radius, quarter, clockwise, feed)| {
            Item::Quarter(radius, quarter, if clockwise { Sense::Clockwise } else { Sense::CounterClockwise }, feed)
        }),
    ]
}

proptest! {
    #![proptest_config(cases(12, 100))]

    /// Wheel and time in turns, whatever the program stands for on its way: the same points there and back, and the end.
    #[test]
    fn from_anywhere_on_the_way_it_goes_on(
        items in prop::collection::vec(items(), 20..80),
        turns in prop::collection::vec((any::<bool>(), -40_i16..30, 1_usize..1_200), 1..12),
        pulses in prop::sample::select(vec![[1250, 2500], [1000, 1000], [5000, 1000]]), law: bool,
    ) {
        let machine = lathe_with(pulses, Method::MinimumDeviation);
        let machine = if law { machine.with_law(SpeedLaw::Sine, 50_000).unwrap() } else { machine };
        let mut follower = Follower::new(&machine, &blocks(&machine, &items));
        follower.bench.channel.start();
        follower.by_time(2_000);
        for (wheel, counts, ticks) in turns {
            if follower.bench.channel.state() == State::Ended {
                break;
            }
            if wheel {
                let end = follower.by_wheel(counts, ticks);
                prop_assert!(matches!(end, None | Some(BackEnd::Start | BackEnd::Dwell)), "{end:?}");
                prop_assert!(end != Some(BackEnd::Start) || follower.bench.at == Lattice::default());
            } else {
                follower.by_time(ticks);
            }
        }
        if follower.bench.channel.state() != State::Ended {
            // home, and to the end
            prop_assert_eq!(follower.by_wheel(-10, 200_000), Some(BackEnd::Start));
            prop_assert_eq!(follower.bench.at, Lattice::default());
            follower.by_time(200_000);
        }
        prop_assert_eq!((follower.bench.at, follower.bench.channel.state()), (follower.last(), State::Ended));
        follower.check_limits(pulses.map(f64::from));
    }

    /// Methods that walk back on points of their own are exact at home and at the end.
    #[test]
    fn every_method_comes_home_from_afar(method in 0_usize..6, kind in 0_i64..5) {
        let machine = lathe(Method::ALL[method]);
        let items = row(60 + kind);
        let all = blocks(&machine, &items);
        let mut bench = Bench::new(&machine, all.clone());
        bench.channel.start();
        while bench.tick(&Inputs::default()).line < 50 {}
        bench.channel.hold();
        bench.rest(200);
        bench.channel.set_drive(click(100)).unwrap();
        bench.channel.start();
        let end = (0..100_000).find_map(|_| bench.wheel(-9).driven.back_end);
        prop_assert_eq!((bench.at, end), (Lattice::default(), Some(BackEnd::Start)));
        for _ in 0..3_000 {
            bench.wheel(7);
        }
        bench.rest(400);
        bench.channel.set_drive(Drive::Time).unwrap();
        while bench.channel.state() != State::Ended {
            bench.rest(1);
        }
        let sum = |at: Lattice, (x, z): (i32, i32)| Lattice { x: at.x + x, z: at.z + z };
        let motions = all.iter().filter_map(|block| match &block.work {
            Work::Motion(motion) => Some(motion.curve.end()),
            _ => None,
        });
        prop_assert_eq!(bench.at, motions.fold(Lattice::default(), sum));
    }
}

/// Wherever the dwell is left: there is no way back out of it, and it is no reason to run on at speed later.
#[test]
fn what_was_stood_at_is_stood_at_again() {
    let items = [Item::Line(0, -300_000, 1_500), Item::Dwell(20), Item::Line(400_000, 0, 3_000)];
    for law in [SpeedLaw::Linear, SpeedLaw::Sine] {
        let machine = lathe(Method::MinimumDeviation).with_law(law, 50_000).unwrap();
        let blocks = blocks(&machine, &items);
        let mut ends = BTreeSet::new();
        for ticks in (20..120).step_by(2) {
            let mut follower = Follower::new(&machine, &blocks);
            follower.by_time(ticks);
            if follower.bench.channel.state() == State::Ended {
                break;
            }
            let end = follower.by_wheel(-1, 10);
            ends.insert(format!("{end:?}"));
            if end == Some(BackEnd::Dwell) {
                // it is over now
                assert_eq!(follower.by_wheel(-1, 11), None);
            }
            follower.by_time(1_000);
            assert_eq!((follower.bench.at, follower.bench.channel.state()), (follower.last(), State::Ended));
            follower.check_limits([1250.0, 2500.0]);
        }
        assert_eq!(ends.len(), 2, "in the dwell, and else: {ends:?}");
    }
}

#[test]
fn where_too_many_blocks_were_run_the_way_back_ends_at_the_oldest_kept() {
    let machine = lathe(Method::MinimumDeviation);
    let lines: Vec<_> =
        (0..1_500).map(|n| Item::Line(if n % 2 == 0 { 25_000 } else { -25_000 }, -100_000, 3_000)).collect();
    let mut follower = Follower::new(&machine, &blocks(&machine, &lines));
    follower.bench.channel.start();
    let mut line = 0;
    while line < 1_400 {
        line = follower.tick(0).line;
    }
    follower.bench.channel.hold();
    while follower.tick(0).speed > 0 {}
    line = follower.tick(0).line;
    follower.bench.channel.start();
    assert_eq!(follower.by_wheel(-40, 100_000), Some(BackEnd::Full));
    // the motion that it was in, and 1023 before it
    assert_eq!(follower.bench.at.z, -40 * (line as i32 - 1_024));
    assert!(follower.tick(-4).driven.back_end == Some(BackEnd::Full), "it is told again");
    follower.by_time(100_000);
    assert_eq!((follower.bench.at, follower.bench.channel.state()), (follower.last(), State::Ended));
}

/// Runs a program to its second last block, held there, and winds back.
fn wound_back(machine: &Machine, blocks: VecDeque<Block>, ticks: u32) -> (Bench, Option<BackEnd>) {
    let mut bench = Bench::new(machine, blocks);
    bench.channel.set_encoder(Some(4096));
    let mut turning = Turning::new();
    bench.channel.start();
    for _ in 0..ticks {
        let reading = turning.reading();
        bench.tick(&Inputs { spindle: Some(reading), wheel: 0 });
        turning.spindle.command(600.0);
        turning.spindle.tick();
    }
    bench.channel.hold();
    bench.rest(300);
    bench.channel.set_drive(click(100)).unwrap();
    bench.channel.start();
    let mut end = None;
    for _ in 0..3_000 {
        end = end.or(bench.wheel(-10).driven.back_end);
    }
    (bench, end)
}

#[test]
fn outputs_and_threads_end_the_way_back_by_name() {
    let machine = lathe(Method::MinimumDeviation);
    let mut builder = Builder::new(&machine, Point::default());
    let mut blocks = VecDeque::new();
    let to = |blocks: &mut VecDeque<Block>, builder: &mut Builder, z: i64, pace| {
        let end = Point { x: Length::from_nm(0).unwrap(), z: Length::from_nm(z).unwrap() };
        let built = builder.motion(Path::Line, end, pace);
        blocks.extend(built.motions.iter().map(|motion| Block { line: 1, work: Work::Motion(*motion) }));
    };
    to(&mut blocks, &mut builder, -5_000_000, per_minute(3_000));
    let mut with_thread = (blocks.clone(), builder.clone());
    builder.standstill();
    blocks.push_back(Block { line: 2, work: Work::Output(Output::Tool(1, 1)) });
    to(&mut blocks, &mut builder, -6_000_000, per_minute(3_000));
    builder.standstill();
    blocks.push_back(Block { line: 3, work: Work::Dwell(5) });
    to(&mut blocks, &mut builder, -30_000_000, per_minute(1_000));
    let (bench, end) = wound_back(&machine, blocks, 1_000);
    // past the dwell, to the output
    assert_eq!((bench.at.z, end), (-2_000, Some(BackEnd::Output)));

    let (blocks, builder) = &mut with_thread;
    let lead = Lead::new(1_000_000, 1).unwrap();
    to(blocks, builder, -15_000_000, Pace::Thread { lead, start: 0 });
    to(blocks, builder, -40_000_000, per_minute(1_000));
    let (bench, end) = wound_back(&machine, blocks.clone(), 2_200);
    assert_eq!((bench.at.z, end), (-6_000, Some(BackEnd::Thread)));
}
