//! Braking on arcs so wide and machines so quick that acceleration times radius passes 64 bits.
#![allow(
    clippy::unwrap_used,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::arithmetic_side_effects,
    missing_docs,
    reason = "tests"
)]

use interp_core::block::{Builder, Pace, Path};
use interp_core::config::{AxisConfig, Config};
use interp_core::units::{Feedrate, Length, Point, PulseSize, Sense};

/// The squared speed from which a stop at the end of an arc is met is that of the closed form, up to the arc's own limit.
#[test]
fn an_arc_brakes_by_its_closed_form_whatever_its_radius() {
    for accel_mm in [500_u32, 2_000, 9_000, 50_000] {
        let feed = Feedrate::from_nm_per_min(12_000_000_000).unwrap();
        let axis = AxisConfig {
            pulse: PulseSize::new(2_500, 1).unwrap(),
            max_feed: feed,
            max_accel: accel_mm * 1000,
            max_jump: 1_000,
            pulse_width_ns: 2_500,
            dir_setup_ns: 5_000,
            dir_hold_ns: 5_000,
            min_space_ns: 2_500,
        };
        let machine = Config { x: axis, z: axis, event_min_ns: 1_000 }.check().unwrap();
        for radius_um in [5_000, 60_000, 300_000, 1_000_000, 2_000_000] {
            let um = |um| Length::from_um(um).unwrap();
            let mut builder = Builder::new(&machine, Point { x: um(0), z: um(radius_um) });
            let path = Path::Arc { centre: (0, 0), sense: Sense::CounterClockwise };
            let built = builder.motion(path, Point { x: um(radius_um), z: um(0) }, Pace::Rapid);
            let motion = built.motions.into_iter().next().unwrap();
            let (accel, radius) = (f64::from(motion.accel), f64::from(radius_um) * 4_096_000.0);
            let most = f64::from(motion.limit).powi(2);
            for share in [1e-4, 1e-3, 0.01, 0.1, 0.5] {
                for exit in [0.0, 0.3, 0.9] {
                    let (distance, exit) = (motion.length as f64 * share, most * exit);
                    let angle =
                        (2.0 * distance / radius + (exit / (accel * radius)).asin()).min(std::f64::consts::FRAC_PI_2);
                    let exact = (accel * radius * angle.sin()).min(most);
                    let found = (motion.reachable(distance as u64, exit as u64) as f64).min(most);
                    let off = found / exact - 1.0;
                    // a 4096th where turning is left out, and what 30 bits of a small sine leave
                    assert!(
                        off.abs() < 3e-3,
                        "{accel_mm} mm/s2, R {radius_um} um, {share} of it: {found}, not {exact}"
                    );
                }
            }
        }
    }
}
