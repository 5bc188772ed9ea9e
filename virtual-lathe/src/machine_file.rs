//! Machine files: parameters in TOML, under the same names as `--set`.
//!
//! `x.pulse_nm = "15875/8"` and a table `[x]` with `pulse_nm = 1250` say the same. Numbers may be written as TOML
//! numbers or as text; `start` is text or an array of two numbers.

use toml::de::{DeTable, DeValue};

use crate::settings::Settings;

/// Reads a machine file into `settings`; returns every error, as `NAME:LINE: message`.
pub fn read(name: &str, text: &str, settings: &mut Settings) -> Vec<String> {
    match DeTable::parse(text) {
        Ok(table) => {
            let mut errors = Vec::new();
            walk("", table.get_ref(), &mut |key, value, at| {
                if let Err(error) = settings.set(key, value) {
                    let line = text.get(..at).unwrap_or_default().matches('\n').count() + 1;
                    errors.push(format!("error: {name}:{line}: {key} = {value}: {error}"));
                }
            });
            errors
        }
        Err(error) => vec![format!("error: {name}: {error}")],
    }
}

fn walk(prefix: &str, table: &DeTable<'_>, set: &mut impl FnMut(&str, &str, usize)) {
    for (key, value) in table {
        let full = if prefix.is_empty() { key.get_ref().to_string() } else { format!("{prefix}.{}", key.get_ref()) };
        let at = key.span().start;
        match value.get_ref() {
            DeValue::Table(inner) => walk(&full, inner, set),
            DeValue::String(text) => set(&full, text, at),
            DeValue::Integer(number) => set(&full, number.as_str(), at),
            DeValue::Float(number) => set(&full, number.as_str(), at),
            DeValue::Boolean(on) => set(&full, if *on { "true" } else { "false" }, at),
            DeValue::Array(parts) => {
                let texts: Vec<String> = parts
                    .iter()
                    .map(|part| match part.get_ref() {
                        DeValue::Integer(number) => number.as_str().to_owned(),
                        DeValue::Float(number) => number.as_str().to_owned(),
                        _ => "?".to_owned(),
                    })
                    .collect();
                set(&full, &texts.join(","), at);
            }
            DeValue::Datetime(date) => set(&full, &date.to_string(), at),
        }
    }
}
