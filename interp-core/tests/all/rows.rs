//! A row of steps is made to the very events that single steps make, from any state of the pins.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::arithmetic_side_effects, reason = "a test")]

use interp_core::config::{AxisConfig, Config, Machine};
use interp_core::curve::Step;
use interp_core::curve::strides::{Strides, Turned, Turns};
use interp_core::shaper::Shaper;
use interp_core::times::{FRACTION, Times};
use interp_core::train::Event;
use interp_core::units::{Feedrate, PulseSize};
use proptest::prelude::*;

/// Steps of one tick, evenly spaced: when the first comes and how far they are apart, their kinds, which of them turn.
#[derive(Clone, Debug)]
struct Run {
    time: u32,
    spacing: u32,
    major_x: bool,
    signs: (i8, i8),
    turns: u128,
    count: u32,
}

fn run() -> impl Strategy<Value = Run> {
    let sign = || prop_oneof![Just(1_i8), Just(-1)];
    // many in a tick, or one whose successor comes in a later one
    let spacing = prop_oneof![8 => 20_u32 << FRACTION..2000 << FRACTION, 1 => 2000 << FRACTION..=u32::MAX];
    (0_u32..12_000, spacing, any::<bool>(), (sign(), sign()), any::<u128>(), any::<u16>()).prop_map(
        |(from, spacing, major_x, signs, turns, a)| {
            let time = from << FRACTION | u32::from(a);
            // as many as the tick holds
            let room = ((12_000_u32 << FRACTION) - 1).saturating_sub(time) / spacing;
            Run { time, spacing, major_x, signs, turns, count: room.min(127) + 1 }
        },
    )
}

fn machine(width: [u32; 2], space: u32, event_min: u32) -> Machine {
    let axis = |width| AxisConfig {
        pulse: PulseSize::ONE_MICROMETRE,
        max_feed: Feedrate::from_nm_per_min(600_000_000).unwrap(),
        max_accel: 500_000,
        max_jump: 1000,
        pulse_width_ns: width,
        dir_setup_ns: 5000,
        dir_hold_ns: 10_000,
        min_space_ns: space,
    };
    Config { x: axis(width[0]), z: axis(width[1]), event_min_ns: event_min }.check().unwrap()
}

/// The recurrence of a part of it.
struct Kinds<'r> {
    run: &'r Run,
    first: u32,
    asked: u32,
}

impl Turns for Kinds<'_> {
    fn turns(&mut self) -> bool {
        self.asked += 1;
        self.run.turns(self.asked - 1)
    }

    fn turned(&self, steps: u32) -> Turned {
        assert_eq!(self.asked, self.first + steps);
        let diagonal = || (0..steps).filter(|n| self.run.turns(self.first + n));
        Turned { count: u32::try_from(diagonal().count()).unwrap(), last: diagonal().next_back().unwrap_or(77) }
    }
}

impl Run {
    fn kinds(&self) -> [Step; 2] {
        let (x, z) = self.signs;
        [if self.major_x { Step { x, z: 0 } } else { Step { x: 0, z } }, Step { x, z }]
    }

    fn turns(&self, n: u32) -> bool {
        self.turns >> n & 1 != 0
    }

    /// Step by step.
    fn singly(&self, shaper: &mut Shaper, out: &mut impl FnMut(Event)) {
        let mut times = Times { time: self.time, spacing: self.spacing };
        let [straight, diagonal] = self.kinds();
        let strides = Strides::new(straight, diagonal);
        for n in 0..self.count {
            shaper.face(&strides, times.clock(), out);
            let step = self.kinds()[usize::from(self.turns(n))];
            shaper.step(times.take(), step.x, step.z, out);
        }
        shaper.end_tick(out);
    }

    /// In rows as far as they go; gives the steps made so.
    fn in_rows(&self, shaper: &mut Shaper, singly: bool, out: &mut impl FnMut(Event)) -> u32 {
        let mut times = Times { time: self.time, spacing: self.spacing };
        let [straight, diagonal] = self.kinds();
        let strides = Strides::new(straight, diagonal);
        let (mut n, mut rows) = (0, 0);
        while n < self.count {
            let mut row = Kinds { run: self, first: n, asked: n };
            let made = shaper.run(&mut times, self.count - n, &strides, &mut row, singly, out);
            let asked = row.asked;
            assert_eq!(asked, n + made.steps);
            assert_eq!(made.diagonals, (n..asked).map(|n| u32::from(self.turns(n))).sum());
            (n, rows) = (asked, rows + made.steps);
            assert!(made.steps > 0 || !singly);
            if made.steps == 0 {
                let step = self.kinds()[usize::from(self.turns(n))];
                shaper.step(times.take(), step.x, step.z, out);
                n += 1;
            }
        }
        shaper.end_tick(out);
        rows
    }
}

proptest! {
    #[test]
    fn rows_make_the_events_of_single_steps(
        ticks in prop::collection::vec(run(), 1..6),
        widths in prop_oneof![Just([5000, 5000]), Just([1000, 1000]), Just([5000, 4000]), Just([1000, 9000])],
        space in prop_oneof![Just(5000_u32), Just(1000), Just(12_000)],
        event_min in prop_oneof![Just(2000_u32), Just(500), Just(7000)],
        singly: bool,
    ) {
        let machine = machine(widths, space, event_min);
        let (mut single, mut rows) = (Shaper::new(&machine), Shaper::new(&machine));
        for tick in &ticks {
            let (mut one, mut other) = (Vec::new(), Vec::new());
            tick.singly(&mut single, &mut |event: Event| one.push(event));
            tick.in_rows(&mut rows, singly, &mut |event: Event| other.push(event));
            prop_assert_eq!(&one, &other);
            prop_assert_eq!(&single, &rows);
        }
    }
}

/// The row is the usual way: of steps spread over a tick all but the outermost are in one.
#[test]
fn steps_inside_a_tick_come_in_rows() {
    let machine = machine([5000, 5000], 5000, 2000);
    let run =
        Run { time: 100 << FRACTION, spacing: 150 << FRACTION, major_x: true, signs: (1, 1), turns: 0x5A5A, count: 79 };
    let mut shaper = Shaper::new(&machine);
    // the first tick turns the directions
    run.in_rows(&mut shaper, false, &mut |_: Event| {});
    assert_eq!(run.in_rows(&mut shaper, false, &mut |_: Event| {}), 79);
}
