//! The panel of an inset: the lattice of the pulses, the points visited, and the true curve through them.

use std::ops::RangeInclusive;

use crate::picture::layout::{LINE, TEXT, WIDE_PANEL};
use crate::picture::number::{Ticks, brief, fixed, multiples};
use crate::picture::pen::{Anchor, GREY, INK, Pen, Point, Stroke};
use crate::picture::view::{Rect, View};
use crate::picture::{Inset, balloon, curve, text};

/// Lines of the lattice.
pub(crate) const LATTICE: Stroke = Stroke::solid("#cfcfcf", 0.8);
/// From one visited point to the next.
pub(crate) const STEPS: Stroke = Stroke::solid(INK, 1.0);
/// What the points follow.
pub(crate) const TRUE_CURVE: Stroke = Stroke::solid("#d1361c", 2.0);
/// Radius of a visited point, at most.
pub(crate) const DOT: f64 = 4.0;

/// The least radius that still reads as a dot.
const LEAST_DOT: f64 = 1.2;
/// Radius of a dot in parts of a square.
const DOT_SHARE: f64 = 0.24;
/// Squares narrower than this are drawn several in one.
const LEAST_SQUARE: f64 = 4.5;
/// Most pulses to a square.
const MOST_PULSES: f64 = 1e6;
/// Size of the heading.
const HEADING: f64 = 14.0;
/// Pulses in half a panel when nobody says how many.
const DEFAULT_HALF: f64 = 10.0;
/// Sizes of pulses, in mm, that can be drawn.
const PULSES: RangeInclusive<f64> = 1e-6..=1e3;
/// Half widths of panels, in mm, that can be drawn.
const HALF_WIDTHS: RangeInclusive<f64> = 1e-7..=1e5;

/// A pulse size that can be drawn.
fn is_usable(pulse: [f64; 2]) -> bool {
    pulse.iter().all(|size| PULSES.contains(size))
}

/// What the panel shows of the plane.
fn view(inset: &Inset, frame: Rect) -> View {
    let half = if HALF_WIDTHS.contains(&inset.half_width) {
        inset.half_width
    } else if is_usable(inset.pulse) {
        DEFAULT_HALF * inset.pulse[0]
    } else {
        1.0
    };
    View::centred(frame, inset.centre, frame.width / (2.0 * half))
}

/// Pulses to one square of the lattice as drawn: 1, or the next round number that keeps the squares apart.
fn pulses_per_square(pulse: [f64; 2], scale: f64) -> f64 {
    let narrowest = pulse[0].min(pulse[1]) * scale;
    Ticks::at_least((LEAST_SQUARE / narrowest).clamp(1.0, MOST_PULSES)).step
}

/// The panel of inset `number`, counted from 1.
pub(crate) fn draw(pen: &mut Pen, inset: &Inset, number: usize, frame: Rect) {
    let view = view(inset, frame);
    let inner = frame.inset(1.0);
    if is_usable(inset.pulse) {
        lattice(pen, inset.pulse, &view);
        steps(pen, inset, &view, inner);
    }
    let lines: Vec<Vec<Point>> = inset.curves.iter().flat_map(|curve| curve::visible(curve, &view, inner)).collect();
    pen.open("true-curve", TRUE_CURVE);
    pen.path(&lines);
    pen.close();
    if is_usable(inset.pulse) {
        dots(pen, inset, &view, inner);
    }
    pen.open("panel", Stroke::solid(INK, 1.0));
    pen.rect([frame.x, frame.y], [frame.width, frame.height]);
    pen.close();
    heading(pen, inset, number, frame);
    captions(pen, inset, &view);
}

fn lattice(pen: &mut Pen, pulse: [f64; 2], view: &View) {
    let (frame, low, high) = (view.rect, view.low, view.high());
    let pulses = pulses_per_square(pulse, view.scale);
    if pulses * pulse[0].min(pulse[1]) * view.scale < LEAST_SQUARE / 2.0 {
        return;
    }
    let mut lines = Vec::new();
    for z in multiples(pulses * pulse[0], low[0], high[0]) {
        let [x, _] = view.at([z, low[1]]);
        lines.push(vec![[x, frame.y], [x, frame.bottom()]]);
    }
    for x in multiples(pulses * pulse[1], low[1], high[1]) {
        let [_, y] = view.at([low[0], x]);
        lines.push(vec![[frame.x, y], [frame.right(), y]]);
    }
    pen.open("lattice", LATTICE);
    pen.path(&lines);
    pen.close();
}

/// Where a lattice point lies on the sheet.
fn place([z, x]: [i32; 2], pulse: [f64; 2], view: &View) -> Point {
    view.at([f64::from(z) * pulse[0], f64::from(x) * pulse[1]])
}

/// Lines between successive points.
fn steps(pen: &mut Pen, inset: &Inset, view: &View, inner: Rect) {
    let is_step = |a: &[i32; 2], b: &[i32; 2]| a[0].abs_diff(b[0]) <= 1 && a[1].abs_diff(b[1]) <= 1;
    let lines: Vec<Vec<Point>> = inset
        .visited
        .chunk_by(is_step)
        .flat_map(|run| {
            let on_sheet: Vec<Point> = run.iter().map(|point| place(*point, inset.pulse, view)).collect();
            inner.clip_line(&on_sheet)
        })
        .collect();
    pen.open("steps", STEPS);
    pen.path(&lines);
    pen.close();
}

/// A dot on every point, unless they would run into each other.
fn dots(pen: &mut Pen, inset: &Inset, view: &View, inner: Rect) {
    let square = inset.pulse[0].min(inset.pulse[1]) * view.scale;
    let radius = (square * DOT_SHARE).clamp(LEAST_DOT, DOT);
    if square < LEAST_DOT {
        return;
    }
    let within = inner.inset(radius);
    let mut centres: Vec<Point> = inset
        .visited
        .iter()
        .map(|point| place(*point, inset.pulse, view))
        .filter(|point| within.contains(*point))
        .collect();
    centres.dedup_by(|a, b| (a[0] - b[0]).hypot(a[1] - b[1]) < 0.01);
    pen.open("visited", STEPS);
    pen.dots(&centres, radius, INK);
    pen.close();
}

fn heading(pen: &mut Pen, inset: &Inset, number: usize, frame: Rect) {
    let middle = [frame.x + balloon::BALLOON, frame.y - balloon::BALLOON - 5.0];
    balloon::numbered(pen, middle, number);
    let left = middle[0] + balloon::BALLOON + 8.0;
    let title = text::fit(&inset.title, HEADING, frame.right() - left);
    let baseline = [left, middle[1] + 0.36 * HEADING];
    pen.text("heading", baseline, HEADING, Anchor::Start, INK, &title);
}

/// What a square is, and where the panel lies.
fn captions(pen: &mut Pen, inset: &Inset, view: &View) {
    let frame = view.rect;
    let mut scale_note = String::new();
    if is_usable(inset.pulse) {
        let pulses = pulses_per_square(inset.pulse, view.scale);
        let (factor, unit) = if inset.pulse[0] * pulses < 1.0 { (1_000.0, "µm") } else { (1.0, "mm") };
        let [z, x] = inset.pulse.map(|size| brief(size * pulses * factor, 4));
        scale_note = format!("one square = {z} × {x} {unit}");
        if pulses > 1.0 {
            scale_note = format!("{scale_note} ({} pulses)", brief(pulses, 0));
        }
    }
    let [z, x] = inset.centre.map(|part| fixed(part, 4));
    let place = format!("centre Z {z}, X {x} mm");
    let baseline = frame.bottom() + LINE - 1.0;
    let is_wide = frame.width >= WIDE_PANEL;
    let room = frame.width / if is_wide { 2.0 } else { 1.0 } - 8.0;
    let (at, anchor) =
        if is_wide { ([frame.right(), baseline], Anchor::End) } else { ([frame.x, baseline + LINE], Anchor::Start) };
    let scale_note = text::fit(&scale_note, TEXT, room);
    pen.text("scale", [frame.x, baseline], TEXT, Anchor::Start, INK, &scale_note);
    let place = text::fit(&place, TEXT, room);
    pen.text("place", at, TEXT, anchor, GREY, &place);
}
