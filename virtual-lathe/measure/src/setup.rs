//! What the checker is told of the machine: pulse equivalents, limits, where the train begins.

use std::fmt;

/// Train clocks per second: 12 MHz on every board.
pub const CLOCKS_PER_SECOND: u32 = 12_000_000;
/// Train clocks per tick of one millisecond.
pub const CLOCKS_PER_TICK: u32 = 12_000;

/// An axis of the lathe.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Cross slide; plus leads away from the turning axis.
    X,
    /// Carriage; plus leads away from the headstock.
    Z,
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::X => "X",
            Self::Z => "Z",
        })
    }
}

/// One value for each axis.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct PerAxis<T> {
    /// Of the cross slide.
    pub x: T,
    /// Of the carriage.
    pub z: T,
}

impl<T> PerAxis<T> {
    /// Applies `change` to both.
    pub fn map<U>(self, mut change: impl FnMut(T) -> U) -> PerAxis<U> {
        PerAxis { x: change(self.x), z: change(self.z) }
    }
}

/// Pulse equivalent: an axis moves by `num`/`den` nanometres a pulse, exactly.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct PulseEquivalent {
    /// Numerator in nanometres, above zero.
    pub num: u32,
    /// Denominator, above zero.
    pub den: u32,
}

impl PulseEquivalent {
    /// Nanometres per pulse, correctly rounded to `f64`.
    #[must_use]
    pub fn nm(self) -> f64 {
        f64::from(self.num) / f64::from(self.den)
    }

    /// The pulse nearest to `nm`; half a pulse rounds toward plus infinity. Exact.
    ///
    /// ```
    /// # use measure::PulseEquivalent;
    /// let pulse = PulseEquivalent { num: 15_875, den: 8 };
    /// assert_eq!(pulse.nearest(2_000), 1); // 1.008 pulses
    /// let pulse = PulseEquivalent { num: 1_000, den: 1 };
    /// assert_eq!((pulse.nearest(500), pulse.nearest(-500)), (1, 0));
    /// ```
    #[must_use]
    pub fn nearest(self, nm: i64) -> i64 {
        // floor(nm den / num + 1/2) with the fraction cleared; |nm den| < 2^95.
        let num = i128::from(self.num);
        let doubled = 2 * i128::from(nm) * i128::from(self.den) + num;
        let pulse = doubled.div_euclid((2 * num).max(1));
        i64::try_from(pulse).unwrap_or(if pulse < 0 { i64::MIN } else { i64::MAX })
    }
}

/// What one axis and its drive allow.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Limits {
    /// Largest acceleration in mm/s².
    pub max_accel: f64,
    /// Largest speed in mm/min.
    pub max_feed: f64,
    /// Largest jump of speed at a joint, a start or a stop, in mm/s.
    pub max_jump: f64,
    /// Shortest time a step pin stays high, in ns.
    pub pulse_width_ns: u32,
    /// Shortest time from a change of direction to a rising edge, in ns.
    pub dir_setup_ns: u32,
    /// Shortest time from a rising edge to a change of direction, in ns.
    pub dir_hold_ns: u32,
    /// Shortest time a step pin stays low between two pulses, in ns.
    pub min_space_ns: u32,
}

/// Everything the checker is told before the train begins.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Setup {
    /// Size of a pulse.
    pub pulse_nm: PerAxis<PulseEquivalent>,
    /// Position before the first event, in pulses.
    pub start: PerAxis<i32>,
    /// Programmed position where the first motion starts, in nm; it must round to `start`.
    pub start_nm: PerAxis<i64>,
    /// Limits of the axes.
    pub limits: PerAxis<Limits>,
    /// Shortest interval of an event, in ns.
    pub event_min_ns: u32,
    /// The pulses of an axis that moves evenly come unevenly, up to one and a half before or behind its ideal place: so
    /// do those of digital integration and of a rate multiplier.
    pub uneven: bool,
    /// Ticks over which the speed of the path is a mean of what was planned, 0 for none. Only the feed is judged by it: ramps
    /// are longer by that.
    pub smoothed_ticks: u32,
}

/// Why a set-up was refused.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum SetupError {
    /// A pulse equivalent has a zero in it.
    Pulse(Axis),
    /// A limit of acceleration or feed is not a positive number, or the jump is below zero.
    Limit(Axis),
}

impl fmt::Display for SetupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pulse(axis) => write!(f, "pulse equivalent of {axis} is zero or infinite"),
            Self::Limit(axis) => write!(f, "a limit of {axis} is not a positive number"),
        }
    }
}

impl std::error::Error for SetupError {}

impl Setup {
    /// Refuses what would make the figures meaningless.
    pub(crate) fn check(&self) -> Result<(), SetupError> {
        let axes = [(Axis::X, self.pulse_nm.x, self.limits.x), (Axis::Z, self.pulse_nm.z, self.limits.z)];
        for (axis, pulse, limits) in axes {
            if pulse.num == 0 || pulse.den == 0 {
                return Err(SetupError::Pulse(axis));
            }
            let positive = |limit: f64| limit.is_finite() && limit > 0.0;
            let jump = limits.max_jump.is_finite() && limits.max_jump >= 0.0;
            if !(positive(limits.max_accel) && positive(limits.max_feed) && jump) {
                return Err(SetupError::Limit(axis));
            }
        }
        Ok(())
    }
}

/// Clocks that `ns` needs at least: ceil(`ns` * 12 / 1000).
///
/// ```
/// assert_eq!(measure::clocks_for(2_500), 30);
/// assert_eq!(measure::clocks_for(2_501), 31);
/// ```
#[must_use]
pub const fn clocks_for(ns: u32) -> u64 {
    (ns as u64 * 12).div_ceil(1_000)
}

#[cfg(test)]
mod tests {
    use super::PulseEquivalent;
    use proptest::prelude::{any, proptest};

    proptest! {
        /// The definition, without a division: |n num - nm den| <= num / 2, a tie only from above.
        #[test]
        fn nearest_pulse_is_within_half_a_pulse_and_ties_go_up(
            nm in any::<i64>(), num in 1_u32..1 << 24, den in 1_u32..4_096,
        ) {
            let nm = nm >> 8; // 36 years of light would do
            let n = i128::from(PulseEquivalent { num, den }.nearest(nm));
            let excess = 2 * (n * i128::from(num) - i128::from(nm) * i128::from(den));
            assert!(excess > -i128::from(num) && excess <= i128::from(num));
        }
    }
}
