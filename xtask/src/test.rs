//! All checks, in the order of what fails soonest.

use std::process::Command;
use std::time::Instant;

use crate::links;

/// Runs cargo; says what and how long.
fn cargo(what: &str, arguments: &[&str], environment: &[(&str, &str)]) -> Result<(), String> {
    eprintln!("\n== {what}: cargo {}", arguments.join(" "));
    let began = Instant::now();
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo)
        .args(arguments)
        .envs(environment.iter().copied())
        .status()
        .map_err(|error| format!("{what}: cargo did not start: {error}"))?;
    eprintln!("== {what}: {:.1} s", began.elapsed().as_secs_f64());
    if status.success() { Ok(()) } else { Err(format!("{what} failed")) }
}

/// Whether a cargo subcommand is installed.
fn has(subcommand: &str) -> bool {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    Command::new(cargo).args([subcommand, "--version"]).output().is_ok_and(|output| output.status.success())
}

/// Everything that continuous integration runs.
pub(crate) fn test() -> Result<(), String> {
    for tool in ["fmt", "clippy"] {
        if !has(tool) {
            return Err(format!("cargo {tool} is missing; install it with `rustup component add {tool}`"));
        }
    }
    cargo("formatting", &["fmt", "--all", "--check"], &[])?;
    cargo("lints", &["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"], &[])?;
    links::check()?;
    cargo("documentation", &["doc", "--workspace", "--no-deps", "--quiet"], &[("RUSTDOCFLAGS", "-D warnings")])?;
    // optimised, as the property tests interpolate millions of pulses, but with the checks of a debug build
    let checks =
        [("CARGO_PROFILE_RELEASE_DEBUG_ASSERTIONS", "true"), ("CARGO_PROFILE_RELEASE_OVERFLOW_CHECKS", "true")];
    cargo("tests", &["test", "--workspace", "--release", "--target-dir", "target/checked"], &checks)
}

/// The property tests of whole programs, at length.
pub(crate) fn soak(cases: Option<&str>) -> Result<(), String> {
    let cases = cases.unwrap_or("20000");
    if cases.parse::<u32>().is_err() {
        return Err(format!("{cases} is not a number of cases"));
    }
    let environment = [("HANDCNC_CASES", cases), ("PROPTEST_CASES", cases)];
    cargo("soak", &["test", "--release", "-p", "host-tests", "-p", "interp-core", "-p", "measure"], &environment)
}
