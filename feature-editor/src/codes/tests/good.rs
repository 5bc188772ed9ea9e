//! Programs that are read.

use super::*;

#[test]
fn a_block_is_executed_in_order() {
    let expected = [
        Action::SpindleSpeed(SpindleSpeed::from_milli_rpm(1_200_500).unwrap()),
        Action::Spindle(SpindleCommand::Reverse),
        Action::Tool { number: 1, offset: 3 },
        Action::Dwell { ms: 1_500 },
        Action::Line { end: at(10_000, -5_000), feed: Feed::PerMinute(per_minute(100)) },
        Action::Stop,
    ];
    assert_eq!(actions("m0 z-5x 10 g1 g4 p1.5 t0103 m4 s1200.5 f100 n10 (all)"), expected);
}

#[test]
fn absolute_incremental_diameter_and_inch() {
    assert_eq!(ends("G0 X50 Z-3\nU1 W1\nG91 X1 Z1"), [at(50_000, -3_000), at(51_000, -2_000), at(52_000, -1_000)]);
    assert_eq!(ends("G7 G0 X50\nU1\nG8 X50"), [at(25_000, 0), at(25_500, 0), at(50_000, 0)]);
    assert_eq!(
        ends("G20 G0 X1 Z-.5\nG21 X1\nG20 G7 X1"),
        [at(25_400, -12_700), at(1_000, -12_700), at(12_700, -12_700)]
    );
}

#[test]
fn path_control_is_modal_and_begins_as_the_settings_say() {
    let controls = |corner: i32, program: &str| {
        let settings = Settings { corner: Length::from_um(corner).unwrap(), ..settings() };
        let mut interpreter = Interpreter::new(settings, Format::Gcode);
        let mut controls = Vec::new();
        for line in program.lines() {
            interpreter.line(line.as_bytes(), &mut |item: Item| controls.push(item.control), &mut |_| {});
        }
        controls
    };
    let within = |um: i32| PathControl::Blend { tolerance: Length::from_um(um) };
    assert_eq!(controls(0, "G0 X1"), [PathControl::Exact]);
    assert_eq!(
        controls(
            20,
            "G0 X1\nG64 P0.05 X2\nX3\nG20 G64 P.001 X1\nG61\nX4\nG61.1\nX5\nG64\nX6\nG64 P0 X7\nG4 P1 G61.1\nG64 P1\nX1"
        ),
        [
            within(20),
            within(50),
            within(50),
            PathControl::Blend { tolerance: Length::from_nm(25_400) },
            PathControl::Exact,
            PathControl::Stop,
            PathControl::Blend { tolerance: None },
            PathControl::Exact,
            PathControl::Stop,
            // 1 inch is too large: refused, and what was in force stays
            PathControl::Stop,
        ]
    );
}

#[test]
fn motion_and_feed_are_modal() {
    let feed = Feed::PerMinute(Feedrate::from_nm_per_min(254_000_000).unwrap());
    assert_eq!(
        actions("G20 F10\nG21 G1 X1\nZ1"),
        [Action::Line { end: at(1_000, 0), feed }, Action::Line { end: at(1_000, 1_000), feed }]
    );
}

#[test]
fn arcs_by_centre() {
    let arcs = "G0 X10 F100\n";
    assert_eq!(arc(&format!("{arcs}G2 X0 Z10 I-10")), (at(0, 10_000), centre(0, 0), Sense::Clockwise));
    // a full circle, diameter mode: I stays a radius
    assert_eq!(arc(&format!("{arcs}G7 G3 X20 K5")), (at(10_000, 0), centre(10_000, 5_000), Sense::CounterClockwise));
    assert_eq!(arc(&format!("{arcs}G2 X0.005 Z10 I-10")).1, centre(0, 0));
}

#[test]
fn arcs_by_radius_agree_with_the_centre() {
    assert_eq!(arc("G0 X10 F100\nG2 X0 Z10 R10"), (at(0, 10_000), centre(0, 0), Sense::Clockwise));
    assert_eq!(arc("G0 X10 F100\nG3 X0 Z10 R-10").1, centre(0, 0));
    assert_eq!(arc("G0 X10 F100\nG2 X0 Z10 R-10").1, centre(10_000, 10_000));
}

#[test]
fn a_front_post_mirrors_the_sense() {
    let front = Settings { front_post: true, ..settings() };
    let (actions, found) = run_with(front, Format::Gcode, "G0 X10 F100\nG3 X0 Z10 R10\nM2");
    assert_eq!(found, []);
    let feed = Feed::PerMinute(per_minute(100));
    let expected = Action::Arc { end: at(0, 10_000), centre: centre(0, 0), sense: Sense::Clockwise, feed };
    assert_eq!(actions[1], expected);
}

#[test]
fn tools() {
    for (text, number, offset) in [
        ("T1", 1, 1),
        ("T12", 12, 12),
        ("T0101", 1, 1),
        ("T0100", 1, 0),
        ("T9999", 99, 99),
        ("T102", 1, 2),
        ("T0000", 0, 0),
    ] {
        assert_eq!(actions(text), [Action::Tool { number, offset }], "{text}");
    }
}

#[test]
fn percent_and_end_codes_end_the_program() {
    for program in ["%\nO1000\nM0\n%\nX#", "M0\n%\nX#", "M0\nM2\nX#", "%\nM0 \nM30\n%", "%\nM0\r\n % \r\nX#"] {
        let (actions, found) = run_with(settings(), Format::Gcode, program);
        assert_eq!((actions[0], found.as_slice()), (Action::Stop, [].as_slice()), "{program}");
    }
}

#[test]
fn block_delete_skips_or_runs() {
    assert_eq!(actions("/M0"), [Action::Stop]);
    let skip = Settings { block_delete: true, ..settings() };
    assert_eq!(run_with(skip, Format::Gcode, " / M0 X#\nM2"), ([Action::End].to_vec(), Vec::new()));
}

#[test]
fn nothing_of_a_refused_line_is_emitted_but_the_position_moves_on() {
    let (actions, found) = run_with(settings(), Format::Gcode, "G0 X10 Z10 Q1\nU1\nM2");
    assert_eq!(found.len(), 1);
    assert_eq!(actions[0], Action::Line { end: at(11_000, 10_000), feed: Feed::Rapid });
}

#[test]
fn every_error_of_a_line_is_told() {
    let kinds: Vec<_> = found("G1 X1 U1 Z3000 S-1 T1.5 G17").into_iter().map(|found| found.1).collect();
    // G17, S, T, U, Z; not the missing F: G17 might be at fault
    assert_eq!(kinds, [25, 16, 20, 7, 10]);
}
