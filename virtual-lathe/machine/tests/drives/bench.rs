//! A channel with a spindle, an encoder and a wheel: tick by tick, with every pulse's instant.

use interp_core::block::{Block, Builder, Pace, Path, Work};
use interp_core::channel::{Channel, Report};
use interp_core::config::{AxisConfig, Config, Machine, TICK_CLOCKS};
use interp_core::curve::method::Method;
use interp_core::drive::Inputs;
use interp_core::drive::spindle::Reading;
use interp_core::train::Event;
use interp_core::units::{Axis, Feedrate, Lattice, Length, Point, PulseSize};
use machine::{Angle, Encoder, Spindle, TABLES};
use std::collections::VecDeque;

/// Pulses of X and of Z, nm.
pub(crate) const PULSES: [u32; 2] = [1250, 2500];

/// The machine at its defaults: 5000 mm/min, 500 mm/s2, 2 mm/s.
pub(crate) fn lathe(method: Method) -> Machine {
    lathe_with(PULSES, method)
}

pub(crate) fn lathe_with([x, z]: [u32; 2], method: Method) -> Machine {
    let axis = |pulse| AxisConfig {
        pulse: PulseSize::new(pulse, 1).unwrap(),
        max_feed: Feedrate::from_nm_per_min(5_000_000_000).unwrap(),
        max_accel: 500_000,
        max_jump: 2_000,
        pulse_width_ns: 5_000,
        dir_setup_ns: 5_000,
        dir_hold_ns: 5_000,
        min_space_ns: 5_000,
    };
    let machine = Config { x: axis(x), z: axis(z), event_min_ns: 2_000 }.check().unwrap();
    Machine { method, ..machine }
}

pub(crate) fn point(x_nm: i64, z_nm: i64) -> Point {
    Point { x: Length::from_nm(x_nm).unwrap(), z: Length::from_nm(z_nm).unwrap() }
}

pub(crate) fn per_minute(mm: u64) -> Pace {
    Pace::Feed(Feedrate::from_nm_per_min(mm * 1_000_000).unwrap())
}

/// Blocks of motions, and the end.
pub(crate) fn program(machine: &Machine, motions: &[(Path, Point, Pace)]) -> VecDeque<Block> {
    let mut builder = Builder::new(machine, Point::default());
    let mut blocks = VecDeque::new();
    for (line, (path, end, pace)) in motions.iter().enumerate() {
        let built = builder.motion(*path, *end, *pace);
        assert_eq!(built.refused, None);
        blocks.extend(built.motions.iter().map(|motion| Block { line: line as u32 + 1, work: Work::Motion(*motion) }));
    }
    blocks.push_back(Block { line: 0, work: Work::End });
    blocks
}

/// A spindle with its encoder: 1024 lines, and figures that let it follow a wobble.
pub(crate) struct Turning {
    pub(crate) spindle: Spindle,
    encoder: Encoder,
    counts: i64,
}

/// Counts a turn, and the count of the index.
pub(crate) const COUNTS: i64 = 4096;
pub(crate) const INDEX: i64 = 1000;

impl Turning {
    pub(crate) fn new() -> Self {
        let mut figures = figures::Figures::new(TABLES);
        let index = format!("{}", INDEX as f64 / COUNTS as f64 * 360.0 + 0.001);
        for (name, text) in [
            ("encoder.lines", "1024"),
            ("encoder.index_deg", index.as_str()),
            ("spindle.ramp_rpm_s", "100000"),
            ("spindle.inertia_kgm2", "0.003"),
            ("spindle.torque_nm", "50"),
            ("spindle.base_rpm", "3000"),
            ("spindle.max_rpm", "3000"),
        ] {
            figures.set(name, text).unwrap_or_else(|error| panic!("{name}: {error}"));
        }
        let encoder = Encoder::new(&figures).unwrap();
        Self { spindle: Spindle::new(&figures).unwrap(), counts: 0, encoder }
    }

    /// The reading at the start of a tick.
    pub(crate) fn reading(&mut self) -> Reading {
        let counts = self.encoder.counts(self.spindle.angle_after(0.0));
        let turn = |counts: i64| (counts - INDEX).div_euclid(COUNTS);
        let (before, now) = (turn(self.counts), turn(counts));
        let index = (before != now).then(|| (before.max(now) * COUNTS + INDEX) as u16);
        self.counts = counts;
        Reading { counts: counts as u16, index }
    }
}

/// Turns from the index mark.
pub(crate) fn turns(angle: Angle) -> f64 {
    angle.turns as f64 + angle.part - INDEX as f64 / COUNTS as f64
}

/// A rise of step pins: clock of the tick that plays it, what moved, where that led.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Pulse {
    pub(crate) clock: u32,
    pub(crate) moved: [i32; 2],
    pub(crate) at: Lattice,
}

pub(crate) struct Bench {
    pub(crate) channel: Channel<64>,
    blocks: VecDeque<Block>,
    levels: interp_core::train::Levels,
    pub(crate) at: Lattice,
    /// Of the last tick.
    pub(crate) pulses: Vec<Pulse>,
    pub(crate) events: Vec<u32>,
}

impl Bench {
    pub(crate) fn new(machine: &Machine, blocks: VecDeque<Block>) -> Self {
        Self {
            channel: Channel::new(machine, Lattice::default()),
            blocks,
            levels: interp_core::train::Levels::LOW,
            at: Lattice::default(),
            pulses: Vec::new(),
            events: Vec::new(),
        }
    }

    pub(crate) fn tick(&mut self, inputs: &Inputs) -> Report {
        self.channel.read(inputs);
        let (mut events, blocks) = (Vec::new(), &mut self.blocks);
        let report = self.channel.tick(&mut || blocks.pop_front(), &mut |event: Event| events.push(event));
        let mut clock = 0;
        self.pulses.clear();
        self.events = events.iter().map(|event| event.word()).collect();
        for event in events {
            let levels = event.levels();
            let rise = |axis| i32::from(levels.step(axis) && !self.levels.step(axis));
            let sign = |axis| if levels.plus(axis) { 1 } else { -1 };
            let moved = [Axis::X, Axis::Z].map(|axis| rise(axis) * sign(axis));
            if moved != [0, 0] {
                self.at = Lattice { x: self.at.x + moved[0], z: self.at.z + moved[1] };
                self.pulses.push(Pulse { clock, moved, at: self.at });
            }
            self.levels = levels;
            clock += event.interval();
        }
        assert_eq!(clock, TICK_CLOCKS);
        report
    }

    /// Ticks without inputs.
    pub(crate) fn rest(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick(&Inputs::default());
        }
    }

    pub(crate) fn wheel(&mut self, counts: i16) -> Report {
        self.tick(&Inputs { wheel: counts, ..Inputs::default() })
    }
}

/// Checks speed and acceleration of positions tick by tick: over h = 1, 2, 4 ... 256 ticks at most `v h + 2` pulses, and
/// a second difference of at most `a h^2 + slack`, in pulses.
pub(crate) fn keep_limits(places: &[i32], pulse_nm: f64, slack: f64) {
    let (v, a) = (5000.0 / 60.0 * 1e3 / pulse_nm, 500.0 / pulse_nm);
    for h in (0..9).map(|n| 1_usize << n) {
        for at in 2 * h..places.len() {
            let [first, middle, last] = [places[at - 2 * h], places[at - h], places[at]].map(f64::from);
            let (travel, bend) = ((last - middle).abs(), (last - 2.0 * middle + first).abs());
            assert!(travel <= v * h as f64 + 2.0, "tick {at}: {travel} pulses in {h} ticks");
            assert!(bend <= a * (h * h) as f64 + slack, "tick {at}: second difference {bend} over {h} ticks");
        }
    }
}
