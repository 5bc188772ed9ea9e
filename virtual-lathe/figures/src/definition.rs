//! One figure: name, unit, how it is written, default, meaning.

use crate::FigureError;

/// How a figure is written, and its range.
#[derive(Copy, Clone, Debug, PartialEq)]
pub enum Kind {
    /// A number from `least` to `most`.
    Number {
        /// Smallest value.
        least: f64,
        /// Largest value.
        most: f64,
    },
    /// A whole number from `least` to `most`.
    Whole {
        /// Smallest value.
        least: u32,
        /// Largest value.
        most: u32,
    },
    /// `true` or `false`.
    Switch,
    /// One word of a list.
    Choice(&'static [&'static str]),
    /// `none`, or pairs `0:0;100:-3.5`, ascending in the first number.
    Pairs {
        /// Range of the first numbers.
        first: (f64, f64),
        /// Range of the second numbers.
        second: (f64, f64),
    },
}

/// A value as held.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Of [`Kind::Number`]; always finite.
    Number(f64),
    /// Of [`Kind::Whole`].
    Whole(u32),
    /// Of [`Kind::Switch`].
    Switch(bool),
    /// Of [`Kind::Choice`].
    Word(&'static str),
    /// Of [`Kind::Pairs`].
    Pairs(Vec<(f64, f64)>),
}

/// One figure.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Definition {
    /// Name: a group, a dot, what is meant with its unit.
    pub name: &'static str,
    /// Unit, as shown; empty for none.
    pub unit: &'static str,
    /// How it is written.
    pub kind: Kind,
    /// Default, as one would type it.
    pub default: &'static str,
    /// What it is.
    pub help: &'static str,
}

impl Definition {
    /// A number from `least` to `most`.
    #[must_use]
    pub const fn number(
        name: &'static str,
        unit: &'static str,
        least: f64,
        most: f64,
        default: &'static str,
        help: &'static str,
    ) -> Self {
        Self { name, unit, kind: Kind::Number { least, most }, default, help }
    }

    /// A whole number from `least` to `most`.
    #[must_use]
    pub const fn whole(
        name: &'static str,
        unit: &'static str,
        least: u32,
        most: u32,
        default: &'static str,
        help: &'static str,
    ) -> Self {
        Self { name, unit, kind: Kind::Whole { least, most }, default, help }
    }

    /// `true` or `false`.
    #[must_use]
    pub const fn switch(name: &'static str, default: &'static str, help: &'static str) -> Self {
        Self { name, unit: "", kind: Kind::Switch, default, help }
    }

    /// One word of a list.
    #[must_use]
    pub const fn choice(
        name: &'static str,
        words: &'static [&'static str],
        default: &'static str,
        help: &'static str,
    ) -> Self {
        Self { name, unit: "", kind: Kind::Choice(words), default, help }
    }

    /// A table of pairs; its unit is that of the two numbers, `mm:um`.
    #[must_use]
    pub const fn pairs(
        name: &'static str,
        unit: &'static str,
        first: (f64, f64),
        second: (f64, f64),
        help: &'static str,
    ) -> Self {
        Self { name, unit, kind: Kind::Pairs { first, second }, default: "none", help }
    }

    /// The range, or the words, as a list of parameters shows it.
    #[must_use]
    pub fn range(&self) -> String {
        match self.kind {
            Kind::Number { least, most } => format!("{least} to {most}"),
            Kind::Whole { least, most } => format!("{least} to {most}"),
            Kind::Switch => "true, false".into(),
            Kind::Choice(words) => words.join(", "),
            Kind::Pairs { first, second } => {
                format!("none, or {} to {}:{} to {};...", first.0, first.1, second.0, second.1)
            }
        }
    }

    /// What a value looks like.
    pub(crate) fn form(&self) -> String {
        let of = if self.unit.is_empty() { String::new() } else { format!(" of {}", self.unit) };
        match self.kind {
            Kind::Number { .. } => format!("a number{of}, such as {}", self.default),
            Kind::Whole { .. } => format!("a whole number{of}, such as {}", self.default),
            Kind::Switch => "true or false".into(),
            Kind::Choice(words) => format!("one of {}", words.join(" ")),
            Kind::Pairs { .. } => format!("none or pairs{of}, such as 0:0;100:-3.5"),
        }
    }

    /// Reads a value.
    pub(crate) fn read(&'static self, text: &str) -> Result<Value, FigureError> {
        let text = text.trim();
        match self.kind {
            Kind::Number { least, most } => self.real(text, (least, most)).map(Value::Number),
            Kind::Whole { least, most } => {
                // a number that is whole but too large, negative or written 4.0 is well-formed, so read it as one first
                let real = self.real(text, (f64::from(least), f64::from(most)))?;
                let number = text.parse().map_err(|_| FigureError::Malformed(self));
                if real.fract() == 0.0 { number.map(Value::Whole) } else { Err(FigureError::Malformed(self)) }
            }
            Kind::Switch => text.parse().map(Value::Switch).map_err(|_| FigureError::Malformed(self)),
            Kind::Choice(words) => {
                let word = words.iter().find(|word| **word == text);
                word.map(|word| Value::Word(word)).ok_or(FigureError::Malformed(self))
            }
            Kind::Pairs { .. } if text == "none" => Ok(Value::Pairs(Vec::new())),
            Kind::Pairs { first, second } => {
                let mut pairs: Vec<(f64, f64)> = Vec::new();
                for pair in text.split(';') {
                    let (a, b) = pair.split_once(':').ok_or(FigureError::Malformed(self))?;
                    let pair = (self.real(a, first)?, self.real(b, second)?);
                    if pairs.last().is_some_and(|last| last.0 >= pair.0) {
                        return Err(FigureError::Order(self));
                    }
                    pairs.push(pair);
                }
                Ok(Value::Pairs(pairs))
            }
        }
    }

    /// A number within `range`. NaN and infinity are words, not numbers.
    fn real(&'static self, text: &str, range: (f64, f64)) -> Result<f64, FigureError> {
        let text = text.trim();
        let plain = text.bytes().all(|byte| byte.is_ascii_digit() || b"+-.eE".contains(&byte));
        let number: f64 = text.parse().map_err(|_| FigureError::Malformed(self))?;
        if !plain {
            Err(FigureError::Malformed(self))
        } else if (range.0..=range.1).contains(&number) {
            Ok(number)
        } else {
            Err(FigureError::Range(self))
        }
    }
}
