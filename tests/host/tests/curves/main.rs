//! Every curve kind through builder and channel, against its own equation in `f64`: where the steps are, where they end,
//! how fast the path is run, and what the axes have to bear.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    missing_docs,
    reason = "tests, with oracles in f64"
)]

mod kinds;
mod played;

use host_tests::programs::cases;
use interp_core::block::{Builder, Pace};
use interp_core::config::{AxisConfig, Config, Machine};
use interp_core::units::{Feedrate, PulseSize};
use kinds::{Kind, Sample};
use played::Played;
use proptest::prelude::*;

fn feed(mm_per_min: u32) -> Feedrate {
    Feedrate::from_nm_per_min(u64::from(mm_per_min) * 1_000_000).unwrap()
}

/// A machine; acceleration in mm/s2, the start-stop speed the least there is, so that nothing hides behind it.
fn machine(x: (u32, u32), z: (u32, u32), accel: u32) -> Machine {
    let axis = |(num, den): (u32, u32)| {
        let pulse = PulseSize::new(num, den).unwrap();
        // 80 000 pulses a second
        let most = u64::from(num) * 80_000 * 60 / u64::from(den);
        AxisConfig {
            pulse,
            max_feed: Feedrate::from_nm_per_min(most.min(12_000_000_000)).unwrap(),
            max_accel: accel * 1000,
            max_jump: 10,
            pulse_width_ns: 2_500,
            dir_setup_ns: 5_000,
            dir_hold_ns: 5_000,
            min_space_ns: 2_500,
        }
    };
    Config { x: axis(x), z: axis(z), event_min_ns: 1_000 }.check().unwrap()
}

/// Runs a sample; gives what was played.
fn run(sample: &Sample, machine: &Machine, pace: Pace) -> Played {
    let mut builder = Builder::new(machine, sample.start);
    let at = builder.lattice();
    let motions = sample.motions(&mut builder, pace);
    let played = Played::new(machine, at, &motions);
    assert_eq!(played.end(), builder.lattice(), "{sample:?}: the channel ends where the builder does");
    let rounded = (machine.x.pulse.nearest(sample.end().x), machine.z.pulse.nearest(sample.end().z));
    assert_eq!((played.end().x, played.end().z), rounded, "{sample:?}: the rounded end");
    played
}

fn pulses() -> impl Strategy<Value = ((u32, u32), (u32, u32))> {
    let one = prop_oneof![
        Just((1_250, 1)),
        Just((2_500, 1)),
        Just((1_000, 1)),
        Just((10_000, 7)),
        Just((15_875, 8)),
        Just((5_000, 1)),
        Just((400, 1)),
    ];
    (one.clone(), one)
}

/// A spline with a hairpin whose tip is far narrower than a pulse: there it has to slow down nearly to standstill.
#[test]
fn the_tip_of_a_hairpin_is_taken_slowly() {
    let points = vec![(4603, 2912), (-2187, -6991), (4113, -5841), (-7846, 6066), (8825, -3711)];
    let sample = Sample::new(Kind::Spline { points }, (0, 0));
    let machine = machine((10_000, 7), (10_000, 7), 1330);
    let played = run(&sample, &machine, Pace::Feed(feed(4772)));
    assert_eq!(played.limits(&machine), None);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(100), max_shrink_iters: 60, failure_persistence: None, ..ProptestConfig::default() })]

    /// At any feed, on a slow machine: the steps are near the curve and the axes keep their limits.
    #[test]
    fn steps_stay_near_the_curve_and_axes_within_their_limits(
        sample in Kind::any(), (x, z) in pulses(), mm_per_min in 100_u32..6000, accel in 100_u32..3000,
    ) {
        let machine = machine(x, z, accel);
        let played = run(&sample, &machine, Pace::Feed(feed(mm_per_min)));
        let (bound, inner) = sample.bounds();
        let (off, between) = played.farthest(&machine, &sample, inner);
        let case = || format!("{sample:?} in pulses of {x:?}, {z:?} at {mm_per_min} mm/min, {accel} mm/s2");
        prop_assert!(off <= bound, "{}: {off} pulses off", case());
        prop_assert!(between <= inner, "{}: {between} pulses off between the ends", case());
        if let Some(fault) = played.limits(&machine) {
            prop_assert!(false, "{}: {fault}", case());
        }
    }

    /// On a quick machine the feed is what was asked, from window to window.
    #[test]
    fn the_feed_along_the_curve_is_the_programmed_one(
        sample in Kind::any(), (x, z) in pulses(), mm_per_min in 100_u32..900,
    ) {
        let machine = machine(x, z, 50_000);
        let feed = feed(mm_per_min);
        let played = run(&sample, &machine, Pace::Feed(feed));
        // in a hairpin a step does not tell how far along it is, and the speed has to drop
        if sample.is_wide() {
            let (behind, ahead) = played.feed_error(&machine, &sample, feed);
            // a step is so far from its place at both ends of a window
            let most = 4.0;
            let held = played.held_back(&machine, feed, 50_000.0);
            prop_assert!(behind >= -most - held && ahead <= most,
                "{sample:?} in pulses of {x:?}, {z:?} at {mm_per_min} mm/min: {behind} to {ahead} pulses off in a window");
        }
    }
}
