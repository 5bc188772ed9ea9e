//! The fence: whatever path and hands do, the tool stays inside; and what stays inside by itself is not held.
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

use crate::pieces::{Piece, motions};
use interp_core::block::{Block, Work};
use interp_core::channel::{Channel, State};
use interp_core::config::{AxisConfig, Config, Machine};
use interp_core::drive::wheel::Click;
use interp_core::drive::{Drive, Inputs};
use interp_core::law::SpeedLaw;
use interp_core::train::Event;
use interp_core::units::{Axis, Feedrate, Lattice, PulseSize};
use proptest::prelude::*;

const FAR: i32 = i32::MAX >> 1;

fn machine(law: SpeedLaw) -> Machine {
    let axis = |nm: u32, accel: u32| AxisConfig {
        pulse: PulseSize::new(nm, 1).unwrap(),
        max_feed: Feedrate::from_nm_per_min(3_000_000_000).unwrap(),
        max_accel: accel * 1_000,
        max_jump: 2_000,
        pulse_width_ns: 5_000,
        dir_setup_ns: 5_000,
        dir_hold_ns: 10_000,
        min_space_ns: 5_000,
    };
    let config = Config { x: axis(1250, 300), z: axis(2500, 700), event_min_ns: 2_000 };
    config.check().unwrap().with_hands().with_law(law, 50_000).unwrap()
}

fn pieces() -> impl Strategy<Value = Vec<Piece>> {
    let piece = prop_oneof![
        (-3_000..3_000_i32, -3_000..3_000_i32).prop_map(|(x, z)| Piece::Line(x, z)),
        (-50..50_i32, -50..50_i32).prop_map(|(x, z)| Piece::Line(x, z)),
        (100..1_500_i32, any::<bool>()).prop_map(|(radius, left)| Piece::Half(radius, left)),
    ];
    prop::collection::vec(piece, 1..12)
}

/// What an operator does: ticks until then, which wheel (X, Z, contour), counts a tick, for how many ticks.
type Turn = (u32, u8, i16, u32);

fn place(channel: &Channel<16>) -> Lattice {
    let (at, offset) = (channel.position(), channel.offset());
    Lattice { x: at.x + offset.x, z: at.z + offset.z }
}

/// Runs a program beside turns, from a tick on inside a fence, and looks at each tick from then on. Whether it was held, and where
/// the tool was at least and at most.
fn run(
    law: SpeedLaw,
    wheel: bool,
    pieces: &[Piece],
    turns: &[Turn],
    (from, fence): (usize, (Lattice, Lattice)),
) -> Result<(bool, Lattice, Lattice), TestCaseError> {
    let machine = machine(law);
    let motions = motions(&machine, pieces, 1_500);
    let mut blocks = motions.iter().map(|motion| Block { line: 1, work: Work::Motion(*motion) });
    let mut channel = Channel::<16>::new(&machine, Lattice { x: 0, z: 0 });
    let click = Click::from_nm(100_000).unwrap();
    if wheel {
        channel.set_drive(Drive::Wheel(click)).unwrap();
    }
    channel.start();
    channel.close();
    let (mut held, mut least, mut most) = (false, place(&channel), place(&channel));
    let mut ticks = vec![[0_i16; 3]; 200];
    for (after, which, counts, lasts) in turns {
        ticks.resize(ticks.len() + *after as usize, [0; 3]);
        ticks.resize(ticks.len() + *lasts as usize, [0, 1, 2].map(|w| if w == *which { *counts } else { 0 }));
    }
    ticks.resize(ticks.len() + 4_000, [0; 3]);
    for (tick, [x, z, contour]) in ticks.into_iter().enumerate() {
        if tick == from {
            channel.set_fence(fence.0, fence.1);
            (least, most) = (place(&channel), place(&channel));
        }
        for (axis, counts) in [(Axis::X, x), (Axis::Z, z)] {
            channel.turn_hand(axis, click, counts, (-FAR, FAR));
        }
        channel.read(&Inputs { spindle: None, wheel: contour });
        channel.tick(&mut || blocks.next(), &mut |_: Event| {});
        let at = place(&channel);
        let inside = at.x >= fence.0.x && at.x <= fence.1.x && at.z >= fence.0.z && at.z <= fence.1.z;
        prop_assert!(inside || tick < from, "tick {tick}: {at:?} of {fence:?}");
        least = Lattice { x: least.x.min(at.x), z: least.z.min(at.z) };
        most = Lattice { x: most.x.max(at.x), z: most.z.max(at.z) };
        held |= channel.met_fence().is_some();
        // a hold at the fence is gone on from now and then
        if channel.state() == State::Holding && channel.speed() == 0 && channel.hands_rest() && tick % 64 == 0 {
            channel.start();
        }
    }
    Ok((held, least, most))
}

fn turns() -> impl Strategy<Value = Vec<Turn>> {
    prop::collection::vec((0..500_u32, 0..3_u8, -30..30_i16, 1..400_u32), 0..8)
}

fn laws() -> impl Strategy<Value = SpeedLaw> {
    prop_oneof![Just(SpeedLaw::Linear), Just(SpeedLaw::Parabolic), Just(SpeedLaw::Sine)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn neither_path_nor_hands_leave_the_fence(
        law in laws(), wheel: bool, pieces in pieces(), turns in turns(),
        minus in (0..2_500_i32, 0..1_500_i32), plus in (0..2_500_i32, 0..1_500_i32)
    ) {
        let fence = (Lattice { x: -minus.0, z: -minus.1 }, Lattice { x: plus.0, z: plus.1 });
        run(law, wheel, &pieces, &turns, (0, fence))?;
    }

    /// A path that ends, or turns, right at the fence runs through; without hands it is held only where it does lead out, wherever
    /// it came from.
    #[test]
    fn a_path_that_stays_inside_is_not_held(law in laws(), pieces in pieces(), from in 0..3_000_usize) {
        let nowhere = (Lattice { x: -FAR, z: -FAR }, Lattice { x: FAR, z: FAR });
        let (_, least, most) = run(law, false, &pieces, &[], (from, nowhere))?;
        // an arc's extreme is known to a pulse
        let fence = (Lattice { x: least.x - 2, z: least.z - 2 }, Lattice { x: most.x + 2, z: most.z + 2 });
        let (held, low, high) = run(law, false, &pieces, &[], (from, fence))?;
        prop_assert!(!held);
        prop_assert_eq!((low, high), (least, most));
    }

    /// One pulse less, and it is held.
    #[test]
    fn a_path_that_leads_out_is_held(law in laws(), pieces in pieces(), side in 0..4) {
        let nowhere = (Lattice { x: -FAR, z: -FAR }, Lattice { x: FAR, z: FAR });
        let (_, least, most) = run(law, false, &pieces, &[], (0, nowhere))?;
        let mut fence = nowhere;
        let (limit, met) = match side {
            0 => (&mut fence.0.x, least.x + 1),
            1 => (&mut fence.0.z, least.z + 1),
            2 => (&mut fence.1.x, most.x - 1),
            _ => (&mut fence.1.z, most.z - 1),
        };
        prop_assume!(if side < 2 { met <= 0 } else { met >= 0 });
        *limit = met;
        let (held, ..) = run(law, false, &pieces, &[], (0, fence))?;
        prop_assert!(held);
    }
}
