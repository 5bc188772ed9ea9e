//! Walks of ellipses and parabolas against their equations in `f64`.
#![allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "oracles in f64")]

use super::*;
use crate::curve::Walker;
use proptest::prelude::*;
extern crate std;
use std::vec::Vec;

/// Walks there and back; gives the largest of `off` on the way.
fn walked(conic: &Conic, off: impl Fn(i32, i32) -> f64) -> f64 {
    let (mut walker, mut at, mut points, mut worst) = (conic.walk(), (0_i32, 0_i32), Vec::new(), 0.0_f64);
    while let Some(step) = walker.next_step() {
        points.push(at);
        at = (at.0 + i32::from(step.x), at.1 + i32::from(step.z));
        worst = worst.max(off(at.0, at.1));
        assert!(points.len() < 1 << 22);
    }
    assert_eq!(at, conic.end());
    while let Some(step) = walker.previous_step() {
        at = (at.0 + i32::from(step.x), at.1 + i32::from(step.z));
        assert_eq!(Some(at), points.pop());
    }
    assert!(points.is_empty());
    worst
}

/// Distance of a point from the conic that was walked, in pulses, by Newton steps along the gradient.
fn distance(conic: &Conic, (x, z): (i32, i32), (px, pz): (f64, f64)) -> f64 {
    let [a, b, c, d] = [conic.arc.a, conic.arc.b, conic.arc.c, conic.arc.d].map(|v| v as f64);
    let (x0, z0) = (f64::from(x), f64::from(z));
    let (mut x, mut z) = (x0, z0);
    for _ in 0..20 {
        let f = (a * x - c) * x + (b * z - d) * z;
        // gradient in mm
        let (gx, gz) = ((2.0 * a * x - c) / px, (2.0 * b * z - d) / pz);
        let square = gx * gx + gz * gz;
        // to the curve's tangent, then along it back toward the point
        let (along_x, along_z) = (-gz, gx);
        let back = (((x0 - x) * px) * along_x + ((z0 - z) * pz) * along_z) / square;
        x += (-f * gx / square + 0.5 * back * along_x) / px;
        z += (-f * gz / square + 0.5 * back * along_z) / pz;
    }
    ((x - x0) * px).hypot((z - z0) * pz) / px.max(pz)
}

fn one() -> (PulseSize, PulseSize) {
    (PulseSize::ONE_MICROMETRE, PulseSize::ONE_MICROMETRE)
}

fn um(value: i32) -> Length {
    Length::from_um(value).unwrap()
}

/// Every small ellipse about a lattice point, whole, from each of its ends, both ways.
#[test]
fn every_small_ellipse_closes_within_half_a_pulse() {
    for (rx, rz) in (2..40).flat_map(|x| (2..40).map(move |z| (x, z))) {
        let ellipse = Ellipse { centre: (0, 0), half_axes: (um(rx), um(rz)) };
        for start in [(rx, 0), (0, rz), (-rx, 0), (0, -rz)] {
            for sense in [Sense::CounterClockwise, Sense::Clockwise] {
                let at = Lattice { x: start.0, z: start.1 };
                let conic = ellipse.arc(one(), at, at, (sense, Reach::Long)).unwrap();
                // the exact equation: half a pulse along one axis
                let off = |x: i32, z: i32| {
                    let (x, z) = (f64::from(x + start.0).abs(), f64::from(z + start.1).abs());
                    let (rx, rz) = (f64::from(rx), f64::from(rz));
                    let along_z = (rz * (1.0 - (x / rx).powi(2)).max(0.0).sqrt() - z).abs();
                    let along_x = (rx * (1.0 - (z / rz).powi(2)).max(0.0).sqrt() - x).abs();
                    if x > rx {
                        along_x
                    } else if z > rz {
                        along_z
                    } else {
                        along_z.min(along_x)
                    }
                };
                let worst = walked(&conic, off);
                // where a gap between two zones is bridged the point nearest the curve may be half a pulse off
                // in distance and more along either axis
                let far =
                    walked(&conic, |x, z| if off(x, z) > 0.5 { distance(&conic, (x, z), (1.0, 1.0)) } else { 0.0 });
                assert!(far <= 0.5 + 1e-9, "{rx} {rz} {start:?} {sense:?}: {worst} {far}");
            }
        }
    }
}

/// Every small parabola along each axis and side, between any two of its points.
#[test]
fn every_small_parabola_stays_within_half_a_pulse() {
    for parameter in (-30..=30).filter(|p| *p != 0) {
        for axis in [Axis::X, Axis::Z] {
            let parabola = Parabola { vertex: (0, 0), axis, parameter: um(parameter) };
            let point = |u: i32| {
                let v = (2 * u * u + 2 * parameter.abs()).div_euclid(4 * parameter.abs()) * parameter.signum();
                if axis == Axis::Z { Lattice { x: u, z: v } } else { Lattice { x: v, z: u } }
            };
            for (from, to) in (-20..=20).flat_map(|from| (-20..=20).map(move |to| (from, to))) {
                let found = parabola.arc(one(), point(from), point(to));
                if from == to {
                    assert_eq!(found, Err(ConicRefusal::NoPulse));
                    continue;
                }
                let conic = found.unwrap_or_else(|why| panic!("{parameter} {axis:?} {from} to {to}: {why:?}"));
                let worst = walked(&conic, |x, z| distance(&conic, (x, z), (1.0, 1.0)));
                assert!(worst <= 0.5 + 1e-6, "{parameter} {axis:?} {from} to {to}: {worst}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]
    #[test]
    fn ellipses_of_any_place_and_pulses_stay_within_half_a_pulse(
        (centre_x, centre_z) in (-300_000_000_i64..300_000_000, -300_000_000_i64..300_000_000),
        (half_x, half_z) in (100_000_i64..6_000_000, 100_000_i64..6_000_000),
        (size_x, size_z) in (500_u32..20_000, prop_oneof![Just(1000_u32), 500_u32..20_000]),
        (from, sweep) in (0.0_f64..6.3, 0.3_f64..2.8),
        clockwise: bool,
    ) {
        let (x, z) = (PulseSize::new(size_x, 1).unwrap(), PulseSize::new(size_z, 3).unwrap());
        let place = |angle: f64| {
            let nm = |centre: i64, off: f64| Length::from_nm(centre + off.round() as i64).unwrap();
            let (dx, dz) = (half_x as f64 * angle.sin(), half_z as f64 * angle.cos());
            Lattice { x: x.nearest(nm(centre_x, dx)), z: z.nearest(nm(centre_z, dz)) }
        };
        let sense = if clockwise { Sense::Clockwise } else { Sense::CounterClockwise };
        let (start, end) = (place(from), place(if clockwise { from - sweep } else { from + sweep }));
        let length = |nm| Length::from_nm(nm).unwrap();
        let ellipse = Ellipse { centre: (centre_x, centre_z), half_axes: (length(half_x), length(half_z)) };
        let conic = match ellipse.arc((x, z), start, end, (sense, Reach::Short)) {
            Ok(conic) => conic,
            Err(ConicRefusal::TooSmall | ConicRefusal::NoPulse) => return Ok(()),
            Err(why) => panic!("{why:?}"),
        };
        let sizes = (f64::from(size_x), f64::from(size_z) / 3.0);
        let worst = walked(&conic, |x, z| distance(&conic, (x, z), sizes));
        prop_assert!(worst <= 0.5 + 1e-5, "{}", worst);
        // and the walked ellipse is the programmed one, moved and sized by the rounding of its ends
        let ratio = half_x.max(half_z) as f64 / half_x.min(half_z) as f64;
        let (hx, hz) = (half_x as f64, half_z as f64);
        let (px, pz) = sizes;
        let off = |x: i32, z: i32| {
            let u = ((f64::from(x) + f64::from(start.x)) * px - centre_x as f64) / hx;
            let v = ((f64::from(z) + f64::from(start.z)) * pz - centre_z as f64) / hz;
            let gradient = (u / hx).hypot(v / hz);
            ((u * u + v * v - 1.0) / (2.0 * gradient)).abs() / px.max(pz)
        };
        let worst = walked(&conic, off);
        prop_assert!(worst <= 1.2 + 0.75 * ratio, "programmed {} of {}", worst, ratio);
    }
}

#[test]
fn what_is_no_ellipse_or_parabola_is_refused_by_name() {
    let at = |x, z| Lattice { x, z };
    let way = (Sense::Clockwise, Reach::Short);
    let ellipse = |x, z| Ellipse { centre: (0, 0), half_axes: (um(x), um(z)) };
    assert_eq!(ellipse(0, 5).arc(one(), at(5, 0), at(0, 5), way), Err(ConicRefusal::Flat));
    assert_eq!(ellipse(-3, 5).arc(one(), at(5, 0), at(0, 5), way), Err(ConicRefusal::Flat));
    assert_eq!(ellipse(9, 5).arc(one(), at(9, 0), at(9, 0), way), Err(ConicRefusal::NoPulse));
    assert_eq!(ellipse(9, 5).arc(one(), at(12, 0), at(0, 5), way), Err(ConicRefusal::OffCurve));
    assert_eq!(ellipse(9, 5).arc(one(), at(9, 0), at(0, 8), way), Err(ConicRefusal::OffCurve));
    let coarse = PulseSize::new(1_000_000, 1).unwrap();
    assert_eq!(ellipse(9, 5).arc((coarse, coarse), at(0, 0), at(1, 0), way), Err(ConicRefusal::TooSmall));
    let parabola = |p| Parabola { vertex: (0, 0), axis: Axis::Z, parameter: um(p) };
    assert_eq!(parabola(0).arc(one(), at(0, 0), at(2, 2)), Err(ConicRefusal::Flat));
    assert_eq!(parabola(2).arc(one(), at(0, 9), at(4, 4)), Err(ConicRefusal::OffCurve));
    assert_eq!(parabola(2).arc(one(), at(0, 0), at(4, 9)), Err(ConicRefusal::OffCurve));
    assert_eq!(parabola(2).arc(one(), at(4, 4), at(4, 4)), Err(ConicRefusal::NoPulse));
    assert_eq!(parabola(2).arc(one(), at(i32::MIN, 0), at(i32::MAX, 0)), Err(ConicRefusal::OutOfRange));
}
