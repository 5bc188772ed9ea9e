//! Runs a scenario: events become requests and readings, the foreground makes a tick, the machine plays the one before.

use std::io;

use handcnc::foreground::alarm::Faults;
use handcnc::foreground::kept::Kept;
use handcnc::foreground::mode::Mode;
use handcnc::foreground::shown::Shown;
use handcnc::foreground::{BLOCK_QUEUE, COMMAND_QUEUE, Command, Foreground, Memory};
use handcnc::queue::Queue;
use indicatif::ProgressBar;
use interp_core::block::Block;
use interp_core::channel::{Report, State};
use interp_core::config::Machine;
use interp_core::train;
use interp_core::units::{Axis, Lattice, Point};
use measure::{Faults as Broken, MotorWatch};
use serde_json::Value;

use super::background::Background;
use super::bench::Bench;
use super::chronicle::Chronicle;
use super::event::Event;
use super::state::{self, Refused, View};
use crate::output::Pending;
use crate::watch;

/// Ticks that all stands before a scenario without `end` is over.
const STILL: u64 = 200;
/// Ticks after the last event at which it is over in any case.
const LONGEST: u64 = 60_000;
/// Where a program begins of which nothing else is known.
pub(super) const NOWHERE: Point = Point { x: interp_core::units::Length::ZERO, z: interp_core::units::Length::ZERO };

/// An expectation that failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failed {
    /// Line of the script.
    pub line: u32,
    /// The line.
    pub text: String,
    /// What was found, and what was wanted.
    pub cause: String,
}

/// What a scenario left.
pub struct Done {
    /// The final state.
    pub state: Value,
    /// Expectations that failed.
    pub failed: Vec<Failed>,
    /// Rules of the motors that were broken.
    pub broken: Broken,
    /// What is drawn.
    pub chronicle: Chronicle,
    /// The machine at the end.
    pub machine: Machine,
    /// The trace, written but not in its place.
    pub trace: Option<Pending>,
    /// It was ended, as something still moved or ran a minute after the last event.
    pub endless: bool,
}

/// What comes after an event, or a stretch of time.
#[derive(Copy, Clone, PartialEq, Eq)]
pub(super) enum Next {
    Tick,
    Fail,
    On,
    End,
}

/// A scenario that runs.
pub(super) struct Control {
    pub(super) events: std::iter::Peekable<std::vec::IntoIter<Event>>,
    pub(super) bench: Bench,
    pub(super) background: Background,
    pub(super) watch: MotorWatch,
    pub(super) shown: Shown,
    pub(super) tick: u64,
    pub(super) last_event: u64,
    /// The last tick in which anything was going on.
    pub(super) busy: u64,
    pub(super) refused: Vec<Refused>,
    pub(super) failed: Vec<Failed>,
    pub(super) chronicle: Chronicle,
    pub(super) trace: Option<Pending>,
    pub(super) bar: ProgressBar,
    /// The emergency stop was pulled out, and the machine waits to be unlocked.
    pub(super) unlocking: bool,
    /// Where the program began that ran last.
    pub(super) began: Point,
    /// What the last ticks made reported, the newer one last.
    pub(super) reports: [Report; 2],
    /// Path that was left of the motion then, nm.
    pub(super) to_go: u64,
    pub(super) power: bool,
    pub(super) endless: bool,
}

impl Control {
    /// A scenario at its beginning.
    pub(super) fn new(
        events: Vec<Event>,
        bench: Bench,
        background: Background,
        trace: Option<Pending>,
        bar: ProgressBar,
    ) -> io::Result<Self> {
        let setup = watch::setup(&background.settings.parameters, &background.machine);
        let watch = MotorWatch::new(setup).map_err(io::Error::other)?;
        let last_event = events.last().map_or(0, |event| event.tick);
        let at = watch.position();
        Ok(Self {
            events: events.into_iter().peekable(),
            bench,
            shown: at_first(&background.machine, Lattice { x: at.x, z: at.z }),
            background,
            watch,
            tick: 0,
            last_event,
            busy: 0,
            refused: Vec::new(),
            failed: Vec::new(),
            chronicle: Chronicle::default(),
            trace,
            bar,
            unlocking: false,
            began: NOWHERE,
            reports: [Report::IDLE; 2],
            to_go: 0,
            power: true,
            endless: false,
        })
    }

    /// Runs it to its end.
    pub(super) fn run(mut self) -> io::Result<Done> {
        let mut kept = None;
        loop {
            if let Next::End = self.powered(&mut kept)? {
                break;
            }
            if let Next::End = self.dark()? {
                break;
            }
        }
        let state = self.state();
        // what moves when a script says `end` is not compared with a rest that does not follow
        if self.busy + 1 >= self.tick {
            self.watch.cut();
        }
        let broken = self.watch.finish();
        let machine = self.background.machine;
        let Self { failed, chronicle, trace, endless, .. } = self;
        Ok(Done { state, failed, broken, chronicle, machine, trace, endless })
    }

    /// A stretch of time with power.
    fn powered(&mut self, kept: &mut Option<Kept>) -> io::Result<Next> {
        let mut blocks = Queue::<Block, BLOCK_QUEUE>::new();
        let mut commands = Queue::<Command, COMMAND_QUEUE>::new();
        let ((mut block_in, block_out), (_, command_out)) = (blocks.split(), commands.split());
        let (start, mut memory) = (self.watch.position(), Memory::new());
        let at = Lattice { x: start.x, z: start.z };
        let mut foreground = Foreground::new(&self.background.machine, at, block_out, command_out, &mut memory);
        if let Some(kept) = kept {
            foreground.restore(kept);
        }
        self.switch_on(&mut foreground);
        loop {
            while let Some(event) = self.events.next_if(|event| event.tick <= self.tick) {
                self.chronicle.happened(self.tick, &event);
                let next = self.event(&event, &mut foreground)?;
                self.shown = foreground.shown();
                match next {
                    Next::Tick | Next::On => {}
                    Next::End => return Ok(Next::End),
                    Next::Fail => {
                        *kept = Some(foreground.kept());
                        self.fail();
                        return Ok(Next::Fail);
                    }
                }
            }
            self.unlock(&mut foreground);
            self.background.feed(&mut block_in)?;
            self.make(&mut foreground)?;
            if self.is_over() {
                return Ok(Next::End);
            }
        }
    }

    /// What the operator's side is told when the control is switched on.
    fn switch_on(&mut self, foreground: &mut Foreground<'_>) {
        let parameters = &self.background.settings.parameters;
        for (axis, table) in
            [(Axis::X, &self.background.settings.pitch.x), (Axis::Z, &self.background.settings.pitch.z)]
        {
            if let Some(table) = table {
                foreground.set_pitch_table(axis, table);
            }
        }
        let commands = [
            Command::Settle(self.background.operation()),
            Command::FeedOverride(parameters.feed_override()),
            Command::OptionalStop(parameters.optional_stop()),
            Command::Mode(Mode::Handwheel),
        ];
        for command in commands {
            if let Err(refusal) = foreground.request(command) {
                self.refuse(0, refusal.name(), &refusal.to_string());
            }
        }
        self.bench.spindle_percent(100);
        self.power = true;
        self.shown = foreground.shown();
    }

    /// A tick: readings, the foreground, the machine.
    fn make(&mut self, foreground: &mut Foreground<'_>) -> io::Result<()> {
        foreground.watch(Faults::default(), self.bench.pressed);
        foreground.read(&self.bench.read(self.tick));
        let mut made = Vec::with_capacity(64);
        let report = foreground.tick(&mut |event: train::Event| made.push(event.word()));
        let (before, after) = (self.shown, foreground.shown());
        self.shown = after;
        while let Some(refusal) = foreground.refused() {
            self.refuse_again(refusal, 1);
        }
        let ended = matches!(report.state, State::Ended) && !matches!(after.mode, Mode::ManualData);
        let program_ended = ended && self.background.is_busy();
        if before.alarm.is_none() && after.alarm.is_some() {
            self.background.stop();
        }
        self.background.follow(!matches!(report.state, State::Idle | State::Ended));
        self.bench.follow(report.output, after.alarm.is_some() || program_ended);
        self.reports = [self.reports[1], report];
        self.play(made)
    }

    /// Plays what was made in the tick before.
    fn play(&mut self, made: Vec<u32>) -> io::Result<()> {
        let played = self.bench.play(made);
        self.measure(&played)
    }

    fn measure(&mut self, played: &[u32]) -> io::Result<()> {
        let [before, now] = self.reports;
        let next = self.shown.distance_to_go > self.to_go;
        self.to_go = self.shown.distance_to_go;
        let stops = (before.speed == 0) != (now.speed == 0);
        let joint = next || stops || before.line != now.line || before.state != now.state;
        if joint {
            self.watch.joint();
        }
        self.watch.line(before.line);
        let before = self.watch.pulses();
        let (mut written, trace) = (Ok(()), &mut self.trace);
        self.watch.tick(played, &mut |clocks, x, z| {
            if let (Some(trace), Ok(())) = (trace.as_mut(), &written) {
                written =
                    std::io::Write::write_fmt(trace.writer(), format_args!("{},{x},{z}\n", measure::time_ns(clocks)));
            }
        });
        if joint {
            self.watch.joint();
        }
        let moved = self.watch.pulses() != before;
        self.chronicle.tick(self.tick, &self.shown, self.power);
        self.tick += 1;
        if moved || self.is_busy() {
            self.busy = self.tick;
        }
        if self.tick.is_multiple_of(256) {
            self.bar.set_position(self.tick);
        }
        written
    }

    /// Whether anything is going on, or about to.
    fn is_busy(&self) -> bool {
        let shown = &self.shown;
        let runs = matches!(shown.state, State::Running | State::Filling | State::Resetting);
        // what is driven by hand may stand as long as it likes
        let by_hand = matches!(shown.mode, Mode::Linked | Mode::Retrace | Mode::Power);
        shown.speed > 0 || runs && !by_hand || !self.bench.wheels_rest() || self.unlocking
    }

    /// Whether a scenario without `end` is over.
    fn is_over(&mut self) -> bool {
        if self.events.peek().is_some() {
            return false;
        }
        self.endless = self.tick >= self.last_event + LONGEST;
        self.endless || self.tick >= self.last_event.max(self.busy) + STILL
    }

    /// A stretch of time without power.
    fn dark(&mut self) -> io::Result<Next> {
        loop {
            while let Some(event) = self.events.next_if(|event| event.tick <= self.tick) {
                self.chronicle.happened(self.tick, &event);
                match self.event_in_the_dark(&event) {
                    Next::Tick | Next::Fail => {}
                    Next::On => return Ok(Next::On),
                    Next::End => return Ok(Next::End),
                }
            }
            // what hands turn meanwhile is lost
            let _ = self.bench.read(self.tick);
            let played = self.bench.dark();
            self.measure(&played)?;
            if self.is_over() {
                return Ok(Next::End);
            }
        }
    }

    /// The mains fail: what was made and not played is lost, and so is what memory held.
    fn fail(&mut self) {
        self.bench.cut();
        self.watch.cut();
        self.bench.follow(None, true);
        self.background.stop();
        (self.unlocking, self.power) = (false, false);
        self.reports = [Report::IDLE; 2];
        self.shown.outputs.motors = false;
        self.shown.outputs.spindle = false;
        self.shown.speed = 0;
        self.shown.state = State::Idle;
    }

    /// The state now.
    pub(super) fn state(&self) -> Value {
        let at = self.watch.position();
        state::json(&View {
            shown: &self.shown,
            bench: &self.bench,
            refused: &self.refused,
            tick: self.tick,
            train_hash: self.watch.train_hash(),
            played: Lattice { x: at.x, z: at.z },
            power: self.power,
        })
    }
}

/// What is to be seen of a lathe before it is switched on.
pub(super) fn at_first(machine: &Machine, at: Lattice) -> Shown {
    let (mut blocks, mut commands) = (Queue::<Block, 2>::new(), Queue::<Command, 2>::new());
    Foreground::new(machine, at, blocks.split().1, commands.split().1, &mut Memory::new()).shown()
}
