//! How far the train leaves its curves.

use crate::fault::Here;
use crate::setup::PerAxis;

/// The largest deviation from a curve, and where it was.
#[derive(Copy, Clone, Debug, Default, PartialEq)]
pub struct Deviation {
    /// Euclidean distance from the lattice point to the curve, over the coarser pulse equivalent.
    pub pulses: f64,
    /// Program line of the motion.
    pub line: u32,
    /// The lattice point.
    pub at: PerAxis<i32>,
    /// Time of its rising edge in train clocks.
    pub clocks: u64,
}

impl Deviation {
    /// Takes a distance in pulses into account.
    #[inline]
    pub(crate) fn take(&mut self, pulses: f64, here: Here) {
        if pulses > self.pulses {
            *self = Self { pulses, line: here.line, at: here.at, clocks: here.clocks };
        }
    }
}
