//! Amounts of compensation against closed forms: tables, expansion, backlash.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::arithmetic_side_effects,
    clippy::cast_precision_loss,
    missing_docs,
    reason = "a test whose oracle is in f64"
)]

use interp_core::compensation::backlash::Backlash;
use interp_core::compensation::pitch::{POINTS, Pitch, PitchError, PitchTable};
use interp_core::compensation::thermal::{STEP, Thermal};
use interp_core::compensation::{FRACTION, PULSE};
use interp_core::units::{Length, PulseSize};
use proptest::prelude::*;

fn pulses(amount: i64) -> f64 {
    amount as f64 / PULSE as f64
}

fn length(nm: i64) -> Length {
    Length::from_nm(nm).unwrap()
}

/// The line between two points, constant beyond the ends; pulses of the motor.
fn straight(start: f64, spacing: f64, errors: &[i16], pulse: f64, position: i32) -> f64 {
    let place = (f64::from(position) * pulse - start) / spacing;
    let last = errors.len() - 1;
    let error = |point: usize| f64::from(errors[point]) * 100.0;
    let value = match place {
        before if before <= 0.0 => error(0),
        behind if behind >= last as f64 => error(last),
        within => {
            let point = within.floor();
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and 127")]
            let index = point as usize;
            error(index) + (error(index + 1) - error(index)) * (within - point)
        }
    };
    -value / pulse
}

fn pulse_sizes() -> impl Strategy<Value = PulseSize> {
    prop_oneof![
        Just(PulseSize::new(1250, 1).unwrap()),
        Just(PulseSize::new(15_875, 8).unwrap()),
        Just(PulseSize::new(10, 1).unwrap()),
        Just(PulseSize::new(1_000_000, 1).unwrap()),
        Just(PulseSize::new(50_000, 4_095).unwrap()),
    ]
}

proptest! {
    #[test]
    fn a_table_is_straight_between_its_points_and_constant_beyond(
        pulse in pulse_sizes(), start in -2_000_000_000_i64..2_000_000_000, spacing in 10_000_i64..=100_000_000,
        steps in prop::collection::vec(-1000_i64..=1000, 1..=POINTS), places in prop::collection::vec(-0.1_f64..1.1, 1..40),
    ) {
        // errors that change by less than half of the spacing
        let most = (spacing / 200 - 1).min(30_000);
        let errors: Vec<i16> = steps.iter().map(|step| i16::try_from(most * step / 2000).unwrap()).collect();
        let table = PitchTable::new(length(start), length(spacing), &errors).unwrap();
        let (size, mut pitch) = (f64::from(pulse.numerator()) / f64::from(pulse.denominator()), Pitch::new(pulse));
        pitch.set(&table);
        let span = spacing as f64 * (errors.len() as f64);
        for place in places {
            #[expect(clippy::cast_possible_truncation, reason = "below 2^31 pulses, or cut off")]
            let position = ((start as f64 + place * span) / size).clamp(-2.1e8, 2.1e8) as i32;
            let expected = straight(start as f64, spacing as f64, &errors, size, position);
            let found = pulses(pitch.at(position));
            prop_assert!((found - expected).abs() < 1e-3, "{position}: {found} {expected}");
        }
    }
}

#[test]
fn every_pulse_of_a_table_is_the_same_whichever_way_it_is_reached() {
    let pulse = PulseSize::new(15_875, 8).unwrap();
    let errors: Vec<i16> = (0..POINTS).map(|point| i16::try_from(point * point % 37).unwrap() - 18).collect();
    let table = PitchTable::new(length(-50_003), length(10_007), &errors).unwrap();
    let mut pitch = Pitch::new(pulse);
    pitch.set(&table);
    let up: Vec<i64> = (-100..800).map(|position| pitch.at(position)).collect();
    let down: Vec<i64> = (-100..800).rev().map(|position| pitch.at(position)).collect();
    assert!(up.iter().eq(down.iter().rev()));
    for (position, amount) in (-100..800).zip(&up) {
        let mut afresh = Pitch::new(pulse);
        afresh.set(&table);
        assert_eq!(afresh.at(position), *amount);
        let expected = straight(-50_003.0, 10_007.0, &errors, 15_875.0 / 8.0, position);
        assert!((pulses(*amount) - expected).abs() < 1e-3, "{position}");
    }
}

#[test]
fn tables_that_no_screw_has_are_refused() {
    let (start, spacing) = (length(0), length(1_000_000));
    assert_eq!(PitchTable::new(start, spacing, &[]), Err(PitchError::Empty));
    assert_eq!(PitchTable::new(start, spacing, &[0; POINTS + 1]), Err(PitchError::TooMany));
    assert!(PitchTable::new(start, spacing, &[0; POINTS]).is_ok());
    assert_eq!(PitchTable::new(start, length(9_999), &[0]), Err(PitchError::Spacing));
    assert_eq!(PitchTable::new(start, length(100_000_001), &[0]), Err(PitchError::Spacing));
    assert_eq!(PitchTable::new(start, spacing, &[0, 4999, 0, 5000]), Err(PitchError::Steep(2)));
    // the ends of the range: no overflow
    let (low, high) = (length(-2_100_000_000), length(100_000_000));
    let table = PitchTable::new(low, high, &[i16::MIN, i16::MAX, i16::MIN]).unwrap();
    for pulse in [PulseSize::new(10, 1).unwrap(), PulseSize::new(1 << 24, 4096).unwrap()] {
        let mut pitch = Pitch::new(pulse);
        pitch.set(&table);
        let size = f64::from(pulse.numerator()) / f64::from(pulse.denominator());
        for position in [i32::MIN, -210_000_000, -205_000_000, -200_000_001, -1, 0, i32::MAX] {
            let expected = straight(-2.1e9, 1e8, &[i16::MIN, i16::MAX, i16::MIN], size, position);
            assert!((pulses(pitch.at(position)) - expected).abs() < 1e-2, "{position}");
        }
    }
}

#[test]
fn backlash_is_the_travel_since_the_reversal_for_every_short_history() {
    let (play, distance) = (12_i64, 3_i32);
    // all 3^9 histories of -1, 0 and 1 pulse
    for history in 0..3_u32.pow(9) {
        let mut backlash = Backlash::new(play << FRACTION, distance);
        let (mut rest, mut at) = (history, 0_i32);
        // the lag of a hysteresis of this width behind the position: the classic play operator
        let mut centre = -distance;
        for _ in 0..9 {
            let step = i32::try_from(rest % 3).unwrap() - 1;
            rest /= 3;
            at += step;
            backlash.moved(step);
            centre = centre.clamp(at - distance, at);
            let taken = i64::from(at - centre);
            assert_eq!(backlash.amount(), ((taken - i64::from(distance)) * play / i64::from(distance)) << FRACTION);
        }
    }
}

#[test]
fn backlash_is_exact_at_both_ends_of_its_distance_however_it_divides() {
    for distance in 1..200 {
        for play in [0, 1, 7, 1000 * PULSE + 1] {
            let mut backlash = Backlash::new(play, distance);
            assert_eq!(backlash.amount(), 0);
            backlash.moved(i32::MIN);
            assert_eq!(backlash.amount(), -play);
            backlash.moved(i32::MAX);
            assert_eq!(backlash.amount(), 0);
        }
    }
}

proptest! {
    #[test]
    fn a_warm_screw_is_longer_from_its_origin_on(
        expansion in 0_u32..=100_000, warmer in -200_000_i32..=200_000, origin in -2_000_000_i32..2_000_000,
        position in -210_000_000_i32..=210_000_000,
    ) {
        let mut screw = Thermal::new(expansion, origin);
        screw.heat(warmer, true);
        let expected = -1e-12 * f64::from(expansion) * f64::from(warmer) * (f64::from(position) - f64::from(origin));
        // the ratio is held to 2^-36 and its factor to 7e-6
        let held = expected.abs() * 8e-6 + f64::from(position.abs() + origin.abs()) * 2e-11 + 1e-6;
        prop_assert!((pulses(screw.at(position)) - expected).abs() < held);
    }
}

#[test]
fn a_new_temperature_acts_by_a_micrometre_a_metre_a_second_and_wholly() {
    let mut screw = Thermal::new(11_500, 0);
    screw.heat(10_000, false);
    assert_eq!(screw.at(1_000_000), 0);
    for _ in 0..1000 {
        screw.tick();
    }
    let expected = 1000.0 * STEP as f64 / 2_f64.powi(36) * 1e6;
    assert!((expected - 0.93).abs() < 0.01);
    assert!((pulses(screw.at(1_000_000)) + expected).abs() < 1e-5);
    // 115 um a metre take two minutes
    for _ in 0..130_000 {
        screw.tick();
    }
    let mut at_once = Thermal::new(11_500, 0);
    at_once.heat(10_000, true);
    assert_eq!(screw.at(1_000_000), at_once.at(1_000_000));
}
