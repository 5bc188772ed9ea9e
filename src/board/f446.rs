//! Nucleo-F446RE, clock 8 MHz from its ST-LINK.
//!
//! | pin | use | in the way of |
//! | --- | --- | --- |
//! | PC0 PC1 | X step, X direction (A5, A4) | analog inputs A5, A4 |
//! | PC2 PC3 | Z step, Z direction (morpho CN7) | SPI2 |
//! | PA9 | motor drivers on (D8) | TIM1 channel 2 |
//! | PA6 | spindle on (D12) | SPI1 |
//! | PC10 | emergency stop, normally closed to ground (morpho CN7) | SPI3, UART4 |
//! | PA2 PA3 | link (USART2), the ST-LINK's serial port | D1, D0 |
//!
//! Step and direction pins of a CNC shield v3 (D2 to D8) lie on two ports and can't be set in one write: wire the
//! drivers to the pins above; its enable (D8) and spindle (D12) pins fit. PC13 (button), PA5 (LED), SWD, TIM2 (PA0, PA1), TIM3 and TIM8
//! (PC6, PC7), TIM4 (PB6, PB7) stay free.
//!
//! Clock: 168 MHz, not 180: the step timer is TIM5 on every board, on APB1 at twice the bus, and 84 / 7 = 12 while
//! 90 MHz has no whole divider.

use handcnc::background::parameters::Parameters;
use interp_core::train::Event;
use stm32f4xx_hal::gpio::{Output, Pin, PinState, Speed};
use stm32f4xx_hal::pac::{self, Peripherals};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Config;

use super::{Board, chip, link_port};

pub(crate) use super::chip::{Bench, EmergencyInput, StepTimer, sleep};

/// First of the four step and direction pins.
const FIRST: u32 = 0;

/// Clock of TIM5, in units of the train's 12 MHz.
const TIMER_DIVIDER: u16 = 7;

/// Sets the board up; every output is at rest.
pub(crate) fn setup(dp: Peripherals) -> Board {
    let mut rcc =
        dp.RCC.freeze(Config::hse(8.MHz()).bypass_hse_oscillator().sysclk(168.MHz()).pclk1(42.MHz()).pclk2(84.MHz()));
    let gpioa = dp.GPIOA.split(&mut rcc);
    let gpioc = dp.GPIOC.split(&mut rcc);
    let pins = (
        gpioc.pc0.into_push_pull_output_in_state(PinState::Low).speed(Speed::High),
        gpioc.pc1.into_push_pull_output_in_state(PinState::Low).speed(Speed::High),
        gpioc.pc2.into_push_pull_output_in_state(PinState::Low).speed(Speed::High),
        gpioc.pc3.into_push_pull_output_in_state(PinState::Low).speed(Speed::High),
    );
    let drives = Drives {
        motors: gpioa.pa9.into_push_pull_output_in_state(PinState::Low),
        spindle: gpioa.pa6.into_push_pull_output_in_state(PinState::Low),
    };
    let mut syscfg = dp.SYSCFG.constrain(&mut rcc);
    let mut exti = dp.EXTI;
    let contact = gpioc.pc10.into_pull_up_input().erase();
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

type StepPins = (Pin<'C', 0, Output>, Pin<'C', 1, Output>, Pin<'C', 2, Output>, Pin<'C', 3, Output>);

impl StepPort {
    /// Sets all four pins in one write.
    #[inline]
    pub(crate) fn write(&mut self, event: Event) {
        let word = chip::set_and_clear(event.levels(), FIRST);
        // SAFETY: BSRR changes only the pins that it names, and those are owned here; the write is atomic.
        #[allow(unsafe_code, reason = "the HAL sets pins one by one")]
        unsafe { &*pac::GPIOC::ptr() }.bsrr().write(|w| unsafe { w.bits(word) });
    }
}

/// Enable pins of motor drivers and spindle: high is on.
pub(crate) struct Drives {
    motors: Pin<'A', 9, Output>,
    spindle: Pin<'A', 6, Output>,
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
        (*pac::GPIOA::ptr()).bsrr().write(|w| w.br9().set_bit());
        (*pac::GPIOA::ptr()).bsrr().write(|w| w.br6().set_bit());
    }
    loop {
        cortex_m::asm::wfi();
    }
}
