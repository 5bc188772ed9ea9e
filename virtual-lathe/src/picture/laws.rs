//! The sheet of the speed laws: speed, acceleration and jerk over time, a panel for each move.

use crate::picture::number::Ticks;
use crate::picture::pen::{Anchor, GREY, INK, Pen, Point, Stroke};
use crate::picture::text;

/// One move under several laws.
#[derive(Clone, Debug)]
pub struct LawPanel {
    /// What moves.
    pub title: String,
    /// A speed to be seen, mm/s, and what it is.
    pub level: Option<(f64, String)>,
    /// Name of each law and its speed in each millisecond, mm/s.
    pub laws: Vec<(String, Vec<f64>)>,
}

const COLUMNS: usize = 2;
const MARGIN: f64 = 24.0;
const HEAD: f64 = 44.0;
/// Room of a panel, and of the curves in it.
const PANEL: [f64; 2] = [588.0, 500.0];
const WIDE: f64 = 500.0;
/// Left of the curves: labels.
const GUTTER: f64 = 58.0;
const STRIP: f64 = 118.0;
const GAP: f64 = 26.0;
const GRID: &str = "#e6e6e6";
const LEVEL: Stroke = Stroke { colour: "#555555", width: 1.0, dashes: "5 3" };
const TEXT: f64 = 12.0;
/// Of the laws, in their order.
const STROKES: [Stroke; 3] = [
    Stroke { colour: "#888888", width: 1.3, dashes: "" },
    Stroke { colour: "#1f4e79", width: 1.8, dashes: "" },
    Stroke { colour: "#c0392b", width: 1.8, dashes: "" },
];

/// Places by number.
fn place(number: usize) -> f64 {
    f64::from(u32::try_from(number).unwrap_or(0))
}

/// Draws the sheet; `jerk` is the largest, mm/s3.
pub fn laws(title: &str, jerk: f64, panels: &[LawPanel]) -> String {
    let rows = panels.len().div_ceil(COLUMNS);
    let width = 2.0 * MARGIN + place(COLUMNS) * PANEL[0];
    let height = 2.0 * MARGIN + HEAD + place(rows) * PANEL[1];
    let mut pen = Pen::sheet(width, height, 1200);
    pen.text("title", [MARGIN, MARGIN + 14.0], 20.0, Anchor::Start, INK, title);
    let names: Vec<_> = panels.first().iter().flat_map(|panel| &panel.laws).map(|(name, _)| name.as_str()).collect();
    let mut right = width - MARGIN;
    for (name, stroke) in names.iter().zip(STROKES).rev() {
        pen.text("legend", [right, MARGIN + 13.0], 14.0, Anchor::End, INK, name);
        right -= text::width(name, 14.0) + 8.0;
        pen.open("sample", stroke);
        pen.line([right - 34.0, MARGIN + 8.0], [right, MARGIN + 8.0]);
        pen.close();
        right -= 34.0 + 24.0;
    }
    for (number, panel) in panels.iter().enumerate() {
        let corner = [MARGIN + place(number % COLUMNS) * PANEL[0], MARGIN + HEAD + place(number / COLUMNS) * PANEL[1]];
        draw(&mut pen, panel, jerk, corner);
    }
    pen.finish()
}

/// Changes in each millisecond, times `scale`.
fn changes(values: &[f64], scale: f64) -> Vec<f64> {
    let before = std::iter::once(&0.0).chain(values);
    values.iter().zip(before).map(|(now, before)| (now - before) * scale).collect()
}

fn draw(pen: &mut Pen, panel: &LawPanel, jerk: f64, [left, top]: Point) {
    pen.text("move", [left, top + 12.0], 15.0, Anchor::Start, INK, &panel.title);
    let longest = panel.laws.iter().map(|(_, speeds)| speeds.len()).max().unwrap_or(1);
    let fastest = panel.laws.iter().flat_map(|(_, speeds)| speeds).fold(1.0_f64, |most, speed| most.max(*speed));
    let accelerations: Vec<_> = panel.laws.iter().map(|(_, speeds)| changes(speeds, 1e3)).collect();
    let mut from = [left + GUTTER, top + 40.0];
    let kinds = [
        ("speed, mm/s", [0.0, 1.1 * fastest]),
        ("acceleration, mm/s²", [-640.0, 640.0]),
        ("jerk, 1000 mm/s³", [-1.3 * jerk / 1e3, 1.3 * jerk / 1e3]),
    ];
    for (kind, (name, range)) in kinds.into_iter().enumerate() {
        let curves: Vec<Vec<f64>> = match kind {
            0 => panel.laws.iter().map(|(_, speeds)| speeds.clone()).collect(),
            1 => accelerations.clone(),
            _ => accelerations.iter().map(|acceleration| changes(acceleration, 1.0)).collect(),
        };
        let level = match kind {
            0 => panel.level.iter().map(|(speed, name)| (*speed, name.as_str())).collect(),
            1 => Vec::new(),
            _ => vec![(jerk / 1e3, "max_jerk"), (-jerk / 1e3, "max_jerk")],
        };
        strip(pen, name, range, place(longest), &level, &curves, from);
        from[1] += STRIP + GAP;
    }
    let time = Ticks::at_least(70.0 * place(longest) / WIDE);
    let bottom = from[1] - GAP;
    for ms in time.labelled(0.0, place(longest)) {
        let x = from[0] + ms / place(longest) * WIDE;
        pen.text("tick", [x, bottom + 16.0], TEXT, Anchor::Middle, INK, &time.label(ms));
    }
    pen.text("axis", [from[0] + WIDE, bottom + 32.0], TEXT, Anchor::End, GREY, "time, ms");
}

/// One quantity over `span` milliseconds. What is beyond the range ends at the frame.
fn strip(
    pen: &mut Pen,
    name: &str,
    [low, high]: [f64; 2],
    span: f64,
    levels: &[(f64, &str)],
    curves: &[Vec<f64>],
    [left, top]: Point,
) {
    let at = |ms: f64, value: f64| -> Point {
        [left + ms / span * WIDE, top + STRIP - (value.clamp(low, high) - low) / (high - low) * STRIP]
    };
    let (up, along) = (Ticks::at_least(26.0 * (high - low) / STRIP), Ticks::at_least(70.0 * span / WIDE));
    pen.open("grid", Stroke::solid(GRID, 0.8));
    for value in up.labelled(low, high) {
        pen.line(at(0.0, value), at(span, value));
    }
    for ms in along.labelled(0.0, span) {
        pen.line(at(ms, low), at(ms, high));
    }
    pen.close();
    pen.open("level", LEVEL);
    for (value, _) in levels {
        pen.line(at(0.0, *value), at(span, *value));
    }
    pen.close();
    for (values, stroke) in curves.iter().zip(STROKES) {
        pen.open("curve", stroke);
        pen.path(&[values.iter().enumerate().map(|(ms, value)| at(place(ms), *value)).collect()]);
        pen.close();
    }
    pen.open("frame", Stroke::solid(INK, 1.0));
    pen.rect([left, top], [WIDE, STRIP]);
    pen.close();
    for value in up.labelled(low, high) {
        let [x, y] = at(0.0, value);
        pen.text("tick", [x - 6.0, y + 0.36 * TEXT], TEXT, Anchor::End, INK, &up.label(value));
    }
    pen.text("axis", [left, top - 6.0], TEXT, Anchor::Start, INK, name);
    for (_, name) in levels.iter().take(1) {
        pen.text("level", [left + WIDE, top - 6.0], TEXT, Anchor::End, GREY, &format!("dashed: {name}"));
    }
}
