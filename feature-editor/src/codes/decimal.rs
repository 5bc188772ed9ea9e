//! Decimal numbers of a program word, exact.
//!
//! A number is kept as it was written: sign, digits, point. Nothing is rounded until a unit is applied
//! ([`Number::scaled`]), and then once. What was written can be shown again digit by digit, so a message quotes the
//! operator's own word. [`Distance`] goes the other way: nanometres to shortest exact millimetres.

use core::fmt::{self, Write as _};

use interp_core::math::divided_wide;
use interp_core::units::Length;

/// Sign as written.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Sign {
    None,
    Plus,
    Minus,
}

/// Decimal number as written: optional sign, digits with at most one point among them, no exponent.
///
/// Up to 18 significant digits, of which up to 18 behind the point; zeros in front do not count.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Number {
    sign: Sign,
    /// All digits read as one integer, below 10^18.
    mantissa: u64,
    /// Digits before the point, zeros included.
    integer_digits: u8,
    /// Digits behind the point, at most 18.
    decimals: u8,
    point: bool,
}

/// Why a text is no [`Number`].
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum NumberError {
    /// There is no text.
    Missing,
    /// Something else than a sign, digits and one point; or no digit.
    Malformed,
    /// More than 18 significant digits, or more than 18 behind the point.
    TooLong,
}

impl Number {
    /// Most significant digits, and most digits behind the point.
    pub const MAX_DIGITS: u8 = 18;

    /// Reads a whole text, without spaces.
    ///
    /// ```
    /// # use feature_editor::codes::{Number, NumberError};
    /// assert_eq!(Number::parse(b"-.5").unwrap().scaled(1_000_000), Some(-500_000));
    /// assert_eq!(Number::parse(b"1.2.3"), Err(NumberError::Malformed));
    /// ```
    ///
    /// # Errors
    /// See [`NumberError`].
    pub fn parse(text: &[u8]) -> Result<Self, NumberError> {
        let (sign, digits) = match text {
            [] => return Err(NumberError::Missing),
            [b'+', rest @ ..] => (Sign::Plus, rest),
            [b'-', rest @ ..] => (Sign::Minus, rest),
            _ => (Sign::None, text),
        };
        let mut number = Self { sign, mantissa: 0, integer_digits: 0, decimals: 0, point: false };
        let mut too_long = false;
        for &byte in digits {
            match byte {
                b'0'..=b'9' => too_long |= !number.push(byte & 0x0f),
                b'.' if !number.point => number.point = true,
                _ => return Err(NumberError::Malformed),
            }
        }
        if number.integer_digits == 0 && number.decimals == 0 {
            Err(NumberError::Malformed)
        } else if too_long {
            Err(NumberError::TooLong)
        } else {
            Ok(number)
        }
    }

    /// Appends a digit, 0 to 9. False when it does not fit; the value is then meaningless.
    fn push(&mut self, digit: u8) -> bool {
        let count = if self.point { &mut self.decimals } else { &mut self.integer_digits };
        let counted = count.checked_add(1);
        *count = counted.unwrap_or(u8::MAX);
        self.mantissa = self.mantissa.saturating_mul(10).saturating_add(u64::from(digit));
        counted.is_some() && self.mantissa < 1_000_000_000_000_000_000 && self.decimals <= Self::MAX_DIGITS
    }

    /// Whether a minus was written, be it before a zero.
    pub const fn is_negative(self) -> bool {
        matches!(self.sign, Sign::Minus)
    }

    /// Whether the value is zero.
    pub const fn is_zero(self) -> bool {
        self.mantissa == 0
    }

    /// Whether a decimal point was written.
    pub const fn has_point(self) -> bool {
        self.point
    }

    /// Digits before the point, zeros in front included.
    pub const fn integer_digits(self) -> u8 {
        self.integer_digits
    }

    /// The value as a code number: whole (`1`, `01`, `1.0`), without a minus, within 32 bits; else `None`.
    pub fn code(self) -> Option<u32> {
        let one = 10_u64.checked_pow(u32::from(self.decimals))?;
        let whole = self.mantissa.checked_div(one)?;
        let rest = self.mantissa.checked_rem(one)?;
        if self.is_negative() || rest != 0 { None } else { u32::try_from(whole).ok() }
    }

    /// The value as a code number with at most one decimal, in tenths (`61.1` is 611); else `None`.
    pub fn code_tenths(self) -> Option<u32> {
        let one = 10_u64.checked_pow(u32::from(self.decimals))?;
        let tenfold = self.mantissa.checked_mul(10)?;
        let rest = tenfold.checked_rem(one)?;
        if self.is_negative() || rest != 0 { None } else { u32::try_from(tenfold.checked_div(one)?).ok() }
    }

    /// The value times `unit`, rounded once: half away from zero. `None` past 64 bits.
    ///
    /// * `unit`: how many of the wanted unit one written unit holds, e.g. 1 000 000 nm for 1 mm, 25 400 000 for 1 in.
    ///
    /// ```
    /// # use feature_editor::codes::Number;
    /// assert_eq!(Number::parse(b"0.0000005").unwrap().scaled(1_000_000), Some(1)); // half a nanometre
    /// assert_eq!(Number::parse(b"-1").unwrap().scaled(25_400_000), Some(-25_400_000));
    /// ```
    pub fn scaled(self, unit: u32) -> Option<i64> {
        let one = u128::from(10_u64.checked_pow(u32::from(self.decimals))?);
        let twice = u128::from(self.mantissa).checked_mul(u128::from(unit))?.checked_mul(2)?;
        let (magnitude, _) = divided_wide(twice.checked_add(one)?, one.checked_mul(2)?)?;
        let magnitude = i64::try_from(magnitude).ok()?;
        if self.is_negative() { magnitude.checked_neg() } else { Some(magnitude) }
    }
}

/// Digit of `value` at the decimal place `place` (0 is the ones), as a character.
fn digit(value: u64, place: u8) -> char {
    let shifted = 10_u64.checked_pow(u32::from(place)).and_then(|power| value.checked_div(power)).unwrap_or(0);
    match shifted % 10 {
        0 => '0',
        1 => '1',
        2 => '2',
        3 => '3',
        4 => '4',
        5 => '5',
        6 => '6',
        7 => '7',
        8 => '8',
        _ => '9',
    }
}

impl fmt::Display for Number {
    /// As written.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.sign {
            Sign::None => {}
            Sign::Plus => f.write_char('+')?,
            Sign::Minus => f.write_char('-')?,
        }
        let mut place = u16::from(self.integer_digits).saturating_add(u16::from(self.decimals));
        while place > u16::from(self.decimals) {
            place = place.saturating_sub(1);
            // a place past 255 can only hold a zero
            f.write_char(u8::try_from(place).map_or('0', |place| digit(self.mantissa, place)))?;
        }
        if self.point {
            f.write_char('.')?;
        }
        let mut place = self.decimals;
        while place > 0 {
            place = place.saturating_sub(1);
            f.write_char(digit(self.mantissa, place))?;
        }
        Ok(())
    }
}

/// Length without the ±2.1 m of [`Length`], in nanometres: centres and radii of arcs.
///
/// Its `Display` is exact millimetres with as few digits as possible.
///
/// ```
/// # extern crate std;
/// # use std::string::ToString;
/// # use feature_editor::codes::Distance;
/// assert_eq!(Distance::from_nm(-20_050_000).to_string(), "-20.05");
/// ```
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Distance(i64);

impl Distance {
    /// From nanometres, any value.
    pub const fn from_nm(nm: i64) -> Self {
        Self(nm)
    }

    /// Nanometres.
    pub const fn nm(self) -> i64 {
        self.0
    }
}

impl From<Length> for Distance {
    fn from(length: Length) -> Self {
        Self(i64::from(length.nm()))
    }
}

impl fmt::Display for Distance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0 < 0 {
            f.write_char('-')?;
        }
        fmt_millimetres(self.0.unsigned_abs(), f)
    }
}

/// Writes nanometres as millimetres, exact, without zeros at the end.
pub(crate) fn fmt_millimetres(nm: u64, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let mut place = 19; // 2^64 has 20 digits
    let mut leading = true;
    while place > 6 {
        let c = digit(nm, place);
        leading = leading && c == '0';
        if !leading {
            f.write_char(c)?;
        }
        place = place.saturating_sub(1);
    }
    f.write_char(digit(nm, 6))?;
    let mut rest = nm % 1_000_000;
    if rest != 0 {
        f.write_char('.')?;
    }
    while rest != 0 {
        f.write_char(digit(rest, 5))?;
        rest = (rest % 100_000).saturating_mul(10);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::format;
    use std::string::{String, ToString};

    /// Oracle on the text: shift the point by six, cut, round up on a 5 or more behind the cut.
    fn nm_of_text(digits: &str, decimals: usize) -> i64 {
        let padded = format!("{digits}{}", "0".repeat(9));
        let cut = digits.len() - decimals + 6;
        let whole: i64 = padded[..cut].parse().unwrap();
        whole + i64::from(padded.as_bytes()[cut] >= b'5')
    }

    #[test]
    fn millimetres_agree_with_cutting_the_text() {
        for decimals in 0..=8_usize {
            for value in 0..20_000_u32 {
                let digits = format!("{value:09}");
                let (whole, part) = digits.split_at(9 - decimals);
                let text = if decimals == 0 { String::from(whole) } else { format!("{whole}.{part}") };
                let nm = nm_of_text(&digits, decimals);
                assert_eq!(Number::parse(text.as_bytes()).unwrap().scaled(1_000_000), Some(nm), "{text}");
                let minus = Number::parse(format!("-{text}").as_bytes()).unwrap();
                assert_eq!(minus.scaled(1_000_000), Some(-nm), "-{text}");
            }
        }
    }

    #[test]
    fn inches_are_the_nearest_nanometre_half_away_from_zero() {
        for decimals in 0..=9_u32 {
            let one = 10_i128.pow(decimals);
            for mantissa in (0..40_000_i128).step_by(3) {
                let text = format!("{}.{:0width$}", mantissa / one, mantissa % one, width = decimals as usize);
                let text = text.trim_end_matches(|c| decimals == 0 && c == '0'); // "7.0" -> "7."
                let nm = Number::parse(text.as_bytes()).unwrap().scaled(25_400_000).unwrap();
                let error = 2 * (i128::from(nm) * one - mantissa * 25_400_000);
                assert!(-one < error && error <= one, "{text} -> {nm}");
            }
        }
    }

    #[test]
    fn shows_what_was_written() {
        for text in ["0", "-0", "+5000", "007.50", ".5", "-.5", "5.", "999999999999999999", "0.000000000000000001"] {
            assert_eq!(Number::parse(text.as_bytes()).unwrap().to_string(), text);
        }
    }

    #[test]
    fn refuses_what_is_no_number() {
        assert_eq!(Number::parse(b""), Err(NumberError::Missing));
        for text in ["+", "-", ".", "-.", "--1", "1-", "1.2.3", "1e5", "#1", "[1]", " 1", "1 ", "1,5"] {
            assert_eq!(Number::parse(text.as_bytes()), Err(NumberError::Malformed), "{text}");
        }
        assert_eq!(Number::parse(b"1000000000000000000"), Err(NumberError::TooLong));
        assert_eq!(Number::parse(b"0.0000000000000000001"), Err(NumberError::TooLong));
        assert_eq!(Number::parse(&[b'0'; 256]), Err(NumberError::TooLong));
        assert_eq!(Number::parse(&[b'9'; 256]), Err(NumberError::TooLong));
    }

    #[test]
    fn code_numbers_are_whole() {
        let code = |text: &str| Number::parse(text.as_bytes()).unwrap().code();
        assert_eq!([code("1"), code("01"), code("1.0"), code("+1.")], [Some(1); 4]);
        assert_eq!([code("38.2"), code("-1"), code("-0"), code("4294967296")], [None; 4]);
        let tenths = |text: &str| Number::parse(text.as_bytes()).unwrap().code_tenths();
        assert_eq!(
            [tenths("61.1"), tenths("61.10"), tenths("61"), tenths("0.5")],
            [Some(611), Some(611), Some(610), Some(5)]
        );
        assert_eq!([tenths("61.11"), tenths("-61.1"), tenths("999999999999999999")], [None; 3]);
    }

    #[test]
    fn distances_show_shortest_millimetres() {
        for (nm, text) in [
            (0, "0"),
            (1, "0.000001"),
            (-1_000_000, "-1"),
            (20_050_000, "20.05"),
            (123_456_789_012, "123456.789012"),
            (i64::MIN, "-9223372036854.775808"),
        ] {
            assert_eq!(Distance::from_nm(nm).to_string(), text);
        }
    }
}
