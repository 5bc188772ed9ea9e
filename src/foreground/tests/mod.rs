//! The operator's machine on a bench: requests and readings in, pulses out.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "tests"
)]

mod coordinates;
mod counts;
mod drives;
mod intervention;
mod panel;
mod power;
mod state;
mod threads;
mod wheels;

extern crate std;

use std::boxed::Box;
use std::collections::VecDeque;
use std::vec::Vec;

use super::inputs::{Inputs, Joystick};
use super::mode::Mode;
use super::shown::Shown;
use super::*;
use crate::background::compile::Compiler;
use crate::background::parameters::Parameters;
use crate::queue::{Producer, Queue};
use feature_editor::codes::Format;
use interp_core::train::Event;
use interp_core::units::Point;

/// Counts a turn of the spindle's encoder.
const COUNTS: f64 = 4096.0;

/// A lathe whose pulses are counted.
struct Bench {
    foreground: Foreground<'static>,
    blocks: Producer<'static, Block>,
    program: VecDeque<Block>,
    parameters: Parameters,
    inputs: Inputs,
    open: bool,
    levels: interp_core::train::Levels,
    /// Counted on the pins.
    at: Lattice,
    /// Where the axes were at each tick's end.
    track: Vec<Lattice>,
    /// The spindle: counts, and counts a tick.
    spindle: f64,
    rate: f64,
}

impl Bench {
    fn new() -> Self {
        Self::with(&[])
    }

    fn with(set: &[(&str, &str)]) -> Self {
        let mut parameters = Parameters::new();
        parameters.set("handwheels", "true").unwrap();
        for (name, value) in set {
            parameters.set(name, value).unwrap();
        }
        let machine = parameters.machine().unwrap();
        let blocks = Box::leak(Box::new(Queue::<Block, BLOCK_QUEUE>::new()));
        let commands = Box::leak(Box::new(Queue::<Command, COMMAND_QUEUE>::new()));
        let ((blocks, block_out), (_, command_out)) = (blocks.split(), commands.split());
        let memory = Box::leak(Box::default());
        let mut foreground = Foreground::new(&machine, Lattice::default(), block_out, command_out, memory);
        foreground.request(Command::Settle(parameters.operation(&machine))).unwrap();
        foreground.set_encoder(Some(4096));
        let (inputs, levels) = (Inputs::NONE, interp_core::train::Levels::LOW);
        let program = VecDeque::new();
        let at = Lattice::default();
        Self {
            foreground,
            blocks,
            program,
            parameters,
            inputs,
            open: false,
            levels,
            at,
            track: Vec::new(),
            spindle: 0.0,
            rate: 0.0,
        }
    }

    fn mode(mode: Mode) -> Self {
        let mut bench = Self::new();
        bench.ask(Command::Mode(mode)).unwrap();
        bench
    }

    fn ask(&mut self, command: Command) -> Result<(), Refusal> {
        self.foreground.request(command)
    }

    /// Compiles a program from where the lathe's program is.
    fn load(&mut self, text: &str) {
        let mut settings = self.parameters.settings();
        let (x, z) = self.foreground.programmed_nm().unwrap();
        settings.start = Point { x, z };
        let mut compiler = Compiler::new(settings, Format::Gcode, &self.parameters.machine().unwrap());
        let program = &mut self.program;
        for line in text.lines() {
            compiler.line(line.as_bytes(), &mut |_, blocks| program.extend(blocks), &mut |finding| {
                assert!(!finding.is_error(), "{line}: {finding}")
            });
        }
        compiler.flush(&mut |_, blocks| program.extend(blocks));
        if !compiler.is_ended() {
            self.program.push_back(Compiler::end_block(0));
        }
    }

    fn tick(&mut self) -> Report {
        while self.blocks.ready() {
            let Some(block) = self.program.pop_front() else { break };
            assert!(self.blocks.enqueue(block).is_ok());
        }
        self.foreground.watch(Faults::default(), self.open);
        let before = self.spindle;
        self.spindle += self.rate;
        let turn = |counts: f64| (counts / COUNTS).floor() as i64;
        let (before, now) = (turn(before), turn(self.spindle));
        let index = (before != now).then(|| (before.max(now) * 4096) as u16);
        let counts = self.spindle.floor() as i64 as u16;
        self.inputs.spindle = Some(interp_core::drive::spindle::Reading { counts, index });
        self.foreground.read(&self.inputs);
        self.inputs.wheels = PerAxis::default();
        self.inputs.contour = 0;
        let (levels, at) = (&mut self.levels, &mut self.at);
        let mut clocks = 0;
        let report = self.foreground.tick(&mut |event: Event| {
            let now = event.levels();
            for axis in inputs::AXES {
                if now.step(axis) && !levels.step(axis) {
                    *desk::part_mut(at, axis) += if now.plus(axis) { 1 } else { -1 };
                }
            }
            *levels = now;
            clocks += event.interval();
        });
        assert_eq!(clocks, interp_core::config::TICK_CLOCKS);
        self.track.push(self.at);
        report
    }

    fn ticks(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    /// Turns a wheel by counts a tick.
    fn turn(&mut self, axis: Axis, counts: i16, ticks: u32) {
        for _ in 0..ticks {
            *self.inputs.wheels.of_mut(axis) = counts;
            self.tick();
        }
    }

    fn turn_contour(&mut self, counts: i16, ticks: u32) {
        for _ in 0..ticks {
            self.inputs.contour = counts;
            self.tick();
        }
    }

    /// Ticks until nothing moves for a while.
    fn settle(&mut self) {
        let mut still = 0;
        for _ in 0..1_000_000 {
            let before = self.at;
            self.tick();
            still = if self.at == before { still + 1 } else { 0 };
            if still == 60 {
                return;
            }
        }
        panic!("it never stands");
    }

    fn shown(&self) -> Shown {
        let shown = self.foreground.shown();
        assert_eq!(shown.position, self.foreground.position());
        shown
    }

    /// The last refusal, if any.
    fn refused(&mut self) -> Option<Refusal> {
        std::iter::from_fn(|| self.foreground.refused()).last()
    }

    /// Speed and acceleration of the whole track keep the machine's limits, whatever was done: over h = 1, 2, 4 .. 256 ticks
    /// at most v h + 1 pulses, and a second difference of a h^2 + 2 and a jump at a start or stop on each side.
    fn keep_limits(&self) {
        let machine = self.parameters.machine().unwrap();
        for axis in inputs::AXES {
            let limits = if axis == Axis::X { machine.x } else { machine.z };
            let nm = f64::from(limits.pulse.numerator()) / f64::from(limits.pulse.denominator()) * 4096.0;
            let (v, a) = (f64::from(limits.speed) / nm, f64::from(limits.accel + limits.by_hand) / nm);
            let jump = f64::from(limits.jump) / nm;
            let places: Vec<f64> = self.track.iter().map(|at| f64::from(desk::part(*at, axis))).collect();
            for h in (0..9).map(|n| 1_usize << n) {
                for at in 2 * h..places.len() {
                    let (first, middle, last) = (places[at - 2 * h], places[at - h], places[at]);
                    let span = h as f64;
                    assert!((last - middle).abs() <= v * span + 2.0, "{axis:?}, tick {at}: {} in {h}", last - middle);
                    let bend = (last - 2.0 * middle + first).abs();
                    let bound = a * span * span + 4.0 + 2.0 * jump * span;
                    assert!(bend <= bound, "{axis:?}, tick {at}: {bend} of {bound} over {h} ticks");
                }
            }
        }
    }
}

#[test]
fn nothing_starts_a_locked_machine_and_its_blocks_are_forgotten() {
    let mut bench = Bench::new();
    bench.foreground.raise(Alarm::Watchdog);
    bench.load("G0 X1");
    assert_eq!(bench.ask(Command::Start), Err(Refusal::Alarm(Alarm::Watchdog)));
    let report = bench.tick();
    assert_eq!((report.state, bench.blocks.is_empty()), (State::Idle, true));
    bench.ask(Command::Unlock).unwrap();
    // the watchdog's restart may have cost pulses
    assert_eq!(bench.ask(Command::Start), Err(Refusal::Unverified));
    bench.ask(Command::ConfirmPosition).unwrap();
    bench.ask(Command::Start).unwrap();
    assert_eq!((bench.foreground.alarm(), bench.foreground.state()), (None, State::Filling));
}

#[test]
fn every_state_comes_back_from_its_number() {
    let states = [0, 1, 2, 3, 4, 5, 6].map(word_state);
    assert_eq!(states.map(state_word), [0, 1, 2, 3, 4, 5, 6]);
}
