//! Rows between pulses that are added, or owed on either axis, make the very events of single steps.

extern crate std;

use super::*;
use crate::config::{AxisConfig, Config, Machine};
use crate::curve::strides::{Turned, Turns};
use crate::train::{Event, Train};
use crate::units::{Feedrate, PulseSize};
use proptest::prelude::*;
use std::vec::Vec;

/// What is made in a tick: steps evenly spaced, their kinds, which of them are diagonal, and the pulses added.
#[derive(Clone, Debug)]
struct Tick {
    times: Times,
    major: Axis,
    signs: (i8, i8),
    turns: u128,
    count: u32,
    added: (i32, i32),
}

fn tick() -> impl Strategy<Value = Tick> {
    let sign = || prop_oneof![4 => Just(1_i8), 1 => Just(-1)];
    let added = || prop_oneof![3 => Just(0), 2 => -2..=2_i32, 1 => -12..=12_i32];
    // none, few, and many diagonal ones
    let turns = (any::<[u128; 3]>(), 0..4_u8).prop_map(|([a, b, c], kind)| match kind {
        0 => 0,
        1 => a & b & c,
        2 => a | b,
        _ => a,
    });
    let times = (0_u32..6_000 << FRACTION, 120_u32 << FRACTION..900 << FRACTION);
    (times, any::<bool>(), (sign(), sign()), turns, (added(), added())).prop_map(
        |((time, spacing), x, signs, turns, added)| {
            let count = ((TICK_CLOCKS << FRACTION) - 1 - time) / spacing + 1;
            let major = if x { Axis::X } else { Axis::Z };
            Tick { times: Times { time, spacing }, major, signs, turns, count, added }
        },
    )
}

fn machine() -> Machine {
    let axis = || AxisConfig {
        pulse: PulseSize::ONE_MICROMETRE,
        max_feed: Feedrate::from_nm_per_min(600_000_000).unwrap(),
        max_accel: 500_000,
        max_jump: 1000,
        pulse_width_ns: 2_000,
        dir_setup_ns: 3_000,
        dir_hold_ns: 4_000,
        min_space_ns: 2_000,
    };
    Config { x: axis(), z: axis(), event_min_ns: 1_000 }.check().unwrap()
}

/// The recurrence, so many steps asked.
#[derive(Clone)]
struct Kinds<'t> {
    tick: &'t Tick,
    first: u32,
    asked: u32,
}

impl Turns for Kinds<'_> {
    fn turns(&mut self) -> bool {
        self.asked += 1;
        self.tick.turns >> (self.asked - 1) & 1 != 0
    }

    fn turned(&self, steps: u32) -> Turned {
        let diagonal = || (0..steps).filter(|n| self.tick.turns >> (self.first + n) & 1 != 0);
        Turned { count: u32::try_from(diagonal().count()).unwrap(), last: diagonal().next_back().unwrap_or(77) }
    }
}

/// Events and what was told of added pulses.
#[derive(Debug, Default, PartialEq)]
struct Log(Vec<Event>, Vec<(i32, Step, Step)>);

impl Train for Log {
    fn put(&mut self, event: Event) {
        self.0.push(event);
    }

    fn superposed(&mut self, clock: i32, program: Step, made: Step) {
        self.1.push((clock, program, made));
    }
}

impl Log {
    /// Directions of an axis's pulses, and when they begin.
    fn pulses(&self, axis: Axis) -> (Vec<bool>, Vec<u32>) {
        let (mut clock, mut high, mut pulses) = (0, false, (Vec::new(), Vec::new()));
        for event in &self.0 {
            let levels = event.levels();
            if levels.step(axis) && !high {
                pulses.0.push(levels.plus(axis));
                pulses.1.push(clock);
            }
            (clock, high) = (clock + event.interval(), levels.step(axis));
        }
        pulses
    }
}

/// One side of the comparison.
struct Side {
    shaper: Shaper,
    superposed: Superposed,
    log: Log,
    /// Steps made in rows, and those of them while a pulse of the other axis was owed.
    in_rows: (u32, u32),
}

/// Clocks that a pulse is later at most: a change of direction and three pulses.
const LATER: u32 = 48 + 3 * 48;

impl Side {
    fn new() -> Self {
        Self { shaper: Shaper::new(&machine()), superposed: Superposed::new(), log: Log::default(), in_rows: (0, 0) }
    }

    /// Makes a tick; `most` steps in a row at most, 0 for none.
    fn tick(&mut self, tick: &Tick, most: u32) {
        let Self { shaper, superposed, log, in_rows } = self;
        let (x, z) = tick.signs;
        let straight = if tick.major == Axis::X { Step { x, z: 0 } } else { Step { x: 0, z } };
        let (strides, mut times, mut made) = (Strides::new(straight, Step { x, z }), tick.times, 0);
        superposed.begin(tick.added.0, tick.added.1);
        while made < tick.count {
            let mut row = Kinds { tick, first: made, asked: made };
            // behind what is due before it a row sets the directions that it needs, as long as nothing is owed nor added
            // against them
            if most == 0 {
                superposed.until(times.time >> FRACTION, shaper, log);
                let (all, diagonal) = (!superposed.opposes(&strides, shaper), tick.turns >> made & 1 != 0);
                let along = if all { strides } else { strides.straight() };
                if !superposed.waits() && !superposed.opposes(&along, shaper) && (all || !diagonal) {
                    shaper.face(&along, times.clock(), log);
                }
            }
            let (room, along) = if most > 0 {
                let straight = |most: u32| (0..most).find(|n| tick.turns >> (made + n) & 1 != 0).unwrap_or(most);
                superposed.room(&times, (tick.count - made).min(most), &strides, straight, shaper, log)
            } else {
                (0, strides)
            };
            let owed = u32::from(superposed.waits());
            let steps = if room > 0 { shaper.run(&mut times, room, &along, &mut row, false, log).steps } else { 0 };
            *in_rows = (in_rows.0 + steps, in_rows.1 + steps * owed);
            if steps == 0 {
                let step = if row.turns() { Step { x, z } } else { straight };
                superposed.step(times.take(), step, shaper, log);
            }
            made += steps.max(1);
        }
        superposed.end(true, shaper, log);
        shaper.end_tick(log);
    }
}

proptest! {
    /// A row's pulses fall by themselves, so an added one that is due meanwhile, and a change of direction, comes behind the
    /// fall: somewhat later than among single steps. Otherwise each motor makes the same pulses.
    #[test]
    fn rows_among_added_pulses_are_single_steps(ticks in prop::collection::vec(tick(), 1..5), most in 1_u32..100) {
        let (mut single, mut rows) = (Side::new(), Side::new());
        for tick in &ticks {
            single.tick(tick, 0);
            rows.tick(tick, most);
            prop_assert_eq!(&single.superposed, &rows.superposed);
        }
        // what a crowd at a tick's end has put off
        for side in [&mut single, &mut rows] {
            side.superposed.end(false, &mut side.shaper, &mut side.log);
            side.shaper.end_tick(&mut side.log);
        }
        for axis in [Axis::X, Axis::Z] {
            let (one, other) = (single.log.pulses(axis), rows.log.pulses(axis));
            prop_assert_eq!(one.0, other.0);
            prop_assert!(one.1.iter().zip(&other.1).all(|(one, other)| one.abs_diff(*other) <= LATER));
        }
    }

    /// How long rows are is nothing to the train, wherever pulses are added.
    #[test]
    fn rows_among_added_pulses_are_rows_of_one(ticks in prop::collection::vec(tick(), 1..8), most in 2_u32..100) {
        let (mut ones, mut rows) = (Side::new(), Side::new());
        for (number, tick) in ticks.iter().enumerate() {
            ones.tick(tick, 1);
            rows.tick(tick, most);
            prop_assert_eq!(&ones.log, &rows.log, "tick {}", number);
            prop_assert_eq!((&ones.shaper, &ones.superposed), (&rows.shaper, &rows.superposed));
        }
    }
}

/// A pulse against the minor axis, owed until that moves: what the major one makes until then is in rows, on either axis.
#[test]
fn an_owed_pulse_does_not_break_the_other_axis_s_rows() {
    for (major, added) in [(Axis::X, (0, -1)), (Axis::Z, (-1, 0))] {
        let times = Times { time: 500 << FRACTION, spacing: 140 << FRACTION };
        let mut tick = Tick { times, major, signs: (1, 1), turns: 1, count: 80, added: (0, 0) };
        let mut side = Side::new();
        // turns the directions
        side.tick(&tick, 100);
        (tick.turns, tick.added) = (0, added);
        side.in_rows = (0, 0);
        side.tick(&tick, 100);
        assert!(side.superposed.waits());
        tick.added = (0, 0);
        side.tick(&tick, 100);
        // due in the middle of a tick of 80 steps
        assert_eq!(side.in_rows, (160, 120), "{major:?}");
        // the first that moves the axis cancels it, the rest are one row
        tick.turns = 1 << 30;
        side.tick(&tick, 100);
        assert_eq!(side.in_rows, (239, 150), "{major:?}");
        assert!(!side.superposed.waits());
    }
}

/// A hand outruns a path that moves its axis the other way now and then, between any two of its pulses: the path's pulses
/// are cancelled, and the axis never turns round.
#[test]
fn a_path_against_a_faster_hand_does_not_turn_its_axis_round() {
    let times = Times { time: 297 << FRACTION, spacing: 1_000 << FRACTION };
    for (major, added) in [(Axis::X, (0, -10)), (Axis::Z, (-10, 0))] {
        let axis = if major == Axis::X { Axis::Z } else { Axis::X };
        for turns in [1 << 2, 1 << 9, 1 << 2 | 1 << 9, 1 << 5 | 1 << 6] {
            let mut side = Side::new();
            for _ in 0..20 {
                let tick = Tick { times, major, signs: (1, 1), turns, count: 12, added };
                side.tick(&tick, 100);
            }
            let pluses = side.log.0.iter().filter(|event| event.levels().plus(axis)).count();
            let [wanted, made] = [20 * (10 - turns.count_ones() as usize), side.log.pulses(axis).0.len()];
            assert!(pluses == 0 && made.abs_diff(wanted) <= 1, "{major:?} {turns}: {pluses} {made}");
        }
    }
}
