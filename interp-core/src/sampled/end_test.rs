//! How a sampled curve finds its end when it only knows where it is and where it must arrive.
//!
//! **Line**: the remaining length is `|x_e - x_i| / cos(a)` with the angle a from the long axis, so that the divisor is
//! never small. **Arc** of at most half a turn: the chord from the tool to the end shrinks steadily; the end is reached
//! when it is no longer than the advance. Past half a turn the chord first grows, up to the diameter, and the test
//! only begins once it shrinks.
//!
//! Source: the time-division interpolation article.

use super::{Place, distance};
use crate::math::{scale, to_u64};

/// Remaining length of a line.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct LineEnd {
    end: Place,
    /// The X axis is the long one.
    along_x: bool,
    length: u64,
    long: u64,
}

impl LineEnd {
    /// Of a line between two points; `None` where they are the same.
    pub fn new(start: Place, end: Place) -> Option<Self> {
        let (dx, dz) = (end.0.wrapping_sub(start.0), end.1.wrapping_sub(start.1));
        let along_x = dx.unsigned_abs() > dz.unsigned_abs();
        let long = if along_x { dx.unsigned_abs() } else { dz.unsigned_abs() };
        (long > 0).then_some(Self { end, along_x, length: distance(dx, dz), long })
    }

    /// What remains from a point on the line.
    pub fn remaining(&self, at: Place) -> u64 {
        let left =
            if self.along_x { self.end.0.wrapping_sub(at.0) } else { self.end.1.wrapping_sub(at.1) }.unsigned_abs();
        to_u64(scale(i128::from(left), i128::from(self.length), i128::from(self.long)))
    }
}

/// The chord that remains of an arc, and whether it tells anything yet.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct ArcEnd {
    end: Place,
    /// The chord grows: more than half a turn remains.
    growing: bool,
    chord: u64,
}

impl ArcEnd {
    /// Of an arc that turns by more than half a turn, or not.
    pub fn new(start: Place, end: Place, past_half: bool) -> Self {
        let chord = distance(end.0.wrapping_sub(start.0), end.1.wrapping_sub(start.1));
        Self { end, growing: past_half, chord }
    }

    /// Notes the next point of the arc; whether the end is within `advance` of it.
    pub fn arrives(&mut self, at: Place, advance: u64) -> bool {
        let chord = distance(self.end.0.wrapping_sub(at.0), self.end.1.wrapping_sub(at.1));
        self.growing &= chord >= self.chord;
        self.chord = chord;
        !self.growing && chord <= advance
    }
}
