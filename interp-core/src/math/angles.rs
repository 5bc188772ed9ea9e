//! Sine, cosine and angle in fixed point. Angles are in radians with 60 fraction bits where a block is prepared ([`angle_of`]) and
//! with 30 where a tick is played ([`sine`]).

use super::root;

/// One radian in the angles of [`sine`].
pub const RADIAN_Q30: i64 = 1 << 30;
/// A quarter turn in the angles of [`sine`].
pub const QUARTER_Q30: i64 = 1_686_629_713;
/// Half a turn in the angles of [`angle_of`].
pub const HALF_TURN_Q60: i64 = 3_622_009_729_038_561_421;

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
}
