//! Alarms: told once, locked until `$X`, and no pulse after the stop.

use super::*;
use crate::foreground::alarm::{Alarm, Faults};

const UNVERIFIED: &str = "; the position is unverified]\r\nALARM:";

/// A motion under way, then what the board sees.
fn alarmed(faults: Faults, open: bool) -> (Bench, Lattice) {
    let mut bench = Bench::under_way();
    bench.ask("M3 S500\n");
    let struck = bench.counted;
    (bench.faults, bench.open) = (faults, open);
    bench.tick();
    bench.work();
    (bench, struck)
}

fn faults(underruns: u32, overruns: u32, late: u32) -> Faults {
    Faults { underruns, overruns, late }
}

#[test]
fn each_fault_brakes_within_the_limits_and_is_told_by_number_and_name() {
    for (seen, told) in [
        (faults(1, 0, 0), "[MSG:the pulse train ran empty; the position is unverified]\r\nALARM:200\r\n"),
        (faults(0, 3, 0), "[MSG:the pulse train overflowed; the position is unverified]\r\nALARM:201\r\n"),
        (faults(0, 0, 1), "[MSG:a pulse was late; the position is unverified]\r\nALARM:202\r\n"),
    ] {
        let (mut bench, struck) = alarmed(seen, false);
        assert_eq!(std::mem::take(&mut bench.out), told);
        assert!(bench.status().starts_with("Alarm:20"));
        bench.ticks(300);
        let stood = bench.counted;
        // 1000 mm/min is 16.7 mm/s along the path; at 500 mm/s2 an axis stops within 0.3 mm
        assert!((1..400).contains(&(stood.x - struck.x)), "{struck:?} {stood:?}");
        assert_eq!((stood, bench.foreground.outputs().spindle), (bench.snapshot.position, false));
        bench.ticks(300);
        assert_eq!((bench.counted, bench.out.as_str()), (stood, ""), "told twice, or moved");
    }
}

#[test]
fn an_emergency_stop_plans_no_further_pulse_and_switches_all_off() {
    let (mut bench, struck) = alarmed(Faults::default(), true);
    assert_eq!(bench.out, ["[MSG:emergency stop", UNVERIFIED, "10\r\n"].concat());
    bench.out.clear();
    assert!(!bench.foreground.outputs().motors && !bench.foreground.outputs().spindle);
    bench.ticks(300);
    assert!(bench.status().starts_with("Alarm:10|"));
    // what the shaper had put off for its intervals, at most
    let moved = bench.counted.x - struck.x;
    assert!((0..=2).contains(&moved), "{moved}");
    // while the input is open it cannot be unlocked
    bench.send("$X\n");
    bench.ticks(5);
    assert_eq!(bench.out, "[MSG:still there: emergency stop; release it, then $X]\r\nerror:50\r\n");
    bench.open = false;
    bench.out.clear();
    bench.send("$X\n");
    bench.ticks(5);
    assert_eq!(bench.out, "[MSG:Caution: Unlocked]\r\nok\r\n");
    assert!(bench.foreground.outputs().motors);
}

#[test]
fn a_locked_machine_refuses_program_lines_and_starts_nothing_until_unlocked() {
    let (mut bench, _) = alarmed(faults(1, 0, 0), false);
    bench.ticks(300);
    bench.out.clear();
    let stood = bench.counted;
    let refused = "[MSG:locked: the pulse train ran empty; check the position, then $X unlocks]\r\nerror:9\r\n";
    assert_eq!(bench.ask("G0 X1\n\n"), [refused, "ok\r\n"].concat());
    bench.send("~!~");
    bench.ticks(300);
    assert_eq!((bench.counted, bench.snapshot.state), (stood, State::Idle));
    // a reset forgets all but the alarm
    bench.send("G0 X1\n\x18");
    bench.ticks(5);
    assert_eq!(bench.out, "\r\nGrbl 1.1h ['$' for help]\r\n[MSG:'$X' to unlock]\r\n");
    assert!(bench.status().starts_with("Alarm:200|"));
    bench.out.clear();
    // what is sent behind $X is read after it, and goes on from where the tool is
    bench.send("$X\nG91 G0 X1.25\n");
    bench.ticks(5);
    bench.until_idle();
    assert_eq!(bench.out, "[MSG:Caution: Unlocked]\r\nok\r\nok\r\n");
    assert_eq!(bench.counted, Lattice { x: stood.x + 1_000, z: stood.z });
    bench.out.clear();
    assert_eq!(bench.ask("$X\n"), "ok\r\n");
}

#[test]
fn the_first_alarm_is_kept_but_for_an_emergency_stop() {
    let (mut bench, _) = alarmed(faults(0, 0, 1), false);
    bench.faults = faults(5, 5, 5);
    bench.ticks(3);
    assert_eq!(bench.snapshot.alarm, Some(Alarm::Late));
    bench.open = true;
    bench.ticks(3);
    bench.open = false;
    bench.faults = faults(6, 6, 6);
    bench.ticks(3);
    assert_eq!(bench.snapshot.alarm, Some(Alarm::Emergency));
    assert!(bench.out.ends_with("ALARM:10\r\n"), "{}", bench.out);
}

#[test]
fn every_line_is_answered_over_an_alarm() {
    let mut bench = Bench::new();
    let lines: String = (0..38).map(|at| std::format!("G1 X{}.5 F100\n", at % 9)).collect();
    for _ in 0..3 {
        bench.send(&lines);
        bench.ticks(300);
    }
    bench.faults = faults(1, 0, 0);
    bench.ticks(1_000);
    let answers = bench.answers();
    assert_eq!(answers.len(), 114);
    // in order: taken, then refused
    let taken = answers.iter().take_while(|answer| *answer == "ok").count();
    assert!((80..110).contains(&taken), "{taken}");
    assert!(answers.iter().skip(taken).all(|answer| answer == "error:9"));
}

#[test]
fn alarms_have_numbers_of_their_own() {
    for alarm in Alarm::ALL {
        assert_eq!(Alarm::of(alarm.number().into()), Some(alarm));
    }
    assert_eq!(Alarm::of(0), None);
}
