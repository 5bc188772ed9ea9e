//! Whatever comes down the wire.

use super::*;
use crate::background::inbox::{Inbox, LOST};
use proptest::prelude::*;

/// A line of a program, good or hopeless, without its terminator.
fn line() -> impl Strategy<Value = Vec<u8>> {
    let motion = (0..4_u8, -300..300_i32, -300..300_i32, 1..9_u32).prop_map(|(g, x, z, r)| {
        let arc = if g >= 2 { std::format!(" R{r}") } else { String::new() };
        std::format!("G91 G{g} X{}.{:02} Z{}.{:02}{arc} F{}00", x / 100, x.abs() % 100, z / 100, z.abs() % 100, r)
            .into_bytes()
    });
    let other = proptest::sample::select(std::vec![
        "",
        "%",
        "G90",
        "G91",
        "G7",
        "G20",
        "G4 P0.01",
        "M3 S100",
        "M30",
        "T0101",
        "/G0 X1",
        "(c)",
        "$",
        "$$",
        "$G",
        "$I",
        "$X",
        "$100=400",
        "$x.max_feed=900",
        "$z.max_accel=",
        "$format=nc1973",
        "$format=gcode",
        "G1",
        "X1e5",
        "G0 X9999",
        "M0 M30",
    ]);
    let garbage = proptest::collection::vec(0..0x80_u8, 0..40);
    prop_oneof![
        4 => motion,
        2 => other.prop_map(|text| text.as_bytes().to_vec()),
        1 => garbage.prop_map(|bytes| bytes.into_iter().filter(|byte| is_text(*byte)).collect()),
    ]
}

/// A line that moves nothing, with its terminator: refused, a query, overlong, garbage, or cut by a break.
fn idle_line() -> impl Strategy<Value = Vec<u8>> {
    let known = proptest::sample::select(std::vec![
        "",
        "$$",
        "$G",
        "$I",
        "$X",
        "$",
        "$x.max_feed=900",
        "$100=400",
        "$format=nc1973",
        "$H",
        "Q9",
        "X1 X2",
        "G2",
        "G0 X",
        "(c)",
        "12",
    ]);
    let garbage = proptest::collection::vec(0..=0xFF_u8, 0..60);
    let text = |bytes: Vec<u8>| -> Vec<u8> { bytes.into_iter().filter(|byte| is_text(*byte)).collect() };
    prop_oneof![
        4 => known.prop_map(|text| text.as_bytes().to_vec()),
        // no line begins with =
        2 => garbage.prop_map(move |bytes| [b"=".to_vec(), text(bytes)].concat()),
        1 => (MAX_LINE + 1..3 * MAX_LINE).prop_map(|bytes| std::vec![b'x'; bytes]),
        1 => Just([b"G0 X".as_slice(), &[LOST], b"99"].concat()),
        1 => Just(b"?G0 ?X???".to_vec()),
    ]
    .prop_map(|line| [line, b"\n".to_vec()].concat())
}

/// Neither a terminator nor a real-time byte.
fn is_text(byte: u8) -> bool {
    realtime(byte).is_none() && !matches!(byte, b'\r' | b'\n')
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn refused_lines_change_no_pulse_among_good_ones(lines in proptest::collection::vec(line(), 1..60)) {
        let text: Vec<u8> = lines.iter().flat_map(|line| [line.as_slice(), b"\n"].concat()).collect();
        let mut bench = Bench::new();
        bench.ticks(3);
        let answers = bench.stream(&text);
        bench.until_idle();
        let good = lines.iter().zip(&answers).filter(|(_, answer)| *answer == "ok");
        let text: Vec<u8> = good.clone().flat_map(|(line, _)| [line.as_slice(), b"\n"].concat()).collect();
        let mut clean = Bench::new();
        clean.ticks(3);
        let again = clean.stream(&text);
        clean.until_idle();
        prop_assert!(again.iter().all(|answer| answer == "ok"), "{again:?}");
        prop_assert_eq!(bench.train, clean.train);
        prop_assert_eq!(bench.counted, bench.snapshot.position);
        prop_assert_eq!(bench.counted, clean.counted);
    }

    #[test]
    fn any_bytes_get_one_answer_for_each_terminator(
        bytes in proptest::collection::vec(prop_oneof![any::<u8>(), Just(b'\n'), Just(b'\r'), Just(b'G'), Just(b'$'), 0x30..0x40_u8], 0..3_000),
        pace in 1..400_usize,
    ) {
        let mut bench = Bench::new();
        let bytes: Vec<u8> = bytes.into_iter().filter(|byte| *byte != 0x18).collect();
        for part in bytes.chunks(pace) {
            bench.send(part);
            bench.tick();
        }
        bench.send("~");
        bench.ticks(100);
        while bench.status().starts_with("Hold:0") {
            bench.send("~");
            bench.ticks(100);
        }
        bench.until_idle();
        let due = bytes.iter().filter(|byte| matches!(byte, b'\r' | b'\n')).count();
        for line in bench.out.lines().filter(|line| line.starts_with("[MSG:")) {
            let lower = line.to_ascii_lowercase();
            prop_assert!(!["ok", "error", "alarm"].iter().any(|word| lower.contains(word)), "{line}");
        }
        prop_assert_eq!(bench.answers().len(), due);
        prop_assert_eq!(bench.counted, bench.snapshot.position);
    }

    #[test]
    fn what_is_sent_in_motion_is_answered_and_changes_no_pulse(
        lines in proptest::collection::vec(idle_line(), 1..80),
        pace in 1..600_usize,
    ) {
        let program = "G91 G1 X2 Z-3 F1000\nG3 X0.5 Z-1 R2\nG1 X-2 F400\nM30\n";
        let mut bench = Bench::new();
        bench.ask(program);
        bench.ticks(20);
        // as the receiving interrupt and the background task hand it on
        let (mut bytes, mut requests) = (crate::queue::Queue::<u8, 256>::new(), crate::queue::Queue::<Realtime, 32>::new());
        let ((bytes_in, mut bytes_out), (requests_in, mut requests_out)) = (bytes.split(), requests.split());
        let mut inbox = Inbox::new(bytes_in, requests_in);
        for part in lines.concat().chunks(pace) {
            part.iter().for_each(|byte| inbox.take(*byte));
            while let Some(byte) = bytes_out.dequeue() {
                if byte == LOST { bench.link.damaged() } else { bench.link.receive(byte) }
            }
            while let Some(what) = requests_out.dequeue() {
                bench.link.realtime(what, &mut bench.commands, &bench.snapshot, &mut bench.out);
            }
            bench.tick();
        }
        bench.until_idle();
        prop_assert_eq!(bench.train, without_link(program));
        let lost = usize::try_from(inbox.lost()).unwrap();
        let messages = bench.out.matches("[MSG:").count();
        prop_assert_eq!(messages, bench.out.matches("error:").count(), "each refusal has its number and its name");
        let answers = bench.answers().len();
        prop_assert!(answers <= lines.len() && answers + lost >= lines.len(), "{answers} answers to {} lines", lines.len());
    }

    #[test]
    fn resets_among_anything_end_idle_where_the_tool_is(
        parts in proptest::collection::vec((line(), prop_oneof![3 => Just(b"\n"), 1 => Just(b"\x18"), 1 => Just(b"!"), 1 => Just(b"~")], 0..40_usize), 1..50),
    ) {
        let mut bench = Bench::new();
        for (line, end, ticks) in &parts {
            bench.send(line);
            bench.send(end);
            bench.ticks(*ticks);
        }
        bench.send("\x18");
        bench.out.clear();
        bench.until_idle();
        prop_assert!(bench.out.ends_with("['$' for help]\r\n"), "{}", bench.out);
        prop_assert_eq!(bench.counted, bench.snapshot.position);
        let before = bench.counted;
        bench.out.clear();
        prop_assert_eq!(bench.ask("$format=gcode\nG91 G0 U0.5 W-0.5\n"), "ok\r\nok\r\n");
        bench.until_idle();
        let pulse = (bench.link.machine.x.pulse, bench.link.machine.z.pulse);
        let half = |pulse: interp_core::units::PulseSize| 500_000.0 * f64::from(pulse.denominator()) / f64::from(pulse.numerator());
        prop_assert!((f64::from(bench.counted.x - before.x) - half(pulse.0)).abs() <= 1.0);
        prop_assert!((f64::from(bench.counted.z - before.z) + half(pulse.1)).abs() <= 1.0);
    }
}
