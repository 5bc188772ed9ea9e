//! Axis words and arcs of a G-code block.

use interp_core::units::{Axis, Length, Point, Sense};

use super::arc::{self, ArcError};
use super::diagnostic::{Diagnostic, DiagnosticKind, Report};
use super::gcode::Block;
use super::item::{Action, Centre, Feed};
use super::modal::{Motion, State};
use super::settings::Settings;
use super::thread;
use super::word::{Placed, Span};
use super::words::Words;

/// The motion of a block, if it has one and nothing of it is refused. The position moves to every coordinate that
/// could be read, refused or not.
pub(super) fn motion(
    block: &Block,
    settings: &Settings,
    state: &mut State,
    report: &mut Report<'_, impl FnMut(Diagnostic)>,
) -> Option<Action> {
    let words = &block.words;
    let Some(axis_word) = words.first_of(&['X', 'U', 'Z', 'W']) else {
        if !block.is_foreign {
            without_axis(block, state, report);
        }
        return None;
    };
    let start = state.position;
    let x = coordinate(words, Axis::X, state, report);
    let z = coordinate(words, Axis::Z, state, report);
    state.position = Point { x: x.unwrap_or(start.x), z: z.unwrap_or(start.z) };
    let end = x.and(z).map(|_| state.position);

    if block.dwell_word().is_some() && block.motion_word().is_none() {
        state.position = start; // elsewhere G4 X is a time
        report.tell(axis_word.span, DiagnosticKind::DwellWithAxis(axis_word.word));
        return None;
    }
    if block.is_foreign {
        return None; // refused already; what else is wrong cannot be told
    }
    let Some(motion) = state.motion else {
        report.tell(axis_word.span, DiagnosticKind::MotionMissing(axis_word.word));
        return None;
    };
    let cause = block.motion_word().unwrap_or(axis_word);
    let place = cause.span;
    let feed = match motion {
        Motion::Rapid => Some(Feed::Rapid),
        Motion::Line | Motion::Arc(_) => {
            if state.feed.is_none() && !block.has_feed {
                let missing =
                    if state.per_turn { DiagnosticKind::FeedPerTurnMissing } else { DiagnosticKind::FeedMissing };
                report.tell(place, missing(cause.word));
            }
            state.feed
        }
        Motion::Thread(code) => thread::feed(block, code, cause, start, end, state, report),
    };
    match motion {
        Motion::Rapid | Motion::Line => {
            unused(words, report);
            Some(Action::Line { end: end?, feed: feed? })
        }
        Motion::Thread(_) => Some(Action::Line { end: end?, feed: feed? }),
        Motion::Arc(sense) => {
            let sense = if settings.front_post { sense.mirrored() } else { sense };
            let centre = centre(words, place, start, end, sense, state.unit_nm(), settings, report);
            Some(Action::Arc { end: end?, centre: centre?, sense, feed: feed? })
        }
    }
}

/// Block without X, Z, U and W.
fn without_axis(block: &Block, state: &State, report: &mut Report<'_, impl FnMut(Diagnostic)>) {
    // or a thread: I and K are words of either
    let is_arc = matches!(state.motion, Some(Motion::Arc(_) | Motion::Thread(_)));
    if let Some(code) = block.motion_word() {
        report.tell(code.span, DiagnosticKind::EndMissing(code.word));
        if !is_arc {
            unused(&block.words, report);
        }
    } else if let (true, Some(placed)) = (is_arc, block.words.first_of(&['I', 'K', 'R'])) {
        report.tell(placed.span, DiagnosticKind::EndMissing(placed.word));
    } else {
        unused(&block.words, report);
    }
}

/// I, K and R outside an arc.
fn unused(words: &Words, report: &mut Report<'_, impl FnMut(Diagnostic)>) {
    for placed in ['I', 'K', 'R'].into_iter().filter_map(|letter| words.get(letter)) {
        report.tell(placed.span, DiagnosticKind::ArcWordUnused(placed.word));
    }
}

/// Coordinate of an axis after this block: as before without a word, `None` when it was refused.
fn coordinate(
    words: &Words,
    axis: Axis,
    state: &State,
    report: &mut Report<'_, impl FnMut(Diagnostic)>,
) -> Option<Length> {
    let (absolute, incremental, unit, now) = match axis {
        Axis::X => ('X', 'U', state.unit_x_nm(), state.position.x),
        Axis::Z => ('Z', 'W', state.unit_nm(), state.position.z),
    };
    let (placed, is_incremental) = match (words.get(absolute), words.get(incremental)) {
        (None, None) => return Some(now),
        (Some(placed), None) => (placed, state.incremental),
        (None, Some(placed)) => (placed, true),
        (Some(absolute), Some(incremental)) => {
            let span = if absolute.span.column > incremental.span.column { absolute.span } else { incremental.span };
            let (absolute, incremental) = (absolute.word, incremental.word);
            report.tell(span, DiagnosticKind::AbsoluteAndIncremental { absolute, incremental });
            return None;
        }
    };
    let from = if is_incremental { i64::from(now.nm()) } else { 0 };
    let end = placed.word.number.scaled(unit).and_then(|nm| from.checked_add(nm)).and_then(Length::from_nm);
    if end.is_none() {
        report.tell(placed.span, DiagnosticKind::Coordinate { word: placed.word, axis });
    }
    end
}

/// Centre of an arc from I and K or R. `end` is `None` when it was refused; then only the words are checked.
#[expect(clippy::too_many_arguments, reason = "an arc is that much; a struct of them would live for one call")]
fn centre(
    words: &Words,
    place: Span,
    start: Point,
    end: Option<Point>,
    sense: Sense,
    unit_nm: u32,
    settings: &Settings,
    report: &mut Report<'_, impl FnMut(Diagnostic)>,
) -> Option<Centre> {
    let tolerance = settings.tolerance_nm();
    // past 64 bits counts as too large, as everything above 4.2 m
    let nm = |placed: Placed| placed.word.number.scaled(unit_nm).unwrap_or(i64::MAX);
    let result = match (words.first_of(&['I', 'K']), words.get('R')) {
        (None, None) => {
            report.tell(place, DiagnosticKind::CentreMissing);
            return None;
        }
        (Some(centre), Some(radius)) => {
            let (centre, span, radius) = (centre.word, radius.span, radius.word);
            report.tell(span, DiagnosticKind::CentreAndRadius { centre, radius });
            return None;
        }
        (Some(first), None) => {
            let offset = (words.get('I').map_or(0, nm), words.get('K').map_or(0, nm));
            arc::by_centre(start, end?, offset, tolerance).map_err(|error| (error, first))
        }
        (None, Some(radius)) => {
            arc::by_radius(start, end?, nm(radius), sense, tolerance).map_err(|error| (error, radius))
        }
    };
    match result {
        Ok(centre) => Some(centre),
        Err((error, placed)) => {
            report.tell(placed.span, refusal(error, placed, settings));
            None
        }
    }
}

/// What an arc error means for the operator; `placed` is R, or the first of I and K.
pub(super) fn refusal(error: ArcError, placed: Placed, settings: &Settings) -> DiagnosticKind {
    match error {
        ArcError::Zero => DiagnosticKind::RadiusZero,
        ArcError::TooLarge => DiagnosticKind::RadiusTooLarge,
        ArcError::RadiiDiffer { start, end } => {
            DiagnosticKind::RadiiDiffer { start, end, tolerance: settings.arc_tolerance.max(Length::ZERO) }
        }
        ArcError::FullCircle => DiagnosticKind::FullCircleByRadius(placed.word),
        ArcError::TooSmall { half_chord } => DiagnosticKind::RadiusTooSmall { radius: placed.word, half_chord },
    }
}
