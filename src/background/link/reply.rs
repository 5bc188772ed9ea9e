//! What the link writes: lines that senders understand, and none that they mistake for another.

use core::fmt::{self, Write};

use interp_core::math::divided_wide;
use interp_core::units::{Length, PulseSize};

/// Writes a line.
pub(super) fn line(out: &mut impl Write, text: fmt::Arguments<'_>) -> fmt::Result {
    out.write_fmt(text)?;
    out.write_str("\r\n")
}

/// Writes a message: text for people, which no sender may take for an answer.
pub(super) fn message(out: &mut impl Write, text: fmt::Arguments<'_>) -> fmt::Result {
    out.write_str("[MSG:")?;
    Harmless { out, last: [' '; 4] }.write_fmt(text)?;
    out.write_str("]\r\n")
}

/// Lets no text through in which a sender would find an answer: it breaks up the words that senders look for anywhere
/// in a line, in whatever case.
struct Harmless<'o, W> {
    out: &'o mut W,
    /// The last four characters, lower case.
    last: [char; 4],
}

impl<W: Write> Write for Harmless<'_, W> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for c in text.chars() {
            let lower = c.to_ascii_lowercase();
            let [a, b, c3, d] = self.last;
            let is_trap = matches!(
                ([a, b, c3, d], lower),
                ([_, _, _, 'o'], 'k') | (['e', 'r', 'r', 'o'], 'r') | (['a', 'l', 'a', 'r'], 'm')
            );
            let shown = if is_trap || c.is_control() { '_' } else { c };
            self.last = [b, c3, d, shown.to_ascii_lowercase()];
            self.out.write_char(shown)?;
        }
        Ok(())
    }
}

/// A number of thousandths, with three decimals.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) struct Thousandths(pub(super) i64);

impl fmt::Display for Thousandths {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = if self.0 < 0 { "-" } else { "" };
        let magnitude = self.0.unsigned_abs();
        write!(f, "{sign}{}.{:03}", magnitude / 1_000, magnitude % 1_000)
    }
}

/// `value * numerator / denominator`, rounded to nearest, half away from zero.
pub(super) fn scaled(value: i64, numerator: u64, denominator: u64) -> i64 {
    let twice = (value.unsigned_abs() as u128).saturating_mul(numerator as u128).saturating_mul(2);
    let half = denominator as u128;
    let rounded = match divided_wide(twice.saturating_add(half), half.saturating_mul(2)) {
        Some((rounded, _)) if rounded <= i64::MAX as u128 => rounded,
        Some(_) | None => i64::MAX as u128,
    };
    #[expect(clippy::cast_possible_truncation, reason = "at most i64::MAX, checked above")]
    let magnitude = rounded as i64;
    if value < 0 { 0_i64.saturating_sub(magnitude) } else { magnitude }
}

/// Where `count` pulses lead, in thousandths of a millimetre.
pub(super) fn micrometres(pulse: PulseSize, count: i32) -> Thousandths {
    let (numerator, denominator) = (u64::from(pulse.numerator()), u64::from(pulse.denominator()));
    Thousandths(scaled(count.into(), numerator, denominator.saturating_mul(1_000)))
}

/// Where `count` pulses lead, to the nanometre; `None` past the range of a length.
///
/// [`PulseSize::nearest`] gives the count back: a pulse is 10 nm at least.
pub(super) fn length(pulse: PulseSize, count: i32) -> Option<Length> {
    Length::from_nm(scaled(count.into(), pulse.numerator().into(), pulse.denominator().into()))
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use std::string::{String, ToString};

    #[test]
    fn messages_hold_no_word_that_a_sender_looks_for() {
        let mut out = String::new();
        message(&mut out, format_args!("broken {} and ALA{}, O{}\r\n", "errOR", "RM", 'K')).unwrap();
        assert_eq!(out, "[MSG:bro_en errO_ and ALAR_, O___]\r\n");
    }

    #[test]
    fn positions_are_the_nearest_thousandth() {
        let shown = |n, d, count| micrometres(PulseSize::new(n, d).unwrap(), count).to_string();
        assert_eq!(shown(1250, 1, 3), "0.004"); // 3.75 um
        assert_eq!(shown(1250, 1, -3), "-0.004");
        assert_eq!(shown(1250, 1, -2), "-0.003"); // 2.5 um, half away from zero
        assert_eq!(shown(10, 1, -1), "0.000"); // no minus on zero
        assert_eq!(shown(15875, 8, 8_000), "15.875");
        assert_eq!(shown(2500, 1, -840_000), "-2100.000");
        assert_eq!(shown(1_000_000, 1, i32::MIN), "-2147483648.000");
    }

    #[test]
    fn a_length_leads_back_to_its_pulse() {
        for (n, d) in [(10, 1), (1250, 1), (15875, 8), (16_777_213, 4096), (41, 4)] {
            let pulse = PulseSize::new(n, d).unwrap();
            for count in (-20_000..20_000).step_by(7) {
                assert_eq!(pulse.nearest(length(pulse, count).unwrap()), count);
            }
        }
    }
}
