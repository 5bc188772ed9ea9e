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
//! 90 MHz has no whole divider; TIM1 on APB2 runs at 168 MHz, and 168 / 14 = 12.

use stm32f4xx_hal::gpio::Pin;
use stm32f4xx_hal::pac::Peripherals;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Config;

use super::Board;
use super::chip::{self, Devices};
use super::pins::{Drives, StepPort};

/// First of the four step and direction pins.
pub(crate) type XStep = Pin<'C', 0>;
/// Switches the motor drivers on.
pub(crate) type Motors = Pin<'A', 9>;
/// Switches the spindle on.
pub(crate) type Spindle = Pin<'A', 6>;
/// The emergency input.
pub(crate) type Contact = Pin<'C', 10>;

/// Clock of TIM5, in units of the train's 12 MHz.
pub(crate) const TIMER_DIVIDER: u16 = 7;
/// Clock of TIM1, likewise.
pub(crate) const FALL_DIVIDER: u16 = 14;

/// Sets the board up; every output is at rest.
pub(crate) fn setup(dp: Peripherals) -> Board {
    let restarted = chip::was_restarted(&dp.RCC);
    let clocks = Config::hse(8.MHz()).bypass_hse_oscillator().sysclk(168.MHz()).pclk1(42.MHz()).pclk2(84.MHz());
    let mut rcc = dp.RCC.freeze(clocks);
    let gpioa = dp.GPIOA.split(&mut rcc);
    let gpioc = dp.GPIOC.split(&mut rcc);
    let steps = StepPort::new(gpioc.pc0, gpioc.pc1, gpioc.pc2, gpioc.pc3);
    let drives = Drives::new(gpioa.pa9, gpioa.pa6);
    let contact: Contact = gpioc.pc10.into_pull_up_input();
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
