//! The sample of 1973 and what does not fit its format.

use super::*;
use DiagnosticKind as K;

const SAMPLE: &str = "N01 G91\nN02 G01 X+5000 F0\nN03 X+7000 F1\nN04 G02 X+2000 Y0 I0 J2000\n\
                          N05 X0 Y-2000 I2000 J0\nN06 G01 X-7000\nN07 G02 X-2000 Y0 I0 J2000\n\
                          N08 X0 Y+2000 I2000 J0\nN09 G01 X-5000 F0\n";

fn tape() -> Settings {
    let mut settings = settings();
    settings.tape_feeds[0] = Some(per_minute(100));
    settings.tape_feeds[8] = Some(per_minute(9_000));
    settings
}

fn one(line: &str) -> (u32, u32, DiagnosticKind) {
    let (_, found) = run_with(tape(), Format::Nc1973, line);
    assert_eq!(found.len(), 1, "{found:?}");
    (found[0].1, found[0].2, found[0].3)
}

#[test]
fn the_sample_is_a_slot_of_110_by_40_and_comes_back() {
    let mut detector = Detector::new();
    SAMPLE.lines().for_each(|line| detector.line(line.as_bytes()));
    assert_eq!(detector.format(), Format::Nc1973);

    let (actions, found) = run_with(tape(), Format::Nc1973, SAMPLE);
    assert_eq!(found, []);
    let feed = Feed::PerMinute(per_minute(100));
    let line = |end, feed| Action::Line { end, feed };
    let arc = |end, centre| Action::Arc { end, centre, sense: Sense::Clockwise, feed };
    let (right, left) = (centre(-20_000, 120_000), centre(-20_000, 50_000));
    let expected = [
        line(at(0, 50_000), Feed::Rapid),
        line(at(0, 120_000), feed),
        arc(at(-20_000, 140_000), right),
        arc(at(-40_000, 120_000), right),
        line(at(-40_000, 50_000), feed),
        arc(at(-20_000, 30_000), left),
        arc(at(0, 50_000), left),
        line(at(0, 0), Feed::Rapid),
    ];
    assert_eq!(actions, expected);
}

#[test]
fn g_code_with_a_y_and_decimal_points_is_not_taken_for_it() {
    let mut detector = Detector::new();
    detector.line(b"G1 X10. Y5.");
    assert_eq!(detector.format(), Format::Gcode);
    let mut detector = Detector::new();
    detector.line(b"G1 X10 I0 K5 (Y5)");
    assert_eq!(detector.format(), Format::Gcode);
}

#[test]
fn what_does_not_fit_is_refused() {
    let format = Format::Nc1973;
    assert_eq!(one("G01 X1.0 F1"), (5, 4, K::DecimalPoint(word("X1.0"))));
    assert_eq!(one("G01 X1 F10"), (8, 3, K::FeedCode(word("F10"))));
    assert_eq!(one("G01 X1 F-1"), (8, 3, K::FeedCode(word("F-1"))));
    assert_eq!(one("G01 X1 F2"), (8, 2, K::FeedCodeUnset(word("F2"))));
    let (limit_x, limit_z) = (per_minute(2_000), per_minute(5_000));
    assert_eq!(one("G01 X1 F9"), (8, 2, K::FeedTooHigh { word: word("F9"), limit_x, limit_z }));
    assert_eq!(one("G01 X1"), (1, 3, K::FeedMissing(word("G01"))));
    assert_eq!(one("X1 F1"), (1, 2, K::MotionMissing(word("X1"))));
    assert_eq!(one("G01 F1"), (1, 3, K::EndMissing(word("G01"))));
    assert_eq!(one("G01 X1 I0 F1"), (8, 2, K::ArcWordUnused(word("I0"))));
    assert_eq!(one("G90"), (1, 3, K::UnknownG { word: word("G90"), format }));
    assert_eq!(one("G00 X1"), (1, 3, K::UnknownG { word: word("G00"), format }));
    assert_eq!(one("G01 X1 F1 Z1"), (11, 2, K::UnknownLetter { word: word("Z1"), format }));
    assert_eq!(one("G01 X210001 F1"), (5, 7, K::Coordinate { word: word("X210001"), axis: Axis::Z }));
    assert_eq!(one("G02 X5 Y0 I0 F1"), (1, 3, K::ArcWordMissing('J')));
    assert_eq!(one("G02 X5 Y0 I0 J-5 F1"), (14, 3, K::Signed(word("J-5"))));
    assert_eq!(one("G02 X3 Y4 I4 J3 F1"), (1, 3, K::NotOneQuadrant));
    assert_eq!(one("G02 X5 Y0 I5 J0 F1"), (1, 3, K::NotOneQuadrant));
    assert_eq!(one("G02 X0 Y0 I0 J0 F1"), (1, 3, K::RadiusZero));
    let (start, end) = (Distance::from_nm(70_000), Distance::from_nm(50_000));
    let tolerance = Length::from_um(10).unwrap();
    assert_eq!(one("G02 X5 Y0 I0 J7 F1"), (1, 3, K::RadiiDiffer { start, end, tolerance }));
    assert_eq!(one("(empty)"), (1, 0, K::Empty));
}
