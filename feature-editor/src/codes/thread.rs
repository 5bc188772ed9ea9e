//! Words of threads: the lead, and where a thread starts.

use interp_core::drive::gearing::Lead;
use interp_core::units::{Axis, Point};

use super::diagnostic::{Diagnostic, DiagnosticKind, Report};
use super::gcode::Block;
use super::item::Feed;
use super::modal::{Motion, State, ThreadCode};
use super::word::Placed;

/// Largest lead and feed a turn: 500 mm.
pub(super) const LIMIT_NM: u64 = 500_000_000;

/// Thousandths of a degree in a turn.
const TURN: u64 = 360_000;

/// A lead or a feed a turn; `unit_nm` is the length of a written 1.
pub(super) fn lead(placed: Placed, unit_nm: u32, report: &mut Report<'_, impl FnMut(Diagnostic)>) -> Option<Lead> {
    let number = placed.word.number;
    let nm = number.scaled(unit_nm).map(u64::try_from);
    let kind = match nm {
        Some(Ok(nm)) if (1..=LIMIT_NM).contains(&nm) => return Lead::new(nm, 1),
        Some(Ok(0) | Err(_)) => DiagnosticKind::LeadNotPositive,
        None if number.is_negative() => DiagnosticKind::LeadNotPositive,
        None | Some(Ok(_)) => DiagnosticKind::LeadTooLarge,
    };
    report.tell(placed.span, kind(placed.word));
    None
}

/// The feed of a thread from `start` to `end` (`None` where that was refused), by the words of its block. `cause` is what
/// asks for the thread: its code or its first axis word.
pub(super) fn feed(
    block: &Block,
    code: ThreadCode,
    cause: Placed,
    start: Point,
    end: Option<Point>,
    state: &State,
    report: &mut Report<'_, impl FnMut(Diagnostic)>,
) -> Option<Feed> {
    let words = &block.words;
    if let Some(placed) = words.get('R') {
        report.tell(placed.span, DiagnosticKind::ArcWordUnused(placed.word));
    }
    let lead = match code {
        ThreadCode::ByFeed => {
            if let Some(placed) = words.first_of(&['I', 'K']) {
                report.tell(placed.span, DiagnosticKind::LeadWithG32(placed.word));
            } else if state.lead.is_none() && !block.has_feed {
                report.tell(cause.span, DiagnosticKind::LeadMissing(cause.word));
            }
            state.lead
        }
        ThreadCode::ByAxis => by_axis(block, cause, start, end, state, report),
    };
    let behind = words.get('Q').map_or(Some(0), |placed| behind(placed, report));
    if end == Some(start) {
        report.tell(cause.span, DiagnosticKind::ThreadEmpty(cause.word));
    }
    Some(Feed::Thread { lead: lead?, start: behind? })
}

/// I or K, of the axis that goes farther.
fn by_axis(
    block: &Block,
    cause: Placed,
    start: Point,
    end: Option<Point>,
    state: &State,
    report: &mut Report<'_, impl FnMut(Diagnostic)>,
) -> Option<Lead> {
    let (placed, axis) = match (block.words.get('I'), block.words.get('K')) {
        (None, None) => {
            report.tell(cause.span, DiagnosticKind::LeadMissing(cause.word));
            return None;
        }
        (Some(x), Some(z)) => {
            report.tell(z.span, DiagnosticKind::LeadTwice { x: x.word, z: z.word });
            return None;
        }
        (Some(x), None) => (x, Axis::X),
        (None, Some(z)) => (z, Axis::Z),
    };
    if let Some(end) = end {
        let travel = |from: i32, to: i32| i64::from(to).saturating_sub(i64::from(from)).unsigned_abs();
        let (x, z) = (travel(start.x.nm(), end.x.nm()), travel(start.z.nm(), end.z.nm()));
        let other = match axis {
            Axis::X if z > x => Some(Axis::Z),
            Axis::Z if x > z => Some(Axis::X),
            Axis::X | Axis::Z => None,
        };
        if let Some(axis) = other {
            report.tell(placed.span, DiagnosticKind::LeadOfOtherAxis { word: placed.word, axis });
        }
    }
    lead(placed, state.unit_nm(), report)
}

/// Q: where the thread starts behind the index, in 2^-16 of a turn, rounded to the nearest.
fn behind(placed: Placed, report: &mut Report<'_, impl FnMut(Diagnostic)>) -> Option<u16> {
    let number = placed.word.number;
    let Some(part) = number.code().map(u64::from).filter(|part| *part <= TURN && !number.has_point()) else {
        report.tell(placed.span, DiagnosticKind::ThreadStart(placed.word));
        return None;
    };
    if (1..1_000).contains(&part) {
        report.tell(placed.span, DiagnosticKind::ThreadStartSmall(placed.word));
    }
    let part = part.saturating_mul(1 << 16).saturating_add(TURN / 2) / TURN;
    // a whole turn is none
    u16::try_from(part & 0xffff).ok()
}

/// Q without a thread.
pub(super) fn unused_start(block: &Block, state: &State, report: &mut Report<'_, impl FnMut(Diagnostic)>) {
    let threads =
        matches!(state.motion, Some(Motion::Thread(_))) && block.words.first_of(&['X', 'U', 'Z', 'W']).is_some();
    if let Some(placed) = block.words.get('Q').filter(|_| !threads && !block.is_foreign) {
        report.tell(placed.span, DiagnosticKind::ThreadStartUnused(placed.word));
    }
}
