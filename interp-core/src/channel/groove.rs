//! A groove that a thread has to meet: one that is there already, or the first one cut by hand.
//!
//! A thread begins at the index by itself. With a groove it begins so that its path, were it extended, would be at the groove's
//! place when the spindle is at the groove's angle; wherever it begins, and whatever its lead.

use super::Channel;
use super::Memory;
use crate::block::Motion;
use crate::drive::gearing::Lead;
use crate::drive::spindle::{ANGLE_BITS, Spindle};
use crate::math::Wide;
use crate::units::PulseSize;
use core::borrow::BorrowMut;

/// A groove.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Groove {
    /// Place of the carriage, the program's pulses.
    pub z: i32,
    /// The spindle's angle behind the index there, 2^-16 of a turn.
    pub angle: u16,
}

impl Groove {
    /// Angle behind the index at which a motion that begins at `z` has to begin, 2^-16 of a turn, with its lead along the path.
    pub(super) fn at(self, z: i32, pulse: PulseSize, motion: &Motion, lead: Lead) -> u16 {
        let (_, dz) = motion.curve.end();
        let nm = |pulses: i32| {
            let nm = i128::from(pulses).wrapping_mul(i128::from(pulse.numerator()) << 12);
            nm.over(i128::from(pulse.denominator())).unwrap_or(0)
        };
        let off = nm(z.wrapping_sub(self.z)).wrapping_mul(i128::from(dz.signum()));
        // along the path: Z is |dz| of its length
        let path = off.times(i128::from(motion.length)).over(nm(dz).wrapping_abs()).unwrap_or(0);
        let (numerator, denominator) = lead.ratio();
        let turns = path.wrapping_mul(i128::from(denominator) << 16);
        let turns = turns.quotient((i128::from(numerator) << 12).max(1)).unwrap_or(0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a part of a turn")]
        let part = turns as u16;
        self.angle.wrapping_add(part)
    }
}

impl<const N: usize, M: BorrowMut<Memory<N>>> Channel<N, M> {
    /// Threads meet this groove from now on; `None` for the index alone.
    pub const fn set_groove(&mut self, groove: Option<Groove>) {
        self.crank.groove = groove;
    }

    /// The groove that threads meet.
    pub const fn groove(&self) -> Option<Groove> {
        self.crank.groove
    }

    /// The spindle's angle behind the index, 2^-16 of a turn, once the index was seen.
    pub fn spindle_phase(&self) -> Option<u16> {
        let spindle: &Spindle = self.crank.spindle.as_ref()?;
        let off = spindle.angle().wrapping_sub(spindle.zero()?);
        let turn = i64::from(spindle.turn()) << ANGLE_BITS;
        let part = i128::from(off.checked_rem_euclid(turn)?) << 16;
        u16::try_from(part.over(i128::from(turn))?).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::block::{Builder, Pace, Path};
    use crate::config::{AxisConfig, Config};
    use crate::units::{Feedrate, Length, Point};

    fn motion(dx: i64, dz: i64, lead: Lead) -> (Motion, Lead) {
        let axis = |pulse| AxisConfig {
            pulse: PulseSize::new(pulse, 1).unwrap(),
            max_feed: Feedrate::from_nm_per_min(5_000_000_000).unwrap(),
            max_accel: 500_000,
            max_jump: 2_000,
            pulse_width_ns: 5_000,
            dir_setup_ns: 5_000,
            dir_hold_ns: 5_000,
            min_space_ns: 5_000,
        };
        let machine = Config { x: axis(1250), z: axis(2500), event_min_ns: 2_000 }.check().unwrap();
        let end = Point { x: Length::from_nm(dx).unwrap(), z: Length::from_nm(dz).unwrap() };
        let built = Builder::new(&machine, Point::default()).motion(Path::Line, end, Pace::Thread { lead, start: 0 });
        let motion = built.motions[0];
        let crate::block::Feed::Thread(lead, _) = motion.feed else { panic!("no thread") };
        (motion, lead)
    }

    #[test]
    fn a_start_that_is_off_by_leads_is_off_by_turns() {
        let pulse = PulseSize::new(2500, 1).unwrap();
        let lead = Lead::new(1_500_000, 1).unwrap();
        let groove = Groove { z: 100, angle: 1_000 };
        for (dz, sense) in [(-20_000_000, -1), (20_000_000, 1)] {
            let (motion, lead) = motion(0, dz, lead);
            // 600 pulses are a lead; a quarter of one along the path is a quarter of a turn later
            for (by, turn) in [(0, 0), (600, 0), (-1200, 0), (150, 16_384), (450, 49_152), (-150, 49_152)] {
                let at = groove.at(100 + sense * by, pulse, &motion, lead);
                assert!(at.wrapping_sub(1_000 + turn).min((1_000 + turn).wrapping_sub(at)) <= 1, "{dz} {by}: {at}");
            }
        }
        // a taper has its lead along Z
        let (motion, lead) = motion(5_000_000, -20_000_000, lead);
        let at = groove.at(100 - 150, pulse, &motion, lead);
        assert!(at.abs_diff(1_000 + 16_384) <= 2, "{at}");
    }
}
