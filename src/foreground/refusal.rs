//! Refusals: why a request was not obeyed. Nothing has changed then.

use super::alarm::Alarm;
use super::mode::Mode;
use core::fmt;
use interp_core::drive::BackEnd;
use interp_core::units::Axis;

/// Why a request was refused.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The machine is locked.
    Alarm(Alarm),
    /// Something moves.
    Moving,
    /// A program is under way.
    CycleUnderWay,
    /// It runs already.
    Running,
    /// Nothing runs that could be held.
    NothingToHold,
    /// There is no alarm to leave.
    NoAlarm,
    /// The emergency input is still open.
    EmergencyOpen,
    /// It belongs to another mode.
    WrongMode(Mode),
    /// The guard is open.
    GuardOpen,
    /// The motors' drivers are off.
    MotorsOff,
    /// Where the tool is, is not known.
    Unverified,
    /// No contour was entered.
    NoContour,
    /// A contour that can't be followed: an arc of no radius, or out of range.
    BadContour,
    /// No program stands that could be run back.
    NothingToRetrace,
    /// No power feed was made that could be returned from.
    NothingToReturnFrom,
    /// No power feed has a stop to repeat to.
    NoStop,
    /// Nothing was kept that could be gone back into.
    NothingToResume,
    /// A thread is being cut.
    InThread,
    /// The axis would leave its limits, to plus or minus.
    Limit(Axis, bool),
    /// The offset would leave its bounds, to plus or minus.
    Bound(Axis, bool),
    /// The last feed was a thread by lever: the tool may stand in the groove.
    InGroove,
    /// The wheel asks for the path to be led farther back than it can be, and why it can't.
    WayBackEnds(BackEnd),
    /// The joystick asks for a path and there is none, or was latched when the mode was entered.
    JoystickLatched,
    /// The handwheels are switched off by a parameter.
    WheelsOff,
    /// The lever has no lead: the feed is not one a turn.
    NoLead,
    /// The spindle's index was not seen.
    NoIndex,
    /// No pick-up was begun, or nothing was captured.
    NothingToPickUp,
}

impl Refusal {
    /// A name of one word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Alarm(_) => "alarm",
            Self::Moving => "moving",
            Self::CycleUnderWay => "cycle-under-way",
            Self::Running => "running",
            Self::NothingToHold => "nothing-to-hold",
            Self::NoAlarm => "no-alarm",
            Self::EmergencyOpen => "emergency-open",
            Self::WrongMode(_) => "wrong-mode",
            Self::GuardOpen => "guard-open",
            Self::MotorsOff => "motors-off",
            Self::Unverified => "unverified",
            Self::NoContour => "no-contour",
            Self::BadContour => "bad-contour",
            Self::NothingToRetrace => "nothing-to-retrace",
            Self::NothingToReturnFrom => "nothing-to-return-from",
            Self::NoStop => "no-stop",
            Self::NothingToResume => "nothing-to-resume",
            Self::InThread => "in-thread",
            Self::Limit(Axis::X, true) => "limit-x+",
            Self::Limit(Axis::X, false) => "limit-x-",
            Self::Limit(Axis::Z, true) => "limit-z+",
            Self::Limit(Axis::Z, false) => "limit-z-",
            Self::Bound(Axis::X, true) => "bound-x+",
            Self::Bound(Axis::X, false) => "bound-x-",
            Self::Bound(Axis::Z, true) => "bound-z+",
            Self::Bound(Axis::Z, false) => "bound-z-",
            Self::InGroove => "in-groove",
            Self::WayBackEnds(BackEnd::Start) => "way-back-start",
            Self::WayBackEnds(BackEnd::Output) => "way-back-output",
            Self::WayBackEnds(BackEnd::Thread) => "way-back-thread",
            Self::WayBackEnds(BackEnd::Dwell) => "way-back-dwell",
            Self::WayBackEnds(BackEnd::Curve) => "way-back-curve",
            Self::WayBackEnds(BackEnd::Full) => "way-back-full",
            Self::JoystickLatched => "joystick-latched",
            Self::WheelsOff => "wheels-off",
            Self::NoLead => "no-lead",
            Self::NoIndex => "no-index",
            Self::NothingToPickUp => "nothing-to-pick-up",
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Alarm(alarm) => write!(f, "the machine is locked ({alarm}): release it first"),
            Self::Moving => f.write_str("something moves: wait until all stands, or hold"),
            Self::CycleUnderWay => f.write_str("a program is under way: let it end, or reset"),
            Self::Running => f.write_str("it runs already"),
            Self::NothingToHold => f.write_str("nothing runs that could be held"),
            Self::NoAlarm => f.write_str("there is no alarm"),
            Self::EmergencyOpen => f.write_str("the emergency stop is still pressed: pull it out first"),
            Self::WrongMode(mode) => write!(f, "that belongs to the mode {}", mode.name()),
            Self::GuardOpen => f.write_str("the guard is open: close it first"),
            Self::MotorsOff => f.write_str("the motors are off: switch them on first"),
            Self::Unverified => f.write_str("where the tool is, is not known: home, touch off or confirm it first"),
            Self::NoContour => f.write_str("there is no contour: enter a taper or an arc, or load a program"),
            Self::BadContour => f.write_str("the contour can't be followed: its radii differ, or it leaves the range"),
            Self::NothingToRetrace => f.write_str("no program stands that could be run back: hold one first"),
            Self::NothingToReturnFrom => f.write_str("no power feed was made that could be returned from"),
            Self::NoStop => f.write_str("there is no stop to repeat to: set one with stop-at, or enter a contour"),
            Self::NothingToResume => f.write_str("nothing was interrupted that could be resumed"),
            Self::InThread => f.write_str("a thread is being cut: let it end, or reset"),
            Self::Limit(axis, plus) => {
                write!(f, "{} is at its {} limit", axis.letter(), if *plus { "plus" } else { "minus" })
            }
            Self::Bound(axis, plus) => {
                write!(f, "the offset of {} is at its {} bound", axis.letter(), if *plus { "plus" } else { "minus" })
            }
            Self::InGroove => {
                f.write_str("the tool may stand in the groove: pull X out and lead Z back by power or wheel")
            }
            Self::WayBackEnds(end) => end.fmt(f),
            Self::JoystickLatched => f.write_str("the joystick is latched: move it to the middle first"),
            Self::WheelsOff => f.write_str("the handwheels are switched off: set handwheels=true"),
            Self::NoLead => f.write_str("the lever needs a lead: set a feed rate in mm/rev"),
            Self::NoIndex => f.write_str("the spindle's index was not seen: turn it by a whole turn"),
            Self::NothingToPickUp => {
                f.write_str("no thread is being picked up: begin, lead the tool into the groove, capture")
            }
        }
    }
}
