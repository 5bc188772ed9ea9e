//! The pitch error of a screw: a table over the position, straight between its points, constant beyond its ends.
//!
//! Looking a position up takes one multiplication: the segment that the last one was in is kept, with its borders in
//! pulses and its slope. The value is a function of the position alone, whichever way it was reached.

use super::FRACTION;
use crate::units::{Length, PulseSize};

/// Most points of a table.
pub const POINTS: usize = 128;

/// Nanometres of a unit of a table's errors.
pub const UNIT_NM: i32 = 100;

/// Fraction bits of a slope, pulses a pulse.
const SLOPE_BITS: u32 = 36;

/// Why there is no such table.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum PitchError {
    /// It has no point.
    Empty,
    /// It has more than [`POINTS`].
    TooMany,
    /// Its spacing is outside [`PitchTable::SPACING_NM`].
    Spacing,
    /// Between this point (from 0) and the next its error changes by half of the spacing and more: no screw does.
    Steep(usize),
}

impl core::fmt::Display for PitchError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Empty => f.write_str("a pitch error table needs at least one point"),
            Self::TooMany => write!(f, "a pitch error table has at most {POINTS} points"),
            Self::Spacing => f.write_str("the points of a pitch error table are 0.01 to 100 mm apart"),
            Self::Steep(point) => {
                let (one, next) = (point.saturating_add(1), point.saturating_add(2));
                write!(
                    f,
                    "the error changes by half of the distance and more between points {one} and {next}: no screw does"
                )
            }
        }
    }
}

/// How far a screw's slide is beyond the place where its pulses should have brought it, over that place.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct PitchTable {
    start: Length,
    /// nm.
    spacing: i32,
    count: usize,
    /// In [`UNIT_NM`].
    errors: [i16; POINTS],
}

impl PitchTable {
    /// Least and largest distance of two points, nm.
    pub const SPACING_NM: (i32, i32) = (10_000, 100_000_000);

    /// No error anywhere.
    pub const NONE: Self = Self { start: Length::ZERO, spacing: 1_000_000, count: 1, errors: [0; POINTS] };

    /// A table whose first point is at `start` and whose points are `spacing` apart; `errors` in [`UNIT_NM`], in the
    /// order of the places, plus where the slide is too far in plus.
    ///
    /// # Errors
    /// [`PitchError`].
    pub fn new(start: Length, spacing: Length, errors: &[i16]) -> Result<Self, PitchError> {
        if errors.is_empty() {
            return Err(PitchError::Empty);
        }
        let mut table = Self { start, spacing: spacing.nm(), count: errors.len(), ..Self::NONE };
        table.errors.get_mut(..errors.len()).ok_or(PitchError::TooMany)?.copy_from_slice(errors);
        if table.spacing < Self::SPACING_NM.0 || table.spacing > Self::SPACING_NM.1 {
            return Err(PitchError::Spacing);
        }
        let steep = errors.windows(2).position(|pair| match pair {
            [one, next] => {
                let change = i64::from(*next).wrapping_sub(i64::from(*one)).saturating_abs();
                change.wrapping_mul(i64::from(UNIT_NM)).wrapping_mul(2) >= i64::from(table.spacing)
            }
            _ => false,
        });
        steep.map_or(Ok(table), |point| Err(PitchError::Steep(point)))
    }

    /// The error at a point, nm; that of the last one beyond it.
    fn error(&self, point: i64) -> i64 {
        let last = self.count.saturating_sub(1);
        let point = usize::try_from(point).unwrap_or(0).min(last);
        i64::from(self.errors.get(point).copied().unwrap_or(0)).wrapping_mul(i64::from(UNIT_NM))
    }
}

/// The pitch error of one axis.
#[derive(Clone, Debug)]
pub struct Pitch {
    pulse: PulseSize,
    table: PitchTable,
    /// The segment that the last position was in: from `low`, to below `high`.
    low: i32,
    high: i32,
    /// What is to be given at `low`, pulses with [`FRACTION`] fraction bits, and by how much more each pulse on.
    base: i64,
    slope: i64,
}

impl Pitch {
    /// No error on an axis of such pulses.
    pub const fn new(pulse: PulseSize) -> Self {
        Self { pulse, table: PitchTable::NONE, low: 0, high: 0, base: 0, slope: 0 }
    }

    /// Takes another table.
    pub const fn set(&mut self, table: &PitchTable) {
        self.table = *table;
        (self.low, self.high) = (0, 0);
    }

    /// Other pulses, the same table.
    pub const fn configure(&mut self, pulse: PulseSize) {
        self.pulse = pulse;
        (self.low, self.high) = (0, 0);
    }

    /// How far the motor has to go beyond `position` (pulses): pulses with [`FRACTION`] fraction bits.
    #[inline]
    pub fn at(&mut self, position: i32) -> i64 {
        if position < self.low || position >= self.high {
            self.enter(position);
        }
        // inside a segment of at most 2^24 pulses; outside the slope is 0
        let along = i64::from(position).wrapping_sub(i64::from(self.low));
        self.base.wrapping_add(along.wrapping_mul(self.slope) >> SLOPE_BITS.wrapping_sub(FRACTION))
    }

    /// Finds the segment of a position.
    #[cold]
    fn enter(&mut self, position: i32) {
        let (numerator, denominator) = (i64::from(self.pulse.numerator()), i64::from(self.pulse.denominator()));
        // lengths in nm times the denominator: below 2^56
        let start = i64::from(self.table.start.nm()).wrapping_mul(denominator);
        let spacing = i64::from(self.table.spacing).wrapping_mul(denominator);
        let from_start = i64::from(position).wrapping_mul(numerator).wrapping_sub(start);
        let segment = from_start.checked_div_euclid(spacing).unwrap_or(0);
        let last = i64::try_from(self.table.count).unwrap_or(1).wrapping_sub(1);
        let place = |point: i64| start.wrapping_add(spacing.wrapping_mul(point));
        // the first pulse at a place or behind it
        let pulse_at = |place: i64| {
            let pulse = place.wrapping_neg().checked_div_euclid(numerator).unwrap_or(0).wrapping_neg();
            i32::try_from(pulse).unwrap_or(if pulse < 0 { i32::MIN } else { i32::MAX })
        };
        // an error below 2^22 nm, with the denominator and the fraction below 2^54
        let given = |error: i64| {
            let scaled = error.wrapping_mul(denominator).wrapping_shl(FRACTION).wrapping_neg();
            scaled.checked_div_euclid(numerator).unwrap_or(0)
        };
        if segment < 0 || segment >= last {
            let (low, high) =
                if segment < 0 { (i32::MIN, pulse_at(place(0))) } else { (pulse_at(place(last)), i32::MAX) };
            (self.low, self.high, self.slope) = (low, high, 0);
            self.base = given(self.table.error(segment));
            return;
        }
        let (one, next) = (self.table.error(segment), self.table.error(segment.wrapping_add(1)));
        // below 2^23 nm, with the fraction below 2^59; the quotient below 2^35
        let change = one.wrapping_sub(next).wrapping_shl(SLOPE_BITS);
        self.slope = change.checked_div_euclid(i64::from(self.table.spacing)).unwrap_or(0);
        self.low = pulse_at(place(segment));
        self.high = pulse_at(place(segment.wrapping_add(1)));
        // from the point to the first pulse behind it: below a pulse, 16 fraction bits
        let behind = i64::from(self.low).wrapping_mul(numerator).wrapping_sub(place(segment));
        let behind = behind.wrapping_shl(16).checked_div(numerator).unwrap_or(0);
        let more = self.slope.wrapping_mul(behind) >> SLOPE_BITS.wrapping_add(16).wrapping_sub(FRACTION);
        self.base = given(one).wrapping_add(more);
    }
}
