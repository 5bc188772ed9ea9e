//! What an oracle is told of: requests that were obeyed, and what else it can't see on the pins.

use handcnc::foreground::inputs::PerAxis;
use handcnc::foreground::settings::Settings as Operation;
use handcnc::foreground::shown::Shown;
use interp_core::channel::State;
use interp_core::config::Machine;
use interp_core::units::Axis;
use measure::Setup;

use super::axis::AxisBooks;
use super::rest::calm;
use super::{Oracle, part};
use crate::operate::soak::clicks::Clicks;
use crate::operate::soak::shoulders::Shoulders;
use crate::operate::soak::track::Track;

impl Oracle {
    /// The train was cut off.
    pub(in crate::operate::soak) fn cut(&mut self) {
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
    pub(in crate::operate::soak) fn stopped(&mut self) {
        self.cut_books();
        self.stopped = true;
    }

    /// Power is on again.
    pub(in crate::operate::soak) fn switched_on(&mut self, tick: u64, shown: &Shown) {
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
    pub(in crate::operate::soak) fn configure(
        &mut self,
        setup: Setup,
        machine: &Machine,
        operation: Operation,
    ) -> Result<(), String> {
        self.operation = operation;
        self.calm = calm(machine);
        for books in &mut self.axes {
            books.forget_limits();
            books.clicks.forget();
        }
        self.watch.configure(setup).map_err(|error| error.to_string())
    }

    /// An axis was set to a place.
    pub(in crate::operate::soak) fn placed(&mut self, axis: Axis, shown: &Shown, compensation: PerAxis<i32>) {
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
    pub(in crate::operate::soak) fn confirmed(&mut self, shown: &Shown) {
        for books in &mut self.axes {
            books.soft_limit.forget();
            // no home was found, whatever the mode
            books.verified = *shown.verified.of(books.axis);
        }
    }

    /// A request was obeyed that may move a slide, or forgets what a wheel asked for.
    pub(in crate::operate::soak) fn obeyed(&mut self, tick: u64, takes: u64) {
        self.stirred = self.stirred.max(tick + takes);
        self.axes.iter_mut().for_each(|books| books.clicks.forget());
    }

    /// All was stopped: what the wheels had asked for is told as dropped, up to a count that was begun.
    pub(in crate::operate::soak) fn reset(&mut self, tick: u64) {
        self.stirred = self.stirred.max(tick);
        self.axes.iter_mut().for_each(|books| books.clicks.broken());
        self.track = self.track.take().filter(Track::has_begun);
    }

    /// Something begins, and may be held at once.
    pub(in crate::operate::soak) fn stirs(&mut self, tick: u64) {
        self.stirred = self.stirred.max(tick);
    }

    /// The spindle may have a say.
    pub(in crate::operate::soak) const fn spindle_is_asked(&mut self) {
        self.spindle_asked = true;
    }

    pub(in crate::operate::soak) fn scale(&mut self, click: Option<i64>) {
        self.click = click;
        self.axes.iter_mut().for_each(|books| books.clicks.forget());
    }

    pub(in crate::operate::soak) fn lock(&mut self, locked: bool, shown: &Shown) {
        self.locked = locked;
        self.shoulders.lock(locked, shown.programmed);
        self.axes.iter_mut().for_each(AxisBooks::forget_limits);
    }

    /// The offset was called something else.
    pub(in crate::operate::soak) fn offset_taken(&mut self) {
        self.axes.iter_mut().for_each(|books| books.bound = None);
    }
}
