//! What a scenario expects of the state, and whether it is so.

use serde_json::Value;

/// A list that is equal to this is empty.
const NONE: &str = "none";

/// How a value is compared.
#[derive(Copy, Clone, Debug, PartialEq)]
pub enum Relation {
    /// Equal; of a list: it contains the value.
    Equal,
    /// Not equal; of a list: it does not contain the value.
    Unequal,
    /// Less.
    Less,
    /// Less or equal.
    AtMost,
    /// More.
    More,
    /// More or equal.
    AtLeast,
    /// At most so far from it.
    Near(f64),
}

impl Relation {
    /// The relation of a sign; `~` is not among them, as it has a tolerance.
    #[must_use]
    pub fn of(sign: &str) -> Option<Self> {
        Some(match sign {
            "==" => Self::Equal,
            "!=" => Self::Unequal,
            "<" => Self::Less,
            "<=" => Self::AtMost,
            ">" => Self::More,
            ">=" => Self::AtLeast,
            _ => return None,
        })
    }

    fn sign(self) -> String {
        match self {
            Self::Equal => "==".into(),
            Self::Unequal => "!=".into(),
            Self::Less => "<".into(),
            Self::AtMost => "<=".into(),
            Self::More => ">".into(),
            Self::AtLeast => ">=".into(),
            Self::Near(tolerance) => format!("within {tolerance} of"),
        }
    }
}

/// What is expected.
#[derive(Clone, Debug, PartialEq)]
pub struct Expect {
    /// Where in the state: names and numbers with dots between.
    pub key: String,
    /// How.
    pub relation: Relation,
    /// With what, as written.
    pub value: String,
}

impl Expect {
    /// Whether it is so.
    ///
    /// # Errors
    /// What was found, and what was wanted.
    pub fn check(&self, state: &Value) -> Result<(), String> {
        let found = at(state, &self.key);
        let holds = found.is_some_and(|found| self.holds(found));
        if holds {
            return Ok(());
        }
        let shown = found.map_or_else(|| "nothing".into(), shown);
        Err(format!("{} is {shown}, wanted {} {}", self.key, self.relation.sign(), self.value))
    }

    fn holds(&self, found: &Value) -> bool {
        if let Value::Array(list) = found {
            if self.value == NONE {
                return match self.relation {
                    Relation::Equal => list.is_empty(),
                    Relation::Unequal => !list.is_empty(),
                    _ => false,
                };
            }
            return match self.relation {
                Relation::Equal => list.iter().any(|item| same(item, &self.value)),
                Relation::Unequal => !list.iter().any(|item| same(item, &self.value)),
                _ => false,
            };
        }
        let numbers = found.as_f64().zip(self.value.parse::<f64>().ok());
        match self.relation {
            Relation::Equal => same(found, &self.value),
            Relation::Unequal => !same(found, &self.value),
            Relation::Less => numbers.is_some_and(|(found, value)| found < value),
            Relation::AtMost => numbers.is_some_and(|(found, value)| found <= value),
            Relation::More => numbers.is_some_and(|(found, value)| found > value),
            Relation::AtLeast => numbers.is_some_and(|(found, value)| found >= value),
            Relation::Near(tolerance) => numbers.is_some_and(|(found, value)| (found - value).abs() <= tolerance),
        }
    }
}

/// The value at a key.
#[must_use]
pub fn at<'s>(state: &'s Value, key: &str) -> Option<&'s Value> {
    key.split('.').try_fold(state, |value, part| match value {
        Value::Object(fields) => fields.get(part),
        Value::Array(list) => list.get(part.parse::<usize>().ok()?),
        _ => None,
    })
}

/// Whether a state like this one can have such a key: an item of a list may come later.
#[must_use]
pub fn is_known(state: &Value, key: &str) -> bool {
    let mut value = state;
    for part in key.split('.') {
        match value {
            Value::Object(fields) => match fields.get(part) {
                Some(next) => value = next,
                None => return false,
            },
            Value::Array(_) => return part.parse::<usize>().is_ok(),
            _ => return false,
        }
    }
    true
}

/// Whether a value is what was written.
#[expect(clippy::float_cmp, reason = "a script that wants a tolerance writes ~")]
fn same(found: &Value, wanted: &str) -> bool {
    match found {
        Value::Null => wanted == "null",
        Value::Bool(on) => wanted == if *on { "true" } else { "false" },
        Value::Number(number) => number.as_f64().zip(wanted.parse::<f64>().ok()).is_some_and(|(a, b)| a == b),
        Value::String(text) => text == wanted,
        Value::Array(_) | Value::Object(_) => false,
    }
}

/// A value as a message has it.
fn shown(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Array(list) if list.is_empty() => "an empty list".into(),
        Value::Array(list) => format!("[{}]", list.iter().map(shown).collect::<Vec<_>>().join(", ")),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn holds(key: &str, relation: Relation, value: &str) -> bool {
        let state = json!({
            "mode": "auto", "position": {"x": -800, "z": 0}, "refusals": ["guard-open"], "alarms": [],
            "verified": {"x": true}, "feed": 99.5, "train_hash": "1234567890123456", "scale": {"x": null}
        });
        Expect { key: key.into(), relation, value: value.into() }.check(&state).is_ok()
    }

    #[test]
    fn each_relation_holds_where_it_should_and_nowhere_else() {
        use Relation::*;
        let good = [
            ("mode", Equal, "auto"),
            ("position.x", Equal, "-800"),
            ("position.x", Less, "-799"),
            ("position.x", AtMost, "-800"),
            ("position.z", More, "-1"),
            ("position.z", AtLeast, "0"),
            ("feed", Near(0.5), "100"),
            ("verified.x", Equal, "true"),
            ("refusals", Equal, "guard-open"),
            ("refusals.0", Equal, "guard-open"),
            ("refusals", Unequal, "moving"),
            ("alarms", Unequal, "emergency"),
            ("alarms", Equal, "none"),
            ("refusals", Unequal, "none"),
            ("train_hash", Equal, "1234567890123456"),
            ("scale.x", Equal, "null"),
            ("mode", Unequal, "mdi"),
        ];
        let bad = [
            ("mode", Equal, "mdi"),
            ("mode", Less, "5"),
            ("position.x", Equal, "800"),
            ("position.x", Less, "-800"),
            ("position.z", More, "0"),
            ("feed", Near(0.4), "100"),
            ("refusals", Equal, "moving"),
            ("refusals", Unequal, "guard-open"),
            ("refusals.1", Equal, "guard-open"),
            ("alarms", Equal, "emergency"),
            ("alarms", Unequal, "none"),
            ("refusals", Equal, "none"),
            ("nothing", Unequal, "1"),
            ("position", Equal, "0"),
        ];
        assert!(good.iter().all(|(key, relation, value)| holds(key, *relation, value)));
        for (key, relation, value) in bad {
            assert!(!holds(key, relation, value), "{key} {relation:?} {value}");
        }
    }
}
