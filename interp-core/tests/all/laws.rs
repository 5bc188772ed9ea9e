//! The S laws, measured on the tool's advance in each tick: jerk, joints, limits, ends.
#![allow(clippy::unwrap_used, clippy::cast_precision_loss, clippy::indexing_slicing, missing_docs, reason = "tests")]

use interp_core::block::{Block, Builder, Feed, Motion, Pace, Path, Speed, Work};
use interp_core::channel::{Channel, State};
use interp_core::config::{AxisConfig, Config, Machine};
use interp_core::curve::arc::Arc;
use interp_core::law::SpeedLaw;
use interp_core::train::Event;
use interp_core::units::{Feedrate, Length, Point, PulseSize, Sense};
use proptest::prelude::*;

const LAWS: [SpeedLaw; 2] = [SpeedLaw::Sine, SpeedLaw::Parabolic];
/// Largest jerk, mm/s3.
const JERK: u32 = 50_000;
/// Acceleration of both axes, mm/s2.
const ACCEL: f64 = 500.0;

/// The feed of a motion that has one.
fn fed(motion: &Motion) -> Speed {
    match motion.feed {
        Feed::PerTick(feed) => feed,
        Feed::Rapid | Feed::PerTurn(_) | Feed::Thread(..) => unreachable!("a feed a minute"),
    }
}

fn config(accel: [u32; 2], jump: u32) -> Config {
    let axis = |accel: u32| AxisConfig {
        pulse: PulseSize::new(1250, 1).unwrap(),
        max_feed: Feedrate::from_nm_per_min(5_000_000_000).unwrap(),
        max_accel: accel * 1_000,
        max_jump: jump,
        pulse_width_ns: 5_000,
        dir_setup_ns: 5_000,
        dir_hold_ns: 10_000,
        min_space_ns: 5_000,
    };
    Config { x: axis(accel[0]), z: axis(accel[1]), event_min_ns: 2_000 }
}

fn machine(law: SpeedLaw) -> Machine {
    config([500, 500], 2_000).check().unwrap().with_law(law, JERK).unwrap()
}

fn point(x_um: i32, z_um: i32) -> Point {
    Point { x: Length::from_um(x_um).unwrap(), z: Length::from_um(z_um).unwrap() }
}

fn feed(mm_min: u32) -> Pace {
    Pace::Feed(Feedrate::from_nm_per_min(u64::from(mm_min) * 1_000_000).unwrap())
}

/// A piece of a program: relative ends in um.
#[derive(Clone, Debug)]
enum Piece {
    Line(i32, i32),
    /// Half a circle of this radius to either side.
    Half(i32, bool),
    /// A quarter of a circle.
    Quarter(i32, bool),
    /// A smooth run of short lines: length, turn in thousandths, how many.
    Run(i32, i32, u32),
    Dwell,
}

/// The blocks of pieces, each with its feed in mm/min.
fn blocks(machine: &Machine, pieces: &[(Piece, u32)]) -> Vec<Work> {
    let mut builder = Builder::new(machine, point(0, 0));
    let (mut x, mut z) = (0, 0);
    let mut works = Vec::new();
    for (piece, speed) in pieces {
        let mut go = |path, x, z| {
            let built = builder.motion(path, point(x, z), feed(*speed));
            works.extend(built.motions.iter().map(|motion| Work::Motion(*motion)));
        };
        let sense = |left: &bool| if *left { Sense::CounterClockwise } else { Sense::Clockwise };
        let centre = |x: i32, z: i32| (i64::from(x) * 1_000, i64::from(z) * 1_000);
        match piece {
            Piece::Line(dx, dz) => {
                (x, z) = (x + dx, z + dz);
                go(Path::Line, x, z);
            }
            Piece::Half(radius, left) => {
                let path = Path::Arc { centre: centre(x + radius, z), sense: sense(left) };
                x += 2 * radius;
                go(path, x, z);
            }
            Piece::Quarter(radius, left) => {
                let path = Path::Arc { centre: centre(x, z + radius), sense: sense(left) };
                (x, z) = if *left { (x - radius, z + radius) } else { (x + radius, z + radius) };
                go(path, x, z);
            }
            Piece::Run(step, turn, count) => {
                let mut heading = f64::from(*turn) / 100.0;
                for _ in 0..*count {
                    heading += f64::from(*turn) / 1_000.0;
                    #[expect(clippy::cast_possible_truncation, reason = "micrometres")]
                    let part = |part: f64| (f64::from(*step) * part).round() as i32;
                    (x, z) = (x + part(heading.sin()), z + part(heading.cos()));
                    go(Path::Line, x, z);
                }
            }
            Piece::Dwell => {
                builder.standstill();
                works.push(Work::Dwell(3));
            }
        }
    }
    works.push(Work::End);
    works
}

/// What is done to a channel before a tick.
#[derive(Copy, Clone, Debug)]
enum Deed {
    Hold,
    Start,
    Override(u16),
    Reset,
}

/// A run: the tool's advance in each tick, nm with 12 fraction bits.
struct Run {
    machine: Machine,
    works: Vec<Work>,
    advance: Vec<f64>,
    /// The override in force at each tick, percent.
    percent: Vec<u16>,
    position: (i32, i32),
}

fn run(machine: Machine, works: Vec<Work>, deeds: &[(usize, Deed)]) -> Run {
    run_late(machine, works, deeds, |_| usize::MAX)
}

/// The same, with so many blocks arrived at each tick.
fn run_late(machine: Machine, works: Vec<Work>, deeds: &[(usize, Deed)], arrived: impl Fn(usize) -> usize) -> Run {
    let mut channel = Channel::<72>::new(&machine, interp_core::units::Lattice::default());
    let mut given = 0;
    let (mut advance, mut percent) = (Vec::new(), Vec::new());
    // where each work ends on the path; of a motion's last tick the speed is 0 already, though it moved
    let ends: Vec<u64> = works
        .iter()
        .scan(0, |at, work| {
            *at += if let Work::Motion(motion) = work { motion.length } else { 0 };
            Some(*at)
        })
        .collect();
    let mut at = 0;
    channel.start();
    let mut deeds = deeds.iter().peekable();
    for tick in 0.. {
        while let Some((_, deed)) = deeds.next_if(|(at, _)| *at <= tick) {
            match deed {
                Deed::Hold => drop(channel.hold()),
                Deed::Start => drop(channel.start()),
                Deed::Override(percent) => channel.set_feed_override(*percent),
                Deed::Reset => channel.reset(),
            }
        }
        let limit = arrived(tick).min(works.len());
        let mut source = || {
            let work = works.get(given).filter(|_| given < limit).copied()?;
            given += 1;
            Some(Block { line: u32::try_from(given).unwrap(), work })
        };
        let report = channel.tick(&mut source, &mut |_: Event| {});
        let before = at;
        at = match ((report.line as usize).checked_sub(1), report.state) {
            (Some(work), _) => ends[work] - channel.to_go(),
            (None, State::Ended) => *ends.last().unwrap(),
            (None, _) => at,
        };
        advance.push((at - before) as f64);
        percent.push(channel.feed_override());
        if matches!(report.state, State::Ended) || matches!(report.state, State::Idle) && tick > 100 {
            break;
        }
        assert!(tick < 200_000, "does not end: {works:?}");
    }
    advance.extend([0.0; 3]);
    percent.extend([100; 3]);
    let position = channel.position();
    Run { machine, works, advance, percent, position: (position.x, position.z) }
}

fn motions(works: &[Work]) -> impl Iterator<Item = &Motion> {
    works.iter().filter_map(|work| if let Work::Motion(motion) = work { Some(motion) } else { None })
}

impl Run {
    /// Greatest change of the acceleration in a tick, mm/s3.
    fn jerk(&self) -> f64 {
        let third = |w: &[f64]| (w[2] - 2.0 * w[1] + w[0]).abs();
        self.advance.windows(3).map(third).fold(0.0, f64::max) / 4.096
    }

    /// Ticks in motion.
    fn ticks(&self) -> usize {
        self.advance.iter().rposition(|v| *v > 0.0).unwrap() - self.advance.iter().position(|v| *v > 0.0).unwrap() + 2
    }

    fn lands(&self) -> Result<(), TestCaseError> {
        let end = motions(&self.works).fold((0, 0), |(x, z), motion| {
            let (dx, dz) = motion.curve.end();
            (x + dx, z + dz)
        });
        prop_assert_eq!(self.position, end);
        Ok(())
    }

    /// Speeds at joints and in blocks, accelerations along and across the path: none above its limit.
    fn keeps_limits(&self) -> Result<(), TestCaseError> {
        let all: Vec<&Motion> = motions(&self.works).collect();
        if all.is_empty() {
            return Ok(());
        }
        let (mut number, mut begun, mut at, mut before) = (0, 0.0, 0.0, 0.0);
        for (tick, advance) in self.advance.iter().enumerate() {
            let from = at;
            at += advance;
            let mut crossed = false;
            // a thousandth for what weights and lengths round
            let most = |cap: u32| f64::from(cap) * 1.001 + 4096.0;
            while number + 1 < all.len() && at > begun + all[number].length as f64 {
                begun += all[number].length as f64;
                number += 1;
                crossed = true;
                prop_assert!(
                    *advance <= most(all[number].joint),
                    "joint {number} at tick {tick}: {advance} of {}",
                    all[number].joint
                );
            }
            let motion = all[number];
            prop_assert!(
                *advance <= most(motion.limit),
                "block {number} at tick {tick}: {advance} of {}",
                motion.limit
            );
            let along = (advance - before) / 4096.0;
            before = *advance;
            if crossed || tick < 1 || from <= begun {
                continue;
            }
            let (across, accel) = match &motion.curve {
                interp_core::block::Curve::Arc(arc) => (self.across(arc, *advance), ACCEL),
                _ => (0.0, f64::from(motion.accel) / 4096.0 * 8.0 / 7.0),
            };
            let total = along.hypot(across);
            prop_assert!(total <= 1.002 * accel + 0.5, "{total} of {accel} in {number} at {tick}");
        }
        Ok(())
    }

    fn across(&self, arc: &Arc, advance: f64) -> f64 {
        advance * advance / arc.radius() as f64 / 4096.0
    }

    /// Without changes of the override: the programmed feed is never passed.
    fn keeps_feeds(&self) -> Result<(), TestCaseError> {
        let all: Vec<&Motion> = motions(&self.works).collect();
        if all.is_empty() {
            return Ok(());
        }
        let (mut number, mut begun, mut at) = (0, 0.0, 0.0);
        for (tick, advance) in self.advance.iter().enumerate() {
            let percent = f64::from(self.percent[tick]) / 100.0;
            let feed = |number: usize| f64::from(fed(all[number])) * percent * 1.001 + 4096.0;
            let first = number;
            at += advance;
            while number + 1 < all.len() && at > begun + all[number].length as f64 {
                begun += all[number].length as f64;
                number += 1;
            }
            for number in first..=number {
                prop_assert!(*advance <= feed(number), "{number} at {tick}: {advance} of {}", feed(number));
            }
        }
        Ok(())
    }
}

fn piece() -> impl Strategy<Value = (Piece, u32)> {
    let far = -6_000..6_000_i32;
    let near = -60..60_i32;
    let piece = prop_oneof![
        4 => (far.clone(), far).prop_map(|(x, z)| Piece::Line(x, z)),
        3 => (near.clone(), near).prop_map(|(x, z)| Piece::Line(x, z)),
        2 => (20..8_000_i32, any::<bool>()).prop_map(|(r, left)| Piece::Half(r, left)),
        3 => (20..8_000_i32, any::<bool>()).prop_map(|(r, left)| Piece::Quarter(r, left)),
        2 => (20..500_i32, -300..300_i32, 3..60_u32).prop_map(|(s, t, n)| Piece::Run(s, t, n)),
        1 => Just(Piece::Dwell),
    ];
    (piece, prop_oneof![30..600_u32, 600..5000_u32, Just(1200_u32)])
}

fn deeds() -> impl Strategy<Value = Vec<(usize, Deed)>> {
    let deed = prop_oneof![
        2 => Just(Deed::Hold),
        3 => Just(Deed::Start),
        4 => (0_u16..=200).prop_map(Deed::Override),
        2 => prop_oneof![Just(10_u16), Just(200)].prop_map(Deed::Override),
    ];
    prop::collection::vec((1..150_usize, deed), 0..20).prop_map(|list| {
        let mut at = 0;
        let mut list: Vec<_> = list
            .into_iter()
            .map(|(gap, deed)| {
                at += gap;
                (at, deed)
            })
            .collect();
        list.extend([(at + 100, Deed::Override(100)), (at + 101, Deed::Start)]);
        list
    })
}

fn cases(bounded: u32) -> ProptestConfig {
    let cases = std::env::var("HANDCNC_CASES").ok().and_then(|text| text.parse().ok()).unwrap_or(bounded);
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(cases(400))]

    #[test]
    fn a_program_lands_on_its_end_within_all_limits(
        pieces in prop::collection::vec(piece(), 1..10),
        sine: bool,
    ) {
        let machine = machine(if sine { SpeedLaw::Sine } else { SpeedLaw::Parabolic });
        let run = run(machine, blocks(&machine, &pieces), &[]);
        run.lands()?;
        prop_assert!(run.jerk() <= 1.01 * f64::from(JERK), "{}", run.jerk());
        run.keeps_limits()?;
        run.keeps_feeds()?;
    }

    #[test]
    fn nothing_that_the_operator_does_breaks_a_limit(
        pieces in prop::collection::vec(piece(), 1..10),
        deeds in deeds(),
        sine: bool,
    ) {
        let machine = machine(if sine { SpeedLaw::Sine } else { SpeedLaw::Parabolic });
        let run = run(machine, blocks(&machine, &pieces), &deeds);
        run.lands()?;
        prop_assert!(run.jerk() <= 1.01 * f64::from(JERK), "{}", run.jerk());
        run.keeps_limits()?;
    }

    /// Blocks that arrive one by one, too late for the look-ahead.
    #[test]
    fn a_program_that_arrives_slowly_breaks_no_limit(
        pieces in prop::collection::vec(piece(), 1..10),
        gap in 1..40_usize,
        sine: bool,
    ) {
        let machine = machine(if sine { SpeedLaw::Sine } else { SpeedLaw::Parabolic });
        let run = run_late(machine, blocks(&machine, &pieces), &[], |tick| tick / gap);
        // what came too late for its margins may be stopped before with a small rest of speed
        prop_assert!(run.jerk() <= 1.1 * f64::from(JERK), "{}", run.jerk());
        run.keeps_limits()?;
    }
}

#[test]
fn a_long_move_takes_the_time_of_its_law() {
    for law in LAWS {
        let machine = machine(law);
        let run = run(machine, blocks(&machine, &[(Piece::Line(0, 40_000), 3000)]), &[]);
        // v / a + s / v of the lead, and the window
        let plan = 50.0 / 437.5 + 40.0 / 50.0;
        let expected = plan * 1e3 + f64::from(machine.smoothing.ticks()) - 1.0;
        let ticks = run.ticks() as f64;
        assert!((ticks - expected).abs() <= 2.0, "{law:?}: {ticks} ticks, {expected} expected");
        assert!(run.jerk() >= 0.34 * f64::from(JERK), "{}", run.jerk());
    }
}

#[test]
fn a_short_move_never_reaches_its_feed_and_lands() {
    for law in LAWS {
        for um in [2, 10, 100, 1_000, 3_000] {
            let machine = machine(law);
            let run = run(machine, blocks(&machine, &[(Piece::Line(0, um), 5000)]), &[]);
            run.lands().unwrap();
            assert!(run.jerk() <= 1.01 * f64::from(JERK));
            let top = run.advance.iter().copied().fold(0.0, f64::max) / 4_096_000.0;
            let reached = (437.5 * f64::from(um) / 1e3).sqrt();
            assert!(top <= reached * 1.01, "{law:?} {um} um: {top} of {reached}");
        }
    }
}

#[test]
fn a_corner_between_long_arms_is_passed_at_its_speed() {
    for law in LAWS {
        for angle in [0.05_f64, 0.1, 0.3, 1.0, 1.57] {
            let machine = machine(law);
            #[expect(clippy::cast_possible_truncation, reason = "micrometres")]
            let arm = |part: f64| (10_000.0 * part).round() as i32;
            let pieces = [(Piece::Line(0, 10_000), 3000), (Piece::Line(arm(angle.sin()), arm(angle.cos())), 3000)];
            let run = run(machine, blocks(&machine, &pieces), &[]);
            run.keeps_limits().unwrap();
            let all: Vec<_> = motions(&run.works).collect();
            let cap = all[1].joint.min(fed(all[0]));
            let mut at = 0.0;
            let at_joint = run.advance.iter().find(|advance| {
                at += **advance;
                at >= all[0].length as f64
            });
            let share = at_joint.unwrap() / f64::from(cap);
            assert!((0.985..=1.001).contains(&share), "{law:?} {angle}: {share}");
        }
    }
}

#[test]
fn a_reset_at_any_tick_brakes_and_forgets() {
    for law in LAWS {
        let machine = machine(law);
        let pieces = [(Piece::Line(0, 3_000), 3000), (Piece::Line(300, 3_000), 2000), (Piece::Quarter(900, true), 900)];
        for at in (1..400).step_by(7) {
            let run = run(machine, blocks(&machine, &pieces), &[(at, Deed::Reset)]);
            assert!(run.jerk() <= 1.01 * f64::from(JERK), "{at}: {}", run.jerk());
            run.keeps_limits().unwrap();
        }
    }
}

/// A curve in short lines, that looking ahead over 72 blocks keeps slow: the S laws don't stop in it.
#[test]
fn many_short_lines_run_nearly_as_fast_as_under_the_linear_law() {
    let pieces = [(Piece::Run(50, 3, 800), 5000)];
    let ticks = [SpeedLaw::Linear, SpeedLaw::Sine, SpeedLaw::Parabolic].map(|law| {
        let machine = machine(law);
        run(machine, blocks(&machine, &pieces), &[]).ticks()
    });
    println!("40 mm in lines of 50 um: {ticks:?} ms linear, sine, parabolic");
    let [linear, sine, parabolic] = ticks;
    assert!(sine <= linear * 125 / 100 && parabolic <= linear * 120 / 100, "{ticks:?}");
}

#[test]
fn the_law_changes_at_standstill_only() {
    let linear = machine(SpeedLaw::Linear);
    let mut channel = Channel::<72>::new(&linear, interp_core::units::Lattice::default());
    let works = blocks(&linear, &[(Piece::Line(0, 2_000), 3000)]);
    let mut given = works.iter().map(|work| Block { line: 1, work: *work });
    channel.start();
    for _ in 0..20 {
        channel.tick(&mut || given.next(), &mut |_: Event| {});
    }
    assert!(!channel.configure(&machine(SpeedLaw::Sine)));
    while channel.tick(&mut || given.next(), &mut |_: Event| {}).state != State::Ended {}
    assert!(channel.configure(&machine(SpeedLaw::Sine)));
    assert_eq!(run(linear, works, &[]).machine.smoothing.ticks(), 0);
}
