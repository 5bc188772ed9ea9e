//! An endless loop in the background changes no pulse.
//!
//! A program moves while its sender keeps the background busy: lines to compile, lines to refuse, commands, status
//! reports. A debugger stops the core in the background, makes it loop for ever there, and leaves. What the chip has
//! played in the end must be what the desktop plays with exactly the blocks that had been handed over: all of their
//! pulses, to the planned standstill, then idle ticks.
//!
//! The points are first instructions of all functions that run in the background, and others some instructions later.
//! A run stops at the first function that no run before stopped at, so a run without a stop tells that there are no
//! more. How many blocks had been handed over shows where the chip ends: Z of each motion is behind that of the last.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, bail};
use handcnc::background::compile::Compiler;
use interp_core::block::Work;
use interp_core::config::TICK_CLOCKS;
use interp_core::train::Levels;
use interp_core::units::Axis;

use crate::compare::{self, Fault, Log, Logged};
use crate::desktop;
use crate::emulate::{each, image};
use crate::gdb::Debugger;
use crate::graph::Graph;
use crate::image::Image;
use crate::qemu::{Machine, Sender};
use crate::trial::Trial;

/// `cargo xtask endless`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// How many points; without it all functions that run in the background.
    #[arg(long)]
    points: Option<usize>,
    /// How many run at once; by default as many as the computer has processors.
    #[arg(long)]
    jobs: Option<usize>,
    /// An image to run instead of the one that this builds.
    #[arg(long)]
    image: Option<PathBuf>,
}

/// Handlers: the background's, the interpolator's.
const BACKGROUND: &str = "I2C3_EV";
const INTERPOLATOR: &str = "I2C3_ER";

/// `b .`
const LOOP: u16 = 0xE7FE;

/// Idle ticks in a row that only a train which is over has.
const OVER: u32 = 150;

/// Motions of the program; the look-ahead and the queue hold a fifth.
const MOTIONS: i32 = 400;

/// The program, and what its sender sends: the same lines and others, which are refused, answered or make nothing.
fn program() -> (String, Vec<String>) {
    const NOISE: [&str; 9] =
        ["$G", "G1 X1 X2", "(nothing)", "$x.max_feed=4000", "G2 X0.1 Z-3", "$$", "G1 Q7.25", "$nonsense=1", "G1 X2101"];
    let (mut clean, mut sent) = ("G21 G90 F1500\n".to_owned(), vec!["G21 G90 F1500".to_owned()]);
    for number in 1..=MOTIONS {
        let (x, z) = (f64::from(number % 7) * 0.01, -f64::from(number) * 0.1);
        let line = match number % 5 {
            0 => format!("G2 X{x:.3} Z{z:.3} R1"),
            1 => format!("G3 X{x:.3} Z{z:.3} R0.8"),
            2 if number % 3 == 0 => format!("S{number} M3 T0101 G4 P0.002\nG1 X{x:.3} Z{z:.3} (cut)"),
            _ => format!("G1 X{x:.3} Z{z:.3}"),
        };
        clean.push_str(&line);
        clean.push('\n');
        sent.extend(line.lines().map(str::to_owned));
        if let Some(noise) = usize::try_from(number).ok().and_then(|number| NOISE.get(number % 19)) {
            sent.push((*noise).to_owned());
        }
    }
    (clean, sent)
}

/// What the chip has done so far.
#[derive(Default)]
struct Record {
    logged: Vec<Logged>,
    steps: u64,
    /// Idle ticks since the last step, or since the start.
    idle: u32,
    ended: bool,
}

/// The emulated chip with a program on its way.
struct Rig<'r> {
    debugger: PathBuf,
    record: &'r Mutex<Record>,
}

impl Rig<'_> {
    /// Runs `work` beside a chip that gets the program; what the chip did.
    fn run(elf: &Path, trial: &Trial, sent: &[String], work: &mut dyn FnMut(&Rig<'_>) -> Result<()>) -> Result<Record> {
        let folder = tempfile::tempdir()?;
        let debugger = folder.path().join("debugger");
        let stub = format!("unix:{},server=on,wait=off", debugger.display());
        let options = ["-d".into(), "unimp".into(), "-gdb".into(), stub];
        let mut emulated = Machine::start(elf, &trial.words, &options)?;
        let mut log = Log::new(emulated.log().context("QEMU has no log")?);
        let mut sender = emulated.sender()?;
        let record = Mutex::new(Record::default());
        let done = std::thread::scope(|scope| {
            let record = &record;
            scope.spawn(move || {
                while let Ok(logged) = log.next() {
                    let Ok(mut record) = record.lock() else { break };
                    record.take(logged);
                }
                if let Ok(mut record) = record.lock() {
                    record.ended = true;
                }
            });
            // nobody answers behind the loop: that it breaks off is no fault
            scope.spawn(move || drop(send(&mut sender, sent)));
            let done = work(&Rig { debugger, record });
            emulated.end();
            drop(emulated);
            done
        });
        done?;
        record.into_inner().map_err(|_| anyhow::anyhow!("the log's reader broke off"))
    }

    /// Waits for something in the record.
    fn wait(&self, what: &str, of: impl Fn(&Record) -> bool) -> Result<()> {
        let began = Instant::now();
        while began.elapsed() < Duration::from_secs(300) {
            let record = self.record.lock().map_err(|_| anyhow::anyhow!("the log's reader broke off"))?;
            if of(&record) {
                return Ok(());
            }
            if record.ended {
                break;
            }
            drop(record);
            std::thread::sleep(Duration::from_millis(1));
        }
        bail!("the chip did not come to {what}")
    }

    /// Waits until the train is over.
    fn stands(&self) -> Result<()> {
        self.wait("a standstill", Record::is_over)
    }

    fn is_over(&self) -> bool {
        self.record.lock().is_ok_and(|record| record.is_over() || record.ended)
    }
}

impl Record {
    fn take(&mut self, logged: Logged) {
        self.logged.push(logged);
        if let Logged::Played(event) = logged {
            let steps = event.levels().step(Axis::X) || event.levels().step(Axis::Z);
            self.steps = self.steps.saturating_add(steps.into());
            self.idle = if event.interval() == TICK_CLOCKS && !steps { self.idle.saturating_add(1) } else { 0 };
        }
    }

    fn is_over(&self) -> bool {
        self.steps > 0 && self.idle > OVER
    }

    /// Net pulses of an axis.
    fn pulses(&self, axis: Axis) -> i64 {
        let mut before = Levels::LOW;
        let mut pulses = 0_i64;
        for logged in &self.logged {
            let (Logged::Played(event) | Logged::Fell(event)) = logged else { continue };
            let levels = event.levels();
            if levels.step(axis) && !before.step(axis) {
                pulses = pulses.saturating_add(if levels.plus(axis) { 1 } else { -1 });
            }
            before = levels;
        }
        pulses
    }

    /// Compares with the train of the desktop that got `blocks` blocks.
    fn compare(&self, trial: &Trial, blocks: usize) -> Result<(), String> {
        let (give, expected) = channel();
        desktop::run(trial, blocks, &mut |events| give.send(events.to_vec()).is_ok())
            .map_err(|error| error.to_string())?;
        drop(give);
        let mut logged = self.logged.iter().copied();
        let mut next = || logged.next().ok_or_else(|| Fault::Silent("the train ended".into()));
        compare::compare(&mut next, &expected).map_err(|fault| fault.text().to_owned())?;
        let behind: Vec<Logged> = logged.filter(|logged| !matches!(logged, Logged::State(_))).collect();
        let idles = |logged: &Logged| match logged {
            Logged::Played(event) => event.interval() == TICK_CLOCKS,
            Logged::Fell(_) | Logged::State(_) | Logged::Fault(_) => false,
        };
        let same = behind.windows(2).all(|pair| pair.first() == pair.last());
        if behind.first().is_some_and(idles) && same { Ok(()) } else { Err("no idle ticks behind the end".into()) }
    }
}

/// Sends lines, and asks for a status report after each.
fn send(sender: &mut Sender, lines: &[String]) -> Result<()> {
    sender.banner()?;
    sender.tolerate();
    for (number, line) in (1..).zip(lines) {
        sender.send(number, line.as_bytes())?;
        sender.realtime(b'?')?;
    }
    sender.settle()
}

/// A number that looks like chance, the same each time.
fn scattered(number: usize, below: u64) -> u64 {
    let mixed = (number as u64).wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    (mixed >> 32).checked_rem(below).unwrap_or(0)
}

/// What all runs share.
struct Test<'t> {
    elf: &'t Path,
    trial: &'t Trial,
    sent: &'t [String],
    /// Z behind each number of blocks, in pulses.
    ends: Vec<i64>,
    /// The number of the background's exception, and its handler.
    exception: u32,
    background: u32,
    interpolator: u32,
    /// Where the loop stands: the reset handler, which nothing calls any more.
    spin: u32,
    image: &'t Image,
    /// Functions that may run in the background, but for those that a run has stopped at or that the foreground shares.
    left: Mutex<BTreeSet<u32>>,
}

/// How a run ended.
enum Stop {
    /// In this function, at this place.
    At(u32, u32),
    /// It does not count.
    Void,
    /// No function was met that is still left.
    Nowhere,
}

impl Test<'_> {
    fn name(&self, function: u32) -> &str {
        self.image.functions.get(&function).and_then(|f| f.names.first()).map_or("?", String::as_str)
    }

    /// Stops in a function that no run before has stopped in, and loops there or some instructions later.
    ///
    /// While a debugger holds the core, QEMU moves the clock on to the next event. That is harmless in the background,
    /// but a stop in the foreground would make it late: such a run is void, and the function left out from then on.
    fn stop(&self, rig: &Rig<'_>, number: usize) -> Result<Stop> {
        let steps = 200 + scattered(number, 2_000);
        rig.wait("motion", |record| record.steps > steps)?;
        let mut debugger = Debugger::attach(&rig.debugger)?;
        if rig.is_over() {
            // on a computer so busy that the program was faster: that tells nothing of what is left
            return Ok(Stop::Void);
        }
        debugger.patch(self.spin, LOOP)?;
        let mut wanted = self.left.lock().map_err(|_| anyhow::anyhow!("another run broke off"))?.clone();
        for place in &wanted {
            debugger.break_at(*place)?;
        }
        let function = loop {
            if !debugger.go(&|| rig.is_over())? {
                return Ok(Stop::Nowhere);
            }
            let place = debugger.place()?;
            let is_left = self.left.lock().is_ok_and(|mut left| left.remove(&place));
            if debugger.exception()? != self.exception {
                println!("point {number} again: {} runs in the foreground, too", self.name(place));
                return Ok(Stop::Void);
            }
            if is_left {
                break place;
            }
            // the other run has met it meanwhile
            debugger.pass(place)?;
            wanted.remove(&place);
        };
        for place in &wanted {
            debugger.pass(*place)?;
        }
        // every other time some instructions later
        if number % 2 == 1 {
            for _ in 0..scattered(number, 120) {
                debugger.step()?;
                if debugger.exception()? != self.exception {
                    // it is over for now: where it begins again
                    debugger.break_at(self.background)?;
                    if !debugger.go(&|| rig.is_over())? {
                        return Ok(Stop::Void);
                    }
                    debugger.pass(self.background)?;
                    break;
                }
            }
        }
        let place = debugger.place()?;
        debugger.jump(self.spin)?;
        debugger.detach()?;
        rig.stands()?;
        Ok(Stop::At(function, place))
    }

    /// One point. False where no more is met.
    fn point(&self, number: usize) -> Result<bool> {
        let began = Instant::now();
        let mut stop = Stop::Void;
        let record = Rig::run(self.elf, self.trial, self.sent, &mut |rig| {
            stop = self.stop(rig, number)?;
            Ok(())
        })?;
        let (function, place) = match stop {
            Stop::At(function, place) => (function, place),
            Stop::Void => return self.point(number),
            Stop::Nowhere => return Ok(false),
        };
        let (end, name) = (record.pulses(Axis::Z), self.name(function));
        let what = || format!("point {number}, {place:#x}, from {name}");
        let blocks = self.ends.iter().position(|z| *z == end).with_context(what)?;
        if self.ends.last() == Some(&end) {
            bail!("{}: the background was not stopped", what());
        }
        record.compare(self.trial, blocks).map_err(anyhow::Error::msg).with_context(what)?;
        let (steps, seconds) = (record.steps, began.elapsed().as_secs_f64());
        println!("point {number}: {place:#x}, {name}: {blocks} blocks, {steps} steps equal ({seconds:.1} s)");
        Ok(true)
    }

    /// That the test can fail: the interpolator is kept from its work for some ticks. The image must count the
    /// underruns, and the comparison must find the train wrong.
    fn control(&self) -> Result<()> {
        let fault = |record: &Record| {
            record.logged.iter().rev().take(100).any(|logged| matches!(logged, Logged::Fault(word) if word >> 16 > 2))
        };
        let record = Rig::run(self.elf, self.trial, self.sent, &mut |rig| {
            rig.wait("motion", |record| record.steps > 1_000)?;
            let mut debugger = Debugger::attach(&rig.debugger)?;
            debugger.patch(self.interpolator, LOOP)?;
            debugger.detach()?;
            rig.wait("idle ticks", |record| record.idle > 5)?;
            let mut debugger = Debugger::attach(&rig.debugger)?;
            debugger.patch(self.interpolator, self.image.half(self.interpolator).context("no code")?)?;
            debugger.detach()?;
            rig.wait("a mark of the underrun", fault)
        })?;
        match record.compare(self.trial, usize::MAX) {
            Ok(()) => bail!("the interpolator was stopped for five ticks, and the comparison finds nothing"),
            Err(text) => {
                println!("control: with a late interpolator {text}");
                Ok(())
            }
        }
    }
}

/// Z behind each number of blocks, in pulses.
fn ends(trial: &Trial) -> Result<Vec<i64>> {
    let mut compiler = Compiler::new(trial.parameters.settings(), trial.program.format, &trial.machine);
    let mut ends = vec![0];
    for line in &trial.program.lines {
        let mut motions = 0;
        let mut count = 0;
        compiler.line(
            line,
            &mut |_, blocks| {
                count += blocks.len();
                motions += blocks.iter().filter(|block| matches!(block.work, Work::Motion(_))).count();
            },
            &mut |_| {},
        );
        let last = ends.last().copied().unwrap_or(0);
        ends.extend(std::iter::repeat_n(last, count.saturating_sub(motions)));
        if motions > 1 {
            bail!("a line of two motions");
        }
        ends.extend((motions == 1).then(|| i64::from(compiler.lattice().z)));
    }
    Ok(ends)
}

/// `cargo xtask endless`.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let elf = image(arguments.image.as_ref())?;
    let image = Image::read(&elf)?;
    let (clean, sent) = program();
    let trial = Trial::new(clean.as_bytes(), &[])?;
    let handler = |name: &str| image.address(name).with_context(|| format!("the image has no handler {name}"));
    let (background, interpolator) = (handler(BACKGROUND)?, handler(INTERPOLATOR)?);
    let graph = Graph::of(&image)?;
    let functions = graph.reached(background);
    let count = functions.len();
    let test = Test {
        elf: &elf,
        trial: &trial,
        sent: &sent,
        ends: ends(&trial)?,
        exception: image.vector(background).context("the background has no vector")?,
        background,
        interpolator,
        spin: handler("Reset")?,
        image: &image,
        left: Mutex::new(functions),
    };
    test.control().context("control")?;
    let (over, done) = (AtomicBool::new(false), AtomicUsize::new(0));
    let most = arguments.points.unwrap_or(count);
    let failed = each(most, arguments.jobs, &|number| {
        if !over.load(Ordering::Relaxed) {
            match test.point(number)? {
                true => drop(done.fetch_add(1, Ordering::Relaxed)),
                false => over.store(true, Ordering::Relaxed),
            }
        }
        Ok(())
    });
    let done = done.into_inner();
    if failed > 0 || done == 0 {
        bail!("a loop in the background changed pulses: {failed} of {} points", done.saturating_add(failed));
    }
    // fewer than all functions may run at all, but then nobody asked for a number
    if let Some(points) = arguments.points.filter(|points| done < *points) {
        bail!("only {done} of {points} points were met");
    }
    println!("{done} endless loops in the background, not a pulse changed");
    Ok(())
}
