//! The command `turn`: checks a program, runs it, measures its train, writes trace, report and pictures.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use feature_editor::codes::{Format, Item};
use handcnc::background::parameters::Parameters;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use interp_core::config::Machine;
use interp_core::units::Axis;
use stock::{ContourError, Part, SetupError, Tool};

use crate::examples::{EXAMPLES, Example};
use crate::insets::Chooser;
use crate::motors::Motors;
use crate::options::{Programs, Setup, animation_file, picture_file};
use crate::output::{Pending, Places};
use crate::picture::Form;
use crate::program::Program;
use crate::report::{self, Run};
use crate::settings::{Refusal, Settings};
use crate::sheets::Sheets;
use crate::watch::{Watch, Watched};
use crate::work::Curves;
use crate::{lathe, messages};

/// Exit code: done.
pub const DONE: u8 = 0;
/// Exit code: the program or the parameters were refused.
pub const REFUSED: u8 = 1;
/// Exit code: a file can't be read or written.
pub const UNUSABLE: u8 = 2;

/// Warnings of one kind that a report lists.
const WARNINGS_LISTED: usize = 100;

/// What `turn` is asked to do.
#[derive(Args, Clone, Debug, Default)]
pub struct Job {
    /// Program text; `-` is standard input.
    pub file: Option<PathBuf>,
    /// Machine, tables and format.
    #[command(flatten)]
    pub programs: Programs,
    /// Write every step: time in ns, position in pulses.
    #[arg(long, value_name = "FILE.csv")]
    pub trace: Option<PathBuf>,
    /// Write the figures.
    #[arg(long, value_name = "FILE.json")]
    pub report: Option<PathBuf>,
    /// Draw the path (SVG or PNG by the name's ending). Without any output option out/NAME.svg and .png are drawn.
    #[arg(long, value_name = "FILE.svg|png", value_parser = picture_file)]
    pub picture: Option<PathBuf>,
    /// Draw how far the cut surface is from the contour, magnified.
    #[arg(long, value_name = "FILE.svg|png", value_parser = picture_file)]
    pub error_picture: Option<PathBuf>,
    /// Draw speed, acceleration and pulse rate over time.
    #[arg(long, value_name = "FILE.svg|png", value_parser = picture_file)]
    pub motion_picture: Option<PathBuf>,
    /// Show the cut, as an animated picture.
    #[arg(long, value_name = "FILE.gif|png", value_parser = animation_file)]
    pub animate: Option<PathBuf>,
}

impl Job {
    /// The outputs asked for, other than trace and report.
    fn pictures(&self) -> impl Iterator<Item = &PathBuf> {
        self.picture.iter().chain(&self.error_picture).chain(&self.motion_picture).chain(&self.animate)
    }
}

/// Why a job ended early.
#[derive(Debug)]
pub enum Failure {
    /// Said already.
    Refused,
    /// A file can't be read or written.
    Unusable(String),
    /// The machine's own check failed: a bug, worth a report.
    Fault(String),
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self::Unusable(error.to_string())
    }
}

/// Runs a job; the exit code.
pub fn turn(job: &Job) -> u8 {
    match run(job) {
        Ok(()) => DONE,
        Err(failure) => told(failure),
    }
}

/// Tells why a job ended early; the exit code.
pub fn told(failure: Failure) -> u8 {
    match failure {
        Failure::Refused => REFUSED,
        Failure::Unusable(message) => {
            eprintln!("error: {message}");
            UNUSABLE
        }
        Failure::Fault(message) => {
            eprintln!(
                "fault: {message}\n   = the pulses were found wrong; nothing was written. This is a bug: please report the program"
            );
            REFUSED
        }
    }
}

/// Reads a machine file and parameters by name.
///
/// # Errors
/// The exit code; all errors are told.
pub fn settings(setup: &Setup) -> Result<(Settings, Machine), u8> {
    parameters(&Programs { setup: setup.clone(), ..Programs::default() }, None).map_err(told)
}

/// A program that has run.
pub struct Finished {
    /// The program's name.
    pub name: String,
    /// What the watch saw.
    pub watched: Watched,
    /// Figures for the report.
    pub run: Run,
    /// The tool that cut.
    pub tool: Option<Tool>,
    /// Size of a pulse, Z and X, in mm.
    pub pulse: [f64; 2],
}

fn run(job: &Job) -> Result<(), Failure> {
    let example = EXAMPLES.first().filter(|_| job.file.is_none());
    // the demo comes with its bar, unless a machine file says what there is
    let (settings, machine) = parameters(&job.programs, example.filter(|_| job.programs.setup.machine.is_none()))?;
    let program = match (&job.file, example) {
        (Some(path), _) => {
            Program::open(path).map_err(|error| Failure::Unusable(format!("{}: {error}", path.display())))?
        }
        (None, Some(example)) => example.program(),
        (None, None) => return Err(Failure::Unusable("there is no program".into())),
    };
    let pictures = pictures(job, &program);
    let mut places = Places::default();
    for input in job.file.iter().chain(job.programs.inputs()) {
        places.input(input);
    }
    let others = [&job.error_picture, &job.motion_picture, &job.animate].into_iter().flatten();
    for output in job.trace.iter().chain(&job.report).chain(&pictures).chain(others) {
        places.output(output)?;
    }
    let finished = perform(&program, job, &settings, &machine)?;
    conclude(job, &pictures, finished)
}

/// Runs one of the examples with its own bar and tool.
///
/// # Errors
/// [`Failure`].
pub fn run_example(example: &'static Example) -> Result<Finished, Failure> {
    let job = Job { animate: Some(PathBuf::new()), ..Job::default() };
    let (settings, machine) = parameters(&job.programs, Some(example))?;
    perform(&example.program(), &job, &settings, &machine)
}

/// Checks a program, runs it and measures.
fn perform(program: &Program, job: &Job, settings: &Settings, machine: &Machine) -> Result<Finished, Failure> {
    let parameters = &settings.parameters;
    let name = program.name();
    let format = match job.programs.format() {
        Some(format) => format,
        None => program.detect()?,
    };
    let bar = progress(program.size());
    let (mut warnings, chooser, curves) = check(program, format, parameters, machine, &bar)?;
    let clamped = match curves.clamp(&settings.figures) {
        Ok(clamped) => clamped,
        Err(error) => {
            bar.finish_and_clear();
            return Err(unclamped(&name, error));
        }
    };
    if curves.is_too_long() {
        warnings.push("the program is too long to compare its surface with the contour".into());
    }
    let leaves = clamped.as_ref().and_then(|clamped| clamped.leaves(&settings.figures));
    if let Some((line, place)) = leaves {
        let (z, x) = (place.z, place.x);
        warnings.push(format!("line {line}: the part ends outside the stock, near Z{z:.3}, radius {x:.3} mm"));
    }
    let tool = clamped.as_ref().map(|clamped| clamped.tool);
    let trace = match &job.trace {
        Some(path) => Some(Pending::create(path)?),
        None => None,
    };
    bar.set_message("turning");
    bar.set_position(0);
    let model = settings.model(machine).map_err(|error| Failure::Unusable(error.to_string()))?;
    let watch = Watch::new(parameters, machine, chooser, trace, bar)?;
    let mut watch = watch.with_work(Motors::new(model), clamped, job.animate.is_some());
    let began = Instant::now();
    let fit = lathe::Fit { tables: &settings.pitch, figures: &settings.figures };
    if let Err(error) = lathe::run_fitted(program, format, parameters, machine, fit, &[], &mut watch) {
        watch.bar().finish_and_clear();
        return Err(stopped(&name, error));
    }
    let wall = began.elapsed();
    watch.bar().finish_and_clear();
    if let Some((count, line)) = watch.stops() {
        warnings.push(format!("line {line}: programmed stop passed by, as there is no operator ({count} in all)"));
    }
    let pulse = watch.pulse();
    let watched = watch.finish();
    let faults = &watched.report.faults;
    if faults.total() > 0 {
        let list: Vec<String> = faults.first().iter().map(ToString::to_string).collect();
        return Err(Failure::Fault(format!("{name}: {} broken rules\n   {}", faults.total(), list.join("\n   "))));
    }
    let motors = watched.motors.as_ref();
    warnings.extend(motors.map(Motors::warnings).unwrap_or_default());
    let lost_pulses = motors.map(Motors::lost_pulses).unwrap_or_default();
    let motor_load = motors.map(Motors::peaks).unwrap_or_default();
    let compensated = parameters.compensation(Axis::X).is_on() || parameters.compensation(Axis::Z).is_on();
    let run = Run {
        blocks: watched.blocks,
        wall,
        lost_pulses,
        motor_load,
        compensated,
        slides_off: watched.slides_off,
        warnings,
    };
    Ok(Finished { name, watched, run, tool, pulse })
}

/// Tells why a run did not come to its end.
fn stopped(name: &str, error: io::Error) -> Failure {
    let Some(alarmed) = error.get_ref().and_then(|error| error.downcast_ref::<lathe::Alarmed>()) else {
        return error.into();
    };
    eprintln!("error: {name}: {alarmed}\n   = {}; nothing was written", messages::after(alarmed.alarm));
    Failure::Refused
}

/// Tells why nothing was clamped.
fn unclamped(name: &str, error: SetupError) -> Failure {
    match error {
        SetupError::Figures(error) => eprintln!("error: {error}"),
        SetupError::Program(errors) => {
            for error in errors {
                eprintln!("error: {name}: {error}\n   = {}", remedy(&error));
            }
        }
    }
    eprintln!("   = `parameters` lists all names, units and ranges; nothing was run");
    Failure::Refused
}

fn remedy(error: &ContourError) -> &'static str {
    match error {
        ContourError::TooThin { .. } => "make stock.diameter_mm larger, or correct the program",
        ContourError::TooShort { .. } => "make stock.length_mm larger, move stock.face_mm, or correct the program",
        ContourError::TooHollow { .. } => "make stock.bore_mm smaller, or correct the program",
        ContourError::Unreachable { part: Part::Front, .. } => {
            "take a tool with a greater tool.front_deg, or make the slope flatter"
        }
        ContourError::Unreachable { .. } => "take a tool with a greater tool.back_deg, or make the slope flatter",
    }
}

/// Reads machine file and settings; all errors are told.
fn parameters(programs: &Programs, example: Option<&Example>) -> Result<(Settings, Machine), Failure> {
    let own =
        example.into_iter().flat_map(|example| example.set).map(|(name, value)| ((*name).into(), (*value).into()));
    let set: Vec<(String, String)> = own.chain(programs.setup.set.iter().cloned()).collect();
    let (file, pitch) = (programs.setup.machine.as_deref(), programs.pitch_table.as_deref());
    Settings::read_fitted(file, &set, pitch).map_err(|refusal| match refusal {
        Refusal::Unreadable(message) => Failure::Unusable(message),
        Refusal::Wrong(errors) => {
            for error in &errors {
                eprintln!("{error}");
            }
            eprintln!("   = `parameters` lists all names, units and ranges; nothing was run");
            Failure::Refused
        }
    })
}

/// Checks the program whole; its warnings, and what of it is worth magnifying.
fn check(
    program: &Program,
    format: Format,
    parameters: &Parameters,
    machine: &Machine,
    bar: &ProgressBar,
) -> Result<(Vec<String>, Chooser, Curves), Failure> {
    bar.set_message("checking");
    let mut chooser = Chooser::new(parameters.start());
    let mut curves = Curves::new(parameters.start());
    let mut action = |item: &Item| {
        chooser.action(item);
        curves.action(item);
    };
    let checked = lathe::check(program, format, parameters, machine, &mut action, &mut |bytes| {
        bar.set_position(bytes);
    })?;
    let name = program.name();
    bar.suspend(|| {
        for (finding, line) in &checked.findings {
            eprint!("{}", messages::finding(&name, finding, line));
        }
    });
    if checked.errors > 0 {
        bar.finish_and_clear();
        let more = checked.errors.saturating_sub(lathe::FINDINGS_KEPT);
        let rest = if more > 0 { format!(" ({more} of them not shown)") } else { String::new() };
        eprintln!("{name}: refused, {} error(s) in {} line(s){rest}; nothing was run", checked.errors, checked.lines);
        return Err(Failure::Refused);
    }
    let mut warnings: Vec<String> = checked
        .findings
        .iter()
        .map(|(finding, _)| format!("line {}: {finding}", finding.line()))
        .take(WARNINGS_LISTED)
        .collect();
    if checked.warnings > warnings.len() {
        warnings.push(format!("{} more warnings", checked.warnings - warnings.len()));
    }
    Ok((warnings, chooser, curves))
}

/// Writes what was asked for, once the figures are in.
fn conclude(job: &Job, pictures: &[PathBuf], mut finished: Finished) -> Result<(), Failure> {
    let mut files = Vec::new();
    files.extend(finished.watched.trace.take());
    let (report, worked) = (&finished.watched.report, &finished.watched.worked);
    if let Some(path) = &job.report {
        let mut file = Pending::create(path)?;
        file.writer().write_all(report::json(report, worked, &finished.run).as_bytes())?;
        files.push(file);
    }
    let sheets = Sheets::new(&finished);
    for path in pictures {
        files.push(sheets.write(path, &sheets.part())?);
    }
    if let Some(path) = &job.error_picture {
        files.push(sheets.write(path, &sheets.error())?);
    }
    if let Some(path) = &job.motion_picture {
        files.push(sheets.write(path, &sheets.motion())?);
    }
    if let Some(path) = &job.animate {
        let mut file = Pending::create(path)?;
        let is_gif = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("gif"));
        let form = if is_gif { Form::Gif } else { Form::Png };
        file.writer().write_all(&sheets.animation(form, &progress(0))?)?;
        files.push(file);
    }
    let mut told = report::summary(&finished.name, report, worked, &finished.run);
    for warning in &finished.run.warnings {
        told.push_str(&format!("  warning     {warning}\n"));
    }
    for file in files {
        told.push_str(&format!("  wrote       {}\n", file.keep()?.display()));
    }
    // the files are in place: a reader that has gone is no failure
    let _ = io::stdout().lock().write_all(told.as_bytes());
    Ok(())
}

/// The pictures to draw: the one asked for, or both kinds where no output was asked for.
fn pictures(job: &Job, program: &Program) -> Vec<PathBuf> {
    if let Some(path) = &job.picture {
        return vec![path.clone()];
    }
    if job.trace.is_some() || job.report.is_some() || job.pictures().next().is_some() {
        return Vec::new();
    }
    let stem = program.stem();
    vec![Path::new("out").join(format!("{stem}.svg")), Path::new("out").join(format!("{stem}.png"))]
}

/// A bar that shows from the first second on, on terminals.
pub(crate) fn progress(size: u64) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(size), ProgressDrawTarget::stderr_with_hz(10));
    let style = ProgressStyle::with_template("{msg:>9} {bar:30} {percent:>3} %  {elapsed} of {duration}");
    if let Ok(style) = style {
        bar.set_style(style);
    }
    bar
}
