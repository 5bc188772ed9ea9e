//! Figures that are refused, by name.
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

use figures::{Figures, Kind};
use machine::{Axes, Control, Machine, TABLES};

fn refused(set: &[(&str, &str)], words: &[&str]) {
    let mut figures = Figures::new(TABLES);
    for (name, text) in set {
        figures.set(name, text).unwrap();
    }
    let error = Machine::new(&figures, common::CONTROL).unwrap_err().to_string();
    for word in words {
        assert!(error.contains(word), "{error}");
    }
}

#[test]
fn contradicting_figures_are_refused_by_name() {
    refused(&[("motor.x.steps", "201")], &["motor.x.steps", "multiple of 4"]);
    refused(&[("driver.x.current_a", "4.2")], &["driver.x.current_a", "motor.x.rated_a", "3.960"]);
    refused(
        &[("motor.z.resistance_ohm", "20")],
        &["driver.z.supply_v", "driver.z.current_a", "motor.z.resistance_ohm"],
    );
    refused(&[("motor.z.detent_nm", "1.9")], &["motor.z.detent_nm", "motor.z.holding_nm"]);
    refused(&[("motor.x.pull_out", "0:2;500:1")], &["motor.x.pull_out", "2 Nm at 0 rpm", "motor.x.holding_nm"]);
    refused(&[("driver.x.microsteps", "16")], &["driver.x.microsteps", "1562.5 nm", "1250 nm", "20 would fit"]);
    refused(&[("screw.z.lead_mm", "4"), ("driver.z.microsteps", "10")], &["driver.z.microsteps", "8 would fit"]);
    refused(&[("slide.z.force_n", "50000")], &["slide.z.force_n", "it can't move the slide"]);
    refused(&[("screw.x.lead_mm", "0.5"), ("screw.x.periodic_um", "90")], &["screw.x.periodic_um", "screw.x.lead_mm"]);
    refused(&[("screw.x.error", "0:0;0.01:9")], &["screw.x.error", "9 um", "0.01 mm"]);
    refused(&[("scale.x.fitted", "true"), ("scale.x.resolution_nm", "6000")], &["scale.x.resolution_nm"]);
    refused(&[("scale.z.fitted", "true"), ("scale.z.error_nm", "6000")], &["scale.z.error_nm"]);
    refused(&[("spindle.load_nm", "7")], &["spindle.load_nm", "spindle.torque_nm"]);
    refused(&[("spindle.max_rpm", "1000")], &["spindle.base_rpm", "spindle.max_rpm"]);
}

#[test]
fn every_number_refuses_what_is_negative_too_small_too_large_or_no_number() {
    let mut figures = Figures::new(TABLES);
    let mut numbers = 0;
    for definition in TABLES.iter().copied().flatten() {
        let bounds = match definition.kind {
            Kind::Number { least, most } => (least, most),
            Kind::Whole { least, most } => (f64::from(least), f64::from(most)),
            Kind::Switch | Kind::Choice(_) | Kind::Pairs { .. } => continue,
        };
        numbers += 1;
        for text in ["NaN", "inf", "", "-1", &(bounds.1 * 2.0 + 1.0).to_string()] {
            let error = figures.set(definition.name, text).unwrap_err().to_string();
            assert!(error.starts_with(definition.name), "{error}");
        }
        if bounds.0 > 0.0 {
            assert!(figures.set(definition.name, "0").is_err(), "{}", definition.name);
        }
    }
    assert!(numbers > 60, "{numbers}");
}

#[test]
fn figures_of_both_axes_have_one_form_and_no_name_twice() {
    let names: Vec<&str> = TABLES.iter().copied().flatten().map(|definition| definition.name).collect();
    let mut sorted = names.clone();
    sorted.sort_unstable();
    sorted.dedup();
    assert_eq!(sorted.len(), names.len());
    for name in &names {
        if name.contains(".x.") {
            assert!(names.contains(&name.replace(".x.", ".z.").as_str()), "{name}");
        }
    }
}

#[test]
fn any_pulse_size_fits_where_no_microsteps_are_typed() {
    for nm in [15_875.0 / 8.0, 10.0, 10_000.0] {
        let control = Control { pulse_nm: Axes { x: nm, z: nm }, start: Axes { x: 5, z: -5 } };
        let machine = Machine::new(&Figures::new(TABLES), control).unwrap();
        assert!((machine.axis(interp_core::units::Axis::X).at() - 5.0 * nm).abs() < 1e-6);
    }
}
