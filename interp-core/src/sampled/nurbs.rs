//! Non-uniform rational B-spline, evaluated by de Boor's algorithm on weighted points.
//!
//! Weights and knots come as text or whole numbers and are fixed point: weights with 24 fraction bits, knots with 16.
//!
//! Source: L. Piegl, W. Tiller, The NURBS Book, algorithms A2.1 and A4.1; C. de Boor, A Practical Guide to Splines.

use super::{CurveRefusal, Place, Sampled, WHOLE, coordinate};
use crate::math::{Wide, scale, to_i64, to_u64};
use crate::units::Point;
use heapless::Vec;

/// Most control points.
pub const MAX_POINTS: usize = 32;
/// Largest degree.
pub const MAX_DEGREE: usize = 5;
/// Most knots.
pub const MAX_KNOTS: usize = MAX_POINTS + MAX_DEGREE + 1;

/// A weight: a positive number up to 65 536, 24 fraction bits.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Weight(u64);

impl Weight {
    /// 1.
    pub const ONE: Self = Self(1 << 24);

    /// Of decimal text such as `1`, `0.7071` or `2.5`.
    ///
    /// # Errors
    /// [`CurveRefusal::Weight`] for what is no such number (`NaN`, too), 0 after rounding, or above 65 536.
    ///
    /// ```
    /// # use interp_core::sampled::{CurveRefusal, nurbs::Weight};
    /// assert_eq!(Weight::parse("1.0"), Ok(Weight::ONE));
    /// assert_eq!(Weight::parse("NaN"), Err(CurveRefusal::Weight));
    /// assert_eq!(Weight::parse("-1"), Err(CurveRefusal::Weight));
    /// assert_eq!(Weight::parse("0"), Err(CurveRefusal::Weight));
    /// ```
    pub fn parse(text: &str) -> Result<Self, CurveRefusal> {
        let (whole, part) = text.trim().split_once('.').unwrap_or((text.trim(), ""));
        let digits = |text: &str| text.bytes().all(|b| b.is_ascii_digit());
        if (whole.is_empty() && part.is_empty()) || !digits(whole) || !digits(part) {
            return Err(CurveRefusal::Weight);
        }
        let mut value = 0_u64;
        for digit in whole.bytes() {
            value = value.saturating_mul(10).saturating_add(u64::from(digit.wrapping_sub(b'0')));
        }
        // digits past the twelfth are below the last bit
        let (mut fraction, mut unit) = (0_u64, 1_u64);
        for digit in part.bytes().take(12) {
            fraction = fraction.wrapping_mul(10).wrapping_add(u64::from(digit.wrapping_sub(b'0')));
            unit = unit.wrapping_mul(10);
        }
        if value > 65_536 {
            return Err(CurveRefusal::Weight);
        }
        let part = to_u64(scale(fraction.into(), 1 << 24, unit.into()));
        let held = (value << 24).wrapping_add(part);
        if held == 0 || held > 65_536 << 24 { Err(CurveRefusal::Weight) } else { Ok(Self(held)) }
    }
}

/// A checked curve.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Nurbs {
    degree: usize,
    /// X and Z times weight (46 fraction bits), and weight (34 fraction bits).
    points: Vec<[i128; 3], MAX_POINTS>,
    /// 16 fraction bits.
    knots: Vec<u32, MAX_KNOTS>,
    /// Shortest span between two different knots.
    shortest: u32,
}

impl Nurbs {
    /// Of a degree (1 to 5), control points with weights, and knots (16 fraction bits), as many as points plus degree
    /// plus one. It runs from knot `degree` to knot `points`, and through its outer points where those are as many times
    /// there as the degree plus one.
    ///
    /// # Errors
    /// [`CurveRefusal::Points`] for too few or too many, [`CurveRefusal::Knots`] where they fall, do not fit, or one
    /// inside comes more often than the degree, which would tear the curve apart; [`CurveRefusal::RepeatedPoint`] where
    /// all points are the same.
    pub fn new(degree: usize, control: &[(Point, Weight)], knots: &[u32]) -> Result<Self, CurveRefusal> {
        if degree == 0 || degree > MAX_DEGREE || control.len() <= degree || control.len() > MAX_POINTS {
            return Err(CurveRefusal::Points);
        }
        let fits = knots.len() == control.len().wrapping_add(degree).wrapping_add(1);
        let rises = knots.windows(2).all(|pair| matches!(pair, [a, b] if a <= b));
        let inside = knots.get(1..knots.len().saturating_sub(1)).unwrap_or_default();
        let torn = inside.windows(degree.wrapping_add(1)).any(|run| run.first() == run.last());
        let (Some(first), Some(last)) = (knots.get(degree), knots.get(control.len())) else {
            return Err(CurveRefusal::Knots);
        };
        if !fits || !rises || torn || first >= last {
            return Err(CurveRefusal::Knots);
        }
        if control.windows(2).all(|pair| matches!(pair, [(a, _), (b, _)] if a == b)) {
            return Err(CurveRefusal::RepeatedPoint);
        }
        let spans = knots.windows(2).filter_map(|pair| match pair {
            [a, b] if b > a => Some(b.wrapping_sub(*a)),
            _ => None,
        });
        let shortest = spans.min().unwrap_or(1);
        let mut points = Vec::new();
        for (point, Weight(weight)) in control {
            // ten bits more, so that sums rounded down stay below a thousandth of a nm; products keep below 2^94
            let weight = i128::from(*weight) << 10;
            let of = |nm: i32| i128::from(coordinate(nm.into())).times(weight);
            points.push([of(point.x.nm()), of(point.z.nm()), weight]).map_err(|_| CurveRefusal::Points)?;
        }
        let knots = Vec::from_slice(knots).map_err(|_| CurveRefusal::Knots)?;
        Ok(Self { degree, points, knots, shortest })
    }

    /// A knot with 56 fraction bits, so that the parameter between two close ones is as fine as anywhere.
    fn knot(&self, i: usize) -> i128 {
        self.knots.get(i).map_or(0, |knot| i128::from(*knot)) << 40
    }

    /// First and last parameter, 56 fraction bits.
    fn domain(&self) -> (i128, i128) {
        (self.knot(self.degree), self.knot(self.points.len()))
    }
}

impl Sampled for Nurbs {
    fn at(&self, parameter: u64) -> Place {
        let (first, last) = self.domain();
        let u = super::between(first, last, parameter);
        // the span that holds u; the last one at its end
        let mut span = self.degree;
        while span.wrapping_add(1) < self.points.len() && self.knot(span.wrapping_add(1)) <= u {
            span = span.wrapping_add(1);
        }
        let mut local = [[0_i128; 3]; MAX_DEGREE + 1];
        for (j, slot) in local.iter_mut().enumerate().take(self.degree.wrapping_add(1)) {
            let i = span.wrapping_sub(self.degree).wrapping_add(j);
            *slot = self.points.get(i).copied().unwrap_or_default();
        }
        for level in 1..=self.degree {
            for j in (level..=self.degree).rev() {
                let i = span.wrapping_sub(self.degree).wrapping_add(j);
                let (low, high) =
                    (self.knot(i), self.knot(i.wrapping_add(self.degree).wrapping_add(1).wrapping_sub(level)));
                // 32 fraction bits; differences of points are below 2^95
                let share = scale(u.wrapping_sub(low), 1 << 32, high.wrapping_sub(low));
                let (Some(before), Some(here)) = (local.get(j.wrapping_sub(1)).copied(), local.get_mut(j)) else {
                    continue;
                };
                for (a, b) in here.iter_mut().zip(before) {
                    let way = a.wrapping_sub(b);
                    *a = b.wrapping_add(way.times(share) >> 32);
                }
            }
        }
        let [x, z, weight] = local.get(self.degree).copied().unwrap_or_default();
        (to_i64(scale(x, 1, weight)), to_i64(scale(z, 1, weight)))
    }

    fn longest(&self) -> u64 {
        let (first, last) = self.domain();
        to_u64(scale(i128::from(WHOLE >> 2), i128::from(self.shortest) << 40, last.wrapping_sub(first)))
    }
}
