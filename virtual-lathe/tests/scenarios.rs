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

/// Names of refusals that no scenario shows: a script can't unlock without pulling out, and no program has a word for a curve
/// that is made part by part.
const NOT_SHOWN: [&str; 2] = ["emergency-open", "way-back-curve"];

#[test]
fn every_refusal_by_name_is_shown_by_a_scenario() {
    let text = include_str!("../../src/foreground/refusal.rs");
    let names = text.split_once("pub const fn name").unwrap().1.split_once("impl fmt::Display").unwrap().0;
    let names: Vec<&str> = names.split('"').skip(1).step_by(2).collect();
    assert!(names.len() > 20, "{names:?}");
    let mut shown = Vec::new();
    for path in scenarios() {
        let done = operate::perform(&Job { scenario: path, ..Job::default() }, None).unwrap();
        let refused = done.state.get("refusals").and_then(serde_json::Value::as_array).cloned().unwrap_or_default();
        shown.extend(refused.iter().filter_map(|name| name.as_str().map(str::to_owned)));
    }
    let missing: Vec<&&str> =
        names.iter().filter(|name| !shown.iter().any(|shown| shown == *name) && !NOT_SHOWN.contains(name)).collect();
    assert!(missing.is_empty(), "{missing:?}");
}
