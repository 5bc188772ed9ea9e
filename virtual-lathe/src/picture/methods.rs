//! A sheet of `compare-methods`: a panel for each method or curve, its steps over the true curve and their error below.

use crate::picture::TrueCurve;
use crate::picture::pen::{Anchor, GREY, INK, Pen, Point, Stroke};

/// One method on one curve; all in pulses, `[z, x]`.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Name of the method.
    pub title: String,
    /// What should be followed, as a polyline.
    pub curve: Vec<[f64; 2]>,
    /// Lattice points visited.
    pub steps: Vec<[f64; 2]>,
    /// Signed distance of each from the curve, pulses.
    pub errors: Vec<f64>,
}

const COLUMNS: usize = 3;
const MARGIN: f64 = 24.0;
const PANEL: [f64; 2] = [368.0, 400.0];
/// Drawing field and error strip inside a panel.
const FIELD: [f64; 2] = [352.0, 260.0];
const STRIP: f64 = 72.0;
const HEAD: f64 = 34.0;

const CURVE: &str = "#c0392b";
const STEP: &str = "#1f4e79";
const GRID: &str = "#dddddd";

/// Draws the sheet.
pub fn methods(title: &str, panels: &[Panel]) -> String {
    let rows = panels.len().div_ceil(COLUMNS);
    let columns = f64::from(u32::try_from(COLUMNS).unwrap_or(1));
    let width = 2.0 * MARGIN + columns * PANEL[0];
    let height = 2.0 * MARGIN + HEAD + f64::from(u32::try_from(rows).unwrap_or(1)) * PANEL[1];
    let mut pen = Pen::sheet(width, height, 1200);
    pen.text("title", [MARGIN, MARGIN + 14.0], 20.0, Anchor::Start, INK, title);
    let lattice = "blue: steps from lattice point to lattice point; red: the curve; below: distance from it in pulses";
    pen.text("key", [width - MARGIN, MARGIN + 13.0], 12.0, Anchor::End, GREY, lattice);
    for (number, panel) in panels.iter().enumerate() {
        let place = |n: usize| f64::from(u32::try_from(n).unwrap_or(0));
        let corner = [MARGIN + place(number % COLUMNS) * PANEL[0], MARGIN + HEAD + place(number / COLUMNS) * PANEL[1]];
        draw(&mut pen, panel, corner);
    }
    pen.finish()
}

/// A true curve as a polyline.
pub fn polyline(curve: &TrueCurve) -> Vec<[f64; 2]> {
    match *curve {
        TrueCurve::Line { from, to } => vec![from, to],
        TrueCurve::Arc { centre, from, to, clockwise } => {
            let angle = |at: [f64; 2]| (at[1] - centre[1]).atan2(at[0] - centre[0]);
            let turn = std::f64::consts::TAU;
            let sweep = (angle(to) - angle(from)).rem_euclid(turn);
            let sweep = if clockwise { sweep - turn } else { sweep };
            let radius = (from[0] - centre[0]).hypot(from[1] - centre[1]);
            (0..=180)
                .map(|k| angle(from) + sweep * f64::from(k) / 180.0)
                .map(|a| [centre[0] + radius * a.cos(), centre[1] + radius * a.sin()])
                .collect()
        }
    }
}

fn draw(pen: &mut Pen, panel: &Panel, [left, top]: Point) {
    let worst = panel.errors.iter().fold(0.0_f64, |worst, error| worst.max(error.abs()));
    pen.text("method", [left, top + 18.0], 15.0, Anchor::Start, INK, &panel.title);
    let label = format!("at most {worst:.2} pulses");
    pen.text("worst", [left + FIELD[0], top + 18.0], 12.0, Anchor::End, GREY, &label);
    let top = top + 28.0;
    let curve = &panel.curve;
    // the smallest or largest [z, x] of all points
    let bound = |pick: fn(f64, f64) -> f64, start: f64| {
        let join = |[z, x]: [f64; 2], at: &[f64; 2]| [pick(z, at[0]), pick(x, at[1])];
        panel.steps.iter().chain(curve).fold([start; 2], join)
    };
    let low = bound(f64::min, f64::MAX).map(|least| least.floor() - 1.0);
    let high = bound(f64::max, f64::MIN).map(|most| most.ceil() + 1.0);
    let scale = (FIELD[0] / (high[0] - low[0])).min(FIELD[1] / (high[1] - low[1]));
    let inset = [(FIELD[0] - scale * (high[0] - low[0])) / 2.0, (FIELD[1] - scale * (high[1] - low[1])) / 2.0];
    let view = |at: [f64; 2]| [left + inset[0] + (at[0] - low[0]) * scale, top + inset[1] + (high[1] - at[1]) * scale];
    pen.open("lattice", Stroke::solid(GRID, 0.6));
    let lines =
        |from: f64, to: f64| std::iter::successors(Some(from), |at| Some(at + 1.0)).take_while(move |at| *at <= to);
    for z in lines(low[0], high[0]) {
        pen.line(view([z, low[1]]), view([z, high[1]]));
    }
    for x in lines(low[1], high[1]) {
        pen.line(view([low[0], x]), view([high[0], x]));
    }
    pen.close();
    pen.open("curve", Stroke::solid(CURVE, 1.6));
    pen.path(&[curve.iter().map(|at| view(*at)).collect()]);
    pen.close();
    let steps: Vec<_> = panel.steps.iter().map(|at| view(*at)).collect();
    pen.open("steps", Stroke::solid(STEP, 1.8));
    pen.path(std::slice::from_ref(&steps));
    pen.dots(&steps, 2.6, STEP);
    pen.close();
    strip(pen, &panel.errors, [left, top + FIELD[1] + 16.0]);
}

/// The error of each step, from -1 to 1 pulse.
fn strip(pen: &mut Pen, errors: &[f64], [left, top]: Point) {
    let half = STRIP / 2.0;
    // one pulse and a little
    let unit = half / 1.15;
    let middle = top + half;
    let from = left + 26.0;
    let across = FIELD[0] - 26.0;
    pen.open("scale", Stroke::solid(GRID, 0.8));
    for pulses in [-1.0, -0.5, 0.5, 1.0] {
        pen.line([from, middle - pulses * unit], [from + across, middle - pulses * unit]);
    }
    pen.close();
    pen.open("zero", Stroke::solid(CURVE, 1.0));
    pen.line([from, middle], [from + across, middle]);
    pen.close();
    for (pulses, text) in [(1.0, "1"), (0.0, "0"), (-1.0, "-1")] {
        pen.text("mark", [from - 5.0, middle - pulses * unit + 4.0], 11.0, Anchor::End, GREY, text);
    }
    let count = f64::from(u32::try_from(errors.len()).unwrap_or(u32::MAX)).max(2.0) - 1.0;
    let mut at = 0.0;
    let points: Vec<Point> = errors
        .iter()
        .map(|error| {
            let point = [from + across * at / count, middle - error * unit];
            at += 1.0;
            point
        })
        .collect();
    pen.open("error", Stroke::solid(STEP, 1.4));
    pen.path(std::slice::from_ref(&points));
    pen.dots(&points, 1.6, STEP);
    pen.close();
}
