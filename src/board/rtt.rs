//! The log's way out of a real chip: a ring in RAM that a debug probe reads while the chip runs (SEGGER's RTT).
//!
//! The probe finds the control block by its symbol. Bytes that find the ring full are dropped: without a probe nobody
//! reads it. Source: SEGGER, UM08001 (J-Link user guide), chapter on RTT: layout of the control block.

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicU32, Ordering};

/// Bytes of the ring.
const BYTES: usize = 512;

#[repr(C)]
struct ControlBlock {
    id: [u8; 16],
    up_channels: u32,
    down_channels: u32,
    name: *const u8,
    ring: *const UnsafeCell<[u8; BYTES]>,
    size: u32,
    /// Where the chip writes next, and the probe reads next.
    write: AtomicU32,
    read: AtomicU32,
    /// 0: what does not fit is dropped.
    mode: u32,
}

struct Ring(UnsafeCell<[u8; BYTES]>);

// SAFETY: `put` alone writes the ring, from one context at a time (see `log`), and nothing on the chip reads it.
#[allow(unsafe_code, reason = "memory that a probe reads")]
unsafe impl Sync for Ring {}

// SAFETY: the pointers never change; the rest is atomic.
#[allow(unsafe_code, reason = "memory that a probe reads")]
unsafe impl Sync for ControlBlock {}

static RING: Ring = Ring(UnsafeCell::new([0; BYTES]));

/// Decoders choose the format by the name.
const NAME: &[u8; 6] = b"defmt\0";

#[allow(unsafe_code, reason = "the probe looks for this name")]
#[unsafe(export_name = "_SEGGER_RTT")]
static CONTROL: ControlBlock = ControlBlock {
    id: *b"SEGGER RTT\0\0\0\0\0\0",
    up_channels: 1,
    down_channels: 0,
    name: NAME.as_ptr(),
    ring: &raw const RING.0,
    #[expect(clippy::cast_possible_truncation, reason = "512")]
    size: BYTES as u32,
    write: AtomicU32::new(0),
    read: AtomicU32::new(0),
    mode: 0,
};

/// Puts bytes into the ring, all or none.
pub(crate) fn put(bytes: &[u8]) {
    let (mut at, read) =
        (CONTROL.write.load(Ordering::Relaxed) as usize, CONTROL.read.load(Ordering::Acquire) as usize);
    let room = read.wrapping_sub(at).wrapping_sub(1) % BYTES;
    if bytes.len() > room {
        return;
    }
    // SAFETY: nothing else on the chip refers to the ring (see the impl of Sync).
    #[allow(unsafe_code, reason = "memory that a probe reads")]
    let ring = unsafe { &mut *RING.0.get() };
    for byte in bytes {
        if let Some(place) = ring.get_mut(at % BYTES) {
            *place = *byte;
        }
        at = at.wrapping_add(1) % BYTES;
    }
    #[expect(clippy::cast_possible_truncation, reason = "below 512")]
    CONTROL.write.store(at as u32, Ordering::Release);
}
