//! Thermal expansion: a screw that is warmer than it was made for is longer.
//!
//! Its error is `expansion * (temperature - reference) * (position - origin)`; the motor goes as far back. A new
//! temperature acts slowly, by at most [`STEP`] a tick, so that a sensor's jump is no jump of the slide.

/// Fraction bits of a relative change of length.
const BITS: u32 = 36;

/// Most by which the relative change of length follows in a tick, 36 fraction bits: about 1 um a metre a second.
pub const STEP: i64 = 64;

/// Thermal expansion of one axis.
#[derive(Clone, Debug)]
pub struct Thermal {
    /// nm a metre a kelvin.
    expansion: i64,
    /// Pulses.
    origin: i32,
    /// Relative change of length: wanted, and in force.
    goal: i64,
    ratio: i64,
    /// No tick has seen the last temperature yet.
    new: bool,
}

impl Thermal {
    /// At the temperature of reference; `expansion` in nm a metre a kelvin, `origin` in pulses.
    pub const fn new(expansion: u32, origin: i32) -> Self {
        Self { expansion: expansion as i64, origin, goal: 0, ratio: 0, new: true }
    }

    /// Other figures; [`heat`](Self::heat) has to follow.
    pub const fn configure(&mut self, expansion: u32, origin: i32) {
        (self.expansion, self.origin) = (expansion as i64, origin);
    }

    /// The screw is `warmer` than at reference, thousandths of a kelvin; more than 200 K count as that.
    pub fn heat(&mut self, warmer: i32, at_once: bool) {
        self.goal = self.longer(warmer);
        self.new = true;
        if at_once {
            self.ratio = self.goal;
        }
    }

    /// Relative change of length by so much heat.
    fn longer(&self, warmer: i32) -> i64 {
        let warmer = i64::from(warmer.clamp(-200_000, 200_000));
        // 1e-12 of a length: times 2^36 / 1e12; the product is below 2^53
        self.expansion.wrapping_mul(warmer).wrapping_mul(68_719) / 1_000_000
    }

    /// Whether it is on its way to this heat, or has it.
    pub fn is_for(&self, warmer: i32) -> bool {
        self.goal == self.longer(warmer)
    }

    /// Whether the screw is as long as its temperature says, and was in the last tick.
    #[inline]
    pub const fn is_steady(&self) -> bool {
        self.ratio == self.goal && !self.new
    }

    /// A tick goes by.
    pub fn tick(&mut self) {
        if self.is_steady() {
            return;
        }
        self.new = false;
        self.ratio = self.ratio.wrapping_add(self.goal.wrapping_sub(self.ratio).clamp(STEP.wrapping_neg(), STEP));
    }

    /// How far the motor has to go beyond `position` (pulses): pulses with [`FRACTION`](super::FRACTION) fraction bits.
    ///
    /// ```
    /// # use interp_core::compensation::{PULSE, thermal::Thermal};
    /// let mut screw = Thermal::new(11_500, 1_000); // steel
    /// screw.heat(10_000, true); // 10 K warmer: 115 um a metre
    /// let back = screw.at(1_001_000); // of pulses of 1 um: a metre from the origin
    /// assert!((back + 115 * PULSE).abs() < PULSE / 100);
    /// assert_eq!(screw.at(1_000), 0);
    /// ```
    pub fn at(&self, position: i32) -> i64 {
        // a distance is below 2^29 pulses and a ratio below 2^31
        let distance = i64::from(position).wrapping_sub(i64::from(self.origin));
        distance.wrapping_mul(self.ratio).wrapping_neg() >> BITS.wrapping_sub(super::FRACTION)
    }
}
