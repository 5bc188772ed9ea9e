//! Whole lines and programs.

extern crate std;

mod good;
mod nc1973;
mod refused;
mod threads;

use super::*;
use interp_core::units::{Axis, Feedrate, Length, Point, Sense};
use std::format;
use std::string::{String, ToString};
use std::vec::Vec;

type Found = (u32, u32, u32, DiagnosticKind);

fn per_minute(mm: u64) -> Feedrate {
    Feedrate::from_nm_per_min(mm * 1_000_000).unwrap()
}

fn settings() -> Settings {
    Settings::new(per_minute(2_000), per_minute(5_000))
}

/// Point from micrometres.
fn at(x: i32, z: i32) -> Point {
    Point { x: Length::from_um(x).unwrap(), z: Length::from_um(z).unwrap() }
}

fn centre(x: i64, z: i64) -> Centre {
    Centre { x: Distance::from_nm(x * 1_000), z: Distance::from_nm(z * 1_000) }
}

fn word(text: &str) -> Word {
    let letter = text.chars().next().unwrap();
    Word { letter, number: Number::parse(&text.as_bytes()[1..]).unwrap() }
}

fn run_with(settings: Settings, format: Format, program: &str) -> (Vec<Action>, Vec<Found>) {
    let (mut actions, mut found) = (Vec::new(), Vec::new());
    let mut report = |d: Diagnostic| {
        assert!(!d.to_string().is_empty() && !d.remedy().to_string().is_empty());
        found.push((d.line, d.column, d.length, d.kind));
    };
    let mut interpreter = Interpreter::new(settings, format);
    for line in program.lines() {
        interpreter.line(line.as_bytes(), &mut |item: Item| actions.push(item.action), &mut report);
    }
    interpreter.finish(&mut report);
    (actions, found)
}

/// Actions of a G-code program that must be good.
fn actions(program: &str) -> Vec<Action> {
    let (actions, found) = run_with(settings(), Format::Gcode, &format!("{program}\nM30"));
    assert_eq!(found, []);
    actions[..actions.len() - 1].to_vec()
}

/// Findings of a G-code program that is refused; its last line is the only bad one.
fn found(program: &str) -> Vec<Found> {
    let (_, found) = run_with(settings(), Format::Gcode, &format!("{program}\nM30"));
    let last = u32::try_from(program.lines().count()).unwrap();
    assert!(!found.is_empty() && found.iter().all(|found| found.0 == last), "{found:?}");
    found
}

/// The one finding of the last line: column, length, kind.
fn one(program: &str) -> (u32, u32, DiagnosticKind) {
    let found = found(program);
    assert_eq!(found.len(), 1, "{found:?}");
    (found[0].1, found[0].2, found[0].3)
}

fn ends(program: &str) -> Vec<Point> {
    let end = |action| match action {
        Action::Line { end, .. } | Action::Arc { end, .. } => Some(end),
        _ => None,
    };
    actions(program).into_iter().filter_map(end).collect()
}

fn arc(program: &str) -> (Point, Centre, Sense) {
    match actions(program).pop() {
        Some(Action::Arc { end, centre, sense, .. }) => (end, centre, sense),
        other => panic!("{other:?}"),
    }
}
