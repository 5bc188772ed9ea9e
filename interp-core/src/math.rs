//! Integer functions that the rest is built on: roots, ratios, sine and angle in fixed point.
//!
//! None can panic or overflow: each states what it does at the ends of its domain. Angles are in radians with 60
//! fraction bits where a block is prepared (`angle_of`) and with 30 where a tick is played (`sine`).

/// One radian in the angles of [`sine`].
pub const RADIAN_Q30: i64 = 1 << 30;
/// A quarter turn in the angles of [`sine`].
pub const QUARTER_Q30: i64 = 1_686_629_713;
/// Half a turn in the angles of [`angle_of`].
pub const HALF_TURN_Q60: i64 = 3_622_009_729_038_561_421;

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

/// Sine of an angle of at most a quarter turn to either side (`-QUARTER_Q30..=QUARTER_Q30`, clamped), both with 30
/// fraction bits. Error below 6e-9, checked against the sine of `f64`.
///
/// Taylor's series as nested products, `x (1 - x^2/6 (1 - x^2/20 (1 - ...)))`, up to the thirteenth power, whose
/// remainder on a quarter turn is below 1e-9. Every factor fits 32 bits, so that a product is one instruction.
pub const fn sine(angle: i64) -> i64 {
    #[expect(clippy::cast_possible_truncation, reason = "a quarter turn is below 2^31")]
    let x = if angle > QUARTER_Q30 {
        QUARTER_Q30 as i32
    } else if angle < -QUARTER_Q30 {
        -QUARTER_Q30 as i32
    } else {
        angle as i32
    };
    // 29 fraction bits: 2.47 at most
    let x2 = product(x, x, 31);
    let mut nested = ONE_Q30;
    // up to 0.8 the last two terms are below 2.2e-9 together
    if x2 > EIGHT_TENTHS_SQUARED {
        nested = one_less(nested, x2, 6_882_960); // 2^30 / (12 * 13)
        nested = one_less(nested, x2, 9_761_289); // 2^30 / (10 * 11)
    }
    nested = one_less(nested, x2, 14_913_081); // 2^30 / (8 * 9)
    nested = one_less(nested, x2, 25_565_282); // 2^30 / (6 * 7)
    nested = one_less(nested, x2, 53_687_091); // 2^30 / (4 * 5)
    nested = one_less(nested, x2, 178_956_971); // 2^30 / (2 * 3)
    product(x, nested, 30) as i64
}

/// 0.8^2 with 29 fraction bits.
const EIGHT_TENTHS_SQUARED: i32 = 343_597_384;

/// One with 30 fraction bits.
const ONE_Q30: i32 = 1 << 30;

/// `a * b >> shift`, where that fits.
const fn product(a: i32, b: i32, shift: u32) -> i32 {
    #[expect(clippy::cast_possible_truncation, reason = "the caller knows that it fits")]
    let product = (a as i64).wrapping_mul(b as i64).wrapping_shr(shift) as i32;
    product
}

/// `1 - x2 * nested * ratio`; `x2` has 29 fraction bits, the others 30. `x2 * ratio` is below a half.
const fn one_less(nested: i32, x2: i32, ratio: i32) -> i32 {
    ONE_Q30.wrapping_sub(product(nested, product(x2, ratio, 29), 30))
}

/// Cosine of an angle whose sine (0 to 1, 30 fraction bits) is given, for angles up to a quarter turn.
pub const fn cosine_from_sine(sine: i64) -> i64 {
    let s = if sine > RADIAN_Q30 { RADIAN_Q30 } else { sine };
    let square = (1_i64 << 60).wrapping_sub(s.wrapping_mul(s));
    root(square.unsigned_abs()) as i64
}

/// Arc tangents of 2^-k with 60 fraction bits, k = 0..: atan(2^-k) = 2^-k (1 - 4^-k/3 + ...), listed because the
/// series needs division; past the end atan(y) = y to the last bit used.
const ARC_TANGENTS_Q60: [i64; 21] = [
    905_502_432_259_640_355,
    534_549_298_976_576_474,
    282_441_168_888_798_124,
    143_371_547_418_228_444,
    71_963_988_336_308_046,
    36_017_075_762_092_179,
    18_012_932_708_689_205,
    9_007_016_009_513_623,
    4_503_576_721_087_964,
    2_251_796_950_380_271,
    1_125_899_548_928_887,
    562_949_908_682_076,
    281_474_971_118_251,
    140_737_487_656_277,
    70_368_744_090_283,
    35_184_372_077_909,
    17_592_186_043_051,
    8_796_093_022_037,
    4_398_046_511_083,
    2_199_023_255_549,
    1_099_511_627_776,
];

/// Angle of the vector (`across`, `up`) from the `across` axis, in `-pi..=pi` with 60 fraction bits; 0 for the zero
/// vector. Error below 2^-50 for vectors longer than 2^60, which the caller gets by scaling up.
///
/// Volder's CORDIC in vectoring mode (IRE Transactions on Electronic Computers EC-8, 1959).
pub fn angle_of(across: i128, up: i128) -> i64 {
    let (mut x, mut y) = (across, up);
    if x == 0 && y == 0 {
        return 0;
    }
    // bring the longer component to about 2^100, so that shifting loses nothing that matters
    let longest = x.unsigned_abs().max(y.unsigned_abs());
    let lift = longest.leading_zeros().saturating_sub(28);
    x = x.wrapping_shl(lift);
    y = y.wrapping_shl(lift);
    let mut angle = 0_i64;
    if x < 0 {
        angle = if y >= 0 { HALF_TURN_Q60 } else { -HALF_TURN_Q60 };
        (x, y) = (x.wrapping_neg(), y.wrapping_neg());
    }
    let mut shift = 0_u32;
    while shift < 56 {
        let step = match ARC_TANGENTS_Q60.get(shift as usize) {
            Some(listed) => *listed,
            None => (1_i64 << 60).wrapping_shr(shift),
        };
        let (dx, dy) = (x.wrapping_shr(shift), y.wrapping_shr(shift));
        if y > 0 {
            (x, y) = (x.wrapping_add(dy), y.wrapping_sub(dx));
            angle = angle.wrapping_add(step);
        } else {
            (x, y) = (x.wrapping_sub(dy), y.wrapping_add(dx));
            angle = angle.wrapping_sub(step);
        }
        shift = shift.wrapping_add(1);
    }
    angle
}

#[cfg(test)]
#[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "oracles in f64")]
mod tests {
    use super::*;
    extern crate std;

    #[test]
    fn sine_agrees_with_f64_over_the_whole_domain() {
        let mut worst = 0.0_f64;
        for k in -20_000..=20_000_i64 {
            let angle = k * QUARTER_Q30 / 20_000;
            let exact = (angle as f64 / RADIAN_Q30 as f64).sin();
            worst = worst.max((sine(angle) as f64 / RADIAN_Q30 as f64 - exact).abs());
        }
        assert!(worst < 6e-9, "worst error {worst:e}");
    }

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
    fn cosine_completes_the_unit_circle() {
        for k in 0..=1000_i64 {
            let s = k * RADIAN_Q30 / 1000;
            let c = cosine_from_sine(s) as f64 / RADIAN_Q30 as f64;
            let exact = (1.0 - (k as f64 / 1000.0).powi(2)).sqrt();
            assert!((c - exact).abs() < 4e-5_f64.min(2e-9 / exact.max(1e-9) + 2e-9), "{k}: {c} {exact}");
        }
    }

    #[test]
    fn angle_agrees_with_f64_all_around() {
        for k in 0..3600_i32 {
            let turn = (f64::from(k) + 0.37) / 3600.0 * std::f64::consts::TAU - std::f64::consts::PI;
            let (x, y) = ((turn.cos() * 1e15) as i128, (turn.sin() * 1e15) as i128);
            let exact = (y as f64).atan2(x as f64);
            let found = angle_of(x, y) as f64 / (1_u64 << 60) as f64;
            assert!((found - exact).abs() < 1e-14, "{k}: {found} {exact}");
        }
        for (x, y, quarters) in [(1, 0, 0), (0, 1, 1), (-1, 0, 2), (0, -1, -1)] {
            let exact = HALF_TURN_Q60 / 2 * quarters;
            assert!((angle_of(x, y) - exact).abs() < 1 << 10);
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
