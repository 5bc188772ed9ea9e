//! Binary rate multiplier: a binary counter gates the bits of a number, and each gate's pulses add up to the number.
//!
//! At count k of 2^n the counter's stage t = (trailing zeros of k) changes, and it lets a pulse through where bit
//! `n - 1 - t` of the axis's number is 1. So the highest bit passes every second count, the next every fourth, and
//! in 2^n counts exactly the number comes out. A line feeds both axes from one counter.
//!
//! **Smoothing.** After k counts the bit i has given `floor(k / 2^(n-i) + 1/2)` pulses, at most 1/2 off its share; n bits
//! together up to about `n/6 + 7/18` pulses (found by trying all small numbers), 5 of a long line, which is why the
//! circuit was followed by a divider. Ours divides by 2^s, s = min(8, n), and runs 2^s frames: the multiplier's error, at
//! most n/2 by the sum above, becomes less than 15/256 of a pulse. The divider begins half full, which adds half a pulse
//! of rounding, so each coordinate is off by less than 0.56 and the point by less than 0.8 pulses from the line. At the
//! end both numbers have come out exactly.
//!
//! **2^s counts at a time.** Of 2^s counts in a row all but the last change the stages below s, always the same, and let
//! the number's upper s bits through as a number; the last one gates one bit of the rest. So a step costs an addition and
//! a gate, and gives the pulses of the circuit's 2^s counts; the divider passes at most one.
//!
//! Circles need an integrator; with this method they are walked by minimum deviation.
//!
//! Source: handbooks of punched-tape control (pulse multiplier).

use super::dda::{Register, pulses, undone};
use super::line::Line;
use super::{Step, Walker};

/// Largest divider, bits.
const SMOOTHING: u32 = 8;

/// Walks a line.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct MultipliedLine {
    x: Register,
    z: Register,
    counts: (u32, u32),
    signs: (i8, i8),
    /// Bits of the counter, and of the divider.
    bits: u32,
    smoothing: u32,
    /// Times 2^s counts done; a frame is 2^(n - s) of them, and 2^s frames 2^n.
    done: u32,
}

impl MultipliedLine {
    /// At the start of `line`.
    pub fn new(line: Line) -> Self {
        let (x, z) = line.end();
        let bits = 32_u32.wrapping_sub(line.steps().leading_zeros());
        let smoothing = bits.min(SMOOTHING);
        Self {
            x: Register::new(smoothing),
            z: Register::new(smoothing),
            counts: (x.unsigned_abs(), z.unsigned_abs()),
            signs: (x.signum() as i8, z.signum() as i8),
            bits,
            smoothing,
            done: 0,
        }
    }

    /// At the end of `line`: the dividers are as at first.
    pub fn end_of(line: Line) -> Self {
        let start = Self::new(line);
        Self { done: 1_u32.wrapping_shl(start.bits), ..start }
    }

    /// Pulses of the multiplier for `number` in the 2^s counts that end with the `group`-th (from 1).
    fn passed(&self, number: u32, group: u32) -> u32 {
        let rest = self.bits.wrapping_sub(self.smoothing);
        let upper = number.wrapping_shr(rest);
        let stage = group.trailing_zeros();
        if stage < rest {
            let bit = rest.wrapping_sub(1).wrapping_sub(stage);
            upper.wrapping_add(number.wrapping_shr(bit) & 1)
        } else {
            upper
        }
    }
}

impl Walker for MultipliedLine {
    fn next_step(&mut self) -> Option<Step> {
        while self.done < 1_u32.wrapping_shl(self.bits) {
            self.done = self.done.wrapping_add(1);
            let (x, z) = (self.passed(self.counts.0, self.done), self.passed(self.counts.1, self.done));
            let (x, z) = (self.x.add(x), self.z.add(z));
            if let Some(step) = pulses(x, z, self.signs) {
                return Some(step);
            }
        }
        None
    }

    fn previous_step(&mut self) -> Option<Step> {
        while self.done > 0 {
            let (x, z) = (self.passed(self.counts.0, self.done), self.passed(self.counts.1, self.done));
            self.done = self.done.wrapping_sub(1);
            let (x, z) = (self.x.take(x), self.z.take(z));
            if let Some(step) = pulses(x, z, self.signs) {
                return Some(undone(step));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The circuit itself, count by count, with its divider, at the end of every 2^s counts.
    #[test]
    fn groups_of_counts_pass_what_the_counter_passes_one_by_one() {
        for number in 1..1024_u32 {
            let line = Line::new(1023, i32::try_from(number).unwrap()).unwrap();
            let walk = MultipliedLine::new(line);
            let (bits, s) = (10, 8);
            assert_eq!((walk.bits, walk.smoothing), (bits, s));
            let mut count = 0_u32;
            for group in 1..=1 << bits {
                let mut passed = 0;
                for _ in 0..1 << s {
                    count += 1;
                    // the counter wraps after a frame
                    let stage = (count % (1 << bits)).trailing_zeros();
                    if stage < bits {
                        passed += number >> (bits - 1 - stage) & 1;
                    }
                }
                assert_eq!(walk.passed(number, group), passed, "number {number} group {group}");
            }
        }
    }

    #[test]
    fn the_plain_multiplier_is_off_by_a_sixth_of_its_bits() {
        for bits in 2..10_u32 {
            let mut worst = 0.0_f64;
            for number in 1..1_u32 << bits {
                let mut passed = 0;
                for k in 1..1_u32 << bits {
                    passed += number >> (bits - 1 - k.trailing_zeros()) & 1;
                    let exact = f64::from(number) * f64::from(k) / f64::from(1_u32 << bits);
                    worst = worst.max((f64::from(passed) - exact).abs());
                }
            }
            let known = f64::from(bits) / 6.0 + 7.0 / 18.0;
            assert!((worst - known).abs() < 0.05, "{bits} bits: {worst} {known}");
        }
    }
}
