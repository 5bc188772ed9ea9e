//! The words of the diagnostics: the cause, then the numbers; and one sentence of advice.
//!
//! Words are quoted as the operator wrote them. Lengths that were computed are millimetres, also in inch programs.

use core::fmt::{self, Display, Formatter, Write as _};

use interp_core::units::{Axis, Feedrate};

use super::decimal::{Distance, fmt_millimetres};
use super::diagnostic::{DiagnosticKind, Remedy};
use super::settings::Format;
use super::word::Word;

/// Feed in millimetres a minute.
struct PerMinute(Feedrate);

impl Display for PerMinute {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        fmt_millimetres(self.0.nm_per_min(), f)
    }
}

/// Byte as two hexadecimal digits.
struct Hexadecimal(u8);

impl Display for Hexadecimal {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for nibble in [self.0 >> 4, self.0 & 0x0f] {
            f.write_char(char::from_digit(u32::from(nibble), 16).unwrap_or('0').to_ascii_uppercase())?;
        }
        Ok(())
    }
}

/// Whole number.
struct Count(u32);

impl Display for Count {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        fmt_millimetres(u64::from(self.0).saturating_mul(1_000_000), f)
    }
}

/// Upper-case letter of an axis.
const fn letter(axis: Axis) -> char {
    axis.letter().to_ascii_uppercase()
}

impl Display for DiagnosticKind {
    /// The cause.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        use DiagnosticKind as K;
        match *self {
            K::LineTooLong { bytes } => write!(f, "line of {} bytes", Count(bytes)),
            K::Byte(byte) => write!(f, "byte {} (hexadecimal) is no printable ASCII character", Hexadecimal(byte)),
            K::Character(c) => write!(f, "unexpected character {c}"),
            K::CommentOpen => f.write_str("comment without )"),
            K::TextAfterPercent => f.write_str("text behind %"),
            K::NumberAlone => f.write_str("number without a letter"),
            K::NumberMissing(letter) => write!(f, "{letter} without a number"),
            K::NumberMalformed(letter) => write!(f, "what follows {letter} is no number"),
            K::NumberTooLong(letter) => write!(f, "number of {letter} has more than 18 digits"),
            K::UnknownLetter { word, .. } => {
                write!(f, "{word}: letter {} is not supported", word.letter)
            }
            K::UnknownG { word, .. } | K::UnknownM(word) => write!(f, "{word} is not supported"),
            K::Repeated { first, second } => write!(f, "{first} and {second} in one block"),
            K::SameGroup { first, second } => {
                write!(f, "{first} and {second} in one block exclude each other")
            }
            K::BlockNumber(word) => write!(f, "{word} is no whole number from 0 to 99999999"),
            K::ProgramNumberPlace(word) => write!(f, "{word} is not the first word of its line"),
            K::ToolNumber(word) => write!(f, "{word} is no tool number"),
            K::SpindleSpeed(word) => write!(f, "{word} is no spindle speed from 0 to 100000"),
            K::FeedNotPositive(word) => write!(f, "{word} is no feed above zero"),
            K::FeedTooLow(word) => {
                write!(f, "{word} is below the slowest feed, {} mm/min", PerMinute(Feedrate::SLOWEST))
            }
            K::FeedTooHigh { word, limit_x, limit_z } => {
                let (x, z) = (PerMinute(limit_x), PerMinute(limit_z));
                write!(f, "{word} is above the fastest feed of both axes: X {x}, Z {z} mm/min")
            }
            K::FeedMissing(word) => write!(f, "{word} without a feed"),
            K::FeedPerTurnMissing(word) => write!(f, "{word} without a feed a turn, under G95"),
            K::LeadMissing(word) => write!(f, "{word} without a lead"),
            K::LeadNotPositive(word) => write!(f, "{word} is nothing above zero a turn"),
            K::LeadTooLarge(word) => write!(f, "{word} is above 500 mm a turn"),
            K::LeadTwice { x, z } => write!(f, "{x} and {z} with one thread"),
            K::LeadOfOtherAxis { word, axis } => {
                write!(f, "{word} is not along {}, which goes farther", letter(axis))
            }
            K::LeadWithG32(word) => write!(f, "{word} with G32 in one block"),
            K::FeedWithThread(word) => write!(f, "{word} while G33 is in force"),
            K::ThreadEmpty(word) => write!(f, "{word}: a thread without motion"),
            K::ThreadStart(word) => write!(f, "{word} is no whole number from 0 to 360000"),
            K::ThreadStartSmall(word) => write!(f, "{word} is less than a degree"),
            K::ThreadStartUnused(word) => write!(f, "{word} belongs to a thread, and this block has none"),
            K::DwellMissing => f.write_str("G4 without P"),
            K::DwellNegative(word) => write!(f, "{word} is a negative time"),
            K::DwellTooLong(word) => write!(f, "{word} is longer than 4294967.295 seconds"),
            K::DwellWithAxis(word) => write!(f, "{word} with G4 in one block"),
            K::DwellLong(word) => write!(f, "{word} dwells {} seconds", word.number),
            K::Coordinate { word, axis } => {
                write!(f, "{word} leads {} past 2100 mm from zero", letter(axis))
            }
            K::AbsoluteAndIncremental { absolute, incremental } => {
                write!(f, "{} with {} in one block", absolute.letter, incremental.letter)
            }
            K::EndMissing(word) => write!(f, "{word} without an end point"),
            K::MotionMissing(word) => write!(f, "{word} before any motion code"),
            K::ArcWordUnused(word) => {
                write!(f, "{word} belongs to an arc, and this block has none")
            }
            K::DwellWordUnused(word) => write!(f, "{word} belongs to G4 or G64, and this block has none"),
            K::ToleranceWithDwell(word) => write!(f, "{word} with G4 and G64 in one block"),
            K::ToleranceUnused { word, code } => write!(f, "{word} with {code} in one block"),
            K::ToleranceNegative(word) => write!(f, "{word} is a negative tolerance"),
            K::ToleranceTooLarge(word) => write!(f, "{word} is a tolerance above 1 mm"),
            K::ToleranceMissing(word) => write!(f, "{word} without P leaves corners as far as the feed needs"),
            K::CentreMissing => f.write_str("arc without a centre"),
            K::CentreAndRadius { centre, radius } => {
                write!(f, "{centre} with {radius} in one block")
            }
            K::FullCircleByRadius(word) => write!(f, "{word} cannot tell where a full circle lies"),
            K::RadiusZero => f.write_str("arc with radius zero"),
            K::RadiusTooLarge => f.write_str("arc with a radius above 4200 mm"),
            K::RadiiDiffer { start, end, tolerance } => {
                let tolerance = Distance::from(tolerance);
                write!(f, "start of the arc is {start} mm from the centre, its end {end} mm (tolerance {tolerance} mm)")
            }
            K::RadiusTooSmall { radius, half_chord } => {
                write!(f, "{radius} is too small: the ends are 2 x {half_chord} mm apart")
            }
            K::DecimalPoint(word) => write!(f, "{word} has a decimal point"),
            K::FeedCode(word) => write!(f, "{word} is no feed code"),
            K::FeedCodeUnset(word) => write!(f, "{word} has no feed"),
            K::ArcWordMissing(letter) => write!(f, "arc without {letter}"),
            K::Signed(word) => write!(f, "{word} has a sign"),
            K::NotOneQuadrant => f.write_str("no arc within one quadrant leads from this start to this end"),
            K::Empty => f.write_str("empty program"),
            K::EndCodeMissing => f.write_str("program without M2 or M30"),
        }
    }
}

/// What to write instead of a G code of other machines.
fn instead_of_g(word: Word, format: Format) -> &'static str {
    match (format, word.number.code()) {
        (Format::Nc1973, _) => "write G01, G02, G03 or G91",
        (Format::Gcode, Some(17 | 19)) => "delete it: a lathe works in G18",
        (Format::Gcode, Some(93 | 98)) => "write G94 and F in mm (G20: inch) a minute",
        (Format::Gcode, Some(99)) => "write G95 and F in mm (G20: inch) a turn",
        (Format::Gcode, Some(28 | 30)) => "write G0 with the end point",
        (Format::Gcode, Some(76 | 78 | 92)) => "write each pass with G0 and G33",
        (Format::Gcode, Some(40 | 54 | 80 | 97)) => "delete it: nothing else is ever in force",
        _ => "write one of G0 G1 G2 G3 G4 G7 G8 G18 G20 G21 G32 G33 G61 G61.1 G64 G90 G91 G94 G95",
    }
}

/// What to write instead of an M code of other machines.
fn instead_of_m(word: Word) -> &'static str {
    match word.number.code() {
        Some(6) => "delete it: T alone calls the tool",
        Some(7..=9) => "delete it: there is no coolant code",
        _ => "write one of M0 M1 M2 M3 M4 M5 M30",
    }
}

/// What to write instead of a letter that the format does not have.
fn instead_of_letter(word: Word, format: Format) -> &'static str {
    match (format, word.letter) {
        (Format::Nc1973, _) => "use the letters N G X Y I J F M",
        (Format::Gcode, 'Y' | 'J') => "delete it: a lathe moves X and Z",
        (Format::Gcode, 'E') => "write the number without an exponent",
        (Format::Gcode, _) => "use the letters N G F S M T X Z U W I K R P Q",
    }
}

impl Display for Remedy {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        use DiagnosticKind as K;
        f.write_str(match self.0 {
            K::LineTooLong { .. } => "write at most 256 bytes in a line",
            K::Byte(_) => "delete it, or move it into a comment",
            K::Character(_) => "delete it, or put the text in ( )",
            K::CommentOpen => "write ) at the end of the comment",
            K::TextAfterPercent => "write % alone on its line",
            K::NumberAlone => "write a letter before it, or delete the space inside the number",
            K::NumberMissing(letter) => {
                return write!(f, "write a number behind {letter}, or delete {letter}");
            }
            K::NumberMalformed(_) => "write digits with at most one sign before them and one decimal point",
            K::NumberTooLong(_) => "write at most 18 digits",
            K::UnknownLetter { word, format } => instead_of_letter(word, format),
            K::UnknownG { word, format } => instead_of_g(word, format),
            K::UnknownM(word) => instead_of_m(word),
            K::Repeated { .. } | K::SameGroup { .. } => "delete one of the two, or write two lines",
            K::BlockNumber(_) => "write a whole number of at most eight digits",
            K::ProgramNumberPlace(_) => "write O at the start of the line",
            K::ToolNumber(_) => "write T with the tool, or with two digits each for tool and offset (T0101)",
            K::SpindleSpeed(_) => "write S in turns a minute, and the direction with M3 or M4",
            K::FeedNotPositive(_) => "write F above zero, in mm (G20: inch) a minute",
            K::FeedTooLow(_) => {
                return write!(f, "write a feed of {} mm/min or more", PerMinute(Feedrate::SLOWEST));
            }
            K::FeedTooHigh { limit_x, limit_z, .. } => {
                return write!(f, "write a feed up to {} mm/min", PerMinute(limit_x.max(limit_z)));
            }
            K::FeedMissing(_) => "write F in this line or before it",
            K::FeedPerTurnMissing(_) => "write F in mm (G20: inch) a turn, or G94 with F a minute",
            K::LeadMissing(_) => "write the lead in mm (G20: inch) a turn: K (I along X) with G33, F with G32",
            K::LeadNotPositive(_) => "write it above zero, in mm (G20: inch) a turn",
            K::LeadTooLarge(_) => "write it in mm (G20: inch) a turn; F in mm a minute needs G94",
            K::LeadTwice { .. } => "write the lead of the axis that goes farther only: K, or I along X",
            K::LeadOfOtherAxis { axis: Axis::X, .. } => "write I with the lead along X, as a radius",
            K::LeadOfOtherAxis { axis: Axis::Z, .. } => "write K with the lead along Z",
            K::LeadWithG32(_) => "write F with the lead, or G33 in place of G32",
            K::FeedWithThread(_) => "write K with the lead, or G32 F; a feed with the next G1",
            K::ThreadEmpty(_) => "correct the end point, or delete the line",
            K::ThreadStart(_) => "write Q in thousandths of a degree, without a point: Q180000 is half a turn",
            K::ThreadStartSmall(_) => "write thousandths of a degree: Q180000 is half a turn",
            K::ThreadStartUnused(_) => "delete it, or write G33",
            K::DwellMissing => "write P with the time in seconds",
            K::DwellNegative(_) => "write P without a minus",
            K::DwellTooLong(_) => "write P in seconds, not in milliseconds",
            K::DwellWithAxis(_) => "write the motion on a line of its own; for a dwell write P in seconds",
            K::DwellLong(_) => "write P in seconds: P0.5 is half a second",
            K::Coordinate { .. } => "write a coordinate within 2100 mm",
            K::AbsoluteAndIncremental { absolute, incremental } => {
                let (absolute, incremental) = (absolute.letter, incremental.letter);
                return write!(f, "write {absolute} (absolute) or {incremental} (incremental), not both");
            }
            K::EndMissing(_) => "write the end point, even where it equals the start",
            K::MotionMissing(_) => "write G0, G1, G2, G3, G32 or G33 before it",
            K::ArcWordUnused(_) => "delete it, or write G2 or G3",
            K::DwellWordUnused(_) => "delete it, or write G4 or G64",
            K::ToleranceWithDwell(_) => "write two lines: P is seconds for G4 and a tolerance for G64",
            K::ToleranceUnused { .. } => "delete P, or write G64",
            K::ToleranceNegative(_) => "write P without a minus, or G61 for the exact path",
            K::ToleranceTooLarge(_) => "write P in mm (G20: inch), at most 1 mm",
            K::ToleranceMissing(_) => "write P with the tolerance in mm (G20: inch)",
            K::CentreMissing => "write I and K (from the start to the centre), or R",
            K::CentreAndRadius { .. } => "write I and K, or R, not both",
            K::FullCircleByRadius(_) => "write I and K instead of R",
            K::RadiusZero => "write R, or I and K with the way from the start to the centre, not all zero",
            K::RadiusTooLarge => "write a straight line, or a radius up to 4200 mm",
            K::RadiiDiffer { .. } => "correct the end or the centre until both radii agree",
            K::RadiusTooSmall { half_chord, .. } => {
                return write!(f, "write a radius of at least {half_chord} mm, or correct the end");
            }
            K::DecimalPoint(_) => "write a whole number of pulses of 0.01 mm",
            K::FeedCode(_) => "write F0 (rapid) or F1 to F9",
            K::FeedCodeUnset(word) => return write!(f, "set the feed of {word} in the settings"),
            K::ArcWordMissing(letter) => {
                return write!(f, "write {letter}, even where it is zero ({letter}0)");
            }
            K::Signed(_) => "write I and J without a sign",
            K::NotOneQuadrant => "write one block for each quadrant, and check G02 or G03",
            K::Empty => "write a program",
            K::EndCodeMissing => "write M30 on the last line",
        })
    }
}
