//! The book's table of what is asked of the background, and of what is pushed, in each mode: as the virtual lathe does it.
#![allow(clippy::unwrap_used, reason = "tests, and helpers of tests, which may panic")]

use handcnc::foreground::mode::Mode;
use serde_json::Value;
use std::fmt::Write;
use virtual_lathe::operate::{self, Job};

/// The state at the end of a script.
fn state(script: &str) -> Value {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("p.nc"), "G1 X5 F300\nX10\nM2\n").unwrap();
    let scenario = folder.path().join("s.txt");
    std::fs::write(&scenario, script).unwrap();
    operate::perform(&Job { scenario, ..Job::default() }, None).unwrap().state
}

/// Led into a mode at rest, to retrace by way of a program that is held.
fn into(mode: Mode) -> String {
    let first = "0 feed-rate 300 mm/min\n0 taper 2 -8\n0 scale 100\n";
    match mode {
        Mode::Retrace => {
            format!(
                "{first}0 load p.nc\n0 mode auto\n0.1 start\n1 hold\n1.5 mode retrace\n1.6 expect mode == retrace\n"
            )
        }
        _ => format!("{first}1.5 mode {}\n", mode.name()),
    }
}

/// What a mode makes of something: the name of its refusal, else `yes`.
fn asked(mode: Mode, what: &str) -> String {
    let state = state(&format!("{}2 {what}\n2.5 end\n", into(mode)));
    let names = state.get("refusals").and_then(Value::as_array).unwrap();
    names.last().and_then(Value::as_str).unwrap_or("yes").to_owned()
}

/// Whether the joystick moves anything in a mode.
fn pushed(mode: Mode, way: &str) -> String {
    let place = |script: &str| state(script).get("position").unwrap().clone();
    let stood = place(&format!("{}2.5 end\n", into(mode)));
    let moved = place(&format!("{}2 joystick {way}\n2.5 end\n", into(mode))) != stood;
    if moved { "yes" } else { "nothing" }.to_owned()
}

#[test]
fn the_book_has_the_table_of_the_background_and_the_joystick() {
    let rows: [(&str, &dyn Fn(Mode) -> String); 4] = [
        ("load", &|mode| asked(mode, "load p.nc")),
        ("mdi", &|mode| asked(mode, "mdi G4 P1")),
        ("joystick along X or Z", &|mode| pushed(mode, "z+")),
        ("joystick along the contour", &|mode| pushed(mode, "path+")),
    ];
    let names: Vec<&str> = Mode::ALL.into_iter().map(Mode::name).collect();
    let mut table = String::new();
    writeln!(table, "| asked or pushed at rest | {} |\n|---|{}", names.join(" | "), "---|".repeat(names.len()))
        .unwrap();
    for (name, cell) in rows {
        writeln!(table, "| {name} | {} |", Mode::ALL.map(cell).join(" | ")).unwrap();
    }
    let book = include_str!("../../docs/src/modes.md");
    assert!(book.contains(&table), "the book lacks this table:\n{table}");
}
