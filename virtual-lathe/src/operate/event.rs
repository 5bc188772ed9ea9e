//! Events of a scenario: what the operator, the machine's switches or the mains do at a time.

use std::path::PathBuf;

use handcnc::foreground::Command;
use handcnc::foreground::command::PickUpStep;
use handcnc::foreground::inputs::Joystick;
use interp_core::units::Axis;

use super::expect::Expect;

/// An event.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Ticks from the start.
    pub tick: u64,
    /// Line of the script, from 1.
    pub line: u32,
    /// The line, for messages.
    pub text: String,
    /// What happens.
    pub what: What,
}

/// One of the three wheels.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Wheel {
    /// That of the cross slide.
    X,
    /// That of the carriage.
    Z,
    /// The contour wheel.
    Contour,
}

impl Wheel {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::X, Self::Z, Self::Contour];
}

/// Where noise comes in.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// At a wheel's channels.
    Wheel(Wheel),
    /// At those of the spindle's encoder.
    Spindle,
}

/// A limit switch, as a script has it.
#[derive(Copy, Clone, Debug, PartialEq)]
pub enum Switch {
    /// Met or not, whatever the slide does.
    Held(bool),
    /// Met where the slide is at this place or beyond it, mm.
    At(f64),
}

/// What happens.
#[derive(Clone, Debug, PartialEq)]
pub enum What {
    /// A request that the foreground gets as it is.
    Command(Command),
    /// A program is loaded.
    Load(PathBuf),
    /// Cycle start.
    Start,
    /// A line to be run at once.
    ManualData(String),
    /// Lines that begin with / are skipped, or not.
    BlockSkip(bool),
    /// A wheel is turned by so many detents, over so many ns.
    Turn(Wheel, i32, u64),
    /// The joystick is latched or let go.
    Joystick(Joystick),
    /// The rapid button.
    Rapid(bool),
    /// A parameter is set.
    Set(String, String),
    /// The spindle's speed wavers: percent and Hz.
    Wobble(f64, f64),
    /// The threading lever.
    Lever(bool),
    /// Picking up a thread.
    PickUp(PickUpStep),
    /// The emergency stop is pressed.
    EmergencyStop,
    /// It is pulled out, and the machine unlocked.
    Release,
    /// The mains fail.
    PowerFail,
    /// They are back.
    PowerOn,
    /// Re-entry into what was interrupted.
    Resume,
    /// A limit switch at the plus or minus end of an axis.
    Limit(Axis, bool, Switch),
    /// The guard is open.
    Guard(bool),
    /// So many counts a second too many or too few.
    Noise(Source, f64),
    /// The index pulse does not come.
    LoseIndex(bool),
    /// Something is expected.
    Expect(Expect),
    /// The scenario ends.
    End,
}
