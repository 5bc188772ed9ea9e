//! What an operator does for no reason, and what goes wrong with a machine.

use handcnc::foreground::mode::Mode;

use super::Operator;

impl Operator {
    /// Something for no reason.
    pub(super) fn anything(&mut self, now: u64) {
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
    pub(super) fn trouble(&mut self, now: u64) {
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
}
