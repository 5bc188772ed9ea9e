//! Options that several commands share, and how their values are read.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use feature_editor::codes::Format;

/// Which machine a command works on.
#[derive(Args, Clone, Debug, Default)]
pub struct Setup {
    /// Machine parameters, in TOML.
    #[arg(long, value_name = "FILE.toml")]
    pub machine: Option<PathBuf>,
    /// One parameter; beats the machine file. `parameters` lists them.
    #[arg(long, value_name = "NAME=VALUE", value_parser = name_and_value)]
    pub set: Vec<(String, String)>,
}

/// Which machine and which control's tables a command runs programs on, and how those are written.
#[derive(Args, Clone, Debug, Default)]
pub struct Programs {
    /// How programs are written.
    #[arg(long = "format", value_enum, default_value_t = FormatName::Auto, value_name = "FORMAT")]
    pub written: FormatName,
    /// The machine.
    #[command(flatten)]
    pub setup: Setup,
    /// Tables of pitch errors for the control, a line a point: axis, position in mm, error in um.
    #[arg(long, value_name = "FILE.txt")]
    pub pitch_table: Option<PathBuf>,
}

impl Programs {
    /// The format of a program; told from its text without one.
    #[must_use]
    pub const fn format(&self) -> Option<Format> {
        match self.written {
            FormatName::Auto => None,
            FormatName::Gcode => Some(Format::Gcode),
            FormatName::Nc1973 => Some(Format::Nc1973),
        }
    }

    /// Files that are read.
    pub fn inputs(&self) -> impl Iterator<Item = &PathBuf> {
        self.setup.machine.iter().chain(&self.pitch_table)
    }
}

/// How a program is written.
#[derive(Copy, Clone, Debug, Default, ValueEnum)]
pub enum FormatName {
    /// Told from the text.
    #[default]
    Auto,
    /// Word address (ISO 6983).
    Gcode,
    /// The sample of 1973: pulses of 0.01 mm, arcs by quadrants.
    Nc1973,
}

/// A name and its value, as `NAME=VALUE`.
///
/// # Errors
/// How to write it.
pub fn name_and_value(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => Ok((name.trim().into(), value.trim().into())),
        _ => Err("write it as NAME=VALUE".into()),
    }
}

/// The file of a picture, whose form its ending says.
///
/// # Errors
/// Which endings there are.
pub fn picture_file(text: &str) -> Result<PathBuf, String> {
    ending_in(text, ["svg", "png"])
}

/// The file of an animation, whose form its ending says.
///
/// # Errors
/// Which endings there are.
pub fn animation_file(text: &str) -> Result<PathBuf, String> {
    ending_in(text, ["gif", "png"])
}

fn ending_in(text: &str, endings: [&str; 2]) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
    if endings.iter().any(|known| ending.as_deref() == Some(known.as_ref())) {
        return Ok(path);
    }
    let [a, b] = endings;
    Err(format!("the name must end in .{a} or .{b}"))
}
