//! Follows a place with limited speed and acceleration, tick by tick, in integers.
//!
//! An advance of `d` in one tick, after one of `d'` in the tick before, is an acceleration of `d - d'`. Braking by `a` a
//! tick, an advance of `d = k a` leads `a k (k + 1) / 2` far until it stands. So with the distance `s` left and `k` the
//! fewest ticks with `a k (k + 1) / 2 >= s`, the largest advance that can still stop there is
//!
//! ```text
//! d = (s + a k (k - 1) / 2) / k
//! ```
//!
//! for `d + (d - a) + ... + (d - (k - 1) a) = s`. It is rounded down; the next tick finds `k - 1` and a `d` that is at
//! most `a` smaller, so braking never needs more than `a`, and at `s <= a` it is `s` itself: the place is met exactly
//! and nothing swings about it. In the continuum this is `v = sqrt(2 a s)`.
//!
//! A place that moves is followed in its own frame: the distance from where it is, and the difference of speeds.

use crate::math::root;

/// What a follower keeps: nm with 12 fraction bits a tick, and a tick squared.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Bounds {
    /// Largest advance in a tick.
    pub speed: u32,
    /// Largest change of it from tick to tick.
    pub accel: u32,
}

/// The largest advance from which braking by `accel` a tick stops within `distance`; 0 to 2^32.
pub fn approach(distance: u64, accel: u32) -> i64 {
    let accel = u64::from(accel.max(1));
    if distance <= accel {
        return distance.cast_signed();
    }
    // k (k + 1) / 2 >= s / a: the root gives k or one less
    let square = distance.min(1 << 58).saturating_mul(8).checked_div(accel).unwrap_or(0);
    let mut k = u64::from(root(square.saturating_add(1))).saturating_sub(1) >> 1;
    let reached = |k: u64| accel.saturating_mul(k.wrapping_mul(k.wrapping_add(1)) >> 1);
    while reached(k) < distance && k < 1 << 31 {
        k = k.wrapping_add(1);
    }
    let less = reached(k.saturating_sub(1));
    distance.saturating_add(less).checked_div(k).unwrap_or(0).min(1 << 32).cast_signed()
}

/// Whether an end is so far that [`approach`] certainly allows an advance, as it does from
/// `sqrt(2 a room) - a / 2 - 1 >= sqrt(a room)` on, which holds where `room >= 2 a + 6`, if the advance is below that. One product
/// tells, in place of roots and divisions in every tick.
pub(crate) const fn is_far(room: u64, advance: u64, accel: u32) -> bool {
    let accel = if accel == 0 { 1 } else { accel as u64 };
    advance >> 31 == 0
        && room >= accel.wrapping_mul(2).wrapping_add(6)
        && advance.wrapping_mul(advance) <= accel.saturating_mul(room)
}

/// Follows a place.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Follower {
    /// Advance of the last tick.
    advance: i64,
}

impl Follower {
    /// Standing.
    pub const fn new() -> Self {
        Self { advance: 0 }
    }

    /// The advance of the last tick, nm with 12 fraction bits.
    pub const fn advance(&self) -> i64 {
        self.advance
    }

    /// Notes that something else decided on the advance of the last tick.
    pub const fn set(&mut self, advance: i64) {
        self.advance = advance;
    }

    /// The advance of this tick toward a place `distance` away at its end, which itself moves by `feed` in it. The
    /// acceleration that the place itself may have stands in `reserve`: it is not used to catch up.
    ///
    /// ```
    /// # use interp_core::drive::follower::{Bounds, Follower};
    /// let (bounds, mut follower) = (Bounds { speed: 100, accel: 10 }, Follower::new());
    /// let mut left = 65;
    /// let mut advances = [0; 7];
    /// for advance in &mut advances {
    ///     *advance = follower.follow(left, 0, bounds, 0);
    ///     left -= *advance;
    /// }
    /// assert_eq!(advances, [10, 20, 21, 12, 2, 0, 0]);
    /// ```
    pub fn follow(&mut self, distance: i64, feed: i64, bounds: Bounds, reserve: u32) -> i64 {
        let (accel, speed) = (i64::from(bounds.accel), i64::from(bounds.speed));
        let closing = toward(distance.saturating_sub(feed), bounds.accel.saturating_sub(reserve));
        let wish = feed.saturating_add(closing).max(speed.wrapping_neg()).min(speed);
        // limits of the acceleration come last: a speed above the largest is left as fast as may be
        let (least, most) = (self.advance.saturating_sub(accel), self.advance.saturating_add(accel));
        self.advance = wish.max(least).min(most);
        self.advance
    }

    /// The same toward a place that stands, and so that from then on braking by `share` a tick stops inside `room` (at most 0, at
    /// least 0).
    pub fn follow_inside(&mut self, distance: i64, bounds: Bounds, room: (i64, i64), share: u32) -> i64 {
        let before = self.advance;
        let wish = Self { advance: before }.follow(distance, 0, bounds, 0);
        let end = if wish < 0 { room.0 } else { room.1 };
        let inside = if is_far(end.unsigned_abs(), wish.unsigned_abs(), share) {
            wish
        } else {
            let most = toward(end, share);
            if wish < 0 { wish.max(most) } else { wish.min(most) }
        };
        // one that the room has shrunk for brakes as hard as it may
        let accel = i64::from(bounds.accel);
        self.advance = inside.max(before.saturating_sub(accel)).min(before.saturating_add(accel));
        self.advance
    }
}

/// The largest advance toward a place from which braking by `accel` a tick stops there; signed.
fn toward(distance: i64, accel: u32) -> i64 {
    let most = approach(distance.unsigned_abs(), accel.max(1));
    if distance < 0 { most.wrapping_neg() } else { most }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// All small distances and accelerations: the advance can stop there and one more can't.
    #[test]
    fn the_approach_is_the_largest_that_stops_in_time() {
        let path = |mut advance: i64, accel: i64| {
            let mut sum = 0;
            while advance > 0 {
                sum += advance;
                advance -= accel;
            }
            sum
        };
        for accel in 1..40_u32 {
            for distance in 0..2000_u64 {
                let advance = approach(distance, accel);
                assert!(path(advance, i64::from(accel)) <= distance.cast_signed(), "{distance} {accel}");
                assert!(path(advance + 1, i64::from(accel)) > distance.cast_signed(), "{distance} {accel}");
            }
        }
    }

    proptest! {
        /// From any motion to any place: limits are kept, the place is met exactly and for good, in about the least time.
        #[test]
        fn a_place_is_met_exactly_and_for_good(
            distance in -1_000_000_i64..1_000_000, speed in 50_u32..20_000, accel in 1_u32..500, start in -1.0_f64..1.0
        ) {
            let bounds = Bounds { speed, accel };
            let mut follower = Follower::new();
            #[allow(clippy::cast_possible_truncation, reason = "a sample")]
            follower.set((start * f64::from(speed)) as i64);
            let (mut left, mut before, mut ticks) = (distance, follower.advance(), 0_u64);
            // the other way first, then there; rounding down costs at most a tick for every tick of braking
            let (v, a) = (u64::from(speed), u64::from(accel));
            let least = distance.unsigned_abs() / v + 4 * v.div_ceil(a) + 2 * (v * v / a) / v;
            while left != 0 || follower.advance() != 0 {
                let advance = follower.follow(left, 0, bounds, 0);
                prop_assert!((advance - before).unsigned_abs() <= a && advance.unsigned_abs() <= v);
                (left, before, ticks) = (left - advance, advance, ticks + 1);
                prop_assert!(ticks <= least + 20, "{ticks} {least}");
            }
            for _ in 0..10 {
                prop_assert_eq!(follower.follow(left, 0, bounds, 0), 0);
            }
        }

        /// From rest it does not pass the place.
        #[test]
        fn from_rest_nothing_is_passed(distance in 0_i64..10_000_000, speed in 50_u32..20_000, accel in 1_u32..500) {
            let (bounds, mut follower, mut left) = (Bounds { speed, accel }, Follower::new(), distance);
            while left != 0 {
                left -= follower.follow(left, 0, bounds, 0);
                prop_assert!(left >= 0);
            }
            prop_assert!(follower.advance().unsigned_abs() <= u64::from(accel));
        }

        /// A place that moves evenly is met, and kept.
        #[test]
        fn a_moving_place_is_met_from_behind_and_kept(distance in 0_i64..1_000_000, feed in 0_i64..5_000, accel in 20_u32..500) {
            let (bounds, mut follower, mut left) = (Bounds { speed: 10_000, accel }, Follower::new(), distance);
            for _ in 0..4_000 {
                left += feed;
                left -= follower.follow(left, feed, bounds, 0);
            }
            prop_assert_eq!((left, follower.advance()), (0, feed));
        }

        /// What is passed unasked is what the question would have allowed.
        #[test]
        fn an_end_that_is_far_allows_the_advance(
            accel in prop_oneof![0_u32..20, 1_u32..u32::MAX], part in 0_u64..1 << 20, advance in 0_u64..1 << 31, bits in 0_u32..31,
        ) {
            let advance = advance >> bits;
            // around where the answer changes
            let edge = advance.saturating_mul(advance) / u64::from(accel.max(1)) + 2 * u64::from(accel);
            for room in [edge, edge + part, edge.saturating_sub(part), edge / 2 + part] {
                prop_assert!(!is_far(room, advance, accel) || approach(room, accel) >= advance.cast_signed(), "{room}");
            }
        }

        #[test]
        fn an_end_far_enough_is_far(accel in 1_u32..1 << 24, advance in 0_u64..1 << 31) {
            prop_assert!(is_far(advance * advance / u64::from(accel) + 2 * u64::from(accel) + 7, advance, accel));
        }
    }
}
