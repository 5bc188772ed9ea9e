//! Properties of program text: garbage is refused and never panics, good programs are read, decimals are exact.
#![allow(clippy::expect_used, clippy::unwrap_used, clippy::panic, reason = "a test")]

use feature_editor::codes::{
    Action, Detector, Diagnostic, Distance, Format, Interpreter, Item, Number, Settings, Severity,
};
use interp_core::units::{Feedrate, Point};
use proptest::prelude::*;

fn settings() -> Settings {
    let feed = Feedrate::from_nm_per_min(5_000_000_000).expect("5 m/min");
    Settings { tape_feeds: [Some(feed); 9], ..Settings::new(feed, feed) }
}

fn run<'a>(format: Format, lines: impl IntoIterator<Item = &'a [u8]>) -> (Vec<Item>, Vec<Diagnostic>) {
    let (mut items, mut found) = (Vec::new(), Vec::new());
    let mut interpreter = Interpreter::new(settings(), format);
    for line in lines {
        interpreter.line(line, &mut |item| items.push(item), &mut |diagnostic| found.push(diagnostic));
    }
    interpreter.finish(&mut |diagnostic| found.push(diagnostic));
    (items, found)
}

/// Errors of a run, as texts.
fn errors(found: &[Diagnostic]) -> Vec<String> {
    let errors = found.iter().filter(|found| found.severity() == Severity::Error);
    errors.map(|found| format!("{}:{} {found}; {}", found.line, found.column, found.remedy())).collect()
}

/// Text that looks like a program more often than random bytes do.
fn likely_line() -> impl Strategy<Value = String> {
    let number = prop_oneof![
        (0..100_u32).prop_map(|n| n.to_string()),
        (-99_999..99_999_i32).prop_map(|n| format!("{}", f64::from(n) / 1000.0)),
        "[-+.0-9]{0,6}",
    ];
    let word = ("[GMGXZUWIKRPFSTNOYJ%/(); a-z]", number).prop_map(|(letter, number)| letter + &number);
    proptest::collection::vec(word, 0..9).prop_map(|words| words.join(" "))
}

/// Motions from the origin that stay near it, as (text, X and Z in micrometres).
fn good_block() -> impl Strategy<Value = (String, i64, i64)> {
    let um = -900_000..900_000_i64;
    (0..5_u8, um.clone(), um, 1..5_000_u32).prop_map(|(which, x, z, feed)| {
        let (dx, dz) = (decimal(x), decimal(z));
        let text = match which {
            0 => format!("G0X{dx}Z{dz}"),
            1 => format!("g1 x {dx} z {dz} f{feed}"),
            2 => format!("G2 X{dx} Z{dz} R4000 F{feed} (arc)"),
            3 => format!("N{feed} G3 Z{dz} R-4000 X{dx} F{feed} ; the larger arc"),
            _ => format!("G90 G20 G21 X{dx} Z{dz} G1 F{feed} S{feed} M3 T0101 M1").replace("G20 ", ""),
        };
        (text, x, z)
    })
}

/// Micrometres as millimetres.
fn decimal(um: i64) -> String {
    let sign = if um < 0 { "-" } else { "" };
    format!("{sign}{}.{:03}", um.abs() / 1000, um.abs() % 1000)
}

fn micrometres(point: Point) -> (i64, i64) {
    (i64::from(point.x.nm()) / 1000, i64::from(point.z.nm()) / 1000)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn a_line_is_refused_or_executed_and_nothing_panics(
        lines in proptest::collection::vec(prop_oneof![
            proptest::collection::vec(any::<u8>(), 0..300),
            likely_line().prop_map(String::into_bytes),
        ], 0..20),
        is_gcode in any::<bool>(),
    ) {
        let format = if is_gcode { Format::Gcode } else { Format::Nc1973 };
        let (items, found) = run(format, lines.iter().map(Vec::as_slice));
        for item in &items {
            prop_assert!(found.iter().all(|found| found.line != item.line || found.severity() == Severity::Warning));
        }
        for found in &found {
            prop_assert!(!found.to_string().is_empty() && !found.remedy().to_string().is_empty());
            prop_assert!(found.column >= 1 && (1..=lines.len().max(1)).contains(&(found.line as usize)));
            if let Some(line) = lines.get(found.line as usize - 1) {
                prop_assert!((found.column - 1 + found.length) as usize <= line.len().max(1));
            }
        }
        let mut detector = Detector::new();
        lines.iter().for_each(|line| detector.line(line));
        let _ = detector.format();
    }

    #[test]
    fn good_programs_are_read_whole(blocks in proptest::collection::vec(good_block(), 1..20)) {
        let text: Vec<_> = blocks.iter().map(|(text, ..)| text.as_str()).chain(["M30"]).collect();
        let mut last = (0, 0);
        let blocks: Vec<_> = blocks.iter().filter(|&&(ref text, x, z)| {
            // an arc to where the tool is has no centre by R
            let is_new = (x, z) != last || !text.contains('R');
            last = (x, z);
            is_new
        }).collect();
        prop_assume!(blocks.len() + 1 == text.len());
        let (items, found) = run(Format::Gcode, text.iter().map(|text| text.as_bytes()));
        prop_assert_eq!(errors(&found), Vec::<String>::new());
        let ends: Vec<_> = items.iter().filter_map(|item| match item.action {
            Action::Line { end, .. } | Action::Arc { end, .. } => Some(micrometres(end)),
            _ => None,
        }).collect();
        prop_assert_eq!(ends, blocks.iter().map(|&&(_, x, z)| (x, z)).collect::<Vec<_>>());
        prop_assert_eq!(items.last().map(|item| item.action), Some(Action::End));
    }

    #[test]
    fn a_radius_and_its_centre_are_one_arc(
        (x, z) in (-900_000_000..900_000_000_i64, -900_000_000..900_000_000_i64),
        radius in 1_300_000_000..4_200_000_000_i64,
        (is_clockwise, is_large) in any::<(bool, bool)>(),
    ) {
        prop_assume!((x, z) != (0, 0));
        let (g, sign) = (if is_clockwise { 2 } else { 3 }, if is_large { "-" } else { "" });
        let (end_x, end_z) = (Distance::from_nm(x), Distance::from_nm(z));
        let by_radius = format!("G{g} X{end_x} Z{end_z} R{sign}{} F100", Distance::from_nm(radius));
        let (items, found) = run(Format::Gcode, [by_radius.as_bytes(), b"M2"]);
        prop_assert_eq!(errors(&found), Vec::<String>::new());
        let Action::Arc { centre, .. } = items[0].action else { panic!("no arc") };
        let (cx, cz) = (i128::from(centre.x.nm()), i128::from(centre.z.nm()));
        let squared = |x: i128, z: i128| x * x + z * z;
        let expected = squared(i128::from(radius), 0);
        // one nanometre of radius is two radii of its square
        prop_assert!((squared(cx, cz) - expected).abs() <= 2 * i128::from(radius));
        prop_assert!((squared(cx - i128::from(x), cz - i128::from(z)) - expected).abs() <= 2 * i128::from(radius));
        // Z to the right, X upward: the centre of the smaller clockwise arc is to the right of the chord
        let cross = i128::from(z) * cx - i128::from(x) * cz;
        prop_assert_eq!(cross < 0, is_clockwise != is_large);

        let by_centre = format!("G{g} X{end_x} Z{end_z} I{} K{} F100", centre.x, centre.z);
        prop_assert_eq!(run(Format::Gcode, [by_centre.as_bytes(), b"M2"]).0, items);
    }

    #[test]
    fn a_shown_distance_reads_back(nm in any::<i64>()) {
        let text = Distance::from_nm(nm).to_string();
        match Number::parse(text.as_bytes()) {
            Ok(number) => {
                prop_assert_eq!(number.scaled(1_000_000), Some(nm));
                prop_assert_eq!(number.to_string(), text);
            }
            Err(_) => prop_assert!(nm.unsigned_abs() >= 1_000_000_000_000_000_000),
        }
    }

    #[test]
    fn a_number_shows_as_written(text in "[-+]?[0-9]{1,9}(\\.[0-9]{0,9})?") {
        prop_assert_eq!(Number::parse(text.as_bytes()).unwrap().to_string(), text);
    }
}
