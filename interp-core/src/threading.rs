//! What the machine does about threads: its spindle's encoder, and how a tool leaves a thread.

use crate::units::Length;

/// Figures of a machine that cuts threads.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Threading {
    /// Counts a turn of the spindle's encoder, 4 a line; 0 for none.
    pub encoder: u32,
    /// How far the cross slide is pulled out of a thread (below 0 inward, for internal ones); 0 for not at all: a hold
    /// then acts at the thread's end.
    pub retract: Length,
    /// Faults of the spindle end the cut, and a spindle that does not turn is not waited for without end.
    pub guarded: bool,
}

impl Threading {
    /// No encoder; a thread is followed whatever the spindle does.
    pub const NONE: Self = Self { encoder: 0, retract: Length::ZERO, guarded: false };
}
