//! One axis from its pins to its slide: driver, motor, screw, slide.
//!
//! Pulses are counted at every event; whether the motor follows is told every tick. A motor that is asked for more
//! than its pull-out torque loses the field: its rotor runs down against friction, and is caught again when the field
//! is no faster than its pull-in speed, at the nearest of the places that look alike to it, four full steps apart.

use std::f64::consts::TAU;

use figures::{FigureError, Figures};
use interp_core::units::Axis;

use crate::driver::Driver;
use crate::motor::Motor;
use crate::rate::Meter;
use crate::read::{self, Refused};
use crate::screw::Screw;
use crate::slide::Slide;

/// Seconds of a tick.
const TICK: f64 = 1e-3;

/// What was asked of a motor in the last tick.
#[derive(Copy, Clone, Debug, Default, PartialEq)]
pub struct Load {
    /// Commanded speed of the motor, rad/s.
    pub speed: f64,
    /// Torque asked for, with its sign, Nm.
    pub asked: f64,
    /// Pull-out torque at this speed, Nm.
    pub available: f64,
    /// The motor has lost the field.
    pub stalled: bool,
}

/// How a motor came to lose pulses.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Loss {
    /// Time at the end of the tick in which it lost the field, in clocks.
    pub clocks: u64,
    /// What was asked of it then; all zero where the pins were at fault and not the motor.
    pub load: Load,
}

#[derive(Copy, Clone, Debug)]
enum Rotor {
    /// Where the driver's field is.
    Follows,
    /// Runs down from `at` (pulses) with `speed` (rad/s); `since` says how it began.
    Stalled { at: f64, speed: f64, since: Loss },
}

/// One axis.
#[derive(Clone, Debug)]
pub struct Drive {
    driver: Driver,
    motor: Motor,
    screw: Screw,
    slide: Slide,
    meter: Meter,
    /// nm.
    pulse: f64,
    /// rad.
    angle: f64,
    /// Pulses of four full steps.
    period: f64,
    sent: i64,
    taken: i64,
    rotor: Rotor,
    /// Periods by which the rotor is behind the driver.
    behind: f64,
    /// Pulses lost by stalls that are over.
    lost: f64,
    /// Pulses that the driver got wrong.
    mistaken: u64,
    first: Option<Loss>,
    load: Load,
    /// Greatest part of the pull-out torque that was asked for.
    peak: f64,
    at: f64,
}

impl Drive {
    /// The axis whose control takes a pulse for `pulse` nm and stands at `start` pulses.
    pub(crate) fn new(figures: &Figures, axis: Axis, pulse: f64, start: i32) -> Result<Self, FigureError> {
        let (motor, screw) = (Motor::new(figures, axis)?, Screw::new(figures, axis)?);
        let steps = f64::from(figures.whole(&read::name("motor", axis, "steps"))?);
        let microsteps_name = read::name("driver", axis, "microsteps");
        let (typed, fits) = (figures.number(&microsteps_name)?, screw.lead_nm() / (steps * pulse));
        if typed > 0.0 && (typed / fits - 1.0).abs() > 1e-9 {
            return Err(Refused(format!(
                "{microsteps_name} of {typed} makes a pulse of {} nm out of {} of {} mm, but the control counts {pulse} nm; \
                 {fits} would fit",
                screw.lead_nm() / (steps * typed),
                read::name("screw", axis, "lead_mm"),
                screw.lead_nm() / 1e6
            ))
            .into());
        }
        let (steady, available) = (screw.steady_torque(), motor.pull_out(0.0));
        if steady >= available {
            return Err(Refused(format!(
                "{}, {} and {} ask for {steady:.3} Nm, and the motor has {available:.3} Nm: it can't move the slide",
                read::name("screw", axis, "drag_nm"),
                read::name("slide", axis, "friction_n"),
                read::name("slide", axis, "force_n")
            ))
            .into());
        }
        let play = figures.number(&read::name("slide", axis, "backlash_um"))? * 1e3;
        let at = screw.nut(f64::from(start) * pulse);
        Ok(Self {
            driver: Driver::new(figures, axis)?,
            motor,
            slide: Slide::new(play, at),
            meter: Meter::new(),
            pulse,
            angle: TAU * pulse / screw.lead_nm(),
            screw,
            period: 4.0 * fits,
            sent: i64::from(start),
            taken: i64::from(start),
            rotor: Rotor::Follows,
            behind: 0.0,
            lost: 0.0,
            mistaken: 0,
            first: None,
            load: Load::default(),
            peak: 0.0,
            at,
        })
    }

    /// Writes the pins at a time in clocks.
    #[inline]
    pub(crate) fn write(&mut self, clocks: i64, now: f64, step: bool, plus: bool) {
        let done = self.driver.write(clocks, step, plus);
        if done.sent == 0 && done.taken == 0 {
            return;
        }
        self.sent += done.sent;
        self.taken += done.taken;
        if done.taken != done.sent {
            self.mistake(done.taken - done.sent, clocks);
        }
        if done.sent == 0 {
            self.meter.correct(real(done.taken));
        } else if done.taken != 0 {
            self.meter.pulse(now, real(done.taken));
        }
        if matches!(self.rotor, Rotor::Follows) {
            self.follow();
        }
    }

    fn mistake(&mut self, by: i64, clocks: i64) {
        self.mistaken += by.unsigned_abs();
        let clocks = u64::try_from(clocks).unwrap_or(0);
        self.first.get_or_insert(Loss { clocks, load: Load::default() });
    }

    /// The slide goes where the rotor is.
    fn follow(&mut self) {
        let turned = match self.rotor {
            Rotor::Follows => real(self.taken) - self.behind * self.period,
            Rotor::Stalled { at, .. } => at,
        };
        self.at = self.slide.push(self.screw.nut(turned * self.pulse));
    }

    /// Ends a tick.
    pub(crate) fn tick(&mut self, clocks: u64, now: f64) {
        let (rate, change) = self.meter.tick(now);
        let (speed, acceleration) = (rate * self.angle, change * self.angle);
        let asked = self.screw.torque(speed, acceleration);
        let available = self.motor.pull_out(speed);
        let moves = rate.abs() > 0.0;
        self.load = Load { speed, asked, available, stalled: false };
        if moves || asked.abs() > 0.0 {
            self.peak = self.peak.max(asked.abs() / available.max(1e-9));
        }
        match self.rotor {
            Rotor::Follows if asked.abs() > available => {
                self.load.stalled = true;
                let at = real(self.taken) - self.behind * self.period;
                self.rotor = Rotor::Stalled { at, speed, since: Loss { clocks, load: self.load } };
            }
            Rotor::Follows => {}
            Rotor::Stalled { at, speed, since } => self.run_down(at, speed, since),
        }
    }

    /// A tick of a rotor that has lost the field.
    fn run_down(&mut self, at: f64, turning: f64, since: Loss) {
        let inertia = self.screw.total_inertia();
        let brake = self.screw.steady_torque() / inertia;
        let ends = turning.signum() * (turning.abs() - brake * TICK).max(0.0);
        let taken = if brake > 0.0 { TICK.min(turning.abs() / brake) } else { TICK };
        let at = at + (turning + ends) / 2.0 * taken / self.angle;
        let periods = ((real(self.taken) - at) / self.period).round();
        if (periods - self.behind).abs() >= 1.0 {
            self.first.get_or_insert(since);
        }
        let pull_in = self.motor.pull_in(inertia, self.screw.steady_torque());
        let field = self.load.speed;
        let still = field.abs() <= 0.0 && ends.abs() <= 0.0;
        let slow = field.abs() <= pull_in && (field - ends).abs() <= pull_in;
        if still || (slow && self.load.asked.abs() <= self.load.available) {
            self.lost += (periods - self.behind).abs() * self.period;
            self.behind = periods;
            self.rotor = Rotor::Follows;
        } else {
            self.load.stalled = true;
            self.rotor = Rotor::Stalled { at, speed: ends, since };
        }
        self.follow();
    }

    /// Where the slide is, nm from the machine zero.
    #[inline]
    #[must_use]
    pub const fn at(&self) -> f64 {
        self.at
    }

    /// Pulses that the motor did not make, and those that the driver got wrong. A stall that lasts counts as far as
    /// it has got. Losses in opposite directions add up.
    #[must_use]
    pub fn lost_pulses(&self) -> u64 {
        let open = match self.rotor {
            Rotor::Follows => 0.0,
            Rotor::Stalled { at, .. } => {
                (((real(self.taken) - at) / self.period).round() - self.behind).abs() * self.period
            }
        };
        self.mistaken.saturating_add(u64::try_from(crate::whole((self.lost + open).round())).unwrap_or(0))
    }

    /// How the axis came to lose its first pulse.
    #[must_use]
    pub const fn first_loss(&self) -> Option<Loss> {
        self.first
    }

    /// What was asked of the motor in the last tick.
    #[must_use]
    pub const fn load(&self) -> Load {
        self.load
    }

    /// Greatest part of the pull-out torque that was asked for so far; above 1 where the motor stalled.
    #[must_use]
    pub const fn peak(&self) -> f64 {
        self.peak
    }

    /// The motor.
    #[must_use]
    pub const fn motor(&self) -> &Motor {
        &self.motor
    }

    /// The screw.
    #[must_use]
    pub const fn screw(&self) -> &Screw {
        &self.screw
    }

    /// Sets the cutting force in N, 0 or more, that stands against every motion.
    pub const fn set_force(&mut self, force: f64) {
        self.screw.set_force(force);
    }
}

/// A count of pulses as a number; counts are far below 2^53.
#[expect(clippy::cast_precision_loss, reason = "pulses of a machine, far below 2^53")]
const fn real(count: i64) -> f64 {
    count as f64
}
