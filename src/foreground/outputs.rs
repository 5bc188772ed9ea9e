//! Outputs besides the steps: motor drivers and spindle.

use super::alarm::Alarm;
use interp_core::block::Output;

/// What the board's outputs are to be.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Outputs {
    /// Motor drivers are on.
    pub motors: bool,
    /// The spindle turns forward. A board has one pin for it and none for the sense, so a reverse leaves it off.
    pub spindle: bool,
}

impl Outputs {
    /// At power-on: motors hold, the spindle stands.
    pub(super) const REST: Self = Self { motors: true, spindle: false };

    /// After a tick in which the program set `output`: the end of a program (that `ends`) and an alarm switch the spindle off,
    /// an emergency stop the motors, too.
    pub(super) const fn follow(&mut self, output: Option<Output>, ends: bool, alarm: Option<Alarm>, motors: bool) {
        match output {
            Some(Output::SpindleForward) => self.spindle = true,
            Some(Output::SpindleReverse | Output::SpindleStop) => self.spindle = false,
            Some(Output::SpindleSpeed(_) | Output::Tool(..)) | None => {}
        }
        self.spindle &= !ends && alarm.is_none();
        self.motors = motors && !matches!(alarm, Some(Alarm::Emergency));
    }
}
