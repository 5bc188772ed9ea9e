//! The ends of a conic that does not pass through them.
//!
//! A conic stays where it was programmed; its rounded ends are up to half a pulse off each way, and so up to a whole pulse
//! along the minor axis. Were the walk nearest to the curve from the first step on, it would begin with a jump to it, and
//! that jump may lead back. Instead it is kept between the lines that the start can lead to and those that can lead to
//! the end, by minor steps in the direction of travel. Where the start is ahead of the curve along the minor axis, it
//! goes straight on until the curve has caught up; where it is behind, every step is diagonal until it has caught up.
//! The same holds at the end, seen backward. The deviation only falls on the way from an end.

use super::arc::Arc;
use super::octants::Octants;
use crate::units::Axis;

/// How the walk goes along a conic.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub(crate) enum Shape {
    /// To the lattice points nearest to it.
    #[default]
    Near,
    /// Along the major axis alone.
    Straight,
    /// With a minor step each time.
    Diagonal,
}

/// Where a walk is led, as its end is not the point nearest to the curve: straight, where it is ahead of the curve along
/// the minor axis at the start, or the curve of it at the end; else diagonally.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Leads {
    /// In the first octant, and for how many of its steps from the start.
    pub(crate) start: (Shape, u32),
    /// In the last octant, and for how many steps up to the end.
    pub(crate) end: (Shape, u32),
}

impl Octants {
    /// What a step of an octant's minor axis adds to its coordinate, seen from the start or from the end of the walk.
    fn minor_sign(&self, octant: u8, forward: bool) -> i32 {
        let (x, z) = Arc::signs(octant, self.sense);
        let sign = i32::from(if Arc::major(octant) == Axis::X { z } else { x });
        if forward { sign } else { sign.wrapping_neg() }
    }

    /// How, and for how many steps from line `from` toward line `to`, the walk is led at an end: seen from there.
    pub(super) fn lead(&self, octant: u8, (from, to): (i32, i32), end: (i32, i32), forward: bool) -> (Shape, u32) {
        let minor = if Arc::major(octant) == Axis::X { end.1 } else { end.0 };
        let (way, sign) = (to.wrapping_sub(from), self.minor_sign(octant, forward));
        // minor steps from the end to the point nearest the curve on a line
        let off = |lines: u32| {
            let line = from.wrapping_add(way.signum().wrapping_mul(lines.cast_signed()));
            self.minor_at(octant, line).wrapping_sub(minor).wrapping_mul(sign)
        };
        let shape = match off(0).signum() {
            0 => return (Shape::Near, 0),
            -1 => Shape::Straight,
            _ => Shape::Diagonal,
        };
        let (mut led, mut free) = (0, way.unsigned_abs());
        while free.wrapping_sub(led) > 1 {
            let middle = led.wrapping_add(free.wrapping_sub(led) >> 1);
            let is_led = if shape == Shape::Straight { off(middle) < 0 } else { off(middle) > middle.cast_signed() };
            if is_led {
                led = middle;
            } else {
                free = middle;
            }
        }
        (shape, free)
    }

    /// Where a walk that is led at an end is on the octant's far line, so many lines on.
    pub(super) fn led(
        &self,
        octant: u8,
        (line, lines): (i32, u32),
        (shape, led): (Shape, u32),
        end: (i32, i32),
        forward: bool,
    ) -> (i32, i32) {
        let axis = Arc::major(octant);
        let minor = if axis == Axis::X { end.1 } else { end.0 };
        let minor = match shape {
            Shape::Straight if led == lines => minor,
            Shape::Diagonal if led == lines => {
                minor.wrapping_add(self.minor_sign(octant, forward).wrapping_mul(lines.cast_signed()))
            }
            _ => self.minor_at(octant, line),
        };
        Self::point(axis, line, minor)
    }

    /// Lets both leads have their share of an octant that is the only one. False where its end is out of reach.
    pub(super) fn share(&mut self, octant: u8, lines: u32) -> bool {
        let minor = if Arc::major(octant) == Axis::X { self.end.1 } else { self.end.0 };
        let Ok(minors) = u32::try_from(minor.wrapping_mul(self.minor_sign(octant, true))) else { return false };
        let Leads { start: (shape, begin), end: (_, end) } = self.leads;
        if begin.saturating_add(end) > lines {
            let begin = if shape == Shape::Straight { lines.wrapping_sub(minors) } else { minors };
            self.leads.start.1 = begin;
            self.leads.end.1 = lines.wrapping_sub(begin);
        }
        minors <= lines
    }
}
