//! A spindle: drive with a ramp, motor with constant torque and then constant power, inertia, friction, load.

use std::f64::consts::TAU;

use figures::{FigureError, Figures};

use crate::read::Refused;

/// Seconds of a tick.
const TICK: f64 = 1e-3;

/// An angle: whole turns and the part of a turn behind them, 0 or more and below 1.
#[derive(Copy, Clone, Debug, Default, PartialEq)]
pub struct Angle {
    /// Whole turns, rounded down.
    pub turns: i64,
    /// The rest.
    pub part: f64,
}

impl Angle {
    /// The angle that is `by` turns farther.
    #[must_use]
    pub fn turned(self, by: f64) -> Self {
        let part = self.part + by;
        let whole = part.floor();
        let rest = part - whole;
        // a tiny negative part rounds up to a whole turn
        let (whole, rest) = if rest < 1.0 { (whole, rest) } else { (whole + 1.0, 0.0) };
        Self { turns: self.turns + crate::whole(whole), part: rest }
    }
}

/// A spindle. Positive is forward.
#[derive(Clone, Debug)]
pub struct Spindle {
    inertia: f64,
    torque: f64,
    /// rad/s.
    base: f64,
    most: f64,
    /// rad/s a tick.
    ramp: f64,
    drag: f64,
    load: f64,
    command: f64,
    /// The command behind the ramp.
    reference: f64,
    speed: f64,
    /// During the running tick, rad/s2.
    acceleration: f64,
    /// Torque of the motor during the running tick, Nm.
    motor: f64,
    /// At its beginning.
    angle: Angle,
}

impl Spindle {
    /// A spindle that stands at angle 0.
    ///
    /// # Errors
    /// Figures that contradict each other.
    pub fn new(figures: &Figures) -> Result<Self, FigureError> {
        let speed = |name: &str| Ok::<f64, FigureError>(figures.number(name)? * TAU / 60.0);
        let (torque, drag, load) = (
            figures.number("spindle.torque_nm")?,
            figures.number("spindle.drag_nm")?,
            figures.number("spindle.load_nm")?,
        );
        if drag + load >= torque {
            return Err(Refused(format!(
                "spindle.drag_nm and spindle.load_nm make {} Nm, and spindle.torque_nm is {torque} Nm: it can't turn",
                drag + load
            ))
            .into());
        }
        let (base, most) = (speed("spindle.base_rpm")?, speed("spindle.max_rpm")?);
        if base > most {
            return Err(Refused(format!(
                "spindle.base_rpm of {} must not be above spindle.max_rpm of {}",
                figures.number("spindle.base_rpm")?,
                figures.number("spindle.max_rpm")?
            ))
            .into());
        }
        Ok(Self {
            inertia: figures.number("spindle.inertia_kgm2")?,
            torque,
            base,
            most,
            ramp: speed("spindle.ramp_rpm_s")? * TICK,
            drag,
            load,
            command: 0.0,
            reference: 0.0,
            speed: 0.0,
            acceleration: 0.0,
            motor: 0.0,
            angle: Angle::default(),
        })
    }

    /// Commands a speed in turns a minute, negative for reverse. What is no number changes nothing.
    pub fn command(&mut self, rpm: f64) {
        if rpm.is_finite() {
            self.command = (rpm * TAU / 60.0).clamp(-self.most, self.most);
        }
    }

    /// Sets the torque of the cut in Nm, 0 or more, against every turn.
    pub const fn set_load(&mut self, load: f64) {
        self.load = load;
    }

    /// Torque that the motor has at a speed, Nm.
    fn available(&self, speed: f64) -> f64 {
        if speed.abs() <= self.base { self.torque } else { self.torque * self.base / speed.abs() }
    }

    /// Ends a tick and decides on the next.
    pub fn tick(&mut self) {
        self.angle = self.angle_after(TICK);
        self.speed += self.acceleration * TICK;
        // friction stops a spindle at zero, not near it
        if self.speed.abs() < 1e-12 {
            self.speed = 0.0;
        }
        self.reference += (self.command - self.reference).clamp(-self.ramp, self.ramp);
        let wanted = (self.reference - self.speed) / TICK;
        let towards = if self.speed.abs() > 0.0 { self.speed.signum() } else { self.reference.signum() };
        let resists =
            if self.speed.abs() > 0.0 || self.reference.abs() > 0.0 { towards * (self.drag + self.load) } else { 0.0 };
        let available = self.available(self.speed);
        self.motor = (self.inertia * wanted + resists).clamp(-available, available);
        self.acceleration = (self.motor - resists) / self.inertia;
        let next = self.speed + self.acceleration * TICK;
        // resistance takes speed away, it never turns a spindle the other way
        if next * towards < 0.0 && self.motor * towards >= 0.0 {
            self.acceleration = -self.speed / TICK;
        }
    }

    /// Angle `seconds` into the running tick.
    #[must_use]
    pub fn angle_after(&self, seconds: f64) -> Angle {
        self.angle.turned((self.speed * seconds + self.acceleration * seconds * seconds / 2.0) / TAU)
    }

    /// Speed at the beginning of the running tick, turns a minute.
    #[must_use]
    pub fn rpm(&self) -> f64 {
        self.speed * 60.0 / TAU
    }

    /// Torque of the motor during the running tick, Nm.
    #[must_use]
    pub const fn motor_torque(&self) -> f64 {
        self.motor
    }
}
