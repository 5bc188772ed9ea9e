//! An operator at random: sees what a person sees, now and then does what makes sense, and now and then anything at all.
//!
//! He thinks at moments of his own, and what he does is noted in the words of a script: told to another machine at the same
//! ticks it leads to the same. A session ends with putting everything in order, from whatever it was left in: the machine has
//! to get to rest, to start again, and to run a program to its end.

mod at_shoulder;
mod deeds;
mod order;
mod whims;

use std::collections::VecDeque;

use handcnc::foreground::inputs::Joystick;
use handcnc::foreground::mode::Mode;
use interp_core::channel::State;

use super::chance::Chance;
use super::hand::{Hand, Seen};
use super::session::seconds;

/// What an operator does for a session.
pub(super) struct Operator {
    chance: Chance,
    /// What comes next, with its tick.
    plan: VecDeque<(u64, String)>,
    /// Ticks that the next thing planned is later.
    waits: u64,
    thinks_at: u64,
    /// Tick at which everything is put in order, and whether that has begun.
    until: u64,
    ordering: bool,
    programs: Vec<String>,
    /// How hasty: longest pause, ticks.
    pause: f64,
    /// One thing in so many is done for no reason.
    folly: u64,
    /// A program was loaded.
    loaded: bool,
    /// He likes to work at shoulders.
    shoulders: bool,
}

/// Name of the program that a session ends with; it is short.
pub(super) const LAST: &str = "last.nc";

/// Its text.
pub(super) const LAST_TEXT: &str =
    "G18 G21 G90 G94\nG0 X0.5 Z-0.5\nG1 X0.2 Z0.3 F300\nG3 X0.4 Z0.5 I0.2 K0\nG1 X0.1234 Z-0.4321\nM30\n";

impl Operator {
    /// For a session of so many ticks with these programs; he likes to work at shoulders, or does all that there is.
    pub(super) fn new(mut chance: Chance, ticks: u64, programs: &[(String, String)], shoulders: bool) -> Self {
        let pause = chance.spread(120.0, 6_000.0);
        let folly = chance.one_of(&[2, 3, 5, 8, 20]);
        let programs = programs.iter().map(|(name, _)| name.clone()).filter(|name| name != LAST).collect();
        Self {
            chance,
            plan: VecDeque::new(),
            waits: 0,
            thinks_at: 0,
            until: ticks,
            ordering: false,
            programs,
            pause,
            folly,
            loaded: false,
            shoulders,
        }
    }

    /// Plans something so many ticks after the last thing planned.
    fn then(&mut self, tick: u64, after: u64, text: impl Into<String>) {
        let at = self.plan.back().map_or(tick, |(at, _)| *at).max(tick) + after + std::mem::take(&mut self.waits);
        self.plan.push_back((at, text.into()));
    }

    fn think(&mut self, seen: &Seen<'_>) {
        let now = seen.tick;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some seconds at most")]
        let pause = self.chance.spread(1.0, self.pause) as u64;
        if now >= self.until {
            self.put_in_order(seen);
            return;
        }
        if !seen.power {
            let later = self.chance.bits() % 500;
            self.then(now, later, "power-on");
        } else if self.chance.once_in(self.folly) {
            self.anything(now);
        } else {
            self.sensible(seen);
        }
        self.thinks_at = self.plan.back().map_or(now, |(at, _)| *at) + pause;
    }

    /// What the situation asks for.
    fn sensible(&mut self, seen: &Seen<'_>) {
        let (now, shown) = (seen.tick, seen.shown);
        if seen.pressed || shown.alarm.is_some() && self.chance.once_in(2) {
            return self.then(now, 0, "release");
        }
        if seen.met {
            for way in ["x+", "x-", "z+", "z-"] {
                self.then(now, 0, format!("limit {way} off"));
            }
            return;
        }
        if seen.guard {
            return self.then(now, 0, "guard closed");
        }
        if !shown.outputs.motors && shown.alarm.is_none() {
            return self.then(now, 0, "motors on");
        }
        if !(shown.verified.x && shown.verified.z) && self.chance.once_in(2) {
            return match self.chance.whole(0, 3) {
                0 => self.home(now),
                1 => self.zero(now),
                _ => self.then(now, 0, "confirm-position"),
            };
        }
        if self.shoulders && matches!(shown.state, State::Idle | State::Ended) && self.chance.coin() {
            return self.work_at_shoulder(seen);
        }
        match shown.mode {
            Mode::Handwheel => self.in_handwheel(now),
            Mode::Power => self.in_power(seen),
            Mode::Linked => self.in_linked(seen),
            Mode::Automatic | Mode::ManualData => self.in_automatic(seen),
            Mode::Homing => self.home(now),
            Mode::Retrace => self.in_retrace(seen),
        }
    }

    /// Goes to another mode, and begins what belongs there.
    fn another_mode(&mut self, now: u64) {
        match self.chance.whole(0, 9) {
            0 => self.then(now, 0, "mode handwheel"),
            1..=2 => {
                self.then(now, 0, "joystick off");
                self.then(now, 0, "mode power");
                let feed = self.feed_rate();
                self.then(now, 1, feed);
            }
            3..=4 => {
                self.then(now, 0, "mode linked");
                self.contour(now);
                self.turn(now, Some("contour"));
            }
            5..=7 => {
                self.then(now, 0, "mode auto");
                self.program(now);
                self.then(now, 1, "start");
            }
            8 => {
                self.then(now, 0, "mode mdi");
                self.typed(now);
            }
            _ => self.home(now),
        }
    }

    fn program(&mut self, now: u64) {
        if self.programs.is_empty() || self.loaded && !self.chance.once_in(3) {
            return;
        }
        self.loaded = true;
        let at = self.chance.bits() % self.programs.len() as u64;
        #[expect(clippy::cast_possible_truncation, reason = "below the length")]
        let name = self.programs.get(at as usize).cloned().unwrap_or_default();
        self.then(now, 0, format!("load {name}"));
    }

    fn in_handwheel(&mut self, now: u64) {
        match self.chance.whole(0, 9) {
            0..=6 => self.turn(now, None),
            7 => self.scale(now),
            _ => self.another_mode(now),
        }
    }

    fn in_power(&mut self, seen: &Seen<'_>) {
        let now = seen.tick;
        if seen.joystick != Joystick::Off && self.chance.once_in(2) {
            return self.then(now, 0, "joystick off");
        }
        match self.chance.whole(0, 19) {
            0..=6 => self.push(now),
            7 => self.then(now, 0, "return"),
            8 => {
                let times = self.chance.whole(0, 4);
                self.then(now, 0, format!("repeat {times}"));
            }
            9..=10 => self.stop_at(now),
            11 => {
                let feed = self.feed_rate();
                self.then(now, 0, feed);
            }
            12 => self.contour(now),
            13 => self.rapid(now),
            14..=15 => self.turn(now, None),
            16 => self.overrides(now),
            17 if self.chance.coin() => self.thread_by_hand(now),
            _ => {
                self.then(now, 0, "joystick off");
                self.another_mode(now);
            }
        }
    }

    fn in_linked(&mut self, seen: &Seen<'_>) {
        let now = seen.tick;
        match self.chance.whole(0, 19) {
            0..=8 => self.turn(now, Some("contour")),
            9..=11 => self.turn(now, None),
            12 => {
                let way = self.chance.one_of(&["path+", "path-", "off"]);
                self.then(now, 0, format!("joystick {way}"));
            }
            13 => self.contour(now),
            14 => self.offset(now),
            15 => {
                self.program(now);
                self.then(now, 0, "start");
            }
            16 => self.scale(now),
            17 => self.then(now, 0, "reset"),
            _ => self.another_mode(now),
        }
    }

    fn in_automatic(&mut self, seen: &Seen<'_>) {
        let now = seen.tick;
        match seen.shown.state {
            State::Running | State::Filling => match self.chance.whole(0, 19) {
                0..=4 => {}
                5..=8 => self.turn(now, None),
                9..=11 => self.then(now, 0, "hold"),
                12..=14 => self.overrides(now),
                15 => self.switches(now),
                16 => self.offset(now),
                17 => self.scale(now),
                18 => self.trouble(now),
                _ => self.then(now, 0, "reset"),
            },
            State::Holding | State::Stopped => match self.chance.whole(0, 15) {
                0..=4 => self.then(now, 0, "start"),
                5..=8 => self.turn(now, None),
                9..=10 => self.offset(now),
                11..=13 => self.then(now, 0, "mode retrace"),
                14 => self.switches(now),
                _ => self.then(now, 0, "reset"),
            },
            State::Resetting => {}
            State::Idle | State::Ended => match self.chance.whole(0, 9) {
                0..=5 if seen.shown.mode == Mode::ManualData => self.typed(now),
                0..=3 => {
                    self.program(now);
                    self.then(now, 0, "start");
                }
                4 => self.switches(now),
                5 => self.then(now, 0, "resume"),
                6 => self.offset(now),
                _ => self.another_mode(now),
            },
        }
    }

    fn in_retrace(&mut self, seen: &Seen<'_>) {
        let now = seen.tick;
        match self.chance.whole(0, 11) {
            0..=5 => self.turn(now, Some("contour")),
            6 => self.turn(now, None),
            7 => {
                let way = self.chance.one_of(&["path+", "path-", "off"]);
                self.then(now, 0, format!("joystick {way}"));
            }
            8 => self.offset(now),
            9 => self.then(now, 0, "start"),
            _ => {
                self.then(now, 0, "joystick off");
                self.then(now, 200, "mode auto");
                self.then(now, 1, "start");
            }
        }
    }
}

impl Hand for Operator {
    fn next(&mut self, seen: &Seen<'_>) -> Option<String> {
        if self.plan.is_empty() && seen.tick >= self.thinks_at.min(self.until.max(seen.tick)) {
            self.think(seen);
        }
        match self.plan.front() {
            Some((at, _)) if *at <= seen.tick => self.plan.pop_front().map(|(_, text)| text),
            _ => None,
        }
    }

    fn due(&self) -> u64 {
        self.plan.front().map_or(self.thinks_at, |(at, _)| *at)
    }
}

/// What a session is named in a comment.
pub(super) fn title(tick: u64, rule: &str, text: &str) -> String {
    format!("second {}: {rule}: {text}", seconds(tick))
}
