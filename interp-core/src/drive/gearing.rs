//! Gearing: from the spindle's angle to a place on the path, an exact ratio.
//!
//! Path per turn is a whole number of nanometres and a fraction of integers ([`Lead`]). Whole turns are summed up exactly:
//! the nanometres, and the fraction's remainder, carried. Within a turn the place is `angle * lead / turn` by one product
//! of 32 bits, which begins anew at every turn. So nothing drifts, however many turns go by in either sense, and at any
//! angle the place is off by less than `lead / 2^29` and a unit, whatever happened before.

use super::spindle::{ANGLE_BITS, COUNT};
use crate::config::FRACTION_BITS;
use crate::curve::proportion::Proportion;
use crate::math::{scale, to_i64, to_u32, to_u64};

/// Path per turn of the spindle: pitch times starts; exact, also for threads in inches.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Lead {
    nm: u32,
    part: u32,
    per: u32,
}

impl Lead {
    /// Longest lead, 1 m.
    pub const LIMIT_NM: u64 = 1_000_000_000;

    /// `nm / turns`. `None` below 1 nm and past 1 m a turn.
    ///
    /// ```
    /// # use interp_core::drive::gearing::Lead;
    /// let eleven_a_inch = Lead::new(25_400_000, 11).unwrap();
    /// let two_starts_of_a_millimetre = Lead::new(2 * 1_000_000, 1).unwrap();
    /// assert!(Lead::new(25_400_000, 0).is_none() && eleven_a_inch != two_starts_of_a_millimetre);
    /// ```
    pub const fn new(nm: u64, turns: u32) -> Option<Self> {
        let (Some(whole), Some(rest)) = (nm.checked_div(turns as u64), nm.checked_rem(turns as u64)) else {
            return None;
        };
        if whole == 0 || whole > Self::LIMIT_NM {
            return None;
        }
        #[expect(clippy::cast_possible_truncation, reason = "below 10^9, and below `turns`")]
        Some(Self { nm: whole as u32, part: rest as u32, per: turns })
    }

    /// Times `numerator / denominator`, both below 2^63 and at least as large as the denominator: exact where they are
    /// equal, else to 2^-30 nm.
    #[must_use]
    pub fn stretched(self, numerator: u64, denominator: u64) -> Self {
        if numerator == denominator {
            return self;
        }
        const FINE: u32 = 1 << 30;
        let part = scale(i128::from(self.part), i128::from(FINE), i128::from(self.per.max(1)));
        let fine = (i128::from(self.nm) << 30).wrapping_add(part);
        let fine = to_u64(scale(fine, i128::from(numerator), i128::from(denominator.max(1))));
        let most = (Self::LIMIT_NM.wrapping_mul(2)) << 30;
        let fine = fine.min(most);
        #[expect(clippy::cast_possible_truncation, reason = "30 bits")]
        Self { nm: to_u32(fine >> 30), part: (fine & u64::from(FINE).wrapping_sub(1)) as u32, per: FINE }
    }

    /// Exactly, as a ratio of nanometres a turn.
    pub const fn ratio(self) -> (u64, u32) {
        let per = if self.per == 0 { 1 } else { self.per };
        ((self.nm as u64).wrapping_mul(per as u64).wrapping_add(self.part as u64), per)
    }

    /// Nanometres a turn, rounded down, and a fraction of one: numerator and denominator.
    pub(crate) const fn parts(self) -> (u32, u32, u32) {
        (self.nm, self.part, self.per)
    }

    /// The lead of [`parts`](Self::parts).
    pub(crate) const fn of_parts((nm, part, per): (u32, u32, u32)) -> Self {
        Self { nm, part, per }
    }

    /// Nanometres a turn, rounded down.
    pub const fn nm(self) -> u32 {
        self.nm
    }

    /// Whole units of path (nm, 12 fraction bits) a turn, and what is over in `1 / per` of a unit.
    const fn units(self) -> (i64, u32) {
        let over = (self.part as u64) << FRACTION_BITS;
        let per = self.per as u64;
        let (Some(more), Some(over)) = (over.checked_div(per), over.checked_rem(per)) else { return (0, 0) };
        let whole = ((self.nm as u64) << FRACTION_BITS).wrapping_add(more);
        #[expect(clippy::cast_possible_truncation, reason = "below `per`")]
        (whole.cast_signed(), over as u32)
    }
}

/// Turns an angle into a place.
#[derive(Copy, Clone, Debug)]
pub struct Gearing {
    lead: Lead,
    /// From an angle within a turn to path.
    ratio: Proportion,
    /// A turn of the spindle, [`ANGLE_BITS`].
    turn: i64,
    /// Path a count, rounded down.
    count: u32,
    /// Path a turn, and what is over in `1 / per` of a unit.
    whole: i64,
    over: u32,
    per: u32,
    /// Path runs on where the angle falls.
    reverse: bool,
    /// Angle last seen, and its part of the present turn.
    angle: i64,
    part: i64,
    /// Path up to the present turn, and what is over.
    base: i64,
    carry: u32,
}

impl Gearing {
    /// At path 0 for `angle`; `reverse` where the path runs on with a falling angle.
    pub fn new(lead: Lead, counts: u32, angle: i64, reverse: bool) -> Self {
        let turn = i64::from(counts.max(1)) << ANGLE_BITS;
        let (whole, over) = lead.units();
        let length = turn.unsigned_abs();
        let ratio = Proportion::new(whole.unsigned_abs(), length, length);
        Self {
            lead,
            ratio,
            turn,
            count: to_u32(ratio.of(COUNT.unsigned_abs())),
            whole,
            over,
            per: lead.per.max(1),
            reverse,
            angle,
            part: 0,
            base: 0,
            carry: 0,
        }
    }

    /// Puts path 0 where the spindle is at `zero` and `phase` (in 2^-16 of a turn) behind it, and the place of the
    /// angle last seen into the turn of path before 0. For this one division is made.
    pub fn set_phase(&mut self, zero: i64, phase: u16) {
        let off = self.signed(self.angle.wrapping_sub(zero));
        let phase = to_u64(i128::from(self.turn).wrapping_mul(i128::from(phase)) >> 16).cast_signed();
        self.part = off.wrapping_sub(phase).checked_rem_euclid(self.turn).unwrap_or(0);
        (self.base, self.carry) = (0, 0);
        self.turn_back();
    }

    /// Puts the place a turn of path back: another groove of the same thread.
    pub fn turn_back(&mut self) {
        self.base = self.base.wrapping_sub(self.whole);
        if self.carry >= self.over {
            self.carry = self.carry.wrapping_sub(self.over);
        } else {
            self.carry = self.carry.wrapping_add(self.per).wrapping_sub(self.over);
            self.base = self.base.wrapping_sub(1);
        }
    }

    /// The lead.
    pub const fn lead(&self) -> Lead {
        self.lead
    }

    /// A length of path under the present lead, as it is under another one.
    pub fn converted(&self, length: i64, lead: Lead) -> i64 {
        let (whole, _) = lead.units();
        to_i64(scale(i128::from(length), i128::from(whole), i128::from(self.whole.max(1))))
    }

    /// Goes on with another lead from where the path is at `joint`, which was or will be passed within a tick.
    pub fn change(&mut self, lead: Lead, joint: i64) {
        let beyond = self.base.wrapping_add(self.along(self.part)).wrapping_sub(joint);
        let place = joint.wrapping_add(self.converted(beyond, lead));
        let counts = to_u32(self.turn.unsigned_abs() >> ANGLE_BITS);
        *self = Self { part: self.part, ..Self::new(lead, counts, self.angle, self.reverse) };
        self.base = place.wrapping_sub(self.along(self.part));
    }

    /// Moves the whole path by so much: the phase is given up.
    pub const fn shift(&mut self, by: i64) {
        self.base = self.base.wrapping_add(by);
    }

    const fn signed(&self, angle: i64) -> i64 {
        if self.reverse { angle.wrapping_neg() } else { angle }
    }

    /// The place at an angle less than a turn from the last one.
    pub fn at(&mut self, angle: i64) -> i64 {
        self.part = self.part.wrapping_add(self.signed(angle.wrapping_sub(self.angle)));
        self.angle = angle;
        // a tick turns a spindle by a small part of a turn
        if self.part >= self.turn {
            self.part = self.part.wrapping_sub(self.turn);
            self.base = self.base.wrapping_add(self.whole);
            self.carry = self.carry.wrapping_add(self.over);
            if self.carry >= self.per {
                self.carry = self.carry.wrapping_sub(self.per);
                self.base = self.base.wrapping_add(1);
            }
        } else if self.part < 0 {
            self.part = self.part.wrapping_add(self.turn);
            self.turn_back();
        }
        self.base.wrapping_add(self.along(self.part))
    }

    /// The path that a count is worth, rounded down.
    pub const fn count(&self) -> u32 {
        self.count
    }

    /// The path that a turn by `angle`, less than a whole one, is worth.
    fn along(&self, angle: i64) -> i64 {
        let path = self.ratio.of(angle.unsigned_abs()).cast_signed();
        if angle < 0 { path.wrapping_neg() } else { path }
    }

    /// The same in the sense of the path.
    pub fn travel(&self, angle: i64) -> i64 {
        self.along(self.signed(angle))
    }
}

/// One count is not more than a turn.
const _: () = assert!(COUNT == 1 << ANGLE_BITS);

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The place in exact arithmetic: floor of counts times lead over counts a turn.
    fn exact(nm: u64, turns: u32, counts: u32, angle: i64) -> i128 {
        let path = i128::from(angle) * i128::from(nm) * 4096;
        path.div_euclid((i128::from(counts) << ANGLE_BITS) * i128::from(turns))
    }

    proptest! {
        #[test]
        fn the_place_is_the_exact_ratio_after_any_way(
            nm in 1_000_u64..200_000_000, turns in 1_u32..5_000, counts in 4_u32..40_000,
            moves in prop::collection::vec((-1.0_f64..1.0, 1_u32..60), 1..60)
        ) {
            prop_assume!(nm / u64::from(turns) >= 1);
            let mut gearing = Gearing::new(Lead::new(nm, turns).unwrap(), counts, 0, false);
            let mut angle = 0_i64;
            for (part, times) in moves {
                #[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "a sample")]
                let step = (part * (f64::from(counts) * COUNT as f64)) as i64;
                for _ in 0..times {
                    angle += step;
                    let off = i128::from(gearing.at(angle)) - exact(nm, turns, counts, angle);
                    // all is rounded down: the ratio, by a 2^29th of a turn's path (factor and cut angle); its numerator, the
                    // product and the path of whole turns, by less than a unit each
                    let allowed = (i128::from(nm) << 12) / i128::from(turns) / (1 << 29) + 3;
                    prop_assert!((-allowed..=0).contains(&off), "{off} {allowed}");
                }
            }
        }
    }

    /// A thousand million counts one way and back, in strides that are no part of a turn: no unit is lost.
    #[test]
    fn nothing_drifts_over_a_thousand_million_counts() {
        let (nm, turns, counts) = (25_400_000, 11, 4096);
        let mut gearing = Gearing::new(Lead::new(nm, turns).unwrap(), counts, 0, false);
        let mut angle = 0;
        for _ in 0..250_100 {
            angle += 3999 * COUNT;
            gearing.at(angle);
        }
        assert!(angle > 1_000_000_000 * COUNT);
        let off = i128::from(gearing.at(angle)) - exact(nm, turns, counts, angle);
        assert!(off.abs() <= 40, "{off} of 2^-12 nm");
        while angle > 0 {
            angle -= 3999 * COUNT;
            gearing.at(angle);
        }
        assert_eq!(gearing.at(0), 0);
    }

    #[test]
    fn starts_lie_their_share_of_a_turn_apart() {
        for starts in 1..=6_u16 {
            let lead = Lead::new(6_000_000, 1).unwrap();
            let place = |start: u16| {
                let mut gearing = Gearing::new(lead, 4096, 12_345 * COUNT, false);
                gearing.set_phase(77 * COUNT, u16::try_from(u32::from(start) * 65_536 / u32::from(starts)).unwrap());
                gearing.at(12_345 * COUNT)
            };
            for start in 0..starts {
                let apart = (place(0) - place(start)).rem_euclid(6_000_000 << 12);
                let share = (6_000_000_i64 << 12) * i64::from(start) / i64::from(starts);
                assert!((apart - share).abs() <= (6_000_000 << 12) / 65_536 + 1, "{start}/{starts}: {apart} {share}");
                assert!((-(6_000_000 << 12)..=0).contains(&place(start)));
            }
        }
    }
}
