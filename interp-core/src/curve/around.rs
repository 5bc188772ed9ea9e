//! What the methods that step round a circle pulse by pulse share: deviation, gradient, quadrants and the end.
//!
//! The curve is the conic of [`Arc`]: `F(x, z) = a x^2 + b z^2 - c x - d z`, coordinates in pulses from the start. With
//! equal pulse sizes and its centre on the lattice that is `x^2 + z^2 - R^2` seen from the centre. `F` and half its
//! gradient, the coordinates from the centre times `a` and `b`, are carried from step to step: a step of `+1` on X adds
//! `2 a x + a`, a step of `-1` adds `-2 a x + a`, and then `2 a x` changes by `2 a`.
//!
//! **Quadrants** are known by the signs of the coordinates from the centre, 0 counting as positive; a step that changes a
//! sign enters the next quadrant. **The end** is found by counting: first the quadrants entered, then, inside the last
//! one, where both coordinates run one way only, the pulses that each axis still owes. An axis that owes none waits for
//! the other, so the end is met exactly.
//!
//! Sums wrap; the true values fit 64 bits, since an [`Arc`]'s weights are chosen so.

use super::Step;
use super::arc::Arc;
use crate::units::{Axis, Sense};

/// A point that goes round a conic, one pulse at a time.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) struct Around {
    /// `F` here.
    deviation: i64,
    /// Gradient of `F` here, X and Z: 0 is on the axis of the conic.
    gradient: [i64; 2],
    /// Half of what a pulse changes the gradient by: `a`, `b`.
    weight: [i64; 2],
    at: (i32, i32),
    start: (i32, i32),
    end: (i32, i32),
    clockwise: bool,
    /// Quadrants entered, and those still to enter.
    entered: u8,
    to_enter: u8,
}

impl Around {
    /// Largest coordinate from the centre that [`Around::circle`] takes.
    pub(crate) const LIMIT: i32 = 1 << 28;

    /// At the start of `arc`.
    pub(crate) fn arc(arc: &Arc) -> Self {
        let conic = [arc.a, arc.b, arc.c, arc.d];
        // more than four octants lead out of the quadrant and back into it
        Self::new(conic, arc.end, arc.sense, arc.pieces > 4)
    }

    /// From one point of a circle about a lattice point to another, both (X, Z) in pulses from the centre; once round
    /// where they are the same. `None` where the start is the centre, a coordinate is past [`Around::LIMIT`], or the
    /// end is off the circle by more than a pulse.
    pub(crate) fn circle(from: (i32, i32), to: (i32, i32), sense: Sense) -> Option<Self> {
        let square = |(x, z): (i32, i32)| {
            let (x, z) = (i64::from(x), i64::from(z));
            x.wrapping_mul(x).wrapping_add(z.wrapping_mul(z))
        };
        let size = |(x, z): (i32, i32)| x.unsigned_abs().max(z.unsigned_abs());
        let reach = i64::from(size(to));
        let off = square(to).wrapping_sub(square(from)).unsigned_abs();
        let fits = size(from).max(size(to)) <= Self::LIMIT.unsigned_abs();
        if from == (0, 0) || !fits || off > reach.wrapping_mul(2).unsigned_abs() {
            return None;
        }
        let centre = (i64::from(from.0).wrapping_mul(-2), i64::from(from.1).wrapping_mul(-2));
        let end = (to.0.wrapping_sub(from.0), to.1.wrapping_sub(from.1));
        // with the start behind the end in its own quadrant travel goes once round
        let mut around = Self::new([1, 1, centre.0, centre.1], end, sense, false);
        if around.to_enter == 0 {
            let (owed_x, owed_z) = around.owed();
            if end == (0, 0) || owed_x < 0 || owed_z < 0 {
                around.to_enter = 4;
            }
        }
        Some(around)
    }

    fn new([a, b, c, d]: [i64; 4], end: (i32, i32), sense: Sense, far: bool) -> Self {
        let mut around = Self {
            deviation: 0,
            gradient: [c.wrapping_neg(), d.wrapping_neg()],
            weight: [a, b],
            at: (0, 0),
            start: (0, 0),
            end,
            clockwise: sense == Sense::Clockwise,
            entered: 0,
            to_enter: 0,
        };
        let slope = |weight: i64, end: i32, c: i64| weight.wrapping_mul(2).wrapping_mul(i64::from(end)).wrapping_sub(c);
        let last = Self::quadrant([slope(a, end.0, c), slope(b, end.1, d)]);
        let between = last.wrapping_sub(Self::quadrant(around.gradient));
        let between = if around.clockwise { between.wrapping_neg() } else { between } & 3;
        around.to_enter = if between == 0 && far { 4 } else { between };
        around
    }

    /// Quadrant of a gradient, counter-clockwise from 0, where both coordinates are positive.
    const fn quadrant([x, z]: [i64; 2]) -> u8 {
        match (x < 0, z < 0) {
            (false, false) => 0,
            (false, true) => 1,
            (true, true) => 2,
            (true, false) => 3,
        }
    }

    /// At the end of `arc`.
    pub(crate) fn end_of(arc: &Arc) -> Self {
        let start = Self::arc(arc);
        let slope = |weight: i64, end: i32, c: i64| weight.wrapping_mul(2).wrapping_mul(i64::from(end)).wrapping_sub(c);
        Self {
            deviation: arc.residual(arc.end.0, arc.end.1),
            gradient: [slope(arc.a, arc.end.0, arc.c), slope(arc.b, arc.end.1, arc.d)],
            at: arc.end,
            entered: start.to_enter,
            to_enter: 0,
            ..start
        }
    }

    /// From here back to the start; turned round again, on to the end.
    pub(crate) const fn reversed(&self) -> Self {
        Self {
            start: self.end,
            end: self.start,
            clockwise: !self.clockwise,
            entered: self.to_enter,
            to_enter: self.entered,
            ..*self
        }
    }

    #[cfg(feature = "methods")]
    /// Takes a step back that led here, before any other is made after turning round.
    pub(crate) const fn take_back(&mut self, step: Step) {
        if step.x != 0 {
            self.pulse(Axis::X, step.x > 0);
        }
        if step.z != 0 {
            self.pulse(Axis::Z, step.z > 0);
        }
    }

    /// `F` here: below 0 inside the curve.
    pub(crate) const fn deviation(&self) -> i64 {
        self.deviation
    }

    /// Gradient of `F` here, X and Z.
    pub(crate) const fn gradient(&self) -> [i64; 2] {
        self.gradient
    }

    /// Half of what a pulse changes the gradient by, X and Z.
    pub(crate) const fn weight(&self) -> [i64; 2] {
        self.weight
    }

    /// Travel is clockwise.
    pub(crate) const fn clockwise(&self) -> bool {
        self.clockwise
    }

    /// Quadrants entered so far.
    pub(crate) const fn entered(&self) -> u8 {
        self.entered
    }

    /// Where the point is, X and Z, pulses from the start.
    pub(crate) const fn at(&self) -> (i32, i32) {
        self.at
    }

    /// Signs of travel here: `true` is minus.
    pub(crate) const fn minus(&self) -> (bool, bool) {
        let [x, z] = self.gradient;
        ((z < 0) ^ self.clockwise, !((x < 0) ^ self.clockwise))
    }

    /// Pulses that X and Z owe in the direction of travel.
    const fn owed(&self) -> (i32, i32) {
        let (x, z) = (self.end.0.wrapping_sub(self.at.0), self.end.1.wrapping_sub(self.at.1));
        let (minus_x, minus_z) = self.minus();
        (if minus_x { x.wrapping_neg() } else { x }, if minus_z { z.wrapping_neg() } else { z })
    }

    /// What the end asks for: a step that must be made now, whatever the method says, or `None` where it may decide.
    pub(crate) fn ending(&self) -> Ending {
        if self.to_enter > 0 {
            return Ending::Free;
        }
        let (x, z) = self.owed();
        match (x > 0, z > 0) {
            (true, true) => Ending::Free,
            (true, false) => Ending::Only(Axis::X),
            (false, true) => Ending::Only(Axis::Z),
            (false, false) if self.at == self.end => Ending::Arrived,
            // past the end by a pulse, which rounding of the curve's centre may lead to: straight back
            (false, false) => {
                let (x, z) = (self.end.0.wrapping_sub(self.at.0), self.end.1.wrapping_sub(self.at.1));
                if x == 0 { Ending::Back(Axis::Z, z < 0) } else { Ending::Back(Axis::X, x < 0) }
            }
        }
    }

    /// Makes one pulse of `axis`.
    pub(crate) const fn pulse(&mut self, axis: Axis, minus: bool) -> Step {
        let sign = if minus { -1_i64 } else { 1 };
        let ([gx, gz], [a, b]) = (self.gradient, self.weight);
        let (slope, weight) = match axis {
            Axis::X => (gx, a),
            Axis::Z => (gz, b),
        };
        self.deviation = self.deviation.wrapping_add(slope.wrapping_mul(sign)).wrapping_add(weight);
        let after = slope.wrapping_add(weight.wrapping_mul(2).wrapping_mul(sign));
        let step = if minus { -1_i8 } else { 1 };
        let made = match axis {
            Axis::X => {
                self.gradient = [after, gz];
                self.at.0 = self.at.0.wrapping_add(step as i32);
                Step { x: step, z: 0 }
            }
            Axis::Z => {
                self.gradient = [gx, after];
                self.at.1 = self.at.1.wrapping_add(step as i32);
                Step { x: 0, z: step }
            }
        };
        if (slope < 0) != (after < 0) {
            self.entered = self.entered.wrapping_add(1);
            self.to_enter = self.to_enter.saturating_sub(1);
        }
        made
    }
}

/// What the end of a curve asks of the next step.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) enum Ending {
    /// Nothing yet.
    Free,
    /// The other axis is at its end coordinate.
    Only(Axis),
    /// A pulse back, minus where true.
    Back(Axis, bool),
    /// There.
    Arrived,
}
