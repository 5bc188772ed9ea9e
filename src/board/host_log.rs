//! The log's way out of the emulator: a file of the host, by semihosting. Without the word `log=FILE` on the emulator's
//! command line nothing is written, and a run is as it would be without a log.

use core::sync::atomic::{AtomicUsize, Ordering};

use cortex_m_semihosting::syscall;

/// Handle of the open file; 0 for none (the host's handles begin at 1).
static FILE: AtomicUsize = AtomicUsize::new(0);

/// Opens `path`, at most 255 bytes. False where that fails.
pub(crate) fn open(path: &str) -> bool {
    let mut name = [0_u8; 256];
    let Some(place) = name.get_mut(..path.len()).filter(|place| place.len() < 256) else { return false };
    place.copy_from_slice(path.as_bytes());
    // SAFETY: the call reads the name, which ends with a zero; 5 is "wb".
    #[allow(unsafe_code, reason = "a call to the emulator")]
    let handle = unsafe { syscall!(OPEN, name.as_ptr(), 5, path.len()) };
    FILE.store(if handle == usize::MAX { 0 } else { handle }, Ordering::Relaxed);
    handle != usize::MAX
}

/// Writes bytes, where a file is open.
pub(crate) fn put(bytes: &[u8]) {
    let file = FILE.load(Ordering::Relaxed);
    if file != 0 {
        // SAFETY: the call reads the bytes.
        #[allow(unsafe_code, reason = "a call to the emulator")]
        let _: usize = unsafe { syscall!(WRITE, file, bytes.as_ptr(), bytes.len()) };
    }
}
