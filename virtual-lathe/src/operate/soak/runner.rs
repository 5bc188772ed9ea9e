//! Runs a session: the firmware's foreground under what an operator does, with an oracle beside it, and no model of motors.
//!
//! It is the runner of a scenario without a machine round it: requests, readings and the background's side are the same, the
//! slides are where the pins have led. So a session is a scenario, and what fails here can be run and drawn there.

use std::path::Path;

use feature_editor::codes::Format;
use handcnc::background::compile::Compiler;
use handcnc::foreground::alarm::Faults;
use handcnc::foreground::command::Stop;
use handcnc::foreground::inputs::{AXES, Ends, Inputs, Joystick, PerAxis};
use handcnc::foreground::kept::Kept;
use handcnc::foreground::mode::Mode;
use handcnc::foreground::refusal::Refusal;
use handcnc::foreground::shown::Shown;
use handcnc::foreground::{BLOCK_QUEUE, COMMAND_QUEUE, Command, Foreground, Memory};
use handcnc::queue::Queue;
use interp_core::block::{Block, Feed};
use interp_core::channel::State;
use interp_core::drive::wheel::COUNTS;
use interp_core::train;
use interp_core::units::{Axis, Lattice, Length, Point};
use serde_json::{Value, json};

use super::coverage::Coverage;
use super::oracle::{Failure, Oracle, Tick};
use super::programs;
use super::session::{Line, Session};
use super::spindle::Spindle;
use super::track::{Track, compile, nearest, part};
use crate::operate::background::{Background, Failure as Unloaded};
use crate::operate::event::{Source, Switch, What, Wheel};
use crate::operate::noise::Noise;
use crate::operate::script;
use crate::operate::state::kebab;
use crate::operate::wheels::Wheels;
use crate::program::Program;
use crate::settings::Settings;
use crate::watch;

/// Nanoseconds of a tick.
const TICK_NS: u64 = 1_000_000;

/// Ticks between two checks of what ends in time.
const CALMLY: u64 = 200;

/// What an operator sees.
pub(super) struct Seen<'s> {
    pub(super) tick: u64,
    pub(super) shown: &'s Shown,
    pub(super) power: bool,
    pub(super) pressed: bool,
    pub(super) guard: bool,
    pub(super) joystick: Joystick,
    /// Where the program is, mm.
    pub(super) place: PerAxis<f64>,
    /// Any limit switch is held.
    pub(super) met: bool,
    pub(super) calm: u64,
}

/// Who does what.
pub(super) trait Hand {
    /// What is done next at this tick, in the words of a script, if anything.
    fn next(&mut self, seen: &Seen<'_>) -> Option<String>;
    /// The first tick at which something may be done again.
    fn due(&self) -> u64;
}

/// What was written before.
pub(super) struct Script<'s> {
    lines: std::slice::Iter<'s, Line>,
    last: u64,
}

impl<'s> Script<'s> {
    pub(super) fn new(lines: &'s [Line]) -> Self {
        Self { lines: lines.iter(), last: lines.last().map_or(0, |line| line.tick) }
    }
}

impl Hand for Script<'_> {
    fn next(&mut self, seen: &Seen<'_>) -> Option<String> {
        match self.lines.as_slice().first() {
            Some(line) if line.tick <= seen.tick => self.lines.next().map(|line| line.text.clone()),
            Some(_) => None,
            None if seen.tick > self.last + CALMLY + 2 * seen.calm => Some("end".into()),
            None => None,
        }
    }

    fn due(&self) -> u64 {
        self.lines.as_slice().first().map_or(0, |line| line.tick)
    }
}

/// What a session led to.
#[derive(Clone, Debug)]
pub(super) struct Outcome {
    pub(super) failure: Option<Failure>,
    pub(super) hash: u64,
    pub(super) coverage: Coverage,
    /// Things that were done.
    pub(super) done: Vec<(u64, String)>,
}

/// Why a session can't be run: its parameters are wrong.
pub(super) type Unfit = String;

/// What comes after an event.
#[derive(Copy, Clone, PartialEq, Eq)]
enum Next {
    On,
    Fail,
    Power,
    End,
}

pub(super) struct Runner<'s, H> {
    session: &'s Session,
    hand: H,
    background: Background,
    spindle: Spindle,
    wheels: Wheels,
    noise: [Noise; 3],
    inputs: Inputs,
    switches: PerAxis<[Switch; 2]>,
    /// A switch is at a place: it has to be compared.
    placed: bool,
    pressed: bool,
    unlocking: bool,
    power: bool,
    began: Point,
    loaded: Option<String>,
    oracle: Oracle,
    shown: Shown,
    tick: u64,
    events: Vec<u32>,
    coverage: Coverage,
    done: Vec<(u64, String)>,
    failure: Option<Failure>,
}

impl<'s, H: Hand> Runner<'s, H> {
    pub(super) fn new(session: &'s Session, hand: H) -> Result<Self, Unfit> {
        let mut settings = Settings::default();
        settings.set("handwheels", "true")?;
        for (name, value) in &session.set {
            settings.set(name, value).map_err(|error| format!("{name} = {value}: {error}"))?;
        }
        let machine = settings.parameters.machine().map_err(|error| error.to_string())?;
        let figures = |error: figures::FigureError| error.to_string();
        let spindle = Spindle::new(&settings.figures, 4).map_err(figures)?;
        let wheels = Wheels::new(&settings.figures).map_err(figures)?;
        let setup = watch::setup(&settings.parameters, &machine);
        let operation = settings.parameters.operation(&machine);
        let oracle = Oracle::new(setup, &machine, operation)?;
        let at = oracle.position();
        let free = [Switch::Held(false); 2];
        Ok(Self {
            session,
            hand,
            shown: crate::operate::control::at_first(&machine, at),
            background: Background::new(settings, machine, Some(Format::Gcode)),
            spindle,
            wheels,
            noise: [1, 2, 3].map(Noise::new),
            inputs: Inputs::NONE,
            switches: PerAxis { x: free, z: free },
            placed: false,
            pressed: false,
            unlocking: false,
            power: true,
            began: Point { x: Length::ZERO, z: Length::ZERO },
            loaded: None,
            oracle,
            tick: 0,
            events: Vec::with_capacity(1024),
            coverage: Coverage::default(),
            done: Vec::new(),
            failure: None,
        })
    }

    /// Runs it to its end, or to the first failure.
    pub(super) fn run(mut self) -> Outcome {
        let mut kept = None;
        while self.failure.is_none() {
            if self.powered(&mut kept) == Next::End || self.dark() == Next::End {
                break;
            }
        }
        let hash = self.oracle.hash();
        self.coverage.sessions = 1;
        let limits = self.oracle.finish();
        let failure = match (self.failure, limits) {
            // what was broken first
            (Some(a), Some(b)) => Some(if b.tick < a.tick { b } else { a }),
            (a, b) => a.or(b),
        };
        Outcome { failure, hash, coverage: self.coverage, done: self.done }
    }

    fn powered(&mut self, kept: &mut Option<Kept>) -> Next {
        let mut blocks = Queue::<Block, BLOCK_QUEUE>::new();
        let mut commands = Queue::<Command, COMMAND_QUEUE>::new();
        let ((mut block_in, block_out), (_, command_out)) = (blocks.split(), commands.split());
        let start = self.oracle.position();
        let mut memory = Memory::new();
        let mut foreground = Foreground::new(&self.background.machine, start, block_out, command_out, &mut memory);
        if let Some(kept) = &kept {
            foreground.restore(kept);
            let back = foreground.kept();
            let same = Kept { line: kept.line, ..back } == *kept;
            if !same || foreground.shown().verified != (PerAxis { x: false, z: false }) {
                self.fail("kept", format!("{kept:?} came back as {back:?}"));
            }
        }
        foreground.set_encoder(self.spindle.turn());
        let parameters = &self.background.settings.parameters;
        let commands = [
            Command::Settle(self.background.operation()),
            Command::FeedOverride(parameters.feed_override()),
            Command::OptionalStop(parameters.optional_stop()),
            Command::Mode(Mode::Handwheel),
        ];
        for command in commands {
            let _ = foreground.request(command);
        }
        self.spindle.percent(100);
        self.power = true;
        self.shown = foreground.shown();
        self.oracle.switched_on(self.tick, &self.shown);
        while self.failure.is_none() {
            while self.hand.due() <= self.tick {
                let Some(text) = self.ask() else { break };
                let next = self.event(&text, &mut foreground);
                self.shown = foreground.shown();
                match next {
                    Next::On | Next::Power => {}
                    Next::End => return Next::End,
                    Next::Fail => {
                        *kept = Some(foreground.kept());
                        self.cut_off();
                        return Next::Fail;
                    }
                }
            }
            self.unlock(&mut foreground);
            if let Err(error) = self.background.feed(&mut block_in) {
                self.fail("feed", error.to_string());
            }
            self.make(&mut foreground);
        }
        Next::End
    }

    /// What the operator does next.
    fn ask(&mut self) -> Option<String> {
        let seen = Seen {
            tick: self.tick,
            shown: &self.shown,
            power: self.power,
            pressed: self.pressed,
            guard: self.inputs.guard,
            joystick: self.inputs.joystick,
            place: PerAxis { x: self.mm(self.shown.programmed, Axis::X), z: self.mm(self.shown.programmed, Axis::Z) },
            met: self.switches.x.iter().chain(&self.switches.z).any(|switch| *switch == Switch::Held(true)),
            calm: self.oracle.calm(),
        };
        let text = self.hand.next(&seen)?;
        self.coverage.request(&text);
        self.done.push((self.tick, text.clone()));
        Some(text)
    }

    /// The mains fail.
    fn cut_off(&mut self) {
        self.oracle.cut();
        self.spindle.off();
        self.background.stop();
        (self.unlocking, self.power) = (false, false);
        self.shown.state = State::Idle;
    }

    /// A stretch of time without power.
    fn dark(&mut self) -> Next {
        loop {
            while self.hand.due() <= self.tick {
                let Some(text) = self.ask() else { break };
                match self.parse(&text) {
                    Some(What::PowerOn) => return Next::Power,
                    Some(What::End) => return Next::End,
                    Some(what) if self.by_hand(&what) => {}
                    Some(_) => self.coverage.refusal("no-power", 1),
                    None => return Next::End,
                }
            }
            let _ = self.read();
            self.spindle.tick();
            self.tick += 1;
        }
    }

    fn fail(&mut self, rule: &str, text: String) {
        if self.failure.is_none() {
            self.failure = Some(Failure { tick: self.tick, rule: rule.into(), text });
        }
    }

    fn parse(&mut self, text: &str) -> Option<What> {
        match script::parse(&format!("0 {text}")) {
            Ok(script) => script.events.into_iter().next().map(|event| event.what),
            Err(errors) => {
                let cause = errors.first().map_or(String::new(), |error| error.cause.clone());
                self.fail("script", format!("{text}: {cause}"));
                None
            }
        }
    }

    /// The readings of a tick.
    fn read(&mut self) -> Inputs {
        let now = self.tick * TICK_NS;
        for (wheel, noise) in Wheel::ALL.into_iter().zip(&mut self.noise) {
            if !noise.is_silent() {
                let by = noise.counts();
                if by != 0 {
                    self.wheels.disturb(wheel, by, now);
                }
            }
        }
        if !self.wheels.rest() {
            let wheels = &mut self.wheels;
            self.inputs.wheels = PerAxis { x: wheels.read(Wheel::X, now), z: wheels.read(Wheel::Z, now) };
            self.inputs.contour = wheels.read(Wheel::Contour, now);
        } else if self.inputs.wheels != (PerAxis { x: 0, z: 0 }) || self.inputs.contour != 0 {
            (self.inputs.wheels, self.inputs.contour) = (PerAxis { x: 0, z: 0 }, 0);
        }
        self.inputs.spindle = Some(self.spindle.read());
        if self.placed {
            self.look_at_switches();
        }
        self.inputs
    }

    fn look_at_switches(&mut self) {
        let at = self.oracle.position();
        for axis in AXES {
            let mm = self.mm(at, axis);
            let met = |switch: Switch, plus: bool| match switch {
                Switch::Held(on) => on,
                Switch::At(place) => (mm >= place && plus) || (mm <= place && !plus),
            };
            let [plus, minus] = *self.switches.of(axis);
            *self.inputs.ends.of_mut(axis) = Ends { plus: met(plus, true), minus: met(minus, false) };
        }
    }

    /// The place of an axis in mm.
    fn mm(&self, at: Lattice, axis: Axis) -> f64 {
        let pulse = if axis == Axis::X { self.background.machine.x.pulse } else { self.background.machine.z.pulse };
        f64::from(part(at, axis)) * f64::from(pulse.numerator()) / f64::from(pulse.denominator()) * 1e-6
    }

    /// A tick.
    fn make(&mut self, foreground: &mut Foreground<'_>) {
        foreground.watch(Faults::default(), self.pressed);
        let inputs = self.read();
        foreground.read(&inputs);
        self.events.clear();
        let events = &mut self.events;
        let report = foreground.tick(&mut |event: train::Event| events.push(event.word()));
        let (before, after) = (self.shown, foreground.shown());
        self.shown = after;
        while let Some(refusal) = foreground.refused() {
            self.coverage.refusal(refusal.name(), 1);
        }
        let compensation = PerAxis { x: foreground.compensation(Axis::X), z: foreground.compensation(Axis::Z) };
        let tick = Tick {
            tick: self.tick,
            events: &self.events,
            report: &report,
            shown: &after,
            inputs: &inputs,
            compensation,
            pressed: self.pressed,
            rests: foreground.hands_rest(),
        };
        let mut found = self.oracle.tick(&tick, &mut self.coverage);
        if let (Ok(()), None, Some(alarm)) = (&found, before.alarm, after.alarm) {
            found = self.oracle.cause(alarm, &tick);
        }
        if let Err(failure) = found {
            self.failure = Some(failure);
        }
        let ended = matches!(report.state, State::Ended) && after.mode != Mode::ManualData;
        let program_ended = ended && self.background.is_busy();
        if before.alarm.is_none() && after.alarm.is_some() {
            self.background.stop();
        }
        self.background.follow(!matches!(report.state, State::Idle | State::Ended));
        if let Some(output) = report.output {
            self.spindle.output(output);
        }
        if after.alarm.is_some() || program_ended {
            self.spindle.off();
        }
        self.spindle.tick();
        self.tick += 1;
    }

    /// Unlocks the machine as soon as it stands.
    fn unlock(&mut self, foreground: &mut Foreground<'_>) {
        if !self.unlocking {
            return;
        }
        match foreground.request(Command::Unlock) {
            Err(Refusal::Moving) => return,
            Err(refusal) => self.coverage.refusal(refusal.name(), 1),
            Ok(()) if foreground.alarm().is_some() => return,
            Ok(()) => {}
        }
        self.unlocking = false;
    }

    /// What hands and switches do, power or not. False where it is something else.
    fn by_hand(&mut self, what: &What) -> bool {
        match *what {
            What::Turn(wheel, detents, over) => self.wheels.turn(wheel, detents, self.tick * TICK_NS, over),
            What::Joystick(joystick) => self.inputs.joystick = joystick,
            What::Rapid(down) => self.inputs.rapid = down,
            What::Limit(axis, plus, switch) => {
                let [at_plus, at_minus] = self.switches.of_mut(axis);
                *(if plus { at_plus } else { at_minus }) = switch;
                let all = self.switches.x.iter().chain(&self.switches.z);
                self.placed = all.into_iter().any(|switch| matches!(switch, Switch::At(_)));
                self.look_at_switches();
            }
            What::Guard(open) => self.inputs.guard = open,
            What::Noise(Source::Spindle, rate) => self.spindle.disturb(rate),
            What::Noise(Source::Wheel(wheel), rate) => {
                let [x, z, contour] = &mut self.noise;
                match wheel {
                    Wheel::X => x,
                    Wheel::Z => z,
                    Wheel::Contour => contour,
                }
                .set(rate);
            }
            What::LoseIndex(lost) => self.spindle.lose_index(lost),
            What::Wobble(percent, hz) => self.spindle.wobble(percent / 100.0, hz),
            _ => return false,
        }
        true
    }

    fn event(&mut self, text: &str, foreground: &mut Foreground<'_>) -> Next {
        let Some(what) = self.parse(text) else { return Next::End };
        match &what {
            what if self.by_hand(what) => {
                // a request of the same tick meets the switches as they are now
                let none = PerAxis { x: 0, z: 0 };
                foreground.read(&Inputs { wheels: none, contour: 0, spindle: None, ..self.inputs });
            }
            What::Command(command) => {
                self.request(*command, foreground);
            }
            What::Lever(engage) => {
                self.oracle.spindle_is_asked();
                self.request(Command::Lever(*engage), foreground);
            }
            What::PickUp(step) => {
                self.oracle.spindle_is_asked();
                self.request(Command::PickUp(*step), foreground);
            }
            What::Start => self.start(foreground),
            What::Load(file) => self.load(file, foreground),
            What::ManualData(text) => self.manual_data(text, foreground),
            What::BlockSkip(on) => {
                let set = self.background.settings.set("block_delete", if *on { "true" } else { "false" });
                if set.is_err() {
                    self.coverage.refusal("unknown", 1);
                }
            }
            What::Set(name, value) => self.set(name, value, foreground),
            What::Resume => self.resume(foreground),
            What::EmergencyStop => {
                self.pressed = true;
                foreground.watch(Faults::default(), true);
                self.oracle.stopped();
                self.background.stop();
                self.spindle.off();
            }
            What::Release => {
                self.pressed = false;
                foreground.watch(Faults::default(), false);
                self.unlocking = true;
                self.unlock(foreground);
            }
            What::PowerFail => return Next::Fail,
            What::Expect(expect) => {
                self.shown = foreground.shown();
                if let Err(cause) = expect.check(&self.state()) {
                    self.fail(&format!("expect {}", expect.key), cause);
                }
            }
            What::End => return Next::End,
            _ => self.coverage.refusal("power-is-on", 1),
        }
        Next::On
    }

    /// A request; what is refused changes nothing.
    fn request(&mut self, command: Command, foreground: &mut Foreground<'_>) -> bool {
        let before = (foreground.shown(), foreground.kept(), foreground.state());
        let result = foreground.request(command);
        let after = (foreground.shown(), foreground.kept(), foreground.state());
        if let Err(refusal) = result {
            self.coverage.refusal(refusal.name(), 1);
            if before != after {
                self.fail(
                    "refusal",
                    format!("{command:?} was refused ({refusal}), and changed {before:?} to {after:?}"),
                );
            }
            return false;
        }
        self.obeyed(command, &before.0, foreground);
        true
    }

    /// What the oracle has to know of a request that was obeyed.
    fn obeyed(&mut self, command: Command, before: &Shown, foreground: &Foreground<'_>) {
        let (shown, calm) = (foreground.shown(), self.oracle.calm());
        let compensation = PerAxis { x: foreground.compensation(Axis::X), z: foreground.compensation(Axis::Z) };
        match command {
            Command::Spindle(milli_rpm) => self.spindle.hand(f64::from(milli_rpm) / 1e3),
            Command::SpindleOverride(percent) => self.spindle.percent(percent),
            Command::FeedRate(Feed::PerTurn(_)) => self.oracle.spindle_is_asked(),
            Command::Scale(click) => {
                let nm = click.map(|click| (click.count() * COUNTS) >> interp_core::config::FRACTION_BITS);
                self.oracle.scale(nm);
            }
            Command::Reset => {
                self.background.stop();
                self.spindle.off();
                self.oracle.shoulders.program(false);
                self.oracle.reset(self.tick);
            }
            Command::Zero(axis, at) => {
                let machine = &self.background.machine;
                let pulse = if axis == Axis::X { machine.x.pulse } else { machine.z.pulse };
                let (wanted, found) = (pulse.nearest(at), part(shown.position, axis));
                if found != wanted {
                    self.fail("zero", format!("{axis:?} was set to {wanted} pulses and shows {found}"));
                }
                let other = if axis == Axis::X { Axis::Z } else { Axis::X };
                if part(shown.position, other) != part(before.position, other) {
                    self.fail("zero", format!("{axis:?} was set, and {other:?} changed"));
                }
                self.oracle.placed(axis, &shown, compensation);
            }
            Command::ConfirmPosition | Command::Motors(_) => self.oracle.confirmed(&shown),
            Command::MachineLock(on) => {
                self.oracle.lock(on, &shown);
                self.oracle.obeyed(self.tick, 0);
            }
            Command::NullOffset => {
                // at the safe speed
                let safe = u64::from(self.background.operation().safe.max(1));
                let far = |axis: Axis| {
                    let machine = &self.background.machine;
                    let pulse = if axis == Axis::X { machine.x.pulse } else { machine.z.pulse };
                    let nm = u64::from(part(shown.offset, axis).unsigned_abs()) * u64::from(pulse.numerator());
                    nm / u64::from(pulse.denominator()) * 4096
                };
                self.oracle.obeyed(self.tick, far(Axis::X).max(far(Axis::Z)) / safe + calm);
            }
            Command::KeepOffset | Command::BookWear => {
                if shown.position != before.position || shown.offset != Lattice::default() {
                    self.fail("offset", format!("{command:?} changed the place from {before:?} to {shown:?}"));
                }
                self.oracle.offset_taken();
                self.oracle.obeyed(self.tick, 0);
            }
            Command::Mode(_) => {
                self.oracle.shoulders.program(false);
                self.oracle.obeyed(self.tick, 0);
            }
            Command::Home(_) | Command::Return | Command::Resume | Command::Contour(_) => {
                self.oracle.obeyed(self.tick, 0);
            }
            Command::StopAt(axis, stop) => {
                let machine = &self.background.machine;
                let pulse = if axis == Axis::X { machine.x.pulse } else { machine.z.pulse };
                let place = match stop {
                    Stop::At(at) => Some(nearest(i64::from(at.nm()), pulse)),
                    Stop::Here => Some(part(shown.programmed, axis)),
                    Stop::Off => None,
                };
                self.oracle.shoulders.set(axis, place);
            }
            Command::Lever(_) | Command::PickUp(_) => self.oracle.obeyed(self.tick, 0),
            Command::Configure(_) | Command::Settle(_) => {}
            Command::Start => self.oracle.stirs(self.tick),
            Command::Hold | Command::Unlock | Command::Repeat(_) => {}
            Command::FeedOverride(_) | Command::RapidOverride(_) | Command::OptionalStop(_) => {}
            Command::SingleBlock(_) | Command::DryRun(_) | Command::FeedRate(_) => {}
        }
    }

    fn place(foreground: &Foreground<'_>) -> Point {
        let nowhere = Point { x: Length::ZERO, z: Length::ZERO };
        foreground.programmed_nm().map_or(nowhere, |(x, z)| Point { x, z })
    }

    fn load(&mut self, file: &Path, foreground: &Foreground<'_>) {
        let name = file.display().to_string();
        let Some(text) = self.session.program(&name) else {
            return self.coverage.refusal("unreadable", 1);
        };
        let program = Program::Text { name: name.clone(), text: text.as_bytes().to_vec() };
        match self.background.take(program, Self::place(foreground)) {
            Ok(()) => self.loaded = Some(name),
            Err(failure) => self.unloaded(&failure),
        }
    }

    fn unloaded(&mut self, failure: &Unloaded) {
        self.coverage.refusal(failure.name, 1);
    }

    /// Cycle start: goes on, or runs the program from its first line.
    fn start(&mut self, foreground: &mut Foreground<'_>) {
        let goes_on = !matches!(foreground.state(), State::Idle | State::Ended);
        if goes_on || !matches!(foreground.shown().mode, Mode::Automatic | Mode::Linked) {
            self.request(Command::Start, foreground);
            return;
        }
        let at = Self::place(foreground);
        let source = match self.background.program_from(at) {
            Ok(source) => source,
            Err(failure) => return self.unloaded(&failure),
        };
        if self.request(Command::Start, foreground) {
            self.began = at;
            self.background.run(source);
            self.oracle.shoulders.program(true);
            let text = self.loaded.as_deref().and_then(|name| self.session.program(name)).unwrap_or_default();
            if text.contains("G33") || text.contains("G95") {
                self.oracle.spindle_is_asked();
            }
            let mut settings = self.background.settings.parameters.settings();
            settings.start = at;
            let mut compiler = Compiler::new(settings, Format::Gcode, &self.background.machine);
            let mut blocks = compile(text, &mut compiler);
            let from = foreground.programmed();
            let track = Track::new(
                blocks.make_contiguous(),
                from,
                programs::end(text),
                &self.background.machine,
                self.spindle.turn(),
            );
            self.oracle.track = Some(track);
        }
    }

    fn manual_data(&mut self, text: &str, foreground: &mut Foreground<'_>) {
        if foreground.shown().mode != Mode::ManualData {
            return self.coverage.refusal(Refusal::WrongMode(Mode::ManualData).name(), 1);
        }
        if !matches!(foreground.state(), State::Idle | State::Ended) {
            return self.coverage.refusal(Refusal::CycleUnderWay.name(), 1);
        }
        let typed = match self.background.typed(text, Self::place(foreground)) {
            Ok(typed) => typed,
            Err(failure) => return self.unloaded(&failure),
        };
        if self.request(Command::Start, foreground) {
            self.oracle.spindle_is_asked();
            self.oracle.track = None;
            self.background.run_typed(typed);
        }
    }

    fn resume(&mut self, foreground: &mut Foreground<'_>) {
        let interrupted = foreground.shown().interrupted;
        let place = Self::place(foreground);
        let reentry = (interrupted != 0)
            .then(|| self.background.reenter(interrupted, foreground.programmed(), place, self.began));
        match reentry {
            Some(Err(failure)) => self.unloaded(&failure),
            Some(Ok(reentry)) => {
                if self.request(Command::Resume, foreground) {
                    self.background.run_from(reentry);
                    let text = self.loaded.as_deref().and_then(|name| self.session.program(name)).unwrap_or_default();
                    let track = Track::only_end(programs::end(text), &self.background.machine);
                    self.oracle.track = Some(track);
                }
            }
            None => {
                self.request(Command::Resume, foreground);
            }
        }
    }

    /// Sets a parameter.
    fn set(&mut self, name: &str, value: &str, foreground: &mut Foreground<'_>) {
        let mut settings = self.background.settings.clone();
        if settings.set(name, value).is_err() {
            return self.coverage.refusal("unknown", 1);
        }
        let Ok(machine) = settings.parameters.machine() else {
            return self.coverage.refusal("contradiction", 1);
        };
        if !self.request(Command::Configure(machine), foreground) {
            return;
        }
        (self.background.settings, self.background.machine) = (settings, machine);
        self.request(Command::Settle(self.background.operation()), foreground);
        let parameters = &self.background.settings.parameters;
        let setup = watch::setup(parameters, &self.background.machine);
        let operation = self.background.operation();
        let (feed, stop) = (parameters.feed_override(), parameters.optional_stop());
        match name {
            "feed_override" => drop(self.request(Command::FeedOverride(feed), foreground)),
            "optional_stop" => drop(self.request(Command::OptionalStop(stop), foreground)),
            _ => {}
        }
        if let Err(error) = self.oracle.configure(setup, &self.background.machine, operation) {
            self.fail("script", error);
        }
    }

    /// What `expect` looks at: of a scenario's state, what there is without a machine.
    fn state(&self) -> Value {
        let shown = &self.shown;
        let both = |at: Lattice| json!({"x": at.x, "z": at.z});
        let alarms: Vec<String> = shown.alarm.iter().map(|alarm| kebab(&format!("{alarm:?}"))).collect();
        json!({
            "mode": shown.mode.name(),
            "state": kebab(&format!("{:?}", shown.state)),
            "position": both(shown.position),
            "programmed": both(shown.programmed),
            "offset": both(shown.offset),
            "kept": both(shown.kept),
            "wear": both(shown.wear),
            "alarms": alarms,
            "verified": {"x": shown.verified.x, "z": shown.verified.z},
            "outputs": {"motors": shown.outputs.motors, "spindle": shown.outputs.spindle},
            "block": shown.line,
            "interrupted": shown.interrupted,
        })
    }
}
