//! Every scenario of `tests/scenarios` is as it expects, and breaks no rule of the motors.
#![allow(clippy::unwrap_used, reason = "tests, and helpers of tests, which may panic")]

use std::path::{Path, PathBuf};

use virtual_lathe::operate::{self, Job, Unrun};

fn scenarios() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/scenarios");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut scenarios: Vec<_> = files.filter(|path| path.extension().is_some_and(|ending| ending == "txt")).collect();
    scenarios.sort();
    scenarios
}

/// What is wrong with a run of a scenario.
fn wrong(path: &Path) -> Vec<String> {
    let done = match operate::perform(&Job { scenario: path.into(), ..Job::default() }, None) {
        Ok(done) => done,
        Err(Unrun::Script(errors)) => {
            return errors.iter().map(|error| operate::message(&path.display().to_string(), error)).collect();
        }
        Err(error) => return vec![format!("{}: {error:?}", path.display())],
    };
    let name = path.file_name().unwrap().to_string_lossy();
    let mut wrong: Vec<String> =
        done.failed.iter().map(|failed| format!("{name}:{}: {}", failed.line, failed.cause)).collect();
    wrong.extend(done.broken.first().iter().map(|fault| format!("{name}: {fault}")));
    if done.endless {
        wrong.push(format!("{name}: never comes to rest"));
    }
    wrong
}

#[test]
fn every_scenario_is_as_it_expects() {
    let wrong: Vec<String> = scenarios().iter().flat_map(|path| wrong(path)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_scenario_expects_something() {
    for path in scenarios() {
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains(" expect "), "{} expects nothing", path.display());
    }
}
