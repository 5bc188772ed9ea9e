//! The follower keeps its limits whatever it is asked, and lands exactly, as fast as they allow.
#![allow(
    clippy::unwrap_used,
    clippy::arithmetic_side_effects,
    clippy::cast_precision_loss,
    missing_docs,
    reason = "a test"
)]

use interp_core::channel::follower::{Follower, Pace};
use interp_core::compensation::PULSE;
use proptest::prelude::*;

fn paces() -> impl Strategy<Value = Pace> {
    // up to 256 pulses a tick squared; above, a speed of more than a thousand pulses a tick is cut off
    let accel = prop_oneof![1_i64..100, 1000_i64..1 << 28];
    let speed = prop_oneof![1_i64..1000, 1_i64 << 16..1 << 30];
    (speed, accel).prop_map(|(speed, accel)| Pace { speed, accel })
}

proptest! {
    #[test]
    fn limits_hold_whatever_is_asked_and_no_pulse_is_lost(
        pace in paces(), targets in prop::collection::vec((-(1_i64 << 41)..1 << 41, 1_usize..300), 1..8),
    ) {
        let (mut follower, mut pulses, mut before, mut speed) = (Follower::new(), 0_i64, 0_i64, 0_i64);
        for (target, ticks) in targets {
            for _ in 0..ticks {
                pulses += i64::from(follower.follow(target, &pace));
                let now = follower.place() - before;
                prop_assert!(now.abs() <= pace.speed && (now - speed).abs() <= pace.accel);
                (before, speed) = (follower.place(), now);
            }
            // nearest, half upward
            prop_assert_eq!(pulses, (follower.place() + PULSE / 2).div_euclid(PULSE));
        }
    }

    #[test]
    fn it_lands_exactly_without_overshoot_in_the_least_time(
        pace in paces(), start in -(1_i64 << 40)..1 << 40, ticks in 1_f64..3000.0, minus: bool,
    ) {
        // a way that takes about so many ticks
        let (speed, accel) = (pace.speed as f64, pace.accel as f64);
        let most = (accel * ticks * ticks / 4.0).min(speed * ticks).min(1e12);
        #[expect(clippy::cast_possible_truncation, reason = "below 1e12")]
        let way = most as i64;
        let full = speed / accel;
        let least = if most < speed * full { 2.0 * (most / accel).sqrt() } else { most / speed + full };
        let target = if minus { start - way } else { start + way };
        let (mut follower, mut taken) = (Follower::at(start), 0);
        while !(follower.place() == target && follower.is_near(target, 1, &Pace { accel: 0, ..pace })) {
            let before = follower.place();
            follower.follow(target, &pace);
            let sign = if minus { -1 } else { 1 };
            let (moved, left) = (sign * (follower.place() - before), sign * (target - follower.place()));
            prop_assert!(moved >= 0 && left >= 0);
            taken += 1;
            prop_assert!(f64::from(taken) <= least * 1.02 + 4.0, "{taken} ticks, {least} are enough");
        }
        prop_assert_eq!(follower.follow(target, &pace), 0);
        prop_assert_eq!(follower.place(), target);
    }

    #[test]
    fn it_follows_an_even_motion_without_lag(pace in paces(), share in 0.0_f64..=1.0) {
        #[expect(clippy::cast_possible_truncation, reason = "a part of an i64")]
        let step = (pace.speed.min(pace.accel) as f64 * share) as i64;
        let mut follower = Follower::new();
        for tick in 1..1000 {
            follower.follow(step * tick, &pace);
            prop_assert_eq!(follower.place(), step * tick);
        }
    }
}
