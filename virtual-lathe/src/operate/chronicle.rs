//! What was going on, moment by moment, in bounded memory: what the picture of a scenario is drawn of.

use handcnc::foreground::Command;
use handcnc::foreground::mode::Mode;
use handcnc::foreground::shown::Shown;
use interp_core::units::Lattice;

use super::event::{Event, What, Wheel};
use super::script::without_comment;

/// Most moments: beyond it every second one is left out.
const MOST: usize = 1 << 14;

/// A moment.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Moment {
    /// Ticks from the start.
    pub tick: u64,
    /// The mode.
    pub mode: Mode,
    /// Where the program is, pulses.
    pub programmed: Lattice,
    /// Where the axes are, pulses.
    pub position: Lattice,
    /// The power is on.
    pub power: bool,
}

/// Something worth a mark.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// A wheel is turned: from this tick to that, so many detents.
    Turn(Wheel, u64, u64, i32),
    /// Something is asked for, in the script's words.
    Asked(u64, String),
    /// Something is refused.
    Refusal(u64, String),
    /// An alarm comes.
    Alarm(u64, String),
}

/// What was going on.
#[derive(Clone, Debug, Default)]
pub struct Chronicle {
    moments: Vec<Moment>,
    /// Ticks between two moments, as a power of two.
    every: u32,
    marks: Vec<Mark>,
    alarmed: bool,
}

impl Chronicle {
    /// A tick has been played.
    pub(super) fn tick(&mut self, tick: u64, shown: &Shown, power: bool) {
        if shown.alarm.is_some() && !self.alarmed {
            let name = shown.alarm.map(|alarm| super::state::kebab(&format!("{alarm:?}"))).unwrap_or_default();
            self.marks.push(Mark::Alarm(tick, name));
        }
        self.alarmed = shown.alarm.is_some();
        if !tick.is_multiple_of(1 << self.every) {
            return;
        }
        if self.moments.len() == MOST {
            self.every += 1;
            let every = self.every;
            self.moments.retain(|moment| moment.tick.is_multiple_of(1 << every));
        }
        let Shown { mode, programmed, position, .. } = *shown;
        self.moments.push(Moment { tick, mode, programmed, position, power });
    }

    /// An event comes: a wheel's turn, or what else the operator or the machine does. Modes are seen by themselves.
    pub(super) fn happened(&mut self, tick: u64, event: &Event) {
        match event.what {
            What::Turn(wheel, detents, over_ns) => {
                self.marks.push(Mark::Turn(wheel, tick, tick + over_ns.div_ceil(1_000_000), detents));
            }
            What::Command(Command::Mode(_)) | What::Expect(_) | What::End => {}
            _ => {
                let words = without_comment(&event.text).split_whitespace().skip(1);
                self.marks.push(Mark::Asked(tick, words.collect::<Vec<_>>().join(" ")));
            }
        }
    }

    /// Something was refused.
    pub(super) fn refused(&mut self, tick: u64, name: &str) {
        self.marks.push(Mark::Refusal(tick, name.into()));
    }

    /// The moments, in order.
    #[must_use]
    pub fn moments(&self) -> &[Moment] {
        &self.moments
    }

    /// The marks, in the order in which they came.
    #[must_use]
    pub fn marks(&self) -> &[Mark] {
        &self.marks
    }
}
