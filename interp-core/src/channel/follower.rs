//! Follows a place that moves by itself, within a speed and an acceleration.
//!
//! For what is added to the program's motion: compensation now, handwheels later. Its place has fraction bits; the
//! whole pulses that it moves by in a tick are for [`Superposed`](super::superposed::Superposed). It lands on a place
//! that stands exactly and without overshoot, and follows one that changes its speed by less than the acceleration a
//! tick without lag.

use crate::compensation::{FRACTION, PULSE};
use crate::math::root;

/// Limits of a follower.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Pace {
    /// Pulses a tick, with [`FRACTION`] fraction bits.
    pub speed: i64,
    /// Pulses a tick squared, with [`FRACTION`] fraction bits; at least 1.
    pub accel: i64,
}

/// Whether a value is at most `most` in magnitude.
const fn within(value: i64, most: i64) -> bool {
    value.wrapping_add(most).cast_unsigned() <= most.wrapping_mul(2).cast_unsigned()
}

/// A follower.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Follower {
    /// Place, pulses with [`FRACTION`] fraction bits.
    place: i64,
    /// Moved in the last tick.
    speed: i64,
}

impl Follower {
    /// Stands at 0.
    pub const fn new() -> Self {
        Self::at(0)
    }

    /// Stands at `place`, pulses with [`FRACTION`] fraction bits.
    pub const fn at(place: i64) -> Self {
        Self { place, speed: 0 }
    }

    /// Where it is, pulses with [`FRACTION`] fraction bits.
    pub const fn place(&self) -> i64 {
        self.place
    }

    /// By how much it moved in the last tick, pulses with [`FRACTION`] fraction bits.
    pub const fn speed(&self) -> i64 {
        self.speed
    }

    /// The nearest whole pulse, half upward.
    #[expect(clippy::cast_possible_truncation, reason = "places are below 2^30 pulses")]
    pub const fn pulses(&self) -> i32 {
        (self.place.wrapping_add(PULSE / 2) >> FRACTION) as i32
    }

    /// Moves for a tick towards `target`; the whole pulses that it moved by.
    ///
    /// The speed is at most one from which it can stop on the target. Slowing down by `a` each tick, the way from `v` on,
    /// `v + (v - a) + (v - 2 a) + ..`, is at most `(v + a / 2)^2 / 2 a`; so `v = sqrt(2 a distance) - a / 2`. From such a speed
    /// the next, slower by `a`, is such a one again.
    pub fn follow(&mut self, target: i64, pace: &Pace) -> i32 {
        let distance = target.wrapping_sub(self.place);
        if self.rests_at(target) {
            return 0;
        }
        let before = self.pulses();
        let (near, change) = (pace.accel.min(pace.speed), distance.wrapping_sub(self.speed));
        if within(distance, near) && within(change, pace.accel) {
            // the usual tick of one that follows closely: what the rest comes to as well
            (self.place, self.speed) = (target, distance);
            return self.pulses().wrapping_sub(before);
        }
        let (accel, away) = (pace.accel, distance.unsigned_abs());
        let most = if away <= accel.unsigned_abs() {
            away
        } else {
            let squared = away.saturating_mul(8).saturating_mul(accel.unsigned_abs());
            u64::from(root(squared)).saturating_sub(accel.unsigned_abs()) / 2
        };
        let most = i64::try_from(most).unwrap_or(i64::MAX).min(pace.speed);
        let wanted = most.wrapping_mul(distance.signum());
        self.speed = wanted.max(self.speed.wrapping_sub(accel)).min(self.speed.wrapping_add(accel));
        self.place = self.place.wrapping_add(self.speed);
        self.pulses().wrapping_sub(before)
    }

    /// Whether it stands at `target`.
    #[inline]
    pub const fn rests_at(&self, target: i64) -> bool {
        self.place == target && self.speed == 0
    }

    /// Stops where it is, from any speed.
    pub const fn stop(&mut self) {
        self.speed = 0;
    }

    /// Whether it is within `tolerance` of `target` and can stop within a tick.
    pub const fn is_near(&self, target: i64, tolerance: i64, pace: &Pace) -> bool {
        target.wrapping_sub(self.place).saturating_abs() < tolerance && self.speed.saturating_abs() <= pace.accel
    }
}

impl Default for Follower {
    fn default() -> Self {
        Self::new()
    }
}
