//! Contacts that bounce.

use figures::{FigureError, Figures};

/// Numbers that look random and are the same in each run: `SplitMix64` (G. Steele, D. Lea, C. Flood, OOPSLA 2014).
#[derive(Clone, Debug)]
pub(crate) struct Dice(u64);

impl Dice {
    pub(crate) fn new(figures: &Figures) -> Result<Self, FigureError> {
        Ok(Self(u64::from(figures.whole("bounce.seed")?)))
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    /// Below `most`; 0 for a `most` of 0.
    fn below(&mut self, most: u64) -> u64 {
        self.next().checked_rem(most).unwrap_or(0)
    }
}

/// Times at which a contact changes that closes or opens at `start_ns`: the first is `start_ns`, there is an odd
/// number of them, so the last one leaves the new level, and it is before `start_ns + settle_ns`.
pub(crate) fn bounce(dice: &mut Dice, start_ns: u64, settle_ns: u64, bounces: u32) -> Vec<u64> {
    let mut times = vec![start_ns];
    let pairs = dice.below(u64::from(bounces) + 1);
    for _ in 0..2 * pairs {
        if settle_ns > 1 {
            times.push(start_ns + 1 + dice.below(settle_ns - 1));
        }
    }
    times.sort_unstable();
    // two changes at one time are none
    let mut distinct: Vec<u64> = Vec::with_capacity(times.len());
    for time in times {
        if distinct.last() == Some(&time) {
            distinct.pop();
        } else {
            distinct.push(time);
        }
    }
    distinct
}
