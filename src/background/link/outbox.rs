//! Commands on their way to the foreground, and whether they have arrived.

use interp_core::config::Machine;

use crate::foreground::Command;
use crate::foreground::settings::Settings;
use crate::queue::Producer;

/// Whether the foreground has obeyed what was asked of it.
///
/// A snapshot may be older than the queue looks, by less than a tick; one that is taken after the queue was seen empty
/// is not.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) enum Settling {
    /// Commands are under way.
    Sent,
    /// The queue was seen empty.
    Taken,
    /// Snapshots show what the commands led to.
    Settled,
}

/// What the program is to do.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) enum Flow {
    Hold,
    Start,
}

/// Commands that found the queue full, or were not sent yet. The later of two wishes counts.
#[derive(Clone, Debug, Default)]
pub(super) struct Outbox {
    pub(super) reset: bool,
    pub(super) machine: Option<Machine>,
    pub(super) settings: Option<Settings>,
    /// Leave the alarm.
    pub(super) unlock: bool,
    /// The position is right: who unlocks says so.
    pub(super) confirm: bool,
    pub(super) percent: Option<u16>,
    pub(super) optional_stop: Option<bool>,
    /// Hold or start.
    pub(super) flow: Option<Flow>,
    /// What the operator asks for.
    pub(super) request: Option<Command>,
}

impl Outbox {
    /// Sends what there is, and as much as fits: a reset first, a request last. True if anything was sent or is left.
    pub(super) fn send(&mut self, commands: &mut Producer<'_, Command>) -> bool {
        let mut any = false;
        while let Some(command) = self.first() {
            any = true;
            if commands.enqueue(command).is_err() {
                break;
            }
            match command {
                Command::Reset => self.reset = false,
                Command::Configure(_) => self.machine = None,
                Command::Settle(_) => self.settings = None,
                Command::FeedOverride(_) => self.percent = None,
                Command::Unlock => (self.unlock, self.confirm) = (false, true),
                Command::ConfirmPosition => self.confirm = false,
                Command::OptionalStop(_) => self.optional_stop = None,
                Command::Start | Command::Hold => self.flow = None,
                _ => self.request = None,
            }
        }
        any
    }

    /// What is to be sent first.
    fn first(&self) -> Option<Command> {
        // one after the other: a machine is large, and this is asked in every tick
        if self.reset {
            return Some(Command::Reset);
        }
        if let Some(machine) = self.machine {
            return Some(Command::Configure(machine));
        }
        if let Some(settings) = self.settings {
            return Some(Command::Settle(settings));
        }
        if self.unlock {
            return Some(Command::Unlock);
        }
        if self.confirm {
            return Some(Command::ConfirmPosition);
        }
        if let Some(percent) = self.percent {
            return Some(Command::FeedOverride(percent));
        }
        if let Some(on) = self.optional_stop {
            return Some(Command::OptionalStop(on));
        }
        match self.flow {
            Some(Flow::Hold) => Some(Command::Hold),
            Some(Flow::Start) => Some(Command::Start),
            None => self.request,
        }
    }
}
