//! The machine's figures: as set ([`Config`]) and as checked and converted for the interpolator ([`Machine`]).
//!
//! Speeds inside are in nanometres a tick with 12 fraction bits, accelerations in nanometres a tick squared with 12
//! fraction bits (so 1 mm/s2 is 4096), times of the train in clocks of 12 MHz.

use crate::compensation::Plan;
use crate::curve::method::Method;
use crate::law::{MAX_TICKS, Smoothing, SpeedLaw};
use crate::math::{root, to_u32};
use crate::threading::Threading;
use crate::units::{Axis, Feedrate, PulseSize};

/// Clocks of the pulse train in one tick.
pub const TICK_CLOCKS: u32 = 12_000;
/// Clocks of the pulse train in a second.
pub const CLOCKS_PER_SECOND: u32 = 12_000_000;
/// Ticks in a second.
pub const TICKS_PER_SECOND: u32 = 1_000;
/// Fraction bits of speeds, accelerations and path lengths.
pub const FRACTION_BITS: u32 = 12;

/// One axis as set.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct AxisConfig {
    /// How far one pulse moves the axis.
    pub pulse: PulseSize,
    /// Largest speed.
    pub max_feed: Feedrate,
    /// Largest acceleration, um/s2, 1 mm/s2 to 50 m/s2.
    pub max_accel: u32,
    /// Largest sudden change of speed (the motor's start-stop speed), um/s, 10 um/s to 100 mm/s.
    pub max_jump: u32,
    /// Time that a step pin stays high, ns.
    pub pulse_width_ns: u32,
    /// Time from a change of direction to the next rising edge, ns.
    pub dir_setup_ns: u32,
    /// Time from a rising edge to a change of direction, ns.
    pub dir_hold_ns: u32,
    /// Time that a step pin stays low, ns.
    pub min_space_ns: u32,
}

/// A machine as set.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Config {
    /// Cross slide.
    pub x: AxisConfig,
    /// Carriage.
    pub z: AxisConfig,
    /// Time between any two events of the train, ns.
    pub event_min_ns: u32,
}

/// Why a set of figures is no machine.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum ConfigError {
    /// The axis would need pulses faster than width and space allow.
    PulseRate {
        /// Which axis.
        axis: Axis,
        /// Pulses a second at the axis's largest feed.
        needed_hz: u32,
        /// Pulses a second that width, space and the waits of events allow.
        limit_hz: u32,
    },
    /// The pulse sizes differ by more than [`Config::MAX_PULSE_RATIO`].
    PulseRatio,
    /// The jerk asked for needs a longer mean than there is room for.
    Jerk {
        /// The law asked for.
        law: SpeedLaw,
        /// The least jerk that can be kept, mm/s3.
        least: u32,
    },
    /// An acceleration or jump is outside its range.
    Range {
        /// Which axis.
        axis: Axis,
    },
}

/// One axis as the interpolator uses it.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct AxisLimits {
    /// How far one pulse moves the axis.
    pub pulse: PulseSize,
    /// Largest speed, nm a tick, 12 fraction bits.
    pub speed: u32,
    /// Largest acceleration, nm a tick squared, 12 fraction bits: the program's.
    pub accel: u32,
    /// What a handwheel has besides while the program moves; 0 without handwheels.
    pub by_hand: u32,
    /// Largest jump of speed, nm a tick, 12 fraction bits.
    pub jump: u32,
    /// Step pin high, clocks.
    pub width: u32,
    /// Step pin low, clocks.
    pub space: u32,
    /// Direction before step, clocks.
    pub setup: u32,
    /// Direction after step, clocks.
    pub hold: u32,
}

/// A machine whose figures were checked.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Machine {
    /// Cross slide.
    pub x: AxisLimits,
    /// Carriage.
    pub z: AxisLimits,
    /// Shortest time between two events, clocks, at least 1.
    pub event_min: u32,
    /// How steps follow a curve. Without the feature `methods` always by minimum deviation.
    pub method: Method,
    /// What the motors have to go beyond the program. [`Config::check`] leaves it empty; see [`Machine::compensated`].
    pub compensation: Plan,
    /// How the speed along the path changes.
    pub smoothing: Smoothing,
    /// What it does about threads. [`Config::check`] leaves it empty.
    pub threading: Threading,
}

/// Speed in the interpolator's unit, rounded to nearest, at least 1.
pub const fn speed_of(feed: Feedrate) -> u32 {
    // nm/min -> nm/tick << 12: * 4096 / 60000
    let scaled = feed.nm_per_min().saturating_mul(4096).saturating_add(30_000) / 60_000;
    let speed = to_u32(scaled);
    if speed == 0 { 1 } else { speed }
}

/// Clocks that last at least `ns`.
pub(crate) const fn clocks(ns: u32) -> u32 {
    to_u32((ns as u64).saturating_mul(12).saturating_add(999) / 1_000)
}

impl AxisConfig {
    /// Range of `max_accel`, um/s2.
    pub const ACCEL_RANGE: (u32, u32) = (1_000, 50_000_000);
    /// Range of `max_jump`, um/s.
    pub const JUMP_RANGE: (u32, u32) = (10, 100_000);

    fn check(&self, axis: Axis, event_min: u32, other_width_ns: u32) -> Result<AxisLimits, ConfigError> {
        let accel_fits = self.max_accel >= Self::ACCEL_RANGE.0 && self.max_accel <= Self::ACCEL_RANGE.1;
        let jump_fits = self.max_jump >= Self::JUMP_RANGE.0 && self.max_jump <= Self::JUMP_RANGE.1;
        if !accel_fits || !jump_fits {
            return Err(ConfigError::Range { axis });
        }
        let (width, space) = (clocks(self.pulse_width_ns).max(1), clocks(self.min_space_ns).max(1));
        // no level of a pin is shorter than an event, and falls of both axes that are closer wait for each other
        let (high, low) = (width.max(event_min), space.max(event_min));
        let apart = clocks(other_width_ns).max(event_min).abs_diff(high);
        let waits_for_fall = if apart > 0 && apart < event_min { event_min } else { 0 };
        let pulse = high.saturating_add(waits_for_fall).saturating_add(low);
        // edges that wait for a tick's border or for another event catch up in what is left: four waits a tick
        let waits = event_min.saturating_mul(4).saturating_mul(TICKS_PER_SECOND);
        let limit_hz = CLOCKS_PER_SECOND.saturating_sub(waits).checked_div(pulse).unwrap_or(0);
        // pulses a second = nm/min * denominator / (60 * numerator), rounded up
        let per_minute = self.max_feed.nm_per_min().saturating_mul(u64::from(self.pulse.denominator()));
        let needed_hz = to_u32(per_minute.div_ceil(u64::from(self.pulse.numerator()).saturating_mul(60).max(1)));
        if needed_hz > limit_hz {
            return Err(ConfigError::PulseRate { axis, needed_hz, limit_hz });
        }
        Ok(AxisLimits {
            pulse: self.pulse,
            speed: speed_of(self.max_feed),
            accel: to_u32(u64::from(self.max_accel).saturating_mul(4096) / 1_000),
            by_hand: 0,
            jump: to_u32(u64::from(self.max_jump).saturating_mul(4096)),
            width,
            space,
            setup: clocks(self.dir_setup_ns),
            hold: clocks(self.dir_hold_ns),
        })
    }
}

impl AxisLimits {
    const fn with_hand(mut self) -> Self {
        let all = self.accel.saturating_add(self.by_hand);
        self.by_hand = to_u32((all as u64).saturating_mul(3) / 10);
        self.accel = all.saturating_sub(self.by_hand);
        self
    }
}

impl Config {
    /// How many times one pulse size may be the other: beyond it 64 bits do not carry an arc exactly.
    pub const MAX_PULSE_RATIO: u64 = 128;

    /// Checks the figures together and converts them.
    ///
    /// # Errors
    /// The first [`ConfigError`] found, X before Z.
    pub fn check(&self) -> Result<Machine, ConfigError> {
        let (x, z) = (self.x.pulse, self.z.pulse);
        let (wide, narrow) = (
            u64::from(x.numerator()).saturating_mul(u64::from(z.denominator())),
            u64::from(z.numerator()).saturating_mul(u64::from(x.denominator())),
        );
        let ratio = Self::MAX_PULSE_RATIO;
        if wide > narrow.saturating_mul(ratio) || narrow > wide.saturating_mul(ratio) {
            return Err(ConfigError::PulseRatio);
        }
        let event_min = clocks(self.event_min_ns).max(1);
        let x = self.x.check(Axis::X, event_min, self.z.pulse_width_ns)?;
        let z = self.z.check(Axis::Z, event_min, self.x.pulse_width_ns)?;
        let (method, compensation, smoothing) = (Method::MinimumDeviation, Plan::default(), Smoothing::NONE);
        Ok(Machine { x, z, event_min, method, compensation, smoothing, threading: Threading::NONE })
    }
}

impl Machine {
    /// The same machine with handwheels that may be turned while the program moves: the program plans with 70 % of the
    /// acceleration of each axis, the wheels have the rest. To be called before [`with_law`](Self::with_law).
    #[must_use]
    pub const fn with_hands(mut self) -> Self {
        self.x = self.x.with_hand();
        self.z = self.z.with_hand();
        self
    }

    /// The same machine under a speed law with a jerk of at most `jerk` mm/s3 along the path.
    ///
    /// The S laws plan with 7/8 of the axes' accelerations: their mean over a joint of a line and an arc may need up to
    /// 2 / sqrt(3) of what each allows by itself, and axes that jump at a joint spread that over the mean, too.
    ///
    /// # Errors
    /// [`ConfigError::Jerk`].
    pub fn with_law(self, law: SpeedLaw, jerk: u32) -> Result<Self, ConfigError> {
        if matches!(law, SpeedLaw::Linear) {
            return Ok(Self { smoothing: Smoothing::NONE, ..self });
        }
        let planned = |limits: AxisLimits| AxisLimits { accel: limits.accel.wrapping_sub(limits.accel >> 3), ..limits };
        let (x, z) = (planned(self.x), planned(self.z));
        // both axes at their limit; below 2^57, as an acceleration is below 2^28
        let square = |limits: AxisLimits| u64::from(limits.accel).wrapping_mul(u64::from(limits.accel));
        let accel = root(square(x).saturating_add(square(z))).saturating_add(1);
        let smoothing = Smoothing::new(law, accel, jerk).map_err(|least| ConfigError::Jerk { law, least })?;
        Ok(Self { x, z, smoothing, ..self })
    }
}

impl core::fmt::Display for ConfigError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::PulseRate { axis, needed_hz, limit_hz } => {
                let a = axis.letter();
                write!(
                    f,
                    "{a}.max_feed needs {needed_hz} pulses a second, but {a}.pulse_width_ns, {a}.min_space_ns and event_min_ns allow {limit_hz}"
                )
            }
            Self::PulseRatio => {
                write!(f, "x.pulse_nm and z.pulse_nm differ by more than {} times", Config::MAX_PULSE_RATIO)
            }
            Self::Jerk { law, least } => write!(
                f,
                "accel={} would need a mean of more than {MAX_TICKS} ms: max_jerk must be at least {least} mm/s3, or max_accel smaller",
                law.name()
            ),
            Self::Range { axis } => write!(f, "{0}.max_accel or {0}.max_jump is outside its range", axis.letter()),
        }
    }
}
