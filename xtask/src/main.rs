#![forbid(unsafe_code)]
//! What needs more than cargo: `cargo xtask --help`. `cargo xtask test` runs everything that continuous integration
//! runs.

mod book;
mod cases;
mod compare;
mod desktop;
mod emulate;
mod endless;
mod firmware;
mod gdb;
mod graph;
mod image;
mod links;
mod lints;
mod measure;
mod nopanic;
mod qemu;
mod test;
mod toolchain;
mod trial;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Firmware images, the emulated run, costs, and the checks of the image.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Formatting, lints, all tests, documentation.
    Test,
    /// The property tests at length.
    Soak {
        /// Cases of each.
        #[arg(default_value_t = 20_000)]
        cases: u32,
    },
    /// Builds firmware: ELF, hex and bin, and a report of flash and RAM.
    Firmware {
        /// Which board.
        #[arg(long, default_value = "all")]
        board: firmware::Choice,
    },
    /// Runs programs on the emulated chip and compares every event with the desktop's train.
    Emulate(emulate::Arguments),
    /// Loops for ever in the emulated chip's background, at one point a run: no pulse may change.
    Endless(endless::Arguments),
    /// Counts the instructions that a step costs; prints JSON.
    Measure(measure::Arguments),
    /// Lints the firmware of one board, and checks that a build without a board, or with two, fails.
    Lints,
    /// Checks that no panic can be reached: by linking the portable code, and in the call graph of the images.
    NoPanic {
        /// Boards whose images are checked.
        #[arg(long, value_delimiter = ',', default_value = "qemu,f411")]
        board: Vec<firmware::Board>,
    },
}

fn main() -> ExitCode {
    let done = match Arguments::parse().task {
        Task::Test => test::test().map_err(anyhow::Error::msg),
        Task::Soak { cases } => test::soak(cases).map_err(anyhow::Error::msg),
        Task::Firmware { board } => firmware::run(&board.boards()),
        Task::Emulate(arguments) => emulate::run(&arguments),
        Task::Endless(arguments) => endless::run(&arguments),
        Task::Measure(arguments) => measure::run(&arguments),
        Task::Lints => lints::run(),
        Task::NoPanic { board } => {
            // the graph tells where a panic is that the linker has found
            let (linked, walked) = (nopanic::run(), graph::run(&board));
            walked.and(linked)
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

/// The workspace's folder.
fn root() -> PathBuf {
    let here = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    here.parent().map_or_else(|| here.clone(), PathBuf::from)
}

/// Where built things go.
fn target() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), |dir| root().join(dir))
}
