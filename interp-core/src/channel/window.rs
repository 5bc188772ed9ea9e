//! The window: the tool's advance as the weighted mean of the lead's last ticks.

use crate::law::{MAX_TICKS, Smoothing, WEIGHT_BITS};

/// The lead's last ticks and their weights.
#[derive(Clone, Debug)]
pub(super) struct Window {
    ticks: u8,
    /// Where the oldest length is.
    at: u8,
    /// What was left of the last mean, [`WEIGHT_BITS`] fraction bits.
    rest: u32,
    /// How far the lead is ahead of the tool, nm with 12 fraction bits.
    owed: u64,
    lengths: [u32; MAX_TICKS],
    /// From one end to the other; they are symmetric.
    weights: [u32; MAX_TICKS],
}

impl Window {
    /// For a law; empty.
    pub(super) fn new(smoothing: Smoothing) -> Self {
        let ticks = smoothing.ticks();
        let mut weights = [0; MAX_TICKS];
        for (place, count) in weights.iter_mut().zip(0..ticks) {
            *place = smoothing.weighed(count.wrapping_add(1)).wrapping_sub(smoothing.weighed(count));
        }
        Self { ticks, at: 0, rest: 0, owed: 0, lengths: [0; MAX_TICKS], weights }
    }

    /// Forgets what is under way.
    pub(super) const fn clear(&mut self) {
        self.rest = 0;
        self.owed = 0;
        self.lengths = [0; MAX_TICKS];
    }

    /// Ticks of the mean; 0 under the linear law, which needs no window.
    #[inline]
    pub(super) const fn ticks(&self) -> u8 {
        self.ticks
    }

    /// How far the lead is ahead of the tool, nm with 12 fraction bits.
    pub(super) const fn owed(&self) -> u64 {
        self.owed
    }

    /// The longest way of the lead in a tick that is under way.
    pub(super) fn longest(&self) -> u32 {
        self.lengths.iter().take(self.ticks.into()).copied().max().unwrap_or(0)
    }

    /// Whether the tool is where the lead is.
    pub(super) const fn is_drained(&self) -> bool {
        self.owed == 0
    }

    /// The lead advanced by `length` in this tick; gives the tool's advance. What a mean leaves over is carried, so over a whole
    /// motion both advance by the same length, exactly.
    pub(super) fn push(&mut self, length: u32) -> u64 {
        let (ticks, at) = (usize::from(self.ticks), usize::from(self.at));
        if let Some(oldest) = self.lengths.get_mut(at) {
            *oldest = length;
        }
        let next = at.wrapping_add(1);
        let next = if next >= ticks { 0 } else { next };
        #[expect(clippy::cast_possible_truncation, reason = "below MAX_TICKS")]
        {
            self.at = next as u8;
        }
        let late = self.lengths.get(..next).unwrap_or_default();
        let early = self.lengths.get(next..ticks).unwrap_or_default();
        let mut weights = self.weights.iter();
        let mut sum = u64::from(self.rest);
        for lengths in [early, late] {
            for (length, weight) in lengths.iter().zip(&mut weights) {
                // all lengths are below 2^32 and the weights' sum is 2^24
                sum = sum.wrapping_add(u64::from(*length).wrapping_mul(u64::from(*weight)));
            }
        }
        #[expect(clippy::cast_possible_truncation, reason = "the fraction")]
        {
            self.rest = sum as u32 & ((1 << WEIGHT_BITS) - 1);
        }
        let advance = sum >> WEIGHT_BITS;
        self.owed = self.owed.wrapping_add(u64::from(length)).wrapping_sub(advance);
        advance
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::SpeedLaw;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_tool_arrives_where_the_lead_is_after_the_window_and_not_before(
            lengths in prop::collection::vec(prop_oneof![Just(0), 0_u32..10, 0..u32::MAX], 1..200),
            sine: bool,
            jerk in 20_000_u32..500_000,
        ) {
            let law = if sine { SpeedLaw::Sine } else { SpeedLaw::Parabolic };
            let mut window = Window::new(Smoothing::new(law, 400 << 12, jerk).unwrap());
            let (mut lead, mut tool) = (0_u64, 0_u64);
            for length in lengths {
                lead += u64::from(length);
                tool += window.push(length);
                prop_assert!(tool <= lead);
                prop_assert_eq!(window.is_drained(), tool == lead);
            }
            for _ in 1..window.ticks() {
                tool += window.push(0);
            }
            prop_assert_eq!(tool, lead);
            prop_assert!(window.is_drained());
        }
    }
}
