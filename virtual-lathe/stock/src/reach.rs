//! What a bar and a tool can't give: a part larger than the bar, a slope that an edge is in the way of.
//!
//! Only what no other part of the path goes below counts: a pass in the air above the part is no part of it.

use std::fmt;

use crate::bar::BarData;
use crate::contour::{Contour, Curve, MOST_CHORDS, is_on};
use crate::geometry::Point;
use crate::tool::{Part, Tool};

/// Lengths and places nearer than this, mm, are the same: several pulses.
const TOLERANCE: f64 = 0.01;
/// So much length, mm, has to be wrong before it counts.
const LEAST: f64 = 0.05;
/// Longest piece that is judged as one, mm.
const PIECE: f64 = 0.25;
/// A path steeper than this (the cosine of its slope) is a plunge, which has no side.
const STEEP: f64 = 0.02;

/// The program asks for what this bar and this tool can't give.
#[derive(Copy, Clone, Debug, PartialEq)]
pub enum ContourError {
    /// The contour lies outside the bar.
    TooThin {
        /// Line of the program.
        line: u32,
        /// Diameter that the contour needs, mm.
        needed: f64,
        /// Diameter of the bar, mm.
        diameter: f64,
    },
    /// The contour lies behind the back end of the bar.
    TooShort {
        /// Line of the program.
        line: u32,
        /// Z that the contour needs, mm.
        needed: f64,
        /// Z of the bar's back end, mm.
        back: f64,
    },
    /// The contour lies in the bore of the bar.
    TooHollow {
        /// Line of the program.
        line: u32,
        /// Diameter that the contour needs, mm.
        needed: f64,
        /// Bore of the bar, mm.
        bore: f64,
    },
    /// An edge of the tool lies in the work there.
    Unreachable {
        /// Line of the program.
        line: u32,
        /// Slope of the contour against the axis, degrees, as the tool sees it.
        slope: f64,
        /// The edge that is in the way.
        part: Part,
    },
}

impl fmt::Display for ContourError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooThin { line, needed, diameter } => {
                write!(f, "line {line}: the part needs a diameter of {needed:.3} mm, the bar has {diameter:.3} mm")
            }
            Self::TooShort { line, needed, back } => {
                write!(f, "line {line}: the part needs material down to Z{needed:.3}, the bar ends at Z{back:.3}")
            }
            Self::TooHollow { line, needed, bore } => {
                write!(
                    f,
                    "line {line}: the part needs material at a diameter of {needed:.3} mm, the bore has {bore:.3} mm"
                )
            }
            Self::Unreachable { line, slope, part } => {
                let edge = if *part == Part::Front { "front" } else { "back" };
                write!(f, "line {line}: the tool can't reach: the contour slopes at {slope:.1} degrees, and the ")?;
                write!(f, "{edge} edge would be in the work")
            }
        }
    }
}

impl std::error::Error for ContourError {}

impl Contour {
    /// Looks for what can't be made.
    pub(crate) fn check(&mut self, curves: &[Curve], tool: &Tool, bar: BarData) {
        let floor = Floor::new(curves, tool, bar);
        let sign = if tool.is_inside() { 1.0 } else { -1.0 };
        let mut out_of_reach = 0.0;
        for curve in curves {
            let mut stretch = Stretch::default();
            let pieces = pieces(&curve.chords());
            for (&from, &to) in pieces.iter().zip(pieces.iter().skip(1)) {
                let chord = to - from;
                let length = chord.length();
                if chord.z.abs() < STEEP * length || length <= 0.0 {
                    continue;
                }
                let across = chord.left() * (1.0 / length);
                let normal = if across.x * sign > 0.0 { across } else { -across };
                let middle = (from + to) * 0.5;
                if !floor.is_floor(middle) {
                    continue;
                }
                let [a, b] = [from, to].map(|end| tool.centre(end) + normal * tool.nose());
                stretch.add(a, b, bar);
                if is_on(bar, (a + b) * 0.5) && !touches_nearly(tool, normal) {
                    out_of_reach += length;
                    if out_of_reach > LEAST {
                        let slope = chord.x.abs().atan2(chord.z.abs()).to_degrees();
                        self.note(ContourError::Unreachable { line: curve.line, slope, part: tool.obstacle(normal) });
                    }
                }
            }
            self.fits(curve.line, &stretch, tool, bar);
        }
    }

    /// Whether the contour that a curve makes lies on the bar: one that runs out of it is told, one that lies beside it
    /// is an error.
    fn fits(&mut self, line: u32, stretch: &Stretch, tool: &Tool, bar: BarData) {
        let Stretch { on, above, below, behind } = stretch;
        if let Some(place) = on {
            let out = if tool.is_inside() { below } else { above };
            if self.leaves.is_none() && (out.length > LEAST || behind.length > LEAST) {
                self.leaves = Some((line, *place));
            }
            return;
        }
        if above.length > LEAST && !tool.is_inside() {
            self.note(ContourError::TooThin { line, needed: 2.0 * above.farthest, diameter: 2.0 * bar.radius });
        }
        if below.length > LEAST && tool.is_inside() {
            self.note(ContourError::TooHollow { line, needed: 2.0 * below.farthest, bore: 2.0 * bar.bore });
        }
        if behind.length > LEAST {
            self.note(ContourError::TooShort { line, needed: behind.farthest, back: bar.back });
        }
    }

    /// Keeps the first error of each kind; of sizes, the greatest need.
    fn note(&mut self, error: ContourError) {
        let same = |other: &ContourError| std::mem::discriminant(other) == std::mem::discriminant(&error);
        match self.errors.iter_mut().find(|other| same(other)) {
            None => self.errors.push(error),
            Some(known) => match (known, error) {
                (ContourError::TooThin { needed, .. }, ContourError::TooThin { needed: more, .. }) => {
                    *needed = needed.max(more);
                }
                (ContourError::TooShort { needed, .. }, ContourError::TooShort { needed: more, .. })
                | (ContourError::TooHollow { needed, .. }, ContourError::TooHollow { needed: more, .. }) => {
                    *needed = needed.min(more);
                }
                _ => {}
            },
        }
    }
}

/// What of a curve lies where, as seen from the bar.
#[derive(Debug, Default)]
struct Stretch {
    /// The last place on the bar.
    on: Option<Point>,
    above: Beside,
    below: Beside,
    behind: Beside,
}

/// Contour beside the bar.
#[derive(Copy, Clone, Debug, Default)]
struct Beside {
    /// Along Z, mm.
    length: f64,
    /// The greatest need: radius or Z, mm.
    farthest: f64,
}

impl Beside {
    fn add(&mut self, length: f64, need: f64, greater: bool) {
        let is_first = self.length <= 0.0;
        self.length += length;
        let is_farther = if greater { need > self.farthest } else { need < self.farthest };
        if is_first || is_farther {
            self.farthest = need;
        }
    }
}

impl Stretch {
    fn add(&mut self, a: Point, b: Point, bar: BarData) {
        let along = (b.z - a.z).abs();
        let is_longitudinal = along >= (b.x - a.x).abs();
        let (low, high) = (a.x.min(b.x), a.x.max(b.x));
        let (left, right) = (a.z.min(b.z), a.z.max(b.z));
        if right < bar.back - TOLERANCE {
            if low < bar.radius {
                self.behind.add(along, left, false);
            }
        } else if left > bar.back && right < bar.face {
            if low > bar.radius + TOLERANCE {
                if is_longitudinal {
                    self.above.add(along, high, true);
                }
            } else if high < bar.bore - TOLERANCE {
                if is_longitudinal {
                    self.below.add(along, low, false);
                }
            } else {
                self.on = Some(if is_on(bar, a) { a } else { b });
            }
        }
    }
}

/// Whether the nose touches a surface, or nearly: an edge may lie along it.
fn touches_nearly(tool: &Tool, normal: Point) -> bool {
    let turned = |angle: f64| {
        let (sine, cosine) = angle.sin_cos();
        Point::new(normal.z * cosine - normal.x * sine, normal.z * sine + normal.x * cosine)
    };
    [0.0, 0.002, -0.002].into_iter().any(|angle| tool.touches(turned(angle)))
}

/// A polyline with its long chords cut into pieces, of which a part may be hidden or off the bar.
fn pieces(points: &[Point]) -> Vec<Point> {
    let mut all: Vec<Point> = points.first().copied().into_iter().collect();
    for (&from, &to) in points.iter().zip(points.iter().skip(1)) {
        let parts = ((to - from).length() / PIECE).ceil().clamp(1.0, MOST_CHORDS);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 1 to MOST_CHORDS")]
        let count = parts as u32;
        all.extend((1..=count).map(|k| from + (to - from) * (f64::from(k) / parts)));
    }
    all
}

/// The deepest that the programmed point goes at each Z.
struct Floor {
    back: f64,
    width: f64,
    deepest: Vec<f64>,
    inside: bool,
}

/// Most stretches of Z of a floor.
const MOST_FLOOR: f64 = 20_000.0;

impl Floor {
    fn new(curves: &[Curve], tool: &Tool, bar: BarData) -> Self {
        let ends = curves.iter().flat_map(|curve| [curve.from.z, curve.to.z]);
        let (back, face) = ends.fold((bar.back, bar.face), |(low, high), z| (low.min(z), high.max(z)));
        let width = ((face - back) / MOST_FLOOR).max(0.01);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most MOST_FLOOR")]
        let count = ((face - back) / width).ceil().max(1.0) as usize;
        let inside = tool.is_inside();
        let none = if inside { f64::NEG_INFINITY } else { f64::INFINITY };
        let mut floor = Self { back, width, deepest: vec![none; count], inside };
        for curve in curves {
            let chords = curve.chords();
            for (from, to) in chords.iter().zip(chords.iter().skip(1)) {
                floor.line(*from, *to);
            }
        }
        floor
    }

    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the stretches")]
    fn cell(&self, z: f64) -> usize {
        (((z - self.back) / self.width).max(0.0) as usize).min(self.deepest.len().saturating_sub(1))
    }

    fn line(&mut self, from: Point, to: Point) {
        let (a, b) = if from.z < to.z { (from, to) } else { (to, from) };
        let (first, last) = (self.cell(a.z), self.cell(b.z));
        for cell in first..=last {
            #[expect(clippy::cast_precision_loss, reason = "at most MOST_FLOOR")]
            let middle = self.back + (cell as f64 + 0.5) * self.width;
            let part = if b.z > a.z { ((middle - a.z) / (b.z - a.z)).clamp(0.0, 1.0) } else { 0.0 };
            let x = if b.z > a.z {
                a.x + (b.x - a.x) * part
            } else if self.inside {
                a.x.max(b.x)
            } else {
                a.x.min(b.x)
            };
            if let Some(deepest) = self.deepest.get_mut(cell) {
                *deepest = if self.inside { deepest.max(x) } else { deepest.min(x) };
            }
        }
    }

    /// Whether nothing goes deeper than a place of the path, by more than a little.
    fn is_floor(&self, place: Point) -> bool {
        let deepest = self.deepest.get(self.cell(place.z)).copied().unwrap_or(place.x);
        if self.inside { place.x >= deepest - 3.0 * self.width } else { place.x <= deepest + 3.0 * self.width }
    }
}
