//! Carries out events, and tells the oracle of requests that were obeyed.

use handcnc::foreground::alarm::Faults;
use handcnc::foreground::command::Stop;
use handcnc::foreground::inputs::{Inputs, PerAxis};
use handcnc::foreground::shown::Shown;
use handcnc::foreground::{Command, Foreground};
use interp_core::block::Feed;
use interp_core::drive::wheel::COUNTS;
use interp_core::units::{Axis, Lattice};

use super::{Next, Runner};
use crate::operate::event::What;
use crate::operate::soak::hand::Hand;
use crate::operate::soak::track::{nearest, part};
use crate::watch;

impl<H: Hand> Runner<'_, H> {
    pub(super) fn event(&mut self, text: &str, foreground: &mut Foreground<'_>) -> Next {
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
    pub(super) fn request(&mut self, command: Command, foreground: &mut Foreground<'_>) -> bool {
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
}
