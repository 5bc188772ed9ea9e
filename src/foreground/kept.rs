//! What outlives a loss of power: where the axes were, what had been added to them, and where a program was.
//!
//! The background keeps it (in backup memory, which needs no erase); whoever starts again has it back, with the position
//! unverified: nobody knows what the slides did meanwhile.

use super::{Foreground, PerAxis};
use interp_core::units::Lattice;

/// What is kept.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Kept {
    /// Where the program was, pulses.
    pub programmed: Lattice,
    /// What the handwheels had added.
    pub offset: Lattice,
    /// Offsets kept, and wear booked.
    pub kept: Lattice,
    /// See `kept`.
    pub wear: Lattice,
    /// From the program's coordinates to the machine's.
    pub datum: Lattice,
    /// Line of the block in which a program was interrupted, 0 for none.
    pub line: u32,
}

impl Foreground<'_> {
    /// What is to be kept now.
    pub fn kept(&self) -> Kept {
        let desk = &self.desk;
        Kept {
            programmed: self.channel.position(),
            offset: self.channel.offset(),
            kept: desk.kept,
            wear: desk.wear,
            datum: desk.datum,
            line: if self.situation().in_cycle() { self.channel.line() } else { desk.interrupted },
        }
    }

    /// Goes on from what was kept, before the first tick.
    pub fn restore(&mut self, kept: &Kept) {
        self.channel.set_position(kept.programmed);
        self.channel.set_offset(kept.offset);
        let desk = &mut self.desk;
        (desk.kept, desk.wear, desk.datum, desk.interrupted) = (kept.kept, kept.wear, kept.datum, kept.line);
        desk.verified = PerAxis { x: false, z: false };
    }
}
