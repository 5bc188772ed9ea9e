//! The command `operate`: the virtual lathe under a script of what an operator does.
//!
//! [`script`] reads the script, `control` runs it: events become requests and readings of the firmware's own foreground,
//! `bench` is the machine that they come from, `background` feeds programs, [`state`] is what `expect` looks at.
//!
//! What the control makes in a tick is played in the next one, as on the chip. Nothing here takes the clock of the wall, and
//! what looks like chance comes from a seed: a scenario gives the same state in every run.

mod background;
mod bench;
pub mod chronicle;
mod control;
pub mod event;
pub mod expect;
mod noise;
pub mod number;
mod obey;
pub mod script;
mod sheet;
pub mod soak;
mod spindle;
pub mod state;
mod wheels;
mod words;

use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use clap::Args;
use feature_editor::codes::Format;
use indicatif::ProgressBar;
use interp_core::config::Machine;

use background::Background;
use bench::Bench;
use control::Control;
pub use control::{Done, Failed};
use event::{Event, What};
use script::{Script, ScriptError};

use crate::options::{Programs, picture_file};
use crate::output::{Pending, Places};
use crate::picture;
use crate::settings::{Refusal, Settings};
use crate::turn;

/// Exit code: an expectation failed, or the pulses were found wrong.
pub const FAILED: u8 = 1;
/// Exit code: the script or the parameters are wrong, or a file can't be read or written.
pub const WRONG: u8 = 2;

/// What `operate` is asked to do.
#[derive(Args, Clone, Debug, Default)]
pub struct Job {
    /// The script: a line an event, SECONDS WHAT.
    pub scenario: PathBuf,
    /// Machine, tables and format.
    #[command(flatten)]
    pub programs: Programs,
    /// Write every step: time in ns, position in pulses.
    #[arg(long, value_name = "FILE.csv")]
    pub trace: Option<PathBuf>,
    /// Write the final state.
    #[arg(long, value_name = "FILE.json")]
    pub report: Option<PathBuf>,
    /// Draw what the tool did (SVG or PNG by the name's ending). Without any output option out/NAME.svg, .png and .csv are
    /// written.
    #[arg(long, value_name = "FILE.svg|png", value_parser = picture_file)]
    pub picture: Option<PathBuf>,
}

/// Why a scenario did not run.
#[derive(Debug)]
pub enum Unrun {
    /// All that is wrong with the script.
    Script(Vec<ScriptError>),
    /// All that is wrong with the parameters, each as a line of its own.
    Parameters(Vec<String>),
    /// A file can't be read or written.
    Unusable(String),
}

impl From<io::Error> for Unrun {
    fn from(error: io::Error) -> Self {
        Self::Unusable(error.to_string())
    }
}

/// Runs a job; the exit code.
pub fn operate(job: &Job) -> u8 {
    let name = job.scenario.display().to_string();
    let outputs = outputs(job);
    let done = places(job, &outputs).map_err(Unrun::from).and_then(|()| perform(job, outputs.trace.as_deref()));
    let told = done.and_then(|done| conclude(&name, &outputs, done).map_err(Unrun::from));
    match told {
        Ok(code) => code,
        Err(Unrun::Script(errors)) => {
            errors.iter().for_each(|error| eprint!("{}", message(&name, error)));
            eprintln!("{name}: {} error(s); nothing was run", errors.len());
            WRONG
        }
        Err(Unrun::Parameters(errors)) => {
            errors.iter().for_each(|error| eprintln!("{error}"));
            eprintln!("   = `parameters` lists all names, units and ranges; nothing was run");
            WRONG
        }
        Err(Unrun::Unusable(message)) => {
            eprintln!("error: {message}");
            WRONG
        }
    }
}

/// Runs a scenario; nothing is printed, and only the trace is written, if asked for, but not put in its place.
///
/// # Errors
/// [`Unrun`].
pub fn perform(job: &Job, trace: Option<&Path>) -> Result<Done, Unrun> {
    let path = &job.scenario;
    let unreadable = |error: &dyn std::fmt::Display| Unrun::Unusable(format!("{}: {error}", path.display()));
    let bytes = std::fs::read(path).map_err(|error| unreadable(&error))?;
    let text = String::from_utf8(bytes).map_err(|_| unreadable(&"is no text in UTF-8"))?;
    let Script { events } = script::parse(&text).map_err(Unrun::Script)?;
    let (settings, machine, events) = prepare(job, events)?;
    let trace = match trace {
        Some(path) => Some(Pending::create(path)?),
        None => None,
    };
    let last = events.last().map_or(0, |event| event.tick);
    let bar = turn::progress(last);
    bar.set_message("operating");
    let done = control(settings, machine, events, job.programs.format(), trace, bar.clone())?.run();
    bar.finish_and_clear();
    Ok(done?)
}

/// The machine with its control, before the first tick.
fn control(
    settings: Settings,
    machine: Machine,
    events: Vec<Event>,
    format: Option<Format>,
    mut trace: Option<Pending>,
    bar: ProgressBar,
) -> Result<Control, Unrun> {
    let start = settings.parameters.start();
    if let Some(trace) = &mut trace {
        let (x, z) = (machine.x.pulse.nearest(start.x), machine.z.pulse.nearest(start.z));
        writeln!(trace.writer(), "time_ns,x,z\n0,{x},{z}")?;
    }
    let wrong = |error: figures::FigureError| Unrun::Parameters(vec![format!("error: {error}")]);
    let model = settings.model(&machine).map_err(wrong)?;
    let bench = Bench::new(&settings, model).map_err(wrong)?;
    let background = Background::new(settings, machine, format);
    Ok(Control::new(events, bench, background, trace, bar)?)
}

/// Parameters of the call, then those that the script sets at second 0, which describe the machine from its start; those
/// that it sets later are tried. The events that are left, with the places of programs relative to the script's folder.
fn prepare(job: &Job, mut events: Vec<Event>) -> Result<(Settings, Machine, Vec<Event>), Unrun> {
    let programs = &job.programs;
    let mut settings = Settings::default();
    // a name and a value of the list
    let _ = settings.set("handwheels", "true");
    let (mut settings, mut machine) = settings
        .read_fitted_over(programs.setup.machine.as_deref(), &programs.setup.set, programs.pitch_table.as_deref())
        .map_err(|refusal| match refusal {
            Refusal::Unreadable(message) => Unrun::Unusable(message),
            Refusal::Wrong(errors) => Unrun::Parameters(errors),
        })?;
    let mut errors = Vec::new();
    let (mut later, mut first) = (settings.clone(), settings.clone());
    for event in &events {
        let What::Set(name, value) = &event.what else { continue };
        match set(&later, name, value, event.tick == 0) {
            Ok((next, its)) => {
                if event.tick == 0 {
                    (first, machine) = (next.clone(), its);
                }
                later = next;
            }
            Err((cause, remedy)) => errors.push(error_of(event, cause, remedy)),
        }
    }
    settings = first;
    let folder = job.scenario.parent().unwrap_or(Path::new(""));
    for event in &mut events {
        if let What::Load(file) = &mut event.what {
            *file = folder.join(&*file);
        }
    }
    errors.extend(events.iter().filter_map(unreadable));
    errors.extend(unknown_keys(&settings, &machine, &events)?);
    if !errors.is_empty() {
        errors.sort_by_key(|error| error.line);
        return Err(Unrun::Script(errors));
    }
    events.retain(|event| event.tick > 0 || !matches!(event.what, What::Set(..)));
    Ok((settings, machine, events))
}

/// A program that can't be read.
fn unreadable(event: &Event) -> Option<ScriptError> {
    let What::Load(file) = &event.what else { return None };
    let error = std::fs::read(file).err()?;
    let remedy = "the name is relative to the script's folder".to_owned();
    Some(error_of(event, format!("{}: {error}", file.display()), remedy))
}

/// Expectations of what the state does not have.
fn unknown_keys(settings: &Settings, machine: &Machine, events: &[Event]) -> Result<Vec<ScriptError>, Unrun> {
    let state = control(settings.clone(), *machine, Vec::new(), None, None, ProgressBar::hidden())?.state();
    let known = state.as_object().map(|fields| fields.keys().cloned().collect::<Vec<_>>().join(", "));
    let remedy = format!("the state has {}", known.unwrap_or_default());
    let unknown = |event: &Event| match &event.what {
        What::Expect(expect) if !expect::is_known(&state, &expect.key) => {
            Some(error_of(event, format!("the state has no {}", expect.key), remedy.clone()))
        }
        _ => None,
    };
    Ok(events.iter().filter_map(unknown).collect())
}

/// Settings with one set, and their machine.
fn set(settings: &Settings, name: &str, value: &str, at_first: bool) -> Result<(Settings, Machine), script::Wrong> {
    let remedy = "the command parameters lists all names, units and ranges";
    let mut next = settings.clone();
    next.set(name, value).map_err(|cause| (format!("{name} = {value}: {cause}"), remedy.to_owned()))?;
    let fixed = handcnc::background::parameters::Parameters::new().iter().all(|(known, _)| known.name != name)
        || matches!(name, "start" | "x.pulse_nm" | "z.pulse_nm" | "handwheels");
    if fixed && !at_first {
        return Err((format!("{name} can't change while the machine is on"), "set it at second 0".into()));
    }
    let machine = next.parameters.machine().map_err(|error| (error.to_string(), remedy.to_owned()))?;
    next.model(&machine).map_err(|error| (error.to_string(), remedy.to_owned()))?;
    Ok((next, machine))
}

fn error_of(event: &Event, cause: String, remedy: String) -> ScriptError {
    let text = event.text.clone();
    let blank = text.chars().take_while(|letter| letter.is_whitespace()).count();
    let number = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
    let span = (number(blank + 1), number(text.chars().count().saturating_sub(blank)));
    ScriptError { line: event.line, span, text, cause, remedy }
}

/// An error as a person reads it.
#[must_use]
pub fn message(name: &str, error: &ScriptError) -> String {
    let ScriptError { line, span: (column, length), text, cause, remedy } = error;
    let shown: String = text.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect();
    let blank = " ".repeat(line.to_string().len());
    let pad = " ".repeat(column.saturating_sub(1) as usize);
    let mark = "^".repeat((*length).max(1) as usize);
    format!(
        "error: {name}:{line}:{column}: {cause}\n {blank} |\n {line} | {shown}\n {blank} | {pad}{mark}\n   = {remedy}\n"
    )
}

/// Files to write.
struct Outputs {
    trace: Option<PathBuf>,
    report: Option<PathBuf>,
    pictures: Vec<PathBuf>,
}

/// Those asked for, or trace and pictures under `out` where none was.
fn outputs(job: &Job) -> Outputs {
    let Job { trace, report, picture, .. } = job.clone();
    if trace.is_some() || report.is_some() || picture.is_some() {
        return Outputs { trace, report, pictures: picture.into_iter().collect() };
    }
    let stem = job.scenario.file_stem().map_or_else(|| "scenario".into(), |stem| stem.to_string_lossy().into_owned());
    let named = |ending: &str| Path::new("out").join(format!("{stem}.{ending}"));
    Outputs { trace: Some(named("csv")), report: None, pictures: vec![named("svg"), named("png")] }
}

fn places(job: &Job, outputs: &Outputs) -> io::Result<()> {
    let mut places = Places::default();
    for input in [&job.scenario].into_iter().chain(job.programs.inputs()) {
        places.input(input);
    }
    outputs.trace.iter().chain(&outputs.report).chain(&outputs.pictures).try_for_each(|path| places.output(path))
}

/// Width of pictures, pixels.
const WIDTH: u32 = 1600;

/// What stands beside the title.
fn facts(done: &Done) -> String {
    let seconds = expect::at(&done.state, "tick").and_then(serde_json::Value::as_f64).unwrap_or(0.0) / 1e3;
    let hash = expect::at(&done.state, "train_hash").and_then(serde_json::Value::as_str).unwrap_or_default();
    format!("{seconds:.3} s · train {hash}")
}

/// Writes a picture as its name's ending says.
fn draw(path: &Path, svg: &str) -> io::Result<Pending> {
    let mut file = Pending::create(path)?;
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png")) {
        file.writer().write_all(&picture::png(svg, WIDTH).map_err(io::Error::other)?)?;
    } else {
        file.writer().write_all(svg.as_bytes())?;
    }
    Ok(file)
}

/// Writes what was asked for, and tells; the exit code.
fn conclude(name: &str, outputs: &Outputs, mut done: Done) -> io::Result<u8> {
    let json = format!("{:#}\n", done.state);
    let mut files: Vec<Pending> = done.trace.take().into_iter().collect();
    if let Some(path) = &outputs.report {
        let mut file = Pending::create(path)?;
        file.writer().write_all(json.as_bytes())?;
        files.push(file);
    }
    let title =
        Path::new(name).file_stem().map_or_else(|| name.into(), |stem| stem.to_string_lossy().replace('-', " "));
    if !outputs.pictures.is_empty() {
        let svg = sheet::sheet(&title, facts(&done), &done.chronicle, &done.machine).svg(WIDTH);
        for path in &outputs.pictures {
            files.push(draw(path, &svg)?);
        }
    }
    let mut told = String::new();
    for failed in &done.failed {
        let _ = writeln!(told, "failed: {name}:{}: {}\n   | {}", failed.line, failed.cause, failed.text.trim());
    }
    if done.endless {
        let _ = writeln!(
            told,
            "warning: {name}: something still moves or runs a minute after the last event: write an end"
        );
    }
    let broken = done.broken.total();
    if broken > 0 {
        let _ = writeln!(
            told,
            "fault: {name}: {broken} broken rules of the motors. This is a bug: please report the scenario"
        );
        for fault in done.broken.first() {
            let _ = writeln!(told, "   {fault}");
        }
    }
    for file in files {
        let _ = writeln!(told, "wrote {}", file.keep()?.display());
    }
    eprint!("{told}");
    // the files are in place: a reader that has gone is no failure
    let _ = io::stdout().lock().write_all(json.as_bytes());
    Ok(if done.failed.is_empty() && broken == 0 { turn::DONE } else { FAILED })
}
