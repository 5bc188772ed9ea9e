//! Programs and machines at random, for property tests.

use proptest::prelude::*;
use std::fmt::Write;

/// How many cases: so many, or what HANDCNC_CASES says for a long run.
pub fn cases(bounded: u32) -> u32 {
    std::env::var("HANDCNC_CASES").ok().and_then(|text| text.parse().ok()).unwrap_or(bounded)
}

/// A piece of a program, in mm relative to where the tool is.
#[derive(Clone, Debug)]
pub enum Piece {
    /// Straight by (X, Z), as fast as may be.
    Rapid(f64, f64),
    /// Straight by (X, Z).
    Line(f64, f64),
    /// Centre, sweep in radians (negative is clockwise).
    Arc(f64, f64, f64),
    /// A smooth run of short lines: step, turn a step, how many.
    Run(f64, f64, u32),
    /// mm/min from now on.
    Feed(f64),
    /// A short stand.
    Dwell,
}

/// Some pieces, each leading at most `reach` far.
pub fn pieces(reach: f64) -> impl Strategy<Value = Vec<Piece>> {
    let far = -reach..reach;
    let near = -0.05..0.05_f64;
    let piece = prop_oneof![
        2 => (far.clone(), far.clone()).prop_map(|(x, z)| Piece::Rapid(x, z)),
        3 => (far.clone(), far.clone()).prop_map(|(x, z)| Piece::Line(x, z)),
        3 => (near.clone(), near).prop_map(|(x, z)| Piece::Line(x, z)),
        3 => (far.clone(), far.clone(), -6.2..6.2_f64).prop_map(|(x, z, s)| Piece::Arc(x, z, s)),
        2 => (-0.3..0.3_f64, -0.3..0.3_f64, -6.2..6.2_f64).prop_map(|(x, z, s)| Piece::Arc(x, z, s)),
        2 => (0.02..1.0_f64, -0.1..0.1_f64, 5..60_u32).prop_map(|(s, t, n)| Piece::Run(s, t, n)),
        2 => (1.0_f64..12.0).prop_map(|log| Piece::Feed(log.exp2())),
        1 => Just(Piece::Dwell),
    ];
    prop::collection::vec(piece, 1..14)
}

/// Program text of some pieces, absolute, in tenths of a micrometre so that no rounding hides.
///
/// # Panics
/// Never: a string takes all that is written.
pub fn program(pieces: &[Piece], least_feed: f64) -> String {
    let mut text = String::from("G18 G21 G90 G94 F600\n");
    let (mut x, mut z, mut feed) = (0.0_f64, 0.0_f64, 600.0_f64);
    let grid = |v: f64| (v * 1e4).round() / 1e4;
    for piece in pieces {
        match piece {
            Piece::Rapid(dx, dz) => {
                (x, z) = (grid(x + dx), grid(z + dz));
                writeln!(text, "G0 X{x:.4} Z{z:.4}").unwrap();
            }
            Piece::Line(dx, dz) => {
                (x, z) = (grid(x + dx), grid(z + dz));
                writeln!(text, "G1 X{x:.4} Z{z:.4}").unwrap();
            }
            Piece::Arc(i, k, sweep) => {
                let (i, k) = (grid(*i), grid(*k));
                if i.hypot(k) < 0.002 || sweep.abs() < 0.01 {
                    continue;
                }
                let (cx, cz) = (x + i, z + k);
                let from = (x - cx).atan2(z - cz);
                let radius = i.hypot(k);
                (x, z) = (grid(cx + radius * (from + sweep).sin()), grid(cz + radius * (from + sweep).cos()));
                let code = if *sweep > 0.0 { 3 } else { 2 };
                writeln!(text, "G{code} X{x:.4} Z{z:.4} I{i:.4} K{k:.4}").unwrap();
            }
            Piece::Run(step, turn, count) => {
                let mut heading = feed.sin() * 3.0;
                for _ in 0..*count {
                    heading += turn;
                    (x, z) = (grid(x + step * heading.sin()), grid(z + step * heading.cos()));
                    writeln!(text, "G1 X{x:.4} Z{z:.4}").unwrap();
                }
            }
            Piece::Feed(value) => {
                feed = value.max(least_feed).min(5000.0);
                writeln!(text, "F{feed:.1}").unwrap();
            }
            Piece::Dwell => text.push_str("G4 P0.03\n"),
        }
    }
    text.push_str("M30\n");
    text
}

/// Machines with fractional and unequal pulses, unequal limits, other overrides.
pub fn machine() -> impl Strategy<Value = Vec<(&'static str, &'static str)>> {
    prop_oneof![
        Just(vec![]),
        Just(vec![("x.pulse_nm", "1984.375"), ("z.pulse_nm", "15875/8")]),
        Just(vec![("x.pulse_nm", "5000"), ("z.pulse_nm", "10000")]),
        Just(vec![("x.pulse_nm", "10000/3"), ("z.pulse_nm", "12700/7"), ("x.max_accel", "1500")]),
        Just(vec![("x.max_feed", "2000"), ("z.max_jump", "8"), ("feed_override", "150")]),
        Just(vec![("x.max_accel", "90"), ("z.max_accel", "2000"), ("x.max_jump", "0.5"), ("feed_override", "70")]),
    ]
}
