//! Backup memory: the twenty registers of the real-time clock's domain, which a battery at VBAT keeps (RM0090 26.6.20,
//! RM0383 17.6.20).
//!
//! They are written like any register, wait for no erase and stall no fetch. They stand under no write protection but that of
//! the whole domain (DBP; RM0090 5.1.2 and 26.3.6). Whether they need the clock of their domain the manual does not say, so
//! it runs, from the LSI. The HAL's `Rtc` would start it, too, and for that resets the domain at each power-on, with all that
//! it was to keep.

use handcnc::background::keeper::{Backup, WORDS};
use stm32f4xx_hal::pac::{PWR, RTC};
use stm32f4xx_hal::rcc::{Enable, Rcc};

/// The registers.
pub(crate) struct Memory(RTC);

impl Memory {
    /// Whether the machine was without power, and its position is doubtful: whoever switches a real one on can't know.
    pub(crate) const DOUBTFUL: bool = true;

    /// Opens the domain.
    pub(crate) fn open(registers: RTC, power: &PWR, rcc: &mut Rcc) -> Self {
        PWR::enable(rcc);
        power.cr().modify(|_, w| w.dbp().set_bit());
        // the watchdog's clock, which never stops
        rcc.csr().modify(|_, w| w.lsion().set_bit());
        // takes the first choice since the domain's reset only
        rcc.bdcr().modify(|_, w| w.rtcsel().lsi());
        rcc.bdcr().modify(|_, w| w.rtcen().set_bit());
        Self(registers)
    }
}

impl Backup for Memory {
    fn read(&self) -> [u32; WORDS] {
        let mut words = [0; WORDS];
        words.iter_mut().zip(self.0.bkpr_iter()).for_each(|(word, register)| *word = register.read().bkp().bits());
        words
    }

    fn write(&mut self, first: usize, words: &[u32]) {
        let registers = self.0.bkpr_iter().skip(first).zip(words);
        registers.for_each(|(register, word)| {
            register.write(|w| w.bkp().set(*word));
        });
    }
}
