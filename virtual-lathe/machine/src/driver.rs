//! The driver's inputs: which rising edges become steps, and in which direction.
//!
//! A driver samples the direction at the rising edge. Where the pins change too close together, what a real one does
//! is not told by its data sheet; here it does the worst that it may, always the same:
//!
//! | broken rule | the driver | pulses off |
//! | --- | --- | --- |
//! | high for less than `pulse_width_ns` | does not see the pulse | 1 |
//! | low for less than `min_space_ns` before it | does not see the pulse | 1 |
//! | direction changed less than `dir_setup_ns` before it | steps the old way | 2 |
//! | direction changed less than `dir_hold_ns` after it | steps the new way | 2 |

use figures::{FigureError, Figures};
use interp_core::units::Axis;

use crate::read;

/// Long before the first event; no required time reaches back to it.
const LONG_AGO: i64 = i64::MIN / 2;

/// What a write to the pins did.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Step {
    /// Pulses that were sent: -1, 0 or 1.
    pub(crate) sent: i64,
    /// Pulses that the driver went: -2 to 2, as it may take one back.
    pub(crate) taken: i64,
}

/// The inputs of one driver.
#[derive(Clone, Debug)]
pub(crate) struct Driver {
    width: i64,
    space: i64,
    setup: i64,
    hold: i64,
    step: bool,
    plus: bool,
    rose: i64,
    fell: i64,
    turned: i64,
    /// What the last rising edge was taken for.
    last: i64,
}

impl Driver {
    pub(crate) fn new(figures: &Figures, axis: Axis) -> Result<Self, FigureError> {
        let clocks = |what: &str| figures.number(&read::name("driver", axis, what)).map(clocks_for);
        Ok(Self {
            width: clocks("pulse_width_ns")?,
            space: clocks("min_space_ns")?,
            setup: clocks("dir_setup_ns")?,
            hold: clocks("dir_hold_ns")?,
            step: false,
            plus: false,
            rose: LONG_AGO,
            fell: LONG_AGO,
            turned: LONG_AGO,
            last: 0,
        })
    }

    /// Writes the pins at a time in clocks.
    #[inline]
    pub(crate) fn write(&mut self, now: i64, step: bool, plus: bool) -> Step {
        let mut done = Step::default();
        if plus != self.plus {
            if now - self.rose < self.hold {
                done.taken -= 2 * self.last;
                self.last = -self.last;
            }
            self.plus = plus;
            self.turned = now;
        }
        if step == self.step {
            return done;
        }
        self.step = step;
        if step {
            done.sent = if plus { 1 } else { -1 };
            self.last = if now - self.fell < self.space {
                0
            } else if now - self.turned < self.setup {
                -done.sent
            } else {
                done.sent
            };
            self.rose = now;
            done.taken += self.last;
        } else {
            if now - self.rose < self.width {
                done.taken -= self.last;
                self.last = 0;
            }
            self.fell = now;
        }
        done
    }
}

/// Clocks of 12 MHz that cover `ns`. Figures go to 200 000 ns.
fn clocks_for(ns: f64) -> i64 {
    crate::whole((ns * 12.0 / 1000.0).ceil())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Positions that a driver with 30, 30, 60 and 60 clocks goes to, over (time, step, plus).
    fn play(writes: &[(i64, bool, bool)]) -> (i64, i64) {
        let mut driver = Driver::new(&Figures::new(crate::TABLES), Axis::X).unwrap();
        let mut at = (0, 0);
        for &(now, step, plus) in writes {
            let done = driver.write(now, step, plus);
            at = (at.0 + done.sent, at.1 + done.taken);
        }
        at
    }

    #[test]
    fn a_pulse_within_the_rules_is_one_step() {
        assert_eq!(play(&[(0, false, true), (60, true, true), (90, false, true)]), (1, 1));
        assert_eq!(play(&[(0, false, true), (60, true, true), (90, false, true), (120, true, true)]), (2, 2));
        let back = [(60, true, true), (90, false, true), (120, false, false), (180, true, false)];
        assert_eq!(play(&[&[(0, false, true)], &back[..]].concat()), (0, 0));
    }

    #[test]
    fn each_broken_rule_does_what_the_table_says() {
        // too short
        assert_eq!(play(&[(0, false, true), (60, true, true), (89, false, true)]), (1, 0));
        // space too short
        assert_eq!(play(&[(0, false, true), (60, true, true), (90, false, true), (119, true, true)]), (2, 1));
        // set-up
        assert_eq!(play(&[(0, false, true), (59, true, true), (99, false, true)]), (1, -1));
        assert_eq!(play(&[(0, true, true), (99, false, true)]), (1, -1));
        // hold
        assert_eq!(play(&[(0, false, true), (60, true, true), (119, true, false), (130, false, false)]), (1, -1));
        // hold, and then too short: seen by nobody
        assert_eq!(play(&[(0, false, true), (60, true, true), (70, true, false), (80, false, false)]), (1, 0));
    }
}
