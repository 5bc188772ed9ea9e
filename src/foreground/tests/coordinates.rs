//! Where the axes are, and whether that is known.

use super::*;
use interp_core::drive::wheel::Click;
use interp_core::units::Length;

#[test]
fn an_emergency_stop_loses_the_place_of_an_axis_that_moves_and_of_no_other() {
    for moving in [false, true] {
        let mut bench = Bench::new();
        if moving {
            bench.load("G0 X30");
            bench.ask(Command::Start).unwrap();
        }
        bench.ticks(200);
        bench.open = true;
        bench.tick();
        let at = bench.at;
        bench.ticks(20);
        assert_eq!((bench.at, bench.shown().alarm), (at, Some(Alarm::Emergency)));
        assert_eq!(bench.ask(Command::Unlock), Err(Refusal::EmergencyOpen));
        bench.open = false;
        bench.tick();
        bench.ask(Command::Unlock).unwrap();
        assert_eq!(bench.shown().verified, PerAxis { x: !moving, z: true });
        let start = bench.ask(Command::Start);
        assert_eq!(start, if moving { Err(Refusal::Unverified) } else { Ok(()) });
    }
}

#[test]
fn an_axis_finds_its_home_where_the_switch_opens() {
    let mut bench = Bench::with(&[("z.home_mm", "200"), ("z.home_toward", "plus")]);
    bench.ask(Command::ConfirmPosition).unwrap();
    assert_eq!(bench.ask(Command::Home(Axis::Z)), Err(Refusal::WrongMode(Mode::Homing)));
    bench.ask(Command::Mode(Mode::Homing)).unwrap();
    bench.ask(Command::Home(Axis::Z)).unwrap();
    // a switch that is closed from pulse 3000 on
    let mut opened = None;
    for _ in 0..20_000 {
        bench.inputs.ends.z.plus = bench.at.z >= 3000;
        bench.tick();
        if opened.is_some() && bench.shown().verified.z {
            break;
        }
        if bench.at.z > 3000 {
            opened = None;
        } else if opened.is_none() && bench.track.iter().any(|at| at.z > 3000) {
            opened = Some(bench.at.z);
        }
    }
    let shown = bench.shown();
    assert!(shown.verified.z && shown.alarm.is_none());
    // 200 mm where it opened, to the pulses of a tick at an eighth of 600 mm/min
    let home = bench.at.z - (shown.position.z - 80_000);
    assert!((home - 3000).abs() <= 2, "{home}");
    bench.settle();
    bench.keep_limits();
}

#[test]
fn a_home_switch_that_never_comes_is_an_alarm() {
    let mut bench = Bench::with(&[("x.home_feed", "5000")]);
    bench.ask(Command::Mode(Mode::Homing)).unwrap();
    bench.ask(Command::Home(Axis::X)).unwrap();
    bench.settle();
    assert_eq!((bench.shown().alarm, bench.shown().verified.x), (Some(Alarm::Homing), false));
}

#[test]
fn a_display_set_to_a_number_moves_nothing_and_limits_stay_where_they_are() {
    let mut bench = Bench::with(&[("x.limit_plus_mm", "3")]);
    bench.ask(Command::Mode(Mode::Handwheel)).unwrap();
    bench.ask(Command::Scale(Some(Click::DECADES[2]))).unwrap();
    bench.turn(Axis::X, 4, 1);
    bench.settle();
    bench.ask(Command::Zero(Axis::X, Length::from_um(20_000).unwrap())).unwrap();
    assert_eq!((bench.at.x, bench.shown().position.x), (80, 16_000));
    bench.turn(Axis::X, 20, 700);
    bench.settle();
    assert_eq!((bench.at.x, bench.shown().position.x), (2400, 16_000 + 2320));
}

#[test]
fn motors_off_and_power_loss_leave_the_position_unverified() {
    let mut bench = Bench::mode(Mode::Handwheel);
    bench.turn(Axis::X, 4, 1);
    bench.settle();
    bench.ask(Command::Motors(false)).unwrap();
    bench.tick();
    assert!(!bench.shown().outputs.motors && !bench.shown().verified.x);
    bench.ask(Command::Mode(Mode::Automatic)).unwrap();
    assert_eq!(bench.ask(Command::Start), Err(Refusal::MotorsOff));
    bench.ask(Command::Motors(true)).unwrap();
    assert_eq!(bench.ask(Command::Start), Err(Refusal::Unverified));

    let mut bench = Bench::new();
    bench.load("G1 X3 F600\nG1 Z-9\nM2");
    bench.ask(Command::Start).unwrap();
    bench.ticks(700);
    let (kept, at) = (bench.foreground.kept(), bench.at);
    assert_eq!(kept.line, 2);
    let mut bench = Bench::new();
    bench.foreground.restore(&kept);
    assert_eq!((bench.shown().position, bench.shown().interrupted), (at, 2));
    assert_eq!(bench.ask(Command::Resume), Err(Refusal::Unverified));
}

#[test]
fn a_scale_shows_the_following_error_and_it_is_taken_back_slowly() {
    let mut bench = Bench::with(&[("z.following_um", "100")]);
    let lost = 8; // pulses that the slide is behind
    let run = |bench: &mut Bench, ticks: u32, lost: i32| {
        for _ in 0..ticks {
            // what the slide did until a tick ago
            let at = bench.track.len().checked_sub(2).map_or(0, |at| bench.track[at].z);
            bench.inputs.scales.z = Some((at - lost) * 2500);
            bench.tick();
        }
    };
    run(&mut bench, 50, 0);
    run(&mut bench, 2, lost);
    assert_eq!(bench.shown().following.z, -lost * 2500);
    run(&mut bench, 1000, lost);
    assert!((bench.at.z - lost).abs() <= 1, "{}", bench.at.z);
    assert!(bench.shown().following.z.abs() <= 2500);
    assert_eq!((bench.shown().position, bench.shown().alarm), (Lattice::default(), None));
    run(&mut bench, 5, 60);
    assert_eq!(bench.shown().alarm, Some(Alarm::FollowingZ));
}

#[test]
fn machine_lock_moves_the_display_alone() {
    let mut bench = Bench::new();
    bench.ask(Command::MachineLock(true)).unwrap();
    bench.load("G0 X3 Z-2");
    bench.ask(Command::Start).unwrap();
    bench.settle();
    bench.ticks(2_000);
    assert_eq!((bench.at, bench.shown().programmed), (Lattice::default(), Lattice { x: 2400, z: -800 }));
    bench.ask(Command::MachineLock(false)).unwrap();
    assert_eq!(bench.shown().position, Lattice::default());
}
