//! Nothing moves where nothing may: after braking under an alarm, at once with motors off and after an emergency stop, held,
//! stopped, ended or idle with nobody turning. And an alarm has a cause.

use handcnc::foreground::alarm::Alarm;
use handcnc::foreground::inputs::AXES;
use handcnc::foreground::mode::Mode;
use interp_core::channel::State;
use interp_core::config::Machine;
use interp_core::drive::ThreadStage;
use interp_core::units::{Axis, Lattice};

use super::{Failure, IN_FLIGHT, Oracle, Tick};

impl Oracle {
    /// Nothing moves where nothing may.
    pub(super) fn rest(&self, tick: &Tick<'_>, (before, at): (Lattice, Lattice)) -> Result<(), (&'static str, String)> {
        let shown = tick.shown;
        let path = shown.programmed != self.programmed;
        if at == before && !path {
            return Ok(());
        }
        let since = |from: u64| tick.tick.saturating_sub(from);
        let by = || format!("X by {} and Z by {} pulses", at.x - before.x, at.z - before.z);
        if self.locked && at != before {
            return Err(("rest", format!("machine lock is on, and the pins moved {}", by())));
        }
        // an emergency stop ends the planning at once; of what was planned before, the shaper may have had no room in its tick
        let flown = (at.x - before.x).abs() <= IN_FLIGHT && (at.z - before.z).abs() <= IN_FLIGHT;
        let cut_off = matches!(self.alarm, (Some(Alarm::Emergency), raised) if since(raised) == 0) && flown && !path;
        if !shown.outputs.motors && at != before && !cut_off {
            return Err(("rest", format!("the motors are off, and the pins moved {}", by())));
        }
        let (alarm, raised) = self.alarm;
        match alarm {
            // the tick in which it is raised was asked for before
            Some(Alarm::Emergency) if since(raised) > 0 && at != before => {
                return Err(("rest", format!("emergency stop, and the pins moved {}", by())));
            }
            Some(alarm) if since(raised) > self.calm && self.stage == ThreadStage::None && at != before => {
                return Err(("rest", format!("{alarm}, {} ticks ago, and the pins moved {}", since(raised), by())));
            }
            _ => {}
        }
        let quiet = since(self.stirred.max(self.state.1)) > self.calm;
        let stands = match shown.state {
            State::Idle | State::Ended | State::Holding | State::Stopped => true,
            // driven by hands only
            State::Running => matches!(shown.mode, Mode::Linked | Mode::Retrace),
            State::Filling | State::Resetting => false,
        };
        // its last pulse may have had no room in its tick, or be owed
        let threads = since(self.threaded) < super::STANDS.into();
        if quiet && stands && !threads && at != before {
            return Err(("rest", format!("nobody asked for it ({:?}), and the pins moved {}", shown.state, by())));
        }
        let guarded = matches!(shown.mode, Mode::Automatic | Mode::ManualData | Mode::Linked | Mode::Retrace);
        if path && guarded && self.guard.0 && since(self.guard.1) > self.calm && !threads {
            return Err((
                "rest",
                format!("the guard has been open for {} ticks, and the program moves", since(self.guard.1)),
            ));
        }
        Ok(())
    }

    /// An alarm has a cause.
    pub(in crate::operate::soak) fn cause(&self, alarm: Alarm, tick: &Tick<'_>) -> Result<(), Failure> {
        let ends = |axis: Axis| {
            let ends = tick.inputs.ends.of(axis);
            ends.plus || ends.minus
        };
        let caused = match alarm {
            Alarm::Emergency => tick.pressed,
            Alarm::LimitSwitchX => ends(Axis::X),
            Alarm::LimitSwitchZ => ends(Axis::Z),
            Alarm::Homing => tick.shown.mode == Mode::Homing,
            // no board counts them here, and no scale is there
            Alarm::Underrun | Alarm::Overrun | Alarm::Late | Alarm::Watchdog | Alarm::PowerReturned => false,
            Alarm::FollowingX | Alarm::FollowingZ => false,
            Alarm::SpindleStopped
            | Alarm::SpindleReversed
            | Alarm::IndexLost
            | Alarm::EncoderNoise
            | Alarm::NoSpindle
            | Alarm::SpindleTooFast
            | Alarm::SpindleTooRough
            | Alarm::NoWayBack => self.spindle_asked,
        };
        let text = format!("{alarm}: without a cause");
        if caused { Ok(()) } else { Err(Failure { tick: tick.tick, rule: "cause".into(), text }) }
    }
}

/// Ticks in which anything that moves comes to rest: each axis brakes from its largest speed with what a hand has of its
/// acceleration, an S law runs on by its window; twice that, and half a second.
pub(super) fn calm(machine: &Machine) -> u64 {
    let of = |axis: Axis| {
        let limits = if axis == Axis::X { &machine.x } else { &machine.z };
        let share = limits.by_hand.min(limits.accel).max(1);
        u64::from(limits.speed / share)
    };
    let slowest = AXES.into_iter().map(of).max().unwrap_or(0);
    2 * (slowest + u64::from(machine.smoothing.ticks()) + 64) + 500
}
