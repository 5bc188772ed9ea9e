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
//! Clock: 96 MHz, not 100: all timers run at 96 MHz, and 96 / 8 = 12.

use stm32f4xx_hal::gpio::Pin;
use stm32f4xx_hal::pac::Peripherals;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Config;

use super::Board;
use super::chip::{self, Devices};
use super::pins::{Drives, StepPort};

/// First of the four step and direction pins.
pub(crate) type XStep = Pin<'B', 12>;
/// Switches the motor drivers on.
pub(crate) type Motors = Pin<'B', 0>;
/// Switches the spindle on.
pub(crate) type Spindle = Pin<'B', 1>;
/// The emergency input.
pub(crate) type Contact = Pin<'B', 10>;

/// Clock of TIM5, in units of the train's 12 MHz.
pub(crate) const TIMER_DIVIDER: u16 = 8;
/// Clock of TIM1, likewise.
pub(crate) const FALL_DIVIDER: u16 = 8;

/// Sets the board up; every output is at rest.
pub(crate) fn setup(dp: Peripherals) -> Board {
    let restarted = chip::was_restarted(&dp.RCC);
    let clocks = Config::hse(25.MHz()).sysclk(96.MHz()).pclk1(48.MHz()).pclk2(96.MHz());
    let mut rcc = dp.RCC.freeze(clocks);
    let gpioa = dp.GPIOA.split(&mut rcc);
    let gpiob = dp.GPIOB.split(&mut rcc);
    let steps = StepPort::new(gpiob.pb12, gpiob.pb13, gpiob.pb14, gpiob.pb15);
    let drives = Drives::new(gpiob.pb0, gpiob.pb1);
    let contact: Contact = gpiob.pb10.into_pull_up_input();
    let devices = Devices {
        syscfg: dp.SYSCFG,
        exti: dp.EXTI,
        timer: dp.TIM5,
        fall: (dp.TIM1, dp.DMA2),
        watchdog: dp.IWDG,
        memory: (dp.RTC, dp.PWR),
        usart: dp.USART2,
        link: (gpioa.pa2, gpioa.pa3),
    };
    chip::board(devices, steps, drives, contact, restarted, &mut rcc)
}
