//! What hands and switches do, and what the control reads of them.

use handcnc::foreground::inputs::{AXES, Ends, Inputs, PerAxis};
use interp_core::units::{Axis, Lattice};

use super::{Runner, TICK_NS};
use crate::operate::event::{Source, Switch, What, Wheel};
use crate::operate::soak::hand::Hand;
use crate::operate::soak::track::part;

impl<H: Hand> Runner<'_, H> {
    /// The readings of a tick.
    pub(super) fn read(&mut self) -> Inputs {
        let now = self.tick * TICK_NS;
        for (wheel, noise) in Wheel::ALL.into_iter().zip(&mut self.noise) {
            if !noise.is_silent() {
                let by = noise.counts();
                if by != 0 {
                    self.wheels.disturb(wheel, by, now);
                }
            }
        }
        if !self.wheels.rest() {
            let wheels = &mut self.wheels;
            self.inputs.wheels = PerAxis { x: wheels.read(Wheel::X, now), z: wheels.read(Wheel::Z, now) };
            self.inputs.contour = wheels.read(Wheel::Contour, now);
        } else if self.inputs.wheels != (PerAxis { x: 0, z: 0 }) || self.inputs.contour != 0 {
            (self.inputs.wheels, self.inputs.contour) = (PerAxis { x: 0, z: 0 }, 0);
        }
        self.inputs.spindle = Some(self.spindle.read());
        if self.placed {
            self.look_at_switches();
        }
        self.inputs
    }

    fn look_at_switches(&mut self) {
        let at = self.oracle.position();
        for axis in AXES {
            let mm = self.mm(at, axis);
            let met = |switch: Switch, plus: bool| match switch {
                Switch::Held(on) => on,
                Switch::At(place) => (mm >= place && plus) || (mm <= place && !plus),
            };
            let [plus, minus] = *self.switches.of(axis);
            *self.inputs.ends.of_mut(axis) = Ends { plus: met(plus, true), minus: met(minus, false) };
        }
    }

    /// The place of an axis in mm.
    pub(super) fn mm(&self, at: Lattice, axis: Axis) -> f64 {
        let pulse = if axis == Axis::X { self.background.machine.x.pulse } else { self.background.machine.z.pulse };
        f64::from(part(at, axis)) * f64::from(pulse.numerator()) / f64::from(pulse.denominator()) * 1e-6
    }

    /// What hands and switches do, power or not. False where it is something else.
    pub(super) fn by_hand(&mut self, what: &What) -> bool {
        match *what {
            What::Turn(wheel, detents, over) => self.wheels.turn(wheel, detents, self.tick * TICK_NS, over),
            What::Joystick(joystick) => self.inputs.joystick = joystick,
            What::Rapid(down) => self.inputs.rapid = down,
            What::Limit(axis, plus, switch) => {
                let [at_plus, at_minus] = self.switches.of_mut(axis);
                *(if plus { at_plus } else { at_minus }) = switch;
                let all = self.switches.x.iter().chain(&self.switches.z);
                self.placed = all.into_iter().any(|switch| matches!(switch, Switch::At(_)));
                self.look_at_switches();
            }
            What::Guard(open) => self.inputs.guard = open,
            What::Noise(Source::Spindle, rate) => self.spindle.disturb(rate),
            What::Noise(Source::Wheel(wheel), rate) => {
                let [x, z, contour] = &mut self.noise;
                match wheel {
                    Wheel::X => x,
                    Wheel::Z => z,
                    Wheel::Contour => contour,
                }
                .set(rate);
            }
            What::LoseIndex(lost) => self.spindle.lose_index(lost),
            What::Wobble(percent, hz) => self.spindle.wobble(percent / 100.0, hz),
            _ => return false,
        }
        true
    }
}
