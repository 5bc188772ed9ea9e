//! The lathe on the desk: runs a program through the firmware's own background and foreground.
//!
//! The two sides take turns in one thread: before each tick the background compiles until the queue of blocks is
//! full, so the look-ahead never lacks a block that the program has.

use std::collections::VecDeque;
use std::{fmt, io};

use feature_editor::codes::{Format, Item};
use figures::Figures;
use handcnc::background::compile::{Compiler, Finding};
use handcnc::background::parameters::Parameters;
use handcnc::foreground::alarm::Alarm;
use handcnc::foreground::{BLOCK_QUEUE, COMMAND_QUEUE, Command, Foreground, Memory};
use handcnc::queue::Queue;
use interp_core::block::Block;
use interp_core::channel::{Report, State};
use interp_core::config::{Machine, TICK_CLOCKS};
use interp_core::curve::Step;
use interp_core::train::{Event, Train};
use interp_core::units::{Axis, Lattice, Point};
use measure::{Added, PerAxis};

use crate::pitch_table::Tables;
use crate::program::{Lines, Program};
use crate::settings::TABLES;
use crate::spindle::Turning;

/// What watches a run.
pub trait Observer {
    /// The background compiled an action, ahead of its execution; `blocks` is how many blocks it made.
    fn compiled(&mut self, _item: &Item, _blocks: usize) {}

    /// In the tick that comes next the motors differ from the program so.
    fn superposed(&mut self, _added: &[Added]) {}

    /// The foreground made a tick that belongs to a cycle.
    ///
    /// # Errors
    /// What the observer writes to.
    fn tick(&mut self, events: &[u32], report: &Report) -> io::Result<()>;

    /// A command was given, to act from the next tick on.
    fn commanded(&mut self, _command: Command) {}

    /// A programmed stop was passed by.
    fn stopped(&mut self, _line: u32) {}

    /// Bytes of the program read so far.
    fn progress(&mut self, _bytes: u64) {}
}

/// Two that watch one run, the first one first.
impl<A: Observer, B: Observer> Observer for (&mut A, &mut B) {
    fn compiled(&mut self, item: &Item, blocks: usize) {
        self.0.compiled(item, blocks);
        self.1.compiled(item, blocks);
    }

    fn superposed(&mut self, added: &[Added]) {
        self.0.superposed(added);
        self.1.superposed(added);
    }

    fn tick(&mut self, events: &[u32], report: &Report) -> io::Result<()> {
        self.0.tick(events, report)?;
        self.1.tick(events, report)
    }

    fn commanded(&mut self, command: Command) {
        self.0.commanded(command);
        self.1.commanded(command);
    }

    fn stopped(&mut self, line: u32) {
        self.0.stopped(line);
        self.1.stopped(line);
    }

    fn progress(&mut self, bytes: u64) {
        self.0.progress(bytes);
        self.1.progress(bytes);
    }
}

/// What checking a program found.
#[derive(Debug, Default)]
pub struct Checked {
    /// Findings in the order of the program, with their lines; at most [`FINDINGS_KEPT`] errors and as many warnings.
    pub findings: Vec<(Finding, Vec<u8>)>,
    /// All errors.
    pub errors: usize,
    /// All warnings.
    pub warnings: usize,
    /// Lines of the program.
    pub lines: u64,
}

/// Errors, and warnings, of a program that are kept.
pub const FINDINGS_KEPT: usize = 100;

/// Checks a whole program; moves nothing. `action` gets every action of a good line.
///
/// # Errors
/// Those of reading it.
pub fn check(
    program: &Program,
    format: Format,
    parameters: &Parameters,
    machine: &Machine,
    action: &mut impl FnMut(&Item),
    progress: &mut impl FnMut(u64),
) -> io::Result<Checked> {
    let mut checked = Checked::default();
    let mut compiler = Compiler::new(parameters.settings(), format, machine);
    let mut lines = program.lines()?;
    let mut last = Vec::new();
    loop {
        let read = lines.bytes();
        let Some(line) = lines.next_line()? else { break };
        checked.lines += 1;
        if checked.lines.is_multiple_of(1024) {
            progress(read);
        }
        let mut found = Vec::new();
        compiler.line(line, &mut |item, _| action(item), &mut |finding| found.push(finding));
        found.sort_by_key(Finding::span);
        for finding in found {
            checked.keep(finding, line);
        }
        last.clear();
        last.extend_from_slice(line.get(..line.len().min(256)).unwrap_or_default());
    }
    compiler.flush(&mut |item, _| action(item));
    let mut found = Vec::new();
    compiler.finish(&mut |finding| found.push(finding));
    for finding in found {
        checked.keep(finding, &last);
    }
    Ok(checked)
}

impl Checked {
    fn keep(&mut self, finding: Finding, line: &[u8]) {
        let count = if finding.is_error() { &mut self.errors } else { &mut self.warnings };
        *count += 1;
        if *count <= FINDINGS_KEPT {
            self.findings.push((finding, line.to_vec()));
        }
    }
}

/// Watches nothing.
pub(crate) struct Nobody;

impl Observer for Nobody {
    fn tick(&mut self, _: &[u32], _: &Report) -> io::Result<()> {
        Ok(())
    }
}

/// The background's side of a run: a program on its way into the queue.
pub(crate) struct Source {
    lines: Lines,
    compiler: Compiler,
    ready: VecDeque<Block>,
    line: u32,
    ended: bool,
}

impl Source {
    /// A program from its first line.
    pub(crate) fn new(lines: Lines, compiler: Compiler) -> Self {
        Self { lines, compiler, ready: VecDeque::new(), line: 0, ended: false }
    }

    /// The lattice point that everything compiled so far leads to.
    pub(crate) fn lattice(&self) -> Lattice {
        self.compiler.lattice()
    }

    /// Compiles up to a line, from 1, whose blocks come next; `passed` gets those before. Where the line begins, as
    /// programmed; `None` where the program ends before.
    ///
    /// # Errors
    /// Those of reading.
    pub(crate) fn skip_to(&mut self, line: u32, passed: &mut impl FnMut(Block)) -> io::Result<Option<Point>> {
        while self.line + 1 < line {
            self.line += 1;
            let Some(text) = self.lines.next_line()? else { return Ok(None) };
            let mut emit = |_: &Item, blocks: &[Block]| blocks.iter().copied().for_each(&mut *passed);
            self.compiler.line(text, &mut emit, &mut |_| {});
            if self.compiler.is_ended() {
                return Ok(None);
            }
        }
        self.compiler.flush(&mut |_, blocks| blocks.iter().copied().for_each(&mut *passed));
        Ok(Some(self.compiler.programmed()))
    }

    /// The next block, compiled when none is ready.
    pub(crate) fn next(&mut self, observer: &mut impl Observer) -> io::Result<Option<Block>> {
        while self.ready.is_empty() && !self.ended {
            self.line = self.line.saturating_add(1);
            let ready = &mut self.ready;
            let mut emit = |item: &Item, blocks: &[Block]| {
                observer.compiled(item, blocks.len());
                ready.extend(blocks);
            };
            let text = match self.lines.next_line()? {
                Some(text) if !self.compiler.is_ended() => text,
                _ => {
                    self.ended = true;
                    self.compiler.flush(&mut emit);
                    self.ready.push_back(Compiler::end_block(self.line));
                    break;
                }
            };
            // the program was checked before: what there is to say has been said
            self.compiler.line(text, &mut emit, &mut |_| {});
            self.ended = self.ready.back().is_some_and(|block| matches!(block.work, interp_core::block::Work::End));
        }
        Ok(self.ready.pop_front())
    }
}

/// Records a tick.
struct Recorder {
    events: Vec<u32>,
    /// In what the motors differ from the program; some may lie behind the tick's end.
    added: Vec<Added>,
}

impl Recorder {
    fn next_tick(&mut self) {
        self.events.clear();
        self.added.retain(|added| added.clock >= TICK_CLOCKS);
        for added in &mut self.added {
            added.clock -= TICK_CLOCKS;
        }
    }

    fn of_this_tick(&self) -> &[Added] {
        let count = self.added.iter().take_while(|added| added.clock < TICK_CLOCKS).count();
        self.added.get(..count).unwrap_or_default()
    }
}

impl Train for Recorder {
    fn put(&mut self, event: Event) {
        self.events.push(event.word());
    }

    fn superposed(&mut self, clock: i32, program: Step, made: Step) {
        let clock = u32::try_from(clock).unwrap_or(0);
        let moved = |step: Step| PerAxis { x: i32::from(step.x), z: i32::from(step.z) };
        // a step at the tick's end may be told of before a pulse that is made somewhat earlier, as nothing has cancelled it
        let place = self.added.partition_point(|earlier| earlier.clock <= clock);
        self.added.insert(place, Added { clock, program: moved(program), motor: moved(made) });
    }
}

/// Runs a program that [`check`] found good, from cycle start to its end. Programmed stops are passed by.
///
/// `commands` are given before the tick of the cycle (from 0) that stands with each, in this order. A hold needs a
/// start behind it; after a reset the run is over.
///
/// # Errors
/// Those of reading the program, and the observer's.
pub fn run(
    program: &Program,
    format: Format,
    parameters: &Parameters,
    machine: &Machine,
    commands: &[(u64, Command)],
    observer: &mut impl Observer,
) -> io::Result<()> {
    let fit = Fit { tables: &Tables::default(), figures: &Figures::new(TABLES) };
    run_fitted(program, format, parameters, machine, fit, commands, observer)
}

/// What a lathe has that is no parameter.
#[derive(Copy, Clone, Debug)]
pub struct Fit<'a> {
    /// Pitch errors that the control knows.
    pub tables: &'a Tables,
    /// Figures of the machine: its spindle turns.
    pub figures: &'a Figures,
}

/// An alarm ended a run.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Alarmed {
    /// Which.
    pub alarm: Alarm,
    /// The line in work, 0 for none.
    pub line: u32,
}

impl fmt::Display for Alarmed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: alarm {}: {}", self.line, self.alarm.number(), self.alarm)
    }
}

impl std::error::Error for Alarmed {}

/// The same of a lathe with its tables and figures. An alarm is an error that holds [`Alarmed`].
///
/// # Errors
/// Those of [`run`].
pub fn run_fitted(
    program: &Program,
    format: Format,
    parameters: &Parameters,
    machine: &Machine,
    fit: Fit<'_>,
    commands: &[(u64, Command)],
    observer: &mut impl Observer,
) -> io::Result<()> {
    let compiler = Compiler::new(parameters.settings(), format, machine);
    let position = compiler.lattice();
    let mut source = Source::new(program.lines()?, compiler);
    let mut blocks = Queue::<Block, BLOCK_QUEUE>::new();
    let mut queue = Queue::<Command, COMMAND_QUEUE>::new();
    let (mut block_in, block_out) = blocks.split();
    let (mut command_in, command_out) = queue.split();
    let mut commands = commands.iter().peekable();
    let mut cycle = 0_u64;
    let mut memory = Memory::new();
    let mut foreground = Foreground::new(machine, position, block_out, command_out, &mut memory);
    for (axis, table) in [(Axis::X, &fit.tables.x), (Axis::Z, &fit.tables.z)] {
        if let Some(table) = table {
            foreground.set_pitch_table(axis, table);
        }
    }
    let mut turning = Turning::new(fit.figures).map_err(|error| io::Error::other(error.to_string()))?;
    let mut alarmed = None;
    let full = || io::Error::other("the queue of commands is full");
    command_in.enqueue(Command::FeedOverride(parameters.feed_override())).map_err(|_| full())?;
    command_in.enqueue(Command::OptionalStop(parameters.optional_stop())).map_err(|_| full())?;
    command_in.enqueue(Command::Start).map_err(|_| full())?;
    let mut recorder = Recorder { events: Vec::with_capacity(1024), added: Vec::new() };
    let mut ticks = 0_u64;
    loop {
        while block_in.ready() {
            let Some(block) = source.next(observer)? else { break };
            block_in.enqueue(block).map_err(|_| io::Error::other("the queue of blocks is full"))?;
        }
        let running = !matches!(foreground.state(), State::Idle | State::Filling);
        while let Some((_, command)) = commands.next_if(|(at, _)| running && *at <= cycle) {
            observer.commanded(*command);
            command_in.enqueue(*command).map_err(|_| full())?;
        }
        recorder.next_tick();
        foreground.read(&turning.read());
        let report = foreground.tick(&mut recorder);
        turning.tick(&report, foreground.alarm());
        alarmed = alarmed.or(foreground.alarm().map(|alarm| Alarmed { alarm, line: report.line }));
        if report.in_cycle {
            observer.superposed(recorder.of_this_tick());
            observer.tick(&recorder.events, &report)?;
            cycle += 1;
        }
        ticks += 1;
        if ticks.is_multiple_of(256) {
            observer.progress(source.lines.bytes());
        }
        match report.state {
            State::Ended | State::Idle => {
                finish(&mut foreground, observer, &mut recorder)?;
                return alarmed.map_or(Ok(()), |alarmed| Err(io::Error::other(alarmed)));
            }
            State::Stopped => {
                observer.stopped(report.line);
                command_in.enqueue(Command::Start).map_err(|_| full())?;
            }
            State::Filling | State::Running | State::Holding | State::Resetting => {}
        }
    }
}

/// Two ticks more, so that the last pulse's falling edge is played, too.
fn finish(foreground: &mut Foreground<'_>, observer: &mut impl Observer, recorder: &mut Recorder) -> io::Result<()> {
    for _ in 0..2 {
        recorder.next_tick();
        let report = foreground.tick(recorder);
        observer.superposed(recorder.of_this_tick());
        observer.tick(&recorder.events, &report)?;
    }
    if foreground.starved() > 0 {
        return Err(io::Error::other(format!("the look-ahead lacked a block {} times", foreground.starved())));
    }
    Ok(())
}
