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
//! * **wheel**: [`Clicks`](super::clicks::Clicks).
//! * **cause**: an alarm has what it tells of.

mod axis;
mod rest;
mod told;

use handcnc::foreground::alarm::Alarm;
use handcnc::foreground::inputs::{Inputs, Joystick, PerAxis};
use handcnc::foreground::mode::Mode;
use handcnc::foreground::settings::Settings as Operation;
use handcnc::foreground::shown::Shown;
use interp_core::channel::{Report, State};
use interp_core::config::Machine;
use interp_core::drive::ThreadStage;
use interp_core::units::{Axis, Lattice};
use measure::{MotorWatch, Setup};

use axis::AxisBooks;
use rest::calm;

use super::coverage::Coverage;
use super::shoulders::{Fed, Shoulders};
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
    /// Last tick in which a thread was under way.
    threaded: u64,
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
            threaded: 0,
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
        if !matches!(stage, ThreadStage::None | ThreadStage::Left) {
            self.threaded = tick.tick;
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
        if added || self.retracts(tick) {
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

    /// X goes out of a thread, or into it, beside the path or right after it: its way has a rounding of its own, as a hand's has.
    fn retracts(&self, tick: &Tick<'_>) -> bool {
        let [x, _] = &self.axes;
        match tick.report.driven.stage {
            ThreadStage::Leaving | ThreadStage::Entering => true,
            ThreadStage::Left => x.still < STANDS,
            ThreadStage::None | ThreadStage::Waiting | ThreadStage::Cutting | ThreadStage::Returning => false,
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
