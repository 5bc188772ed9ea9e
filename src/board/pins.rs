//! Pins of real boards: steps, drives, the emergency input.
//!
//! A board names its pins by type; registers and numbers follow from the types. Each write here is one store, or is made
//! where nothing can come between, so that the emergency task and the interpolator may both switch.

use handcnc::foreground::outputs::Outputs;
use handcnc::foreground::train_queue::Play;
use interp_core::train::Levels;
use stm32f4xx_hal::gpio::{Output, Pin, PinState, Pull, Speed};
use stm32f4xx_hal::pac::gpioa::RegisterBlock;
use stm32f4xx_hal::pac::{self, EXTI};

use super::chip::set_and_clear;
use super::registers::Registers;
use super::this;

/// Where a pin is.
pub(crate) trait Place {
    /// Its port's letter.
    const PORT: char;
    /// Its number in the port.
    const NUMBER: u8;
}

impl<const P: char, const N: u8, M> Place for Pin<P, N, M> {
    const PORT: char = P;
    const NUMBER: u8 = N;
}

/// Registers of a pin's port.
#[inline]
pub(super) fn registers<P: Place>() -> &'static RegisterBlock {
    let port = match P::PORT {
        'A' => pac::GPIOA::ptr(),
        'B' => pac::GPIOB::ptr().cast(),
        'C' => pac::GPIOC::ptr().cast(),
        'D' => pac::GPIOD::ptr().cast(),
        _ => pac::GPIOE::ptr().cast(),
    };
    // SAFETY: all ports have the same registers (RM0090, 8.4), and they exist for ever. Only BSRR (which changes no pin
    // but those named), MODER of the step pins and IDR are used through it.
    #[allow(unsafe_code, reason = "tasks of two priorities switch the same pins, and the HAL sets pins one by one")]
    unsafe {
        &*port
    }
}

/// Sets a pin high or low.
#[inline]
fn set<P: Place>(high: bool) {
    const { assert!(P::NUMBER < 16) };
    let word = if high { 1 } else { 1 << 16 } << P::NUMBER;
    // SAFETY: BSRR may take any value.
    #[allow(unsafe_code, reason = "a pin by its number")]
    registers::<P>().bsrr().write(|w| unsafe { w.bits(word) });
}

/// First of the four step and direction pins.
const FIRST: u32 = <this::XStep as Place>::NUMBER as u32;

/// The step and direction pins.
pub(crate) struct StepPort(Registers<RegisterBlock>);

impl StepPort {
    /// Takes the pins of X step, X direction, Z step, Z direction: neighbours in one port, the first one [`this::XStep`].
    pub(crate) fn new<const P: char, const A: u8, const B: u8, const C: u8, const D: u8>(
        x_step: Pin<P, A>,
        x_direction: Pin<P, B>,
        z_step: Pin<P, C>,
        z_direction: Pin<P, D>,
    ) -> Self {
        const {
            assert!(A == <this::XStep as Place>::NUMBER && P as u32 == <this::XStep as Place>::PORT as u32);
            assert!(B == A + 1 && C == A + 2 && D == A + 3);
        }
        // pulled down, too: in an emergency they are let go
        output(x_step).set_internal_resistor(Pull::Down);
        output(x_direction).set_internal_resistor(Pull::Down);
        output(z_step).set_internal_resistor(Pull::Down);
        output(z_direction).set_internal_resistor(Pull::Down);
        // SAFETY: the pins are owned here; BSRR changes no others.
        #[allow(unsafe_code, reason = "the registers for ever")]
        Self(unsafe { Registers::new(registers::<this::XStep>()) })
    }

    /// The register that sets and clears pins, and the word that lowers the step pins.
    pub(crate) fn lowering(&self) -> (*mut u32, &'static u32) {
        static LOWER: u32 = set_and_clear(Levels::LOW, FIRST) & ((1 | 1 << 2) << (16 + FIRST));
        (self.0.bsrr().as_ptr(), &LOWER)
    }

    /// Sets all four pins in one write.
    #[inline]
    pub(crate) fn write(&mut self, play: Play) {
        let word = set_and_clear(play.levels(), FIRST);
        // SAFETY: BSRR changes only the pins that it names, and those are owned here; the write is atomic.
        #[allow(unsafe_code, reason = "the HAL sets pins one by one")]
        self.0.bsrr().write(|w| unsafe { w.bits(word) });
    }
}

/// A fast output, low.
fn output<const P: char, const N: u8>(pin: Pin<P, N>) -> Pin<P, N, Output> {
    pin.into_push_pull_output_in_state(PinState::Low).speed(Speed::High)
}

/// Enable pins of motor drivers and spindle, high is on, and whether the step pins are driven.
#[derive(Copy, Clone)]
pub(crate) struct Drives;

impl Drives {
    /// Takes the pins of motor drivers and spindle; both off.
    pub(crate) fn new(motors: this::Motors, spindle: this::Spindle) -> Self {
        output(motors);
        output(spindle);
        Self
    }

    /// Switches as the foreground says.
    #[inline]
    pub(crate) fn follow(&mut self, outputs: Outputs) {
        set::<this::Spindle>(outputs.spindle);
        set::<this::Motors>(outputs.motors);
        // what is in the train still plays when the drivers are off
        Self::steps(u32::from(outputs.motors));
    }

    /// All off at once, and no step leaves the chip.
    pub(crate) fn off(&mut self) {
        set::<this::Motors>(false);
        set::<this::Spindle>(false);
        Self::steps(0);
    }

    /// Makes the four step and direction pins outputs (1) or inputs (0).
    fn steps(mode: u32) {
        const { assert!(FIRST <= 12) };
        let port = registers::<this::XStep>();
        let (mask, word) = (0xFF << (2 * FIRST), (0x55 * mode) << (2 * FIRST));
        let now = port.moder().read().bits();
        let then = now & !mask | word;
        if now != then {
            // SAFETY: only the modes of these four pins change. Should the emergency task come between reading and
            // writing, the interpolator sees it afterwards and switches off again.
            #[allow(unsafe_code, reason = "four pins at once")]
            port.moder().write(|w| unsafe { w.bits(then) });
        }
    }
}

/// Level of the emergency input: a normally closed contact to ground, so that a broken wire stops, too.
pub(crate) struct Contact;

impl Contact {
    /// Whether the contact is open.
    #[inline]
    pub(crate) fn is_open(&self) -> bool {
        registers::<this::Contact>().idr().read().bits() >> <this::Contact as Place>::NUMBER & 1 != 0
    }
}

/// Interrupt of the emergency input.
pub(crate) struct EmergencyInput;

impl EmergencyInput {
    /// Takes the interrupt.
    pub(crate) fn acknowledge(&mut self) {
        // SAFETY: a one clears the pending bit of its line, zeros do nothing; nobody else uses this line.
        #[allow(unsafe_code, reason = "the HAL's pin would have to be erased")]
        unsafe {
            (*EXTI::ptr()).pr().write(|w| w.bits(1 << <this::Contact as Place>::NUMBER));
        }
    }
}
