//! Arcs of any sweep, centre and radius against a walk by dense sampling: curves are built here from
//! angles, a lattice point belongs to the walk if it is the nearest to a sample, and the deviation is the
//! distance to the nearest sample.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "helpers of tests may panic as tests do")]

mod common;

use common::{arc, jumpy, play};
use measure::{PerAxis, Setup};
use proptest::prelude::{ProptestConfig, prop_assert, prop_assert_eq, prop_assume, proptest};
use proptest::test_runner::TestCaseError;
use std::f64::consts::{PI, TAU};

/// (x, z), in pulses of 1 um.
type Place = (f64, f64);

/// Samples per pulse of curve.
const DENSE: f64 = 400.0;

fn angle(from: Place, to: Place) -> f64 {
    (to.0 - from.0).atan2(to.1 - from.1)
}

fn distance(a: Place, b: Place) -> f64 {
    (a.0 - b.0).hypot(a.1 - b.1)
}

fn polar(centre: Place, radius: f64, angle: f64) -> Place {
    (centre.0 + radius * angle.sin(), centre.1 + radius * angle.cos())
}

fn swept(start: Place, end: Place, centre: Place, clockwise: bool) -> f64 {
    let turn = angle(centre, end) - angle(centre, start);
    if clockwise { (-turn).rem_euclid(TAU) } else { turn.rem_euclid(TAU) }
}

/// Samples of the arc about the moved centre.
fn samples(start: Place, end: Place, centre: Place, clockwise: bool) -> Vec<Place> {
    // Along the chord until both ends are equally far: |c + t d - s|² = |c + t d - e|².
    let chord = (end.0 - start.0, end.1 - start.1);
    let squared = chord.0 * chord.0 + chord.1 * chord.1;
    let of = |place: Place| distance(centre, place).powi(2);
    let full = squared < 1e-12;
    let along = if full { 0.0 } else { (of(end) - of(start)) / (2.0 * squared) };
    let centre = (centre.0 + along * chord.0, centre.1 + along * chord.1);
    let radius = distance(centre, start);
    let sweep = if full { TAU } else { swept(start, end, centre, clockwise) };
    let turn = if clockwise { -sweep } else { sweep };
    let first = angle(centre, start);
    let count = (sweep * radius * DENSE).ceil().max(1.0);
    let mut samples: Vec<Place> = (0_u32..)
        .map(f64::from)
        .take_while(|sample| *sample <= count)
        .map(|sample| polar(centre, radius, first + turn * sample / count))
        .collect();
    samples.push(end);
    samples
}

#[allow(clippy::cast_possible_truncation, reason = "a few pulses")]
fn whole(value: f64) -> i32 {
    value.round() as i32
}

#[allow(clippy::cast_possible_truncation, reason = "a few pulses")]
fn nm(value: f64) -> i64 {
    (value * 1_000.0).round() as i64
}

#[allow(clippy::cast_precision_loss, reason = "a few pulses")]
fn pulses(nm: i64) -> f64 {
    nm as f64 / 1_000.0
}

fn up(place: Place) -> Place {
    ((place.0 + 0.5).floor(), (place.1 + 0.5).floor())
}

/// The lattice points nearest to samples, without repetition.
fn nearest(samples: &[Place]) -> Vec<(i32, i32)> {
    let mut points: Vec<(i32, i32)> = samples.iter().map(|place| (whole(place.0), whole(place.1))).collect();
    points.dedup();
    points
}

fn farthest(points: &[(i32, i32)], samples: &[Place]) -> f64 {
    let off = |point: &(i32, i32)| {
        let place = (f64::from(point.0), f64::from(point.1));
        samples.iter().map(|sample| distance(*sample, place)).fold(f64::INFINITY, f64::min)
    };
    points.iter().map(off).fold(0.0, f64::max)
}

/// Programmed arc, in nm: (x, z).
#[derive(Copy, Clone, Debug)]
struct Programmed {
    centre: (i64, i64),
    start: (i64, i64),
    end: (i64, i64),
    clockwise: bool,
}

/// Plays the walk of `of` and compares what the checker finds.
fn compare(of: Programmed) -> Result<(), TestCaseError> {
    let Programmed { clockwise, .. } = of;
    let in_pulses = |nm: (i64, i64)| (pulses(nm.0), pulses(nm.1));
    let (middle, start, end) = (in_pulses(of.centre), in_pulses(of.start), in_pulses(of.end));
    let full = of.start == of.end;
    let turned = swept(start, end, middle, clockwise);
    prop_assume!(full || (turned - PI).abs() > 1e-3);
    // Past half a turn two halves, unless the rounded ends lie equally far from the centre to within a 16th of a
    // pulse, seen along the chord.
    let (first, last) = (up(start), up(end));
    let (near, far) = (distance(middle, first), distance(middle, last));
    let moved = (far - near).abs() * near - distance(first, last) / 16.0;
    prop_assume!(moved == 0.0 || moved.abs() > 1e-6);
    let whole_turn = (full || turned > PI) && moved <= 0.0;
    let mut corners = vec![(up(start), start)];
    if full {
        let place = in_pulses((2 * of.centre.0 - of.start.0, 2 * of.centre.1 - of.start.1));
        corners.push((up(place), place));
    } else if turned > PI {
        let half = if clockwise { -turned / 2.0 } else { turned / 2.0 };
        let mean = f64::midpoint(distance(middle, start), distance(middle, end));
        let place = polar(middle, mean, angle(middle, start) + half);
        // a pulse is a micrometre here, so a nanometre is a thousandth
        let to_nm = |pulses: f64| (pulses * 1e3 + 0.5 + 1e-4).floor() / 1e3;
        let told = (to_nm(place.0), to_nm(place.1));
        corners.push((up(told), place));
    }
    corners.push((up(end), end));
    let mut points = vec![(whole(corners[0].0.0), whole(corners[0].0.1))];
    let mut programmed: Vec<Place> = Vec::new();
    let mut walked = 0.0_f64;
    for pair in corners.windows(2) {
        programmed.extend(samples(pair[0].1, pair[1].1, middle, clockwise));
        if !whole_turn && distance(pair[0].0, pair[1].0) > 0.5 {
            let arc = samples(pair[0].0, pair[1].0, middle, clockwise);
            let half = nearest(&arc);
            walked = walked.max(farthest(&half, &arc));
            points.extend(half);
        }
    }
    let small = distance(first, last) < 0.5 && near < 1.0;
    prop_assume!((near - 1.0).abs() > 1e-6);
    if whole_turn && !small {
        let arc = samples(first, last, middle, clockwise);
        let round = nearest(&arc);
        walked = farthest(&round, &arc);
        points.extend(round);
    }
    points.dedup();
    let steps: Vec<common::Step> = points
        .windows(2)
        .zip(1_u64..)
        .map(|(pair, count)| common::Step {
            clocks: 12_000 * count + 6_000,
            x: pair[1].0 - pair[0].0,
            z: pair[1].1 - pair[0].1,
        })
        .collect();
    let setup = Setup {
        start: PerAxis { x: points[0].0, z: points[0].1 },
        start_nm: PerAxis { x: of.start.0, z: of.start.1 },
        ..jumpy()
    };
    let report = play(setup, &[arc(of.centre, of.end, clockwise, 60.0)], &steps);
    prop_assert_eq!(report.faults.total(), 0, "{}\n{:?}", &report, &points);
    prop_assert_eq!(report.motions, u64::from(points.len() > 1));
    prop_assert!((report.walked.pulses - walked).abs() < 0.002, "{} {}", walked, &report);
    // The place before the first step is no event.
    let off = farthest(&points[1..], &programmed);
    prop_assert!((report.programmed.pulses - off).abs() < 0.002, "{} {}", off, &report);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn arcs_are_followed_and_deviations_are_those_of_dense_samples(
        centre in (-3_000_i64..3_000, -3_000_i64..3_000),
        radius in 600_u32..12_000,
        first in 0_u32..36_000,
        sweep in 100_u32..36_000,
        clockwise: bool,
    ) {
        let radius = f64::from(radius) / 1_000.0;
        let first = f64::from(first) / 36_000.0 * TAU;
        let turn = f64::from(sweep) / 36_000.0 * TAU;
        let last = if clockwise { first - turn } else { first + turn };
        let on_nm = |angle| {
            let place = polar((pulses(centre.0), pulses(centre.1)), radius, angle);
            (nm(place.0), nm(place.1))
        };
        let (start, end) = (on_nm(first), on_nm(last));
        prop_assume!(start != end);
        compare(Programmed { centre, start, end, clockwise })?;
    }

    /// Places in quarters of a pulse: half a pulse is met all the time.
    #[test]
    fn full_circles_turn_about_the_programmed_centre(
        centre in (-8_i64..8, -8_i64..8),
        radius in 3_i64..40,
        quarter in 0_u8..4,
        clockwise: bool,
    ) {
        let out = match quarter {
            0 => (0, radius),
            1 => (radius, 0),
            2 => (0, -radius),
            _ => (-radius, 0),
        };
        let start = (250 * (centre.0 + out.0), 250 * (centre.1 + out.1));
        let centre = (250 * centre.0, 250 * centre.1);
        compare(Programmed { centre, start, end: start, clockwise })?;
    }
}
