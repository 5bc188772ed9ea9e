//! Where the slides are and where the program is, tick by tick: what a screw costs, and what compensation saves.

use std::io;

use feature_editor::codes::Format;
use interp_core::channel::Report;
use interp_core::train::{Event, Levels};
use interp_core::units::Axis;
use machine::Machine;
use measure::Added;

use crate::lathe::{self, Observer};
use crate::program::Program;
use crate::settings::Settings;

/// A moment: `[z, x]` in mm.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Place {
    /// Of the program.
    pub program: [f64; 2],
    /// Of the slides.
    pub slides: [f64; 2],
}

/// Follows the slides of a machine.
struct Slides {
    machine: Machine,
    levels: Levels,
    /// Pulses of the program, Z and X.
    program: [i32; 2],
    /// mm.
    pulse: [f64; 2],
    places: Vec<Place>,
}

impl Observer for Slides {
    fn superposed(&mut self, added: &[Added]) {
        for step in added {
            self.program[0] += step.program.z - step.motor.z;
            self.program[1] += step.program.x - step.motor.x;
        }
    }

    fn tick(&mut self, events: &[u32], _: &Report) -> io::Result<()> {
        let mut slides = [0.0; 2];
        for word in events {
            let event = Event::from_word(*word);
            let levels = event.levels();
            for (pulses, axis) in self.program.iter_mut().zip([Axis::Z, Axis::X]) {
                if levels.step(axis) && !self.levels.step(axis) {
                    *pulses += if levels.plus(axis) { 1 } else { -1 };
                }
            }
            self.levels = levels;
            let place = self.machine.play(event);
            slides = [place.z_nm * 1e-6, place.x_nm * 1e-6];
        }
        let program = [f64::from(self.program[0]) * self.pulse[0], f64::from(self.program[1]) * self.pulse[1]];
        self.places.push(Place { program, slides });
        Ok(())
    }
}

/// Runs a program of G-code under settings that are whole; where program and slides were at the end of each tick.
///
/// # Errors
/// Settings that contradict each other, a program with errors.
pub fn follow(text: &str, settings: &Settings) -> io::Result<Vec<Place>> {
    let machine = settings.parameters.machine().map_err(|error| io::Error::other(error.to_string()))?;
    let model = settings.model(&machine).map_err(|error| io::Error::other(error.to_string()))?;
    let program = Program::Text { name: "slides".into(), text: text.into() };
    let parameters = &settings.parameters;
    let checked = lathe::check(&program, Format::Gcode, parameters, &machine, &mut |_| {}, &mut |_| {})?;
    if let Some((finding, _)) = checked.findings.first().filter(|_| checked.errors > 0) {
        return Err(io::Error::other(format!("line {}: {finding}", finding.line())));
    }
    let start = parameters.start();
    let mm =
        |pulse: interp_core::units::PulseSize| f64::from(pulse.numerator()) / f64::from(pulse.denominator()) * 1e-6;
    let mut slides = Slides {
        machine: model,
        levels: Levels::LOW,
        program: [machine.z.pulse.nearest(start.z), machine.x.pulse.nearest(start.x)],
        pulse: [mm(machine.z.pulse), mm(machine.x.pulse)],
        places: Vec::new(),
    };
    let fit = lathe::Fit { tables: &settings.pitch, figures: &settings.figures };
    lathe::run_fitted(&program, Format::Gcode, parameters, &machine, fit, &[], &mut slides)?;
    Ok(slides.places)
}
