//! Parameters: names, units, ranges, defaults, and the machine and program settings that they make.
//!
//! A value is given as text, as an operator types it, and held exactly: lengths as ratios or whole nanometres, the
//! rest as whole multiples of the unit's last decimal.

use core::fmt;

use feature_editor::codes::{Number, Settings};
use interp_core::compensation::{self, Temperatures};
use interp_core::config::{AxisConfig, Config, ConfigError, Machine};
use interp_core::curve::method::Method;
use interp_core::law::{Smoothing, SpeedLaw};
use interp_core::units::{Axis, Feedrate, Length, Point, PulseSize};

/// How a parameter is written and held.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A ratio, decimal or whole number of nanometres a pulse.
    Pulse,
    /// A number, held times `scale`, from `least` to `most` (so held).
    Number {
        /// What one unit is held as.
        scale: u32,
        /// Smallest value.
        least: i64,
        /// Largest value.
        most: i64,
    },
    /// `true` or `false`.
    Switch,
    /// One word of a list.
    Choice(&'static [&'static str]),
    /// Two lengths in mm: X (radius) and Z, with a comma between.
    Place,
}

/// One parameter.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Definition {
    /// Name, with the axis's letter in front.
    pub name: &'static str,
    /// Unit, as shown.
    pub unit: &'static str,
    /// How it is written.
    pub kind: Kind,
    /// Default, as an operator would type it.
    pub default: &'static str,
    /// What it is.
    pub help: &'static str,
}

const fn number(scale: u32, least: i64, most: i64) -> Kind {
    Kind::Number { scale, least, most }
}

const FEED: Kind = number(1_000_000, 10_000, 30_000_000_000);
const ACCEL: Kind = number(1_000, AxisConfig::ACCEL_RANGE.0 as i64, AxisConfig::ACCEL_RANGE.1 as i64);
const JUMP: Kind = number(1_000, AxisConfig::JUMP_RANGE.0 as i64, AxisConfig::JUMP_RANGE.1 as i64);
const BACKLASH: Kind = number(1_000, 0, compensation::Config::MAX_BACKLASH_NM as i64);
const EXPANSION: Kind = number(1_000, 0, compensation::Config::MAX_THERMAL as i64);
const POSITION: Kind = number(1_000_000, -(Length::LIMIT_NM as i64), Length::LIMIT_NM as i64);
const TEMPERATURE: Kind = number(1_000, -50_000, 150_000);
const JERK: Kind = number(1, Smoothing::JERK_RANGE.0 as i64, Smoothing::JERK_RANGE.1 as i64);
const NANOSECONDS: Kind = number(1, 100, 200_000);

const fn definition(
    name: &'static str,
    unit: &'static str,
    kind: Kind,
    default: &'static str,
    help: &'static str,
) -> Definition {
    Definition { name, unit, kind, default, help }
}

/// Index of a parameter in [`DEFINITIONS`].
mod index {
    pub(super) const PULSE: [usize; 2] = [0, 8];
    pub(super) const MAX_FEED: usize = 1;
    pub(super) const MAX_ACCEL: usize = 2;
    pub(super) const MAX_JUMP: usize = 3;
    pub(super) const PULSE_WIDTH: usize = 4;
    pub(super) const DIR_SETUP: usize = 5;
    pub(super) const DIR_HOLD: usize = 6;
    pub(super) const MIN_SPACE: usize = 7;
    pub(super) const AXIS: usize = 8;
    pub(super) const EVENT_MIN: usize = 16;
    pub(super) const FEED_OVERRIDE: usize = 17;
    pub(super) const ARC_TOLERANCE: usize = 18;
    pub(super) const CORNER: usize = 19;
    pub(super) const METHOD: usize = 20;
    pub(super) const TAPE_FEEDS: usize = 21;
    pub(super) const FRONT_POST: usize = 30;
    pub(super) const BLOCK_DELETE: usize = 31;
    pub(super) const START: usize = 32;
    pub(super) const OPTIONAL_STOP: usize = 33;
    /// Of X; those of Z follow.
    pub(super) const COMPENSATION: usize = 34;
    pub(super) const BACKLASH: usize = 0;
    pub(super) const BACKLASH_DISTANCE: usize = 1;
    pub(super) const PITCH_TABLE: usize = 2;
    pub(super) const THERMAL: usize = 3;
    pub(super) const THERMAL_ORIGIN: usize = 4;
    pub(super) const AXIS_COMPENSATION: usize = 5;
    pub(super) const THERMAL_REFERENCE: usize = 44;
    pub(super) const TEMPERATURE: usize = 45;
    pub(super) const LAW: usize = 46;
    pub(super) const MAX_JERK: usize = 47;
    pub(super) const COUNT: usize = 48;
}

/// Methods that this build has, in the order of [`Method::ALL`].
const METHODS: &[&str] = if cfg!(feature = "methods") {
    &["minimum-deviation", "point-comparison", "dda", "rate-multiplier", "fraction", "time-division"]
} else {
    &["minimum-deviation"]
};

/// Speed laws in the order of [`SpeedLaw::ALL`].
const LAWS: &[&str] = &[SpeedLaw::ALL[0].name(), SpeedLaw::ALL[1].name(), SpeedLaw::ALL[2].name()];

/// All parameters.
pub static DEFINITIONS: [Definition; index::COUNT] = [
    definition("x.pulse_nm", "nm", Kind::Pulse, "1250", "how far one pulse moves the cross slide (radius)"),
    definition("x.max_feed", "mm/min", FEED, "5000", "largest speed of the cross slide"),
    definition("x.max_accel", "mm/s2", ACCEL, "500", "largest acceleration of the cross slide"),
    definition("x.max_jump", "mm/s", JUMP, "2", "largest sudden change of speed (start-stop speed)"),
    definition("x.pulse_width_ns", "ns", NANOSECONDS, "5000", "time that the step pin stays high"),
    definition("x.dir_setup_ns", "ns", NANOSECONDS, "5000", "time from a change of direction to the next pulse"),
    definition("x.dir_hold_ns", "ns", NANOSECONDS, "10000", "time from a pulse to a change of direction"),
    definition("x.min_space_ns", "ns", NANOSECONDS, "5000", "time that the step pin stays low"),
    definition("z.pulse_nm", "nm", Kind::Pulse, "2500", "how far one pulse moves the carriage"),
    definition("z.max_feed", "mm/min", FEED, "5000", "largest speed of the carriage"),
    definition("z.max_accel", "mm/s2", ACCEL, "500", "largest acceleration of the carriage"),
    definition("z.max_jump", "mm/s", JUMP, "2", "largest sudden change of speed (start-stop speed)"),
    definition("z.pulse_width_ns", "ns", NANOSECONDS, "5000", "time that the step pin stays high"),
    definition("z.dir_setup_ns", "ns", NANOSECONDS, "5000", "time from a change of direction to the next pulse"),
    definition("z.dir_hold_ns", "ns", NANOSECONDS, "10000", "time from a pulse to a change of direction"),
    definition("z.min_space_ns", "ns", NANOSECONDS, "5000", "time that the step pin stays low"),
    definition("event_min_ns", "ns", number(1, 100, 50_000), "2000", "shortest time between two events of the train"),
    definition("feed_override", "%", number(1, 0, 200), "100", "part of the programmed feed"),
    definition("arc_tolerance_um", "um", number(1_000, 0, 100_000), "10", "how far the two radii of an arc may differ"),
    definition("corner_um", "um", number(1_000, 0, 1_000_000), "0", "how far a blend may leave a corner; 0 for none"),
    definition("method", "", Kind::Choice(METHODS), "minimum-deviation", "how steps follow a curve"),
    definition("f1", "mm/min", FEED, "25", "feed of the tape code F1"),
    definition("f2", "mm/min", FEED, "50", "feed of the tape code F2"),
    definition("f3", "mm/min", FEED, "75", "feed of the tape code F3"),
    definition("f4", "mm/min", FEED, "100", "feed of the tape code F4"),
    definition("f5", "mm/min", FEED, "150", "feed of the tape code F5"),
    definition("f6", "mm/min", FEED, "200", "feed of the tape code F6"),
    definition("f7", "mm/min", FEED, "300", "feed of the tape code F7"),
    definition("f8", "mm/min", FEED, "400", "feed of the tape code F8"),
    definition("f9", "mm/min", FEED, "600", "feed of the tape code F9"),
    definition("front_post", "", Kind::Switch, "false", "the tool post is on the operator's side: G2 and G3 change"),
    definition("block_delete", "", Kind::Switch, "true", "lines that begin with / are skipped"),
    definition("start", "mm", Kind::Place, "0,0", "where the tool is when the program starts: X (radius), Z"),
    definition("optional_stop", "", Kind::Switch, "false", "M1 stops as M0 does"),
    definition("x.backlash_um", "um", BACKLASH, "0", "play of screw and nut that the control takes up (radius)"),
    definition("x.backlash_distance_um", "um", BACKLASH, "5", "travel after a reversal over which it is taken up"),
    definition("x.pitch_table", "", Kind::Switch, "false", "the table of pitch errors is in force"),
    definition("x.thermal_um_per_m_k", "um/m/K", EXPANSION, "0", "how much longer the warm screw gets"),
    definition("x.thermal_origin_mm", "mm", POSITION, "0", "place that stays where it is when the screw gets longer"),
    definition("z.backlash_um", "um", BACKLASH, "0", "play of screw and nut that the control takes up"),
    definition("z.backlash_distance_um", "um", BACKLASH, "5", "travel after a reversal over which it is taken up"),
    definition("z.pitch_table", "", Kind::Switch, "false", "the table of pitch errors is in force"),
    definition("z.thermal_um_per_m_k", "um/m/K", EXPANSION, "0", "how much longer the warm screw gets"),
    definition("z.thermal_origin_mm", "mm", POSITION, "0", "place that stays where it is when the screw gets longer"),
    definition("thermal_reference_c", "C", TEMPERATURE, "20", "temperature at which the screws are right"),
    definition("temperature_c", "C", TEMPERATURE, "20", "temperature of the screws, as measured"),
    definition(
        "accel",
        "",
        Kind::Choice(LAWS),
        "linear",
        "how the speed changes: at once, or S-shaped with limited jerk",
    ),
    definition("max_jerk", "mm/s3", JERK, "50000", "largest jerk along the path under accel=sine and parabolic"),
];

/// A value as held.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Value {
    Pulse(PulseSize),
    Number(i64),
    Switch(bool),
    /// Which word of the list.
    Choice(usize),
    Place(Point),
}

/// Why a parameter was refused. Nothing changes then.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum ParameterError {
    /// No parameter has this name.
    Unknown,
    /// The text is not what the parameter is written as.
    Malformed(&'static Definition),
    /// The value is outside the parameter's range.
    Range(&'static Definition),
}

impl fmt::Display for ParameterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown => f.write_str("there is no parameter of this name"),
            Self::Malformed(definition) => {
                write!(f, "{} is ", definition.name)?;
                match definition.kind {
                    Kind::Pulse => f.write_str("a number or a ratio of nm, such as 1250, 1984.375 or 15875/8"),
                    Kind::Number { .. } => write!(f, "a number of {}, such as {}", definition.unit, definition.default),
                    Kind::Switch => f.write_str("true or false"),
                    Kind::Choice(words) => {
                        f.write_str("one of")?;
                        words.iter().try_for_each(|word| write!(f, " {word}"))
                    }
                    Kind::Place => f.write_str("X and Z in mm with a comma between, such as 25,100"),
                }
            }
            Self::Range(definition) => {
                write!(f, "{} goes from ", definition.name)?;
                match definition.kind {
                    Kind::Number { scale, least, most } => {
                        decimal(f, least, scale)?;
                        f.write_str(" to ")?;
                        decimal(f, most, scale)?;
                        write!(f, " {}", definition.unit)
                    }
                    Kind::Pulse => write!(
                        f,
                        "10 nm to 1 mm, as a ratio whose numerator is at most {} and denominator at most {}",
                        PulseSize::MAX_NUMERATOR,
                        PulseSize::MAX_DENOMINATOR
                    ),
                    Kind::Place => f.write_str("-2100 to 2100 mm"),
                    Kind::Switch | Kind::Choice(_) => f.write_str("one of its words to another"),
                }
            }
        }
    }
}

/// Writes `value / scale`, scale a power of ten, without trailing zeros.
fn decimal(f: &mut fmt::Formatter<'_>, value: i64, scale: u32) -> fmt::Result {
    let scale = u64::from(scale.max(1));
    let magnitude = value.unsigned_abs();
    let sign = if value < 0 { "-" } else { "" };
    let whole = magnitude.checked_div(scale).unwrap_or(0);
    write!(f, "{sign}{whole}")?;
    let mut rest = magnitude.checked_rem(scale).unwrap_or(0);
    if rest > 0 {
        f.write_str(".")?;
    }
    let mut place = scale / 10;
    while rest > 0 && place > 0 {
        write!(f, "{}", rest.checked_div(place).unwrap_or(0))?;
        rest = rest.checked_rem(place).unwrap_or(0);
        place /= 10;
    }
    Ok(())
}

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
        let machine = Machine { method: self.method(), ..machine }.compensated(&x, &z, temperatures);
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

/// The value of a parameter, as an operator would type it.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Shown {
    definition: &'static Definition,
    value: Value,
}

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.value {
            Value::Pulse(pulse) if pulse.denominator() == 1 => write!(f, "{}", pulse.numerator()),
            Value::Pulse(pulse) => write!(f, "{}/{}", pulse.numerator(), pulse.denominator()),
            Value::Number(number) => {
                let scale = match self.definition.kind {
                    Kind::Number { scale, .. } => scale,
                    Kind::Pulse | Kind::Switch | Kind::Choice(_) | Kind::Place => 1,
                };
                decimal(f, number, scale)
            }
            Value::Switch(on) => write!(f, "{on}"),
            Value::Choice(word) => f.write_str(match self.definition.kind {
                Kind::Choice(words) => words.get(word).copied().unwrap_or(self.definition.default),
                Kind::Pulse | Kind::Number { .. } | Kind::Switch | Kind::Place => self.definition.default,
            }),
            Value::Place(point) => {
                decimal(f, point.x.nm().into(), 1_000_000)?;
                f.write_str(",")?;
                decimal(f, point.z.nm().into(), 1_000_000)
            }
        }
    }
}

/// Reads a value as `definition` writes it.
fn read(definition: &'static Definition, text: &str) -> Result<Value, ParameterError> {
    let malformed = ParameterError::Malformed(definition);
    let range = ParameterError::Range(definition);
    let text = text.trim();
    match definition.kind {
        Kind::Pulse => {
            let (numerator, denominator) = match text.split_once('/') {
                Some((n, d)) => (whole(n).ok_or(malformed)?, whole(d).ok_or(malformed)?),
                None => {
                    // nine decimals; more than 4096ths do not fit anyway
                    let held = parse(text).ok_or(malformed)?.scaled(1_000_000_000).ok_or(range)?;
                    (u64::try_from(held).map_err(|_| range)?, 1_000_000_000)
                }
            };
            pulse(numerator, denominator).ok_or(range)
        }
        Kind::Number { scale, least, most } => {
            let held = parse(text).ok_or(malformed)?.scaled(scale).ok_or(range)?;
            if (least..=most).contains(&held) { Ok(Value::Number(held)) } else { Err(range) }
        }
        Kind::Switch => match text {
            "true" => Ok(Value::Switch(true)),
            "false" => Ok(Value::Switch(false)),
            _ => Err(malformed),
        },
        Kind::Choice(words) => words.iter().position(|word| *word == text).map(Value::Choice).ok_or(malformed),
        Kind::Place => {
            let (x, z) = text.split_once(',').ok_or(malformed)?;
            let length = |part: &str| -> Result<Length, ParameterError> {
                let nm = parse(part.trim()).ok_or(malformed)?.scaled(1_000_000).ok_or(range)?;
                Length::from_nm(nm).ok_or(range)
            };
            Ok(Value::Place(Point { x: length(x)?, z: length(z)? }))
        }
    }
}

/// A pulse size of a ratio that may be reduced.
fn pulse(numerator: u64, denominator: u64) -> Option<Value> {
    let (mut a, mut b) = (numerator, denominator);
    while let Some(rest) = a.checked_rem(b) {
        (a, b) = (b, rest);
    }
    let reduced = |value: u64| value.checked_div(a).and_then(|v| u32::try_from(v).ok());
    let pulse = reduced(numerator).zip(reduced(denominator)).and_then(|(n, d)| PulseSize::new(n, d));
    pulse.map(Value::Pulse)
}

fn parse(text: &str) -> Option<Number> {
    Number::parse(text.as_bytes()).ok()
}

fn whole(text: &str) -> Option<u64> {
    text.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
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
