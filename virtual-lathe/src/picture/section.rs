//! The work in half section: cut open above the centre line, seen from outside below it; the bar it was cut from, the
//! tool, and the dimensions, which stand upright in one row under the work.

use crate::picture::layout::TEXT;
use crate::picture::pen::{Anchor, INK, Pen, Point, Stroke};
use crate::picture::room::Room;
use crate::picture::view::{Rect, View};
use crate::picture::{Section, text};

/// The bar before the cut: a phantom line.
pub(crate) const BAR: Stroke = Stroke { colour: "#444444", width: 0.9, dashes: "14 3 3 3 3 3" };
/// The edges of the work.
const EDGE: Stroke = Stroke::solid(INK, 1.8);
/// Edges seen from outside, and leaders.
const THIN: Stroke = Stroke::solid("#333333", 0.8);
/// Lines of the section.
const HATCH: Stroke = Stroke::solid("#9a9a9a", 0.7);
/// The tool's outline.
pub(crate) const TOOL: Stroke = Stroke::solid(INK, 1.1);
/// Its body.
pub(crate) const TOOL_FILL: &str = "#dcdcdc";
/// Body of the work, seen from outside.
const FILL: &str = "#f3f3f3";
/// Distance of the lines of a section, units.
const HATCH_STEP: f64 = 7.0;
/// A dimension's share of the row, units.
const PITCH: f64 = 15.0;
/// From the work to the bend of a leader, and from there to the text.
const LEADER: [f64; 2] = [12.0, 22.0];
/// Room above the text row and below it.
const GAP: f64 = 5.0;
/// A step of the outline within so much of Z, mm, shows as an edge from outside.
const STEEP: f64 = 0.03;
/// Lower ones, mm, do not.
const LEAST_STEP: f64 = 0.15;

/// Corners that have to be in sight.
pub(crate) fn corners(section: &Section) -> Vec<[f64; 2]> {
    let [back, face] = section.bar_z;
    let radius = section.bar_x[1];
    vec![[back, -radius], [face, radius]]
}

/// Height of the row of dimensions, units.
pub(crate) fn foot(section: &Section) -> f64 {
    let widest = section.dimensions.iter().map(|dimension| text::width(&dimension.text, TEXT)).fold(0.0, f64::max);
    if widest > 0.0 { LEADER[0] + LEADER[1] + widest + 2.0 * GAP } else { 0.0 }
}

/// A patch of section for the legend.
pub(crate) fn sample(pen: &mut Pen, [x, y]: Point, [width, height]: [f64; 2]) {
    let patch = [[x, y], [x + width, y], [x + width, y + height], [x, y + height]];
    hatch(pen, &patch);
    pen.open("sample", Stroke::solid(INK, 1.2));
    pen.rect([x, y], [width, height]);
    pen.close();
}

/// Everything, under the path.
pub(crate) fn draw(pen: &mut Pen, room: &mut Room, section: &Section, view: &View) {
    let frame = view.rect;
    let mirrored = |line: &[[f64; 2]]| -> Vec<Point> { line.iter().map(|[z, x]| view.at([*z, -x])).collect() };
    let upper: Vec<Point> = section.outside.iter().map(|point| view.at(*point)).collect();
    let bore: Vec<Point> = section.inside.iter().map(|point| view.at(*point)).collect();
    let lower = mirrored(&section.outside);
    let body: Vec<Point> = upper.iter().copied().chain(bore.iter().rev().copied()).collect();
    let axis = |[x, _]: &Point| [*x, view.at([0.0, 0.0])[1]];
    let outside: Vec<Point> =
        lower.iter().copied().chain(lower.last().map(axis)).chain(lower.first().map(axis)).collect();
    pen.open("work outside", THIN);
    pen.shape(&outside, FILL);
    pen.path(&edges(section, view));
    pen.close();
    hatch(pen, &body);
    pen.open("work", EDGE);
    // the back end is cut off by the sheet: it has no edge
    let mut lines = vec![upper.clone(), lower.clone()];
    if let (Some(top), Some(bottom)) = (upper.last(), lower.last()) {
        lines.push(vec![*top, *bottom]);
    }
    if section.bar_x[0] > 0.0 || section.inside.iter().any(|[_, x]| *x > 0.0) {
        lines.push(bore.clone());
    }
    pen.path(&lines);
    pen.close();
    for line in [&upper, &lower] {
        for (from, to) in line.iter().zip(line.iter().skip(1)) {
            room.take_line(*from, *to);
        }
    }
    bar(pen, section, view);
    tool(pen, room, section, view, frame);
    dimensions(pen, room, section, view);
}

fn bar(pen: &mut Pen, section: &Section, view: &View) {
    let [back, face] = section.bar_z;
    let [bore, radius] = section.bar_x;
    let around = |x: f64| vec![view.at([back, x]), view.at([face, x]), view.at([face, -x]), view.at([back, -x])];
    let mut lines = vec![around(radius)];
    if bore > 0.0 {
        lines.push(around(bore));
    }
    pen.open("bar", BAR);
    pen.path(&lines);
    pen.close();
}

fn tool(pen: &mut Pen, room: &mut Room, section: &Section, view: &View, frame: Rect) {
    let corners: Vec<Point> = section.tool.iter().map(|point| view.at(*point)).collect();
    let inside = clip(&corners, frame.inset(1.0));
    pen.open("tool", TOOL);
    pen.shape(&inside, TOOL_FILL);
    pen.close();
    for (from, to) in inside.iter().zip(inside.iter().cycle().skip(1)) {
        room.take_line(*from, *to);
    }
}

/// Edges that show from outside: where the outline steps.
fn edges(section: &Section, view: &View) -> Vec<Vec<Point>> {
    let steps = section.outside.windows(2).filter_map(|pair| match pair {
        [[z0, x0], [z1, x1]] if (x1 - x0).abs() > LEAST_STEP && (z1 - z0).abs() < STEEP => {
            Some([f64::midpoint(*z0, *z1), x0.max(*x1)])
        }
        _ => None,
    });
    steps.map(|[z, x]| vec![view.at([z, 0.0]), view.at([z, -x])]).collect()
}

/// Lines at 45 degrees inside a polygon.
fn hatch(pen: &mut Pen, polygon: &[Point]) {
    let along = |[x, y]: &Point| x + y;
    let (low, high) = polygon
        .iter()
        .map(along)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    if low >= high {
        return;
    }
    let mut lines = Vec::new();
    let mut level = (low / HATCH_STEP).ceil() * HATCH_STEP;
    while level < high {
        let mut crossings: Vec<Point> = polygon
            .iter()
            .zip(polygon.iter().cycle().skip(1))
            .filter_map(|(a, b)| {
                let (p, q) = (along(a) - level, along(b) - level);
                ((p > 0.0) != (q > 0.0)).then(|| {
                    let part = p / (p - q);
                    [a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])]
                })
            })
            .collect();
        crossings.sort_by(|a, b| a[0].total_cmp(&b[0]));
        lines.extend(crossings.chunks_exact(2).map(<[Point]>::to_vec));
        level += HATCH_STEP;
    }
    pen.open("hatch", HATCH);
    pen.path(&lines);
    pen.close();
}

/// The part of a convex polygon inside a rectangle (Sutherland and Hodgman, Communications of the ACM 17(1), 1974).
fn clip(polygon: &[Point], rect: Rect) -> Vec<Point> {
    let sides: [(usize, f64, f64); 4] =
        [(0, 1.0, rect.x), (0, -1.0, -rect.right()), (1, 1.0, rect.y), (1, -1.0, -rect.bottom())];
    let mut points = polygon.to_vec();
    for (axis, sign, least) in sides {
        let depth = |point: &Point| point.get(axis).map_or(0.0, |part| sign * part - least);
        let mut kept = Vec::new();
        for (a, b) in points.iter().zip(points.iter().cycle().skip(1)) {
            let (p, q) = (depth(a), depth(b));
            if p >= 0.0 {
                kept.push(*a);
            }
            if (p >= 0.0) != (q >= 0.0) {
                let part = p / (p - q);
                kept.push([a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])]);
            }
        }
        points = kept;
    }
    points
}

/// All dimensions in one row under the work, spread so that they keep apart.
fn dimensions(pen: &mut Pen, room: &mut Room, section: &Section, view: &View) {
    if section.dimensions.is_empty() {
        return;
    }
    let mut labels: Vec<(Point, &str)> = section
        .dimensions
        .iter()
        .map(|dimension| (view.at([dimension.place[0], -dimension.place[1]]), dimension.text.as_str()))
        .collect();
    labels.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
    let frame = view.rect.inset(PITCH);
    let wanted: Vec<f64> = labels.iter().map(|(place, _)| place[0]).collect();
    let places = spread(&wanted, PITCH, [frame.x, frame.right()]);
    let bend = view.at([0.0, -section.bar_x[1]])[1] + LEADER[0];
    let row = bend + LEADER[1];
    let leaders: Vec<Vec<Point>> =
        labels.iter().zip(&places).map(|((place, _), x)| vec![*place, [place[0], bend], [*x, row - GAP]]).collect();
    pen.open("leaders", THIN);
    pen.path(&leaders);
    pen.close();
    let ends: Vec<Point> = labels.iter().map(|(place, _)| *place).collect();
    pen.open("leader ends", THIN);
    pen.dots(&ends, 1.7, INK);
    pen.close();
    for ((_, label), x) in labels.iter().zip(&places) {
        pen.upright("dimension", [*x, row], TEXT, Anchor::End, label);
        let width = text::width(label, TEXT);
        room.take_rect(Rect { x: x - PITCH / 2.0, y: row - GAP, width: PITCH, height: width + GAP });
    }
    for line in leaders {
        for (from, to) in line.iter().zip(line.iter().skip(1)) {
            room.take_line(*from, *to);
        }
    }
}

/// Places at least `pitch` apart, in order, as near to those wanted as a walk to both sides finds.
fn spread(wanted: &[f64], pitch: f64, [low, high]: [f64; 2]) -> Vec<f64> {
    // clusters of places that touch, each centred on what its members want
    let mut clusters: Vec<(f64, f64)> = Vec::new(); // sum of (wanted - offset), count
    let start = |(sum, count): &(f64, f64)| {
        let most = high - (count - 1.0) * pitch;
        (sum / count).min(most).max(low)
    };
    for want in wanted {
        clusters.push((*want, 1.0));
        while let [.., before, last] = clusters.as_mut_slice() {
            if start(before) + before.1 * pitch <= start(last) {
                break;
            }
            // the members of the last follow those of the one before
            before.0 += last.0 - last.1 * before.1 * pitch;
            before.1 += last.1;
            clusters.pop();
        }
    }
    let mut places = Vec::with_capacity(wanted.len());
    for cluster in &clusters {
        let mut at = start(cluster);
        let mut left = cluster.1;
        while left > 0.5 {
            places.push(at);
            at += pitch;
            left -= 1.0;
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_keep_apart_and_in_order() {
        let places = spread(&[1.0, 2.0, 3.0, 50.0, 99.0, 100.0], 10.0, [0.0, 100.0]);
        assert_eq!(places.len(), 6);
        assert!(places.windows(2).all(|pair| pair[1] - pair[0] >= 10.0 - 1e-9), "{places:?}");
        assert!(places.first().is_some_and(|first| *first >= 0.0));
        assert!(places.last().is_some_and(|last| *last <= 100.0 + 1e-9));
        assert!((places[3] - 50.0).abs() < 1e-9);
    }

    #[test]
    fn a_polygon_is_cut_at_the_frame() {
        let rect = Rect { x: 0.0, y: 0.0, width: 10.0, height: 10.0 };
        let inside = clip(&[[-5.0, -5.0], [5.0, -5.0], [5.0, 5.0], [-5.0, 5.0]], rect);
        assert_eq!(inside.len(), 4);
        assert!(inside.iter().all(|point| rect.contains(*point)));
        assert!(clip(&[[20.0, 20.0], [30.0, 20.0], [30.0, 30.0]], rect).is_empty());
    }
}
