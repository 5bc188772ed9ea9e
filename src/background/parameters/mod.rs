//! Parameters: names, units, ranges, defaults, and the machine and program settings that they make.
//!
//! A value is given as text, as an operator types it, and held exactly: lengths as ratios or whole nanometres, the
//! rest as whole multiples of the unit's last decimal.

mod definitions;
mod operation;
mod value;

use feature_editor::codes::Settings;
use interp_core::compensation::{self, Temperatures};
use interp_core::config::{AxisConfig, Config, ConfigError, Machine};
use interp_core::curve::method::Method;
use interp_core::law::SpeedLaw;
use interp_core::units::{Axis, Feedrate, Length, Point, PulseSize};

use definitions::index;
pub use definitions::{DEFINITIONS, Definition, Kind};
pub use value::{ParameterError, Shown};
use value::{Value, pulse, read};

/// The values of all parameters.
#[derive(Clone, Debug)]
pub struct Parameters {
    values: [Value; index::COUNT],
}

impl Default for Parameters {
    fn default() -> Self {
        Self::new()
    }
}

impl Parameters {
    /// All defaults.
    pub fn new() -> Self {
        let mut values = [Value::Choice(0); index::COUNT];
        for (value, definition) in values.iter_mut().zip(&DEFINITIONS) {
            // a test reads every default
            *value = read(definition, definition.default).unwrap_or(Value::Choice(0));
        }
        Self { values }
    }

    /// Sets a parameter from text.
    ///
    /// # Errors
    /// [`ParameterError`]; the parameter keeps its value.
    pub fn set(&mut self, name: &str, text: &str) -> Result<(), ParameterError> {
        let mut places = DEFINITIONS.iter().zip(self.values.iter_mut());
        let Some((definition, value)) = places.find(|(definition, _)| definition.name == name) else {
            return Err(ParameterError::Unknown);
        };
        *value = read(definition, text)?;
        Ok(())
    }

    /// Sets how far one pulse moves an axis, in nanometres, as a ratio.
    ///
    /// # Errors
    /// [`ParameterError::Range`]; the parameter keeps its value.
    pub fn set_pulse(&mut self, axis: Axis, numerator: u64, denominator: u64) -> Result<(), ParameterError> {
        let at = match axis {
            Axis::X => index::PULSE[0],
            Axis::Z => index::PULSE[1],
        };
        if let Some((definition, value)) = DEFINITIONS.iter().zip(self.values.iter_mut()).nth(at) {
            *value = pulse(numerator, denominator).ok_or(ParameterError::Range(definition))?;
        }
        Ok(())
    }

    /// All parameters with their values, which are written as an operator would type them.
    pub fn iter(&self) -> impl Iterator<Item = (&'static Definition, Shown)> + '_ {
        let shown =
            |(definition, value): (&'static Definition, &Value)| (definition, Shown { definition, value: *value });
        DEFINITIONS.iter().zip(&self.values).map(shown)
    }

    /// The machine that the parameters describe.
    ///
    /// # Errors
    /// [`ConfigError`] where they contradict each other.
    pub fn machine(&self) -> Result<Machine, ConfigError> {
        let machine = self.config().check()?;
        let (x, z) = (self.compensation(Axis::X), self.compensation(Axis::Z));
        let temperatures = Temperatures {
            reference: self.temperature(index::THERMAL_REFERENCE),
            screws: self.temperature(index::TEMPERATURE),
        };
        let (method, threading) = (self.method(), self.threading());
        let machine = Machine { method, threading, ..machine }.compensated(&x, &z, temperatures);
        let machine = if self.switch(index::HANDWHEELS) { machine.with_hands() } else { machine };
        machine.with_law(self.law(), self.small(index::MAX_JERK))
    }

    /// How steps follow a curve.
    pub fn method(&self) -> Method {
        match self.values.get(index::METHOD) {
            Some(Value::Choice(word)) => Method::ALL.get(*word).copied().unwrap_or_default(),
            _ => Method::default(),
        }
    }

    /// How the speed changes.
    pub fn law(&self) -> SpeedLaw {
        match self.values.get(index::LAW) {
            Some(Value::Choice(word)) => SpeedLaw::ALL.get(*word).copied().unwrap_or_default(),
            _ => SpeedLaw::default(),
        }
    }

    /// The machine as typed, unchecked.
    pub fn config(&self) -> Config {
        Config { x: self.axis(Axis::X), z: self.axis(Axis::Z), event_min_ns: self.small(index::EVENT_MIN) }
    }

    /// What is to be compensated on an axis.
    pub fn compensation(&self, axis: Axis) -> compensation::Config {
        let first = index::COMPENSATION.wrapping_add(match axis {
            Axis::X => 0,
            Axis::Z => index::AXIS_COMPENSATION,
        });
        let small = |offset: usize| self.small(first.wrapping_add(offset));
        compensation::Config {
            backlash_nm: small(index::BACKLASH),
            backlash_distance_nm: small(index::BACKLASH_DISTANCE),
            pitch: self.switch(first.wrapping_add(index::PITCH_TABLE)),
            thermal: small(index::THERMAL),
            thermal_origin: Length::from_nm(self.number(first.wrapping_add(index::THERMAL_ORIGIN))).unwrap_or_default(),
        }
    }

    /// Puts the table of pitch errors of an axis in force, or out of it.
    pub fn set_pitch(&mut self, axis: Axis, on: bool) {
        let at = index::COMPENSATION.wrapping_add(index::PITCH_TABLE).wrapping_add(match axis {
            Axis::X => 0,
            Axis::Z => index::AXIS_COMPENSATION,
        });
        if let Some(value) = self.values.get_mut(at) {
            *value = Value::Switch(on);
        }
    }

    /// Thousandths of a degree.
    fn temperature(&self, at: usize) -> i32 {
        i32::try_from(self.number(at)).unwrap_or(20_000)
    }

    /// How program text is read.
    pub fn settings(&self) -> Settings {
        let mut settings = Settings::new(self.axis(Axis::X).max_feed, self.axis(Axis::Z).max_feed);
        settings.front_post = self.switch(index::FRONT_POST);
        settings.block_delete = self.switch(index::BLOCK_DELETE);
        settings.arc_tolerance = Length::from_nm(self.number(index::ARC_TOLERANCE)).unwrap_or_default();
        settings.corner = Length::from_nm(self.number(index::CORNER)).unwrap_or_default();
        settings.start = self.start();
        for (number, feed) in settings.tape_feeds.iter_mut().enumerate() {
            let value = self.number(index::TAPE_FEEDS.wrapping_add(number));
            *feed = u64::try_from(value).ok().and_then(Feedrate::from_nm_per_min);
        }
        settings
    }

    /// Where the tool is when the program starts.
    pub fn start(&self) -> Point {
        match self.values.get(index::START) {
            Some(Value::Place(point)) => *point,
            _ => Point::default(),
        }
    }

    /// Feed override, percent.
    pub fn feed_override(&self) -> u16 {
        u16::try_from(self.number(index::FEED_OVERRIDE)).unwrap_or(100)
    }

    /// Whether M1 stops.
    pub fn optional_stop(&self) -> bool {
        self.switch(index::OPTIONAL_STOP)
    }

    fn axis(&self, axis: Axis) -> AxisConfig {
        let first = match axis {
            Axis::X => 0,
            Axis::Z => index::AXIS,
        };
        let pulse = match self.values.get(match axis {
            Axis::X => index::PULSE[0],
            Axis::Z => index::PULSE[1],
        }) {
            Some(Value::Pulse(pulse)) => *pulse,
            _ => PulseSize::ONE_MICROMETRE,
        };
        let small = |offset: usize| self.small(first.wrapping_add(offset));
        let feed = u64::try_from(self.number(first.wrapping_add(index::MAX_FEED))).unwrap_or(0);
        AxisConfig {
            pulse,
            max_feed: Feedrate::from_nm_per_min(feed).unwrap_or(Feedrate::SLOWEST),
            max_accel: small(index::MAX_ACCEL),
            max_jump: small(index::MAX_JUMP),
            pulse_width_ns: small(index::PULSE_WIDTH),
            dir_setup_ns: small(index::DIR_SETUP),
            dir_hold_ns: small(index::DIR_HOLD),
            min_space_ns: small(index::MIN_SPACE),
        }
    }

    fn number(&self, at: usize) -> i64 {
        match self.values.get(at) {
            Some(Value::Number(number)) => *number,
            _ => 0,
        }
    }

    fn small(&self, at: usize) -> u32 {
        u32::try_from(self.number(at)).unwrap_or(0)
    }

    fn switch(&self, at: usize) -> bool {
        matches!(self.values.get(at), Some(Value::Switch(true)))
    }
}

#[cfg(test)]
mod tests {
    use super::definitions::METHODS;
    use super::*;
    use interp_core::law::Smoothing;
    extern crate std;
    use std::string::ToString;

    #[test]
    fn every_default_is_readable_and_the_indices_are_right() {
        for definition in &DEFINITIONS {
            assert!(read(definition, definition.default).is_ok(), "{}", definition.name);
        }
        for (at, name) in [
            (index::PULSE[1], "z.pulse_nm"),
            (index::AXIS + index::MIN_SPACE, "z.min_space_ns"),
            (index::EVENT_MIN, "event_min_ns"),
            (index::FEED_OVERRIDE, "feed_override"),
            (index::ARC_TOLERANCE, "arc_tolerance_um"),
            (index::CORNER, "corner_um"),
            (index::TAPE_FEEDS + 8, "f9"),
            (index::FRONT_POST, "front_post"),
            (index::BLOCK_DELETE, "block_delete"),
            (index::START, "start"),
            (index::LAW, "accel"),
            (index::MAX_JERK, "max_jerk"),
            (index::ENCODER_COUNTS, "spindle.encoder_counts"),
            (index::THREAD_RETRACT, "thread.retract_mm"),
            (index::GUARD_SWITCH, "guard_switch"),
            (index::LIMIT_SWITCHES, "limit_switches"),
        ] {
            assert_eq!(DEFINITIONS[at].name, name);
        }
        let machine = Parameters::new().machine().unwrap();
        assert_eq!((machine.x.width, machine.x.hold, machine.event_min), (60, 120, 24));
        assert_eq!(machine.x.accel, 500 << 12);
        assert_eq!(machine.z.jump, 2000 << 12);
    }

    #[test]
    fn every_value_is_shown_as_it_may_be_typed() {
        let mut parameters = Parameters::new();
        for (definition, shown) in parameters.iter() {
            assert_eq!(shown.to_string(), definition.default);
        }
        for (name, text) in [("x.pulse_nm", "15875/8"), ("z.max_feed", "0.01"), ("start", "-0.5,12.345678")] {
            parameters.set(name, text).unwrap();
            let shown = parameters.iter().find(|(definition, _)| definition.name == name).unwrap().1;
            assert_eq!(shown.to_string(), text);
        }
    }

    #[test]
    fn a_pulse_is_a_whole_number_a_decimal_or_a_ratio() {
        let mut parameters = Parameters::new();
        for (text, numerator, denominator) in
            [("1250", 1250, 1), ("1984.375", 15875, 8), ("15875/8", 15875, 8), ("30/12", 5, 2)]
        {
            let result = parameters.set("x.pulse_nm", text);
            let expected = PulseSize::new(numerator, denominator);
            if numerator < 10 {
                assert!(result.is_err(), "{text}");
            } else {
                assert_eq!(Some(parameters.axis(Axis::X).pulse), expected, "{text}");
            }
        }
    }

    #[test]
    fn refusals_name_the_parameter_and_change_nothing() {
        let mut parameters = Parameters::new();
        for (name, text, message) in [
            ("x.pulse", "1", "there is no parameter of this name"),
            ("x.pulse_nm", "1250/", "x.pulse_nm is a number or a ratio of nm, such as 1250, 1984.375 or 15875/8"),
            (
                "x.pulse_nm",
                "5",
                "x.pulse_nm goes from 10 nm to 1 mm, as a ratio whose numerator is at most 16777216 and denominator at most 4096",
            ),
            ("z.max_feed", "0", "z.max_feed goes from 0.01 to 30000 mm/min"),
            ("z.max_accel", "fast", "z.max_accel is a number of mm/s2, such as 500"),
            ("feed_override", "201", "feed_override goes from 0 to 200 %"),
            ("front_post", "yes", "front_post is true or false"),
            ("method", "spiral", &std::format!("method is one of {}", METHODS.join(" "))),
            ("start", "1", "start is X and Z in mm with a comma between, such as 25,100"),
            ("start", "1,3000", "start goes from -2100 to 2100 mm"),
        ] {
            let before = parameters.values;
            assert_eq!(parameters.set(name, text).unwrap_err().to_string(), message);
            assert_eq!(parameters.values, before);
        }
    }

    #[test]
    fn methods_are_named_in_their_order_and_read_back() {
        assert!(METHODS.iter().zip(Method::ALL).all(|(name, method)| *name == method.name()));
        let mut parameters = Parameters::new();
        assert_eq!(parameters.method(), Method::MinimumDeviation);
        for (name, method) in METHODS.iter().zip(Method::ALL) {
            parameters.set("method", name).unwrap();
            assert_eq!(parameters.machine().unwrap().method, method);
            let shown = parameters.iter().find(|(definition, _)| definition.name == "method");
            assert_eq!(shown.unwrap().1.to_string(), *name);
        }
    }

    #[test]
    fn a_speed_law_takes_a_mean_that_its_jerk_allows() {
        let mut parameters = Parameters::new();
        let machine = parameters.machine().unwrap();
        assert_eq!((machine.smoothing, machine.x.accel), (Smoothing::NONE, 500 << 12));
        // 7/8 of 500 mm/s2 in both axes is 618.7 along the path; 2 a / j = 24.7 ms, pi a / j = 38.9 ms
        for (law, ticks) in [("parabolic", 25), ("sine", 39)] {
            parameters.set("accel", law).unwrap();
            let machine = parameters.machine().unwrap();
            assert_eq!((machine.smoothing.law(), machine.smoothing.ticks()), (parameters.law(), ticks));
            assert_eq!(machine.x.accel, 437 << 12 | 2048);
        }
        parameters.set("max_jerk", "30000").unwrap();
        let error = parameters.machine().unwrap_err().to_string();
        assert_eq!(
            error,
            "accel=sine would need a mean of more than 64 ms: max_jerk must be at least 30376 mm/s3, or max_accel smaller"
        );
        parameters.set("max_jerk", "30376").unwrap();
        assert_eq!(parameters.machine().unwrap().smoothing.ticks(), 64);
    }

    #[test]
    fn a_feed_that_the_pulses_cannot_follow_is_refused() {
        let mut parameters = Parameters::new();
        parameters.set("x.max_feed", "10000").unwrap();
        let error = parameters.machine().unwrap_err();
        assert_eq!(error, ConfigError::PulseRate { axis: Axis::X, needed_hz: 133_334, limit_hz: 99_200 });
    }
}
