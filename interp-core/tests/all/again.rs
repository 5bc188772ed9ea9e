//! A path that goes on: after a hold, and where it was led back over.
#![allow(clippy::unwrap_used, clippy::arithmetic_side_effects, missing_docs, reason = "tests")]

use interp_core::block::{Block, Builder, Pace, Path, Work};
use interp_core::channel::{Channel, Report, State};
use interp_core::config::{AxisConfig, Config, Machine};
use interp_core::drive::wheel::Click;
use interp_core::drive::{Drive, Inputs};
use interp_core::law::SpeedLaw;
use interp_core::train::Event;
use interp_core::units::{Feedrate, Lattice, Length, Point, PulseSize};

/// Largest jerk, mm/s3.
const JERK: u32 = 50_000;

/// Ends of the program's lines, pulses of a micrometre: a run along Z, and so short ones along X that each takes but some ticks.
const ENDS: [(i32, i32); 6] = [(0, 2_000), (200, 2_000), (400, 2_000), (600, 2_000), (600, 2_300), (900, 2_300)];

fn machine(law: SpeedLaw) -> Machine {
    machine_jumping(law, 2_000)
}

fn machine_jumping(law: SpeedLaw, jump: u32) -> Machine {
    let axis = AxisConfig {
        pulse: PulseSize::new(1_000, 1).unwrap(),
        max_feed: Feedrate::from_nm_per_min(5_000_000_000).unwrap(),
        max_accel: 500_000,
        max_jump: jump,
        pulse_width_ns: 5_000,
        dir_setup_ns: 5_000,
        dir_hold_ns: 10_000,
        min_space_ns: 5_000,
    };
    let machine = Config { x: axis, z: axis, event_min_ns: 2_000 }.check().unwrap();
    machine.with_law(law, JERK).unwrap()
}

fn point((x_um, z_um): (i32, i32)) -> Point {
    Point { x: Length::from_um(x_um).unwrap(), z: Length::from_um(z_um).unwrap() }
}

fn feed(mm_min: u64) -> Pace {
    Pace::Feed(Feedrate::from_nm_per_min(mm_min * 1_000_000).unwrap())
}

/// The program; lines are counted from 1.
fn program(machine: &Machine) -> Vec<Block> {
    let mut builder = Builder::new(machine, point((0, 0)));
    let mut blocks = Vec::new();
    for (end, line) in ENDS.into_iter().zip(1..) {
        let motions = builder.motion(Path::Line, point(end), feed(1_500)).motions;
        blocks.extend(motions.iter().map(|motion| Block { line, work: Work::Motion(*motion) }));
    }
    blocks.push(Block { line: 7, work: Work::End });
    blocks
}

struct Bench {
    channel: Channel<16>,
    blocks: std::vec::IntoIter<Block>,
}

impl Bench {
    fn tick(&mut self, wheel: i16) -> Report {
        self.channel.read(&Inputs { spindle: None, wheel });
        let blocks = &mut self.blocks;
        self.channel.tick(&mut || blocks.next(), &mut |_: Event| {})
    }

    /// Advances until it stands in a state other than running; the advance of each tick, and in which line.
    fn run(&mut self) -> Vec<(u32, i64)> {
        let mut advance = Vec::new();
        loop {
            let report = self.tick(0);
            advance.push((report.line, i64::from(report.speed)));
            if !matches!(report.state, State::Running | State::Filling) {
                return advance;
            }
            assert!(advance.len() < 10_000, "does not end");
        }
    }

    /// In single block, at the end of the second line: back into the first by so many counts of a micrometre, forward by some, and
    /// in automatic again.
    fn led_back(law: SpeedLaw, counts: i16, forward: i16) -> Self {
        let machine = machine(law);
        let blocks = program(&machine).into_iter();
        let mut bench = Self { channel: Channel::new(&machine, Lattice::default()), blocks };
        bench.channel.set_single_block(true);
        assert!(bench.channel.start());
        bench.run();
        assert!(bench.channel.start());
        bench.run();
        assert_eq!(bench.channel.position(), Lattice { x: 200, z: 2_000 });
        bench.channel.set_drive(Drive::Wheel(Click::from_nm(4_000).unwrap())).unwrap();
        assert!(bench.channel.start());
        for tick in 0..2_000 {
            bench.tick(if tick < counts { -1 } else { 0 });
        }
        for tick in 0..2_000 {
            bench.tick(if tick < forward { 1 } else { 0 });
        }
        let back = i32::from(counts) - i32::from(forward) - 200;
        assert_eq!(bench.channel.position(), Lattice { x: 0, z: 2_000 - back });
        assert!(bench.channel.hold());
        bench.channel.set_drive(Drive::Time).unwrap();
        assert!(bench.channel.start());
        bench
    }
}

/// What is run again for a part stands at each line's end from that of the line begun last on, to the pulse. Under an S law its
/// jerk is that of the law from the first tick of the line begun last.
#[test]
fn a_path_led_back_goes_on_in_single_block() {
    for law in SpeedLaw::ALL {
        // some where a tick at the start-stop speed, 2 um, leads over the joint, and one at the joint
        for counts in [203, 204, 205, 206, 207, 208, 250, 251, 777, 1_300] {
            let forward = if counts == 250 { 50 } else { 0 };
            let mut bench = Bench::led_back(law, counts, forward);
            // to the end of the line that was begun last: nothing stands before that
            let mut again = bench.run();
            assert_eq!(bench.channel.position(), Lattice { x: 200, z: 2_000 }, "{law:?} {counts}");
            again.retain(|(line, _)| *line == 2);
            let mut runs = vec![again];
            for (end, line) in ENDS.into_iter().zip(1..).skip(2) {
                assert!(bench.channel.start());
                runs.push(bench.run());
                let (x, z) = end;
                assert_eq!(bench.channel.position(), Lattice { x, z }, "{law:?} {counts}: end of line {line}");
            }
            for run in runs.into_iter().filter(|_| law != SpeedLaw::Linear) {
                let advance: Vec<i64> =
                    [0; 3].into_iter().chain(run.iter().map(|(_, speed)| *speed)).chain([0; 3]).collect();
                let jerks = advance.windows(3).map(|w| (w[2] - 2 * w[1] + w[0]).abs());
                let jerk = jerks.max().unwrap() * 1000 / 4096;
                assert!(jerk <= i64::from(JERK) * 1_010, "{law:?} {counts}: {jerk} um/s3 in {advance:?}");
            }
            assert_eq!(bench.channel.state(), State::Ended);
        }
    }
}

/// A hold in a line and cycle start: the line is done to its end, and the next one waits.
#[test]
fn a_start_in_the_midst_of_a_line_lets_no_other_line_pass_in_single_block() {
    for law in SpeedLaw::ALL {
        for tick in (1..60).step_by(9) {
            let machine = machine(law);
            let blocks = program(&machine).into_iter();
            let mut bench = Bench { channel: Channel::new(&machine, Lattice::default()), blocks };
            bench.channel.set_single_block(true);
            assert!(bench.channel.start());
            while bench.tick(0).speed == 0 {}
            for _ in 0..tick {
                bench.tick(0);
            }
            assert!(bench.channel.hold());
            while bench.tick(0).speed != 0 {}
            assert!(bench.channel.position().z < 2_000);
            assert!(bench.channel.start());
            bench.run();
            assert_eq!(bench.channel.position(), Lattice { x: 0, z: 2_000 }, "{law:?} {tick}");
            assert_eq!(bench.channel.state(), State::Stopped);
        }
    }
}

/// Where a path that was led back stands for single block or a dwell, an axis that turns round there jumps to rest, and from rest: a
/// tick at least ends in standstill.
#[test]
fn a_path_led_back_stands_before_an_axis_turns_round() {
    let machine = machine_jumping(SpeedLaw::Linear, 10_000);
    // Z forth and back, some times, with a dwell in the middle
    let mut blocks = Vec::new();
    let mut builder = Builder::new(&machine, point((0, 0)));
    for (z, line) in [1_000, 0, 1_000, 0, 1_000].into_iter().zip(1..) {
        let motions = builder.motion(Path::Line, point((0, z)), feed(1_500)).motions;
        blocks.extend(motions.iter().map(|motion| Block { line, work: Work::Motion(*motion) }));
        if line == 2 {
            builder.standstill();
            blocks.push(Block { line, work: Work::Dwell(3) });
        }
    }
    for single in [false, true] {
        let mut bench =
            Bench { channel: Channel::new(&machine, Lattice::default()), blocks: blocks.clone().into_iter() };
        bench.channel.set_drive(Drive::Wheel(Click::from_nm(4_000).unwrap())).unwrap();
        assert!(bench.channel.start());
        for wheel in [10, -10] {
            for tick in 0..2_000 {
                bench.tick(if tick < 450 { wheel } else { 0 });
            }
        }
        assert!(bench.channel.position().z < 600);
        assert!(bench.channel.hold());
        bench.channel.set_drive(Drive::Time).unwrap();
        bench.channel.set_single_block(single);
        assert!(bench.channel.start());
        let (mut at, mut before, mut stood, mut turns) = (bench.channel.position().z, 0, true, 0);
        for _ in 0..2_000 {
            let report = bench.tick(0);
            let by = bench.channel.position().z - at;
            // 10 pulses a tick of jump, half a pulse of acceleration, and rounding
            let jumps = (by - before).abs() > 10 + 1 + 2;
            turns += i32::from(by * before < 0 || stood && by != 0);
            assert!(!jumps || stood, "single {single}: from {before} to {by} pulses a tick");
            stood = report.speed == 0;
            (at, before) = (at + by, if by == 0 { before } else { by });
        }
        assert!(turns >= 2, "{turns}");
    }
}

/// Single block, switched on in any tick: the tool stands at the first end of a line that there is way to brake before, and
/// keeps to the law's acceleration and jerk.
#[test]
fn single_block_that_comes_in_motion_stops_where_there_is_way_to_brake_in() {
    for law in [SpeedLaw::Sine, SpeedLaw::Parabolic] {
        let machine = machine(law);
        let mut builder = Builder::new(&machine, point((0, 0)));
        let mut blocks = Vec::new();
        for line in 1..=60 {
            let motions = builder.motion(Path::Line, point((0, 100 * line)), feed(5_000)).motions;
            blocks
                .extend(motions.iter().map(|motion| Block { line: line.unsigned_abs(), work: Work::Motion(*motion) }));
        }
        blocks.push(Block { line: 61, work: Work::End });
        for tick in 1..180 {
            let blocks = blocks.clone().into_iter();
            let mut bench = Bench { channel: Channel::new(&machine, Lattice::default()), blocks };
            assert!(bench.channel.start());
            let mut advance: Vec<i64> = vec![0; 3];
            advance.extend((0..tick).map(|_| i64::from(bench.tick(0).speed)));
            let mut held = Bench { channel: bench.channel.clone(), blocks: bench.blocks.clone() };
            bench.channel.set_single_block(true);
            advance.extend(bench.run().into_iter().map(|(_, speed)| speed));
            advance.extend([0; 3]);
            assert_eq!(bench.channel.state(), State::Stopped);
            let accel = advance.windows(2).map(|w| (w[1] - w[0]).abs()).max().unwrap() * 1000 / 4096;
            assert!(accel <= 500_000, "{law:?} {tick}: {accel} um/s2");
            let jerks = advance.windows(3).map(|w| (w[2] - 2 * w[1] + w[0]).abs());
            let jerk = jerks.max().unwrap() * 1000 / 4096;
            assert!(jerk <= i64::from(JERK) * 1_010, "{law:?} {tick}: {jerk} um/s3");
            // where a hold would have stopped it, and on to the end of the line
            assert!(held.channel.hold());
            while held.tick(0).speed != 0 {}
            let (stopped, held) = (bench.channel.position().z, held.channel.position().z);
            assert_eq!(stopped % 100, 0, "{law:?} {tick}");
            assert!((held..held + 105).contains(&stopped), "{law:?} {tick}: {stopped} where a hold stops at {held}");
        }
    }
}
