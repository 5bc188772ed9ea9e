//! Feeds along the contour: how far its shoulders let the tool go, and power feed there and back.
//!
//! The contour is a path of the machine's own that the contour wheel drives, or the joystick in its place
//! ([pulling](interp_core::channel::Pull)). It stays in the channel until something else begins, so the tool is led forth and
//! back on it and never leaves it. Its ends are those of the curve, or the [shoulder stops](interp_core::block::shoulder)
//! before them.
//!
//! A push of the joystick leads to an end and is over there, or where a hold or a soft limit stops it; then, and when the
//! joystick is let go, the path is held: what goes on is another push. A return leads back to where the last push began.

use super::Foreground;
use super::desk::{Desk, part};
use super::inputs::{AXES, Joystick};
use super::mode::Mode;
use super::power::Phase;
use super::refusal::Refusal;
use interp_core::block::shoulder::{Shoulder, free};
use interp_core::block::{Feed, Speed};
use interp_core::channel::{Pull, State};
use interp_core::drive::Drive;
use interp_core::math::percent;
use interp_core::units::Lattice;

/// Lengths nearer than this, 16 nm with 12 fraction bits, are one place: on an arc the last nm are too little to plan with.
const NEAR: u64 = 16 << 12;

/// Farther than any path leads.
const FAR: i64 = 1 << 60;

/// The contour that is in the channel. Lengths along it are nm with 12 fraction bits.
#[derive(Copy, Clone, Debug)]
pub(super) struct Way {
    /// Where it begins, in the program's pulses.
    from: Lattice,
    /// Its speed where it is slowest at rapid.
    rapid: Speed,
    length: i64,
    /// How far it may be followed to either side.
    least: i64,
    most: i64,
    /// Where the joystick's last push began.
    began: Option<i64>,
}

impl Way {
    /// Where the way back ends: where the last push began, or at a shoulder that was set between.
    fn way_back(&self) -> Option<i64> {
        self.began.map(|began| began.max(self.least).min(self.most))
    }
}

impl Desk {
    /// The contour, where it is in the channel.
    const fn on_way(&mut self) -> Option<&mut Way> {
        if self.own_path { self.way.as_mut() } else { None }
    }

    /// Where the joystick's last push along the contour began.
    pub(super) const fn way_began(&self) -> Option<i64> {
        match self.way {
            Some(Way { began, .. }) if self.own_path => began,
            Some(_) | None => None,
        }
    }
}

impl Foreground<'_> {
    /// Puts the contour into the channel where none is in it, from where the tool stands. False without one.
    pub(super) fn begin_contour(&mut self) -> bool {
        let Some(contour) = self.desk.contour else {
            self.desk.refuse(Refusal::NoContour);
            return false;
        };
        let from = self.channel.position();
        let drive = Drive::Wheel(self.desk.wheels.contour());
        let desk = &mut self.desk;
        if !desk.own.contour(&desk.machine, from, &contour) || !self.within_limits() {
            self.desk.own.clear();
            self.desk.refuse(Refusal::BadContour);
            return false;
        }
        let _ = self.channel.set_drive(drive);
        let (mut rapid, mut length) = (Speed::MAX, 0_u64);
        for motion in self.desk.own.motions() {
            rapid = rapid.min(motion.limit);
            length = length.saturating_add(motion.length);
        }
        let length = length.cast_signed();
        self.desk.way = Some(Way { from, rapid, length, least: 0, most: length, began: None });
        self.find_shoulders();
        self.begin_own()
    }

    /// The shoulder stops are others, while all stands.
    pub(super) fn move_shoulders(&mut self) {
        let Some(&mut Way { from, .. }) = self.desk.on_way() else { return };
        let Some(contour) = self.desk.contour else { return };
        // the channel has the motions; they are made once more, of the same figures
        let desk = &mut self.desk;
        let taken = desk.own.motions().next().is_none();
        if taken && !desk.own.contour(&desk.machine, from, &contour) {
            return;
        }
        self.find_shoulders();
        if taken {
            self.desk.own.clear();
        }
    }

    /// Finds how far the contour that was built may be followed from where the tool is.
    fn find_shoulders(&mut self) {
        let here = self.channel.position();
        let at = self.channel.along().max(0).unsigned_abs();
        let Desk { own, way: Some(way), power, .. } = &mut self.desk else { return };
        (way.least, way.most) = (0, way.length);
        for axis in AXES {
            for plus in [true, false] {
                let Some(stop) = power.stop_ahead(axis, plus, part(here, axis)) else { continue };
                let shoulder = Shoulder { axis, at: stop.wrapping_sub(part(way.from, axis)), plus };
                let (least, most) = free(own.motions(), at, shoulder);
                way.least = way.least.max(least.cast_signed());
                way.most = way.most.min(most.cast_signed());
            }
        }
        self.set_ends();
    }

    /// Tells the channel where shoulders are. What the curve itself ends at, it knows and tells.
    fn set_ends(&mut self) {
        let Some(Way { length, least, most, .. }) = self.desk.way else { return };
        let least = if least == 0 { -FAR } else { least };
        self.channel.set_ends(least, if most == length { FAR } else { most });
    }

    /// Whether the path is at a place.
    fn is_along(&self, place: i64) -> bool {
        self.channel.along().abs_diff(place) < NEAR
    }

    /// A tick of power feed along the contour, led forward or back by a push, or by none.
    pub(super) fn follow_contour(&mut self, led: Option<bool>) {
        let pushed = self.pushed();
        if let (Some(led), Joystick::Path(forward)) = (led, pushed)
            && led == forward
        {
            return self.lead_on(forward);
        }
        if led.is_some() {
            self.desk.power.repeats = 0;
            self.desk.power.phase = Phase::Contour(None);
        }
        if self.channel.speed() > 0 || matches!(self.channel.state(), State::Running | State::Filling) {
            self.stand_along();
            return;
        }
        match pushed {
            Joystick::Path(forward) => self.set_off(forward),
            // another direction leaves the contour
            Joystick::Axis(..) if self.channel.hands_rest() => {
                self.desk.power.phase = Phase::Rest;
                self.drop_path();
            }
            Joystick::Axis(..) | Joystick::Off => {}
        }
    }

    /// A push begins.
    fn set_off(&mut self, forward: bool) {
        // hands have all of the acceleration until then
        if !self.channel.hands_rest() {
            return;
        }
        match self.channel.state() {
            State::Idle | State::Ended => {
                if !self.begin_contour() {
                    self.desk.power.done = Joystick::Path(forward);
                    return;
                }
            }
            State::Holding => drop(self.channel.start()),
            State::Filling | State::Running | State::Resetting | State::Stopped => return,
        }
        let at = self.channel.along();
        if let Some(way) = self.desk.on_way() {
            way.began = Some(at);
        }
        self.desk.power.began = None;
        self.desk.power.phase = Phase::Contour(Some(forward));
        self.lead_on(forward);
    }

    /// A push goes on to its end.
    fn lead_on(&mut self, forward: bool) {
        let Some(&mut Way { least, most, .. }) = self.desk.on_way() else {
            self.desk.power.phase = Phase::Rest;
            return;
        };
        let held = matches!(self.channel.state(), State::Holding);
        let ends = self.is_along(if forward { most } else { least });
        if self.channel.speed() > 0 || !held && !ends {
            let speed = self.pull_speed();
            self.channel.pull(Some(Pull { back: !forward, speed }));
            return;
        }
        self.desk.power.done = Joystick::Path(forward);
        if held {
            self.desk.power.repeats = 0;
        }
        if self.desk.power.repeats == 0 || !self.lead_back() {
            self.stand_along();
        }
    }

    /// Brakes where it moves, and stands on the contour until something is asked for.
    fn stand_along(&mut self) {
        self.channel.pull(None);
        if self.channel.speed() == 0 {
            let _ = self.channel.hold();
        }
        self.desk.power.phase = Phase::Contour(None);
    }

    /// Begins the way back to where the last push began. False where it is there.
    pub(super) fn lead_back(&mut self) -> bool {
        let Some(to) = self.desk.on_way().and_then(|way| way.way_back()) else { return false };
        if self.is_along(to) {
            return false;
        }
        if matches!(self.channel.state(), State::Holding) {
            let _ = self.channel.start();
        }
        self.desk.power.phase = Phase::ContourReturn;
        true
    }

    /// A tick of the way back.
    #[cold]
    pub(super) fn return_along(&mut self) {
        let way = self.desk.on_way().map(|way| (way.rapid, way.way_back()));
        let Some((rapid, Some(to))) = way else {
            self.desk.power.phase = Phase::Rest;
            return;
        };
        let (at, inputs) = (self.channel.along(), &self.desk.inputs);
        // with the joystick let go, or a push of it that asked for no return, it brakes
        let let_go = self.desk.power.repeats > 0 && matches!(inputs.joystick, Joystick::Off);
        let broken = let_go || inputs.guard || matches!(self.channel.state(), State::Holding);
        if !broken && (self.channel.speed() > 0 || !self.is_along(to)) {
            self.channel.set_ends(at.min(to), at.max(to));
            let speed = percent(rapid, self.channel.rapid_override());
            self.channel.pull(Some(Pull { back: to < at, speed }));
            return;
        }
        self.set_ends();
        self.stand_along();
        if broken {
            self.desk.power.repeats = 0;
        } else {
            self.desk.power.repeat();
        }
    }

    /// The joystick along the contour in linked feed, along the program in retrace.
    pub(super) fn pull_on(&mut self) {
        let pushed = self.pushed();
        let Joystick::Path(forward) = pushed else {
            self.channel.pull(None);
            return;
        };
        if matches!(self.channel.state(), State::Idle | State::Ended) {
            if !self.channel.hands_rest() || self.desk.starting {
                return;
            }
            if matches!(self.desk.mode, Mode::Retrace) || !self.begin_contour() {
                self.desk.power.done = pushed;
                return;
            }
        }
        let speed = self.pull_speed();
        self.channel.pull(Some(Pull { back: !forward, speed }));
    }

    /// The speed that the joystick pulls at.
    fn pull_speed(&mut self) -> Speed {
        match (self.desk.inputs.rapid, self.desk.feed()) {
            (true, _) | (false, Feed::Rapid | Feed::Thread(..)) => {
                let rapid = self.desk.on_way().map(|way| way.rapid);
                rapid.map_or(Speed::MAX, |rapid| percent(rapid, self.channel.rapid_override()))
            }
            (false, Feed::PerTick(speed)) => percent(speed, self.channel.feed_override()),
            (false, Feed::PerTurn(lead)) => self.channel.per_turn(lead),
        }
    }
}
