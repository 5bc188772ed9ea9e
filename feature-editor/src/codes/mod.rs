//! Program text, line by line, to motions.
//!
//! An [`Interpreter`] is fed the lines of a program. Each good line yields [`Item`]s in execution order, each bad one
//! [`Diagnostic`]s that name the place, the cause and the remedy; nothing of a bad line is executed. Lengths come out
//! exact: a decimal is turned into nanometres once, rounded half away from zero; X comes out as a radius.
//!
//! # G-code
//! - G0 rapid, G1 line, G2 and G3 arcs, G4 dwell (P in seconds); G7 X and U as diameter, G8 as radius (at start);
//!   G18; G20 inch, G21 mm (at start); G90 absolute (at start), G91 incremental; G94 feed a minute
//!   (at start), G95 a turn. An F counts for the one in force.
//! - G33 thread with K, the lead along Z in mm (inch) a turn, or I along X where X goes farther (as a radius); G32 with
//!   the lead as F, which stays in force for G32 alone. Q from 0 to 360000 is where it starts behind the index, in
//!   thousandths of a degree; without it 0. On a taper the lead is along the axis that goes farther.
//! - G61 exact path (at start, unless the settings have a tolerance), G61.1 exact stop, G64 P with the tolerance of
//!   blends in mm (inch).
//! - M0 stop, M1 optional stop, M2 and M30 end, M3 M4 M5 spindle. S turns a minute.
//! - T1 is tool 1 with offset 1; of three or four digits the last two are the offset (T0103).
//! - X Z absolute (incremental under G91), U W always incremental. I K from the start of the arc to its centre, always
//!   as radius, the missing one zero; or R, above zero up to 180 degrees, below zero the larger arc.
//! - F in mm (inch) a minute along the path. F, the motion code and G7 to G95 stay in force.
//! - N and O numbers, comments in ( ) and behind ;, `%` alone on its line, `/` before a line that may be skipped.
//! - G2 is clockwise seen with Z to the right and X upward; a front tool post mirrors it.
//!
//! A block is executed as S, M3 to M5, T, dwell, motion, stop or end; its F and modal codes hold for it.
//!
//! # The 1973 format
//! Letters N G X Y I J F M, whole numbers of pulses of 0.01 mm, G01 G02 G03 G91, always incremental. X is the lathe's
//! Z and Y its X. Arcs: one quadrant a block, X Y the end and I J the start, both from the centre, I J without signs.
//! F0 is rapid, F1 to F9 are feeds of the settings.
//!
//! # Left out
//! Cycles, offsets and compensation; soft limits; a feed above the limit of one axis only. They need the
//! machine, and a planner checks them.

mod arc;
mod decimal;
mod detect;
mod diagnostic;
mod gcode;
mod item;
mod message;
mod modal;
mod motion;
mod nc1973;
mod settings;
#[cfg(test)]
mod tests;
mod thread;
mod word;
mod words;

pub use decimal::{Distance, Number, NumberError};
pub use detect::Detector;
pub use diagnostic::{Diagnostic, DiagnosticKind, Remedy, Severity};
pub use item::{Action, Centre, Feed, Item, PathControl, SpindleCommand, SpindleSpeed};
pub use modal::Modal;
pub use settings::{Format, Settings};
pub use word::Word;

use diagnostic::Report;
use modal::State;
use word::{Lexer, Span, characters};

/// Longest line, in bytes without its terminator. The firmware's line buffer has this size.
pub const MAX_LINE: usize = 256;

/// Reads a program line by line.
///
/// It keeps what is modal and where the tool is. After a refused line it goes on from that line's end point, so that
/// the rest of a program can be checked; when the lines are executed as they come, keep a clone and go back to it
/// after a refusal.
///
/// ```
/// use feature_editor::codes::{Action, Feed, Format, Interpreter, Settings};
/// use interp_core::units::{Feedrate, Length, Point};
///
/// let feed = Feedrate::from_nm_per_min(1_000_000_000).unwrap(); // 1 m/min
/// let mut program = Interpreter::new(Settings::new(feed, feed), Format::Gcode);
/// let mut items = Vec::new();
/// let mut found = Vec::new();
/// program.line(b"G7 G0 X50 Z2.5", &mut |item| items.push(item), &mut |diagnostic| found.push(diagnostic));
/// program.line(b"G1 X10 U5 F100", &mut |item| items.push(item), &mut |diagnostic| found.push(diagnostic));
///
/// let end = Point { x: Length::from_um(25_000).unwrap(), z: Length::from_um(2_500).unwrap() };
/// assert_eq!(items.len(), 1);
/// assert_eq!(items[0].action, Action::Line { end, feed: Feed::Rapid });
/// assert_eq!((found[0].line, found[0].column, found[0].length), (2, 8, 2));
/// assert_eq!(found[0].to_string(), "X with U in one block");
/// assert_eq!(found[0].remedy().to_string(), "write X (absolute) or U (incremental), not both");
/// ```
#[derive(Clone, Debug)]
pub struct Interpreter {
    settings: Settings,
    format: Format,
    state: State,
    line: u32,
    /// A line had something else than comments.
    has_words: bool,
    /// A `%` was read.
    has_percent: bool,
    ended: bool,
}

impl Interpreter {
    /// At the start of a program.
    pub const fn new(settings: Settings, format: Format) -> Self {
        let state = State::new(&settings);
        Self { settings, format, state, line: 0, has_words: false, has_percent: false, ended: false }
    }

    /// Reads one line, without its terminator (a carriage return at its end is taken as part of it).
    ///
    /// * `emit` is called for each action, in execution order, once the whole line is found good.
    /// * `report` is called for each error and warning, in no particular order within the line.
    ///
    /// Lines behind the end of the program are counted and otherwise ignored.
    pub fn line(&mut self, text: &[u8], emit: &mut impl FnMut(Item), report: &mut impl FnMut(Diagnostic)) {
        self.line = self.line.saturating_add(1);
        if self.ended {
            return;
        }
        let text = text.strip_suffix(b"\r").unwrap_or(text);
        let mut report = Report::new(self.line, report);
        if text.len() > MAX_LINE {
            self.has_words = true;
            let bytes = u32::try_from(text.len()).unwrap_or(u32::MAX);
            let span = Span { column: 1, length: characters(text) };
            return report.tell(span, DiagnosticKind::LineTooLong { bytes });
        }
        let mut lexer = Lexer::new(text);
        if lexer.accept(b'%') {
            return self.percent(lexer, &mut report);
        }
        if lexer.accept(b'/') && self.settings.block_delete {
            return;
        }
        self.has_words |= lexer.clone().next().is_some();
        let (actions, ends) = match self.format {
            Format::Gcode => gcode::block(lexer, &self.settings, &mut self.state, &mut report),
            Format::Nc1973 => nc1973::block(lexer, &self.settings, &mut self.state, &mut report),
        };
        self.ended = ends;
        if !report.is_refused() {
            for action in actions.into_iter().flatten() {
                emit(Item { line: self.line, action, control: self.state.control });
            }
        }
    }

    /// `%`: the first one before any word begins the program, any other ends it.
    fn percent(&mut self, mut lexer: Lexer<'_>, report: &mut Report<'_, impl FnMut(Diagnostic)>) {
        self.ended = self.has_percent || self.has_words;
        self.has_percent = true;
        if let Some(token) = lexer.next() {
            let span = token.map_or_else(|(span, _)| span, |placed| placed.span);
            report.tell(span, DiagnosticKind::TextAfterPercent);
        }
    }

    /// Says what only the whole program can be blamed for: it is empty, or (a warning, in G-code) nothing ends it.
    /// The program is over then.
    pub fn finish(&mut self, report: &mut impl FnMut(Diagnostic)) {
        let mut report = Report::new(self.line.max(1), report);
        let span = Span { column: 1, length: 0 };
        if !self.has_words {
            report.tell(span, DiagnosticKind::Empty);
        } else if !self.ended && self.format == Format::Gcode {
            report.tell(span, DiagnosticKind::EndCodeMissing);
        }
        self.ended = true;
    }

    /// Goes on under other settings, with the tool at their `start`. What is modal stays in force.
    pub const fn configure(&mut self, settings: Settings) {
        self.state.position = settings.start;
        self.settings = settings;
    }

    /// What is in force.
    pub const fn modal(&self) -> Modal {
        self.state.shown()
    }

    /// Whether the program is over: M2, M30 or the closing `%` was read.
    pub const fn is_ended(&self) -> bool {
        self.ended
    }
}
