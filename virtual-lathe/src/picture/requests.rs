//! The lane of a scenario's sheet with what was asked for: a flag at its time, its words beside it.
//!
//! Flags hang from the top of the lane, the latest highest: so a flag's staff passes words that begin to its right, and few are in
//! its way.

use crate::picture::pen::{Anchor, GREY, INK, Pen, Stroke};
use crate::picture::text;
use crate::picture::view::Rect;

/// What was asked for at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// Seconds.
    pub time: f64,
    /// The script's words, one text for each event.
    pub words: Vec<String>,
}

/// Height of a row of flags.
pub(crate) const ROW: f64 = 16.0;
const TEXT: f64 = 11.5;
/// Most rows: what finds no room in them has a staff and no words.
const ROWS: usize = 8;
/// Of a staff, over the words' line.
const STAFF: f64 = 4.0;
/// Between words and the next staff.
const GAP: f64 = 9.0;
const BETWEEN: &str = " \u{b7} ";
const POLE: Stroke = Stroke::solid(GREY, 0.9);

/// A flag: where its staff is, its row from the top, and its words, from left to right.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Flag {
    x: f64,
    row: Option<usize>,
    words: String,
    spread: [f64; 2],
}

impl Flag {
    /// Whether this flag in `row` has its words or its staff in the way of another one.
    fn meets(&self, row: usize, other: &Self) -> bool {
        let Some(other_row) = other.row else { return false };
        let crossed = |x: f64, [from, to]: [f64; 2]| x > from - STAFF && x < to + STAFF;
        let overlap = self.spread[0] < other.spread[1] + GAP && other.spread[0] < self.spread[1] + GAP;
        (other_row == row && overlap)
            || (other_row < row && crossed(self.x, other.spread))
            || (other_row > row && crossed(other.x, self.spread))
    }
}

/// Places the flags in a lane `width` units wide that spans `span` seconds.
pub(crate) fn flags(requests: &[Request], span: f64, width: f64) -> Vec<Flag> {
    let flag = |request: &Request| {
        let x = (request.time / span).clamp(0.0, 1.0) * width;
        let words = text::fit(&request.words.join(BETWEEN), TEXT, width - STAFF);
        let length = text::width(&words, TEXT);
        // near the right edge words stand before their staff
        let left = if x + STAFF + length > width { x - STAFF - length } else { x + STAFF };
        Flag { x, row: None, words, spread: [left, left + length] }
    };
    let (mut before, behind): (Vec<Flag>, Vec<Flag>) =
        requests.iter().map(flag).partition(|flag| flag.spread[0] < flag.x);
    before.reverse();
    let mut placed: Vec<Flag> = Vec::new();
    for mut flag in behind.into_iter().rev().chain(before) {
        flag.row = (0..ROWS).find(|row| !placed.iter().any(|other| flag.meets(*row, other)));
        placed.push(flag);
    }
    placed
}

/// How high a lane of these flags is.
pub(crate) fn height(flags: &[Flag]) -> f64 {
    let rows = flags.iter().filter_map(|flag| flag.row).max().map_or(0, |row| row + 1);
    f64::from(u32::try_from(rows).unwrap_or(0)) * ROW + if rows > 0 { 6.0 } else { 0.0 }
}

/// Draws the lane.
pub(crate) fn draw(pen: &mut Pen, lane: Rect, flags: &[Flag]) {
    pen.open("staff", POLE);
    for flag in flags {
        let rows = flag.row.map_or(0.4, |row| f64::from(u32::try_from(row).unwrap_or(0)) + 0.9);
        pen.line([lane.x + flag.x, lane.y], [lane.x + flag.x, lane.y + rows * ROW]);
    }
    pen.close();
    for flag in flags {
        let Some(row) = flag.row else { continue };
        let below = f64::from(u32::try_from(row).unwrap_or(0)) + 0.85;
        pen.text("request", [lane.x + flag.spread[0], lane.y + below * ROW], TEXT, Anchor::Start, INK, &flag.words);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(time: f64, words: &str) -> Request {
        Request { time, words: vec![words.into()] }
    }

    #[test]
    fn no_words_overlap_and_no_staff_crosses_any() {
        let names = ["start", "hold", "joystick z-", "feed 50", "estop", "rapid-override 100"];
        let mut requests: Vec<Request> =
            (0..60_u32).map(|k| asked(f64::from(k * k % 977) / 100.0, names[(k % 6) as usize])).collect();
        requests.sort_by(|a, b| a.time.total_cmp(&b.time));
        let flags = flags(&requests, 10.0, 900.0);
        let mut placed = 0;
        for (k, flag) in flags.iter().enumerate() {
            let Some(row) = flag.row else { continue };
            placed += 1;
            for other in flags.iter().enumerate().filter(|(j, _)| *j != k).map(|(_, other)| other) {
                let (Some(above), [left, right], [from, to]) = (other.row, flag.spread, other.spread) else { continue };
                assert!(above != row || right <= from || to <= left, "{flag:?} over {other:?}");
                assert!(above >= row || flag.x < from || flag.x > to, "the staff of {flag:?} crosses {other:?}");
            }
        }
        assert!(placed > 30, "{placed}");
    }
}
