//! Whatever is given as a program is refused with a message or runs; nothing crashes, and nothing of a refused
//! program runs.
#![allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, missing_docs, reason = "tests")]

use std::fmt::Write;

use feature_editor::codes::Format;
use host_tests::{optimum, parameters};
use indicatif::ProgressBar;
use proptest::prelude::*;
use virtual_lathe::insets::Chooser;
use virtual_lathe::lathe::{self, FINDINGS_KEPT};
use virtual_lathe::messages;
use virtual_lathe::program::Program;
use virtual_lathe::watch::Watch;

/// Programs that take longer on the machine are checked only.
const LONGEST_S: f64 = 20.0;

/// Whether a text was refused; a good one is run and must be measured without a fault, unless it takes too long.
fn refused(bytes: &[u8], format: Option<Format>, set: &[(&str, &str)]) -> Result<bool, TestCaseError> {
    let parameters = parameters(set);
    let machine = parameters.machine().unwrap();
    let program = Program::Text { name: "bytes".into(), text: bytes.to_vec() };
    let format = format.unwrap_or(program.detect().unwrap());
    let mut items = Vec::new();
    let mut chooser = Chooser::new(parameters.start());
    let mut look = |item: &feature_editor::codes::Item| {
        chooser.action(item);
        items.push(*item);
    };
    let checked = lathe::check(&program, format, &parameters, &machine, &mut look, &mut |_| {}).unwrap();
    prop_assert!(checked.findings.len() <= 2 * FINDINGS_KEPT);
    for (finding, line) in &checked.findings {
        let message = messages::finding("bytes", finding, line);
        prop_assert!(message.contains(&format!("bytes:{}:", finding.line())), "{}", message);
        prop_assert!(finding.line() >= 1 && u64::from(finding.line()) <= checked.lines.max(1), "{}", message);
        prop_assert!(!message.contains(|c: char| c.is_control() && c != '\n'), "{:?}", message);
        if finding.is_error() {
            prop_assert!(message.starts_with("error: ") && message.contains("\n   = "), "{}", message);
        }
    }
    if checked.errors > 0 {
        return Ok(true);
    }
    if optimum::seconds(&items, &parameters) < LONGEST_S {
        let mut watch = Watch::new(&parameters, &machine, chooser, None, ProgressBar::hidden()).unwrap();
        lathe::run(&program, format, &parameters, &machine, &[], &mut watch).unwrap();
        let report = watch.finish().report;
        let text = String::from_utf8_lossy(bytes);
        prop_assert_eq!(report.faults.total(), 0, "{:?}\n{:?}\n{}", report.faults.first(), set, text);
        prop_assert!(report.walked.pulses <= 0.5 + 1e-6, "{:?} {:?}\n{}", report.walked, set, text);
    }
    Ok(false)
}

/// Words, nearly words, and what stands between them.
fn soup() -> impl Strategy<Value = Vec<u8>> {
    let number = prop_oneof![
        4 => (-9.0..9.0_f64, 0_usize..5).prop_map(|(value, places)| format!("{value:.places$}")),
        2 => (0_u32..110).prop_map(|value| value.to_string()),
        1 => prop::sample::select(vec![
            "", "-", "+", ".", "-.", "-0", "0.", ".5", "+1", "--1", "1.2.3", "1e3", "2100", "-2100.0001", "4294967296",
            "9223372036854775807", "999999999999999999", "9999999999999999999", "0.000000000000000001",
        ])
        .prop_map(String::from),
    ];
    let word = prop_oneof![
        6 => ("[GXZUWIKRF]", number.clone()).prop_map(|(letter, number)| format!("{letter}{number}")),
        3 => prop::sample::select(vec![
            "G0", "G1", "G2", "G3", "G90", "G91", "G7", "G8", "G20", "G21", "G18", "G94", "F600", "F3000", "M3", "M0",
            "G4 P0.01", "M30", "G01", "G02", "X+100", "Y0", "I0 J200",
        ])
        .prop_map(String::from),
        2 => ("[A-Za-z]", number).prop_map(|(letter, number)| format!("{letter}{number}")),
        1 => prop::sample::select(vec!["(a)", "(", ")", ";", "%", "/", "\t", "\r", "\u{e4}", "\u{feff}", "(\u{202e})"])
            .prop_map(String::from),
    ];
    let separator = prop_oneof![4 => Just(" "), 2 => Just("\n"), 1 => Just("")];
    prop::collection::vec((word, separator), 0..60).prop_map(|words| {
        let text: String = words.into_iter().flat_map(|(word, separator)| [word, separator.to_owned()]).collect();
        text.into_bytes()
    })
}

/// A motion: relative end, and for arcs the radius over half the chord, the sense, and whether it is the long way.
type Motion = (u8, f64, f64, f64, bool, bool);

fn motions() -> impl Strategy<Value = Vec<Motion>> {
    let size = prop_oneof![0.002..0.02_f64, 0.05..0.5_f64, 1.0..6.0_f64];
    let part = (size, any::<bool>()).prop_map(|(size, minus)| if minus { -size } else { size });
    prop::collection::vec((0_u8..8, part.clone(), part, 1.01..3.0_f64, any::<bool>(), any::<bool>()), 1..16)
}

/// A valid program.
fn program(motions: &[Motion], feed: u32) -> String {
    let mut text = format!("%\n(random)\nG21 G90 G8\nF{feed}\n");
    let (mut x, mut z) = (0.0_f64, 0.0_f64);
    for (number, (kind, dx, dz, bulge, clockwise, long)) in motions.iter().enumerate() {
        (x, z) = (((x + dx) * 1e4).round() / 1e4, ((z + dz) * 1e4).round() / 1e4);
        write!(text, "N{number} ").unwrap();
        let sense = if *clockwise { 2 } else { 3 };
        match kind {
            0 => writeln!(text, "G0 X{x:.4} Z{z:.4}").unwrap(),
            1 | 2 => writeln!(text, "G1 X{x:.4} Z{z:.4}").unwrap(),
            3 => writeln!(text, "G91 G1 X{dx:.4} W{dz:.4}\nG90 G1 X{x:.4} Z{z:.4}").unwrap(),
            4 => writeln!(text, "G4 P0.02\nG7 G1 X{:.4} Z{z:.4}\nG8", 2.0 * x).unwrap(),
            5 => writeln!(text, "G1 X{x:.4} Z{z:.4}\nG{sense} X{x:.4} Z{z:.4} I{dx:.4} K{dz:.4}").unwrap(),
            _ => {
                let radius = dx.hypot(*dz) / 2.0 * bulge + 0.001;
                let sign = if *long { "-" } else { "" };
                writeln!(text, "G{sense} X{x:.4} Z{z:.4} R{sign}{radius:.4}").unwrap();
            }
        }
    }
    text.push_str("M30\n%\n");
    text
}

fn cases(bounded: u32) -> ProptestConfig {
    let cases = std::env::var("HANDCNC_CASES").ok().and_then(|text| text.parse().ok()).unwrap_or(bounded);
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn random_bytes_are_refused_or_run(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
        refused(&bytes, None, &[])?;
        refused(&bytes, Some(Format::Nc1973), &[])?;
    }

    #[test]
    fn random_words_are_refused_or_run(text in soup()) {
        refused(&text, None, &[])?;
        refused(&text, Some(Format::Gcode), &[])?;
        refused(&text, Some(Format::Nc1973), &[("f1", "600")])?;
    }
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn valid_programs_run(motions in motions(), feed in 60_u32..3_000) {
        prop_assert!(!refused(program(&motions, feed).as_bytes(), None, &[])?);
    }

    #[test]
    fn damaged_programs_are_refused_or_run(
        motions in motions(),
        damage in prop::collection::vec((any::<prop::sample::Index>(), 0_u8..3, any::<u8>()), 1..4),
    ) {
        let mut bytes = program(&motions, 900).into_bytes();
        for (at, kind, byte) in damage {
            let at = at.index(bytes.len());
            match kind {
                0 => bytes[at] = byte,
                1 => bytes.insert(at, byte),
                _ => drop(bytes.remove(at)),
            }
        }
        refused(&bytes, None, &[])?;
    }

    #[test]
    fn shortened_programs_are_refused_or_run(motions in motions(), at in any::<prop::sample::Index>()) {
        let text = program(&motions, 900);
        refused(&text.as_bytes()[..at.index(text.len())], None, &[])?;
    }
}
