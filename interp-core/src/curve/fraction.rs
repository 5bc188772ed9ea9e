//! Major axis plus fraction: the major axis steps every time, `alpha = n_minor / n_major` is added to a register each
//! time, and its carry is a step of the minor axis. The end is known by the major count.
//!
//! The group control held alpha in 12 bits, `alpha / 4096`, so a long line missed its end by up to n_major / 8192 pulses;
//! ours has 31 bits and the register begins half full. Of at most 2^29 steps the sum is then off by at most 2^29 / 2^32 = 1/8,
//! so the minor coordinate is within 5/8 of a pulse of the line, and the last one is exact.
//!
//! Arcs have no fraction; with this method they are walked by minimum deviation.
//!
//! Source: the group control system of 1979-80.

use super::dda::{Register, undone};
use super::line::Line;
use super::strides::Strides;
use super::{Step, Walker};

/// Bits of alpha.
const BITS: u32 = 31;

/// Walks a line.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct FractionLine {
    register: Register,
    /// `n_minor / n_major`, 31 fraction bits, rounded to nearest; 2^31 is 1.
    alpha: u32,
    strides: Strides,
    done: u32,
    steps: u32,
}

impl FractionLine {
    /// At the start of `line`.
    pub fn new(line: Line) -> Self {
        let (x, z) = line.end();
        let (sign_x, sign_z) = (x.signum() as i8, z.signum() as i8);
        let (minor, straight) = if x.unsigned_abs() > z.unsigned_abs() {
            (z.unsigned_abs(), Step { x: sign_x, z: 0 })
        } else {
            (x.unsigned_abs(), Step { x: 0, z: sign_z })
        };
        let major = u64::from(line.steps());
        let doubled = (u64::from(minor) << BITS).wrapping_mul(2).wrapping_add(major);
        let alpha = doubled.checked_div(major.wrapping_mul(2)).unwrap_or(0);
        Self {
            register: Register::new(BITS),
            alpha: crate::math::to_u32(alpha),
            strides: Strides::new(straight, Step { x: sign_x, z: sign_z }),
            done: 0,
            steps: line.steps(),
        }
    }
}

impl FractionLine {
    /// At the end of `line`.
    pub fn end_of(line: Line) -> Self {
        let start = Self::new(line);
        // the register takes alpha modulo its size
        let sum = start.alpha.wrapping_mul(start.steps) & (1_u32.wrapping_shl(BITS)).wrapping_sub(1);
        let mut register = start.register;
        register.add(sum);
        Self { register, done: start.steps, ..start }
    }
}

impl Walker for FractionLine {
    fn next_step(&mut self) -> Option<Step> {
        if self.done == self.steps {
            return None;
        }
        self.done = self.done.wrapping_add(1);
        let carry = self.register.add(self.alpha);
        Some(self.strides.step(carry))
    }

    fn previous_step(&mut self) -> Option<Step> {
        if self.done == 0 {
            return None;
        }
        self.done = self.done.wrapping_sub(1);
        let carry = self.register.take(self.alpha);
        Some(undone(self.strides.step(carry)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The register after all steps of a line of any size, by its closed form: the minor pulses that came out.
        #[test]
        fn the_end_of_every_line_is_exact(x in 0..=Line::LIMIT, z in 1..=Line::LIMIT) {
            let walk = FractionLine::new(Line::new(x, z).unwrap());
            let sum = (u128::from(walk.alpha) * u128::from(walk.steps)) + (1 << 30);
            prop_assert_eq!(sum >> 31, u128::from(x.min(z).unsigned_abs()));
        }
    }
}
