//! What real chips share: all but the pins and the clock, which a board's own module gives.

use handcnc::foreground::alarm::Faults;
use handcnc::foreground::rehearsal::Act;
use interp_core::channel::{Report, State};
use interp_core::train::Levels;
use stm32f4xx_hal::gpio::alt::SerialAsync as CommonPins;
use stm32f4xx_hal::gpio::{ExtiPin, PushPull};
use stm32f4xx_hal::pac::{DMA2, EXTI, IWDG, PWR, RCC, RTC, SYSCFG, TIM1, TIM5, USART2, tim5};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};
use stm32f4xx_hal::watchdog::IndependentWatchdog;

use super::backup::Memory;
use super::controls::Controls;
use super::pins::{Contact, Drives, EmergencyInput, StepPort};
use super::registers::Registers;
use super::this::TIMER_DIVIDER;
use super::{Board, fall, link_port};

/// Pins of one lathe: X step, X direction, Z step, Z direction.
const LATHE_PINS: u32 = 0xF;

/// How long the watchdog waits, milliseconds of its own clock, which runs at 0.53 to 1.5 times its nominal rate.
const WATCHDOG_MS: u32 = 250;

/// Devices that every board uses, besides its pins.
pub(crate) struct Devices<L> {
    pub(crate) syscfg: SYSCFG,
    pub(crate) exti: EXTI,
    pub(crate) timer: TIM5,
    /// Timer and DMA of falling edges.
    pub(crate) fall: (TIM1, DMA2),
    pub(crate) watchdog: IWDG,
    /// Backup memory, and what opens it.
    pub(crate) memory: (RTC, PWR),
    pub(crate) usart: USART2,
    /// The link's pins: transmit, receive.
    pub(crate) link: L,
    /// What the operator has.
    pub(crate) controls: Controls,
}

/// Sets up what the boards have in common. `restarted`: see [`was_restarted`].
pub(crate) fn board<T, R>(
    devices: Devices<(T, R)>,
    steps: StepPort,
    drives: Drives,
    mut contact: impl ExtiPin,
    restarted: bool,
    rcc: &mut Rcc,
) -> Board
where
    T: Into<<USART2 as CommonPins>::Tx<PushPull>>,
    R: Into<<USART2 as CommonPins>::Rx<PushPull>>,
{
    let Devices { syscfg, mut exti, timer, fall, watchdog, memory, usart, link, controls } = devices;
    let mut syscfg = syscfg.constrain(rcc);
    contact.make_interrupt_source(&mut syscfg);
    contact.trigger_on_edge(&mut exti, stm32f4xx_hal::gpio::Edge::Rising);
    contact.enable_interrupt(&mut exti);
    let (receiver, sender) = link_port::open(usart, link, rcc);
    let timer = StepTimer::new(timer, TIMER_DIVIDER, rcc);
    let (bsrr, lower) = steps.lowering();
    let (fall, width) = fall::new(fall.0, fall.1, bsrr, lower, rcc);
    Board {
        timer,
        port: steps,
        fall,
        width,
        drives,
        backup: Memory::open(memory.0, &memory.1, rcc),
        emergency: EmergencyInput,
        contact: Contact,
        controls,
        receiver,
        sender,
        watchdog: Watchdog::start(watchdog),
        bench: Bench,
        restarted,
        parameters: handcnc::background::parameters::Parameters::new(),
    }
}

/// Whether the watchdog has restarted the chip. Forgets why it was started.
pub(crate) fn was_restarted(rcc: &RCC) -> bool {
    let restarted = rcc.csr().read().wdgrstf().bit_is_set();
    rcc.csr().modify(|_, w| w.rmvf().set_bit());
    restarted
}

/// Restarts the chip unless it is fed.
pub(crate) struct Watchdog(IndependentWatchdog);

impl Watchdog {
    fn start(device: IWDG) -> Self {
        let mut watchdog = IndependentWatchdog::new(device);
        watchdog.start(WATCHDOG_MS.millis());
        Self(watchdog)
    }

    /// Feeds it.
    #[inline]
    pub(crate) fn feed(&mut self) {
        self.0.feed();
    }
}

/// TIM5 as the train's clock, 12 MHz.
///
/// It counts from 0 at each event; writing ARR sets when the present event ends. So an event begins exactly the
/// interval after the one before it, whatever the handler's latency, which is jitter of the pins but never drift. ARR
/// is not buffered: should the handler come so late that the counter has passed the new value, it is moved on at once
/// and the late event counted.
pub(crate) struct StepTimer {
    timer: Registers<tim5::RegisterBlock>,
}

impl StepTimer {
    /// Sets the clock up, which still stands. `prescaler` makes 12 MHz of the timer's clock.
    fn new(timer: TIM5, prescaler: u16, rcc: &mut Rcc) -> Self {
        TIM5::enable(rcc);
        TIM5::reset(rcc);
        timer.psc().write(|w| w.psc().set(prescaler.wrapping_sub(1)));
        timer.arr().write(|w| w.arr().set(interp_core::config::TICK_CLOCKS.wrapping_sub(1)));
        // the prescaler is taken over at an update, which must not count as an event
        timer.cr1().write(|w| w.urs().set_bit());
        timer.egr().write(|w| w.ug().set_bit());
        timer.sr().write(|w| w.uif().clear_bit());
        timer.dier().write(|w| w.uie().set_bit());
        // SAFETY: the timer's only owner gives it up here, for ever.
        #[allow(unsafe_code, reason = "the registers for ever")]
        Self { timer: unsafe { Registers::new(TIM5::ptr()) } }
    }

    /// Starts the clock with an idle tick. Last of all: a tick later the train must be there.
    pub(crate) fn start(&mut self) {
        self.timer.cr1().write(|w| w.urs().set_bit().cen().set_bit());
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

/// Values of BSRR for the levels of the lathe whose first pin is `first`: one write sets and clears all four.
#[inline]
pub(crate) const fn set_and_clear(levels: Levels, first: u32) -> u32 {
    let set = levels.bits() as u32 & LATHE_PINS;
    (set | (set ^ LATHE_PINS) << 16) << first
}

/// Where a fault ends: all off, until the watchdog restarts the chip.
pub(crate) fn safe() -> ! {
    super::off();
    loop {
        cortex_m::asm::nop();
    }
}

/// A real machine has no test bench.
pub(crate) struct Bench;

impl Bench {
    /// Nothing is rehearsed: see [`Controls`].
    #[inline]
    pub(crate) fn due(&mut self, _: State, _: &mut impl FnMut(Act)) {}

    /// Sees a tick.
    #[inline]
    pub(crate) fn saw(&mut self, _: &Report, _: Faults) {}
}

/// Sleeps until the next interrupt, hungry or not.
pub(crate) fn sleep(_: bool) {
    cortex_m::asm::wfi();
}
