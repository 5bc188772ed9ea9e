//! A bell: interrupts ring it, one background task sleeps until it rings.
//!
//! `spawn()` from an interrupt would fail while the task's last run is just ending, and what it was to do would wait
//! for the next ring; a task that never ends and sleeps on its waker misses none.

use core::cell::UnsafeCell;
use core::future::poll_fn;
use core::sync::atomic::{AtomicBool, Ordering};
use core::task::{Poll, Waker};

/// Wakes one task.
pub(crate) struct Bell {
    waker: UnsafeCell<Option<Waker>>,
    hung: AtomicBool,
}

// SAFETY: the waker is written once, by the only task that sleeps on the bell, before `hung` is set; `ring` reads it
// only after it has seen `hung`, and nothing writes it again.
#[allow(unsafe_code, reason = "a waker handed to interrupts, without a critical section")]
unsafe impl Sync for Bell {}

impl Bell {
    /// A bell that nobody hears.
    pub(crate) const fn new() -> Self {
        Self { waker: UnsafeCell::new(None), hung: AtomicBool::new(false) }
    }

    /// Rings: the task runs once more, also if it is running now.
    pub(crate) fn ring(&self) {
        if !self.hung.load(Ordering::Acquire) {
            return;
        }
        // SAFETY: `hung` is set, so the waker was written before and is never written again.
        #[allow(unsafe_code, reason = "see the impl of Sync")]
        let waker = unsafe { &*self.waker.get() };
        if let Some(waker) = waker {
            waker.wake_by_ref();
        }
    }

    /// Sleeps until the bell rings. To be called by one task only.
    pub(crate) async fn sleep(&self) {
        let mut slept = false;
        poll_fn(|context| {
            if !self.hung.load(Ordering::Relaxed) {
                // SAFETY: `hung` is not set, so `ring` does not look, and no other task calls `sleep`.
                #[allow(unsafe_code, reason = "see the impl of Sync")]
                let place = unsafe { &mut *self.waker.get() };
                *place = Some(context.waker().clone());
                self.hung.store(true, Ordering::Release);
            }
            if slept {
                return Poll::Ready(());
            }
            slept = true;
            Poll::Pending
        })
        .await;
    }
}
