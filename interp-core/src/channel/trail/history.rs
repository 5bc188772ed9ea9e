//! The history: the motions begun last, packed, the oldest overwritten.
//!
//! A place in it is counted from the first motion ever on, modulo 2^32, so it stays the same while others come and go.

use super::record::{Kept, Slot};

/// Slots of the history, a power of two. A motion takes one of 32 bytes, rare ones two: 32 KiB hold at least a thousand
/// usual blocks.
const SLOTS: usize = 1024;

#[expect(clippy::cast_possible_truncation, reason = "a small constant")]
const LENGTH: u32 = SLOTS as u32;

/// The motions begun last, where drives that go back find them.
#[derive(Clone, Debug)]
pub(super) struct History {
    slots: [Slot; SLOTS],
    /// Where the next one goes.
    next: u32,
    used: u32,
    /// The place of the motion noted last.
    newest: u32,
}

impl History {
    /// Of no motion.
    pub(super) const fn new() -> Self {
        Self { slots: [Slot::NONE; SLOTS], next: 0, used: 0, newest: 0 }
    }

    fn slot(&self, place: u32) -> &Slot {
        let index = usize::try_from(place).unwrap_or(0) & (SLOTS - 1);
        self.slots.get(index).unwrap_or(&Slot::NONE)
    }

    fn append(&mut self, slot: Slot) {
        let index = usize::try_from(self.next).unwrap_or(0) & (SLOTS - 1);
        if let Some(place) = self.slots.get_mut(index) {
            *place = slot;
        }
        self.next = self.next.wrapping_add(1);
        self.used = self.used.saturating_add(1).min(LENGTH);
    }

    /// Notes a motion; its place, and whether an older one had to go.
    pub(super) fn push(&mut self, kept: &Kept) -> (u32, bool) {
        let (main, rest) = Slot::pack(kept);
        let full = self.used.saturating_add(1).saturating_add(u32::from(rest.is_some())) > LENGTH;
        self.newest = self.next;
        self.append(main);
        if let Some(rest) = rest {
            self.append(rest);
        }
        (self.newest, full)
    }

    /// Forgets all.
    pub(super) const fn clear(&mut self) {
        self.used = 0;
    }

    /// Whether there are no more than so many motions.
    pub(super) fn is_within(&self, motions: usize) -> bool {
        usize::try_from(self.used).is_ok_and(|used| used <= motions)
    }

    /// The place of the motion noted last.
    pub(super) const fn newest(&self) -> u32 {
        self.newest
    }

    /// The line of the motion noted last.
    pub(super) fn line(&self) -> u32 {
        self.slot(self.newest).line()
    }

    const fn holds(&self, place: u32) -> bool {
        let age = self.next.wrapping_sub(place);
        age > 0 && age <= self.used
    }

    /// The place of the motion before the one at `place`.
    pub(super) fn before(&self, place: u32) -> Option<u32> {
        let mut before = place.wrapping_sub(1);
        if self.holds(before) && self.slot(before).is_rest() {
            before = before.wrapping_sub(1);
        }
        self.holds(before).then_some(before)
    }

    /// The place of the motion after the one at `place`.
    pub(super) fn after(&self, place: u32) -> Option<u32> {
        let mut after = place.wrapping_add(1);
        if self.holds(after) && self.slot(after).is_rest() {
            after = after.wrapping_add(1);
        }
        self.holds(after).then_some(after)
    }

    /// Whether the motion at `place` can be made again.
    pub(super) fn can_be_made(&self, place: u32) -> bool {
        self.holds(place) && self.slot(place).can_be_made()
    }

    /// What is kept at `place`.
    pub(super) fn get(&self, place: u32) -> Option<Kept> {
        self.holds(place).then(|| self.slot(place).unpack(self.slot(place.wrapping_add(1))))
    }
}
