//! The background's side: programs are loaded, checked and compiled into the queue of blocks; typed lines, too; and a
//! program that was interrupted is gone back into.

use std::collections::VecDeque;
use std::io;
use std::path::Path;

use feature_editor::codes::Format;
use handcnc::background::compile::{Compiler, Finding};
use handcnc::foreground::settings::Settings as Operation;
use handcnc::queue::Producer;
use interp_core::block::{Block, Builder, Output, Pace, Path as Way, Work};
use interp_core::config::Machine;
use interp_core::units::{Feedrate, Lattice, Length, Point};

use crate::lathe::{self, Source};
use crate::program::Program;
use crate::settings::Settings;

/// Why nothing is run.
pub(super) struct Failure {
    /// A name of one word, as a refusal has it.
    pub(super) name: &'static str,
    /// What there is to say.
    pub(super) text: String,
}

impl Failure {
    pub(super) fn new(name: &'static str, text: impl Into<String>) -> Self {
        Self { name, text: text.into() }
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self::new("unreadable", error.to_string())
    }
}

/// The background.
pub(super) struct Background {
    pub(super) settings: Settings,
    pub(super) machine: Machine,
    format: Option<Format>,
    program: Option<(Program, Format)>,
    /// The program that runs.
    source: Option<Source>,
    /// Blocks that go before it.
    ready: VecDeque<Block>,
    /// What typed lines have left in force.
    typed: Option<Compiler>,
    /// The cycle that the source is for has begun.
    begun: bool,
}

impl Background {
    /// Without a program.
    pub(super) fn new(settings: Settings, machine: Machine, format: Option<Format>) -> Self {
        Self {
            settings,
            machine,
            format,
            program: None,
            source: None,
            ready: VecDeque::new(),
            typed: None,
            begun: false,
        }
    }

    /// How the machine is operated.
    pub(super) fn operation(&self) -> Operation {
        self.settings.parameters.operation(&self.machine)
    }

    /// Loads a program that is checked to be good from where the tool is.
    pub(super) fn load(&mut self, file: &Path, at: Point) -> Result<(), Failure> {
        let program =
            Program::open(file).map_err(|error| Failure::new("unreadable", format!("{}: {error}", file.display())))?;
        self.take(program, at)
    }

    /// The same of a program that is there.
    pub(super) fn take(&mut self, program: Program, at: Point) -> Result<(), Failure> {
        let format = match self.format {
            Some(format) => format,
            None => program.detect()?,
        };
        self.check(&program, format, at)?;
        self.program = Some((program, format));
        Ok(())
    }

    fn check(&self, program: &Program, format: Format, at: Point) -> Result<(), Failure> {
        let mut parameters = self.settings.parameters.clone();
        let start = format!("{},{}", mm(at.x), mm(at.z));
        parameters.set("start", &start).map_err(|error| Failure::new("program-refused", error.to_string()))?;
        let checked = lathe::check(program, format, &parameters, &self.machine, &mut |_| {}, &mut |_| {})?;
        match checked.findings.iter().find(|(finding, _)| finding.is_error()) {
            Some((finding, _)) => Err(refused(&program.name(), finding, checked.errors)),
            None => Ok(()),
        }
    }

    /// The program that is loaded, checked from where the tool is, ready to be compiled from its start.
    pub(super) fn program_from(&self, at: Point) -> Result<Source, Failure> {
        let Some((program, format)) = &self.program else {
            return Err(Failure::new("no-program", "no program is loaded: load one first"));
        };
        self.check(program, *format, at)?;
        let mut settings = self.settings.parameters.settings();
        settings.start = at;
        Ok(Source::new(program.lines()?, Compiler::new(settings, *format, &self.machine)))
    }

    /// Runs a program from now on.
    pub(super) fn run(&mut self, source: Source) {
        self.stop();
        self.source = Some(source);
    }

    /// Compiles a typed line from where the tool is; what it leaves in force comes with it.
    pub(super) fn typed(&self, text: &str, at: Point) -> Result<(Compiler, Vec<Block>), Failure> {
        let mut settings = self.settings.parameters.settings();
        settings.start = at;
        let mut compiler = match &self.typed {
            Some(compiler) => {
                let mut compiler = compiler.clone();
                compiler.configure(settings, &self.machine);
                compiler
            }
            None => Compiler::new(settings, Format::Gcode, &self.machine),
        };
        let (mut blocks, mut found) = (Vec::new(), Vec::new());
        compiler
            .line(text.as_bytes(), &mut |_, made| blocks.extend_from_slice(made), &mut |finding| found.push(finding));
        if let Some(finding) = found.iter().find(|finding| finding.is_error()) {
            return Err(refused("mdi", finding, found.iter().filter(|finding| finding.is_error()).count()));
        }
        compiler.flush(&mut |_, made| blocks.extend_from_slice(made));
        if !compiler.is_ended() {
            blocks.push(Compiler::end_block(1));
        }
        Ok((compiler, blocks))
    }

    /// Runs a typed line from now on.
    pub(super) fn run_typed(&mut self, (compiler, blocks): (Compiler, Vec<Block>)) {
        self.stop();
        // an M30 that was typed ends that line only
        self.typed = (!compiler.is_ended()).then_some(compiler);
        self.ready = blocks.into();
    }

    /// Re-entry: the program up to the line in which it was interrupted, from where the tool was when it began; what it
    /// had switched on; a straight lead-in at the safe feed from where the tool is; and on.
    pub(super) fn reenter(
        &self,
        line: u32,
        at: Lattice,
        from: Point,
        began: Point,
    ) -> Result<(Source, Vec<Block>), Failure> {
        let mut source = self.program_from(began)?;
        let (mut lead, mut outputs) = (Vec::new(), Outputs::default());
        let place = source.skip_to(line, &mut |block| outputs.note(&block))?;
        let Some(place) = place else {
            return Err(Failure::new("nothing-to-resume", format!("the program has no line {line}")));
        };
        lead.extend(outputs.blocks(line));
        if source.lattice() != at {
            let feed = Feedrate::from_nm_per_min(u64::from(self.operation().safe) * 60_000 / 4096);
            let feed = feed.unwrap_or(Feedrate::SLOWEST);
            let built = Builder::new(&self.machine, from).motion(Way::Line, place, Pace::Feed(feed));
            if built.refused.is_some() {
                return Err(Failure::new("nothing-to-resume", "the lead-in leaves the range"));
            }
            lead.extend(built.motions.iter().map(|motion| Block { line, work: Work::Motion(*motion) }));
            // the program's first motion knows nothing of the way that leads to it: it begins from standstill
            lead.push(Block { line, work: Work::Dwell(1) });
        }
        Ok((source, lead))
    }

    /// Goes back into a program from now on.
    pub(super) fn run_from(&mut self, (source, lead): (Source, Vec<Block>)) {
        self.run(source);
        self.ready = lead.into();
    }

    /// Whether a program is being fed.
    pub(super) fn is_busy(&self) -> bool {
        self.source.is_some() || !self.ready.is_empty()
    }

    /// Nothing more is fed.
    pub(super) fn stop(&mut self) {
        self.source = None;
        self.ready.clear();
        self.begun = false;
    }

    /// What the cycle is doing: a source whose cycle is over is done with.
    pub(super) fn follow(&mut self, in_cycle: bool) {
        if in_cycle {
            self.begun = true;
        } else if self.begun {
            self.stop();
        }
    }

    /// Fills the queue.
    pub(super) fn feed(&mut self, queue: &mut Producer<'_, Block>) -> io::Result<()> {
        while queue.ready() {
            let block = match self.ready.pop_front() {
                Some(block) => Some(block),
                None => match &mut self.source {
                    Some(source) => source.next(&mut lathe::Nobody)?,
                    None => None,
                },
            };
            let Some(block) = block else { break };
            queue.enqueue(block).map_err(|_| io::Error::other("the queue of blocks is full"))?;
        }
        Ok(())
    }
}

/// What a program has switched on so far.
#[derive(Default)]
struct Outputs {
    speed: Option<Output>,
    sense: Option<Output>,
}

impl Outputs {
    fn note(&mut self, block: &Block) {
        match block.work {
            Work::Output(output @ Output::SpindleSpeed(_)) => self.speed = Some(output),
            Work::Output(output @ (Output::SpindleForward | Output::SpindleReverse | Output::SpindleStop)) => {
                self.sense = Some(output);
            }
            _ => {}
        }
    }

    fn blocks(&self, line: u32) -> impl Iterator<Item = Block> {
        self.speed.into_iter().chain(self.sense).map(move |output| Block { line, work: Work::Output(output) })
    }
}

fn refused(name: &str, finding: &Finding, errors: usize) -> Failure {
    let (column, _) = finding.span();
    let more = if errors > 1 { format!(" ({errors} errors in all)") } else { String::new() };
    Failure::new("program-refused", format!("{name}:{}:{column}: {finding}{more}", finding.line()))
}

/// A length in mm, exact.
pub(super) fn mm(length: Length) -> String {
    let nm = i64::from(length.nm());
    let sign = if nm < 0 { "-" } else { "" };
    format!("{sign}{}.{:06}", nm.abs() / 1_000_000, nm.abs() % 1_000_000)
}
