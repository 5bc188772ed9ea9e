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
//! | PD12 PD13 PD14 | spindle's encoder A, B, index (TIM4 channels 1 to 3) | LEDs of the Discovery, FSMC A17, A18, D0 |
//! | PA15 PA1 | X handwheel A, B (TIM2 channels 1, 2) | JTAG (not SWD), Ethernet |
//! | PA6 PA7 | Z handwheel A, B (TIM3 channels 1, 2) | SPI1 |
//! | PC6 PC7 | contour handwheel A, B (TIM8 channels 1, 2) | TIM3 channels 1, 2, camera |
//! | PD0 PD1 PD3 PD7 | joystick X+, X-, Z+, Z- | CAN1, FSMC D2, D3, CLK, NE1 |
//! | PE6 PE5 | rapid, threading lever | camera |
//! | PE4 PE3 PE2 | start, hold, reset | trace, FSMC A20, A19, A23 |
//! | PD8 PD9 PD10 PD11 | limit switches X+, X-, Z+, Z- | USART3, FSMC D13 to D15, A16 |
//! | PE11 | guard | TIM1 channel 2, FSMC D8 |
//!
//! All inputs are pulled up. On these boards the pins that LEDs and the crystal need (PC13 to PC15), the SD card (PC8 to
//! PC12, PD2), SWD and the flash on SPI (PB3 to PB5) stay free. A display on FSMC does not go with these pins; one on SPI
//! does. On the Discovery PA6, PA7 and PE3 go to its accelerometer and PD12 to PD14 to LEDs: no place for wheels and spindle.
//!
//! Clock: 168 MHz; the timers of APB1 run at 84 MHz, and 84 / 7 = 12; those of APB2 at 168 MHz, and 168 / 14 = 12.

use stm32f4xx_hal::gpio::Pin;
use stm32f4xx_hal::pac::Peripherals;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Config;

use handcnc::foreground::inputs::PerAxis;
use handcnc::foreground::panel::{Contact as Of, Wiring};

use super::Board;
use super::chip::{self, Devices};
use super::controls::{Controls, Encoders, at, spindle, wheel};
use super::pins::{Drives, StepPort};

/// First of the four step and direction pins.
pub(crate) type XStep = Pin<'E', 7>;
/// Switches the motor drivers on.
pub(crate) type Motors = Pin<'D', 4>;
/// Switches the spindle on.
pub(crate) type Spindle = Pin<'B', 0>;
/// The emergency input.
pub(crate) type Contact = Pin<'E', 12>;

/// Ports of the contacts.
pub(crate) type Ports = (Pin<'D', 0>, Pin<'E', 0>);

/// Clock of TIM5, in units of the train's 12 MHz.
pub(crate) const TIMER_DIVIDER: u16 = 7;
/// Clock of TIM1, likewise.
pub(crate) const FALL_DIVIDER: u16 = 14;

/// Sets the board up; every output is at rest.
pub(crate) fn setup(dp: Peripherals) -> Board {
    let restarted = chip::was_restarted(&dp.RCC);
    let clocks = Config::hse(8.MHz()).sysclk(168.MHz()).pclk1(42.MHz()).pclk2(84.MHz());
    let mut rcc = dp.RCC.freeze(clocks);
    let gpioa = dp.GPIOA.split(&mut rcc);
    let gpiob = dp.GPIOB.split(&mut rcc);
    let gpioc = dp.GPIOC.split(&mut rcc);
    let gpiod = dp.GPIOD.split(&mut rcc);
    let gpioe = dp.GPIOE.split(&mut rcc);
    let steps = StepPort::new(gpioe.pe7, gpioe.pe8, gpioe.pe9, gpioe.pe10);
    let drives = Drives::new(gpiod.pd4, gpiob.pb0);
    let contact: Contact = gpioe.pe12.into_pull_up_input();
    let encoders = Encoders {
        wheels: PerAxis {
            x: wheel(dp.TIM2, gpioa.pa15.into_input(), gpioa.pa1, &mut rcc),
            z: wheel(dp.TIM3, gpioa.pa6, gpioa.pa7, &mut rcc),
        },
        contour: Some(wheel(dp.TIM8, gpioc.pc6, gpioc.pc7, &mut rcc)),
        spindle: spindle(dp.TIM4, gpiod.pd12, gpiod.pd13, gpiod.pd14, &mut rcc),
    };
    let wiring = Wiring::NONE
        .with(Of::JoystickXPlus, at(gpiod.pd0))
        .with(Of::JoystickXMinus, at(gpiod.pd1))
        .with(Of::JoystickZPlus, at(gpiod.pd3))
        .with(Of::JoystickZMinus, at(gpiod.pd7))
        .with(Of::Rapid, at(gpioe.pe6))
        .with(Of::Lever, at(gpioe.pe5))
        .with(Of::Start, at(gpioe.pe4))
        .with(Of::Hold, at(gpioe.pe3))
        .with(Of::Reset, at(gpioe.pe2))
        .with(Of::XPlusEnd, at(gpiod.pd8))
        .with(Of::XMinusEnd, at(gpiod.pd9))
        .with(Of::ZPlusEnd, at(gpiod.pd10))
        .with(Of::ZMinusEnd, at(gpiod.pd11))
        .with(Of::Guard, at(gpioe.pe11));
    let devices = Devices {
        syscfg: dp.SYSCFG,
        exti: dp.EXTI,
        timer: dp.TIM5,
        fall: (dp.TIM1, dp.DMA2),
        watchdog: dp.IWDG,
        memory: (dp.RTC, dp.PWR),
        usart: dp.USART2,
        link: (gpiod.pd5, gpiod.pd6),
        controls: Controls::new(encoders, wiring),
    };
    chip::board(devices, steps, drives, contact, restarted, &mut rcc)
}
