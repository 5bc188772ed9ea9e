//! The curve kinds: random ones, and their equations.

use interp_core::block::{Builder, Chain, Motion, Pace, Pieces};
use interp_core::curve::conic::{Ellipse, Parabola};
use interp_core::curve::prepare_arc::Reach;
use interp_core::sampled::Sampled;
use interp_core::sampled::curves::{Hyperbola, SineWave, Spiral, TiltedEllipse, TiltedParabola};
use interp_core::sampled::nurbs::{Nurbs, Weight};
use interp_core::sampled::spline::Spline;
use interp_core::units::{Axis, Length, Point, Sense};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

/// A curve of a kind; lengths in um, angles in radians.
#[derive(Clone, Debug)]
pub(crate) enum Kind {
    Ellipse {
        half: (i32, i32),
        tilt: f64,
        from: f64,
        sweep: f64,
    },
    Hyperbola {
        half: (i32, i32),
        tilt: f64,
        way: (i32, i32),
    },
    Parabola {
        parameter: i32,
        tilt: f64,
        way: (i32, i32),
    },
    Sine {
        amplitude: i32,
        wave: i32,
        phase: f64,
        way: i32,
    },
    Spiral {
        radii: (i32, i32),
        from: f64,
        sweep: f64,
    },
    Spline {
        points: Vec<(i32, i32)>,
    },
    Nurbs {
        points: Vec<(i32, i32, u32)>,
        knots: Vec<u32>,
    },
    /// Half axes along X and Z; eccentric angle from Z toward X; a whole turn for a sweep of one.
    AxisEllipse {
        half: (i32, i32),
        from: f64,
        sweep: f64,
    },
    /// Along Z or X, positive or negative; from one place across to another.
    AxisParabola {
        parameter: i32,
        along_z: bool,
        way: (i32, i32),
    },
}

/// A curve somewhere, with the point that it begins at.
#[derive(Clone, Debug)]
pub(crate) struct Sample {
    pub(crate) kind: Kind,
    pub(crate) start: Point,
    origin: (i32, i32),
}

pub(crate) fn um(value: i32) -> Length {
    Length::from_um(value).unwrap()
}

fn radians(angle: f64) -> i64 {
    (angle * (1_u64 << 60) as f64) as i64
}

fn point((x, z): (f64, f64)) -> Point {
    let nm = |v: f64| Length::from_nm(v.round() as i64).unwrap();
    Point { x: nm(x), z: nm(z) }
}

impl Kind {
    pub(crate) fn any() -> impl Strategy<Value = Sample> {
        let size = || 300_i32..9_000;
        let angle = || -3.1_f64..3.1;
        let way = || (-6_000_i32..6_000, 200_i32..8_000).prop_map(|(from, length)| (from, from + length));
        let sweep = || prop_oneof![0.3_f64..6.2, -6.2_f64..-0.3];
        let place = || (-9_000_i32..9_000, -9_000_i32..9_000);
        let ellipse = ((size(), size()), angle(), -1.7_f64..1.7, sweep())
            .prop_map(|(half, tilt, from, sweep)| Self::Ellipse { half, tilt, from, sweep });
        let hyperbola =
            ((size(), size()), angle(), way()).prop_map(|(half, tilt, way)| Self::Hyperbola { half, tilt, way });
        let parabola =
            (size(), angle(), way()).prop_map(|(parameter, tilt, way)| Self::Parabola { parameter, tilt, way });
        let sine = (100_i32..3_000, 1_500_i32..9_000, angle(), 500_i32..15_000, any::<bool>()).prop_map(
            |(amplitude, wave, phase, way, back)| Self::Sine {
                amplitude,
                wave,
                phase,
                way: if back { -way } else { way },
            },
        );
        let spiral = ((200_i32..4_000, 200_i32..4_000), angle(), prop_oneof![1.0_f64..20.0, -20.0_f64..-1.0])
            .prop_map(|(radii, from, sweep)| Self::Spiral { radii, from, sweep });
        let spline = prop::collection::vec(place(), 2..9).prop_map(|points| Self::Spline { points });
        let control = (-9_000_i32..9_000, -9_000_i32..9_000, 1_u32..40);
        let nurbs =
            (prop::collection::vec(control, 5..10), prop::collection::vec(1_u32..5, 8)).prop_map(|(points, steps)| {
                // degree 3, clamped: as many knots inside as points less four
                let mut knots = vec![0_u32; 4];
                for step in &steps[..points.len() - 4] {
                    knots.push(knots[knots.len() - 1] + (step << 14));
                }
                let end = knots[knots.len() - 1] + (1 << 14);
                knots.extend([end; 4]);
                Self::Nurbs { points, knots }
            });
        let axis_ellipse = (size(), 0.1_f64..10.0, angle(), prop_oneof![sweep(), Just(TAU), Just(-TAU)]).prop_map(
            |(x, ratio, from, sweep)| Self::AxisEllipse {
                half: (x, ((f64::from(x) * ratio) as i32).max(250)),
                from,
                sweep,
            },
        );
        let axis_parabola = (size(), any::<bool>(), any::<bool>(), way(), any::<bool>()).prop_map(
            |(parameter, negative, along_z, (from, to), back)| Self::AxisParabola {
                parameter: if negative { -parameter } else { parameter },
                along_z,
                way: if back { (to, from) } else { (from, to) },
            },
        );
        let sampled = prop_oneof![ellipse, hyperbola, parabola, sine, spiral, spline, nurbs];
        let kind = prop_oneof![5 => sampled, 2 => axis_ellipse, 2 => axis_parabola];
        (kind, place()).prop_map(|(kind, origin)| Sample::new(kind, origin))
    }
}

/// Positions of the tridiagonal system of the natural spline, in `f64`.
fn natural(points: &[(i32, i32)], t: f64) -> (f64, f64) {
    let place = |k: usize| (f64::from(points[k].0) * 1e3, f64::from(points[k].1) * 1e3);
    let n = points.len();
    let mut knots = vec![0.0];
    for k in 1..n {
        let (a, b) = (place(k - 1), place(k));
        knots.push(knots[k - 1] + (b.0 - a.0).hypot(b.1 - a.1));
    }
    // second derivatives M: h0 M0 + 2 (h0 + h1) M1 + h1 M2 = 6 (s1 - s0), M = 0 at both ends; by relaxation
    let mut bend = vec![(0.0, 0.0); n];
    for _ in 0..40 {
        for k in 1..n - 1 {
            let (h0, h1) = (knots[k] - knots[k - 1], knots[k + 1] - knots[k]);
            let (a, b, c) = (place(k - 1), place(k), place(k + 1));
            let of = |a: f64, b: f64, c: f64, before: f64, after: f64| {
                (6.0 * ((c - b) / h1 - (b - a) / h0) - h0 * before - h1 * after) / (2.0 * (h0 + h1))
            };
            bend[k] =
                (of(a.0, b.0, c.0, bend[k - 1].0, bend[k + 1].0), of(a.1, b.1, c.1, bend[k - 1].1, bend[k + 1].1));
        }
    }
    let along = t * knots[n - 1];
    let k = (1..n - 1).find(|k| knots[*k] > along).unwrap_or(n - 1);
    let h = knots[k] - knots[k - 1];
    let (left, right) = ((along - knots[k - 1]) / h, (knots[k] - along) / h);
    let (a, b) = (place(k - 1), place(k));
    let of = |a: f64, b: f64, ma: f64, mb: f64| {
        right * a + left * b + h * h / 6.0 * ((right.powi(3) - right) * ma + (left.powi(3) - left) * mb)
    };
    (of(a.0, b.0, bend[k - 1].0, bend[k].0), of(a.1, b.1, bend[k - 1].1, bend[k].1))
}

/// The B-spline basis by its recursion.
fn basis(knots: &[u32], i: usize, degree: usize, u: f64) -> f64 {
    let knot = |k: usize| f64::from(knots[k]);
    if degree == 0 {
        let last = knot(i + 1) >= knot(knots.len() - 1) && u >= knot(i) && knot(i) < knot(i + 1);
        return f64::from(u8::from((knot(i) <= u && u < knot(i + 1)) || last));
    }
    let part = |num: f64, den: f64| if den > 0.0 { num / den } else { 0.0 };
    part(u - knot(i), knot(i + degree) - knot(i)) * basis(knots, i, degree - 1, u)
        + part(knot(i + degree + 1) - u, knot(i + degree + 1) - knot(i + 1)) * basis(knots, i + 1, degree - 1, u)
}

/// Many points of a curve, none further than `step` nm from the next, nor the curve half way from the middle between two
/// than a 20th of that: the tip of a hairpin is not left out.
fn dense(curve: &dyn Fn(f64) -> (f64, f64), step: f64) -> Vec<(f64, f64)> {
    fn between(curve: &dyn Fn(f64) -> (f64, f64), (from, to): (f64, f64), step: f64, points: &mut Vec<(f64, f64)>) {
        let (end, last, half) = (curve(to), points[points.len() - 1], f64::midpoint(from, to));
        let middle = curve(half);
        let bow = (f64::midpoint(last.0, end.0) - middle.0).hypot(f64::midpoint(last.1, end.1) - middle.1);
        if (end.0 - last.0).hypot(end.1 - last.1) > step || bow > step / 20.0 {
            between(curve, (from, half), step, points);
            between(curve, (half, to), step, points);
        } else {
            points.push(end);
        }
    }
    let mut points = vec![curve(0.0)];
    for k in 0..500 {
        between(curve, (f64::from(k) / 500.0, f64::from(k + 1) / 500.0), step, &mut points);
    }
    points
}

impl Sample {
    pub(crate) fn new(kind: Kind, origin: (i32, i32)) -> Self {
        let mut sample = Self { kind, start: Point::default(), origin };
        sample.start = point(sample.exact(0.0));
        sample
    }

    pub(crate) fn end(&self) -> Point {
        point(self.exact(1.0))
    }

    /// The curve's point at a part of its parameter, nm.
    pub(crate) fn exact(&self, t: f64) -> (f64, f64) {
        let (ox, oz) = (f64::from(self.origin.0) * 1e3, f64::from(self.origin.1) * 1e3);
        let nm = |um: i32| f64::from(um) * 1e3;
        let tilted =
            |u: f64, v: f64, tilt: f64| (ox + u * tilt.sin() + v * tilt.cos(), oz + u * tilt.cos() - v * tilt.sin());
        let over = |(from, to): (i32, i32)| nm(from) + (nm(to) - nm(from)) * t;
        match &self.kind {
            Kind::Ellipse { half, tilt, from, sweep } => {
                let angle = from + sweep * t;
                tilted(nm(half.0) * angle.cos(), nm(half.1) * angle.sin(), *tilt)
            }
            Kind::Hyperbola { half, tilt, way } => {
                let v = over(*way);
                tilted(nm(half.0) * (1.0 + (v / nm(half.1)).powi(2)).sqrt(), v, *tilt)
            }
            Kind::Parabola { parameter, tilt, way } => {
                let v = over(*way);
                tilted(v * v / 2.0 / nm(*parameter), v, *tilt)
            }
            Kind::Sine { amplitude, wave, phase, way } => {
                let along = nm(*way) * t;
                (ox + nm(*amplitude) * (phase + TAU * along / nm(*wave)).sin(), oz + along)
            }
            Kind::Spiral { radii, from, sweep } => {
                let (radius, angle) = (over(*radii), from + sweep * t);
                (ox + radius * angle.sin(), oz + radius * angle.cos())
            }
            Kind::AxisEllipse { half, from, sweep } => {
                let angle = from + sweep * t;
                (ox + nm(half.0) * angle.sin(), oz + nm(half.1) * angle.cos())
            }
            Kind::AxisParabola { parameter, along_z, way } => {
                let across = over(*way);
                let along = across * across / 2.0 / nm(*parameter);
                if *along_z { (ox + across, oz + along) } else { (ox + along, oz + across) }
            }
            Kind::Spline { points } => natural(points, t),
            Kind::Nurbs { points, knots } => {
                let (first, last) = (f64::from(knots[3]), f64::from(knots[points.len()]));
                let u = first + (last - first) * t;
                let mut sum = (0.0, 0.0, 0.0);
                for (i, (x, z, weight)) in points.iter().enumerate() {
                    let share = basis(knots, i, 3, u) * f64::from(*weight) / 8.0;
                    sum = (sum.0 + share * nm(*x), sum.1 + share * nm(*z), sum.2 + share);
                }
                (sum.0 / sum.2, sum.1 / sum.2)
            }
        }
    }

    /// How far a step may be off the programmed curve, coarser pulses: by minimum deviation one at the ends, which are
    /// rounded, and half a one between them, and what a polyline leaves out; 1.5 along chords.
    pub(crate) fn bounds(&self) -> (f64, f64) {
        if self.is_conic() { (1.0, 0.51) } else { (1.5, 1.5) }
    }

    const fn is_conic(&self) -> bool {
        matches!(self.kind, Kind::AxisEllipse { .. } | Kind::AxisParabola { .. })
    }

    /// Many points of the curve.
    pub(crate) fn dense(&self) -> Vec<(f64, f64)> {
        dense(&|t| self.exact(t), if self.is_conic() { 1_000.0 } else { 5_000.0 })
    }

    /// Nowhere so tightly bent that the quick machine would have to slow down.
    pub(crate) fn is_wide(&self) -> bool {
        let curve = dense(&|t| self.exact(t), 5_000.0);
        // 900 mm/min, 0.8 of 50 m/s2: v^2 / a is 6 um; corners of splines may be sharper
        !matches!(self.kind, Kind::Spline { .. } | Kind::Nurbs { .. })
            || curve.windows(3).all(|p| {
                let (a, b) = ((p[1].0 - p[0].0, p[1].1 - p[0].1), (p[2].0 - p[1].0, p[2].1 - p[1].1));
                let turn = (a.0 * b.1 - a.1 * b.0).atan2(a.0 * b.0 + a.1 * b.1).abs();
                turn * 50_000.0 < a.0.hypot(a.1).min(b.0.hypot(b.1))
            })
    }

    pub(crate) fn motions(&self, builder: &mut Builder, pace: Pace) -> Vec<Motion> {
        fn chain<C: Sampled + Clone>(curve: C, builder: &mut Builder, pace: Pace) -> Vec<Motion> {
            let mut chain = Chain::new(builder, curve, pace).unwrap();
            std::iter::from_fn(|| chain.next_motion(builder)).map(|motion| motion.unwrap()).collect()
        }
        let origin = (um(self.origin.0), um(self.origin.1));
        let both = |(a, b): (i32, i32)| (um(a), um(b));
        let at = |(x, z): (i32, i32)| Point { x: um(x), z: um(z) };
        match &self.kind {
            Kind::Ellipse { half, tilt, from, sweep } => {
                let way = (radians(*from), radians(from + sweep));
                chain(TiltedEllipse::new(origin, both(*half), radians(*tilt), way).unwrap(), builder, pace)
            }
            Kind::Hyperbola { half, tilt, way } => {
                chain(Hyperbola::new(origin, both(*half), radians(*tilt), both(*way)).unwrap(), builder, pace)
            }
            Kind::Parabola { parameter, tilt, way } => {
                chain(TiltedParabola::new(origin, um(*parameter), radians(*tilt), both(*way)).unwrap(), builder, pace)
            }
            Kind::Sine { amplitude, wave, phase, way } => {
                let curve = SineWave::new(origin, um(*amplitude), um(*wave), radians(*phase), um(*way)).unwrap();
                chain(curve, builder, pace)
            }
            Kind::Spiral { radii, from, sweep } => {
                let small = |angle: f64| (angle * f64::from(1_u32 << 30)) as i64;
                chain(Spiral::new(origin, both(*radii), small(*from), small(*sweep)).unwrap(), builder, pace)
            }
            Kind::AxisEllipse { half, from: _, sweep } => {
                let nm = |um: i32| i64::from(um) * 1000;
                let ellipse = Ellipse { centre: (nm(self.origin.0), nm(self.origin.1)), half_axes: both(*half) };
                let sense = if *sweep > 0.0 { Sense::CounterClockwise } else { Sense::Clockwise };
                let reach = if sweep.abs() > PI { Reach::Long } else { Reach::Short };
                let end = if sweep.abs() > 6.25 { self.start } else { self.end() };
                let mut pieces = Pieces::ellipse(builder, &ellipse, end, (sense, reach), pace).unwrap();
                std::iter::from_fn(|| pieces.next_motion(builder)).collect()
            }
            Kind::AxisParabola { parameter, along_z, .. } => {
                let nm = |um: i32| i64::from(um) * 1000;
                let axis = if *along_z { Axis::Z } else { Axis::X };
                let vertex = (nm(self.origin.0), nm(self.origin.1));
                let parabola = Parabola { vertex, axis, parameter: um(*parameter) };
                let mut pieces = Pieces::parabola(builder, &parabola, self.end(), pace).unwrap();
                std::iter::from_fn(|| pieces.next_motion(builder)).collect()
            }
            Kind::Spline { points } => {
                let points: Vec<_> = points.iter().map(|p| at(*p)).collect();
                chain(Spline::<16>::new(&points).unwrap(), builder, pace)
            }
            Kind::Nurbs { points, knots } => {
                let weight = |eighths: u32| Weight::parse(&format!("{}", f64::from(eighths) / 8.0)).unwrap();
                let control: Vec<_> = points.iter().map(|(x, z, w)| (at((*x, *z)), weight(*w))).collect();
                chain(Nurbs::new(3, &control, knots).unwrap(), builder, pace)
            }
        }
    }
}
