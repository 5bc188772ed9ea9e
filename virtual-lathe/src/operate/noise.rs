//! Noise: counts that come at random, the same in every run.

/// Random counts at a rate: `SplitMix64` (G. Steele, D. Lea, C. Flood, OOPSLA 2014).
pub(super) struct Noise {
    state: u64,
    /// Counts a tick.
    rate: f64,
}

impl Noise {
    /// Silence.
    pub(super) const fn new(seed: u64) -> Self {
        Self { state: seed, rate: 0.0 }
    }

    /// So many counts a second.
    pub(super) fn set(&mut self, rate: f64) {
        self.rate = rate / 1e3;
    }

    /// Whether no counts come.
    pub(super) fn is_silent(&self) -> bool {
        self.rate <= 0.0
    }

    /// Counts of a tick, each to plus or to minus.
    pub(super) fn counts(&mut self) -> i16 {
        if self.rate <= 0.0 {
            return 0;
        }
        let whole = self.rate.floor();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 1000 a tick")]
        let count = whole as u32 + u32::from(self.chance() < self.rate - whole);
        let mut sum = 0_i16;
        for _ in 0..count {
            sum = sum.saturating_add(if self.chance() < 0.5 { 1 } else { -1 });
        }
        sum
    }

    /// A number from 0 to 1.
    fn chance(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.state;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        #[expect(clippy::cast_precision_loss, reason = "53 bits")]
        let part = ((mixed ^ (mixed >> 31)) >> 11) as f64;
        part / 9_007_199_254_740_992.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_counts_come_as_the_rate_says() {
        let mut noise = Noise::new(1);
        assert_eq!((0..1000).map(|_| noise.counts()).max(), Some(0));
        noise.set(50.0);
        let counts: Vec<i16> = (0..100_000).map(|_| noise.counts()).collect();
        let (plus, minus) = (counts.iter().filter(|c| **c > 0).count(), counts.iter().filter(|c| **c < 0).count());
        // 5000 expected, with a spread of 70
        assert!((4600..5400).contains(&(plus + minus)) && plus.abs_diff(minus) < 400, "{plus} {minus}");
    }
}
