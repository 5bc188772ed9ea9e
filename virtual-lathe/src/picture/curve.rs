//! True curves as polylines, as far as a view shows them.
//!
//! Under magnification the radius of an arc can be a million units, far more than the single precision of an SVG
//! renderer bears. So the part inside the view is found first, in closed form, and only that becomes a polyline.

use std::f64::consts::TAU;

use crate::picture::TrueCurve;
use crate::picture::pen::Point;
use crate::picture::view::{Rect, View};

/// Largest distance of the polyline from the curve, in units.
const SAGITTA: f64 = 0.05;

/// Most segments for one stretch of an arc, whatever the scale.
const MOST_SEGMENTS: u32 = 2_000;

/// Ends closer than this, in mm, make an arc a full turn.
const CLOSED: f64 = 1e-9;

/// Part of a circle, by angle.
struct Sweep {
    centre: [f64; 2],
    radius: f64,
    /// Angle where it begins, from +Z towards +X.
    begin: f64,
    /// 1 towards +X, -1 the other way.
    sense: f64,
    /// Angle turned through, positive.
    turn: f64,
}

impl Sweep {
    fn new(centre: [f64; 2], from: [f64; 2], to: [f64; 2], clockwise: bool) -> Self {
        let angle = |p: [f64; 2]| (p[1] - centre[1]).atan2(p[0] - centre[0]);
        let sense = if clockwise { -1.0 } else { 1.0 };
        let begin = angle(from);
        let is_closed = (from[0] - to[0]).hypot(from[1] - to[1]) < CLOSED;
        let turn = if is_closed { TAU } else { ((angle(to) - begin) * sense).rem_euclid(TAU) };
        Self { centre, radius: (from[0] - centre[0]).hypot(from[1] - centre[1]), begin, sense, turn }
    }

    /// Position after turning through `turned`.
    fn at(&self, turned: f64) -> [f64; 2] {
        let (sine, cosine) = (self.begin + self.sense * turned).sin_cos();
        [self.centre[0] + self.radius * cosine, self.centre[1] + self.radius * sine]
    }

    /// Where the sweep may enter or leave `view`: its ends, and where it crosses the lines of the four edges.
    fn crossings(&self, view: &View) -> Vec<f64> {
        let (low, high) = (view.low, view.high());
        let mut found = vec![0.0, self.turn];
        for (edge, middle, quarter) in [
            (low[0], self.centre[0], 0.0),
            (high[0], self.centre[0], 0.0),
            (low[1], self.centre[1], TAU / 4.0),
            (high[1], self.centre[1], TAU / 4.0),
        ] {
            let half = ((edge - middle) / self.radius).acos(); // NaN: it does not come that far
            for angle in [quarter - half, quarter + half] {
                let turned = ((angle - self.begin) * self.sense).rem_euclid(TAU);
                if turned < self.turn {
                    found.push(turned);
                }
            }
        }
        found.sort_by(f64::total_cmp);
        found
    }

    /// The stretch between two angles as points of the sheet.
    fn stretch(&self, view: &View, from: f64, to: f64) -> Vec<Point> {
        let flat = 1.0 - SAGITTA / (self.radius * view.scale);
        let widest = 2.0 * flat.max(0.0).acos();
        let wanted = ((to - from) / widest).ceil();
        let segments = (1..MOST_SEGMENTS).find(|count| f64::from(*count) >= wanted).unwrap_or(MOST_SEGMENTS);
        (0..=segments)
            .map(|k| {
                let part = f64::from(k) / f64::from(segments);
                view.at(self.at(from + part * (to - from)))
            })
            .collect()
    }
}

/// The parts of `curve` that `view` shows, inside `frame`, as polylines of the sheet.
pub(crate) fn visible(curve: &TrueCurve, view: &View, frame: Rect) -> Vec<Vec<Point>> {
    let lines = match *curve {
        TrueCurve::Line { from, to } => vec![vec![view.at(from), view.at(to)]],
        TrueCurve::Arc { centre, from, to, clockwise } => {
            let sweep = Sweep::new(centre, from, to, clockwise);
            let turns = sweep.crossings(view);
            turns
                .iter()
                .zip(turns.iter().skip(1))
                .filter(|(enter, leave)| view.rect.inset(-1.0).contains(view.at(sweep.at((*enter + *leave) / 2.0))))
                .map(|(enter, leave)| sweep.stretch(view, *enter, *leave))
                .collect()
        }
    };
    lines
        .iter()
        .filter(|line| line.iter().flatten().all(|part| part.is_finite()))
        .flat_map(|line| frame.clip_line(line))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Rect = Rect { x: 0.0, y: 0.0, width: 200.0, height: 200.0 };

    fn arc(from: [f64; 2], to: [f64; 2], clockwise: bool) -> TrueCurve {
        TrueCurve::Arc { centre: [0.0, 0.0], from, to, clockwise }
    }

    #[test]
    fn the_way_round_decides_which_part_is_seen() {
        let top = View::centred(FRAME, [0.0, 20.0], 10_000.0);
        let [left, right] = [[-20.0, 0.0], [20.0, 0.0]];
        assert_eq!(visible(&arc(left, right, true), &top, FRAME).len(), 1);
        assert!(visible(&arc(left, right, false), &top, FRAME).is_empty());
        assert_eq!(visible(&arc(right, left, false), &top, FRAME).len(), 1);
        assert_eq!(visible(&arc(right, right, false), &top, FRAME).len(), 1);
    }

    #[test]
    fn a_magnified_arc_stays_on_its_circle() {
        let view = View::centred(FRAME, [12.0, 16.0], 8_000.0);
        let lines = visible(&arc([20.0, 0.0], [-20.0, 0.0], false), &view, FRAME);
        assert_eq!(lines.len(), 1);
        let line = lines.first().unwrap();
        assert!(line.len() >= 2);
        for [right, down] in line {
            let z = view.low[0] + right / view.scale;
            let x = view.low[1] + (FRAME.height - down) / view.scale;
            assert!((z.hypot(x) - 20.0).abs() * view.scale < SAGITTA * 1.01);
        }
    }

    #[test]
    fn a_circle_inside_the_view_is_whole_and_one_around_it_is_not_seen() {
        let view = View::centred(FRAME, [0.0, 0.0], 5.0);
        let length = |lines: &[Vec<Point>]| -> f64 {
            lines
                .iter()
                .flat_map(|line| line.iter().zip(line.iter().skip(1)))
                .map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]))
                .sum()
        };
        let inside = visible(&arc([10.0, 0.0], [10.0, 0.0], true), &view, FRAME);
        assert!((length(&inside) - TAU * 50.0).abs() < 1.0);
        assert!(visible(&arc([90.0, 0.0], [90.0, 0.0], true), &view, FRAME).is_empty());
        let nothing = visible(&arc([0.0, 0.0], [0.0, 0.0], true), &view, FRAME);
        assert!(length(&nothing) < 1e-6);
    }
}
