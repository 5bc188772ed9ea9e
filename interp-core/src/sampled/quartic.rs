//! The quartic through five points at even steps of a parameter: its first and second derivative at each of them.
//!
//! With P0 to P4 at steps of one, a derivative at a point is a weighted sum of all five, the weights being those of the
//! derivatives of Lagrange's polynomials. A cubic's are exact.
//!
//! Source: B. Fornberg, Generation of finite difference formulas on arbitrarily spaced grids,
//! Mathematics of Computation 51, 1988.

use super::{Place, distance};
use crate::math::{RADIAN_Q30, Wide, scale, to_u64};

/// The weights of 12 times the first derivative at each of the points.
const FIRST: [[i64; 5]; 5] =
    [[-25, 48, -36, 16, -3], [-3, -10, 18, -6, 1], [1, -8, 0, 8, -1], [-1, 6, -18, 10, 3], [3, -16, 36, -48, 25]];

/// And of the second one.
const SECOND: [[i64; 5]; 5] = [
    [35, -104, 114, -56, 11],
    [11, -20, 6, 4, -1],
    [-1, 16, -30, 16, -1],
    [-1, 4, 6, -20, 11],
    [11, -56, 114, -104, 35],
];

/// The sum of the points with these weights.
fn weighed(points: &[Place; 5], weights: [i64; 5]) -> (i64, i64) {
    let sum = |of: fn(&Place) -> i64| {
        points.iter().zip(weights).fold(0_i64, |sum, (point, weight)| sum.wrapping_add(of(point).wrapping_mul(weight)))
    };
    (sum(|point| point.0), sum(|point| point.1))
}

/// 12 times the derivative at the first point and at the last one.
pub(crate) fn ends(points: &[Place; 5]) -> ((i64, i64), (i64, i64)) {
    let [first, .., last] = FIRST;
    (weighed(points, first), weighed(points, last))
}

/// The least radius of curvature at the five points, in the units of the points; `None` where it is straight at all.
///
/// `R = |r'|^3 / |r' x r''|`; with 12 times both and the unit vector u along r' that is `|12 r'|^2 / 12 |u x 12 r''|`.
pub(crate) fn least_radius(points: &[Place; 5]) -> Option<u64> {
    let radius = |(first, second): ([i64; 5], [i64; 5])| {
        let ((x, z), (bend_x, bend_z)) = (weighed(points, first), weighed(points, second));
        let (speed, change) = (i128::from(distance(x, z)), i128::from(distance(bend_x, bend_z)));
        // where the curve stands its direction is not known
        if speed <= change >> 6 {
            return None;
        }
        let part = |d: i64| scale(i128::from(d), i128::from(RADIAN_Q30), speed);
        let across = part(x).times(i128::from(bend_z)).wrapping_sub(part(z).times(i128::from(bend_x)));
        let across = across.saturating_abs().saturating_mul(12);
        (across > 0).then(|| to_u64(scale(speed.squared(), i128::from(RADIAN_Q30), across)))
    };
    FIRST.into_iter().zip(SECOND).filter_map(radius).min()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "oracles in f64")]
    use super::*;

    fn points(of: impl Fn(f64) -> (f64, f64)) -> [Place; 5] {
        [0.0, 1.0, 2.0, 3.0, 4.0].map(|k| {
            let (x, z) = of(k);
            ((x * 4096.0) as i64, (z * 4096.0) as i64)
        })
    }

    #[test]
    fn a_cubic_has_its_own_derivatives_and_radius() {
        let cubic = |t: f64| (t.mul_add(30_000.0, t.powi(3) * 1_500.0), t.powi(2) * 20_000.0 - t * 50_000.0);
        let (entry, exit) = ends(&points(cubic));
        let derivative = |t: f64| (t.powi(2).mul_add(4_500.0, 30_000.0), t * 40_000.0 - 50_000.0);
        for ((x, z), t) in [(entry, 0.0), (exit, 4.0)] {
            let (dx, dz) = derivative(t);
            assert!((x as f64 / 49_152.0 - dx).abs() < 0.01 && (z as f64 / 49_152.0 - dz).abs() < 0.01, "{x} {z}");
        }
        let radius = |t: f64| {
            let ((x, z), (ax, az)) = (derivative(t), (9_000.0 * t, 40_000.0));
            x.hypot(z).powi(3) / (x * az - z * ax).abs()
        };
        let least = [0.0, 1.0, 2.0, 3.0, 4.0].map(radius).into_iter().fold(f64::MAX, f64::min);
        let found = least_radius(&points(cubic)).unwrap() as f64 / 4096.0;
        assert!((found / least - 1.0).abs() < 1e-5, "{found}, not {least}");
    }

    #[test]
    fn a_circle_has_its_radius_and_a_line_none() {
        for step in [0.001_f64, 0.02, 0.12] {
            let circle = points(|k| ((k * step).sin() * 7e6, (k * step).cos() * 7e6));
            let found = least_radius(&circle).unwrap() as f64 / 4096.0;
            assert!((found / 7e6 - 1.0).abs() < 1e-3, "{step}: {found}");
        }
        assert_eq!(least_radius(&points(|k| (k * 300.0, k * -70.0))), None);
        assert_eq!(least_radius(&[(5, 5); 5]), None);
    }
}
