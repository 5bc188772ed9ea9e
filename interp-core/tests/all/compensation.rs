//! Compensation in the channel: the motor is at program + compensation, keeps its limits, and nothing drifts.
//!
//! The motor's position is read from the pins; the compensation is worked out in `f64`.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::arithmetic_side_effects,
    clippy::cast_precision_loss,
    missing_docs,
    reason = "a test whose oracle is in f64"
)]

use interp_core::block::{Block, Builder, Pace, Path, Work};
use interp_core::channel::{Channel, State};
use interp_core::compensation::pitch::PitchTable;
use interp_core::compensation::{Compensation, Config, Temperatures};
use interp_core::config::{AxisConfig, Config as MachineConfig, Machine, TICK_CLOCKS};
use interp_core::train::{Event, Levels};
use interp_core::units::{Axis, Feedrate, Lattice, Length, Point, PulseSize, Sense};
use proptest::prelude::*;

const AXES: [Axis; 2] = [Axis::X, Axis::Z];

/// Nanometres of a pulse of X and Z.
const PULSE: [f64; 2] = [1250.0, 2500.0];

/// mm/s2 and mm/s.
const ACCEL: f64 = 500.0;
const SPEED: f64 = 5000.0 / 60.0;

/// So small that it makes no pulse in a quarter of a second.
const JUMP_UM_S: u32 = 10;

fn bare() -> Machine {
    let axis = |nm| AxisConfig {
        pulse: PulseSize::new(nm, 1).unwrap(),
        max_feed: Feedrate::from_nm_per_min(5_000_000_000).unwrap(),
        max_accel: 500_000,
        max_jump: JUMP_UM_S,
        pulse_width_ns: 5_000,
        dir_setup_ns: 5_000,
        dir_hold_ns: 10_000,
        min_space_ns: 5_000,
    };
    MachineConfig { x: axis(1250), z: axis(2500), event_min_ns: 2_000 }.check().unwrap()
}

fn config(play_um: u32, distance_um: u32, thermal: u32) -> Config {
    Config {
        backlash_nm: play_um * 1000,
        backlash_distance_nm: distance_um * 1000,
        pitch: true,
        thermal,
        thermal_origin: Length::ZERO,
    }
}

/// A lathe, its pins read.
struct Lathe {
    channel: Channel<64>,
    builder: Builder,
    waiting: std::collections::VecDeque<Block>,
    levels: Levels,
    motor: [i32; 2],
    /// Changes of direction.
    turns: [u32; 2],
    /// Where the motor was at each tick's end.
    trace: Vec<[i32; 2]>,
    line: u32,
}

impl Lathe {
    fn new(machine: &Machine) -> Self {
        Self {
            channel: Channel::new(machine, Lattice::default()),
            builder: Builder::new(machine, Point::default()),
            waiting: std::collections::VecDeque::new(),
            levels: Levels::LOW,
            motor: [0; 2],
            turns: [0; 2],
            trace: Vec::new(),
            line: 0,
        }
    }

    fn go(&mut self, path: Path, x: i64, z: i64, pace: Pace) {
        self.line += 1;
        let end = Point { x: Length::from_nm(x).unwrap(), z: Length::from_nm(z).unwrap() };
        for motion in self.builder.motion(path, end, pace).motions {
            self.waiting.push_back(Block { line: self.line, work: Work::Motion(motion) });
        }
    }

    fn rapid(&mut self, x: i64, z: i64) {
        self.go(Path::Line, x, z, Pace::Rapid);
    }

    fn tick(&mut self) -> State {
        let (mut sum, waiting) = (0, &mut self.waiting);
        let (levels, motor, turns) = (&mut self.levels, &mut self.motor, &mut self.turns);
        let report = self.channel.tick(&mut || waiting.pop_front(), &mut |event: Event| {
            sum += event.interval();
            for ((place, turns), axis) in motor.iter_mut().zip(turns.iter_mut()).zip(AXES) {
                *turns += u32::from(event.levels().plus(axis) != levels.plus(axis));
                if event.levels().step(axis) && !levels.step(axis) {
                    *place += if event.levels().plus(axis) { 1 } else { -1 };
                }
            }
            *levels = event.levels();
        });
        assert_eq!(sum, TICK_CLOCKS);
        self.trace.push(self.motor);
        report.state
    }

    /// Runs what waits to its end.
    fn run(&mut self) {
        self.waiting.push_back(Block { line: self.line + 1, work: Work::End });
        assert!(self.channel.start());
        while self.tick() != State::Ended {}
        // the last pins fall
        self.tick();
    }

    fn program(&self) -> [i32; 2] {
        let at = self.channel.position();
        [at.x, at.z]
    }

    /// How far the motor is beyond the program.
    fn beyond(&self) -> [i32; 2] {
        let program = self.program();
        [self.motor[0] - program[0], self.motor[1] - program[1]]
    }

    /// Speed and acceleration of the motor over windows of 1, 2, 4 ... 256 ticks.
    fn assert_limits(&self, context: &str) {
        for (axis, pulse) in PULSE.iter().enumerate() {
            let at = |tick: usize| self.trace[tick][axis];
            let (v, a) = (SPEED * 1e3 / pulse, ACCEL / pulse);
            for h in (0..9).map(|n| 1_usize << n) {
                let ticks = h as f64;
                for first in 0..self.trace.len().saturating_sub(2 * h) {
                    let (one, two, three) = (at(first), at(first + h), at(first + 2 * h));
                    let (way, bend) = (f64::from((two - one).abs()), f64::from((one - 2 * two + three).abs()));
                    // what the lattice fakes: 1 and 4 for any minor axis and on arcs, 1 more with a pulse added
                    assert!(way <= v * ticks + 2.0, "{context}: axis {axis}, tick {first}, {h} ticks: {way} pulses");
                    let most = a * ticks * ticks + 5.0;
                    assert!(bend <= most, "{context}: axis {axis}, tick {first}, {h} ticks: {bend} of {most}");
                }
            }
        }
    }
}

/// The table of both axes: points from -50 mm on, each 5 mm, errors of up to 60 um.
const ERRORS: [i16; 21] =
    [-600, -520, -430, -470, -300, -210, -40, 0, 55, 120, 130, 80, -60, 10, 90, 220, 310, 290, 380, 470, 600];

fn error_nm(nm: f64) -> f64 {
    let place = ((nm + 50e6) / 5e6).clamp(0.0, 20.0);
    let point = place.floor().min(19.0);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 19")]
    let index = point as usize;
    let (one, next) = (f64::from(ERRORS[index]), f64::from(ERRORS[index + 1]));
    100.0 * (one + (next - one) * (place - point))
}

fn fitted(lathe: &mut Lathe) {
    let table =
        PitchTable::new(Length::from_nm(-50_000_000).unwrap(), Length::from_nm(5_000_000).unwrap(), &ERRORS).unwrap();
    for axis in AXES {
        assert!(lathe.channel.set_pitch_table(axis, &table));
    }
}

/// Random moves of up to `span` nm about the zero point.
fn places(moves: usize, span: i64, mut seed: u64) -> Vec<[i64; 2]> {
    let mut next = || {
        // splitmix64
        seed = seed.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = seed;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        i64::try_from((z ^ (z >> 31)) % (2 * span.unsigned_abs())).unwrap() - span
    };
    (0..moves).map(|_| [next(), next()]).collect()
}

/// How many moves: bounded, or a million and more in `cargo xtask soak`.
fn moves(bounded: usize) -> usize {
    if std::env::var_os("HANDCNC_CASES").is_some() { 1_000_000 } else { bounded }
}

#[test]
fn nothing_drifts_over_random_moves_and_home_is_home() {
    let warm = Temperatures { reference: 20_000, screws: 33_000 };
    let machine = bare().compensated(&config(23, 17, 11_500), &config(70, 40, 12_000), warm);
    let mut lathe = Lathe::new(&machine);
    fitted(&mut lathe);
    // to see each place at rest, cycles of 20 moves
    for group in places(moves(6_000), 300_000, 1).chunks(20) {
        lathe.trace.clear();
        for [x, z] in group {
            lathe.rapid(*x, *z);
        }
        // far enough in one direction that the side of the backlash is known
        let [x, z] = group.last().map_or([0; 2], |place| *place);
        let (to_x, to_z) =
            (x + if x % 2 == 0 { 40_000 } else { -40_000 }, z + if z % 2 == 0 { 90_000 } else { -90_000 });
        lathe.rapid(to_x, to_z);
        lathe.run();
        let program = lathe.program();
        for (axis, (from, to)) in [(x, to_x), (z, to_z)].into_iter().enumerate() {
            let (play, grows) = [(23_000.0, 11.5e-6 * 13.0), (70_000.0, 12e-6 * 13.0)][axis];
            let place = f64::from(program[axis]) * PULSE[axis];
            let behind = if to < from { play } else { 0.0 };
            let due = -(error_nm(place) - error_nm(0.0) + behind + grows * place) / PULSE[axis];
            let beyond = f64::from(lathe.beyond()[axis]);
            // what is given at the start and now are rounded
            assert!((beyond - due).abs() <= 1.01, "axis {axis} at {place} nm: {beyond} pulses, not {due}");
        }
        let given = AXES.map(|axis| lathe.channel.compensation(axis));
        let first = error_nm(0.0) / PULSE[0];
        assert!(first.abs() < 1e3 && given.iter().all(|pulses| pulses.abs() < 1000));
    }
    // home in plus: not a pulse beyond the program
    lathe.rapid(-100_000, -100_000);
    lathe.rapid(0, 0);
    lathe.run();
    assert_eq!((lathe.program(), lathe.beyond()), ([0; 2], [0; 2]));
}

/// The screw's error is that of the machine's own place, whatever the tool's place is called.
#[test]
fn a_pitch_table_stays_where_the_screw_is() {
    let due = |nm: f64| -error_nm(nm) / PULSE[1];
    let warm = Temperatures { reference: 20_000, screws: 33_000 };
    for (play, renamed) in [(0, 0), (0, 1), (20, 1), (20, 2)] {
        let machine = bare().compensated(&config(0, 5, 0), &config(play, 5, 12_000), warm);
        let mut lathe = Lathe::new(&machine);
        fitted(&mut lathe);
        lathe.rapid(0, 10_000_000);
        lathe.run();
        let given = lathe.channel.compensation(Axis::Z);
        match renamed {
            // a zero is set, an offset is kept
            1 => assert!(lathe.channel.set_position(Lattice { x: 0, z: 0 })),
            2 => lathe.channel.set_offset(Lattice { x: 0, z: -4_000 }),
            _ => {}
        }
        assert_eq!(lathe.channel.compensation(Axis::Z), given);
        let stands = lathe.motor;
        for _ in 0..20 {
            lathe.tick();
        }
        assert_eq!(lathe.motor, stands);
        let from = lathe.channel.position().z;
        let nm = |place: i32| Length::from_nm(i64::from(place) * 2_500).unwrap();
        lathe.builder = Builder::new(&machine, Point { x: Length::ZERO, z: nm(from) });
        // 7 mm on in plus, to 17 mm of the screw
        lathe.rapid(0, (i64::from(from) + 2_800) * 2_500);
        lathe.run();
        let more = f64::from(lathe.motor[1] - stands[1] - 2_800);
        let warmer = -12e-6 * 13.0 * 7e6 / PULSE[1];
        assert!((more - (due(17e6) - due(10e6) + warmer)).abs() <= 1.01, "{more} pulses, renamed {renamed}");
    }
}

/// Home tells where the screw is.
#[test]
fn a_pitch_table_follows_the_place_that_is_made_known() {
    let machine = bare().compensated(&config(0, 5, 0), &config(0, 5, 0), Temperatures::default());
    let mut lathe = Lathe::new(&machine);
    fitted(&mut lathe);
    // it stands 20 mm from home, and calls that nothing
    lathe.channel.stand_at(Axis::Z, 8_000);
    lathe.rapid(0, 10_000_000);
    lathe.run();
    let due = (error_nm(20e6) - error_nm(30e6)) / PULSE[1];
    assert!((f64::from(lathe.beyond()[1]) - due).abs() <= 1.01, "{:?} of {due}", lathe.beyond());
}

/// What compensates is made to its end though nothing else moves any more, and with no pulses made nothing is given.
#[test]
fn what_is_due_is_made_at_rest_and_nothing_while_the_pins_are_mute() {
    let machine = bare().compensated(&config(0, 5, 0), &config(200, 5, 0), Temperatures::default());
    let mut lathe = Lathe::new(&machine);
    assert!(lathe.channel.mute(true));
    lathe.rapid(0, -1_000_000);
    lathe.run();
    assert_eq!((lathe.motor, lathe.channel.compensation(Axis::Z)), ([0; 2], 0));
    assert!(lathe.channel.set_position(Lattice::default()) && lathe.channel.mute(false));
    lathe.builder = Builder::new(&machine, Point::default());
    lathe.rapid(0, -1_000_000);
    lathe.run();
    assert_eq!(lathe.motor[1], -400 - 80);
    assert!(!lathe.channel.owes());
}

/// An alarm has stopped it half-way: another acceleration of the axis makes it right no more than it was.
#[test]
fn what_is_due_stays_due_with_another_acceleration() {
    let plan = |accel: u32| {
        let mut machine = bare();
        machine.z.accel = accel;
        machine.compensated(&config(0, 5, 0), &config(200, 5, 0), Temperatures::default()).compensation
    };
    let (accel, tool) = (bare().z.accel, Lattice { x: 0, z: -100 });
    let mut compensation = Compensation::new(&plan(accel), Lattice::default());
    // faces minus, then turns round
    let ticks = |compensation: &mut Compensation, tool: Lattice, ticks: u32| {
        (0..ticks).map(|_| compensation.tick(tool, false).1).sum::<i32>()
    };
    let all = ticks(&mut compensation, tool, 500);
    let back = Lattice { x: 0, z: 100 };
    let part = ticks(&mut compensation, back, 12);
    assert!(part != 0 && all + part != 0, "{all} {part}");
    compensation.stop(back);
    let given = compensation.given(Axis::Z);
    compensation.configure(&plan(accel / 2), back);
    assert_eq!(compensation.given(Axis::Z), given);
    // given when the axis moves again
    let on = Lattice { x: 0, z: 101 };
    assert_eq!(all + part + ticks(&mut compensation, on, 2_000), compensation.given(Axis::Z));
    assert_eq!(compensation.given(Axis::Z), 0);
}

#[test]
fn the_motors_limits_hold_with_compensation_live() {
    let machine =
        bare().compensated(&config(23, 5, 0), &config(200, 40, 0), Temperatures { reference: 20_000, screws: 20_000 });
    for seed in 1..=3 {
        let mut lathe = Lathe::new(&machine);
        fitted(&mut lathe);
        // long moves at full speed, short ones that turn all the time, and an arc through all quadrants
        for [x, z] in places(20, 30_000_000, seed).into_iter().chain(places(100, 20_000, seed + 10)) {
            lathe.rapid(x, z);
        }
        lathe.rapid(0, 10_000_000);
        let feed = Pace::Feed(Feedrate::from_nm_per_min(3_000_000_000).unwrap());
        lathe.go(Path::Arc { centre: (0, 0), sense: Sense::Clockwise }, 0, 10_000_000, feed);
        lathe.go(Path::Arc { centre: (0, 7_000_000), sense: Sense::CounterClockwise }, 0, 10_000_000, feed);
        lathe.run();
        lathe.assert_limits(&format!("seed {seed}"));
    }
}

#[test]
fn the_program_is_that_of_a_machine_without_compensation() {
    // tables and backlash of nothing take their share of the limits, and add no pulse
    let nothing = Config { pitch: true, ..Config::default() };
    let (machine, reference) = (bare(), Temperatures::default());
    let mut without = Lathe::new(&machine.compensated(&nothing, &nothing, reference));
    let mut with = Lathe::new(&machine.compensated(&config(10, 5, 0), &config(30, 20, 0), reference));
    fitted(&mut with);
    for lathe in [&mut without, &mut with] {
        lathe.channel.start();
        for [x, z] in places(30, 500_000, 7) {
            lathe.rapid(x, z);
        }
        lathe.waiting.push_back(Block { line: 31, work: Work::End });
    }
    let (mut ticks, mut apart) = (0, 0);
    while without.tick() != State::Ended {
        let state = with.tick();
        assert_eq!(without.program(), with.program());
        apart = apart.max(with.beyond()[1].abs());
        ticks += i32::from(state == State::Running);
    }
    assert_eq!(without.beyond(), [0; 2]);
    assert!(apart > 10 && ticks > 100, "{apart} pulses, {ticks} ticks");
}

#[test]
fn an_axis_that_moves_on_never_turns_round_for_its_compensation() {
    // 20 mm in plus where the table falls and rises by up to 30 um in 5 mm, slowly and fast
    for feed in [50_000_000, 600_000_000, 3_000_000_000] {
        let table = Config { pitch: true, ..Config::default() };
        let mut lathe = Lathe::new(&bare().compensated(&table, &table, Temperatures::default()));
        fitted(&mut lathe);
        let span = if feed < 100_000_000 { 2_000_000 } else { 40_000_000 };
        lathe.go(Path::Line, 0, span, Pace::Feed(Feedrate::from_nm_per_min(feed).unwrap()));
        lathe.run();
        let turned = |pair: &[[i32; 2]]| pair[1][1] < pair[0][1];
        assert!(lathe.beyond()[1] != 0 && !lathe.trace.windows(2).any(turned), "at {feed}");
        assert_eq!(lathe.turns, [0, 1], "at {feed}");
    }
}

#[test]
fn no_quadrant_stops_while_backlash_is_taken_up() {
    let machine = bare().compensated(&config(20, 5, 0), &config(20, 5, 0), Temperatures::default());
    let plain = Config { pitch: true, ..Config::default() };
    let mut lathes = [machine, bare().compensated(&plain, &plain, Temperatures::default())].map(|machine| {
        let mut lathe = Lathe::new(&machine);
        lathe.rapid(0, 10_000_000);
        let feed = Pace::Feed(Feedrate::from_nm_per_min(200_000_000).unwrap());
        lathe.go(Path::Arc { centre: (0, 0), sense: Sense::Clockwise }, 0, 10_000_000, feed);
        lathe.run();
        lathe
    });
    let [with, without] = &mut lathes;
    // only at the end, which waits for the motor
    assert!(with.trace.len() - without.trace.len() < 100, "{} and {} ticks", with.trace.len(), without.trace.len());
    let most = with.trace.iter().zip(&without.trace).map(|(one, two)| (one[0] - two[0]).abs()).max();
    assert_eq!(most, Some(16));
}

#[test]
fn a_tick_without_compensation_makes_the_same_events_with_the_mechanism_there() {
    // a compensated axis that has nothing to give, against none: the same machine but for its share
    let slow = |machine: Machine| {
        let mut machine = machine;
        for axis in [&mut machine.x, &mut machine.z] {
            (axis.speed, axis.accel) = (axis.speed / 2, axis.accel / 2);
        }
        machine
    };
    let none = Config { pitch: true, ..Config::default() };
    let machine = bare().compensated(&none, &none, Temperatures::default());
    let mut bare = bare();
    (bare.x.speed, bare.x.accel, bare.z.speed, bare.z.accel) =
        (machine.x.speed, machine.x.accel, machine.z.speed, machine.z.accel);
    let trains = [slow(machine), slow(bare)].map(|machine| {
        let mut lathe = Lathe::new(&machine);
        for [x, z] in places(30, 500_000, 3) {
            lathe.rapid(x, z);
        }
        lathe.run();
        lathe.trace
    });
    assert_eq!(trains[0], trains[1]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(std::env::var("PROPTEST_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(24)))]
    #[test]
    fn holds_resets_and_emergencies_at_any_tick_lose_nothing(
        seed: u64, at in 1_usize..3000, what in 0..3, wait in 1_usize..500, play in 0_u32..300, distance in 0_u32..300,
    ) {
        let machine = bare().compensated(
            &config(play, distance, 11_500), &config(play / 2, distance, 0), Temperatures { reference: 0, screws: 5_000 },
        );
        let mut lathe = Lathe::new(&machine);
        fitted(&mut lathe);
        for [x, z] in places(20, 400_000, seed) {
            lathe.rapid(x, z);
        }
        lathe.waiting.push_back(Block { line: 1, work: Work::End });
        lathe.channel.start();
        for _ in 0..at {
            lathe.tick();
        }
        match what {
            0 => drop(lathe.channel.hold()),
            1 => lathe.channel.reset(),
            _ => lathe.channel.abandon(),
        }
        for _ in 0..wait {
            lathe.tick();
        }
        if what == 2 {
            // it stands at once, to the pulse
            let stands = lathe.motor;
            lathe.tick();
            prop_assert_eq!(lathe.motor, stands);
        }
        lathe.channel.start();
        lathe.waiting.clear();
        lathe.channel.reset();
        while lathe.channel.state() != State::Idle {
            lathe.tick();
        }
        // home, in plus
        let at = lathe.channel.position();
        let nm = |pulses: i32, pulse: i64| i64::from(pulses) * pulse;
        let from = Point { x: Length::from_nm(nm(at.x, 1250)).unwrap(), z: Length::from_nm(nm(at.z, 2500)).unwrap() };
        lathe.builder = Builder::new(&machine, from);
        lathe.rapid(-2_000_000, -2_000_000);
        lathe.rapid(0, 0);
        lathe.run();
        prop_assert_eq!((lathe.program(), lathe.beyond()), ([0; 2], [0; 2]));
    }
}
