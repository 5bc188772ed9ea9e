//! Commands at given ticks of a cycle, for runs that have to be repeated exactly.
//!
//! An operator presses a key at some instant; a test needs the same instant on the desktop and on the chip. A
//! rehearsal gives each of its commands right before the tick that it is set for, counted from the first tick of the
//! cycle (which is number 0). Only ticks that belong to a cycle count: those in which blocks are executed, held or
//! stopped, not those in which the look-ahead fills. A programmed stop is passed by at once.

use super::Command;
use heapless::Vec;
use interp_core::channel::State;

/// Most commands of a rehearsal.
pub const APPOINTMENTS: usize = 16;

/// Commands waiting for their ticks.
#[derive(Clone, Debug, Default)]
pub struct Rehearsal {
    appointments: Vec<(u32, Command), APPOINTMENTS>,
    tick: u32,
}

impl Rehearsal {
    /// No command.
    pub const fn new() -> Self {
        Self { appointments: Vec::new(), tick: 0 }
    }

    /// Sets `command` for `tick`. False where there is no place for it.
    pub fn set(&mut self, tick: u32, command: Command) -> bool {
        self.appointments.push((tick, command)).is_ok()
    }

    /// To be called before each tick with the lathe's state: gives the commands that are due.
    pub fn due(&mut self, state: State, obey: &mut impl FnMut(Command)) {
        if !matches!(state, State::Running | State::Holding | State::Stopped | State::Resetting) {
            return;
        }
        // programmed stops are passed by: nobody is there to press the key
        if matches!(state, State::Stopped) {
            obey(Command::Start);
        }
        for (tick, command) in &self.appointments {
            if *tick == self.tick {
                obey(*command);
            }
        }
        self.tick = self.tick.saturating_add(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_come_at_their_tick_and_only_ticks_of_a_cycle_count() {
        let mut rehearsal = Rehearsal::new();
        assert!(rehearsal.set(0, Command::Hold));
        assert!(rehearsal.set(2, Command::Start));
        let mut seen = Vec::<(u32, Command), 8>::new();
        let states = [State::Filling, State::Running, State::Holding, State::Filling, State::Holding, State::Ended];
        for (n, state) in (0..).zip(states) {
            rehearsal.due(state, &mut |command| seen.push((n, command)).unwrap());
        }
        assert_eq!(seen.as_slice(), [(1, Command::Hold), (4, Command::Start)]);
    }
}
