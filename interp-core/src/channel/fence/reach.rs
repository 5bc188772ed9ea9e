//! The reach of the path: all that it leads through before it stands, if it brakes now or goes on for a tick.

use super::{Span, end, plus, whole};
use crate::block::{Motion, Speed, Work};
use crate::channel::swath::{Groups, shed};
use crate::channel::{Active, Channel, Current, Memory, lookahead};
use crate::governor::square;
use crate::units::Lattice;
use core::borrow::BorrowMut;

/// Pulses that steps may be off the length that they belong to: rounded at both ends, and a classic method's deviation.
const ROUGH: i32 = 4;

/// Where a motion begins that ends at `at`.
const fn begin(at: Lattice, motion: &Motion) -> Lattice {
    let Lattice { x, z } = end(motion);
    plus(at, Lattice { x: x.wrapping_neg(), z: z.wrapping_neg() })
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

impl<const N: usize, M: BorrowMut<Memory<N>>> Channel<N, M> {
    /// What the path leads through before it stands, in the program's pulses: if it brakes now, or goes on for a tick.
    pub(super) fn reach(&self, back: bool, goes_on: bool) -> Span {
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
