//! Programs: loaded, started, typed, gone back into.

use std::path::Path;

use feature_editor::codes::Format;
use handcnc::background::compile::Compiler;
use handcnc::foreground::mode::Mode;
use handcnc::foreground::refusal::Refusal;
use handcnc::foreground::{Command, Foreground};
use interp_core::channel::State;
use interp_core::units::{Length, Point};

use super::Runner;
use crate::operate::background::Failure as Unloaded;
use crate::operate::soak::hand::Hand;
use crate::operate::soak::programs;
use crate::operate::soak::track::{Track, compile};
use crate::program::Program;

impl<H: Hand> Runner<'_, H> {
    fn place(foreground: &Foreground<'_>) -> Point {
        let nowhere = Point { x: Length::ZERO, z: Length::ZERO };
        foreground.programmed_nm().map_or(nowhere, |(x, z)| Point { x, z })
    }

    pub(super) fn load(&mut self, file: &Path, foreground: &Foreground<'_>) {
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
    pub(super) fn start(&mut self, foreground: &mut Foreground<'_>) {
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

    pub(super) fn manual_data(&mut self, text: &str, foreground: &mut Foreground<'_>) {
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

    pub(super) fn resume(&mut self, foreground: &mut Foreground<'_>) {
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
}
