//! The machine's side of a scenario: motors, slides, spindle, wheels, switches; what the control reads of them.

use figures::FigureError;
use handcnc::foreground::inputs::{AXES, Ends, Inputs, Joystick, PerAxis};
use interp_core::block::Output;
use interp_core::config::TICK_CLOCKS;
use interp_core::train::{Event, Levels};
use interp_core::units::Axis;
use machine::{Axes, Machine};

use super::event::{Source, Switch, Wheel};
use super::noise::Noise;
use super::spindle::Spindle;
use super::wheels::Wheels;
use crate::settings::Settings;

/// Nanoseconds of a tick.
const TICK_NS: u64 = 1_000_000;

/// The machine, and what hands do to it.
pub(super) struct Bench {
    machine: Machine,
    pub(super) spindle: Spindle,
    wheels: Wheels,
    /// Of the wheels in their order, and of the spindle.
    noise: [Noise; 4],
    pub(super) joystick: Joystick,
    pub(super) rapid: bool,
    pub(super) guard: bool,
    /// The emergency stop is pressed.
    pub(super) pressed: bool,
    /// Of each axis at plus and at minus.
    switches: PerAxis<[Switch; 2]>,
    /// The tick made last, which is played in the next one.
    ahead: Vec<u32>,
    /// Of the pins, after what was played.
    levels: Levels,
    spindle_percent: u16,
}

impl Bench {
    /// A machine at rest.
    pub(super) fn new(settings: &Settings, machine: Machine) -> Result<Self, FigureError> {
        let figures = &settings.figures;
        let seed = u64::from(figures.whole("bounce.seed")?);
        let free = [Switch::Held(false); 2];
        Ok(Self {
            machine,
            spindle: Spindle::new(figures)?,
            wheels: Wheels::new(figures)?,
            noise: [1, 2, 3, 4].map(|salt| Noise::new(seed << 8 | salt)),
            joystick: Joystick::Off,
            rapid: false,
            guard: false,
            pressed: false,
            switches: PerAxis { x: free, z: free },
            ahead: vec![TICK_CLOCKS],
            levels: Levels::LOW,
            spindle_percent: 100,
        })
    }

    /// The machine.
    pub(super) const fn machine(&self) -> &Machine {
        &self.machine
    }

    /// Turns a wheel from now on.
    pub(super) fn turn(&mut self, tick: u64, wheel: Wheel, detents: i32, over_ns: u64) {
        self.wheels.turn(wheel, detents, tick * TICK_NS, over_ns);
    }

    /// Sets the rate of a source of noise.
    pub(super) fn disturb(&mut self, source: Source, rate: f64) {
        let [x, z, contour, spindle] = &mut self.noise;
        match source {
            Source::Wheel(Wheel::X) => x,
            Source::Wheel(Wheel::Z) => z,
            Source::Wheel(Wheel::Contour) => contour,
            Source::Spindle => spindle,
        }
        .set(rate);
    }

    /// Sets a limit switch.
    pub(super) fn limit(&mut self, axis: Axis, plus: bool, switch: Switch) {
        let [at_plus, at_minus] = self.switches.of_mut(axis);
        *(if plus { at_plus } else { at_minus }) = switch;
    }

    /// Whether nobody turns a wheel.
    pub(super) fn wheels_rest(&self) -> bool {
        self.wheels.rest()
    }

    /// What the control reads at the start of a tick.
    pub(super) fn read(&mut self, tick: u64) -> Inputs {
        let now = tick * TICK_NS;
        for (wheel, noise) in Wheel::ALL.into_iter().zip(&mut self.noise) {
            let by = noise.counts();
            if by != 0 {
                self.wheels.disturb(wheel, by, now);
            }
        }
        let wheels = &mut self.wheels;
        Inputs {
            wheels: PerAxis { x: wheels.read(Wheel::X, now), z: wheels.read(Wheel::Z, now) },
            contour: wheels.read(Wheel::Contour, now),
            spindle: Some(self.spindle.read(&self.machine)),
            ..self.at_once()
        }
    }

    /// What it would read now of what does not count.
    pub(super) fn at_once(&self) -> Inputs {
        let mut inputs = Inputs { joystick: self.joystick, rapid: self.rapid, guard: self.guard, ..Inputs::NONE };
        for axis in AXES {
            *inputs.ends.of_mut(axis) = self.ends(axis);
            *inputs.scales.of_mut(axis) = self.scale(axis);
        }
        inputs
    }

    fn ends(&self, axis: Axis) -> Ends {
        let at = self.machine.axis(axis).at() * 1e-6;
        let met = |switch: Switch, plus: bool| match switch {
            Switch::Held(on) => on,
            Switch::At(place) => (at >= place && plus) || (at <= place && !plus),
        };
        let [plus, minus] = *self.switches.of(axis);
        Ends { plus: met(plus, true), minus: met(minus, false) }
    }

    /// What the scale of an axis shows, nm.
    pub(super) fn scale(&self, axis: Axis) -> Option<i32> {
        let nm = self.machine.scale_nm(axis)?;
        #[expect(clippy::cast_possible_truncation, reason = "saturates")]
        Some(nm.round() as i32)
    }

    /// Plays the tick that was made before; the one made now is played next. Gives the events played.
    pub(super) fn play(&mut self, made: Vec<u32>) -> Vec<u32> {
        let played = std::mem::replace(&mut self.ahead, made);
        for &word in &played {
            let event = Event::from_word(word);
            self.levels = event.levels();
            self.machine.play(event);
        }
        self.spindle.tick(&self.machine, &mut self.noise[3]);
        self.spindle.command(&mut self.machine, self.spindle_percent);
        played
    }

    /// The train stops at once: what was made and not played is not played.
    pub(super) fn cut(&mut self) {
        self.ahead = vec![idle(self.levels)];
    }

    /// A tick without a control: its pins are low.
    pub(super) fn dark(&mut self) -> Vec<u32> {
        self.play(vec![TICK_CLOCKS])
    }

    /// Follows the spindle's outputs.
    pub(super) fn follow(&mut self, output: Option<Output>, off: bool) {
        if let Some(output) = output {
            self.spindle.output(output);
        }
        if off {
            self.spindle.off();
        }
    }

    /// Spindle override.
    pub(super) fn spindle_percent(&mut self, percent: u16) {
        self.spindle_percent = percent;
    }

    /// Where the slides really are, nm.
    pub(super) fn slides(&self) -> Axes<f64> {
        Axes { x: self.machine.axis(Axis::X).at(), z: self.machine.axis(Axis::Z).at() }
    }
}

/// A tick in which no pin steps.
fn idle(levels: Levels) -> u32 {
    let low = AXES.into_iter().fold(levels, |levels, axis| levels.with_step(axis, false));
    Event::new(low, TICK_CLOCKS).word()
}
