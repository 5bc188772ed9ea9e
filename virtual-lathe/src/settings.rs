//! Parameters as typed: the firmware's and, behind them, the figures of the desktop's models.

use std::path::Path;

use figures::{FigureError, Figures};
use handcnc::background::parameters::{ParameterError, Parameters};
use interp_core::config::Machine;
use interp_core::units::{Axis, PulseSize};
use machine::{Axes, Control, table};

use crate::machine_file;
use crate::pitch_table::{self, Tables};

/// The tables of the desktop's models, in the order of the list.
pub const TABLES: &[&[figures::Definition]] = &[&table::CROSS_SLIDE, &table::CARRIAGE, &table::OTHERS, &stock::FIGURES];

/// Everything that `--set` and a machine file set.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The firmware's parameters.
    pub parameters: Parameters,
    /// Figures of the desktop's models.
    pub figures: Figures,
    /// Tables of pitch errors that the control is given.
    pub pitch: Tables,
}

/// Why settings were refused.
#[derive(Clone, Debug)]
pub enum Refusal {
    /// The machine file can't be read.
    Unreadable(String),
    /// Everything that is wrong, each as a line of its own.
    Wrong(Vec<String>),
}

impl Default for Settings {
    fn default() -> Self {
        Self { parameters: Parameters::new(), figures: Figures::new(TABLES), pitch: Tables::default() }
    }
}

impl Settings {
    /// Reads a machine file, if there is one, then parameters by name, which beat it.
    ///
    /// # Errors
    /// [`Refusal`], with all that is wrong and not only the first of it.
    pub fn read(file: Option<&Path>, set: &[(String, String)]) -> Result<(Self, Machine), Refusal> {
        Self::default().read_over(file, set)
    }

    /// The same over these settings, in the place of the defaults.
    ///
    /// # Errors
    /// [`Refusal`], with all that is wrong and not only the first of it.
    pub fn read_over(mut self, file: Option<&Path>, set: &[(String, String)]) -> Result<(Self, Machine), Refusal> {
        let settings = &mut self;
        let mut errors = Vec::new();
        if let Some(path) = file {
            let unreadable =
                |error: &dyn std::fmt::Display| Refusal::Unreadable(format!("{}: {error}", path.display()));
            let bytes = std::fs::read(path).map_err(|error| unreadable(&error))?;
            let text = String::from_utf8(bytes).map_err(|error| unreadable(&error))?;
            errors = machine_file::read(&path.display().to_string(), &text, settings);
        }
        for (name, value) in set {
            if let Err(error) = settings.set(name, value) {
                errors.push(format!("error: --set {name}={value}: {error}"));
            }
        }
        if errors.is_empty() && settings.parameters.feed_override() == 0 {
            errors.push("error: feed_override = 0: the program would never end".into());
        }
        match settings.parameters.machine() {
            Ok(machine) if errors.is_empty() => match settings.model(&machine) {
                Ok(_) => return Ok((self, machine)),
                Err(error) => errors.push(format!("error: {error}")),
            },
            Ok(_) => {}
            Err(error) => errors.push(format!("error: {error}")),
        }
        Err(Refusal::Wrong(errors))
    }

    /// The same with a file of pitch error tables, which are in force unless a parameter says otherwise.
    ///
    /// # Errors
    /// [`Refusal`], with all that is wrong and not only the first of it.
    pub fn read_fitted(
        file: Option<&Path>,
        set: &[(String, String)],
        pitch: Option<&Path>,
    ) -> Result<(Self, Machine), Refusal> {
        Self::default().read_fitted_over(file, set, pitch)
    }

    /// The same over these settings, in the place of the defaults.
    ///
    /// # Errors
    /// [`Refusal`], with all that is wrong and not only the first of it; a table in force that nobody gave is wrong.
    pub fn read_fitted_over(
        self,
        file: Option<&Path>,
        set: &[(String, String)],
        pitch: Option<&Path>,
    ) -> Result<(Self, Machine), Refusal> {
        let (settings, machine) = self.read_with_tables(file, set, pitch)?;
        let missing = |axis: Axis, table: bool| {
            let on = settings.parameters.compensation(axis).pitch;
            (on && !table).then(|| {
                let name = axis.letter();
                format!("error: {name}.pitch_table = true, but there is no table for {name}: give one with --pitch-table FILE")
            })
        };
        let tables = [(Axis::X, settings.pitch.x.is_some()), (Axis::Z, settings.pitch.z.is_some())];
        let errors: Vec<String> = tables.into_iter().filter_map(|(axis, table)| missing(axis, table)).collect();
        if errors.is_empty() { Ok((settings, machine)) } else { Err(Refusal::Wrong(errors)) }
    }

    fn read_with_tables(
        self,
        file: Option<&Path>,
        set: &[(String, String)],
        pitch: Option<&Path>,
    ) -> Result<(Self, Machine), Refusal> {
        let Some(path) = pitch else { return self.read_over(file, set) };
        let name = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|error| Refusal::Unreadable(format!("{name}: {error}")))?;
        let tables = pitch_table::read(&name, &text).map_err(Refusal::Wrong)?;
        let on = |axis: &str, table: bool| table.then(|| (format!("{axis}.pitch_table"), "true".to_owned()));
        let own = on("x", tables.x.is_some()).into_iter().chain(on("z", tables.z.is_some()));
        let set: Vec<(String, String)> = own.chain(set.iter().cloned()).collect();
        let (mut settings, machine) = self.read_over(file, &set)?;
        settings.pitch = tables;
        Ok((settings, machine))
    }

    /// Sets a parameter from text.
    ///
    /// # Errors
    /// What to tell about it; everything keeps its value.
    pub fn set(&mut self, name: &str, text: &str) -> Result<(), String> {
        match self.parameters.set(name, text) {
            Err(ParameterError::Unknown) => {}
            result => return result.map_err(|error| error.to_string()),
        }
        self.figures.set(name, text).map_err(|error| match error {
            // the name stands before the message already
            FigureError::Unknown(_) => ParameterError::Unknown.to_string(),
            error => error.to_string(),
        })
    }

    /// The machine that the figures describe, standing where the program starts.
    ///
    /// # Errors
    /// Figures that contradict each other, or the size of the pulses.
    pub fn model(&self, machine: &Machine) -> Result<machine::Machine, FigureError> {
        let nm = |pulse: PulseSize| f64::from(pulse.numerator()) / f64::from(pulse.denominator());
        let start = self.parameters.start();
        let control = Control {
            pulse_nm: Axes { x: nm(machine.x.pulse), z: nm(machine.z.pulse) },
            start: Axes { x: machine.x.pulse.nearest(start.x), z: machine.z.pulse.nearest(start.z) },
        };
        machine::Machine::new(&self.figures, control)
    }
}
