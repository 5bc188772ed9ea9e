//! Figures of operation: limits, bounds of the intervention, homing, safe speeds.

use super::inputs::PerAxis;
use interp_core::block::Speed;

/// Figures of one axis; places in pulses of the machine's own coordinates.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct AxisSettings {
    /// Soft limits, minus and plus.
    pub limits: (i32, i32),
    /// How far the handwheel may lead off the program, to minus (at most 0) and to plus, pulses.
    pub bounds: (i32, i32),
    /// The home switch is at the plus end.
    pub home_plus: bool,
    /// Speed on which it is looked for.
    pub home_speed: Speed,
    /// Coordinate where it opens again.
    pub home: i32,
    /// Following error that is an alarm, nm; 0 for none.
    pub following: i32,
}

/// Which switches the machine has, where a board reads them.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Fitted {
    /// A switch tells whether the guard is closed.
    pub guard: bool,
    /// Limit switches at the axes' ends.
    pub ends: bool,
}

/// Figures of operation.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Of each axis.
    pub axes: PerAxis<AxisSettings>,
    /// The handwheels may be turned.
    pub wheels: bool,
    /// Speed on which offsets go back to zero and a program is gone back into.
    pub safe: Speed,
    /// Feed of a dry run.
    pub dry: Speed,
    /// Feed of power feed until another one is asked for.
    pub power: Speed,
    /// Switches that a board reads.
    pub fitted: Fitted,
}

impl Settings {
    /// No limits; wheels on.
    pub const NONE: Self = {
        let far = (i32::MIN >> 1, i32::MAX >> 1);
        let fitted = Fitted { guard: true, ends: true };
        let axis =
            AxisSettings { limits: far, bounds: far, home_plus: true, home_speed: 1 << 12, home: 0, following: 0 };
        Self { axes: PerAxis { x: axis, z: axis }, wheels: true, safe: 1 << 12, dry: 1 << 12, power: 1 << 12, fitted }
    };
}
