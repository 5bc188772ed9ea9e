//! The two kinds of step that a row consists of, prepared for the loop that makes it.

use super::Step;
use crate::train::Levels;
use crate::units::Axis;

/// Step pins that a step raises.
const fn raised(step: Step) -> Levels {
    Levels::LOW.with_step(Axis::X, step.x != 0).with_step(Axis::Z, step.z != 0)
}

/// What turned in a row.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Turned {
    /// Diagonal steps.
    pub count: u32,
    /// The last one, from 0; any number where there was none.
    pub last: u32,
}

/// The recurrence of a row of steps, made for the loop that runs it: what else is asked of it is told at its end.
pub trait Turns {
    /// Whether the next step is diagonal.
    fn turns(&mut self) -> bool;
    /// What turned of the `steps` steps asked so far, below 2^11.
    fn turned(&self, steps: u32) -> Turned;
}

/// A straight step moves the major axis, a diagonal one both.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Strides {
    /// What a straight step moves, X and Z.
    straight: [i32; 2],
    /// What a diagonal one moves besides.
    besides: [i32; 2],
    /// Step pins that a straight and a diagonal step raise.
    pub(crate) raised: [Levels; 2],
    /// Direction pins of the axes that move, and those of them that are high.
    directions: Levels,
    plus: Levels,
}

impl Strides {
    /// Of these steps; the axis of `straight` moves in `diagonal`, too, and the same way.
    pub const fn new(straight: Step, diagonal: Step) -> Self {
        Self {
            straight: [straight.x as i32, straight.z as i32],
            besides: [
                (diagonal.x as i32).wrapping_sub(straight.x as i32),
                (diagonal.z as i32).wrapping_sub(straight.z as i32),
            ],
            raised: [raised(straight), raised(diagonal)],
            directions: Levels::LOW.with_plus(Axis::X, diagonal.x != 0).with_plus(Axis::Z, diagonal.z != 0),
            plus: Levels::LOW.with_plus(Axis::X, diagonal.x > 0).with_plus(Axis::Z, diagonal.z > 0),
        }
    }

    /// The straight kind alone: what the other axis faces is nothing to it.
    pub(crate) const fn straight(&self) -> Self {
        let [straight, _] = self.raised;
        // a direction's bit is the one above its step's
        let moves = straight.bits() << 1;
        Self {
            directions: Levels::from_bits(self.directions.bits() & moves),
            plus: Levels::from_bits(self.plus.bits() & moves),
            ..*self
        }
    }

    /// Whether every step moves an axis.
    pub(crate) const fn always_moves(&self, axis: Axis) -> bool {
        let [straight, _] = self.raised;
        straight.step(axis)
    }

    /// One step.
    pub(crate) const fn step(&self, diagonal: bool) -> Step {
        let (x, z) = self.lead(1, if diagonal { 1 } else { 0 });
        #[expect(clippy::cast_possible_truncation, reason = "-1, 0 or 1")]
        Step { x: x as i8, z: z as i8 }
    }

    /// Whether every direction pin is as these steps need it.
    #[inline]
    pub(crate) const fn agree(&self, levels: Levels) -> bool {
        levels.bits() & self.directions.bits() == self.plus.bits()
    }

    /// The direction that an axis has to take, plus or not, where `levels` have the other one.
    pub(crate) const fn turned(&self, axis: Axis, levels: Levels) -> Option<bool> {
        let plus = self.plus.plus(axis);
        if self.directions.plus(axis) && levels.plus(axis) != plus { Some(plus) } else { None }
    }

    /// How far `steps` steps lead, `diagonals` of them diagonal: X and Z.
    #[inline]
    pub(crate) const fn lead(&self, steps: u32, diagonals: u32) -> (i32, i32) {
        let (steps, diagonals) = (steps.cast_signed(), diagonals.cast_signed());
        let [x, z] = self.straight;
        let [more_x, more_z] = self.besides;
        (
            x.wrapping_mul(steps).wrapping_add(more_x.wrapping_mul(diagonals)),
            z.wrapping_mul(steps).wrapping_add(more_z.wrapping_mul(diagonals)),
        )
    }
}
