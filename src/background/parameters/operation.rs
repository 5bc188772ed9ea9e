//! The parameters of operation: limits, bounds, homing, safe speeds.

use interp_core::config::{Machine, speed_of};
use interp_core::threading::Threading;
use interp_core::units::{Axis, Feedrate, Length, PulseSize};

use super::definitions::index;
use super::{Parameters, Value};
use crate::foreground::inputs::PerAxis;
use crate::foreground::settings::{AxisSettings, Fitted, Settings};

impl Parameters {
    /// How the machine is operated.
    pub fn operation(&self, machine: &Machine) -> Settings {
        let axis = |axis: Axis, pulse: PulseSize| {
            let first = match axis {
                Axis::X => index::OPERATION,
                Axis::Z => index::OPERATION.wrapping_add(index::AXIS_OPERATION),
            };
            let at = |offset: usize| first.wrapping_add(offset);
            let pulses = |offset: usize| self.pulses(at(offset), pulse);
            let toward = self.values.get(at(index::HOME_TOWARD));
            AxisSettings {
                limits: (pulses(index::LIMIT_MINUS), pulses(index::LIMIT_PLUS)),
                bounds: (pulses(index::HAND_MINUS).wrapping_neg(), pulses(index::HAND_PLUS)),
                home_plus: !matches!(toward, Some(Value::Choice(1))),
                home_speed: speed_of(self.feed(at(index::HOME_FEED))),
                home: pulses(index::HOME),
                // nm
                following: i32::try_from(self.number(at(index::FOLLOWING))).unwrap_or(0),
            }
        };
        Settings {
            axes: PerAxis { x: axis(Axis::X, machine.x.pulse), z: axis(Axis::Z, machine.z.pulse) },
            wheels: self.switch(index::HANDWHEELS),
            safe: speed_of(self.feed(index::SAFE_FEED)),
            dry: speed_of(self.feed(index::DRY_FEED)),
            power: speed_of(self.feed(index::POWER_FEED)),
            fitted: Fitted { guard: self.switch(index::GUARD_SWITCH), ends: self.switch(index::LIMIT_SWITCHES) },
        }
    }

    /// What the machine does about threads.
    pub fn threading(&self) -> Threading {
        let retract = Length::from_nm(self.number(index::THREAD_RETRACT)).unwrap_or_default();
        Threading { encoder: self.small(index::ENCODER_COUNTS), retract, guarded: true }
    }

    /// A length in nm as pulses, to the nearest.
    fn pulses(&self, at: usize, pulse: PulseSize) -> i32 {
        Length::from_nm(self.number(at)).map_or(0, |length| pulse.nearest(length))
    }

    fn feed(&self, at: usize) -> Feedrate {
        let nm = u64::try_from(self.number(at)).unwrap_or(0);
        Feedrate::from_nm_per_min(nm).unwrap_or(Feedrate::SLOWEST)
    }
}
