//! Watches a run: measures every tick, writes the trace, collects what is drawn.

use std::collections::VecDeque;
use std::io::{self, Write};

use feature_editor::codes::{Action, Feed, Item};
use handcnc::background::parameters::Parameters;
use handcnc::foreground::Command;
use indicatif::ProgressBar;
use interp_core::channel::{self, State};
use interp_core::config::{AxisConfig, Config, Machine};
use interp_core::curve::method::Method;
use interp_core::units::{Axis, Point, Sense};
use measure::{Added, Checker, Limits, Motion, PerAxis, PulseEquivalent, Report, Setup, Shape};
use stock::Clamped;

use crate::insets::{self, Chooser};
use crate::lathe::Observer;
use crate::motors::Motors;
use crate::output::Pending;
use crate::picture::{Inset, Kind, Thinner};
use crate::work::{Work, Worked};

/// Points of the path that a picture keeps.
const PATH_POINTS: usize = 20_000;

/// Watches a run.
pub struct Watch {
    checker: Checker,
    /// In what the motors differ from the program in this tick.
    added: Vec<Added>,
    /// Programmed position of the action compiled last.
    at: Point,
    /// Lines compiled ahead, with the kind of their motion.
    kinds: VecDeque<(u32, Kind)>,
    kind: Kind,
    thinner: Thinner,
    /// Z and X, mm.
    pulse: [f64; 2],
    insets: Vec<Inset>,
    trace: Option<Pending>,
    motors: Option<Motors>,
    /// The machine's slides, how far they were off the program at most: Z and X, mm.
    slides_off: [f64; 2],
    work: Work,
    lattice: [i32; 2],
    blocks: u64,
    stops: u64,
    last_stop: u32,
    /// Feed override.
    percent: u32,
    /// Standing in a feed hold.
    held: bool,
    bar: ProgressBar,
}

/// What a run left.
pub struct Watched {
    /// The checker's figures.
    pub report: Report,
    /// The path, thinned.
    pub thinner: Thinner,
    /// Places under magnification.
    pub insets: Vec<Inset>,
    /// The trace, written but not in its place.
    pub trace: Option<Pending>,
    /// Program blocks that move.
    pub blocks: u64,
    /// The stock, and the times of the cycle.
    pub worked: Worked,
    /// The machine as the run left it, if one followed.
    pub motors: Option<Motors>,
    /// How far its slides were off the program at most, at the end of a tick: Z and X, mm.
    pub slides_off: [f64; 2],
}

impl Watch {
    /// Watches from the start; `chooser` has seen the program.
    ///
    /// # Errors
    /// Those of writing the trace, and a set-up that the checker refuses.
    pub fn new(
        parameters: &Parameters,
        machine: &Machine,
        chooser: Chooser,
        trace: Option<Pending>,
        bar: ProgressBar,
    ) -> io::Result<Self> {
        let pulse = [pulse_mm(machine, Axis::Z), pulse_mm(machine, Axis::X)];
        let start = parameters.start();
        let (x, z) = (machine.x.pulse.nearest(start.x), machine.z.pulse.nearest(start.z));
        let mut checker = Checker::new(setup(parameters, machine)).map_err(io::Error::other)?;
        let compensated = |axis| parameters.compensation(axis).is_on();
        checker = checker.compensated(PerAxis { x: compensated(Axis::X), z: compensated(Axis::Z) });
        checker.override_percent(u32::from(parameters.feed_override()));
        let mut watch = Self {
            checker,
            added: Vec::new(),
            at: start,
            kinds: VecDeque::new(),
            kind: Kind::Rapid,
            thinner: Thinner::new(pulse[0].max(pulse[1]) * 0.5, PATH_POINTS),
            pulse,
            insets: chooser.insets(pulse),
            trace,
            motors: None,
            slides_off: [0.0; 2],
            work: Work::new(None, pulse, [z, x], false),
            lattice: [z, x],
            blocks: 0,
            stops: 0,
            last_stop: 0,
            percent: u32::from(parameters.feed_override()),
            held: false,
            bar,
        };
        watch.thinner.push(Kind::Rapid, [f64::from(z) * pulse[0], f64::from(x) * pulse[1]]);
        insets::visit(&mut watch.insets, z, x);
        if let Some(trace) = &mut watch.trace {
            writeln!(trace.writer(), "time_ns,x,z\n0,{x},{z}")?;
        }
        Ok(watch)
    }

    /// Lets motors follow the train, and `clamped` be cut by where they bring the tool. Moments of an `animated` run are
    /// kept.
    #[must_use]
    pub fn with_work(mut self, motors: Motors, clamped: Option<Clamped>, animated: bool) -> Self {
        self.motors = Some(motors);
        self.work = Work::new(clamped, self.pulse, self.lattice, animated);
        self
    }

    /// How many programmed stops were passed by, and the line of the last.
    pub fn stops(&self) -> Option<(u64, u32)> {
        (self.stops > 0).then_some((self.stops, self.last_stop))
    }

    /// Size of a pulse, Z and X, in mm.
    pub fn pulse(&self) -> [f64; 2] {
        self.pulse
    }

    /// The progress bar.
    pub fn bar(&self) -> &ProgressBar {
        &self.bar
    }

    /// Ends the measurement.
    pub fn finish(self) -> Watched {
        let Self { checker, thinner, insets, trace, motors, slides_off, work, blocks, .. } = self;
        Watched { report: checker.finish(), thinner, insets, trace, blocks, worked: work.finish(), motors, slides_off }
    }
}

impl Observer for Watch {
    fn compiled(&mut self, item: &Item, blocks: usize) {
        let (shape, end, feed) = match item.action {
            Action::Line { end, feed } => (Shape::Line, end, feed),
            Action::Arc { end, centre, sense, feed } => {
                let centre_nm = PerAxis { x: centre.x.nm(), z: centre.z.nm() };
                (Shape::Arc { centre_nm, clockwise: sense == Sense::Clockwise }, end, feed)
            }
            _ => return self.checker.pause(),
        };
        #[expect(clippy::cast_precision_loss, reason = "feeds of at most eleven digits")]
        let feed_mm_min = match feed {
            // what follows the spindle has no feed of its own
            Feed::Rapid | Feed::PerTurn(_) | Feed::Thread { .. } => None,
            Feed::PerMinute(feed) => Some(feed.nm_per_min() as f64 / 1e6),
        };
        self.checker.motion(Motion { line: item.line, shape, end_nm: nm(end), feed_mm_min });
        let kind = match (shape, feed) {
            (_, Feed::Rapid) => Kind::Rapid,
            (_, Feed::Thread { .. }) => Kind::Thread,
            (Shape::Line, Feed::PerMinute(_) | Feed::PerTurn(_)) => Kind::Feed,
            (Shape::Arc { .. }, Feed::PerMinute(_) | Feed::PerTurn(_)) => Kind::Arc,
        };
        if blocks > 0 {
            self.blocks += 1;
            self.kinds.push_back((item.line, kind));
        }
        insets::curve(&mut self.insets, self.at, item);
        self.at = end;
    }

    fn superposed(&mut self, added: &[Added]) {
        self.added.clear();
        self.added.extend(added);
    }

    fn tick(&mut self, events: &[u32], report: &channel::Report) -> io::Result<()> {
        while self.kinds.front().is_some_and(|(line, _)| *line <= report.line) {
            self.kind = self.kinds.pop_front().map_or(self.kind, |(_, kind)| kind);
        }
        let (kind, pulse) = (self.kind, self.pulse);
        let (thinner, insets) = (&mut self.thinner, &mut self.insets);
        let mut written = Ok(());
        let (trace, lattice) = (&mut self.trace, &mut self.lattice);
        self.checker.tick_added(events, &self.added, &mut |clocks, x, z| {
            thinner.push(kind, [f64::from(z) * pulse[0], f64::from(x) * pulse[1]]);
            insets::visit(insets, z, x);
            *lattice = [z, x];
            if let (Some(trace), Ok(())) = (trace.as_mut(), &written) {
                written = writeln!(trace.writer(), "{},{x},{z}", measure::time_ns(clocks));
            }
        });
        let work = &mut self.work;
        // what is cut is where the slides really are
        if let Some(motors) = &mut self.motors {
            let mut at = None;
            motors.play(events, report.line, &mut |place| {
                at = Some([place.z_nm * 1e-6, place.x_nm * 1e-6]);
                work.step(place, kind, report.line);
            });
            let program = lattice.iter().zip(self.pulse).map(|(pulses, pulse)| f64::from(*pulses) * pulse);
            for ((off, at), program) in self.slides_off.iter_mut().zip(at.into_iter().flatten()).zip(program) {
                *off = off.max((at - program).abs());
            }
        }
        work.tick(*lattice, kind, report.speed == 0);
        let held = matches!(report.state, State::Holding) && report.speed == 0;
        if held && !self.held {
            self.checker.rest();
        }
        self.held = held;
        written
    }

    fn commanded(&mut self, command: Command) {
        match command {
            Command::FeedOverride(percent) => self.percent = u32::from(percent),
            Command::Hold | Command::Reset => return self.checker.override_percent(0),
            _ => {}
        }
        self.checker.override_percent(self.percent);
    }

    fn stopped(&mut self, line: u32) {
        self.stops += 1;
        self.last_stop = line;
    }

    fn progress(&mut self, bytes: u64) {
        self.bar.set_position(bytes);
    }
}

fn pulse_mm(machine: &Machine, axis: Axis) -> f64 {
    let pulse = match axis {
        Axis::X => machine.x.pulse,
        Axis::Z => machine.z.pulse,
    };
    f64::from(pulse.numerator()) / f64::from(pulse.denominator()) * 1e-6
}

/// The checker's set-up: the parameters as they were typed, not as the interpolator holds them.
pub(crate) fn setup(parameters: &Parameters, machine: &Machine) -> Setup {
    let Config { x, z, event_min_ns } = parameters.config();
    #[expect(clippy::cast_precision_loss, reason = "feeds of at most eleven digits")]
    let limits = |axis: &AxisConfig| Limits {
        max_accel: f64::from(axis.max_accel) / 1e3,
        max_feed: axis.max_feed.nm_per_min() as f64 / 1e6,
        max_jump: f64::from(axis.max_jump) / 1e3,
        pulse_width_ns: axis.pulse_width_ns,
        dir_setup_ns: axis.dir_setup_ns,
        dir_hold_ns: axis.dir_hold_ns,
        min_space_ns: axis.min_space_ns,
    };
    let pulse = |axis: &AxisConfig| PulseEquivalent { num: axis.pulse.numerator(), den: axis.pulse.denominator() };
    let start = parameters.start();
    Setup {
        pulse_nm: PerAxis { x: pulse(&x), z: pulse(&z) },
        start: PerAxis { x: machine.x.pulse.nearest(start.x), z: machine.z.pulse.nearest(start.z) },
        start_nm: nm(start),
        limits: PerAxis { x: limits(&x), z: limits(&z) },
        event_min_ns,
        uneven: matches!(machine.method, Method::Dda | Method::RateMultiplier),
        smoothed_ticks: machine.smoothing.ticks().into(),
    }
}

fn nm(point: Point) -> PerAxis<i64> {
    PerAxis { x: i64::from(point.x.nm()), z: i64::from(point.z.nm()) }
}
