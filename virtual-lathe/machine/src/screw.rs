//! A screw: what turns into travel, with its pitch error, and what it costs in torque.

use std::f64::consts::{PI, TAU};

use figures::{FigureError, Figures};
use interp_core::units::Axis;

use crate::read::{self, Refused};

/// Density of steel, kg/m3.
const STEEL: f64 = 7850.0;

/// Screw and slide of one axis.
#[derive(Clone, Debug)]
pub struct Screw {
    /// nm a turn.
    lead: f64,
    /// Of screw and rotor, kg m2.
    inertia: f64,
    efficiency: f64,
    drag: f64,
    mass: f64,
    friction: f64,
    force: f64,
    /// Amplitude, nm.
    periodic: f64,
    /// Position and error, nm.
    table: Vec<(f64, f64)>,
}

impl Screw {
    pub(crate) fn new(figures: &Figures, axis: Axis) -> Result<Self, FigureError> {
        let number = |group: &str, what: &str| figures.number(&read::name(group, axis, what));
        let (lead_name, periodic_name) =
            (read::name("screw", axis, "lead_mm"), read::name("screw", axis, "periodic_um"));
        let error_name = read::name("screw", axis, "error");
        let (lead, periodic) = (figures.number(&lead_name)? * 1e6, figures.number(&periodic_name)? * 1e3);
        if periodic * TAU >= lead / 2.0 {
            return Err(Refused(format!(
                "{periodic_name} of {} um is too much for {lead_name} of {} mm: the screw would run back within a turn",
                periodic / 1e3,
                lead / 1e6
            ))
            .into());
        }
        let table: Vec<(f64, f64)> = figures.pairs(&error_name)?.iter().map(|(mm, um)| (mm * 1e6, um * 1e3)).collect();
        for pair in table.windows(2) {
            if let [(x0, y0), (x1, y1)] = pair
                && (y1 - y0).abs() >= (x1 - x0) / 2.0
            {
                return Err(Refused(format!(
                    "{error_name} changes by {} um between {} and {} mm: no screw does",
                    (y1 - y0) / 1e3,
                    x0 / 1e6,
                    x1 / 1e6
                ))
                .into());
            }
        }
        let (diameter, length) = (number("screw", "diameter_mm")? * 1e-3, number("screw", "length_mm")? * 1e-3);
        let rotor = number("motor", "inertia_gcm2")? * 1e-7;
        Ok(Self {
            lead,
            inertia: rotor + STEEL * PI / 32.0 * diameter.powi(4) * length,
            efficiency: number("screw", "efficiency")?,
            drag: number("screw", "drag_nm")?,
            mass: number("slide", "mass_kg")?,
            friction: number("slide", "friction_n")?,
            force: number("slide", "force_n")?,
            periodic,
            table,
        })
    }

    /// Travel in nm a turn.
    #[must_use]
    pub const fn lead_nm(&self) -> f64 {
        self.lead
    }

    /// Travel in m a radian.
    fn transmission(&self) -> f64 {
        self.lead * 1e-9 / TAU
    }

    /// Inertia at the motor in kg m2: rotor, screw, and the slide through the lead.
    #[must_use]
    pub fn total_inertia(&self) -> f64 {
        self.inertia + self.mass * self.transmission().powi(2)
    }

    /// Torque in Nm that it takes to keep moving.
    #[must_use]
    pub fn steady_torque(&self) -> f64 {
        self.torque(1.0, 0.0)
    }

    /// Torque in Nm that the motor must make at a speed (rad/s) and an acceleration (rad/s2), with its sign.
    ///
    /// `T = J a + T_drag + F lead / (2 pi eta)`, with the force `F` at the nut from mass, friction and cut. Where the
    /// slide drives the screw, the efficiency is `2 - 1 / eta`, and a screw below one half holds by itself.
    #[must_use]
    pub fn torque(&self, speed: f64, acceleration: f64) -> f64 {
        let towards = if speed < 0.0 || (speed <= 0.0 && acceleration < 0.0) { -1.0 } else { 1.0 };
        if speed.abs() <= 0.0 && acceleration.abs() <= 0.0 {
            return 0.0;
        }
        let transmission = self.transmission();
        let force = self.mass * acceleration * transmission + towards * (self.friction + self.force);
        let drives = force * towards >= 0.0;
        let efficiency = if drives { 1.0 / self.efficiency } else { (2.0 - 1.0 / self.efficiency).max(0.0) };
        self.inertia * acceleration + towards * self.drag + force * transmission * efficiency
    }

    /// Sets the cutting force in N against every motion.
    pub(crate) const fn set_force(&mut self, force: f64) {
        self.force = force;
    }

    /// Where the nut is, for where it would be on a true screw; nm.
    #[inline]
    #[must_use]
    pub fn nut(&self, position: f64) -> f64 {
        let mut nut = position;
        if self.periodic > 0.0 {
            nut += self.periodic * (TAU * (position / self.lead).fract()).sin();
        }
        if !self.table.is_empty() {
            nut += self.table_error(position);
        }
        nut
    }

    /// Straight between the rows, flat outside.
    fn table_error(&self, position: f64) -> f64 {
        let after = self.table.partition_point(|(x, _)| *x < position);
        match (after.checked_sub(1).and_then(|before| self.table.get(before)), self.table.get(after)) {
            (Some((x0, y0)), Some((x1, y1))) => y0 + (y1 - y0) * (position - x0) / (x1 - x0),
            (Some((_, y)), None) | (None, Some((_, y))) => *y,
            (None, None) => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn screw(efficiency: &str) -> Screw {
        let mut figures = Figures::new(crate::TABLES);
        for (name, text) in [
            ("screw.z.efficiency", efficiency),
            ("screw.z.drag_nm", "0.1"),
            ("slide.z.mass_kg", "40"),
            ("slide.z.friction_n", "20"),
            ("slide.z.force_n", "30"),
        ] {
            figures.set(name, text).unwrap();
        }
        Screw::new(&figures, Axis::Z).unwrap()
    }

    #[test]
    fn torque_is_that_of_inertia_drag_and_the_force_at_the_nut() {
        let screw = screw("0.8");
        // by hand: k = 7.957747e-4 m/rad, J of rotor and screw 7.430406e-5 kg m2
        let (k, inertia) = (7.957_747e-4, 7.430_406e-5);
        assert!((screw.total_inertia() - (inertia + 40.0 * k * k)).abs() < 1e-10);
        let close = |got: f64, expected: f64| assert!((got - expected).abs() < 1e-6, "{got} {expected}");
        close(screw.torque(0.0, 0.0), 0.0);
        close(screw.torque(10.0, 0.0), 0.1 + 50.0 * k / 0.8);
        // m k a = 31.831 N
        close(screw.torque(10.0, 1000.0), inertia * 1000.0 + 0.1 + (31.830_99 + 50.0) * k / 0.8);
        // braking by less than friction: the nut is still pushed
        close(screw.torque(10.0, -1000.0), -inertia * 1000.0 + 0.1 + (50.0 - 31.830_99) * k / 0.8);
        // braking by more: the slide drives, with 2 - 1 / 0.8 = 0.75
        close(screw.torque(10.0, -3000.0), -inertia * 3000.0 + 0.1 + (50.0 - 95.492_97) * k * 0.75);
        // the other way round all signs change
        for (speed, acceleration) in [(10.0, 0.0), (10.0, 1000.0), (10.0, -3000.0), (0.0, 500.0)] {
            close(screw.torque(-speed, -acceleration), -screw.torque(speed, acceleration));
        }
    }

    #[test]
    fn a_screw_below_one_half_holds_by_itself() {
        let screw = screw("0.4");
        let braking = screw.torque(10.0, -3000.0);
        assert!((braking - (0.1 - 7.430_406e-5 * 3000.0)).abs() < 1e-6, "{braking}");
    }
}
