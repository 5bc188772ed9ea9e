//! The command `soak`: random operators at random machines, and rules that nothing they do may break.
//!
//! A session is a random machine, random programs and what an `operator` does with them, all from a seed; the `runner` is
//! that of a scenario without a model of motors; the `oracle` looks at every tick. What fails is made short
//! (`shrink`(mod@shrink)) and written as a scenario.

mod chance;
mod clicks;
mod coverage;
mod hand;
mod machines;
mod operator;
mod oracle;
mod programs;
mod runner;
mod session;
mod shoulders;
mod shrink;
mod soft_limit;
mod spindle;
mod swing;
mod track;

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use interp_core::config::TICKS_PER_SECOND;

use chance::Chance;
use coverage::Coverage;
use hand::Script;
use operator::Operator;
use oracle::Failure;
use runner::{Outcome, Runner};
use session::{Line, Session, Unread};
use shrink::Found;

use super::{FAILED, WRONG, message};

/// Ticks of an hour.
const HOUR: u64 = 3_600 * TICKS_PER_SECOND as u64;

/// Every so many sessions one is run again from its notes: the train has to be the same.
const AGAIN: u64 = 16;

/// In every so many sessions the operator likes to work at shoulders.
const AT_SHOULDERS: u64 = 3;

/// Runs that shortening a failure may take, and ticks.
const BUDGET_RUNS: u32 = 2_000;
const BUDGET_TICKS: u64 = 60_000_000;

/// What `soak` is asked to do.
#[derive(Args, Clone, Debug, Default)]
pub struct Job {
    /// Simulated hours.
    #[arg(long, default_value_t = 1.0)]
    pub hours: f64,
    /// Where chance begins: the same seed gives the same sessions.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Run only the session of this seed, as a failure tells it.
    #[arg(long, value_name = "SEED", conflicts_with_all = ["hours", "seed"])]
    pub session: Option<u64>,
    /// Run this scenario under the same rules, instead.
    #[arg(long, value_name = "FILE")]
    pub replay: Option<PathBuf>,
    /// Where failures are written.
    #[arg(long, value_name = "FOLDER", default_value = "out/soak")]
    pub folder: PathBuf,
    /// Go on until so many failures were found.
    #[arg(long, default_value_t = 1)]
    pub failures: u64,
}

/// What was found in so many ticks.
#[derive(Debug, Default)]
pub struct Soaked {
    /// Simulated ticks.
    pub ticks: u64,
    /// Time that the sessions took, without what shortening a failure took.
    pub seconds: f64,
    /// What was broken, and the scenarios that show it.
    pub broken: Vec<(String, PathBuf)>,
    /// The table of what was exercised.
    pub table: String,
    /// Hash over the trains of all sessions.
    pub hash: u64,
}

/// Runs a job and tells; the exit code.
pub fn soak(job: &Job) -> u8 {
    if let Some(path) = &job.replay {
        return replay(path);
    }
    let soaked = run(job, true);
    eprint!("{}", soaked.table);
    println!("soak: seed {}: {}; train {:016x}", job.seed, rate(soaked.ticks, soaked.seconds), soaked.hash);
    for (text, path) in &soaked.broken {
        println!("broken: {text}\n   wrote {}", path.display());
    }
    if soaked.broken.is_empty() { 0 } else { FAILED }
}

#[expect(clippy::cast_precision_loss, reason = "ticks of some hours")]
fn hours(ticks: u64) -> f64 {
    ticks as f64 / HOUR as f64
}

fn rate(ticks: u64, seconds: f64) -> String {
    let hours = hours(ticks);
    format!("{hours:.2} simulated hours, {:.1} hours a minute", hours * 60.0 / seconds.max(1e-3))
}

/// Runs sessions for so many simulated hours.
pub fn run(job: &Job, tell: bool) -> Soaked {
    let (mut coverage, mut soaked) = (Coverage::default(), Soaked::default());
    // a single session is over after the first
    let hours = if job.session.is_some() { f64::MIN_POSITIVE } else { job.hours.max(0.0) };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hours")]
    let wanted = (hours * HOUR as f64).ceil() as u64;
    let bar = if tell { ProgressBar::new(wanted) } else { ProgressBar::hidden() };
    let style =
        ProgressStyle::with_template("{bar:30} {percent}% {elapsed} {msg}").unwrap_or(ProgressStyle::default_bar());
    bar.set_style(style);
    let mut number = 0;
    while soaked.ticks < wanted {
        let seed = job.session.unwrap_or(job.seed.wrapping_mul(1_000_003).wrapping_add(number));
        let begun = Instant::now();
        let (session, outcome) = one(seed);
        coverage.add(&outcome.coverage);
        soaked.ticks += outcome.coverage.ticks;
        soaked.hash = soaked.hash.rotate_left(1) ^ outcome.hash;
        let mut failure = outcome.failure.clone();
        if failure.is_none() && number.is_multiple_of(AGAIN) {
            failure = differs(&session, outcome.hash);
            soaked.ticks += outcome.coverage.ticks;
        }
        soaked.seconds += begun.elapsed().as_secs_f64();
        if let Some(failure) = failure {
            bar.suspend(|| eprintln!("seed {seed}: {}", told(&failure)));
            soaked.broken.push(write(job, seed, Found { session, failure }, tell));
            if soaked.broken.len() as u64 >= job.failures.max(1) {
                break;
            }
        }
        number += 1;
        bar.set_position(soaked.ticks.min(wanted));
        bar.set_message(format!("seed {}: {}", job.seed, rate(soaked.ticks, soaked.seconds)));
    }
    bar.finish_and_clear();
    soaked.table = coverage.table();
    soaked
}

fn told(failure: &Failure) -> String {
    operator::title(failure.tick, &failure.rule, &failure.text)
}

/// A session of a seed, run.
fn one(seed: u64) -> (Session, Outcome) {
    let mut chance = Chance::new(seed, 1);
    let mut session = Session { set: machines::machine(&mut chance), ..Session::default() };
    for number in 0..chance.whole(1, 3) {
        let reach = chance.spread(1.0, 30.0);
        let taste = programs::Taste { reach, spindle: chance.once_in(3), stops: chance.coin() };
        session.programs.push((format!("{number}.nc"), programs::program(&mut chance, taste)));
    }
    session.programs.push((operator::LAST.into(), operator::LAST_TEXT.into()));
    let ticks = chance.whole(20_000, 200_000).unsigned_abs();
    let shoulders = seed.is_multiple_of(AT_SHOULDERS);
    let operator = Operator::new(Chance::new(seed, 2), ticks, &session.programs, shoulders);
    let outcome = match Runner::new(&session, operator) {
        Ok(runner) => runner.run(),
        // figures that contradict each other: another machine
        Err(_) => {
            session.set.clear();
            let operator = Operator::new(Chance::new(seed, 2), ticks, &session.programs, shoulders);
            match Runner::new(&session, operator) {
                Ok(runner) => runner.run(),
                Err(text) => return (session, unfit(text)),
            }
        }
    };
    // the last 'spindle-wobble 0 0' begins what ends a session
    let order = outcome.done.iter().filter(|(_, text)| text == "joystick off").map(|(tick, _)| *tick).next_back();
    let lines = outcome.done.iter();
    session.lines = lines
        .map(|(tick, text)| Line { tick: *tick, text: text.clone(), fixed: *tick >= ticks && Some(*tick) >= order })
        .collect();
    (session, outcome)
}

fn unfit(text: String) -> Outcome {
    let failure = Some(Failure { tick: 0, rule: "parameters".into(), text });
    Outcome { failure, hash: 0, coverage: Coverage::default(), done: Vec::new() }
}

/// Runs what was done once more.
fn again(session: &Session) -> Outcome {
    match Runner::new(session, Script::new(&session.lines)) {
        Ok(runner) => runner.run(),
        Err(text) => unfit(text),
    }
}

/// The same session gives the same train.
fn differs(session: &Session, hash: u64) -> Option<Failure> {
    let outcome = again(session);
    if outcome.hash == hash && outcome.failure.is_none() {
        return None;
    }
    let text = format!("the train was {hash:016x}, and {:016x} the second time", outcome.hash);
    Some(outcome.failure.unwrap_or(Failure { tick: 0, rule: "repeatable".into(), text }))
}

/// Shortens what fails, and writes it as a scenario.
fn write(job: &Job, seed: u64, found: Found, tell: bool) -> (String, PathBuf) {
    let bar = if tell { ProgressBar::new_spinner() } else { ProgressBar::hidden() };
    let (mut runs, mut ticks) = (0_u32, 0_u64);
    let mut run = |session: &Session| {
        if runs >= BUDGET_RUNS || ticks >= BUDGET_TICKS {
            return None;
        }
        let outcome = again(session);
        runs += 1;
        ticks += outcome.coverage.ticks;
        bar.set_message(format!("shortening: {runs} runs, {} events left", session.lines.len()));
        bar.tick();
        Some(outcome.failure)
    };
    let repeated = run(&found.session).flatten().is_some_and(|failure| failure.rule == found.failure.rule);
    let found = if repeated { shrink::shrink(found, &mut run) } else { found };
    bar.finish_and_clear();
    let text = told(&found.failure);
    let mut comments = vec![format!("Found by soak, session {seed}: {}", found.failure.rule), text.clone()];
    if !repeated {
        comments.push("It could not be repeated from the notes: chance has a part in it.".into());
    }
    comments.push("Run it under the same rules with: soak --replay FILE".into());
    let name = format!("seed-{seed}");
    match found.session.write(&job.folder, &name, &comments) {
        Ok(path) => (text, path),
        Err(error) => (format!("{text} (not written: {error})"), job.folder.join(name)),
    }
}

/// Runs a scenario under the oracles; the exit code.
fn replay(path: &Path) -> u8 {
    let session = match Session::read(path) {
        Ok(session) => session,
        Err(Unread::File(text)) => {
            eprintln!("error: {text}");
            return WRONG;
        }
        Err(Unread::Script(errors)) => {
            let name = path.display().to_string();
            errors.iter().for_each(|error| eprint!("{}", message(&name, error)));
            return WRONG;
        }
    };
    let outcome = again(&session);
    match outcome.failure {
        Some(failure) => {
            println!("broken: {}", told(&failure));
            FAILED
        }
        None => {
            println!("nothing is broken; train {:016x}", outcome.hash);
            0
        }
    }
}
