//! Boards: the only code that knows a register.
//!
//! Each board is a module with the same `setup() -> Board` and the pins in its own documentation. What boards share
//! stands beside them: `chip` and `pins` have what all real ones do alike, `controls` and `quadrature` what they read of
//! the operator, `backup` the memory that outlives a loss of power, `fall` the falling edges, `link_port` the serial port, `fault` the
//! handlers of faults, `log` the log, which leaves by `rtt` or `host_log`. All boards use the same interrupts
//! (a task of the app names one): TIM5 for steps, USART2 for the link, EXTI15_10 for the emergency stop, I2C3_ER for
//! the interpolator and I2C3_EV for the background (the last two stand for no device).
//!
//! The only `unsafe` of the firmware is here.

#[cfg(not(feature = "board-qemu"))]
mod backup;
mod copy;
mod fall;
mod fault;
#[cfg(feature = "board-qemu")]
mod host_log;
mod link_port;
mod log;

#[cfg(not(feature = "board-qemu"))]
mod chip;
#[cfg(not(feature = "board-qemu"))]
mod controls;
#[cfg(feature = "board-f407")]
mod f407;
#[cfg(feature = "board-f411")]
mod f411;
#[cfg(feature = "board-f446")]
mod f446;
#[cfg(not(feature = "board-qemu"))]
mod pins;
#[cfg(feature = "board-qemu")]
mod qemu;
#[cfg(not(feature = "board-qemu"))]
mod quadrature;
mod registers;
#[cfg(not(feature = "board-qemu"))]
mod rtt;

#[cfg(feature = "board-f407")]
use f407 as this;
#[cfg(feature = "board-f411")]
use f411 as this;
#[cfg(feature = "board-f446")]
use f446 as this;
#[cfg(feature = "board-qemu")]
use qemu as this;

#[cfg(feature = "board-qemu")]
use host_log as this_log;
#[cfg(not(feature = "board-qemu"))]
use rtt as this_log;

#[cfg(not(any(feature = "board-f407", feature = "board-f411", feature = "board-f446", feature = "board-qemu")))]
compile_error!("name a board: --features board-f407, board-f411, board-f446 or board-qemu (cargo xtask firmware does)");
// two boards name two chips, which the HAL refuses

use handcnc::background::parameters::Parameters;

#[cfg(not(feature = "board-qemu"))]
pub(crate) use backup::Memory;
#[cfg(not(feature = "board-qemu"))]
pub(crate) use chip::{Bench, StepTimer, Watchdog, safe, sleep};
#[cfg(not(feature = "board-qemu"))]
pub(crate) use controls::{Controls, Teller};
pub(crate) use fall::{Fall, Width};
pub(crate) use link_port::{Receiver, Sender};
#[cfg(not(feature = "board-qemu"))]
pub(crate) use pins::{Contact, Drives, EmergencyInput, StepPort};
pub(crate) use this::setup;
#[cfg(feature = "board-qemu")]
pub(crate) use this::{
    Bench, Contact, Controls, Drives, EmergencyInput, Memory, StepPort, StepTimer, Teller, Watchdog, safe, sleep,
};

/// Masks interrupts and switches all off: a fault's first step.
fn off() {
    cortex_m::interrupt::disable();
    Drives.off();
}

/// A panic that the compiler can't see coming.
#[cfg(feature = "planted-panic")]
pub(crate) fn plant() {
    let places = [1, 2, 3];
    #[allow(clippy::indexing_slicing, reason = "planted")]
    core::hint::black_box(places[core::hint::black_box(3_usize)]);
}

/// What a board gives.
pub(crate) struct Board {
    /// Waits the intervals of the train.
    pub(crate) timer: StepTimer,
    /// Step and direction pins.
    pub(crate) port: StepPort,
    /// Lowers the step pins of a pulse.
    pub(crate) fall: Fall,
    /// How long a pulse is.
    pub(crate) width: Width,
    /// Enable pins of motor drivers and spindle.
    pub(crate) drives: Drives,
    /// What a loss of power leaves.
    pub(crate) backup: Memory,
    /// Interrupt of the emergency stop.
    pub(crate) emergency: EmergencyInput,
    /// Level of the emergency stop.
    pub(crate) contact: Contact,
    /// Wheels, spindle, panel.
    pub(crate) controls: Controls,
    /// The link's bytes in.
    pub(crate) receiver: Receiver,
    /// The link's bytes out.
    pub(crate) sender: Sender,
    /// Restarts the chip unless it is fed.
    pub(crate) watchdog: Watchdog,
    /// The watchdog has restarted the chip.
    pub(crate) restarted: bool,
    /// What a test bench asks for.
    pub(crate) bench: Bench,
    /// The machine's parameters.
    pub(crate) parameters: Parameters,
}
