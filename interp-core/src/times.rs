//! Times inside a tick at which an evenly moving coordinate passes lattice lines.

use crate::math::{divided, to_u32};

/// Fraction bits of a time. A tick has less than 2^14 clocks, so a time fits 32 bits, and adding the rounding error
/// of a spacing for every step of a tick stays far below a clock.
pub const FRACTION: u32 = 18;

/// One pulse in the continuous coordinate.
pub const PULSE: i64 = 1 << 16;

/// A stretch of time in clocks of the present tick, in which the path advances evenly.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Stretch {
    /// When it begins.
    pub from: u32,
    /// How long it lasts.
    pub clocks: u32,
}

/// Evenly spaced times, clocks of the present tick with [`FRACTION`] fraction bits.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Times {
    /// The next one.
    pub time: u32,
    /// Clocks from one to the next; the largest value where it does not fit, and none follows the first in the tick.
    pub spacing: u32,
}

impl Times {
    /// For a coordinate (16 fraction bits) that goes from `from` to `to` (`to > from`) during `stretch` and passes
    /// `next` (`next <= to`) first, then every pulse. Rounded down.
    #[inline]
    pub fn new(from: i64, to: i64, next: i64, stretch: Stretch) -> Self {
        let moved = to.wrapping_sub(from).cast_unsigned();
        let first = next.wrapping_sub(from).max(0).unsigned_abs();
        let begin = stretch.from << FRACTION;
        match u32::try_from(moved) {
            Ok(moved) if (1 << 16..1 << 24).contains(&moved) => {
                // (clocks << FRACTION) * 2^16 / moved, in three divisions of 32 bits
                let whole = stretch.clocks << FRACTION;
                let (high, rest) = divided(whole, moved);
                let (middle, rest) = divided(rest << 8, moved);
                let (low, _) = divided(rest << 8, moved);
                let spacing = (high << 16).wrapping_add(middle << 8).wrapping_add(low);
                // first <= moved < 2^24, so the product is below 2^56, and shifted at most the whole stretch
                #[expect(clippy::cast_possible_truncation, reason = "see above")]
                let offset = (first.wrapping_mul(u64::from(spacing)) >> 16) as u32;
                Self { time: begin.wrapping_add(offset), spacing }
            }
            _ => Self::far(begin, moved, first, stretch.clocks),
        }
    }

    /// Less than one pulse in the stretch, or hundreds.
    #[cold]
    fn far(begin: u32, moved: u64, first: u64, clocks: u32) -> Self {
        // 2^32 in 64 bits and more than 2^46 pulses do not occur; cut off, they only move steps within the tick
        let whole = u64::from(clocks) << FRACTION;
        let ratio = |dividend: u64| dividend.checked_div(moved).map_or(u32::MAX, to_u32);
        let offset = if moved < 1 << 16 {
            ratio(whole.wrapping_mul(first))
        } else {
            to_u32(first.wrapping_mul(u64::from(ratio(whole << 16))) >> 16)
        };
        Self { time: begin.wrapping_add(offset.min(to_u32(whole))), spacing: ratio(whole << 16) }
    }

    /// Clock of the next one.
    #[inline]
    pub const fn clock(&self) -> i32 {
        (self.time >> FRACTION).cast_signed()
    }

    /// Clocks between two, rounded down.
    #[inline]
    pub const fn spacing_clocks(&self) -> i32 {
        (self.spacing >> FRACTION).cast_signed()
    }

    /// Takes the next one: its clock.
    #[inline]
    pub const fn take(&mut self) -> u32 {
        let clock = self.time >> FRACTION;
        self.time = self.time.wrapping_add(self.spacing);
        clock
    }
}
