//! Each refusal with its place.

use super::*;
use DiagnosticKind as K;

#[test]
fn text() {
    let long = format!("X1{}", " ".repeat(255));
    assert_eq!(one(&long), (1, 257, K::LineTooLong { bytes: 257 }));
    assert_eq!(actions(&format!("M0{}", " ".repeat(254))), [Action::Stop]);
    assert_eq!(one("M0 é\u{7}M3é"), (4, 2, K::Byte(0xc3)));
    assert_eq!(one("M0 #"), (4, 1, K::Character('#')));
    assert_eq!(one("M0 )"), (4, 1, K::Character(')')));
    assert_eq!(one("M0 %"), (4, 1, K::Character('%')));
    assert_eq!(one("M0 (a"), (4, 2, K::CommentOpen));
    assert_eq!(one("% X1"), (3, 2, K::TextAfterPercent));
    assert_eq!(one("G0 X1 0"), (7, 1, K::NumberAlone));
    assert_eq!(one("G0 X"), (4, 1, K::NumberMissing('X')));
    assert_eq!(one("G0 X1.2.3"), (4, 6, K::NumberMalformed('X')));
    assert_eq!(one("G0 Z0.1234567890123456789"), (4, 22, K::NumberTooLong('Z')));
}

#[test]
fn words() {
    let (word_y, word_g) = (word("Y5"), word("G38.2"));
    assert_eq!(one("G0 X1 y5"), (7, 2, K::UnknownLetter { word: word_y, format: Format::Gcode }));
    assert_eq!(one("G38.2 X1"), (1, 5, K::UnknownG { word: word_g, format: Format::Gcode }));
    assert_eq!(one("G17"), (1, 3, K::UnknownG { word: word("G17"), format: Format::Gcode }));
    assert_eq!(one("M06"), (1, 3, K::UnknownM(word("M06"))));
    assert_eq!(one("G0 X1 X02"), (7, 3, K::Repeated { first: word("X1"), second: word("X02") }));
    assert_eq!(one("G0 G01 X1"), (4, 3, K::SameGroup { first: word("G0"), second: word("G01") }));
    assert_eq!(one("M3 M5"), (4, 2, K::SameGroup { first: word("M3"), second: word("M5") }));
    assert_eq!(one("M0 M30"), (4, 3, K::SameGroup { first: word("M0"), second: word("M30") }));
    assert_eq!(one("N123456789 M0"), (1, 10, K::BlockNumber(word("N123456789"))));
    assert_eq!(one("N1 O2"), (4, 2, K::ProgramNumberPlace(word("O2"))));
    assert_eq!(one("T00001"), (1, 6, K::ToolNumber(word("T00001"))));
    assert_eq!(one("T1.5"), (1, 4, K::ToolNumber(word("T1.5"))));
    assert_eq!(one("S-1"), (1, 3, K::SpindleSpeed(word("S-1"))));
    assert_eq!(one("S100000.001"), (1, 11, K::SpindleSpeed(word("S100000.001"))));
}

#[test]
fn feed() {
    for (text, length) in [("F0", 2), ("F-1", 3), ("F0.0000001", 10)] {
        assert_eq!(one(text), (1, length, K::FeedNotPositive(word(text))));
    }
    assert_eq!(one("F0.009"), (1, 6, K::FeedTooLow(word("F0.009"))));
    assert_eq!(actions("F0.01"), []);
    let limits = |text| K::FeedTooHigh { word: word(text), limit_x: per_minute(2_000), limit_z: per_minute(5_000) };
    assert_eq!(one("F5000.1"), (1, 7, limits("F5000.1")));
    assert_eq!(one("F999999999999999999"), (1, 19, limits("F999999999999999999")));
    assert_eq!(actions("F5000"), []);
    assert_eq!(one("Z1 G1 "), (4, 2, K::FeedMissing(word("G1"))));
    assert_eq!(one("G1 Z1 F0"), (7, 2, K::FeedNotPositive(word("F0"))));
}

#[test]
fn dwell() {
    assert_eq!(one("N1 G4"), (4, 2, K::DwellMissing));
    assert_eq!(one("G4 P-1"), (4, 3, K::DwellNegative(word("P-1"))));
    assert_eq!(one("G4 P4294967.296"), (4, 12, K::DwellTooLong(word("P4294967.296"))));
    assert_eq!(one("G0 X1\nG4 P1 X2"), (7, 2, K::DwellWithAxis(word("X2"))));
    assert_eq!(one("G0 X1 P1"), (7, 2, K::DwellWordUnused(word("P1"))));
    let (actions, found) = run_with(settings(), Format::Gcode, "G4 P500\nM2");
    assert_eq!(actions[0], Action::Dwell { ms: 500_000 });
    assert_eq!(found, [(1, 4, 4, K::DwellLong(word("P500")))]);
    assert_eq!(found[0].3.severity(), Severity::Warning);
}

#[test]
fn path_control() {
    assert_eq!(one("G64 P-0.1"), (5, 5, K::ToleranceNegative(word("P-0.1"))));
    assert_eq!(one("G64 P1.000001"), (5, 9, K::ToleranceTooLarge(word("P1.000001"))));
    assert_eq!(one("G20 G64 P0.04"), (9, 5, K::ToleranceTooLarge(word("P0.04"))));
    assert_eq!(one("G64 P999999999999999999"), (5, 19, K::ToleranceTooLarge(word("P999999999999999999"))));
    assert_eq!(one("G64 P"), (5, 1, K::NumberMissing('P')));
    assert_eq!(one("G61 P0.1"), (5, 4, K::ToleranceUnused { word: word("P0.1"), code: word("G61") }));
    assert_eq!(one("P1 G61.1"), (1, 2, K::ToleranceUnused { word: word("P1"), code: word("G61.1") }));
    assert_eq!(one("G4 G64 P1"), (8, 2, K::ToleranceWithDwell(word("P1"))));
    assert_eq!(one("G61 G64"), (5, 3, K::SameGroup { first: word("G61"), second: word("G64") }));
    assert_eq!(one("G61.2"), (1, 5, K::UnknownG { word: word("G61.2"), format: Format::Gcode }));
    assert_eq!(one("G64.1"), (1, 5, K::UnknownG { word: word("G64.1"), format: Format::Gcode }));
    let (_, found) = run_with(settings(), Format::Gcode, "G64\nM2");
    assert_eq!(found, [(1, 1, 3, K::ToleranceMissing(word("G64")))]);
    assert_eq!(found[0].3.severity(), Severity::Warning);
}

#[test]
fn coordinates() {
    assert_eq!(one("G0 X2100.000001"), (4, 12, K::Coordinate { word: word("X2100.000001"), axis: Axis::X }));
    assert_eq!(one("G0 Z-2100\nW-0.000001"), (1, 10, K::Coordinate { word: word("W-0.000001"), axis: Axis::Z }));
    let (absolute, incremental) = (word("Z1"), word("W2"));
    assert_eq!(one("G0 W2 Z1"), (7, 2, K::AbsoluteAndIncremental { absolute, incremental }));
    assert_eq!(one("G1 F5"), (1, 2, K::EndMissing(word("G1"))));
    assert_eq!(one("G2 I5 F5"), (1, 2, K::EndMissing(word("G2"))));
    assert_eq!(one("G0 X5 F5\nG2 X5 K5\nK5"), (1, 2, K::EndMissing(word("K5"))));
    assert_eq!(one("Z1"), (1, 2, K::MotionMissing(word("Z1"))));
    assert_eq!(one("G0 Z1 K5"), (7, 2, K::ArcWordUnused(word("K5"))));
    assert_eq!(one("R5"), (1, 2, K::ArcWordUnused(word("R5"))));
}

#[test]
fn arcs() {
    assert_eq!(one("G2 Z1 F5"), (1, 2, K::CentreMissing));
    assert_eq!(one("G2 Z1 F5 R1 K1"), (10, 2, K::CentreAndRadius { centre: word("K1"), radius: word("R1") }));
    assert_eq!(one("G2 Z0 F5 R1"), (10, 2, K::FullCircleByRadius(word("R1"))));
    assert_eq!(one("G2 Z1 F5 R0"), (10, 2, K::RadiusZero));
    assert_eq!(one("G2 Z0 F5 I0"), (10, 2, K::RadiusZero));
    assert_eq!(one("G2 Z1 F5 I0 K0"), (10, 2, K::RadiusZero));
    assert_eq!(one("G2 Z1 F5 R4200.1"), (10, 7, K::RadiusTooLarge));
    assert_eq!(one("G2 Z1 F5 I4000 K4000"), (10, 5, K::RadiusTooLarge));
    let (start, end) = (Distance::from_nm(5_000_000), Distance::from_nm(5_011_000));
    let tolerance = Length::from_um(10).unwrap();
    assert_eq!(one("G2 Z10.011 F5 K5"), (15, 2, K::RadiiDiffer { start, end, tolerance }));
    let half_chord = Distance::from_nm(5_010_001);
    assert_eq!(one("G2 Z10.020002 F5 R5"), (18, 2, K::RadiusTooSmall { radius: word("R5"), half_chord }));
    assert_eq!(arc("G2 Z10.02 F5 R5").1, centre(0, 5_010));
}

#[test]
fn programs() {
    for program in ["", "\n\n(nothing)\n;", "%\n%"] {
        let (_, found) = run_with(settings(), Format::Gcode, program);
        assert_eq!(found, [(u32::try_from(program.lines().count().max(1)).unwrap(), 1, 0, K::Empty)]);
    }
    let (_, found) = run_with(settings(), Format::Gcode, "M0\n(last)");
    assert_eq!(found, [(2, 1, 0, K::EndCodeMissing)]);
}

#[test]
fn messages_name_the_word_and_the_numbers() {
    let text = |program: &str| {
        let (line, column, length, kind) = found(program)[0];
        let diagnostic = Diagnostic { line, column, length, kind };
        (diagnostic.to_string(), diagnostic.remedy().to_string())
    };
    let pair = |cause: &str, remedy: &str| (String::from(cause), String::from(remedy));
    assert_eq!(text("G0 X1 U05"), pair("X with U in one block", "write X (absolute) or U (incremental), not both"));
    assert_eq!(
        text("G2 Z10.011 F5 K5"),
        pair(
            "start of the arc is 5 mm from the centre, its end 5.011 mm (tolerance 0.01 mm)",
            "correct the end or the centre until both radii agree"
        )
    );
    assert_eq!(
        text("F+5000.10"),
        pair(
            "F+5000.10 is above the fastest feed of both axes: X 2000, Z 5000 mm/min",
            "write a feed up to 5000 mm/min"
        )
    );
    assert_eq!(text("G99").1, "write G95 and F in mm (G20: inch) a turn");
    assert_eq!(text("é").0, "byte C3 (hexadecimal) is no printable ASCII character");
    assert_eq!(text(&" ".repeat(300)).0, "line of 300 bytes");
}
