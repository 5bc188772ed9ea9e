//! The contour wheel: counts become a distance to go along the path.
//!
//! A count is worth an exact part of a nanometre-based increment, so nothing is rounded and nothing is carried. What is
//! asked for stands in two parts. **Waiting** is the last click: it is let go over some ticks, an eighth of what is left
//! in each and a last 16th at once, so that a detent is no jerk. **To go** is what the path is driven along; the channel brakes for its end.
//!
//! Both together are never more than what braking from the present speed needs, a click, and a tick's worth: what
//! is beyond that is dropped, in whole counts, and told. So after the wheel stops the tool runs on by no more than
//! `v^2 / 2a`, a click and a tick.

use crate::config::FRACTION_BITS;
use crate::math::to_i32;

/// Counts of a detent.
pub const COUNTS: i64 = 4;

/// Ticks' share of the waiting click that is let go in each.
const SPREAD: u32 = 3;

/// Path of one detent.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Click(u32);

impl Click {
    /// 1, 10 and 100 um: x1, x10 and x100.
    pub const DECADES: [Self; 3] = [Self(1_000), Self(10_000), Self(100_000)];

    /// Of 1 nm to 10 mm.
    pub const fn from_nm(nm: u32) -> Option<Self> {
        if nm == 0 || nm > 10_000_000 { None } else { Some(Self(nm)) }
    }

    /// Path of a detent, nm with 12 fraction bits.
    pub const fn length(self) -> i64 {
        (self.0 as i64) << FRACTION_BITS
    }

    /// Path of a count: exact.
    pub const fn count(self) -> i64 {
        self.length() / COUNTS
    }
}

/// What the wheel asks for; nm with 12 fraction bits, signed.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Wheel {
    waiting: i64,
    to_go: i64,
}

impl Wheel {
    /// Nothing is asked for.
    pub const fn new() -> Self {
        Self { waiting: 0, to_go: 0 }
    }

    /// Path to go.
    pub const fn to_go(&self) -> i64 {
        self.to_go
    }

    /// All that is asked for.
    pub const fn all(&self) -> i64 {
        self.to_go.saturating_add(self.waiting)
    }

    /// The path went on by so much.
    pub const fn went(&mut self, by: i64) {
        self.to_go = self.to_go.wrapping_sub(by);
    }

    /// Takes the counts of a tick. `braking` is the signed distance that braking from the present speed needs, and
    /// `tick` what a tick at this speed covers. Returns the counts dropped.
    pub fn turn(&mut self, click: Click, counts: i16, braking: i64, tick: i64) -> i32 {
        self.waiting = self.waiting.saturating_add(i64::from(counts).saturating_mul(click.count()));
        let all = self.to_go.saturating_add(self.waiting);
        let room = click.length().saturating_add(tick);
        let (least, most) = (braking.min(0).saturating_sub(room), braking.max(0).saturating_add(room));
        let surplus = all.saturating_sub(all.max(least).min(most));
        // whole counts, so that what is left of the last click is kept
        let dropped = surplus.checked_div(click.count()).unwrap_or(0);
        self.waiting = self.waiting.saturating_sub(dropped.saturating_mul(click.count()));
        // no more than a click waits, and of that a share is let go, the last of it as a whole
        let kept = self.waiting.max(click.length().wrapping_neg()).min(click.length());
        let beyond = self.waiting.saturating_sub(kept);
        let share = kept >> SPREAD;
        let let_go = if kept.saturating_abs() <= click.length() >> 4 { kept } else { share };
        self.waiting = kept.saturating_sub(let_go);
        self.to_go = self.to_go.saturating_add(beyond).saturating_add(let_go);
        to_i32(dropped)
    }

    /// Whether nothing is asked for.
    pub const fn is_at_rest(&self) -> bool {
        self.to_go == 0 && self.waiting == 0
    }

    /// Asks for a distance outright, in the place of all asked for.
    pub const fn ask(&mut self, by: i64) {
        self.to_go = by;
        self.waiting = 0;
    }

    /// Drops what would lead out of the room (at most 0, at least 0). Returns the counts dropped, begun ones too.
    pub fn limit(&mut self, click: Click, (least, most): (i64, i64)) -> i32 {
        let all = self.to_go.saturating_add(self.waiting);
        let kept = all.max(least).min(most);
        if kept == all {
            return 0;
        }
        self.ask(kept);
        dropped(all.saturating_sub(kept), click)
    }

    /// Drops what is left where the path ends. Returns the counts dropped, begun ones too.
    pub fn stop(&mut self, click: Click) -> i32 {
        let all = self.to_go.saturating_add(self.waiting);
        *self = Self::new();
        dropped(all, click)
    }
}

/// Counts that a length is worth, begun ones too.
pub(crate) fn dropped(length: i64, click: Click) -> i32 {
    let count = click.count().unsigned_abs();
    let up = length.unsigned_abs().saturating_add(count.saturating_sub(1));
    let whole = up.checked_div(count).unwrap_or(0).cast_signed();
    to_i32(if length < 0 { whole.wrapping_neg() } else { whole })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Counts asked for are gone or dropped, never both and never lost; what is owed stays within its bound.
        #[test]
        fn every_count_is_gone_or_dropped(
            turns in prop::collection::vec((-40_i16..40, -3.0_f64..3.0), 1..300), nm in 1_u32..200_000
        ) {
            let click = Click::from_nm(nm).unwrap();
            let (mut wheel, mut gone, mut dropped, mut asked) = (Wheel::new(), 0_i64, 0_i64, 0_i64);
            for (counts, share) in turns {
                dropped += i64::from(wheel.turn(click, counts, 0, 500));
                asked += i64::from(counts);
                prop_assert!((wheel.to_go + wheel.waiting).abs() <= click.length() + 500 + click.count());
                #[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "a sample")]
                let by = (wheel.to_go as f64 * share / 3.0) as i64;
                wheel.went(by);
                gone += by;
            }
            prop_assert_eq!(gone + wheel.to_go + wheel.waiting + dropped * click.count(), asked * click.count());
        }
    }

    #[test]
    fn a_click_comes_over_some_ticks_and_whole() {
        let click = Click::from_nm(10_000).unwrap();
        let (mut wheel, mut ticks) = (Wheel::new(), 0);
        assert_eq!(wheel.turn(click, 4, 0, 0), 0);
        assert_eq!(wheel.to_go(), click.length() / 8);
        while wheel.to_go() != click.length() {
            assert_eq!(wheel.turn(click, 0, 0, 0), 0);
            ticks += 1;
        }
        assert!((10..30).contains(&ticks), "{ticks}");
    }
}
