//! Keys of a board's panel on their way to the link.
//!
//! The interpolator sees a key go down and marks it; the background takes the marks and tells the link what the same byte
//! of a sender would. A key that goes down again before its mark was taken is the same mark.

use super::link::Realtime;
use crate::foreground::panel::Keys;
use core::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Keys that went down and of which the link does not know yet.
#[derive(Debug, Default)]
pub struct Pressed {
    reset: AtomicBool,
    start: AtomicBool,
    hold: AtomicBool,
}

impl Pressed {
    /// None.
    pub const fn new() -> Self {
        Self { reset: AtomicBool::new(false), start: AtomicBool::new(false), hold: AtomicBool::new(false) }
    }

    /// Marks keys. From the interpolator only.
    #[inline]
    pub fn mark(&self, keys: Keys) {
        if keys == Keys::default() {
            return;
        }
        for (key, mark) in [(keys.reset, &self.reset), (keys.start, &self.start), (keys.hold, &self.hold)] {
            if key {
                mark.store(true, Relaxed);
            }
        }
    }

    /// What one of them asks for: a hold last, so that of a hold and a start the hold counts. From one task only, of lower
    /// priority.
    pub fn take(&self) -> Option<Realtime> {
        let marks = [(&self.reset, Realtime::Reset), (&self.start, Realtime::Start), (&self.hold, Realtime::Hold)];
        let (mark, what) = marks.into_iter().find(|(mark, _)| mark.load(Relaxed))?;
        mark.store(false, Relaxed);
        Some(what)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_key_is_told_once_and_a_hold_last() {
        let pressed = Pressed::new();
        assert_eq!(pressed.take(), None);
        pressed.mark(Keys { start: true, hold: true, reset: false });
        pressed.mark(Keys { start: false, hold: true, reset: true });
        pressed.mark(Keys::default());
        let told = [(); 4].map(|()| pressed.take());
        assert_eq!(told, [Some(Realtime::Reset), Some(Realtime::Start), Some(Realtime::Hold), None]);
    }
}
