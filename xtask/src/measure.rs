//! What a step costs: executed instructions on the emulated chip.
//!
//! QEMU runs the image with a plugin (`plugin/count.c`) that counts the instructions of each call of a handler,
//! without those of handlers that preempted it. Each call of `pulse` plays one event, or a pulse whose fall the hardware makes, and
//! each call of `interpolate` makes one tick, so the counts are put beside the events of the same run, which are compared with the desktop's
//! meanwhile: figures of a wrong train would be none.
//!
//! A **step event** is an event with at least one rising edge; its falling edge is part of its cost. Means are over
//! all ticks at full speed (at least 95 % of the steps of the busiest tick); the worst is the costliest of them. What
//! `interpolate` takes for each step event more is told from a slow and a fast case of the same curve; the rest of a
//! tick is what it takes besides steps, where a block begins or the tool brakes more than at full speed. Entry and exit
//! of an interrupt are no instructions; the chip's share counts them as 24 clocks a call, and an instruction as 1.35
//! clocks of 168 MHz.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, bail};
use interp_core::config::TICKS_PER_SECOND;
use serde_json::{Map, Value, json};

use crate::book;
use crate::cases::{CASES, Case};
use crate::compare::Played;
use crate::emulate;
use crate::firmware::{self, Board};
use crate::image::Image;
use crate::qemu;
use crate::toolchain::{Toolchain, apt};
use crate::trial::Trial;

/// `cargo xtask measure`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Boards whose flash and RAM are shown.
    #[arg(long, value_delimiter = ',', default_value = "f407,f411,f446,qemu")]
    board: Vec<Board>,
    /// Writes the tables into the book, too (`docs/src/firmware.md`).
    #[arg(long)]
    book: bool,
    /// An image to measure instead of the one that this builds.
    #[arg(long)]
    image: Option<PathBuf>,
    /// Measures only cases whose names have this in them; what a step costs more can't be told then.
    #[arg(long, value_name = "TEXT", conflicts_with = "book")]
    only: Option<String>,
}

/// The chip that shares are told of: its clock, clocks of an instruction, of an interrupt's entry and exit
/// (`docs/src/firmware.md`).
const CLOCK_HZ: f64 = 168e6;
const CLOCKS_PER_INSTRUCTION: f64 = 1.35;
const CLOCKS_PER_INTERRUPT: f64 = 24.0;

/// Functions of the costliest call that are told.
const FUNCTIONS: usize = 48;

/// Handlers by the names of their vectors; the first two are reported.
const HANDLERS: [&str; 5] = ["TIM5", "I2C3_ER", "USART2", "I2C3_EV", "EXTI15_10"];

/// Runs of a case that may fail.
const RETRIES: u32 = 7;

/// `cargo xtask measure`.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    qemu::find()?;
    let toolchain = Toolchain::find()?;
    let mut sizes = Map::new();
    for board in &arguments.board {
        let (flash, ram) = Image::read(&firmware::build(&toolchain, *board)?)?.sizes();
        sizes.insert(board.name().into(), json!({ "flash_bytes": flash, "ram_bytes": ram }));
    }
    let elf = match &arguments.image {
        Some(image) => image.clone(),
        None => firmware::build(&toolchain, Board::Qemu)?,
    };
    let folder = tempfile::tempdir()?;
    let plugin = compile(folder.path())?;
    let mut counted = Vec::new();
    let wanted = |case: &&Case| arguments.only.as_ref().is_none_or(|text| case.0.contains(text));
    for case in CASES.iter().filter(wanted) {
        let run = || measure(&elf, &plugin, folder.path(), case).with_context(|| case.0);
        // once in some hundred runs the plugin still meets what it does not understand: such a run is none, and the next one
        // differs in when its lines arrive
        let counts = (0..RETRIES).find_map(|_| run().ok()).map_or_else(run, Ok)?;
        counted.push((case.0, counts));
    }
    let mut cases = Map::new();
    for (name, counts) in &counted {
        // the two cases of one curve with the fewest and the most steps a tick, under the linear law and uncompensated
        let plain = |name: &str| {
            !["law", "compensated", "everything", "turn", "thread"].iter().any(|other| name.contains(other))
        };
        let kin = counted.iter().filter(|(other, _)| plain(other) && other.contains("arc") == name.contains("arc"));
        let per_step = slope(kin.map(|(_, counts)| counts));
        cases.insert((*name).into(), figures(counts, per_step));
    }
    let report = json!({ "unit": "executed instructions", "cases": cases, "boards": sizes });
    println!("{}", serde_json::to_string_pretty(&report)?);
    if arguments.book { book::write(&report) } else { Ok(()) }
}

/// Compiles the plugin.
fn compile(folder: &Path) -> Result<PathBuf> {
    let source = crate::root().join("xtask/plugin/count.c");
    let plugin = folder.join("count.so");
    let runs = || {
        Command::new("cc")
            .args(["-O2", "-Wall", "-shared", "-fPIC", "-fvisibility=hidden", "-o"])
            .arg(&plugin)
            .arg(&source)
            .status()
    };
    let status = match runs() {
        Ok(status) => status,
        Err(_) => {
            apt(&["gcc", "libc6-dev"]).context("a C compiler is missing: apt-get install gcc libc6-dev")?;
            runs()?
        }
    };
    if !status.success() {
        bail!("cc failed on {}", source.display());
    }
    Ok(plugin)
}

/// One tick's figures: step events, calls of `pulse`, instructions of each handler.
#[derive(Copy, Clone, Debug, Default)]
struct Tick {
    steps: u64,
    calls: u64,
    pulse: u64,
    interpolate: u64,
}

fn measure(elf: &Path, plugin: &Path, folder: &Path, case: &Case) -> Result<Counts> {
    let counts = folder.join("counts");
    let image = Image::read(elf)?;
    let mut option = format!("{},out={}", plugin.display(), counts.display());
    for name in HANDLERS {
        let at = image.address(name).with_context(|| format!("the image has no handler {name}"))?;
        let size = image.functions.get(&at).map_or(0, |function| function.size);
        option.push_str(&format!(",h={name}:{at:x}:{:x}", at + size));
    }
    option.push_str(",worst=I2C3_ER");
    let trial = Trial::new(case.program().as_bytes(), &case.parameters())?;
    let played = emulate::play(elf, &trial, &["-plugin".into(), option])?;
    let text = fs::read_to_string(&counts).context("the plugin wrote nothing")?;
    let of = |wanted: &str| -> Result<Vec<u64>> {
        let lines = text.lines().filter_map(|line| line.split_once(' '));
        lines.filter(|(name, _)| *name == wanted).map(|(_, count)| Ok(count.parse()?)).collect()
    };
    if of("anomalies")? != [0] {
        bail!("the plugin met calls that it does not understand");
    }
    let mut counts = Counts::new(&played, &of("TIM5")?, &of("I2C3_ER")?)?;
    counts.costliest = by_function(&image, &text)?;
    Ok(counts)
}

/// Where the instructions of the costliest call of `interpolate` were: functions, the one with the most first. What was
/// inlined counts for its caller.
fn by_function(image: &Image, text: &str) -> Result<Vec<(String, u64)>> {
    let mut found = BTreeMap::<String, u64>::new();
    for line in text.lines() {
        let Some((at, times)) = line.strip_prefix("at ").and_then(|rest| rest.split_once(' ')) else { continue };
        let (at, times) = (at.parse::<u32>()?, times.parse::<u64>()?);
        let function = image.functions.range(..=at).next_back();
        let name = function.and_then(|(_, function)| function.names.first()).map_or("?", String::as_str);
        *found.entry(format!("{:#}", rustc_demangle::demangle(name))).or_default() += times;
    }
    let mut found: Vec<_> = found.into_iter().collect();
    found.sort_by_key(|(_, times)| std::cmp::Reverse(*times));
    Ok(found)
}

/// What was counted in one case.
struct Counts {
    ticks: Vec<Tick>,
    /// Of each call of `pulse`.
    calls: Vec<u64>,
    /// Step events of the busiest tick.
    most: u64,
    /// Of the costliest call of `interpolate`, by function.
    costliest: Vec<(String, u64)>,
}

impl Counts {
    fn new(played: &Played, pulse: &[u64], interpolate: &[u64]) -> Result<Self> {
        let mut ticks = Vec::new();
        let before = usize::try_from(played.events_before)?;
        let mut at = before;
        let first = usize::try_from(played.ticks_before)?;
        for (number, tick) in played.ticks.iter().enumerate() {
            let calls = pulse.get(at..at + tick.handled).context("the plugin saw fewer events than were played")?;
            let made = *interpolate.get(first + number).context("the plugin saw fewer ticks than were played")?;
            let (steps, pulse) = (tick.rising as u64, calls.iter().sum());
            ticks.push(Tick { steps, calls: tick.handled as u64, pulse, interpolate: made });
            at += tick.handled;
        }
        let most = ticks.iter().map(|tick| tick.steps).max().unwrap_or(0);
        if most == 0 {
            bail!("nothing moved");
        }
        Ok(Self { ticks, calls: pulse.get(before..at).unwrap_or_default().to_vec(), most, costliest: Vec::new() })
    }

    /// Ticks at full speed.
    fn full(&self) -> Vec<Tick> {
        self.ticks.iter().copied().filter(|tick| tick.steps * 100 >= self.most * 95).collect()
    }

    /// Steps and instructions of a usual tick at full speed.
    fn usual(&self) -> (f64, f64) {
        let mut full = self.full();
        full.sort_by_key(|tick| tick.interpolate);
        let tick = full.get(full.len() / 2).copied().unwrap_or_default();
        (tick.steps as f64, tick.interpolate as f64)
    }
}

/// What `interpolate` takes for each step event more: from the usual ticks of the slowest and the fastest case; `None` where
/// their steps are too much alike to tell.
fn slope<'a>(cases: impl Iterator<Item = &'a Counts>) -> Option<f64> {
    let mut usual: Vec<(f64, f64)> = cases.map(Counts::usual).collect();
    usual.sort_by(|a, b| a.0.total_cmp(&b.0));
    match (usual.first(), usual.last()) {
        (Some(slow), Some(fast)) if fast.0 > slow.0 * 1.5 => Some((fast.1 - slow.1) / (fast.0 - slow.0)),
        _ => None,
    }
}

fn figures(counts: &Counts, per_step: Option<f64>) -> Value {
    let (ticks, most, full) = (&counts.ticks, counts.most, counts.full());
    // the programs begin with a dwell; its first tick takes the block
    let idle: Vec<Tick> =
        ticks.iter().take_while(|tick| tick.steps == 0).skip(2).map(|tick| Tick { steps: 1, ..*tick }).collect();
    let idle = idle.get(..idle.len().saturating_sub(1)).unwrap_or_default().to_vec();
    let calls = &counts.calls;
    let besides = per_step.map(|per_step| {
        let fixed: Vec<f64> = ticks
            .iter()
            .filter(|tick| tick.steps > 0)
            .map(|tick| (tick.interpolate as f64 - per_step * tick.steps as f64).max(0.0))
            .collect();
        let (steps, cost) = counts.usual();
        json!({
            "at_full_speed": rounded(cost - per_step * steps),
            "mean": rounded(fixed.iter().sum::<f64>() / fixed.len().max(1) as f64),
            "worst": rounded(fixed.iter().copied().fold(0.0, f64::max)),
        })
    });
    let of_the_worst: Map<String, Value> =
        counts.costliest.iter().take(FUNCTIONS).map(|(name, times)| (name.clone(), json!(times))).collect();
    json!({
        "step_events_per_tick": most,
        "interrupts_per_step_event": rounded(ratio(&full, |tick| (tick.calls + 1) as f64, |tick| tick.steps as f64)),
        "per_step_event": {
            "pulse": mean_and_worst(&full, |tick| tick.pulse),
            "interpolate": mean_and_worst(&full, |tick| tick.interpolate),
            "all": mean_and_worst(&full, |tick| tick.pulse + tick.interpolate),
        },
        "per_call_of_pulse": { "mean": rounded(calls.iter().sum::<u64>() as f64 / calls.len().max(1) as f64), "worst": calls.iter().max() },
        "per_tick_of_interpolate": {
            "mean": rounded(ticks.iter().map(|tick| tick.interpolate).sum::<u64>() as f64 / ticks.len() as f64),
            "worst": ticks.iter().map(|tick| tick.interpolate).max(),
            "of_the_worst": of_the_worst,
            "for_each_step_event": per_step.map(rounded),
            "besides": besides,
        },
        "per_idle_tick": {
            "pulse": mean_and_worst(&idle, |tick| tick.pulse),
            "interpolate": mean_and_worst(&idle, |tick| tick.interpolate),
            "all": mean_and_worst(&idle, |tick| tick.pulse + tick.interpolate),
        },
        "percent_of_chip": {
            "mean": rounded(ratio(&full, percent, |_| 1.0)),
            "worst": rounded(full.iter().map(percent).fold(0.0, f64::max)),
        },
    })
}

/// What a tick's interrupts take of the chip, percent.
fn percent(tick: &Tick) -> f64 {
    let instructions = (tick.pulse + tick.interpolate) as f64;
    let interrupts = (tick.calls + 1) as f64;
    (instructions * CLOCKS_PER_INSTRUCTION + interrupts * CLOCKS_PER_INTERRUPT) * 100.0 * f64::from(TICKS_PER_SECOND)
        / CLOCK_HZ
}

/// The sum of one figure over that of another.
fn ratio(ticks: &[Tick], of: impl Fn(&Tick) -> f64, over: impl Fn(&Tick) -> f64) -> f64 {
    ticks.iter().map(of).sum::<f64>() / ticks.iter().map(over).sum::<f64>().max(1.0)
}

/// Mean and worst of a cost for each step event.
fn mean_and_worst(ticks: &[Tick], cost: impl Fn(&Tick) -> u64) -> Value {
    let steps: u64 = ticks.iter().map(|tick| tick.steps).sum();
    let all: u64 = ticks.iter().map(&cost).sum();
    let worst = ticks.iter().map(|tick| cost(tick) as f64 / tick.steps.max(1) as f64).fold(0.0, f64::max);
    json!({ "mean": rounded(all as f64 / steps.max(1) as f64), "worst": rounded(worst) })
}

fn rounded(value: f64) -> f64 {
    (value * 10.0).round() / 10.0
}
