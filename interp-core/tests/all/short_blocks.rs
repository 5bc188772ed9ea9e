//! Programs of blocks so short that a stop from the feed takes dozens of them.
#![allow(
    clippy::unwrap_used,
    clippy::cast_precision_loss,
    clippy::arithmetic_side_effects,
    missing_docs,
    reason = "tests"
)]

use interp_core::block::{Block, Builder, Pace, Path, Work};
use interp_core::channel::{Channel, State};
use interp_core::config::{AxisConfig, Config, Machine};
use interp_core::law::SpeedLaw;
use interp_core::train::Event;
use interp_core::units::{Feedrate, Lattice, Length, Point, PulseSize};

/// Acceleration of both axes, mm/s2.
const ACCEL: u32 = 500;

fn machine(law: Option<SpeedLaw>) -> Machine {
    let axis = AxisConfig {
        pulse: PulseSize::new(1250, 1).unwrap(),
        max_feed: Feedrate::from_nm_per_min(5_000_000_000).unwrap(),
        max_accel: ACCEL * 1_000,
        max_jump: 2_000,
        pulse_width_ns: 5_000,
        dir_setup_ns: 5_000,
        dir_hold_ns: 10_000,
        min_space_ns: 5_000,
    };
    let machine = Config { x: axis, z: axis, event_min_ns: 2_000 }.check().unwrap();
    law.map_or(machine, |law| machine.with_law(law, 50_000).unwrap())
}

/// The largest speed, mm/s, of so many lines of `um` along Z at the largest feed, which all wait in the source.
fn speed(law: Option<SpeedLaw>, um: i32, count: i32) -> f64 {
    run(law, um, count, None).0
}

/// The same, and the ticks that the lines take, with soft limits so many pulses behind the end of Z.
fn run(law: Option<SpeedLaw>, um: i32, count: i32, behind: Option<i32>) -> (f64, u32) {
    let machine = machine(law);
    let at = |z_um: i32| Point { x: Length::from_um(0).unwrap(), z: Length::from_um(z_um).unwrap() };
    let mut builder = Builder::new(&machine, at(0));
    let pace = Pace::Feed(Feedrate::from_nm_per_min(5_000_000_000).unwrap());
    let mut works: Vec<Work> = Vec::new();
    for n in 1..=count {
        works.extend(builder.motion(Path::Line, at(n * um), pace).motions.iter().map(|motion| Work::Motion(*motion)));
    }
    works.push(Work::End);
    let mut works = works.into_iter();
    let mut channel = Channel::<72>::new(&machine, Lattice::default());
    if let Some(behind) = behind {
        let far = i32::MAX >> 1;
        channel.set_fence(Lattice { x: -far, z: -far }, Lattice { x: far, z: um * count * 4 / 5 + behind });
    }
    assert!(channel.start());
    let (mut most, mut ticks) = (0, 0);
    loop {
        let mut source = || works.next().map(|work| Block { line: 1, work });
        let report = channel.tick(&mut source, &mut |_: Event| {});
        most = most.max(report.speed);
        ticks += u32::from(report.speed > 0);
        assert_eq!(channel.met_fence(), None);
        if report.state == State::Ended {
            return (f64::from(most) / 4096.0 / 1000.0, ticks);
        }
    }
}

/// Planning some blocks a tick takes ticks in which blocks are passed: a look-ahead of 72 makes up for them.
#[test]
fn what_72_blocks_planned_bit_by_bit_allow_is_no_slower_than_64_planned_at_once() {
    let accel = f64::from(ACCEL);
    for um in [140, 100, 70, 50, 30, 20, 10] {
        // what is known is enough to brake in: v^2 / 2a = 64 L
        let known = 64.0 * f64::from(um) / 1000.0;
        // and a block takes a tick at least
        let most = (5000.0 / 60.0_f64).min(f64::from(um));
        let linear = (2.0 * accel * known).sqrt().min(most);
        let found = speed(None, um, 120_000 / um);
        assert!(found >= linear * 0.999, "{um} um: {found} mm/s, {linear} wanted");
        // and, under an S law, twice the window of pi/2 a/j besides: v^2 / 2a + 2 v T = 64 L
        let ways = 2.0 * core::f64::consts::FRAC_PI_2 * accel / 50_000.0;
        let sine = (accel * (((ways * accel).powi(2) + 2.0 * accel * known).sqrt() / accel - ways)).min(most);
        let found = speed(Some(SpeedLaw::Sine), um, 120_000 / um);
        assert!(found >= sine * 0.98, "{um} um: {found} mm/s, {sine} wanted");
    }
}

/// Lines of a pulse to more than a tick, at the largest speeds and twice the feed: a tick begins two at most, and on the average
/// one is begun in each while it lasts.
#[test]
fn a_tick_begins_two_blocks_at_most() {
    let lengths = [1, 2, 3, 5, 10, 20, 40, 80, 160_i32];
    for law in [None, Some(SpeedLaw::Sine)] {
        for (seed, feed) in
            (1..=lengths.len()).flat_map(|seed| [500_000_000, 2_500_000_000, 5_000_000_000].map(|f| (seed, f)))
        {
            let machine = machine(law);
            let at = |z_um: i32| Point { x: Length::from_um(0).unwrap(), z: Length::from_um(z_um).unwrap() };
            let mut builder = Builder::new(&machine, at(0));
            let pace = Pace::Feed(Feedrate::from_nm_per_min(feed).unwrap());
            let (mut z, mut lines) = (0, Vec::new());
            for n in 0..3_000_usize {
                // all of one length where the seed is even, else a mix
                z += lengths[if seed % 2 == 0 { seed } else { (n * n + n / 7 * seed) % lengths.len() }];
                lines
                    .extend(builder.motion(Path::Line, at(z), pace).motions.iter().map(|motion| Work::Motion(*motion)));
            }
            lines.push(Work::End);
            let mut blocks = lines.into_iter().zip(1..).map(|(work, line)| Block { line, work });
            let mut channel = Channel::<72>::new(&machine, Lattice::default());
            channel.set_feed_override(200);
            assert!(channel.start());
            let (mut line, mut most) = (0, 0);
            loop {
                let report = channel.tick(&mut || blocks.next(), &mut |_: Event| {});
                if report.state == State::Ended {
                    break;
                }
                most = most.max(report.line - line);
                line = report.line;
            }
            assert!((1..=2).contains(&most), "{law:?}, seed {seed}, {feed} nm/min: {most} in a tick");
        }
    }
}

/// 40 mm that end a pulse before a soft limit: at these speeds the path is looked at all the way, and less is planned a tick. It is
/// not held, and takes at most a 20th longer than the same far from any limit: 4 % where lines are of 10 um.
#[test]
fn short_blocks_before_a_limit_are_as_fast_as_far_from_it() {
    for law in [None, Some(SpeedLaw::Sine)] {
        for um in [140, 100, 50, 20, 10] {
            let [far, near] = [None, Some(1)].map(|behind| run(law, um, 40_000 / um, behind));
            assert!(f64::from(near.1) <= f64::from(far.1) * 1.05, "{law:?}, {um} um: {near:?} beside {far:?}");
        }
    }
}
