//! The desktop's train: the firmware's own foreground and background, run here.

use anyhow::{Result, bail};
use feature_editor::codes::{Detector, Format, Item};
use handcnc::background::compile::{Compiler, Finding};
use handcnc::background::parameters::Parameters;
use handcnc::foreground::{BLOCK_QUEUE, COMMAND_QUEUE, Command, Foreground, Memory};
use handcnc::queue::Queue;
use interp_core::block::{Block, Work};
use interp_core::channel::State;
use interp_core::config::Machine;
use interp_core::train::Event;
use interp_core::units::Lattice;
use std::collections::VecDeque;

use crate::trial::Trial;

/// A program whose every line is good.
pub(crate) struct Program {
    /// Its lines.
    pub(crate) lines: Vec<Vec<u8>>,
    /// How it is written.
    pub(crate) format: Format,
    /// Whether a line ends it.
    pub(crate) ends: bool,
}

impl Program {
    /// Reads and checks a program.
    pub(crate) fn read(text: &[u8], parameters: &Parameters, machine: &Machine) -> Result<Self> {
        let text = text.strip_suffix(b"\n").unwrap_or(text);
        let lines: Vec<Vec<u8>> = text.split(|byte| *byte == b'\n').map(<[u8]>::to_vec).collect();
        let mut detector = Detector::new();
        lines.iter().for_each(|line| detector.line(line));
        let format = detector.format();
        let mut compiler = Compiler::new(parameters.settings(), format, machine);
        let mut found: Option<Finding> = None;
        for line in &lines {
            compiler.line(line, &mut |_, _| {}, &mut |finding| {
                if finding.is_error() {
                    found = found.or(Some(finding));
                }
            });
        }
        if let Some(finding) = found {
            bail!("line {}: {finding}", finding.line());
        }
        Ok(Self { lines, format, ends: compiler.is_ended() })
    }
}

/// Where a train goes: the events of one tick. False ends the run.
pub(crate) type Take<'a> = dyn FnMut(&[Event]) -> bool + 'a;

/// Runs a trial and gives the events of each tick of its cycle. No more than `most` blocks are handed over.
pub(crate) fn run(trial: &Trial, most: usize, take: &mut Take<'_>) -> Result<()> {
    let Trial { program, parameters, machine, rehearsal, .. } = trial;
    let mut rehearsal = rehearsal.clone();
    let mut compiler = Compiler::new(parameters.settings(), program.format, machine);
    let start = parameters.start();
    let position = Lattice { x: machine.x.pulse.nearest(start.x), z: machine.z.pulse.nearest(start.z) };
    let (mut blocks, mut commands) = (Queue::<Block, BLOCK_QUEUE>::new(), Queue::<Command, COMMAND_QUEUE>::new());
    let (mut block_in, block_out) = blocks.split();
    let (_, command_out) = commands.split();
    let mut memory = Memory::new();
    let mut foreground = Foreground::new(machine, position, block_out, command_out, &mut memory);
    foreground.obey(Command::FeedOverride(parameters.feed_override()));
    foreground.obey(Command::OptionalStop(parameters.optional_stop()));
    foreground.obey(Command::Settle(parameters.operation(machine)));
    foreground.obey(Command::Start);
    let mut lines = program.lines.iter();
    let mut ready: VecDeque<Block> = VecDeque::new();
    let mut ended = false;
    let mut left = most;
    let ended_by = loop {
        while left > 0 && block_in.ready() {
            while ready.is_empty() && !ended {
                match lines.next() {
                    Some(line) => {
                        compiler.line(line, &mut |_: &Item, blocks| ready.extend(blocks), &mut |_| {});
                    }
                    None => {
                        compiler.flush(&mut |_: &Item, blocks| ready.extend(blocks));
                        ready.push_back(Compiler::end_block(0));
                    }
                }
                ended = ready.iter().any(|block| matches!(block.work, Work::End));
            }
            let Some(block) = ready.pop_front() else { break };
            if block_in.enqueue(block).is_err() {
                bail!("the queue of blocks is full");
            }
            left -= 1;
        }
        let mut events = Vec::new();
        rehearsal.due(foreground.state(), &mut |act| foreground.act(act));
        let report = foreground.tick(&mut |event| events.push(event));
        if report.in_cycle && !take(&events) {
            return Ok(());
        }
        if matches!(report.state, State::Ended | State::Idle) {
            break report.state;
        }
    };
    // the last pulse's falling edge may lie in the next tick; then the chip idles. After a reset the link soon goes on
    // with the rest of the program, which is no part of the cycle.
    let behind = if ended_by == State::Ended { 20 } else { 2 };
    for _ in 0..behind {
        let mut events = Vec::new();
        foreground.tick(&mut |event| events.push(event));
        if !take(&events) {
            break;
        }
    }
    Ok(())
}
