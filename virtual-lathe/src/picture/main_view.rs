//! The path in the ZX plane, with its ends and the places of the insets.

use crate::picture::layout::Layout;
use crate::picture::pen::{INK, Pen, Point, Stroke};
use crate::picture::room::Room;
use crate::picture::view::{View, is_drawable};
use crate::picture::{Drawing, Kind, arrows, axes, balloon, section, thin};

/// Rotation axis of the work.
pub(crate) const CENTRE_LINE: Stroke = Stroke { colour: "#555555", width: 0.9, dashes: "18 4 3 4" };

/// Radius of the marks at the ends of the path.
const MARK: f64 = 4.2;

/// Below this distance, in units, the path ends where it starts.
const SAME_PLACE: f64 = 4.0;

/// Deviation of what is drawn from what is given, in units: far below what shows.
const INVISIBLE: f64 = 0.04;

/// How a kind of track is drawn. In black and white, the weight tells an arc from a straight feed.
pub(crate) const fn stroke(kind: Kind) -> Stroke {
    match kind {
        Kind::Rapid => Stroke { colour: "#6b6b6b", width: 1.0, dashes: "6 4" },
        Kind::Feed => Stroke::solid(INK, 1.5),
        Kind::Arc => Stroke::solid("#1668b8", 3.0),
        Kind::Thread => Stroke { colour: "#8a2f8a", width: 2.2, dashes: "9 3 2 3" },
    }
}

/// Kinds in the order they are drawn: cuts over rapids, thin lines over thick ones.
const KINDS: [Kind; 4] = [Kind::Rapid, Kind::Arc, Kind::Thread, Kind::Feed];

const fn class(kind: Kind) -> &'static str {
    match kind {
        Kind::Rapid => "track rapid",
        Kind::Feed => "track feed",
        Kind::Arc => "track arc",
        Kind::Thread => "track thread",
    }
}

/// Whether the centre line is in sight.
pub(crate) fn shows_centre_line(view: &View) -> bool {
    view.low[1] <= 0.0 && view.high()[1] >= 0.0
}

/// The main view in full.
pub(crate) fn draw(pen: &mut Pen, drawing: &Drawing, layout: &Layout) {
    let view = &layout.main;
    let mut room = Room::new(view.rect);
    axes::grid(pen, layout);
    if let Some(work) = &drawing.section {
        section::draw(pen, &mut room, work, view);
    }
    centre_line(pen, &mut room, view);
    let lines = lines(drawing, view);
    for kind in KINDS {
        tracks(pen, &mut room, &lines, kind);
    }
    let places = places(drawing, view);
    arrows(pen, &lines, &places);
    axes::frame(pen, layout);
    ends(pen, &mut room, &places);
}

/// What has a place of its own on the path; `None` if it cannot be drawn.
struct Places {
    start: Option<Point>,
    end: Option<Point>,
    insets: Vec<Point>,
}

fn places(drawing: &Drawing, view: &View) -> Places {
    let place = |position| is_drawable(&position).then(|| view.at(position));
    let insets = drawing.insets.iter();
    Places {
        start: place(drawing.start),
        end: place(drawing.end),
        insets: insets.map(|inset| view.at(inset.centre)).collect(),
    }
}

/// All lines of a kind.
fn tracks(pen: &mut Pen, room: &mut Room, lines: &[(Kind, Vec<Point>)], kind: Kind) {
    let parts: Vec<Vec<Point>> = lines.iter().filter(|(of, _)| *of == kind).map(|(_, line)| line.clone()).collect();
    if parts.is_empty() {
        return;
    }
    pen.open(class(kind), stroke(kind));
    pen.path(&parts);
    pen.close();
    for line in &parts {
        for (from, to) in line.iter().zip(line.iter().skip(1)) {
            room.take_line(*from, *to);
        }
    }
}

fn arrows(pen: &mut Pen, lines: &[(Kind, Vec<Point>)], places: &Places) {
    let drawn: Vec<(Stroke, &[Point])> = lines.iter().map(|(kind, line)| (stroke(*kind), line.as_slice())).collect();
    let ends = places.start.iter().chain(&places.end);
    let avoid: Vec<Point> = ends.chain(&places.insets).copied().collect();
    arrows::draw(pen, &drawn, &avoid);
}

fn centre_line(pen: &mut Pen, room: &mut Room, view: &View) {
    if !shows_centre_line(view) {
        return;
    }
    let [_, y] = view.at([0.0, 0.0]);
    let (from, to) = ([view.rect.x, y], [view.rect.right(), y]);
    pen.open("centre-line", CENTRE_LINE);
    pen.line(from, to);
    pen.close();
    room.take_line(from, to);
}

/// The tracks on the sheet, thinned to what shows; successive ones of a kind are joined.
fn lines(drawing: &Drawing, view: &View) -> Vec<(Kind, Vec<Point>)> {
    let mut lines: Vec<(Kind, Vec<Point>)> = Vec::new();
    for track in &drawing.tracks {
        let on_sheet: Vec<Point> =
            track.points.iter().filter(|point| is_drawable(point)).map(|point| view.at(*point)).collect();
        let line = thin::thinned(&on_sheet, INVISIBLE);
        match lines.last_mut() {
            Some((kind, before)) if *kind == track.kind && is_joined(before, &line) => {
                before.extend(line.into_iter().skip(1));
            }
            _ => lines.push((track.kind, line)),
        }
    }
    lines
}

fn is_joined(before: &[Point], after: &[Point]) -> bool {
    match (before.last(), after.first()) {
        (Some(end), Some(start)) => (end[0] - start[0]).hypot(end[1] - start[1]) < INVISIBLE,
        _ => false,
    }
}

/// An open circle: the start of the path.
fn start_mark(pen: &mut Pen, at: Point) {
    pen.open("start", Stroke::solid(INK, 1.4));
    pen.circle(at, MARK, Some("#ffffff"));
    pen.close();
}

/// A small full square: its end. It fits into the circle of the start.
fn end_mark(pen: &mut Pen, [x, y]: Point, half: f64) {
    pen.open("end", Stroke::solid(INK, 1.0));
    let corners = [[x - half, y - half], [x + half, y - half], [x + half, y + half], [x - half, y + half]];
    pen.polygon(&corners, INK);
    pen.close();
}

/// Marks at both ends, then all that needs a free place: numbers of insets and names.
fn ends(pen: &mut Pen, room: &mut Room, places: &Places) {
    let (start, end) = (places.start, places.end);
    for place in [start, end].into_iter().flatten() {
        balloon::take_mark(room, place, MARK);
    }
    let is_closed = start.zip(end).is_some_and(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]) < SAME_PLACE);
    if let Some(start) = start {
        start_mark(pen, start);
    }
    if let Some(end) = end {
        end_mark(pen, end, if is_closed { 0.5 * MARK } else { 0.9 * MARK });
    }
    balloon::rings(pen, room, &places.insets);
    if let Some(start) = start {
        let name = if is_closed { "start, end" } else { "start" };
        balloon::named(pen, room, start, name);
    }
    if let Some(end) = end.filter(|_| !is_closed) {
        balloon::named(pen, room, end, "end");
    }
}
