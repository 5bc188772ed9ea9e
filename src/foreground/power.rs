//! Power feed: the joystick moves a slide to a stop, or both along the contour; there and back, as often as asked for.
//!
//! A feed along an axis is a straight path of the machine's own, from where the tool stands to the shoulder stop, else to the
//! soft limit: so feed, override, feed a turn of the spindle and an exact end are those of any path. Letting go of the
//! joystick brakes and forgets it, and so does a hold. What follows the contour is [elsewhere](super::along).

use super::Foreground;
use super::desk::{part, part_mut};
use super::inputs::{AXES, Joystick, PerAxis};
use super::mode::Mode;
use super::refusal::Refusal;
use interp_core::block::Feed;
use interp_core::channel::State;
use interp_core::units::{Axis, Lattice};

/// What power feed is doing.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) enum Phase {
    /// Nothing.
    Rest,
    /// Along an axis.
    Feed { axis: Axis, plus: bool },
    /// On the contour: led forward, or back, by a push, or standing.
    Contour(Option<bool>),
    /// Along the contour back to where the push began.
    ContourReturn,
    /// A thread by lever.
    Thread,
    /// Back to where it began.
    Return,
    /// Brakes.
    Brake,
}

/// Power feed.
#[derive(Copy, Clone, Debug)]
pub(super) struct Power {
    pub(super) phase: Phase,
    /// The feed asked for, if one was.
    pub(super) feed: Option<Feed>,
    /// Shoulder stops, in the program's pulses.
    pub(super) stops: PerAxis<Option<i32>>,
    /// Whether each axis moved to plus when it moved last.
    pub(super) came: PerAxis<Option<bool>>,
    /// Where the last feed began.
    pub(super) began: Option<Lattice>,
    /// It was a thread by lever.
    pub(super) threaded: bool,
    /// Feeds that are still to be made there and back, the present one included.
    pub(super) repeats: u16,
    /// The feed runs at rapid, else at this feed.
    pub(super) rapid: bool,
    pub(super) runs_at: Feed,
    /// The joystick's last position that has been dealt with: it is not begun again where it has led to its end.
    pub(super) done: Joystick,
}

impl Power {
    pub(super) const fn new() -> Self {
        Self {
            phase: Phase::Rest,
            feed: None,
            stops: PerAxis { x: None, z: None },
            came: PerAxis { x: None, z: None },
            began: None,
            threaded: false,
            repeats: 0,
            rapid: false,
            runs_at: Feed::Rapid,
            done: Joystick::Off,
        }
    }

    /// The feed that it runs at.
    const fn runs(&self) -> Feed {
        if self.rapid { Feed::Rapid } else { self.runs_at }
    }

    /// Forgets what it was doing; stops and feed stay.
    pub(super) const fn cancel(&mut self, joystick: Joystick) {
        self.phase = Phase::Rest;
        self.repeats = 0;
        self.done = joystick;
    }

    /// Where a feed along an axis from `from` ends: at the stop, where it lies that way, else at the limit.
    pub(super) fn end(&self, axis: Axis, plus: bool, from: i32, limit: i32) -> i32 {
        match self.stop_ahead(axis, plus, from) {
            Some(stop) if plus => stop.min(limit),
            Some(stop) => stop.max(limit),
            None => limit,
        }
    }

    /// The stop of an axis that is at `from`, where it lies that way. An axis that stands at its stop may leave it the way it came.
    pub(super) fn stop_ahead(&self, axis: Axis, plus: bool, from: i32) -> Option<i32> {
        let leaves = self.came.of(axis).is_some_and(|came| came != plus);
        let ahead = |stop: i32| if plus { stop > from } else { stop < from };
        self.stops.of(axis).filter(|&stop| ahead(stop) || stop == from && !leaves)
    }

    /// Where a way back to `began` ends: there, or at a shoulder that was set between.
    fn way_back(&self, from: Lattice, began: Lattice) -> Lattice {
        let mut to = began;
        for axis in AXES {
            let (from, began) = (part(from, axis), part(began, axis));
            if began != from {
                *part_mut(&mut to, axis) = self.end(axis, began > from, from, began);
            }
        }
        to
    }

    /// Whether the tool is on the contour.
    pub(super) const fn on_contour(&self) -> bool {
        matches!(self.phase, Phase::Contour(_) | Phase::ContourReturn)
    }

    /// Back where a feed began: with repeats left the joystick begins the next one.
    pub(super) const fn repeat(&mut self) {
        if self.repeats > 0 {
            self.repeats = self.repeats.wrapping_sub(1);
            if self.repeats > 0 {
                self.done = Joystick::Off;
            }
        }
    }

    /// Whether an axis is moved by power now.
    pub(super) fn drives(&self, axis: Axis) -> bool {
        match self.phase {
            Phase::Rest => false,
            Phase::Feed { axis: driven, .. } => driven == axis,
            // beside a thread X is the operator's
            Phase::Thread => matches!(axis, Axis::Z),
            Phase::Contour(_) | Phase::ContourReturn | Phase::Return | Phase::Brake => true,
        }
    }
}

impl Foreground<'_> {
    /// A tick of power feed; and of the joystick along the contour in linked feed.
    pub(super) fn feed_on(&mut self) {
        if matches!(self.desk.inputs.joystick, Joystick::Off) {
            self.desk.power.done = Joystick::Off;
        }
        match self.desk.mode {
            Mode::Power => {}
            Mode::Linked | Mode::Retrace => return self.pull_on(),
            Mode::Handwheel | Mode::Automatic | Mode::ManualData | Mode::Homing => return,
        }
        let pushed = self.pushed();
        let held = matches!(self.channel.state(), State::Holding);
        match self.desk.power.phase {
            Phase::Rest => match pushed {
                Joystick::Off => {}
                Joystick::Axis(axis, plus) => self.begin_feed(axis, plus),
                Joystick::Path(_) => self.follow_contour(None),
            },
            Phase::Feed { axis, plus } if self.desk.own_path => {
                if held {
                    // what goes on is another push
                    self.desk.power.done = self.desk.inputs.joystick;
                }
                if pushed == Joystick::Axis(axis, plus) && !held {
                    self.feed_at();
                } else {
                    self.brake();
                }
            }
            Phase::Feed { axis, plus } => self.arrived(axis, plus),
            Phase::Contour(led) => self.follow_contour(led),
            Phase::ContourReturn => self.return_along(),
            Phase::Thread => self.thread_on(),
            Phase::Return if self.desk.own_path => {
                // with the joystick let go, or a push of it that asked for no return, it brakes
                let repeats = self.desk.power.repeats > 0;
                if repeats && matches!(self.desk.inputs.joystick, Joystick::Off) || self.desk.inputs.guard || held {
                    self.brake();
                }
            }
            Phase::Return => {
                self.desk.power.phase = Phase::Rest;
                self.desk.power.repeat();
            }
            Phase::Brake if self.desk.own_path => {}
            Phase::Brake => self.desk.power.phase = Phase::Rest,
        }
    }

    /// Begins a feed along an axis.
    fn begin_feed(&mut self, axis: Axis, plus: bool) {
        if !self.channel.hands_rest() {
            return;
        }
        if self.desk.power.repeats > 0 && self.desk.power.stops.of(axis).is_none() {
            self.desk.power.done = Joystick::Axis(axis, plus);
            self.desk.refuse(Refusal::NoStop);
            return;
        }
        self.drop_path();
        let position = self.channel.position();
        let at = part(position, axis);
        let room = self.desk.room(axis, part(self.place(), axis));
        // without limits as far as a path may lead
        let far = if plus { room.1.min(FAR) } else { room.0.max(-FAR) };
        let end = self.desk.power.end(axis, plus, at, at.saturating_add(far));
        let mut to = position;
        *part_mut(&mut to, axis) = self.desk.representable(axis, end);
        let (feed, rapid) = (self.desk.feed(), self.desk.inputs.rapid);
        let power = &mut self.desk.power;
        (power.began, power.threaded) = (Some(position), false);
        (power.rapid, power.runs_at) = (rapid, feed);
        if self.begin_line(to, self.desk.power.runs()) {
            self.desk.power.phase = Phase::Feed { axis, plus };
        } else {
            self.desk.power.done = Joystick::Axis(axis, plus);
            if room.0 == 0 && !plus || room.1 == 0 && plus {
                self.desk.refuse(Refusal::Limit(axis, plus));
            }
        }
    }

    /// Sets the feed of what runs: the one asked for, or rapid.
    fn feed_at(&mut self) {
        let (feed, rapid) = (self.desk.feed(), self.desk.inputs.rapid);
        let power = &mut self.desk.power;
        if (power.rapid, power.runs_at) != (rapid, feed) {
            (power.rapid, power.runs_at) = (rapid, feed);
            let runs = power.runs();
            self.channel.set_feed(runs);
        }
    }

    fn brake(&mut self) {
        self.channel.reset();
        self.desk.own.clear();
        self.desk.power.phase = Phase::Brake;
        self.desk.power.repeats = 0;
    }

    /// A feed has come to its end: the joystick has led there; with repeats it goes back.
    fn arrived(&mut self, axis: Axis, plus: bool) {
        let power = &mut self.desk.power;
        let (repeats, began) = (power.repeats, power.began);
        power.done = Joystick::Axis(axis, plus);
        power.phase = Phase::Rest;
        if let (1.., Some(began)) = (repeats, began) {
            self.begin_return(began);
        }
    }

    /// Begins the way back to where a feed along an axis began.
    pub(super) fn begin_return(&mut self, began: Lattice) {
        let to = self.desk.power.way_back(self.channel.position(), began);
        if self.begin_line(to, Feed::Rapid) {
            self.desk.power.phase = Phase::Return;
        }
    }

    /// The coordinates of an axis count from elsewhere: shoulder and groove stay where they are on the machine, and the
    /// way back ends.
    pub(super) fn recount(&mut self, axis: Axis, by: i32) {
        if matches!(axis, Axis::Z) {
            self.shift_groove(by);
        }
        let power = &mut self.desk.power;
        let stop = power.stops.of_mut(axis);
        *stop = stop.map(|stop| stop.wrapping_add(by));
        (power.began, power.threaded) = (None, false);
        if let Some(locked) = &mut self.desk.locked {
            let recounted = part_mut(&mut locked.recounted, axis);
            *recounted = recounted.wrapping_add(by);
        }
    }
}

/// Pulses that a feed without limits leads, at most.
pub(super) const FAR: i32 = 1 << 28;
