//! What became of the last request that somebody waits for, as a number.
//!
//! The foreground makes the number when it decides, so that publishing it in each tick is a single store.

use super::alarm::Alarm;
use super::command::Command;
use super::mode::Mode;
use super::refusal::Refusal;
use interp_core::drive::BackEnd;
use interp_core::units::Axis;

/// The number of a request that was obeyed.
pub(super) const OBEYED: u32 = 0;

/// Behind it the number of an alarm.
const ALARM: u32 = 0x100;

/// Both ways between refusals and their numbers; the compiler finds one that was forgotten.
macro_rules! numbers {
    ($($number:literal { $($refusal:tt)* })*) => {
        /// The number of a refusal.
        pub(super) fn number(refusal: Refusal) -> u32 {
            match refusal {
                Refusal::Alarm(alarm) => ALARM | u32::from(alarm.number()),
                $($($refusal)* => $number,)*
            }
        }

        /// The refusal of a number; `None` for 0, a request that was obeyed.
        pub fn refusal(number: u32) -> Option<Refusal> {
            match number {
                // the usual case
                OBEYED => None,
                $($number => Some($($refusal)*),)*
                _ => Alarm::of(number ^ ALARM).map(Refusal::Alarm),
            }
        }
    };
}

numbers! {
    1 { Refusal::Moving }
    2 { Refusal::CycleUnderWay }
    3 { Refusal::Running }
    4 { Refusal::NothingToHold }
    5 { Refusal::NoAlarm }
    6 { Refusal::EmergencyOpen }
    7 { Refusal::GuardOpen }
    8 { Refusal::MotorsOff }
    9 { Refusal::Unverified }
    10 { Refusal::NoContour }
    11 { Refusal::BadContour }
    12 { Refusal::NothingToRetrace }
    13 { Refusal::NothingToReturnFrom }
    14 { Refusal::NoStop }
    15 { Refusal::NothingToResume }
    16 { Refusal::InThread }
    17 { Refusal::JoystickLatched }
    18 { Refusal::WheelsOff }
    19 { Refusal::NoLead }
    20 { Refusal::NoIndex }
    21 { Refusal::NothingToPickUp }
    22 { Refusal::Limit(Axis::X, true) }
    23 { Refusal::Limit(Axis::X, false) }
    24 { Refusal::Limit(Axis::Z, true) }
    25 { Refusal::Limit(Axis::Z, false) }
    26 { Refusal::WrongMode(Mode::Handwheel) }
    27 { Refusal::WrongMode(Mode::Power) }
    28 { Refusal::WrongMode(Mode::Linked) }
    29 { Refusal::WrongMode(Mode::Automatic) }
    30 { Refusal::WrongMode(Mode::ManualData) }
    31 { Refusal::WrongMode(Mode::Homing) }
    32 { Refusal::WrongMode(Mode::Retrace) }
    33 { Refusal::WayBackEnds(BackEnd::Start) }
    34 { Refusal::WayBackEnds(BackEnd::Output) }
    35 { Refusal::WayBackEnds(BackEnd::Thread) }
    36 { Refusal::WayBackEnds(BackEnd::Dwell) }
    37 { Refusal::WayBackEnds(BackEnd::Curve) }
    38 { Refusal::WayBackEnds(BackEnd::Full) }
    39 { Refusal::InGroove }
    40 { Refusal::Bound(Axis::X, true) }
    41 { Refusal::Bound(Axis::X, false) }
    42 { Refusal::Bound(Axis::Z, true) }
    43 { Refusal::Bound(Axis::Z, false) }
}

/// Whether nobody waits for what becomes of it: a byte or a key that acts at once, while a request may be waited for.
pub(super) const fn is_unasked(command: &Command) -> bool {
    matches!(command, Command::Hold | Command::Start | Command::Reset | Command::FeedOverride(_))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_lead_back_to_their_refusals() {
        assert_eq!(refusal(OBEYED), None);
        let mut known = 0;
        for n in 1..=0x1ff {
            if let Some(refusal) = refusal(n) {
                assert_eq!(number(refusal), n, "{refusal}");
                known += 1;
            }
        }
        let alarms = (0..=0xff).filter(|number| Alarm::of(*number).is_some()).count();
        assert_eq!(known, 43 + alarms);
    }
}
