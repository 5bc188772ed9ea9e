//! Feeds that are held back for the corners at their ends.

use super::*;
use std::format;

fn zigzag(corner: &str) -> String {
    let teeth: String = (1..40).map(|k| format!("X{} Z{}\n", if k % 2 == 0 { 0 } else { 3 }, -2 * k)).collect();
    format!("{corner}\nG1 X1 F1500\n{teeth}M30\n")
}

#[test]
fn a_streamed_program_is_blended_as_a_stored_one() {
    let text = zigzag("G64 P0.05");
    let stored = without_link(&text);
    assert_ne!(stored.hash, without_link(&zigzag("G61")).hash);
    let mut bench = Bench::new();
    let answers = bench.stream(text.as_bytes());
    assert!(answers.iter().all(|answer| answer == "ok"), "{answers:?}");
    bench.until_idle();
    assert_eq!(bench.train, stored);
    // a sender that waits for each answer, and is slow to send on
    let mut bench = Bench::new();
    for line in text.lines() {
        assert_eq!(bench.stream(format!("{line}\n").as_bytes()), ["ok"]);
        bench.ticks(usize::from(HOLD_PATIENCE) - 5);
    }
    bench.until_idle();
    assert_eq!(bench.train.pulses, stored.pulses);
}

#[test]
fn a_feed_goes_out_when_its_sender_pauses() {
    let mut bench = Bench::new();
    assert_eq!(bench.ask("G64 P0.05\nG1 X1 F600\n"), "ok\nok\n".replace('\n', "\r\n"));
    assert!(bench.status().starts_with("Run"), "{}", bench.status());
    bench.ticks(usize::from(HOLD_PATIENCE) - 3);
    assert_eq!(bench.blocks.len(), 0);
    bench.until_idle();
    assert_eq!(bench.counted, Lattice { x: 800, z: 0 });
    // and the program goes on from there
    assert!(bench.ask("Z1\nM30\n").ends_with("ok\r\n"));
    bench.until_idle();
    assert_eq!(bench.counted, Lattice { x: 800, z: 400 });
}

#[test]
fn a_setting_waits_until_the_feed_is_out() {
    let mut bench = Bench::new();
    bench.ask("G64 P0.05\nG1 X1 F600\n");
    assert!(bench.ask("$corner_um=5\n").contains("error:8"));
    bench.until_idle();
    assert_eq!(bench.ask("$corner_um=5\n"), "ok\r\n");
}

#[test]
fn a_reset_and_an_alarm_forget_the_feed_that_is_held_back() {
    for alarm in [false, true] {
        let mut bench = Bench::new();
        bench.ask("G64 P0.05\nG1 X1 F600\nX2\n");
        bench.until_idle();
        bench.ask("X3\n");
        if alarm {
            bench.open = true;
            bench.ticks(2);
            bench.open = false;
            bench.ticks(40);
            bench.ask("$X\n");
        } else {
            bench.send([0x18]);
        }
        bench.ticks(100);
        assert!(bench.status().starts_with("Idle"), "{}", bench.status());
        // 2 mm, and 1 mm from there
        assert!(bench.ask("G91 G1 X1 F600\n").ends_with("ok\r\n"));
        bench.until_idle();
        assert_eq!(bench.counted, Lattice { x: 2_400, z: 0 });
    }
}

#[test]
fn a_refused_line_leaves_the_feed_that_is_held_back_as_it_was() {
    let with = |refused: &str| {
        let mut bench = Bench::new();
        bench.stream(format!("G64 P0.05\nG1 X3 F1500\n{refused}X0 Z-2\nM30\n").as_bytes());
        bench.until_idle();
        bench.train
    };
    assert_eq!(with("X5 Z1 P2\n"), with(""));
    assert_eq!(with("G2 X5 Z1 R1\n"), with(""));
}
