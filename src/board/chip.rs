//! What real chips share: the step timer, the step port, the emergency input.

use handcnc::background::status::Faults;
use handcnc::foreground::Command;
use interp_core::channel::{Report, State};
use interp_core::train::Levels;
use stm32f4xx_hal::gpio::{AnyPin, Edge, ExtiPin, Input};
use stm32f4xx_hal::pac::{EXTI, TIM5};
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};
use stm32f4xx_hal::syscfg::SysCfg;

/// Pins of one lathe: X step, X direction, Z step, Z direction.
pub(crate) const LATHE_PINS: u32 = 0xF;

/// TIM5 as the train's clock, 12 MHz.
///
/// It counts from 0 at each event; writing ARR sets when the present event ends. So an event begins exactly the
/// interval after the one before it, whatever the handler's latency, which is jitter of the pins but never drift. ARR
/// is not buffered: should the handler come so late that the counter has passed the new value, it is moved on at once
/// and the late event counted.
pub(crate) struct StepTimer {
    timer: TIM5,
}

impl StepTimer {
    /// Starts the clock with an idle tick. `prescaler` makes 12 MHz of the timer's clock.
    pub(crate) fn start(timer: TIM5, prescaler: u16, rcc: &mut Rcc) -> Self {
        TIM5::enable(rcc);
        TIM5::reset(rcc);
        timer.psc().write(|w| w.psc().set(prescaler.wrapping_sub(1)));
        timer.arr().write(|w| w.arr().set(interp_core::config::TICK_CLOCKS.wrapping_sub(1)));
        // the prescaler is taken over at an update, which must not count as an event
        timer.cr1().write(|w| w.urs().set_bit());
        timer.egr().write(|w| w.ug().set_bit());
        timer.sr().write(|w| w.uif().clear_bit());
        timer.dier().write(|w| w.uie().set_bit());
        timer.cr1().write(|w| w.urs().set_bit().cen().set_bit());
        Self { timer }
    }

    /// Takes the interrupt.
    #[inline]
    pub(crate) fn acknowledge(&mut self) {
        self.timer.sr().write(|w| w.uif().clear_bit());
    }

    /// Lets the present event last `clocks`. True where it is over already: then the next one begins at once.
    #[inline]
    pub(crate) fn load(&mut self, clocks: u32) -> bool {
        self.timer.arr().write(|w| w.arr().set(clocks.wrapping_sub(1)));
        let late = self.timer.cnt().read().cnt().bits() >= clocks;
        if late {
            self.hurry();
        }
        late
    }

    /// The event is over already.
    #[cold]
    fn hurry(&mut self) {
        // with URS set this raises no interrupt, so it is pended by hand
        self.timer.egr().write(|w| w.ug().set_bit());
        cortex_m::peripheral::NVIC::pend(stm32f4xx_hal::pac::Interrupt::TIM5);
    }
}

/// Stops the train: no event after this one.
pub(crate) fn stop_train() {
    // SAFETY: one write that stops the counter; whatever the owner of the timer does next starts nothing.
    #[allow(unsafe_code, reason = "an emergency stops a timer that another task owns")]
    unsafe { &*TIM5::ptr() }.cr1().write(|w| w.cen().clear_bit());
}

/// Level of the emergency input: a normally closed contact to ground, so that a broken wire stops, too.
pub(crate) struct EmergencyInput(AnyPin<Input>);

impl EmergencyInput {
    /// Interrupts when the contact opens.
    pub(crate) fn new(mut pin: AnyPin<Input>, syscfg: &mut SysCfg, exti: &mut EXTI) -> Self {
        pin.make_interrupt_source(syscfg);
        pin.trigger_on_edge(exti, Edge::Rising);
        pin.enable_interrupt(exti);
        Self(pin)
    }

    /// Takes the interrupt.
    pub(crate) fn acknowledge(&mut self) {
        self.0.clear_interrupt_pending_bit();
    }
}

/// Values of BSRR for the levels of the lathe whose first pin is `first`: one write sets and clears all four.
#[inline]
pub(crate) const fn set_and_clear(levels: Levels, first: u32) -> u32 {
    let set = levels.bits() as u32 & LATHE_PINS;
    (set | (set ^ LATHE_PINS) << 16) << first
}

/// A real machine has no test bench.
pub(crate) struct Bench;

impl Bench {
    /// Commands that are due: none.
    #[inline]
    pub(crate) fn due(&mut self, _: State, _: &mut impl FnMut(Command)) {}

    /// Sees a tick.
    #[inline]
    pub(crate) fn saw(&mut self, _: &Report, _: Faults) {}
}

/// Sleeps until the next interrupt, hungry or not.
pub(crate) fn sleep(_: bool) {
    cortex_m::asm::wfi();
}
