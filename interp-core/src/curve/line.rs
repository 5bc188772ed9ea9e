//! Straight line by minimum deviation.
//!
//! The major axis is the one with more pulses and steps every time; the minor coordinate after step k is the lattice
//! line nearest to `k * minor / major`, half toward plus infinity. The remainder of that division is carried, so the
//! end is met exactly and nothing rounds.
//!
//! Source: J. E. Bresenham, IBM Systems Journal 4(1), 1965; the rule for halves is this project's.

use super::strides::{Strides, Turned, Turns};
use super::{Step, Walker};

/// A straight line from (0, 0).
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Line {
    x: i32,
    z: i32,
}

impl Line {
    /// Largest magnitude of an end coordinate.
    pub const LIMIT: i32 = 1 << 29;

    /// A line to (`x`, `z`) pulses. `None` where both are 0 or one is past ±2^29.
    pub const fn new(x: i32, z: i32) -> Option<Self> {
        let fits = x.unsigned_abs() <= Self::LIMIT as u32 && z.unsigned_abs() <= Self::LIMIT as u32;
        if fits && (x != 0 || z != 0) { Some(Self { x, z }) } else { None }
    }

    /// Number of steps: the pulses of the major axis.
    pub const fn steps(self) -> u32 {
        let (x, z) = (self.x.unsigned_abs(), self.z.unsigned_abs());
        if x > z { x } else { z }
    }

    /// The end, X then Z.
    pub const fn end(self) -> (i32, i32) {
        (self.x, self.z)
    }

    /// A walker at the start.
    pub const fn walk(self) -> LineWalker {
        let (x, z) = (self.x.unsigned_abs(), self.z.unsigned_abs());
        let (sx, sz) = (self.x.signum() as i8, self.z.signum() as i8);
        let (major, minor, straight, minor_sign) =
            if x > z { (x, z, Step { x: sx, z: 0 }, sz) } else { (z, x, Step { x: 0, z: sz }, sx) };
        // after k steps the remainder is (2 k minor + major) mod 2 major for a rising minor axis; for a falling
        // one it is mirrored, which turns a half up into a half not taken
        let first = if minor_sign < 0 { major.wrapping_sub(1) } else { major };
        LineWalker {
            remainder: first,
            rise: minor.wrapping_mul(2),
            turn: major.wrapping_mul(2),
            strides: Strides::new(straight, Step { x: sx, z: sz }),
            done: 0,
            steps: major,
        }
    }
}

impl Line {
    /// A walker at the end.
    pub const fn walk_from_end(self) -> LineWalker {
        // the remainder has come round: in all it rose by `steps * rise`, a multiple of `turn`
        LineWalker { done: self.steps(), ..self.walk() }
    }
}

impl LineWalker {
    /// Steps that remain.
    #[inline]
    pub(crate) const fn left(&self) -> u32 {
        self.steps.wrapping_sub(self.done)
    }

    /// The two kinds of step: the major axis alone, and both.
    #[inline]
    pub(crate) const fn strides(&self) -> Strides {
        self.strides
    }

    /// How many steps are straight before the next diagonal one, at most `most`.
    pub(crate) fn straight(&self, most: u32) -> u32 {
        let room = self.turn.wrapping_sub(1).wrapping_sub(self.remainder);
        room.checked_div(self.rise).unwrap_or(most).min(most)
    }

    /// Makes steps in a row: `make` asks the recurrence for each whether it is diagonal, and tells how many it made.
    #[inline(always)]
    pub(crate) fn row(&mut self, make: impl FnOnce(&mut LineRow) -> u32) {
        let mut row = LineRow { remainder: self.remainder, rise: self.rise, turn: self.turn, turned: 0 };
        self.done = self.done.wrapping_add(make(&mut row));
        self.remainder = row.remainder;
    }
}

/// The recurrence of a [`LineWalker`] during a row of steps.
pub(crate) struct LineRow {
    remainder: u32,
    rise: u32,
    turn: u32,
    /// Diagonal steps.
    turned: u32,
}

impl Turns for LineRow {
    #[inline(always)]
    fn turns(&mut self) -> bool {
        // every figure is below 2^30 and a remainder below 2^30: sums stay under 2^31
        self.remainder = self.remainder.wrapping_add(self.rise);
        let turns = self.remainder >= self.turn;
        if turns {
            self.remainder = self.remainder.wrapping_sub(self.turn);
            self.turned = self.turned.wrapping_add(1);
        }
        turns
    }

    #[inline(always)]
    fn turned(&self, steps: u32) -> Turned {
        // a diagonal step leaves less than a rise, and each straight one adds one
        let since = self.remainder.checked_div(self.rise).unwrap_or(0);
        Turned { count: self.turned, last: steps.wrapping_sub(1).wrapping_sub(since) }
    }
}

/// Walks a [`Line`].
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct LineWalker {
    /// In `0..turn`.
    remainder: u32,
    rise: u32,
    turn: u32,
    strides: Strides,
    done: u32,
    steps: u32,
}

impl Walker for LineWalker {
    #[inline]
    fn next_step(&mut self) -> Option<Step> {
        if self.done >= self.steps {
            return None;
        }
        let mut diagonal = false;
        self.row(|row| {
            diagonal = row.turns();
            1
        });
        Some(self.strides.step(diagonal))
    }

    fn previous_step(&mut self) -> Option<Step> {
        if self.done == 0 {
            return None;
        }
        self.done = self.done.wrapping_sub(1);
        let step = if self.remainder >= self.rise {
            self.remainder = self.remainder.wrapping_sub(self.rise);
            self.strides.step(false)
        } else {
            self.remainder = self.remainder.wrapping_add(self.turn).wrapping_sub(self.rise);
            self.strides.step(true)
        };
        Some(Step { x: step.x.wrapping_neg(), z: step.z.wrapping_neg() })
    }

    fn each_step(&mut self, mut take: impl FnMut(Step)) {
        let (left, steps) = (self.left(), [false, true].map(|diagonal| self.strides.step(diagonal)));
        self.row(|row| {
            for _ in 0..left {
                take(if row.turns() { steps[1] } else { steps[0] });
            }
            left
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every line of a small square against the rounding formula itself, there and back.
    #[test]
    fn every_small_line_is_the_nearest_lattice_line_with_halves_up() {
        for x in -24..=24_i32 {
            for z in -24..=24_i32 {
                let Some(line) = Line::new(x, z) else { continue };
                let n = i32::try_from(line.steps()).unwrap();
                let nearest = |k: i32, delta: i32| (2 * k * delta + n).div_euclid(2 * n);
                let (mut walker, mut at) = (line.walk(), (0, 0));
                let mut visited = heapless::Vec::<(i32, i32), 32>::new();
                for k in 0..n {
                    visited.push(at).unwrap();
                    let step = walker.next_step().unwrap();
                    at = (at.0 + i32::from(step.x), at.1 + i32::from(step.z));
                    assert_eq!(at, (nearest(k + 1, x), nearest(k + 1, z)), "line {x},{z} step {k}");
                }
                assert_eq!(at, (x, z));
                assert_eq!(walker.next_step(), None);
                while let Some(step) = walker.previous_step() {
                    at = (at.0 + i32::from(step.x), at.1 + i32::from(step.z));
                    assert_eq!(Some(at), visited.pop());
                }
                assert!(visited.is_empty());
                assert_eq!(walker, line.walk());
                let mut single = line.walk();
                walker.each_step(|step| assert_eq!(Some(step), single.next_step()));
                assert_eq!((walker, single.next_step()), (single, None));
            }
        }
    }

    #[test]
    fn the_longest_line_ends_where_it_must() {
        for (x, z) in [(Line::LIMIT, Line::LIMIT), (-Line::LIMIT, Line::LIMIT - 1), (3, -Line::LIMIT)] {
            let walker = Line::new(x, z).unwrap().walk();
            assert!(walker.remainder < walker.turn && walker.rise <= walker.turn);
        }
        assert_eq!(Line::new(0, 0), None);
        assert_eq!(Line::new(Line::LIMIT + 1, 0), None);
    }
}
