//! Carries out requests that the [mode](super::mode) allows.

use super::command::{Command, Stop};
use super::desk::{Locked, Nulling, part, part_mut};
use super::homing;
use super::inputs::{AXES, Joystick, PerAxis};
use super::mode::{Mode, Situation};
use super::power::Phase;
use super::refusal::Refusal;
use super::threads::Lever;
use super::{Alarm, Foreground};
use interp_core::channel::State;
use interp_core::drive::Drive;
use interp_core::units::{Axis, Lattice, Length};

impl Foreground<'_> {
    /// What a request meets.
    pub(super) fn situation(&self) -> Situation {
        let desk = &self.desk;
        let state = self.channel.state();
        let drives = matches!(self.channel.drive(), Drive::Time);
        let runs = matches!(state, State::Running | State::Filling | State::Resetting);
        let moves = self.channel.speed() > 0
            || !self.channel.hands_rest()
            || self.channel.owes()
            || self.channel.wheel_asks()
            || desk.homing.axis().is_some()
            || desk.starting
            || matches!(desk.nulling, Nulling::Waits)
            // a path that is driven by hand may stand as long as it likes
            || (runs && drives);
        Situation {
            mode: desk.mode,
            state,
            moves,
            hands: !self.channel.hands_rest(),
            starting: desk.starting,
            own_path: desk.own_path,
            alarm: self.alarm,
            open: self.open,
            guard: desk.inputs.guard,
            motors: desk.motors,
            verified: desk.verified.x && desk.verified.z,
            cut: desk.power.began.is_some() || desk.way_began().is_some(),
            threaded: desk.power.threaded,
            stop: desk.power.stops.x.is_some() || desk.power.stops.z.is_some() || desk.contour.is_some(),
            kept: desk.interrupted != 0,
            thread: self.channel.in_thread(),
        }
    }

    /// Does what was asked for and is allowed.
    pub(super) fn carry_out(&mut self, command: Command) -> Result<(), Refusal> {
        let done = self.carry_out_one(command);
        self.set_limits();
        done
    }

    fn carry_out_one(&mut self, command: Command) -> Result<(), Refusal> {
        match command {
            Command::Mode(mode) => self.change_mode(mode),
            Command::Start => {
                self.desk.starting = true;
                self.start_when_still();
            }
            Command::Hold => drop(self.channel.hold()),
            Command::Reset => self.reset(),
            Command::Unlock => {
                if matches!(self.channel.state(), State::Idle | State::Ended) {
                    self.alarm = None;
                }
            }
            Command::FeedOverride(percent) => self.channel.set_feed_override(percent),
            Command::RapidOverride(percent) => self.channel.set_rapid_override(percent),
            Command::SpindleOverride(percent) => self.desk.spindle_override = percent.min(200),
            Command::OptionalStop(on) => self.channel.set_optional_stop(on),
            Command::SingleBlock(on) => self.channel.set_single_block(on),
            Command::DryRun(on) => self.desk.dry_run = on,
            Command::MachineLock(on) => self.lock(on),
            Command::Configure(machine) => {
                // a path of the machine's own was built with the figures that end here
                self.drop_path();
                if self.channel.configure(&machine) {
                    self.desk.machine = machine;
                }
            }
            Command::Settle(settings) => self.desk.settings = settings,
            Command::Scale(click) => self.desk.wheels.set_scale(click),
            Command::FeedRate(feed) => self.desk.power.feed = Some(feed),
            Command::StopAt(axis, stop) => self.set_stop(axis, stop)?,
            Command::Contour(contour) => {
                self.drop_path();
                self.desk.contour = Some(contour);
            }
            Command::Return => self.go_back()?,
            Command::Repeat(times) => self.desk.power.repeats = times,
            Command::Home(axis) => self.seek_home(axis),
            Command::Zero(axis, at) => self.set_place(axis, at),
            Command::ConfirmPosition => {
                self.desk.verified = PerAxis { x: true, z: true };
                AXES.into_iter().for_each(|axis| self.desk.closed_loop.forget(axis));
            }
            Command::Motors(on) => {
                self.desk.motors = on;
                if !on {
                    self.desk.verified = PerAxis::default();
                }
            }
            Command::KeepOffset => {
                let offset = self.take_offset();
                add(&mut self.desk.kept, offset);
            }
            Command::BookWear => {
                let offset = self.take_offset();
                add(&mut self.desk.wear, offset);
            }
            Command::NullOffset => {
                if self.channel.hands_fold() && !self.channel.hands_rest() {
                    // what a hand moves now is a slide; what it goes on with would be an offset
                    AXES.into_iter().for_each(|axis| self.channel.stop_hand(axis));
                    self.desk.nulling = Nulling::Waits;
                } else {
                    self.null_offset();
                }
            }
            Command::Spindle(speed) => self.desk.spindle = speed,
            Command::Lever(engage) => self.set_lever(engage)?,
            Command::PickUp(step) => self.pick_up(step)?,
            Command::Resume => {
                self.desk.interrupted = 0;
                self.desk.starting = true;
                self.start_when_still();
            }
        }
        Ok(())
    }

    /// Leaves a mode and enters another, at rest.
    fn change_mode(&mut self, mode: Mode) {
        let before = self.desk.mode;
        if mode == before {
            return;
        }
        match (before, mode) {
            (Mode::Automatic, Mode::Retrace) => {
                // nothing moves: the drive can be another one
                let _ = self.channel.set_drive(Drive::Wheel(self.desk.wheels.contour()));
                let _ = self.channel.start();
            }
            (Mode::Retrace, Mode::Automatic) => {
                let _ = self.channel.hold();
                let _ = self.channel.set_drive(Drive::Time);
            }
            _ => {
                self.drop_path();
                let linked = matches!(mode, Mode::Linked);
                let drive = if linked { Drive::Wheel(self.desk.wheels.contour()) } else { Drive::Time };
                let _ = self.channel.set_drive(drive);
            }
        }
        self.desk.mode = mode;
        self.desk.power.cancel(self.desk.inputs.joystick);
        self.desk.lever = Lever::Out;
        if !matches!(self.desk.inputs.joystick, Joystick::Off) {
            self.desk.refuse(Refusal::JoystickLatched);
        }
    }

    /// Forgets a path of the machine's own that stands in the channel.
    pub(super) fn drop_path(&mut self) {
        if self.desk.own_path {
            self.channel.drop_path();
            self.desk.own.clear();
            self.desk.own_path = false;
            if self.desk.power.on_contour() {
                self.desk.power.phase = Phase::Rest;
            }
            if !matches!(self.desk.mode, Mode::Linked) {
                let _ = self.channel.set_drive(Drive::Time);
            }
        }
    }

    /// Brakes and forgets.
    fn reset(&mut self) {
        self.channel.reset();
        self.forget();
        self.stand_down();
        self.outputs.spindle = false;
    }

    /// Ends what the operator's side was doing.
    pub(super) fn stand_down(&mut self) {
        for axis in AXES {
            self.channel.stop_hand(axis);
        }
        self.channel.pull(None);
        self.desk.power.cancel(self.desk.inputs.joystick);
        self.desk.lever = Lever::Out;
        self.desk.homing = homing::Phase::Rest;
        self.desk.starting = false;
        if matches!(self.desk.nulling, Nulling::Waits) {
            self.desk.nulling = Nulling::No;
        }
    }

    /// Machine lock: while it is on only the display moves; then it goes back to where the axes are.
    fn lock(&mut self, on: bool) {
        if on {
            self.lock_up();
        } else if let Some(locked) = self.desk.locked.take() {
            self.drop_path();
            self.channel.set_position(locked.position);
            self.channel.set_offset(locked.offset);
            self.channel.mute(false);
            for axis in AXES {
                self.recount(axis, part(locked.recounted, axis).wrapping_neg());
            }
            let desk = &mut self.desk;
            desk.power.came = locked.came;
            (desk.kept, desk.wear, desk.datum) = (locked.kept, locked.wear, locked.datum);
            // what was lost meanwhile is lost; what was found was not the axes' place
            desk.verified.x &= locked.verified.x;
            desk.verified.z &= locked.verified.z;
        }
    }

    /// Notes where the axes stand and makes no pulses from now on; once only: what is noted is needed for the way back.
    fn lock_up(&mut self) {
        if self.desk.locked.is_none() && self.channel.mute(true) {
            let (position, offset) = (self.channel.position(), self.channel.offset());
            let desk = &mut self.desk;
            let (kept, wear, datum, verified) = (desk.kept, desk.wear, desk.datum, desk.verified);
            let (came, recounted) = (desk.power.came, Lattice::default());
            desk.locked = Some(Locked { position, offset, kept, wear, datum, verified, came, recounted });
        }
    }

    fn set_stop(&mut self, axis: Axis, stop: Stop) -> Result<(), Refusal> {
        let pulse = self.desk.pulse(axis);
        *self.desk.power.stops.of_mut(axis) = match stop {
            Stop::Off => None,
            Stop::Here => Some(part(self.channel.position(), axis)),
            Stop::At(at) => Some(pulse.nearest(at)),
        };
        self.move_shoulders();
        Ok(())
    }

    /// Rapid back to where the last power feed began, along what it went along.
    fn go_back(&mut self) -> Result<(), Refusal> {
        if self.desk.way_began().is_some() {
            self.lead_back();
            return Ok(());
        }
        let Some(began) = self.desk.power.began else { return Err(Refusal::NothingToReturnFrom) };
        self.drop_path();
        self.begin_return(began);
        Ok(())
    }

    /// The axis is at a coordinate; it counts as touched off.
    fn set_place(&mut self, axis: Axis, at: Length) {
        let pulse = self.desk.pulse(axis);
        self.drop_path();
        let mut position = self.channel.position();
        let place = part_mut(&mut position, axis);
        // what is shown is the place of the tool, offset and all
        let shown = part(self.desk.physical(self.channel.position(), self.channel.offset()), axis);
        let by = pulse.nearest(at).wrapping_sub(shown);
        *place = place.wrapping_add(by);
        if self.channel.set_position(position) {
            self.recount(axis, by);
            let datum = part_mut(&mut self.desk.datum, axis);
            *datum = datum.wrapping_sub(by);
            *self.desk.verified.of_mut(axis) = true;
            self.desk.closed_loop.forget(axis);
        }
    }

    /// The offset becomes something else's.
    fn take_offset(&mut self) -> Lattice {
        let offset = self.channel.offset();
        self.channel.set_offset(Lattice::default());
        offset
    }

    /// Whether an axis has moved in the last tick, or its hand has, or its motor goes on to compensate.
    fn moved(&self, axis: Axis) -> bool {
        part(self.place(), axis) != part(self.seen.before, axis)
            || self.channel.hand_advance(axis) != 0
            || self.channel.is_compensating(axis)
    }

    /// After an alarm nobody may know where the axes are.
    pub(super) fn lose_place(&mut self, alarm: Alarm) {
        // a tick is planned that is not played: an axis that moved at all is not where the plan has it
        let lost = AXES.map(|axis| !alarm.brakes() && self.moved(axis) || alarm.loses_pulses());
        for (axis, lost) in AXES.into_iter().zip(lost) {
            *self.desk.verified.of_mut(axis) &= !lost;
        }
        self.set_limits();
        if self.situation().in_cycle() {
            self.desk.interrupted = self.channel.line();
        }
    }
}

const fn add(to: &mut Lattice, more: Lattice) {
    to.x = to.x.wrapping_add(more.x);
    to.z = to.z.wrapping_add(more.z);
}
