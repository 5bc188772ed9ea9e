//! Soft limits: the fence that neither the path nor a hand leads the tool over.
//!
//! Both may move an axis at once, so each leaves the other the room that it can't help using. With the **reach** of the path, all
//! that it leads through if it brakes from now on, and the way that a hand needs to brake:
//!
//! ```text
//! a hand's room:       from the path's reach, moved by the offset, to the fence; approached with the hand's own share
//! the path goes on:    where its reach if it goes on for one more tick, the offset, and the hand's braking stay inside
//! else:                it is held, which leads through no more than the reach that the hand has left free
//! ```
//!
//! What the path leads through if it goes on for a tick is at least what it leads through if it brakes a tick later: so in a
//! tick behind one in which it was allowed to go on, the hands' room is that which it left then, and the path is looked at once.
//!
//! So what is planned of both is inside in every tick. A tool that is beyond (a limit was set to the inside of it) may come back,
//! not go farther. The path is held only where it does lead out: one that turns before the fence, or ends on it, is not.
//!
//! A thread can't be stopped in its groove: it is looked at as a whole before it begins, with the room that X needs to be pulled
//! out of it anywhere, and a hand leaves it that room.

mod reach;

use core::borrow::BorrowMut;

use super::{Channel, Memory, State};
use crate::block::Motion;
use crate::drive::Drive;
use crate::units::{Axis, Lattice};

/// Ticks at the largest speeds that are added to what braking needs at most before a limit: there the path begins to be looked
/// at, and a few ticks later the hands' room to be asked for, so that it is known then.
const PATH_AHEAD: u8 = 16;
const HANDS_AHEAD: u8 = 8;

/// As good as no limit, pulses.
const FAR: i32 = i32::MAX >> 1;

/// Places from the least to the greatest, of both axes.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) struct Span {
    pub(super) least: Lattice,
    pub(super) most: Lattice,
}

impl Span {
    pub(super) const fn at(place: Lattice) -> Self {
        Self { least: place, most: place }
    }

    fn of(a: Lattice, b: Lattice) -> Self {
        let least = Lattice { x: a.x.min(b.x), z: a.z.min(b.z) };
        Self { least, most: Lattice { x: a.x.max(b.x), z: a.z.max(b.z) } }
    }

    pub(super) fn and(self, other: Self) -> Self {
        let Self { least: a, most: b } = other;
        let least = Lattice { x: self.least.x.min(a.x), z: self.least.z.min(a.z) };
        Self { least, most: Lattice { x: self.most.x.max(b.x), z: self.most.z.max(b.z) } }
    }

    pub(super) const fn moved(self, by: Lattice) -> Self {
        Self { least: plus(self.least, by), most: plus(self.most, by) }
    }

    /// What is within so many pulses of a place.
    fn near(self, at: Lattice, (x, z): (i32, i32)) -> Self {
        let least = Lattice { x: at.x.saturating_sub(x), z: at.z.saturating_sub(z) };
        let most = Lattice { x: at.x.saturating_add(x), z: at.z.saturating_add(z) };
        Self {
            least: Lattice { x: self.least.x.max(least.x), z: self.least.z.max(least.z) },
            most: Lattice { x: self.most.x.min(most.x), z: self.most.z.min(most.z) },
        }
    }

    /// Whether a place is inside, and on no side.
    #[inline]
    const fn surrounds(&self, at: Lattice) -> bool {
        let Self { least, most } = self;
        at.x > least.x && at.x < most.x && at.z > least.z && at.z < most.z
    }

    pub(super) const fn part(&self, axis: Axis) -> (i32, i32) {
        match axis {
            Axis::X => (self.least.x, self.most.x),
            Axis::Z => (self.least.z, self.most.z),
        }
    }
}

pub(super) const fn plus(at: Lattice, by: Lattice) -> Lattice {
    Lattice { x: at.x.saturating_add(by.x), z: at.z.saturating_add(by.z) }
}

/// Where a motion ends, from where it begins.
pub(super) const fn end(motion: &Motion) -> Lattice {
    let (x, z) = motion.curve.end();
    Lattice { x, z }
}

/// All places of a motion that begins at `from`.
pub(super) fn whole(from: Lattice, motion: &Motion) -> Span {
    let ((x, z), (most_x, most_z)) = motion.curve.extent();
    Span { least: Lattice { x, z }, most: Lattice { x: most_x, z: most_z } }.moved(from)
}

/// The fence, in the program's pulses and with what the hands have added.
#[derive(Clone, Debug)]
pub(super) struct Fence {
    inside: Span,
    /// From there nothing that moves is braked past it: the path, and a hand.
    calm: Span,
    free: Span,
    /// Where the path was held: the axis, and whether to plus.
    met: Option<(Axis, bool)>,
    /// What the path leads through if it brakes in the tick to come, or more, where that is known.
    brakes: Option<Span>,
}

impl Fence {
    /// None.
    pub(super) const fn new() -> Self {
        let far = Lattice { x: FAR, z: FAR };
        let all = Span { least: Lattice { x: -FAR, z: -FAR }, most: far };
        Self { inside: all, calm: all, free: all, met: None, brakes: None }
    }

    /// What is known of the path is over.
    #[inline]
    pub(super) const fn forget(&mut self) {
        self.brakes = None;
    }

    /// Whether no path there is braked past it, wherever it leads to in the next tick.
    #[inline]
    pub(super) const fn is_calm(&self, at: Lattice) -> bool {
        self.calm.surrounds(at)
    }

    /// Whether a hand there has all room.
    #[inline]
    pub(super) const fn is_free(&self, at: Lattice) -> bool {
        self.free.surrounds(at)
    }

    /// Room of an axis that something else leads through a part of, to either side.
    pub(super) fn room(&self, axis: Axis, span: &Span) -> (i32, i32) {
        let ((least, most), (low, high)) = (self.inside.part(axis), span.part(axis));
        (least.saturating_sub(low).min(0), most.saturating_sub(high).max(0))
    }

    /// Which side of an axis that stands at `here` is passed by what leads as far as `span`, if any.
    fn passed(&self, axis: Axis, here: i32, span: &Span) -> Option<bool> {
        let ((least, most), (low, high)) = (self.inside.part(axis), span.part(axis));
        if high > most.max(here) {
            Some(true)
        } else if low < least.min(here) {
            Some(false)
        } else {
            None
        }
    }
}

impl<const N: usize, M: BorrowMut<Memory<N>>> Channel<N, M> {
    /// Sets the least and the greatest place of the tool, in pulses: of [`position`](Self::position) with
    /// [`offset`](Self::offset) and what X is [pulled out](Self::retracted) by. What is 2^30 pulses off is as good as no limit.
    pub fn set_fence(&mut self, least: Lattice, most: Lattice) {
        self.fence.inside = Span { least, most };
        self.fence.brakes = None;
        let near = |limit: i32, by: i32| if limit.saturating_abs() >= FAR { limit } else { limit.saturating_add(by) };
        let out = self.crank.thread.distance().saturating_abs();
        let before = |ahead: u8| {
            let way = self.hands.longest_braking(self.window.ticks().saturating_add(ahead));
            let (x, z) = self.hands.pulses_of(way);
            let x = x.saturating_add(out);
            let least = Lattice { x: near(least.x, x), z: near(least.z, z) };
            let most = Lattice { x: near(most.x, x.wrapping_neg()), z: near(most.z, z.wrapping_neg()) };
            Span { least, most }
        };
        (self.fence.calm, self.fence.free) = (before(PATH_AHEAD), before(HANDS_AHEAD));
    }

    /// What the path leads through if it brakes in the tick to come, or more, in the program's pulses.
    pub(super) fn braking_reach(&mut self) -> Span {
        if let Some(span) = self.fence.brakes {
            return span;
        }
        let span = self.reach(self.crank.back, false);
        self.fence.brakes = Some(span);
        span
    }

    /// Where the path was held before the fence since this was asked last: the axis, and whether to plus.
    #[inline]
    pub const fn met_fence(&mut self) -> Option<(Axis, bool)> {
        self.fence.met.take()
    }

    /// Holds the path where it must not go on for another tick.
    #[inline]
    pub(super) fn keep_inside(&mut self) {
        // a thread can't be held in its groove: it is looked at before it begins, wherever that is
        let begins = self.crank.in_thread && self.speed == 0;
        if matches!(self.state, State::Running) && (begins || !self.fence.is_calm(self.tool())) {
            self.look_ahead_to_fence();
        }
    }

    #[cold]
    #[inline(never)]
    fn look_ahead_to_fence(&mut self) {
        // a wheel that stands may go either way: it is looked at when it sets off
        let wheel = matches!(self.crank.drive, Drive::Wheel(_)) && !self.crank.in_thread;
        if self.speed > 0 || !wheel {
            let back = match &self.crank.spindle {
                Some(spindle) if matches!(self.crank.drive, Drive::Spindle(_)) && self.speed == 0 => {
                    spindle.foretold().rate < 0
                }
                _ => self.crank.back,
            };
            let _ = self.is_fenced(back);
        }
    }

    /// Whether the path must not go on in a sense for another tick; it is held then.
    #[cold]
    pub(super) fn is_fenced(&mut self, back: bool) -> bool {
        let (offset, by_hand) = (self.hands.offset(), self.hands.braking());
        let reach = self.reach(back, true);
        let span = reach.moved(offset);
        let span = span.and(span.moved(by_hand));
        let mut here = self.tool();
        here.x = here.x.saturating_add(self.retracted());
        let x = self.fence.passed(Axis::X, here.x, &span).map(|plus| (Axis::X, plus));
        let met = x.or_else(|| self.fence.passed(Axis::Z, here.z, &span).map(|plus| (Axis::Z, plus)));
        if met.is_some() {
            let _ = self.hold();
            self.fence.met = met;
        } else if !self.crank.turns {
            // a path that is turned may be turned back
            self.fence.brakes = Some(reach);
        }
        met.is_some()
    }
}
