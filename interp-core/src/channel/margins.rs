//! How far around a joint the lead keeps a speed under an S law.
//!
//! The tool's advance is the mean of the lead's last N ticks, so at a joint it still has a part of the speed that the lead
//! had before it, or has already one of that behind. The lead therefore keeps the largest speed c of a joint from
//! `c (N + 1) / 2` before it until as much behind it; then the window reaches outside only while the tool is still before the joint, or
//! already behind it (proved in `docs/src/speed.md`). Margins of several joints overlap where blocks are short: of
//! those, the ones that matter form a staircase, the slower the shorter, of which the three that differ most are kept.

use crate::block::{Motion, Speed};
use crate::governor::square;
use crate::math::to_u32;

/// One margin.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
struct Margin {
    /// Largest speed in it.
    cap: Speed,
    /// Length, nm; 0 where there is none.
    length: u32,
}

impl Margin {
    /// One in the place of this and a faster, longer one.
    const fn and(self, faster: Self) -> Self {
        Self { cap: self.cap, length: faster.length }
    }
}

const NONE: Margin = Margin { cap: Speed::MAX, length: 0 };

/// Length of a margin in which a mean over `ticks` may have `cap`, nm, rounded up. It is half a tick longer than the
/// proof asks for, since weights are rounded.
pub(super) fn margin(cap: Speed, ticks: u8) -> u32 {
    let twice = u64::from(cap).saturating_mul(u64::from(ticks).wrapping_add(2));
    to_u32(twice >> 13).saturating_add(1)
}

/// Up to three margins before, or behind, one place; the shorter the slower.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) struct Margins([Margin; 3]);

impl Margins {
    /// No margin.
    pub(super) const EMPTY: Self = Self([NONE; 3]);

    /// What a block keeps to whose successor is not known yet: whatever the speed of that joint, its margin can be kept
    /// from any state that keeps this one. Of all speeds c, `c^2 + 2 a (s - c t)` is least for `c = a t`.
    pub(super) fn reserve(motion: &Motion, ticks: u8) -> Self {
        let worst = u64::from(motion.accel).saturating_mul(u64::from(ticks).wrapping_add(2)) / 2;
        let cap = to_u32(worst).min(motion.limit);
        let mut margins = Self::EMPTY;
        margins.keep(cap, ticks);
        margins
    }

    /// Adds the margin of a speed.
    pub(super) fn keep(&mut self, cap: Speed, ticks: u8) {
        self.add(Margin { cap, length: margin(cap, ticks) });
    }

    /// Adds a margin. Where there are four, two neighbours become one with the slower speed and the larger length: those whose
    /// speeds differ least, so that a stop does not take the length of a fast joint near it.
    fn add(&mut self, new: Margin) {
        if self.0.iter().any(|known| known.cap <= new.cap && known.length >= new.length) {
            return;
        }
        for known in &mut self.0 {
            if known.cap >= new.cap && known.length <= new.length {
                *known = NONE;
            }
        }
        // the shortest, which is the slowest, first; no margin is the shortest
        self.sort();
        let [first, second, third] = self.0;
        if first.length == 0 {
            self.0 = [new, second, third];
            return self.sort();
        }
        let [a, b, c, d] = if new.length < first.length {
            [new, first, second, third]
        } else if new.length < second.length {
            [first, new, second, third]
        } else if new.length < third.length {
            [first, second, new, third]
        } else {
            [first, second, third, new]
        };
        // a smaller part of the faster one is lost
        let closer = |(slow, fast): (Margin, Margin), (than_slow, than_fast): (Margin, Margin)| {
            u64::from(fast.cap).saturating_mul(than_slow.cap.into())
                <= u64::from(than_fast.cap).saturating_mul(slow.cap.into())
        };
        self.0 = if closer((a, b), (b, c)) && closer((a, b), (c, d)) {
            [a.and(b), c, d]
        } else if closer((b, c), (c, d)) {
            [a, b.and(c), d]
        } else {
            [a, b, c.and(d)]
        };
    }

    fn sort(&mut self) {
        let [first, second, third] = &mut self.0;
        let order = |a: &mut Margin, b: &mut Margin| {
            if a.length > b.length {
                core::mem::swap(a, b);
            }
        };
        order(first, second);
        order(second, third);
        order(first, second);
    }

    /// The largest speed in all of them.
    pub(super) fn cap(&self) -> Speed {
        self.0.iter().fold(Speed::MAX, |least, margin| least.min(margin.cap))
    }

    /// Whether there is none.
    pub(super) const fn are_empty(&self) -> bool {
        let [.., longest] = &self.0;
        longest.length == 0
    }

    /// Length of the longest, nm with 12 fraction bits.
    pub(super) fn longest(&self) -> u64 {
        let [.., longest] = &self.0;
        u64::from(longest.length) << 12
    }

    /// What is left of each after `length` (12 fraction bits) of it.
    pub(super) fn pass(&mut self, length: u64) {
        let nm = to_u32(length >> 12);
        let [_, second, longest] = &mut self.0;
        if second.length == 0 {
            // the usual case: one at most
            longest.length = longest.length.saturating_sub(nm);
            if longest.length == 0 {
                *longest = NONE;
            }
            return;
        }
        for margin in &mut self.0 {
            margin.length = margin.length.saturating_sub(nm);
            if margin.length == 0 {
                *margin = NONE;
            }
        }
        self.sort();
    }

    /// How to go on, `left` before the end of `motion`, behind which lie these margins' place and the squared speed
    /// `exit`: the largest speed here, how far it holds, and the squared speed to be met there.
    pub(super) fn way(&self, motion: &Motion, left: u64, exit: u64) -> Way {
        let mut way = Way { cap: Speed::MAX, room: left, exit };
        let mut at = 0_u64;
        for margin in self.0.iter().filter(|margin| margin.length > 0) {
            let begin = u64::from(margin.length) << 12;
            if begin >= left {
                way.cap = margin.cap;
                break;
            }
            way.exit = motion.reachable(begin.wrapping_sub(at), way.exit).min(square(margin.cap));
            at = begin;
        }
        way.room = left.wrapping_sub(at);
        way
    }
}

/// How a lead goes on.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) struct Way {
    /// Largest speed.
    pub(super) cap: Speed,
    /// How far this holds.
    pub(super) room: u64,
    /// Squared speed to be met there.
    pub(super) exit: u64,
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Whatever is merged: every place keeps at most the speed that any margin given asks for.
        #[test]
        fn no_margin_is_forgotten(given in prop::collection::vec((1_u32..1000, 1_u32..1000), 1..12)) {
            let mut margins = Margins::EMPTY;
            for (cap, length) in &given {
                margins.add(Margin { cap: *cap, length: *length });
            }
            for place in 1..1000 {
                let asked = given.iter().filter(|(_, length)| *length >= place).map(|(cap, _)| *cap).min();
                let kept = margins.0.iter().filter(|m| m.length >= place).map(|m| m.cap).min();
                prop_assert!(kept.unwrap_or(u32::MAX) <= asked.unwrap_or(u32::MAX), "{place}: {margins:?}");
                prop_assert!(kept.is_none() || asked.is_some());
            }
            let lengths: std::vec::Vec<_> = margins.0.iter().map(|m| m.length).collect();
            prop_assert!(lengths.is_sorted());
            let steps = margins.0.iter().filter(|m| m.length > 0).map(|m| m.cap);
            prop_assert!(steps.is_sorted());
        }

        /// Up to three of them are kept as they are.
        #[test]
        fn three_margins_are_exact(given in prop::collection::vec((1_u32..1000, 1_u32..1000), 1..4)) {
            let mut margins = Margins::EMPTY;
            for (cap, length) in &given {
                margins.add(Margin { cap: *cap, length: *length });
            }
            for place in 1..1000 {
                let asked = given.iter().filter(|(_, length)| *length >= place).map(|(cap, _)| *cap).min();
                let kept = margins.0.iter().filter(|m| m.length >= place).map(|m| m.cap).min();
                prop_assert_eq!(kept, asked);
            }
        }
    }

    /// A corner taken nearly at standstill, behind joints of a smooth run: its speed is kept for its own length only.
    #[test]
    fn a_stop_keeps_its_length_beside_fast_joints() {
        let mut margins = Margins::EMPTY;
        for (cap, length) in [(700, 700), (600, 600), (500, 500), (10, 10)] {
            margins.add(Margin { cap, length });
        }
        let at = |place: u32| margins.0.iter().filter(|m| m.length >= place).map(|m| m.cap).min();
        assert_eq!((at(10), at(11), at(500), at(501)), (Some(10), Some(500), Some(500), Some(600)));
    }

    #[test]
    fn a_margin_is_half_the_mean_and_at_least_half_a_tick_more() {
        // 2 um a tick over 20 ticks
        assert_eq!(margin(2_000 << 12, 20), 22_001);
        assert_eq!(margin(1, 2), 1);
    }
}
