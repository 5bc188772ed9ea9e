//! A fixed ratio that lengths are multiplied by, prepared so that the foreground needs one 32-bit product.

use crate::math::{divided_wide, shifted, to_u32, to_u64};

/// `length * factor`, the factor as a 31-bit mantissa: relative error below 2^-30.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Proportion {
    factor: u32,
    /// Bits cut off the length so that it fits 32.
    before: u8,
    /// Bits cut off the product.
    after: u8,
}

impl Proportion {
    /// The ratio `numerator / denominator` for lengths up to `longest`, below 2^63. The ratio must be below 2^30, else it
    /// saturates; a zero denominator makes the ratio zero.
    pub fn new(numerator: u64, denominator: u64, longest: u64) -> Self {
        let before = 64_u32.wrapping_sub(longest.leading_zeros()).saturating_sub(32);
        let top = u128::from(numerator).wrapping_shl(before);
        // factor = numerator * 2^(before + after) / denominator in 2^30..2^31
        let mut after = 0_u32;
        let bits = |v: u128| 128_u32.wrapping_sub(v.leading_zeros());
        let short = 31_u32.wrapping_add(bits(u128::from(denominator))).saturating_sub(bits(top));
        if short > 0 {
            after = short.min(62);
        }
        let factor = match divided_wide(top.wrapping_shl(after), u128::from(denominator)) {
            Some((quotient, _)) => to_u32(to_u64(i128::try_from(quotient).unwrap_or(i128::MAX))),
            None => 0,
        };
        let byte = |v: u32| u8::try_from(v).unwrap_or(0);
        Self { factor, before: byte(before), after: byte(after) }
    }

    /// The product, rounded down.
    #[inline]
    pub fn of(self, length: u64) -> u64 {
        let (before, after) = (u32::from(self.before), u32::from(self.after));
        let product = u64::from(to_u32(shifted(length, before))).wrapping_mul(u64::from(self.factor));
        if after < 32 { shifted(product, after) } else { u64::from(to_u32(product >> 32).wrapping_shr(after)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn products_are_within_a_billionth(
            numerator in 1_u64..1 << 46, denominator in 1_u64..1 << 46, longest in 1_u64..1 << 46, part in 0.0_f64..=1.0
        ) {
            prop_assume!(u128::from(numerator) < u128::from(denominator) << 20);
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss, reason = "a sample")]
            let length = (longest as f64 * part) as u64;
            let exact = u128::from(length) * u128::from(numerator) / u128::from(denominator);
            let found = u128::from(Proportion::new(numerator, denominator, longest).of(length));
            // one part in 2^29, one unit of the result, and what the bits cut off the length are worth
            let cut = u128::from(longest >> 31) * u128::from(numerator) / u128::from(denominator);
            let allowed = (exact >> 29) + 2 + cut;
            prop_assert!(found.abs_diff(exact) <= allowed, "{found} {exact} {allowed}");
        }
    }
}
