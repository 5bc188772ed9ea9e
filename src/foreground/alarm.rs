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
use interp_core::drive::Trouble;
use interp_core::units::Axis;

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
    /// A limit switch of the cross slide was run into.
    LimitSwitchX,
    /// A limit switch of the carriage.
    LimitSwitchZ,
    /// A home switch was not found, or did not open.
    Homing,
    /// The slide is not where the cross slide's motor should have led it.
    FollowingX,
    /// Of the carriage.
    FollowingZ,
    /// The power was gone: what the slides did meanwhile is not known.
    PowerReturned,
    /// The spindle stopped in a thread.
    SpindleStopped,
    /// The spindle turned round in a thread.
    SpindleReversed,
    /// The spindle's index did not come in one and a half turns.
    IndexLost,
    /// The index came at another count: counts of the encoder were lost, or there is noise.
    EncoderNoise,
    /// A thread or a feed a turn waited for a spindle that does not turn.
    NoSpindle,
    /// Lead times spindle speed is more than an axis makes.
    SpindleTooFast,
    /// The spindle's speed changed faster than an axis can follow.
    SpindleTooRough,
    /// A pass of too many blocks was left and can't be repeated.
    NoWayBack,
}

impl Alarm {
    /// All alarms.
    pub const ALL: [Self; 19] = [
        Self::Emergency,
        Self::Underrun,
        Self::Overrun,
        Self::Late,
        Self::Watchdog,
        Self::LimitSwitchX,
        Self::LimitSwitchZ,
        Self::Homing,
        Self::FollowingX,
        Self::FollowingZ,
        Self::PowerReturned,
        Self::SpindleStopped,
        Self::SpindleReversed,
        Self::IndexLost,
        Self::EncoderNoise,
        Self::NoSpindle,
        Self::SpindleTooFast,
        Self::SpindleTooRough,
        Self::NoWayBack,
    ];

    /// The alarm of an axis that has run into a limit switch.
    pub const fn limit_switch(axis: Axis) -> Self {
        match axis {
            Axis::X => Self::LimitSwitchX,
            Axis::Z => Self::LimitSwitchZ,
        }
    }

    /// The alarm of an axis that does not follow.
    pub const fn following(axis: Axis) -> Self {
        match axis {
            Axis::X => Self::FollowingX,
            Axis::Z => Self::FollowingZ,
        }
    }

    /// Whether what moves is braked, and not stopped at once.
    pub(super) const fn brakes(self) -> bool {
        !matches!(self, Self::Emergency)
    }

    /// Whether pulses may have been lost for certain, whatever the speed was.
    pub(super) const fn loses_pulses(self) -> bool {
        match self {
            Self::Emergency | Self::LimitSwitchX | Self::LimitSwitchZ | Self::Homing => false,
            Self::SpindleStopped
            | Self::SpindleReversed
            | Self::IndexLost
            | Self::EncoderNoise
            | Self::NoSpindle
            | Self::SpindleTooFast
            | Self::SpindleTooRough
            | Self::NoWayBack => false,
            Self::Underrun
            | Self::Overrun
            | Self::Late
            | Self::Watchdog
            | Self::FollowingX
            | Self::FollowingZ
            | Self::PowerReturned => true,
        }
    }

    /// The number behind `ALARM:`. 10 is grblHAL's; those from 200 on are this project's.
    pub const fn number(self) -> u8 {
        match self {
            Self::Emergency => 10,
            Self::Underrun => 200,
            Self::Overrun => 201,
            Self::Late => 202,
            Self::Watchdog => 203,
            Self::LimitSwitchX => 204,
            Self::LimitSwitchZ => 205,
            Self::Homing => 206,
            Self::FollowingX => 207,
            Self::FollowingZ => 208,
            Self::PowerReturned => 209,
            Self::SpindleStopped => 210,
            Self::SpindleReversed => 211,
            Self::IndexLost => 212,
            Self::EncoderNoise => 213,
            Self::NoSpindle => 214,
            Self::SpindleTooFast => 215,
            Self::SpindleTooRough => 216,
            Self::NoWayBack => 217,
        }
    }

    /// The alarm of what the spindle did to a thread.
    pub const fn of_trouble(trouble: Trouble) -> Self {
        match trouble {
            Trouble::Stopped => Self::SpindleStopped,
            Trouble::Reversed => Self::SpindleReversed,
            Trouble::IndexLost => Self::IndexLost,
            Trouble::Index { .. } => Self::EncoderNoise,
            Trouble::NoSpindle => Self::NoSpindle,
            Trouble::TooFast { .. } => Self::SpindleTooFast,
            Trouble::TooHard { .. } => Self::SpindleTooRough,
            Trouble::NoWayBack => Self::NoWayBack,
        }
    }

    /// Whether no pulse was lost: the position is as true as before.
    pub const fn keeps_position(self) -> bool {
        self.number() >= 210
    }

    /// The alarm of a number; `None` of any other number.
    pub fn of(number: u32) -> Option<Self> {
        // the usual case, asked in every tick
        if number == 0 {
            return None;
        }
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
            Self::LimitSwitchX => "a limit switch of X was met",
            Self::LimitSwitchZ => "a limit switch of Z was met",
            Self::Homing => "the home switch was not found",
            Self::FollowingX => "X is not where it should be",
            Self::FollowingZ => "Z is not where it should be",
            Self::PowerReturned => "the power was gone",
            Self::SpindleStopped => "the spindle stopped in a thread",
            Self::SpindleReversed => "the spindle turned round in a thread",
            Self::IndexLost => "the spindle turns without an index pulse",
            Self::EncoderNoise => "the spindle's index came at another count",
            Self::NoSpindle => "the spindle does not turn",
            Self::SpindleTooFast => "the spindle is too fast for the lead",
            Self::SpindleTooRough => "the spindle's speed changed too fast for the lead",
            Self::NoWayBack => "the thread can't be repeated: its pass has too many blocks",
        })
    }
}
