//! What the operator's hands and the machine's switches say, read once a tick.

use interp_core::drive::spindle;
use interp_core::units::Axis;

/// One value for each axis.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct PerAxis<T> {
    /// Of the cross slide.
    pub x: T,
    /// Of the carriage.
    pub z: T,
}

impl<T> PerAxis<T> {
    /// Of an axis.
    pub const fn of(&self, axis: Axis) -> &T {
        match axis {
            Axis::X => &self.x,
            Axis::Z => &self.z,
        }
    }

    /// Of an axis.
    pub const fn of_mut(&mut self, axis: Axis) -> &mut T {
        match axis {
            Axis::X => &mut self.x,
            Axis::Z => &mut self.z,
        }
    }
}

/// Both axes.
pub const AXES: [Axis; 2] = [Axis::X, Axis::Z];

/// Where the joystick is latched.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub enum Joystick {
    /// In the middle.
    #[default]
    Off,
    /// Along an axis, to plus or minus.
    Axis(Axis, bool),
    /// Along the contour, forward or backward.
    Path(bool),
}

/// A limit switch at either end of an axis.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Ends {
    /// At the plus end.
    pub plus: bool,
    /// At the minus end.
    pub minus: bool,
}

impl Inputs {
    /// Nothing is touched.
    pub const NONE: Self = {
        let open = Ends { plus: false, minus: false };
        Self {
            wheels: PerAxis { x: 0, z: 0 },
            contour: 0,
            spindle: None,
            joystick: Joystick::Off,
            rapid: false,
            ends: PerAxis { x: open, z: open },
            guard: false,
            scales: PerAxis { x: None, z: None },
        }
    };

    /// Whether anything is touched. The spindle is read in every tick, whoever attends.
    pub(super) const fn is_touched(&self) -> bool {
        let Self { wheels, contour, spindle: _, joystick, rapid, ends, guard, scales } = self;
        let Ends { plus, minus } = ends.x;
        let Ends { plus: plus_z, minus: minus_z } = ends.z;
        let switched = plus | minus | plus_z | minus_z | *rapid | *guard;
        wheels.x | wheels.z | *contour != 0
            || switched
            || !matches!(joystick, Joystick::Off)
            || scales.x.is_some()
            || scales.z.is_some()
    }
}

/// Readings of a tick.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Inputs {
    /// Counts of the handwheels since the last tick, 4 a detent.
    pub wheels: PerAxis<i16>,
    /// Counts of the contour wheel since the last tick.
    pub contour: i16,
    /// The spindle's encoder.
    pub spindle: Option<spindle::Reading>,
    /// The joystick.
    pub joystick: Joystick,
    /// The rapid button is held down.
    pub rapid: bool,
    /// Limit switches, true where one is met.
    pub ends: PerAxis<Ends>,
    /// The guard is open, or something else inhibits cycle start.
    pub guard: bool,
    /// Scales, nm from where the position was last made known.
    pub scales: PerAxis<Option<i32>>,
}
