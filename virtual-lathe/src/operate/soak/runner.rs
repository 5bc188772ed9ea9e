//! Runs a session: the firmware's foreground under what an operator does, with an oracle beside it, and no model of motors.
//!
//! It is the runner of a scenario without a machine round it: requests, readings and the background's side are the same, the
//! slides are where the pins have led. So a session is a scenario, and what fails here can be run and drawn there.

mod cycles;
mod readings;
mod requests;

use feature_editor::codes::Format;
use handcnc::foreground::alarm::Faults;
use handcnc::foreground::inputs::{Inputs, PerAxis};
use handcnc::foreground::kept::Kept;
use handcnc::foreground::mode::Mode;
use handcnc::foreground::refusal::Refusal;
use handcnc::foreground::shown::Shown;
use handcnc::foreground::{BLOCK_QUEUE, COMMAND_QUEUE, Command, Foreground, Memory};
use handcnc::queue::Queue;
use interp_core::block::Block;
use interp_core::channel::State;
use interp_core::train;
use interp_core::units::{Axis, Lattice, Length, Point};
use serde_json::{Value, json};

use super::coverage::Coverage;
use super::hand::{Hand, Seen};
use super::oracle::{Failure, Oracle, Tick};
use super::session::Session;
use super::spindle::Spindle;
use crate::operate::background::Background;
use crate::operate::event::{Switch, What};
use crate::operate::noise::Noise;
use crate::operate::script;
use crate::operate::state::kebab;
use crate::operate::wheels::Wheels;
use crate::settings::Settings;
use crate::watch;

/// Nanoseconds of a tick.
const TICK_NS: u64 = 1_000_000;

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
