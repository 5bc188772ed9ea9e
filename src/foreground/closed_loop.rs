//! The closed loop: where an axis has a scale, how far the slide is off is shown, watched, and slowly taken back.
//!
//! A scale is read at a tick's start: what it shows is the end of the tick made two calls before. The difference from where the
//! axis then was to be is the following error. It is smoothed; as long as it is more than a pulse, a pulse is added to the
//! train now and then, so the loop can't swing: the motor answers within a few ticks, a correction comes every
//! [`EVERY`] ticks at most.

use super::desk::part;
use super::inputs::{AXES, PerAxis};
use super::{Alarm, Foreground};
use interp_core::units::{Axis, Lattice, PulseSize};

/// Ticks between two pulses of correction.
const EVERY: u8 = 32;

/// Readings until the places of the last two ticks are those of coordinates that were just made known.
const KNOWN: u8 = 2;

/// Ticks that the error is smoothed over, as a shift.
const SMOOTH: u32 = 4;

/// The loop of one axis.
#[derive(Copy, Clone, Debug)]
struct Loop {
    /// The scale's reading less the place, nm, when the place was made known; `None` before.
    zero: Option<i64>,
    /// Smoothed error, nm with [`SMOOTH`] fraction bits.
    error: i64,
    waited: u8,
}

/// The loops of a lathe.
#[derive(Copy, Clone, Debug)]
pub(super) struct ClosedLoop {
    loops: PerAxis<Loop>,
}

impl ClosedLoop {
    pub(super) const fn new() -> Self {
        const OPEN: Loop = Loop { zero: None, error: 0, waited: 0 };
        Self { loops: PerAxis { x: OPEN, z: OPEN } }
    }

    /// The axis's place is made known anew.
    pub(super) const fn forget(&mut self, axis: Axis) {
        *self.loops.of_mut(axis) = Loop { zero: None, error: 0, waited: 0 };
    }

    /// Takes a reading, nm, of an axis that was to be at `played`: the error, nm, and a pulse to correct it.
    fn read(&mut self, axis: Axis, reading: i32, played: Lattice, pulse: PulseSize) -> (i64, i32) {
        let nm = i64::from(part(played, axis)).wrapping_mul(i64::from(pulse.numerator()));
        let nm = nm.checked_div_euclid(i64::from(pulse.denominator())).unwrap_or(0);
        let at = self.loops.of_mut(axis);
        let off = i64::from(reading).wrapping_sub(nm);
        at.waited = at.waited.saturating_add(1);
        let Some(zero) = at.zero else {
            // only then the place of two calls before is told as it is now
            if at.waited > KNOWN {
                at.zero = Some(off);
            }
            return (0, 0);
        };
        let error = off.wrapping_sub(zero);
        at.error = at.error.wrapping_add(error.wrapping_sub(at.error >> SMOOTH));
        let size = i64::from(pulse.numerator()).checked_div(i64::from(pulse.denominator())).unwrap_or(1).max(1);
        if at.waited < EVERY || (at.error >> SMOOTH).saturating_abs() <= size {
            return (error, 0);
        }
        at.waited = 0;
        (error, if at.error > 0 { -1 } else { 1 })
    }
}

impl Foreground<'_> {
    /// A tick of the closed loop.
    pub(super) fn close_loop(&mut self) {
        let mut pulses = [0, 0];
        for (axis, pulse) in AXES.into_iter().zip(&mut pulses) {
            let Some(reading) = *self.desk.inputs.scales.of(axis) else { continue };
            let size = self.desk.pulse(axis);
            let (error, correction) = self.desk.closed_loop.read(axis, reading, self.seen.before, size);
            *self.desk.following.of_mut(axis) = i32::try_from(error).unwrap_or(i32::MAX);
            let allowed = i64::from(self.desk.settings.axes.of(axis).following);
            if allowed > 0 && error.saturating_abs() > allowed && *self.desk.verified.of(axis) {
                self.raise(Alarm::following(axis));
            } else if self.desk.motors && self.alarm.is_none() {
                *pulse = correction;
            }
        }
        self.channel.correct(pulses[0], pulses[1]);
    }
}
