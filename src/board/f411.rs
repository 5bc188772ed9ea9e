//! WeAct BlackPill, STM32F411CE with HSE 25 MHz.
//!
//! | pin | use | in the way of |
//! | --- | --- | --- |
//! | PB12 PB13 | X step, X direction | SPI2; grblHAL has limit switches here |
//! | PB14 PB15 | Z step, Z direction | SPI2; grblHAL has a limit and the probe here |
//! | PB0 | motor drivers on | TIM3 channel 3 |
//! | PB1 | spindle on | TIM3 channel 4 |
//! | PB10 | emergency stop, normally closed to ground | I2C2 |
//! | PA2 PA3 | link (USART2) | TIM2 and TIM5 channels 3 and 4; grblHAL has steps here |
//!
//! All step pins bear 5 V (PA0 and PB5 would not: DS10314 rev 7, table 8). LED PC13, key PA0, USB PA11 and PA12, SWD
//! PA13 and PA14, the flash footprint PA4 to PA7, TIM2 (PA15, PB3) for the spindle and TIM4 (PB6, PB7) for a
//! handwheel stay free.
//!
//! Clock: 96 MHz, not 100: the timers run at 96 MHz, and 96 / 8 = 12.

use handcnc::background::parameters::Parameters;
use interp_core::train::Event;
use stm32f4xx_hal::gpio::{Output, Pin, PinState, Speed};
use stm32f4xx_hal::pac::{self, Peripherals};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Config;

use super::{Board, chip, link_port};

pub(crate) use super::chip::{Bench, EmergencyInput, StepTimer, sleep};

/// First of the four step and direction pins.
const FIRST: u32 = 12;

/// Clock of TIM5, in units of the train's 12 MHz.
const TIMER_DIVIDER: u16 = 8;

/// Sets the board up; every output is at rest.
pub(crate) fn setup(dp: Peripherals) -> Board {
    let mut rcc = dp.RCC.freeze(Config::hse(25.MHz()).sysclk(96.MHz()).pclk1(48.MHz()).pclk2(96.MHz()));
    let gpioa = dp.GPIOA.split(&mut rcc);
    let gpiob = dp.GPIOB.split(&mut rcc);
    let pins = (
        gpiob.pb12.into_push_pull_output_in_state(PinState::Low).speed(Speed::High),
        gpiob.pb13.into_push_pull_output_in_state(PinState::Low).speed(Speed::High),
        gpiob.pb14.into_push_pull_output_in_state(PinState::Low).speed(Speed::High),
        gpiob.pb15.into_push_pull_output_in_state(PinState::Low).speed(Speed::High),
    );
    let drives = Drives {
        motors: gpiob.pb0.into_push_pull_output_in_state(PinState::Low),
        spindle: gpiob.pb1.into_push_pull_output_in_state(PinState::Low),
    };
    let mut syscfg = dp.SYSCFG.constrain(&mut rcc);
    let mut exti = dp.EXTI;
    let contact = gpiob.pb10.into_pull_up_input().erase();
    let emergency = EmergencyInput::new(contact, &mut syscfg, &mut exti);
    let (receiver, sender) = link_port::open(dp.USART2, (gpioa.pa2, gpioa.pa3), &mut rcc);
    let timer = StepTimer::start(dp.TIM5, TIMER_DIVIDER, &mut rcc);
    Board {
        timer,
        port: StepPort { _pins: pins },
        drives,
        emergency,
        receiver,
        sender,
        bench: Bench,
        parameters: Parameters::new(),
    }
}

/// The step and direction pins.
pub(crate) struct StepPort {
    _pins: StepPins,
}

type StepPins = (Pin<'B', 12, Output>, Pin<'B', 13, Output>, Pin<'B', 14, Output>, Pin<'B', 15, Output>);

impl StepPort {
    /// Sets all four pins in one write.
    #[inline]
    pub(crate) fn write(&mut self, event: Event) {
        let word = chip::set_and_clear(event.levels(), FIRST);
        // SAFETY: BSRR changes only the pins that it names, and those are owned here; the write is atomic.
        #[allow(unsafe_code, reason = "the HAL sets pins one by one")]
        unsafe { &*pac::GPIOB::ptr() }.bsrr().write(|w| unsafe { w.bits(word) });
    }
}

/// Enable pins of motor drivers and spindle: high is on.
pub(crate) struct Drives {
    motors: Pin<'B', 0, Output>,
    spindle: Pin<'B', 1, Output>,
}

impl Drives {
    /// Motors on; the spindle is not driven yet.
    pub(crate) fn enable(&mut self) {
        self.motors.set_high();
    }

    /// All off, and no further step.
    pub(crate) fn off(&mut self) {
        self.motors.set_low();
        self.spindle.set_low();
        chip::stop_train();
    }
}

/// Where a fault ends: all off, for ever.
pub(crate) fn safe() -> ! {
    cortex_m::interrupt::disable();
    chip::stop_train();
    // SAFETY: interrupts are off and nothing runs any more but this; the writes only switch outputs off.
    #[allow(unsafe_code, reason = "the owner of the pins may be damaged")]
    unsafe {
        (*pac::GPIOB::ptr()).bsrr().write(|w| w.br0().set_bit());
        (*pac::GPIOB::ptr()).bsrr().write(|w| w.br1().set_bit());
    }
    loop {
        cortex_m::asm::wfi();
    }
}
