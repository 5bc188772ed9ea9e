//! The emulated run: the chip's pulses against the desktop's, event by event.
//!
//! The image plays in QEMU, which logs what the core writes to the step port and to the register that the qemu board
//! gives each interval. The program comes over the link, as from any sender. The desktop runs the same program with
//! the same foreground; both trains are compared as they come, so that neither is stored.
//!
//! Commands at a given tick: the image reads them from its command line and obeys right before the tick of the cycle
//! with that number; so does the desktop. Keys pressed over the link act on some tick, which would be another in each
//! run.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::sync_channel;
use std::time::Instant;

use anyhow::{Context as _, Result, bail};
use feature_editor::codes::Format;
use interp_core::train::Event;

use crate::compare::{self, Fault, Log, Played};
use crate::desktop::{self, Program};
use crate::firmware::{self, Board};
use crate::qemu::{self, Machine, Sender};
use crate::toolchain::Toolchain;
use crate::trial::Trial;

/// `cargo xtask emulate`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Programs, each run from cycle start to its end; `demo` is the desktop's own, a folder all that it holds.
    #[arg(required = true)]
    programs: Vec<PathBuf>,
    /// Sets a parameter on both sides.
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<String>,
    /// What an operator does right before this tick of the cycle: hold, start, reset, override=PERCENT, wheel-x=COUNTS*TICKS ..
    #[arg(long, value_name = "TICK:WHAT")]
    at: Vec<String>,
    /// How many run at once; by default as many as the computer has processors.
    #[arg(long)]
    jobs: Option<usize>,
    /// An image to run instead of the one that this builds.
    #[arg(long)]
    image: Option<PathBuf>,
}

/// The image to run: the one given, or a new one.
pub(crate) fn image(given: Option<&PathBuf>) -> Result<PathBuf> {
    qemu::find()?;
    match given {
        Some(image) => Ok(image.clone()),
        None => firmware::build(&Toolchain::find()?, Board::Qemu),
    }
}

/// Files of the programs.
fn files(programs: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for path in programs {
        if path.as_os_str() == "demo" {
            files.push(crate::root().join("virtual-lathe/src/demo/handle.nc"));
        } else if path.is_dir() {
            let entries = path.read_dir()?.collect::<Result<Vec<_>, _>>()?;
            let mut inside: Vec<_> =
                entries.iter().map(std::fs::DirEntry::path).filter(|path| path.is_file()).collect();
            inside.sort();
            files.append(&mut inside);
        } else {
            files.push(path.clone());
        }
    }
    Ok(files)
}

/// Does `work` with each of `count` numbers, some at once; how many of them failed.
pub(crate) fn each(count: usize, jobs: Option<usize>, work: &(dyn Fn(usize) -> Result<()> + Sync)) -> usize {
    let jobs = jobs.or_else(|| std::thread::available_parallelism().ok().map(usize::from)).unwrap_or(1);
    let (next, failed) = (AtomicUsize::new(0), AtomicUsize::new(0));
    std::thread::scope(|scope| {
        for _ in 0..jobs.clamp(1, count.max(1)) {
            scope.spawn(|| {
                loop {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    if number >= count {
                        break;
                    }
                    if let Err(error) = work(number) {
                        println!("{error:#}");
                        failed.fetch_add(1, Ordering::Relaxed);
                    }
                }
            });
        }
    });
    failed.into_inner()
}

/// `cargo xtask emulate`.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let elf = image(arguments.image.as_ref())?;
    let files = files(&arguments.programs)?;
    let words = [&*arguments.set, &*arguments.at].concat();
    let failed = each(files.len(), arguments.jobs, &|number| {
        let Some(path) = files.get(number) else { return Ok(()) };
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
        let began = Instant::now();
        let played = Trial::read(path, &words).and_then(|trial| play(&elf, &trial, &[]));
        let Played { events, hash, .. } = played.with_context(|| name.to_string())?;
        let seconds = began.elapsed().as_secs_f64();
        println!("{name}: {events} events compared, train {hash:016x}, equal ({seconds:.1} s)");
        Ok(())
    });
    if failed > 0 {
        bail!("{failed} of {} programs differ", files.len());
    }
    Ok(())
}

/// Runs a program on both sides; fails at the first difference.
pub(crate) fn play(elf: &Path, trial: &Trial, more: &[String]) -> Result<Played> {
    let options = [&["-d".into(), "unimp".into()], more].concat();
    let mut emulated = Machine::start(elf, &trial.words, &options)?;
    let mut log = Log::new(emulated.log().context("QEMU has no log")?);
    let mut sender = emulated.sender()?;
    let broken = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let broken = &broken;
        let (give, expected) = sync_channel::<Vec<Event>>(1024);
        let desktop =
            scope.spawn(move || desktop::run(trial, usize::MAX, &mut |events| give.send(events.to_vec()).is_ok()));
        let stream = scope.spawn(move || {
            let streamed = stream(&mut sender, &trial.program);
            broken.store(streamed.is_err(), Ordering::Relaxed);
            streamed
        });
        // a chip that gets no more lines idles for ever
        let mut next = || match log.next() {
            Ok(_) if broken.load(Ordering::Relaxed) => Err(Fault::Silent("the sender broke off".into())),
            logged => logged,
        };
        let compared = compare::compare(&mut next, &expected);
        drop(expected);
        // ends the emulator, so that nothing waits for it
        emulated.end();
        drop(emulated);
        let streamed = stream.join().unwrap_or_else(|_| bail!("the sender broke off"));
        let ran = desktop.join().unwrap_or_else(|_| bail!("the desktop broke off"));
        ran.context("on the desktop")?;
        match (compared, streamed) {
            (Ok(compared), _) => Ok(compared),
            (Err(fault @ Fault::Silent(_)), Err(error)) => Err(error).context(fault.text().to_owned()),
            (Err(fault), _) => bail!("{}", fault.text()),
        }
    })
}

/// Sends a program.
fn stream(sender: &mut Sender, program: &Program) -> Result<()> {
    sender.banner()?;
    if program.format == Format::Nc1973 {
        sender.set("$format=nc1973")?;
    }
    for (number, line) in (1..).zip(&program.lines) {
        sender.send(number, line.strip_suffix(b"\r").unwrap_or(line))?;
    }
    if !program.ends {
        sender.send(0, b"M2")?;
    }
    sender.settle()
}
