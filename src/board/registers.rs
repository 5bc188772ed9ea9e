//! A peripheral's registers through a pointer.
//!
//! An address in the code takes two instructions at each use. A pointer stands in memory beside what else a handler
//! needs, and one instruction loads two of them.

use core::ops::Deref;

/// The registers of a peripheral that has no other owner.
pub(crate) struct Registers<T: 'static>(&'static T);

// SAFETY: whoever made it promised that nobody else owns the peripheral, so it may be used in any one context.
#[allow(unsafe_code, reason = "registers are not Sync, since two owners could write them")]
unsafe impl<T> Send for Registers<T> {}

impl<T> Registers<T> {
    /// Takes the registers for ever.
    ///
    /// # Safety
    /// `block` must be a peripheral's registers, and nothing else may use those that this one's owner writes.
    #[allow(unsafe_code, reason = "a pointer to a peripheral")]
    pub(crate) const unsafe fn new(block: *const T) -> Self {
        // SAFETY: registers are there for ever.
        Self(unsafe { &*block })
    }
}

impl<T> Deref for Registers<T> {
    type Target = T;

    #[inline(always)]
    fn deref(&self) -> &T {
        self.0
    }
}
