//! Ring distribution: the windings of a stepping motor that is driven directly, as an output stage behind the train.
//!
//! A motor of m phases has a ring of 2 m beats, which alternate between w and w + 1 windings in a row:
//!
//! | motor | ring forward |
//! | --- | --- |
//! | 3 phases, 6 beats | A, AB, B, BC, C, CA |
//! | 4 phases, 8 beats | A, AB, B, BC, C, CD, D, DA |
//! | 5 phases, 10 beats | AB, ABC, BC, BCD, CD, CDE, DE, DEA, EA, EAB |
//!
//! So beat k has the w (odd beats: w + 1) windings from number `k / 2` on, with w = 1, 1, 2. A pulse forward goes to the
//! next beat, one backward to the one before. A pattern that is no beat, as a disturbance or power-up may leave it, is
//! taken for the beat that differs in the fewest windings, the first of them: the ring is left for one pulse at most.
//!
//! [`RingOutput`] plays a pulse train's events to the windings of X and Z: a rising edge of a step pin is a pulse.
//!
//! Source: handbooks of punched-tape control (ring distributors).

use crate::train::{Event, Levels};
use crate::units::Axis;

/// Which motor.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Ring {
    /// 3 phases, 6 beats.
    ThreePhase,
    /// 4 phases, 8 beats.
    FourPhase,
    /// 5 phases, 10 beats.
    FivePhase,
}

impl Ring {
    /// Windings.
    pub const fn phases(self) -> u8 {
        match self {
            Self::ThreePhase => 3,
            Self::FourPhase => 4,
            Self::FivePhase => 5,
        }
    }

    /// Beats of the ring.
    pub const fn beats(self) -> u8 {
        self.phases().wrapping_mul(2)
    }

    /// Windings that are on in a beat (taken modulo their number), A in bit 0.
    ///
    /// ```
    /// # use interp_core::ring::Ring;
    /// assert_eq!(Ring::ThreePhase.windings(5), 0b101); // CA
    /// assert_eq!(Ring::FivePhase.windings(1), 0b00111); // ABC
    /// ```
    pub const fn windings(self, beat: u8) -> u8 {
        let phases = self.phases() as u32;
        let few = match self {
            Self::ThreePhase | Self::FourPhase => 0b1_u32,
            Self::FivePhase => 0b11,
        };
        let Some(beat) = beat.checked_rem(self.beats()) else { return 0 };
        let some = if beat & 1 == 1 { few << 1 | 1 } else { few };
        let turned = some.wrapping_shl(beat as u32 >> 1);
        let mask = 1_u32.wrapping_shl(phases).wrapping_sub(1);
        #[expect(clippy::cast_possible_truncation, reason = "at most five bits")]
        let windings = ((turned | turned.wrapping_shr(phases)) & mask) as u8;
        windings
    }

    /// The beat of a pattern of windings: where it is none, the first of those that differ least.
    pub const fn nearest(self, windings: u8) -> u8 {
        let (mut best, mut least, mut beat) = (0, u32::MAX, 0);
        let mask = 1_u8.wrapping_shl(self.phases() as u32).wrapping_sub(1);
        while beat < self.beats() {
            let off = ((self.windings(beat) ^ windings) & mask).count_ones();
            if off < least {
                (best, least) = (beat, off);
            }
            beat = beat.wrapping_add(1);
        }
        best
    }
}

/// One motor's place in its ring.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Distributor {
    ring: Ring,
    beat: u8,
}

impl Distributor {
    /// With these windings on, or the beat nearest to them.
    pub const fn new(ring: Ring, windings: u8) -> Self {
        Self { ring, beat: ring.nearest(windings) }
    }

    /// One pulse; the windings after it.
    pub const fn pulse(&mut self, plus: bool) -> u8 {
        let last = self.ring.beats().wrapping_sub(1);
        self.beat = if plus {
            if self.beat >= last { 0 } else { self.beat.wrapping_add(1) }
        } else if self.beat == 0 {
            last
        } else {
            self.beat.wrapping_sub(1)
        };
        self.windings()
    }

    /// The windings that are on, A in bit 0.
    pub const fn windings(&self) -> u8 {
        self.ring.windings(self.beat)
    }
}

/// Plays events to the windings of two motors.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct RingOutput {
    x: Distributor,
    z: Distributor,
    levels: Levels,
}

impl RingOutput {
    /// Two motors that stand, their step pins low.
    pub const fn new(x: Distributor, z: Distributor) -> Self {
        Self { x, z, levels: Levels::LOW }
    }

    /// The windings of X and of Z from this event on.
    pub fn play(&mut self, event: Event) -> (u8, u8) {
        let levels = event.levels();
        let rises = |axis| levels.step(axis) && !self.levels.step(axis);
        if rises(Axis::X) {
            self.x.pulse(levels.plus(Axis::X));
        }
        if rises(Axis::Z) {
            self.z.pulse(levels.plus(Axis::Z));
        }
        self.levels = levels;
        (self.x.windings(), self.z.windings())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RINGS: [(Ring, &[&str]); 3] = [
        (Ring::ThreePhase, &["A", "AB", "B", "BC", "C", "CA"]),
        (Ring::FourPhase, &["A", "AB", "B", "BC", "C", "CD", "D", "DA"]),
        (Ring::FivePhase, &["AB", "ABC", "BC", "BCD", "CD", "CDE", "DE", "DEA", "EA", "EAB"]),
    ];

    fn bits(names: &str) -> u8 {
        names.bytes().map(|name| 1 << (name - b'A')).sum()
    }

    #[test]
    fn the_rings_are_those_of_the_handbook_from_every_beat_in_both_directions() {
        for (ring, names) in RINGS {
            let count = names.len();
            assert_eq!(usize::from(ring.beats()), count);
            for (k, name) in names.iter().enumerate() {
                let start = Distributor::new(ring, bits(name));
                assert_eq!(start.windings(), bits(name));
                let (mut up, mut down) = (start, start);
                for turn in 1..=2 * count {
                    assert_eq!(up.pulse(true), bits(names[(k + turn) % count]));
                    assert_eq!(down.pulse(false), bits(names[(k + 2 * count - turn) % count]));
                }
                assert_eq!((up, down), (start, start), "whole turns lead back");
            }
        }
    }

    #[test]
    fn one_winding_changes_with_each_pulse() {
        for (ring, _) in RINGS {
            for beat in 0..ring.beats() {
                assert_eq!((ring.windings(beat) ^ ring.windings(beat + 1)).count_ones(), 1);
            }
        }
    }

    #[test]
    fn any_pattern_of_windings_leads_into_the_ring() {
        for (ring, names) in RINGS {
            for pattern in 0..1_u8 << ring.phases() {
                let found = Distributor::new(ring, pattern).windings();
                assert!(names.iter().any(|name| bits(name) == found), "{ring:?} {pattern:b}");
                let off = |name: &&str| (bits(name) ^ pattern).count_ones();
                let least = names.iter().map(off).min();
                assert_eq!(Some((found ^ pattern).count_ones()), least);
            }
        }
    }

    #[test]
    fn edges_of_the_train_turn_the_motors() {
        let high = |axis, plus| Levels::LOW.with_step(axis, true).with_plus(axis, plus);
        let (x, z) = (Distributor::new(Ring::FourPhase, 1), Distributor::new(Ring::ThreePhase, 1));
        let mut output = RingOutput::new(x, z);
        let mut play = |levels| output.play(Event::new(levels, 100));
        assert_eq!(play(high(Axis::X, true)), (0b11, 1));
        assert_eq!(play(high(Axis::X, true)), (0b11, 1), "held high");
        assert_eq!(play(Levels::LOW), (0b11, 1), "a fall is no pulse");
        assert_eq!(play(high(Axis::Z, false)), (0b11, 0b101));
    }
}
