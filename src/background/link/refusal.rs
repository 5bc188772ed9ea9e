//! Why a line was refused, and the number that senders know it by.
//!
//! The numbers are those of Grbl 1.1 (1 to 38) and of grblHAL (39 to 79) where one fits; the rest are ours, from 200.
//!
//! | number | why |
//! | --- | --- |
//! | 200 | the receive buffer was full: the sender did not wait |
//! | 201 | bytes were lost or garbled on the way |
//! | 202 | comment without its end |
//! | 203 | an O word that is not the first of its line |
//! | 204 | the tool is past 2.1 m from zero, where no program can start |
//! | 205 | the foreground refuses a request |
//! | 206 | a line of a program in a mode that runs none |

use core::fmt;

use feature_editor::codes::{DiagnosticKind, MAX_LINE};
use interp_core::config::ConfigError;

use super::requests::{Cause, Wrong};
use crate::background::compile::Finding;
use crate::background::parameters::ParameterError;
use crate::foreground::alarm::Alarm;
use crate::foreground::mode::Mode;
use crate::foreground::refusal as foreground;

/// Why a line was refused. A refusal changes nothing.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) enum Refusal {
    /// The program text.
    Program(Finding),
    /// More than [`MAX_LINE`] bytes.
    TooLong,
    /// Bytes were lost because the buffer was full; how many, ever.
    Overflow(u32),
    /// Bytes were lost or garbled.
    Damaged,
    /// An alarm locks the machine.
    Locked(Alarm),
    /// The cause of an alarm is still there.
    Lasting(Alarm),
    /// It needs an idle machine.
    NotIdle,
    /// No such `$` command.
    Command,
    /// `$H`.
    Homing,
    /// A parameter.
    Parameter(ParameterError),
    /// A number that is none.
    Number,
    /// Parameters that contradict each other.
    Machine(ConfigError),
    /// A parameter that only counts at power-on.
    PowerOn,
    /// The tool is past 2.1 m.
    Position,
    /// A request that is written wrong.
    Wrong(Wrong),
    /// Blocks wait, and the request would change what they lead to.
    Waiting,
    /// A request that the foreground refuses.
    Request(foreground::Refusal),
    /// A line of a program in this mode, which runs none.
    Mode(Mode),
}

impl Refusal {
    /// The number behind `error:`.
    pub(super) const fn number(&self) -> u8 {
        match self {
            Self::Program(Finding::Text(diagnostic)) => of_text(&diagnostic.kind),
            Self::Program(Finding::Thread { .. }) => 43,
            Self::Program(Finding::Arc { .. } | Finding::Limited { .. } | Finding::NoArcs { .. }) => 33,
            Self::TooLong => 11,
            Self::Overflow(_) => 200,
            Self::Damaged => 201,
            Self::NotIdle
            | Self::Waiting
            | Self::Request(
                foreground::Refusal::Moving | foreground::Refusal::CycleUnderWay | foreground::Refusal::Running,
            ) => 8,
            Self::Locked(_) | Self::Request(foreground::Refusal::Alarm(_)) => 9,
            Self::Wrong(Wrong { cause: Cause::Missing | Cause::Number(_), .. }) => 2,
            Self::Wrong(Wrong { cause: Cause::Range(_), .. }) => 52,
            Self::Wrong(Wrong { cause: Cause::Word(_) | Cause::More, .. }) => 3,
            Self::Request(_) => 205,
            Self::Mode(_) => 206,
            Self::Lasting(_) => 50,
            Self::Command | Self::Parameter(ParameterError::Unknown) => 3,
            Self::Homing => 5,
            Self::Number | Self::Parameter(ParameterError::Malformed(_)) => 2,
            Self::Parameter(ParameterError::Range(_)) | Self::Machine(_) => 52,
            Self::PowerOn => 53,
            Self::Position => 204,
        }
    }
}

/// The number of a finding in the text.
const fn of_text(kind: &DiagnosticKind) -> u8 {
    use DiagnosticKind as K;
    match kind {
        // letter expected
        K::Byte(_) | K::Character(_) | K::NumberAlone => 1,
        // bad number
        K::NumberMissing(_) | K::NumberMalformed(_) | K::NumberTooLong(_) => 2,
        // negative
        K::DwellNegative(_) | K::ToleranceNegative(_) | K::Signed(_) => 4,
        K::LineTooLong { .. } => 11,
        // zero or less
        K::FeedNotPositive(_) | K::LeadNotPositive(_) => 19,
        // unsupported
        K::UnknownLetter { .. } | K::UnknownG { .. } | K::UnknownM(_) => 20,
        // two of one modal group
        K::SameGroup { .. } => 21,
        // no feed
        K::FeedMissing(_) | K::FeedPerTurnMissing(_) | K::LeadMissing(_) | K::FeedCodeUnset(_) => 22,
        // whole number needed
        K::DecimalPoint(_) => 23,
        K::Repeated { .. } => 25,
        // no axis words
        K::EndMissing(_) | K::ThreadEmpty(_) => 26,
        // line number
        K::BlockNumber(_) => 27,
        // missing value
        K::DwellMissing => 28,
        // unused axis words
        K::DwellWithAxis(_) | K::MotionMissing(_) => 31,
        // bad target
        K::Coordinate { .. }
        | K::RadiiDiffer { .. }
        | K::FullCircleByRadius(_)
        | K::RadiusZero
        | K::RadiusTooLarge
        | K::NotOneQuadrant => 33,
        // arc radius
        K::RadiusTooSmall { .. } => 34,
        // arc without offsets
        K::CentreMissing | K::ArcWordMissing(_) => 35,
        // unused words
        K::ArcWordUnused(_) | K::DwellWordUnused(_) | K::ToleranceUnused { .. } | K::ThreadStartUnused(_) => 36,
        K::ToolNumber(_) => 38,
        // out of range; a tolerance that is missing is a warning, and no refusal
        K::DwellTooLong(_)
        | K::DwellLong(_)
        | K::FeedCode(_)
        | K::ToleranceTooLarge(_)
        | K::ToleranceMissing(_)
        | K::FeedTooLow(_)
        | K::ThreadStart(_)
        | K::ThreadStartSmall(_) => 39,
        // above the largest feed
        K::FeedTooHigh { .. } | K::LeadTooLarge(_) => 43,
        // spindle speed
        K::SpindleSpeed(_) => 44,
        // words that exclude each other
        K::AbsoluteAndIncremental { .. }
        | K::CentreAndRadius { .. }
        | K::ToleranceWithDwell(_)
        | K::LeadTwice { .. }
        | K::LeadOfOtherAxis { .. }
        | K::LeadWithG32(_)
        | K::FeedWithThread(_) => 48,
        // program demarcation; the last two are of a whole program, which the link never checks
        K::TextAfterPercent | K::Empty | K::EndCodeMissing => 57,
        K::CommentOpen => 202,
        K::ProgramNumberPlace(_) => 203,
    }
}

/// Place and cause of a finding.
pub(super) struct Place(pub(super) Finding);

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {} column {}: {}", self.0.line(), self.0.span().0, self.0)
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Program(finding) => Place(*finding).fmt(f),
            Self::TooLong => write!(f, "line of more than {MAX_LINE} bytes"),
            Self::Overflow(bytes) => {
                write!(f, "line lost: the receive buffer was full, {bytes} bytes lost since power-on")
            }
            Self::Damaged => f.write_str("line lost: bytes of it did not arrive whole"),
            Self::Locked(alarm) => write!(f, "locked: {alarm}; check the position, then $X unlocks"),
            Self::Lasting(alarm) => write!(f, "still there: {alarm}; release it, then $X"),
            Self::NotIdle => f.write_str("only while the machine is idle"),
            Self::Command => f.write_str("there is no such command; $ lists them"),
            Self::Homing => f.write_str("one axis after the other: $mode=home, then $home=x or $home=z"),
            Self::Parameter(error) => error.fmt(f),
            Self::Number => f.write_str("a number above zero with a decimal point, such as 800.000"),
            Self::Machine(error) => error.fmt(f),
            Self::PowerOn => f.write_str("start says where the tool is at power-on, and it may have moved since"),
            Self::Position => f.write_str("the tool would be past 2100 mm from zero, where no program can start"),
            Self::Wrong(wrong) => wrong.fmt(f),
            Self::Waiting => f.write_str("blocks of a program wait: ~ starts them, ctrl-x forgets them"),
            Self::Request(refusal) => write!(f, "{}: {refusal}", refusal.name()),
            Self::Mode(mode) => write!(f, "mode {} runs no program: $mode=auto first", mode.name()),
        }
    }
}
