//! Where a block goes: curves on the pulse lattice and the walkers that enumerate their steps.
//!
//! A curve is prepared in the background (square roots, divisions, 128 bits) and walked in the foreground, where a
//! step costs a few additions. Coordinates are pulses relative to the curve's start, so that every curve begins at
//! (0, 0).
//!
//! A walker tells which step comes next; the curve's *timeline* tells when: it gives the continuous coordinate of
//! the major axis as a function of the path length, and a step is due where that coordinate reaches the next
//! lattice line. So the tangential feed is even at every direction, and no error adds up along the curve.

pub mod arc;
pub(crate) mod arc_row;
pub mod arc_walker;
mod around;
pub mod conic;
pub mod conic_part;
#[cfg(feature = "methods")]
pub mod conic_piece;
pub mod dda;
pub mod fraction;
mod leads;
pub mod line;
pub mod method;
pub(crate) mod octants;
pub mod point_comparison;
pub(crate) mod preparation;
pub mod prepare_arc;
pub mod proportion;
pub mod rate_multiplier;
pub(crate) mod round;
pub mod strides;

#[cfg(test)]
mod row_tests;

/// Fraction bits of the part of a curve's length that leads along an axis.
pub(crate) const PART_BITS: u32 = 16;

/// One step of a walker: -1, 0 or 1 pulse of each axis, at least one of them not 0.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Step {
    /// Pulses of X.
    pub x: i8,
    /// Pulses of Z.
    pub z: i8,
}

/// Enumerates the steps of one curve, both ways: `previous` undoes `next` exactly.
pub trait Walker {
    /// The next step, or `None` at the end.
    fn next_step(&mut self) -> Option<Step>;
    /// The step that led here, undone, or `None` at the start.
    fn previous_step(&mut self) -> Option<Step>;
    /// All steps that are left: as [`next_step`](Self::next_step) gives them, in less time where a walker makes rows.
    fn each_step(&mut self, mut take: impl FnMut(Step)) {
        while let Some(step) = self.next_step() {
            take(step);
        }
    }
}

/// Enumerates the steps of one curve where a step does not tell where it came from: the classic methods on circles.
/// Backward they walk the reversed curve, which leads to the start exactly, over points of its own.
pub trait OneWay: Sized {
    /// The next step, or `None` at the end.
    fn next_step(&mut self) -> Option<Step>;
    /// From here back to the start.
    #[must_use]
    fn reversed(&self) -> Self;
}
