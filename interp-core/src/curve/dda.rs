//! Digital differential analyser: each axis's speed is summed up in a register whose overflow is a pulse.
//!
//! **Line** to (n_x, n_z): 2^n iterations with `2^n > max(n_x, n_z)`; in each, both registers, of n bits, take n_x and n_z
//! up, and overflows are the pulses of that iteration. The registers begin half full, so each coordinate is the nearest
//! to the line's at that iteration: at most half a pulse off, and the point at most `1/2 sqrt(2)` pulses from the line.
//! After 2^n iterations the registers are as at first and the pulses n_x and n_z.
//!
//! **Circle**: two integrators in a ring, `dX = z dt` and `dZ = -x dt` counter-clockwise, where each takes the pulses of
//! the other into its integrand. X integrates first and Z uses the new x: summed at the same time, both would add
//! `x^2 + z^2` a little in every iteration, and a circle would grow by about 3 pulses a turn; one after the other they
//! keep `x^2 + z^2 - x z / 2R` (Beeler, Gosper, Schroeppel, HAKMEM item 149, 1972). The registers are signed, so that what
//! an axis owes when it turns round is taken back, and overflow at half their size. That is twice the largest gradient
//! of the curve, so that no axis makes a pulse in every iteration; with once, circles below 6 pulses would be off by 1.5. On a lattice with different pulse sizes the integrands are the gradient of the conic of [`Arc`]. The end is
//! met exactly: see `around.rs`. Error: at most 1 pulse; the tests look at every circle up to
//! 400 pulses.
//!
//! Source: handbooks of punched-tape control (digital integration).

use super::arc::Arc;
use super::around::{Around, Ending};
use super::line::Line;
#[cfg(feature = "methods")]
use super::point_comparison::ComparedArc;
use super::{OneWay, Step, Walker};
use crate::math::{Wide, root_wide, to_i64};
use crate::units::{Axis, Sense};

/// A register that a count is added to or taken from; its overflow is a pulse.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) struct Register {
    sum: u32,
    /// One less than its size, a power of two up to 2^30.
    mask: u32,
}

impl Register {
    /// Of `bits` bits (1 to 30), half full.
    pub(crate) const fn new(bits: u32) -> Self {
        let size = 1_u32.wrapping_shl(bits);
        Self { sum: size >> 1, mask: size.wrapping_sub(1) }
    }

    /// Adds at most its size; whether it overflows.
    #[inline]
    pub(crate) const fn add(&mut self, count: u32) -> bool {
        let sum = self.sum.wrapping_add(count);
        self.sum = sum & self.mask;
        sum > self.mask
    }

    /// Undoes an [`add`](Self::add); whether that had overflowed.
    #[inline]
    pub(crate) const fn take(&mut self, count: u32) -> bool {
        let under = self.sum < count;
        self.sum = self.sum.wrapping_sub(count) & self.mask;
        under
    }
}

/// Pulses of an iteration of a line in its own signs.
#[inline]
pub(crate) fn pulses(x: bool, z: bool, (sign_x, sign_z): (i8, i8)) -> Option<Step> {
    (x || z).then_some(Step { x: if x { sign_x } else { 0 }, z: if z { sign_z } else { 0 } })
}

/// The step undone.
#[inline]
pub(crate) const fn undone(step: Step) -> Step {
    Step { x: step.x.wrapping_neg(), z: step.z.wrapping_neg() }
}

/// Walks a line.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct IntegratedLine {
    x: Register,
    z: Register,
    counts: (u32, u32),
    signs: (i8, i8),
    done: u32,
    iterations: u32,
}

impl IntegratedLine {
    /// At the start of `line`.
    pub const fn new(line: Line) -> Self {
        let (x, z) = line.end();
        let bits = 32_u32.wrapping_sub(line.steps().leading_zeros());
        Self {
            x: Register::new(bits),
            z: Register::new(bits),
            counts: (x.unsigned_abs(), z.unsigned_abs()),
            signs: (x.signum() as i8, z.signum() as i8),
            done: 0,
            iterations: 1_u32.wrapping_shl(bits),
        }
    }
}

impl IntegratedLine {
    /// At the end of `line`: the registers are as at first.
    pub const fn end_of(line: Line) -> Self {
        let start = Self::new(line);
        Self { done: start.iterations, ..start }
    }
}

impl Walker for IntegratedLine {
    fn next_step(&mut self) -> Option<Step> {
        // the major count is at least half the register's size, so at most two iterations go by without a pulse
        while self.done < self.iterations {
            self.done = self.done.wrapping_add(1);
            let (x, z) = (self.x.add(self.counts.0), self.z.add(self.counts.1));
            if let Some(step) = pulses(x, z, self.signs) {
                return Some(step);
            }
        }
        None
    }

    fn previous_step(&mut self) -> Option<Step> {
        while self.done > 0 {
            self.done = self.done.wrapping_sub(1);
            let (x, z) = (self.x.take(self.counts.0), self.z.take(self.counts.1));
            if let Some(step) = pulses(x, z, self.signs) {
                return Some(undone(step));
            }
        }
        None
    }
}

/// Walks a circle or an arc of one.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct IntegratedArc {
    around: Around,
    /// What X and Z owe, `-size / 2 ..= size / 2`.
    register: [i64; 2],
    /// A pulse in the registers.
    size: i64,
}

impl IntegratedArc {
    /// At the start of a prepared arc, on a lattice with any pulse sizes.
    pub fn new(arc: &Arc) -> Self {
        Self::around(Around::arc(arc))
    }

    /// As [`ComparedArc::circle`](super::point_comparison::ComparedArc::circle).
    pub fn circle(from: (i32, i32), to: (i32, i32), sense: Sense) -> Option<Self> {
        Some(Self::around(Around::circle(from, to, sense)?))
    }

    #[cfg(feature = "methods")]
    /// The same point for [`ComparedArc`], which holds to the curve from wherever it is.
    pub(crate) const fn compared(&self) -> ComparedArc {
        ComparedArc::from_around(self.around)
    }

    fn around(around: Around) -> Self {
        let ([a, b], [gx, gz]) = (around.weight(), around.gradient());
        let most = i128::from(a.max(b));
        // the largest gradient: at F = 0, g_x^2 / a + g_z^2 / b is the same everywhere
        let longest = gx.unsigned_abs().max(gz.unsigned_abs());
        let cut = 64_u32.wrapping_sub(longest.leading_zeros()).saturating_sub(56);
        let part = |gradient: i64, weight: i64| {
            let short = i128::from(gradient.wrapping_shr(cut));
            let square = short.times(short).over(i128::from(weight)).unwrap_or(0);
            square.saturating_mul(most)
        };
        let square = part(gx, a).saturating_add(part(gz, b));
        let largest = i128::from(root_wide(square.unsigned_abs())).wrapping_shl(cut);
        // twice the largest gradient: small circles need the finer time; and the point may be off the curve by a pulse
        let size = to_i64(largest.saturating_add(most).wrapping_mul(2));
        Self { around, register: [0, 0], size }
    }

    /// Quadrants entered since the start.
    pub const fn quadrants_entered(&self) -> u8 {
        self.around.entered()
    }

    /// Adds `count` to the register of `axis`; the pulse that this makes, if any.
    fn integrate(&mut self, axis: Axis, count: i64) -> Option<Step> {
        let [x, z] = self.register;
        let sum = match axis {
            Axis::X => x,
            Axis::Z => z,
        };
        let sum = sum.wrapping_add(count);
        let half = self.size >> 1;
        let (sum, minus) = if sum > half {
            (sum.wrapping_sub(self.size), Some(false))
        } else if sum < half.wrapping_neg() {
            (sum.wrapping_add(self.size), Some(true))
        } else {
            (sum, None)
        };
        self.register = match axis {
            Axis::X => [sum, z],
            Axis::Z => [x, sum],
        };
        minus.map(|minus| self.around.pulse(axis, minus))
    }
}

impl OneWay for IntegratedArc {
    fn next_step(&mut self) -> Option<Step> {
        loop {
            let (minus_x, minus_z) = self.around.minus();
            match self.around.ending() {
                Ending::Free => {}
                Ending::Only(Axis::X) => return Some(self.around.pulse(Axis::X, minus_x)),
                Ending::Only(Axis::Z) => return Some(self.around.pulse(Axis::Z, minus_z)),
                Ending::Back(axis, minus) => return Some(self.around.pulse(axis, minus)),
                Ending::Arrived => {
                    // the end is on the curve: nothing is owed, should it be the start of the way back
                    self.register = [0, 0];
                    return None;
                }
            }
            let turned = |gradient: i64| if self.around.clockwise() { gradient.wrapping_neg() } else { gradient };
            let [_, speed_x] = self.around.gradient().map(turned);
            let x = self.integrate(Axis::X, speed_x);
            let turned = |gradient: i64| if self.around.clockwise() { gradient } else { gradient.wrapping_neg() };
            let [speed_z, _] = self.around.gradient().map(turned);
            // the pulse of X may have been the last that X owed
            let free = self.around.ending() == Ending::Free;
            let z = if free { self.integrate(Axis::Z, speed_z) } else { None };
            match (x, z) {
                (Some(x), Some(z)) => return Some(Step { x: x.x, z: z.z }),
                (Some(step), None) | (None, Some(step)) => return Some(step),
                (None, None) => {}
            }
        }
    }

    fn reversed(&self) -> Self {
        Self { around: self.around.reversed(), ..*self }
    }
}

#[cfg(test)]
#[path = "dda_tests.rs"]
mod tests;
