//! Values of parameters: read as an operator types them, held exactly, shown as they were typed.

use core::fmt;

use feature_editor::codes::Number;
use interp_core::units::{Length, Point, PulseSize};

use super::definitions::{Definition, Kind};

/// A value as held.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) enum Value {
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

/// The value of a parameter, as an operator would type it.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Shown {
    pub(super) definition: &'static Definition,
    pub(super) value: Value,
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
pub(super) fn read(definition: &'static Definition, text: &str) -> Result<Value, ParameterError> {
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
pub(super) fn pulse(numerator: u64, denominator: u64) -> Option<Value> {
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
