//! Programs that are streamed make the train of programs that are turned.

use super::*;

#[test]
fn the_demo_streamed_is_the_demo_turned() {
    let mut bench = Bench::new();
    let answers = bench.stream(DEMO.as_bytes());
    assert_eq!(answers, std::vec!["ok"; DEMO.lines().count()]);
    bench.until_idle();
    assert_eq!(bench.train.hash, DEMO_HASH);
    assert_eq!(bench.train.pulses, 168_618 + 403_304);
    assert_eq!(without_link(DEMO).hash, DEMO_HASH);
    assert_eq!(bench.counted, bench.snapshot.position);
}

#[test]
fn line_by_line_makes_the_same_train() {
    let mut bench = Bench::new();
    for line in DEMO.lines() {
        // an answer comes late while the queue is full
        bench.send(line);
        bench.send("\r\n");
        let mut answers = Vec::new();
        while answers.len() < 2 {
            bench.work();
            answers.extend(bench.answers());
            if answers.len() < 2 {
                bench.tick();
            }
        }
        assert_eq!(answers, ["ok", "ok"], "{line}");
    }
    bench.until_idle();
    assert_eq!(bench.train.hash, DEMO_HASH);
}

#[test]
fn many_short_blocks_wait_for_the_queue_and_lose_nothing() {
    let mut program = String::from("G91 F600\n");
    for at in 0..400 {
        program += if at % 2 == 0 { "G1 X0.02 Z0.05\n" } else { "G3 X-0.02 Z0.05 R1\n" };
    }
    program += "M30\n";
    let mut bench = Bench::new();
    assert!(bench.stream(program.as_bytes()).iter().all(|answer| answer == "ok"));
    bench.until_idle();
    assert_eq!(bench.train, without_link(&program));
    assert_eq!(bench.status(), "Idle|MPos:0.000,0.000,20.000");
}

#[test]
fn a_second_program_begins_where_the_first_ended() {
    let mut bench = Bench::new();
    bench.stream(b"%\nG91 G1 X1 F300\nM30\n%\n%\nG91 G1 Z1 F300\n%\nG91\nX1 G0\nM2\n");
    bench.until_idle();
    bench.until_idle();
    assert_eq!(bench.status(), "Idle|MPos:2.000,0.000,1.000");
}

#[test]
fn modal_codes_do_not_outlive_their_program() {
    let mut bench = Bench::new();
    assert_eq!(bench.stream(b"G7 G91 G1 X2 F300\nM30\nX5\nG0 X5\n"), ["ok", "ok", "error:31", "ok"]);
    bench.until_idle();
    bench.until_idle();
    assert_eq!(bench.status(), "Idle|MPos:5.000,0.000,0.000");
}

#[test]
fn lines_sent_one_at_a_time_by_hand_run_after_a_moment_and_end_idle() {
    let mut bench = Bench::new();
    for (line, place) in
        [("G0 X1\n", "1.000,0.000,0.000"), ("Z-1\n", "1.000,0.000,-1.000"), ("G1 X0 F100\n", "0.000,0.000,-1.000")]
    {
        assert_eq!(bench.ask(line), "ok\r\n");
        assert!(bench.status().starts_with("Run"), "{line}");
        bench.until_idle();
        assert_eq!(bench.status(), ["Idle|MPos:", place].concat());
        bench.ticks(200);
    }
}

#[test]
fn a_sender_that_pauses_stops_the_tool_and_goes_on() {
    let mut bench = Bench::new();
    bench.ask("G1 X1 F600\nX2\n");
    bench.until_idle();
    bench.ask("X3\nM30\n");
    bench.until_idle();
    assert_eq!(bench.status(), "Idle|MPos:3.000,0.000,0.000");
    assert_eq!(bench.counted, bench.snapshot.position);
}
