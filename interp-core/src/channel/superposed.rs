//! Pulses that are added to the program's: those of the compensation and of the hands.
//!
//! The contract: [`begin`](Superposed::begin) tells, before a tick's steps are made, *these signed pulses of X and Z are
//! to be added in this tick*. They are spread evenly over it and come among the program's steps in the order of time,
//! through the shaper and under its rules. [`end`](Superposed::end) makes those that the program's last step left.
//! What is added in all ticks is made to the pulse; how it comes by is not the caller's concern. Its speed and
//! acceleration together with the program's are.
//!
//! **Opposite pulses cancel first.** A pulse that would turn its axis round is not made at once: it is owed. A pulse
//! the other way, the program's or an added one, then cancels it, and neither is made. A second one the same way shows
//! that the axis does turn: it is made, and the one still owed an eighth of a tick later, so that a motor that has stood is
//! not asked for two pulses at once. So does the time, after [`PATIENCE`] ticks. So a motor is at most one
//! pulse behind, and an axis that moves on under a compensation against its motion never turns round. What touches no
//! pulse that is owed goes on in rows: the steps of the other axis alone, too.
//!
//! A tick without such pulses knows nothing of all this.

use crate::config::TICK_CLOCKS;
use crate::curve::Step;
use crate::curve::strides::Strides;
use crate::shaper::Shaper;
use crate::times::{FRACTION, Times};
use crate::train::Train;
use crate::units::Axis;

/// Ticks that a pulse may be owed.
pub const PATIENCE: u8 = 16;

/// What is added to one axis.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
struct Added {
    /// Pulses that are still due in this tick, and when.
    left: u32,
    times: Times,
    /// Their direction, 0 where none were.
    sign: i8,
    /// A pulse, at most, that would turn the axis round and waits.
    owed: i8,
    /// Ticks that it has waited.
    waited: u8,
}

impl Added {
    const NONE: Self = Self { left: 0, times: Times { time: 0, spacing: 0 }, sign: 0, owed: 0, waited: 0 };

    fn begin(&mut self, pulses: i32) {
        self.left = pulses.unsigned_abs();
        self.sign = pulses.signum() as i8;
        if let Some(spacing) = (TICK_CLOCKS << FRACTION).checked_div(self.left) {
            self.times = Times { time: spacing / 2, spacing };
        }
    }

    /// When the next one is due, if any.
    #[inline]
    fn due(&self) -> Option<u32> {
        (self.left > 0).then_some(self.times.time)
    }

    /// Takes the next one.
    #[inline]
    fn take(&mut self) -> i8 {
        self.left = self.left.wrapping_sub(1);
        self.times.time = self.times.time.wrapping_add(self.times.spacing);
        self.sign
    }

    /// A pulse that is due (or none) at a clock: what is to be made now of an axis that faces plus or not, at most one pulse.
    #[inline]
    fn offer(&mut self, clock: u32, pulse: i8, faces_plus: bool) -> i8 {
        let owed = self.owed.wrapping_add(pulse);
        let turns = (owed > 0) != faces_plus;
        if owed == 0 || turns && owed.unsigned_abs() == 1 {
            self.owed = owed;
            self.waited = if owed == 0 { 0 } else { self.waited };
            return 0;
        }
        (self.owed, self.waited) = (0, 0);
        if owed.unsigned_abs() > 1 {
            self.postpone(clock, owed.signum());
        }
        owed.signum()
    }

    /// Makes a pulse somewhat later: a motor that has stood is not asked for two at once.
    #[cold]
    fn postpone(&mut self, clock: u32, pulse: i8) {
        if self.left == 0 {
            let later = clock.saturating_add(TICK_CLOCKS / 8).min(LATE.max(clock));
            (self.left, self.sign) = (1, pulse);
            self.times = Times { time: later << FRACTION, spacing: 0 };
        } else if self.sign == pulse {
            self.left = self.left.wrapping_add(1);
        } else {
            self.left = self.left.wrapping_sub(1);
        }
    }

    /// A tick is over: what must not wait longer.
    fn patience(&mut self, patience: u8) -> i8 {
        if self.owed == 0 {
            return 0;
        }
        self.waited = self.waited.saturating_add(1);
        if self.waited < patience {
            return 0;
        }
        self.waited = 0;
        core::mem::take(&mut self.owed)
    }
}

/// What is added to the program of one lathe.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Superposed {
    x: Added,
    z: Added,
    live: bool,
    /// No pulse is made, the program's included.
    muted: bool,
}

impl Superposed {
    /// Nothing.
    pub const fn new() -> Self {
        Self { x: Added::NONE, z: Added::NONE, live: false, muted: false }
    }

    /// Makes no pulses from now on, or makes them again; nothing may be owed.
    pub const fn mute(&mut self, muted: bool) {
        self.muted = muted;
    }

    /// Adds these signed pulses of X and Z in the tick that begins.
    #[inline]
    pub fn begin(&mut self, x: i32, z: i32) {
        // nothing is left of the tick before
        if x == 0 && z == 0 {
            return;
        }
        self.x.begin(x);
        self.z.begin(z);
        self.live |= x != 0 || z != 0;
    }

    /// Whether steps have to be made by [`step`](Self::step) and not past it.
    #[inline]
    pub const fn is_live(&self) -> bool {
        self.live | self.muted
    }

    /// Whether something is still to be made.
    pub const fn owes(&self) -> bool {
        self.live
    }

    /// Forgets what is owed, between two ticks: the pulses of X and Z that are never made.
    pub fn abandon(&mut self) -> (i32, i32) {
        let owed = (i32::from(self.x.owed), i32::from(self.z.owed));
        *self = Self { muted: self.muted, ..Self::new() };
        owed
    }

    /// How many of `count` steps of the program, due at `times`, are made past it in a row, and as steps of which kinds: up to
    /// the next pulse that is added and the next step that moves an axis which owes one. What is due before the first of them
    /// is made here. `straight` tells how many steps, of so many, are straight before the next diagonal one.
    #[inline]
    pub fn room(
        &mut self,
        times: &Times,
        count: u32,
        strides: &Strides,
        straight: impl FnOnce(u32) -> u32,
        shaper: &mut Shaper,
        out: &mut impl Train,
    ) -> (u32, Strides) {
        let room = self.room_before(times, count, strides, shaper, out);
        if room > 0 && (self.waits() || self.opposes(strides, shaper)) {
            (straight(room), strides.straight())
        } else {
            (room, *strides)
        }
    }

    /// The same, but for diagonal steps that move an axis which owes a pulse, or that would turn it against what is added.
    #[cold]
    fn room_before(
        &mut self,
        times: &Times,
        count: u32,
        strides: &Strides,
        shaper: &mut Shaper,
        out: &mut impl Train,
    ) -> u32 {
        if self.muted {
            return 0;
        }
        let first = times.time >> FRACTION;
        if self.next().is_some_and(|next| next >> FRACTION <= first) {
            self.until(first, shaper, out);
        }
        let waits = self.waits();
        let owes = |added: &Added, axis: Axis| added.owed != 0 && strides.always_moves(axis);
        if owes(&self.x, Axis::X) || owes(&self.z, Axis::Z) {
            return 0;
        }
        // a step that would turn an axis round again is offered to what is added
        if !shaper.faces(strides) {
            let straight = strides.straight();
            if waits && !shaper.faces(&straight) || self.opposes(&straight, shaper) {
                return 0;
            }
        }
        let Some(next) = self.next() else { return count };
        // of two in one clock the added one comes first
        let next = next >> FRACTION << FRACTION;
        let Some(before) = next.checked_sub(times.time).and_then(|room| room.checked_sub(1)) else { return 0 };
        before.checked_div(times.spacing).map_or(0, |more| more.saturating_add(1)).min(count)
    }

    /// Whether steps would turn an axis round against what is added to it in this tick.
    #[inline]
    fn opposes(&self, strides: &Strides, shaper: &Shaper) -> bool {
        let axis = |added: &Added, axis: Axis| match shaper.turns(strides, axis) {
            Some(true) => added.sign < 0,
            Some(false) => added.sign > 0,
            None => false,
        };
        // as a rule none turns
        !shaper.faces(strides) && (axis(&self.x, Axis::X) || axis(&self.z, Axis::Z))
    }

    /// Whether a pulse is owed.
    #[inline]
    const fn waits(&self) -> bool {
        self.x.owed != 0 || self.z.owed != 0
    }

    /// When the next one is due.
    #[inline]
    fn next(&self) -> Option<u32> {
        match (self.x.due(), self.z.due()) {
            (Some(x), Some(z)) => Some(x.min(z)),
            (x, z) => x.or(z),
        }
    }

    /// Makes a step of the program, due at `clock`, after what is due until then.
    #[cold]
    pub fn step(&mut self, clock: u32, step: Step, shaper: &mut Shaper, out: &mut impl Train) {
        self.until(clock, shaper, out);
        self.offer(clock, step, step, shaper, out);
    }

    /// Makes what the tick still owes. Where the program does not move nothing of its own can cancel a pulse, and none waits.
    #[cold]
    pub fn end(&mut self, moves: bool, shaper: &mut Shaper, out: &mut impl Train) {
        // what was postponed may be due past the tick
        self.until(u32::MAX, shaper, out);
        let patience = if moves { PATIENCE } else { 0 };
        let (x, z) = (self.x.patience(patience), self.z.patience(patience));
        self.make(LATE, [x, z], Step { x: 0, z: 0 }, shaper, out);
        self.live = self.waits();
    }

    /// Makes what is due until `clock`.
    fn until(&mut self, clock: u32, shaper: &mut Shaper, out: &mut impl Train) {
        while let Some(next) = self.next() {
            let due = (next >> FRACTION).min(TICK_CLOCKS);
            if due > clock {
                return;
            }
            let x = if self.x.due() == Some(next) { self.x.take() } else { 0 };
            let z = if self.z.due() == Some(next) { self.z.take() } else { 0 };
            self.offer(due, Step { x, z }, Step { x: 0, z: 0 }, shaper, out);
        }
    }

    /// Offers a step to both axes and makes what they make of it; `program` of it is the program's.
    fn offer(&mut self, clock: u32, step: Step, program: Step, shaper: &mut Shaper, out: &mut impl Train) {
        let x = if step.x == 0 { 0 } else { self.x.offer(clock, step.x, shaper.faces_plus(Axis::X)) };
        let z = if step.z == 0 { 0 } else { self.z.offer(clock, step.z, shaper.faces_plus(Axis::Z)) };
        self.make(clock, [x, z], program, shaper, out);
    }

    /// Makes so many pulses of X and Z, one of each at a time, and tells in what they differ from the program's step.
    fn make(&self, clock: u32, pulses: [i8; 2], program: Step, shaper: &mut Shaper, out: &mut impl Train) {
        let ([mut x, mut z], mut program) = (pulses, program);
        loop {
            let due = Step { x: x.signum(), z: z.signum() };
            let made = if self.muted { Step { x: 0, z: 0 } } else { due };
            if made.x != 0 || made.z != 0 {
                shaper.step(clock, made.x, made.z, out);
            }
            if made != program {
                out.superposed(shaper.began().max(clock.cast_signed()), program, made);
            }
            (x, z, program) = (x.wrapping_sub(due.x), z.wrapping_sub(due.z), Step { x: 0, z: 0 });
            if x == 0 && z == 0 {
                return;
            }
        }
    }
}

/// When a pulse is made that nothing has cancelled: towards the tick's end, but with time for its events before it.
const LATE: u32 = TICK_CLOCKS - TICK_CLOCKS / 8;

impl Default for Superposed {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests;
