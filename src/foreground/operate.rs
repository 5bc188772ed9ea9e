//! A tick of the operator's side: readings become motion, and what the channel does is overseen.

use super::desk::{Nulling, part};
use super::inputs::{AXES, Ends, Inputs, Joystick, PerAxis};
use super::mode::Mode;
use super::refusal::Refusal;
use super::{Alarm, Foreground};
use interp_core::block::Feed;
use interp_core::channel::{Report, State};
use interp_core::drive::{self, Drive};
use interp_core::units::{Axis, Lattice};

/// Limits of an axis that nobody knows the place of.
const NOWHERE: (i32, i32) = (i32::MIN >> 1, i32::MAX >> 1);

impl Foreground<'_> {
    /// Before the channel's tick.
    #[inline]
    pub(super) fn operate(&mut self) {
        if let Some(reading) = self.desk.inputs.spindle.take() {
            self.channel.read(&drive::Inputs { spindle: Some(reading), wheel: 0 });
        }
        if self.attended {
            self.attend();
        }
    }

    /// Readings, requests, and what either has begun.
    #[inline(never)]
    fn attend(&mut self) {
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

    /// Tells the channel what soft limits and bounds there are: whenever one of them, or where the axes count from, has changed.
    pub(super) fn set_limits(&mut self) {
        let desk = &self.desk;
        // soft limits are in the machine's own coordinates, the channel's places in the program's
        let beside = desk.physical(desk.datum, Lattice::default());
        let inside = |axis: Axis| {
            let (least, most) = desk.settings.axes.of(axis).limits;
            let by = part(beside, axis);
            if *desk.verified.of(axis) { (least.saturating_sub(by), most.saturating_sub(by)) } else { NOWHERE }
        };
        let (x, z) = (inside(Axis::X), inside(Axis::Z));
        let axes = &desk.settings.axes;
        self.channel.set_fence(Lattice { x: x.0, z: z.0 }, Lattice { x: x.1, z: z.1 });
        self.channel.set_bounds(axes.x.bounds, axes.z.bounds);
    }

    /// The handwheels of X and Z.
    fn turn_wheels(&mut self) {
        let counts = self.desk.inputs.wheels;
        self.desk.inputs.wheels = PerAxis { x: 0, z: 0 };
        // what homing has begun to move is a slide until it stands
        let slides = matches!(self.desk.mode, Mode::Handwheel | Mode::Homing)
            || matches!(self.desk.mode, Mode::Power) && !self.desk.power.on_contour();
        if matches!(self.desk.nulling, Nulling::Waits) && self.channel.hands_rest() {
            self.null_offset();
        }
        // what is nulled is the offset, in every mode
        let folds = slides && !matches!(self.desk.nulling, Nulling::Goes);
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
            let ends = self.desk.switches(axis);
            // what moves by itself is not a wheel's: a turn takes it over
            if counts == 0 && !matches!(self.desk.nulling, Nulling::No) {
                if self.channel.limit_hand(axis, ends) {
                    self.desk.refuse(Refusal::Limit(axis, part(self.channel.offset(), axis) < 0));
                }
                continue;
            }
            if slides && matches!(self.desk.nulling, Nulling::Goes) {
                // a turn ends it; what it goes while it brakes is the offset's still, and no slide's
                AXES.into_iter().for_each(|axis| self.channel.stop_hand(axis));
                self.desk.wheels.drop(axis, i32::from(counts));
                continue;
            }
            self.desk.nulling = Nulling::No;
            let (dropped, at_end) = self.channel.turn_hand(axis, click, counts, ends);
            self.desk.wheels.drop(axis, dropped);
            if at_end {
                let refusal = self.end_of_hand(axis, dropped > 0, folds);
                self.desk.refuse(refusal);
            }
        }
    }

    /// What ends the room of a hand, that moves the slide or makes an offset.
    fn end_of_hand(&self, axis: Axis, plus: bool, folds: bool) -> Refusal {
        let (least, most) = self.desk.settings.axes.of(axis).bounds;
        let off = part(self.channel.offset(), axis);
        if !folds && if plus { off >= most } else { off <= least } {
            Refusal::Bound(axis, plus)
        } else {
            Refusal::Limit(axis, plus)
        }
    }

    /// Sends the hands back to where no offset is.
    pub(super) fn null_offset(&mut self) {
        let (offset, safe) = (self.channel.offset(), self.desk.settings.safe);
        self.desk.nulling = Nulling::Goes;
        for axis in AXES {
            self.channel.go_hand(axis, part(offset, axis).wrapping_neg(), safe);
        }
    }

    /// Whether an axis's handwheel moves it.
    fn may_turn(&self, axis: Axis) -> bool {
        let desk = &self.desk;
        let free = match desk.mode {
            Mode::Handwheel => true,
            Mode::Homing => false,
            Mode::Power => desk.power.on_contour() || !desk.power.drives(axis),
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
        self.desk.way = None;
        self.desk.own.line(&self.desk.machine, from, to, feed) && self.begin_own()
    }

    /// Whether the path that was built stays inside the soft limits.
    pub(super) fn within_limits(&self) -> bool {
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

    /// Cycle start waits until the handwheels rest: they have all of the acceleration while the program stands. Where a guard was
    /// opened meanwhile it is held before it moves.
    pub(super) fn start_when_still(&mut self) {
        if self.desk.starting && self.channel.hands_rest() {
            self.desk.starting = false;
            let _ = self.channel.start();
            if self.desk.inputs.guard && self.channel.hold() {
                self.desk.refuse(Refusal::GuardOpen);
            }
        }
    }

    /// After the channel's tick, that the program began at `from`.
    #[inline]
    pub(super) fn oversee(&mut self, report: &Report, from: Lattice) {
        self.desk.trouble = report.driven.trouble;
        let place = self.place();
        if self.attended || report.driven.dropped != 0 || report.driven.back_end.is_some() {
            self.oversee_acts(report, place);
        }
        if let Some((axis, plus)) = self.channel.met_fence() {
            self.desk.refuse(Refusal::Limit(axis, plus));
        }
        self.note_way(from);
        (self.seen.before, self.seen.place) = (self.seen.place, place);
    }

    /// Notes from which side the program's place comes: that is what shoulders stop, and not what hands lead beside it. Only
    /// the way within a tick counts, as coordinates are set anew between ticks.
    #[inline]
    fn note_way(&mut self, from: Lattice) {
        let (at, came) = (self.channel.position(), &mut self.desk.power.came);
        if at.x != from.x {
            came.x = Some(at.x > from.x);
        }
        if at.z != from.z {
            came.z = Some(at.z > from.z);
        }
    }

    /// What wheels and the machine's own paths have come to, and switches.
    #[inline(never)]
    fn oversee_acts(&mut self, report: &Report, place: Lattice) {
        let dropped = &mut self.desk.wheels.dropped_contour;
        *dropped = dropped.saturating_add(report.driven.dropped);
        if let Some(end) = report.driven.back_end {
            self.desk.refuse(Refusal::WayBackEnds(end));
        }
        if matches!(self.desk.nulling, Nulling::Goes) && self.channel.hands_rest() {
            self.desk.nulling = Nulling::No;
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

    /// Where a joystick that is latched leads, if anywhere.
    pub(super) fn pushed(&self) -> Joystick {
        let joystick = self.desk.inputs.joystick;
        let free = self.alarm.is_none() && self.desk.motors && !self.desk.inputs.guard;
        if free && joystick != self.desk.power.done { joystick } else { Joystick::Off }
    }
}
