//! The state machine: what is refused changes nothing.

use super::command::{PickUpStep, Stop};
use super::mode::Situation;
use super::*;
use interp_core::units::Length;

/// One of each request.
fn requests() -> Vec<Command> {
    let zero = Length::ZERO;
    let mut all: Vec<Command> = Mode::ALL.into_iter().map(Command::Mode).collect();
    all.extend([
        Command::Start,
        Command::Hold,
        Command::Reset,
        Command::Unlock,
        Command::FeedOverride(50),
        Command::SingleBlock(true),
        Command::DryRun(true),
        Command::MachineLock(true),
        Command::StopAt(Axis::X, Stop::Here),
        Command::Return,
        Command::Repeat(2),
        Command::Home(Axis::Z),
        Command::Zero(Axis::X, zero),
        Command::ConfirmPosition,
        Command::Motors(false),
        Command::KeepOffset,
        Command::NullOffset,
        Command::BookWear,
        Command::Spindle(100_000),
        Command::Resume,
    ]);
    all
}

/// Every mode, every state, everything that may be in the way: a refusal leaves no trace.
#[test]
fn what_is_refused_changes_nothing_in_any_mode() {
    let mut refused = 0;
    for mode in Mode::ALL {
        for moving in [false, true] {
            for command in requests() {
                let mut bench = Bench::new();
                if bench.ask(Command::Mode(mode)).is_err() {
                    continue;
                }
                if moving {
                    bench.load("G1 X20 F300");
                    let _ = bench.ask(Command::Start);
                    bench.inputs.joystick = Joystick::Axis(Axis::Z, false);
                    bench.turn(Axis::X, 2, 50);
                }
                let before = bench.shown();
                if bench.ask(command).is_err() {
                    refused += 1;
                    assert_eq!(bench.shown(), before, "{mode:?} {command:?}");
                }
            }
        }
    }
    assert!(refused > 60, "{refused}");
}

/// At rest in automatic, and nothing is in the way.
const REST: Situation = Situation {
    mode: Mode::Automatic,
    state: State::Idle,
    moves: false,
    hands: false,
    starting: false,
    own_path: false,
    alarm: None,
    open: false,
    guard: false,
    motors: true,
    verified: true,
    cut: false,
    threaded: false,
    stop: false,
    kept: false,
    thread: false,
};

/// The table in the book, as facts about the pure function.
#[test]
fn the_table_of_modes() {
    let refusal = |command: Command, now: Situation| mode::refusal(&command, &now);
    for mode in Mode::ALL {
        let now = Situation { mode, ..REST };
        // cycle start where programs run
        let starts = matches!(mode, Mode::Automatic | Mode::ManualData | Mode::Linked);
        assert_eq!(refusal(Command::Start, now).is_none(), starts, "{mode:?}");
        for to in Mode::ALL {
            let allowed = to == mode || to != Mode::Retrace;
            assert_eq!(
                refusal(Command::Mode(to), now).is_none() || mode == Mode::Retrace,
                allowed || mode == Mode::Retrace
            );
            // never while something moves
            if to != mode {
                assert_eq!(refusal(Command::Mode(to), Situation { moves: true, ..now }), Some(Refusal::Moving));
            }
        }
        // nothing begins on a locked machine, with an open guard, without motors or not knowing where the tool is
        for (now, why) in [
            (Situation { alarm: Some(Alarm::Late), ..now }, Refusal::Alarm(Alarm::Late)),
            (Situation { guard: true, ..now }, Refusal::GuardOpen),
            (Situation { motors: false, ..now }, Refusal::MotorsOff),
            (Situation { verified: false, ..now }, Refusal::Unverified),
        ] {
            if starts {
                assert_eq!(refusal(Command::Start, now), Some(why));
            }
        }
        // a reset is never refused
        for state in [0, 1, 2, 3, 4, 5, 6].map(word_state) {
            assert_eq!(refusal(Command::Reset, Situation { state, moves: true, ..now }), None);
        }
    }
}

#[test]
fn a_guard_that_opens_while_a_start_waits_for_the_wheels_holds_it_before_it_moves() {
    let mut bench = Bench::with(&[("x.max_accel", "100")]);
    bench.load("G1 Z20 F600");
    bench.turn(Axis::X, 40, 20);
    bench.ask(Command::Start).unwrap();
    assert!(!bench.foreground.hands_rest());
    bench.inputs.guard = true;
    bench.settle();
    assert_eq!((bench.at.z, bench.shown().state, bench.refused()), (0, State::Holding, Some(Refusal::GuardOpen)));
    assert!(bench.track.iter().all(|at| at.z == 0));
    bench.inputs.guard = false;
    bench.tick();
    bench.ask(Command::Start).unwrap();
    bench.settle();
    assert_eq!((bench.at.z, bench.shown().state), (8_000, State::Ended));
}

#[test]
fn a_guard_that_opens_holds_and_nothing_starts_until_it_is_closed() {
    let mut bench = Bench::new();
    bench.load("G1 X20 F600");
    bench.ask(Command::Start).unwrap();
    bench.ticks(300);
    bench.inputs.guard = true;
    bench.settle();
    assert_eq!((bench.shown().state, bench.refused()), (State::Holding, Some(Refusal::GuardOpen)));
    assert_eq!(bench.ask(Command::Start), Err(Refusal::GuardOpen));
    bench.inputs.guard = false;
    bench.tick();
    bench.ask(Command::Start).unwrap();
    bench.settle();
    assert_eq!(bench.at.x, 16_000);
}

#[test]
fn single_block_stops_before_each_line_under_every_law() {
    for law in ["linear", "sine", "parabolic"] {
        let mut bench = Bench::with(&[("accel", law)]);
        bench.ask(Command::SingleBlock(true)).unwrap();
        bench.load("G1 X1 F1200\nG1 X2\nG1 X3 Z-1\nM2");
        bench.ask(Command::Start).unwrap();
        let mut stops = Vec::new();
        for _ in 0..6 {
            bench.settle();
            stops.push((bench.at.x, bench.at.z, bench.shown().state));
            if bench.shown().state == State::Ended {
                break;
            }
            bench.ask(Command::Start).unwrap();
        }
        assert_eq!(stops, [(800, 0, State::Stopped), (1600, 0, State::Stopped), (2400, -400, State::Ended)], "{law}");
    }
}

#[test]
fn rapids_are_overridden_and_a_dry_run_has_its_own_feed() {
    let mut bench = Bench::new();
    bench.ask(Command::RapidOverride(25)).unwrap();
    bench.load("G0 X20\nG1 X0 F60\nM2");
    bench.ask(Command::DryRun(true)).unwrap();
    bench.ask(Command::Start).unwrap();
    bench.ticks(300);
    let at = bench.at.x;
    bench.ticks(100);
    // 1250 mm/min
    assert!((bench.at.x - at - 1667).abs() <= 3, "{}", bench.at.x - at);
    while bench.at.x < 16_000 {
        bench.tick();
    }
    bench.ticks(300);
    let at = bench.at.x;
    bench.ticks(100);
    // 1000 mm/min
    assert!((at - bench.at.x - 1333).abs() <= 3, "{}", at - bench.at.x);
}

/// The book's table of modes is what the machine does: a row a request, a column a mode, and what is said where it is refused.
#[test]
fn the_book_has_the_table() {
    use std::fmt::Write;
    use std::string::String;
    let rest = Situation { cut: true, stop: true, kept: true, ..REST };
    let zero = Length::ZERO;
    let rows = [
        ("cycle start", Command::Start),
        ("feed hold", Command::Hold),
        ("reset", Command::Reset),
        ("another mode", Command::Mode(Mode::Handwheel)),
        ("retrace", Command::Mode(Mode::Retrace)),
        ("automatic", Command::Mode(Mode::Automatic)),
        ("overrides, single block, optional stop", Command::FeedOverride(100)),
        ("dry run, machine lock, parameters", Command::DryRun(true)),
        ("taper, arc", Command::Contour(super::contour::Contour::Taper(interp_core::units::Point::default()))),
        ("stop-at", Command::StopAt(Axis::Z, Stop::Here)),
        ("return", Command::Return),
        ("repeat", Command::Repeat(1)),
        ("threading lever in", Command::Lever(true)),
        ("pick-up", Command::PickUp(PickUpStep::Begin)),
        ("home", Command::Home(Axis::X)),
        ("zero, touch off", Command::Zero(Axis::X, zero)),
        ("confirm position", Command::ConfirmPosition),
        ("motors", Command::Motors(false)),
        ("keep offset, book wear", Command::KeepOffset),
        ("null offset", Command::NullOffset),
        ("spindle on", Command::Spindle(1)),
        ("resume", Command::Resume),
    ];
    let of_power = ["cycle start", "feed hold", "another mode", "stop-at", "return", "repeat", "threading lever in"];
    let table = |head: &str, columns: &[(&str, Situation)], some: &[&str]| {
        let mut table = String::new();
        let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
        writeln!(table, "| {head} | {} |\n|---|{}", names.join(" | "), "---|".repeat(names.len())).unwrap();
        for (name, command) in rows.iter().filter(|(name, _)| some.is_empty() || some.contains(name)) {
            let cells: Vec<&str> =
                columns.iter().map(|(_, now)| mode::refusal(command, now).map_or("yes", Refusal::name)).collect();
            writeln!(table, "| {name} | {} |", cells.join(" | ")).unwrap();
        }
        table
    };
    let at_rest: Vec<(&str, Situation)> =
        Mode::ALL.into_iter().map(|mode| (mode.name(), Situation { mode, ..rest })).collect();
    let in_auto = [
        ("running", Situation { state: State::Running, moves: true, ..rest }),
        ("held, standing", Situation { state: State::Holding, ..rest }),
        ("alarm", Situation { alarm: Some(Alarm::Emergency), ..rest }),
        ("guard open", Situation { guard: true, ..rest }),
        ("motors off", Situation { motors: false, verified: false, ..rest }),
        ("unverified", Situation { verified: false, ..rest }),
    ];
    let fed = Situation { mode: Mode::Power, ..rest };
    let in_power = [
        ("fed along X or Z", Situation { state: State::Running, own_path: true, moves: true, ..fed }),
        ("standing on the contour", Situation { state: State::Holding, own_path: true, ..fed }),
        ("no feed, stop or contour yet", Situation { cut: false, stop: false, ..fed }),
        ("after a thread by lever", Situation { cut: false, threaded: true, ..fed }),
        ("alarm", Situation { alarm: Some(Alarm::Emergency), ..fed }),
        ("guard open", Situation { guard: true, ..fed }),
    ];
    let book = include_str!("../../../docs/src/modes.md");
    for wanted in [
        table("at rest, in mode", &at_rest, &[]),
        table("in automatic", &in_auto, &[]),
        table("in power feed", &in_power, &of_power),
    ] {
        assert!(book.contains(&wanted), "the book lacks this table:\n{wanted}");
    }
}
