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

use core::borrow::BorrowMut;

use super::swath::{Groups, shed};
use super::{Active, Channel, Current, Memory, State, lookahead};
use crate::block::{Motion, Speed, Work};
use crate::drive::Drive;
use crate::governor::square;
use crate::units::{Axis, Lattice};

/// Pulses that steps may be off the length that they belong to: rounded at both ends, and a classic method's deviation.
const ROUGH: i32 = 4;

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

/// Where a motion begins that ends at `at`.
const fn begin(at: Lattice, motion: &Motion) -> Lattice {
    let Lattice { x, z } = end(motion);
    plus(at, Lattice { x: x.wrapping_neg(), z: z.wrapping_neg() })
}

/// All places of a motion that begins at `from`.
pub(super) fn whole(from: Lattice, motion: &Motion) -> Span {
    let ((x, z), (most_x, most_z)) = motion.curve.extent();
    Span { least: Lattice { x, z }, most: Lattice { x: most_x, z: most_z } }.moved(from)
}

impl Active {
    /// All places that are left in a sense, from `here` on.
    fn left(&self, back: bool, here: Lattice) -> Span {
        let to = if back { self.from } else { plus(self.from, end(&self.motion)) };
        let (from, until) = if back { (0, self.done) } else { (self.done, self.motion.length) };
        let ends = Span::of(here, to);
        let ((x, z), (most_x, most_z)) = self.motion.curve.extremes(from, until);
        let extremes = Span { least: Lattice { x, z }, most: Lattice { x: most_x, z: most_z } }.moved(self.from);
        ends.and(extremes)
    }
}

/// How the path comes to a stand.
struct Braking {
    /// Length that it covers before it brakes, nm with 12 fraction bits; and the square of its speed then.
    way: u64,
    squared: u64,
    /// What its speed gains in the tick that it goes on for; `None` where it brakes now.
    gains: Option<Speed>,
    /// It stands, and begins with the motion that comes next.
    begins: bool,
}

impl Braking {
    const fn stands(&self) -> bool {
        self.way == 0 && self.squared == 0 && !self.begins
    }

    /// Goes on through a motion of which `room` is left: the length covered there.
    fn through(&mut self, motion: &Motion, rest: Speed, room: u64) -> u64 {
        if core::mem::take(&mut self.begins) {
            let speed = rest.max(motion.start).saturating_add(self.gains.unwrap_or(0));
            (self.way, self.squared) = (speed.into(), square(speed));
        }
        let shed = shed(motion);
        let brakes = room.saturating_sub(self.way);
        let most = brakes.saturating_mul(shed);
        if self.way <= room && self.squared <= most {
            let covered = self.way.saturating_add(self.squared.checked_div(shed).unwrap_or(0));
            (self.way, self.squared) = (0, 0);
            return covered;
        }
        (self.way, self.squared) = (self.way.saturating_sub(room), self.squared.saturating_sub(most));
        room
    }

    /// Goes on through all of a motion, from its start, that sheds so much; false, and nothing changes, where it may stand in it.
    #[inline]
    const fn passes_through(&mut self, length: u64, sheds: u64) -> bool {
        if self.way > length {
            self.way = self.way.wrapping_sub(length);
            return true;
        }
        let passes = self.way == 0 && self.squared > sheds && !self.begins;
        if passes {
            self.squared = self.squared.wrapping_sub(sheds);
        }
        passes
    }

    /// Comes to what is no motion. Whether the path may lead past it before it stands.
    const fn passes(&mut self, work: &Work, optional_stop: bool) -> bool {
        let within = matches!(work, Work::Dwell(0)) || matches!(work, Work::OptionalStop) && !optional_stop;
        self.begins = within && self.gains.is_some() && (self.begins || self.way > 0);
        self.begins
    }
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

    /// What the path leads through before it stands, in the program's pulses: if it brakes now, or goes on for a tick.
    fn reach(&self, back: bool, goes_on: bool) -> Span {
        if self.crank.in_thread {
            return self.thread_reach();
        }
        // behind the newest motion the path goes by the linear law
        let behind = self.memory.borrow().trail.is_behind();
        let smooth = self.window.ticks() > 0 && !self.crank.turns && self.follows() && !behind;
        let (speed, owed) = if smooth { (self.lead.speed(), self.window.owed()) } else { (self.speed, 0) };
        let mut braking = Braking { way: owed, squared: square(speed), gains: None, begins: false };
        if goes_on {
            let gains = self.hands.accel();
            let faster = speed.saturating_add(gains);
            (braking.gains, braking.begins) = (Some(gains), speed == 0 && owed == 0);
            (braking.way, braking.squared) = (owed.saturating_add(faster.into()), square(faster));
        }
        let (mut span, memory) = (Span::at(self.position), self.memory.borrow());
        if braking.stands() {
            return span;
        }
        let see = |span: Span, at: Lattice, all: Span, motion: &Motion, room: u64, braking: &mut Braking| {
            let covered = braking.through(motion, self.rest, room);
            // no place of a motion is farther off than its length
            span.and(if covered >= motion.length {
                all
            } else {
                let (x, z) = self.hands.pulses_of(covered);
                all.near(at, (x.saturating_add(ROUGH), z.saturating_add(ROUGH)))
            })
        };
        let (mut begins, mut ends) = (self.position, self.position);
        if let Current::Motion(active) = &self.current {
            span = see(
                span,
                self.position,
                active.left(back, self.position),
                &active.motion,
                self.room(back),
                &mut braking,
            );
            (begins, ends) = (active.from, plus(active.from, end(&active.motion)));
        }
        if back {
            for earlier in memory.trail.earlier() {
                if braking.stands() {
                    break;
                }
                let at = begins;
                begins = begin(at, earlier);
                span = see(span, at, whole(begins, earlier), earlier, earlier.length, &mut braking);
            }
            return self.beyond(span, back, &braking);
        }
        for later in memory.trail.later() {
            if braking.stands() {
                break;
            }
            span = see(span, ends, whole(ends, later), later, later.length, &mut braking);
            ends = plus(ends, end(later));
        }
        // what follows a gap in the trail is not next
        if !memory.trail.is_whole() {
            return span;
        }
        let mut index = 0_usize;
        while let Some((block, swath)) = memory.ahead.swath(index)
            && !braking.stands()
        {
            if let Some(group) = memory.ahead.group(index)
                && braking.passes_through(group.length, group.sheds)
            {
                span = span.and(group.span.moved(ends));
                ends = plus(ends, group.end);
                index = index.wrapping_add(Groups::<N>::SIZE);
                continue;
            }
            index = index.wrapping_add(1);
            let Some(later) = lookahead::as_motion(block) else {
                if braking.passes(&block.work, self.optional_stop) {
                    continue;
                }
                break;
            };
            let all = swath.span.moved(ends);
            span = if braking.passes_through(swath.length, swath.sheds) {
                span.and(all)
            } else {
                see(span, ends, all, later, swath.length, &mut braking)
            };
            ends = plus(ends, swath.end);
        }
        self.beyond(span, back, &braking)
    }

    /// The span with what a path that does not stand at the end of the motions at hand may lead through behind them, whichever
    /// way: they are left at the start-stop speed at most, and what is made by then is gone on into.
    fn beyond(&self, span: Span, back: bool, braking: &Braking) -> Span {
        match self.memory.borrow().trail.leaves(back) {
            Some(speed) if !braking.stands() && !braking.begins => {
                let speed = u64::from(speed.saturating_add(braking.gains.unwrap_or(0)));
                let (x, z) = self.hands.pulses_of(self.hands.braking_from(speed).saturating_add(speed));
                let by = Lattice { x, z };
                span.and(span.moved(by)).and(span.moved(Lattice { x: x.wrapping_neg(), z: z.wrapping_neg() }))
            }
            _ => span,
        }
    }

    /// All that a thread leads through, forward and back and with X pulled out anywhere.
    fn thread_reach(&self) -> Span {
        let (mut span, memory) = (Span::at(self.position), self.memory.borrow());
        let (mut begins, mut ends) = (self.position, self.position);
        if let Current::Motion(active) = &self.current {
            (begins, ends) = (active.from, plus(active.from, end(&active.motion)));
            span = span.and(whole(begins, &active.motion));
        } else if let Some((_, here)) = memory.trail.here() {
            begins = begin(begins, here);
            span = span.and(whole(begins, here));
        }
        for earlier in memory.trail.earlier() {
            begins = begin(begins, earlier);
            span = span.and(whole(begins, earlier));
        }
        let ahead = memory.ahead.blocks().take_while(|_| memory.trail.is_whole());
        let ahead = ahead.map_while(lookahead::as_motion).take_while(|motion| motion.feed.is_thread());
        for later in memory.trail.later().chain(ahead) {
            span = span.and(whole(ends, later));
            ends = plus(ends, end(later));
        }
        let out = if self.leads_z() || self.retracted() != 0 { self.crank.thread.distance() } else { 0 };
        span.and(span.moved(Lattice { x: out, z: 0 }))
    }
}
