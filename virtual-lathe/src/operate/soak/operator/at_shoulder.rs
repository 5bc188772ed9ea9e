//! What an operator does at a shoulder: feeds to it, along an axis or a contour, and back, as often as he likes.
//!
//! A piece of work is planned as a whole, as single things at random would seldom come together to one.

use handcnc::foreground::inputs::Joystick;
use handcnc::foreground::mode::Mode;
use interp_core::units::Axis;

use super::Operator;
use crate::operate::soak::hand::Seen;

impl Operator {
    /// A piece of work at shoulders, in power or linked feed.
    pub(super) fn work_at_shoulder(&mut self, seen: &Seen<'_>) {
        let now = seen.tick;
        let linked = match seen.shown.mode {
            Mode::Linked => !self.chance.once_in(4),
            Mode::Power => self.chance.once_in(4),
            _ => self.chance.coin(),
        };
        if seen.joystick != Joystick::Off {
            self.then(now, 0, "joystick off");
            self.wait(400.0);
        }
        self.then(now, 0, if linked { "mode linked" } else { "mode power" });
        if !self.chance.once_in(3) {
            let feed = self.feed_rate();
            self.then(now, 0, feed);
        }
        if !self.chance.once_in(3) {
            self.contour(now);
        }
        for _ in 0..self.chance.whole(1, 3) {
            self.shoulder_near(seen);
        }
        for _ in 0..self.chance.whole(1, 6) {
            if linked { self.lead_along(now) } else { self.feed_along(seen) }
        }
        self.then(now, 0, "joystick off");
    }

    /// The next thing is done after some time.
    fn wait(&mut self, most: f64) {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some seconds")]
        let ticks = self.chance.spread(1.0, most) as u64;
        self.waits += ticks;
    }

    /// Sets a shoulder not far from the tool, or where it is; now and then takes one away.
    fn shoulder_near(&mut self, seen: &Seen<'_>) {
        let axis = self.chance.one_of(&[Axis::X, Axis::Z]);
        let name = if axis == Axis::X { "x" } else { "z" };
        let text = match self.chance.whole(0, 9) {
            0 => format!("stop-at {name} off"),
            1..=2 => format!("stop-at {name} here"),
            _ => {
                let by = self.chance.spread(0.002, 8.0) * self.chance.one_of(&[1.0, -1.0]);
                format!("stop-at {name} {:.4}", seen.place.of(axis) + by)
            }
        };
        self.then(seen.tick, 0, text);
    }

    /// In power feed.
    fn feed_along(&mut self, seen: &Seen<'_>) {
        let now = seen.tick;
        match self.chance.whole(0, 11) {
            0..=4 => {
                let way = self.chance.one_of(&["x+", "x-", "z+", "z-", "path+", "path-", "path+", "path-"]);
                self.then(now, 0, format!("joystick {way}"));
                self.wait(8_000.0);
            }
            5 => {
                self.then(now, 0, "joystick off");
                self.wait(500.0);
            }
            6 => {
                self.then(now, 0, "joystick off");
                self.wait(500.0);
                self.then(now, 0, "return");
                self.wait(4_000.0);
            }
            7 => {
                self.then(now, 0, "joystick off");
                self.wait(500.0);
                let (times, way) = (self.chance.whole(1, 4), self.chance.one_of(&["x+", "z-", "path+", "path-"]));
                self.then(now, 0, format!("repeat {times}"));
                self.then(now, 0, format!("joystick {way}"));
                self.wait(20_000.0);
            }
            8 => {
                self.then(now, 0, "rapid on");
                self.wait(2_000.0);
                self.then(now, 0, "rapid off");
            }
            9 => self.turn(now, None),
            10 => {
                self.then(now, 0, "hold");
                self.wait(500.0);
            }
            _ => {
                self.then(now, 0, "joystick off");
                self.wait(800.0);
                self.shoulder_near(seen);
            }
        }
    }

    /// In linked feed.
    fn lead_along(&mut self, now: u64) {
        match self.chance.whole(0, 7) {
            0..=4 => {
                self.turn(now, Some("contour"));
                self.wait(4_000.0);
            }
            5 => self.turn(now, None),
            6 => {
                let way = self.chance.one_of(&["path+", "path-"]);
                self.then(now, 0, format!("joystick {way}"));
                self.wait(4_000.0);
                self.then(now, 0, "joystick off");
            }
            _ => {
                self.wait(1_000.0);
                let axis = self.chance.one_of(&["x", "z"]);
                self.then(now, 0, format!("stop-at {axis} here"));
            }
        }
    }
}
