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
//! | PB6 PB7 PB8 | spindle's encoder A, B, index (TIM4 channels 1 to 3) | I2C1; grblHAL has reset, hold, start here |
//! | PA15 PB3 | X handwheel A, B (TIM2 channels 1, 2) | JTAG and SWO (not SWD); grblHAL has an encoder here |
//! | PA6 PA7 | Z handwheel A, B (TIM3 channels 1, 2), the contour's in linked feed and retrace | a flash under the board |
//! | PA4 PA5 PA8 PA9 | joystick X+, X-, Z+, Z- | a flash under the board, USB VBUS |
//! | PA10 | rapid | USB ID; a level here keeps the boot loader from USB |
//! | PA1 PA0 | start, hold: the board's key | |
//! | PB4 PB5 | limit switches X+, Z+ | SPI1 |
//! | PB9 | guard | I2C1; grblHAL has the door here |
//!
//! All inputs are pulled up. With 48 pins and without TIM8 there is no timer for a contour wheel (the wheel of Z is one
//! while a contour is followed) and there are no pins for reset, threading lever and the limit switches at minus, which
//! never ask for anything: the link resets, soft limits guard the ends, and home is at plus.
//!
//! All step pins bear 5 V (PA0 and PB5 would not: DS10314 rev 7, table 8). LED PC13, crystal PC14 and PC15, USB PA11 and
//! PA12, SWD PA13 and PA14, and PB2, which is pulled down, stay free.
//!
//! Clock: 96 MHz, not 100: all timers run at 96 MHz, and 96 / 8 = 12.

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
pub(crate) type XStep = Pin<'B', 12>;
/// Switches the motor drivers on.
pub(crate) type Motors = Pin<'B', 0>;
/// Switches the spindle on.
pub(crate) type Spindle = Pin<'B', 1>;
/// The emergency input.
pub(crate) type Contact = Pin<'B', 10>;

/// Ports of the contacts.
pub(crate) type Ports = (Pin<'A', 0>, Pin<'B', 0>);

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
    let encoders = Encoders {
        wheels: PerAxis {
            x: wheel(dp.TIM2, gpioa.pa15.into_input(), gpiob.pb3.into_input(), &mut rcc),
            z: wheel(dp.TIM3, gpioa.pa6, gpioa.pa7, &mut rcc),
        },
        contour: None,
        spindle: spindle(dp.TIM4, gpiob.pb6, gpiob.pb7, gpiob.pb8, &mut rcc),
    };
    let wiring = Wiring::NONE
        .with(Of::JoystickXPlus, at(gpioa.pa4))
        .with(Of::JoystickXMinus, at(gpioa.pa5))
        .with(Of::JoystickZPlus, at(gpioa.pa8))
        .with(Of::JoystickZMinus, at(gpioa.pa9))
        .with(Of::Rapid, at(gpioa.pa10))
        .with(Of::Start, at(gpioa.pa1))
        .with(Of::Hold, at(gpioa.pa0))
        .with(Of::XPlusEnd, at(gpiob.pb4))
        .with(Of::ZPlusEnd, at(gpiob.pb5))
        .with(Of::Guard, at(gpiob.pb9));
    let devices = Devices {
        syscfg: dp.SYSCFG,
        exti: dp.EXTI,
        timer: dp.TIM5,
        fall: (dp.TIM1, dp.DMA2),
        watchdog: dp.IWDG,
        memory: (dp.RTC, dp.PWR),
        usart: dp.USART2,
        link: (gpioa.pa2, gpioa.pa3),
        controls: Controls::new(encoders, wiring),
    };
    chip::board(devices, steps, drives, contact, restarted, &mut rcc)
}
