#![forbid(unsafe_code)]
//! What the project needs beyond cargo. `cargo xtask test` runs everything that continuous integration runs.

mod links;
mod test;

use std::process::ExitCode;

fn main() -> ExitCode {
    let task = std::env::args().nth(1);
    let done = match task.as_deref() {
        Some("test") => test::test(),
        Some("soak") => test::soak(std::env::args().nth(2).as_deref()),
        _ => {
            eprintln!("cargo xtask test          formatting, lints, all tests, documentation");
            eprintln!("cargo xtask soak [CASES]  the property tests at length (default 20000 cases each)");
            return ExitCode::from(2);
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("xtask: {message}");
            ExitCode::FAILURE
        }
    }
}
