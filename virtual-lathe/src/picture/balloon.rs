//! Puts names and numbers next to the places they belong to, where nothing else is drawn.

use std::f64::consts::TAU;

use crate::picture::layout::TEXT;
use crate::picture::pen::{Anchor, INK, Pen, Point, Stroke};
use crate::picture::room::Room;
use crate::picture::text::{self, DIGIT_HEIGHT};
use crate::picture::view::Rect;

/// Radius of the ring around the place an inset shows.
pub(crate) const RING: f64 = 7.5;

/// Radius of the circle around a number.
pub(crate) const BALLOON: f64 = 10.5;

/// Size of the number in it.
const NUMBER: f64 = 13.0;

/// White room kept around names and balloons.
const CLEARANCE: f64 = 4.0;

/// From a mark to its name.
const NAME_GAP: f64 = 10.0;

/// Directions that are tried.
const DIRECTIONS: u32 = 24;

/// What it costs to cover something, to have a leader cross something, and to be a unit farther away.
const COSTS: [f64; 3] = [8.0, 2.0, 0.25];

/// Middle of a box of the given size near `place`, with least in its way; the room it gets is taken. `away` gives
/// the middle from the place, for a direction (cosine, sine) and a distance from place to box.
fn settle(room: &mut Room, place: Point, size: Point, nearest: f64, away: impl Fn(f64, f64, f64) -> Point) -> Point {
    let mut best: Option<(f64, Point)> = None;
    for farther in [0.0, 8.0, 18.0, 32.0, 52.0, 80.0, 120.0] {
        for k in 0..DIRECTIONS {
            // To the upper right first: of equals, the first is chosen.
            let (sine, cosine) = (TAU * (0.125 + f64::from(k) / f64::from(DIRECTIONS))).sin_cos();
            let [right, up] = away(cosine, sine, nearest + farther);
            let middle = [place[0] + right, place[1] - up];
            let Some(covered) = room.taken_in(around(middle, size)) else {
                continue;
            };
            let edge = [place[0] + cosine * nearest, place[1] - sine * nearest];
            let crossed = room.taken_along(edge, middle);
            let cost = covered as f64 * COSTS[0] + crossed as f64 * COSTS[1] + farther * COSTS[2];
            if best.is_none_or(|(known, _)| cost < known) {
                best = Some((cost, middle));
            }
        }
    }
    let middle = best.map_or(place, |(_, middle)| middle);
    room.take_rect(around(middle, size));
    middle
}

/// The box of a size, with clearance.
fn around(middle: Point, [width, height]: Point) -> Rect {
    Rect { x: middle[0] - width / 2.0, y: middle[1] - height / 2.0, width, height }.inset(-CLEARANCE)
}

/// Takes the room of a mark.
pub(crate) fn take_mark(room: &mut Room, place: Point, radius: f64) {
    room.take_rect(around(place, [2.0 * (radius - CLEARANCE); 2]));
}

/// A number in a circle.
pub(crate) fn numbered(pen: &mut Pen, middle: Point, number: usize) {
    pen.open("balloon", Stroke::solid(INK, 1.2));
    pen.circle(middle, BALLOON, Some("#ffffff"));
    pen.close();
    let baseline = [middle[0], middle[1] + DIGIT_HEIGHT * NUMBER / 2.0];
    let number = number.to_string();
    pen.text("number", baseline, NUMBER, Anchor::Middle, INK, &number);
}

/// Rings around the places of the insets, with leaders to their numbers.
pub(crate) fn rings(pen: &mut Pen, room: &mut Room, places: &[Point]) {
    for place in places {
        take_mark(room, *place, RING);
    }
    for (place, number) in places.iter().zip(1..) {
        let round = |cosine: f64, sine: f64, distance: f64| [cosine, sine].map(|part| part * (distance + BALLOON));
        let middle = settle(room, *place, [2.0 * BALLOON; 2], RING + 6.0, round);
        let [dx, dy] = [middle[0] - place[0], middle[1] - place[1]];
        let length = dx.hypot(dy).max(1.0);
        let on_way = |distance: f64| {
            let part = distance / length;
            [place[0] + part * dx, place[1] + part * dy]
        };
        pen.open("ring", Stroke::solid(INK, 1.2));
        pen.circle(*place, RING, None);
        if length > RING + BALLOON {
            pen.line(on_way(RING), on_way(length - BALLOON));
        }
        pen.close();
        numbered(pen, middle, number);
    }
}

/// A name beside a mark.
pub(crate) fn named(pen: &mut Pen, room: &mut Room, place: Point, name: &str) {
    let height = DIGIT_HEIGHT * TEXT;
    let size = [text::width(name, TEXT), height];
    let beside = |cosine: f64, sine: f64, distance: f64| {
        // On a rectangle, so that the name is as near above as beside.
        let whole = 1.0 / f64::max(cosine.abs(), sine.abs());
        [cosine * whole * (distance + size[0] / 2.0), sine * whole * (distance + size[1] / 2.0)]
    };
    let middle = settle(room, place, size, NAME_GAP, beside);
    let baseline = [middle[0], middle[1] + height / 2.0];
    pen.text("mark", baseline, TEXT, Anchor::Middle, INK, name);
}
