//! Time division: curves without a lattice walk, sampled into chords that are walked by minimum deviation.
//!
//! A [`Sampled`] curve gives its point for a parameter from 0 to 1; [`Chords`] divides it. A chord is as long as its
//! distance from the curve allows: it is halved until the curve's points at its 16ths lie within the tolerance, and the
//! next one tries twice its length. It is halved as well until none of its 16ths, nor a tangent at its ends, leans from it by
//! more than a quarter (14 degrees), so that nowhere inside it bends much more sharply than on the whole, as the tip of a hairpin does; a bend that
//! is left where a chord is within a 64th of the tolerance is a [corner](Chords::is_corner). It also stays below [`Sampled::longest`], a part of the curve that has no more than one
//! bend to each side, so that no wave can hide between the points looked at. The points looked at bound the
//! distance from above but for a tenth, which the tolerance keeps in reserve. State is bounded: a parameter and a length.
//!
//! The ends are exact: the first chord starts at parameter 0, the last ends at 1. That needs no end test. Where a curve
//! is run by its advance alone, without knowing how long it is, [`end_test`] has those of the method's source.
//!
//! Everything is integers: points in nm with 12 fraction bits (finer than 1 nm), angles of 60 fraction bits. It runs in the
//! background, like all preparation; what the foreground gets are lines.
//!
//! Source: the time-division interpolation article; the survey of the state of the art for the resolution.

pub mod curves;
pub mod end_test;
pub mod nurbs;
#[cfg_attr(not(feature = "methods"), allow(dead_code, reason = "chains alone ask for radii"))]
pub(crate) mod quartic;
pub mod spline;

use crate::math::{HALF_TURN_Q60, Wide, root_wide, scale, to_i64};
use crate::units::{Length, Point};

/// Fraction bits of a point's coordinates in nm.
pub const FRACTION: u32 = 12;

/// The whole of a curve as a parameter.
pub const WHOLE: u64 = 1 << 32;

/// A point of a curve: X and Z, nm with [`FRACTION`] fraction bits.
pub type Place = (i64, i64);

/// A curve whose points are known for a parameter of 0 to [`WHOLE`].
pub trait Sampled {
    /// The point at a parameter; past the ends, the ends.
    fn at(&self, parameter: u64) -> Place;
    /// Largest part of the parameter that one chord may span.
    fn longest(&self) -> u64;
}

/// Why a curve is not sampled.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum CurveRefusal {
    /// It has no extent: a half axis, wave length, parameter or sweep is zero or negative.
    Degenerate,
    /// Two neighbouring points are the same.
    RepeatedPoint,
    /// Fewer points than a curve of this kind needs, or more than fit.
    Points,
    /// A weight is no number, zero, negative or too large.
    Weight,
    /// The knots do not rise, or do not fit the number of points and the degree.
    Knots,
    /// A point is past ±2.1 m.
    OutOfRange,
    /// It bends more often, or more sharply, than its parameter can be divided.
    TooFine,
    /// It begins somewhere else than where the tool is.
    Elsewhere,
    /// All of it rounds to one lattice point.
    NoPulse,
}

impl core::fmt::Display for CurveRefusal {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Degenerate => "the curve has no extent: give it a positive size and a way to go",
            Self::RepeatedPoint => "two neighbouring points are the same: leave one out",
            Self::Points => "the curve has too few points or too many: give at least degree plus one, or two",
            Self::Weight => "a weight is no positive number up to 65536: give one such as 1 or 0.5",
            Self::Knots => "the knots fall, stay too long or do not fit: give as many as points plus degree plus one, rising, inside none more often than the degree",
            Self::OutOfRange => "the curve leaves the range of 2.1 m: move it or shorten it",
            Self::TooFine => "the curve has more or sharper bends than can be told apart: divide it into several",
            Self::Elsewhere => "the curve does not begin where the tool is: move there first",
            Self::NoPulse => "the whole curve is within one pulse: leave it out",
        })
    }
}

/// Divides a curve into chords; gives the end of each.
#[derive(Clone, Debug)]
pub struct Chords<C> {
    curve: C,
    parameter: u64,
    span: u64,
    from: Place,
    /// nm with [`FRACTION`] fraction bits.
    tolerance: u64,
    corner: bool,
    refused: bool,
}

/// What a chord is like.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Fit {
    /// Too far from the curve, or too much bent.
    Poor,
    /// As short as it gets, and bent all the same.
    Corner,
    /// Near, and nearly straight.
    Good,
}

impl<C: Sampled> Chords<C> {
    /// Shortest part of the parameter that a chord spans: where that is too long still, the curve is refused.
    pub const SHORTEST: u64 = 1 << 4;

    /// Chords that leave the curve by at most `tolerance` nm (below 1 counts as 1).
    pub fn new(curve: C, tolerance: u32) -> Self {
        let from = curve.at(0);
        let span = curve.longest().clamp(Self::SHORTEST, WHOLE);
        let tolerance = u64::from(tolerance.max(1)) << FRACTION;
        let tolerance = tolerance.wrapping_sub(tolerance / 10);
        Self { curve, parameter: 0, span, from, tolerance, corner: false, refused: false }
    }

    /// The curve that is divided.
    pub const fn curve(&self) -> &C {
        &self.curve
    }

    /// Parameter at which the chord given last ends.
    pub const fn parameter(&self) -> u64 {
        self.parameter
    }

    /// Whether the chord given last is a corner: the curve turns by more than a chord may, within a 64th of the tolerance.
    pub const fn is_corner(&self) -> bool {
        self.corner
    }

    /// How good the chord to `to` is: by the curve at its 16ths. Quarters alone were met by chance on rational splines.
    fn fit(&self, span: u64, to: Place) -> Fit {
        let grain = self.tolerance >> 6;
        let chord = way(self.from, to);
        let length = i128::from(distance(chord.0, chord.1));
        let mut points = [self.from; 17];
        let mut reach = 0;
        for (part, point) in (0_u64..).zip(&mut points).skip(1) {
            *point = self.curve.at(self.parameter.wrapping_add(span.wrapping_mul(part) >> 4));
            if !self.is_near(*point, to, (chord, length)) {
                return Fit::Poor;
            }
            let (x, z) = way(self.from, *point);
            reach = x.unsigned_abs().max(z.unsigned_abs()).max(reach);
        }
        // the direction of a shorter one is not known, nor does it matter: all 16 are a grain
        let leans = |side: (i64, i64), least: u64| {
            let (along, across) = parts(side, chord);
            side.0.unsigned_abs().max(side.1.unsigned_abs()) > least && across.saturating_mul(4) >= along
        };
        let least = grain >> 4;
        let [p0, p1, p2, p3, p4, .., p12, p13, p14, p15, p16] = points;
        // a tip inside the first or the last side is told by the tangents there
        let entry = quartic::ends(&[p0, p1, p2, p3, p4]).0;
        let exit = quartic::ends(&[p12, p13, p14, p15, p16]).1;
        let bent = leans(entry, least.wrapping_mul(12))
            || leans(exit, least.wrapping_mul(12))
            || points.windows(2).any(|pair| matches!(pair, [a, b] if leans(way(*a, *b), least)));
        match bent {
            false => Fit::Good,
            true if reach <= grain || span <= Self::SHORTEST => Fit::Corner,
            true => Fit::Poor,
        }
    }

    /// Whether a point of the curve is near enough to the chord to `to` with its length.
    fn is_near(&self, at: Place, to: Place, (chord, length): ((i64, i64), i128)) -> bool {
        let (px, pz) = way(self.from, at);
        let (along, across) = parts((px, pz), chord);
        // beyond its ends the chord is as far as they are
        if length == 0 || along < 0 || along > length.times(length) {
            let (qx, qz) = way(to, at);
            return distance(px, pz).min(distance(qx, qz)) <= self.tolerance;
        }
        across.unsigned_abs() <= u128::from(self.tolerance).saturating_mul(length.unsigned_abs())
    }
}

/// From one place to another.
const fn way(from: Place, to: Place) -> (i64, i64) {
    (to.0.wrapping_sub(from.0), to.1.wrapping_sub(from.1))
}

/// How far a vector leads along another one, and across it to either side; times the length of that one.
fn parts((px, pz): (i64, i64), (dx, dz): (i64, i64)) -> (i128, i128) {
    let of = |p: i64, q: i64| i128::from(p).times(i128::from(q));
    let (along, across) = (of(px, dx).wrapping_add(of(pz, dz)), of(px, dz).wrapping_sub(of(pz, dx)));
    (along, across.saturating_abs())
}

/// Length of a vector.
pub(crate) fn distance(x: i64, z: i64) -> u64 {
    // coordinates are below 2^45
    let (x, z) = (i128::from(x), i128::from(z));
    root_wide(x.times(x).wrapping_add(z.times(z)).unsigned_abs())
}

/// A point in whole nanometres; `None` past ±2.1 m.
fn rounded((x, z): Place) -> Option<Point> {
    let nm = |v: i64| Length::from_nm(v.wrapping_add(1 << (FRACTION - 1)) >> FRACTION);
    Some(Point { x: nm(x)?, z: nm(z)? })
}

impl<C: Sampled> Iterator for Chords<C> {
    type Item = Result<Point, CurveRefusal>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.refused || self.parameter >= WHOLE {
            return None;
        }
        let left = WHOLE.wrapping_sub(self.parameter);
        let mut span = self.span.min(left);
        let mut to = self.curve.at(self.parameter.wrapping_add(span));
        let mut fit = self.fit(span, to);
        while fit == Fit::Poor && span > Self::SHORTEST {
            span >>= 1;
            to = self.curve.at(self.parameter.wrapping_add(span));
            fit = self.fit(span, to);
        }
        if fit == Fit::Poor || self.curve.longest() < Self::SHORTEST {
            self.refused = true;
            return Some(Err(CurveRefusal::TooFine));
        }
        self.corner = fit == Fit::Corner;
        self.parameter = self.parameter.wrapping_add(span);
        self.span = span.wrapping_mul(2).min(self.curve.longest()).max(Self::SHORTEST);
        self.from = to;
        let point = rounded(to).ok_or(CurveRefusal::OutOfRange);
        self.refused = point.is_err();
        Some(point)
    }
}

/// Nanometres as a coordinate.
const fn coordinate(nm: i64) -> i64 {
    nm.wrapping_shl(FRACTION)
}

/// Sine and cosine of any angle (60 fraction bits), with 60 fraction bits. Error below 2^-54.
///
/// Taylor's series up to the 19th and 20th power on an eighth of a turn to either side, whose remainder is below 2^-60.
pub fn sine_cosine(angle: i128) -> (i64, i64) {
    let quarter = i128::from(HALF_TURN_Q60 >> 1);
    let quarters = angle.wrapping_add(quarter >> 1).quotient(quarter).unwrap_or(0);
    let x = angle.wrapping_sub(quarters.times(quarter));
    let times = |a: i128, b: i128| a.times(b) >> 60;
    let square = times(x, x);
    // 1 - s/(n(n-1)) (1 - s/((n-2)(n-3)) (...))
    let nested = |mut power: i128| {
        let mut sum = ONE;
        while power > 1 {
            let divisor = power.wrapping_mul(power.wrapping_sub(1));
            sum = ONE.wrapping_sub(times(square, sum).quotient(divisor).unwrap_or(0));
            power = power.wrapping_sub(2);
        }
        sum
    };
    let (s, c) = (times(x, nested(19)), nested(20));
    let (s, c) = (to_i64(s), to_i64(c));
    match quarters & 3 {
        0 => (s, c),
        1 => (c, s.wrapping_neg()),
        2 => (s.wrapping_neg(), c.wrapping_neg()),
        _ => (c.wrapping_neg(), s),
    }
}

/// One with 60 fraction bits.
const ONE: i128 = 1 << 60;

/// `from + (to - from) * parameter`, for angles and coordinates.
fn between(from: i128, to: i128, parameter: u64) -> i128 {
    from.wrapping_add(scale(to.wrapping_sub(from), i128::from(parameter.min(WHOLE)), i128::from(WHOLE)))
}

#[cfg(test)]
mod tests;
