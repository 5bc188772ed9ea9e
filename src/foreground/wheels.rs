//! The handwheels: what a detent is worth, and what was dropped.

use super::inputs::PerAxis;
use interp_core::drive::wheel::Click;

/// What detents are worth and what became of them.
#[derive(Copy, Clone, Debug)]
pub(super) struct Wheels {
    /// What a detent is worth; `None` for as much as it is turned fast.
    scale: Option<Click>,
    /// Counts a tick of each wheel, smoothed, with [`RATE_BITS`] fraction bits.
    rates: PerAxis<u32>,
    /// Counts that were dropped so far.
    pub(super) dropped: PerAxis<i32>,
    /// Those of the contour wheel.
    pub(super) dropped_contour: i32,
}

/// Ticks that a wheel's rate is smoothed over, as a shift.
const SMOOTH: u32 = 5;

/// Fraction bits of a wheel's rate.
const RATE_BITS: u32 = 16;

const CLICKS: [Click; 3] = Click::DECADES;

impl Wheels {
    pub(super) const fn new() -> Self {
        let none = PerAxis { x: 0, z: 0 };
        Self { scale: Some(CLICKS[1]), rates: PerAxis { x: 0, z: 0 }, dropped: none, dropped_contour: 0 }
    }

    pub(super) const fn set_scale(&mut self, scale: Option<Click>) {
        self.scale = scale;
    }

    /// What a detent of the contour wheel is worth.
    pub(super) const fn contour(&self) -> Click {
        match self.scale {
            Some(click) => click,
            None => CLICKS[1],
        }
    }

    /// Takes a tick's counts: what a detent of this wheel is worth now, by how fast it was turned until then.
    pub(super) fn click(&mut self, axis: interp_core::units::Axis, counts: i16) -> Click {
        let rate = self.rates.of_mut(axis);
        let before = *rate;
        let now = u32::from(counts.unsigned_abs()) << RATE_BITS;
        *rate = before.saturating_sub((before >> SMOOTH).max(1)).wrapping_add(now >> SMOOTH);
        self.scale.unwrap_or_else(|| by_speed(before >> (RATE_BITS - 8)))
    }

    /// Whether both wheels have stood for so long that their rates are none.
    pub(super) const fn rest(&self) -> bool {
        self.rates.x == 0 && self.rates.z == 0
    }

    /// Notes counts that were dropped.
    pub(super) const fn drop(&mut self, axis: interp_core::units::Axis, counts: i32) {
        let dropped = self.dropped.of_mut(axis);
        *dropped = dropped.saturating_add(counts);
    }
}

/// Velocity-scaled: 1 um a detent where the wheel creeps, growing with the square of its speed to 100 um at 50 detents a second.
///
/// * `rate`: counts a tick with 8 fraction bits.
fn by_speed(rate: u32) -> Click {
    // 50 detents a second are 0.2 counts a tick: a rate of 51
    let square = rate.saturating_mul(rate).min(51 * 51);
    let nm = square.saturating_mul(99_000).checked_div(51 * 51).unwrap_or(0).saturating_add(1_000);
    // a multiple of 4 nm: a count is a whole number of nm
    Click::from_nm(nm & !3).unwrap_or(CLICKS[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use interp_core::units::Axis;

    #[test]
    fn a_wheel_that_is_turned_fast_goes_further_a_detent() {
        let mut wheels = Wheels::new();
        wheels.set_scale(None);
        assert_eq!(wheels.click(Axis::X, 0), CLICKS[0]);
        let mut last = 0;
        // a count every 50 ticks, 5 detents a second: hardly more than 1 um
        for ticks in 0..1_000 {
            let counts = i16::from(ticks % 50 == 0);
            let click = wheels.click(Axis::X, counts);
            if counts > 0 {
                last = click.length();
            }
        }
        assert!((1_000 << 12..1_500 << 12).contains(&last), "{}", last >> 12);
        for ticks in 0..400 {
            // a count every five ticks: 50 detents a second
            let click = wheels.click(Axis::X, i16::from(ticks % 5 == 0));
            last = click.length();
        }
        assert!((70_000 << 12..=100_000 << 12).contains(&last), "{}", last >> 12);
    }
}
