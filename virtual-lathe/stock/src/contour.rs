//! The programmed contour: what the nose leaves when the programmed point follows the program's curves exactly.
//!
//! There is no nose-radius compensation (G41, G42) in the machine yet, so the programmed path is that of the programmed
//! point of the tool (the imaginary tip, or the nose's centre for tip 9). The contour is the envelope of the nose along
//! that path, which is the path of its centre offset by its radius to the side of the work. It is sampled, and a sample
//! that any other part of the path takes away is no part of the contour. Each sample has its normal, along which the
//! cut surface is measured.

use crate::bar::{Bar, BarData};
use crate::geometry::Point;
use crate::reach::ContourError;
use crate::sweep::Sweep;
use crate::tool::{Part, Tool};

/// How far chords of an arc may lie from it, mm: a thousandth of a pulse.
const SAGITTA: f64 = 5e-6;
/// Most chords of one arc.
pub(crate) const MOST_CHORDS: f64 = 20_000.0;
/// Distance of samples, mm, unless the contour is very long.
const SPACING: f64 = 0.01;
/// Most samples, about.
const MOST_SAMPLES: f64 = 60_000.0;
/// A sample that the exact path takes away by more than this, mm, is hidden.
const HIDDEN: f64 = 1e-4;
/// A surface of a smaller radius, mm, is a corner.
const SHARP: f64 = 0.02;
/// Samples of a group.
const GROUP: usize = 32;
/// Above a sample by more than this, mm, a tool does not count as having been there.
const NEAR: f64 = 0.02;

/// A curve of the program along which material is cut, for the programmed point; in mm.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Curve {
    /// Line of the program.
    pub line: u32,
    /// Where it begins.
    pub from: Point,
    /// Where it ends.
    pub to: Point,
    /// Centre of an arc, and whether it turns clockwise (Z to the right, X upward). An arc that ends where it begins
    /// is a full circle.
    pub arc: Option<(Point, bool)>,
}

impl Curve {
    /// The curve as a polyline, both ends among its points.
    #[must_use]
    pub fn chords(&self) -> Vec<Point> {
        let Some((centre, clockwise)) = self.arc else { return vec![self.from, self.to] };
        let (a, b) = (self.from - centre, self.to - centre);
        let (radius, end) = (a.length(), b.length());
        let sense = if clockwise { -1.0 } else { 1.0 };
        let begin = a.x.atan2(a.z);
        let mut turn = ((b.x.atan2(b.z) - begin) * sense).rem_euclid(std::f64::consts::TAU);
        if (self.from - self.to).length() < 1e-9 {
            turn = std::f64::consts::TAU;
        }
        let widest = 2.0 * (1.0 - SAGITTA / radius.max(SAGITTA)).acos();
        let count = (turn / widest).ceil().clamp(1.0, MOST_CHORDS);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 1 to MOST_CHORDS")]
        let parts = count as u32;
        (0..=parts)
            .map(|k| {
                let part = f64::from(k) / count;
                let (sine, cosine) = (begin + sense * turn * part).sin_cos();
                // the two radii may differ a little
                centre + Point::new(cosine, sine) * (radius + (end - radius) * part)
            })
            .collect()
    }
}

/// A place of the contour.
#[derive(Copy, Clone, Debug)]
pub struct Sample {
    /// The place, mm.
    pub place: Point,
    /// Unit vector into the work.
    pub normal: Point,
    /// Line of the program that makes it.
    pub line: u32,
    /// Length of contour that it stands for, mm.
    pub weight: f64,
    /// How far beyond the place material is gone, mm; below zero it stays short of it. Minus infinity: never reached.
    pub depth: f64,
    /// Place in the order of the program.
    pub order: usize,
    /// Radius of the surface there as programmed, mm: negative for a hollow; `None` where it is straight.
    pub arc: Option<f64>,
}

/// The sampled contour.
#[derive(Clone, Debug, Default)]
pub struct Contour {
    samples: Vec<Sample>,
    groups: Vec<Group>,
    clusters: Vec<Group>,
    /// Where the contour leaves the bar other than by its face, if it does: line and place.
    pub(crate) leaves: Option<(u32, Point)>,
    pub(crate) errors: Vec<ContourError>,
}

/// The box around some samples.
#[derive(Copy, Clone, Debug)]
struct Group {
    z: [f64; 2],
    x: [f64; 2],
}

impl Group {
    fn around(samples: &[Sample]) -> Self {
        let mut group = Self { z: [f64::INFINITY, f64::NEG_INFINITY], x: [f64::INFINITY, f64::NEG_INFINITY] };
        for Sample { place, .. } in samples {
            group.z = [group.z[0].min(place.z), group.z[1].max(place.z)];
            group.x = [group.x[0].min(place.x), group.x[1].max(place.x)];
        }
        group
    }

    #[inline]
    fn may_meet(&self, sweep: &Sweep<'_>) -> bool {
        let [z, x] = [self.z, self.x].map(|[low, high]| [low - NEAR, high + NEAR]);
        !sweep.misses(z, x)
    }
}

impl Contour {
    /// The contour that `tool` makes of a bar along `curves`, which are in the order of the program.
    #[must_use]
    pub fn new(curves: &[Curve], tool: &Tool, bar: BarData) -> Self {
        let length: f64 = curves.iter().map(|curve| polyline_length(&curve.chords())).sum();
        let spacing = SPACING.max(length / MOST_SAMPLES);
        let mut contour = Self::default();
        for curve in curves {
            contour.sample(curve, tool, spacing);
        }
        contour.samples.retain(|sample| is_on(bar, sample.place));
        contour.group();
        for curve in curves {
            let chords = curve.chords();
            for (from, to) in chords.iter().zip(chords.iter().skip(1)) {
                contour.mow(&Sweep::new(tool, tool.centre(*from), tool.centre(*to)), |_, _| {});
            }
        }
        contour.samples.retain(|sample| sample.depth.abs() <= HIDDEN);
        for sample in &mut contour.samples {
            sample.depth = f64::NEG_INFINITY;
        }
        contour.group();
        if !tool.is_facing() {
            contour.check(curves, tool, bar);
        }
        contour
    }

    fn sample(&mut self, curve: &Curve, tool: &Tool, spacing: f64) {
        let chords = curve.chords();
        let radius = curve.arc.map(|(centre, _)| (curve.from - centre).length());
        let mut walked = 0.0;
        let mut due = 0.0;
        let total = polyline_length(&chords);
        let count = (total / spacing).ceil().max(1.0);
        let step = total / count;
        for (&from, &to) in chords.iter().zip(chords.iter().skip(1)) {
            let chord = to - from;
            let length = chord.length();
            if length <= 0.0 {
                continue;
            }
            let across = chord.left() * (1.0 / length);
            let side = [across, -across].into_iter().find(|side| tool.touches(*side));
            while due + step / 2.0 <= walked + length {
                if let Some(normal) = side {
                    let on_path = from + chord * ((due + step / 2.0 - walked) / length);
                    // on the true arc, not on its chord
                    let (on_path, normal) = match curve.arc {
                        Some((centre, _)) => on_arc(on_path, normal, centre, radius.unwrap_or_default()),
                        None => (on_path, normal),
                    };
                    let arc = curve.arc.map(|(centre, _)| {
                        let outward = (on_path - centre).dot(normal) < 0.0;
                        let r = radius.unwrap_or_default();
                        if outward { r - tool.nose() } else { -(r + tool.nose()) }
                    });
                    due += step;
                    // at a sharp corner a normal says little: a pulse beside it is seen as many along it
                    if arc.is_some_and(|radius: f64| radius.abs() < SHARP) {
                        continue;
                    }
                    self.samples.push(Sample {
                        place: tool.centre(on_path) + normal * tool.nose(),
                        normal,
                        line: curve.line,
                        weight: step,
                        depth: f64::NEG_INFINITY,
                        order: self.samples.len(),
                        arc,
                    });
                } else {
                    due += step;
                }
            }
            walked += length;
        }
    }

    /// Sorts by Z and boxes the samples.
    fn group(&mut self) {
        self.samples.sort_by(|a, b| a.place.z.total_cmp(&b.place.z));
        self.groups = self.samples.chunks(GROUP).map(Group::around).collect();
        self.clusters = self.samples.chunks(GROUP * GROUP).map(Group::around).collect();
    }

    /// Takes away what a sweep passes over. `deeper` is told of each sample that loses material: which, and by what
    /// part of the tool.
    #[inline]
    pub(crate) fn mow(&mut self, sweep: &Sweep<'_>, mut deeper: impl FnMut(&Sample, Part)) {
        for (cluster, bounds) in self.clusters.iter().enumerate() {
            if !bounds.may_meet(sweep) {
                continue;
            }
            for number in cluster * GROUP..((cluster + 1) * GROUP).min(self.groups.len()) {
                if !self.groups.get(number).is_some_and(|group| group.may_meet(sweep)) {
                    continue;
                }
                let end = ((number + 1) * GROUP).min(self.samples.len());
                for sample in self.samples.get_mut(number * GROUP..end).into_iter().flatten() {
                    let Some(exit) = sweep.exit(sample.place, sample.normal) else { continue };
                    if exit.at <= sample.depth || exit.at < -NEAR {
                        continue;
                    }
                    // only what reaches the sample from outside: not what passes by on the far side of the work
                    let Some(enter) = sweep.exit(sample.place, -sample.normal) else { continue };
                    if -enter.at <= sample.depth.max(0.0) {
                        sample.depth = exit.at;
                        deeper(sample, sweep.part(exit, sample.place, sample.normal));
                    }
                }
            }
        }
    }

    /// Measures what no tool came near to: how far the material stands above the contour.
    pub(crate) fn measure_rest(&mut self, bar: &Bar) {
        let BarData { radius, back, face, .. } = bar.data();
        let step = bar.width();
        let farthest = 2.0 * radius + (face - back);
        for sample in self.samples.iter_mut().filter(|sample| sample.depth < -NEAR) {
            let is_material = |above: f64| bar.is_material(sample.place - sample.normal * above);
            let mut above = 0.0;
            while above < farthest && is_material(above + step) {
                above += step;
            }
            // the surface lies in the next step
            let mut beyond = above + step;
            for _ in 0..16 {
                let middle = f64::midpoint(above, beyond);
                if is_material(middle) { above = middle } else { beyond = middle }
            }
            sample.depth = -above;
        }
    }

    /// The samples, sorted by Z.
    #[must_use]
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// What the bar and the tool can't give, the first of each kind.
    #[must_use]
    pub fn errors(&self) -> &[ContourError] {
        &self.errors
    }

    /// Where the contour runs out of the bar other than by its face: line and place.
    #[must_use]
    pub fn leaves(&self) -> Option<(u32, Point)> {
        self.leaves
    }
}

pub(crate) fn is_on(bar: BarData, place: Point) -> bool {
    (bar.back..=bar.face).contains(&place.z) && (bar.bore..=bar.radius).contains(&place.x)
}

/// A place on a chord moved onto its arc, with the normal there.
fn on_arc(on_chord: Point, normal: Point, centre: Point, radius: f64) -> (Point, Point) {
    let from = on_chord - centre;
    let length = from.length();
    if length <= 0.0 {
        return (on_chord, normal);
    }
    let outward = from * (1.0 / length);
    (centre + outward * radius, if outward.dot(normal) < 0.0 { -outward } else { outward })
}

fn polyline_length(points: &[Point]) -> f64 {
    points.iter().zip(points.iter().skip(1)).map(|(a, b)| (*b - *a).length()).sum()
}
