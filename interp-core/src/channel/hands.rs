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
//! the hands leave room. Each keeps clear of what the other may gain in a tick, so the sum stays within the limit.
//!
//! [`Machine::with_hands`]: crate::config::Machine::with_hands

use super::Memory;
use super::hand::{ENDLESS, Hand, beside};
use super::{Channel, State};
use crate::block::Speed;
use crate::config::{AxisLimits, Machine};
use crate::drive::follower::Bounds;
use crate::drive::wheel::Click;
use crate::math::to_u32;
use crate::units::{Axis, Lattice, PulseSize};
use core::borrow::BorrowMut;

/// All of a program's speed.
const ALL: u32 = 1 << 16;

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
    /// The program's position at the last tick.
    at: i32,
}

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
            at: 0,
        }
    }

    /// What it may do in a tick, after one in which the program moved the axis by `moved`; `None` where it stands.
    fn bounds(&self, moved: Option<i32>) -> Bounds {
        let (speed, accel) = match moved {
            None => (self.speed, self.accel.saturating_add(self.by_hand)),
            Some(pulses) => (beside(self.speed, pulses, self.accel, self.pulse), self.by_hand),
        };
        Bounds { speed: speed.min(self.pace), accel: accel.max(1) }
    }

    /// The part of a program's speed that is left beside it, 16 fraction bits.
    fn leaves(&self) -> u32 {
        let taken = self.hand.advance().unsigned_abs().saturating_add(u64::from(self.by_hand));
        let left = u64::from(self.speed).saturating_sub(taken) << 16;
        to_u32(left.checked_div(u64::from(self.speed)).unwrap_or(0))
    }
}

/// The hands of a lathe.
#[derive(Clone, Debug)]
pub(super) struct Hands {
    x: AxisHand,
    z: AxisHand,
    offset: Lattice,
    /// The part of its speed that the program may have, 16 fraction bits.
    left: u32,
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
            touched: false,
            correction: (0, 0),
        }
    }

    /// Other limits, at rest.
    pub(super) const fn configure(&mut self, machine: &Machine) {
        let offset = self.offset;
        let folds = (self.x.folds, self.z.folds);
        *self = Self::new(machine);
        self.offset = offset;
        (self.x.folds, self.z.folds) = folds;
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

    /// Whether none moves nor has to.
    #[inline]
    pub(super) const fn at_rest(&self) -> bool {
        !self.touched || self.x.hand.is_at_rest() && self.z.hand.is_at_rest()
    }

    /// A speed of the program, of which `limit` is the largest, as far as the hands leave room for it.
    #[inline]
    pub(super) fn cap(&self, target: Speed, limit: Speed) -> Speed {
        if self.left == ALL { target } else { self.cap_slowly(target, limit) }
    }

    #[cold]
    fn cap_slowly(&self, target: Speed, limit: Speed) -> Speed {
        target.min(to_u32(u64::from(limit).wrapping_mul(u64::from(self.left)) >> 16))
    }

    /// Moves for a tick beside a program that has got to `position`; `moves` tells whether it may move. The pulses of X and Z.
    #[cold]
    fn tick(&mut self, moves: bool, position: Lattice) -> (i32, i32) {
        let moved = |axis: &AxisHand, at: i32| moves.then(|| at.wrapping_sub(axis.at));
        let (x, z) = (self.x.bounds(moved(&self.x, position.x)), self.z.bounds(moved(&self.z, position.z)));
        let pulses = (self.x.hand.tick(x, self.x.pulse), self.z.hand.tick(z, self.z.pulse));
        let rest = self.at_rest();
        self.left = if rest { ALL } else { self.x.leaves().min(self.z.leaves()) };
        pulses
    }
}

impl<const N: usize, M: BorrowMut<Memory<N>>> Channel<N, M> {
    /// Whether the program may move in the tick to come.
    const fn may_move(&self) -> bool {
        self.speed > 0 || matches!(self.state, State::Running | State::Filling)
    }

    /// The tick of the hands: pulses of X and Z to be added to the program's, which pulls X out of a thread by `retract`.
    #[inline]
    pub(super) fn by_hand(&mut self, retract: i32) -> (i32, i32) {
        let (x, z) = core::mem::take(&mut self.hands.correction);
        if self.hands.at_rest() {
            self.hands.touched = false;
            (self.hands.x.at, self.hands.z.at) = (self.position.x, self.position.z);
            return (x, z);
        }
        let by_hand = self.move_by_hand(retract);
        (by_hand.0.wrapping_add(x), by_hand.1.wrapping_add(z))
    }

    #[cold]
    fn move_by_hand(&mut self, retract: i32) -> (i32, i32) {
        let moves = self.may_move() || retract != 0;
        // the retract is the program's, too
        let away = self.position.x.wrapping_sub(self.hands.x.at).saturating_abs();
        self.hands.x.at = self.position.x.wrapping_sub(away).wrapping_sub(retract.saturating_abs());
        let (x, z) = self.hands.tick(moves, self.position);
        let into = |folds: bool, position: &mut i32, offset: &mut i32, pulses: i32| {
            let place = if folds { position } else { offset };
            *place = place.wrapping_add(pulses);
        };
        let hands = &mut self.hands;
        into(hands.x.folds, &mut self.position.x, &mut hands.offset.x, x);
        into(hands.z.folds, &mut self.position.z, &mut hands.offset.z, z);
        (hands.x.at, hands.z.at) = (self.position.x, self.position.z);
        (x, z)
    }

    /// Takes the counts of a handwheel, 4 a detent, each detent worth `click`. `room` is how many pulses the axis may move
    /// to either side (at most 0, at least 0). Returns the counts dropped.
    pub fn turn_hand(&mut self, axis: Axis, click: Click, counts: i16, room: (i32, i32)) -> i32 {
        let moves = self.may_move();
        let position = match axis {
            Axis::X => self.position.x,
            Axis::Z => self.position.z,
        };
        let hand = self.hands.of(axis);
        if counts == 0 && hand.hand.is_at_rest() {
            return 0;
        }
        hand.pace = Speed::MAX;
        let bounds = hand.bounds(moves.then(|| position.wrapping_sub(hand.at)));
        let to = |pulses: i32| hand.hand.to_pulses(pulses, hand.pulse);
        let room = (to(room.0).min(0).max(ENDLESS.0), to(room.1).max(0).min(ENDLESS.1));
        hand.hand.turn(click, counts, bounds, room)
    }

    /// Moves an axis by so many pulses, at most at `pace`, in the place of all that its hand was to do.
    pub fn go_hand(&mut self, axis: Axis, pulses: i32, pace: Speed) {
        let hand = self.hands.of(axis);
        hand.pace = pace.max(1);
        let by = hand.hand.to_pulses(pulses, hand.pulse);
        hand.hand.go(by);
    }

    /// Drops what an axis's hand still has to do beyond so many pulses to either side (at most 0, at least 0). Whether it was
    /// too much.
    pub fn limit_hand(&mut self, axis: Axis, room: (i32, i32)) -> bool {
        let hand = self.hands.of(axis);
        let to = |pulses: i32| hand.hand.to_pulses(pulses, hand.pulse);
        let room = (to(room.0).min(0).max(ENDLESS.0), to(room.1).max(0).min(ENDLESS.1));
        hand.hand.limit(room)
    }

    /// How far an axis's hand goes at most if it brakes now beside a program: nm with 12 fraction bits, signed.
    pub fn hand_braking(&self, axis: Axis) -> i64 {
        let hand = match axis {
            Axis::X => &self.hands.x,
            Axis::Z => &self.hands.z,
        };
        hand.hand.braking(hand.by_hand)
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
