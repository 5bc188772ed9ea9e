//! A bounded share of the soak: random operators, and rules that nothing they do may break.
#![allow(clippy::unwrap_used, reason = "a helper of tests may panic as tests do")]

use virtual_lathe::operate::soak::{Job, run, soak};

#[test]
fn some_sessions_break_no_rule_and_the_same_seed_gives_the_same_train() {
    let folder = std::env::temp_dir().join("handcnc-soak");
    let job = Job { hours: 0.1, seed: SEED, folder, failures: 1, ..Job::default() };
    let (first, second) = (run(&job, false), run(&job, false));
    assert!(first.broken.is_empty(), "{:?}", first.broken);
    assert_eq!(first.hash, second.hash);
}

/// Its sessions find nothing; others may: `soak` looks for them.
const SEED: u64 = 16;

/// Runs a script with its program, `0.nc`, under the rules of the soak; whether nothing is broken.
fn keeps_every_rule(name: &str, program: &str, script: &str) -> bool {
    let folder = std::env::temp_dir().join("handcnc-soak").join(name);
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("0.nc"), program).unwrap();
    let path = folder.join("0.txt");
    std::fs::write(&path, script).unwrap();
    soak(&Job { replay: Some(path), ..Job::default() }) == 0
}

/// X is pulled out beside the thread's taper: two ways, each with its own rounding, within the acceleration of one.
#[test]
fn a_tapered_thread_is_left_at_any_time_within_the_limits() {
    let program = "G18 G21 G90 G94\nG0 X6.8943 Z-1.0236\nS1076 M4\nG4 P0.3\nG33 X6.60 Z-9.0495 K2.031\nM30\n";
    for tick in (740..900).step_by(4) {
        let script = format!(
            "0.000 set x.pulse_nm 10000\n0.000 mode auto\n0.000 load 0.nc\n0.000 start\n{:.3} reset\n",
            f64::from(tick) / 1e3
        );
        assert!(keeps_every_rule("tapered-thread", program, &script), "reset at {tick} ms");
    }
}

/// A thread that was begun by the contour wheel ends by its spindle, with nobody at the wheel: of its last tick's pulses some come a
/// tick later.
#[test]
fn a_thread_begun_by_the_wheel_comes_to_its_end_by_itself() {
    for hundredths in (800..900).step_by(7) {
        let program = format!(
            "G18 G21 G90 G94\nS600 M3\nG4 P1\nG1 X0.1 F300\nG33 X0.5 Z-{:.2} K0.25\nG0 X1\nM30\n",
            f64::from(hundredths) / 1e2
        );
        let script = "0.000 mode auto\n0.000 load 0.nc\n0.000 start\n1.005 hold\n1.200 mode retrace\n\
             1.300 wheel contour +20 over 0.3\n9.000 mode retrace\n";
        assert!(keeps_every_rule("thread-by-wheel", &program, script), "{program}");
    }
}
