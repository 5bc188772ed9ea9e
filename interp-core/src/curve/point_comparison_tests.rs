//! Point comparison against the geometry of a circle and the table of the group control system.

use super::*;
extern crate std;
use std::vec::Vec;

/// All 16 combinations of the logic's four inputs against geometry: the direction of travel is the radius turned by a
/// quarter, and from outside the step must lead inward, from inside outward.
#[test]
fn the_expressions_are_the_truth_table_of_all_sixteen_combinations() {
    for bits in 0..16_u8 {
        let (x, z, d, s) = (bits & 1 != 0, bits & 2 != 0, bits & 4 != 0, bits & 8 != 0);
        let sign = |negative: bool| if negative { -1_i32 } else { 1 };
        let turn = sign(s);
        let travel = (turn * sign(z), -turn * sign(x));
        let inward = (sign(x) * travel.0 < 0, sign(z) * travel.1 < 0);
        assert_ne!(inward.0, inward.1, "one axis leads inward, the other outward");
        let outside = !d;
        assert_eq!(x_steps(x, z, d, s), inward.0 == outside, "{bits:04b}");
        assert_eq!(z_steps(x, z, d, s), inward.1 == outside, "{bits:04b}");
        assert_eq!(x_negative(z, s), travel.0 < 0, "{bits:04b}");
        assert_eq!(z_negative(x, s), travel.1 < 0, "{bits:04b}");
    }
}

/// The group control system's table: "CCW I, III and CW II, IV step Z inward when f >= 0 and X outward when f < 0; CCW
/// II, IV and CW I, III step X inward when f >= 0 and Z outward when f < 0".
#[test]
fn the_expressions_agree_with_the_quadrant_table_of_the_group_control() {
    // quadrant: signs of X and Z, Z to the right and X upward
    let quadrants = [(1, false, false), (2, false, true), (3, true, true), (4, true, false)];
    for (quadrant, x, z) in quadrants {
        for s in [false, true] {
            let z_inward = matches!((s, quadrant), (false, 1 | 3) | (true, 2 | 4));
            let (outside, inside) = (false, true);
            assert_eq!(z_steps(x, z, outside, s), z_inward);
            assert_eq!(x_steps(x, z, outside, s), !z_inward);
            assert_eq!(x_steps(x, z, inside, s), z_inward);
            assert_eq!(z_steps(x, z, inside, s), !z_inward);
            // inward is toward 0: minus where the coordinate is positive
            if z_inward {
                assert_eq!((z_negative(x, s), x_negative(z, s)), (!z, x));
            } else {
                assert_eq!((x_negative(z, s), z_negative(x, s)), (!x, z));
            }
        }
    }
}

/// Walks once round in both senses from each of the `starts`; gives the worst radial error.
fn round(radius: i32, starts: &[(i32, i32)]) -> f64 {
    let mut worst = 0.0_f64;
    for sense in [Sense::CounterClockwise, Sense::Clockwise] {
        for &(x, z) in starts {
            let from = (x * radius, z * radius);
            let mut walk = ComparedArc::circle(from, from, sense).unwrap();
            let (mut at, mut pulses) = (from, 0);
            while let Some(step) = walk.next_step() {
                at = (at.0 + i32::from(step.x), at.1 + i32::from(step.z));
                pulses += 1;
                assert!(pulses <= 8 * radius, "radius {radius} {sense:?} ends");
                assert_eq!(step.x.unsigned_abs() + step.z.unsigned_abs(), 1, "one axis at a time");
                worst = worst.max((f64::from(at.0).hypot(f64::from(at.1)) - f64::from(radius)).abs());
            }
            assert_eq!(at, from, "radius {radius} {sense:?} closes");
            // the sum of both axes' pulses over all quadrants
            assert_eq!(pulses, 8 * radius, "radius {radius} {sense:?}");
        }
    }
    worst
}

#[test]
fn full_circles_close_in_both_senses_within_a_pulse() {
    for radius in 2..=2000 {
        let starts = if radius < 300 { &[(0, 1), (1, 0), (0, -1), (-1, 0)][..] } else { &[(0, 1)] };
        let worst = round(radius, starts);
        assert!(worst <= 1.0, "radius {radius}: {worst}");
    }
}

/// Every arc between the lattice points that point comparison itself visits on small circles.
#[test]
fn every_arc_of_a_small_circle_ends_where_it_must_and_leads_back() {
    for radius in 2..13 {
        for sense in [Sense::CounterClockwise, Sense::Clockwise] {
            let mut points = Vec::from([(0, radius)]);
            let mut walk = ComparedArc::circle((0, radius), (0, radius), sense).unwrap();
            while let Some(step) = walk.next_step() {
                let (x, z) = points[points.len() - 1];
                points.push((x + i32::from(step.x), z + i32::from(step.z)));
                assert!(points.len() <= 8 * 13, "it ends");
            }
            for &from in &points {
                let start = f64::from(from.0).hypot(f64::from(from.1));
                for &to in &points {
                    let Some(mut walk) = ComparedArc::circle(from, to, sense) else { continue };
                    let (mut at, mut steps) = (from, 0);
                    let check = |at: (i32, i32)| {
                        let off = (f64::from(at.0).hypot(f64::from(at.1)) - start).abs();
                        assert!(off <= 1.5, "{from:?} to {to:?} {sense:?} at {at:?}: {off}");
                    };
                    while let Some(step) = walk.next_step() {
                        at = (at.0 + i32::from(step.x), at.1 + i32::from(step.z));
                        steps += 1;
                        assert!(steps <= 8 * radius + 8, "{from:?} to {to:?} {sense:?}");
                        check(at);
                    }
                    assert_eq!(at, to, "from {from:?} {sense:?}");
                    let mut back = walk.reversed();
                    while let Some(step) = back.next_step() {
                        at = (at.0 + i32::from(step.x), at.1 + i32::from(step.z));
                        check(at);
                    }
                    assert_eq!(at, from, "back from {to:?} {sense:?}");
                }
            }
        }
    }
}

/// Every line of a small square: end, distance at every step, and the same points backward.
#[test]
fn every_small_line_stays_within_a_pulse_and_leads_back_over_its_points() {
    for x in -24..=24_i32 {
        for z in -24..=24_i32 {
            let Some(line) = Line::new(x, z) else { continue };
            let (mut walk, mut at, mut points) = (ComparedLine::new(line), (0_i32, 0_i32), Vec::new());
            while let Some(step) = walk.next_step() {
                points.push(at);
                at = (at.0 + i32::from(step.x), at.1 + i32::from(step.z));
                let off = f64::from(at.0 * z - at.1 * x) / f64::from(x).hypot(f64::from(z));
                assert!(off.abs() <= 1.0, "{x},{z} at {at:?}: {off}");
            }
            assert_eq!(at, (x, z));
            assert_eq!(points.len(), (x.unsigned_abs() + z.unsigned_abs()) as usize);
            while let Some(step) = walk.previous_step() {
                at = (at.0 + i32::from(step.x), at.1 + i32::from(step.z));
                assert_eq!(Some(at), points.pop());
            }
            assert!(points.is_empty());
            assert_eq!(walk, ComparedLine::new(line));
        }
    }
}

#[test]
fn what_is_no_circle_is_refused() {
    let sense = Sense::Clockwise;
    assert_eq!(ComparedArc::circle((0, 0), (0, 0), sense), None);
    assert_eq!(ComparedArc::circle((0, 10), (13, 0), sense), None);
    assert_eq!(ComparedArc::circle((0, Around::LIMIT + 1), (0, Around::LIMIT + 1), sense), None);
    assert!(ComparedArc::circle((0, Around::LIMIT), (Around::LIMIT, 0), sense).is_some());
}
