//! A program for the emulated run, with the parameters and the commands that belong to it.
//!
//! A line of the program that begins with `;:` is a comment to every reader but this one: its words are those of the
//! qemu image's command line, `NAME=VALUE` for a parameter and `TICK:WHAT` for what an operator does right before that tick of
//! the cycle (see `handcnc::foreground::rehearsal`).

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result, bail};
use handcnc::background::parameters::Parameters;
use handcnc::foreground::rehearsal::{APPOINTMENTS, Rehearsal};
use interp_core::config::Machine;

use crate::desktop::Program;

const WORDS: &[u8] = b";:";

/// What a run needs on both sides.
pub(crate) struct Trial {
    pub(crate) program: Program,
    pub(crate) parameters: Parameters,
    pub(crate) machine: Machine,
    pub(crate) rehearsal: Rehearsal,
    /// The image's command line.
    pub(crate) words: Vec<String>,
}

impl Trial {
    /// Reads a program and its words; `more` words count after them.
    pub(crate) fn new(text: &[u8], more: &[String]) -> Result<Self> {
        let mut words = Vec::new();
        for line in text.split(|byte| *byte == b'\n').filter_map(|line| line.strip_prefix(WORDS)) {
            words.extend(String::from_utf8_lossy(line).split_whitespace().map(str::to_owned));
        }
        words.extend_from_slice(more);
        let (mut parameters, mut rehearsal) = (Parameters::new(), Rehearsal::new());
        for word in &words {
            obey(word, &mut parameters, &mut rehearsal).with_context(|| format!("`{word}`"))?;
        }
        let machine = parameters.machine().map_err(|error| anyhow::anyhow!("{error}"))?;
        let program = Program::read(text, &parameters, &machine)?;
        Ok(Self { program, parameters, machine, rehearsal, words })
    }

    /// Reads a program's file.
    pub(crate) fn read(path: &Path, more: &[String]) -> Result<Self> {
        let text = fs::read(path).with_context(|| format!("reading {}", path.display()))?;
        Self::new(&text, more)
    }
}

/// Obeys one word, as the image does.
fn obey(word: &str, parameters: &mut Parameters, rehearsal: &mut Rehearsal) -> Result<()> {
    if word.contains(' ') {
        bail!("a word has no blanks");
    }
    if word.contains(':') {
        if !rehearsal.set_word(word) {
            bail!("TICK:WHAT is wanted, as docs/src/firmware.md lists it, and at most {APPOINTMENTS} of them");
        }
        return Ok(());
    }
    let (name, value) = word.split_once('=').context("NAME=VALUE or TICK:COMMAND is wanted")?;
    parameters.set(name, value).map_err(|error| anyhow::anyhow!("{error}"))
}
