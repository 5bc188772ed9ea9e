//! Threads by hand: the threading lever, and picking up a thread that is there.
//!
//! **The lever** works as half nuts do: in, the carriage follows the spindle with the lead of the feed a turn, in the groove of
//! the pass before, wherever it is engaged; out, the tool is pulled out in step and the carriage brakes. The first engagement
//! makes the groove, at the index; another lead makes another one.
//!
//! **Picking up**: the spindle is turned by hand until the tool fits into the groove; capture notes place and angle; from go on
//! all threads, by lever and in programs, meet that groove.

use super::Foreground;
use super::desk::part_mut;
use super::inputs::Joystick;
use super::power::Phase;
use super::refusal::Refusal;
use interp_core::block::Feed;
use interp_core::channel::groove::Groove;
use interp_core::drive::gearing::Lead;
use interp_core::units::Axis;

/// The threading lever.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) enum Lever {
    /// Disengaged.
    Out,
    /// Engaged.
    In,
}

/// Picking up a thread.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum PickUp {
    /// None is picked up.
    None,
    /// The tool is led into the groove.
    Begun,
    /// Place and angle were noted.
    Captured(Groove),
    /// Threads meet the groove.
    Active,
}

impl PickUp {
    /// Its name, as the display has it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Begun => "begun",
            Self::Captured(_) => "captured",
            Self::Active => "active",
        }
    }
}

/// Steps of picking up a thread.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum PickUpStep {
    /// Forget the groove before; lead the tool into the one that is there.
    Begin,
    /// The tool is in it.
    Capture,
    /// Meet it.
    Go,
}

impl Foreground<'_> {
    /// Engages or disengages the lever.
    pub(super) fn set_lever(&mut self, engage: bool) -> Result<(), Refusal> {
        if !engage {
            if matches!(self.desk.lever, Lever::In) {
                self.desk.lever = Lever::Out;
                self.channel.reset();
                self.desk.own.clear();
                self.desk.power.phase = Phase::Brake;
            }
            return Ok(());
        }
        let Some(Feed::PerTurn(lead)) = self.desk.power.feed else { return Err(Refusal::NoLead) };
        self.engage(lead)
    }

    /// The carriage follows the spindle to the stop, else towards the headstock.
    fn engage(&mut self, lead: Lead) -> Result<(), Refusal> {
        let position = self.channel.position();
        let plus = self.desk.power.stops.z.is_some_and(|stop| stop > position.z);
        let room = self.desk.room(Axis::Z, self.place().z);
        let far = if plus { room.1.min(super::power::FAR) } else { room.0.max(-super::power::FAR) };
        let mut to = position;
        let end = self.desk.power.end(Axis::Z, plus, position.z, position.z.saturating_add(far));
        let end = self.desk.representable(Axis::Z, end);
        *part_mut(&mut to, Axis::Z) = end;
        if end == position.z {
            return Err(Refusal::Limit(Axis::Z, plus));
        }
        self.drop_path();
        if self.desk.thread_lead != Some(lead) && !matches!(self.desk.pick_up, PickUp::Active) {
            self.channel.set_groove(Some(Groove { z: position.z, angle: 0 }));
        }
        self.desk.thread_lead = Some(lead);
        if !self.begin_line(to, Feed::Thread(lead, 0)) {
            return Err(Refusal::Limit(Axis::Z, plus));
        }
        self.desk.lever = Lever::In;
        (self.desk.power.began, self.desk.power.threaded) = (None, true);
        self.desk.power.phase = Phase::Thread;
        Ok(())
    }

    /// A tick of a thread by lever.
    pub(super) fn thread_on(&mut self) {
        if self.desk.own_path {
            return;
        }
        self.desk.lever = Lever::Out;
        self.desk.power.cancel(Joystick::Off);
    }

    /// A step of picking up a thread.
    pub(super) fn pick_up(&mut self, step: PickUpStep) -> Result<(), Refusal> {
        self.desk.pick_up = match (step, self.desk.pick_up) {
            (PickUpStep::Begin, _) => {
                self.channel.set_groove(None);
                self.desk.thread_lead = None;
                PickUp::Begun
            }
            (PickUpStep::Capture, PickUp::None) => return Err(Refusal::NothingToPickUp),
            (PickUpStep::Capture, _) => {
                let Some(angle) = self.channel.spindle_phase() else { return Err(Refusal::NoIndex) };
                let z = self.channel.position().z.wrapping_add(self.channel.offset().z);
                PickUp::Captured(Groove { z, angle })
            }
            (PickUpStep::Go, PickUp::Captured(groove)) => {
                self.channel.set_groove(Some(groove));
                PickUp::Active
            }
            (PickUpStep::Go, PickUp::None | PickUp::Begun | PickUp::Active) => return Err(Refusal::NothingToPickUp),
        };
        Ok(())
    }

    /// The coordinates of Z have changed: a groove is where it was.
    pub(super) fn shift_groove(&mut self, by: i32) {
        let shifted = |groove: Groove| Groove { z: groove.z.wrapping_add(by), ..groove };
        self.channel.set_groove(self.channel.groove().map(shifted));
        if let PickUp::Captured(groove) = &mut self.desk.pick_up {
            *groove = shifted(*groove);
        }
    }

    /// Whether the lever is engaged.
    pub(super) const fn engaged(&self) -> bool {
        matches!(self.desk.lever, Lever::In)
    }
}
