//! Tells the 1973 format from G-code.

use super::MAX_LINE;
use super::settings::Format;
use super::word::Lexer;

/// Looks at a program's lines before it is read.
///
/// It is the 1973 format when a Y or J word occurs and no word at all has a decimal point. Lines that are refused in
/// both formats do not count.
///
/// ```
/// # use feature_editor::codes::{Detector, Format};
/// let mut detector = Detector::new();
/// detector.line(b"N04 G02 X+2000 Y0 I0 J2000");
/// assert_eq!(detector.format(), Format::Nc1973);
/// detector.line(b"G1 X10.5 F100");
/// assert_eq!(detector.format(), Format::Gcode);
/// ```
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Detector {
    has_letter: bool,
    has_point: bool,
}

impl Detector {
    /// Has seen nothing: G-code.
    pub const fn new() -> Self {
        Self { has_letter: false, has_point: false }
    }

    /// Looks at one line, without its terminator.
    pub fn line(&mut self, text: &[u8]) {
        if text.len() > MAX_LINE {
            return;
        }
        for placed in Lexer::new(text).filter_map(Result::ok) {
            self.has_letter |= matches!(placed.word.letter, 'Y' | 'J');
            self.has_point |= placed.word.number.has_point();
        }
    }

    /// The format, as far as seen.
    pub const fn format(&self) -> Format {
        if self.has_letter && !self.has_point { Format::Nc1973 } else { Format::Gcode }
    }
}
