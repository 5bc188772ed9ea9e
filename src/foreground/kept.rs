//! What outlives a loss of power: where the axes were, what had been added to them, and where a program was.
//!
//! The background keeps it (in backup memory, which needs no erase); whoever starts again has it back, with the position
//! unverified: nobody knows what the slides did meanwhile.

use core::sync::atomic::Ordering::Relaxed;

use interp_core::units::{Lattice, PulseSize};

use super::desk::part;
use super::inputs::AXES;
use super::published::Published;
use super::{Foreground, PerAxis};

/// Ticks between two records that the foreground publishes.
const EVERY: u8 = 8;

/// What is kept.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Kept {
    /// What the places are counted in.
    pub pulse: PerAxis<PulseSize>,
    /// Where the program was, pulses.
    pub programmed: Lattice,
    /// What the handwheels had added.
    pub offset: Lattice,
    /// Offsets kept, and wear booked.
    pub kept: Lattice,
    /// See `kept`.
    pub wear: Lattice,
    /// From the program's coordinates to the machine's.
    pub datum: Lattice,
    /// Line of the block in which a program was interrupted, 0 for none.
    pub line: u32,
}

impl Foreground<'_> {
    /// What is to be kept now.
    pub fn kept(&self) -> Kept {
        let desk = &self.desk;
        // under machine lock the axes stand where they stood before it
        let (programmed, offset, kept, wear, datum) = match &desk.locked {
            Some(locked) => (locked.position, locked.offset, locked.kept, locked.wear, locked.datum),
            None => (self.channel.position(), self.channel.offset(), desk.kept, desk.wear, desk.datum),
        };
        Kept {
            pulse: PerAxis { x: desk.machine.x.pulse, z: desk.machine.z.pulse },
            programmed,
            offset,
            kept,
            wear,
            datum,
            line: if self.situation().in_cycle() { self.channel.line() } else { desk.interrupted },
        }
    }

    /// Goes on from what was kept, before the first tick.
    pub fn restore(&mut self, kept: &Kept) {
        self.attended = true;
        self.channel.set_position(kept.programmed);
        self.channel.set_offset(kept.offset);
        let desk = &mut self.desk;
        (desk.kept, desk.wear, desk.datum, desk.interrupted) = (kept.kept, kept.wear, kept.datum, kept.line);
        desk.verified = PerAxis { x: false, z: false };
        for axis in AXES {
            self.channel.stand_at(axis, part(self.place(), axis));
        }
        self.set_limits();
    }
}

/// The foreground's record for the background, published now and then: in motion nobody knows the place to less than the
/// time that the slides take to stop, and at rest the next one comes soon.
#[derive(Debug, Default)]
pub struct Record(Published<15>);

impl Record {
    /// Of nothing.
    pub const fn new() -> Self {
        Self(Published::new())
    }

    /// Publishes what is to be kept, once in a few calls that `since` counts. From the interpolator only, once a tick.
    #[inline]
    pub fn publish(&self, since: &mut u8, foreground: &Foreground<'_>) {
        *since = since.wrapping_add(1);
        if *since >= EVERY {
            *since = 0;
            self.write(&foreground.kept());
        }
    }

    #[inline(never)]
    fn write(&self, kept: &Kept) {
        let Kept { pulse, programmed, offset, kept, wear, datum, line } = *kept;
        let places = [programmed, offset, kept, wear, datum].map(|at| [at.x.cast_unsigned(), at.z.cast_unsigned()]);
        let sizes = [pulse.x, pulse.z].map(|pulse| [pulse.numerator(), pulse.denominator()]);
        let words = places.as_flattened().iter().chain(sizes.as_flattened()).chain([&line]);
        self.0.publish(|published| published.iter().zip(words).for_each(|(place, word)| place.store(*word, Relaxed)));
    }

    /// What was published last; `None` before the first time.
    pub fn read(&self) -> Option<Kept> {
        let [px, pz, ox, oz, kx, kz, wx, wz, dx, dz, xn, xd, zn, zd, line] = self.0.read();
        let at = |x: u32, z: u32| Lattice { x: x.cast_signed(), z: z.cast_signed() };
        Some(Kept {
            pulse: PerAxis { x: PulseSize::new(xn, xd)?, z: PulseSize::new(zn, zd)? },
            programmed: at(px, pz),
            offset: at(ox, oz),
            kept: at(kx, kz),
            wear: at(wx, wz),
            datum: at(dx, dz),
            line,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_is_read_as_it_was_written() {
        let record = Record::new();
        assert_eq!(record.read(), None);
        let at = |x, z| Lattice { x, z };
        let size = |nm, part| PulseSize::new(nm, part).unwrap();
        let kept = Kept {
            pulse: PerAxis { x: size(1_250, 1), z: size(15_875, 8) },
            programmed: at(1, -2),
            offset: at(-3, 4),
            kept: at(5, -6),
            wear: at(-7, 8),
            datum: at(i32::MIN, i32::MAX),
            line: 11,
        };
        record.write(&kept);
        assert_eq!(record.read(), Some(kept));
    }
}
