//! Who does what in a session: an operator, or notes of what was done.

use handcnc::foreground::inputs::{Joystick, PerAxis};
use handcnc::foreground::shown::Shown;

use super::session::Line;

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
