//! What events ask for, and what becomes of it.

use std::io;

use handcnc::foreground::alarm::Faults;
use handcnc::foreground::mode::Mode;
use handcnc::foreground::refusal::Refusal;
use handcnc::foreground::{Command, Foreground};
use interp_core::channel::State;
use interp_core::units::Point;

use super::background::Failure;
use super::control::{Control, Failed, NOWHERE, Next};
use super::event::{Event, What};
use super::state::Refused;
use crate::watch;

/// Ticks in which a refusal that comes again counts as the same.
const AGAIN: u64 = 1_000;

impl Control {
    /// Unlocks the machine as soon as it stands.
    pub(super) fn unlock(&mut self, foreground: &mut Foreground<'_>) {
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

    pub(super) fn event_in_the_dark(&mut self, event: &Event) -> Next {
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
        true
    }

    pub(super) fn event(&mut self, event: &Event, foreground: &mut Foreground<'_>) -> io::Result<Next> {
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
        // one that is held goes on by cycle start: what is typed would begin where that has not got to yet
        if !matches!(foreground.state(), State::Idle | State::Ended) {
            return self.refuse(line, Refusal::CycleUnderWay.name(), &Refusal::CycleUnderWay.to_string());
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

    pub(super) fn refuse(&mut self, line: u32, name: &str, text: &str) {
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
    pub(super) fn refuse_again(&mut self, refusal: Refusal, times: u32) {
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
}

/// Where a program that is compiled now begins.
fn place(foreground: &Foreground<'_>) -> Point {
    foreground.programmed_nm().map_or(NOWHERE, |(x, z)| Point { x, z })
}
