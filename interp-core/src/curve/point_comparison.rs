//! Point-by-point comparison: four directions, one pulse at a time, in three beats: judge on which side of the curve
//! the point lies, feed one pulse toward it, compute the new deviation (and see whether the end is reached).
//!
//! **Circle.** With coordinates from the centre the deviation is `D = x^2 + z^2 - R^2`; a step of `+1` on a coordinate
//! `c` adds `2 c + 1`, a step of `-1` adds `-2 c + 1`. All quadrants and both senses go one way, by logic:
//!
//! | | from `X = (x < 0)`, `Z = (z < 0)`, `D = (D < 0)`, `S = clockwise` |
//! | --- | --- |
//! | X steps | `X ^ Z ^ S ^ D` |
//! | Z steps | `!(X ^ Z ^ S ^ D)` |
//! | an X step is negative | `Z ^ S` |
//! | a Z step is negative | `!(X ^ S)` |
//!
//! Why: counter-clockwise travel has the direction (dX, dZ) = (z, -x), clockwise the opposite, which gives the signs.
//! From outside (`D >= 0`) the axis steps whose travel leads inward. Counter-clockwise where x and z have one sign that
//! is Z; it is X where they differ, and both swap clockwise and again inside: three exclusive-ors.
//!
//! **Error on a circle.** From outside a step leads inward, and by at most one pulse; from inside outward by at most one.
//! So the point stays within a pulse of the circle. (Where a step passes an axis of the circle its far side counts, too:
//! up to `1/(2 R)` more with a centre off the lattice. About a lattice point it is at most 1, and full circles of 2 to
//! 2000 pulses are tested.)
//!
//! **Line** to (n_x, n_z): `F = n_z x - n_x z` in the quadrant's own signs, 0 on the line. At `F >= 0` Z steps and `F`
//! falls by n_x, else X steps and it rises by n_z. So `-n_x <= F < n_z`, and the distance from the line,
//! `|F| / sqrt(n_x^2 + n_z^2)`, is at most one pulse: with different pulse sizes `|F| p_x p_z / L` in mm, at most the
//! coarser one. `F` modulo n_x + n_z turns by n_z each step, so each step can be undone.
//!
//! The end is known by counting the pulses of both axes.
//!
//! Source: the hand lathe paper of 2000 (the logic), handbooks of punched-tape control (the three beats).

use super::arc::Arc;
use super::around::{Around, Ending};
use super::line::Line;
use super::{OneWay, Step, Walker};
use crate::units::{Axis, Sense};

/// Whether X steps.
const fn x_steps(x: bool, z: bool, d: bool, s: bool) -> bool {
    x ^ z ^ s ^ d
}

/// Whether Z steps.
const fn z_steps(x: bool, z: bool, d: bool, s: bool) -> bool {
    !(x ^ z ^ s ^ d)
}

/// Whether an X step is negative.
const fn x_negative(z: bool, s: bool) -> bool {
    z ^ s
}

/// Whether a Z step is negative.
const fn z_negative(x: bool, s: bool) -> bool {
    !(x ^ s)
}

/// Walks a circle or an arc of one.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct ComparedArc {
    around: Around,
}

impl ComparedArc {
    /// At the start of a prepared arc, on a lattice with any pulse sizes.
    pub fn new(arc: &Arc) -> Self {
        Self { around: Around::arc(arc) }
    }

    /// From one point of a circle about a lattice point to another, both (X, Z) in pulses from the centre; once round
    /// where they are the same. `None` where the start is the centre, a coordinate is past ±2^28, or the end lies off
    /// the circle by more than a pulse.
    ///
    /// ```
    /// # use interp_core::curve::{OneWay, Step, point_comparison::ComparedArc};
    /// # use interp_core::units::Sense;
    /// let mut walk = ComparedArc::circle((0, 2), (2, 0), Sense::CounterClockwise).unwrap();
    /// let steps = core::iter::from_fn(|| walk.next_step());
    /// let (x, z) = (Step { x: 1, z: 0 }, Step { x: 0, z: -1 });
    /// assert!(steps.eq([z, x, x, z]));
    /// ```
    pub fn circle(from: (i32, i32), to: (i32, i32), sense: Sense) -> Option<Self> {
        Some(Self { around: Around::circle(from, to, sense)? })
    }

    /// At the end of a prepared arc.
    pub fn end_of(arc: &Arc) -> Self {
        Self { around: Around::end_of(arc) }
    }

    #[cfg(feature = "methods")]
    /// Goes on from where another method is.
    pub(crate) const fn from_around(around: Around) -> Self {
        Self { around }
    }

    #[cfg(feature = "methods")]
    /// Takes a step back that led here, right after turning round.
    pub(crate) const fn take_back(&mut self, step: Step) {
        self.around.take_back(step);
    }

    /// Quadrants entered since the start.
    pub const fn quadrants_entered(&self) -> u8 {
        self.around.entered()
    }

    /// Where the walker is: X, Z, pulses from the start.
    pub const fn position(&self) -> (i32, i32) {
        self.around.at()
    }
}

impl OneWay for ComparedArc {
    fn next_step(&mut self) -> Option<Step> {
        // judge
        let [x, z] = self.around.gradient();
        let (x, z, d, s) = (x < 0, z < 0, self.around.deviation() < 0, self.around.clockwise());
        let (mut steps_x, mut steps_z) = (x_steps(x, z, d, s), z_steps(x, z, d, s));
        match self.around.ending() {
            Ending::Free => {}
            Ending::Only(axis) => (steps_x, steps_z) = (axis == Axis::X, axis == Axis::Z),
            Ending::Back(axis, minus) => return Some(self.around.pulse(axis, minus)),
            Ending::Arrived => return None,
        }
        // feed, and compute
        if steps_x {
            Some(self.around.pulse(Axis::X, x_negative(z, s)))
        } else if steps_z {
            Some(self.around.pulse(Axis::Z, z_negative(x, s)))
        } else {
            None
        }
    }

    fn reversed(&self) -> Self {
        Self { around: self.around.reversed() }
    }
}

/// Walks a line.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct ComparedLine {
    deviation: i64,
    /// Pulses of X and Z in all, and signs.
    counts: (u32, u32),
    signs: (i8, i8),
    done: u32,
}

impl ComparedLine {
    /// At the start of `line`.
    pub const fn new(line: Line) -> Self {
        let (x, z) = line.end();
        Self {
            deviation: 0,
            counts: (x.unsigned_abs(), z.unsigned_abs()),
            signs: (x.signum() as i8, z.signum() as i8),
            done: 0,
        }
    }

    /// At the end of `line`.
    pub const fn end_of(line: Line) -> Self {
        let start = Self::new(line);
        Self { done: start.counts.0.wrapping_add(start.counts.1), ..start }
    }

    const fn x_step(&self) -> Step {
        Step { x: self.signs.0, z: 0 }
    }

    const fn z_step(&self) -> Step {
        Step { x: 0, z: self.signs.1 }
    }
}

impl Walker for ComparedLine {
    fn next_step(&mut self) -> Option<Step> {
        let (x, z) = (i64::from(self.counts.0), i64::from(self.counts.1));
        // a coordinate is below 2^30 pulses, so their number is below 2^31 and the deviation below 2^30
        if self.done == self.counts.0.wrapping_add(self.counts.1) {
            return None;
        }
        self.done = self.done.wrapping_add(1);
        if self.deviation >= 0 && z > 0 {
            self.deviation = self.deviation.wrapping_sub(x);
            Some(self.z_step())
        } else {
            self.deviation = self.deviation.wrapping_add(z);
            Some(self.x_step())
        }
    }

    fn previous_step(&mut self) -> Option<Step> {
        let (x, z) = (i64::from(self.counts.0), i64::from(self.counts.1));
        if self.done == 0 {
            return None;
        }
        self.done = self.done.wrapping_sub(1);
        // after a Z step F < n_z - n_x, after an X step not
        let step = if self.deviation < z.wrapping_sub(x) || x == 0 {
            self.deviation = self.deviation.wrapping_add(x);
            self.z_step()
        } else {
            self.deviation = self.deviation.wrapping_sub(z);
            self.x_step()
        };
        Some(Step { x: step.x.wrapping_neg(), z: step.z.wrapping_neg() })
    }
}

#[cfg(test)]
#[path = "point_comparison_tests.rs"]
mod tests;
