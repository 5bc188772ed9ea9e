//! Hands beside a path: whatever both do, no axis passes its largest speed; and what the path leaves of it is the hand's.
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

use crate::pieces::{Piece, motions};
use interp_core::block::{Block, Work};
use interp_core::channel::Channel;
use interp_core::config::{AxisConfig, Config, Machine};
use interp_core::drive::wheel::Click;
use interp_core::drive::{Drive, Inputs};
use interp_core::law::SpeedLaw;
use interp_core::train::Event;
use interp_core::units::{Axis, Feedrate, Lattice, PulseSize};
use proptest::prelude::*;

const FAR: i32 = i32::MAX >> 1;

/// Largest speeds of X and Z, mm/min.
const SPEEDS: (i64, i64) = (500, 3_000);

/// X is slow, Z is fast.
fn machine(law: SpeedLaw, pulses: (u32, u32)) -> Machine {
    let axis = |nm: u32, speed: i64, accel: u32| AxisConfig {
        pulse: PulseSize::new(nm, 1).unwrap(),
        max_feed: Feedrate::from_nm_per_min(speed.cast_unsigned() * 1_000_000).unwrap(),
        max_accel: accel * 1_000,
        max_jump: 2_000,
        pulse_width_ns: 2_500,
        dir_setup_ns: 2_500,
        dir_hold_ns: 2_500,
        min_space_ns: 2_500,
    };
    let config = Config { x: axis(pulses.0, SPEEDS.0, 300), z: axis(pulses.1, SPEEDS.1, 700), event_min_ns: 2_000 };
    config.check().unwrap().with_hands().with_law(law, 25_000).unwrap()
}

fn pieces() -> impl Strategy<Value = Vec<Piece>> {
    let piece = prop_oneof![
        (-300..300_i32, -3_000..3_000_i32).prop_map(|(x, z)| Piece::Line(x, z)),
        (-3_000..3_000_i32, -3_000..3_000_i32).prop_map(|(x, z)| Piece::Line(x, z)),
        (40..1_500_i32, any::<bool>()).prop_map(|(radius, left)| Piece::Half(radius, left)),
        (40..200_i32, any::<bool>()).prop_map(|(radius, left)| Piece::Half(radius, left)),
    ];
    let some = prop::collection::vec(piece, 1..12);
    // a smooth curve of short chords, from along Z to along X
    let chords = (2..60_u32, 3.0..200.0_f64).prop_map(|(count, length)| {
        let chord = |n: u32| {
            let angle = f64::from(n) / f64::from(count) * std::f64::consts::FRAC_PI_2;
            #[allow(clippy::cast_possible_truncation, reason = "below 200")]
            Piece::Line((length * angle.sin()) as i32, (length * angle.cos()) as i32)
        };
        (0..count).map(|_| Piece::Line(0, 100)).chain((0..=count).map(chord)).collect()
    });
    prop_oneof![some, chords]
}

/// What an operator does: ticks until then, which wheel (X, Z, contour), counts a tick, for how many ticks.
type Turn = (u32, u8, i16, u32);

fn turns() -> impl Strategy<Value = Vec<Turn>> {
    let some = (0..200_u32, 0..3_u8, -8..8_i16, 1..200_u32);
    // as much of X as there is
    let all = (0..60_u32, Just(0), prop_oneof![Just(-8), Just(8)], 60..300_u32);
    prop_oneof![prop::collection::vec(some, 1..12), prop::collection::vec(all, 1..12)]
}

fn place(channel: &Channel<16>) -> [i32; 2] {
    let (at, offset) = (channel.position(), channel.offset());
    [at.x + offset.x, at.z + offset.z]
}

/// Runs a program beside turns: the place at the end of each tick, and whether counts of X or Z were dropped.
fn run(machine: &Machine, wheel: bool, (pieces, feed): (&[Piece], i64), turns: &[Turn]) -> (Vec<[i32; 2]>, bool) {
    let motions = motions(machine, pieces, feed);
    let mut blocks = motions.iter().map(|motion| Block { line: 1, work: Work::Motion(*motion) });
    let mut channel = Channel::<16>::new(machine, Lattice { x: 0, z: 0 });
    let click = Click::from_nm(100_000).unwrap();
    if wheel {
        channel.set_drive(Drive::Wheel(click)).unwrap();
    }
    channel.start();
    channel.close();
    let mut ticks = vec![[0_i16; 3]; 20];
    for (after, which, counts, lasts) in turns {
        ticks.resize(ticks.len() + *after as usize, [0; 3]);
        ticks.resize(ticks.len() + *lasts as usize, [0, 1, 2].map(|w| if w == *which { *counts } else { 0 }));
    }
    ticks.resize(ticks.len() + 500, [0; 3]);
    let mut dropped = false;
    let made = ticks.into_iter().map(|[x, z, contour]| {
        for (axis, counts) in [(Axis::X, x), (Axis::Z, z)] {
            dropped |= channel.turn_hand(axis, click, counts, (-FAR, FAR)).0 != 0;
        }
        channel.read(&Inputs { spindle: None, wheel: contour });
        channel.tick(&mut || blocks.next(), &mut |_: Event| {});
        place(&channel)
    });
    (made.collect(), dropped)
}

fn law() -> impl Strategy<Value = SpeedLaw> {
    prop_oneof![Just(SpeedLaw::Linear), Just(SpeedLaw::Parabolic), Just(SpeedLaw::Sine)]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1_000, ..ProptestConfig::default() })]

    /// Over 1, 2, 4 .. 256 ticks. The pulses of both are rounded, and those of a path at both ends of a window.
    #[test]
    fn no_axis_passes_its_largest_speed(
        law in law(), wheel in prop::bool::weighted(0.2), pieces in pieces(), turns in turns(), feed in 100..3_000_i64
    ) {
        let pulses = (250, 1_000);
        let machine = machine(law, pulses);
        let (places, _) = run(&machine, wheel, (&pieces, feed), &turns);
        for (axis, (nm, speed)) in [(pulses.0, SPEEDS.0), (pulses.1, SPEEDS.1)].into_iter().enumerate() {
            for ticks in (0..=8).map(|power| 1_usize << power) {
                // mm/min are 10^6 / 60000 nm a tick
                let most = speed * 50 * i64::try_from(ticks).unwrap() / 3 / i64::from(nm) + 2;
                for (tick, pair) in places.windows(ticks + 1).enumerate() {
                    let moved = i64::from(pair[ticks][axis]) - i64::from(pair[0][axis]);
                    prop_assert!(moved.abs() <= most, "tick {tick}: axis {axis} {moved} in {ticks}, most {most}");
                }
            }
        }
    }
}

/// A pulse of X in a tick would be more than its largest speed. Whatever the path does along Z, the wheel has all of X, and the
/// path is not slowed down for it.
#[test]
fn beside_a_path_along_the_other_axis_a_coarse_axis_takes_all_counts() {
    // ever faster, up to 250 counts of 0.025 mm a second: three quarters of X's largest speed
    let turns: Vec<Turn> = (0..300_u32).map(|count| (14_u32.saturating_sub(count / 8).max(3), 0, 1, 1)).collect();
    let none = [(turns.iter().map(|turn| turn.0 + turn.3).sum(), 0, 0, 0)];
    for law in [SpeedLaw::Linear, SpeedLaw::Parabolic, SpeedLaw::Sine] {
        let machine = machine(law, (10_000, 1_000));
        for feed in [100, 600, 2_900] {
            let path = (&[Piece::Line(0, 100_000)][..], feed);
            let ((places, dropped), (alone, _)) =
                (run(&machine, false, path, &turns), run(&machine, false, path, &none));
            assert!(!dropped, "{law:?} {feed}");
            assert_eq!(places.last().unwrap()[0], 750);
            assert!(places.iter().zip(&alone).all(|(place, alone)| place[1] == alone[1]), "{law:?} {feed}");
        }
    }
}
