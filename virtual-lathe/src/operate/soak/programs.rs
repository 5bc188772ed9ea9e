//! Programs at random: text in absolute mm, whose last X and Z are where it ends.

use std::fmt::Write as _;

use super::chance::Chance;

/// What a program may contain.
#[derive(Copy, Clone, Debug)]
pub(super) struct Taste {
    /// How far from zero, mm.
    pub(super) reach: f64,
    /// Threads, and feeds a turn.
    pub(super) spindle: bool,
    /// Stops, dwells and outputs.
    pub(super) stops: bool,
}

/// To the tenth of a micrometre, so that no rounding of the text hides.
fn grid(value: f64) -> f64 {
    (value * 1e4).round() / 1e4 + 0.0
}

/// A program.
pub(super) fn program(chance: &mut Chance, taste: Taste) -> String {
    let mut text = String::from("G18 G21 G90 G94\n");
    let at = |chance: &mut Chance| grid(chance.real(-taste.reach, taste.reach));
    let (mut x, mut z) = (at(chance), at(chance));
    let _ = writeln!(text, "G0 X{x:.4} Z{z:.4}\nF{:.1}", chance.spread(30.0, 3_000.0));
    let mut per_turn = false;
    if taste.spindle {
        let _ = writeln!(text, "S{:.0} {}\nG4 P2", chance.spread(60.0, 1_500.0), chance.one_of(&["M3", "M3", "M4"]));
    }
    for _ in 0..chance.whole(2, 24) {
        match chance.whole(0, 19) {
            0..=1 => {
                (x, z) = (at(chance), at(chance));
                let _ = writeln!(text, "G0 X{x:.4} Z{z:.4}");
            }
            2..=6 => {
                let by = chance.spread(0.002, taste.reach);
                let heading = chance.real(0.0, std::f64::consts::TAU);
                (x, z) = (grid(x + by * heading.sin()), grid(z + by * heading.cos()));
                let _ = writeln!(text, "G1 X{x:.4} Z{z:.4}");
            }
            7..=10 => {
                let (i, k) = (grid(chance.real(-1.0, 1.0) * taste.reach), grid(chance.real(-1.0, 1.0) * taste.reach));
                (x, z) = arc(chance, (x, z), (i, k), &mut text);
            }
            11..=12 => {
                let (step, turn) = (chance.spread(0.005, 0.6), chance.real(-0.1, 0.1));
                let mut heading = chance.real(0.0, std::f64::consts::TAU);
                for _ in 0..chance.whole(5, 60) {
                    heading += turn;
                    (x, z) = (grid(x + step * heading.sin()), grid(z + step * heading.cos()));
                    let _ = writeln!(text, "G1 X{x:.4} Z{z:.4}");
                }
            }
            13..=14 if !per_turn => {
                let _ = writeln!(text, "F{:.1}", chance.spread(10.0, 5_000.0));
            }
            15 if taste.stops => {
                let _ = writeln!(text, "G4 P{:.2}", chance.spread(0.01, 1.0));
            }
            16 if taste.stops => {
                text.push_str(chance.one_of(&["M0\n", "M1\n", "M1\n", "M8\n"]));
            }
            17 if taste.spindle => {
                let by = grid(chance.spread(2.0, 20.0)) * chance.one_of(&[1.0, -1.0]);
                let (lead, taper) = (chance.spread(0.1, 3.0), chance.one_of(&[0.0, 0.0, 0.05]));
                (x, z) = (grid(x + by * taper), grid(z + by));
                let _ = writeln!(text, "G33 X{x:.4} Z{z:.4} K{lead:.3}");
                // a pass that is cut, drawn back and gone back over
                let (out, back) = (grid(x + chance.one_of(&[2.0, -2.0])), grid(z - by));
                let _ = writeln!(text, "G0 X{out:.4}\nG0 Z{back:.4}");
                (x, z) = (out, back);
            }
            18 if taste.spindle => {
                per_turn = !per_turn;
                let _ = match per_turn {
                    true => writeln!(text, "G95 F{:.3}", chance.spread(0.02, 1.0)),
                    false => writeln!(text, "G94 F{:.1}", chance.spread(30.0, 1_000.0)),
                };
            }
            19 if taste.stops => {
                let _ = writeln!(text, "/G1 X{x:.4} Z{z:.4}");
            }
            _ => {}
        }
    }
    let _ = writeln!(text, "G1 X{x:.4} Z{z:.4}\nM30");
    text
}

/// An arc about a centre relative to the start; where it ends.
fn arc(chance: &mut Chance, (x, z): (f64, f64), (i, k): (f64, f64), text: &mut String) -> (f64, f64) {
    let (radius, sweep) = (i.hypot(k), chance.real(-6.2, 6.2));
    if radius < 0.01 || sweep.abs() < 0.02 {
        return (x, z);
    }
    let (cx, cz) = (x + i, z + k);
    let from = (x - cx).atan2(z - cz);
    let to = (grid(cx + radius * (from + sweep).sin()), grid(cz + radius * (from + sweep).cos()));
    let code = if sweep > 0.0 { 3 } else { 2 };
    let _ = writeln!(text, "G{code} X{:.4} Z{:.4} I{i:.4} K{k:.4}", to.0, to.1);
    to
}

/// Where a program of absolute places in mm ends: its last X and Z, in nm. Read from the text by itself, as an oracle for
/// what the compiler makes of it. `None` where it has none.
pub(super) fn end(text: &str) -> Option<(i64, i64)> {
    let last = |letter: char| {
        text.lines().filter(|line| !line.starts_with('/')).flat_map(str::split_whitespace).rev().find_map(|word| {
            let number = word.strip_prefix(letter)?;
            crate::operate::number::scaled(number, 6)
        })
    };
    Some((last('X')?, last('Z')?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_ends_at_its_last_words() {
        assert_eq!(end("G0 X1 Z2\nG1 X-0.5\n/G1 X7\nM30\n"), Some((-500_000, 2_000_000)));
        assert_eq!(end("M30\n"), None);
    }
}
