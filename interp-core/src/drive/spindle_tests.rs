//! The observer against closed forms.

use super::*;

/// Largest error of the foretold angle, in counts, for an angle that is a function of the tick.
fn worst(angle: impl Fn(f64) -> f64) -> f64 {
    let (mut spindle, mut worst) = (Spindle::new(4096).unwrap(), 0.0_f64);
    for tick in 0..3_000_u32 {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the low bits")]
        let counts = angle(f64::from(tick)).floor() as i64 as u16;
        spindle.observe(Reading { counts, index: None });
        if tick > 300 {
            #[allow(clippy::cast_precision_loss, reason = "counts")]
            let foretold = spindle.foretold().angle as f64 / COUNT as f64 + angle(0.0).floor();
            worst = worst.max((foretold - angle(f64::from(tick) + 2.0)).abs());
        }
    }
    worst
}

#[test]
fn an_even_speed_is_foretold_within_a_count() {
    for speed in [-136.5, -3.3, 0.0, 0.013, 0.5, 2.05, 8.2, 68.27, 136.53] {
        let error = worst(|tick| 0.37 + speed * tick);
        assert!(error < 0.9, "{speed} counts a tick: {error}");
    }
}

#[test]
fn an_even_acceleration_leaves_no_error() {
    let error = worst(|tick| 20.0 + 1e-2 * tick * tick);
    assert!(error < 0.9, "{error}");
}

/// 20 % at 2 Hz of 2000 turns a minute, where the jerk is 0.0043 counts a tick^3.
#[test]
fn a_wobble_is_foretold_within_two_counts() {
    let omega = core::f64::consts::TAU * 2e-3;
    let error = worst(|tick| 136.5 * tick - 136.5 * 0.2 / omega * f64::cos(omega * tick) + 3_000.0);
    assert!(error > 0.8 && error < 2.0, "{error}");
}

#[test]
fn the_index_is_checked_in_whole_turns() {
    let mut spindle = Spindle::new(4096).unwrap();
    let mut at = 0_u16;
    let mut pass = |counts: u16, off: u16| {
        at = at.wrapping_add(counts);
        spindle.observe(Reading { counts: at, index: Some(at.wrapping_sub(off)) });
        spindle.lost()
    };
    assert_eq!(pass(100, 0), None);
    assert_eq!(pass(4096, 0), None);
    assert_eq!(pass(4098, 0), None);
    assert_eq!(pass(4096, 2), None);
    assert_eq!(pass(4090, 0), Some(-4));
    assert_eq!(pass(4100, 0), None);
}
