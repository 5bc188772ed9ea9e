//! The classic methods on arcs with any centre and any pulse sizes: exact ends, near the arc, there and back.
#![allow(clippy::unwrap_used, clippy::arithmetic_side_effects, reason = "a test")]
#![allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "an oracle")]

use interp_core::curve::OneWay;
use interp_core::curve::dda::IntegratedArc;
use interp_core::curve::point_comparison::ComparedArc;
use interp_core::curve::prepare_arc::{Metric, Prepared, Reach};
use interp_core::units::{Lattice, Length, PulseSize, Sense};
use proptest::prelude::*;

/// Walks from (0, 0); gives where it ends, the pulses made, and the largest distance from the circle in pulses of the
/// coarser axis.
fn walk(walk: &mut impl OneWay, from: (i64, i64), off: impl Fn(i64, i64) -> f64) -> ((i64, i64), u64, f64) {
    let (mut at, mut worst, mut pulses) = (from, 0.0_f64, 0);
    while let Some(step) = walk.next_step() {
        at = (at.0 + i64::from(step.x), at.1 + i64::from(step.z));
        pulses += u64::from(step.x.unsigned_abs() + step.z.unsigned_abs());
        worst = worst.max(off(at.0, at.1));
        assert!(pulses < 1 << 22, "it ends");
    }
    (at, pulses, worst)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]
    #[test]
    fn classic_arcs_end_exactly_and_stay_within_a_pulse_of_the_walked_circle(
        radius_nm in 30_000.0_f64..1_000_000.0,
        (centre_x, centre_z) in (-500_000_i64..500_000, -500_000_i64..500_000),
        (start, sweep) in (0.0_f64..6.3, 0.1_f64..2.9),
        (size_x, size_z) in (prop_oneof![Just(1000_u32), Just(2500), Just(625), 500_u32..5000], prop_oneof![Just(1000_u32), Just(5000)]),
        clockwise: bool,
    ) {
        let (x, z) = (PulseSize::new(size_x, 1).unwrap(), PulseSize::new(size_z, 1).unwrap());
        let sense = if clockwise { Sense::Clockwise } else { Sense::CounterClockwise };
        let place = |angle: f64| {
            let nm = |v: f64| Length::from_nm(v.round() as i64).unwrap();
            let (dx, dz) = (radius_nm * angle.sin(), radius_nm * angle.cos());
            Lattice { x: x.nearest(nm(centre_x as f64 + dx)), z: z.nearest(nm(centre_z as f64 + dz)) }
        };
        let (from, to) = (place(start), place(if clockwise { start - sweep } else { start + sweep }));
        let Prepared::Arc(arc, _) = Metric::new(x, z).arc(from, to, (centre_x, centre_z), sense, Reach::Short) else {
            return Ok(());
        };
        let coarser = f64::from(size_x.max(size_z));
        // the walked circle: its centre is the programmed one, moved onto the perpendicular bisector of the rounded ends
        let mm = |at: Lattice| (f64::from(at.x) * f64::from(size_x), f64::from(at.z) * f64::from(size_z));
        let ((from_x, from_z), (to_x, to_z)) = (mm(from), mm(to));
        let (dx, dz) = (to_x - from_x, to_z - from_z);
        let (mid_x, mid_z) = (from_x.midpoint(to_x), from_z.midpoint(to_z));
        let moved = ((mid_x - centre_x as f64) * dx + (mid_z - centre_z as f64) * dz) / (dx * dx + dz * dz);
        let (walked_x, walked_z) = (centre_x as f64 + moved * dx, centre_z as f64 + moved * dz);
        let walked = (from_x - walked_x).hypot(from_z - walked_z);
        let off = |px: i64, pz: i64| {
            let dx = px as f64 * f64::from(size_x) + from_x - walked_x;
            let dz = pz as f64 * f64::from(size_z) + from_z - walked_z;
            (dx.hypot(dz) - walked).abs() / coarser
        };
        // a pulse; and where a step passes an axis of the circle half a pulse of that on its far side
        let bound = 1.0 + coarser / (2.0 * walked) + 1e-4;
        let end = arc.end();
        let end = (i64::from(end.0), i64::from(end.1));
        let mut compared = ComparedArc::new(&arc);
        let (at, _, worst) = walk(&mut compared, (0, 0), off);
        prop_assert_eq!(at, end);
        prop_assert!(worst <= bound, "point comparison {}", worst);
        let (at, _, worst) = walk(&mut compared.reversed(), end, off);
        prop_assert_eq!(at, (0, 0));
        prop_assert!(worst <= bound, "point comparison back {}", worst);
        let mut integrated = IntegratedArc::new(&arc);
        let (at, _, worst) = walk(&mut integrated, (0, 0), off);
        prop_assert_eq!(at, end);
        prop_assert!(worst <= bound, "dda {}", worst);
        let (at, _, worst) = walk(&mut integrated.reversed(), end, off);
        prop_assert_eq!(at, (0, 0));
        prop_assert!(worst <= bound, "dda back {}", worst);
    }
}
