//! Compensation: what a motor has to go beyond the program so that the slide is where the program says.
//!
//! The program's position stays as it is; the motor goes to program + compensation. For each axis it is the sum of
//! [`backlash`], [`pitch`] and [`thermal`], a function of the machine's own place, of the way it came there, and of the
//! temperature: nothing is summed up, so nothing drifts. In each tick a
//! [`Follower`] moves what is given towards that sum, within
//! a share of the axis's speed and acceleration that the program leaves free; the whole pulses it moves by are
//! [superposed](crate::channel::superposed) on the program's.
//!
//! **The machine's own place.** A screw's errors belong to the screw. So what the tool's place is called (an offset that is
//! kept, a zero that is set) changes nothing here: a *shift* leads from the tool's coordinates to the machine's.
//!
//! Amounts are in pulses with [`FRACTION`] fraction bits. Where the machine's place is made known (when the channel is made,
//! at home, with other figures) the tool is taken to stand right: the compensation of that place counts as given, and nothing
//! moves. Otherwise what is due is made to the pulse, also after the program and the hands have come to rest.

pub mod backlash;
pub mod pitch;
pub mod thermal;

use crate::channel::follower::{Follower, Pace};
use crate::config::{AxisLimits, FRACTION_BITS, Machine};
use crate::math::to_i64;
use crate::units::{Axis, Lattice, Length, PulseSize};
use backlash::Backlash;
use pitch::{Pitch, PitchTable};
use thermal::Thermal;

/// Fraction bits of a compensation in pulses.
pub const FRACTION: u32 = 20;

/// One pulse.
pub const PULSE: i64 = 1 << FRACTION;

/// What part of an axis's acceleration its compensation gets, and the program leaves: a fifth.
pub const ACCEL_SHARE: u32 = 5;

/// What part of an axis's speed its compensation gets, and the program leaves: a 16th.
pub const SPEED_SHARE: u32 = 16;

/// What is to be compensated on one axis. All zero: nothing.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Config {
    /// Play of screw and nut, nm, at most [`Config::MAX_BACKLASH_NM`].
    pub backlash_nm: u32,
    /// Travel in the new direction over which the backlash is taken up, nm; a pulse at least.
    pub backlash_distance_nm: u32,
    /// Whether the pitch error table is in force.
    pub pitch: bool,
    /// How much longer the screw gets, nm a metre a kelvin, at most [`Config::MAX_THERMAL`].
    pub thermal: u32,
    /// The place that does not move when the screw gets longer.
    pub thermal_origin: Length,
}

impl Config {
    /// Largest backlash, 5 mm.
    pub const MAX_BACKLASH_NM: u32 = 5_000_000;
    /// Largest expansion, 100 um a metre a kelvin.
    pub const MAX_THERMAL: u32 = 100_000;

    /// Whether there is anything to compensate.
    pub const fn is_on(&self) -> bool {
        self.backlash_nm > 0 || self.pitch || self.thermal > 0
    }

    /// Brings the figures of one axis into pulses and leaves its share of the limits.
    fn plan(&self, limits: &mut AxisLimits) -> AxisPlan {
        if !self.is_on() {
            return AxisPlan { pulse: limits.pulse, ..AxisPlan::default() };
        }
        let pulse = limits.pulse;
        let speed = limits.speed / SPEED_SHARE;
        let accel = limits.accel / ACCEL_SHARE;
        limits.speed = limits.speed.wrapping_sub(speed);
        limits.accel = limits.accel.wrapping_sub(accel);
        // nm a tick with 12 fraction bits
        let rate = |rate: u32| pulses(pulse, i128::from(rate), FRACTION_BITS).max(1);
        let distance = pulses(pulse, i128::from(self.backlash_distance_nm), 0) >> FRACTION;
        let backlash = pulses(pulse, i128::from(self.backlash_nm.min(Self::MAX_BACKLASH_NM)), 0);
        AxisPlan {
            on: true,
            pulse,
            pitch: self.pitch,
            backlash,
            distance: i32::try_from(distance).unwrap_or(i32::MAX).max(1),
            thermal: self.thermal.min(Self::MAX_THERMAL),
            origin: pulse.nearest(self.thermal_origin),
            pace: Pace { speed: rate(speed), accel: rate(accel) },
        }
    }
}

/// A length in nm with `bits` fraction bits, as pulses with [`FRACTION`] fraction bits, rounded down.
pub(crate) fn pulses(pulse: PulseSize, nm: i128, bits: u32) -> i64 {
    let scaled = nm.wrapping_mul(i128::from(pulse.denominator())).wrapping_shl(FRACTION.wrapping_sub(bits));
    to_i64(scaled.checked_div_euclid(i128::from(pulse.numerator())).unwrap_or(0))
}

/// The compensation of one axis, checked and converted.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct AxisPlan {
    /// Anything is compensated.
    on: bool,
    pitch: bool,
    pulse: PulseSize,
    /// Pulses.
    backlash: i64,
    /// Whole pulses, at least 1.
    distance: i32,
    /// nm a metre a kelvin.
    thermal: u32,
    /// Whole pulses.
    origin: i32,
    pace: Pace,
}

impl Default for AxisPlan {
    fn default() -> Self {
        Self {
            on: false,
            pitch: false,
            pulse: PulseSize::ONE_MICROMETRE,
            backlash: 0,
            distance: 1,
            thermal: 0,
            origin: 0,
            pace: Pace::default(),
        }
    }
}

/// The compensation of a machine. The default is none.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Plan {
    x: AxisPlan,
    z: AxisPlan,
    temperatures: Temperatures,
}

/// Temperatures, thousandths of a degree Celsius.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Temperatures {
    /// At which the screws are right.
    pub reference: i32,
    /// Which the screws have when the cycle starts; [`Compensation::set_temperature`] tells another one later.
    pub screws: i32,
}

impl Plan {
    /// Whether anything is compensated.
    pub const fn is_on(&self) -> bool {
        self.x.on || self.z.on
    }
}

impl Machine {
    /// The same machine compensated: the program's share of an axis's speed and acceleration gets smaller by what the
    /// compensation needs.
    #[must_use]
    pub fn compensated(mut self, x: &Config, z: &Config, temperatures: Temperatures) -> Self {
        self.compensation = Plan { x: x.plan(&mut self.x), z: z.plan(&mut self.z), temperatures };
        self
    }
}

/// The compensation of one axis at work.
#[derive(Clone, Debug)]
struct AxisCompensation {
    plan: AxisPlan,
    backlash: Backlash,
    pitch: Pitch,
    thermal: Thermal,
    follower: Follower,
    /// What is to be given at the machine's place.
    target: i64,
}

impl AxisCompensation {
    const fn new(plan: AxisPlan) -> Self {
        Self {
            plan,
            backlash: Backlash::new(plan.backlash, plan.distance),
            pitch: Pitch::new(plan.pulse),
            thermal: Thermal::new(plan.thermal, plan.origin),
            follower: Follower::new(),
            target: 0,
        }
    }

    /// What is to be given at `position`.
    fn at(&mut self, position: i32) -> i64 {
        let pitch = if self.plan.pitch { self.pitch.at(position) } else { 0 };
        self.backlash.amount().wrapping_add(pitch).wrapping_add(self.thermal.at(position))
    }

    /// Stands at `position`, which counts as right.
    fn stand(&mut self, position: i32) {
        self.target = self.at(position);
        self.follower = Follower::at(self.target);
    }

    /// Takes other figures where they are others; a machine that stands at `position` counts as right with those. How fast it gives
    /// is none of them: what an alarm has left due stays due.
    fn configure(&mut self, plan: AxisPlan, warmer: i32, position: i32) {
        let same = AxisPlan { pace: plan.pace, ..self.plan } == plan && self.thermal.is_for(warmer);
        self.plan = plan;
        if same {
            return;
        }
        self.backlash.configure(plan.backlash, plan.distance);
        self.pitch.configure(plan.pulse);
        self.thermal.configure(plan.thermal, plan.origin);
        self.thermal.heat(warmer, true);
        self.stand(position);
    }

    fn tick(&mut self, moved: i32, position: i32, warms: bool) -> i32 {
        // where neither the slide nor the screw's length changes, the target stays
        let still = moved == 0 && (!warms || self.thermal.is_steady()) && self.follower.rests_at(self.target);
        if !self.plan.on || still {
            return 0;
        }
        self.backlash.moved(moved);
        if warms {
            self.thermal.tick();
        }
        self.target = self.at(position);
        self.follower.follow(self.target, &self.plan.pace)
    }

    /// The axis has `moved` to `position`; what that asks for is still to be given.
    fn see(&mut self, moved: i32, position: i32) {
        if self.plan.on && moved != 0 {
            self.backlash.moved(moved);
            self.target = self.at(position);
        }
    }

    /// Stops where it is, from any speed: what is missing is given when the axis moves again.
    const fn stop(&mut self) {
        self.follower.stop();
        self.target = self.follower.place();
    }

    const fn rests(&self) -> bool {
        !self.plan.on || self.follower.rests_at(self.target)
    }

    /// Whether all is given but for less than a pulse, and the follower may stop.
    const fn settled(&self) -> bool {
        !self.plan.on || self.follower.is_near(self.target, PULSE, &self.plan.pace)
    }
}

/// The compensation of a lathe at work.
#[derive(Clone, Debug)]
pub struct Compensation {
    on: bool,
    /// Only the display moves: nothing is given.
    muted: bool,
    x: AxisCompensation,
    z: AxisCompensation,
    /// The machine's own place at the last tick.
    at: Lattice,
    /// From the tool's coordinates to the machine's.
    shift: Lattice,
    temperatures: Temperatures,
}

impl Compensation {
    /// Of a machine that stands at `place`, which counts as right and is the machine's own.
    pub fn new(plan: &Plan, place: Lattice) -> Self {
        let mut new = Self {
            on: plan.is_on(),
            muted: false,
            x: AxisCompensation::new(plan.x),
            z: AxisCompensation::new(plan.z),
            at: place,
            shift: Lattice { x: 0, z: 0 },
            temperatures: plan.temperatures,
        };
        new.heat(true);
        new.x.stand(place.x);
        new.z.stand(place.z);
        new
    }

    /// Goes on with other figures, the tool standing at `tool`. An axis whose figures are others counts as right; else what is
    /// due stays due. Tables are kept.
    pub fn configure(&mut self, plan: &Plan, tool: Lattice) {
        let place = self.stand_still(tool);
        self.temperatures = plan.temperatures;
        let warmer = self.warmer();
        self.x.configure(plan.x, warmer, place.x);
        self.z.configure(plan.z, warmer, place.z);
        self.on = plan.is_on();
    }

    /// Puts a pitch error table in the place of an axis's last one; the tool stands at `tool`, which counts as right.
    pub fn set_pitch_table(&mut self, axis: Axis, table: &PitchTable, tool: Lattice) {
        let place = self.stand_still(tool);
        match axis {
            Axis::X => {
                self.x.pitch.set(table);
                self.x.stand(place.x);
            }
            Axis::Z => {
                self.z.pitch.set(table);
                self.z.stand(place.z);
            }
        }
    }

    /// Sets the temperature of the screws, thousandths of a degree Celsius; it acts slowly or at once.
    pub fn set_temperature(&mut self, temperature: i32, slowly: bool) {
        self.temperatures.screws = temperature;
        self.heat(!slowly);
    }

    const fn warmer(&self) -> i32 {
        self.temperatures.screws.saturating_sub(self.temperatures.reference)
    }

    fn heat(&mut self, at_once: bool) {
        let warmer = self.warmer();
        for axis in [&mut self.x, &mut self.z] {
            axis.thermal.heat(warmer, at_once);
        }
    }

    /// The machine's own place of an axis is `place`, where the tool's coordinate is `tool`: it counts as right there.
    pub fn stand_at(&mut self, axis: Axis, place: i32, tool: i32) {
        let shift = place.wrapping_sub(tool);
        match axis {
            Axis::X => self.shift.x = shift,
            Axis::Z => self.shift.z = shift,
        }
        // with no pulses made the motors stand somewhere else
        if self.muted {
            return;
        }
        match axis {
            Axis::X => {
                self.at.x = place;
                self.x.stand(place);
            }
            Axis::Z => {
                self.at.z = place;
                self.z.stand(place);
            }
        }
    }

    /// The tool's place, `before` up to now, is called `after`; nothing has moved.
    pub const fn rename(&mut self, before: Lattice, after: Lattice) {
        self.shift.x = self.shift.x.wrapping_add(before.x).wrapping_sub(after.x);
        self.shift.z = self.shift.z.wrapping_add(before.z).wrapping_sub(after.z);
    }

    /// Gives nothing from now on, the tool standing at `tool`; or goes on, where the tool is called `tool` now.
    pub fn mute(&mut self, muted: bool, tool: Lattice) {
        if muted {
            self.stand_still(tool);
        } else {
            self.shift = Lattice { x: self.at.x.wrapping_sub(tool.x), z: self.at.z.wrapping_sub(tool.z) };
        }
        self.muted = muted;
    }

    /// The machine's own place of the tool, which stands; it is noted as that of the last tick.
    fn stand_still(&mut self, tool: Lattice) -> Lattice {
        if !self.muted {
            let place = self.place(tool);
            self.x.see(place.x.wrapping_sub(self.at.x), place.x);
            self.z.see(place.z.wrapping_sub(self.at.z), place.z);
            self.at = place;
        }
        self.at
    }

    const fn place(&self, tool: Lattice) -> Lattice {
        Lattice { x: tool.x.wrapping_add(self.shift.x), z: tool.z.wrapping_add(self.shift.z) }
    }

    /// Whether anything is compensated.
    #[inline]
    pub const fn is_on(&self) -> bool {
        self.on && !self.muted
    }

    /// Whether each motor stands where it has to, but for less than a pulse.
    pub const fn settled(&self) -> bool {
        !self.is_on() || self.x.settled() && self.z.settled()
    }

    /// Whether each motor stands where it has to with the tool at `tool`, and no pulse is to come.
    pub const fn rests(&self, tool: Lattice) -> bool {
        let place = self.place(tool);
        let seen = place.x == self.at.x && place.z == self.at.z;
        !self.is_on() || seen && self.x.rests() && self.z.rests()
    }

    /// Whether an axis's motor stands where it has to.
    pub const fn axis_rests(&self, axis: Axis) -> bool {
        match axis {
            Axis::X => self.x.rests(),
            Axis::Z => self.z.rests(),
        }
    }

    /// The pulses that each axis has to go in this tick beyond the tool, which has got to `tool`. Screws that get warmer do so
    /// only where it `warms`: a machine at rest makes what is due and then stands.
    pub fn tick(&mut self, tool: Lattice, warms: bool) -> (i32, i32) {
        let place = self.place(tool);
        let moved = (place.x.wrapping_sub(self.at.x), place.z.wrapping_sub(self.at.z));
        self.at = place;
        (self.x.tick(moved.0, place.x, warms), self.z.tick(moved.1, place.z, warms))
    }

    /// Stops where it is, from any speed, with the tool at `tool`.
    pub fn stop(&mut self, tool: Lattice) {
        self.stand_still(tool);
        self.x.stop();
        self.z.stop();
    }

    /// Pulses that the motor of an axis is due beyond the program since the position was last made known.
    pub const fn given(&self, axis: Axis) -> i32 {
        match axis {
            Axis::X => self.x.follower.pulses(),
            Axis::Z => self.z.follower.pulses(),
        }
    }
}
