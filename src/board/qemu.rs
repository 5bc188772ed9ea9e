//! QEMU 7.2's `netduinoplus2`: an STM32F405 with timers 2 to 5, the serial ports and the interrupt controller, and
//! without ports, clock tree, TIM1 and DMA. For tests.
//!
//! QEMU's `-d unimp` logs each write to what it lacks, in order and with its value. So this board's port is GPIOE's
//! ODR, and each interval goes to GPIOF's ODR, too: the log has a pair of port and interval for every event that the
//! core really played; bit 15 of an interval says that the event is a pulse whose fall TIM1 and DMA make (`fall`), whose
//! registers are logged, too. TIM1's CCR1 gets a mark when the lathe's state changes, its CCR2 one when the train ran empty
//! or lost events.
//!
//! TIM5 counts nanoseconds here; an interval is 0.002 % short, so that it costs few instructions. Its model adds whatever a write of PSC, CNT or
//! EGR leaves behind to every later alarm, so those are never written; writing ARR restarts the wait.
//!
//! The words of semihosting's command line (`-semihosting-config arg=..`) are `name=value` for a parameter and
//! `log=FILE` for a log,
//! `TICK:hold`, `TICK:start`, `TICK:reset`, `TICK:override=PERCENT` for a command at a tick of the cycle.

use handcnc::background::keeper::{Backup, WORDS};
use handcnc::background::parameters::Parameters;
use handcnc::foreground::Foreground;
use handcnc::foreground::alarm::Faults;
use handcnc::foreground::outputs::Outputs;
use handcnc::foreground::panel::Keys;
use handcnc::foreground::rehearsal::{Act, Rehearsal};
use handcnc::foreground::train_queue::Play;
use interp_core::channel::{Report, State};
use interp_core::config::TICK_CLOCKS;
use stm32f4xx_hal::pac::{self, GPIOE, GPIOF, Peripherals, TIM1, TIM5};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Config;

use super::registers::Registers;
use super::{Board, fall, host_log, link_port};

/// TIM1's clock would be the chip's 16 MHz, and the pulses too short; there are no pins.
pub(crate) const FALL_DIVIDER: u16 = 1;

/// Would lower the step pins.
static LOWER: u32 = 5 << 16;

/// Sets the board up.
pub(crate) fn setup(dp: Peripherals) -> Board {
    let mut rcc = dp.RCC.freeze(Config::hsi());
    let gpioa = dp.GPIOA.split(&mut rcc);
    let (receiver, sender) = link_port::open(dp.USART2, (gpioa.pa2, gpioa.pa3), &mut rcc);
    let mut parameters = Parameters::new();
    let mut rehearsal = Rehearsal::new();
    each_word(&mut |word| {
        if !set(word, &mut parameters, &mut rehearsal) {
            fail(word);
        }
    });
    let port = StepPort::new(dp.GPIOE, dp.GPIOF);
    let (fall, width) = fall::new(dp.TIM1, dp.DMA2, port.0.port.bsrr().as_ptr(), &LOWER, &mut rcc);
    Board {
        timer: StepTimer::new(dp.TIM5),
        port,
        fall,
        width,
        drives: Drives,
        backup: Memory,
        emergency: EmergencyInput,
        contact: Contact,
        controls: Controls,
        receiver,
        sender,
        watchdog: Watchdog,
        restarted: false,
        bench: Bench { rehearsal, state: State::Idle, mark: Mark },
        parameters,
    }
}

/// The train's clock.
pub(crate) struct StepTimer {
    timer: Registers<pac::tim5::RegisterBlock>,
}

impl StepTimer {
    fn new(timer: TIM5) -> Self {
        timer.dier().write(|w| w.uie().set_bit());
        timer.arr().write(|w| w.arr().set(nanoseconds(TICK_CLOCKS)));
        // SAFETY: the timer's only owner gives it up here, for ever.
        #[allow(unsafe_code, reason = "the registers for ever")]
        Self { timer: unsafe { Registers::new(TIM5::ptr()) } }
    }

    /// Starts the clock with an idle tick. The emulated counter has run since its limit was set, and one that is past it comes
    /// round after 4 s only.
    pub(crate) fn start(&mut self) {
        self.timer.cr1().write(|w| w.cen().set_bit());
        self.timer.cnt().write(|w| w.cnt().set(0));
    }

    /// Takes the interrupt.
    #[inline]
    pub(crate) fn acknowledge(&mut self) {
        self.timer.sr().write(|w| w.uif().clear_bit());
    }

    /// Lets the present event last `clocks`. The emulated handler is never late.
    #[inline]
    pub(crate) fn load(&mut self, clocks: u32) -> bool {
        self.timer.arr().write(|w| w.arr().set(nanoseconds(clocks)));
        false
    }
}

/// Clocks of 12 MHz in nanoseconds, 83.332 for 83.333.
const fn nanoseconds(clocks: u32) -> u32 {
    clocks.wrapping_mul(21_333) >> 8
}

/// The step port's registers and, behind them, those of the next port, which take the intervals.
#[repr(C)]
struct Ports {
    port: pac::gpioe::RegisterBlock,
    gap: [u8; 0x400 - size_of::<pac::gpioe::RegisterBlock>()],
    shadow: pac::gpioe::RegisterBlock,
}

/// The step port, and the shadow of the intervals.
pub(crate) struct StepPort(Registers<Ports>);

impl StepPort {
    /// Takes the port and the one behind it.
    fn new(_: GPIOE, _: GPIOF) -> Self {
        // SAFETY: the ports' only owners give them up here, for ever; GPIOF lies 0x400 behind GPIOE.
        #[allow(unsafe_code, reason = "the registers for ever")]
        Self(unsafe { Registers::new(GPIOE::ptr().cast()) })
    }

    /// Writes all levels, and for the log the interval.
    #[inline]
    pub(crate) fn write(&mut self, play: Play) {
        // SAFETY: any value may stand there; the emulator only logs it.
        #[allow(unsafe_code, reason = "registers that the emulator lacks")]
        unsafe {
            self.0.port.odr().write(|w| w.bits(u32::from(play.levels().bits())));
            self.0.shadow.odr().write(|w| w.bits(play.word() & 0xFFFF));
        }
    }
}

/// No backup memory: an emulated machine is always a new one, and where it begins is known.
pub(crate) struct Memory;

impl Memory {
    /// See above.
    pub(crate) const DOUBTFUL: bool = false;
}

impl Backup for Memory {
    fn read(&self) -> [u32; WORDS] {
        [0; WORDS]
    }

    fn write(&mut self, _: usize, _: &[u32]) {}
}

/// No drives.
#[derive(Copy, Clone)]
pub(crate) struct Drives;

impl Drives {
    /// Nothing to switch.
    pub(crate) fn follow(&mut self, _: Outputs) {}

    /// Nothing to switch off.
    pub(crate) fn off(&mut self) {}
}

/// No watchdog.
pub(crate) struct Watchdog;

impl Watchdog {
    /// Nothing to feed.
    pub(crate) fn feed(&mut self) {}
}

/// No emergency input.
pub(crate) struct Contact;

impl Contact {
    /// Never open.
    pub(crate) const fn is_open(&self) -> bool {
        false
    }
}

/// No panel: an operator is [rehearsed](Bench).
pub(crate) struct Controls;

impl Controls {
    /// Nothing to read.
    #[inline]
    pub(crate) fn read(&mut self, _: &mut Foreground<'_>) -> Keys {
        Keys::default()
    }
}

/// Nothing to tell.
pub(crate) struct Teller;

impl Teller {
    /// Has told nothing.
    pub(crate) const fn new() -> Self {
        Self
    }

    /// Tells nothing.
    #[inline]
    pub(crate) fn tell(&mut self) {}
}

/// No emergency input.
pub(crate) struct EmergencyInput;

impl EmergencyInput {
    /// Nothing to take.
    pub(crate) fn acknowledge(&mut self) {}
}

/// Commands at given ticks, and marks in the log.
pub(crate) struct Bench {
    rehearsal: Rehearsal,
    state: State,
    mark: Mark,
}

impl Bench {
    /// What the operator does now.
    pub(crate) fn due(&mut self, state: State, act: &mut impl FnMut(Act)) {
        self.rehearsal.due(state, act);
    }

    /// Marks a change of state, and faults, in the log.
    pub(crate) fn saw(&mut self, report: &Report, faults: Faults) {
        if faults != Faults::default() {
            self.mark.fault(faults);
        }
        if report.state != self.state {
            self.state = report.state;
            self.mark.write(report.state);
        }
    }
}

/// TIM1's CCR1 and CCR2.
struct Mark;

impl Mark {
    fn write(&mut self, state: State) {
        let word = handcnc::foreground::state_word(state);
        // SAFETY: the emulator has no TIM1 and logs the write; the owner of TIM1 uses another register.
        #[allow(unsafe_code, reason = "a register that the emulator lacks")]
        unsafe { &*TIM1::ptr() }.ccr1().write(|w| unsafe { w.bits(word) });
    }

    #[cold]
    fn fault(&mut self, faults: Faults) {
        let word = faults.underruns << 16 | faults.overruns & 0xFFFF;
        // SAFETY: as for the state.
        #[allow(unsafe_code, reason = "a register that the emulator lacks")]
        unsafe { &*TIM1::ptr() }.ccr2().write(|w| unsafe { w.bits(word) });
    }
}

/// Gives the words of semihosting's command line but for the first, the program's name.
fn each_word(give: &mut impl FnMut(&str)) {
    const GET_COMMAND_LINE: usize = 0x15;
    let mut text = [0_u8; 2048];
    let mut block = [text.as_mut_ptr() as usize, text.len()];
    // SAFETY: semihosting writes at most as many bytes as the block says into the buffer that it names.
    #[allow(unsafe_code, reason = "a call to the emulator")]
    let answer = unsafe { cortex_m_semihosting::syscall1(GET_COMMAND_LINE, block.as_mut_ptr() as usize) };
    if answer != 0 {
        return;
    }
    for word in text.split(|byte| matches!(byte, 0 | b' ')).filter(|word| !word.is_empty()).skip(1) {
        give(core::str::from_utf8(word).unwrap_or("?"));
    }
}

/// Obeys one word. False where it is none.
fn set(word: &str, parameters: &mut Parameters, rehearsal: &mut Rehearsal) -> bool {
    if let Some(path) = word.strip_prefix("log=") {
        return host_log::open(path);
    }
    if word.contains(':') {
        return rehearsal.set_word(word);
    }
    word.split_once('=').is_some_and(|(name, value)| parameters.set(name, value).is_ok())
}

/// Says what is wrong with the emulator's command line, and ends it.
fn fail(word: &str) {
    cortex_m_semihosting::hprintln!("the image does not understand `{}`", word);
    safe()
}

/// Waits for the next interrupt. While the lathe is hungry for blocks the emulated time is braked instead, so that a
/// sender on a busy computer is never late: each call costs the emulator microseconds, the machine a few instructions.
pub(crate) fn sleep(hungry: bool) {
    if !hungry {
        return cortex_m::asm::wfi();
    }
    const CLOCK: usize = 0x10;
    // SAFETY: the call takes no argument and returns a number.
    #[allow(unsafe_code, reason = "a call to the emulator")]
    let _: usize = unsafe { cortex_m_semihosting::syscall1(CLOCK, 0) };
}

/// Where a fault ends: the emulator, too.
pub(crate) fn safe() -> ! {
    cortex_m::interrupt::disable();
    cortex_m_semihosting::debug::exit(cortex_m_semihosting::debug::EXIT_FAILURE);
    loop {
        cortex_m::asm::nop();
    }
}
