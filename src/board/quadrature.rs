//! Encoders at general-purpose timers: which values their registers get, in which order, and what is read each tick.
//!
//! It knows registers by name only, so desktop tests run it against a model of a timer; the board says where they are.
//! TIM2 to TIM5 and TIM8 are alike in all that is used here: RM0090 (F407) 18.3.12 and 18.4, TIM8 17.3.16 and 17.4; the
//! chapters "General-purpose timers (TIM2 to TIM5)" of RM0383 (F411) and RM0390 (F446) have the same registers.
//!
//! - **Counting.** Encoder mode 3 (SMCR.SMS = 011) counts every edge of both channels, four a line, up or down by which one
//!   leads. No interrupt runs. All timers wrap at 16 bits, the 32-bit ones, too; [`Count`] makes 32 of them.
//! - **Filter.** A level counts once eight samples in a row show it. [`Filter`] says how far apart they are.
//! - **Index.** Channel 3 captures the count at the rising edge of its pin, in hardware: the manual says of encoder mode that
//!   capture goes on as usual. All three channels have the same filter, so the index is late by as much as the counts are.
//!   What is left is a sample at each of the two filters: below one count as long as a count lasts longer than that.

/// Registers that are used.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) enum Register {
    Cr1,
    Smcr,
    Dier,
    Sr,
    Ccmr1,
    Ccmr2,
    Ccer,
    Cnt,
    Psc,
    Arr,
    Ccr3,
}

/// A timer's registers.
pub(crate) trait Port {
    /// Writes one.
    fn write(&mut self, register: Register, value: u32);
    /// Reads one. Reading CCR3 takes the mark of a capture away.
    fn read(&mut self, register: Register) -> u32;
}

/// How long a level has to last, as tables of CR1.CKD and CCMRx.ICxF have it.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) enum Filter {
    /// Eight samples 16 clocks apart: 1.5 us at 84 MHz, 1.3 us at 96 MHz. A line of the spindle's encoder lasts 14.6 us at
    /// 4000 turns a minute with 1024 of them, half of it is high.
    Fast,
    /// Eight samples 128 clocks apart: 12 us at 84 MHz, 11 us at 96, 6 us at 168. A hand turns at most 500 detents a
    /// second: each level lasts a millisecond.
    Slow,
}

impl Filter {
    /// CR1.CKD, which divides the filters' clock: 00 by 1, 10 by 4.
    const fn clock_division(self) -> u32 {
        match self {
            Self::Fast => 0b00 << 8,
            Self::Slow => 0b10 << 8,
        }
    }

    /// CCMRx.ICxF: 1100 for eight samples at a 16th of that clock, 1111 at a 32nd.
    const fn samples(self) -> u32 {
        match self {
            Self::Fast => 0b1100,
            Self::Slow => 0b1111,
        }
    }
}

/// CR1.CEN.
const ENABLE: u32 = 1;
/// SMCR.SMS: encoder mode 3.
const BOTH_EDGES: u32 = 0b011;
/// CCMRx.CCyS of the register's first channel: an input, from its own pin.
const OWN_PIN: u32 = 0b01;
/// CCER.CC3E: channel 3 captures; CC3P and CC3NP 0: at the rising edge.
const CAPTURE_3: u32 = 1 << 8;
/// SR.CC3IF: it has.
const CAPTURED_3: u32 = 1 << 3;

/// Makes a timer that was just reset count an encoder, and capture its index where there is one.
pub(crate) fn count_encoder(timer: &mut impl Port, filter: Filter, index: bool) {
    let channel = OWN_PIN | filter.samples() << 4;
    timer.write(Register::Cr1, filter.clock_division());
    timer.write(Register::Dier, 0);
    timer.write(Register::Psc, 0);
    timer.write(Register::Arr, 0xFFFF);
    // which input a channel has can be chosen only while it is off, so CCER comes behind (RM0090 18.4.7)
    timer.write(Register::Ccmr1, channel | channel << 8);
    timer.write(Register::Ccmr2, if index { channel } else { 0 });
    timer.write(Register::Ccer, if index { CAPTURE_3 } else { 0 });
    timer.write(Register::Smcr, BOTH_EDGES);
    timer.write(Register::Cr1, filter.clock_division() | ENABLE);
}

/// The counter.
#[inline]
pub(crate) fn counter(timer: &mut impl Port) -> u16 {
    low(timer.read(Register::Cnt))
}

/// The count at an index pulse, where one came since it was last asked for.
#[inline]
pub(crate) fn index(timer: &mut impl Port) -> Option<u16> {
    let captured = timer.read(Register::Sr) & CAPTURED_3 != 0;
    captured.then(|| low(timer.read(Register::Ccr3)))
}

#[expect(clippy::cast_possible_truncation, reason = "the counter wraps at 16 bits")]
const fn low(word: u32) -> u16 {
    word as u16
}

/// All counts of an encoder, of a counter of 16 bits that is read often enough: at least once in 32 767 counts, and a tick
/// has less than 300 of any encoder.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Count(i32);

impl Count {
    /// None.
    pub(crate) const NONE: Self = Self(0);

    /// Takes the counter, gives the counts since it was taken last.
    #[inline]
    pub(crate) const fn take(&mut self, counter: u16) -> i16 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "where the counter was")]
        let by = counter.wrapping_sub(self.0 as u16).cast_signed();
        self.0 = self.0.wrapping_add(by as i32);
        by
    }

    /// All of them.
    pub(crate) const fn total(self) -> i32 {
        self.0
    }
}

#[cfg(test)]
#[path = "quadrature_tests.rs"]
mod tests;
