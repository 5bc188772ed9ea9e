//! Slides: backlash and pitch error, and what a scale reads.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    dead_code,
    unreachable_pub,
    missing_docs,
    reason = "tests, and helpers of tests, which may panic"
)]

mod common;

use std::f64::consts::TAU;

use common::{machine, play, ramp};
use interp_core::units::Axis;

/// A slow move of Z by whole millimetres from where it is.
fn go(machine: &mut machine::Machine, mm: f64) {
    play(machine, Axis::Z, mm > 0.0, ramp(mm.abs(), 2500.0, 300.0, 10.0, 300.0).into_iter());
}

fn z(machine: &machine::Machine) -> f64 {
    machine.axis(Axis::Z).at()
}

#[test]
fn backlash_is_a_loop_that_closes() {
    let mut machine = machine(&[("slide.z.backlash_um", "30")]);
    let mut corners = Vec::new();
    for _ in 0..3 {
        for mm in [2.0, -2.0] {
            go(&mut machine, mm);
            corners.push(z(&machine));
        }
    }
    // plus ends where the nut is, minus 30 um farther in plus
    for (at, corner) in corners.iter().enumerate() {
        let expected = if at % 2 == 0 { 2_000_000.0 } else { 30_000.0 };
        assert!((corner - expected).abs() < 1e-3, "{corners:?}");
    }
}

#[test]
fn a_reversal_takes_up_the_play_before_the_slide_moves() {
    let mut machine = machine(&[("slide.z.backlash_um", "30")]);
    go(&mut machine, 1.0);
    // 12 pulses of 2.5 um are the play; the next one moves
    play(&mut machine, Axis::Z, false, (0..12).map(|n| f64::from(n) * 1e-3));
    assert!((z(&machine) - 1e6).abs() < 1e-3);
    play(&mut machine, Axis::Z, false, (0..1).map(f64::from));
    assert!((z(&machine) - 997_500.0).abs() < 1e-3);
    play(&mut machine, Axis::Z, true, (0..12).map(|n| f64::from(n) * 1e-3));
    assert!((z(&machine) - 997_500.0).abs() < 1e-3);
}

#[test]
fn pitch_error_belongs_to_the_position_whichever_way_it_is_reached() {
    let mut machine = machine(&[("screw.z.periodic_um", "4"), ("screw.z.error", "0:0;10:20;30:-10")]);
    let mut seen = std::collections::BTreeMap::new();
    for mm in [1.0, 1.0, 1.0, 4.0, 5.0, -3.0, -2.0, -4.0, -1.0, -1.0] {
        go(&mut machine, mm);
        let at = machine.axis(Axis::Z).at();
        let nominal = (at / 1e6).round();
        let table = if nominal <= 10.0 { 2.0 * nominal } else { 20.0 - 1.5 * (nominal - 10.0) };
        let expected = nominal * 1e6 + 4_000.0 * (TAU * nominal / 5.0).sin() + table * 1e3;
        assert!((at - expected).abs() < 1.0, "{nominal}: {at} {expected}");
        let first = *seen.entry(nominal as i64).or_insert(at);
        assert!((first - at).abs() < 1e-3);
    }
    assert!(seen.len() < 10, "no place was reached twice");
}

#[test]
fn a_scale_reads_the_slide_and_not_the_screw() {
    let set = [
        ("scale.z.fitted", "true"),
        ("scale.z.error_nm", "0"),
        ("scale.z.resolution_nm", "5000"),
        ("slide.z.backlash_um", "30"),
    ];
    let mut machine = machine(&set);
    assert_eq!(machine.scale_nm(Axis::X), None);
    go(&mut machine, 2.0);
    go(&mut machine, -1.0);
    assert!((machine.scale_nm(Axis::Z).unwrap() - 1_030_000.0).abs() < 1e-6);
    play(&mut machine, Axis::Z, false, (0..1).map(f64::from));
    // 1.0275 mm, shown to 5 um
    let shown = machine.scale_nm(Axis::Z).unwrap();
    assert!((shown / 5000.0 - (shown / 5000.0).round()).abs() < 1e-9 && (shown - 1_027_500.0).abs() <= 2_500.0);
}

#[test]
fn a_scale_shows_the_nearest_of_its_steps() {
    let set = [("scale.x.fitted", "true"), ("scale.x.error_nm", "0"), ("scale.x.resolution_nm", "500")];
    let scale = machine::Scale::new(&common::figures(&set), Axis::X).unwrap().unwrap();
    for nm in -3_000..3_000 {
        let shown = scale.reading(f64::from(nm));
        assert!((shown - f64::from(nm)).abs() <= 250.0 && (shown / 500.0).fract().abs() <= 0.0, "{nm}: {shown}");
    }
}

#[test]
fn the_error_of_a_scale_repeats_each_period() {
    let figures = common::figures(&[("scale.x.fitted", "true"), ("scale.x.resolution_nm", "1")]);
    let scale = machine::Scale::new(&figures, Axis::X).unwrap().unwrap();
    let mut greatest = 0.0_f64;
    for nm in 0..20_000 {
        let error = scale.reading(f64::from(nm)) - f64::from(nm);
        let later = scale.reading(f64::from(nm) + 60_000.0) - f64::from(nm) - 60_000.0;
        assert!((error - later).abs() <= 1.0);
        greatest = greatest.max(error.abs());
    }
    assert!((199.0..=201.0).contains(&greatest), "{greatest}");
}
