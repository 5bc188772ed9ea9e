//! Motions that were kept in 32 bytes, against the first ones; and the window on the history.
extern crate std;
use super::record::{Kept, Slot};
use super::*;
use crate::block::again::{Again, Made};
use crate::block::{Builder, Pace, Path};
use crate::config::{AxisConfig, Config, Machine};
use crate::curve::method::Method;
use crate::drive::gearing::Lead;
use crate::units::{Feedrate, Length, Point, PulseSize, Sense};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use std::vec::Vec;

fn machine(pulses: [(u32, u32); 2], method: Method) -> Machine {
    let axis = |(numerator, denominator)| AxisConfig {
        pulse: PulseSize::new(numerator, denominator).unwrap(),
        max_feed: Feedrate::from_nm_per_min(30_000_000).unwrap(),
        max_accel: 700_000,
        max_jump: 3_000,
        pulse_width_ns: 1_000,
        dir_setup_ns: 1_000,
        dir_hold_ns: 1_000,
        min_space_ns: 1_000,
    };
    let z = AxisConfig { max_accel: 500_000, max_jump: 2_000, ..axis(pulses[1]) };
    let machine = Config { x: axis(pulses[0]), z, event_min_ns: 1_000 }.check().unwrap();
    // as everywhere, methods are there with the feature only
    Machine { method: if cfg!(feature = "methods") { method } else { Method::MinimumDeviation }, ..machine }
}

/// One programmed motion, in nm from where the last one ended.
#[derive(Copy, Clone, Debug)]
enum Move {
    Line(i64, i64),
    /// Radius, angle of the start, how far it turns; how far its centre is off.
    Arc(f64, f64, f64, (i64, i64)),
    Circle(i64, i64),
    Stand,
}

fn moves() -> impl Strategy<Value = Move> {
    // sizes from pulses to metres
    let size = || (1.0_f64..9.0).prop_map(|digits| 10_f64.powf(digits));
    #[allow(clippy::cast_possible_truncation, reason = "a sample")]
    let along = || (size(), -1.0_f64..1.0).prop_map(|(size, part)| (size * part) as i64);
    prop_oneof![
        (along(), along()).prop_map(|(x, z)| Move::Line(x, z)),
        (size(), 0.0_f64..6.3, -6.25_f64..6.25, (-9_i64..9, -9_i64..9))
            .prop_map(|(r, from, turn, off)| Move::Arc(r, from, turn, off)),
        (along(), along()).prop_map(|(x, z)| Move::Circle(x, z)),
        Just(Move::Stand),
    ]
}

fn pace() -> impl Strategy<Value = Pace> {
    let lead = || (1_u64..1_000_000, 1_u32..60).prop_filter_map("a lead", |(nm, turns)| Lead::new(nm * 10, turns));
    prop_oneof![
        Just(Pace::Rapid),
        (1_u64..1 << 34).prop_filter_map("a feed", |feed| Feedrate::from_nm_per_min(feed).map(Pace::Feed)),
        lead().prop_map(Pace::PerTurn),
        (lead(), any::<u16>()).prop_map(|(lead, start)| Pace::Thread { lead, start }),
    ]
}

#[allow(clippy::cast_possible_truncation, reason = "a sample")]
fn programmed(at: Point, what: Move) -> Option<(Path, Point)> {
    let (x, z) = (i64::from(at.x.nm()), i64::from(at.z.nm()));
    let point = |x, z| Some(Point { x: Length::from_nm(x)?, z: Length::from_nm(z)? });
    match what {
        Move::Line(dx, dz) => Some((Path::Line, point(x + dx, z + dz)?)),
        Move::Arc(radius, from, turn, (off_x, off_z)) => {
            let centre = (x - (radius * from.sin()) as i64 + off_x, z - (radius * from.cos()) as i64 + off_z);
            let sense = if turn < 0.0 { Sense::Clockwise } else { Sense::CounterClockwise };
            let reached = |part: f64| (radius * part) as i64;
            let (sine, cosine) = (from + turn).sin_cos();
            Some((Path::Arc { centre, sense }, point(centre.0 + reached(sine), centre.1 + reached(cosine))?))
        }
        Move::Circle(off_x, off_z) => Some((Path::Arc { centre: (x + off_x, z + off_z), sense: Sense::Clockwise }, at)),
        Move::Stand => None,
    }
}

/// All motions of a random program, in order.
fn motions(machine: &Machine, program: &[(Move, Pace)], mut take: impl FnMut(&Motion)) {
    let mut builder = Builder::new(machine, Point::default());
    for (what, pace) in program {
        match programmed(builder.programmed(), *what) {
            Some((path, end)) => builder.motion(path, end, *pace).motions.iter().for_each(&mut take),
            None => builder.standstill(),
        }
    }
}

/// A motion as it comes back, and in how many steps.
fn again(builder: &Builder, motion: &Motion) -> Option<(Motion, u32)> {
    let (main, rest) = Slot::pack(&Kept { line: 7, apart: false, outline: Outline::of(motion) });
    let outline = main.unpack(&rest.unwrap_or(Slot::NONE)).outline?;
    let mut again = Again::new(outline)?;
    for step in 1.. {
        match again.step(builder) {
            Made::More => {}
            Made::Motion(motion) => return Some((motion, step)),
            Made::Nothing => break,
        }
    }
    None
}

proptest! {
    #![proptest_config(ProptestConfig { cases: std::env::var("PROPTEST_CASES").map_or(256, |cases| cases.parse().unwrap()), ..ProptestConfig::default() })]

    /// Lines, arcs of all sizes, whole circles, halves; feeds of every kind; joints and standstill; every method.
    #[test]
    fn a_motion_comes_back_bit_for_bit(
        pulses in prop::sample::select(std::vec![
            [(1250, 1), (2500, 1)], [(1000, 1), (1000, 1)], [(15_875, 8), (3175, 4)], [(10_000, 1), (99, 1)],
            [(40_961, 4096), (1_000_003, 4096)], [(16_777_213, 4095), (5_000_011, 997)],
        ]),
        method in 0_usize..6,
        program in prop::collection::vec((moves(), pace()), 1..40),
    ) {
        let machine = machine(pulses, Method::ALL[method]);
        let builder = Builder::new(&machine, Point::default());
        let mut wrong = Vec::new();
        motions(&machine, &program, |motion| {
            let (found, steps) = match again(&builder, motion) {
                Some((found, steps)) => (Some(found), steps),
                None => (None, 0),
            };
            if found != Some(*motion) || steps > 22 {
                wrong.push((*motion, found, steps));
            }
        });
        prop_assert!(wrong.is_empty(), "{wrong:?}");
    }
}

/// The random programs hold what they are to test.
#[test]
fn the_samples_are_of_all_kinds() {
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let machine = machine([(15_875, 8), (3175, 4)], Method::MinimumDeviation);
    let (mut arcs, mut halves, mut whole, mut long) = (0, 0, 0, 0);
    for _ in 0..200 {
        let program = prop::collection::vec((moves(), pace()), 40).new_tree(&mut runner).unwrap().current();
        motions(&machine, &program, |motion| {
            if let Some(Outline { shape: crate::block::again::Shape::Arc(..), end, continues, .. }) =
                Outline::of(motion)
            {
                arcs += 1;
                halves += i32::from(continues);
                whole += i32::from(end == (0, 0));
            }
            long += i32::from(Slot::pack(&Kept { line: 1, apart: false, outline: Outline::of(motion) }).1.is_some());
        });
    }
    assert!(arcs > 1000 && halves > 100 && whole > 50 && long > 1000, "{arcs} {halves} {whole} {long}");
}
