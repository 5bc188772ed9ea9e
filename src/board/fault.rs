//! Panic and fault handlers: safe outputs first.

use core::panic::PanicInfo;

use cortex_m_rt::{ExceptionFrame, exception};

#[panic_handler]
// a name of its own in the image, so that the check of the call graph finds it
#[inline(never)]
fn panic(_: &PanicInfo<'_>) -> ! {
    super::safe()
}

#[exception]
#[allow(unsafe_code, reason = "the attribute asks for it: the handler runs on a stack that may be damaged")]
// SAFETY: nothing of the interrupted program is used.
unsafe fn HardFault(_: &ExceptionFrame) -> ! {
    super::safe()
}
