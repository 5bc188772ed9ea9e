//! Runs a scenario: events become requests and readings, the foreground makes a tick, the machine plays the one before.

use std::io;

use handcnc::foreground::alarm::Faults;
use handcnc::foreground::kept::Kept;
use handcnc::foreground::mode::Mode;
use handcnc::foreground::refusal::Refusal;
use handcnc::foreground::shown::Shown;
use handcnc::foreground::{BLOCK_QUEUE, COMMAND_QUEUE, Command, Foreground};
use handcnc::queue::Queue;
use indicatif::ProgressBar;
use interp_core::block::Block;
use interp_core::channel::{Report, State};
use interp_core::config::Machine;
use interp_core::train;
use interp_core::units::{Axis, Lattice, Point};
use measure::{Faults as Broken, MotorWatch};
use serde_json::Value;

use super::background::{Background, Failure};
use super::bench::Bench;
use super::chronicle::Chronicle;
use super::event::{Event, What};
use super::state::{self, Refused, View};
use crate::output::Pending;
use crate::watch;

/// Ticks that all stands before a scenario without `end` is over.
const STILL: u64 = 200;
/// Ticks after the last event at which it is over in any case.
const LONGEST: u64 = 60_000;
/// Ticks in which a refusal that comes again counts as the same.
const AGAIN: u64 = 1_000;
/// Where a program begins of which nothing else is known.
const NOWHERE: Point = Point { x: interp_core::units::Length::ZERO, z: interp_core::units::Length::ZERO };

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
enum Next {
    Tick,
    Fail,
    On,
    End,
}

/// A scenario that runs.
pub(super) struct Control {
    events: std::iter::Peekable<std::vec::IntoIter<Event>>,
    bench: Bench,
    background: Background,
    watch: MotorWatch,
    shown: Shown,
    tick: u64,
    last_event: u64,
    /// The last tick in which anything was going on.
    busy: u64,
    refused: Vec<Refused>,
    failed: Vec<Failed>,
    chronicle: Chronicle,
    trace: Option<Pending>,
    bar: ProgressBar,
    /// The emergency stop was pulled out, and the machine waits to be unlocked.
    unlocking: bool,
    /// Where the program began that ran last.
    began: Point,
    /// What the last ticks made reported, the newer one last.
    reports: [Report; 2],
    /// Path that was left of the motion then, nm.
    to_go: u64,
    power: bool,
    endless: bool,
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
        let start = self.watch.position();
        let mut foreground =
            Foreground::new(&self.background.machine, Lattice { x: start.x, z: start.z }, block_out, command_out);
        if let Some(kept) = kept {
            foreground.restore(kept);
        }
        self.switch_on(&mut foreground);
        loop {
            while let Some(event) = self.events.next_if(|event| event.tick <= self.tick) {
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
        let (last, times) = foreground.refused();
        if let Some(refusal) = last {
            self.refuse_again(refusal, times);
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
        let joint = next || before.line != now.line || before.state != now.state;
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

    /// Unlocks the machine as soon as it stands.
    fn unlock(&mut self, foreground: &mut Foreground<'_>) {
        if !self.unlocking {
            return;
        }
        match foreground.request(Command::Unlock) {
            Err(Refusal::Moving) => return,
            Err(refusal) => self.refuse(0, refusal.name(), &refusal.to_string()),
            // it stays locked until the channel has come to its end
            Ok(()) if foreground.alarm().is_some() => return,
            Ok(()) => {}
        }
        self.unlocking = false;
    }

    fn event_in_the_dark(&mut self, event: &Event) -> Next {
        match &event.what {
            What::PowerOn => return Next::On,
            What::End => return Next::End,
            What::Expect(expect) => {
                let state = self.state();
                self.expect(event, expect.check(&state));
            }
            what if self.by_hand(what) => {}
            What::Set(..) => self.refuse(event.line, "no-power", "the power is off"),
            _ => self.refuse(event.line, "no-power", "the power is off: nothing is obeyed"),
        }
        Next::Tick
    }

    /// What hands and switches do, power or not. False where it is something else.
    fn by_hand(&mut self, what: &What) -> bool {
        let bench = &mut self.bench;
        match *what {
            What::Turn(wheel, detents, over) => bench.turn(self.tick, wheel, detents, over),
            What::Joystick(joystick) => bench.joystick = joystick,
            What::Rapid(down) => bench.rapid = down,
            What::Limit(axis, plus, switch) => bench.limit(axis, plus, switch),
            What::Guard(open) => bench.guard = open,
            What::Noise(source, rate) => bench.disturb(source, rate),
            What::LoseIndex(lost) => bench.spindle.lose_index(lost),
            What::Wobble(percent, hz) => bench.spindle.wobble(percent / 100.0, hz),
            _ => return false,
        }
        self.chronicle.turned(self.tick, what);
        true
    }

    fn event(&mut self, event: &Event, foreground: &mut Foreground<'_>) -> io::Result<Next> {
        let line = event.line;
        match &event.what {
            what if self.by_hand(what) => {
                // a request of the same tick meets the switches as they are now
                foreground.read(&self.bench.at_once());
            }
            What::Command(command) => self.command(line, *command, foreground),
            What::Start => self.start(line, foreground),
            What::Load(file) => {
                let at = place(foreground);
                let loaded = self.background.load(file, at);
                self.outcome(line, loaded);
            }
            What::ManualData(text) => self.manual_data(line, text, foreground),
            What::BlockSkip(on) => {
                let value = if *on { "true" } else { "false" };
                let set =
                    self.background.settings.set("block_delete", value).map_err(|text| Failure::new("unknown", text));
                self.outcome(line, set);
            }
            What::Set(name, value) => self.set(line, name, value, foreground)?,
            What::Resume => self.resume(line, foreground)?,
            What::EmergencyStop => {
                self.bench.pressed = true;
                self.bench.cut();
                self.watch.cut();
                foreground.watch(Faults::default(), true);
                self.background.stop();
                self.bench.follow(None, true);
            }
            What::Release => {
                self.bench.pressed = false;
                foreground.watch(Faults::default(), false);
                self.unlocking = true;
                self.unlock(foreground);
            }
            What::Lever(engage) => self.command(line, Command::Lever(*engage), foreground),
            What::PickUp(step) => self.command(line, Command::PickUp(*step), foreground),
            What::PowerFail => return Ok(Next::Fail),
            What::PowerOn => self.refuse(line, "power-is-on", "the power is on already"),
            What::Expect(expect) => {
                self.shown = foreground.shown();
                let state = self.state();
                self.expect(event, expect.check(&state));
            }
            What::End => return Ok(Next::End),
            _ => {}
        }
        Ok(Next::Tick)
    }

    fn command(&mut self, line: u32, command: Command, foreground: &mut Foreground<'_>) {
        if let Err(refusal) = foreground.request(command) {
            return self.refuse(line, refusal.name(), &refusal.to_string());
        }
        match command {
            Command::Spindle(milli_rpm) => self.bench.spindle.hand(f64::from(milli_rpm) / 1e3),
            Command::SpindleOverride(percent) => self.bench.spindle_percent(percent),
            Command::Reset => {
                self.background.stop();
                self.bench.follow(None, true);
            }
            _ => {}
        }
    }

    /// Cycle start: goes on, or runs the program from its first line.
    fn start(&mut self, line: u32, foreground: &mut Foreground<'_>) {
        let goes_on = !matches!(foreground.state(), State::Idle | State::Ended);
        if goes_on || foreground.shown().mode == Mode::ManualData {
            return self.command(line, Command::Start, foreground);
        }
        if !matches!(foreground.shown().mode, Mode::Automatic | Mode::Linked) {
            // no other mode runs a program: the foreground says which
            return self.command(line, Command::Start, foreground);
        }
        let at = place(foreground);
        let source = match self.background.program_from(at) {
            Ok(source) => source,
            // what locks the machine is nearer than what is wrong with the program
            Err(_) if foreground.alarm().is_some() => return self.command(line, Command::Start, foreground),
            Err(failure) => return self.outcome(line, Err(failure)),
        };
        match foreground.request(Command::Start) {
            Ok(()) => {
                self.began = at;
                self.background.run(source);
            }
            Err(refusal) => self.refuse(line, refusal.name(), &refusal.to_string()),
        }
    }

    fn manual_data(&mut self, line: u32, text: &str, foreground: &mut Foreground<'_>) {
        let mode = foreground.shown().mode;
        if mode != Mode::ManualData {
            let refusal = Refusal::WrongMode(Mode::ManualData);
            return self.refuse(line, refusal.name(), &refusal.to_string());
        }
        let typed = match self.background.typed(text, place(foreground)) {
            Ok(typed) => typed,
            Err(failure) => return self.outcome(line, Err(failure)),
        };
        match foreground.request(Command::Start) {
            Ok(()) => self.background.run_typed(typed),
            Err(refusal) => self.refuse(line, refusal.name(), &refusal.to_string()),
        }
    }

    /// Goes back into the program that was interrupted.
    fn resume(&mut self, line: u32, foreground: &mut Foreground<'_>) -> io::Result<()> {
        let interrupted = foreground.shown().interrupted;
        let reentry = if interrupted == 0 {
            None
        } else {
            Some(self.background.reenter(interrupted, foreground.programmed(), place(foreground), self.began))
        };
        if let Some(Err(failure)) = reentry {
            self.outcome(line, Err(failure));
            return Ok(());
        }
        match (foreground.request(Command::Resume), reentry) {
            (Ok(()), Some(Ok(reentry))) => self.background.run_from(reentry),
            (Ok(()), _) => {}
            (Err(refusal), _) => self.refuse(line, refusal.name(), &refusal.to_string()),
        }
        Ok(())
    }

    /// Sets a parameter.
    fn set(&mut self, line: u32, name: &str, value: &str, foreground: &mut Foreground<'_>) -> io::Result<()> {
        let mut settings = self.background.settings.clone();
        if let Err(text) = settings.set(name, value) {
            self.refuse(line, "unknown", &text);
            return Ok(());
        }
        let machine = match settings.parameters.machine() {
            Ok(machine) => machine,
            Err(error) => {
                self.refuse(line, "contradiction", &error.to_string());
                return Ok(());
            }
        };
        if let Err(refusal) = foreground.request(Command::Configure(machine)) {
            self.refuse(line, refusal.name(), &refusal.to_string());
            return Ok(());
        }
        (self.background.settings, self.background.machine) = (settings, machine);
        self.command(line, Command::Settle(self.background.operation()), foreground);
        let parameters = &self.background.settings.parameters;
        let setup = watch::setup(parameters, &self.background.machine);
        match name {
            "feed_override" => self.command(line, Command::FeedOverride(parameters.feed_override()), foreground),
            "optional_stop" => self.command(line, Command::OptionalStop(parameters.optional_stop()), foreground),
            _ => {}
        }
        self.watch.configure(setup).map_err(io::Error::other)
    }

    fn outcome(&mut self, line: u32, result: Result<(), Failure>) {
        if let Err(Failure { name, text }) = result {
            self.refuse(line, name, &text);
        }
    }

    fn refuse(&mut self, line: u32, name: &str, text: &str) {
        self.chronicle.refused(self.tick, name);
        self.refused.push(Refused {
            tick: self.tick,
            last: self.tick,
            line,
            name: name.into(),
            text: text.into(),
            times: 1,
        });
    }

    /// The foreground refuses something by itself: often in every tick that it lasts.
    fn refuse_again(&mut self, refusal: Refusal, times: u32) {
        let (name, tick) = (refusal.name(), self.tick);
        let same = |refused: &&mut Refused| refused.line == 0 && refused.name == name && tick - refused.last < AGAIN;
        match self.refused.iter_mut().rev().find(same) {
            Some(refused) => {
                refused.last = tick;
                refused.times = refused.times.saturating_add(times);
            }
            None => self.refuse(0, name, &refusal.to_string()),
        }
    }

    fn expect(&mut self, event: &Event, result: Result<(), String>) {
        if let Err(cause) = result {
            self.failed.push(Failed { line: event.line, text: event.text.clone(), cause });
        }
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

/// Where a program that is compiled now begins.
fn place(foreground: &Foreground<'_>) -> Point {
    foreground.programmed_nm().map_or(NOWHERE, |(x, z)| Point { x, z })
}

/// What is to be seen of a lathe before it is switched on.
fn at_first(machine: &Machine, at: Lattice) -> Shown {
    let (mut blocks, mut commands) = (Queue::<Block, 2>::new(), Queue::<Command, 2>::new());
    Foreground::new(machine, at, blocks.split().1, commands.split().1).shown()
}
