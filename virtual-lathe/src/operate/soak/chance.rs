//! Chance that is the same in every run of a seed.

/// Random numbers: `SplitMix64` (G. Steele, D. Lea, C. Flood, OOPSLA 2014).
#[derive(Clone, Debug)]
pub(super) struct Chance(u64);

impl Chance {
    /// Of a seed, and of what it is used for.
    pub(super) fn new(seed: u64, salt: u64) -> Self {
        let mut chance = Self(seed.wrapping_mul(0xD134_2543_DE82_EF95) ^ salt);
        let first = chance.bits();
        Self(first ^ salt.rotate_left(32))
    }

    /// 64 bits.
    pub(super) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    /// From 0 to 1.
    pub(super) fn part(&mut self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "53 bits")]
        let part = (self.bits() >> 11) as f64;
        part / 9_007_199_254_740_992.0
    }

    /// From `least` to `most`.
    pub(super) fn real(&mut self, least: f64, most: f64) -> f64 {
        least + self.part() * (most - least)
    }

    /// From `least` to `most`, small ones as likely as large ones; both more than 0.
    pub(super) fn spread(&mut self, least: f64, most: f64) -> f64 {
        (self.real(least.ln(), most.ln())).exp()
    }

    /// A whole number from `least` to `most`, both included.
    pub(super) fn whole(&mut self, least: i64, most: i64) -> i64 {
        let span = most.abs_diff(least).saturating_add(1);
        least.saturating_add_unsigned(self.bits() % span)
    }

    /// Once in so many times.
    pub(super) fn once_in(&mut self, times: u64) -> bool {
        self.bits().is_multiple_of(times)
    }

    /// Heads or tails.
    pub(super) fn coin(&mut self) -> bool {
        self.once_in(2)
    }

    /// One of a list that is not empty.
    pub(super) fn one_of<T: Copy>(&mut self, list: &[T]) -> T {
        let at = self.bits() % (list.len() as u64).max(1);
        #[expect(clippy::indexing_slicing, clippy::cast_possible_truncation, reason = "below the length")]
        list[at as usize]
    }
}
