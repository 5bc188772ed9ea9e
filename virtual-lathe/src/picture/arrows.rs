//! Arrowheads that tell which way the path was travelled: one on each of the longest lines.

use crate::picture::pen::{Pen, Point, Stroke};

/// Length and half width of an arrowhead.
const HEAD: [f64; 2] = [10.0, 3.6];

/// Shorter lines get none.
const SHORTEST: f64 = 60.0;

/// Most arrowheads in a drawing.
const MOST: usize = 24;

/// Where along its line an arrowhead may sit, best first.
const PARTS: [f64; 5] = [0.5, 0.42, 0.58, 0.3, 0.7];

/// Least distance from anything to keep clear of.
const CLEAR: f64 = 22.0;

fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn length(line: &[Point]) -> f64 {
    line.iter().zip(line.iter().skip(1)).map(|(from, to)| distance(*from, *to)).sum()
}

/// The place at a part of the length, and the direction there as a unit vector.
fn on(line: &[Point], part: f64) -> Option<(Point, Point)> {
    let mut left = part * length(line);
    for (from, to) in line.iter().zip(line.iter().skip(1)) {
        let long = distance(*from, *to);
        if long >= left && long > 0.0 {
            let way = [(to[0] - from[0]) / long, (to[1] - from[1]) / long];
            return Some(([from[0] + left * way[0], from[1] + left * way[1]], way));
        }
        left -= long;
    }
    None
}

/// Arrowheads on `lines`, each with its stroke; they keep away from the places to `avoid`.
pub(crate) fn draw(pen: &mut Pen, lines: &[(Stroke, &[Point])], avoid: &[Point]) {
    let mut longest: Vec<(f64, Stroke, &[Point])> = lines
        .iter()
        .map(|(stroke, line)| (length(line), *stroke, *line))
        .filter(|(length, ..)| *length >= SHORTEST)
        .collect();
    longest.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (_, stroke, line) in longest.into_iter().take(MOST) {
        let free = PARTS
            .into_iter()
            .filter_map(|part| on(line, part))
            .find(|(place, _)| avoid.iter().all(|other| distance(*place, *other) > CLEAR));
        if let Some((place, way)) = free {
            head(pen, stroke, place, way);
        }
    }
}

fn head(pen: &mut Pen, stroke: Stroke, [x, y]: Point, [right, down]: Point) {
    let [long, half] = HEAD;
    let half = half + stroke.width / 2.0;
    let at = |ahead: f64, aside: f64| [x + ahead * right - aside * down, y + ahead * down + aside * right];
    let corners = [at(long / 2.0, 0.0), at(-long / 2.0, half), at(-long / 2.0, -half)];
    pen.open("arrow", Stroke::solid(stroke.colour, 1.0));
    pen.polygon(&corners, stroke.colour);
    pen.close();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_a_bent_line_is_found_with_its_direction() {
        let line = [[0.0, 0.0], [10.0, 0.0], [10.0, 0.0], [10.0, 90.0]];
        let ([x, y], [right, down]) = on(&line, 0.5).unwrap();
        assert!((x - 10.0).abs() < 1e-9 && (y - 40.0).abs() < 1e-9);
        assert!(right.abs() < 1e-9 && (down - 1.0).abs() < 1e-9);
        assert!(on(&line[..1], 0.5).is_none());
    }
}
