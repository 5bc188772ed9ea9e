//! A folder to run the built program in, and what a run left.

use std::ffi::OsStr;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;
use tempfile::TempDir;

pub(crate) const GOOD: &str = "G21 G90\nG1 X1 Z-2 F100\nM30\n";
pub(crate) const SAMPLE_1973: &str = "N01 G91\nN02 G01 X+5000 F0\nN03 X+7000 F1\nN04 G02 X+2000 Y0 I0 J2000\n\
                           N05 X0 Y-2000 I2000 J0\nN06 G01 X-7000\nN07 G02 X-2000 Y0 I0 J2000\n\
                           N08 X0 Y+2000 I2000 J0\nN09 G01 X-5000 F0\n";

/// A folder to run in.
pub(crate) struct Bench(pub(crate) TempDir);

/// What a run left.
pub(crate) struct Outcome {
    pub(crate) code: i32,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Bench {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn with(program: impl AsRef<[u8]>) -> Self {
        let bench = Self::new();
        bench.put("p.nc", program);
        bench
    }

    pub(crate) fn put(&self, name: &str, text: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), text).unwrap();
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    pub(crate) fn json(&self, name: &str) -> Value {
        serde_json::from_str(&self.read(name)).unwrap()
    }

    /// All files and folders below, sorted.
    pub(crate) fn files(&self) -> Vec<String> {
        fn below(folder: &Path, base: &Path, found: &mut Vec<String>) {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                found.push(path.strip_prefix(base).unwrap().to_string_lossy().into_owned());
                if path.is_dir() {
                    below(&path, base, found);
                }
            }
        }
        let mut found = Vec::new();
        below(self.0.path(), self.0.path(), &mut found);
        found.sort();
        found
    }

    pub(crate) fn command(&self) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_virtual-lathe"));
        command.current_dir(self.0.path());
        command
    }

    pub(crate) fn run<S: AsRef<OsStr>>(&self, arguments: &[S]) -> Outcome {
        Outcome::of(&self.command().args(arguments).stdin(Stdio::null()).output().unwrap())
    }

    pub(crate) fn turn(&self, arguments: &[&str]) -> Outcome {
        self.run(&[&["turn"], arguments].concat())
    }

    pub(crate) fn pipe(&self, arguments: &[&str], input: &[u8]) -> Outcome {
        let mut command = self.command();
        command.arg("turn").args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        child.stdin.take().unwrap().write_all(input).unwrap();
        Outcome::of(&child.wait_with_output().unwrap())
    }

    /// Runs `p.nc`; its report.
    pub(crate) fn report(&self, arguments: &[&str]) -> Value {
        let outcome = self.turn(&[&["p.nc", "--report", "r.json"], arguments].concat());
        assert_eq!(outcome.code, 0, "{}", outcome.err);
        self.json("r.json")
    }

    /// Runs `p.nc`; lines of its trace: time, X, Z.
    pub(crate) fn trace(&self, arguments: &[&str]) -> Vec<[i64; 3]> {
        let outcome = self.turn(&[&["p.nc", "--trace", "t.csv"], arguments].concat());
        assert_eq!(outcome.code, 0, "{}", outcome.err);
        let text = self.read("t.csv");
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some("time_ns,x,z"));
        lines
            .map(|line| {
                let parts: Vec<i64> = line.split(',').map(|part| part.parse().unwrap()).collect();
                parts.try_into().unwrap()
            })
            .collect()
    }
}

impl Outcome {
    pub(crate) fn of(output: &std::process::Output) -> Self {
        Self {
            code: output.status.code().unwrap_or(-1),
            out: String::from_utf8_lossy(&output.stdout).into_owned(),
            err: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }

    #[track_caller]
    pub(crate) fn says(&self, parts: &[&str]) {
        for part in parts {
            assert!(self.err.contains(part), "{part:?} is not in:\n{}", self.err);
        }
    }
}

/// A program is refused with exit code 1, the message has all `parts`, and nothing is written.
#[track_caller]
pub(crate) fn refused_with(program: impl AsRef<[u8]>, arguments: &[&str], parts: &[&str]) {
    for outputs in [&["--trace", "t.csv", "--report", "r.json", "--picture", "p.svg"][..], &[]] {
        let bench = Bench::with(program.as_ref());
        let outcome = bench.turn(&[&["p.nc"], arguments, outputs].concat());
        assert_eq!(outcome.code, 1, "{}{}", outcome.out, outcome.err);
        outcome.says(parts);
        outcome.says(&["nothing was run"]);
        assert_eq!(bench.files(), ["p.nc"]);
        assert_eq!(outcome.out, "");
    }
}

#[track_caller]
pub(crate) fn refused(program: impl AsRef<[u8]>, parts: &[&str]) {
    refused_with(program, &[], parts);
}

/// Parameters are refused with exit code 1, and nothing is written.
#[track_caller]
pub(crate) fn refused_setting(setting: &str, parts: &[&str]) {
    let bench = Bench::with(GOOD);
    let outcome = bench.turn(&["p.nc", "--report", "r.json", "--set", setting]);
    assert_eq!(outcome.code, 1, "{}{}", outcome.out, outcome.err);
    outcome.says(parts);
    assert_eq!(bench.files(), ["p.nc"]);
}

/// A machine file is refused with exit code 1, and nothing is written.
#[track_caller]
pub(crate) fn refused_machine(text: &str, parts: &[&str]) {
    let bench = Bench::with(GOOD);
    bench.put("m.toml", text);
    let outcome = bench.turn(&["p.nc", "--report", "r.json", "--machine", "m.toml"]);
    assert_eq!(outcome.code, 1, "{}{}", outcome.out, outcome.err);
    outcome.says(parts);
    assert_eq!(bench.files(), ["m.toml", "p.nc"]);
}

/// The call is no good (exit code 2) and leaves the folder as it was.
#[track_caller]
pub(crate) fn unusable(bench: &Bench, arguments: &[&str], parts: &[&str]) {
    let before = bench.files();
    let outcome = bench.turn(arguments);
    assert_eq!(outcome.code, 2, "{}{}", outcome.out, outcome.err);
    outcome.says(parts);
    assert_eq!(bench.files(), before);
}
