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
//! Clock: 168 MHz; the timers of APB1 run at 84 MHz, and 84 / 7 = 12; those of APB2 at 168 MHz, and 168 / 14 = 12.

use stm32f4xx_hal::gpio::Pin;
use stm32f4xx_hal::pac::Peripherals;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Config;

use super::Board;
use super::chip::{self, Devices};
use super::pins::{Drives, StepPort};

/// First of the four step and direction pins.
pub(crate) type XStep = Pin<'E', 7>;
/// Switches the motor drivers on.
pub(crate) type Motors = Pin<'D', 4>;
/// Switches the spindle on.
pub(crate) type Spindle = Pin<'B', 0>;
/// The emergency input.
pub(crate) type Contact = Pin<'E', 12>;

/// Clock of TIM5, in units of the train's 12 MHz.
pub(crate) const TIMER_DIVIDER: u16 = 7;
/// Clock of TIM1, likewise.
pub(crate) const FALL_DIVIDER: u16 = 14;

/// Sets the board up; every output is at rest.
pub(crate) fn setup(dp: Peripherals) -> Board {
    let restarted = chip::was_restarted(&dp.RCC);
    let clocks = Config::hse(8.MHz()).sysclk(168.MHz()).pclk1(42.MHz()).pclk2(84.MHz());
    let mut rcc = dp.RCC.freeze(clocks);
    let gpiob = dp.GPIOB.split(&mut rcc);
    let gpiod = dp.GPIOD.split(&mut rcc);
    let gpioe = dp.GPIOE.split(&mut rcc);
    let steps = StepPort::new(gpioe.pe7, gpioe.pe8, gpioe.pe9, gpioe.pe10);
    let drives = Drives::new(gpiod.pd4, gpiob.pb0);
    let contact: Contact = gpioe.pe12.into_pull_up_input();
    let devices = Devices {
        syscfg: dp.SYSCFG,
        exti: dp.EXTI,
        timer: dp.TIM5,
        fall: (dp.TIM1, dp.DMA2),
        watchdog: dp.IWDG,
        memory: (dp.RTC, dp.PWR),
        usart: dp.USART2,
        link: (gpiod.pd5, gpiod.pd6),
    };
    chip::board(devices, steps, drives, contact, restarted, &mut rcc)
}
