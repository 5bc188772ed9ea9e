//! All checks, in the order of what fails soonest.

use std::process::Command;
use std::time::Instant;

use crate::links;

/// Programs whose pulses on the emulated chip are compared with the desktop's.
const EMULATED: [&str; 3] = ["emulate", "demo", "tests/on-target/programs"];

/// A share of the endless loops in the background.
const ENDLESS: [&str; 3] = ["endless", "--points", "10"];

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
    let checks = [
        ("CARGO_PROFILE_RELEASE_DEBUG_ASSERTIONS", "true"),
        ("CARGO_PROFILE_RELEASE_OVERFLOW_CHECKS", "true"),
        // a panic tells its place without
        ("CARGO_PROFILE_RELEASE_DEBUG", "false"),
    ];
    cargo("tests", &["test", "--workspace", "--release", "--target-dir", "target/checked"], &checks)?;
    let tool = std::env::current_exe().map_err(|error| error.to_string())?;
    for arguments in [&["lints"][..], &["firmware"], &["no-panic"], &EMULATED, &ENDLESS] {
        eprintln!("\n== cargo xtask {}", arguments.join(" "));
        let status = Command::new(&tool).args(arguments).current_dir(crate::root()).status();
        if !status.map_err(|error| error.to_string())?.success() {
            return Err(format!("cargo xtask {} failed", arguments.join(" ")));
        }
    }
    Ok(())
}

/// Cases of each property in a round of a long run.
const ROUND: u32 = 1000;

/// The property tests at length, each round with other random cases: what is done is told after each.
pub(crate) fn soak(cases: u32) -> Result<(), String> {
    let arguments = ["test", "--quiet", "--release", "-p", "host-tests", "-p", "interp-core", "-p", "measure"];
    let rounds = cases.div_ceil(ROUND).max(1);
    let share = cases.div_ceil(rounds);
    let began = Instant::now();
    for round in 1..=rounds {
        let number = &*share.to_string();
        let environment = [("HANDCNC_CASES", number), ("PROPTEST_CASES", number)];
        cargo(&format!("soak, round {round} of {rounds}"), &arguments, &environment)?;
        let gone = began.elapsed().as_secs_f64();
        let left = gone / f64::from(round) * f64::from(rounds - round);
        eprintln!("== {} cases of each property in {gone:.0} s, about {left:.0} s to go", share * round);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    /// Priorities by task: of the table above the app, and of the attributes.
    fn plans() -> (BTreeMap<String, u8>, BTreeMap<String, u8>) {
        let source = std::fs::read_to_string(crate::root().join("src/main.rs")).unwrap();
        let (mut table, mut attributes) = (BTreeMap::new(), BTreeMap::new());
        let mut attribute: Option<u8> = None;
        for line in source.lines().map(str::trim) {
            if let Some(row) = line.strip_prefix("/// |") {
                let cells: Vec<&str> = row.split('|').map(str::trim).collect();
                if let Ok(priority) = cells[0].parse() {
                    table.insert(cells[1].trim_matches('`').to_owned(), priority);
                }
            } else if line.starts_with("#[task(") {
                let rest = line.split_once("priority = ").expect("every task has a priority").1;
                let digits: String = rest.chars().take_while(char::is_ascii_digit).collect();
                attribute = Some(digits.parse().unwrap());
            } else if line == "#[idle]" {
                attribute = Some(0);
            } else if let Some(rest) = line.strip_prefix("async fn ").or_else(|| line.strip_prefix("fn "))
                && let Some(priority) = attribute.take()
            {
                attributes.insert(rest.split('(').next().unwrap().to_owned(), priority);
            }
        }
        (table, attributes)
    }

    #[test]
    fn the_table_above_the_app_has_every_task_with_its_priority() {
        let (table, attributes) = plans();
        assert_eq!(table, attributes);
        assert_eq!(table.len(), 6);
        assert!(table["emergency"] > table["pulse"] && table["pulse"] > table["interpolate"]);
    }
}
