//! What an operator does at given ticks of a cycle, for runs that have to be repeated exactly.
//!
//! An operator presses a key or turns a wheel at some instant; a test needs the same instant on the desktop and on the chip.
//! A rehearsal gives each of its acts right before the tick that it is set for, counted from the first tick of the
//! cycle (which is number 0). Only ticks that belong to a cycle count: those in which blocks are executed, held or
//! stopped, not those in which the look-ahead fills. A programmed stop is passed by at once.
//!
//! An act is written as `TICK:WHAT`: `hold`, `start`, `reset`, `override=PERCENT`, `rapid=PERCENT`, `null-offset`, or
//! `wheel-x=COUNTS`, `wheel-z=COUNTS`, `wheel-contour=COUNTS`, each with `*TICKS` behind it for as many ticks in a row.
//! `spindle=COUNTS*TICKS` turns the spindle by so many counts a tick; its index comes every 4096 counts.

use super::Command;
use super::inputs::Inputs;
use heapless::Vec;
use interp_core::channel::State;
use interp_core::drive::spindle::Reading;

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
    /// What the spindle's encoder says.
    Spindle(Reading),
}

impl Act {
    /// Adds a turn of the wheels to readings, or is the spindle's.
    pub const fn read(self, inputs: &mut Inputs) {
        match self {
            Self::Command(_) => {}
            Self::Wheels(x, z, contour) => {
                inputs.wheels.x = inputs.wheels.x.saturating_add(x);
                inputs.wheels.z = inputs.wheels.z.saturating_add(z);
                inputs.contour = inputs.contour.saturating_add(contour);
            }
            Self::Spindle(reading) => inputs.spindle = Some(reading),
        }
    }
}

/// What stands in a rehearsal for a tick.
#[expect(clippy::large_enum_variant, reason = "as an act")]
#[derive(Copy, Clone, Debug)]
enum Cue {
    Act(Act),
    /// The spindle turns by so many counts.
    Turn(i16),
}

impl Cue {
    /// A cue as it is written, and for how many ticks; `None` for anything else.
    fn parse(what: &str) -> Option<(Self, u32)> {
        let Some((name, value)) = what.split_once('=') else {
            let command = match what {
                "hold" => Command::Hold,
                "start" => Command::Start,
                "reset" => Command::Reset,
                "null-offset" => Command::NullOffset,
                _ => return None,
            };
            return Some((Self::Act(Act::Command(command)), 1));
        };
        match name {
            "override" => return Some((Self::Act(Act::Command(Command::FeedOverride(value.parse().ok()?))), 1)),
            "rapid" => return Some((Self::Act(Act::Command(Command::RapidOverride(value.parse().ok()?))), 1)),
            _ => {}
        }
        let (counts, ticks) = match value.split_once('*') {
            Some((counts, ticks)) => (counts, ticks.parse().ok()?),
            None => (value, 1),
        };
        let counts = counts.parse().ok()?;
        let cue = match name {
            "wheel-x" => Self::Act(Act::Wheels(counts, 0, 0)),
            "wheel-z" => Self::Act(Act::Wheels(0, counts, 0)),
            "wheel-contour" => Self::Act(Act::Wheels(0, 0, counts)),
            "spindle" => Self::Turn(counts),
            _ => return None,
        };
        Some((cue, ticks))
    }
}

/// Counts of a turn of the spindle's encoder.
const SPINDLE_COUNTS: i64 = 4096;

/// A cue with its first tick and how many ticks it lasts.
#[derive(Copy, Clone, Debug)]
struct Appointment {
    from: u32,
    ticks: u32,
    cue: Cue,
}

/// Acts waiting for their ticks.
#[derive(Clone, Debug, Default)]
pub struct Rehearsal {
    appointments: Vec<Appointment, APPOINTMENTS>,
    tick: u32,
    /// Counts that the spindle has turned by.
    turned: i64,
}

impl Rehearsal {
    /// No act.
    pub const fn new() -> Self {
        Self { appointments: Vec::new(), tick: 0, turned: 0 }
    }

    /// Sets an act as it is written, `TICK:WHAT`. False where it is none, or there is no place for it.
    pub fn set_word(&mut self, word: &str) -> bool {
        let Some((tick, what)) = word.split_once(':') else { return false };
        match (tick.parse(), Cue::parse(what)) {
            (Ok(from), Some((cue, ticks))) => self.appointments.push(Appointment { from, ticks, cue }).is_ok(),
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
            if since.is_none_or(|since| since >= appointment.ticks) {
                continue;
            }
            match appointment.cue {
                Cue::Act(what) => act(what),
                Cue::Turn(counts) => {
                    let before = self.turned;
                    self.turned = before.wrapping_add(i64::from(counts));
                    act(Act::Spindle(reading(before, self.turned)));
                }
            }
        }
        self.tick = self.tick.saturating_add(1);
    }
}

/// What the encoder says behind a turn from one count to another, less than a whole one. The index comes where a turn
/// is complete, going forward, and at the same place going back.
fn reading(from: i64, to: i64) -> Reading {
    let low = |counts: i64| u16::try_from(counts & 0xFFFF).unwrap_or(0);
    // 4096 divides the counter's 65 536
    let (before, after) = (from.wrapping_shr(12), to.wrapping_shr(12));
    let index = (before != after).then(|| low(before.max(after).wrapping_mul(SPINDLE_COUNTS)));
    Reading { counts: low(to), index }
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
    fn the_spindle_turns_with_an_index_a_turn() {
        let mut rehearsal = Rehearsal::new();
        assert!(rehearsal.set_word("0:spindle=3000*3") && rehearsal.set_word("3:spindle=-2000*4"));
        let mut seen = Vec::<(u16, Option<u16>), 8>::new();
        for _ in 0..7 {
            rehearsal.due(State::Running, &mut |act| {
                let Act::Spindle(Reading { counts, index }) = act else { panic!("{act:?}") };
                seen.push((counts, index)).unwrap();
            });
        }
        let turns = [
            (3000, None),
            (6000, Some(4096)),
            (9000, Some(8192)),
            (7000, Some(8192)),
            (5000, None),
            (3000, Some(4096)),
            (1000, None),
        ];
        assert_eq!(seen.as_slice(), turns);
    }

    #[test]
    fn what_is_no_act_is_refused() {
        for word in ["", "5", "5:jump", "x:hold", "5:override=x", "5:wheel-y=3", "5:wheel-x=3*x", "-1:hold"] {
            assert!(!Rehearsal::new().set_word(word), "{word}");
        }
    }
}
