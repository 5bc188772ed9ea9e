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

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, bail};
use interp_core::config::TICKS_PER_SECOND;
use serde_json::{Map, Value, json};

use crate::book;
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
}

/// A case: its name, its program, its parameters.
struct Case(&'static str, &'static str, &'static [&'static str]);

// a space below the default's 5 us, since 100 000 pulses a second and the tick's border need it
const PULSES: [&str; 6] = [
    "x.pulse_nm=1000",
    "z.pulse_nm=1000",
    "x.max_feed=6000",
    "z.max_feed=6000",
    "x.min_space_ns=4500",
    "z.min_space_ns=4500",
];

// pins that are high and low for 2 us: 200 000 pulses a second are 80 % of what they, the events' distance and the
// tick's border allow
const FAST: [&str; 10] = [
    "x.pulse_nm=1000",
    "z.pulse_nm=1000",
    "x.max_feed=12000",
    "z.max_feed=12000",
    "x.max_accel=20000",
    "z.max_accel=20000",
    "x.pulse_width_ns=2000",
    "z.pulse_width_ns=2000",
    "x.min_space_ns=2000",
    "z.min_space_ns=2000",
];

/// The same with an axis's play taken up, expansion followed, and an override.
const COMPENSATED: [&str; 14] = [
    "x.pulse_nm=1000",
    "z.pulse_nm=1000",
    "x.max_feed=6000",
    "z.max_feed=6000",
    "x.min_space_ns=4500",
    "z.min_space_ns=4500",
    "x.backlash_um=20",
    "z.backlash_um=30",
    "x.backlash_distance_um=200",
    "z.backlash_distance_um=200",
    "x.thermal_um_per_m_k=11.5",
    "z.thermal_um_per_m_k=11.5",
    "temperature_c=35",
    "feed_override=90",
];

/// The same with a spindle of 996 turns a minute.
const SPINDLE: [&str; 7] = [
    "x.pulse_nm=1000",
    "z.pulse_nm=1000",
    "x.max_feed=6000",
    "z.max_feed=6000",
    "x.min_space_ns=4500",
    "z.min_space_ns=4500",
    "0:spindle=68*5000",
];

const SINE: [&str; 7] = [
    "x.pulse_nm=1000",
    "z.pulse_nm=1000",
    "x.max_feed=6000",
    "z.max_feed=6000",
    "x.min_space_ns=4500",
    "z.min_space_ns=4500",
    "accel=sine",
];

/// Everything at once: both axes at 100 000 pulses a second, compensated, under the sine law, both handwheels turned.
const EVERYTHING: [&str; 21] = [
    "x.pulse_nm=1000",
    "z.pulse_nm=1000",
    "x.max_feed=9000",
    "z.max_feed=9000",
    "x.max_accel=5000",
    "z.max_accel=5000",
    "x.pulse_width_ns=2500",
    "z.pulse_width_ns=2500",
    "x.min_space_ns=2000",
    "z.min_space_ns=2000",
    "x.backlash_um=20",
    "z.backlash_um=30",
    "x.thermal_um_per_m_k=11.5",
    "z.thermal_um_per_m_k=11.5",
    "temperature_c=35",
    "accel=sine",
    "max_jerk=200000",
    "handwheels=true",
    "60:wheel-x=3*2000",
    "60:wheel-z=-2*2000",
    "200:override=97",
];

const CASES: [Case; 14] = [
    Case("line 4:3, X at 80 kHz", "G21 G90\nG4 P0.05\nG1 X40 Z30 F6000\nM2\n", &PULSES),
    Case("arc, R 10 mm, 25 kHz", "G21 G90\nG4 P0.05\nG3 X-10 Z-10 I-10 K0 F1500\nM2\n", &PULSES),
    // its centre lies between the lattice lines, so the walk needs 64 bits
    Case("arc, R 10 mm by R, 25 kHz", "G21 G90\nG4 P0.05\nG3 X-12 Z-11 R10 F1500\nM2\n", &PULSES),
    Case("line 1:1, 71 kHz", "G21 G90\nG4 P0.05\nG1 X30 Z30 F6000\nM2\n", &PULSES),
    Case("line 4:3, X at 200 kHz", "G21 G90\nG4 P0.05\nG0 X80 Z60\nM2\n", &FAST),
    Case("arc, R 50 mm, 200 kHz", "G21 G90\nG4 P0.05\nG3 X-50 Z-50 I-50 K0 F12000\nM2\n", &FAST),
    Case("line 4:3, compensated, override 90 %", "G21 G90\nG4 P0.05\nG1 X40 Z30 F6000\nM2\n", &COMPENSATED),
    Case(
        "arc, R 10 mm, compensated, override 90 %",
        "G21 G90\nG4 P0.05\nG3 X-10 Z-10 I-10 K0 F1500\nM2\n",
        &COMPENSATED,
    ),
    Case("line 4:3, sine law", "G21 G90\nG4 P0.05\nG1 X40 Z30 F6000\nM2\n", &SINE),
    Case("line 4:3, a feed a turn, X at 80 kHz", "G21 G90\nM3 S1000\nG4 P0.05\nG95 G1 X40 Z30 F6\nM2\n", &SPINDLE),
    Case("thread, lead 4.8 mm, 80 kHz", "G21 G90\nM3 S1000\nG4 P0.05\nG33 Z30 K4.8\nM2\n", &SPINDLE),
    Case("line 1:1, everything, 2 x 100 kHz", "G21 G90\nG4 P0.05\nG1 X60 Z60 F8485\nM2\n", &EVERYTHING),
    Case("arc, R 50 mm, everything, 141 kHz", "G21 G90\nG4 P0.05\nG3 X-50 Z-50 I-50 K0 F8485\nM2\n", &EVERYTHING),
    Case("arc, R 10 mm, sine law", "G21 G90\nG4 P0.05\nG3 X-10 Z-10 I-10 K0 F1500\nM2\n", &SINE),
];

/// The chip that shares are told of: its clock, clocks of an instruction, of an interrupt's entry and exit
/// (`docs/src/firmware.md`).
const CLOCK_HZ: f64 = 168e6;
const CLOCKS_PER_INSTRUCTION: f64 = 1.35;
const CLOCKS_PER_INTERRUPT: f64 = 24.0;

/// Handlers by the names of their vectors; the first two are reported.
const HANDLERS: [&str; 5] = ["TIM5", "I2C3_ER", "USART2", "I2C3_EV", "EXTI15_10"];

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
    for case in &CASES {
        counted.push((case.0, measure(&elf, &plugin, folder.path(), case).with_context(|| case.0)?));
    }
    let mut cases = Map::new();
    for (name, counts) in &counted {
        // the two cases of one curve with the fewest and the most steps a tick, under the linear law and uncompensated
        let plain = |name: &str| !["law", "compensated", "everything", "turn"].iter().any(|other| name.contains(other));
        let kin = counted.iter().filter(|(other, _)| plain(other) && other.split(' ').next() == name.split(' ').next());
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
    let Case(_, program, parameters) = case;
    let counts = folder.join("counts");
    let image = Image::read(elf)?;
    let mut option = format!("{},out={}", plugin.display(), counts.display());
    for name in HANDLERS {
        let at = image.address(name).with_context(|| format!("the image has no handler {name}"))?;
        let size = image.functions.get(&at).map_or(0, |function| function.size);
        option.push_str(&format!(",h={name}:{at:x}:{:x}", at + size));
    }
    let set: Vec<String> = parameters.iter().map(|text| (*text).to_owned()).collect();
    let trial = Trial::new(program.as_bytes(), &set)?;
    let played = emulate::play(elf, &trial, &["-plugin".into(), option])?;
    let text = fs::read_to_string(&counts).context("the plugin wrote nothing")?;
    let of = |wanted: &str| -> Result<Vec<u64>> {
        let lines = text.lines().filter_map(|line| line.split_once(' '));
        lines.filter(|(name, _)| *name == wanted).map(|(_, count)| Ok(count.parse()?)).collect()
    };
    if of("anomalies")? != [0] {
        bail!("the plugin met calls that it does not understand");
    }
    Counts::new(&played, &of("TIM5")?, &of("I2C3_ER")?)
}

/// What was counted in one case.
struct Counts {
    ticks: Vec<Tick>,
    /// Of each call of `pulse`.
    calls: Vec<u64>,
    /// Step events of the busiest tick.
    most: u64,
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
        Ok(Self { ticks, calls: pulse.get(before..at).unwrap_or_default().to_vec(), most })
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

/// What `interpolate` takes for each step event more: from the usual ticks of the slowest and the fastest case.
fn slope<'a>(cases: impl Iterator<Item = &'a Counts>) -> f64 {
    let mut usual: Vec<(f64, f64)> = cases.map(Counts::usual).collect();
    usual.sort_by(|a, b| a.0.total_cmp(&b.0));
    match (usual.first(), usual.last()) {
        (Some(slow), Some(fast)) if fast.0 > slow.0 => (fast.1 - slow.1) / (fast.0 - slow.0),
        _ => 0.0,
    }
}

fn figures(counts: &Counts, per_step: f64) -> Value {
    let (ticks, most, full) = (&counts.ticks, counts.most, counts.full());
    // the programs begin with a dwell; its first tick takes the block
    let idle: Vec<Tick> =
        ticks.iter().take_while(|tick| tick.steps == 0).skip(2).map(|tick| Tick { steps: 1, ..*tick }).collect();
    let idle = idle.get(..idle.len().saturating_sub(1)).unwrap_or_default().to_vec();
    let calls = &counts.calls;
    let fixed: Vec<f64> = ticks
        .iter()
        .filter(|tick| tick.steps > 0)
        .map(|tick| (tick.interpolate as f64 - per_step * tick.steps as f64).max(0.0))
        .collect();
    let mean = fixed.iter().sum::<f64>() / fixed.len().max(1) as f64;
    let (steps, cost) = counts.usual();
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
            "worst": ticks.iter().map(|tick| tick.interpolate).max(),
            "for_each_step_event": rounded(per_step),
            "besides": {
                "at_full_speed": rounded(cost - per_step * steps),
                "mean": rounded(mean),
                "worst": rounded(fixed.iter().copied().fold(0.0, f64::max)),
            },
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
