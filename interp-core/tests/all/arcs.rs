//! Invariants 1 to 3 for arcs: half a pulse from the walked circle, the exact end, the same points back.
//!
//! The oracle is the circle itself in `f64`: through both rounded ends, centre moved onto their bisector.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    clippy::unwrap_used,
    clippy::panic,
    missing_docs,
    reason = "a test whose oracle is in f64"
)]

use interp_core::curve::Walker;
use interp_core::curve::prepare_arc::{Metric, Prepared, Reach};
use interp_core::units::{Lattice, PulseSize, Sense};
use proptest::prelude::*;

struct Case {
    pulses: (PulseSize, PulseSize),
    /// X, Z in nm.
    centre: (i64, i64),
    radius: f64,
    /// Radians.
    from: f64,
    sweep: f64,
    sense: Sense,
}

impl Case {
    fn reach(&self) -> Reach {
        if self.sweep > std::f64::consts::PI { Reach::Long } else { Reach::Short }
    }
}

fn nm(pulse: PulseSize) -> f64 {
    f64::from(pulse.numerator()) / f64::from(pulse.denominator())
}

/// What the walk of a case showed; `None` where there is no arc to walk.
fn walk(case: &Case) -> Option<(f64, u32)> {
    let (px, pz) = (nm(case.pulses.0), nm(case.pulses.1));
    let turn = if case.sense == Sense::CounterClockwise { case.sweep } else { -case.sweep };
    let place = |angle: f64| Lattice {
        x: ((case.centre.0 as f64 + case.radius * angle.sin()) / px + 0.5).floor() as i32,
        z: ((case.centre.1 as f64 + case.radius * angle.cos()) / pz + 0.5).floor() as i32,
    };
    let (start, end) = (place(case.from), place(case.from + turn));
    let metric = Metric::new(case.pulses.0, case.pulses.1);
    let delta = (start.x - end.x).abs().max((start.z - end.z).abs());
    let arc = match metric.arc(start, end, case.centre, case.sense, case.reach()) {
        Prepared::Arc(arc, _) => arc,
        Prepared::Chord if delta > 1 && case.radius > 1.5 * px.max(pz) => panic!("a chord from {start:?} to {end:?}"),
        Prepared::Chord | Prepared::Nothing => return None,
    };
    // the walked circle, relative to the start, nm
    let (cx, cz) = (case.centre.0 as f64 - f64::from(start.x) * px, case.centre.1 as f64 - f64::from(start.z) * pz);
    let (ex, ez) = (f64::from(end.x - start.x) * px, f64::from(end.z - start.z) * pz);
    let chord = ex * ex + ez * ez;
    let shift = if chord > 0.0 { 0.5 - (cx * ex + cz * ez) / chord } else { 0.0 };
    // the builder walks a long arc whole only where its centre hardly moves
    if case.sweep > std::f64::consts::PI && shift.abs() * chord.sqrt() > px.max(pz) {
        return None;
    }
    let (cx, cz) = (cx + shift * ex, cz + shift * ez);
    let radius = cx.hypot(cz);
    let label = format!("{start:?} {end:?} {:?} {:?} R {radius}", case.centre, case.sense);
    let relative = (arc.radius() as f64 / 4096.0 - radius).abs() / radius;
    assert!(relative < 1e-6, "{label}: radius {}", arc.radius() as f64 / 4096.0);

    let mut walker = arc.walk();
    let coarse = px.max(pz);
    let (mut at, mut visited, mut worst, mut swept) = ((0_i32, 0_i32), vec![(0, 0)], 0.0_f64, 0.0_f64);
    let angle = |(x, z): (i32, i32)| (f64::from(x) * px - cx).atan2(f64::from(z) * pz - cz);
    while let Some(step) = walker.next_step() {
        assert!(step.x != 0 || step.z != 0, "{label}: empty step after {at:?}");
        let before = angle(at);
        at = (at.0 + i32::from(step.x), at.1 + i32::from(step.z));
        let mut gain = angle(at) - before;
        gain -= (gain / std::f64::consts::TAU).round() * std::f64::consts::TAU;
        swept += if case.sense == Sense::CounterClockwise { gain } else { -gain };
        let off = ((f64::from(at.0) * px - cx).hypot(f64::from(at.1) * pz - cz) - radius).abs();
        worst = worst.max(off / coarse);
        visited.push(at);
        assert!(visited.len() < 100_000_000);
    }
    assert_eq!(at, (end.x - start.x, end.z - start.z), "{label}: end");
    let length = arc.length() as f64 / 4096.0;
    assert!(
        radius < 2.0 * coarse || swept > -1e-9,
        "{label}: went backward by {swept}, visited {:?}",
        visited.get(..12)
    );
    let turned = length / radius;
    assert!(radius < 2.0 * coarse || (turned - swept).abs() < 1e-6, "{label}: swept {swept}, length says {turned}");
    // the extent holds all steps, and each of its sides is met to a pulse or two, and what a coarse pulse steps over
    let over = (coarse * coarse / (2.0 * radius * px.min(pz))) as i32;
    let ((x0, z0), (x1, z1)) = interp_core::block::Curve::Arc(arc).extent();
    let least = visited.iter().fold((0, 0), |m: (i32, i32), p| (m.0.min(p.0), m.1.min(p.1)));
    let most = visited.iter().fold((0, 0), |m: (i32, i32), p| (m.0.max(p.0), m.1.max(p.1)));
    for (bound, met) in [(-x0, -least.0), (-z0, -least.1), (x1, most.0), (z1, most.1)] {
        assert!((met..=met + 2 + over).contains(&bound), "{label}: extent {bound}, met {met}");
    }
    let count = visited.len() as u32 - 1;
    visited.pop();
    while let Some(step) = walker.previous_step() {
        at = (at.0 + i32::from(step.x), at.1 + i32::from(step.z));
        assert_eq!(visited.pop(), Some(at), "{label}: way back");
    }
    assert!(visited.is_empty(), "{label}: way back ends early, {} left", visited.len());
    Some((worst, count))
}

fn pulse_pairs() -> impl Strategy<Value = (PulseSize, PulseSize)> {
    prop_oneof![
        Just((1250, 1, 2500, 1)),
        Just((1000, 1, 1000, 1)),
        Just((15875, 8, 2500, 1)),
        Just((5000, 1, 10000, 1)),
        Just((10_000, 3, 12_700, 7)),
        Just((16_777_213, 4093, 16_777_199, 4095)),
        Just((500, 1, 40_000, 1)),
    ]
    .prop_map(|(a, b, c, d)| (PulseSize::new(a, b).unwrap(), PulseSize::new(c, d).unwrap()))
}

fn sense() -> impl Strategy<Value = Sense> {
    prop_oneof![Just(Sense::Clockwise), Just(Sense::CounterClockwise)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]
    #[test]
    fn arcs_stay_within_half_a_pulse_and_walk_back(
        pulses in pulse_pairs(),
        centre in (-1_000_000_000_i64..1_000_000_000, -1_000_000_000_i64..1_000_000_000),
        log_radius in 0.5_f64..16.0,
        from in 0.0..std::f64::consts::TAU,
        sweep in prop_oneof![2 => 0.001..std::f64::consts::PI, 1 => 3.15..6.25_f64, 1 => Just(std::f64::consts::TAU)],
        sense in sense(),
    ) {
        let coarse = nm(pulses.0).max(nm(pulses.1));
        let radius = coarse * log_radius.exp2();
        if let Some((worst, _)) = walk(&Case { pulses, centre, radius, from, sweep, sense }) {
            prop_assert!(worst <= 0.5 + 1e-6, "deviation {worst}");
        }
    }
}

/// Every centre on a fine grid, small radii, every pair of ends on a coarse set of angles.
#[test]
fn small_arcs_in_full() {
    let pulses = (PulseSize::new(1000, 1).unwrap(), PulseSize::new(1000, 1).unwrap());
    let wide = (PulseSize::new(1000, 1).unwrap(), PulseSize::new(2000, 1).unwrap());
    let (mut walked, mut worst) = (0_u32, 0.0_f64);
    for pulses in [pulses, wide] {
        for radius in (12..=80).map(|k| f64::from(k) * 100.0) {
            for (cx, cz) in [(0, 0), (500, 0), (0, 500), (500, 500), (250, 130), (790, 410), (999, 1)] {
                for from in 0..16 {
                    for sweep in 1..=16 {
                        for sense in [Sense::Clockwise, Sense::CounterClockwise] {
                            let case = Case {
                                pulses,
                                centre: (cx, cz),
                                radius,
                                from: f64::from(from) * std::f64::consts::PI / 8.0,
                                sweep: f64::from(sweep) * std::f64::consts::PI / 8.0,
                                sense,
                            };
                            if let Some((off, _)) = walk(&case) {
                                walked += 1;
                                worst = worst.max(off);
                                assert!(
                                    off <= 0.5 + 1e-6,
                                    "R {radius} about {cx},{cz} from {from} by {sweep} {sense:?}: {off}"
                                );
                            }
                        }
                    }
                }
            }
        }
    }
    assert!(walked > 100_000, "only {walked} arcs walked");
}

/// The largest radii with the finest pulses: too long to walk whole, so a stretch after each of many starts.
#[test]
fn the_largest_arcs_with_the_finest_pulses_stay_on_the_circle() {
    for (px, pz) in [((10, 1), (10, 1)), ((10, 1), (1280, 1)), ((41, 4), (31, 3)), ((1_000_000, 1), (1_000_000, 1))] {
        let pulses = (PulseSize::new(px.0, px.1).unwrap(), PulseSize::new(pz.0, pz.1).unwrap());
        let metric = Metric::new(pulses.0, pulses.1);
        let (x_nm, z_nm) = (nm(pulses.0), nm(pulses.1));
        for start in 0..12 {
            let radius = 2.05e9;
            let place = |angle: f64| Lattice {
                x: (radius * angle.sin() / x_nm + 0.5).floor() as i32,
                z: (radius * angle.cos() / z_nm + 0.5).floor() as i32,
            };
            let from = f64::from(start) * 0.5 + 0.1;
            let (a, b) = (place(from), place(from - 3.0));
            let Prepared::Arc(arc, _) = metric.arc(a, b, (0, 0), Sense::Clockwise, Reach::Short) else {
                panic!("no arc")
            };
            let (ex, ez) = (f64::from(b.x - a.x) * x_nm, f64::from(b.z - a.z) * z_nm);
            let (cx, cz) = (-f64::from(a.x) * x_nm, -f64::from(a.z) * z_nm);
            let shift = 0.5 - (cx * ex + cz * ez) / (ex * ex + ez * ez);
            let (cx, cz) = (cx + shift * ex, cz + shift * ez);
            let circle = cx.hypot(cz);
            let mut walker = arc.walk();
            let (mut at, mut worst, mut count) = ((0_i32, 0_i32), 0.0_f64, 0);
            while let Some(step) = walker.next_step() {
                at = (at.0 + i32::from(step.x), at.1 + i32::from(step.z));
                let off = (f64::from(at.0) * x_nm - cx).hypot(f64::from(at.1) * z_nm - cz) - circle;
                worst = worst.max(off.abs() / x_nm.max(z_nm));
                count += 1;
                if count == 400_000 {
                    break;
                }
            }
            // coefficients of 64 bits leave a 32nd of a pulse at the very end of the range (see prepare_arc)
            assert!(worst <= 0.5 + 0.04, "{px:?} {pz:?} from {from}: {worst}");
        }
    }
}
