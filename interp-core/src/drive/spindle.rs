//! The spindle's angle: estimated from an encoder's counts, and foretold for the end of the tick that is being made.
//!
//! **When.** The encoder is read at the start of a tick. In that tick the train of the next one is made, and played a
//! tick later: so what is made covers the time from one to two ticks after the reading ([`AHEAD`]). The path's place at
//! its end is that of the angle foretold for that instant.
//!
//! **Filter.** A count is a rounded angle: its difference from tick to tick is rough (at 120 turns a minute with 4096
//! counts a turn, 8 or 9). Angle `x`, rate `v` and acceleration `b` are tracked by an observer of the third order
//! (alpha-beta-gamma): foretell by `x + v + b/2`, `v + b`; then with `e`, the reading less the foretold angle, add
//! `alpha e`, `beta e`, `gamma e`. Critical damping puts all three poles at one place r:
//!
//! ```text
//! alpha = 1 - r^3    beta = 3/2 (1 - r)^2 (1 + r)    gamma = (1 - r)^3
//! ```
//!
//! `r = 13/16` is a bandwidth of `-ln r / 2 pi T` = 33 Hz. Even speed and even acceleration leave no error; a jerk `j`
//! leaves `j / gamma`. A wobble of 20 % at 2 Hz of 2000 turns a minute has a jerk of up to 0.0043 counts a tick^3 and so
//! leaves 0.65 counts at the reading, 1.5 counts two ticks ahead; smoothing in the [channel](crate::channel) adds one.
//! Rounding of the counts, half a count to either side, moves the estimate of an even speed by less than 0.7 counts.
//!
//! **Index.** The reading brings the count latched at the index pulse. The first one is the zero of threads; each later
//! one must be whole turns from it, within [`INDEX_TOLERANCE`] counts (in the other sense the pulse is met at its other
//! edge), else counts were lost, and that is told.

/// Fraction bits of an angle in counts. An angle wraps after 2^35 counts; only differences are used.
pub const ANGLE_BITS: u32 = 28;

/// One count.
pub const COUNT: i64 = 1 << ANGLE_BITS;

/// Ticks from a reading to the end of the tick that is made with it.
pub const AHEAD: i64 = 2;

/// Gains with 16 fraction bits, for r = 13/16.
const ALPHA: i64 = (4096 - 13 * 13 * 13) * 16;
const BETA: i64 = 3 * 3 * 3 * (16 + 13) * 8;
const GAMMA: i64 = 3 * 3 * 3 * 16;

/// Counts that an index pulse may be off.
pub const INDEX_TOLERANCE: u32 = 2;

/// A reading of the encoder at the start of a tick.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Reading {
    /// The counter, 4 counts a line, wrapping at 16 bits.
    pub counts: u16,
    /// The counter at the index pulse, where one came since the last reading.
    pub index: Option<u16>,
}

/// Tracks the spindle.
#[derive(Copy, Clone, Debug)]
pub struct Spindle {
    /// Counts a turn.
    turn: u32,
    /// The counter's last reading, and all counts.
    counter: u16,
    counts: i64,
    /// Counts at an index pulse.
    zero: Option<i64>,
    /// How far the last one was off.
    off: i32,
    /// Counts at the last one, or since when it is looked for.
    indexed: i64,
    angle: i64,
    rate: i64,
    acceleration: i64,
    /// A reading was taken.
    known: bool,
}

/// An angle that is foretold.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Foretold {
    /// At the end of the tick that is made, [`ANGLE_BITS`].
    pub angle: i64,
    /// Its change in that tick.
    pub rate: i64,
    /// And the change of that from tick to tick.
    pub acceleration: i64,
}

impl Spindle {
    /// Range of counts a turn.
    pub const COUNTS: (u32, u32) = (4, 1 << 20);

    /// A spindle whose encoder has `turn` counts a turn, 4 a line. `None` outside [`Self::COUNTS`].
    pub const fn new(turn: u32) -> Option<Self> {
        if turn < Self::COUNTS.0 || turn > Self::COUNTS.1 {
            return None;
        }
        Some(Self {
            turn,
            counter: 0,
            counts: 0,
            zero: None,
            off: 0,
            indexed: 0,
            angle: 0,
            rate: 0,
            acceleration: 0,
            known: false,
        })
    }

    /// Counts a turn.
    pub const fn turn(&self) -> u32 {
        self.turn
    }

    /// The angle at the last reading, [`ANGLE_BITS`].
    pub const fn angle(&self) -> i64 {
        self.angle
    }

    /// Takes the reading of a tick.
    pub fn observe(&mut self, reading: Reading) {
        if !self.known {
            self.known = true;
            self.counter = reading.counts;
            self.angle = COUNT >> 1;
        }
        self.counts = self.counts.wrapping_add(i64::from(reading.counts.wrapping_sub(self.counter).cast_signed()));
        self.counter = reading.counts;
        self.angle = self.angle.wrapping_add(self.rate).wrapping_add(self.acceleration >> 1);
        self.rate = self.rate.wrapping_add(self.acceleration);
        // a count stands for all angles up to the next one
        let read = self.counts.wrapping_shl(ANGLE_BITS).wrapping_add(COUNT >> 1);
        // 16 bits of counts at most: products stay below 2^62
        let error = read.wrapping_sub(self.angle);
        let times = |gain: i64| error.wrapping_mul(gain).wrapping_add(1 << 15) >> 16;
        self.angle = self.angle.wrapping_add(times(ALPHA));
        self.rate = self.rate.wrapping_add(times(BETA));
        self.acceleration = self.acceleration.wrapping_add(times(GAMMA));
        if let Some(latched) = reading.index {
            self.index(latched);
        }
    }

    /// Takes the count latched at an index pulse.
    fn index(&mut self, latched: u16) {
        let since = i64::from(self.counter.wrapping_sub(latched).cast_signed());
        let at = self.counts.wrapping_sub(since);
        self.indexed = at;
        match self.zero {
            None => self.zero = Some(at),
            Some(zero) => {
                let turn = i64::from(self.turn);
                let past = at.wrapping_sub(zero).wrapping_add(turn >> 1).checked_rem_euclid(turn).unwrap_or(0);
                let off = past.wrapping_sub(turn >> 1);
                self.off = crate::math::to_i32(off);
            }
        }
    }

    /// Forgets the index: the next pulse is the zero again.
    pub const fn forget_index(&mut self) {
        (self.zero, self.off, self.indexed) = (None, 0, self.counts);
    }

    /// Whether the spindle has turned by more than one and a half turns without an index pulse.
    pub const fn is_index_missing(&self) -> bool {
        let turned = self.counts.wrapping_sub(self.indexed).unsigned_abs();
        turned > (self.turn as u64).wrapping_add(self.turn as u64 / 2)
    }

    /// Angle of the index, once it was seen.
    pub fn zero(&self) -> Option<i64> {
        self.zero.map(|counts| counts.wrapping_shl(ANGLE_BITS))
    }

    /// Counts by which the last index pulse was off, where that is more than may be.
    pub fn lost(&self) -> Option<i32> {
        (self.off.unsigned_abs() > INDEX_TOLERANCE).then_some(self.off)
    }

    /// The angle at the end of the tick that is being made.
    pub const fn foretold(&self) -> Foretold {
        let acceleration = self.acceleration;
        let turned = self.rate.wrapping_add(acceleration).wrapping_mul(AHEAD);
        Foretold {
            angle: self.angle.wrapping_add(turned),
            // halfway through the second tick
            rate: self.rate.wrapping_add(acceleration).wrapping_add(acceleration >> 1),
            acceleration,
        }
    }
}

#[cfg(test)]
#[path = "spindle_tests.rs"]
mod tests;
