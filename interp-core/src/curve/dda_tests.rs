//! The integrators against the circle, and all line methods against the line.

use super::*;
use crate::curve::fraction::FractionLine;
use crate::curve::rate_multiplier::MultipliedLine;
extern crate std;
use std::vec::Vec;

fn along(at: (i32, i32), step: Step) -> (i32, i32) {
    (at.0 + i32::from(step.x), at.1 + i32::from(step.z))
}

/// Walks there and back over the same points; gives the largest distance from the line.
fn there_and_back<W: Walker + Clone + PartialEq + core::fmt::Debug>(line: Line, start: W) -> f64 {
    let (x, z) = line.end();
    let (mut walk, mut at, mut points, mut worst) = (start.clone(), (0_i32, 0_i32), Vec::new(), 0.0_f64);
    while let Some(step) = walk.next_step() {
        points.push(at);
        at = along(at, step);
        let cross = i64::from(at.0) * i64::from(z) - i64::from(at.1) * i64::from(x);
        #[allow(clippy::cast_precision_loss, reason = "small")]
        let off = cross as f64 / f64::from(x).hypot(f64::from(z));
        worst = worst.max(off.abs());
    }
    assert_eq!(at, (x, z));
    while let Some(step) = walk.previous_step() {
        at = along(at, step);
        assert_eq!(Some(at), points.pop());
    }
    assert!(points.is_empty());
    assert_eq!(walk, start);
    worst
}

#[test]
fn every_small_line_ends_where_it_must_near_its_line_and_leads_back() {
    for x in -40..=40_i32 {
        for z in -40..=40_i32 {
            let Some(line) = Line::new(x, z) else { continue };
            let half_diagonal = 0.5_f64.hypot(0.5) + 1e-9;
            assert!(there_and_back(line, IntegratedLine::new(line)) <= half_diagonal, "dda {x},{z}");
            assert!(there_and_back(line, MultipliedLine::new(line)) <= half_diagonal, "rate multiplier {x},{z}");
            assert!(there_and_back(line, FractionLine::new(line)) <= 0.5 + 1e-6, "fraction {x},{z}");
        }
    }
}

#[test]
fn long_lines_end_where_they_must_near_their_line() {
    for (x, z) in [(40_000, 3), (-32_767, 12_345), (65_536, -65_535), (1, 50_000), (21_845, 43_691), (-4095, -4096)] {
        let line = Line::new(x, z).unwrap();
        assert!(there_and_back(line, IntegratedLine::new(line)) <= 0.71, "dda {x},{z}");
        assert!(there_and_back(line, MultipliedLine::new(line)) <= 0.8, "rate multiplier {x},{z}");
        assert!(there_and_back(line, FractionLine::new(line)) <= 0.51, "fraction {x},{z}");
    }
}

#[test]
fn full_circles_close_in_both_senses_near_the_circle() {
    for radius in 2..=400_i32 {
        let mut worst = 0.0_f64;
        for sense in [Sense::CounterClockwise, Sense::Clockwise] {
            for from in [(0, radius), (radius, 0), (0, -radius), (-radius, 0)] {
                let mut walk = IntegratedArc::circle(from, from, sense).unwrap();
                let (mut at, mut pulses) = (from, 0);
                while let Some(step) = walk.next_step() {
                    at = along(at, step);
                    pulses += 1;
                    assert!(pulses <= 8 * radius + 8, "radius {radius} ends");
                    worst = worst.max((f64::from(at.0).hypot(f64::from(at.1)) - f64::from(radius)).abs());
                }
                assert_eq!(at, from);
                assert_eq!(walk.quadrants_entered(), 4);
                let mut back = walk.reversed();
                while let Some(step) = back.next_step() {
                    at = along(at, step);
                    worst = worst.max((f64::from(at.0).hypot(f64::from(at.1)) - f64::from(radius)).abs());
                }
                assert_eq!(at, from);
            }
        }
        assert!(worst <= 1.0, "radius {radius}: {worst}");
    }
}
