//! STM32F407 boards with HSE 8 MHz (JZ-F407VET6, "black VE", Discovery).
//!
//! | pin | use | in the way of |
//! | --- | --- | --- |
//! | PE7 PE8 | X step, X direction | the data bus of a display on FSMC (D4, D5) |
//! | PE9 PE10 | Z step, Z direction | TIM1 channel 1, FSMC D6, D7 |
//! | PD4 | motor drivers on | FSMC NOE |
//! | PB0 | spindle on | TIM3 channel 3 |
//! | PE12 | emergency stop, normally closed to ground | TIM1 channel 3N, FSMC D9 |
//! | PD5 PD6 | link (USART2) | FSMC NWE, NWAIT |
//!
//! On these boards the pins that LEDs and the crystal need (PC13 to PC15), the SD card (PC8 to PC12, PD2), SWD and
//! TIM2, TIM3 and TIM4 for spindle and handwheels (PA0, PA15, PB4 to PB9, PD12, PD13) stay free. A display on FSMC does not
//! go with these pins; one on SPI does.
//!
//! Clock: 168 MHz; the timers of APB1 run at 84 MHz, and 84 / 7 = 12.

use handcnc::background::parameters::Parameters;
use interp_core::train::Event;
use stm32f4xx_hal::gpio::{Output, Pin, PinState, Speed};
use stm32f4xx_hal::pac::{self, Peripherals};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Config;

use super::{Board, chip, link_port};

pub(crate) use super::chip::{Bench, EmergencyInput, StepTimer, sleep};

/// First of the four step and direction pins.
const FIRST: u32 = 7;

/// Clock of TIM5, in units of the train's 12 MHz.
const TIMER_DIVIDER: u16 = 7;

/// Sets the board up; every output is at rest.
pub(crate) fn setup(dp: Peripherals) -> Board {
    let mut rcc = dp.RCC.freeze(Config::hse(8.MHz()).sysclk(168.MHz()).pclk1(42.MHz()).pclk2(84.MHz()));
    let gpiob = dp.GPIOB.split(&mut rcc);
    let gpiod = dp.GPIOD.split(&mut rcc);
    let gpioe = dp.GPIOE.split(&mut rcc);
    let pins = (
        gpioe.pe7.into_push_pull_output_in_state(PinState::Low).speed(Speed::High),
        gpioe.pe8.into_push_pull_output_in_state(PinState::Low).speed(Speed::High),
        gpioe.pe9.into_push_pull_output_in_state(PinState::Low).speed(Speed::High),
        gpioe.pe10.into_push_pull_output_in_state(PinState::Low).speed(Speed::High),
    );
    let drives = Drives {
        motors: gpiod.pd4.into_push_pull_output_in_state(PinState::Low),
        spindle: gpiob.pb0.into_push_pull_output_in_state(PinState::Low),
    };
    let mut syscfg = dp.SYSCFG.constrain(&mut rcc);
    let mut exti = dp.EXTI;
    let contact = gpioe.pe12.into_pull_up_input().erase();
    let emergency = EmergencyInput::new(contact, &mut syscfg, &mut exti);
    let (receiver, sender) = link_port::open(dp.USART2, (gpiod.pd5, gpiod.pd6), &mut rcc);
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

type StepPins = (Pin<'E', 7, Output>, Pin<'E', 8, Output>, Pin<'E', 9, Output>, Pin<'E', 10, Output>);

impl StepPort {
    /// Sets all four pins in one write.
    #[inline]
    pub(crate) fn write(&mut self, event: Event) {
        let word = chip::set_and_clear(event.levels(), FIRST);
        // SAFETY: BSRR changes only the pins that it names, and those are owned here; the write is atomic.
        #[allow(unsafe_code, reason = "the HAL sets pins one by one")]
        unsafe { &*pac::GPIOE::ptr() }.bsrr().write(|w| unsafe { w.bits(word) });
    }
}

/// Enable pins of motor drivers and spindle: high is on.
pub(crate) struct Drives {
    motors: Pin<'D', 4, Output>,
    spindle: Pin<'B', 0, Output>,
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
        (*pac::GPIOD::ptr()).bsrr().write(|w| w.br4().set_bit());
        (*pac::GPIOB::ptr()).bsrr().write(|w| w.br0().set_bit());
    }
    loop {
        cortex_m::asm::wfi();
    }
}
