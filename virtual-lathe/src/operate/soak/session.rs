//! A session: a machine, programs, and what an operator does; as a scenario file, and back.

use std::fmt::Write as _;
use std::io;
use std::path::Path;

use crate::operate::event::What;
use crate::operate::script::{self, ScriptError};

/// Something that an operator does.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Line {
    /// Ticks from the start.
    pub(super) tick: u64,
    /// What, in the words of a script.
    pub(super) text: String,
    /// It belongs to what ends a session, which is not left out when a session is shortened.
    pub(super) fixed: bool,
}

/// A session.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Session {
    /// Parameters at second 0.
    pub(super) set: Vec<(String, String)>,
    /// Names and texts.
    pub(super) programs: Vec<(String, String)>,
    /// In the order of time.
    pub(super) lines: Vec<Line>,
}

/// Seconds of a tick's start.
pub(super) fn seconds(tick: u64) -> String {
    format!("{}.{:03}", tick / 1000, tick % 1000)
}

impl Session {
    /// The text of a program.
    pub(super) fn program(&self, name: &str) -> Option<&str> {
        self.programs.iter().find(|(known, _)| known == name).map(|(_, text)| text.as_str())
    }

    /// As a scenario, behind comments that say what it shows. `prefix` stands before the programs' names.
    pub(super) fn script(&self, comments: &[String], prefix: &str) -> String {
        let mut text = String::new();
        for comment in comments {
            let _ = writeln!(text, "# {comment}");
        }
        for (name, value) in &self.set {
            let _ = writeln!(text, "0.000 set {name} {value}");
        }
        for line in &self.lines {
            let told = match line.text.strip_prefix("load ") {
                Some(name) => format!("load {prefix}{name}"),
                None => line.text.clone(),
            };
            let _ = writeln!(text, "{} {told}", seconds(line.tick));
        }
        text
    }

    /// Writes it to a folder, with its programs beside it.
    pub(super) fn write(&self, folder: &Path, name: &str, comments: &[String]) -> io::Result<std::path::PathBuf> {
        std::fs::create_dir_all(folder)?;
        let prefix = format!("{name}-");
        for (program, text) in &self.programs {
            if self.lines.iter().any(|line| line.text.strip_prefix("load ") == Some(program)) {
                std::fs::write(folder.join(format!("{prefix}{program}")), text)?;
            }
        }
        let path = folder.join(format!("{name}.txt"));
        std::fs::write(&path, self.script(comments, &prefix))?;
        Ok(path)
    }

    /// Reads a scenario with the programs that it loads.
    pub(super) fn read(path: &Path) -> Result<Self, Unread> {
        let told = |path: &Path, error: &dyn std::fmt::Display| Unread::File(format!("{}: {error}", path.display()));
        let text = std::fs::read_to_string(path).map_err(|error| told(path, &error))?;
        let mut session = Self::default();
        for event in script::parse(&text).map_err(Unread::Script)?.events {
            let words = event.text.split_once(char::is_whitespace).map_or("", |(_, words)| words.trim()).to_owned();
            match &event.what {
                What::Set(name, value) if event.tick == 0 => session.set.push((name.clone(), value.clone())),
                What::Load(file) => {
                    let place = path.parent().unwrap_or(Path::new("")).join(file);
                    let text = std::fs::read_to_string(&place).map_err(|error| told(&place, &error))?;
                    let name = file.display().to_string();
                    if session.program(&name).is_none() {
                        session.programs.push((name.clone(), text));
                    }
                    session.lines.push(Line { tick: event.tick, text: format!("load {name}"), fixed: false });
                }
                _ => session.lines.push(Line { tick: event.tick, text: words, fixed: false }),
            }
        }
        Ok(session)
    }
}

/// Why a scenario can't be replayed.
#[derive(Debug)]
pub(super) enum Unread {
    /// A file can't be read.
    File(String),
    /// All that is wrong with the script.
    Script(Vec<ScriptError>),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_session_comes_back_from_its_scenario() {
        let line = |tick, text: &str| Line { tick, text: text.into(), fixed: false };
        let session = Session {
            set: vec![("x.max_feed".into(), "2000".into())],
            programs: vec![("a.nc".into(), "G0 X1 Z1\nM30\n".into())],
            lines: vec![line(0, "load a.nc"), line(17, "mode auto"), line(1_234, "wheel x -3 over 0.5")],
        };
        let folder = tempfile::tempdir().unwrap();
        let path = session.write(folder.path(), "seed-1", &["why".into()]).unwrap();
        let read = Session::read(&path).unwrap();
        assert_eq!(read.set, session.set);
        assert_eq!(read.program("seed-1-a.nc"), session.program("a.nc"));
        assert_eq!(read.lines[1..], session.lines[1..]);
    }
}
