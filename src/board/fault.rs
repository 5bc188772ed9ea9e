//! Panic and fault handlers: safe outputs first.

use core::panic::PanicInfo;

use super::{off, safe};

use cortex_m_rt::{ExceptionFrame, exception};

#[panic_handler]
// a name of its own in the image, so that the check of the call graph finds it
#[inline(never)]
fn panic(info: &PanicInfo<'_>) -> ! {
    off();
    match info.location() {
        Some(place) => defmt::error!("panic: {=str} line {=u32}", place.file(), place.line()),
        None => defmt::error!("panic"),
    }
    safe()
}

#[exception]
#[allow(unsafe_code, reason = "the attribute asks for it: the handler runs on a stack that may be damaged")]
// SAFETY: nothing of the interrupted program is used but what the chip itself has saved.
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    off();
    defmt::error!("hard fault at {=u32:#x}, called from {=u32:#x}", frame.pc(), frame.lr());
    safe()
}
