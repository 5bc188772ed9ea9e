//! Hands in the channel: axes moved beside the program.
//!
//! What a [`Hand`] moves is added to the program's pulses and makes the **offset**; where it *folds*, it becomes part of the
//! position instead, as when a slide is wound to a new place.
//!
//! **Acceleration.** A machine with handwheels keeps a share of each axis's acceleration for them ([`Machine::with_hands`]):
//! while the program may move the hand has that share, the program never more than the rest. While the program stands the hand
//! has all. So their sum keeps the axis's limit, whatever either does.
//!
//! **Speed.** The hand gets what the program leaves of the axis's largest speed; the program may gain speed only in so far as
//! the hands leave room. So the sum stays within the limit: see [`beside`].
//!
//! **Room.** A hand stops where its axis meets the [fence](super::fence), beside a path that may need a part of the room, and
//! where the offset meets its bound. It approaches either with its share, so that a program that begins finds it able to stop.
//!
//! [`Machine::with_hands`]: crate::config::Machine::with_hands

mod beside;

use super::Memory;
use super::hand::{ENDLESS, Hand, Room};
use super::{Channel, Current};
use crate::block::Speed;
use crate::config::{AxisLimits, FRACTION_BITS, Machine};
use crate::drive::follower::Bounds;
use crate::drive::wheel::Click;
use crate::math::to_u32;
use crate::units::{Axis, Lattice, PulseSize};
use beside::Path;
use core::borrow::BorrowMut;

/// Any speed of a program.
const ALL: Speed = Speed::MAX;

/// A hand with its axis's limits.
#[derive(Copy, Clone, Debug)]
struct AxisHand {
    hand: Hand,
    pulse: PulseSize,
    speed: Speed,
    /// The program's acceleration, and the hand's beside it.
    accel: u32,
    by_hand: u32,
    /// Speed of what moves now.
    pace: Speed,
    folds: bool,
    /// How far the offset may go.
    bounds: (i32, i32),
    /// Room in the tick that comes, where it is known already.
    room: Option<Room>,
}

/// No bounds.
const UNBOUND: (i32, i32) = (i32::MIN >> 1, i32::MAX >> 1);

impl AxisHand {
    const fn new(limits: &AxisLimits) -> Self {
        Self {
            hand: Hand::new(),
            pulse: limits.pulse,
            speed: limits.speed,
            accel: limits.accel,
            by_hand: limits.by_hand,
            pace: Speed::MAX,
            folds: false,
            bounds: UNBOUND,
            room: None,
        }
    }

    /// What it has of the acceleration beside a program; all, where none was kept for it.
    const fn share(&self) -> u32 {
        if self.by_hand > 0 { self.by_hand } else { self.accel }
    }

    /// Moves for a tick; the pulses.
    fn tick(&mut self, bounds: Bounds) -> i32 {
        let room = self.room.take().unwrap_or(ENDLESS);
        self.hand.tick(bounds, room, self.share(), self.pulse)
    }

    /// Room of so many pulses as lengths.
    fn length(&self, (least, most): (i32, i32)) -> Room {
        let to = |pulses: i32| self.hand.to_pulses(pulses, self.pulse);
        (to(least).min(0).max(ENDLESS.0), to(most).max(0).min(ENDLESS.1))
    }

    /// Whole pulses of a length, nm with 12 fraction bits, and one more.
    fn pulses_of(&self, length: u64) -> i32 {
        let nm = (length >> FRACTION_BITS).saturating_mul(self.pulse.denominator().into());
        let numerator = self.pulse.numerator();
        let pulses = match u32::try_from(nm) {
            // the usual case, in one instruction
            Ok(nm) => nm.checked_div(numerator).unwrap_or(0).into(),
            Err(_) => nm.checked_div(numerator.into()).unwrap_or(0),
        };
        to_u32(pulses.min(u64::from(u32::MAX >> 2))).cast_signed().saturating_add(1)
    }
}

/// The hands of a lathe.
#[derive(Clone, Debug)]
pub(super) struct Hands {
    x: AxisHand,
    z: AxisHand,
    offset: Lattice,
    /// The speed that the program may gain.
    left: Speed,
    /// The path beside which they moved last.
    path: Option<Path>,
    /// A hand was touched since all were seen to rest.
    touched: bool,
    /// Pulses of X and Z to be made in the next tick that nobody counts.
    correction: (i32, i32),
}

impl Hands {
    pub(super) const fn new(machine: &Machine) -> Self {
        Self {
            x: AxisHand::new(&machine.x),
            z: AxisHand::new(&machine.z),
            offset: Lattice { x: 0, z: 0 },
            left: ALL,
            path: None,
            touched: false,
            correction: (0, 0),
        }
    }

    /// Other limits, at rest.
    pub(super) const fn configure(&mut self, machine: &Machine) {
        let offset = self.offset;
        let (folds, bounds) = ((self.x.folds, self.z.folds), (self.x.bounds, self.z.bounds));
        *self = Self::new(machine);
        self.offset = offset;
        (self.x.folds, self.z.folds) = folds;
        (self.x.bounds, self.z.bounds) = bounds;
    }

    const fn of(&mut self, axis: Axis) -> &mut AxisHand {
        self.touched = true;
        match axis {
            Axis::X => &mut self.x,
            Axis::Z => &mut self.z,
        }
    }

    /// Stops at once.
    pub(super) const fn abandon(&mut self) {
        self.x.hand.abandon();
        self.z.hand.abandon();
    }

    pub(super) const fn offset(&self) -> Lattice {
        self.offset
    }

    /// Pulses until they stand, if they brake beside a program.
    pub(super) fn braking(&self) -> Lattice {
        let of = |axis: &AxisHand| axis.hand.pulses_to_stand(axis.share(), axis.pulse);
        Lattice { x: of(&self.x), z: of(&self.z) }
    }

    /// Pulses of X and Z that a length, nm with 12 fraction bits, is at most.
    pub(super) fn pulses_of(&self, length: u64) -> (i32, i32) {
        (self.x.pulses_of(length), self.z.pulses_of(length))
    }

    /// More than any path gains in a tick.
    pub(super) const fn accel(&self) -> Speed {
        self.x.accel.saturating_add(self.z.accel)
    }

    /// More than anything needs to brake, and so many ticks at the largest speeds: nm with 12 fraction bits.
    pub(super) fn longest_braking(&self, ticks: u8) -> u64 {
        let speed = u64::from(self.x.speed).saturating_add(self.z.speed.into());
        self.braking_from(speed).saturating_add(speed.saturating_mul(ticks.into()))
    }

    /// More than anything needs to brake from a speed: nm with 12 fraction bits.
    pub(super) fn braking_from(&self, speed: u64) -> u64 {
        let least = |axis: &AxisHand| axis.accel.min(axis.share()).max(1);
        let accel = u64::from(least(&self.x).min(least(&self.z)));
        // on an arc turning takes up to half of it
        speed.saturating_mul(speed).checked_div(accel).unwrap_or(u64::MAX)
    }

    /// Whether none moves nor has to.
    #[inline]
    pub(super) const fn at_rest(&self) -> bool {
        !self.touched || self.x.hand.is_at_rest() && self.z.hand.is_at_rest()
    }

    /// A speed of the program, as far as the hands leave room for it.
    #[inline]
    pub(super) const fn cap(&self, target: Speed) -> Speed {
        if target < self.left { target } else { self.left }
    }

    /// Moves for a tick beside a program that may move. The pulses of X and Z.
    #[cold]
    fn tick(&mut self, path: Option<Path>) -> (i32, i32) {
        let (x, z) = self.bounds(path);
        let pulses = (self.x.tick(x), self.z.tick(z));
        let rest = self.at_rest();
        self.left = path.filter(|_| !rest).map_or(ALL, |path| self.leave(path));
        self.path = path;
        pulses
    }
}

impl<const N: usize, M: BorrowMut<Memory<N>>> Channel<N, M> {
    /// The tick of the hands: pulses of X and Z to be added to the program's, which pulls X out of a thread by `retract`.
    #[inline]
    pub(super) fn by_hand(&mut self, retract: i32) -> (i32, i32) {
        let (x, z) = core::mem::take(&mut self.hands.correction);
        if self.hands.at_rest() {
            if core::mem::take(&mut self.hands.touched) {
                // an emergency may have stopped a hand at speed
                self.hands.left = ALL;
                (self.hands.x.room, self.hands.z.room) = (None, None);
            }
            return (x, z);
        }
        let by_hand = self.move_by_hand(retract);
        (by_hand.0.wrapping_add(x), by_hand.1.wrapping_add(z))
    }

    #[cold]
    fn move_by_hand(&mut self, retract: i32) -> (i32, i32) {
        for axis in [Axis::X, Axis::Z] {
            let hand = self.hands.of(axis);
            if hand.room.is_none() && !hand.hand.is_at_rest() {
                let _ = self.find_room(axis, UNBOUND);
            }
        }
        // the retract is the program's, too
        let path = self.path(retract != 0);
        let (x, z) = self.hands.tick(path);
        let into = |folds: bool, position: &mut i32, offset: &mut i32, pulses: i32| {
            let place = if folds { position } else { offset };
            *place = place.wrapping_add(pulses);
        };
        let hands = &mut self.hands;
        if let Current::Motion(active) = &mut self.current {
            // the path goes on beside where it began
            active.from.x = active.from.x.wrapping_add(if hands.x.folds { x } else { 0 });
            active.from.z = active.from.z.wrapping_add(if hands.z.folds { z } else { 0 });
        }
        into(hands.x.folds, &mut self.position.x, &mut hands.offset.x, x);
        into(hands.z.folds, &mut self.position.z, &mut hands.offset.z, z);
        (x, z)
    }

    /// Sets how far the offset may go: to minus (at most 0) and to plus (at least 0), pulses of X and of Z.
    pub const fn set_bounds(&mut self, x: (i32, i32), z: (i32, i32)) {
        (self.hands.x.bounds, self.hands.z.bounds) = (x, z);
    }

    /// Finds the room of an axis's hand in the tick that comes, inside `ends`: pulses, at most 0 and at least 0; and as lengths.
    fn find_room(&mut self, axis: Axis, ends: (i32, i32)) -> ((i32, i32), Room) {
        let offset = self.hands.offset;
        let (mut least, mut most) = ends;
        let mut bound = |(low, high): (i32, i32)| (least, most) = (least.max(low.min(0)), most.min(high.max(0)));
        if !self.fence.is_free(self.tool()) {
            let span = self.braking_reach().moved(offset);
            bound(self.fence.room(axis, &span));
        }
        let off = if matches!(axis, Axis::X) { offset.x } else { offset.z };
        let hand = self.hands.of(axis);
        if !hand.folds {
            bound((hand.bounds.0.saturating_sub(off), hand.bounds.1.saturating_sub(off)));
        }
        let room = hand.length((least, most));
        hand.room = Some(room);
        ((least, most), room)
    }

    /// Takes the counts of a handwheel, 4 a detent, each detent worth `click`. `ends` is how many pulses the axis may move
    /// to either side (at most 0, at least 0), besides fence and bounds. Returns the counts dropped, and whether there was no room
    /// at all for them.
    pub fn turn_hand(&mut self, axis: Axis, click: Click, counts: i16, ends: (i32, i32)) -> (i32, bool) {
        let hand = self.hands.of(axis);
        if counts == 0 && hand.hand.is_at_rest() {
            return (0, false);
        }
        let ((least, most), room) = self.find_room(axis, ends);
        self.hands.of(axis).pace = Speed::MAX;
        if self.hands.at_rest() {
            // what moves has looked in the last tick
            self.hands.path = self.path(false);
        }
        let (x, z) = self.hands.bounds(self.hands.path);
        let bounds = if matches!(axis, Axis::X) { x } else { z };
        let hand = self.hands.of(axis);
        let dropped = hand.hand.turn(click, counts, bounds, room);
        (dropped, dropped < 0 && least == 0 || dropped > 0 && most == 0)
    }

    /// Moves an axis by so many pulses, at most at `pace`, in the place of all that its hand was to do.
    pub fn go_hand(&mut self, axis: Axis, pulses: i32, pace: Speed) {
        let hand = self.hands.of(axis);
        hand.pace = pace.max(1);
        let by = hand.hand.to_pulses(pulses, hand.pulse);
        hand.hand.go(by);
    }

    /// Drops what an axis's hand still has to do beyond `ends` (pulses, at most 0 and at least 0), fence and bounds. Whether it was
    /// too much.
    pub fn limit_hand(&mut self, axis: Axis, ends: (i32, i32)) -> bool {
        let (_, room) = self.find_room(axis, ends);
        self.hands.of(axis).hand.limit(room)
    }

    /// Stops what a hand does, as soon as its acceleration allows.
    pub fn stop_hand(&mut self, axis: Axis) {
        self.hands.of(axis).hand.stop();
    }

    /// Where an axis's hand has come to the end of a stop: the counts, each detent worth `click`, that a wheel had asked for
    /// and that are dropped.
    pub fn end_stop(&mut self, axis: Axis, click: Click) -> i32 {
        self.hands.of(axis).hand.end_stop(click)
    }

    /// Makes pulses in the next tick that are no part of the position: what a scale found missing.
    pub const fn correct(&mut self, x: i32, z: i32) {
        self.hands.correction = (x, z);
    }

    /// Whether no hand moves nor has to.
    pub const fn hands_rest(&self) -> bool {
        self.hands.at_rest()
    }

    /// Advance of an axis's hand in the last tick, nm with 12 fraction bits.
    pub const fn hand_advance(&self, axis: Axis) -> i64 {
        match axis {
            Axis::X => self.hands.x.hand.advance(),
            Axis::Z => self.hands.z.hand.advance(),
        }
    }

    /// Sets of which axes the hands move the position (true) and of which they make an offset (false).
    pub const fn fold_hands(&mut self, x: bool, z: bool) {
        (self.hands.x.folds, self.hands.z.folds) = (x, z);
    }

    /// Whether the hands move the position, of either axis.
    pub const fn hands_fold(&self) -> bool {
        self.hands.x.folds || self.hands.z.folds
    }

    /// Pulses by which the axes are off the program.
    pub const fn offset(&self) -> Lattice {
        self.hands.offset
    }

    /// Calls the offset another one; nothing moves.
    pub const fn set_offset(&mut self, offset: Lattice) {
        let before = self.tool();
        self.hands.offset = offset;
        self.compensation.rename(before, self.tool());
    }
}
