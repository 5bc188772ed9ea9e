//! Geometry of arcs, in integers.
//!
//! Coordinates are nanometres. An end point has at most 2.1 m, so two differ by at most 4.2 m; a radius is at most
//! [`RADIUS_LIMIT_NM`], 4.2 m; a centre is then within 6.3 m and anything from it within 8.4 m. Squares of these stay
//! below 2^67, the one product of two squares (in [`by_radius`]) below 2^128.

use interp_core::math::divided_wide;
use interp_core::units::{Point, Sense};

use super::decimal::Distance;
use super::item::Centre;

/// Largest radius: 4.2 m.
pub(crate) const RADIUS_LIMIT_NM: u64 = 4_200_000_000;

/// Why there is no such arc.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) enum ArcError {
    /// The radius is zero.
    Zero,
    /// The radius is above 4.2 m.
    TooLarge,
    /// Start and end are not equally far from the centre.
    RadiiDiffer {
        /// From the centre to the start.
        start: Distance,
        /// From the centre to the end.
        end: Distance,
    },
    /// Start and end are one point, and only a radius is known.
    FullCircle,
    /// The ends are further apart than twice the radius.
    TooSmall {
        /// Half the distance of the ends.
        half_chord: Distance,
    },
}

/// Largest integer whose square is at most `n`.
///
/// Digit by digit, two bits of `n` a turn: no division and nothing that could overflow (`root` stays below 2^64 times
/// the current digit).
fn isqrt(n: u128) -> u128 {
    let (mut rest, mut root, mut bit) = (n, 0_u128, 1_u128 << 126);
    while bit != 0 {
        let trial = root | bit; // the two share no bit
        root >>= 1;
        if let Some(less) = rest.checked_sub(trial) {
            rest = less;
            root |= bit;
        }
        bit >>= 2;
    }
    root
}

/// Nearest integer to the square root; it is never half way.
fn nearest_sqrt(n: u128) -> u128 {
    let root = isqrt(n);
    // sqrt(n) > root + 1/2  <=>  n > root^2 + root, for integers
    if n > root.saturating_mul(root).saturating_add(root) { root.saturating_add(1) } else { root }
}

/// Square of `a - b`.
fn square(a: i64, b: i64) -> u128 {
    let difference = u128::from(a.abs_diff(b));
    difference.saturating_mul(difference)
}

/// Distance from its square.
fn distance(square: u128) -> Distance {
    Distance::from_nm(i64::try_from(nearest_sqrt(square)).unwrap_or(i64::MAX))
}

/// Coordinates of a point.
fn nm(point: Point) -> (i64, i64) {
    (i64::from(point.x.nm()), i64::from(point.z.nm()))
}

/// Checks the two distances from the centre, given as squares: not zero, not above 4.2 m, and alike within
/// `tolerance_nm` once both are rounded to the nanometre.
pub(crate) fn check_radii(start: u128, end: u128, tolerance_nm: i64) -> Result<(), ArcError> {
    let (start, end) = (distance(start), distance(end));
    if start.nm().unsigned_abs() > RADIUS_LIMIT_NM {
        Err(ArcError::TooLarge)
    } else if start.nm() == 0 {
        // before the end is looked at: no end would fit
        Err(ArcError::Zero)
    } else if start.nm().abs_diff(end.nm()) > tolerance_nm.unsigned_abs() {
        Err(ArcError::RadiiDiffer { start, end })
    } else if end.nm() == 0 {
        Err(ArcError::Zero)
    } else {
        Ok(())
    }
}

/// Centre at `(i, k)` from the start; `i` along X as a radius, `k` along Z.
///
/// `start == end` is a full circle.
pub(crate) fn by_centre(start: Point, end: Point, (i, k): (i64, i64), tolerance_nm: i64) -> Result<Centre, ArcError> {
    if i.unsigned_abs() > RADIUS_LIMIT_NM || k.unsigned_abs() > RADIUS_LIMIT_NM {
        return Err(ArcError::TooLarge);
    }
    let ((start_x, start_z), (end_x, end_z)) = (nm(start), nm(end));
    // at most 2.1 m + 4.2 m
    let (x, z) = (start_x.saturating_add(i), start_z.saturating_add(k));
    let start_radius = square(i, 0).saturating_add(square(k, 0));
    let end_radius = square(end_x, x).saturating_add(square(end_z, z));
    check_radii(start_radius, end_radius, tolerance_nm)?;
    Ok(Centre { x: Distance::from_nm(x), z: Distance::from_nm(z) })
}

/// Centre from the radius, rounded to the nanometre, half toward plus infinity.
///
/// * `radius_nm > 0`: the arc of at most 180 degrees; `< 0`: the larger one.
/// * `sense`: seen with Z to the right and X upward.
///
/// A radius that is too short for the chord by at most `tolerance_nm` gives the middle of the chord.
///
/// The centre is off the chord's middle, square to the chord `d`, by `sqrt(r^2 - d^2 / 4)`. So twice a coordinate of
/// the centre is the sum of the ends' and `± sqrt(p^2 (4 r^2 - d^2) / d^2)`, `p` being the other coordinate of `d`.
pub(crate) fn by_radius(
    start: Point,
    end: Point,
    radius_nm: i64,
    sense: Sense,
    tolerance_nm: i64,
) -> Result<Centre, ArcError> {
    let ((start_x, start_z), (end_x, end_z)) = (nm(start), nm(end));
    let chord = square(end_x, start_x).saturating_add(square(end_z, start_z));
    let radius = radius_nm.unsigned_abs();
    if radius == 0 {
        return Err(ArcError::Zero);
    }
    if radius > RADIUS_LIMIT_NM {
        return Err(ArcError::TooLarge);
    }
    if chord == 0 {
        return Err(ArcError::FullCircle);
    }
    let diameter_squared = |radius: u64| square(0, i64::try_from(radius).unwrap_or(i64::MAX)).saturating_mul(4);
    let excess = match diameter_squared(radius).checked_sub(chord) {
        Some(excess) => excess,
        None if chord <= diameter_squared(radius.saturating_add(tolerance_nm.unsigned_abs())) => 0,
        None => {
            return Err(ArcError::TooSmall { half_chord: half(chord) });
        }
    };
    // Clockwise, the centre of the smaller arc is to the right of the chord: (z, x) = (dx, -dz) for d = (dz, dx).
    let right = matches!(sense, Sense::Clockwise) == (radius_nm > 0);
    let (dx, dz) = (end_x.saturating_sub(start_x), end_z.saturating_sub(start_z));
    let coordinate = |a: i64, b: i64, p: i64, negative: bool| {
        let (floor, exact) = root_of_share(square(p, 0), excess, chord);
        // twice the coordinate, rounded down; a root that is not exact rounds the other way when it is taken off
        let twice = if negative {
            a.saturating_add(b).saturating_sub(floor).saturating_sub(i64::from(!exact))
        } else {
            a.saturating_add(b).saturating_add(floor)
        };
        Distance::from_nm(twice.saturating_add(1) >> 1)
    };
    Ok(Centre {
        x: coordinate(start_x, end_x, dz, (dz > 0) == right),
        z: coordinate(start_z, end_z, dx, (dx > 0) != right),
    })
}

/// Half the root of a square, rounded to the nanometre.
fn half(chord: u128) -> Distance {
    Distance::from_nm(i64::try_from(nearest_sqrt(chord).saturating_add(1) >> 1).unwrap_or(i64::MAX))
}

/// `sqrt(part * excess / chord)` rounded down, and whether it is exact.
///
/// The whole product would need 130 bits; a quarter of it fits, since `excess + chord` is at most `4 r^2` and `part`
/// at most `(4.2 m)^2`. The quarter's remainder is put back.
fn root_of_share(part: u128, excess: u128, chord: u128) -> (i64, bool) {
    let product = part.saturating_mul(excess >> 2);
    let (quarter, left) = divided_wide(product, chord).unwrap_or((0, 0));
    let left = left.saturating_mul(4).saturating_add(part.saturating_mul(excess & 3));
    let (more, left) = divided_wide(left, chord).unwrap_or((0, 1));
    let whole = quarter.saturating_mul(4).saturating_add(more);
    let root = isqrt(whole);
    let exact = left == 0 && root.saturating_mul(root) == whole;
    (i64::try_from(root).unwrap_or(i64::MAX), exact)
}

/// Start of an arc that lies in one quadrant, from the magnitudes of its coordinates; all relative to the centre.
///
/// * `magnitude`, `end`: (along X, along Z).
/// * Returns the start with the signs that put it into the end's quadrant, on the side from which `sense` leads to the
///   end; `None` when there is none, or when start and end are in one direction.
pub(crate) fn one_quadrant(magnitude: (u64, u64), end: (i64, i64), sense: Sense) -> Option<(i64, i64)> {
    let (x, z) = (i64::try_from(magnitude.0).ok()?, i64::try_from(magnitude.1).ok()?);
    for (sign_x, sign_z) in [(1_i64, 1_i64), (1, -1), (-1, -1), (-1, 1)] {
        let start = (x.saturating_mul(sign_x), z.saturating_mul(sign_z));
        let inside = end.0.signum() != sign_x.saturating_neg() && end.1.signum() != sign_z.saturating_neg();
        // cross product with Z to the right and X upward: positive is counterclockwise
        let cross = i128::from(start.1)
            .saturating_mul(i128::from(end.0))
            .saturating_sub(i128::from(start.0).saturating_mul(i128::from(end.1)));
        let turns = match sense {
            Sense::Clockwise => cross < 0,
            Sense::CounterClockwise => cross > 0,
        };
        if inside && turns {
            return Some(start);
        }
    }
    None
}

/// Sum of two squares.
pub(crate) fn radius_squared((x, z): (i64, i64)) -> u128 {
    square(x, 0).saturating_add(square(z, 0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use interp_core::units::Length;

    fn point(x: i64, z: i64) -> Point {
        Point { x: Length::from_nm(x).unwrap(), z: Length::from_nm(z).unwrap() }
    }

    fn centre(x: i64, z: i64) -> Centre {
        Centre { x: Distance::from_nm(x), z: Distance::from_nm(z) }
    }

    #[test]
    fn root_is_exact_at_squares_and_beside() {
        for n in 0..70_000_u128 {
            let root = isqrt(n);
            assert!(root * root <= n && n < (root + 1) * (root + 1), "{n}");
        }
        for root in [1_u128, 4_200_000_000, u128::from(u64::MAX)] {
            assert_eq!([isqrt(root * root - 1), isqrt(root * root)], [root - 1, root]);
        }
        assert_eq!(isqrt(u128::MAX), u128::from(u64::MAX));
    }

    #[test]
    fn radius_puts_the_centre_on_the_right_side() {
        use Sense::{Clockwise, CounterClockwise};
        // from (x 0, z 0) to (x 10, z 10): the centres are (x 0, z 10) and (x 10, z 0)
        let (start, end) = (point(0, 0), point(10, 10));
        assert_eq!(by_radius(start, end, 10, Clockwise, 0), Ok(centre(0, 10)));
        assert_eq!(by_radius(start, end, -10, Clockwise, 0), Ok(centre(10, 0)));
        assert_eq!(by_radius(start, end, 10, CounterClockwise, 0), Ok(centre(10, 0)));
        assert_eq!(by_radius(start, end, -10, CounterClockwise, 0), Ok(centre(0, 10)));
    }

    #[test]
    fn centres_from_a_radius_are_the_nearest_lattice_points() {
        use Sense::{Clockwise, CounterClockwise};
        let start = point(-3, 5);
        for x in -40..40_i64 {
            for z in -40..40_i64 {
                for radius in [-60_i64, -31, 57, 58, 91] {
                    let Ok(found) = by_radius(start, point(x, z), radius, Clockwise, 0) else {
                        continue;
                    };
                    // Oracle in doubles: small numbers, so the error is far below the distance to a half.
                    let (dx, dz) = ((x + 3) as f64, (z - 5) as f64);
                    let d = dx.hypot(dz);
                    let h = ((radius * radius) as f64 - d * d / 4.0).max(0.0).sqrt() * (radius.signum() as f64);
                    let (cx, cz) = ((x - 3) as f64 / 2.0 - h * dz / d, (z + 5) as f64 / 2.0 + h * dx / d);
                    assert!((found.x.nm() as f64 - cx).abs() < 0.5 + 1e-9, "{x} {z} {radius}");
                    assert!((found.z.nm() as f64 - cz).abs() < 0.5 + 1e-9, "{x} {z} {radius}");
                    assert_eq!(by_radius(start, point(x, z), -radius, CounterClockwise, 0), Ok(found));
                }
            }
        }
    }

    #[test]
    fn the_largest_arcs_do_not_overflow() {
        let (low, high) = (point(-2_100_000_000, -2_100_000_000), point(2_100_000_000, 2_100_000_000));
        let far = by_radius(low, point(-2_100_000_000, 2_100_000_000), 4_200_000_000, Sense::Clockwise, 0).unwrap();
        // an equilateral triangle: 2.1 m * sqrt(3) below the chord
        assert_eq!(far, centre(-2_100_000_000 - 3_637_306_696, 0));
        let corner = by_radius(low, high, 4_200_000_000, Sense::Clockwise, 0).unwrap();
        let k = 4_200_000_000_u128.pow(2);
        let r = square(corner.x.nm(), -2_100_000_000) + square(corner.z.nm(), -2_100_000_000);
        assert!(r.abs_diff(k) < 2 * 4_200_000_000, "{r}");
    }

    #[test]
    fn a_chord_slightly_too_long_gives_its_middle() {
        let (start, end) = (point(0, 0), point(0, 20_000));
        assert_eq!(by_radius(start, end, 9_990, Sense::Clockwise, 10), Ok(centre(0, 10_000)));
        let refused = Err(ArcError::TooSmall { half_chord: Distance::from_nm(10_000) });
        assert_eq!(by_radius(start, end, 9_989, Sense::Clockwise, 10), refused);
    }

    #[test]
    fn one_quadrant_takes_the_side_from_which_the_sense_comes() {
        use Sense::{Clockwise, CounterClockwise};
        // (x, z): from the top clockwise to the right
        assert_eq!(one_quadrant((20, 0), (0, 20), Clockwise), Some((20, 0)));
        assert_eq!(one_quadrant((20, 0), (0, 20), CounterClockwise), Some((-20, 0)));
        assert_eq!(one_quadrant((3, 4), (4, 3), Clockwise), None);
        assert_eq!(one_quadrant((3, 4), (4, 3), CounterClockwise), Some((3, 4)));
        assert_eq!(one_quadrant((4, 3), (-3, -4), CounterClockwise), None);
        assert_eq!(one_quadrant((4, 3), (-3, -4), Clockwise), Some((-4, -3)));
        assert_eq!(one_quadrant((0, 20), (0, 20), Clockwise), None);
    }
}
