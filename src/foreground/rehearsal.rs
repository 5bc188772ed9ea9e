//! What an operator does at given ticks of a cycle, for runs that have to be repeated exactly.
//!
//! An operator presses a key or turns a wheel at some instant; a test needs the same instant on the desktop and on the chip.
//! A rehearsal gives each of its acts right before the tick that it is set for, counted from the first tick of the
//! cycle (which is number 0). Only ticks that belong to a cycle count: those in which blocks are executed, held or
//! stopped, not those in which the look-ahead fills. A programmed stop is passed by at once.
//!
//! An act is written as `TICK:WHAT`: `hold`, `start`, `reset`, `override=PERCENT`, `rapid=PERCENT`, `null-offset`, or
//! `wheel-x=COUNTS`, `wheel-z=COUNTS`, `wheel-contour=COUNTS`, each with `*TICKS` behind it for as many ticks in a row.

use super::Command;
use super::inputs::Inputs;
use heapless::Vec;
use interp_core::channel::State;

/// Most acts of a rehearsal.
pub const APPOINTMENTS: usize = 16;

/// What an operator does.
#[expect(clippy::large_enum_variant, reason = "a command may bring a whole machine, and there is no allocation")]
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Act {
    /// Asks for something.
    Command(Command),
    /// Turns wheels: counts of X, of Z and of the contour wheel.
    Wheels(i16, i16, i16),
}

impl Act {
    /// An act as it is written, and for how many ticks; `None` for anything else.
    pub fn parse(what: &str) -> Option<(Self, u32)> {
        let Some((name, value)) = what.split_once('=') else {
            let command = match what {
                "hold" => Command::Hold,
                "start" => Command::Start,
                "reset" => Command::Reset,
                "null-offset" => Command::NullOffset,
                _ => return None,
            };
            return Some((Self::Command(command), 1));
        };
        match name {
            "override" => return Some((Self::Command(Command::FeedOverride(value.parse().ok()?)), 1)),
            "rapid" => return Some((Self::Command(Command::RapidOverride(value.parse().ok()?)), 1)),
            _ => {}
        }
        let (counts, ticks) = match value.split_once('*') {
            Some((counts, ticks)) => (counts, ticks.parse().ok()?),
            None => (value, 1),
        };
        let counts = counts.parse().ok()?;
        let wheels = match name {
            "wheel-x" => Self::Wheels(counts, 0, 0),
            "wheel-z" => Self::Wheels(0, counts, 0),
            "wheel-contour" => Self::Wheels(0, 0, counts),
            _ => return None,
        };
        Some((wheels, ticks))
    }

    /// Adds a turn of the wheels to readings.
    pub const fn turn(self, inputs: &mut Inputs) {
        if let Self::Wheels(x, z, contour) = self {
            inputs.wheels.x = inputs.wheels.x.saturating_add(x);
            inputs.wheels.z = inputs.wheels.z.saturating_add(z);
            inputs.contour = inputs.contour.saturating_add(contour);
        }
    }
}

/// An act with its first tick and how many ticks it lasts.
#[derive(Copy, Clone, Debug)]
struct Appointment {
    from: u32,
    ticks: u32,
    act: Act,
}

/// Acts waiting for their ticks.
#[derive(Clone, Debug, Default)]
pub struct Rehearsal {
    appointments: Vec<Appointment, APPOINTMENTS>,
    tick: u32,
}

impl Rehearsal {
    /// No act.
    pub const fn new() -> Self {
        Self { appointments: Vec::new(), tick: 0 }
    }

    /// Sets `act` for so many ticks from `from` on. False where there is no place for it.
    pub fn set(&mut self, from: u32, act: Act, ticks: u32) -> bool {
        self.appointments.push(Appointment { from, ticks, act }).is_ok()
    }

    /// Sets an act as it is written, `TICK:WHAT`. False where it is none, or there is no place for it.
    pub fn set_word(&mut self, word: &str) -> bool {
        let Some((tick, what)) = word.split_once(':') else { return false };
        match (tick.parse(), Act::parse(what)) {
            (Ok(tick), Some((act, ticks))) => self.set(tick, act, ticks),
            _ => false,
        }
    }

    /// To be called before each tick with the lathe's state: gives the acts that are due.
    pub fn due(&mut self, state: State, act: &mut impl FnMut(Act)) {
        if !matches!(state, State::Running | State::Holding | State::Stopped | State::Resetting) {
            return;
        }
        // programmed stops are passed by: nobody is there to press the key
        if matches!(state, State::Stopped) {
            act(Act::Command(Command::Start));
        }
        for appointment in &self.appointments {
            let since = self.tick.checked_sub(appointment.from);
            if since.is_some_and(|since| since < appointment.ticks) {
                act(appointment.act);
            }
        }
        self.tick = self.tick.saturating_add(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn acts_come_at_their_tick_and_only_ticks_of_a_cycle_count() {
        let mut rehearsal = Rehearsal::new();
        assert!(rehearsal.set_word("0:hold") && rehearsal.set_word("2:start") && rehearsal.set_word("1:wheel-z=-3*2"));
        let mut seen = Vec::<(u32, Act), 8>::new();
        let states = [State::Filling, State::Running, State::Holding, State::Filling, State::Holding, State::Ended];
        for (n, state) in (0..).zip(states) {
            rehearsal.due(state, &mut |act| seen.push((n, act)).unwrap());
        }
        let (hold, start, turn) = (Act::Command(Command::Hold), Act::Command(Command::Start), Act::Wheels(0, -3, 0));
        assert_eq!(seen.as_slice(), [(1, hold), (2, turn), (4, start), (4, turn)]);
    }

    #[test]
    fn what_is_no_act_is_refused() {
        for word in ["", "5", "5:jump", "x:hold", "5:override=x", "5:wheel-y=3", "5:wheel-x=3*x", "-1:hold"] {
            assert!(!Rehearsal::new().set_word(word), "{word}");
        }
    }
}
