//! Walks of ellipses and parabolas against their equations in `f64`.
#![allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "oracles in f64")]

use super::*;
use crate::curve::Walker;
use proptest::prelude::*;
extern crate std;
use std::vec::Vec;

/// Walks there and back; gives how far each point is off, the start's first.
fn walked(conic: &Conic, off: impl Fn(i32, i32) -> f64) -> Vec<f64> {
    let (mut walker, mut at, mut points) = (conic.walk(), (0_i32, 0_i32), Vec::new());
    let mut offs = std::vec![off(0, 0)];
    while let Some(step) = walker.next_step() {
        points.push(at);
        at = (at.0 + i32::from(step.x), at.1 + i32::from(step.z));
        offs.push(off(at.0, at.1));
        assert!(points.len() < 1 << 22);
    }
    assert_eq!(at, conic.end());
    while let Some(step) = walker.previous_step() {
        at = (at.0 + i32::from(step.x), at.1 + i32::from(step.z));
        assert_eq!(Some(at), points.pop());
    }
    assert!(points.is_empty());
    offs
}

/// Half a pulse between the ends, where the rounded ends are up to half a pulse off each way; from there on the deviation
/// falls until it is half a pulse.
fn is_near(offs: &[f64], tolerance: f64) -> Result<(), std::string::String> {
    let near = |off: &f64| *off <= 0.5 + tolerance;
    let (Some(first), Some(last)) = (offs.iter().position(near), offs.iter().rposition(near)) else {
        return if offs.iter().all(|off| *off <= 1.0) { Ok(()) } else { Err(std::format!("{offs:?}")) };
    };
    for (k, off) in offs.iter().enumerate() {
        let bound = if (first..=last).contains(&k) { 0.5 + tolerance } else { 1.0 };
        if *off > bound {
            return Err(std::format!("{off} at {k}, near from {first} to {last} of {}", offs.len()));
        }
    }
    Ok(())
}

/// Distance of a point from where `value` is 0, in coarser pulses, by Newton steps along the gradient; all in nm.
fn distance(conic: impl Fn(f64, f64) -> (f64, f64, f64), (x0, z0): (f64, f64), coarser: f64) -> f64 {
    let (mut x, mut z) = (x0, z0);
    for _ in 0..30 {
        let (value, gx, gz) = conic(x, z);
        let square = gx * gx + gz * gz;
        // to the curve's tangent, then along it back toward the point
        let (along_x, along_z) = (-gz, gx);
        let back = ((x0 - x) * along_x + (z0 - z) * along_z) / square;
        x += -value * gx / square + 0.5 * back * along_x;
        z += -value * gz / square + 0.5 * back * along_z;
    }
    (x - x0).hypot(z - z0) / coarser
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
                // where a gap between two zones is bridged the point nearest the curve may be half a pulse off
                // in distance and more along either axis
                let (hx, hz) = (f64::from(rx), f64::from(rz));
                let value = |x: f64, z: f64| {
                    let (u, v) = (x / hx, z / hz);
                    (u * u + v * v - 1.0, 2.0 * u / hx, 2.0 * v / hz)
                };
                let far = walked(&conic, |x, z| {
                    let at = (f64::from(x + start.0), f64::from(z + start.1));
                    if off(x, z) > 0.5 { distance(value, at, 1.0) } else { 0.0 }
                });
                assert!(far.iter().all(|off| *off <= 0.5 + 1e-9), "{rx} {rz} {start:?} {sense:?}: {far:?}");
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
                let (twice, begin) = (2.0 * f64::from(parameter), point(from));
                let value = |x: f64, z: f64| {
                    if axis == Axis::Z {
                        (x * x - twice * z, 2.0 * x, -twice)
                    } else {
                        (z * z - twice * x, -twice, 2.0 * z)
                    }
                };
                let at = |x: i32, z: i32| (f64::from(x + begin.x), f64::from(z + begin.z));
                let offs = walked(&conic, |x, z| distance(value, at(x, z), 1.0));
                let near = is_near(&offs, 1e-6);
                assert!(near.is_ok(), "{parameter} {axis:?} {from} to {to}: {near:?}");
            }
        }
    }
}

/// How an arc of an ellipse between two rounded points keeps to the ellipse: centre and half axes in nm, pulses in nm and
/// in thirds of one, angle and sweep in rad.
fn ellipse_is_near(
    (centre_x, centre_z): (i64, i64),
    (half_x, half_z): (i64, i64),
    (size_x, size_z): (u32, u32),
    (from, sweep): (f64, f64),
    clockwise: bool,
) -> Result<(), std::string::String> {
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
    let (px, pz) = (f64::from(size_x), f64::from(size_z) / 3.0);
    let (hx, hz) = (half_x as f64, half_z as f64);
    let value = |x: f64, z: f64| {
        let (u, v) = ((x - centre_x as f64) / hx, (z - centre_z as f64) / hz);
        (u * u + v * v - 1.0, 2.0 * u / hx, 2.0 * v / hz)
    };
    let at = |x: i32, z: i32| ((f64::from(x) + f64::from(start.x)) * px, (f64::from(z) + f64::from(start.z)) * pz);
    let offs = walked(&conic, |x, z| distance(value, at(x, z), px.max(pz)));
    is_near(&offs, 1e-5)
}

/// At the tip of a slim ellipse half a pulse across is many pulses along.
#[test]
fn an_end_rounded_across_the_tip_of_a_slim_ellipse_is_on_it() {
    let (half, pulse) = ((301_595, 1_625_341), (18_777, 1000));
    let near =
        ellipse_is_near((-40_821_686, 0), half, pulse, (0.716_338_277_692_263_1, 2.397_918_595_121_300_5), false);
    assert_eq!(near, Ok(()));
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
        let near = ellipse_is_near((centre_x, centre_z), (half_x, half_z), (size_x, size_z), (from, sweep), clockwise);
        prop_assert!(near.is_ok(), "{near:?}");
    }

    #[test]
    fn parabolas_of_any_place_and_pulses_stay_within_half_a_pulse(
        (vertex_x, vertex_z) in (-300_000_000_i64..300_000_000, -300_000_000_i64..300_000_000),
        parameter in prop_oneof![20_000_i64..6_000_000, -6_000_000_i64..-20_000],
        (size_x, size_z) in (500_u32..20_000, prop_oneof![Just(1000_u32), 500_u32..20_000]),
        (from, to) in (-6_000_000_i64..6_000_000, -6_000_000_i64..6_000_000), along_x: bool,
    ) {
        let (x, z) = (PulseSize::new(size_x, 1).unwrap(), PulseSize::new(size_z, 3).unwrap());
        let twice = 2.0 * parameter as f64;
        let place = |across: i64| {
            let along = (across as f64).powi(2) / twice;
            (along.abs() < 30e6).then(|| {
                let nm = |vertex: i64, off: f64| Length::from_nm(vertex + off.round() as i64).unwrap();
                let (dx, dz) = if along_x { (along, across as f64) } else { (across as f64, along) };
                Lattice { x: x.nearest(nm(vertex_x, dx)), z: z.nearest(nm(vertex_z, dz)) }
            })
        };
        let (Some(start), Some(end)) = (place(from), place(to)) else { return Ok(()) };
        let axis = if along_x { Axis::X } else { Axis::Z };
        let parabola = Parabola { vertex: (vertex_x, vertex_z), axis, parameter: Length::from_nm(parameter).unwrap() };
        let conic = match parabola.arc((x, z), start, end) {
            Ok(conic) => conic,
            Err(ConicRefusal::TooSmall | ConicRefusal::NoPulse) => return Ok(()),
            Err(why) => panic!("{why:?}"),
        };
        let (px, pz) = (f64::from(size_x), f64::from(size_z) / 3.0);
        let value = |x: f64, z: f64| {
            let (dx, dz) = (x - vertex_x as f64, z - vertex_z as f64);
            if along_x { (dz * dz - twice * dx, -twice, 2.0 * dz) } else { (dx * dx - twice * dz, 2.0 * dx, -twice) }
        };
        let at = |x: i32, z: i32| ((f64::from(x) + f64::from(start.x)) * px, (f64::from(z) + f64::from(start.z)) * pz);
        let offs = walked(&conic, |x, z| distance(value, at(x, z), px.max(pz)));
        let near = is_near(&offs, 1e-5);
        prop_assert!(near.is_ok(), "{near:?}");
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
    // x = 6 at z = 9: two pulses off, and three
    assert_eq!(parabola(2).arc(one(), at(0, 0), at(4, 9)).map(|conic| conic.end()), Ok((4, 9)));
    assert_eq!(parabola(2).arc(one(), at(0, 0), at(3, 9)), Err(ConicRefusal::OffCurve));
    assert_eq!(parabola(2).arc(one(), at(4, 4), at(4, 4)), Err(ConicRefusal::NoPulse));
    assert_eq!(parabola(2).arc(one(), at(i32::MIN, 0), at(i32::MAX, 0)), Err(ConicRefusal::OutOfRange));
}
