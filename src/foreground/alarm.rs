//! Alarms: latched stops of the machine, each with the number and the name that the link tells.
//!
//! An alarm ends motion, forgets all blocks and switches the spindle off. It stays until the operator unlocks the
//! machine, and as long as it stays nothing starts: the position counts as unverified, since pulses may have been lost,
//! late, or without effect. The first alarm is kept, as it tells the cause; only an emergency stop takes its place.
//!
//! Every alarm but the emergency stop brakes along the path, as a reset does: the train still runs, and a stop from full
//! speed would cost the position for certain. An emergency stop plans no further pulse, and the board lets none out that
//! was planned.

use core::fmt;

/// Counters of what must not happen: one that rises is an alarm.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Faults {
    /// The train was found empty.
    pub underruns: u32,
    /// Events found no place in the train.
    pub overruns: u32,
    /// An event was over before it began.
    pub late: u32,
}

impl Faults {
    /// The alarm of what has risen since `before`.
    pub(super) const fn alarm_since(self, before: Self) -> Option<Alarm> {
        if self.underruns != before.underruns {
            Some(Alarm::Underrun)
        } else if self.overruns != before.overruns {
            Some(Alarm::Overrun)
        } else if self.late != before.late {
            Some(Alarm::Late)
        } else {
            None
        }
    }
}

/// Why the machine is locked.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Alarm {
    /// The emergency input opened.
    Emergency,
    /// The pulse train ran empty: the interpolator was too slow.
    Underrun,
    /// Events found no place in the train: pulses were lost.
    Overrun,
    /// An event was over before it began: pulses came late.
    Late,
    /// The watchdog restarted the chip.
    Watchdog,
}

impl Alarm {
    /// All alarms.
    pub const ALL: [Self; 5] = [Self::Emergency, Self::Underrun, Self::Overrun, Self::Late, Self::Watchdog];

    /// The number behind `ALARM:`. 10 is grblHAL's; those from 200 on are this project's.
    pub const fn number(self) -> u8 {
        match self {
            Self::Emergency => 10,
            Self::Underrun => 200,
            Self::Overrun => 201,
            Self::Late => 202,
            Self::Watchdog => 203,
        }
    }

    /// The alarm of a number; `None` of any other number.
    pub fn of(number: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|alarm| u32::from(alarm.number()) == number)
    }
}

impl fmt::Display for Alarm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Emergency => "emergency stop",
            Self::Underrun => "the pulse train ran empty",
            Self::Overrun => "the pulse train overflowed",
            Self::Late => "a pulse was late",
            Self::Watchdog => "the watchdog restarted the controller",
        })
    }
}
