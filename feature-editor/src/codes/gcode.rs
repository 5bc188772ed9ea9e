//! One block of G-code.
//!
//! The words are gathered first, in whatever order they stand ([`Block`]); then the modal codes take effect, then F,
//! then everything else. Axis words and arcs are in [`motion`](super::motion).

use heapless::Vec;

use interp_core::units::{Feedrate, Length, Sense};

use super::decimal::Number;
use super::diagnostic::{Diagnostic, DiagnosticKind, Report};
use super::item::{Action, Feed, PathControl, SpindleSpeed};
use super::modal::{Motion, State, ThreadCode};
use super::settings::{Format, Settings};
use super::thread;
use super::word::{Lexer, Placed};
use super::words::{Words, check_block_number, exclude};

/// Supported G codes.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Code {
    Motion(Motion),
    Dwell,
    /// True for G7.
    Diameter(bool),
    Plane,
    /// True for G20.
    Inch(bool),
    /// True for G91.
    Incremental(bool),
    /// True for G95.
    PerTurn(bool),
    Path(PathCode),
}

/// Codes of the path control.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum PathCode {
    Exact,
    Stop,
    Blend,
}

/// Number of groups.
const GROUPS: usize = 8;

impl Code {
    fn from_number(number: Number) -> Option<Self> {
        if number.code_tenths() == Some(611) {
            return Some(Self::Path(PathCode::Stop));
        }
        Some(match number.code()? {
            0 => Self::Motion(Motion::Rapid),
            1 => Self::Motion(Motion::Line),
            2 => Self::Motion(Motion::Arc(Sense::Clockwise)),
            3 => Self::Motion(Motion::Arc(Sense::CounterClockwise)),
            4 => Self::Dwell,
            7 => Self::Diameter(true),
            8 => Self::Diameter(false),
            18 => Self::Plane,
            20 => Self::Inch(true),
            21 => Self::Inch(false),
            32 => Self::Motion(Motion::Thread(ThreadCode::ByFeed)),
            33 => Self::Motion(Motion::Thread(ThreadCode::ByAxis)),
            61 => Self::Path(PathCode::Exact),
            64 => Self::Path(PathCode::Blend),
            90 => Self::Incremental(false),
            91 => Self::Incremental(true),
            94 => Self::PerTurn(false),
            95 => Self::PerTurn(true),
            _ => return None,
        })
    }

    /// Whether two codes exclude each other in one block.
    fn is_same_group(self, other: Self) -> bool {
        core::mem::discriminant(&self) == core::mem::discriminant(&other)
    }
}

/// What a line says, before it is understood.
#[derive(Debug, Default)]
pub(super) struct Block {
    pub(super) words: Words,
    codes: Vec<(Code, Placed), GROUPS>,
    /// A word was refused that the other words might depend on.
    pub(super) is_foreign: bool,
    /// F was written, right or wrong.
    pub(super) has_feed: bool,
}

impl Block {
    /// Gathers the words of a line.
    fn read(lexer: Lexer<'_>, report: &mut Report<'_, impl FnMut(Diagnostic)>) -> Self {
        let mut block = Self::default();
        let mut is_first = true;
        for token in lexer {
            match token {
                Ok(placed) => block.accept(placed, is_first, report),
                Err((span, kind)) => {
                    match kind.lost_letter() {
                        Some('F') => block.has_feed = true,
                        None | Some('M' | 'N' | 'O' | 'S' | 'T') => {}
                        // the lost word may be the one that the others need
                        Some(_) => block.is_foreign = true,
                    }
                    report.tell(span, kind);
                }
            }
            is_first = false;
        }
        block
    }

    fn accept(&mut self, placed: Placed, is_first: bool, report: &mut Report<'_, impl FnMut(Diagnostic)>) {
        let word = placed.word;
        match word.letter {
            'G' => self.code(placed, report),
            'M' => self.words.machine(placed, report),
            'O' if !is_first => report.tell(placed.span, DiagnosticKind::ProgramNumberPlace(word)),
            'N' | 'O' => {
                check_block_number(placed, report);
                self.words.keep(placed, report);
            }
            'F' | 'S' | 'T' | 'X' | 'Z' | 'U' | 'W' | 'I' | 'K' | 'R' | 'P' | 'Q' => {
                self.words.keep(placed, report);
            }
            _ => {
                self.is_foreign = true;
                report.tell(placed.span, DiagnosticKind::UnknownLetter { word, format: Format::Gcode });
            }
        }
    }

    fn code(&mut self, placed: Placed, report: &mut Report<'_, impl FnMut(Diagnostic)>) {
        let word = placed.word;
        let Some(code) = Code::from_number(word.number) else {
            self.is_foreign = true;
            return report.tell(placed.span, DiagnosticKind::UnknownG { word, format: Format::Gcode });
        };
        match self.codes.iter().find(|(other, _)| other.is_same_group(code)) {
            Some(&(_, first)) => report.tell(placed.span, exclude(first, placed)),
            // cannot be full: one place for each group
            None => {
                let _ = self.codes.push((code, placed));
            }
        }
    }

    /// The motion code of this block.
    pub(super) fn motion_word(&self) -> Option<Placed> {
        self.codes.iter().find(|(code, _)| matches!(code, Code::Motion(_))).map(|&(_, placed)| placed)
    }

    /// The G4 of this block.
    pub(super) fn dwell_word(&self) -> Option<Placed> {
        self.codes.iter().find(|(code, _)| matches!(code, Code::Dwell)).map(|&(_, placed)| placed)
    }

    /// The G61, G61.1 or G64 of this block.
    fn path_word(&self) -> Option<(PathCode, Placed)> {
        self.codes.iter().find_map(|&(code, placed)| match code {
            Code::Path(path) => Some((path, placed)),
            _ => None,
        })
    }

    /// Puts the modal codes into force.
    fn apply(&self, state: &mut State) {
        for &(code, _) in &self.codes {
            match code {
                Code::Motion(motion) => state.motion = Some(motion),
                Code::Diameter(diameter) => state.diameter = diameter,
                Code::Inch(inch) => state.inch = inch,
                Code::Incremental(incremental) => state.incremental = incremental,
                Code::PerTurn(per_turn) => state.set_per_turn(per_turn),
                Code::Dwell | Code::Plane | Code::Path(_) => {}
            }
        }
    }
}

/// Actions of a block, in execution order.
pub(crate) type Actions = [Option<Action>; 6];

/// Reads one block. The actions count only if nothing was refused; whether the program ends counts always.
pub(crate) fn block(
    lexer: Lexer<'_>,
    settings: &Settings,
    state: &mut State,
    report: &mut Report<'_, impl FnMut(Diagnostic)>,
) -> (Actions, bool) {
    let mut block = Block::read(lexer, report);
    block.apply(state);
    if let Some(placed) = block.words.get('F') {
        block.has_feed = true;
        feed(placed, settings, state, report);
    }
    let speed = block.words.get('S').and_then(|placed| speed(placed, report));
    let spindle = block.words.spindle.map(|(action, _)| action);
    let tool = block.words.get('T').and_then(|placed| tool(placed, report));
    let dwell = dwell(&block, report);
    path(&block, state, report);
    let motion = super::motion::motion(&block, settings, state, report);
    thread::unused_start(&block, state, report);
    let stop = block.words.stop.map(|(action, _)| action);
    ([speed, spindle, tool, dwell, motion, stop], block.words.ends())
}

/// F: millimetres (inches) a minute, under G95 or of a thread a turn.
fn feed(placed: Placed, settings: &Settings, state: &mut State, report: &mut Report<'_, impl FnMut(Diagnostic)>) {
    match state.motion {
        Some(Motion::Thread(ThreadCode::ByFeed)) => {
            state.lead = thread::lead(placed, state.unit_nm(), report).or(state.lead);
            return;
        }
        Some(Motion::Thread(ThreadCode::ByAxis)) => {
            return report.tell(placed.span, DiagnosticKind::FeedWithThread(placed.word));
        }
        _ if state.per_turn => {
            state.feed = thread::lead(placed, state.unit_nm(), report).map(Feed::PerTurn).or(state.feed);
            return;
        }
        _ => {}
    }
    let word = placed.word;
    let (limit_x, limit_z) = (settings.max_feed_x, settings.max_feed_z);
    let too_high = DiagnosticKind::FeedTooHigh { word, limit_x, limit_z };
    match word.number.scaled(state.unit_nm()).map(u64::try_from) {
        None if !word.number.is_negative() => report.tell(placed.span, too_high),
        None | Some(Err(_) | Ok(0)) => report.tell(placed.span, DiagnosticKind::FeedNotPositive(word)),
        Some(Ok(nm_per_min)) => match Feedrate::from_nm_per_min(nm_per_min) {
            Some(feed) if feed <= limit_x.max(limit_z) => state.feed = Some(Feed::PerMinute(feed)),
            None if nm_per_min < Feedrate::SLOWEST.nm_per_min() => {
                report.tell(placed.span, DiagnosticKind::FeedTooLow(word));
            }
            _ => report.tell(placed.span, too_high),
        },
    }
}

/// S: turns a minute.
fn speed(placed: Placed, report: &mut Report<'_, impl FnMut(Diagnostic)>) -> Option<Action> {
    let milli_rpm = placed.word.number.scaled(1_000).and_then(|milli_rpm| u32::try_from(milli_rpm).ok());
    let speed = milli_rpm.and_then(SpindleSpeed::from_milli_rpm);
    if speed.is_none() {
        report.tell(placed.span, DiagnosticKind::SpindleSpeed(placed.word));
    }
    speed.map(Action::SpindleSpeed)
}

/// T: one or two digits are a tool with its own offset, three or four end in two digits of offset.
fn tool(placed: Placed, report: &mut Report<'_, impl FnMut(Diagnostic)>) -> Option<Action> {
    let digits = placed.word.number.integer_digits();
    let code = placed.word.number.code().and_then(|code| u16::try_from(code).ok());
    match code {
        Some(code) if digits <= 4 && !placed.word.number.has_point() => {
            let (number, offset) = if digits <= 2 { (code, code) } else { (code / 100, code % 100) };
            Some(Action::Tool { number, offset })
        }
        _ => {
            report.tell(placed.span, DiagnosticKind::ToolNumber(placed.word));
            None
        }
    }
}

/// G61, G61.1, and G64 with P in millimetres (inches).
fn path(block: &Block, state: &mut State, report: &mut Report<'_, impl FnMut(Diagnostic)>) {
    let Some((code, placed)) = block.path_word() else { return };
    let tolerance = match (block.words.get('P'), code) {
        (Some(tolerance), PathCode::Blend) if block.dwell_word().is_some() => {
            let word = tolerance.word;
            return report.tell(tolerance.span, DiagnosticKind::ToleranceWithDwell(word));
        }
        (Some(tolerance), PathCode::Exact | PathCode::Stop) if block.dwell_word().is_none() => {
            let (word, code) = (tolerance.word, placed.word);
            return report.tell(tolerance.span, DiagnosticKind::ToleranceUnused { word, code });
        }
        (tolerance, _) => tolerance,
    };
    state.control = match (code, tolerance) {
        (PathCode::Exact, _) => PathControl::Exact,
        (PathCode::Stop, _) => PathControl::Stop,
        (PathCode::Blend, None) => {
            if !block.is_foreign {
                report.tell(placed.span, DiagnosticKind::ToleranceMissing(placed.word));
            }
            PathControl::Blend { tolerance: None }
        }
        (PathCode::Blend, Some(Placed { word, span })) => {
            if word.number.is_negative() && !word.number.is_zero() {
                return report.tell(span, DiagnosticKind::ToleranceNegative(word));
            }
            let limit = i64::from(PathControl::LIMIT_NM);
            match word.number.scaled(state.unit_nm()).filter(|nm| *nm <= limit).and_then(Length::from_nm) {
                Some(tolerance) => PathControl::within(tolerance),
                None => return report.tell(span, DiagnosticKind::ToleranceTooLarge(word)),
            }
        }
    };
}

/// G4 with P in seconds.
fn dwell(block: &Block, report: &mut Report<'_, impl FnMut(Diagnostic)>) -> Option<Action> {
    let placed = match (block.dwell_word(), block.words.get('P')) {
        (Some(_), Some(placed)) => placed,
        (Some(code), None) => {
            if !block.is_foreign {
                report.tell(code.span, DiagnosticKind::DwellMissing);
            }
            return None;
        }
        (None, Some(_)) if block.path_word().is_some() => return None,
        (None, Some(placed)) => {
            if !block.is_foreign {
                report.tell(placed.span, DiagnosticKind::DwellWordUnused(placed.word));
            }
            return None;
        }
        (None, None) => return None,
    };
    let word = placed.word;
    if word.number.is_negative() && !word.number.is_zero() {
        report.tell(placed.span, DiagnosticKind::DwellNegative(word));
        return None;
    }
    let Some(ms) = word.number.scaled(1_000).and_then(|ms| u32::try_from(ms).ok()) else {
        report.tell(placed.span, DiagnosticKind::DwellTooLong(word));
        return None;
    };
    if ms >= 60_000 && !word.number.has_point() {
        report.tell(placed.span, DiagnosticKind::DwellLong(word));
    }
    Some(Action::Dwell { ms })
}
