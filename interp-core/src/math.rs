//! Integer functions that the rest is built on: roots, ratios, sine and angle in fixed point.
//!
//! None can panic or overflow: each states what it does at the ends of its domain.

mod angles;

pub use angles::{HALF_TURN_Q60, QUARTER_Q30, RADIAN_Q30, angle_of, cosine_from_sine, sine};

/// Floor of the square root.
///
/// ```
/// # use interp_core::math::root;
/// assert_eq!((root(24), root(25), root(u64::MAX)), (4, 5, u32::MAX));
/// ```
///
/// Karatsuba's square root: the upper half's root and its remainder give the lower half by one division of 32 bits,
/// since half the divisor suffices; twice, from a table of 8 bits. Source: P. Zimmermann, Karatsuba Square Root, INRIA
/// RR-3805, 1999.
pub const fn root(value: u64) -> u32 {
    if value == 0 {
        return 0;
    }
    // an even shift that brings a one into the upper two bits, undone by half of it
    let shift = value.leading_zeros() & !1;
    let normal = value.wrapping_shl(shift);
    let upper = (normal >> 32) as u32;
    #[expect(clippy::cast_possible_truncation, reason = "the lower half")]
    let lower = normal as u32;
    let (high, rest) = half_root(upper);
    // the remainder is at most twice the root, so the dividend is below 2^33
    let dividend = (rest as u64) << 16 | (lower >> 16) as u64;
    #[expect(clippy::cast_possible_truncation, reason = "below 2^32")]
    let halved = (dividend >> 1) as u32;
    let half = match halved.checked_div(high) {
        Some(quotient) => quotient,
        None => 0,
    };
    // what is left fits 17 bits, so it may be computed modulo 2^32
    let left = (rest << 16 | lower >> 16).wrapping_sub(half.wrapping_mul(high) << 1);
    let left = (left as u64) << 16 | (lower & 0xFFFF) as u64;
    let root = (high << 16).wrapping_add(half);
    // one too many where the square of the lower half is not left
    let root = if left < (half as u64).wrapping_mul(half as u64) { root.wrapping_sub(1) } else { root };
    root.wrapping_shr(shift >> 1)
}

/// Root and remainder of 32 bits, the upper two not both 0.
const fn half_root(value: u32) -> (u32, u32) {
    let top = value >> 16;
    let high = first_root(top);
    let dividend = top.wrapping_sub(high.wrapping_mul(high)) << 8 | value >> 8 & 0xFF;
    let half = match dividend.checked_div(high << 1) {
        Some(quotient) => quotient,
        None => 0,
    };
    let left = dividend.wrapping_sub(half.wrapping_mul(high) << 1) << 8 | value & 0xFF;
    let root = (high << 8).wrapping_add(half);
    let square = half.wrapping_mul(half);
    if left < square {
        // the remainder grows by twice the smaller root and one
        let root = root.wrapping_sub(1);
        (root, left.wrapping_sub(square).wrapping_add(root << 1 | 1))
    } else {
        (root, left.wrapping_sub(square))
    }
}

/// Root of 16 bits, the upper two not both 0.
#[expect(clippy::indexing_slicing, reason = "a constant function has no `get`; the index is checked")]
const fn first_root(value: u32) -> u32 {
    let index = ((value >> 8) as usize).wrapping_sub(64);
    let root = if index < ROOTS.len() { ROOTS[index] as u32 } else { 255 };
    // the table knows the upper byte only
    let next = root.wrapping_add(1);
    if next.wrapping_mul(next) <= value { next } else { root }
}

/// Roots of 64 to 255, times 16, rounded down.
#[expect(clippy::indexing_slicing, clippy::cast_possible_truncation, reason = "constants: 192 roots below 256")]
const ROOTS: [u8; 192] = {
    let mut roots = [0; 192];
    let mut n = 0_u32;
    while n < 192 {
        roots[n as usize] = n.wrapping_add(64).wrapping_shl(8).isqrt() as u8;
        n = n.wrapping_add(1);
    }
    roots
};

/// Floor of the square root, wide.
pub const fn root_wide(value: u128) -> u64 {
    #[expect(clippy::cast_possible_truncation, reason = "the root of 128 bits has 64")]
    let root = value.isqrt() as u64;
    root
}

/// Arithmetic of 128 bits as calls: in the code each such product takes a hundred instructions and more, a quotient three
/// hundred, and where blocks are prepared space matters, not time.
pub trait Wide {
    /// The product modulo 2^128.
    #[must_use]
    fn times(self, other: Self) -> Self;
    /// The square, saturating.
    #[must_use]
    fn squared(self) -> Self;
    /// The quotient rounded down, for a positive divisor; `None` for 0.
    fn quotient(self, divisor: Self) -> Option<Self>
    where
        Self: Sized;
    /// What is left then.
    fn rest(self, divisor: Self) -> Option<Self>
    where
        Self: Sized;
    /// The quotient rounded toward zero; `None` for a divisor of 0.
    fn over(self, divisor: Self) -> Option<Self>
    where
        Self: Sized;
}

impl Wide for i128 {
    #[inline(never)]
    fn times(self, other: Self) -> Self {
        self.wrapping_mul(other)
    }

    #[inline(never)]
    fn squared(self) -> Self {
        self.saturating_mul(self)
    }

    #[inline(never)]
    fn quotient(self, divisor: Self) -> Option<Self> {
        self.checked_div_euclid(divisor)
    }

    #[inline(never)]
    fn rest(self, divisor: Self) -> Option<Self> {
        self.checked_rem_euclid(divisor)
    }

    #[inline(never)]
    fn over(self, divisor: Self) -> Option<Self> {
        self.checked_div(divisor)
    }
}

/// Quotient and remainder of 128 bits without sign, as a call like those of [`Wide`]; `None` for a divisor of 0.
#[inline(never)]
pub fn divided_wide(dividend: u128, divisor: u128) -> Option<(u128, u128)> {
    let quotient = dividend.checked_div(divisor)?;
    Some((quotient, dividend.wrapping_sub(quotient.wrapping_mul(divisor))))
}

/// `value * numerator / denominator` rounded to nearest, half toward plus infinity; saturates, and 0 where the
/// denominator is not positive.
pub const fn scale(value: i128, numerator: i128, denominator: i128) -> i128 {
    let product = value.saturating_mul(numerator);
    let half = denominator >> 1;
    match product.saturating_add(half).checked_div_euclid(denominator) {
        Some(quotient) if denominator > 0 => quotient,
        _ => 0,
    }
}

/// So many percent of a speed or another number, rounded down; saturates. Without a division of 64 bits.
pub fn percent(of: u32, percent: u16) -> u32 {
    let percent = u32::from(percent);
    let (hundreds, rest) = (of / 100, of % 100);
    let part = rest.wrapping_mul(percent) / 100;
    to_u32(u64::from(hundreds).wrapping_mul(percent.into()).wrapping_add(part.into()))
}

/// Quotient and remainder; the divisor is not zero.
#[inline]
pub(crate) const fn divided(dividend: u32, divisor: u32) -> (u32, u32) {
    match dividend.checked_div(divisor) {
        Some(quotient) => (quotient, dividend.wrapping_sub(quotient.wrapping_mul(divisor))),
        None => (u32::MAX, 0),
    }
}

/// `value >> bits` for `bits` from 0 to 31, in place: the compiler calls a function for shifts of 64 bits where it minds
/// space.
#[inline(always)]
pub(crate) const fn shifted(value: u64, bits: u32) -> u64 {
    #[expect(clippy::cast_possible_truncation, reason = "the halves")]
    let (high, low) = ((value >> 32) as u32, value as u32);
    // what comes down from the upper half; nothing where `bits` is 0
    let down = (high << 1).wrapping_shl(31_u32.wrapping_sub(bits));
    (high.wrapping_shr(bits) as u64) << 32 | (low.wrapping_shr(bits) | down) as u64
}

/// The same with the sign kept.
#[inline(always)]
pub(crate) const fn shifted_signed(value: i64, bits: u32) -> i64 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the halves")]
    let (high, low) = ((value >> 32) as i32, value as u32);
    let down = (high << 1).cast_unsigned().wrapping_shl(31_u32.wrapping_sub(bits));
    (high.wrapping_shr(bits) as i64) << 32 | (low.wrapping_shr(bits) | down) as i64
}

/// Saturating conversion.
pub const fn to_i64(value: i128) -> i64 {
    #[expect(clippy::cast_possible_truncation, reason = "clamped to the range")]
    if value > i64::MAX as i128 {
        i64::MAX
    } else if value < i64::MIN as i128 {
        i64::MIN
    } else {
        value as i64
    }
}

/// Saturating conversion; negative values become 0.
pub const fn to_u64(value: i128) -> u64 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the range")]
    if value > u64::MAX as i128 {
        u64::MAX
    } else if value < 0 {
        0
    } else {
        value as u64
    }
}

/// Saturating conversion.
pub const fn to_u32(value: u64) -> u32 {
    #[expect(clippy::cast_possible_truncation, reason = "clamped to the range")]
    if value > u32::MAX as u64 { u32::MAX } else { value as u32 }
}

/// Saturating conversion.
pub const fn to_i32(value: i64) -> i32 {
    #[expect(clippy::cast_possible_truncation, reason = "clamped to the range")]
    if value > i32::MAX as i64 {
        i32::MAX
    } else if value < i32::MIN as i64 {
        i32::MIN
    } else {
        value as i32
    }
}

#[cfg(test)]
#[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "oracles in f64")]
mod tests {
    use super::*;
    extern crate std;

    /// All small values, and every square of 32 bits that a step of 9973 meets, with its neighbours.
    #[test]
    fn root_is_the_floor_of_the_square_root() {
        for value in 0..100_000 {
            assert_eq!(u64::from(root(value)), value.isqrt(), "{value}");
        }
        for side in (1..=u64::from(u32::MAX)).step_by(9973).chain([u64::from(u32::MAX)]) {
            for value in [side * side - 1, side * side, side * side + side, side * side + 2 * side] {
                assert_eq!(u64::from(root(value)), value.isqrt(), "{value}");
            }
        }
    }

    proptest::proptest! {
        #[test]
        fn root_agrees_with_the_standard_library(value: u64, cut in 0_u32..64) {
            proptest::prop_assert_eq!(u64::from(root(value >> cut)), (value >> cut).isqrt());
        }
    }

    #[test]
    fn scale_rounds_half_up_and_never_wraps() {
        for value in -50..=50_i128 {
            for denominator in 1..=12_i128 {
                let doubled = 2 * value * 3 + denominator;
                assert_eq!(scale(value, 3, denominator), doubled.div_euclid(2 * denominator));
            }
        }
        assert_eq!(scale(i128::MAX, 2, 1), i128::MAX);
        assert_eq!(scale(1, 1, 0), 0);
    }
    #[test]
    fn shifts_in_place_are_shifts() {
        for value in
            [0, 1, 0x8000_0000, 0xFFFF_FFFF, 0x1_0000_0000, 0x1234_5678_9ABC_DEF0, 0xFEDC_BA98_7654_3210, u64::MAX]
        {
            for bits in 0..32 {
                assert_eq!(shifted(value, bits), value >> bits);
                assert_eq!(shifted_signed(value.cast_signed(), bits), value.cast_signed() >> bits);
            }
        }
    }

    #[test]
    fn percents_are_rounded_down_and_saturate() {
        for of in (0..2_000).chain([99_999, 1 << 20, u32::MAX / 2, u32::MAX - 99, u32::MAX]) {
            for part in [0, 1, 33, 99, 100, 101, 150, 200, u16::MAX] {
                let exact = u64::from(of) * u64::from(part) / 100;
                assert_eq!(u64::from(percent(of, part)), exact.min(u32::MAX.into()));
            }
        }
    }
}
