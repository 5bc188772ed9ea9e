//! Trains of small programs, event by event, as a person reviewed them. `UPDATE_GOLDEN=1` rewrites them.
//!
//! A line is a tick; an event is its start in clocks, then what changes: X+ X- Z+ Z- for a pulse, x z for its end,
//! d for a direction alone, and a dot where nothing does.
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

use host_tests::train;
use std::fmt::Write;
use std::path::Path;

fn show(train: &[Vec<u32>]) -> String {
    let mut text = String::new();
    let mut before = 0_u32;
    for (tick, events) in train.iter().enumerate() {
        write!(text, "{tick:>3}:").unwrap();
        let mut clock = 0;
        for event in events {
            let levels = event >> 16;
            let (rise, fall) = (levels & !before, before & !levels);
            let mut what = String::new();
            for (axis, step, plus) in [("X", 1, 2), ("Z", 4, 8)] {
                if rise & step != 0 {
                    write!(what, "{axis}{}", if levels & plus != 0 { '+' } else { '-' }).unwrap();
                }
                if fall & step != 0 {
                    what.push_str(&axis.to_lowercase());
                }
            }
            if what.is_empty() {
                what.push(if (rise | fall) & 0b1010 != 0 { 'd' } else { '.' });
            }
            write!(text, " {clock}{what}").unwrap();
            before = levels;
            clock += event & 0xFFFF;
        }
        assert_eq!(clock, 12_000, "tick {tick}");
        text.push('\n');
    }
    text
}

fn compare(name: &str, program: &str, set: &[(&str, &str)]) {
    let found = format!("{}\n\n{}", program.trim(), show(&train(program, set, &[])));
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden").join(name);
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&path, &found).unwrap();
    }
    let expected = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(found == expected, "{name} differs from its golden; UPDATE_GOLDEN=1 rewrites it\n{found}");
}

#[test]
fn a_line_four_to_three_and_back() {
    compare("line.txt", "G1 X0.015 Z0.04 F240\nX0 Z0\nM30\n", &[("x.pulse_nm", "2500"), ("z.pulse_nm", "5000")]);
}

#[test]
fn a_full_circle_of_four_pulses() {
    compare("circle.txt", "G2 X0 Z0 I0.02 K0 F120\nM30\n", &[("x.pulse_nm", "5000"), ("z.pulse_nm", "5000")]);
}

#[test]
fn a_dwell_between_two_moves() {
    compare("dwell.txt", "G1 Z0.0125 F300\nG4 P0.003\nG1 Z0\nM30\n", &[]);
}
