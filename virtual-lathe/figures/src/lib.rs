#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod definition;

use std::fmt;

pub use definition::{Definition, Kind, Value};

/// The values of all figures of some tables.
#[derive(Clone, Debug)]
pub struct Figures {
    held: Vec<Held>,
}

#[derive(Clone, Debug)]
struct Held {
    definition: &'static Definition,
    /// As typed.
    text: String,
    /// `None` only where a table's own default can't be read: asking for it tells.
    value: Option<Value>,
}

/// Why a figure was refused. Nothing changes then.
#[derive(Clone, Debug, PartialEq)]
pub enum FigureError {
    /// No figure has this name.
    Unknown(String),
    /// The text is not what the figure is written as.
    Malformed(&'static Definition),
    /// The value is outside the figure's range.
    Range(&'static Definition),
    /// The rows of a table of pairs are not in ascending order.
    Order(&'static Definition),
    /// Figures that can't go together; the text names them and says what to do.
    Contradiction(String),
}

impl fmt::Display for FigureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown(name) => write!(f, "{name}: there is no parameter of this name"),
            Self::Malformed(definition) => write!(f, "{} is {}", definition.name, definition.form()),
            Self::Range(definition) => {
                write!(f, "{} goes from {}", definition.name, definition.range())?;
                if definition.unit.is_empty() { Ok(()) } else { write!(f, " {}", definition.unit) }
            }
            Self::Order(definition) => {
                write!(f, "the first number of each pair of {} must be above that of the pair before", definition.name)
            }
            Self::Contradiction(text) => f.write_str(text),
        }
    }
}

impl std::error::Error for FigureError {}

impl Figures {
    /// The figures of `tables` in their order, at their defaults.
    #[must_use]
    pub fn new(tables: &[&'static [Definition]]) -> Self {
        let held = |definition: &'static Definition| Held {
            definition,
            text: definition.default.to_owned(),
            value: definition.read(definition.default).ok(),
        };
        Self { held: tables.iter().flat_map(|table| table.iter()).map(held).collect() }
    }

    /// Sets a figure from text.
    ///
    /// # Errors
    /// [`FigureError`]; the figure keeps its value.
    pub fn set(&mut self, name: &str, text: &str) -> Result<(), FigureError> {
        let held = self.held.iter_mut().find(|held| held.definition.name == name);
        let held = held.ok_or_else(|| FigureError::Unknown(name.to_owned()))?;
        held.value = Some(held.definition.read(text)?);
        held.text = text.trim().to_owned();
        Ok(())
    }

    /// All figures with their values as typed.
    pub fn iter(&self) -> impl Iterator<Item = (&'static Definition, &str)> + '_ {
        self.held.iter().map(|held| (held.definition, held.text.as_str()))
    }

    /// The value of a figure that is a number.
    ///
    /// # Errors
    /// [`FigureError::Unknown`] where no number has this name.
    pub fn number(&self, name: &str) -> Result<f64, FigureError> {
        match self.value(name) {
            Some(Value::Number(number)) => Ok(*number),
            _ => Err(FigureError::Unknown(name.to_owned())),
        }
    }

    /// The value of a figure that is a whole number.
    ///
    /// # Errors
    /// [`FigureError::Unknown`] where no whole number has this name.
    pub fn whole(&self, name: &str) -> Result<u32, FigureError> {
        match self.value(name) {
            Some(Value::Whole(number)) => Ok(*number),
            _ => Err(FigureError::Unknown(name.to_owned())),
        }
    }

    /// The value of a figure that is a switch.
    ///
    /// # Errors
    /// [`FigureError::Unknown`] where no switch has this name.
    pub fn switch(&self, name: &str) -> Result<bool, FigureError> {
        match self.value(name) {
            Some(Value::Switch(on)) => Ok(*on),
            _ => Err(FigureError::Unknown(name.to_owned())),
        }
    }

    /// The value of a figure that is one word of a list.
    ///
    /// # Errors
    /// [`FigureError::Unknown`] where no choice has this name.
    pub fn word(&self, name: &str) -> Result<&'static str, FigureError> {
        match self.value(name) {
            Some(Value::Word(word)) => Ok(word),
            _ => Err(FigureError::Unknown(name.to_owned())),
        }
    }

    /// The value of a figure that is a table of pairs, ascending in the first number; empty for `none`.
    ///
    /// # Errors
    /// [`FigureError::Unknown`] where no table has this name.
    pub fn pairs(&self, name: &str) -> Result<&[(f64, f64)], FigureError> {
        match self.value(name) {
            Some(Value::Pairs(pairs)) => Ok(pairs),
            _ => Err(FigureError::Unknown(name.to_owned())),
        }
    }

    fn value(&self, name: &str) -> Option<&Value> {
        self.held.iter().find(|held| held.definition.name == name)?.value.as_ref()
    }
}

#[cfg(test)]
mod tests;
