//! Whatever figures pass the check, the pins keep up with the fastest line: no tick lags more and more behind.
#![allow(clippy::unwrap_used, clippy::arithmetic_side_effects, reason = "a test")]

use interp_core::config::{AxisConfig, Config, TICK_CLOCKS};
use interp_core::shaper::Shaper;
use interp_core::train::Event;
use interp_core::units::{Feedrate, PulseSize};
use proptest::prelude::*;

/// The most clocks that a train may run past a tick: a pulse and its waits.
fn lag(config: &Config, hz: u64) -> i32 {
    let machine = config.check().unwrap();
    let mut shaper = Shaper::new(&machine);
    let clocks_a_pulse = 12_000_000 / hz.max(1) + 1;
    let (mut due, mut most) = (0, 0);
    for tick in 0..100 {
        let end = (tick + 1) * u64::from(TICK_CLOCKS);
        while due < end {
            let clock = u32::try_from(due - tick * u64::from(TICK_CLOCKS)).unwrap();
            shaper.step(clock, 1, 1, &mut |_: Event| {});
            due += clocks_a_pulse;
        }
        shaper.end_tick(&mut |_: Event| {});
        most = most.max(shaper.ahead() + i32::try_from(TICK_CLOCKS).unwrap());
    }
    most
}

proptest! {
    #[test]
    fn the_fastest_line_never_lags_behind(
        widths in (100_u32..200_000, 100_u32..200_000), spaces in (100_u32..200_000, 100_u32..200_000),
        event_min in prop_oneof![100_u32..50_000, Just(50_000), Just(2_000)], share in 1_u64..=10,
    ) {
        let axis = |width, space, feed| AxisConfig {
            pulse: PulseSize::ONE_MICROMETRE,
            max_feed: Feedrate::from_nm_per_min(feed).unwrap(),
            max_accel: 500_000,
            max_jump: 1000,
            pulse_width_ns: width,
            dir_setup_ns: 5000,
            dir_hold_ns: 10_000,
            min_space_ns: space,
        };
        let config = |feed| Config {
            x: axis(widths.0, spaces.0, feed), z: axis(widths.1, spaces.1, feed), event_min_ns: event_min,
        };
        // the fastest feed that passes, or a tenth of it and more
        let (mut least, mut most) = (60_000_u64, 30_000_000_000_u64);
        prop_assume!(config(least).check().is_ok());
        while most - least > 60_000 {
            let middle = least.midpoint(most);
            if config(middle).check().is_ok() { least = middle } else { most = middle }
        }
        let hz = (least / 60_000 * share / 10).max(1);
        let lag = lag(&config(least), hz);
        prop_assert!(lag < 12_000, "{hz} pulses a second, {lag} clocks");
    }
}
