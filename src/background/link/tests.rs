//! Bytes in, replies and pulses out: the link with a real foreground behind it.

extern crate std;

mod alarms;
mod blends;
mod commands;
mod hostile;
mod lines;
mod panel;
mod realtime_bytes;
mod requests;
mod streams;

use super::*;
use crate::foreground::alarm::Faults;
use crate::foreground::{BLOCK_QUEUE, COMMAND_QUEUE, Foreground};
use crate::queue::Queue;
use interp_core::train::{Event, Hash};
use interp_core::units::{Axis, Lattice};
use std::boxed::Box;
use std::string::{String, ToString};
use std::vec::Vec;

/// What a run of the train was, up to the last tick that moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Train {
    hash: u64,
    ticks: u64,
    pulses: u64,
}

/// A link, its foreground, and the wire.
struct Bench {
    link: Link,
    foreground: Foreground<'static>,
    blocks: Producer<'static, Block>,
    commands: Producer<'static, Command>,
    snapshot: Snapshot,
    /// What the board counted.
    faults: Faults,
    /// The emergency input is open.
    open: bool,
    /// What came back.
    out: String,
    hash: Hash,
    ticks: u64,
    levels: u16,
    counted: Lattice,
    pulses: u64,
    train: Train,
}

impl Bench {
    fn new() -> Self {
        Self::with(&[])
    }

    fn with(set: &[(&str, &str)]) -> Self {
        let mut parameters = Parameters::new();
        set.iter().for_each(|(name, value)| parameters.set(name, value).unwrap());
        let machine = parameters.machine().unwrap();
        let (start, pulse) = (parameters.start(), (machine.x.pulse, machine.z.pulse));
        let position = Lattice { x: pulse.0.nearest(start.x), z: pulse.1.nearest(start.z) };
        let (blocks, block_out) = Box::leak(Box::new(Queue::<Block, BLOCK_QUEUE>::new())).split();
        let (commands, command_out) = Box::leak(Box::new(Queue::<Command, COMMAND_QUEUE>::new())).split();
        let snapshot = Snapshot::at(position);
        Self {
            link: Link::new(parameters, machine),
            foreground: Foreground::new(&machine, position, block_out, command_out, Box::leak(Box::default())),
            blocks,
            commands,
            snapshot,
            faults: Faults::default(),
            open: false,
            out: String::new(),
            hash: Hash::new(),
            ticks: 0,
            levels: 0,
            counted: position,
            pulses: 0,
            train: Train { hash: Hash::new().value(), ticks: 0, pulses: 0 },
        }
    }

    /// A long motion, well under way.
    fn under_way() -> Self {
        let mut bench = Self::new();
        bench.ask("G1 X50 Z50 F1000\nX0 Z0\nM30\n");
        bench.ticks(1_000);
        assert!(bench.status().starts_with("Run|"));
        bench.out.clear();
        bench
    }

    /// Puts bytes on the wire.
    fn send(&mut self, bytes: impl AsRef<[u8]>) {
        for &byte in bytes.as_ref() {
            match realtime(byte) {
                Some(what) => self.link.realtime(what, &mut self.commands, &self.snapshot, &mut self.out),
                None => self.link.receive(byte),
            }
        }
    }

    /// Lets the background work until nothing is left to do.
    fn work(&mut self) {
        let mut left = 10_000;
        while self.link.work(&mut self.blocks, &mut self.commands, &self.snapshot, &mut self.out) {
            left -= 1;
            assert!(left > 0, "the background never rests");
        }
    }

    /// Work, then a tick.
    fn tick(&mut self) {
        self.work();
        let mut events = Vec::new();
        self.foreground.watch(self.faults, self.open);
        let report = self.foreground.tick(&mut |event: Event| events.push(event));
        let before = self.pulses;
        events.iter().for_each(|event| self.play(*event));
        if report.in_cycle {
            events.iter().for_each(|event| self.hash.event(*event));
            self.ticks += 1;
            if self.pulses != before {
                self.train = Train { hash: self.hash.value(), ticks: self.ticks, pulses: self.pulses };
            }
        }
        self.snapshot = Snapshot::of(&report, &self.foreground);
    }

    /// Counts rising edges: where the motors are.
    fn play(&mut self, event: Event) {
        let (now, before) = (event.levels(), interp_core::train::Levels::from_bits(self.levels));
        let step = |axis: Axis| match (now.step(axis) && !before.step(axis), now.plus(axis)) {
            (false, _) => 0,
            (true, true) => 1,
            (true, false) => -1,
        };
        let (x, z): (i32, i32) = (step(Axis::X), step(Axis::Z));
        self.counted = Lattice { x: self.counted.x + x, z: self.counted.z + z };
        self.pulses += u64::from(x.unsigned_abs() + z.unsigned_abs());
        self.levels = now.bits();
    }

    fn ticks(&mut self, count: usize) {
        (0..count).for_each(|_| self.tick());
    }

    /// The status report's first two fields.
    fn status(&mut self) -> String {
        let kept = self.out.len();
        self.send("?");
        let report = self.out.split_off(kept);
        report.trim_start_matches('<').splitn(3, '|').take(2).collect::<Vec<_>>().join("|")
    }

    /// Ticks until the link says idle.
    fn until_idle(&mut self) {
        for _ in 0..10_000_000 {
            self.tick();
            if self.status().starts_with("Idle") {
                // the last falling edges
                return self.ticks(3);
            }
        }
        panic!("never idle: {}", self.status());
    }

    /// Takes what came back, line by line; `ok` and `error:N` only.
    fn answers(&mut self) -> Vec<String> {
        let is_answer = |line: &&str| *line == "ok" || line.starts_with("error:");
        let answers = self.out.lines().filter(is_answer).map(ToString::to_string).collect();
        self.out.clear();
        answers
    }

    /// Sends lines, lets the background work, takes all that came back.
    fn ask(&mut self, lines: &str) -> String {
        self.send(lines);
        self.work();
        std::mem::take(&mut self.out)
    }

    /// Streams a program counting characters, as many in flight as Grbl's receive buffer has. The answers.
    fn stream(&mut self, text: &[u8]) -> Vec<String> {
        let mut lines = text.split_inclusive(|byte| *byte == b'\n').peekable();
        let mut in_flight = std::collections::VecDeque::new();
        let mut answers = Vec::new();
        for _ in 0..10_000_000 {
            loop {
                let mut moved = false;
                while let Some(line) =
                    lines.next_if(|line| in_flight.iter().sum::<usize>() + line.len() <= 127 || in_flight.is_empty())
                {
                    in_flight.push_back(line.len());
                    self.send(line);
                    moved = true;
                }
                self.work();
                for answer in self.answers() {
                    in_flight.pop_front().unwrap();
                    answers.push(answer);
                    moved = true;
                }
                if !moved {
                    break;
                }
            }
            if in_flight.is_empty() && lines.peek().is_none() {
                return answers;
            }
            self.tick();
        }
        panic!("lines are left without an answer");
    }
}

/// What the foreground makes of a program when nothing stands between it and the compiler.
fn without_link(text: &str) -> Train {
    let mut bench = Bench::new();
    let parameters = Parameters::new();
    let mut compiler = Compiler::new(parameters.settings(), Format::Gcode, &parameters.machine().unwrap());
    let mut ready = std::collections::VecDeque::new();
    for line in text.lines() {
        compiler.line(line.as_bytes(), &mut |_, blocks| ready.extend(blocks.iter().copied()), &mut |finding| {
            assert!(!finding.is_error(), "{line}: {finding}");
        });
    }
    bench.commands.enqueue(Command::Start).unwrap();
    while bench.snapshot.state != State::Ended {
        while bench.blocks.ready()
            && let Some(block) = ready.pop_front()
        {
            bench.blocks.enqueue(block).unwrap();
        }
        // the link has nothing to say to a foreground that is busy
        bench.tick();
    }
    bench.train
}

const DEMO: &str = include_str!("../../../virtual-lathe/src/demo/handle.nc");

/// The demo's train as the command `turn` reports it.
const DEMO_HASH: u64 = 0x3738_7de0_1abb_c410;
