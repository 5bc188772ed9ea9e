//! What has to be true at every tick, whatever an operator does: seen on the pins, and in what the lathe shows of itself.
//!
//! Each rule has an oracle of its own:
//!
//! * **limits**: [`MotorWatch`] reads the pins, as in a scenario: widths and spaces of pulses, speed and second difference over
//!   1, 2, 4 ... 256 ticks, with the allowances that its page derives.
//! * **count**: the pulses counted on the pins are the place shown, less what was set by zero or home, less compensation: at
//!   rest exactly; while it moves within [`IN_FLIGHT`].
//! * **soft-limit**, **bound**: while an axis is verified it does not pass its limit, and the offset not its bound; one that is
//!   beyond already comes back only.
//! * **rest**: nothing moves where nothing may: after braking under an alarm, at once with motors off and after an emergency
//!   stop, held, stopped, ended or idle with nobody turning.
//! * **curve**, **end**: [`Track`].
//! * **shoulder**: [`Shoulders`].
//! * **wheel**: [`Clicks`].
//! * **cause**: an alarm has what it tells of.

use handcnc::foreground::alarm::Alarm;
use handcnc::foreground::inputs::{AXES, Inputs, Joystick, PerAxis};
use handcnc::foreground::mode::Mode;
use handcnc::foreground::settings::Settings as Operation;
use handcnc::foreground::shown::Shown;
use interp_core::channel::{Report, State};
use interp_core::config::Machine;
use interp_core::drive::ThreadStage;
use interp_core::units::{Axis, Lattice, PulseSize};
use measure::{MotorWatch, Setup};

use super::clicks::{Clicks, Turned};
use super::coverage::Coverage;
use super::shoulders::{Fed, Shoulders};
use super::soft_limit::{Place, SoftLimit};
use super::track::{Track, part};

/// Pulses that the pins may be off the place shown while an axis moves: one is owed where it would turn the axis round; and
/// those that the shaper keeps for the next tick, as they have no room in this one. It keeps 24 events at most, two a pulse; one
/// more would be lost, which shows at rest, and in the tick's length.
const IN_FLIGHT: i32 = 13;

/// Ticks without a pulse after which it stands: what is owed waits 16.
pub(super) const STANDS: u32 = 20;

/// A rule that was broken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Failure {
    /// Ticks from the start.
    pub(super) tick: u64,
    /// The rule, in a word.
    pub(super) rule: String,
    /// What was seen.
    pub(super) text: String,
}

/// A tick that was made.
pub(super) struct Tick<'t> {
    pub(super) tick: u64,
    pub(super) events: &'t [u32],
    pub(super) report: &'t Report,
    pub(super) shown: &'t Shown,
    pub(super) inputs: &'t Inputs,
    pub(super) compensation: PerAxis<i32>,
    /// The emergency stop is pressed.
    pub(super) pressed: bool,
    /// No wheel's axis moves, nor has to.
    pub(super) rests: bool,
}

/// What is remembered of an axis.
struct AxisBooks {
    axis: Axis,
    pulse: PulseSize,
    /// The place shown less that of the pins; and the same in the machine's coordinates.
    shift: i32,
    own: i32,
    soft_limit: SoftLimit,
    /// How far its offset may be to either side.
    bound: Option<(i32, i32)>,
    clicks: Clicks,
    /// The place shown, and ticks since it or the pins moved.
    at: i32,
    still: u32,
    verified: bool,
    /// At its soft limit or beyond, as shown.
    at_limit: bool,
}

impl AxisBooks {
    /// Limits and bounds are others, or are not known.
    const fn forget_limits(&mut self) {
        self.soft_limit.forget();
        self.bound = None;
    }

    fn new(axis: Axis, machine: &Machine) -> Self {
        let pulse = match axis {
            Axis::X => machine.x.pulse,
            Axis::Z => machine.z.pulse,
        };
        let clicks = Clicks::new();
        let (soft_limit, bound, still) = (SoftLimit::default(), None, STANDS);
        Self { axis, pulse, shift: 0, own: 0, soft_limit, bound, clicks, at: 0, still, verified: true, at_limit: false }
    }
}

/// All oracles of a session.
pub(super) struct Oracle {
    watch: MotorWatch,
    axes: [AxisBooks; 2],
    operation: Operation,
    /// Ticks in which anything comes to rest.
    calm: u64,
    /// Since when what is, is so.
    state: (State, u64),
    alarm: (Option<Alarm>, u64),
    guard: (bool, u64),
    mode: Mode,
    /// Last tick in which somebody asked for motion that is no program's.
    stirred: u64,
    /// No pulses are made.
    locked: bool,
    pub(super) track: Option<Track>,
    pub(super) shoulders: Shoulders,
    programmed: Lattice,
    /// Line and states of the tick before, and whether the path stood then.
    path: (u32, State, State, bool),
    to_go: u64,
    stage: ThreadStage,
    click: Option<i64>,
    /// Threads, feeds a turn or the lever: the spindle has a part in what runs.
    spindle_asked: bool,
    offset_was: bool,
    /// No wheel's axis had to move in the tick before.
    rested: bool,
    compensation: PerAxis<i32>,
    stopped: bool,
}

impl Oracle {
    pub(super) fn new(setup: Setup, machine: &Machine, operation: Operation) -> Result<Self, String> {
        let watch = MotorWatch::new(setup).map_err(|error| error.to_string())?;
        let mut axes = [AxisBooks::new(Axis::X, machine), AxisBooks::new(Axis::Z, machine)];
        let at = watch.position();
        for (books, at) in axes.iter_mut().zip([at.x, at.z]) {
            books.at = at;
        }
        Ok(Self {
            watch,
            axes,
            operation,
            calm: calm(machine),
            state: (State::Idle, 0),
            alarm: (None, 0),
            guard: (false, 0),
            mode: Mode::Handwheel,
            stirred: 0,
            locked: false,
            track: None,
            shoulders: Shoulders::new(Lattice { x: at.x, z: at.z }),
            programmed: Lattice { x: at.x, z: at.z },
            path: (0, State::Idle, State::Idle, true),
            to_go: 0,
            stage: ThreadStage::None,
            click: Some(10_000),
            spindle_asked: false,
            offset_was: false,
            rested: true,
            compensation: PerAxis { x: 0, z: 0 },
            stopped: false,
        })
    }

    /// Where the pins have led.
    pub(super) fn position(&self) -> Lattice {
        let at = self.watch.position();
        Lattice { x: at.x, z: at.z }
    }

    pub(super) fn hash(&self) -> u64 {
        self.watch.train_hash()
    }

    pub(super) const fn calm(&self) -> u64 {
        self.calm
    }

    /// The train was cut off.
    pub(super) fn cut(&mut self) {
        self.watch.cut();
        self.cut_books();
    }

    fn cut_books(&mut self) {
        for books in &mut self.axes {
            books.clicks.forget();
            books.forget_limits();
        }
        self.track = None;
    }

    /// An emergency stop: what was planned already comes in the next tick, then nothing is compared with what was before.
    pub(super) fn stopped(&mut self) {
        self.cut_books();
        self.stopped = true;
    }

    /// Power is on again.
    pub(super) fn switched_on(&mut self, tick: u64, shown: &Shown) {
        self.cut();
        (self.state, self.alarm, self.guard) = ((State::Idle, tick), (None, tick), (false, tick));
        (self.locked, self.mode, self.stirred) = (false, shown.mode, tick);
        self.programmed = shown.programmed;
        self.shoulders = Shoulders::new(shown.programmed);
        self.click = Some(10_000);
        let at = self.position();
        for books in &mut self.axes {
            books.clicks = Clicks::new();
            books.verified = *shown.verified.of(books.axis);
            // what a compensation had added counts as right from now on, and what was owed is not made any more
            let shift = part(shown.position, books.axis) - part(at, books.axis);
            books.own += shift - books.shift;
            books.shift = shift;
        }
    }

    /// Other figures, at rest.
    pub(super) fn configure(&mut self, setup: Setup, machine: &Machine, operation: Operation) -> Result<(), String> {
        self.operation = operation;
        self.calm = calm(machine);
        for books in &mut self.axes {
            books.forget_limits();
            books.clicks.forget();
        }
        self.watch.configure(setup).map_err(|error| error.to_string())
    }

    /// An axis was set to a place.
    pub(super) fn placed(&mut self, axis: Axis, shown: &Shown, compensation: PerAxis<i32>) {
        self.shoulders.placed(axis, part(shown.programmed, axis));
        let at = self.position();
        // what is set while no pulses are made ends with the lock
        for books in self.axes.iter_mut().filter(|books| books.axis == axis && !self.locked) {
            books.soft_limit.forget();
            books.shift = part(shown.position, axis) - (part(at, axis) - *compensation.of(axis));
            books.verified = *shown.verified.of(axis);
            books.clicks.forget();
        }
    }

    /// The place of both axes was told to be right, or motors went on or off.
    pub(super) fn confirmed(&mut self, shown: &Shown) {
        for books in &mut self.axes {
            books.soft_limit.forget();
            // no home was found, whatever the mode
            books.verified = *shown.verified.of(books.axis);
        }
    }

    /// A request was obeyed that may move a slide, or forgets what a wheel asked for.
    pub(super) fn obeyed(&mut self, tick: u64, takes: u64) {
        self.stirred = self.stirred.max(tick + takes);
        self.axes.iter_mut().for_each(|books| books.clicks.forget());
    }

    /// All was stopped: what the wheels had asked for is told as dropped, up to a count that was begun.
    pub(super) fn reset(&mut self, tick: u64) {
        self.stirred = self.stirred.max(tick);
        self.axes.iter_mut().for_each(|books| books.clicks.broken());
        self.track = self.track.take().filter(Track::has_begun);
    }

    /// Something begins, and may be held at once.
    pub(super) fn stirs(&mut self, tick: u64) {
        self.stirred = self.stirred.max(tick);
    }

    /// The spindle may have a say.
    pub(super) const fn spindle_is_asked(&mut self) {
        self.spindle_asked = true;
    }

    pub(super) fn scale(&mut self, click: Option<i64>) {
        self.click = click;
        self.axes.iter_mut().for_each(|books| books.clicks.forget());
    }

    pub(super) fn lock(&mut self, locked: bool, shown: &Shown) {
        self.locked = locked;
        self.shoulders.lock(locked, shown.programmed);
        self.axes.iter_mut().for_each(AxisBooks::forget_limits);
    }

    /// The offset was called something else.
    pub(super) fn offset_taken(&mut self) {
        self.axes.iter_mut().for_each(|books| books.bound = None);
    }

    /// Looks at a tick.
    pub(super) fn tick(&mut self, tick: &Tick<'_>, coverage: &mut Coverage) -> Result<(), Failure> {
        self.look(tick, coverage).map_err(|(rule, text)| Failure { tick: tick.tick, rule: rule.into(), text })
    }

    fn look(&mut self, tick: &Tick<'_>, coverage: &mut Coverage) -> Result<(), (&'static str, String)> {
        let (shown, report) = (tick.shown, tick.report);
        let before = self.position();
        self.play(tick);
        let at = self.position();
        let moved = at != before;
        coverage.tick(shown.mode, shown.state, moved);
        self.remember(tick, coverage);
        let stage = report.driven.stage;
        if stage != self.stage {
            match stage {
                ThreadStage::Cutting => coverage.happened("thread cut"),
                ThreadStage::Leaving => coverage.happened("thread left"),
                ThreadStage::None | ThreadStage::Waiting | ThreadStage::Left => {}
                ThreadStage::Returning | ThreadStage::Entering => {}
            }
            self.stage = stage;
        }
        self.rest(tick, (before, at))?;
        for index in 0..2 {
            self.count(index, tick, (before, at), coverage)?;
        }
        self.feed(tick, coverage)?;
        self.follow(tick, coverage)
    }

    /// What power and linked feed lead.
    fn feed(&mut self, tick: &Tick<'_>, coverage: &mut Coverage) -> Result<(), (&'static str, String)> {
        let (shown, report) = (tick.shown, tick.report);
        let [x, z] = &self.axes;
        let fed = Fed {
            mode: shown.mode,
            state: shown.state,
            joystick: tick.inputs.joystick,
            place: shown.programmed,
            speed: shown.speed,
            line: report.line,
            threads: shown.lever || report.driven.stage != ThreadStage::None,
            at_limit: PerAxis { x: x.at_limit, z: z.at_limit },
        };
        match self.shoulders.tick(&fed) {
            Ok(true) => coverage.happened("shoulder met"),
            Ok(false) => {}
            Err(text) => return Err(("shoulder", text)),
        }
        Ok(())
    }

    /// The pins.
    fn play(&mut self, tick: &Tick<'_>) {
        let next = tick.shown.distance_to_go > self.to_go;
        // a path starts and stops at the start-stop speed, beside a wheel that moves on as well
        let now = (tick.report.line, tick.report.state, tick.shown.state, tick.report.speed == 0);
        let joint = next || self.path != now;
        if self.path.3 && !now.3 {
            self.watch.rest();
        }
        (self.to_go, self.path) = (tick.shown.distance_to_go, now);
        if joint {
            self.watch.joint();
        }
        let added = !tick.rests || !self.rested || self.compensation != tick.compensation;
        if added {
            self.watch.added();
        }
        (self.rested, self.compensation) = (tick.rests, tick.compensation);
        self.watch.line(tick.report.line);
        self.watch.tick(tick.events, &mut |_, _, _| {});
        if joint {
            self.watch.joint();
        }
        if std::mem::take(&mut self.stopped) {
            self.watch.cut();
        }
    }

    fn remember(&mut self, tick: &Tick<'_>, coverage: &mut Coverage) {
        let (shown, inputs) = (tick.shown, tick.inputs);
        if self.state.0 != shown.state {
            self.state = (shown.state, tick.tick);
        }
        if self.alarm.0 != shown.alarm {
            self.alarm = (shown.alarm, tick.tick);
            if let Some(alarm) = shown.alarm {
                coverage.alarm(alarm);
            }
            self.axes.iter_mut().for_each(|books| books.clicks.forget());
        }
        if self.guard.0 != inputs.guard {
            self.guard = (inputs.guard, tick.tick);
        }
        if self.mode != shown.mode {
            self.mode = shown.mode;
            self.stirred = self.stirred.max(tick.tick);
            self.axes.iter_mut().for_each(|books| books.clicks.forget());
        }
        let turned = inputs.wheels != PerAxis { x: 0, z: 0 } || inputs.contour != 0;
        if turned || inputs.joystick != Joystick::Off || shown.mode == Mode::Homing {
            self.stirred = self.stirred.max(tick.tick);
        }
        let offset = shown.offset != Lattice::default();
        if self.offset_was && !offset {
            coverage.happened("offset wound back to zero");
        }
        self.offset_was = offset;
    }

    /// Nothing moves where nothing may.
    fn rest(&self, tick: &Tick<'_>, (before, at): (Lattice, Lattice)) -> Result<(), (&'static str, String)> {
        let shown = tick.shown;
        let path = shown.programmed != self.programmed;
        if at == before && !path {
            return Ok(());
        }
        let since = |from: u64| tick.tick.saturating_sub(from);
        let by = || format!("X by {} and Z by {} pulses", at.x - before.x, at.z - before.z);
        if self.locked && at != before {
            return Err(("rest", format!("machine lock is on, and the pins moved {}", by())));
        }
        // an emergency stop ends the planning at once; of what was planned before, the shaper may have had no room in its tick
        let flown = (at.x - before.x).abs() <= IN_FLIGHT && (at.z - before.z).abs() <= IN_FLIGHT;
        let cut_off = matches!(self.alarm, (Some(Alarm::Emergency), raised) if since(raised) == 0) && flown && !path;
        if !shown.outputs.motors && at != before && !cut_off {
            return Err(("rest", format!("the motors are off, and the pins moved {}", by())));
        }
        let (alarm, raised) = self.alarm;
        match alarm {
            // the tick in which it is raised was asked for before
            Some(Alarm::Emergency) if since(raised) > 0 && at != before => {
                return Err(("rest", format!("emergency stop, and the pins moved {}", by())));
            }
            Some(alarm) if since(raised) > self.calm && self.stage == ThreadStage::None && at != before => {
                return Err(("rest", format!("{alarm}, {} ticks ago, and the pins moved {}", since(raised), by())));
            }
            _ => {}
        }
        let quiet = since(self.stirred.max(self.state.1)) > self.calm;
        let stands = match shown.state {
            State::Idle | State::Ended | State::Holding | State::Stopped => true,
            // driven by hands only
            State::Running => matches!(shown.mode, Mode::Linked | Mode::Retrace),
            State::Filling | State::Resetting => false,
        };
        let threads = !matches!(self.stage, ThreadStage::None | ThreadStage::Left);
        if quiet && stands && !threads && at != before {
            return Err(("rest", format!("nobody asked for it ({:?}), and the pins moved {}", shown.state, by())));
        }
        let guarded = matches!(shown.mode, Mode::Automatic | Mode::ManualData | Mode::Linked | Mode::Retrace);
        if path && guarded && self.guard.0 && since(self.guard.1) > self.calm && !threads {
            return Err((
                "rest",
                format!("the guard has been open for {} ticks, and the program moves", since(self.guard.1)),
            ));
        }
        Ok(())
    }

    /// The books of an axis.
    fn count(
        &mut self,
        index: usize,
        tick: &Tick<'_>,
        (before, at): (Lattice, Lattice),
        coverage: &mut Coverage,
    ) -> Result<(), (&'static str, String)> {
        let Some(books) = self.axes.get_mut(index) else { return Ok(()) };
        let (axis, shown) = (books.axis, tick.shown);
        let pins = part(at, axis);
        // a pulse that is planned now may be made in the next tick, as the shaper has no room for it before
        let rests = pins == part(before, axis) && part(shown.position, axis) == books.at;
        books.still = if rests { books.still.saturating_add(1) } else { 0 };
        books.at = part(shown.position, axis);
        let plain = pins - *tick.compensation.of(axis);
        let verified = *shown.verified.of(axis);
        let home = verified && !books.verified && shown.mode == Mode::Homing;
        if home {
            self.shoulders.placed(axis, part(shown.programmed, axis));
        }
        if home && !self.locked {
            // home was found: the place is another one, and nothing is beside it
            books.shift = part(shown.position, axis) - plain;
            books.own = books.shift;
            books.clicks.forget();
            if part(shown.offset, axis) != 0 || part(shown.kept, axis) != 0 || part(shown.wear, axis) != 0 {
                return Err(("home", format!("{axis:?} is home with an offset")));
            }
        }
        books.verified = verified;
        let (least, most) = self.operation.axes.of(axis).limits;
        let own = part(shown.position, axis) - books.shift + books.own;
        books.at_limit = self.locked || verified && (own <= least || own >= most);
        if self.locked {
            books.clicks.forget();
            return Ok(());
        }
        let off = part(shown.position, axis) - books.shift - plain;
        let stands = books.still >= STANDS && shown.speed == 0;
        if off.abs() > if stands { 0 } else { IN_FLIGHT } {
            let what = if stands { "at rest" } else { "moving" };
            return Err(("count", format!("{what}, {axis:?} shows {off} pulses more than the pins have counted")));
        }
        let own = plain + books.own;
        let figures = self.operation.axes.of(axis);
        let given = *tick.compensation.of(axis);
        if verified {
            let (least, most) = figures.limits;
            let goes_on = shown.speed == 0 || shown.state == State::Running;
            let place = Place { tick: tick.tick, own, given, limits: figures.limits, stands, goes_on };
            if !books.soft_limit.tick(&place) {
                return Err(("soft-limit", format!("{axis:?} is at {own} of {least} to {most} pulses")));
            }
            if (own == least || own == most) && books.still == 0 {
                coverage.happened("soft limit reached");
            }
        } else {
            books.soft_limit.forget();
            books.soft_limit.compensate(given, tick.tick);
        }
        let (offset, (least, most)) = (part(shown.offset, axis), figures.bounds);
        let bound = books.bound.get_or_insert((least.min(offset), most.max(offset)));
        if offset < bound.0 || offset > bound.1 {
            return Err(("bound", format!("the offset of {axis:?} is {offset} of {least} to {most} pulses")));
        }
        *bound = (least.min(offset), most.max(offset));
        let reach =
            i32::try_from(25_000_000 * u64::from(books.pulse.denominator()) / u64::from(books.pulse.numerator()));
        let reach = reach.unwrap_or(i32::MAX);
        let (folded, free) = match shown.mode {
            Mode::Handwheel => (true, true),
            Mode::Automatic | Mode::ManualData | Mode::Linked | Mode::Retrace => (false, true),
            Mode::Power | Mode::Homing => (true, false),
        };
        let ends = *tick.inputs.ends.of(axis);
        let (low, high) = figures.limits;
        let near = ends.plus || ends.minus || !folded || own - low < reach || high - own < reach;
        let (Some(click), true) = (self.click, free && shown.alarm.is_none()) else {
            books.clicks.forget();
            return Ok(());
        };
        let place = if folded { part(shown.programmed, axis) } else { offset };
        let turned = Turned {
            place,
            counts: *tick.inputs.wheels.of(axis),
            dropped: *shown.dropped.of(axis),
            click,
            near,
            rests: tick.rests,
        };
        match books.clicks.tick(&turned, books.pulse) {
            Ok(true) => coverage.happened("wheel counted exactly"),
            Ok(false) => {}
            Err(text) => return Err(("wheel", format!("{axis:?}: {text}"))),
        }
        Ok(())
    }

    /// The curve of the program.
    fn follow(&mut self, tick: &Tick<'_>, coverage: &mut Coverage) -> Result<(), (&'static str, String)> {
        let (shown, report) = (tick.shown, tick.report);
        let moved = shown.programmed != self.programmed;
        self.programmed = shown.programmed;
        let Some(track) = &mut self.track else { return Ok(()) };
        if track.waits(shown.state) && shown.alarm.is_none() {
            return Ok(());
        }
        if matches!(shown.state, State::Idle) || shown.alarm.is_some() {
            if matches!(shown.state, State::Idle) {
                coverage.happened("cycle reset");
            }
            self.track = None;
            return Ok(());
        }
        let wheel = matches!(shown.mode, Mode::Linked | Mode::Retrace);
        let reading = tick.inputs.spindle.map(|reading| reading.counts);
        track.turn(reading, report.driven.stage, f64::from(report.speed) / 4096.0);
        if let Err(text) = track.follow(shown.programmed, wheel) {
            let Lattice { x, z } = shown.programmed;
            return Err(("curve", format!("line {}: X {x} Z {z} is {text}", report.line)));
        }
        if moved && wheel {
            coverage.happened("path run by a wheel");
        }
        if matches!(shown.state, State::Ended) {
            coverage.happened("cycle ended");
            let ends = track.ends(shown.programmed);
            self.track = None;
            return ends.map_err(|text| ("end", text));
        }
        Ok(())
    }

    /// An alarm has a cause.
    pub(super) fn cause(&self, alarm: Alarm, tick: &Tick<'_>) -> Result<(), Failure> {
        let ends = |axis: Axis| {
            let ends = tick.inputs.ends.of(axis);
            ends.plus || ends.minus
        };
        let caused = match alarm {
            Alarm::Emergency => tick.pressed,
            Alarm::LimitSwitchX => ends(Axis::X),
            Alarm::LimitSwitchZ => ends(Axis::Z),
            Alarm::Homing => tick.shown.mode == Mode::Homing,
            // no board counts them here, and no scale is there
            Alarm::Underrun | Alarm::Overrun | Alarm::Late | Alarm::Watchdog | Alarm::PowerReturned => false,
            Alarm::FollowingX | Alarm::FollowingZ => false,
            Alarm::SpindleStopped
            | Alarm::SpindleReversed
            | Alarm::IndexLost
            | Alarm::EncoderNoise
            | Alarm::NoSpindle
            | Alarm::SpindleTooFast
            | Alarm::SpindleTooRough
            | Alarm::NoWayBack => self.spindle_asked,
        };
        let text = format!("{alarm}: without a cause");
        if caused { Ok(()) } else { Err(Failure { tick: tick.tick, rule: "cause".into(), text }) }
    }

    /// The session is over: what the pins have broken.
    pub(super) fn finish(mut self) -> Option<Failure> {
        // notes may end in the midst of a motion: what would follow is not that all stands
        if self.axes.iter().any(|books| books.still < STANDS) {
            self.watch.cut();
        }
        let faults = self.watch.finish();
        let first = faults.first().first()?;
        let tick = first.clocks / u64::from(interp_core::config::TICK_CLOCKS);
        Some(Failure { tick, rule: format!("limits {:?}", first.kind), text: first.to_string() })
    }
}

/// Ticks in which anything that moves comes to rest: each axis brakes from its largest speed with what a hand has of its
/// acceleration, an S law runs on by its window; twice that, and half a second.
fn calm(machine: &Machine) -> u64 {
    let of = |axis: Axis| {
        let limits = if axis == Axis::X { &machine.x } else { &machine.z };
        let share = limits.by_hand.min(limits.accel).max(1);
        u64::from(limits.speed / share)
    };
    let slowest = AXES.into_iter().map(of).max().unwrap_or(0);
    2 * (slowest + u64::from(machine.smoothing.ticks()) + 64) + 500
}
