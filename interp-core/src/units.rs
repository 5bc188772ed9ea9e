//! Quantities: lengths in nanometres, points, pulse sizes as exact ratios, feeds, points of the pulse lattice.
//!
//! The sign convention is ISO 841: +Z away from the spindle, +X away from the centre line. X is a radius
//! everywhere inside; the factor two of a diameter exists only where text is read or shown.

/// One of the two controlled axes.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Cross slide, radius.
    X,
    /// Carriage.
    Z,
}

impl Axis {
    /// Lower-case letter, as parameters name the axis.
    pub const fn letter(self) -> char {
        match self {
            Self::X => 'x',
            Self::Z => 'z',
        }
    }
}

/// Length, held in nanometres: 0.001 mm, 0.0001 in and their halves are exact. Spans ±2.1 m.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Length(i32);

impl Length {
    /// No length.
    pub const ZERO: Self = Self(0);
    /// Largest magnitude, 2.1 m.
    pub const LIMIT_NM: i32 = 2_100_000_000;

    /// `None` past ±2.1 m.
    pub const fn from_nm(nm: i64) -> Option<Self> {
        if nm < (Self::LIMIT_NM as i64).wrapping_neg() || nm > Self::LIMIT_NM as i64 {
            return None;
        }
        #[expect(clippy::cast_possible_truncation, reason = "within ±2.1e9, checked above")]
        Some(Self(nm as i32))
    }

    /// `None` past ±2.1 m.
    pub const fn from_um(um: i32) -> Option<Self> {
        match um.checked_mul(1_000) {
            Some(nm) => Self::from_nm(nm as i64),
            None => None,
        }
    }

    /// Nanometres.
    pub const fn nm(self) -> i32 {
        self.0
    }
}

/// Point of the XZ plane, X as a radius.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Point {
    /// Cross slide, radius.
    pub x: Length,
    /// Carriage.
    pub z: Length,
}

/// Point of the pulse lattice, in pulses of each axis from the machine zero.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Lattice {
    /// Pulses of X.
    pub x: i32,
    /// Pulses of Z.
    pub z: i32,
}

/// Sense of an arc, seen with Z to the right and X upward.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Sense {
    /// G2.
    Clockwise,
    /// G3.
    CounterClockwise,
}

impl Sense {
    /// The other sense.
    #[must_use]
    pub const fn mirrored(self) -> Self {
        match self {
            Self::Clockwise => Self::CounterClockwise,
            Self::CounterClockwise => Self::Clockwise,
        }
    }
}

/// Speed along the path, held in nanometres a minute; never zero. 0.01 mm/min to 30 m/min.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Feedrate(u64);

impl Feedrate {
    /// 0.01 mm/min.
    pub const SLOWEST: Self = Self(10_000);
    /// Largest feed that the arithmetic carries: 30 m/min.
    pub const LIMIT_NM_PER_MIN: u64 = 30_000_000_000;

    /// `None` below 0.01 mm/min and above 30 m/min.
    pub const fn from_nm_per_min(nm: u64) -> Option<Self> {
        if nm < Self::SLOWEST.0 || nm > Self::LIMIT_NM_PER_MIN { None } else { Some(Self(nm)) }
    }

    /// Nanometres a minute.
    pub const fn nm_per_min(self) -> u64 {
        self.0
    }
}

/// Pulse equivalent: how far one pulse moves the axis, an exact ratio in nanometres.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct PulseSize {
    numerator: u32,
    denominator: u32,
}

impl PulseSize {
    /// 1000 nm.
    pub const ONE_MICROMETRE: Self = Self { numerator: 1000, denominator: 1 };
    /// Largest numerator, 2^24.
    pub const MAX_NUMERATOR: u32 = 1 << 24;
    /// Largest denominator.
    pub const MAX_DENOMINATOR: u32 = 4096;

    /// `numerator / denominator` nanometres a pulse, reduced. `None` outside 10 nm to 1 mm, or when the reduced
    /// ratio does not fit.
    pub const fn new(numerator: u32, denominator: u32) -> Option<Self> {
        if numerator == 0 || denominator == 0 {
            return None;
        }
        let (mut a, mut b) = (numerator, denominator);
        while let Some(rest) = a.checked_rem(b) {
            (a, b) = (b, rest);
        }
        let (Some(n), Some(d)) = (numerator.checked_div(a), denominator.checked_div(a)) else { return None };
        let fits = n <= Self::MAX_NUMERATOR && d <= Self::MAX_DENOMINATOR;
        let (size, per) = (n as u64, d as u64);
        let in_range = size >= per.wrapping_mul(10) && size <= per.wrapping_mul(1_000_000);
        if fits && in_range { Some(Self { numerator: n, denominator: d }) } else { None }
    }

    /// Numerator of the reduced ratio, nanometres.
    pub const fn numerator(self) -> u32 {
        self.numerator
    }

    /// Denominator of the reduced ratio, pulses.
    pub const fn denominator(self) -> u32 {
        self.denominator
    }

    /// Nearest pulse, half toward plus infinity.
    ///
    /// ```
    /// # use interp_core::units::{Length, PulseSize};
    /// let pulse = PulseSize::new(2500, 1).unwrap();
    /// assert_eq!(pulse.nearest(Length::from_nm(1250).unwrap()), 1); // half goes up
    /// assert_eq!(pulse.nearest(Length::from_nm(-1250).unwrap()), 0);
    /// ```
    pub const fn nearest(self, length: Length) -> i32 {
        // |length| < 2^31, denominator <= 2^12, numerator <= 2^24: below 2^45
        let n = self.numerator as i64;
        let twice = (length.0 as i64).wrapping_mul(2).wrapping_mul(self.denominator as i64).wrapping_add(n);
        #[expect(clippy::cast_possible_truncation, reason = "2.1e9 nm / 10 nm is below 2^28")]
        let pulses = match twice.checked_div_euclid(n.wrapping_mul(2)) {
            Some(pulses) => pulses as i32,
            None => 0,
        };
        pulses
    }
}
