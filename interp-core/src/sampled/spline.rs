//! Cubic spline through points, with free ends, twice continuously differentiable.
//!
//! The parameter is the sum of the chords between the points. With chords h and their slopes s (per axis) the tangents D at
//! the points solve `l D_(i-1) + 2 D_i + (1 - l) D_(i+1) = 3 (l s_(i-1) + (1 - l) s_i)`, l = h_i / (h_(i-1) + h_i), and at
//! the free ends `2 D_0 + D_1 = 3 s_0`. The system is tridiagonal and its diagonal dominates, so elimination without
//! pivoting is stable, and in fixed point (40 fraction bits) loses less than a nanometre.
//!
//! Source: C. de Boor, A Practical Guide to Splines, chapter IV.

use super::{CurveRefusal, Place, Sampled, WHOLE, coordinate, distance};
use crate::math::{Wide, scale, to_i64, to_u64};
use crate::units::Point;
use heapless::Vec;

/// Fraction bits of slopes and weights.
const BITS: u32 = 40;

/// One in them.
const ONE: i128 = 1 << BITS;

/// A point that the spline passes.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
struct Node {
    place: Place,
    /// Sum of the chords up to here, nm with 12 fraction bits.
    along: u64,
    /// Tangent, X and Z.
    tangent: (i64, i64),
}

/// A spline through up to `N` points.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Spline<const N: usize> {
    nodes: Vec<Node, N>,
    /// Shortest chord.
    shortest: u64,
}

/// `a b` with 40 fraction bits.
fn times(a: i128, b: i128) -> i128 {
    a.times(b) >> BITS
}

/// `a / b` with 40 fraction bits; b is not below a half.
fn over(a: i128, b: i128) -> i128 {
    scale(a, ONE, b)
}

impl<const N: usize> Spline<N> {
    /// Through these points, two at least.
    ///
    /// # Errors
    /// [`CurveRefusal::Points`], [`CurveRefusal::RepeatedPoint`].
    pub fn new(points: &[Point]) -> Result<Self, CurveRefusal> {
        if points.len() < 2 || points.len() > N {
            return Err(CurveRefusal::Points);
        }
        let mut nodes = Vec::<Node, N>::new();
        let (mut along, mut shortest) = (0_u64, u64::MAX);
        for point in points {
            let place = (coordinate(i64::from(point.x.nm())), coordinate(i64::from(point.z.nm())));
            if let Some(last) = nodes.last() {
                let chord = distance(place.0.wrapping_sub(last.place.0), place.1.wrapping_sub(last.place.1));
                if chord == 0 {
                    return Err(CurveRefusal::RepeatedPoint);
                }
                along = along.wrapping_add(chord);
                shortest = shortest.min(chord);
            }
            nodes.push(Node { place, along, tangent: (0, 0) }).map_err(|_| CurveRefusal::Points)?;
        }
        let mut spline = Self { nodes, shortest };
        spline.solve();
        Ok(spline)
    }

    /// Chord and slopes from node `i` to the next.
    fn piece(&self, i: usize) -> Option<(i128, (i128, i128))> {
        let (from, to) = (self.nodes.get(i)?, self.nodes.get(i.wrapping_add(1))?);
        let chord = i128::from(to.along.wrapping_sub(from.along));
        let slope = |a: i64, b: i64| scale(i128::from(b.wrapping_sub(a)), ONE, chord);
        Some((chord, (slope(from.place.0, to.place.0), slope(from.place.1, to.place.1))))
    }

    /// Finds the tangents.
    fn solve(&mut self) {
        // after elimination: D_i = right_i - upper_i D_(i+1)
        let mut rows = Vec::<(i128, i128, i128), N>::new();
        let mut last = (0_i128, 0_i128, 0_i128);
        for i in 0..self.nodes.len() {
            let before = i.checked_sub(1).and_then(|i| self.piece(i));
            let (lower, upper, right) = match (before, self.piece(i)) {
                (Some((h0, s0)), Some((h1, s1))) => {
                    let l = scale(ONE, h1, h0.wrapping_add(h1));
                    let rest = ONE.wrapping_sub(l);
                    let mix = |a: i128, b: i128| times(l, a).wrapping_add(times(rest, b)).wrapping_mul(3);
                    (l, rest, (mix(s0.0, s1.0), mix(s0.1, s1.1)))
                }
                (None, Some((_, s))) => (0, ONE, (s.0.wrapping_mul(3), s.1.wrapping_mul(3))),
                (Some((_, s)), None) => (ONE, 0, (s.0.wrapping_mul(3), s.1.wrapping_mul(3))),
                (None, None) => return,
            };
            let diagonal = ONE.wrapping_mul(2).wrapping_sub(times(lower, last.0));
            let row = (
                over(upper, diagonal),
                over(right.0.wrapping_sub(times(lower, last.1)), diagonal),
                over(right.1.wrapping_sub(times(lower, last.2)), diagonal),
            );
            last = row;
            // as many rows as nodes, which fit
            let _ = rows.push(row);
        }
        let mut next = (0_i128, 0_i128);
        for (node, row) in self.nodes.iter_mut().zip(&rows).rev() {
            next = (row.1.wrapping_sub(times(row.0, next.0)), row.2.wrapping_sub(times(row.0, next.1)));
            node.tangent = (to_i64(next.0), to_i64(next.1));
        }
    }

    fn length(&self) -> u64 {
        self.nodes.last().map_or(1, |last| last.along)
    }
}

impl<const N: usize> Sampled for Spline<N> {
    fn at(&self, parameter: u64) -> Place {
        let along = to_u64(scale(self.length().into(), parameter.min(WHOLE).into(), WHOLE.into()));
        let next = self.nodes.iter().position(|node| node.along > along);
        let Some((to, from)) = next.and_then(|next| {
            let from = next.checked_sub(1)?;
            Some((self.nodes.get(next)?, self.nodes.get(from)?))
        }) else {
            return self.nodes.last().map_or((0, 0), |last| last.place);
        };
        let chord = i128::from(to.along.wrapping_sub(from.along));
        // Hermite's cubic: p0 + (p1 - p0)(3 u^2 - 2 u^3) + h (D0 (u^3 - 2 u^2 + u) + D1 (u^3 - u^2))
        let u = scale(i128::from(along.wrapping_sub(from.along)), ONE, chord);
        let square = times(u, u);
        let cube = times(square, u);
        let rise = square.wrapping_mul(3).wrapping_sub(cube.wrapping_mul(2));
        let (first, second) = (cube.wrapping_sub(square.wrapping_mul(2)).wrapping_add(u), cube.wrapping_sub(square));
        let axis = |p0: i64, p1: i64, d0: i64, d1: i64| {
            let turned = times(d0.into(), first).wrapping_add(times(d1.into(), second));
            let off = times(i128::from(p1.wrapping_sub(p0)), rise).wrapping_add(times(chord, turned));
            p0.wrapping_add(to_i64(off))
        };
        (
            axis(from.place.0, to.place.0, from.tangent.0, to.tangent.0),
            axis(from.place.1, to.place.1, from.tangent.1, to.tangent.1),
        )
    }

    fn longest(&self) -> u64 {
        to_u64(scale(i128::from(WHOLE >> 1), self.shortest.into(), self.length().into()))
    }
}
