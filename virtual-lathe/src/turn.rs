//! The command `turn`: checks a program, runs it, measures its train, writes trace, report and pictures.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use feature_editor::codes::Format;
use handcnc::background::parameters::Parameters;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use interp_core::config::Machine;
use measure::Report;

use crate::insets::Chooser;
use crate::lathe;
use crate::motors::Motors;
use crate::output::{Pending, Places};
use crate::picture::{self, Drawing, Inset, Thinner};
use crate::program::Program;
use crate::report::{self, Run};
use crate::settings::{Refusal, Settings};
use crate::watch::{Watch, Watched};
use crate::{DEMO, messages};

/// Exit code: done.
pub const DONE: u8 = 0;
/// Exit code: the program or the parameters were refused.
pub const REFUSED: u8 = 1;
/// Exit code: a file can't be read or written.
pub const UNUSABLE: u8 = 2;

/// Width of pictures, pixels.
const WIDTH: u32 = 1600;
/// Warnings of one kind that a report lists.
const WARNINGS_LISTED: usize = 100;

/// What `turn` is asked to do.
#[derive(Clone, Debug, Default)]
pub struct Job {
    /// The program; the demo without one.
    pub file: Option<PathBuf>,
    /// Its format; told from the text without one.
    pub format: Option<Format>,
    /// Machine file.
    pub machine: Option<PathBuf>,
    /// Parameters by name.
    pub set: Vec<(String, String)>,
    /// Where the trace goes.
    pub trace: Option<PathBuf>,
    /// Where the report goes.
    pub report: Option<PathBuf>,
    /// Where the picture goes.
    pub picture: Option<PathBuf>,
}

/// Why a job ended early.
enum Failure {
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
fn told(failure: Failure) -> u8 {
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
pub fn settings(machine: Option<&Path>, set: &[(String, String)]) -> Result<(Settings, Machine), u8> {
    let job = Job { machine: machine.map(Into::into), set: set.to_vec(), ..Job::default() };
    parameters(&job).map_err(told)
}

fn run(job: &Job) -> Result<(), Failure> {
    let (settings, machine) = parameters(job)?;
    let parameters = &settings.parameters;
    let program = match &job.file {
        None => Program::Text { name: "handle.nc".into(), text: DEMO.to_vec() },
        Some(path) => Program::open(path).map_err(|error| Failure::Unusable(format!("{}: {error}", path.display())))?,
    };
    let pictures = pictures(job, &program);
    let mut places = Places::default();
    for input in job.file.iter().chain(&job.machine) {
        places.input(input);
    }
    for output in job.trace.iter().chain(&job.report).chain(&pictures) {
        places.output(output)?;
    }
    let name = program.name();
    let format = match job.format {
        Some(format) => format,
        None => program.detect()?,
    };
    let bar = progress(program.size());
    let (warnings, chooser) = check(&program, format, parameters, &machine, &bar)?;
    let trace = match &job.trace {
        Some(path) => Some(Pending::create(path)?),
        None => None,
    };
    bar.set_message("turning");
    bar.set_position(0);
    let model = settings.model(&machine).map_err(|error| Failure::Unusable(error.to_string()))?;
    let mut watch = Watch::new(parameters, &machine, chooser, trace, bar)?;
    let mut motors = Motors::new(model);
    let began = Instant::now();
    lathe::run(&program, format, parameters, &machine, &[], &mut (&mut watch, &mut motors))?;
    let wall = began.elapsed();
    watch.bar().finish_and_clear();
    conclude(job, &pictures, &name, watch, &motors, warnings, wall)
}

/// Reads machine file and settings; all errors are told.
fn parameters(job: &Job) -> Result<(Settings, Machine), Failure> {
    Settings::read(job.machine.as_deref(), &job.set).map_err(|refusal| match refusal {
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
) -> Result<(Vec<String>, Chooser), Failure> {
    bar.set_message("checking");
    let mut chooser = Chooser::new(parameters.start());
    let checked = lathe::check(program, format, parameters, machine, &mut |item| chooser.action(item), &mut |bytes| {
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
    if parameters.corner_nm() > 0 {
        warnings.push("corner_um: corners are not blended; the path stays exact".into());
    }
    Ok((warnings, chooser))
}

/// Writes what was asked for, once the figures are in.
fn conclude(
    job: &Job,
    pictures: &[PathBuf],
    name: &str,
    watch: Watch,
    motors: &Motors,
    mut warnings: Vec<String>,
    wall: Duration,
) -> Result<(), Failure> {
    if let Some((count, line)) = watch.stops() {
        warnings.push(format!("line {line}: programmed stop passed by, as there is no operator ({count} in all)"));
    }
    let Watched { report, thinner, insets, trace, blocks } = watch.finish();
    if report.faults.total() > 0 {
        let list: Vec<String> = report.faults.first().iter().map(ToString::to_string).collect();
        return Err(Failure::Fault(format!(
            "{name}: {} broken rules\n   {}",
            report.faults.total(),
            list.join("\n   ")
        )));
    }
    warnings.extend(motors.warnings());
    let run = Run { blocks, wall, lost_pulses: motors.lost_pulses(), motor_load: motors.peaks(), warnings };
    let mut files = Vec::new();
    files.extend(trace);
    if let Some(path) = &job.report {
        let mut file = Pending::create(path)?;
        file.writer().write_all(report::json(&report, &run).as_bytes())?;
        files.push(file);
    }
    if !pictures.is_empty() {
        files.extend(draw(pictures, name, &report, &thinner, insets)?);
    }
    let mut told = report::summary(name, &report, &run);
    for warning in &run.warnings {
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
    match (&job.picture, &job.trace, &job.report) {
        (Some(path), _, _) => vec![path.clone()],
        (None, None, None) => {
            let stem = program.stem();
            vec![Path::new("out").join(format!("{stem}.svg")), Path::new("out").join(format!("{stem}.png"))]
        }
        _ => Vec::new(),
    }
}

fn draw(
    paths: &[PathBuf],
    name: &str,
    report: &Report,
    thinner: &Thinner,
    insets: Vec<Inset>,
) -> Result<Vec<Pending>, Failure> {
    let tracks = thinner.tracks();
    let start = tracks.first().and_then(|track| track.points.first()).copied().unwrap_or_default();
    let end = tracks.last().and_then(|track| track.points.last()).copied().unwrap_or(start);
    let drawing = Drawing {
        title: name.to_owned(),
        subtitle: format!(
            "{}, {} pulses of X, {} of Z; at most {:.3} pulses off the curve; train {:016x}",
            report::clock(report.time_s),
            report.pulses.x,
            report.pulses.z,
            report.walked.pulses,
            report.train_hash
        ),
        tracks,
        start,
        end,
        insets,
    };
    let svg = drawing.svg(WIDTH);
    let mut files = Vec::new();
    for path in paths {
        let mut file = Pending::create(path)?;
        if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png")) {
            let image = picture::png(&svg, WIDTH).map_err(|error| Failure::Unusable(error.to_string()))?;
            file.writer().write_all(&image)?;
        } else {
            file.writer().write_all(svg.as_bytes())?;
        }
        files.push(file);
    }
    Ok(files)
}

/// A bar that shows from the first second on, on terminals.
fn progress(size: u64) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(size), ProgressDrawTarget::stderr_with_hz(10));
    let style = ProgressStyle::with_template("{msg:>9} {bar:30} {percent:>3} %  {elapsed} of {duration}");
    if let Ok(style) = style {
        bar.set_style(style);
    }
    bar
}
