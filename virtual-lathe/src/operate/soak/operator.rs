//! An operator at random: sees what a person sees, now and then does what makes sense, and now and then anything at all.
//!
//! He thinks at moments of his own, and what he does is noted in the words of a script: told to another machine at the same
//! ticks it leads to the same. A session ends with putting everything in order, from whatever it was left in: the machine has
//! to get to rest, to start again, and to run a program to its end.

use std::collections::VecDeque;

use handcnc::foreground::inputs::Joystick;
use handcnc::foreground::mode::Mode;
use interp_core::channel::State;

use super::chance::Chance;
use super::runner::{Hand, Seen};
use super::session::seconds;

/// What an operator does for a session.
pub(super) struct Operator {
    pub(super) chance: Chance,
    /// What comes next, with its tick.
    plan: VecDeque<(u64, String)>,
    /// Ticks that the next thing planned is later.
    pub(super) waits: u64,
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
    pub(super) fn then(&mut self, tick: u64, after: u64, text: impl Into<String>) {
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

    /// Something for no reason.
    fn anything(&mut self, now: u64) {
        match self.chance.whole(0, 39) {
            0..=5 => self.turn(now, None),
            6 => self.turn(now, Some("contour")),
            7 => self.scale(now),
            8 => self.push(now),
            9 => self.then(now, 0, "joystick off"),
            10 => self.rapid(now),
            11 => {
                let mode = self.chance.one_of(&Mode::ALL).name();
                self.then(now, 0, format!("mode {mode}"));
            }
            12..=13 => self.then(now, 0, "start"),
            14 => self.then(now, 0, "hold"),
            15 => self.then(now, 0, "reset"),
            16..=17 => self.overrides(now),
            18..=19 => self.switches(now),
            20 => self.offset(now),
            21 => self.contour(now),
            22 => self.stop_at(now),
            23 => self.then(now, 0, "return"),
            24 => {
                let times = self.chance.whole(0, 4);
                self.then(now, 0, format!("repeat {times}"));
            }
            25 => self.home(now),
            26 => self.zero(now),
            27 => self.then(now, 0, "confirm-position"),
            28 => {
                let on = self.chance.one_of(&["on", "off"]);
                self.then(now, 0, format!("motors {on}"));
            }
            29 => self.typed(now),
            30 => self.program(now),
            31 => {
                let feed = self.feed_rate();
                self.then(now, 0, feed);
            }
            32 => self.set(now),
            33..=34 => self.spindle(now),
            35 => self.then(now, 0, "resume"),
            36 => self.thread_by_hand(now),
            37 => self.then(now, 0, "release"),
            _ => self.trouble(now),
        }
    }

    /// What goes wrong with a machine.
    fn trouble(&mut self, now: u64) {
        match self.chance.whole(0, 11) {
            0..=2 => {
                self.then(now, 0, "estop");
                let later = self.chance.bits() % 2_000;
                self.then(now, later, "release");
            }
            3..=4 => {
                let later = self.chance.bits() % 3_000;
                self.then(now, 0, "guard open");
                self.then(now, later, "guard closed");
            }
            5..=6 => {
                let (way, later) = (self.chance.one_of(&["x+", "x-", "z+", "z-"]), self.chance.bits() % 2_000);
                self.then(now, 0, format!("limit {way} on"));
                self.then(now, later, format!("limit {way} off"));
            }
            7 => {
                let later = self.chance.bits() % 1_000;
                self.then(now, 0, "power-fail");
                self.then(now, later, "power-on");
            }
            8 => {
                let source = self.chance.one_of(&["wheel-x", "wheel-z", "wheel-contour", "spindle"]);
                let (rate, later) = (self.chance.spread(1.0, 400.0), self.chance.bits() % 4_000);
                self.then(now, 0, format!("noise {source} {rate:.1}"));
                self.then(now, later, format!("noise {source} 0"));
            }
            9 => {
                let later = self.chance.bits() % 4_000;
                self.then(now, 0, "lose-index on");
                self.then(now, later, "lose-index off");
            }
            10 => {
                let (percent, hz) = (self.chance.spread(0.5, 30.0), self.chance.spread(0.2, 4.0));
                self.then(now, 0, format!("spindle-wobble {percent:.2} {hz:.2}"));
            }
            _ => self.spindle(now),
        }
    }

    pub(super) fn turn(&mut self, now: u64, wheel: Option<&'static str>) {
        let wheel = wheel.unwrap_or_else(|| self.chance.one_of(&["x", "z", "x", "z", "contour"]));
        let sign = if self.chance.coin() { 1 } else { -1 };
        let turn = |operator: &mut Self, detents: f64, over: f64, after: u64| {
            #[expect(clippy::cast_possible_truncation, reason = "some thousands")]
            let detents = (detents.round() as i64).max(1) * sign;
            operator.then(now, after, format!("wheel {wheel} {detents:+} over {over:.3}"));
        };
        match self.chance.whole(0, 9) {
            // creeps
            0..=1 => {
                let (detents, over) = (self.chance.spread(1.0, 5.0), self.chance.spread(0.1, 2.0));
                turn(self, detents, over, 0);
            }
            2..=5 => {
                let (detents, over) = (self.chance.spread(3.0, 120.0), self.chance.spread(0.2, 3.0));
                turn(self, detents, over, 0);
            }
            // spins
            6..=7 => {
                let (detents, over) = (self.chance.spread(50.0, 1_500.0), self.chance.spread(0.3, 3.0));
                turn(self, detents, over, 0);
            }
            // a burst
            8 => {
                let (detents, over) = (self.chance.spread(5.0, 300.0), self.chance.spread(0.001, 0.03));
                turn(self, detents, over, 0);
            }
            // to and fro
            _ => {
                let (detents, over) = (self.chance.spread(2.0, 60.0), self.chance.spread(0.02, 0.5));
                for at in 0..self.chance.whole(2, 8) {
                    let sign = if at % 2 == 0 { 1.0 } else { -1.0 };
                    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below a second")]
                    let after = (over * 1e3) as u64;
                    let detents = detents.round() * sign;
                    self.then(
                        now,
                        if at == 0 { 0 } else { after },
                        format!("wheel {wheel} {detents:+} over {over:.3}"),
                    );
                }
            }
        }
    }

    fn scale(&mut self, now: u64) {
        let scale = self.chance.one_of(&["1", "10", "100", "100", "speed"]);
        self.then(now, 0, format!("scale {scale}"));
    }

    fn push(&mut self, now: u64) {
        let way = self.chance.one_of(&["x+", "x-", "z+", "z-", "path+", "path-"]);
        self.then(now, 0, format!("joystick {way}"));
        if self.chance.coin() {
            let later = self.chance.bits() % 4_000;
            self.then(now, later, "joystick off");
        }
    }

    fn rapid(&mut self, now: u64) {
        let later = self.chance.bits() % 2_000;
        self.then(now, 0, "rapid on");
        self.then(now, later, "rapid off");
    }

    pub(super) fn feed_rate(&mut self) -> String {
        if self.chance.once_in(4) {
            format!("feed-rate {:.3} mm/rev", self.chance.spread(0.02, 2.0))
        } else {
            format!("feed-rate {:.1} mm/min", self.chance.spread(5.0, 5_000.0))
        }
    }

    pub(super) fn contour(&mut self, now: u64) {
        let mut far = || {
            let sign = self.chance.one_of(&[1.0, -1.0]);
            self.chance.spread(0.05, 20.0) * sign
        };
        let (a, b, c, d) = (far(), far(), far(), far());
        let text = if self.chance.coin() {
            format!("taper {a:.3} {b:.3}")
        } else if self.chance.once_in(4) {
            // mostly none that can be followed
            format!("arc {a:.3} {b:.3} {c:.3} {d:.3} cw")
        } else {
            let sweep = self.chance.real(-6.2, 6.2);
            let (radius, from) = (a.hypot(b), (-a).atan2(-b));
            let (x, z) = (a + radius * (from + sweep).sin(), b + radius * (from + sweep).cos());
            format!("arc {x:.4} {z:.4} {a:.4} {b:.4} {}", if sweep > 0.0 { "ccw" } else { "cw" })
        };
        self.then(now, 0, text);
    }

    fn stop_at(&mut self, now: u64) {
        let axis = self.chance.one_of(&["x", "z"]);
        let text = match self.chance.whole(0, 5) {
            0 => format!("stop-at {axis} off"),
            1 => format!("stop-at {axis} here"),
            _ => format!("stop-at {axis} {:.3}", self.chance.real(-20.0, 20.0)),
        };
        self.then(now, 0, text);
    }

    fn offset(&mut self, now: u64) {
        let what = self.chance.one_of(&["null-offset", "null-offset", "keep-offset", "book-wear"]);
        self.then(now, 0, what);
    }

    fn overrides(&mut self, now: u64) {
        let text = match self.chance.whole(0, 5) {
            0..=3 => format!("feed {}", self.chance.one_of(&[0, 1, 10, 50, 100, 100, 150, 200])),
            4 => format!("rapid-override {}", self.chance.one_of(&[0, 5, 50, 100, 100])),
            _ => format!("spindle-override {}", self.chance.one_of(&[0, 50, 100, 100, 120, 200])),
        };
        self.then(now, 0, text);
    }

    fn switches(&mut self, now: u64) {
        let name = self.chance.one_of(&["single", "dry-run", "lock", "optional-stop", "block-skip"]);
        let on = self.chance.one_of(&["on", "off", "off"]);
        self.then(now, 0, format!("{name} {on}"));
    }

    fn zero(&mut self, now: u64) {
        let axis = self.chance.one_of(&["x", "z"]);
        let place = self.chance.real(-10.0, 10.0);
        self.then(now, 0, format!("zero {axis} {place:.4}"));
    }

    fn home(&mut self, now: u64) {
        let axis = self.chance.one_of(&["x", "z"]);
        self.then(now, 0, "mode home");
        match self.chance.whole(0, 3) {
            // hands press the switch
            0 => {
                let (side, later, held) =
                    (self.chance.one_of(&["+", "-"]), self.chance.bits() % 3_000, self.chance.bits() % 400);
                self.then(now, 1, format!("home {axis}"));
                self.then(now, later, format!("limit {axis}{side} on"));
                self.then(now, held, format!("limit {axis}{side} off"));
            }
            _ => {
                let far = self.chance.spread(1.0, 40.0);
                self.then(now, 0, format!("limit {axis}+ at {far:.3}"));
                self.then(now, 0, format!("limit {axis}- at -{far:.3}"));
                self.then(now, 1, format!("home {axis}"));
                let wait = self.chance.bits() % 12_000;
                self.then(now, wait, format!("limit {axis}+ off"));
                self.then(now, 0, format!("limit {axis}- off"));
            }
        }
        let mode = self.chance.one_of(&["auto", "handwheel", "power", "linked"]);
        self.then(now, 10, format!("mode {mode}"));
    }

    fn typed(&mut self, now: u64) {
        let (x, z) = (self.chance.real(-15.0, 15.0), self.chance.real(-15.0, 15.0));
        let text = match self.chance.whole(0, 9) {
            0 => "M3 S300".into(),
            1 => "M5".into(),
            2 => "G91 G1 X0.5 Z0.25 F400".into(),
            3 => "G90".into(),
            4 => "G99 what".into(),
            5..=6 => format!("G0 X{x:.3} Z{z:.3}"),
            _ => format!("G1 X{x:.3} Z{z:.3} F{:.0}", self.chance.spread(20.0, 4_000.0)),
        };
        self.then(now, 0, format!("mdi {text}"));
    }

    fn spindle(&mut self, now: u64) {
        let text = match self.chance.whole(0, 3) {
            0 => "spindle stop".into(),
            1 => format!("spindle -{:.0}", self.chance.spread(30.0, 1_500.0)),
            _ => format!("spindle {:.0}", self.chance.spread(30.0, 2_000.0)),
        };
        self.then(now, 0, text);
    }

    fn thread_by_hand(&mut self, now: u64) {
        let text = match self.chance.whole(0, 6) {
            0..=1 => "threading-lever in",
            2 => "threading-lever out",
            3 => "pick-up begin",
            4 => "pick-up capture",
            5 => "pick-up go",
            _ => {
                let lead = self.chance.spread(0.2, 2.0);
                self.then(now, 0, format!("feed-rate {lead:.3} mm/rev"));
                self.then(now, 0, format!("spindle {:.0}", 300.0));
                let way = self.chance.one_of(&["z+", "z-"]);
                self.then(now, 1_500, "threading-lever in");
                self.then(now, 10, format!("joystick {way}"));
                let later = self.chance.bits() % 4_000;
                self.then(now, later, "joystick off");
                "threading-lever out"
            }
        };
        self.then(now, 0, text);
    }

    fn set(&mut self, now: u64) {
        let axis = self.chance.one_of(&["x", "z"]);
        let text = match self.chance.whole(0, 7) {
            0 => format!("set {axis}.limit_plus_mm {:.3}", self.chance.spread(0.5, 80.0)),
            1 => format!("set {axis}.limit_minus_mm {:.3}", -self.chance.spread(0.5, 80.0)),
            2 => format!("set {axis}.hand_plus_mm {:.3}", self.chance.spread(0.05, 20.0)),
            3 => format!("set {axis}.hand_minus_mm {:.3}", self.chance.spread(0.05, 20.0)),
            4 => format!("set {axis}.max_accel {:.0}", self.chance.spread(60.0, 2_000.0)),
            5 => format!("set safe_feed {:.0}", self.chance.spread(60.0, 2_000.0)),
            6 => format!("set feed_override {}", self.chance.one_of(&[50, 100, 150])),
            _ => format!("set accel {}", self.chance.one_of(&["linear", "sine", "parabolic"])),
        };
        self.then(now, 0, text);
    }

    /// Puts everything in order, whatever it was left in: then the machine rests, starts, and runs a program to its end.
    fn put_in_order(&mut self, seen: &Seen<'_>) {
        let now = seen.tick;
        if self.ordering {
            return self.then(now, 0, "end");
        }
        self.ordering = true;
        if !seen.power {
            self.then(now, 0, "power-on");
        }
        for text in [
            "joystick off",
            "rapid off",
            "guard closed",
            "limit x+ off",
            "limit x- off",
            "limit z+ off",
            "limit z- off",
        ] {
            self.then(now, 0, text);
        }
        for source in ["wheel-x", "wheel-z", "wheel-contour", "spindle"] {
            self.then(now, 0, format!("noise {source} 0"));
        }
        for text in
            ["spindle-wobble 0 0", "lose-index off", "threading-lever out", "spindle stop", "estop", "release", "reset"]
        {
            self.then(now, 0, text);
        }
        // wheels that were turned for some seconds still, then everything brakes
        let calm = 2 * seen.calm + 4_000;
        self.then(now, calm, "release");
        self.then(now, 20, "expect alarms == none");
        self.then(now, 0, "motors on");
        self.then(now, 0, "lock off");
        self.then(now, 0, "confirm-position");
        self.then(now, 0, "expect verified.x == true");
        self.then(now, 0, "expect verified.z == true");
        self.then(now, 0, "mode handwheel");
        self.then(now, 0, "expect mode == handwheel");
        for text in ["single off", "dry-run off", "optional-stop off", "block-skip on", "scale 10"] {
            self.then(now, 0, text);
        }
        for text in ["feed 100", "rapid-override 100", "spindle-override 100", "set safe_feed 3000"] {
            self.then(now, 0, text);
        }
        for axis in ["x", "z"] {
            self.then(now, 0, format!("set {axis}.limit_minus_mm -2100"));
            self.then(now, 0, format!("set {axis}.limit_plus_mm 2100"));
        }
        self.then(now, 0, "null-offset");
        self.then(now, 2 * seen.calm + 1_000, "expect offset.x == 0");
        self.then(now, 0, "expect offset.z == 0");
        self.then(now, 0, "zero x 0");
        self.then(now, 0, "zero z 0");
        self.then(now, 0, "mode auto");
        self.then(now, 0, "expect mode == auto");
        self.then(now, 0, format!("load {LAST}"));
        self.then(now, 0, "start");
        self.then(now, 4 * seen.calm + 8_000, "expect state == ended");
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
