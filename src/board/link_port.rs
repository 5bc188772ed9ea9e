//! The serial port of the link: USART2, 115 200 baud, 8 bits, no parity, on every board.

use core::fmt;

use stm32f4xx_hal::gpio::PushPull;
use stm32f4xx_hal::gpio::alt::SerialAsync as CommonPins;
use stm32f4xx_hal::pac::USART2;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::{Config, Rx, Serial, Tx};

/// Bits a second.
pub(crate) const BAUD: u32 = 115_200;

/// Bytes in.
pub(crate) struct Receiver(Rx<USART2>);

/// Bytes out.
pub(crate) struct Sender(Tx<USART2>);

/// Both ends of an open port; bytes in interrupt from now on.
pub(crate) fn open<TX, RX>(usart: USART2, pins: (TX, RX), rcc: &mut Rcc) -> (Receiver, Sender)
where
    TX: Into<<USART2 as CommonPins>::Tx<PushPull>>,
    RX: Into<<USART2 as CommonPins>::Rx<PushPull>>,
{
    let config = Config::default().baudrate(BAUD.bps());
    let serial = match Serial::new(usart, pins, config, rcc) {
        Ok(serial) => serial,
        // the rate is fixed and every board's clock can make it: only init gets here, and never
        Err(_) => super::safe(),
    };
    let (sender, mut receiver) = serial.split();
    receiver.listen();
    (Receiver(receiver), Sender(sender))
}

impl Receiver {
    /// The byte that has arrived. What the line damaged comes as 0x7F, which no line may contain.
    pub(crate) fn byte(&mut self) -> Option<u8> {
        match self.0.read() {
            Ok(byte) => Some(byte),
            Err(nb::Error::WouldBlock) => None,
            Err(nb::Error::Other(_)) => Some(0x7F),
        }
    }
}

impl fmt::Write for Sender {
    /// Waits for the port, at the lowest priority.
    fn write_str(&mut self, text: &str) -> fmt::Result {
        text.bytes().try_for_each(|byte| nb::block!(self.0.write(byte)).map_err(|_| fmt::Error))
    }
}
