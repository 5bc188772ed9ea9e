//! Log for a person with a probe: starts, alarms and faults, as `defmt` frames.
//!
//! The background logs, and so do the handlers of faults, which never return; never the pulses. So one frame is under
//! way at a time, or one that a fault cuts off, and nothing has to be masked: the ready-made transports `defmt-rtt` and
//! `defmt-semihosting` mask all interrupts while they write, pulses included, and panic when they are entered twice.
//!
//! A board gives `put`, which takes bytes or drops them, and never waits.

use core::cell::UnsafeCell;

use defmt::Encoder;

use super::this_log::put;

#[defmt::global_logger]
struct Logger;

struct Shared(UnsafeCell<Encoder>);

// SAFETY: see the module's documentation: one task logs, and handlers that never return to it.
#[allow(unsafe_code, reason = "the encoder of the only logger")]
unsafe impl Sync for Shared {}

static ENCODER: Shared = Shared(UnsafeCell::new(Encoder::new()));

// SAFETY: the frames of one context do not mix, as only one context logs; a handler begins a frame of its own.
#[allow(unsafe_code, reason = "the trait asks for it")]
unsafe impl defmt::Logger for Logger {
    fn acquire() {
        // SAFETY: nothing else refers to the encoder, see above.
        unsafe { &mut *ENCODER.0.get() }.start_frame(put);
    }

    unsafe fn flush() {}

    unsafe fn release() {
        // SAFETY: as in `acquire`.
        unsafe { &mut *ENCODER.0.get() }.end_frame(put);
    }

    unsafe fn write(bytes: &[u8]) {
        // SAFETY: as in `acquire`.
        unsafe { &mut *ENCODER.0.get() }.write(bytes, put);
    }
}
