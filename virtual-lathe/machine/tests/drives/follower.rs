//! A bench that goes along the points of a program by wheel and by time, in either sense, and what it has to keep.

use crate::bench::{Bench, per_minute, point};
use crate::wheel::click;
use interp_core::block::{Block, Builder, Path, Work};
use interp_core::channel::{Report, State};
use interp_core::config::Machine;
use interp_core::drive::{BackEnd, Drive};
use interp_core::units::{Lattice, Point, Sense};
use proptest::prelude::*;
use std::collections::{BTreeSet, VecDeque};

/// What a program is made of.
#[derive(Copy, Clone, Debug)]
pub(crate) enum Item {
    /// By so many nm, at mm/min.
    Line(i64, i64, u64),
    /// A quarter of a circle of a radius in nm, from the angle of so many quarters.
    Quarter(i64, u8, Sense, u64),
    /// Three quarters.
    Long(i64, u8, u64),
    Dwell(u32),
    Stop,
}

/// The blocks of a program, each item with a line of its own, and the end.
pub(crate) fn blocks(machine: &Machine, items: &[Item]) -> VecDeque<Block> {
    let mut builder = Builder::new(machine, Point::default());
    let mut blocks = VecDeque::new();
    for (line, item) in items.iter().enumerate() {
        let line = line as u32 + 1;
        let at = builder.programmed();
        let (x, z) = (i64::from(at.x.nm()), i64::from(at.z.nm()));
        let round = |radius: i64, quarter: u8, turn: i64| {
            // X and Z of the radius vector by quarters
            let vector = |quarter: i64| [(0, 1), (1, 0), (0, -1), (-1, 0)][quarter.rem_euclid(4) as usize];
            let (from, to) = (vector(i64::from(quarter)), vector(i64::from(quarter) + turn));
            let centre = (x - from.0 * radius, z - from.1 * radius);
            let sense = if turn < 0 { Sense::Clockwise } else { Sense::CounterClockwise };
            (Path::Arc { centre, sense }, point(centre.0 + to.0 * radius, centre.1 + to.1 * radius))
        };
        let (path, end, feed) = match *item {
            Item::Line(dx, dz, feed) => (Path::Line, point(x + dx, z + dz), feed),
            Item::Quarter(radius, quarter, sense, feed) => {
                let (path, end) = round(radius, quarter, if sense == Sense::Clockwise { -1 } else { 1 });
                (path, end, feed)
            }
            Item::Long(radius, quarter, feed) => {
                let (path, end) = round(radius, quarter, 3);
                (path, end, feed)
            }
            Item::Dwell(ticks) => {
                builder.standstill();
                blocks.push_back(Block { line, work: Work::Dwell(ticks) });
                continue;
            }
            Item::Stop => {
                builder.standstill();
                blocks.push_back(Block { line, work: Work::Stop });
                continue;
            }
        };
        let built = builder.motion(path, end, per_minute(feed));
        assert_eq!(built.refused, None);
        blocks.extend(built.motions.iter().map(|motion| Block { line, work: Work::Motion(*motion) }));
    }
    blocks.push_back(Block { line: 0, work: Work::End });
    blocks
}

pub(crate) fn items() -> impl Strategy<Value = Item> {
    let nm = || prop_oneof![-20_000_i64..20_000, -900_000_i64..900_000];
    let feed = || 30_u64..3_000;
    prop_oneof![
        6 => (nm(), nm(), feed()).prop_map(|(x, z, feed)| Item::Line(x, z, feed)),
        2 => (20_000_i64..900_000, 0_u8..4, any::<bool>(), feed()).prop_map(|(radius, quarter, clockwise, feed)| {
            Item::Quarter(radius, quarter, if clockwise { Sense::Clockwise } else { Sense::CounterClockwise }, feed)
        }),
        1 => (20_000_i64..500_000, 0_u8..4, feed()).prop_map(|(radius, quarter, feed)| Item::Long(radius, quarter, feed)),
        1 => (1_u32..40).prop_map(Item::Dwell),
        1 => Just(Item::Stop),
    ]
}

/// A bench that follows along all lattice points of the program, in either sense.
pub(crate) struct Follower {
    pub(crate) bench: Bench,
    way: Vec<Lattice>,
    /// Where on the way it may be: at one place, but where the way turns back on itself.
    pub(crate) index: BTreeSet<usize>,
    places: Vec<[i32; 2]>,
    /// Joints that each tick has led over, at most, and stands that it has begun or ended.
    jumps: Vec<u32>,
    line: u32,
    speed: u32,
}

impl Follower {
    pub(crate) fn new(machine: &Machine, blocks: &VecDeque<Block>) -> Self {
        let mut bench = Bench::new(machine, blocks.clone());
        let mut way = vec![Lattice::default()];
        bench.channel.start();
        while bench.channel.state() != State::Ended {
            bench.rest(1);
            way.extend(bench.pulses.iter().map(|pulse| pulse.at));
            if bench.channel.state() == State::Stopped {
                bench.channel.start();
            }
        }
        let ends = blocks.iter().filter_map(|block| match &block.work {
            Work::Motion(motion) => Some(motion.curve.end()),
            _ => None,
        });
        let end = ends.fold(Lattice::default(), |at, (x, z)| Lattice { x: at.x + x, z: at.z + z });
        assert_eq!(bench.at, end);
        let bench = Bench::new(machine, blocks.clone());
        Self { bench, way, index: BTreeSet::from([0]), places: Vec::new(), jumps: Vec::new(), line: 0, speed: 0 }
    }

    pub(crate) fn tick(&mut self, counts: i16) -> Report {
        let report = self.bench.wheel(counts);
        for pulse in &self.bench.pulses {
            let next = self.index.iter().flat_map(|&index| [index.checked_sub(1), Some(index + 1)]).flatten();
            let next: BTreeSet<usize> = next.filter(|&next| self.way.get(next) == Some(&pulse.at)).collect();
            assert!(!next.is_empty(), "off the points: {:?} at {:?}", pulse.at, self.index);
            self.index = next;
        }
        self.places.push([self.bench.at.x, self.bench.at.z]);
        // a line is a curve, a dwell or a stop, so all joints between two lines count; a stand is left and entered
        let line = if report.line == 0 { self.line } else { report.line };
        let stands = u32::from((report.speed == 0) != (self.speed == 0));
        self.jumps.push(line.abs_diff(self.line) + stands);
        (self.line, self.speed) = (line, report.speed);
        if report.state == State::Stopped {
            self.bench.channel.start();
        }
        report
    }

    pub(crate) fn last(&self) -> Lattice {
        *self.way.last().unwrap()
    }

    /// By time for so many ticks at most, then held until it stands.
    pub(crate) fn by_time(&mut self, ticks: usize) {
        self.bench.channel.set_drive(Drive::Time).unwrap();
        self.bench.channel.start();
        for _ in 0..ticks {
            if self.tick(0).state == State::Ended {
                return;
            }
        }
        self.hold();
    }

    /// Held until it stands, and released.
    pub(crate) fn hold(&mut self) {
        self.bench.channel.hold();
        while self.tick(0).speed > 0 {}
        self.bench.channel.start();
    }

    /// By the wheel until it is let go for long enough to stand; where it came to an end of the way back, that.
    pub(crate) fn by_wheel(&mut self, counts: i16, ticks: usize) -> Option<BackEnd> {
        self.bench.channel.set_drive(click(100)).unwrap();
        let mut end = None;
        for _ in 0..ticks {
            end = self.tick(counts).driven.back_end;
            if end.is_some() {
                break;
            }
        }
        self.rest();
        end
    }

    /// The wheel let go for long enough to stand.
    pub(crate) fn rest(&mut self) {
        for _ in 0..400 {
            self.tick(0);
        }
    }

    /// Speed and acceleration of both axes over windows, the machine's at its defaults.
    ///
    /// A second difference of the place over h ticks is the speed's change weighed by a triangle of height h. The
    /// acceleration a makes a h^2 of it at most; a jump of the speed makes as much as h less its distance from the
    /// middle, and it is somewhere in its tick. Each of the places, one of them taken twice, is less than 0.86 pulses off the
    /// curve: half a pulse, and more only where the gap at the border of two zones is bridged. So four times that is added.
    pub(crate) fn check_limits(&self, pulses: [f64; 2]) {
        for (axis, pulse) in pulses.into_iter().enumerate() {
            let place = |at: usize| f64::from(self.places[at][axis]);
            let (v, a, jump) = (5000.0 / 60.0 * 1e3 / pulse, 500.0 / pulse, 2_000.0 / pulse);
            for h in (0..9).map(|n| 1_usize << n) {
                for at in 2 * h..self.places.len() {
                    let (travel, before) = (place(at) - place(at - h), place(at - h) - place(at - 2 * h));
                    assert!(travel.abs() <= v * h as f64 + 1.0, "tick {at}: {travel} pulses in {h} ticks");
                    let (bend, smooth) = ((travel - before).abs(), a * (h * h) as f64 + 4.0 * 0.86);
                    if bend <= smooth {
                        continue;
                    }
                    let weight = |tick: usize| h.min((h + 1).saturating_sub(tick.abs_diff(at - h)));
                    let jumps: f64 = (at - 2 * h..=at).map(|t| f64::from(self.jumps[t]) * weight(t) as f64).sum();
                    assert!(
                        bend <= smooth + jump * jumps,
                        "tick {at}: {bend} over {h} ticks, {smooth} and {jumps} jumps"
                    );
                }
            }
        }
    }
}
