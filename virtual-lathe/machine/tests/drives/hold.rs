//! Hold and spindle faults in a thread: what the tool did to the work, pulse by pulse.

use crate::bench::{Bench, PULSES, Turning, keep_limits, lathe, point, program, turns};
use interp_core::block::{Pace, Path};
use interp_core::channel::State;
use interp_core::config::Machine;
use interp_core::curve::method::Method;
use interp_core::drive::gearing::Lead;
use interp_core::drive::{Inputs, ThreadStage, Trouble};
use interp_core::threading::Threading;
use interp_core::units::Length;

/// Radius that the tool stands at outside, and how deep it cuts, X pulses.
const OUTSIDE: i32 = 8_000;
const DEPTH: i32 = 800;

/// The lathe, with X pulled out by 2 mm.
pub(crate) fn guarded(retract_um: i32) -> Machine {
    let threading = Threading { encoder: 4096, retract: Length::from_um(retract_um).unwrap(), guarded: true };
    Machine { threading, ..lathe(Method::MinimumDeviation) }
}

/// What the operator and the spindle do at a tick.
#[derive(Copy, Clone, Debug, PartialEq)]
pub(crate) enum Act {
    Start,
    Hold,
    Reset,
    Rpm(f64),
    /// Index pulses come, or don't.
    Index(bool),
    /// So many counts are lost for good.
    Lose(u16),
}

/// A pulse in the groove: its instant's angle in turns, and where the tool was.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Cut {
    pub(crate) tick: u32,
    pub(crate) turns: f64,
    pub(crate) z: i32,
    /// Z's sense.
    pub(crate) moved: i32,
}

/// A thread of 40 mm with a lead of 2 mm at 1 mm of depth, its run.
pub(crate) struct Run {
    /// Z pulses with X below the surface.
    pub(crate) cut: Vec<Cut>,
    /// At each tick's end.
    pub(crate) places: Vec<[i32; 2]>,
    pub(crate) stages: Vec<ThreadStage>,
    pub(crate) states: Vec<State>,
    pub(crate) faults: Vec<Option<Trouble>>,
    pub(crate) bench: Bench,
}

pub(crate) const LEAD_NM: u64 = 2_000_000;
pub(crate) const END: i32 = -16_000;

pub(crate) fn run(machine: &Machine, ticks: u32, acts: &[(u32, Act)]) -> Run {
    let thread = Pace::Thread { lead: Lead::new(LEAD_NM, 1).unwrap(), start: 0 };
    let blocks = program(
        machine,
        &[
            (Path::Line, point(-i64::from(OUTSIDE) * 1_250, 0), Pace::Rapid),
            (Path::Line, point(-i64::from(OUTSIDE) * 1_250, -40_000_000), thread),
            (Path::Line, point(0, -40_000_000), Pace::Rapid),
        ],
    );
    let mut bench = Bench::new(machine, blocks);
    let mut turning = Turning::new();
    let (mut index, mut lost) = (true, 0_u16);
    let mut run = (Vec::new(), Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut due: Vec<(u32, [i32; 2])> = Vec::new();
    for tick in 0..ticks {
        // pulses made in the last tick are played now
        for (clock, [z, moved]) in due.drain(..) {
            let turns = turns(turning.spindle.angle_after(f64::from(clock) / 12e6));
            run.0.push(Cut { tick, turns, z, moved });
        }
        for (_, act) in acts.iter().filter(|(at, _)| *at == tick) {
            match *act {
                Act::Start => drop(bench.channel.start()),
                Act::Hold => assert!(bench.channel.hold()),
                Act::Reset => bench.channel.reset(),
                Act::Rpm(rpm) => turning.spindle.command(rpm),
                Act::Index(on) => index = on,
                Act::Lose(counts) => lost = lost.wrapping_add(counts),
            }
        }
        let mut reading = turning.reading();
        reading.counts = reading.counts.wrapping_sub(lost);
        reading.index = reading.index.filter(|_| index).map(|at| at.wrapping_sub(lost));
        let report = bench.tick(&Inputs { spindle: Some(reading), wheel: 0 });
        // below the surface: the tool stands at -OUTSIDE + DEPTH there
        let in_work = |x: i32| x < -OUTSIDE + DEPTH;
        due.extend(
            bench
                .pulses
                .iter()
                .filter(|pulse| pulse.moved[1] != 0 && in_work(pulse.at.x))
                .map(|pulse| (pulse.clock, [pulse.at.z, pulse.moved[1]])),
        );
        run.1.push([bench.at.x, bench.at.z]);
        run.2.push(report.driven.stage);
        run.3.push(report.state);
        run.4.push(bench.channel.fault());
        turning.spindle.tick();
    }
    Run { cut: run.0, places: run.1, stages: run.2, states: run.3, faults: run.4, bench }
}

impl Run {
    /// Distance of a pulse in the groove from the spindle's true angle, Z pulses.
    fn off(cut: &Cut) -> f64 {
        let lead = LEAD_NM as f64 / f64::from(PULSES[1]);
        let off = cut.turns * lead - f64::from(-cut.z + i32::from(cut.moved > 0));
        (off - (off / lead).round() * lead).abs()
    }

    /// The largest such distance where the tool had fallen in and was not braking at the thread's end.
    pub(crate) fn worst(&self, run_in: i32, run_out: i32) -> f64 {
        let within = |cut: &&Cut| cut.z < -run_in && cut.z > END + run_out;
        self.cut.iter().filter(within).map(Self::off).fold(0.0, f64::max)
    }

    fn keep_limits(&self) {
        for axis in 0..2 {
            let places: Vec<i32> = self.places.iter().map(|place| place[axis]).collect();
            keep_limits(&places, f64::from(PULSES[axis]), 6.0);
        }
    }

    /// The first tick from `from` on at a stage.
    pub(crate) fn first(&self, stage: ThreadStage, from: u32) -> Option<usize> {
        (from as usize..self.stages.len()).find(|at| self.stages[*at] == stage)
    }
}

/// 2 mm at 600/min are 20 mm/s: 0.53 mm to fall in with 375 mm/s2, 0.4 mm to brake; with a wobble's margin, in pulses.
const RUN_IN: i32 = 260;
const RUN_OUT: i32 = 200;

#[test]
fn a_hold_in_a_thread_leaves_in_step_and_repeats_the_pass() {
    for hold in [1_310, 1_600, 1_700, 2_011, 2_900, 3_200, 3_300] {
        let acts = [(0, Act::Rpm(600.0)), (1_000, Act::Start), (hold, Act::Hold), (hold + 900, Act::Start)];
        let run = run(&guarded(2_000), 9_000, &acts);
        let stages = [ThreadStage::Leaving, ThreadStage::Left, ThreadStage::Returning, ThreadStage::Entering];
        let at: Vec<usize> = stages.iter().map(|stage| run.first(*stage, 0).unwrap_or(0)).collect();
        assert!(at.is_sorted() && at[0] >= hold as usize && at[0] < hold as usize + 3, "{hold}: {at:?}");
        // back with X out, in with Z at the start
        assert!(run.places[at[2]..at[3]].iter().all(|place| place[0] == -OUTSIDE + 1_600), "{hold}");
        assert_eq!(run.places[at[3]][1], 0);
        assert!(run.worst(RUN_IN, RUN_OUT) <= 1.5, "{hold}: {}", run.worst(RUN_IN, RUN_OUT));
        let full = run.cut.iter().filter(|cut| cut.moved < 0).map(|cut| cut.z).min();
        assert_eq!((full, run.states.last()), (Some(END), Some(&State::Ended)), "{hold}");
        assert_eq!(run.places.last(), Some(&[0, END]));
        assert_eq!((run.bench.channel.retracted(), run.bench.channel.position().z), (0, END));
        run.keep_limits();
    }
}

#[test]
fn a_hold_before_the_cut_waits_at_the_start() {
    let acts = [(0, Act::Rpm(600.0)), (1_000, Act::Start), (1_290, Act::Hold), (2_000, Act::Start)];
    let run = run(&guarded(2_000), 6_000, &acts);
    assert_eq!(run.first(ThreadStage::Leaving, 0), None);
    assert!(run.places[1_300..2_000].iter().all(|place| *place == [-OUTSIDE, 0]));
    assert!(run.worst(RUN_IN, RUN_OUT) <= 1.5 && run.places.last() == Some(&[0, END]));
}

#[test]
fn holds_on_the_way_back_and_in_leave_x_out() {
    // back from tick 2500 to 2765, in from there to 2911
    for (hold, first) in [(2_600, ThreadStage::Returning), (2_800, ThreadStage::Entering)] {
        let acts = [
            (0, Act::Rpm(600.0)),
            (1_000, Act::Start),
            (1_600, Act::Hold),
            (2_500, Act::Start),
            (hold, Act::Hold),
            (hold + 600, Act::Start),
        ];
        let run = run(&guarded(2_000), 9_000, &acts);
        assert_eq!(run.stages[hold as usize - 1], first);
        assert_eq!(run.places[hold as usize + 599], run.places[hold as usize + 400], "it stands");
        assert_eq!(run.places[hold as usize + 599][0], -OUTSIDE + 1_600, "with X out");
        assert!(run.worst(RUN_IN, RUN_OUT) <= 1.5, "{}", run.worst(RUN_IN, RUN_OUT));
        assert_eq!(run.places.last(), Some(&[0, END]));
        run.keep_limits();
    }
}

#[test]
fn without_a_way_out_a_hold_acts_at_the_end() {
    let acts = [(0, Act::Rpm(600.0)), (1_000, Act::Start), (1_600, Act::Hold)];
    let run = run(&guarded(0), 5_000, &acts);
    assert_eq!(run.first(ThreadStage::Leaving, 0), None);
    assert_eq!((run.places.last(), run.states.last()), (Some(&[-OUTSIDE, END]), Some(&State::Holding)));
    assert!(run.worst(RUN_IN, RUN_OUT) <= 1.5);
}

#[test]
fn a_reset_leaves_the_groove_and_the_position_is_true() {
    for reset in [1_290, 1_600, 1_650, 3_300] {
        let acts = [(0, Act::Rpm(600.0)), (1_000, Act::Start), (reset, Act::Reset)];
        let run = run(&guarded(2_000), 4_000, &acts);
        assert_eq!(run.states.last(), Some(&State::Idle));
        let x = if reset < 1_300 { -OUTSIDE } else { -OUTSIDE + 1_600 };
        let [at_x, at_z] = *run.places.last().unwrap();
        let position = run.bench.channel.position();
        assert_eq!((at_x, at_x, at_z), (x, position.x, position.z), "{reset}");
        assert_eq!(run.bench.channel.retracted(), 0);
        assert!(run.worst(RUN_IN, RUN_OUT) <= 1.5, "{reset}: {}", run.worst(RUN_IN, RUN_OUT));
        run.keep_limits();
    }
}

#[test]
fn a_reset_on_the_way_in_goes_out_again() {
    let acts =
        [(0, Act::Rpm(600.0)), (1_000, Act::Start), (1_600, Act::Hold), (2_500, Act::Start), (2_800, Act::Reset)];
    let run = run(&guarded(2_000), 4_000, &acts);
    assert_eq!((run.states.last(), run.places.last()), (Some(&State::Idle), Some(&[-OUTSIDE + 1_600, 0])));
    assert_eq!(run.bench.channel.position().x, -OUTSIDE + 1_600);
}

/// The fault that was told first, its tick, and what came of it: X out, in step, and the channel holds.
fn fault(acts: &[(u32, Act)]) -> (Trouble, usize, Run) {
    let run = run(&guarded(2_000), 6_000, acts);
    let at = run.faults.iter().position(Option::is_some).unwrap();
    let trouble = run.faults[at].unwrap();
    assert_eq!((run.states.last(), run.faults.last()), (Some(&State::Holding), Some(&Some(trouble))));
    assert_eq!(run.stages.last(), Some(&ThreadStage::Left));
    assert_eq!(run.places.last().unwrap()[0], -OUTSIDE + 1_600);
    run.keep_limits();
    (trouble, at, run)
}

const START: [(u32, Act); 2] = [(0, Act::Rpm(600.0)), (1_000, Act::Start)];

fn with(acts: &[(u32, Act)]) -> Vec<(u32, Act)> {
    START.iter().chain(acts).copied().collect()
}

/// From tick 2000 on the spindle changes its speed by 2000/min in a second.
fn ramp(to: f64) -> Vec<(u32, Act)> {
    let speed = |tick: u32| (600.0 - 2.0 * f64::from(tick - 2_000)).max(to);
    with(&(2_000..2_500).map(|tick| (tick, Act::Rpm(speed(tick)))).collect::<Vec<_>>())
}

#[test]
fn a_spindle_that_stops_in_a_thread_is_told_and_left_in_step() {
    let (trouble, at, run) = fault(&ramp(0.0));
    assert_eq!(trouble, Trouble::Stopped);
    // it hardly turns below a 16th of its speed, from tick 2281 on, and 100 ticks later it is sure
    assert!((2_381..2_395).contains(&at), "{at}");
    assert!(run.worst(RUN_IN, RUN_OUT) <= 1.5, "{}", run.worst(RUN_IN, RUN_OUT));
}

#[test]
fn a_spindle_that_turns_round_in_a_thread_is_told_and_left_in_step() {
    let (trouble, at, run) = fault(&ramp(-100.0));
    assert_eq!(trouble, Trouble::Reversed);
    // 37.5 the other way are reached at tick 2319
    assert!((2_319..2_330).contains(&at), "{at}");
    assert!(run.worst(RUN_IN, RUN_OUT) <= 1.5, "{}", run.worst(RUN_IN, RUN_OUT));
}

/// A spindle that is caught within milliseconds can't be followed: the groove is spoiled, and that is told.
#[test]
fn a_spindle_that_is_caught_is_told_at_once() {
    let (trouble, at, _) = fault(&with(&[(2_000, Act::Rpm(0.0))]));
    assert!(matches!(trouble, Trouble::TooHard { .. }), "{trouble:?}");
    assert!((2_000..2_030).contains(&at), "{at}");
}

#[test]
fn a_lost_index_is_told_after_one_and_a_half_turns() {
    let (trouble, at, run) = fault(&with(&[(2_000, Act::Index(false))]));
    assert_eq!(trouble, Trouble::IndexLost);
    // a turn is 100 ms
    assert!((2_050..2_160).contains(&at), "{at}");
    assert!(run.worst(RUN_IN, RUN_OUT) <= 1.5);
}

#[test]
fn noise_is_told_with_the_next_index() {
    let (trouble, at, _) = fault(&with(&[(2_000, Act::Lose(7))]));
    assert_eq!(trouble, Trouble::Index { off: -7 });
    assert!((2_000..2_110).contains(&at), "{at}");
}

/// What was wrong is mended: the pass is repeated in the same groove, though the count of the index has changed.
#[test]
fn after_a_fault_the_pass_is_repeated_in_its_groove() {
    for mend in [vec![(2_000, Act::Lose(7))], vec![(2_000, Act::Index(false)), (3_000, Act::Index(true))]] {
        let acts: Vec<_> = START.into_iter().chain(mend).chain([(3_500, Act::Start)]).collect();
        let run = run(&guarded(2_000), 9_000, &acts);
        let again: Vec<&Cut> = run.cut.iter().filter(|cut| cut.tick > 3_500 && cut.moved < 0).collect();
        assert_eq!(again.iter().map(|cut| cut.z).min(), Some(END));
        let within = |cut: &&&Cut| cut.z < -RUN_IN && cut.z > END + RUN_OUT;
        let worst = again.iter().filter(within).map(|cut| Run::off(cut)).fold(0.0, f64::max);
        assert!(worst <= 1.5, "{worst}");
        assert_eq!(run.places.last(), Some(&[0, END]));
    }
}

#[test]
fn a_spindle_that_does_not_turn_is_waited_for_for_five_seconds() {
    let run = run(&guarded(2_000), 7_000, &[(1_000, Act::Start)]);
    let from = run.first(ThreadStage::Waiting, 0).unwrap();
    let at = run.faults.iter().position(Option::is_some).unwrap();
    assert_eq!(run.faults[at], Some(Trouble::NoSpindle));
    assert!((5_000..5_003).contains(&(at - from)), "{}", at - from);
    assert_eq!((run.places.last(), run.states.last()), (Some(&[-OUTSIDE, 0]), Some(&State::Holding)));
}

#[test]
fn an_index_that_never_comes_is_no_reason_to_wait() {
    let run = run(&guarded(2_000), 3_000, &[(0, Act::Index(false)), (0, Act::Rpm(600.0)), (1_000, Act::Start)]);
    let from = run.first(ThreadStage::Waiting, 0).unwrap();
    let at = run.faults.iter().position(Option::is_some).unwrap();
    assert_eq!(run.faults[at], Some(Trouble::IndexLost));
    assert!((140..160).contains(&(at - from)), "{}", at - from);
}

#[test]
fn a_thread_too_fast_for_the_axis_does_not_begin() {
    // 2600/min of 2 mm are 86.7 mm/s, and Z makes 83.3
    let run = run(&guarded(2_000), 3_000, &[(0, Act::Rpm(2_600.0)), (1_000, Act::Start)]);
    let at = run.faults.iter().position(Option::is_some).unwrap();
    let Some(Trouble::TooFast { needed, limit }) = run.faults[at] else { panic!("{:?}", run.faults[at]) };
    // nm a tick with 12 fraction bits
    assert!(
        (f64::from(needed) / 4096.0 / 1e3 - 86.67).abs() < 0.1 && (f64::from(limit) / 4096.0 / 1e3 - 83.33).abs() < 0.1
    );
    assert_eq!(run.places.last(), Some(&[-OUTSIDE, 0]));
}

#[test]
fn a_thread_that_becomes_too_fast_is_left() {
    let (trouble, ..) = fault(&with(&[(2_000, Act::Rpm(2_700.0))]));
    assert!(matches!(trouble, Trouble::TooFast { .. } | Trouble::TooHard { .. }), "{trouble:?}");
}

/// An encoder with other counts than the control was told: the index never comes where whole turns put it.
#[test]
fn a_wrong_number_of_counts_is_told_and_not_cut() {
    let threading = Threading { encoder: 4_000, ..guarded(2_000).threading };
    let machine = Machine { threading, ..guarded(2_000) };
    let run = run(&machine, 4_000, &START);
    let at = run.faults.iter().position(Option::is_some).unwrap();
    // 96 counts a turn too many
    assert!(matches!(run.faults[at], Some(Trouble::Index { off: 90..=99 })), "{:?}", run.faults[at]);
    assert!(run.places.iter().all(|place| place[1] > -2_000), "{:?}", run.places.last());
}
