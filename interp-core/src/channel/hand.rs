//! An axis moved by hand: the handwheels, and whatever else moves one axis by itself beside the program (homing, a return).
//!
//! What is asked for is a distance. A handwheel asks through [`Wheel`], which smooths a detent, bounds what may be queued and
//! tells what it drops; others ask for a distance outright, or for a stop. The distance is followed within a speed and an
//! acceleration ([`Follower`]), and the place comes in whole pulses for [`Superposed`](super::superposed::Superposed).
//!
//! The place is held in nanometres with 12 fraction bits, not in pulses: a detent is worth an exact part of a micrometre
//! whatever the pulse is, the remainder is carried, and as many counts back lead to the very same pulse.

use crate::config::FRACTION_BITS;
use crate::drive::follower::{Bounds, Follower};
use crate::drive::wheel::{Click, Wheel};
use crate::math::to_i32;
use crate::units::PulseSize;

/// Room to either side of a place, nm with 12 fraction bits: the first at most 0, the second at least 0.
pub type Room = (i64, i64);

/// Room without an end.
pub const ENDLESS: Room = (i64::MIN >> 8, i64::MAX >> 8);

/// An axis moved by hand.
#[derive(Copy, Clone, Debug)]
pub struct Hand {
    wheel: Wheel,
    follower: Follower,
    stopping: bool,
    /// A distance was asked for outright, not by a wheel.
    going: bool,
    /// What a wheel had asked for when it was stopped, less what it has gone since: nm with 12 fraction bits.
    lost: i64,
    /// Nanometres with 12 fraction bits since the beginning.
    place: i64,
    /// Pulses made of it.
    made: i32,
}

impl Hand {
    /// At rest; nothing is asked for.
    pub const fn new() -> Self {
        let (wheel, follower) = (Wheel::new(), Follower::new());
        Self { wheel, follower, stopping: false, going: false, lost: 0, place: 0, made: 0 }
    }

    /// Whether it neither moves nor has to, and has told all that was dropped.
    pub const fn is_at_rest(&self) -> bool {
        self.follower.advance() == 0 && self.wheel.is_at_rest() && self.lost == 0
    }

    /// Advance of the last tick, nm with 12 fraction bits.
    pub const fn advance(&self) -> i64 {
        self.follower.advance()
    }

    /// Takes the counts of a handwheel, 4 a detent. Returns those dropped: what would run on by more than braking, a click
    /// and a tick, and what would leave the room.
    pub fn turn(&mut self, click: Click, counts: i16, bounds: Bounds, room: Room) -> i32 {
        if self.stopping && counts == 0 {
            return 0;
        }
        if self.going {
            // a turn takes it over: it goes on as far as it has to
            self.wheel.ask(self.braking(bounds.accel));
        }
        let speed = self.follower.advance().saturating_abs();
        (self.stopping, self.going) = (false, false);
        let lost = self.tell(click);
        let dropped = self.wheel.turn(click, counts, self.braking(bounds.accel), speed);
        dropped.saturating_add(self.wheel.limit(click, room)).saturating_add(lost)
    }

    /// Where a stop has come to its end: the counts that the wheel had asked for and that are dropped, begun ones too.
    pub fn end_stop(&mut self, click: Click) -> i32 {
        if self.stopping && self.follower.advance() != 0 {
            return 0;
        }
        self.stopping = false;
        self.tell(click)
    }

    fn tell(&mut self, click: Click) -> i32 {
        crate::drive::wheel::dropped(core::mem::take(&mut self.lost), click)
    }

    /// What a wheel asked for is dropped from here on, to be told when it stands.
    const fn drop_rest(&mut self) {
        if !self.going {
            self.lost = self.lost.saturating_add(self.wheel.all());
        }
        self.wheel.ask(0);
        (self.going, self.stopping) = (false, true);
    }

    /// How far it goes if it brakes by so much a tick, signed: v (v + a) / 2a.
    pub fn braking(&self, accel: u32) -> i64 {
        let advance = self.follower.advance();
        let (speed, accel) = (advance.unsigned_abs(), u64::from(accel.max(1)));
        let braking = speed.wrapping_mul(speed.saturating_add(accel));
        let braking = braking.checked_div(accel << 1).unwrap_or(0).cast_signed();
        if advance < 0 { braking.wrapping_neg() } else { braking }
    }

    /// Drops what leads out of the room, and is no wheel's. Whether anything does.
    pub fn limit(&mut self, room: Room) -> bool {
        let [least, ..] = Click::DECADES;
        !self.stopping && self.wheel.limit(least, room) != 0
    }

    /// Asks for a distance in the place of all asked for before.
    pub const fn go(&mut self, by: i64) {
        self.drop_rest();
        (self.stopping, self.going) = (false, true);
        self.wheel.ask(by);
    }

    /// Asks for a stop, as soon as the acceleration allows.
    pub const fn stop(&mut self) {
        self.drop_rest();
    }

    /// Stops at once, from any speed: for an emergency.
    pub const fn abandon(&mut self) {
        self.drop_rest();
        self.follower = Follower::new();
    }

    /// The distance from here to where `pulses` more pulses are made, exactly.
    pub fn to_pulses(&self, pulses: i32, pulse: PulseSize) -> i64 {
        let made = i64::from(self.made.wrapping_add(pulses)).wrapping_mul(i64::from(pulse.numerator()));
        let place = made.wrapping_shl(FRACTION_BITS).checked_div(i64::from(pulse.denominator())).unwrap_or(0);
        place.wrapping_sub(self.place)
    }

    /// The pulses that it makes until it stands if it brakes by so much a tick.
    pub fn pulses_to_stand(&self, accel: u32, pulse: PulseSize) -> i32 {
        let advance = self.follower.advance();
        if advance == 0 {
            return 0;
        }
        // (v - a) + (v - 2 a) + ..
        let (speed, accel) = (advance.unsigned_abs(), u64::from(accel.max(1)));
        let ticks = speed.checked_div(accel).unwrap_or(0);
        let less = accel.wrapping_mul(ticks.wrapping_mul(ticks.saturating_add(1)) >> 1);
        let way = speed.saturating_mul(ticks).saturating_sub(less).cast_signed();
        let braking = if advance < 0 { way.wrapping_neg() } else { way };
        pulses(self.place.wrapping_add(braking), pulse).wrapping_sub(self.made)
    }

    /// Moves for a tick within `bounds`, and so that braking by `share` a tick it stops inside the room; the pulses that it moved
    /// by.
    pub fn tick(&mut self, bounds: Bounds, room: Room, share: u32, pulse: PulseSize) -> i32 {
        let before = self.follower.advance();
        if self.stopping {
            let accel = i64::from(bounds.accel);
            self.follower.set(before.wrapping_sub(before.max(accel.wrapping_neg()).min(accel)));
            if self.lost != 0 {
                self.lost = self.lost.saturating_sub(self.follower.advance());
            }
        } else {
            let distance = self.wheel.to_go();
            if distance == 0 && before == 0 {
                return 0;
            }
            self.wheel.went(self.follower.follow_inside(distance, bounds, room, share));
        }
        self.place = self.place.wrapping_add(self.follower.advance());
        let pulses = pulses(self.place, pulse);
        let moved = pulses.wrapping_sub(self.made);
        self.made = pulses;
        moved
    }
}

/// The whole pulse nearest to a place, half up.
fn pulses(place: i64, pulse: PulseSize) -> i32 {
    let numerator = i64::from(pulse.numerator());
    let doubled = place.wrapping_mul(i64::from(pulse.denominator()));
    let half = numerator.wrapping_shl(FRACTION_BITS.wrapping_sub(1));
    let nearest = doubled.wrapping_add(half).checked_div_euclid(numerator.wrapping_shl(FRACTION_BITS));
    to_i32(nearest.unwrap_or(0))
}

impl Default for Hand {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const BOUNDS: Bounds = Bounds { speed: 83_333 << 12, accel: 500 << 12 };

    /// What a hand has beside a program.
    const SHARE: u32 = 150 << 12;

    proptest! {
        /// Wherever it is from then on left its share only, it stops inside its room.
        #[test]
        fn it_can_always_stop_inside_its_room_with_its_share(
            pulses in 1_i32..4_000, counts in 100_i16..3_000, ticks in 1_u32..200, far: bool
        ) {
            let pulse = PulseSize::new(2_500, 1).unwrap();
            let click = Click::from_nm(100_000).unwrap();
            let (mut hand, mut made) = (Hand::new(), 0);
            for _ in 0..ticks {
                let room = (-1, hand.to_pulses(pulses - made, pulse));
                hand.turn(click, counts / 40, BOUNDS, if far { ENDLESS } else { room });
                made += hand.tick(BOUNDS, room, SHARE, pulse);
                prop_assert!(made + hand.pulses_to_stand(SHARE, pulse) <= pulses);
            }
            let stands = made + hand.pulses_to_stand(SHARE, pulse);
            hand.stop();
            while !hand.is_at_rest() {
                made += hand.tick(Bounds { accel: SHARE, ..BOUNDS }, ENDLESS, SHARE, pulse);
                // it rests once what it dropped is told
                let _ = hand.end_stop(click);
            }
            prop_assert!(made <= stands && stands <= pulses);
        }

        /// Any turns at any scale, then the same back: the very same pulse, however many were dropped on the way.
        #[test]
        fn what_is_not_dropped_is_moved_exactly(
            turns in prop::collection::vec((-60_i16..60, 0_usize..3, 0_u32..40), 1..60),
            numerator in 1000_u32..30_000, denominator in 1_u32..20
        ) {
            let pulse = PulseSize::new(numerator, denominator).unwrap();
            let clicks = [1_000, 10_000, 100_000].map(|nm| Click::from_nm(nm).unwrap());
            let (mut hand, mut asked, mut made) = (Hand::new(), 0_i64, 0_i64);
            for (counts, scale, ticks) in turns {
                for tick in 0..=ticks {
                    let counts = if tick == 0 { counts } else { 0 };
                    let dropped = hand.turn(clicks[scale], counts, BOUNDS, ENDLESS);
                    asked += (i64::from(counts) - i64::from(dropped)) * [250, 2_500, 25_000][scale];
                    made += i64::from(hand.tick(BOUNDS, ENDLESS, BOUNDS.accel, pulse));
                }
            }
            while !hand.is_at_rest() {
                asked -= i64::from(hand.turn(clicks[0], 0, BOUNDS, ENDLESS)) * 250;
                made += i64::from(hand.tick(BOUNDS, ENDLESS, BOUNDS.accel, pulse));
            }
            // nearest pulse of the nanometres asked for, half up
            let (n, d) = (i64::from(numerator), i64::from(denominator));
            prop_assert_eq!(made, (2 * asked * d + n).div_euclid(2 * n));
        }

        /// Limits are met exactly and never passed, from any speed that the bounds allow.
        #[test]
        fn a_limit_is_met_and_not_passed(pulses in 1_i32..40_000, counts in 100_i16..3_000, ticks in 1_u32..400) {
            let pulse = PulseSize::new(2_500, 1).unwrap();
            let click = Click::from_nm(100_000).unwrap();
            let (mut hand, mut made, mut dropped) = (Hand::new(), 0, 0);
            for _ in 0..ticks {
                let room = (-1, hand.to_pulses(pulses - made, pulse));
                dropped += hand.turn(click, counts / 40, BOUNDS, room);
                made += hand.tick(BOUNDS, room, SHARE, pulse);
                prop_assert!(made <= pulses);
            }
            for _ in 0..4_000 {
                let room = (-1, hand.to_pulses(pulses - made, pulse));
                dropped += hand.turn(click, 10, BOUNDS, room);
                made += hand.tick(BOUNDS, room, SHARE, pulse);
                prop_assert!(made <= pulses);
            }
            prop_assert_eq!(made, pulses);
            prop_assert!(dropped > 0);
        }
    }

    #[test]
    fn it_stops_as_soon_as_the_acceleration_allows() {
        let (mut hand, pulse) = (Hand::new(), PulseSize::new(1_000, 1).unwrap());
        hand.go(1 << 40);
        for _ in 0..50 {
            hand.tick(BOUNDS, ENDLESS, BOUNDS.accel, pulse);
        }
        assert_eq!(hand.advance(), (50 * 500) << 12);
        hand.stop();
        let ticks = (0..)
            .take_while(|_| {
                hand.tick(BOUNDS, ENDLESS, BOUNDS.accel, pulse);
                !hand.is_at_rest()
            })
            .count();
        assert_eq!(ticks, 49);
    }
}
