//! Ellipses and parabolas in parts, and sampled curves in chains: the parts make the whole's steps, their lengths are
//! those of closed forms, and hostile figures are refused or built, never worse.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::arithmetic_side_effects,
    missing_docs,
    reason = "tests, with oracles in f64"
)]

use interp_core::block::{Builder, Chain, Curve, Motion, Pace, Pieces};
use interp_core::config::{AxisConfig, Config, Machine};
use interp_core::curve::arc::Arc;
use interp_core::curve::conic::{Conic, Ellipse, Parabola};
use interp_core::curve::conic_piece::ConicPiece;
use interp_core::curve::prepare_arc::Reach;
use interp_core::curve::{Step, Walker};
use interp_core::sampled::curves::{Hyperbola, SineWave, Spiral, TiltedEllipse, TiltedParabola};
use interp_core::sampled::nurbs::{Nurbs, Weight};
use interp_core::sampled::spline::Spline;
use interp_core::sampled::{CurveRefusal, Sampled};
use interp_core::units::{Axis, Feedrate, Lattice, Length, Point, PulseSize, Sense};
use proptest::prelude::*;

fn machine(x: PulseSize, z: PulseSize) -> Machine {
    let axis = |pulse: PulseSize| AxisConfig {
        pulse,
        max_feed: Feedrate::from_nm_per_min(
            40_000 * 60 * u64::from(pulse.numerator()) / u64::from(pulse.denominator()),
        )
        .unwrap(),
        max_accel: 500_000,
        max_jump: 1000,
        pulse_width_ns: 2_500,
        dir_setup_ns: 5_000,
        dir_hold_ns: 5_000,
        min_space_ns: 2_500,
    };
    Config { x: axis(x), z: axis(z), event_min_ns: 1_000 }.check().unwrap()
}

fn nm(value: i64) -> Length {
    Length::from_nm(value).unwrap()
}

const RAPID: Pace = Pace::Rapid;

/// The parts of a conic walk as the whole, and each of them back.
fn same_steps(conic: &Conic, motions: &[Motion]) {
    let mut whole = conic.walk();
    for (number, motion) in motions.iter().enumerate() {
        let Curve::Conic(piece) = &motion.curve else { panic!("a part") };
        let (mut walker, mut steps, mut at) = (piece.walk(), Vec::new(), (0, 0));
        while let Some(step) = walker.next_step() {
            assert_eq!(Some(step), whole.next_step(), "part {number} after {}", steps.len());
            at = (at.0 + i32::from(step.x), at.1 + i32::from(step.z));
            steps.push(step);
        }
        assert_eq!(at, piece.end(), "part {number}");
        assert_eq!(motion.continues, number + 1 < motions.len());
        while let Some(back) = walker.previous_step() {
            let step = steps.pop().unwrap();
            assert_eq!(back, Step { x: -step.x, z: -step.z }, "part {number} back");
        }
        assert!(steps.is_empty(), "part {number} goes back to its start");
    }
    assert_eq!(whole.next_step(), None);
}

fn total(motions: &[Motion]) -> f64 {
    motions.iter().map(|motion| motion.length as f64 / 4096.0).sum()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_parts_of_an_ellipse_walk_as_the_whole(
        (half_x, half_z) in (3_000_i64..4_000_000, 3_000_i64..4_000_000),
        (size_x, size_z) in (500_u32..6_000, 500_u32..6_000),
        (from, sweep) in (0.0_f64..6.3, 0.1_f64..6.2), clockwise: bool, whole: bool,
    ) {
        let (x, z) = (PulseSize::new(size_x, 1).unwrap(), PulseSize::new(size_z, 3).unwrap());
        let place = |angle: f64| Point {
            x: nm((half_x as f64 * angle.sin()) as i64),
            z: nm((half_z as f64 * angle.cos()) as i64),
        };
        let sense = if clockwise { Sense::Clockwise } else { Sense::CounterClockwise };
        let start = place(from);
        let end = if whole { start } else { place(if clockwise { from - sweep } else { from + sweep }) };
        let reach = if whole || sweep > 3.15 { Reach::Long } else { Reach::Short };
        let ellipse = Ellipse { centre: (0, 0), half_axes: (nm(half_x), nm(half_z)) };
        let machine = machine(x, z);
        let mut builder = Builder::new(&machine, start);
        let at = builder.lattice();
        let Ok(mut pieces) = Pieces::ellipse(&builder, &ellipse, end, (sense, reach), RAPID) else { return Ok(()) };
        let motions: Vec<_> = std::iter::from_fn(|| pieces.next_motion(&mut builder)).collect();
        let to = Lattice { x: x.nearest(end.x), z: z.nearest(end.z) };
        same_steps(&ellipse.arc((x, z), at, to, (sense, reach)).unwrap(), &motions);
        prop_assert_eq!(builder.lattice(), to);
    }

    #[test]
    fn the_parts_of_a_parabola_walk_as_the_whole(
        parameter in 2_000_i64..3_000_000, negative: bool, along_x: bool,
        (size_x, size_z) in (500_u32..6_000, 500_u32..6_000),
        (from, to) in (-2_000_000_i64..2_000_000, -2_000_000_i64..2_000_000),
    ) {
        let (x, z) = (PulseSize::new(size_x, 1).unwrap(), PulseSize::new(size_z, 3).unwrap());
        let sign = if negative { -1 } else { 1 };
        let axis = if along_x { Axis::X } else { Axis::Z };
        let place = |u: i64| {
            let v = sign * u * u / 2 / parameter;
            Length::from_nm(v).map(|v| if along_x { Point { x: v, z: nm(u) } } else { Point { x: nm(u), z: v } })
        };
        let (Some(start), Some(end)) = (place(from), place(to)) else { return Ok(()) };
        prop_assume!(start.x.nm().abs().max(start.z.nm().abs()) < 50_000_000);
        prop_assume!(end.x.nm().abs().max(end.z.nm().abs()) < 50_000_000);
        let parabola = Parabola { vertex: (0, 0), axis, parameter: nm(sign * parameter) };
        let machine = machine(x, z);
        let mut builder = Builder::new(&machine, start);
        let at = builder.lattice();
        let Ok(mut pieces) = Pieces::parabola(&builder, &parabola, end, RAPID) else { return Ok(()) };
        let motions: Vec<_> = std::iter::from_fn(|| pieces.next_motion(&mut builder)).collect();
        same_steps(&parabola.arc((x, z), at, builder.lattice()).unwrap(), &motions);
    }
}

/// Circumference of an ellipse by the arithmetic-geometric mean: 2 pi (a^2 - sum 2^(n-1) c_n^2) / agm(a, b).
fn circumference(a: f64, b: f64) -> f64 {
    let (mut x, mut y, mut weight) = (a.max(b), a.min(b), 0.5);
    let (mut sum, mut gap) = (x * x, (x * x - y * y).sqrt());
    for _ in 0..30 {
        sum -= weight * gap * gap;
        weight *= 2.0;
        gap = (x - y) / 2.0;
        (x, y) = (f64::midpoint(x, y), (x * y).sqrt());
    }
    2.0 * std::f64::consts::PI * sum / x
}

/// Between vertices that are lattice points the walked ellipse is the programmed one.
#[test]
fn lengths_of_ellipses_are_their_elliptic_integrals() {
    for (px, pz) in [(1_000, 1_000), (1_250, 2_500), (10, 10), (400, 5_000)] {
        let machine = machine(PulseSize::new(px, 1).unwrap(), PulseSize::new(pz, 1).unwrap());
        for (x, z) in [(5, 5), (40, 7), (300, 300), (20_000, 1_300), (7_000, 400_000), (150_000, 149_000)] {
            let (half_x, half_z) = (i64::from(px) * x, i64::from(pz) * z);
            let ellipse = Ellipse { centre: (0, 0), half_axes: (nm(half_x), nm(half_z)) };
            let top = Point { x: nm(half_x), z: nm(0) };
            for (end, reach, part) in [
                (top, Reach::Long, 1.0),
                (Point { x: nm(-half_x), z: nm(0) }, Reach::Short, 0.5),
                (Point { x: nm(0), z: nm(half_z) }, Reach::Short, 0.25),
            ] {
                let mut builder = Builder::new(&machine, top);
                let way = (Sense::Clockwise, reach);
                let mut pieces = Pieces::ellipse(&builder, &ellipse, end, way, RAPID).unwrap();
                let motions: Vec<_> = std::iter::from_fn(|| pieces.next_motion(&mut builder)).collect();
                let exact = circumference(half_x as f64, half_z as f64) * part;
                let found = total(&motions);
                assert!(
                    (found / exact - 1.0).abs() < 1e-6 || (found - exact).abs() < 0.01,
                    "{px} {pz} {x} {z}: {found}, not {exact}: {:e}",
                    found / exact - 1.0
                );
            }
        }
    }
}

#[test]
fn lengths_of_parabolas_are_their_closed_form() {
    let machine = machine(PulseSize::ONE_MICROMETRE, PulseSize::new(500, 1).unwrap());
    // from the vertex to (u, u^2 / 2 p), both lattice points, nm
    for (p, u) in [(8_000_i64, 40_000_i64), (500, 10_000), (2_000_000, 60_000_000), (50_000_000, 1_000_000)] {
        let end = Point { x: nm(u), z: nm(u * u / 2 / p) };
        let mut builder = Builder::new(&machine, Point::default());
        let parabola = Parabola { vertex: (0, 0), axis: Axis::Z, parameter: nm(p) };
        let mut pieces = Pieces::parabola(&builder, &parabola, end, RAPID).unwrap();
        let motions: Vec<_> = std::iter::from_fn(|| pieces.next_motion(&mut builder)).collect();
        let (p, u) = (p as f64, u as f64);
        let exact = u / 2.0 * (u / p).hypot(1.0) + p / 2.0 * (u / p).asinh();
        let found = total(&motions);
        // a vertex bent more sharply than a pulse is entered where the minor coordinate has no slope
        let sharp = p < 1_000.0 && (found - exact).abs() < 0.25;
        assert!((found / exact - 1.0).abs() < 1e-6 || sharp, "{p} {u}: {found}, not {exact}");
    }
}

/// A motion grows by no curve of this feature: the look-ahead holds 64 of them.
#[test]
fn a_part_of_a_conic_is_no_larger_than_an_arc() {
    assert!(size_of::<ConicPiece>() <= size_of::<Arc>(), "{} {}", size_of::<ConicPiece>(), size_of::<Arc>());
}

/// The first motions of a chain, or its refusal, which explains itself.
fn chained(machine: &Machine, start: Point, curve: Result<impl Sampled, CurveRefusal>) {
    let explains = |why: &dyn std::fmt::Display| assert!(why.to_string().contains(": "), "{why}");
    let curve = match curve {
        Ok(curve) => curve,
        Err(why) => return explains(&why),
    };
    let mut builder = Builder::new(machine, start);
    let mut chain = match Chain::new(&builder, curve, RAPID) {
        Ok(chain) => chain,
        Err(why) => return explains(&why),
    };
    for _ in 0..40 {
        let at = builder.lattice();
        match chain.next_motion(&mut builder) {
            None => return,
            Some(Err(why)) => {
                assert_eq!(builder.lattice(), at);
                return explains(&why);
            }
            Some(Ok(motion)) => sound(&motion),
        }
    }
}

fn sound(motion: &Motion) {
    assert!(motion.length > 0 && motion.limit > 0 && motion.accel > 0, "{motion:?}");
    let (x, z) = motion.curve.end();
    assert!(matches!(motion.curve, Curve::Conic(_)) || (x, z) != (0, 0));
}

/// Often at an end of the range, often small, often round.
fn length() -> impl Strategy<Value = i64> {
    let limit = i64::from(Length::LIMIT_NM);
    prop_oneof![
        -limit..=limit,
        -3_000_i64..3_000,
        Just(0),
        Just(1),
        Just(-1),
        Just(limit),
        Just(-limit),
        (0_u32..31).prop_map(|bits| 1_i64 << bits),
    ]
}

fn pulse() -> impl Strategy<Value = PulseSize> {
    prop_oneof![Just((10, 1)), Just((1_000_000, 1)), Just((1_000, 1)), Just((15_875, 8)), (1_u32..1 << 24, 1_u32..4096)]
        .prop_filter_map("no pulse", |(num, den)| PulseSize::new(num, den))
}

fn machines() -> impl Strategy<Value = Machine> {
    (pulse(), pulse()).prop_filter_map("no machine", |(x, z)| {
        let ratio = |p: PulseSize| f64::from(p.numerator()) / f64::from(p.denominator());
        let (a, b) = (ratio(x), ratio(z));
        let fits = a.max(b) < 12_000.0 && a.max(b) / a.min(b) < 100.0;
        fits.then(|| machine(x, z))
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn hostile_curves_are_built_or_refused(
        machine in machines(), a in [length(), length()], b in [length(), length()], c in [length(), length()],
        tilt: i64, from: i64, to: i64,
    ) {
        let both = |v: [i64; 2]| (nm(v[0]), nm(v[1]));
        let start = |curve: &dyn Sampled| {
            let (x, z) = curve.at(0);
            match (Length::from_nm((x + 2048) >> 12), Length::from_nm((z + 2048) >> 12)) {
                (Some(x), Some(z)) => Point { x, z },
                _ => Point::default(),
            }
        };
        macro_rules! try_out {
            ($curve:expr) => {{
                let curve = $curve;
                chained(&machine, curve.as_ref().map_or(Point::default(), |curve| start(curve)), curve);
            }};
        }
        try_out!(TiltedEllipse::new(both(a), both(b), tilt, (from, to)));
        try_out!(Hyperbola::new(both(a), both(b), tilt, both(c)));
        try_out!(TiltedParabola::new(both(a), nm(b[0]), tilt, both(c)));
        try_out!(SineWave::new(both(a), nm(b[0]), nm(b[1]), from, nm(c[0])));
        try_out!(Spiral::new(both(a), both(b), from, to));
        try_out!(Spiral::new(both(a), both(b), from, to >> 28));
        let at = |v: [i64; 2]| Point { x: nm(v[0]), z: nm(v[1]) };
        try_out!(Spline::<4>::new(&[at(a), at(b), at(c)]));
        let weight = |v: i64| Weight::parse(&format!("{}", v as f64 / 1e4)).unwrap_or(Weight::ONE);
        let control = [(at(a), weight(b[0])), (at(b), weight(c[1])), (at(c), weight(a[0])), (at(a), Weight::ONE)];
        let knot = |v: i64| v.unsigned_abs() as u32;
        let mut knots = [0, 0, knot(tilt), knot(from), knot(to), u32::MAX, u32::MAX];
        try_out!(Nurbs::new(2, &control, &knots));
        knots.sort_unstable();
        try_out!(Nurbs::new(2, &control, &knots));
    }

    #[test]
    fn hostile_conics_are_built_or_refused(
        machine in machines(), centre in [length(), length()], half in [length(), length()], turns in [0.0_f64..1.0, 0.0_f64..1.0],
        end in [length(), length()], on_curve: bool, long: bool, clockwise: bool,
    ) {
        let place = |turn: f64| {
            let angle = turn * std::f64::consts::TAU;
            let of = |k: usize, part: f64| Length::from_nm(centre[k] + (half[k] as f64 * part).round() as i64);
            Some(Point { x: of(0, angle.sin())?, z: of(1, angle.cos())? })
        };
        let far = Point { x: nm(end[0]), z: nm(end[1]) };
        let start = place(turns[0]).unwrap_or_default();
        let to = if on_curve { place(turns[1]).unwrap_or_default() } else { far };
        let way = (
            if clockwise { Sense::Clockwise } else { Sense::CounterClockwise },
            if long { Reach::Long } else { Reach::Short },
        );
        let ellipse = Ellipse { centre: (centre[0], centre[1]), half_axes: (nm(half[0]), nm(half[1])) };
        let parabola = Parabola {
            vertex: (centre[0], centre[1]),
            axis: if long { Axis::X } else { Axis::Z },
            parameter: nm(half[0]),
        };
        let mut builder = Builder::new(&machine, start);
        let made = [
            Pieces::ellipse(&builder, &ellipse, to, way, RAPID),
            Pieces::parabola(&builder, &parabola, to, RAPID),
        ];
        for pieces in made {
            match pieces {
                Err(why) => prop_assert!(why.to_string().contains(": "), "{}", why),
                Ok(mut pieces) => {
                    for _ in 0..40 {
                        let Some(motion) = pieces.next_motion(&mut builder) else { break };
                        sound(&motion);
                    }
                }
            }
        }
    }
}
