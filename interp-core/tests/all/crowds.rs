//! Steps that come in a crowd, all at one clock: every tick still adds up, and every step is made.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::arithmetic_side_effects, reason = "a test")]

use interp_core::config::{AxisConfig, Config, Machine, TICK_CLOCKS};
use interp_core::shaper::Shaper;
use interp_core::train::Event;
use interp_core::units::{Axis, Feedrate, PulseSize};
use proptest::prelude::*;

fn machine(event_min_ns: u32) -> Machine {
    let axis = AxisConfig {
        pulse: PulseSize::ONE_MICROMETRE,
        max_feed: Feedrate::from_nm_per_min(600_000_000).unwrap(),
        max_accel: 500_000,
        max_jump: 1000,
        pulse_width_ns: 5000,
        dir_setup_ns: 5000,
        dir_hold_ns: 10_000,
        min_space_ns: 5000,
    };
    Config { x: axis, z: axis, event_min_ns }.check().unwrap()
}

proptest! {
    #[test]
    fn ticks_add_up_and_no_step_is_lost(
        crowds in prop::collection::vec((11_700_u32..12_000, prop::collection::vec((-1_i8..=1, -1_i8..=1), 0..5)), 1..8),
        event_min in prop_oneof![Just(2000_u32), Just(500)],
    ) {
        let mut shaper = Shaper::new(&machine(event_min));
        let (mut before, mut rises, mut wanted) = ([false; 2], [0_u32; 2], [0_u32; 2]);
        // an empty tick at the end lets the last pins fall
        for (clock, steps) in crowds.iter().cloned().chain([(0, Vec::new()), (0, Vec::new())]) {
            let mut events = Vec::new();
            let mut out = |event: Event| events.push(event);
            for (x, z) in steps {
                if (x, z) != (0, 0) {
                    shaper.step(clock, x, z, &mut out);
                    wanted = [wanted[0] + u32::from(x != 0), wanted[1] + u32::from(z != 0)];
                }
            }
            shaper.end_tick(&mut out);
            prop_assert_eq!(events.iter().map(|event| event.interval()).sum::<u32>(), TICK_CLOCKS);
            prop_assert!(events.iter().all(|event| event.interval() > 0));
            for event in events {
                let now = [event.levels().step(Axis::X), event.levels().step(Axis::Z)];
                for axis in 0..2 {
                    rises[axis] += u32::from(now[axis] && !before[axis]);
                }
                before = now;
            }
        }
        prop_assert_eq!(rises, wanted);
        prop_assert!(shaper.at_rest());
    }
}

/// What a path, hands and compensations of both axes bring at once at most, wherever near the tick's end.
#[test]
fn eleven_pulses_of_single_axes_have_room_behind_a_tick() {
    for (clock, event_min) in (11_700..12_000).flat_map(|clock| [(clock, 500), (clock, 5000)]) {
        let mut shaper = Shaper::new(&machine(event_min));
        let (mut rises, mut before) = (0, [false; 2]);
        for tick in 0..3 {
            let mut events = Vec::new();
            let mut out = |event: Event| events.push(event);
            for number in 0..if tick == 1 { 11 } else { 0 } {
                let (x, z) = if number % 2 == 0 { (1, 0) } else { (0, 1) };
                shaper.step(clock, x, z, &mut out);
            }
            shaper.end_tick(&mut out);
            assert_eq!(events.iter().map(|event| event.interval()).sum::<u32>(), TICK_CLOCKS, "{clock}");
            for event in events {
                let now = [event.levels().step(Axis::X), event.levels().step(Axis::Z)];
                rises += (0..2).filter(|axis| now[*axis] && !before[*axis]).count();
                before = now;
            }
        }
        assert_eq!(rises, 11, "{clock}");
    }
}
