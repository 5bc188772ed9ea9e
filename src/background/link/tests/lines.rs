//! Lines and their answers.

use super::*;

#[test]
fn every_terminator_is_answered_once() {
    let mut bench = Bench::new();
    assert_eq!(bench.ask("\n"), "ok\r\n");
    assert_eq!(bench.ask("\r\n"), "ok\r\nok\r\n");
    assert_eq!(bench.ask("G21\r"), "ok\r\n");
    assert_eq!(bench.ask("(a comment)\n; another\n   \n"), "ok\r\nok\r\nok\r\n");
    assert_eq!(bench.ask("G0 X1"), "");
    assert_eq!(bench.ask(" Z2\n"), "ok\r\n");
    bench.until_idle();
    assert_eq!(bench.status(), "Idle|MPos:1.000,0.000,2.000");
}

#[test]
fn bytes_above_text_are_dropped() {
    let mut bench = Bench::new();
    bench.send(b"G0\x80 X\xFF1\xC3\xA4\n");
    assert_eq!(bench.ask(""), "ok\r\n");
    bench.until_idle();
    assert_eq!(bench.status(), "Idle|MPos:1.000,0.000,0.000");
}

#[test]
fn refused_lines_are_named_and_numbered() {
    let mut bench = Bench::new();
    for (line, answer) in [
        ("X1", "[MSG:line 1 column 1: X1 before any motion code]|error:31"),
        ("G1 X1", "[MSG:line 2 column 1: G1 without a feed]|error:22"),
        ("G55", "[MSG:line 3 column 1: G55 is not supported]|error:20"),
        ("G0 G1 X1 F1", "[MSG:line 4 column 4: G0 and G1 in one block exclude each other]|error:21"),
        ("G0 X1 X2", "[MSG:line 5 column 7: X1 and X2 in one block]|error:25"),
        ("G0 X", "[MSG:line 6 column 4: X without a number]|error:2"),
        ("12", "[MSG:line 7 column 1: number without a letter]|error:1"),
        ("G0 X3000", "[MSG:line 8 column 4: X3000 leads X past 2100 mm from zero]|error:33"),
        ("G2 X1 F100", "[MSG:line 9 column 1: arc without a centre]|error:35"),
        ("G2 X10 R1 F100", "[MSG:line 10 column 8: R1 is too small: the ends are 2 x 5 mm apart]|error:34"),
        ("G0 X1 R1", "[MSG:line 11 column 7: R1 belongs to an arc, and this block has none]|error:36"),
        ("G0 X1 U1", "[MSG:line 12 column 7: X with U in one block]|error:48"),
        ("(open", "[MSG:line 13 column 1: comment without )]|error:202"),
        ("F0", "[MSG:line 14 column 1: F0 is no feed above zero]|error:19"),
        (
            "F60000",
            "[MSG:line 15 column 1: F60000 is above the fastest feed of both axes: X 5000, Z 5000 mm/min]|error:43",
        ),
        ("G4", "[MSG:line 16 column 1: G4 without P]|error:28"),
        ("S-1", "[MSG:line 17 column 1: S-1 is no spindle speed from 0 to 100000]|error:44"),
        ("T1.5", "[MSG:line 18 column 1: T1.5 is no tool number]|error:38"),
        ("S5 O1", "[MSG:line 19 column 4: O1 is not the first word of its line]|error:203"),
        ("% X", "[MSG:line 20 column 3: text behind %]|error:57"),
    ] {
        let expected = answer.replace('|', "\r\n") + "\r\n";
        assert_eq!(bench.ask(&[line, "\n"].concat()), expected, "{line}");
    }
    bench.ticks(200);
    assert_eq!((bench.train.pulses, bench.status().as_str()), (0, "Idle|MPos:0.000,0.000,0.000"));
}

#[test]
fn a_warning_comes_before_its_ok() {
    let mut bench = Bench::with(&[("x.max_feed", "1000")]);
    let answer = bench.ask("G1 X1 F2000\n");
    assert_eq!(
        answer,
        "[MSG:line 1 column 1: F is limited to 1000.0 mm/min by the X axis in this direction]\r\nok\r\n"
    );
}

/// SPEC 3.3: live, a feed above the maximum is refused with a message, and the previous one stays in force.
#[test]
fn a_feed_above_both_maxima_is_refused_and_the_previous_one_is_kept() {
    let mut bench = Bench::new();
    assert_eq!(bench.ask("G1 Z1 F600\n"), "ok\r\n");
    let answer = bench.ask("G1 Z2 F5001\n");
    assert!(answer.starts_with("[MSG:") && answer.ends_with("error:43\r\n"), "{answer}");
    assert!(bench.ask("$G\n").contains(" F600.000 "));
    assert_eq!(bench.ask("G1 Z2\n"), "ok\r\n");
}

#[test]
fn an_overlong_line_is_refused_whole() {
    let mut bench = Bench::new();
    let mut line = String::from("G0 X1 (");
    line.extend(std::iter::repeat_n('x', 2 * MAX_LINE));
    line += ") Z1\n";
    assert_eq!(bench.ask(&line), "[MSG:line of more than 256 bytes]\r\nerror:11\r\n");
    // Bytes are counted, terminators not: 256 are a line, 257 are none.
    let comment = |bytes: usize| ["(", &"x".repeat(bytes - 2), ")\n"].concat();
    assert_eq!(bench.ask(&comment(MAX_LINE)), "ok\r\n");
    assert!(bench.ask(&comment(MAX_LINE + 1)).ends_with("error:11\r\n"));
    bench.ticks(200);
    assert_eq!(bench.train.pulses, 0);
}

#[test]
fn a_flood_is_answered_line_by_line_and_moves_only_what_was_answered_ok() {
    let mut bench = Bench::new();
    // an idle channel fills: 16 blocks in the queue, then lines wait, then the buffer overflows
    bench.send("!");
    for at in 0..300 {
        bench.send(std::format!("G1 Z{}.5 F1000\n", at % 7));
        if at % 10 == 0 {
            bench.tick();
        }
    }
    bench.send("~");
    let mut answers = bench.answers();
    bench.until_idle();
    answers.extend(bench.answers());
    assert_eq!(answers.len(), 300);
    let good = answers.iter().filter(|answer| *answer == "ok").count();
    let lost = answers.iter().filter(|answer| *answer == "error:200").count();
    assert_eq!((good + lost, bench.link.overflow() > 0), (300, true));
    assert!(good >= 16 && lost > 0, "{good} {lost}");
    let mut clean = Bench::new();
    let lines = answers.iter().enumerate().filter(|(_, answer)| *answer == "ok");
    let text: String = lines.map(|(at, _)| std::format!("G1 Z{}.5 F1000\n", at % 7)).collect();
    clean.stream(text.as_bytes());
    clean.until_idle();
    assert_eq!((bench.train.pulses, bench.counted), (clean.train.pulses, clean.counted));
    // and it goes on as if nothing had been
    assert_eq!(bench.ask("G0 Z0\n"), "ok\r\n");
}

#[test]
fn a_break_in_mid_line_refuses_the_line() {
    let mut bench = Bench::new();
    bench.send("G0 X1");
    bench.link.damaged();
    assert_eq!(bench.ask("0\nG0 Z1\n"), "[MSG:line lost: bytes of it did not arrive whole]\r\nerror:201\r\nok\r\n");
    // as a port that does not flag it delivers it
    assert!(bench.ask("G0 X1\0\0\n").ends_with("error:1\r\n"));
    // a sender that left in mid-line is not continued by the next one
    bench.send("G0 X1");
    bench.link.disconnected();
    assert_eq!(bench.ask("G0 Z2\n"), "ok\r\n");
    bench.until_idle();
    assert_eq!(bench.status(), "Idle|MPos:0.000,0.000,2.000");
}

#[test]
fn a_refused_line_leaves_no_trace() {
    let program = "G91 F500\nG1 X1 Z-1\nG3 X1 Z-1 I1\nM30\n";
    let bad = "G90 G20 G7 G1 X5 F9 Z\nG0 X1 Q1\nM30 Z\n%x\nF0\nG2 X9 R1\n";
    let dirty: String = program.split_inclusive('\n').flat_map(|line| [bad, line]).collect();
    let mut bench = Bench::new();
    let answers = bench.stream(dirty.as_bytes());
    assert_eq!(answers.iter().filter(|answer| *answer == "ok").count(), 4);
    bench.until_idle();
    assert_eq!(bench.train, without_link(program));
}
