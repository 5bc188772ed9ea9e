//! What can be wrong with a program, where, and how bad it is. The texts are in [`message`](super::message).

use core::fmt;

use interp_core::units::{Axis, Feedrate, Length};

use super::decimal::Distance;
use super::settings::Format;
use super::word::{Span, Word};

/// How bad a [`Diagnostic`] is.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Severity {
    /// The line is refused: nothing of it is executed.
    Error,
    /// The line is executed; the operator should look at it.
    Warning,
}

/// What is wrong, with the words as written and the lengths that the operator needs.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum DiagnosticKind {
    /// The line has more than [`MAX_LINE`](super::MAX_LINE) bytes; it was not read.
    LineTooLong {
        /// Bytes of the line.
        bytes: u32,
    },
    /// Byte outside printable ASCII, outside a comment.
    Byte(u8),
    /// Printable character that begins nothing.
    Character(char),
    /// Comment without its closing parenthesis.
    CommentOpen,
    /// Something behind a `%`.
    TextAfterPercent,
    /// Number without a letter.
    NumberAlone,
    /// Letter without a number.
    NumberMissing(char),
    /// What follows the letter is no number.
    NumberMalformed(char),
    /// Number with more digits than are read.
    NumberTooLong(char),
    /// Letter that the format does not have.
    UnknownLetter {
        /// The word.
        word: Word,
        /// The format.
        format: Format,
    },
    /// G code that the format does not have.
    UnknownG {
        /// The word.
        word: Word,
        /// The format.
        format: Format,
    },
    /// M code that is not supported.
    UnknownM(Word),
    /// Letter twice in one line.
    Repeated {
        /// The one that was written first.
        first: Word,
        /// The other.
        second: Word,
    },
    /// Two codes that exclude each other.
    SameGroup {
        /// The one that was written first.
        first: Word,
        /// The other.
        second: Word,
    },
    /// N or O word that is not a whole number from 0 to 99 999 999.
    BlockNumber(Word),
    /// O word that is not the first of its line.
    ProgramNumberPlace(Word),
    /// T word that is not a whole number of one to four digits.
    ToolNumber(Word),
    /// S word below zero or above 100 000.
    SpindleSpeed(Word),
    /// F word that is zero, less, or rounds to zero.
    FeedNotPositive(Word),
    /// F word below [`Feedrate::SLOWEST`].
    FeedTooLow(Word),
    /// F word above the fastest feed of both axes.
    FeedTooHigh {
        /// The word.
        word: Word,
        /// Fastest feed of the cross slide.
        limit_x: Feedrate,
        /// Fastest feed of the carriage.
        limit_z: Feedrate,
    },
    /// Feed motion, and no F yet; the motion code, or the axis word.
    FeedMissing(Word),
    /// Feed motion under G95, and no F yet; the motion code, or the axis word.
    FeedPerTurnMissing(Word),
    /// Thread without a lead; the motion code, or the axis word.
    LeadMissing(Word),
    /// Lead, or F under G95, that is zero, less, or rounds to zero.
    LeadNotPositive(Word),
    /// Lead, or F under G95, above 500 mm.
    LeadTooLarge(Word),
    /// G33 with I and K.
    LeadTwice {
        /// I.
        x: Word,
        /// K.
        z: Word,
    },
    /// G33 with the lead of the axis that goes less far.
    LeadOfOtherAxis {
        /// I or K.
        word: Word,
        /// The axis that goes farther.
        axis: Axis,
    },
    /// G32 with I or K.
    LeadWithG32(Word),
    /// G33 with F.
    FeedWithThread(Word),
    /// Thread whose end is its start.
    ThreadEmpty(Word),
    /// Q that is no whole number of 0.001 degrees of a turn.
    ThreadStart(Word),
    /// Warning: Q below a degree: perhaps degrees were meant.
    ThreadStartSmall(Word),
    /// Q in a line that is no thread.
    ThreadStartUnused(Word),
    /// G4 without P.
    DwellMissing,
    /// P below zero.
    DwellNegative(Word),
    /// P above 4 294 967.295 s.
    DwellTooLong(Word),
    /// Axis word in a line with G4 and no motion code.
    DwellWithAxis(Word),
    /// Warning: a minute or more, written without a decimal point: perhaps milliseconds were meant.
    DwellLong(Word),
    /// Word that leads an axis past ±2.1 m.
    Coordinate {
        /// The word.
        word: Word,
        /// The axis.
        axis: Axis,
    },
    /// X with U, or Z with W.
    AbsoluteAndIncremental {
        /// X or Z.
        absolute: Word,
        /// U or W.
        incremental: Word,
    },
    /// Motion code, or words of an arc, without any axis word.
    EndMissing(Word),
    /// Axis word before any motion code.
    MotionMissing(Word),
    /// I, K or R in a line that is no arc.
    ArcWordUnused(Word),
    /// P in a line without G4 and G64.
    DwellWordUnused(Word),
    /// P with G4 and G64.
    ToleranceWithDwell(Word),
    /// P with G61 or G61.1.
    ToleranceUnused {
        /// P.
        word: Word,
        /// The code.
        code: Word,
    },
    /// P of G64 below zero.
    ToleranceNegative(Word),
    /// P of G64 above [`PathControl::LIMIT_NM`](super::PathControl::LIMIT_NM).
    ToleranceTooLarge(Word),
    /// Warning: G64 without P.
    ToleranceMissing(Word),
    /// Arc without I, K and R.
    CentreMissing,
    /// Arc with R and with I or K.
    CentreAndRadius {
        /// I or K.
        centre: Word,
        /// R.
        radius: Word,
    },
    /// Full circle with R: its centre may be anywhere around.
    FullCircleByRadius(Word),
    /// Arc of no radius.
    RadiusZero,
    /// Arc with a radius above 4.2 m.
    RadiusTooLarge,
    /// Start and end are not equally far from the centre.
    RadiiDiffer {
        /// From the centre to the start.
        start: Distance,
        /// From the centre to the end.
        end: Distance,
        /// By how much they may differ.
        tolerance: Length,
    },
    /// The ends are further apart than twice R.
    RadiusTooSmall {
        /// R.
        radius: Word,
        /// Half the distance of the ends.
        half_chord: Distance,
    },
    /// 1973: number with a decimal point.
    DecimalPoint(Word),
    /// 1973: F other than F0 to F9.
    FeedCode(Word),
    /// 1973: F code that has no feed.
    FeedCodeUnset(Word),
    /// 1973: arc without one of X, Y, I, J.
    ArcWordMissing(char),
    /// 1973: I or J with a minus.
    Signed(Word),
    /// 1973: no arc in one quadrant has these ends in this sense.
    NotOneQuadrant,
    /// The program has no words.
    Empty,
    /// Warning: neither M2 nor M30 ends the program.
    EndCodeMissing,
}

impl DiagnosticKind {
    /// How bad it is.
    pub const fn severity(self) -> Severity {
        match self {
            Self::DwellLong(_) | Self::ToleranceMissing(_) | Self::ThreadStartSmall(_) | Self::EndCodeMissing => {
                Severity::Warning
            }
            _ => Severity::Error,
        }
    }

    /// Letter of a word that was lost because its number cannot be read.
    pub(crate) const fn lost_letter(self) -> Option<char> {
        match self {
            Self::NumberMissing(letter) | Self::NumberMalformed(letter) | Self::NumberTooLong(letter) => Some(letter),
            _ => None,
        }
    }
}

/// One finding. Its `Display` is the cause; [`Diagnostic::remedy`] says what to do.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// From 1.
    pub line: u32,
    /// First character, from 1.
    pub column: u32,
    /// Characters; zero when the place is the end of the program.
    pub length: u32,
    /// What is wrong.
    pub kind: DiagnosticKind,
}

impl Diagnostic {
    /// One imperative sentence.
    ///
    /// ```
    /// # extern crate std;
    /// # use std::string::ToString;
    /// # use feature_editor::codes::{Diagnostic, DiagnosticKind};
    /// let found = Diagnostic { line: 3, column: 7, length: 1, kind: DiagnosticKind::NumberMissing('X') };
    /// assert_eq!(found.to_string(), "X without a number");
    /// assert_eq!(found.remedy().to_string(), "write a number behind X, or delete X");
    /// ```
    pub const fn remedy(&self) -> Remedy {
        Remedy(self.kind)
    }

    /// How bad it is.
    pub const fn severity(&self) -> Severity {
        self.kind.severity()
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.kind.fmt(f)
    }
}

/// What to do about a finding; shown with `Display`.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Remedy(pub(crate) DiagnosticKind);

/// Collects the findings of one line.
pub(crate) struct Report<'a, F> {
    line: u32,
    refused: bool,
    sink: &'a mut F,
}

impl<'a, F: FnMut(Diagnostic)> Report<'a, F> {
    pub(crate) const fn new(line: u32, sink: &'a mut F) -> Self {
        Self { line, refused: false, sink }
    }

    /// Passes a finding on.
    pub(crate) fn tell(&mut self, span: Span, kind: DiagnosticKind) {
        self.refused |= matches!(kind.severity(), Severity::Error);
        (self.sink)(Diagnostic { line: self.line, column: span.column, length: span.length, kind });
    }

    /// Whether an error was told.
    pub(crate) const fn is_refused(&self) -> bool {
        self.refused
    }
}
