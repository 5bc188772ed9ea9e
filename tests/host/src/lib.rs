#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests, which may panic")]
//! What the tests of whole cycles share: running a program, and an oracle for the time that it may take.

pub mod optimum;
pub mod programs;

use feature_editor::codes::Item;
use handcnc::background::parameters::Parameters;
use handcnc::foreground::Command;
use indicatif::ProgressBar;
use interp_core::config::Machine;
use measure::Report;
use virtual_lathe::insets::Chooser;
use virtual_lathe::lathe;
use virtual_lathe::program::Program;
use virtual_lathe::watch::Watch;

/// A program that was run, or the messages that it was refused with.
pub struct Run {
    /// What the checker measured.
    pub report: Report,
    /// All actions, in order.
    pub items: Vec<Item>,
    /// The parameters it ran under.
    pub parameters: Parameters,
    /// The machine it ran on.
    pub machine: Machine,
}

/// Default parameters with some set.
///
/// # Panics
/// Where one is refused.
pub fn parameters(set: &[(&str, &str)]) -> Parameters {
    let mut parameters = Parameters::new();
    for (name, value) in set {
        if let Err(error) = parameters.set(name, value) {
            panic!("{name}={value}: {error}");
        }
    }
    parameters
}

/// Checks and runs a program.
///
/// # Errors
/// The messages of a refused program.
pub fn run(text: &str, set: &[(&str, &str)]) -> Result<Run, Vec<String>> {
    run_with(text, set, &[])
}

/// Checks and runs a program, with commands at ticks of its cycle.
///
/// # Errors
/// The messages of a refused program.
pub fn run_with(text: &str, set: &[(&str, &str)], commands: &[(u64, Command)]) -> Result<Run, Vec<String>> {
    let parameters = parameters(set);
    let machine = parameters.machine().map_err(|error| vec![error.to_string()])?;
    let program = Program::Text { name: "test".into(), text: text.as_bytes().to_vec() };
    let format = program.detect().unwrap();
    let mut items = Vec::new();
    let mut chooser = Chooser::new(parameters.start());
    let mut look = |item: &Item| {
        chooser.action(item);
        items.push(*item);
    };
    let checked = lathe::check(&program, format, &parameters, &machine, &mut look, &mut |_| {}).unwrap();
    if checked.errors > 0 {
        let message = |finding: &handcnc::background::compile::Finding| format!("{}: {finding}", finding.line());
        return Err(checked.findings.iter().map(|(finding, _)| message(finding)).collect());
    }
    let mut watch = Watch::new(&parameters, &machine, chooser, None, ProgressBar::hidden()).unwrap();
    lathe::run(&program, format, &parameters, &machine, commands, &mut watch).unwrap();
    Ok(Run { report: watch.finish().report, items, parameters, machine })
}

/// The train of a program: the events of each tick of its cycle.
///
/// # Panics
/// Where the program or a parameter is refused.
pub fn train(text: &str, set: &[(&str, &str)], commands: &[(u64, Command)]) -> Vec<Vec<u32>> {
    struct Recorder(Vec<Vec<u32>>);
    impl lathe::Observer for Recorder {
        fn compiled(&mut self, _: &Item, _: usize) {}
        fn tick(&mut self, events: &[u32], _: &interp_core::channel::Report) -> std::io::Result<()> {
            self.0.push(events.to_vec());
            Ok(())
        }
        fn commanded(&mut self, _: Command) {}
        fn stopped(&mut self, _: u32) {}
        fn progress(&mut self, _: u64) {}
    }
    let parameters = parameters(set);
    let machine = parameters.machine().unwrap();
    let program = Program::Text { name: "test".into(), text: text.as_bytes().to_vec() };
    let format = program.detect().unwrap();
    let mut recorder = Recorder(Vec::new());
    lathe::run(&program, format, &parameters, &machine, commands, &mut recorder).unwrap();
    recorder.0
}
