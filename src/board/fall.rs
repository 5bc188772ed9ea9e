//! The falling edges of pulses: TIM1 and DMA lower the step pins, and no handler runs for them.
//!
//! `pulse` raises the pins of a pulse and starts TIM1, which runs once (one-pulse mode, RM0090 17.3.10) for the pulse's
//! width. Its update asks DMA2 (stream 5, channel 6, RM0090 table 43; RM0383 table 28, RM0390 table 29 alike) for one
//! transfer: a word that lowers all step pins goes to the port's BSRR. The DMA is circular with one item, so it needs no
//! care after the set-up. What lowers pins that are low changes nothing.
//!
//! Only pulses of a row fall so (`Play::falls`): nothing else happens on the port between rise and fall.

use stm32f4xx_hal::pac::{DMA2, TIM1, tim1};
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use super::registers::Registers;
use super::this::FALL_DIVIDER;

/// Stream and channel of TIM1's update at DMA2.
const STREAM: usize = 5;
const CHANNEL: u8 = 6;

/// Starts falls: the step timer's side.
pub(crate) struct Fall {
    timer: Registers<tim1::RegisterBlock>,
}

/// Sets how long pulses are: the interpolator's side.
pub(crate) struct Width {
    timer: Registers<tim1::RegisterBlock>,
}

/// Sets timer and DMA up. `bsrr` is the step port's register, `lower` the word, in memory for ever, that lowers all step
/// pins of the board.
pub(crate) fn new(timer: TIM1, dma: DMA2, bsrr: *mut u32, lower: &'static u32, rcc: &mut Rcc) -> (Fall, Width) {
    TIM1::enable(rcc);
    TIM1::reset(rcc);
    DMA2::enable(rcc);
    DMA2::reset(rcc);
    let stream = dma.st(STREAM);
    // SAFETY: the DMA reads one word that stays for ever and writes one register, which may take any value.
    #[allow(unsafe_code, reason = "addresses for the DMA")]
    unsafe {
        stream.par().write(|w| w.bits(bsrr as u32));
        stream.m0ar().write(|w| w.bits(core::ptr::from_ref(lower) as u32));
    }
    stream.ndtr().write(|w| w.ndt().set(1));
    stream.cr().write(|w| {
        w.chsel().set(CHANNEL).pl().very_high().msize().bits32().psize().bits32();
        w.circ().enabled().dir().memory_to_peripheral().en().enabled()
    });
    timer.psc().write(|w| w.psc().set(FALL_DIVIDER.wrapping_sub(1)));
    // the prescaler is taken over at an update, which asks for nothing yet
    timer.egr().write(|w| w.ug().set_bit());
    timer.dier().write(|w| w.ude().set_bit());
    // SAFETY: the timer's only owner gives it up here, for ever; one side writes CR1, the other ARR.
    #[allow(unsafe_code, reason = "the registers for ever")]
    let registers = || unsafe { Registers::new(TIM1::ptr()) };
    (Fall { timer: registers() }, Width { timer: registers() })
}

impl Fall {
    /// Lowers the step pins a width from now on.
    #[inline]
    pub(crate) fn start(&mut self) {
        self.timer.cr1().write(|w| w.opm().enabled().cen().enabled());
    }
}

impl Width {
    /// Lets the pulses that are started from now on last `clocks`.
    #[inline]
    pub(crate) fn set(&mut self, clocks: u32) {
        #[expect(clippy::cast_possible_truncation, reason = "a width is at most a tick, 12 000 clocks")]
        self.timer.arr().write(|w| w.arr().set(clocks.wrapping_sub(1) as u16));
    }
}
