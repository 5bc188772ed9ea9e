//! Degenerate curves and the ends of the range: a refusal by name or a curve, never a wrap, a hang or a panic.
#![allow(clippy::unwrap_used, clippy::arithmetic_side_effects, reason = "a test")]

use interp_core::curve::conic::{Ellipse, Parabola};
use interp_core::curve::dda::{IntegratedArc, IntegratedLine};
use interp_core::curve::fraction::FractionLine;
use interp_core::curve::line::Line;
use interp_core::curve::point_comparison::{ComparedArc, ComparedLine};
use interp_core::curve::prepare_arc::{Metric, Prepared, Reach};
use interp_core::curve::rate_multiplier::MultipliedLine;
use interp_core::curve::{OneWay, Step, Walker};
use interp_core::sampled::curves::{Hyperbola, SineWave, Spiral, TiltedEllipse, TiltedParabola};
use interp_core::sampled::nurbs::{Nurbs, Weight};
use interp_core::sampled::spline::Spline;
use interp_core::sampled::{Chords, Sampled};
use interp_core::units::{Axis, Lattice, Length, Point, PulseSize, Sense};
use proptest::prelude::*;

/// Lengths of any size, the ends and 0 often.
fn length() -> impl Strategy<Value = Length> {
    let nm = prop_oneof![
        Just(0_i64),
        Just(1),
        Just(-1),
        Just(2_100_000_000),
        Just(-2_100_000_000),
        -3000_i64..3000,
        -2_100_000_000_i64..=2_100_000_000,
    ];
    nm.prop_map(|nm| Length::from_nm(nm).unwrap())
}

fn pulse() -> impl Strategy<Value = PulseSize> {
    prop_oneof![
        Just((10, 1)),
        Just((1_000_000, 1)),
        Just((16_777_213, 4093)),
        Just((4097, 409)),
        (10_u32..1_000_000, Just(1))
    ]
    .prop_filter_map("a pulse size", |(n, d)| PulseSize::new(n, d))
}

fn sense() -> impl Strategy<Value = Sense> {
    prop_oneof![Just(Sense::Clockwise), Just(Sense::CounterClockwise)]
}

fn reach() -> impl Strategy<Value = Reach> {
    prop_oneof![Just(Reach::Short), Just(Reach::Long)]
}

fn single(step: Step) -> bool {
    step != Step::default() && step.x.unsigned_abs() <= 1 && step.z.unsigned_abs() <= 1
}

/// The first steps of a walk, there and back.
fn walks(mut walker: impl Walker) {
    let (mut at, mut count) = ((0_i32, 0_i32), 0);
    while count < 3000 {
        let Some(step) = walker.next_step() else { break };
        assert!(single(step));
        at = (at.0 + i32::from(step.x), at.1 + i32::from(step.z));
        count += 1;
    }
    while let Some(step) = walker.previous_step() {
        at = (at.0 + i32::from(step.x), at.1 + i32::from(step.z));
        count -= 1;
    }
    assert_eq!((at, count), ((0, 0), 0));
}

fn goes(mut walker: impl OneWay) {
    for _ in 0..3000 {
        let Some(step) = walker.next_step() else { break };
        assert!(single(step));
    }
    let mut back = walker.reversed();
    for _ in 0..3000 {
        let Some(step) = back.next_step() else { break };
        assert!(single(step));
    }
}

/// The first chords of a curve lead somewhere in the range or end with a refusal.
fn divides(curve: impl Sampled) {
    let mut chords = Chords::new(curve, 5);
    for _ in 0..60 {
        match chords.next() {
            Some(Ok(_)) => {}
            Some(Err(_)) => {
                assert!(chords.next().is_none(), "nothing follows a refusal");
                return;
            }
            None => return,
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn lines_of_any_length_walk_both_ways(x in -Line::LIMIT..=Line::LIMIT, z in -Line::LIMIT..=Line::LIMIT, cut in 0_u32..30) {
        let Some(line) = Line::new(x >> cut, z) else { return Ok(()) };
        walks(ComparedLine::new(line));
        walks(IntegratedLine::new(line));
        walks(MultipliedLine::new(line));
        walks(FractionLine::new(line));
    }

    #[test]
    fn arcs_of_any_place_and_pulses_are_walked_or_refused(
        (x, z) in (pulse(), pulse()), points in (length(), length(), length(), length()),
        centre in (length(), length()), sense in sense(), reach in reach(),
    ) {
        // pulse sizes further apart than the machine allows do not come here
        let metre = |pulse: PulseSize| pulse.nearest(Length::from_nm(1_000_000_000).unwrap());
        let near = metre(x) / metre(z) < 128 && metre(z) / metre(x) < 128;
        let z = if near { z } else { x };
        let start = Lattice { x: x.nearest(points.0), z: z.nearest(points.1) };
        let end = Lattice { x: x.nearest(points.2), z: z.nearest(points.3) };
        let centre = (i64::from(centre.0.nm()), i64::from(centre.1.nm()));
        if let Prepared::Arc(arc, _) = Metric::new(x, z).arc(start, end, centre, sense, reach) {
            goes(ComparedArc::new(&arc));
            goes(IntegratedArc::new(&arc));
        }
    }

    #[test]
    fn conics_of_any_place_and_pulses_are_walked_or_refused(
        (x, z) in (pulse(), pulse()), points in (length(), length(), length(), length()),
        centre in (length(), length()), half_axes in (length(), length()), sense in sense(), reach in reach(), along_x: bool,
    ) {
        let start = Lattice { x: x.nearest(points.0), z: z.nearest(points.1) };
        let end = Lattice { x: x.nearest(points.2), z: z.nearest(points.3) };
        let centre = (i64::from(centre.0.nm()), i64::from(centre.1.nm()));
        // and one whose start is an end of an axis, so that it is on the curve
        let on = Lattice {
            x: x.nearest(Length::from_nm(centre.0).unwrap()),
            z: z.nearest(Length::from_nm((centre.1 + i64::from(half_axes.1.nm())).clamp(-2_100_000_000, 2_100_000_000)).unwrap()),
        };
        let ellipse = Ellipse { centre, half_axes };
        for (start, end) in [(start, end), (on, on), (on, end)] {
            if let Ok(conic) = ellipse.arc((x, z), start, end, (sense, reach)) {
                walks(conic.walk());
            }
        }
        let axis = if along_x { Axis::X } else { Axis::Z };
        let parabola = Parabola { vertex: centre, axis, parameter: half_axes.0 };
        let vertex = Lattice { x: on.x, z: z.nearest(Length::from_nm(centre.1).unwrap()) };
        for (start, end) in [(start, end), (vertex, end), (start, vertex)] {
            if let Ok(conic) = parabola.arc((x, z), start, end) {
                walks(conic.walk());
            }
        }
    }

    #[test]
    fn sampled_curves_of_any_size_end_or_are_refused(
        (a, b, c, d) in (length(), length(), length(), length()), tilt: i64, (from, to) in (any::<i64>(), any::<i64>()),
        (e, f) in (length(), length()),
    ) {
        if let Ok(curve) = TiltedEllipse::new((a, b), (c, d), tilt, (from, to)) { divides(curve); }
        if let Ok(curve) = Hyperbola::new((a, b), (c, d), tilt, (e, f)) { divides(curve); }
        if let Ok(curve) = TiltedParabola::new((a, b), c, tilt, (e, f)) { divides(curve); }
        if let Ok(curve) = SineWave::new((a, b), c, d, tilt, e) { divides(curve); }
        if let Ok(curve) = Spiral::new((a, b), (c, d), from, to) { divides(curve); }
        let points = [(a, b), (c, d), (e, f), (b, a), (f, c)].map(|(x, z)| Point { x, z });
        if let Ok(curve) = Spline::<8>::new(&points) { divides(curve); }
        let weight = |n: i64| Weight::parse(["1", "0.0000001", "65536", "0.7"][usize::try_from(n & 3).unwrap()]).unwrap();
        let control = points.map(|point| (point, weight(i64::from(point.x.nm()) ^ tilt)));
        if let Ok(curve) = Nurbs::new(3, &control, &[0, 0, 0, 0, 1, u32::MAX, u32::MAX, u32::MAX, u32::MAX]) { divides(curve); }
    }
}
