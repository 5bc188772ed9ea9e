//! The emulated run: the chip's pulses against the desktop's, event by event.
//!
//! The image plays in QEMU, which logs what the core writes to the step port and to the register that the qemu board
//! gives each interval. The program comes over the link, as from any sender. The desktop runs the same program with
//! the same foreground; both trains are compared as they come, so that neither is stored.
//!
//! Hold and override at a given tick: the image reads them from its command line and obeys right before the tick of
//! the cycle with that number; so does the desktop. Keys pressed over the link act on some tick, which would be
//! another in each run.

use std::fmt::Write as _;
use std::fs;
use std::io::BufRead;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, sync_channel};

use anyhow::{Context as _, Result, bail};
use handcnc::background::parameters::Parameters;
use handcnc::foreground::rehearsal::Rehearsal;
use handcnc::foreground::{Command, state_word};
use interp_core::channel::State;
use interp_core::config::{Machine as Config, TICK_CLOCKS};
use interp_core::train::{Event, Hash, Levels};
use interp_core::units::Axis;

use crate::desktop::{self, Program};
use crate::firmware::{self, Board};
use crate::qemu::{self, Machine, Sender};
use crate::toolchain::Toolchain;

/// `cargo xtask emulate`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Programs, each run from cycle start to its end; `demo` is the desktop's own.
    #[arg(required = true)]
    programs: Vec<PathBuf>,
    /// Sets a parameter on both sides.
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<String>,
    /// Feed hold before this tick of the cycle.
    #[arg(long, value_name = "TICK")]
    hold_at: Option<u32>,
    /// Cycle start again this many ticks after the hold.
    #[arg(long, value_name = "TICKS", default_value_t = 1000)]
    hold_for: u32,
    /// Feed override from this tick of the cycle on.
    #[arg(long, value_name = "TICK=PERCENT")]
    override_at: Vec<String>,
    /// An image to run instead of the one that this builds.
    #[arg(long)]
    image: Option<PathBuf>,
}

/// What a run needs on both sides.
pub(crate) struct Setting {
    parameters: Parameters,
    machine: Config,
    rehearsal: Rehearsal,
    words: Vec<String>,
}

impl Arguments {
    fn setting(&self) -> Result<Setting> {
        let mut setting = Setting::new(&self.set)?;
        if let Some(tick) = self.hold_at {
            setting.appoint(tick, Command::Hold, "hold")?;
            setting.appoint(tick.saturating_add(self.hold_for.max(1)), Command::Start, "start")?;
        }
        for text in &self.override_at {
            let parts =
                text.split_once('=').and_then(|(tick, percent)| Some((tick.parse().ok()?, percent.parse().ok()?)));
            let (tick, percent) = parts.with_context(|| format!("--override-at {text}: TICK=PERCENT is wanted"))?;
            setting.appoint(tick, Command::FeedOverride(percent), &format!("override={percent}"))?;
        }
        Ok(setting)
    }
}

impl Setting {
    /// Parameters set as `NAME=VALUE`, and no command.
    pub(crate) fn new(set: &[String]) -> Result<Self> {
        let mut parameters = Parameters::new();
        for text in set {
            let (name, value) = text.split_once('=').with_context(|| format!("--set {text}: NAME=VALUE is wanted"))?;
            parameters.set(name, value).map_err(|error| anyhow::anyhow!("--set {text}: {error}"))?;
            if text.contains(' ') {
                bail!("--set {text}: no blanks");
            }
        }
        let machine = parameters.machine().map_err(|error| anyhow::anyhow!("{error}"))?;
        Ok(Self { parameters, machine, rehearsal: Rehearsal::new(), words: set.to_vec() })
    }

    fn appoint(&mut self, tick: u32, command: Command, text: &str) -> Result<()> {
        if !self.rehearsal.set(tick, command) {
            bail!("too many commands");
        }
        self.words.push(format!("{tick}:{text}"));
        Ok(())
    }
}

/// What the chip played, equal to the desktop's train.
pub(crate) struct Played {
    /// Events of the cycle.
    pub(crate) events: u64,
    /// Hash up to the last tick that moves.
    pub(crate) hash: u64,
    /// Events and ticks before the cycle.
    pub(crate) events_before: u64,
    pub(crate) ticks_before: u64,
    /// Events, and events with a rising edge, of each tick of the cycle.
    pub(crate) ticks: Vec<(usize, usize)>,
}

/// Text of a program.
pub(crate) fn text(path: &Path) -> Result<Vec<u8>> {
    let path =
        if path.as_os_str() == "demo" { crate::root().join("virtual-lathe/src/demo/handle.nc") } else { path.into() };
    fs::read(&path).with_context(|| format!("reading {}", path.display()))
}

/// `cargo xtask emulate`.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let setting = arguments.setting()?;
    qemu::find()?;
    let elf = match &arguments.image {
        Some(image) => image.clone(),
        None => firmware::build(&Toolchain::find()?, Board::Qemu)?,
    };
    let mut failed = 0;
    for path in &arguments.programs {
        let name = path.display();
        match text(path).and_then(|text| play(&elf, &setting, &text, &[])) {
            Ok(Played { events, hash, .. }) => println!("{name}: {events} events compared, train {hash:016x}, equal"),
            Err(error) => {
                println!("{name}: {error:#}");
                failed += 1;
            }
        }
    }
    if failed > 0 {
        bail!("{failed} of {} programs differ", arguments.programs.len());
    }
    Ok(())
}

/// Runs a program on both sides; fails at the first difference.
pub(crate) fn play(elf: &Path, setting: &Setting, text: &[u8], more: &[String]) -> Result<Played> {
    let Setting { parameters, machine, rehearsal, words } = setting;
    let program = Program::read(text, parameters, machine)?;
    let options = [&["-d".into(), "unimp".into()], more].concat();
    let mut emulated = Machine::start(elf, words, &options)?;
    let log = emulated.log().context("QEMU has no log")?;
    let mut sender = emulated.sender()?;
    std::thread::scope(|scope| {
        let (give, expected) = sync_channel::<Vec<Event>>(1024);
        let program = &program;
        let desktop = scope.spawn(move || {
            let mut rehearsal = rehearsal.clone();
            desktop::run(program, parameters, machine, &mut rehearsal, &mut |events| give.send(events.to_vec()).is_ok())
        });
        let stream = scope.spawn(move || stream(&mut sender, program));
        let compared = compare(log, &expected);
        drop(expected);
        // ends the emulator, so that nothing waits for it
        emulated.end();
        drop(emulated);
        let streamed = stream.join().unwrap_or_else(|_| bail!("the sender broke off"));
        let ran = desktop.join().unwrap_or_else(|_| bail!("the desktop broke off"));
        ran.context("on the desktop")?;
        match (compared, streamed) {
            (Ok(compared), _) => Ok(compared),
            (Err(Fault::Silent(text)), Err(error)) => Err(error).context(text),
            (Err(Fault::Silent(text) | Fault::Differs(text)), _) => bail!(text),
        }
    })
}

/// Sends a program.
fn stream(sender: &mut Sender, program: &Program) -> Result<()> {
    sender.banner()?;
    for (number, line) in (1..).zip(&program.lines) {
        sender.send(number, line.strip_suffix(b"\r").unwrap_or(line))?;
    }
    if !program.ends {
        sender.send(0, b"M2")?;
    }
    sender.settle()
}

/// Why a comparison failed.
enum Fault {
    /// The chip's train differs.
    Differs(String),
    /// The log ended; the sender may know why.
    Silent(String),
}

const PORT: &str = "GPIOE: unimplemented device write (size 4, offset 0x014, value 0x";
const INTERVAL: &str = "GPIOF: unimplemented device write (size 4, offset 0x014, value 0x";
const STATE: &str = "timer[1]: unimplemented device write (size 4, offset 0x034, value 0x";
const FAULTS: &str = "timer[1]: unimplemented device write (size 4, offset 0x038, value 0x";

/// What the log says, line by line.
enum Logged {
    Port(u32),
    Interval(u32),
    State(u32),
    Fault(u32),
}

fn logged(line: &str) -> Option<Logged> {
    let value = |rest: &str| u32::from_str_radix(rest.trim_end().strip_suffix(')')?, 16).ok();
    if let Some(rest) = line.strip_prefix(PORT) {
        value(rest).map(Logged::Port)
    } else if let Some(rest) = line.strip_prefix(INTERVAL) {
        value(rest).map(Logged::Interval)
    } else if let Some(rest) = line.strip_prefix(STATE) {
        value(rest).map(Logged::State)
    } else if let Some(rest) = line.strip_prefix(FAULTS) {
        value(rest).map(Logged::Fault)
    } else {
        None
    }
}

/// Compares the log with the expected train as both come.
fn compare(mut log: impl BufRead, expected: &Receiver<Vec<Event>>) -> Result<Played, Fault> {
    let mut comparison = Comparison::new(expected);
    let mut line = String::new();
    let mut said = String::new();
    loop {
        line.clear();
        match log.read_line(&mut line) {
            Ok(0) | Err(_) => {
                return Err(Fault::Silent(format!(
                    "the emulator ended after {} events{}{}",
                    comparison.events,
                    if said.is_empty() { "" } else { ": " },
                    said.trim()
                )));
            }
            Ok(_) => {}
        }
        match logged(&line) {
            Some(Logged::Port(levels)) => comparison.port = Some(levels),
            Some(Logged::Interval(interval)) => comparison.played(interval)?,
            Some(Logged::State(word)) => comparison.state(word),
            Some(Logged::Fault(word)) => {
                return Err(Fault::Differs(format!(
                    "the image counts faults: underruns {}, lost events {}",
                    word >> 16,
                    word & 0xFFFF
                )));
            }
            None if line.contains("unimplemented device") => {}
            None => said.push_str(&line),
        }
        if comparison.done {
            return Ok(Played {
                events: comparison.events,
                hash: comparison.moved,
                events_before: comparison.events_before,
                ticks_before: comparison.first.unwrap_or(0),
                ticks: comparison.counts,
            });
        }
    }
}

/// Where a comparison has got to.
struct Comparison<'e> {
    expected: &'e Receiver<Vec<Event>>,
    /// Events of the expected tick, and the next of them.
    tick: Vec<Event>,
    next: usize,
    port: Option<u32>,
    /// Clocks of the chip's present tick, and how many ticks have begun.
    clocks: u32,
    ticks: u64,
    /// The tick that the cycle begins with.
    first: Option<u64>,
    before: Levels,
    events: u64,
    events_before: u64,
    /// Events, and those with a rising edge, of each tick of the cycle.
    counts: Vec<(usize, usize)>,
    hash: Hash,
    moved: u64,
    done: bool,
}

impl<'e> Comparison<'e> {
    fn new(expected: &'e Receiver<Vec<Event>>) -> Self {
        let hash = Hash::new();
        Self {
            expected,
            tick: Vec::new(),
            next: 0,
            port: None,
            clocks: 0,
            ticks: 0,
            first: None,
            before: Levels::LOW,
            events: 0,
            events_before: 0,
            counts: Vec::new(),
            hash,
            moved: hash.value(),
            done: false,
        }
    }

    /// The channel's state changed in the tick behind the one being played. A cycle's ticks begin right after.
    fn state(&mut self, word: u32) {
        if word == state_word(State::Running) && self.first.is_none() {
            self.first = Some(self.ticks.saturating_add(1));
        }
    }

    /// The chip played an event.
    fn played(&mut self, interval: u32) -> Result<(), Fault> {
        let Some(port) = self.port.take() else {
            return Err(Fault::Differs("an interval without a write of the port".into()));
        };
        if self.clocks == 0 {
            self.ticks = self.ticks.saturating_add(1);
        }
        self.clocks = self.clocks.saturating_add(interval);
        if self.clocks > TICK_CLOCKS {
            return Err(Fault::Differs(format!("the events of a tick last {} clocks", self.clocks)));
        }
        self.clocks %= TICK_CLOCKS;
        let levels = Levels::from_bits(u16::try_from(port).unwrap_or(u16::MAX));
        let found = Event::new(levels, interval);
        match self.first {
            Some(first) if self.ticks > first => self.compare(found)?,
            _ if port & 0x5555 != 0 => return Err(Fault::Differs("a step before the cycle's start".into())),
            _ => self.events_before = self.events_before.saturating_add(1),
        }
        self.before = found.levels();
        Ok(())
    }

    fn compare(&mut self, found: Event) -> Result<(), Fault> {
        if self.next >= self.tick.len() {
            let Ok(tick) = self.expected.recv() else {
                self.done = true;
                return Ok(());
            };
            let mut before = self.before;
            let mut rising = 0_usize;
            for event in &tick {
                let rises = event.levels().bits() & !before.bits() & 0x5555 != 0;
                rising = rising.saturating_add(usize::from(rises));
                before = event.levels();
            }
            self.counts.push((tick.len(), rising));
            if rising > 0 {
                let mut hash = self.hash;
                tick.iter().for_each(|event| hash.event(*event));
                self.moved = hash.value();
            }
            (self.tick, self.next) = (tick, 0);
        }
        let expected = self.tick.get(self.next).copied().unwrap_or(Event::from_word(0));
        if found != expected {
            let mut text = format!("event {} differs", self.events);
            let _ = write!(
                text,
                " (tick {} of the cycle, {} clocks into it): the chip played {}, the desktop {}",
                self.ticks.saturating_sub(self.first.unwrap_or_default()).saturating_sub(1),
                self.tick.iter().take(self.next).map(|event| event.interval()).sum::<u32>(),
                described(found, self.before),
                described(expected, self.before)
            );
            return Err(Fault::Differs(text));
        }
        self.hash.event(found);
        self.events = self.events.saturating_add(1);
        self.next = self.next.saturating_add(1);
        Ok(())
    }
}

/// An event in words: its edges, then how long it lasts.
fn described(event: Event, before: Levels) -> String {
    let mut text = String::new();
    for (axis, name) in [(Axis::X, "X"), (Axis::Z, "Z")] {
        let levels = event.levels();
        match (before.step(axis), levels.step(axis)) {
            (false, true) => text
                .push_str(&format!("a rising edge of {name} {}, ", if levels.plus(axis) { "plus" } else { "minus" })),
            (true, false) => text.push_str(&format!("a falling edge of {name}, ")),
            _ => {}
        }
        if before.plus(axis) != levels.plus(axis) {
            text.push_str(&format!("{name} turning to {}, ", if levels.plus(axis) { "plus" } else { "minus" }));
        }
    }
    if text.is_empty() {
        text.push_str("no edge, ");
    }
    text.push_str(&format!("{} clocks", event.interval()));
    text
}
