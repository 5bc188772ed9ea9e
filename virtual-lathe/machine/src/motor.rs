//! A hybrid step motor on a current-controlled driver: pull-out torque over speed, pull-in speed.

use crate::read::{self, Refused};
use figures::{FigureError, Figures};
use interp_core::units::Axis;

/// A motor with its driver's current and voltage.
#[derive(Clone, Debug)]
pub struct Motor {
    /// Nm per A of winding current, and V per rad/s.
    constant: f64,
    resistance: f64,
    /// H.
    inductance: f64,
    /// Electrical periods a turn: the rotor's teeth.
    teeth: f64,
    /// Peak current, A.
    current: f64,
    /// Peak voltage of a winding, V.
    voltage: f64,
    detent: f64,
    /// Measured curve, rad/s and Nm; empty for none.
    curve: Vec<(f64, f64)>,
}

impl Motor {
    /// The motor of an axis.
    ///
    /// # Errors
    /// Figures that contradict each other.
    pub(crate) fn new(figures: &Figures, axis: Axis) -> Result<Self, FigureError> {
        let name = |group: &str, what: &str| read::name(group, axis, what);
        let (holding_name, rated_name) = (name("motor", "holding_nm"), name("motor", "rated_a"));
        let (detent_name, steps_name) = (name("motor", "detent_nm"), name("motor", "steps"));
        let (current_name, supply_name) = (name("driver", "current_a"), name("driver", "supply_v"));
        let (holding, rated) = (figures.number(&holding_name)?, figures.number(&rated_name)?);
        let (current, voltage) = (figures.number(&current_name)?, figures.number(&supply_name)?);
        let resistance = figures.number(&name("motor", "resistance_ohm"))?;
        let (detent, steps) = (figures.number(&detent_name)?, figures.whole(&steps_name)?);
        if !steps.is_multiple_of(4) {
            return Err(Refused(format!("{steps_name} is {steps}, but must be a multiple of 4")).into());
        }
        // both windings with the rated current make a current vector of sqrt 2 of it
        let limit = rated * std::f64::consts::SQRT_2;
        if current > limit * 1.001 {
            return Err(Refused(format!(
                "{current_name} of {current} A would overheat the motor: {rated_name} of {rated} A allows a peak of {limit:.3} A"
            ))
            .into());
        }
        if resistance * current > voltage {
            return Err(Refused(format!(
                "{supply_name} of {voltage} V cannot drive {current_name} of {current} A through {} of {resistance} ohm",
                name("motor", "resistance_ohm")
            ))
            .into());
        }
        if detent >= holding {
            return Err(
                Refused(format!("{detent_name} of {detent} Nm must be below {holding_name} of {holding} Nm")).into()
            );
        }
        let curve_name = name("motor", "pull_out");
        let pairs = figures.pairs(&curve_name)?;
        if let Some((rpm, torque)) = pairs.iter().find(|(_, torque)| *torque > holding) {
            return Err(Refused(format!(
                "{curve_name} has {torque} Nm at {rpm} rpm, more than {holding_name} of {holding} Nm"
            ))
            .into());
        }
        Ok(Self {
            constant: holding / limit,
            resistance,
            inductance: figures.number(&name("motor", "inductance_mh"))? * 1e-3,
            teeth: f64::from(steps) / 4.0,
            current,
            voltage,
            detent,
            curve: pairs.iter().map(|(rpm, torque)| (rpm * std::f64::consts::TAU / 60.0, *torque)).collect(),
        })
    }

    /// Torque in Nm above which the motor loses its step at `speed` (rad/s, any sign); 0 where it has none.
    ///
    /// Of the current vectors that the driver can make, it is the one with the most torque: the driver limits the
    /// current, `|I| <= I0`, and the supply the voltage, `|(R + jX) I + E| <= V`, with `X` = teeth x speed x L and
    /// `E` = constant x speed. Both are circles in the plane of currents, and the torque is the constant times the
    /// real part. Where only the voltage limits, this is the well-known `k V / Z - k E R / Z^2` (P. Acarnley,
    /// Stepping Motors, 4th edition, on high-speed operation). The detent torque is taken off.
    #[must_use]
    pub fn pull_out(&self, speed: f64) -> f64 {
        let speed = speed.abs();
        if !self.curve.is_empty() {
            return along(&self.curve, speed);
        }
        let (e, x) = (self.constant * speed, self.teeth * speed * self.inductance);
        let z2 = self.resistance * self.resistance + x * x;
        let volts = (e + self.resistance * self.current).hypot(x * self.current);
        let best = if volts <= self.voltage {
            self.current
        } else {
            // the voltage's circle
            let (re, im, radius) = (-e * self.resistance / z2, e * x / z2, self.voltage / z2.sqrt());
            if (re + radius).hypot(im) <= self.current { re + radius } else { self.corner(re, im, radius) }
        };
        (self.constant * best - self.detent).max(0.0)
    }

    /// The greater real part of the points that are on the current's circle and on that about (`re`, `im`).
    fn corner(&self, re: f64, im: f64, radius: f64) -> f64 {
        let distance = re.hypot(im);
        let along = (self.current * self.current - radius * radius + distance * distance) / (2.0 * distance);
        let across = self.current * self.current - along * along;
        // no common point: the current that the rotor itself drives is more than the driver takes
        if across < 0.0 { 0.0 } else { (along * re + across.sqrt() * im.abs()) / distance }
    }

    /// Speed in rad/s up to which the field catches a rotor that stands, with `inertia` (kg m2) and a load (Nm).
    ///
    /// Seen from the field, the rotor starts from its rest at -speed, and is caught if its energy does not take it
    /// over the next hump of the torque: `J w^2 / 2 <= (T / teeth) (2 cos d - (pi - 2 d) sin d)`, with `sin d` =
    /// load / T (the equal-area rule of synchronous machines).
    #[must_use]
    pub fn pull_in(&self, inertia: f64, load: f64) -> f64 {
        let torque = self.pull_out(0.0);
        let part = load / torque;
        // also where there is no torque at all
        if !(0.0..1.0).contains(&part) {
            return 0.0;
        }
        let rest = part.asin();
        let hump = 2.0 * rest.cos() - (std::f64::consts::PI - 2.0 * rest) * part;
        (2.0 * torque / (self.teeth * inertia) * hump).sqrt()
    }
}

/// A curve of straight pieces: flat before its first row, nothing behind its last.
fn along(curve: &[(f64, f64)], at: f64) -> f64 {
    let mut before: Option<(f64, f64)> = None;
    for &(x, y) in curve {
        if at <= x {
            return before.map_or(y, |(x0, y0)| y0 + (y - y0) * (at - x0) / (x - x0));
        }
        before = Some((x, y));
    }
    0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::{ProptestConfig, prop_assert, proptest};

    fn motor(set: &[(&str, &str)]) -> Motor {
        let mut figures = Figures::new(crate::TABLES);
        for (name, text) in set {
            figures.set(name, text).unwrap();
        }
        Motor::new(&figures, Axis::X).unwrap()
    }

    /// The most torque of all current vectors that a fine grid of angles and sizes finds within both limits.
    fn searched(motor: &Motor, speed: f64) -> f64 {
        let (e, x) = (motor.constant * speed, motor.teeth * speed * motor.inductance);
        let mut best = 0.0_f64;
        for size in 0..=200 {
            for angle in 0..800 {
                let (size, angle) =
                    (motor.current * f64::from(size) / 200.0, f64::from(angle) / 400.0 * std::f64::consts::PI);
                let (re, im) = (size * angle.cos(), size * angle.sin());
                let volts = (motor.resistance * re - x * im + e).hypot(motor.resistance * im + x * re);
                if volts <= motor.voltage {
                    best = best.max(re);
                }
            }
        }
        (motor.constant * best - motor.detent).max(0.0)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]
        #[test]
        fn pull_out_is_the_most_that_current_and_voltage_allow(
            rpm in 0.0_f64..1500.0, ohm in 0.2_f64..3.0, mh in 0.5_f64..20.0, volts in 12.0_f64..80.0,
        ) {
            let texts = [ohm, mh, volts].map(|figure| format!("{figure:.3}"));
            let motor = motor(&[
                ("motor.x.resistance_ohm", &texts[0]),
                ("motor.x.inductance_mh", &texts[1]),
                ("driver.x.supply_v", &texts[2]),
            ]);
            let speed = rpm * std::f64::consts::TAU / 60.0;
            let (found, told) = (searched(&motor, speed), motor.pull_out(speed));
            // the grid misses the true corner by a cell
            prop_assert!(found <= told + 1e-9 && found >= told - 0.03, "{} rpm: {} told, {} found", rpm, told, found);
            prop_assert!((motor.pull_out(-speed) - told).abs() <= 0.0);
        }
    }

    #[test]
    fn slow_motors_have_the_torque_of_their_current_and_fast_ones_that_of_their_voltage() {
        let motor = motor(&[]);
        // 1.9 Nm of sqrt 2 x 2.8 A, at 3.76 A, less the detent torque
        assert!((motor.pull_out(0.0) - (1.9 * 3.76 / (2.8 * 2.0_f64.sqrt()) - 0.068)).abs() < 1e-12);
        // 1000 rpm, by hand: X = 28.274 ohm, Z = 28.297 ohm, k = 0.47982, E = 50.247 V
        let speed = 1000.0 * std::f64::consts::TAU / 60.0;
        assert!((motor.pull_out(speed) - (0.610_43 - 0.034_03 - 0.068)).abs() < 1e-3, "{}", motor.pull_out(speed));
    }

    #[test]
    fn a_measured_curve_is_kept_to() {
        let motor = motor(&[("motor.x.pull_out", "100:1.5;700:0.9")]);
        for (rpm, torque) in [(0.0, 1.5), (100.0, 1.5), (400.0, 1.2), (700.0, 0.9), (701.0, 0.0)] {
            assert!((motor.pull_out(rpm * std::f64::consts::TAU / 60.0) - torque).abs() < 1e-9, "{rpm}");
        }
    }

    /// Whether a rotor that rests under `load` is caught by a field that starts at `speed`: the equation of motion,
    /// step by step, against the energy that [`Motor::pull_in`] argues with.
    fn caught(motor: &Motor, inertia: f64, load: f64, speed: f64) -> bool {
        let torque = motor.pull_out(0.0);
        let (mut lag, mut slip) = ((load / torque).asin(), speed);
        for _ in 0..200_000 {
            slip += (load - torque * lag.sin()) / inertia * 1e-6;
            lag += motor.teeth * slip * 1e-6;
            if slip < 0.0 {
                return true;
            }
            if lag > std::f64::consts::PI {
                return false;
            }
        }
        false
    }

    #[test]
    fn pull_in_is_where_the_equation_of_motion_stops_catching_the_rotor() {
        let motor = motor(&[]);
        for (inertia, load) in [(6.4e-5, 0.0), (6.4e-5, 0.3), (1e-4, 0.8), (5e-4, 1.5)] {
            let speed = motor.pull_in(inertia, load);
            assert!(caught(&motor, inertia, load, speed * 0.99), "{inertia} {load}: {speed}");
            assert!(!caught(&motor, inertia, load, speed * 1.01), "{inertia} {load}: {speed}");
        }
        assert!(motor.pull_in(6.4e-5, 5.0).abs() <= 0.0);
    }
}
