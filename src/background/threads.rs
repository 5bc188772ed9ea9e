//! What can be known of a program's threads before anything moves: whether the spindle turns, the axes keep up, and the
//! path is long enough to fall in with it.
//!
//! The spindle's speed is that of the last S. To reach the thread's speed v the tool needs `v^2 / 2a'` of path, `a'` three
//! quarters of the acceleration, and `v^2 / 2a` to brake at the end: only between both is the groove true.

use core::fmt;

use feature_editor::codes::{Action, Item, SpindleCommand};
use interp_core::block::{Block, Feed, Motion, Work};

/// What is wrong with a thread or a feed a turn.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// A warning, once a program: nothing in it has set the spindle turning.
    SpindleOff,
    /// An error: lead times S is more than the axes make. Path, micrometres a minute.
    TooFast {
        /// What lead and S need.
        needed: u64,
        /// What the axes allow.
        limit: u64,
    },
    /// An error: the thread ends before the tool has fallen in with the spindle. Micrometres of path.
    TooShort {
        /// Its length.
        length: u64,
        /// What falling in needs.
        run_in: u64,
    },
    /// A warning: the tool brakes for the end before it has fallen in. Micrometres of path.
    NoTruePart {
        /// Its length.
        length: u64,
        /// What falling in needs.
        run_in: u64,
        /// What braking needs.
        run_out: u64,
    },
    /// A warning: two parts of a thread join in a corner that can't be taken at this speed, micrometres a minute.
    Corner {
        /// What lead and S need.
        needed: u64,
        /// What the corner allows.
        limit: u64,
    },
}

impl Doubt {
    /// Whether the program is refused for it.
    pub const fn is_error(self) -> bool {
        matches!(self, Self::TooFast { .. } | Self::TooShort { .. })
    }

    /// What to do about it.
    pub const fn remedy(self) -> &'static str {
        match self {
            Self::SpindleOff => "write S and M3 or M4 before it, unless the spindle is switched by hand",
            Self::TooFast { .. } | Self::Corner { .. } => "write a smaller S",
            Self::TooShort { .. } | Self::NoTruePart { .. } => "begin farther before the work, or write a smaller S",
        }
    }
}

/// Micrometres as millimetres with two decimals.
struct Millimetres(u64);

impl fmt::Display for Millimetres {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let hundredths = self.0.saturating_add(5) / 10;
        write!(f, "{}.{:02}", hundredths / 100, hundredths % 100)
    }
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mm = Millimetres;
        match *self {
            Self::SpindleOff => f.write_str("this follows the spindle, and nothing before it turns that on"),
            Self::TooFast { needed, limit } => {
                write!(f, "lead times S is {} mm/min, and the axes make {}", mm(needed), mm(limit))
            }
            Self::TooShort { length, run_in } => {
                write!(f, "the thread is {} mm long, and falling in with the spindle takes {}", mm(length), mm(run_in))
            }
            Self::NoTruePart { length, run_in, run_out } => write!(
                f,
                "of {} mm the first {} go to falling in with the spindle and the last {} to braking: no part is true",
                mm(length),
                mm(run_in),
                mm(run_out)
            ),
            Self::Corner { needed, limit } => {
                write!(f, "this corner of the thread allows {} mm/min, and lead times S is {}", mm(limit), mm(needed))
            }
        }
    }
}

/// nm a tick with 12 fraction bits to micrometres a minute.
const fn per_minute(speed: u64) -> u64 {
    speed.saturating_mul(60) / 4_096
}

/// nm with 12 fraction bits to micrometres.
const fn micrometres(length: u64) -> u64 {
    length / 4_096_000
}

/// Follows the spindle of a program.
#[derive(Copy, Clone, Debug, Default)]
pub(super) struct Threads {
    turns: bool,
    /// Thousandths of a turn a minute; 0 where none was written.
    milli_rpm: u32,
    in_thread: bool,
    told: bool,
}

impl Threads {
    /// Looks at an action and its blocks.
    pub(super) fn see(&mut self, item: &Item, blocks: &[Block]) -> Option<Doubt> {
        match item.action {
            Action::Spindle(command) => self.turns = !matches!(command, SpindleCommand::Stop),
            Action::SpindleSpeed(speed) => self.milli_rpm = speed.milli_rpm(),
            _ => {}
        }
        let mut found = None;
        for block in blocks {
            let Work::Motion(motion) = &block.work else {
                self.in_thread = false;
                continue;
            };
            let first = !self.in_thread;
            self.in_thread = motion.feed.is_thread();
            found = found.or(self.motion(motion, first));
        }
        found
    }

    fn motion(&mut self, motion: &Motion, first: bool) -> Option<Doubt> {
        let Feed::Thread(lead, _) = motion.feed else {
            return matches!(motion.feed, Feed::PerTurn(_)).then(|| self.off()).flatten();
        };
        // nm a turn times turns a minute / 60 000 000, 12 fraction bits: below 2^31 2^27 2^12
        let speed = u128::from(lead.nm()).saturating_mul(u128::from(self.milli_rpm)).saturating_mul(4_096) / 60_000_000;
        let speed = u64::try_from(speed).unwrap_or(u64::MAX);
        let limit = u64::from(motion.limit);
        let (needed, accel) = (per_minute(speed), u64::from(motion.accel.max(2)));
        if speed > limit {
            return Some(Doubt::TooFast { needed, limit: per_minute(limit) });
        }
        // speeds are below 2^32 now
        let square = speed.saturating_mul(speed);
        let way = |accel: u64| square.checked_div(accel.saturating_mul(2)).unwrap_or(0);
        // with two ticks that the tool is ahead by
        let run_in = way(accel.saturating_sub(accel / 4)).saturating_add(speed.saturating_mul(2));
        let (length, in_um, out_um) = (motion.length, micrometres(run_in), micrometres(way(accel)));
        if first && length <= run_in {
            return Some(Doubt::TooShort { length: micrometres(length), run_in: in_um });
        }
        if first && length <= run_in.saturating_add(way(accel)) {
            return Some(Doubt::NoTruePart { length: micrometres(length), run_in: in_um, run_out: out_um });
        }
        if !first && speed > u64::from(motion.joint) {
            return Some(Doubt::Corner { needed, limit: per_minute(motion.joint.into()) });
        }
        self.off()
    }

    fn off(&mut self) -> Option<Doubt> {
        let tells = !self.turns && !self.told;
        self.told |= tells;
        tells.then_some(Doubt::SpindleOff)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use crate::background::compile::{Compiler, Finding};
    use crate::background::parameters::Parameters;
    use feature_editor::codes::Format;
    use std::string::{String, ToString};
    use std::vec::Vec;

    /// Findings of a program: line, whether it is refused, what is said.
    fn found(program: &str) -> Vec<(u32, bool, String)> {
        let parameters = Parameters::new();
        let mut compiler = Compiler::new(parameters.settings(), Format::Gcode, &parameters.machine().unwrap());
        let mut found = Vec::new();
        for line in program.lines() {
            compiler.line(line.as_bytes(), &mut |_, _| {}, &mut |finding: Finding| {
                found.push((finding.line(), finding.is_error(), finding.to_string()));
            });
        }
        found
    }

    fn one(program: &str) -> (u32, bool, String) {
        let found = found(program);
        assert_eq!(found.len(), 1, "{found:?}");
        found[0].clone()
    }

    #[test]
    fn a_good_thread_is_passed() {
        assert_eq!(found("S600 M3\nG0 Z5\nG33 Z-20 K1.5\nG0 X5\nG95 F0.2 G1 Z5"), []);
        // whose speed is not known
        assert_eq!(found("M3\nG0 Z5\nG33 Z-20 K1.5"), []);
    }

    #[test]
    fn a_spindle_that_nothing_has_turned_on_is_told_once() {
        let off = "this follows the spindle, and nothing before it turns that on";
        assert_eq!(one("S600\nG33 Z-20 K1.5\nG33 Z-30 K1.5"), (2, false, off.into()));
        assert_eq!(one("S600 M3\nM5\nG95 F0.2 G1 Z-20"), (3, false, off.into()));
    }

    /// 3 mm at 2000/min are 6000 mm/min.
    #[test]
    fn a_thread_above_the_axes_speed_is_refused_with_figures() {
        let text = "lead times S is 6000.00 mm/min, and the axes make 5000.00";
        assert_eq!(one("S2000 M3\nG33 Z-20 K3"), (2, true, text.into()));
        assert_eq!(found("S1666 M3\nG33 Z-20 K3"), []);
    }

    /// 2 mm at 1500/min are 50 mm/s: 3.33 mm with 375 mm/s2 and two ticks of 0.05, 2.5 mm with 500.
    #[test]
    fn a_thread_too_short_to_be_true_is_refused_or_told_with_figures() {
        let short = "the thread is 3.42 mm long, and falling in with the spindle takes 3.43";
        assert_eq!(one("S1500 M3\nG33 Z-3.42 K2"), (2, true, short.into()));
        let none =
            "of 5.90 mm the first 3.43 go to falling in with the spindle and the last 2.50 to braking: no part is true";
        assert_eq!(one("S1500 M3\nG33 Z-5.9 K2"), (2, false, none.into()));
        assert_eq!(found("S1500 M3\nG33 Z-5.95 K2"), []);
        // a part that follows another one has fallen in already
        assert_eq!(found("S1500 M3\nG33 Z-9 K2\nG33 Z-10 K2\nG33 Z-20 K2"), []);
    }

    /// X may jump by 2 mm/s: at 20 mm/s along Z, 1 in 10.
    #[test]
    fn a_corner_inside_a_thread_is_told_with_figures() {
        assert_eq!(found("S600 M3\nG33 Z-20 K2\nG33 Z-30 X0.99 K2"), []);
        let (line, refused, text) = one("S600 M3\nG33 Z-20 K2\nG33 Z-30 X2 K2");
        assert!(text.starts_with("this corner of the thread allows 6"), "{text}");
        assert_eq!((line, refused), (3, false));
    }
}
