//! What the background, a key or the link asks of the foreground.

use super::contour::Contour;
use super::mode::Mode;
use super::settings::Settings;
pub use super::threads::PickUpStep;
use interp_core::block::Feed;
use interp_core::config::Machine;
use interp_core::drive::wheel::Click;
use interp_core::units::{Axis, Length};

/// Where a shoulder stop is set.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Stop {
    /// At a coordinate.
    At(Length),
    /// Where the axis is.
    Here,
    /// Nowhere.
    Off,
}

/// A request.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Command {
    /// Change the mode.
    Mode(Mode),
    /// Cycle start; goes on after a hold or a programmed stop.
    Start,
    /// Feed hold.
    Hold,
    /// Brake, then forget all blocks, those in the queue included. The spindle stops at once.
    Reset,
    /// Leave an alarm: the operator has seen to it.
    Unlock,
    /// Feed override, percent, 0 to 200.
    FeedOverride(u16),
    /// Rapid override, percent, 0 to 100.
    RapidOverride(u16),
    /// Spindle override, percent, 0 to 200.
    SpindleOverride(u16),
    /// Optional stops stop.
    OptionalStop(bool),
    /// Each line waits for cycle start.
    SingleBlock(bool),
    /// Feeds are run at the dry-run feed, the spindle stands.
    DryRun(bool),
    /// Nothing moves; the display does.
    MachineLock(bool),
    /// Other figures of the machine.
    Configure(Machine),
    /// Other figures of its operation.
    Settle(Settings),
    /// What a detent of the handwheels is worth; `None` for as much as it is turned fast.
    Scale(Option<Click>),
    /// Feed of power feed.
    FeedRate(Feed),
    /// Shoulder stop of an axis.
    StopAt(Axis, Stop),
    /// The contour that power and linked feed follow, from where the tool then stands.
    Contour(Contour),
    /// Back to where the last power feed began, at rapid.
    Return,
    /// Power feed to the stop and back so many times, with the joystick's next push.
    Repeat(u16),
    /// Find home.
    Home(Axis),
    /// The axis is at this coordinate: touch-off, or a display set to a number.
    Zero(Axis, Length),
    /// The tool is where the display says.
    ConfirmPosition,
    /// Motors' drivers.
    Motors(bool),
    /// The intervention's offset stays: it is the program's place from now on.
    KeepOffset,
    /// The offset goes back to zero, at a safe speed.
    NullOffset,
    /// The offset is the tool's wear.
    BookWear,
    /// Spindle speed, thousandths of a turn a minute; negative for reverse.
    Spindle(i32),
    /// Go back into what was interrupted.
    Resume,
    /// Engage or disengage the threading lever.
    Lever(bool),
    /// Pick up a thread that is there.
    PickUp(PickUpStep),
}
