//! The recurrence of an [`ArcWalker`](super::arc_walker::ArcWalker) during a row of steps, in 64 bits or, where they do, in 32.

use super::strides::{Turned, Turns};
use crate::math::to_u32;

/// A word that the recurrence is computed in, modulo its size.
pub(crate) trait Word: Copy {
    /// The low bits.
    fn from_wide(value: i64) -> Self;
    /// The value, whose true one fits.
    fn wide(self) -> i64;
    /// The sum.
    fn plus(self, other: Self) -> Self;
    /// Whether it is 0 or above.
    fn is_reached(self) -> bool;
    /// How often `step`, of which there is a divisor where words are wide, was added to `from` to come here: below 2^11.
    fn times_from(self, from: Self, step: Self, divisor: Divisor) -> u32;
}

/// What multiples of a wide number, below the 2^11th one, are divided by in 32 bits.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Divisor {
    /// Bits cut off so that a multiple fits 32 bits. What is left has 21 of them: more than the remainders, one each, add up to.
    cut: u32,
    one: u32,
}

impl Divisor {
    pub(super) const fn new(step: i64) -> Self {
        let step = step.unsigned_abs();
        let cut = 43_u32.saturating_sub(step.leading_zeros());
        Self { cut, one: to_u32(step.wrapping_shr(cut)) }
    }
}

impl Word for i64 {
    #[inline(always)]
    fn from_wide(value: i64) -> Self {
        value
    }
    #[inline(always)]
    fn wide(self) -> i64 {
        self
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self.wrapping_add(other)
    }
    #[inline(always)]
    fn is_reached(self) -> bool {
        self >= 0
    }
    #[inline]
    fn times_from(self, from: Self, _: Self, divisor: Divisor) -> u32 {
        let all = self.wrapping_sub(from).unsigned_abs();
        to_u32(all.wrapping_shr(divisor.cut)).checked_div(divisor.one).unwrap_or(0)
    }
}

impl Word for i32 {
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the caller knows that it fits")]
    fn from_wide(value: i64) -> Self {
        value as Self
    }
    #[inline(always)]
    fn wide(self) -> i64 {
        i64::from(self)
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self.wrapping_add(other)
    }
    #[inline(always)]
    fn is_reached(self) -> bool {
        self >= 0
    }
    #[inline(always)]
    fn times_from(self, from: Self, step: Self, _: Divisor) -> u32 {
        self.wrapping_sub(from).unsigned_abs().checked_div(step.unsigned_abs()).unwrap_or(0)
    }
}

/// The recurrence of an [`ArcWalker`] during a row of steps.
pub(crate) struct ArcRow<W> {
    pub(super) decision: W,
    pub(super) major_rise: W,
    pub(super) major_curve: W,
    pub(super) minor_rise: W,
    pub(super) minor_curve: W,
    /// The rises at the row's start.
    pub(super) before: (W, W),
    /// The major axis's rise at the last diagonal step.
    pub(super) turned: W,
    pub(super) divisors: [Divisor; 2],
}

impl<W: Word> Turns for ArcRow<W> {
    #[inline(always)]
    fn turns(&mut self) -> bool {
        self.turns_if(true)
    }

    #[inline(always)]
    fn turned(&self, _: u32) -> Turned {
        // the rises change evenly, so they tell how often they did
        let [major, minor] = self.divisors;
        let count = self.minor_rise.times_from(self.before.1, self.minor_curve, minor);
        Turned { count, last: self.turned.times_from(self.before.0, self.major_curve, major) }
    }
}

impl<W: Word> ArcRow<W> {
    /// Makes a step; a diagonal one only where the minor axis is free to step.
    #[inline(always)]
    pub(super) fn turns_if(&mut self, free: bool) -> bool {
        let turns = self.decision.is_reached() && free;
        self.step(turns);
        turns
    }

    /// Makes a step, diagonal or not.
    #[inline(always)]
    fn step(&mut self, diagonal: bool) {
        let rise = self.major_rise;
        if diagonal {
            self.turned = rise;
            self.decision = self.decision.plus(self.minor_rise);
            self.minor_rise = self.minor_rise.plus(self.minor_curve);
        }
        self.decision = self.decision.plus(rise);
        self.major_rise = rise.plus(self.major_curve);
    }
}
