//! One block of the 1973 sample's format.
//!
//! Whole numbers of pulses of 0.01 mm, incremental, X as a radius never asked for: X of the milling sample is the
//! lathe's Z, Y is X; so J belongs to X and I to Z. An arc gives its end (X, Y) and its start (I, J, without signs)
//! relative to the centre and stays within one quadrant; the signs of the start follow from that and the sense.
//! F0 is rapid, F1 to F9 are feeds of the settings. The front tool post is not heeded: the sample is drawn with Z to
//! the right and X upward.

use interp_core::units::{Axis, Length, Point, Sense};

use super::arc;
use super::decimal::Distance;
use super::diagnostic::{Diagnostic, DiagnosticKind, Report};
use super::gcode::Actions;
use super::item::{Action, Centre, Feed};
use super::modal::{Motion, State};
use super::motion::refusal;
use super::settings::{Format, Settings};
use super::word::{Lexer, Placed};
use super::words::{Words, check_block_number, exclude};

/// One pulse: 0.01 mm.
const PULSE_NM: u32 = 10_000;

/// What a line says.
#[derive(Debug, Default)]
struct Block {
    words: Words,
    motion: Option<(Motion, Placed)>,
    incremental: Option<Placed>,
    /// A word was refused that the other words might depend on.
    is_foreign: bool,
    /// F was written, right or wrong.
    has_feed: bool,
}

impl Block {
    fn read(lexer: Lexer<'_>, report: &mut Report<'_, impl FnMut(Diagnostic)>) -> Self {
        let mut block = Self::default();
        for token in lexer {
            match token {
                Ok(placed) if placed.word.number.has_point() => {
                    block.has_feed |= placed.word.letter == 'F';
                    block.is_foreign |= placed.word.letter != 'F';
                    report.tell(placed.span, DiagnosticKind::DecimalPoint(placed.word));
                }
                Ok(placed) => block.accept(placed, report),
                Err((span, kind)) => {
                    match kind.lost_letter() {
                        Some('F') => block.has_feed = true,
                        None | Some('M' | 'N') => {}
                        Some(_) => block.is_foreign = true,
                    }
                    report.tell(span, kind);
                }
            }
        }
        block
    }

    fn accept(&mut self, placed: Placed, report: &mut Report<'_, impl FnMut(Diagnostic)>) {
        let word = placed.word;
        match word.letter {
            'G' => self.code(placed, report),
            'M' => self.words.machine(placed, report),
            'N' => {
                check_block_number(placed, report);
                self.words.keep(placed, report);
            }
            'I' | 'J' if word.number.is_negative() => {
                self.is_foreign = true;
                report.tell(placed.span, DiagnosticKind::Signed(word));
            }
            'X' | 'Y' | 'I' | 'J' | 'F' => self.words.keep(placed, report),
            _ => {
                self.is_foreign = true;
                report.tell(placed.span, DiagnosticKind::UnknownLetter { word, format: Format::Nc1973 });
            }
        }
    }

    fn code(&mut self, placed: Placed, report: &mut Report<'_, impl FnMut(Diagnostic)>) {
        let word = placed.word;
        let motion = match word.number.code() {
            Some(1) => Motion::Line,
            Some(2) => Motion::Arc(Sense::Clockwise),
            Some(3) => Motion::Arc(Sense::CounterClockwise),
            Some(91) => {
                match self.incremental {
                    Some(first) => report.tell(placed.span, exclude(first, placed)),
                    None => self.incremental = Some(placed),
                }
                return;
            }
            _ => {
                self.is_foreign = true;
                return report.tell(placed.span, DiagnosticKind::UnknownG { word, format: Format::Nc1973 });
            }
        };
        match self.motion {
            Some((_, first)) => report.tell(placed.span, exclude(first, placed)),
            None => self.motion = Some((motion, placed)),
        }
    }
}

/// Reads one block. The actions count only if nothing was refused; whether the program ends counts always.
pub(crate) fn block(
    lexer: Lexer<'_>,
    settings: &Settings,
    state: &mut State,
    report: &mut Report<'_, impl FnMut(Diagnostic)>,
) -> (Actions, bool) {
    let mut block = Block::read(lexer, report);
    if let Some((motion, _)) = block.motion {
        state.motion = Some(motion);
    }
    if let Some(placed) = block.words.get('F') {
        block.has_feed = true;
        feed(placed, settings, state, report);
    }
    let spindle = block.words.spindle.map(|(action, _)| action);
    let motion = if block.is_foreign { None } else { motion(&block, settings, state, report) };
    let stop = block.words.stop.map(|(action, _)| action);
    ([None, spindle, None, None, motion, stop], block.words.ends())
}

/// F0 is rapid, F1 to F9 are looked up.
fn feed(placed: Placed, settings: &Settings, state: &mut State, report: &mut Report<'_, impl FnMut(Diagnostic)>) {
    let word = placed.word;
    let code = word.number.code().and_then(|code| usize::try_from(code).ok());
    match code {
        Some(0) => state.feed = Some(Feed::Rapid),
        Some(code) => match settings.tape_feeds.get(code.saturating_sub(1)) {
            Some(&Some(feed)) if feed <= settings.max_feed_x.max(settings.max_feed_z) => {
                state.feed = Some(Feed::PerMinute(feed));
            }
            Some(Some(_)) => {
                let (limit_x, limit_z) = (settings.max_feed_x, settings.max_feed_z);
                report.tell(placed.span, DiagnosticKind::FeedTooHigh { word, limit_x, limit_z });
            }
            Some(None) => report.tell(placed.span, DiagnosticKind::FeedCodeUnset(word)),
            None => report.tell(placed.span, DiagnosticKind::FeedCode(word)),
        },
        None => report.tell(placed.span, DiagnosticKind::FeedCode(word)),
    }
}

/// The motion of a block without refused words.
fn motion(
    block: &Block,
    settings: &Settings,
    state: &mut State,
    report: &mut Report<'_, impl FnMut(Diagnostic)>,
) -> Option<Action> {
    let words = &block.words;
    let Some(axis_word) = words.first_of(&['X', 'Y']) else {
        if let Some((_, code)) = block.motion {
            report.tell(code.span, DiagnosticKind::EndMissing(code.word));
        } else if let Some(placed) = words.first_of(&['I', 'J']) {
            let kind = match state.motion {
                Some(Motion::Arc(_)) => DiagnosticKind::EndMissing(placed.word),
                _ => DiagnosticKind::ArcWordUnused(placed.word),
            };
            report.tell(placed.span, kind);
        }
        return None;
    };
    let Some(motion) = state.motion else {
        report.tell(axis_word.span, DiagnosticKind::MotionMissing(axis_word.word));
        return None;
    };
    let place = block.motion.map_or(axis_word, |(_, placed)| placed);
    if state.feed.is_none() && !block.has_feed {
        report.tell(place.span, DiagnosticKind::FeedMissing(place.word));
    }
    match motion {
        // this format has no threads
        Motion::Rapid | Motion::Line | Motion::Thread(_) => {
            for placed in ['I', 'J'].into_iter().filter_map(|letter| words.get(letter)) {
                report.tell(placed.span, DiagnosticKind::ArcWordUnused(placed.word));
            }
            let position = state.position;
            let end = advance(words, (i64::from(position.x.nm()), i64::from(position.z.nm())), report)?;
            state.position = end;
            Some(Action::Line { end, feed: state.feed? })
        }
        Motion::Arc(sense) => {
            let (end, centre) = quadrant(words, place, sense, settings, state.position, report)?;
            state.position = end;
            Some(Action::Arc { end, centre, sense, feed: state.feed? })
        }
    }
}

/// Nanometres of a word; without it zero.
fn pulses(words: &Words, letter: char) -> i64 {
    // a number past 64 bits is out of range as well
    words.get(letter).map_or(0, |placed| placed.word.number.scaled(PULSE_NM).unwrap_or(i64::MAX))
}

/// Point at (Y, X) from `(x, z)`, in nanometres. Tells which coordinate is out of range.
fn advance(words: &Words, (x, z): (i64, i64), report: &mut Report<'_, impl FnMut(Diagnostic)>) -> Option<Point> {
    let mut along = |letter: char, from: i64, axis: Axis| {
        let end = from.checked_add(pulses(words, letter)).and_then(Length::from_nm);
        if let (None, Some(placed)) = (end, words.get(letter)) {
            report.tell(placed.span, DiagnosticKind::Coordinate { word: placed.word, axis });
        }
        end
    };
    let (x, z) = (along('Y', x, Axis::X), along('X', z, Axis::Z));
    Some(Point { x: x?, z: z? })
}

/// End and centre of an arc within one quadrant.
fn quadrant(
    words: &Words,
    place: Placed,
    sense: Sense,
    settings: &Settings,
    position: Point,
    report: &mut Report<'_, impl FnMut(Diagnostic)>,
) -> Option<(Point, Centre)> {
    let mut is_whole = true;
    for letter in ['X', 'Y', 'I', 'J'] {
        if words.get(letter).is_none() {
            report.tell(place.span, DiagnosticKind::ArcWordMissing(letter));
            is_whole = false;
        }
    }
    if !is_whole {
        return None;
    }
    let (end, magnitude) = ((pulses(words, 'Y'), pulses(words, 'X')), (pulses(words, 'J'), pulses(words, 'I')));
    let radii = arc::check_radii(arc::radius_squared(magnitude), arc::radius_squared(end), settings.tolerance_nm());
    if let Err(error) = radii {
        report.tell(place.span, refusal(error, place, settings));
        return None;
    }
    let magnitude = (magnitude.0.unsigned_abs(), magnitude.1.unsigned_abs());
    let Some(start) = arc::one_quadrant(magnitude, end, sense) else {
        report.tell(place.span, DiagnosticKind::NotOneQuadrant);
        return None;
    };
    let x = i64::from(position.x.nm()).saturating_sub(start.0);
    let z = i64::from(position.z.nm()).saturating_sub(start.1);
    let end = advance(words, (x, z), report)?;
    Some((end, Centre { x: Distance::from_nm(x), z: Distance::from_nm(z) }))
}
