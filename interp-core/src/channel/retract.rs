//! Pulls the cross slide out and brings it back: pulses of X that are added to the program's.
//!
//! Its place is what the tool is off the program by. It moves to either end within its own speed and acceleration and
//! stands there exactly; where it is asked to turn round on the way it brakes first.

use super::follower::{Follower, Pace};
use crate::compensation::PULSE;

/// The cross slide's way out.
#[derive(Copy, Clone, Debug)]
pub(super) struct Retract {
    follower: Follower,
    /// Where it goes, pulses with [`FRACTION`](crate::compensation::FRACTION) fraction bits.
    target: i64,
    pace: Pace,
    live: bool,
}

impl Retract {
    /// Not out.
    pub(super) const fn new() -> Self {
        Self { follower: Follower::new(), target: 0, pace: Pace { speed: 0, accel: 0 }, live: false }
    }

    /// Goes out by so many pulses.
    pub(super) fn out(&mut self, pulses: i32, pace: Pace) {
        self.target = i64::from(pulses).wrapping_mul(PULSE);
        (self.pace, self.live) = (pace, true);
    }

    /// Comes back.
    pub(super) const fn home(&mut self) {
        (self.target, self.live) = (0, true);
    }

    /// Whether a tick may have pulses.
    #[inline]
    pub(super) const fn is_live(&self) -> bool {
        self.live
    }

    /// The pulses of X in a tick.
    pub(super) fn tick(&mut self) -> i32 {
        let pulses = self.follower.follow(self.target, &self.pace);
        self.live = self.moves();
        if !self.live {
            self.follower.stop();
        }
        pulses
    }

    /// Whether it is still on its way.
    pub(super) const fn moves(&self) -> bool {
        self.follower.place() != self.target || !self.follower.is_near(self.target, 1, &self.pace)
    }

    /// By how many pulses X is out.
    pub(super) const fn pulses(&self) -> i32 {
        self.follower.pulses()
    }

    /// Pulses that it moved by in the last tick, with [`FRACTION`](crate::compensation::FRACTION) fraction bits.
    pub(super) const fn speed(&self) -> i64 {
        self.follower.speed()
    }

    /// Ends it where it is: X stands there from now on. By how many pulses that is off.
    pub(super) const fn take(&mut self) -> i32 {
        let pulses = self.pulses();
        *self = Self::new();
        pulses
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Out, and wherever it is turned round, back: what was added is what it says, within speed and acceleration.
        #[test]
        fn it_goes_out_and_comes_back_exactly(
            pulses in -4_000_i32..4_000, speed in 1_i64..60, accel in 1_i64..2_000, turn in 1_u32..3_000
        ) {
            let pace = Pace { speed: speed << 20, accel: accel << 10 };
            let (mut retract, mut sum, mut ticks) = (Retract::new(), 0, 0_u32);
            retract.out(pulses, pace);
            let mut before = 0;
            while retract.is_live() {
                let made = retract.tick();
                sum += made;
                prop_assert_eq!(sum, retract.pulses());
                prop_assert!(i64::from(made.abs()) <= speed + 1);
                prop_assert!(i64::from((made - before).abs()) <= (accel >> 10) + 2);
                before = made;
                ticks += 1;
                if ticks == turn {
                    retract.home();
                }
                prop_assert!(ticks < 2_000_000);
            }
            prop_assert_eq!(sum, if ticks >= turn { 0 } else { pulses });
        }
    }
}
