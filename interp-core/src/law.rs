//! Speed laws: how the speed along the path changes from one value to another.
//!
//! The linear law changes it with a constant acceleration. The two S laws smooth the advance that the linear law plans: the
//! tool's advance in a tick is a weighted mean of the plan's last N ticks ([`Smoothing`]). With N equal weights the
//! acceleration itself changes evenly (parabolic double-S), with weights along half a sine wave it does so without a
//! kink (trigonometric double-S). What the mean does is told in `docs/src/speed.md`.

use crate::math::{QUARTER_Q30, RADIAN_Q30, sine, to_u32};

/// How the speed along the path changes.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub enum SpeedLaw {
    /// With a constant acceleration, time-optimal; the jerk is unlimited.
    #[default]
    Linear,
    /// Trigonometric double-S: the jerk is limited and continuous.
    Sine,
    /// Parabolic double-S: the jerk is limited and constant in stretches.
    Parabolic,
}

impl SpeedLaw {
    /// All, in the order of their parameter.
    pub const ALL: [Self; 3] = [Self::Linear, Self::Sine, Self::Parabolic];

    /// The word of the parameter.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Sine => "sine",
            Self::Parabolic => "parabolic",
        }
    }

    /// Ticks times jerk over acceleration, thousandths: from `+a` to `-a` the mean changes by at most `2 a / N` a tick with
    /// equal weights, `pi a / N` with half a sine wave.
    const fn reversal(self) -> u64 {
        match self {
            Self::Linear => 0,
            Self::Sine => 3_142,
            Self::Parabolic => 2_000,
        }
    }
}

/// A speed law and the ticks over which it takes its mean.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Smoothing {
    law: SpeedLaw,
    ticks: u8,
}

/// Fraction bits of the weights, which add up to one.
pub const WEIGHT_BITS: u32 = 24;

/// Most ticks of a mean.
pub const MAX_TICKS: usize = 64;

impl Smoothing {
    /// The linear law.
    pub const NONE: Self = Self { law: SpeedLaw::Linear, ticks: 0 };
    /// Range of the largest jerk, mm/s3.
    pub const JERK_RANGE: (u32, u32) = (100, 1_000_000_000);

    /// The shortest mean under which an acceleration of at most `accel` (nm a tick squared, 12 fraction bits, that is
    /// 4096ths of mm/s2) gives a jerk of at most `jerk` mm/s3.
    ///
    /// # Errors
    /// The least jerk that [`MAX_TICKS`] can keep.
    ///
    /// ```
    /// # use interp_core::law::{Smoothing, SpeedLaw};
    /// // 500 mm/s2 and 50 000 mm/s3: 2 * 500 / 50 000 = 20 ms
    /// assert_eq!(Smoothing::new(SpeedLaw::Parabolic, 500 << 12, 50_000).unwrap().ticks(), 20);
    /// assert_eq!(Smoothing::new(SpeedLaw::Parabolic, 500 << 12, 10_000), Err(15_625));
    /// ```
    pub fn new(law: SpeedLaw, accel: u32, jerk: u32) -> Result<Self, u32> {
        if matches!(law, SpeedLaw::Linear) {
            return Ok(Self::NONE);
        }
        // a tick is a thousandth of a second, and so is the unit of `reversal`
        let change = u64::from(accel).wrapping_mul(law.reversal());
        // rounded up: to the whole tick, and to the whole jerk
        let up = |value: u64, unit: u64| value.saturating_add(unit.wrapping_sub(1)).checked_div(unit);
        let Some(ticks) = up(change, u64::from(jerk.max(1)) << 12) else { return Ok(Self::NONE) };
        if ticks > MAX_TICKS as u64 {
            return Err(to_u32(up(change, (MAX_TICKS as u64) << 12).unwrap_or(u64::MAX)));
        }
        #[expect(clippy::cast_possible_truncation, reason = "at most MAX_TICKS")]
        let ticks = if ticks < 2 { 2 } else { ticks as u8 };
        Ok(Self { law, ticks })
    }

    /// The law.
    pub const fn law(&self) -> SpeedLaw {
        self.law
    }

    /// Ticks of the mean, 2 to [`MAX_TICKS`]; 0 for the linear law, which takes none.
    pub const fn ticks(&self) -> u8 {
        self.ticks
    }

    /// The sum of the first `count` weights; the sum of all is one, exactly. Each weight is the law's curve summed over
    /// its tick.
    pub const fn weighed(&self, count: u8) -> u32 {
        let ticks = if self.ticks == 0 { 1 } else { self.ticks as i64 };
        match self.law {
            SpeedLaw::Sine => {
                // (1 - cos(pi k / N)) / 2
                let turned = QUARTER_Q30.wrapping_mul(2).wrapping_mul(count as i64);
                let cosine = match turned.checked_div(ticks) {
                    Some(angle) => sine(QUARTER_Q30.wrapping_sub(angle)),
                    None => RADIAN_Q30,
                };
                let shift = 31_u32.wrapping_sub(WEIGHT_BITS);
                let half = 1_i64.wrapping_shl(shift.wrapping_sub(1));
                let sum = RADIAN_Q30.wrapping_sub(cosine).wrapping_add(half).wrapping_shr(shift);
                to_u32(sum.unsigned_abs())
            }
            SpeedLaw::Linear | SpeedLaw::Parabolic => {
                let whole = (count as i64).wrapping_shl(WEIGHT_BITS);
                match whole.wrapping_add(ticks >> 1).checked_div(ticks) {
                    Some(sum) => to_u32(sum.unsigned_abs()),
                    None => 0,
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    fn all() -> impl Iterator<Item = Smoothing> {
        [SpeedLaw::Sine, SpeedLaw::Parabolic]
            .into_iter()
            .flat_map(|law| (2..=64).map(move |ticks| Smoothing { law, ticks }))
    }

    fn weights(smoothing: Smoothing) -> std::vec::Vec<f64> {
        let sum = |count| f64::from(smoothing.weighed(count)) / f64::from(1 << WEIGHT_BITS);
        (0..smoothing.ticks).map(|k| sum(k + 1) - sum(k)).collect()
    }

    #[test]
    fn weights_add_up_to_one_and_are_symmetric() {
        for smoothing in all() {
            assert_eq!(smoothing.weighed(0), 0);
            assert_eq!(smoothing.weighed(smoothing.ticks), 1 << WEIGHT_BITS, "{smoothing:?}");
            let weights = weights(smoothing);
            for (a, b) in weights.iter().zip(weights.iter().rev()) {
                assert!((a - b).abs() < 3e-7 && *a > 0.0, "{smoothing:?} {a} {b}");
            }
        }
    }

    /// The change of the mean from `+a` to `-a` is the sum of the weights' differences.
    #[test]
    fn the_jerk_promised_is_that_of_the_weights() {
        for smoothing in all() {
            let weights = weights(smoothing);
            let steps = weights.windows(2).map(|pair| (pair[1] - pair[0]).abs());
            let variation = weights[0] + steps.sum::<f64>() + weights[weights.len() - 1];
            #[allow(clippy::cast_precision_loss, reason = "a small number")]
            let promised = smoothing.law.reversal() as f64 / 1e3 / f64::from(smoothing.ticks);
            assert!(variation <= promised * 1.0002 + 1e-6, "{smoothing:?}: {variation} of {promised}");
            assert!(variation >= promised * 0.63, "{smoothing:?}: {variation} of {promised}");
        }
    }

    #[test]
    fn half_a_sine_wave_is_that() {
        let smoothing = Smoothing { law: SpeedLaw::Sine, ticks: 39 };
        for (k, weight) in (0_u8..).zip(weights(smoothing)) {
            let angle = |k: u8| std::f64::consts::PI * f64::from(k) / 39.0;
            assert!((weight - (angle(k).cos() - angle(k + 1).cos()) / 2.0).abs() < 2e-7);
        }
    }

    #[test]
    fn a_jerk_without_room_names_the_least_that_has() {
        for law in [SpeedLaw::Sine, SpeedLaw::Parabolic] {
            let least = Smoothing::new(law, 619 << 12, 1).unwrap_err();
            assert_eq!(Smoothing::new(law, 619 << 12, least).map(|s| s.ticks()), Ok(64));
            assert!(Smoothing::new(law, 619 << 12, least - 1).is_err());
        }
        assert_eq!(Smoothing::new(SpeedLaw::Linear, u32::MAX, 1), Ok(Smoothing::NONE));
        assert_eq!(Smoothing::new(SpeedLaw::Sine, 1, u32::MAX).unwrap().ticks(), 2);
    }
}
