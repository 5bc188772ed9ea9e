//! What a display shows of the foreground, taken after a tick.

use super::alarm::Alarm;
use super::contour::length;
use super::inputs::PerAxis;
use super::mode::Mode;
pub use super::threads::PickUp;
use super::{Foreground, Outputs};
use interp_core::block::Speed;
use interp_core::channel::State;
use interp_core::config::FRACTION_BITS;
use interp_core::drive::Trouble;
use interp_core::units::{Axis, Lattice, Length};

/// The lathe as an operator sees it.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Shown {
    /// The mode.
    pub mode: Mode,
    /// What the channel is doing.
    pub state: State,
    /// Where the axes are, pulses.
    pub position: Lattice,
    /// Where the program is.
    pub programmed: Lattice,
    /// What the handwheels have added to it.
    pub offset: Lattice,
    /// Offsets that were kept, and wear that was booked.
    pub kept: Lattice,
    /// See `kept`.
    pub wear: Lattice,
    /// Counts of the handwheels that were dropped so far.
    pub dropped: PerAxis<i32>,
    /// Those of the contour wheel.
    pub dropped_contour: i32,
    /// Path that is left of the present motion, nm.
    pub distance_to_go: u64,
    /// Speed along the path, nm a tick with 12 fraction bits.
    pub speed: Speed,
    /// Why the machine is locked.
    pub alarm: Option<Alarm>,
    /// Line of the block being executed, 0 for none.
    pub line: u32,
    /// Where the axes are, is known.
    pub verified: PerAxis<bool>,
    /// What the outputs are.
    pub outputs: Outputs,
    /// Following errors, nm.
    pub following: PerAxis<i32>,
    /// What a drive can't do.
    pub trouble: Option<Trouble>,
    /// Line in which a program was interrupted, 0 for none.
    pub interrupted: u32,
    /// The threading lever is engaged.
    pub lever: bool,
    /// Picking up a thread.
    pub pick_up: PickUp,
}

impl Foreground<'_> {
    /// What there is to be seen.
    pub fn shown(&self) -> Shown {
        let desk = &self.desk;
        Shown {
            mode: desk.mode,
            state: self.channel.state(),
            position: self.position(),
            programmed: self.channel.position(),
            offset: self.channel.offset(),
            kept: desk.kept,
            wear: desk.wear,
            dropped: desk.wheels.dropped,
            dropped_contour: desk.wheels.dropped_contour,
            distance_to_go: self.channel.to_go() >> FRACTION_BITS,
            speed: self.channel.speed(),
            alarm: self.alarm,
            line: self.channel.line(),
            verified: desk.verified,
            outputs: self.outputs,
            following: desk.following,
            trouble: desk.trouble,
            interrupted: desk.interrupted,
            lever: self.engaged(),
            pick_up: desk.pick_up,
        }
    }

    /// The program's place in nm, X as a radius: where a program that is compiled now begins.
    pub fn programmed_nm(&self) -> Option<(Length, Length)> {
        let at = self.channel.position();
        Some((length(self.desk.machine.x.pulse, at.x)?, length(self.desk.machine.z.pulse, at.z)?))
    }

    /// Nanometres of so many pulses of an axis.
    pub fn nm_of(&self, axis: Axis, pulses: i32) -> Option<Length> {
        match axis {
            Axis::X => length(self.desk.machine.x.pulse, pulses),
            Axis::Z => length(self.desk.machine.z.pulse, pulses),
        }
    }
}
