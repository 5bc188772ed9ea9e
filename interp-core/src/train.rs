//! The pulse train: events of 32 bits that add up to a tick, and their hash.
//!
//! An event is a 16-bit interval in clocks of 12 MHz (low half) and 16 levels of the step port (high half). Its
//! levels are written first, then its interval is waited. Lathe n of four owns the levels 4n to 4n + 3: X step,
//! X direction, Z step, Z direction; a direction is high for plus. The intervals of a tick add up to exactly
//! [`TICK_CLOCKS`](crate::config::TICK_CLOCKS), so the train is the clock and nothing drifts.

use crate::curve::Step;
use crate::units::Axis;

/// Levels of the step port.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Levels(u16);

impl Levels {
    /// All low.
    pub const LOW: Self = Self(0);

    /// Bits of one lathe: 0 to 3, X step, X direction, Z step, Z direction.
    pub const fn from_bits(bits: u16) -> Self {
        Self(bits)
    }

    /// The levels as they are written to the port.
    pub const fn bits(self) -> u16 {
        self.0
    }

    const fn step_mask(axis: Axis) -> u16 {
        match axis {
            Axis::X => 1,
            Axis::Z => 4,
        }
    }

    /// Whether the step pin is high.
    pub const fn step(self, axis: Axis) -> bool {
        self.0 & Self::step_mask(axis) != 0
    }

    /// Whether the direction pin says plus.
    pub const fn plus(self, axis: Axis) -> bool {
        self.0 & (Self::step_mask(axis) << 1) != 0
    }

    /// With the step pin high or low.
    #[must_use]
    pub const fn with_step(self, axis: Axis, high: bool) -> Self {
        let mask = Self::step_mask(axis);
        Self(if high { self.0 | mask } else { self.0 & !mask })
    }

    /// With the direction pin high for plus.
    #[must_use]
    pub const fn with_plus(self, axis: Axis, plus: bool) -> Self {
        let mask = Self::step_mask(axis) << 1;
        Self(if plus { self.0 | mask } else { self.0 & !mask })
    }
}

/// One event of the train.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Event(u32);

impl Event {
    /// Levels to write, then clocks to wait (cut off past 65 535).
    pub const fn new(levels: Levels, interval: u32) -> Self {
        Self((levels.bits() as u32) << 16 | interval & 0xFFFF)
    }

    /// An event as it is stored.
    pub const fn from_word(word: u32) -> Self {
        Self(word)
    }

    /// The event as it is stored: interval in the low half, levels in the high half.
    pub const fn word(self) -> u32 {
        self.0
    }

    /// Clocks to wait after the levels are written.
    pub const fn interval(self) -> u32 {
        self.0 & 0xFFFF
    }

    /// Levels to write.
    pub const fn levels(self) -> Levels {
        Levels((self.0 >> 16) as u16)
    }
}

/// Takes the events of a train, one after the other. Every closure that takes an event does.
pub trait Train {
    /// Takes the next event.
    fn put(&mut self, event: Event);

    /// A pulse of a row with no clocks yet, its pins raised: what a queue marks such a pulse with is in it.
    #[inline(always)]
    fn pulse(raised: Levels) -> Event {
        Event::new(raised, 0)
    }

    /// Takes a row of `pulses` pulses: `next` gives for each its [`pulse`](Self::pulse) with the clocks to the next one's
    /// rise, below 2^15; its pins fall to `low` after `width` clocks, and nothing else happens meanwhile. The last one is
    /// taken up to its fall only: when the next event comes is not known yet, and its clocks mean nothing. A queue may
    /// keep a pulse in one word.
    #[inline(always)]
    fn put_row(&mut self, pulses: u32, width: u32, low: Levels, mut next: impl FnMut() -> Event) {
        let mut left = pulses;
        while left > 0 {
            left = left.wrapping_sub(1);
            let pulse = next();
            self.put(Event::new(pulse.levels(), width));
            if left > 0 {
                self.put(Event::new(low, pulse.interval().wrapping_sub(width)));
            }
        }
    }

    /// Is told that at a clock of the present tick (one past its end is in the next) the motors were moved by `made`
    /// where the program moved by `program`. For those who have to know the program's position at every step.
    #[inline(always)]
    fn superposed(&mut self, _clock: i32, _program: Step, _made: Step) {}
}

impl<F: FnMut(Event)> Train for F {
    #[inline]
    fn put(&mut self, event: Event) {
        self(event);
    }
}

/// FNV-1a, 64 bits, over the words of a train, little endian.
///
/// Source: G. Fowler, L. C. Noll, K.-P. Vo, the FNV non-cryptographic hash algorithm.
///
/// ```
/// # use interp_core::train::{Event, Hash};
/// let mut hash = Hash::new();
/// hash.event(Event::from_word(u32::from_le_bytes(*b"foob")));
/// hash.byte(b'a');
/// hash.byte(b'r');
/// assert_eq!(hash.value(), 0x8594_4171_f739_67e8); // the published value of "foobar"
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Hash(u64);

impl Hash {
    /// The hash of nothing.
    pub const fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    /// Takes one byte in.
    pub const fn byte(&mut self, byte: u8) {
        self.0 = (self.0 ^ byte as u64).wrapping_mul(0x0100_0000_01b3);
    }

    /// Takes one event in, four bytes little endian.
    pub fn event(&mut self, event: Event) {
        for byte in event.0.to_le_bytes() {
            self.byte(byte);
        }
    }

    /// The hash; shown as 16 hex digits.
    pub const fn value(self) -> u64 {
        self.0
    }
}

impl Default for Hash {
    fn default() -> Self {
        Self::new()
    }
}
