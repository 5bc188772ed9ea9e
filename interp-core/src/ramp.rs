//! Ramp table: the intervals between the pulses of a motor that starts at one frequency and climbs to another, linearly
//! in time.
//!
//! From the start frequency f0 to the top frequency fH in H steps the acceleration is `a = (fH^2 - f0^2) / (2 H)`, and step
//! X is due after `t_X = (sqrt(f0^2 + 2 a X) - f0) / a`. So the interval before step X is
//!
//! ```text
//! T_X = 2 sqrt(H) (sqrt(H f0^2 + X d) - sqrt(H f0^2 + (X - 1) d)) / d       with d = fH^2 - f0^2
//!     = 2 H / (r_X + r_(X-1))                                               with r_X = sqrt(H (H f0^2 + X d))
//! ```
//!
//! The second form, the first times the sum of its roots, subtracts nothing and so loses no digits, and holds for fH = f0,
//! too. The roots are taken of 128 bits; an interval is the nearest number of timer ticks (but where it lies within a
//! 10^-9th of a half). The intervals from X = 1 on add up to `t_H = 2 H / (f0 + fH)`.
//!
//! A start from rest makes its first step a whole period of f0 after the start: the table begins with `T_1 = 1 / f0`
//! and follows the formula from X = 2. A ramp down is the same, backward.
//!
//! Source: the hand lathe paper of 2000, section 3.2.

use crate::math::root_wide;

/// A ramp whose figures were checked.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Ramp {
    start: u32,
    top: u32,
    steps: u32,
    timer: u32,
}

/// Why figures are no ramp.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum RampError {
    /// The start frequency is 0, or the top one is below it.
    Frequencies,
    /// No step, or more than [`Ramp::MAX_STEPS`].
    Steps,
    /// The top frequency is past the timer's or past [`Ramp::MAX_HZ`], or the timer's is 0.
    Timer,
}

impl core::fmt::Display for RampError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Frequencies => write!(f, "a ramp must start above 0 Hz and not end below its start"),
            Self::Steps => write!(f, "a ramp has 1 to {} steps", Ramp::MAX_STEPS),
            Self::Timer => {
                write!(f, "a ramp's top frequency must not pass its timer's nor {} Hz", Ramp::MAX_HZ)
            }
        }
    }
}

impl Ramp {
    /// Most steps.
    pub const MAX_STEPS: u32 = 1 << 20;
    /// Largest frequency, Hz.
    pub const MAX_HZ: u32 = 1 << 24;

    /// A ramp from `start` to `top` (Hz) in `steps` steps, counted by a timer of `timer` Hz.
    ///
    /// ```
    /// # use interp_core::ramp::Ramp;
    /// let ramp = Ramp::new(500, 5000, 100, 1_000_000).unwrap();
    /// assert_eq!(ramp.interval(1), Some(2000)); // a period of 500 Hz
    /// assert_eq!(ramp.interval(100), Some(200));
    /// ```
    pub const fn new(start: u32, top: u32, steps: u32, timer: u32) -> Result<Self, RampError> {
        if start == 0 || top < start {
            Err(RampError::Frequencies)
        } else if steps == 0 || steps > Self::MAX_STEPS {
            Err(RampError::Steps)
        } else if top > timer || top > Self::MAX_HZ {
            Err(RampError::Timer)
        } else {
            Ok(Self { start, top, steps, timer })
        }
    }

    /// Steps between the two frequencies.
    pub const fn steps(&self) -> u32 {
        self.steps
    }

    /// Interval before step `step` (from 1) of a start from rest, timer ticks; `None` outside the ramp. The first is a
    /// whole period of the start frequency.
    pub const fn interval(&self, step: u32) -> Option<u32> {
        if step == 1 { Some(self.first()) } else { self.formula(step) }
    }

    /// Interval before step `step` (from 1) of a stop from the top frequency. The last is a whole period of the start
    /// frequency.
    pub const fn falling(&self, step: u32) -> Option<u32> {
        self.interval(self.steps.wrapping_add(1).wrapping_sub(step))
    }

    /// Interval before step `step` (from 1) by the formula, timer ticks; `None` outside the ramp.
    pub const fn formula(&self, step: u32) -> Option<u32> {
        if step == 0 || step > self.steps {
            return None;
        }
        Some(self.time(2, step, step.wrapping_sub(1)))
    }

    /// Time from the start of the climb to step `step` (0 to [`steps`](Self::steps)), timer ticks, rounded to nearest.
    /// Differences of these add no rounding up along a ramp.
    pub const fn elapsed(&self, step: u32) -> Option<u32> {
        if step > self.steps {
            return None;
        }
        Some(self.time((step as u64).wrapping_mul(2), step, 0))
    }

    /// A period of the start frequency, rounded to nearest.
    const fn first(&self) -> u32 {
        nearest(self.timer as u128, self.start as u128)
    }

    /// `steps * H * timer / (r_a + r_b)`.
    const fn time(&self, steps: u64, a: u32, b: u32) -> u32 {
        let (square_a, square_b) = (self.square(a), self.square(b));
        // as many fraction bits as both roots bear in 63; H fH is below 2^44, so its square below 2^88
        let bits = 128_u32.wrapping_sub(self.square(self.steps).leading_zeros());
        let shift = 126_u32.wrapping_sub(bits) & !1;
        let sum = (root_wide(square_a.wrapping_shl(shift)) as u128)
            .wrapping_add(root_wide(square_b.wrapping_shl(shift)) as u128);
        // below 2^21 * 2^20 * 2^32, and the shift is at most 126, halved 63
        let whole = (steps as u128).wrapping_mul(self.steps as u128).wrapping_mul(self.timer as u128);
        let room = whole.leading_zeros();
        let half = shift >> 1;
        let lift = if half < room { half } else { room };
        // what the dividend can't be lifted by is cut off the divisor
        nearest(whole.wrapping_shl(lift), sum.wrapping_shr(half.wrapping_sub(lift)))
    }

    /// `H (H f0^2 + X d)`: below 2^88.
    const fn square(&self, step: u32) -> u128 {
        let (start, top, steps) = (self.start as u128, self.top as u128, self.steps as u128);
        let low = start.wrapping_mul(start);
        let rise = top.wrapping_mul(top).wrapping_sub(low);
        steps.wrapping_mul(steps.wrapping_mul(low).wrapping_add((step as u128).wrapping_mul(rise)))
    }
}

/// `numerator / denominator` rounded to nearest, saturating.
const fn nearest(numerator: u128, denominator: u128) -> u32 {
    match numerator.saturating_add(denominator >> 1).checked_div(denominator) {
        #[expect(clippy::cast_possible_truncation, reason = "compared before")]
        Some(ticks) if ticks <= u32::MAX as u128 => ticks as u32,
        _ => u32::MAX,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::cmp::Ordering;
    use proptest::prelude::*;

    /// Compares `2 H timer / (sqrt(p) + sqrt(q))` with `twice / 2` in integers, by squaring
    /// `4 H timer <=> twice (sqrt(p) + sqrt(q))` two times.
    fn compare(steps: u128, timer: u128, [p, q]: [u128; 2], twice: u128) -> Ordering {
        let left = (4 * steps * timer).pow(2);
        let plain = twice.pow(2) * (p + q);
        if left < plain { Ordering::Less } else { (left - plain).pow(2).cmp(&(4 * twice.pow(4) * p * q)) }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(5000))]
        /// Against the closed form without any rounding: roots compared by their squares.
        #[test]
        fn every_interval_is_the_nearest_tick(start in 300_u32..2000, rise in 0_u32..2000, steps in 1_u32..20, at: u32) {
            let (top, timer) = (start + rise, 200_000);
            let ramp = Ramp::new(start, top, steps, timer).unwrap();
            let step = 1 + at % steps;
            let found = u128::from(ramp.formula(step).unwrap());
            let (f0, fh, h) = (u128::from(start), u128::from(top), u128::from(steps));
            let square = |x: u128| h * (h * f0 * f0 + x * (fh * fh - f0 * f0));
            let roots = [square(u128::from(step)), square(u128::from(step) - 1)];
            let off = |twice| compare(h, u128::from(timer), roots, twice);
            // from half a tick less, which goes up, to half a tick more
            prop_assert_ne!(off(2 * found - 1), Ordering::Less, "{} is too long", found);
            prop_assert_eq!(off(2 * found + 1), Ordering::Less, "{} is too short", found);
        }

        /// The sum of the formula's intervals is `t_H`, whatever the size.
        #[test]
        fn the_climb_takes_its_closed_time(start in 1_u32..1 << 20, rise in 0_u32..1 << 20, steps in 1_u32..=Ramp::MAX_STEPS) {
            let timer = 84_000_000;
            let ramp = Ramp::new(start, start + rise, steps, timer).unwrap();
            let sum = u128::from(start) + u128::from(start + rise);
            let closed = (4 * u128::from(steps) * u128::from(timer) + sum) / (2 * sum);
            prop_assume!(closed < u128::from(u32::MAX));
            prop_assert_eq!(u128::from(ramp.elapsed(steps).unwrap()), closed);
            prop_assert_eq!(ramp.elapsed(0), Some(0));
            // and an interval is the difference of two times
            for step in [1, steps / 2 + 1, steps] {
                let (to, from) = (ramp.elapsed(step).unwrap(), ramp.elapsed(step - 1).unwrap());
                prop_assert!((to - from).abs_diff(ramp.formula(step).unwrap()) <= 1);
            }
        }
    }

    #[test]
    fn the_formula_adds_up_to_the_time_of_the_climb_and_the_table_is_longer_by_the_first_period() {
        let (f0, fh, h, timer) = (500.0_f64, 5000.0_f64, 100_u32, 1e9_f64);
        let ramp = Ramp::new(500, 5000, h, 1_000_000_000).unwrap();
        let sum: u64 = (1..=h).map(|x| u64::from(ramp.formula(x).unwrap())).sum();
        #[allow(clippy::cast_precision_loss, reason = "below 2^53")]
        let off = sum as f64 - 2.0 * f64::from(h) / (f0 + fh) * timer;
        assert!(off.abs() <= f64::from(h) / 2.0, "each interval is rounded once: {off}");
        // the paper's table: T_1 = 1/f0 in place of the formula's, which is shorter
        assert_eq!(ramp.interval(1), Some(2_000_000));
        assert!(ramp.formula(1).unwrap() < 2_000_000);
        for x in 2..=h {
            assert_eq!(ramp.interval(x), ramp.formula(x));
        }
    }

    #[test]
    fn a_ramp_falls_as_it_climbed() {
        let ramp = Ramp::new(300, 4000, 37, 12_000_000).unwrap();
        for x in 1..=37 {
            assert_eq!(ramp.falling(x), ramp.interval(38 - x));
        }
        assert_eq!((ramp.falling(0), ramp.falling(38), ramp.interval(0), ramp.interval(38)), (None, None, None, None));
    }

    #[test]
    fn what_is_no_ramp_is_refused() {
        assert_eq!(Ramp::new(0, 10, 5, 100), Err(RampError::Frequencies));
        assert_eq!(Ramp::new(11, 10, 5, 100), Err(RampError::Frequencies));
        assert_eq!(Ramp::new(1, 10, 0, 100), Err(RampError::Steps));
        assert_eq!(Ramp::new(1, 10, Ramp::MAX_STEPS + 1, 100), Err(RampError::Steps));
        assert_eq!(Ramp::new(1, 101, 5, 100), Err(RampError::Timer));
        // the widest figures saturate, and nothing wraps
        let ramp = Ramp::new(1, Ramp::MAX_HZ, Ramp::MAX_STEPS, u32::MAX).unwrap();
        assert_eq!(ramp.interval(1), Some(u32::MAX));
        assert_eq!(ramp.interval(Ramp::MAX_STEPS), Some(256));
    }
}
