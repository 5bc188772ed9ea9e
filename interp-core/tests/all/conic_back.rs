//! Parts of an ellipse under the contour wheel: back over the same points, home exactly, wherever the wheel turns round.
#![allow(
    clippy::unwrap_used,
    clippy::arithmetic_side_effects,
    clippy::indexing_slicing,
    missing_docs,
    reason = "tests"
)]

use interp_core::block::{Block, Builder, Pace, Pieces, Work};
use interp_core::channel::Channel;
use interp_core::config::{AxisConfig, Config, Machine};
use interp_core::curve::conic::Ellipse;
use interp_core::curve::prepare_arc::Reach;
use interp_core::drive::wheel::Click;
use interp_core::drive::{Drive, Inputs};
use interp_core::train::{Event, Levels};
use interp_core::units::{Axis, Feedrate, Lattice, Length, Point, PulseSize, Sense};
use proptest::prelude::*;

fn machine() -> Machine {
    let axis = |pulse_nm| AxisConfig {
        pulse: PulseSize::new(pulse_nm, 1).unwrap(),
        max_feed: Feedrate::from_nm_per_min(3_000_000_000).unwrap(),
        max_accel: 500_000,
        max_jump: 2_000,
        pulse_width_ns: 5_000,
        dir_setup_ns: 5_000,
        dir_hold_ns: 10_000,
        min_space_ns: 5_000,
    };
    Config { x: axis(1_250), z: axis(2_500), event_min_ns: 2_000 }.check().unwrap()
}

/// Half an ellipse of 0.1 by 0.16 mm, in so few parts that the trail keeps all.
fn blocks(machine: &Machine) -> Vec<Block> {
    let nm = |value: i64| Length::from_nm(value).unwrap();
    let mut builder = Builder::new(machine, Point { x: nm(0), z: nm(0) });
    let ellipse = Ellipse { centre: (-100_000, 0), half_axes: (nm(100_000), nm(160_000)) };
    let end = Point { x: nm(-200_000), z: nm(0) };
    let feed = Pace::Feed(Feedrate::from_nm_per_min(200_000_000).unwrap());
    let mut pieces = Pieces::ellipse(&builder, &ellipse, end, (Sense::Clockwise, Reach::Short), feed).unwrap();
    std::iter::from_fn(|| pieces.next_motion(&mut builder))
        .map(|motion| Block { line: 1, work: Work::Motion(motion) })
        .collect()
}

/// A channel, where it is, and the points that it has visited.
struct Bench {
    channel: Channel<16>,
    blocks: std::vec::IntoIter<Block>,
    levels: Levels,
    at: Lattice,
}

impl Bench {
    fn new(machine: &Machine) -> Self {
        let mut channel = Channel::new(machine, Lattice::default());
        channel.set_drive(Drive::Wheel(Click::from_nm(1_000).unwrap())).unwrap();
        assert!(channel.start());
        let blocks = blocks(machine).into_iter();
        assert!((4..=9).contains(&blocks.len()), "{}", blocks.len());
        let mut bench = Self { channel, blocks, levels: Levels::LOW, at: Lattice::default() };
        assert!(bench.turn(0, 200).is_empty());
        bench
    }

    /// Turns the wheel by some counts in each of some ticks, lets it rest, and gives the points visited.
    fn turn(&mut self, counts: i16, ticks: u32) -> Vec<Lattice> {
        let mut points = Vec::new();
        for tick in 0..ticks + 400 {
            let wheel = if tick < ticks { counts } else { 0 };
            self.channel.read(&Inputs { spindle: None, wheel });
            let Self { channel, blocks, levels, at } = self;
            channel.tick(&mut || blocks.next(), &mut |event: Event| {
                let now = event.levels();
                let rises = |axis| now.step(axis) && !levels.step(axis);
                let sign = |axis| if now.plus(axis) { 1 } else { -1 };
                let (x, z) = (rises(Axis::X), rises(Axis::Z));
                at.x += if x { sign(Axis::X) } else { 0 };
                at.z += if z { sign(Axis::Z) } else { 0 };
                if x || z {
                    points.push(*at);
                }
                *levels = now;
            });
        }
        assert_eq!(self.channel.position(), self.at);
        points
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn an_ellipse_leads_back_over_the_same_points(turns in prop::collection::vec((-12_i16..20, 1_u32..120), 1..20)) {
        let machine = machine();
        let mut bench = Bench::new(&machine);
        // the way from the start to where the tool is, without what was gone back over
        let mut way = vec![Lattice::default()];
        for (counts, ticks) in turns.into_iter().chain([(-40, 4_000)]) {
            for point in bench.turn(counts, ticks) {
                let last = way.len() - 1;
                if last > 0 && way[last - 1] == point {
                    way.pop();
                } else {
                    way.push(point);
                }
            }
        }
        prop_assert_eq!((bench.at, way.len()), (Lattice::default(), 1));
    }
}

#[test]
fn wound_to_the_end_it_is_there() {
    let machine = machine();
    let mut bench = Bench::new(&machine);
    assert!(bench.turn(40, 1_000).len() > 150);
    assert_eq!(bench.at, Lattice { x: -160, z: 0 });
    assert!(!bench.turn(-40, 1_000).is_empty());
    assert_eq!(bench.at, Lattice::default());
}
