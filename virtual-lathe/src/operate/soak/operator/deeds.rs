//! Single things that an operator does, with figures at random.

use super::Operator;

impl Operator {
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

    pub(super) fn scale(&mut self, now: u64) {
        let scale = self.chance.one_of(&["1", "10", "100", "100", "speed"]);
        self.then(now, 0, format!("scale {scale}"));
    }

    pub(super) fn push(&mut self, now: u64) {
        let way = self.chance.one_of(&["x+", "x-", "z+", "z-", "path+", "path-"]);
        self.then(now, 0, format!("joystick {way}"));
        if self.chance.coin() {
            let later = self.chance.bits() % 4_000;
            self.then(now, later, "joystick off");
        }
    }

    pub(super) fn rapid(&mut self, now: u64) {
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

    pub(super) fn stop_at(&mut self, now: u64) {
        let axis = self.chance.one_of(&["x", "z"]);
        let text = match self.chance.whole(0, 5) {
            0 => format!("stop-at {axis} off"),
            1 => format!("stop-at {axis} here"),
            _ => format!("stop-at {axis} {:.3}", self.chance.real(-20.0, 20.0)),
        };
        self.then(now, 0, text);
    }

    pub(super) fn offset(&mut self, now: u64) {
        let what = self.chance.one_of(&["null-offset", "null-offset", "keep-offset", "book-wear"]);
        self.then(now, 0, what);
    }

    pub(super) fn overrides(&mut self, now: u64) {
        let text = match self.chance.whole(0, 5) {
            0..=3 => format!("feed {}", self.chance.one_of(&[0, 1, 10, 50, 100, 100, 150, 200])),
            4 => format!("rapid-override {}", self.chance.one_of(&[0, 5, 50, 100, 100])),
            _ => format!("spindle-override {}", self.chance.one_of(&[0, 50, 100, 100, 120, 200])),
        };
        self.then(now, 0, text);
    }

    pub(super) fn switches(&mut self, now: u64) {
        let name = self.chance.one_of(&["single", "dry-run", "lock", "optional-stop", "block-skip"]);
        let on = self.chance.one_of(&["on", "off", "off"]);
        self.then(now, 0, format!("{name} {on}"));
    }

    pub(super) fn zero(&mut self, now: u64) {
        let axis = self.chance.one_of(&["x", "z"]);
        let place = self.chance.real(-10.0, 10.0);
        self.then(now, 0, format!("zero {axis} {place:.4}"));
    }

    pub(super) fn home(&mut self, now: u64) {
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

    pub(super) fn typed(&mut self, now: u64) {
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

    pub(super) fn spindle(&mut self, now: u64) {
        let text = match self.chance.whole(0, 3) {
            0 => "spindle stop".into(),
            1 => format!("spindle -{:.0}", self.chance.spread(30.0, 1_500.0)),
            _ => format!("spindle {:.0}", self.chance.spread(30.0, 2_000.0)),
        };
        self.then(now, 0, text);
    }

    pub(super) fn thread_by_hand(&mut self, now: u64) {
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

    pub(super) fn set(&mut self, now: u64) {
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
}
