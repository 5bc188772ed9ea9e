//! The bookkeeping of a handwheel: what was counted is moved or told as dropped, to the nanometre.
//!
//! Between two moments at which no wheel's axis has anything to do an axis that only its wheel moves has gone by (counts - dropped) clicks. A place is the nearest
//! pulse of an exact one, so two of them may hide half a pulse each; nothing else, however long it goes on.

use interp_core::units::PulseSize;

#[derive(Copy, Clone, Debug)]
struct Base {
    place: i64,
    /// Quarters of a nanometre asked for since.
    asked: i64,
    /// Counts that rounding at a limit may have cost.
    slack: i64,
    /// What was asked for when the books were last found right.
    told: i64,
}

/// The books of one wheel.
#[derive(Clone, Debug)]
pub(super) struct Clicks {
    base: Option<Base>,
    dropped: i32,
}

/// What a tick brought.
#[derive(Copy, Clone, Debug)]
pub(super) struct Turned {
    /// Place in pulses of what the wheel moves.
    pub(super) place: i32,
    /// Counts read, and those dropped so far.
    pub(super) counts: i16,
    pub(super) dropped: i32,
    /// Worth of a detent, nm.
    pub(super) click: i64,
    /// A limit or a bound is in reach.
    pub(super) near: bool,
    /// No wheel has anything to do.
    pub(super) rests: bool,
}

impl Clicks {
    pub(super) const fn new() -> Self {
        Self { base: None, dropped: 0 }
    }

    /// Something else moved the axis, or what was asked for is forgotten.
    pub(super) const fn forget(&mut self) {
        self.base = None;
    }

    /// The axis was stopped on its way: a count that was begun is dropped as a whole.
    pub(super) const fn broken(&mut self) {
        if let Some(base) = &mut self.base {
            base.slack += 1;
        }
    }

    /// A tick. `Some(true)` where the books were found right, and tell something.
    pub(super) fn tick(&mut self, turned: &Turned, pulse: PulseSize) -> Result<bool, String> {
        let place = i64::from(turned.place);
        let lost = turned.dropped.wrapping_sub(self.dropped);
        self.dropped = turned.dropped;
        if let Some(base) = &mut self.base {
            base.asked += (i64::from(turned.counts) - i64::from(lost)) * turned.click;
            base.slack += i64::from(turned.near && lost != 0);
        }
        if !turned.rests {
            return Ok(false);
        }
        let Some(base) = self.base else {
            self.base = Some(Base { place, asked: 0, slack: 0, told: 0 });
            return Ok(false);
        };
        if turned.counts == 0 && base.asked == base.told && place == base.place {
            return Ok(false);
        }
        let (numerator, denominator) = (i128::from(pulse.numerator()), i128::from(pulse.denominator()));
        let off = 4 * i128::from(place - base.place) * numerator - i128::from(base.asked) * denominator;
        let most = 4 * numerator + i128::from(base.slack * turned.click) * denominator;
        if off.abs() > most {
            let nm = off / denominator / 4;
            return Err(format!("the wheel asked for {} nm, the axis went {nm} nm more", base.asked / 4));
        }
        let tells = base.asked != base.told;
        self.base = Some(Base { told: base.asked, ..base });
        Ok(tells)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_count_that_is_lost_is_found() {
        let pulse = PulseSize::new(1_000, 1).unwrap();
        for lost in [0, 8] {
            let mut clicks = Clicks::new();
            let mut found = Vec::new();
            for tick in 0..400 {
                let turning = tick == 100;
                let place = if tick < 100 { 0 } else { 10 - lost };
                let counts = if turning { 40 } else { 0 };
                let turned = Turned { place, counts, dropped: 0, click: 1_000, near: false, rests: true };
                found.push(clicks.tick(&turned, pulse));
            }
            assert_eq!(found.iter().any(Result::is_err), lost > 0);
        }
    }
}
