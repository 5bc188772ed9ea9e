//! The machine as a whole: plays the train, tells where the slides are.

use figures::{FigureError, Figures};
use interp_core::train::{Event, Levels};
use interp_core::units::Axis;

use crate::drive::{Drive, Loss};
use crate::encoder::{Channels, Encoder};
use crate::scale::Scale;
use crate::spindle::{Angle, Spindle};

/// Clocks of a tick.
const TICK: u64 = 12_000;

/// One value for each axis.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Axes<T> {
    /// Of the cross slide.
    pub x: T,
    /// Of the carriage.
    pub z: T,
}

/// What the control believes of the machine.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Control {
    /// How far it takes a pulse to move an axis, nm (X as a radius).
    pub pulse_nm: Axes<f64>,
    /// Where it begins, pulses from the machine zero.
    pub start: Axes<i32>,
}

/// Where the slides really are, nm from the machine zero, X as a radius.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Place {
    /// Time in clocks of 12 MHz since the beginning: of the end of the event that was played.
    pub clocks: u64,
    /// Cross slide.
    pub x_nm: f64,
    /// Carriage.
    pub z_nm: f64,
}

/// The machine.
#[derive(Clone, Debug)]
pub struct Machine {
    x: Drive,
    z: Drive,
    scales: Axes<Option<Scale>>,
    spindle: Spindle,
    encoder: Encoder,
    levels: Levels,
    clocks: u64,
    tick_ends: u64,
}

impl Machine {
    /// The machine that the figures describe, at rest.
    ///
    /// # Errors
    /// [`FigureError::Contradiction`] where figures don't go together, or not with what the control believes.
    pub fn new(figures: &Figures, control: Control) -> Result<Self, FigureError> {
        let Control { pulse_nm, start } = control;
        Ok(Self {
            x: Drive::new(figures, Axis::X, pulse_nm.x, start.x)?,
            z: Drive::new(figures, Axis::Z, pulse_nm.z, start.z)?,
            scales: Axes { x: Scale::new(figures, Axis::X)?, z: Scale::new(figures, Axis::Z)? },
            spindle: Spindle::new(figures)?,
            encoder: Encoder::new(figures)?,
            levels: Levels::LOW,
            clocks: 0,
            tick_ends: TICK,
        })
    }

    /// Plays an event of lathe 0: its levels, then its interval. Where the slides are then.
    pub fn play(&mut self, event: Event) -> Place {
        let levels = event.levels();
        if levels != self.levels {
            self.levels = levels;
            #[expect(clippy::cast_precision_loss, reason = "clocks of a run, far below 2^53")]
            let (clocks, now) = (self.clocks.cast_signed(), self.clocks as f64);
            self.x.write(clocks, now, levels.step(Axis::X), levels.plus(Axis::X));
            self.z.write(clocks, now, levels.step(Axis::Z), levels.plus(Axis::Z));
        }
        self.clocks += u64::from(event.interval());
        while self.clocks >= self.tick_ends {
            self.tick();
        }
        Place { clocks: self.clocks, x_nm: self.x.at(), z_nm: self.z.at() }
    }

    fn tick(&mut self) {
        #[expect(clippy::cast_precision_loss, reason = "clocks of a run, far below 2^53")]
        let now = self.tick_ends as f64;
        self.x.tick(self.tick_ends, now);
        self.z.tick(self.tick_ends, now);
        self.spindle.tick();
        self.tick_ends += TICK;
    }

    /// An axis.
    #[must_use]
    pub const fn axis(&self, axis: Axis) -> &Drive {
        match axis {
            Axis::X => &self.x,
            Axis::Z => &self.z,
        }
    }

    /// An axis, to load it.
    pub const fn axis_mut(&mut self, axis: Axis) -> &mut Drive {
        match axis {
            Axis::X => &mut self.x,
            Axis::Z => &mut self.z,
        }
    }

    /// Pulses that each axis did not make, or made the wrong way ([`Drive::lost_pulses`]).
    #[must_use]
    pub fn lost_pulses(&self) -> Axes<u64> {
        Axes { x: self.x.lost_pulses(), z: self.z.lost_pulses() }
    }

    /// How each axis came to lose its first pulse.
    #[must_use]
    pub const fn first_loss(&self) -> Axes<Option<Loss>> {
        Axes { x: self.x.first_loss(), z: self.z.first_loss() }
    }

    /// The spindle.
    #[must_use]
    pub const fn spindle(&self) -> &Spindle {
        &self.spindle
    }

    /// The spindle, to command and load it.
    pub const fn spindle_mut(&mut self) -> &mut Spindle {
        &mut self.spindle
    }

    /// Angle of the spindle now.
    #[must_use]
    pub fn spindle_angle(&self) -> Angle {
        let begun = self.tick_ends - TICK;
        let into = u32::try_from(self.clocks - begun).unwrap_or(0);
        self.spindle.angle_after(f64::from(into) / 12e6)
    }

    /// Counts of the spindle's encoder now.
    #[must_use]
    pub fn encoder_counts(&self) -> i64 {
        self.encoder.counts(self.spindle_angle())
    }

    /// Levels of the spindle's encoder now.
    #[must_use]
    pub fn encoder_channels(&self) -> Channels {
        self.encoder.channels(self.spindle_angle())
    }

    /// What the scale of an axis shows now, nm; `None` where none is fitted.
    #[must_use]
    pub fn scale_nm(&self, axis: Axis) -> Option<f64> {
        let scale = match axis {
            Axis::X => &self.scales.x,
            Axis::Z => &self.scales.z,
        };
        scale.as_ref().map(|scale| scale.reading(self.axis(axis).at()))
    }
}
