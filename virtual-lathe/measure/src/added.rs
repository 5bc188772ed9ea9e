//! Pulses that a motor makes beyond the program.
//!
//! A control that compensates tells of every step that is not the program's own: where the motor moves and the program
//! does not, or the other way round. Its word is not taken for it: a declared pulse has to be on the pins, the program
//! as it is left over has to follow the curves, and the motor has to keep its limits.

use crate::setup::{PerAxis, Setup};

/// A step at which motor and program differ.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Added {
    /// Clocks since the start of the tick.
    pub clock: u32,
    /// How the program moves.
    pub program: PerAxis<i32>,
    /// How the motor moves; nothing, and no edge, where it has nothing to do.
    pub motor: PerAxis<i32>,
}

/// Part of an axis's speed that the program is left while the axis is compensated.
const SPEED_LEFT: f64 = 15.0 / 16.0;
/// Part of its acceleration.
const ACCEL_LEFT: f64 = 4.0 / 5.0;

/// The set-up that the program has where these axes are compensated.
pub(crate) fn program_setup(mut setup: Setup, compensated: PerAxis<bool>) -> Setup {
    for (limits, on) in [(&mut setup.limits.x, compensated.x), (&mut setup.limits.z, compensated.z)] {
        if on {
            limits.max_feed *= SPEED_LEFT;
            limits.max_accel *= ACCEL_LEFT;
        }
    }
    setup
}
