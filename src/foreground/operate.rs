//! A tick of the operator's side: readings become motion, and what the channel does is overseen.

use super::desk::part;
use super::inputs::{AXES, Ends, Inputs, Joystick, PerAxis};
use super::mode::Mode;
use super::power::Phase;
use super::refusal::Refusal;
use super::{Alarm, Foreground};
use interp_core::block::Feed;
use interp_core::channel::{Report, State};
use interp_core::drive::{self, Drive};
use interp_core::units::{Axis, Lattice};

impl Foreground<'_> {
    /// Before the channel's tick.
    #[inline]
    pub(super) fn operate(&mut self) {
        if self.attended {
            self.attend();
        }
        if matches!(self.channel.state(), State::Running) && self.channel.speed() == 0 {
            self.watch_start();
        }
    }

    /// Readings, requests, and what either has begun.
    #[inline(never)]
    fn attend(&mut self) {
        if let Some(reading) = self.desk.inputs.spindle.take() {
            self.channel.read(&drive::Inputs { spindle: Some(reading), wheel: 0 });
        }
        if self.desk.inputs.scales != Inputs::NONE.scales {
            self.close_loop();
        }
        self.turn_wheels();
        self.home_on();
        self.feed_on();
        self.turn_contour();
        self.start_when_still();
        self.attended = self.desk.acts() || !self.channel.hands_rest();
    }

    /// The handwheels of X and Z.
    fn turn_wheels(&mut self) {
        let counts = self.desk.inputs.wheels;
        self.desk.inputs.wheels = PerAxis { x: 0, z: 0 };
        let slides = matches!(self.desk.mode, Mode::Handwheel)
            || matches!(self.desk.mode, Mode::Power) && !matches!(self.desk.power.phase, Phase::Contour);
        // what is nulled is the offset, in every mode
        let folds = slides && !self.desk.nulling;
        self.channel.fold_hands(folds, folds);
        if counts == (PerAxis { x: 0, z: 0 }) && self.channel.hands_rest() {
            if self.desk.wheels.rest() {
                return;
            }
            // its rate falls meanwhile
            for axis in AXES {
                self.desk.wheels.click(axis, 0);
            }
            return;
        }
        let place = self.place();
        for axis in AXES {
            let counts = *counts.of(axis);
            let click = self.desk.wheels.click(axis, counts);
            // what a stop has cut off
            let stopped = self.channel.end_stop(axis, click);
            self.desk.wheels.drop(axis, stopped);
            if !self.may_turn(axis) {
                self.desk.wheels.drop(axis, i32::from(counts));
                if counts != 0 && !self.desk.settings.wheels {
                    self.desk.refuse(Refusal::WheelsOff);
                }
                continue;
            }
            let (mut least, mut most) = self.desk.room(axis, part(place, axis));
            if self.channel.speed() > 0 {
                // the path and the hand may have to brake for one and the same limit
                let braking = self.braking_pulses(axis);
                (least, most) = (least.saturating_add(braking).min(0), most.saturating_sub(braking).max(0));
            }
            // what moves by itself is not a wheel's: a turn takes it over
            if counts == 0 && self.desk.nulling {
                if self.channel.limit_hand(axis, (least, most)) {
                    self.desk.refuse(Refusal::Limit(axis, part(self.channel.offset(), axis) < 0));
                }
                continue;
            }
            self.desk.nulling = false;
            if !folds {
                let (bounds, offset) = (self.desk.settings.axes.of(axis).bounds, part(self.channel.offset(), axis));
                least = least.max(bounds.0.saturating_sub(offset).min(0));
                most = most.min(bounds.1.saturating_sub(offset).max(0));
            }
            let dropped = self.channel.turn_hand(axis, click, counts, (least, most));
            self.desk.wheels.drop(axis, dropped);
            let (at_minus, at_plus) = (least == 0 && dropped < 0, most == 0 && dropped > 0);
            if at_minus || at_plus {
                self.desk.refuse(Refusal::Limit(axis, at_plus));
            }
        }
    }

    /// Whether an axis's handwheel moves it.
    fn may_turn(&self, axis: Axis) -> bool {
        let desk = &self.desk;
        let free = match desk.mode {
            Mode::Handwheel => true,
            Mode::Homing => false,
            Mode::Power => matches!(desk.power.phase, Phase::Contour) || !desk.power.drives(axis),
            // beside a thread the spindle leads Z
            Mode::Automatic | Mode::ManualData | Mode::Linked | Mode::Retrace => {
                matches!(axis, Axis::X) || !self.channel.in_thread()
            }
        };
        free && self.alarm.is_none() && desk.motors && desk.settings.wheels && desk.homing.axis().is_none()
    }

    /// The contour wheel.
    fn turn_contour(&mut self) {
        let counts = core::mem::take(&mut self.desk.inputs.contour);
        let linked = matches!(self.desk.mode, Mode::Linked | Mode::Retrace);
        let may = linked && self.alarm.is_none() && self.desk.motors && !self.desk.inputs.guard;
        if counts == 0 {
            return;
        }
        let drop = |desk: &mut super::Desk| {
            desk.wheels.dropped_contour = desk.wheels.dropped_contour.saturating_add(i32::from(counts));
        };
        if !may {
            drop(&mut self.desk);
            return;
        }
        let idle = matches!(self.channel.state(), State::Idle | State::Ended);
        // a path begins when the handwheels rest: they have all of the acceleration until then; and not one in the place of the
        // program that was started
        let may = !self.desk.starting && self.channel.hands_rest();
        if idle && matches!(self.desk.mode, Mode::Linked) && !(may && self.begin_contour()) {
            drop(&mut self.desk);
            return;
        }
        self.channel.set_click(self.desk.wheels.contour());
        self.channel.read(&drive::Inputs { spindle: None, wheel: counts });
    }

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
        self.begin_own()
    }

    /// Begins the path of the machine's own that was built.
    pub(super) fn begin_own(&mut self) -> bool {
        self.desk.own_path = self.channel.start();
        if self.desk.own_path {
            self.channel.close();
        } else {
            self.desk.own.clear();
        }
        self.desk.own_path
    }

    /// Begins a straight path to a place. False where it is there already.
    pub(super) fn begin_line(&mut self, to: Lattice, feed: Feed) -> bool {
        let from = self.channel.position();
        let _ = self.channel.set_drive(Drive::Time);
        self.desk.own.line(&self.desk.machine, from, to, feed) && self.begin_own()
    }

    /// Whether the path that was built stays inside the soft limits.
    fn within_limits(&self) -> bool {
        let mut at = self.place();
        self.desk.own.extents().all(|(least, most, end)| {
            let inside = AXES.into_iter().all(|axis| {
                let limits = self.desk.settings.axes.of(axis).limits;
                let from = part(at, axis);
                !self.desk.verified.of(axis)
                    || from.saturating_add(part(least, axis)) >= limits.0
                        && from.saturating_add(part(most, axis)) <= limits.1
            });
            at = Lattice { x: at.x.wrapping_add(end.x), z: at.z.wrapping_add(end.z) };
            inside
        })
    }

    /// Cycle start waits until the handwheels rest: they have all of the acceleration while the program stands.
    pub(super) fn start_when_still(&mut self) {
        if self.desk.starting && self.channel.hands_rest() {
            self.desk.starting = false;
            let _ = self.channel.start();
        }
    }

    /// After the channel's tick.
    #[inline]
    pub(super) fn oversee(&mut self, report: &Report) {
        self.desk.trouble = report.driven.trouble;
        let place = self.place();
        if self.attended || report.driven.dropped != 0 || report.driven.back_end.is_some() {
            self.oversee_acts(report, place);
        }
        let before = self.seen.place;
        if place != before {
            if !self.seen.is_calm(place) {
                self.watch_limits(place);
            }
            let came = &mut self.desk.power.came;
            if place.x != before.x {
                came.x = Some(place.x > before.x);
            }
            if place.z != before.z {
                came.z = Some(place.z > before.z);
            }
        }
        (self.seen.before, self.seen.place) = (before, place);
    }

    /// What wheels and the machine's own paths have come to, and switches.
    #[inline(never)]
    fn oversee_acts(&mut self, report: &Report, place: Lattice) {
        let dropped = &mut self.desk.wheels.dropped_contour;
        *dropped = dropped.saturating_add(report.driven.dropped);
        if let Some(end) = report.driven.back_end {
            self.desk.refuse(Refusal::WayBackEnds(end));
        }
        if self.desk.nulling && self.channel.hands_rest() {
            self.desk.nulling = false;
        }
        if self.desk.own_path && matches!(report.state, State::Idle | State::Ended) {
            self.desk.own_path = false;
        }
        if self.desk.inputs.guard || self.desk.inputs.ends != Inputs::NONE.ends {
            self.watch_switches(place);
        }
    }

    /// The guard holds what runs; a limit switch that an axis runs into is an alarm.
    #[cold]
    fn watch_switches(&mut self, at: Lattice) {
        let runs = matches!(self.channel.state(), State::Running | State::Filling);
        if self.desk.inputs.guard && runs && matches!(self.channel.drive(), Drive::Time) {
            let _ = self.channel.hold();
            self.desk.refuse(Refusal::GuardOpen);
        }
        if matches!(self.desk.mode, Mode::Homing) {
            return;
        }
        for axis in AXES {
            let (moved, Ends { plus, minus }) =
                (part(at, axis).wrapping_sub(part(self.seen.place, axis)), *self.desk.inputs.ends.of(axis));
            if plus && moved > 0 || minus && moved < 0 {
                self.raise(Alarm::limit_switch(axis));
            }
        }
    }

    /// Holds a path that would lead an axis past its soft limit.
    #[cold]
    fn watch_limits(&mut self, at: Lattice) {
        if !matches!(self.channel.state(), State::Running) || self.channel.speed() == 0 {
            return;
        }
        for axis in AXES {
            let moved = part(at, axis).wrapping_sub(part(self.seen.place, axis));
            let (near, hand) = (self.braking_pulses(axis), self.hand_pulses(axis));
            let minus = if moved <= 0 { near.saturating_sub(hand.min(0)) } else { -1 };
            let plus = if moved >= 0 { near.saturating_add(hand.max(0)) } else { -1 };
            if self.stop_at_limit(axis, at, (minus, plus), hand) {
                return;
            }
        }
    }

    /// Holds a path that stands and would begin past a soft limit, before it moves.
    fn watch_start(&mut self) {
        let at = self.place();
        if !matches!(self.channel.drive(), Drive::Time) || self.seen.is_calm(at) {
            return;
        }
        for axis in AXES {
            let near = self.starting_pulses(axis);
            if self.stop_at_limit(axis, at, (near, near), 0) {
                return;
            }
        }
    }

    /// Holds the path where an axis is within so many pulses of its minus or plus limit, and the path leads farther and past it,
    /// with what the axis's hand goes while it brakes.
    fn stop_at_limit(&mut self, axis: Axis, at: Lattice, (minus, plus): (i32, i32), hand: i32) -> bool {
        let ((least, most), here) = (self.desk.settings.axes.of(axis).limits, part(at, axis));
        let near_minus = here.saturating_sub(least) <= minus && minus >= 0;
        let near_plus = most.saturating_sub(here) <= plus && plus >= 0;
        if !self.desk.verified.of(axis) || !near_minus && !near_plus {
            return false;
        }
        let shift = here.wrapping_sub(part(self.channel.position(), axis));
        let (mut low, mut high) = (here, here);
        self.channel.extents(|least, most| {
            low = low.min(part(least, axis).saturating_add(shift));
            high = high.max(part(most, axis).saturating_add(shift));
        });
        let (low, high) = (low.saturating_add(hand.min(0)), high.saturating_add(hand.max(0)));
        let to_plus = near_plus && high > most.max(here);
        let passes = to_plus || near_minus && low < least.min(here);
        if passes {
            let _ = self.channel.hold();
            self.desk.refuse(Refusal::Limit(axis, to_plus));
        }
        passes
    }

    /// Pulses that an axis goes at most if a path begins and is held after its first tick; an S law has begun more by then.
    fn starting_pulses(&self, axis: Axis) -> i32 {
        let machine = &self.desk.machine;
        let limits = if matches!(axis, Axis::X) { &machine.x } else { &machine.z };
        let (accel, window) = (u64::from(limits.accel.max(1)), u64::from(machine.smoothing.ticks()));
        let speed = accel.saturating_mul(window.saturating_add(1)).saturating_add(limits.jump.into());
        let brakes = speed.saturating_mul(speed).checked_div(accel << 1).unwrap_or(0);
        let way = brakes.saturating_add(speed.saturating_mul(window.saturating_add(2)));
        self.pulses_of(axis, way).saturating_add(2)
    }

    /// Whole pulses of so many nm with 12 fraction bits.
    fn pulses_of(&self, axis: Axis, length: u64) -> i32 {
        let (pulse, nm) = (self.desk.pulse(axis), length >> interp_core::config::FRACTION_BITS);
        let pulses = nm.saturating_mul(u64::from(pulse.denominator())).checked_div(u64::from(pulse.numerator()));
        i32::try_from(pulses.unwrap_or(0)).unwrap_or(i32::MAX >> 2)
    }

    /// Pulses that an axis's hand goes while it brakes, signed.
    fn hand_pulses(&self, axis: Axis) -> i32 {
        let braking = self.channel.hand_braking(axis);
        let pulses = self.pulses_of(axis, braking.unsigned_abs());
        if braking < 0 { pulses.wrapping_neg() } else { pulses }
    }

    /// Pulses that an axis goes at most while the path brakes.
    fn braking_pulses(&self, axis: Axis) -> i32 {
        self.pulses_of(axis, self.channel.braking()).saturating_add(2)
    }

    /// Where a joystick that is latched leads, if anywhere.
    pub(super) fn pushed(&self) -> Joystick {
        let joystick = self.desk.inputs.joystick;
        let free = self.alarm.is_none() && self.desk.motors && !self.desk.inputs.guard;
        if free && joystick != self.desk.power.done { joystick } else { Joystick::Off }
    }
}
