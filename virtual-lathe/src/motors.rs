//! The machine behind the pins while a program runs, and where its motors lost pulses.

use std::io;

use interp_core::channel;
use interp_core::train::Event;
use interp_core::units::Axis;
use machine::{Axes, Loss, Machine, Place};

use crate::lathe::Observer;

/// The machine of a run.
#[derive(Debug)]
pub struct Motors {
    machine: Machine,
    x: Losses,
    z: Losses,
}

/// When an axis lost its first pulse.
#[derive(Copy, Clone, Debug, Default)]
struct Losses {
    stalled: bool,
    /// Program line in work when the motor last lost the field.
    line: u32,
    first: Option<(u32, Loss)>,
}

impl Losses {
    /// Looks at an axis after a tick in which `line` was in work.
    fn look(&mut self, machine: &Machine, axis: Axis, line: u32) {
        let drive = machine.axis(axis);
        let stalled = drive.load().stalled;
        // the line where it lost the field: what that comes to may show on a later one
        if !self.stalled {
            self.line = line;
        }
        if self.first.is_none() {
            self.first = drive.first_loss().map(|loss| (self.line, loss));
        }
        self.stalled = stalled;
    }
}

impl Motors {
    /// The machine, before the first tick.
    #[must_use]
    pub fn new(machine: Machine) -> Self {
        Self { machine, x: Losses::default(), z: Losses::default() }
    }

    /// Plays a tick in which `line` was in work; `moved` is told where the slides are at the end of each event.
    pub fn play(&mut self, events: &[u32], line: u32, moved: &mut impl FnMut(Place)) {
        for &word in events {
            moved(self.machine.play(Event::from_word(word)));
        }
        self.x.look(&self.machine, Axis::X, line);
        self.z.look(&self.machine, Axis::Z, line);
    }

    /// The machine.
    #[must_use]
    pub const fn machine(&self) -> &Machine {
        &self.machine
    }

    /// Pulses that the motors did not make.
    #[must_use]
    pub fn lost_pulses(&self) -> Axes<u64> {
        self.machine.lost_pulses()
    }

    /// Greatest part of its pull-out torque that each motor was asked for.
    #[must_use]
    pub fn peaks(&self) -> Axes<f64> {
        let peak = |axis| self.machine.axis(axis).peak();
        Axes { x: peak(Axis::X), z: peak(Axis::Z) }
    }

    /// What to tell of lost pulses: time, line, axis, cause and remedy.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let lost = self.lost_pulses();
        [("x", self.x, lost.x), ("z", self.z, lost.z)]
            .into_iter()
            .filter_map(|(axis, losses, lost)| losses.first.map(|(line, loss)| warning(axis, line, loss, lost)))
            .collect()
    }
}

impl Observer for Motors {
    fn tick(&mut self, events: &[u32], report: &channel::Report) -> io::Result<()> {
        self.play(events, report.line, &mut |_| {});
        Ok(())
    }
}

fn warning(axis: &str, line: u32, loss: Loss, lost: u64) -> String {
    let letter = axis.to_uppercase();
    #[expect(clippy::cast_precision_loss, reason = "clocks of a run, far below 2^53")]
    let seconds = loss.clocks as f64 / 12e6;
    if loss.load.stalled {
        format!(
            "line {line}: the motor of {letter} stalls at {seconds:.3} s: {:.0} rpm take {:.3} Nm, and it has {:.3} Nm; \
             {lost} pulses lost in all, the part is off by them. Lower {axis}.max_feed or {axis}.max_accel, or look at \
             motor.{axis}, driver.{axis} and slide.{axis}",
            loss.load.speed.abs() * 60.0 / std::f64::consts::TAU,
            loss.load.asked.abs(),
            loss.load.available
        )
    } else {
        format!(
            "line {line}: the driver of {letter} misreads its pins from {seconds:.3} s on: {lost} pulses off in all. \
             Raise {axis}.pulse_width_ns, {axis}.min_space_ns, {axis}.dir_setup_ns and {axis}.dir_hold_ns to what \
             driver.{axis} needs"
        )
    }
}
