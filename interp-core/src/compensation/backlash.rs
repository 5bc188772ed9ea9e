//! Backlash: the play of screw and nut, taken up over a distance of travel.
//!
//! After travel in plus the slide stands where the nut is; after travel in minus the motor has to stand lower by the
//! play. Between the two the amount goes with the travel since the reversal: a *take-up* of 0 (minus) to the distance
//! (plus) follows the motion pulse by pulse and stops at both ends. A reversal inside the ramp goes back the way it
//! came, and however often the motion turns, the amount depends on the take-up alone.
//!
//! Until the play is taken up the slide stands: with the play `b` and the distance `d` over `b d / (b + d)` of travel.
//! So a short distance is exact and a long one gentle.

/// The backlash of one axis.
#[derive(Clone, Debug)]
pub struct Backlash {
    /// Pulses with [`FRACTION`](super::FRACTION) fraction bits.
    play: i64,
    /// Of the play, a pulse of travel.
    slope: i64,
    /// Pulses, at least 1.
    distance: i32,
    /// 0 after travel in minus, the distance after travel in plus.
    taken: i32,
}

impl Backlash {
    /// A slide that came in plus. `play` in pulses with [`FRACTION`](super::FRACTION) fraction bits, taken up over
    /// `distance` pulses (at least 1) of travel.
    pub const fn new(play: i64, distance: i32) -> Self {
        let distance = if distance < 1 { 1 } else { distance };
        let slope = match play.checked_div(distance as i64) {
            Some(slope) => slope,
            None => play,
        };
        Self { play, slope, distance, taken: distance }
    }

    /// Other figures; the slide stays on the side of the play that it is on.
    pub const fn configure(&mut self, play: i64, distance: i32) {
        let minus = self.taken <= self.distance / 2;
        *self = Self::new(play, distance);
        if minus {
            self.taken = 0;
        }
    }

    /// The program has moved by so many pulses.
    pub fn moved(&mut self, pulses: i32) {
        self.taken = self.taken.saturating_add(pulses).max(0).min(self.distance);
    }

    /// How far the motor has to go beyond the program: 0 after travel in plus, minus the play after travel in minus.
    ///
    /// ```
    /// # use interp_core::compensation::{PULSE, backlash::Backlash};
    /// let mut backlash = Backlash::new(20 * PULSE, 4);
    /// let mut along = |pulses| {
    ///     backlash.moved(pulses);
    ///     backlash.amount() / PULSE
    /// };
    /// assert_eq!([along(9), along(-1), along(-2), along(1), along(-9), along(3), along(9)], [0, -5, -15, -10, -20, -5, 0]);
    /// ```
    pub fn amount(&self) -> i64 {
        if self.taken == 0 {
            return self.play.wrapping_neg();
        }
        // at most the play: no overflow
        self.slope.wrapping_mul(i64::from(self.taken.wrapping_sub(self.distance)))
    }
}
