//! Keeps what outlives a loss of power in backup memory: twenty words, as many as every STM32F4 has (RTC_BKP0R to
//! RTC_BKP19R).
//!
//! | words | what |
//! | --- | --- |
//! | 0 to 5 | offsets kept, wear booked, datum: they change at rest only |
//! | 6 | their check |
//! | 7 to 11 | programmed place, offset, and line with a count of writes in the uppermost byte |
//! | 12 | their check |
//! | 13 to 18 | the same once more; the two are written in turns |
//!
//! Power may go between any two words. A check covers the words before it, the sizes of a pulse (places in pulses of
//! another size are none), and, for what moves, the check of what stands. So whatever is read back was true as a whole at
//! some time, and where the words of two writes are mixed nothing is read.

use interp_core::config::Machine;
use interp_core::units::{Lattice, PulseSize};

use crate::foreground::inputs::PerAxis;
use crate::foreground::kept::Kept;

/// Words of backup memory.
pub const WORDS: usize = 20;

const STANDING: usize = 6;
const MOVING: usize = 5;
/// Where the two records of what moves begin.
const PLACES: [usize; 2] = [7, 13];
/// Lines above have no room beside the count of writes, and are not kept.
const LINES: u32 = 0x00FF_FFFF;

/// Memory that outlives a loss of power, word by word.
pub trait Backup {
    /// All words.
    fn read(&self) -> [u32; WORDS];

    /// Writes words from `first` on, in order.
    fn write(&mut self, first: usize, words: &[u32]);
}

/// What stands in the memory, and what comes next.
#[derive(Clone, Debug)]
pub struct Keeper {
    /// Of the sizes of a pulse.
    seed: u32,
    standing: Option<[u32; STANDING]>,
    /// What moves as written last, without the count.
    moving: Option<[u32; MOVING]>,
    writes: u8,
}

impl Keeper {
    /// A keeper for `machine`, and what it finds; `None` where the memory was without power, or its last write did not end.
    pub fn new(machine: &Machine, memory: &impl Backup) -> (Self, Option<Kept>) {
        let pulse = PerAxis { x: machine.x.pulse, z: machine.z.pulse };
        let mut keeper = Self { seed: seed(pulse), standing: None, moving: None, writes: 0 };
        let found = keeper.find(&memory.read(), pulse);
        (keeper, found)
    }

    /// Keeps it; writes only what has changed.
    pub fn keep(&mut self, kept: &Kept, memory: &mut impl Backup) {
        let (standing, moving) = words(kept);
        if self.seed != seed(kept.pulse) {
            (self.seed, self.standing) = (seed(kept.pulse), None);
        }
        let sum = check(self.seed, &standing);
        if self.standing != Some(standing) {
            // neither record of what moves goes with it; one that is left could count as the newest if it came back
            for first in PLACES {
                memory.write(first.wrapping_add(MOVING), &[0]);
            }
            let [a, b, c, d, e, f] = standing;
            memory.write(0, &[a, b, c, d, e, f, sum]);
            (self.standing, self.moving) = (Some(standing), None);
        }
        if self.moving != Some(moving) {
            self.moving = Some(moving);
            self.writes = self.writes.wrapping_add(1);
            let [px, pz, ox, oz, line] = moving;
            let counted = [px, pz, ox, oz, line | u32::from(self.writes).wrapping_shl(24)];
            let [px, pz, ox, oz, line] = counted;
            let [even, odd] = PLACES;
            let first = if self.writes & 1 == 0 { even } else { odd };
            memory.write(first, &[px, pz, ox, oz, line, check(sum, &counted)]);
        }
    }

    fn find(&mut self, memory: &[u32; WORDS], pulse: PerAxis<PulseSize>) -> Option<Kept> {
        let standing: [u32; STANDING] = part(memory, 0)?;
        let sum = check(self.seed, &standing);
        if memory.get(STANDING) != Some(&sum) {
            return None;
        }
        let record = |first: usize| {
            let counted: [u32; MOVING] = part(memory, first)?;
            (memory.get(first.wrapping_add(MOVING)) == Some(&check(sum, &counted))).then_some(counted)
        };
        let [even, odd] = PLACES.map(record);
        let [px, pz, ox, oz, line] = match (even, odd) {
            (Some(even), Some(odd)) => {
                // the count goes round: the later one is less than half a round ahead
                let ahead = count(even).wrapping_sub(count(odd));
                if ahead < 0x80 { even } else { odd }
            }
            (one, other) => one.or(other)?,
        };
        self.writes = count([px, pz, ox, oz, line]);
        let moving = [px, pz, ox, oz, line & LINES];
        (self.standing, self.moving) = (Some(standing), Some(moving));
        Some(kept(pulse, standing, moving))
    }
}

/// Which write it was.
const fn count([.., line]: [u32; MOVING]) -> u8 {
    let [.., top] = line.to_le_bytes();
    top
}

const fn words(kept: &Kept) -> ([u32; STANDING], [u32; MOVING]) {
    let Kept { programmed, offset, kept, wear, datum, line, .. } = *kept;
    let line = if line > LINES { 0 } else { line };
    let [px, pz, ox, oz] = [programmed.x, programmed.z, offset.x, offset.z];
    let standing = [kept.x, kept.z, wear.x, wear.z, datum.x, datum.z];
    let [a, b, c, d, e, f] = standing;
    let standing = [
        a.cast_unsigned(),
        b.cast_unsigned(),
        c.cast_unsigned(),
        d.cast_unsigned(),
        e.cast_unsigned(),
        f.cast_unsigned(),
    ];
    (standing, [px.cast_unsigned(), pz.cast_unsigned(), ox.cast_unsigned(), oz.cast_unsigned(), line])
}

const fn kept(
    pulse: PerAxis<PulseSize>,
    [kx, kz, wx, wz, dx, dz]: [u32; STANDING],
    [px, pz, ox, oz, line]: [u32; MOVING],
) -> Kept {
    const fn at(x: u32, z: u32) -> Lattice {
        Lattice { x: x.cast_signed(), z: z.cast_signed() }
    }
    Kept {
        pulse,
        programmed: at(px, pz),
        offset: at(ox, oz),
        kept: at(kx, kz),
        wear: at(wx, wz),
        datum: at(dx, dz),
        line,
    }
}

/// Where checks begin: places in pulses of another size are none.
fn seed(pulse: PerAxis<PulseSize>) -> u32 {
    check(OFFSET_BASIS, [pulse.x, pulse.z].map(|pulse| [pulse.numerator(), pulse.denominator()]).as_flattened())
}

/// `N` words from `first` on.
fn part<const N: usize>(memory: &[u32; WORDS], first: usize) -> Option<[u32; N]> {
    memory.get(first..)?.first_chunk().copied()
}

const OFFSET_BASIS: u32 = 0x811C_9DC5;

/// FNV-1a over the words' bytes, from another one's end (Fowler, Noll, Vo; draft-eastlake-fnv).
fn check(seed: u32, words: &[u32]) -> u32 {
    let bytes = words.iter().flat_map(|word| word.to_le_bytes());
    bytes.fold(seed, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Memory that loses power after so many words.
    #[derive(Clone)]
    struct Memory {
        words: [u32; WORDS],
        left: usize,
    }

    impl Memory {
        const fn new(words: [u32; WORDS]) -> Self {
            Self { words, left: usize::MAX }
        }
    }

    impl Backup for Memory {
        fn read(&self) -> [u32; WORDS] {
            self.words
        }

        fn write(&mut self, first: usize, words: &[u32]) {
            for (place, word) in self.words[first..].iter_mut().zip(words) {
                if self.left > 0 {
                    *place = *word;
                    self.left -= 1;
                }
            }
        }
    }

    fn machine() -> Machine {
        crate::background::parameters::Parameters::new().machine().unwrap()
    }

    fn nothing() -> Kept {
        let (zero, machine) = (Lattice::default(), machine());
        let pulse = PerAxis { x: machine.x.pulse, z: machine.z.pulse };
        Kept { pulse, programmed: zero, offset: zero, kept: zero, wear: zero, datum: zero, line: 0 }
    }

    fn anything() -> impl Strategy<Value = Kept> {
        // few values, so that some stay the same
        let pair = || (-2..2, -2..2).prop_map(|(x, z)| Lattice { x, z });
        (pair(), pair(), pair(), pair(), pair(), 0..3_u32).prop_map(|(programmed, offset, kept, wear, datum, line)| {
            Kept { programmed, offset, kept, wear, datum, line, ..nothing() }
        })
    }

    #[test]
    fn memory_without_a_record_has_none() {
        for word in [0, u32::MAX, 0xA5A5_A5A5] {
            assert_eq!(Keeper::new(&machine(), &Memory::new([word; WORDS])).1, None);
        }
    }

    #[test]
    fn places_in_pulses_of_another_size_are_none() {
        let mut memory = Memory::new([0; WORDS]);
        Keeper::new(&machine(), &memory).0.keep(&nothing(), &mut memory);
        assert_eq!(Keeper::new(&machine(), &memory).1, Some(nothing()));
        let mut other = machine();
        other.z.pulse = PulseSize::new(1_000, 1).unwrap();
        let (mut keeper, found) = Keeper::new(&other, &memory);
        assert_eq!(found, None);
        // the size is set anew while the machine is on
        keeper.keep(&nothing(), &mut memory);
        assert_eq!(Keeper::new(&machine(), &memory).1, Some(nothing()));
    }

    #[test]
    fn the_line_has_three_bytes() {
        for (line, back) in [(0xFF_FFFF, 0xFF_FFFF), (0x100_0000, 0), (u32::MAX, 0)] {
            let mut memory = Memory::new([0; WORDS]);
            Keeper::new(&machine(), &memory).0.keep(&Kept { line, ..nothing() }, &mut memory);
            assert_eq!(Keeper::new(&machine(), &memory).1.unwrap().line, back);
        }
    }

    #[test]
    fn the_count_of_writes_goes_round() {
        let mut memory = Memory::new([0; WORDS]);
        let mut keeper = Keeper::new(&machine(), &memory).0;
        for line in 1..1_000 {
            let kept = Kept { line, ..nothing() };
            keeper.keep(&kept, &mut memory);
            let (again, found) = Keeper::new(&machine(), &memory);
            assert_eq!(found, Some(kept));
            keeper = if line % 3 == 0 { again } else { keeper };
        }
    }

    #[test]
    fn what_has_not_changed_is_not_written() {
        let mut memory = Memory::new([0; WORDS]);
        let mut keeper = Keeper::new(&machine(), &memory).0;
        keeper.keep(&nothing(), &mut memory);
        memory.left = 0;
        let before = memory.words;
        keeper.keep(&nothing(), &mut memory);
        assert_eq!(memory.words, before);
        memory.left = usize::MAX;
        keeper.keep(&Kept { line: 7, ..nothing() }, &mut memory);
        let changed = before.iter().zip(&memory.words).filter(|(before, after)| before != after).count();
        assert!(changed <= 6, "{changed} words for what moves");
    }

    proptest! {
        /// Power goes after any word: what is found is what was kept last or before it, or, where what stands was being
        /// written, an earlier one (two writes in a row that were cut short may bring it back) or nothing. A keeper that finds
        /// it goes on.
        #[test]
        fn whenever_the_power_goes_what_is_found_was_true(
            history in prop::collection::vec((anything(), 0..20_usize), 1..12), noise in any::<[u32; WORDS]>(),
        ) {
            let mut memory = Memory::new(noise);
            let (mut keeper, mut known) = Keeper::new(&machine(), &memory);
            prop_assert_eq!(known, None);
            let mut earlier = heapless::Vec::<Kept, 12>::new();
            for (kept, left) in history {
                memory.left = left;
                keeper.keep(&kept, &mut memory);
                let (after, found) = Keeper::new(&machine(), &memory);
                let stands = known.is_some_and(|known| (known.kept, known.wear, known.datum) == (kept.kept, kept.wear, kept.datum));
                if left >= 15 {
                    prop_assert_eq!(found, Some(kept));
                } else if stands {
                    prop_assert!(found == Some(kept) || found == known, "{found:?}");
                } else {
                    prop_assert!(found.is_none_or(|found| found == kept || earlier.contains(&found)), "{found:?}");
                }
                memory.left = usize::MAX;
                earlier.push(kept).unwrap();
                (keeper, known) = (after, found);
            }
        }
    }
}
