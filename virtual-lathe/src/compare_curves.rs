//! The third sheet of `compare-methods`: every kind of curve, its steps as the channel's train plays them, and how far each
//! is from the curve's equation.

use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

use interp_core::block::{Builder, Chain, Motion, Pace, Path, Pieces};
use interp_core::config::Machine;
use interp_core::curve::conic::{Ellipse, Parabola};
use interp_core::curve::method::Method;
use interp_core::curve::prepare_arc::Reach;
use interp_core::sampled::curves::{Hyperbola, SineWave, Spiral, TiltedEllipse};
use interp_core::sampled::nurbs::{Nurbs, Weight};
use interp_core::sampled::spline::Spline;
use interp_core::sampled::{CurveRefusal, Sampled};
use interp_core::units::{Axis, Feedrate, Length, Point, Sense};

use crate::compare_methods::{length, machine, play};
use crate::picture::Panel;

/// Name of the files.
pub(crate) const NAME: &str = "curves";
/// Title of the sheet.
pub(crate) const TITLE: &str = "Every kind of curve, pulses of 10 \u{b5}m";

/// What makes a curve's motions from where the builder stands.
type Build = fn(&mut Builder) -> Vec<Motion>;

/// A curve: title, X and Z in pulses for a parameter of 0 to 1, and its motions.
struct Kind(&'static str, fn(f64) -> (f64, f64), Build);

const PACE: fn() -> Pace = || Feedrate::from_nm_per_min(60_000_000).map_or(Pace::Rapid, Pace::Feed);

const KINDS: [Kind; 10] = [
    Kind("line", |t| (9.0 * t, -26.0 * t), |b| path(b, Path::Line, (9, -26))),
    Kind(
        "circle",
        |t| (11.0 * (TAU * t).sin(), 11.0 * (TAU * t).cos()),
        |b| path(b, Path::Arc { centre: (0, 0), sense: Sense::CounterClockwise }, (0, 11)),
    ),
    Kind(
        "ellipse",
        |t| (8.0 * (TAU * t).sin(), 15.0 * (TAU * t).cos()),
        |b| {
            let ellipse = Ellipse { centre: (0, 0), half_axes: (length(8), length(15)) };
            let pieces = Pieces::ellipse(b, &ellipse, point((0, 15)), (Sense::CounterClockwise, Reach::Long), PACE());
            parts(b, pieces.ok())
        },
    ),
    Kind(
        "parabola",
        |t| (-12.0 + 24.0 * t, (-12.0 + 24.0 * t).powi(2) / 12.0),
        |b| {
            let parabola = Parabola { vertex: (0, 0), axis: Axis::Z, parameter: length(6) };
            let pieces = Pieces::parabola(b, &parabola, point((12, 12)), PACE());
            parts(b, pieces.ok())
        },
    ),
    Kind(
        "ellipse at 30\u{b0}",
        |t| tilted(16.0 * (TAU * t).cos(), 7.0 * (TAU * t).sin(), PI / 6.0),
        |b| {
            let curve = TiltedEllipse::new(zero(), (length(16), length(7)), angle(PI / 6.0, 60), (0, angle(TAU, 60)));
            chain(b, curve)
        },
    ),
    Kind(
        "hyperbola",
        |t| {
            let v: f64 = -12.0 + 24.0 * t;
            tilted(7.0 * (1.0 + (v / 5.0).powi(2)).sqrt(), v, 0.2)
        },
        |b| {
            let way = (length(-12), length(12));
            chain(b, Hyperbola::new(zero(), (length(7), length(5)), angle(0.2, 60), way))
        },
    ),
    Kind(
        "sine",
        |t| (-7.0 * (TAU * 1.75 * t).sin(), -35.0 * t),
        |b| chain(b, SineWave::new(zero(), length(7), length(20), 0, length(-35))),
    ),
    Kind(
        "Archimedean spiral",
        |t| ((2.0 + 11.0 * t) * (TAU * 2.5 * t).sin(), (2.0 + 11.0 * t) * (TAU * 2.5 * t).cos()),
        |b| chain(b, Spiral::new(zero(), (length(2), length(13)), 0, angle(TAU * 2.5, 30))),
    ),
    Kind("cubic spline", spline_at, |b| chain(b, spline())),
    Kind("NURBS, three quarters", quarters_at, |b| {
        let weights = [Weight::ONE, Weight::parse("0.70710678118").unwrap_or(Weight::ONE)];
        let corners = [(0, 12), (12, 12), (12, 0), (12, -12), (0, -12), (-12, -12), (-12, 0)];
        let control: Vec<_> = corners.iter().zip(weights.iter().cycle()).map(|(at, w)| (point(*at), *w)).collect();
        chain(b, Nurbs::new(2, &control, &[0, 0, 0, 1, 1, 2, 2, 3, 3, 3].map(|knot: u32| knot << 16)))
    }),
];

/// The panels of the sheet.
pub(crate) fn panels() -> Vec<Panel> {
    let machine = machine(Method::MinimumDeviation);
    KINDS.iter().map(|kind| kind.panel(&machine)).collect()
}

impl Kind {
    fn panel(&self, machine: &Machine) -> Panel {
        let Self(title, curve, build) = self;
        let dense: Vec<_> = (0..=2000).map(|k| curve(f64::from(k) / 2000.0)).collect();
        let start = curve(0.0);
        let nm = |pulses: f64| Length::from_nm(nearest(pulses * 1e4)).unwrap_or_default();
        let mut builder = Builder::new(machine, Point { x: nm(start.0), z: nm(start.1) });
        let from = builder.lattice();
        let motions = build(&mut builder);
        let steps = play(machine, from, &motions);
        let errors = steps.iter().map(|at| distance(&dense, (f64::from(at.0), f64::from(at.1)))).collect();
        let place = |(x, z): (f64, f64)| [z, x];
        Panel {
            title: (*title).into(),
            curve: dense.into_iter().map(place).collect(),
            steps: steps.into_iter().map(|(x, z)| [f64::from(z), f64::from(x)]).collect(),
            errors,
        }
    }
}

/// Distance from a polyline, positive on its left.
fn distance(curve: &[(f64, f64)], (x, z): (f64, f64)) -> f64 {
    let mut best = f64::MAX;
    for pair in curve.windows(2) {
        let [a, b] = pair else { continue };
        let (dx, dz) = (b.0 - a.0, b.1 - a.1);
        let square = (dx * dx + dz * dz).max(f64::MIN_POSITIVE);
        let t = (((x - a.0) * dx + (z - a.1) * dz) / square).clamp(0.0, 1.0);
        let off = (x - a.0 - t * dx).hypot(z - a.1 - t * dz);
        if off < best.abs() {
            let left = (x - a.0) * dz - (z - a.1) * dx;
            best = off.copysign(left);
        }
    }
    best
}

fn path(builder: &mut Builder, path: Path, end: (i32, i32)) -> Vec<Motion> {
    builder.motion(path, point(end), PACE()).motions.into_iter().collect()
}

fn parts(builder: &mut Builder, pieces: Option<Pieces>) -> Vec<Motion> {
    pieces
        .into_iter()
        .flat_map(|mut pieces| std::iter::from_fn(|| pieces.next_motion(builder)).collect::<Vec<_>>())
        .collect()
}

fn chain<C: Sampled>(builder: &mut Builder, curve: Result<C, CurveRefusal>) -> Vec<Motion> {
    let chain = curve.and_then(|curve| Chain::new(builder, curve, PACE()));
    // the curves of this list are right: a test runs them
    let Ok(mut chain) = chain else { return Vec::new() };
    std::iter::from_fn(|| chain.next_motion(builder)).filter_map(Result::ok).collect()
}

fn zero() -> (Length, Length) {
    (Length::ZERO, Length::ZERO)
}

fn point((x, z): (i32, i32)) -> Point {
    Point { x: length(x), z: length(z) }
}

#[expect(clippy::cast_possible_truncation, reason = "far below 2^63")]
fn nearest(value: f64) -> i64 {
    value.round() as i64
}

/// Radians as fixed point.
fn angle(radians: f64, bits: i32) -> i64 {
    nearest(radians * 2.0_f64.powi(bits))
}

fn tilted(u: f64, v: f64, tilt: f64) -> (f64, f64) {
    (u * tilt.sin() + v * tilt.cos(), u * tilt.cos() - v * tilt.sin())
}

fn spline() -> Result<Spline<8>, CurveRefusal> {
    Spline::new(&[(0, 0), (9, -6), (5, -15), (-4, -19), (3, -30)].map(point))
}

/// Its own samples: the spline's equation has a test of its own.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "2^32 and 2^40"
)]
fn spline_at(t: f64) -> (f64, f64) {
    let (x, z) = spline().map_or((0, 0), |spline| spline.at((t * interp_core::sampled::WHOLE as f64) as u64));
    (x as f64 / 4096.0 / 1e4, z as f64 / 4096.0 / 1e4)
}

/// The rational quadratic of each quarter, which is a circle.
fn quarters_at(t: f64) -> (f64, f64) {
    let quarter = (t * 3.0).floor().min(2.0);
    let u = t * 3.0 - quarter;
    let (a, b, c) = ((1.0 - u).powi(2), FRAC_1_SQRT_2 * 2.0 * u * (1.0 - u), u * u);
    let (sine, cosine) = ((b + c) / (a + b + c) * 12.0, (a + b) / (a + b + c) * 12.0);
    let turn = quarter * PI / 2.0;
    (sine * turn.cos() + cosine * turn.sin(), cosine * turn.cos() - sine * turn.sin())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_curve_is_followed_to_its_end() {
        for (panel, Kind(title, curve, _)) in panels().iter().zip(&KINDS) {
            let (x, z) = curve(1.0);
            let end = panel.steps.last().unwrap();
            assert!((end[0] - z).abs() <= 0.5 + 1e-6 && (end[1] - x).abs() <= 0.5 + 1e-6, "{title} ends at {end:?}");
            assert!(panel.steps.len() > 20, "{title}");
            let worst = panel.errors.iter().fold(0.0_f64, |worst, error| worst.max(error.abs()));
            let exact = ["line", "circle", "ellipse", "parabola"].contains(title);
            assert!(worst <= if exact { 0.51 } else { 1.5 }, "{title}: {worst}");
        }
    }
}
