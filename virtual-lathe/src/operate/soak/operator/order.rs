//! How a session ends: everything is put in order, whatever it was left in.

use super::{LAST, Operator};
use crate::operate::soak::hand::Seen;

impl Operator {
    /// Puts everything in order, whatever it was left in: then the machine rests, starts, and runs a program to its end.
    pub(super) fn put_in_order(&mut self, seen: &Seen<'_>) {
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
