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
//! | PB6 PB7 PB8 | spindle's encoder A (D10), B (morpho CN7), index (D15) (TIM4 channels 1 to 3) | I2C1 |
//! | PA0 PA1 | X handwheel A, B (A0, A1) (TIM2 channels 1, 2) | analog inputs A0, A1 |
//! | PB4 PB5 | Z handwheel A, B (D5, D4) (TIM3 channels 1, 2) | JTAG (not SWD) |
//! | PC6 PC7 | contour handwheel A (morpho CN10), B (D9) (TIM8 channels 1, 2) | TIM3 channels 1, 2 |
//! | PC4 PC5 PC8 PC9 | joystick X+, X-, Z+, Z- (morpho CN10) | |
//! | PC11 PC12 | rapid, threading lever (morpho CN7) | SPI3 |
//! | PB0 PC13 PB1 | start (A3), hold: the blue button, reset (morpho CN10) | analog input A3 |
//! | PB12 PB13 PB14 PB15 | limit switches X+, X-, Z+, Z- (morpho CN10) | SPI2 |
//! | PB10 | guard (D6) | TIM2 channel 3 |
//!
//! All inputs are pulled up.
//!
//! Step and direction pins of a CNC shield v3 (D2 to D8) lie on two ports and can't be set in one write: wire the
//! drivers to the pins above; its enable (D8) and spindle (D12) pins fit. PA5 (LED), SWD and PB3 (SWO) stay free.
//!
//! Clock: 168 MHz, not 180: the step timer is TIM5 on every board, on APB1 at twice the bus, and 84 / 7 = 12 while
//! 90 MHz has no whole divider; TIM1 on APB2 runs at 168 MHz, and 168 / 14 = 12.

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
pub(crate) type XStep = Pin<'C', 0>;
/// Switches the motor drivers on.
pub(crate) type Motors = Pin<'A', 9>;
/// Switches the spindle on.
pub(crate) type Spindle = Pin<'A', 6>;
/// The emergency input.
pub(crate) type Contact = Pin<'C', 10>;

/// Ports of the contacts.
pub(crate) type Ports = (Pin<'B', 0>, Pin<'C', 0>);

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
    let gpiob = dp.GPIOB.split(&mut rcc);
    let gpioc = dp.GPIOC.split(&mut rcc);
    let steps = StepPort::new(gpioc.pc0, gpioc.pc1, gpioc.pc2, gpioc.pc3);
    let drives = Drives::new(gpioa.pa9, gpioa.pa6);
    let contact: Contact = gpioc.pc10.into_pull_up_input();
    let encoders = Encoders {
        wheels: PerAxis {
            x: wheel(dp.TIM2, gpioa.pa0, gpioa.pa1, &mut rcc),
            z: wheel(dp.TIM3, gpiob.pb4.into_input(), gpiob.pb5, &mut rcc),
        },
        contour: Some(wheel(dp.TIM8, gpioc.pc6, gpioc.pc7, &mut rcc)),
        spindle: spindle(dp.TIM4, gpiob.pb6, gpiob.pb7, gpiob.pb8, &mut rcc),
    };
    let wiring = Wiring::NONE
        .with(Of::JoystickXPlus, at(gpioc.pc4))
        .with(Of::JoystickXMinus, at(gpioc.pc5))
        .with(Of::JoystickZPlus, at(gpioc.pc8))
        .with(Of::JoystickZMinus, at(gpioc.pc9))
        .with(Of::Rapid, at(gpioc.pc11))
        .with(Of::Lever, at(gpioc.pc12))
        .with(Of::Start, at(gpiob.pb0))
        .with(Of::Hold, at(gpioc.pc13))
        .with(Of::Reset, at(gpiob.pb1))
        .with(Of::XPlusEnd, at(gpiob.pb12))
        .with(Of::XMinusEnd, at(gpiob.pb13))
        .with(Of::ZPlusEnd, at(gpiob.pb14))
        .with(Of::ZMinusEnd, at(gpiob.pb15))
        .with(Of::Guard, at(gpiob.pb10));
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
