//! Points and directions of the half plane: Z along the axis, X away from it, in mm.

use std::ops::{Add, Mul, Neg, Sub};

/// A point or a direction, in mm.
#[derive(Copy, Clone, Debug, Default, PartialEq)]
pub struct Point {
    /// Along the axis of the work, positive away from the spindle.
    pub z: f64,
    /// Away from the axis (a radius).
    pub x: f64,
}

impl Point {
    /// A point from its coordinates.
    #[must_use]
    pub const fn new(z: f64, x: f64) -> Self {
        Self { z, x }
    }

    /// The unit vector at an angle, counter-clockwise from +Z as seen with X upward.
    #[must_use]
    pub fn at_degrees(angle: f64) -> Self {
        let (sine, cosine) = angle.to_radians().sin_cos();
        Self { z: cosine, x: sine }
    }

    /// Scalar product.
    #[must_use]
    pub fn dot(self, other: Self) -> f64 {
        self.z * other.z + self.x * other.x
    }

    /// Positive if `other` lies counter-clockwise of it.
    #[must_use]
    pub fn cross(self, other: Self) -> f64 {
        self.z * other.x - self.x * other.z
    }

    /// Distance from the origin.
    #[must_use]
    pub fn length(self) -> f64 {
        self.z.hypot(self.x)
    }

    /// Turned by a quarter, counter-clockwise.
    #[must_use]
    pub fn left(self) -> Self {
        Self { z: -self.x, x: self.z }
    }
}

impl Add for Point {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { z: self.z + other.z, x: self.x + other.x }
    }
}

impl Sub for Point {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { z: self.z - other.z, x: self.x - other.x }
    }
}

impl Mul<f64> for Point {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self { z: self.z * factor, x: self.x * factor }
    }
}

impl Neg for Point {
    type Output = Self;
    fn neg(self) -> Self {
        Self { z: -self.z, x: -self.x }
    }
}
