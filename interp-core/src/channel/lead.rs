//! The S laws: a lead plans ahead, the tool follows as the mean of the lead's last ticks.
//!
//! The *lead* advances along the path as the linear law does, from rest to rest, tick by tick; a [`Window`] gives
//! the tool's advance, and the tool walks it. So acceleration is smoothed before anything is interpolated, and the path
//! never bends. The lead runs ahead by half a window, over joints and through several blocks where they are short; the
//! tool takes blocks off the look-ahead as it comes to them. What stands still (dwells, outputs, stops) waits until the
//! tool has arrived. Hold, reset and override act on the lead. Feeds a turn and threads follow the spindle, whose course
//! nobody plans: they are run as under the linear law, and begin and end in standstill beside smoothed motions.
//!
//! Where the lead slows down for a joint it keeps that speed for a [margin](super::margins) on both sides.

use super::Memory;
use super::cruise::Cruise;
use super::lookahead::smooth::{is_smoothed, most};
use super::lookahead::{Lookahead, Overrides, pace};
use super::margins::Margins;
use super::swath::{Groups, shed};
use super::{Channel, Current, State};
use crate::block::{Motion, Speed};
use crate::config::TICK_CLOCKS;
use crate::governor::{Advance, square};
use crate::math::to_u32;
use crate::train::Train;
use core::borrow::BorrowMut;

/// Where the lead is.
#[derive(Clone, Debug)]
pub(super) struct Lead {
    /// How many blocks it is ahead of the one that the tool has begun last.
    block: usize,
    /// Length covered of its block.
    done: u64,
    speed: Speed,
    /// Its block's speed under the overrides `paced_at`.
    pace: Speed,
    paced_at: Overrides,
    cruise: Cruise,
    /// Margins behind joints passed.
    behind: Margins,
}

impl Lead {
    /// At rest at the start of the tool's block.
    pub(super) const fn new() -> Self {
        Self::at(0)
    }

    /// At rest with the tool, so far along its block.
    pub(super) const fn at(done: u64) -> Self {
        Self {
            block: 0,
            done,
            speed: 0,
            pace: 0,
            // its pace is found anew
            paced_at: Overrides::AT_LIMIT,
            cruise: Cruise::new(),
            behind: Margins::EMPTY,
        }
    }

    /// Its speed.
    pub(super) const fn speed(&self) -> Speed {
        self.speed
    }

    /// The feeds are others: its pace is found anew.
    pub(super) const fn repace(&mut self) {
        self.paced_at = Overrides::AT_LIMIT;
    }
}

/// The motion so many blocks ahead of the one that the tool has begun last.
fn ahead_of<'c, const N: usize>(current: &'c Current, ahead: &'c Lookahead<N>, blocks: usize) -> Option<&'c Motion> {
    match (blocks.checked_sub(1), current) {
        (Some(index), _) => ahead.motion(index),
        (None, Current::Motion(active)) => Some(&active.motion).filter(|_| !active.linear),
        (None, Current::Nothing | Current::Dwell(_)) => None,
    }
}

impl<const N: usize, M: BorrowMut<Memory<N>>> Channel<N, M> {
    /// Whether a tick belongs to the lead and the tool that follows it, not to a block that stands still.
    pub(super) fn follows(&self) -> bool {
        match self.current {
            Current::Motion(ref active) => !active.linear,
            Current::Dwell(_) => false,
            Current::Nothing => !self.window.is_drained() || self.memory.borrow().ahead.motion(0).is_some(),
        }
    }

    /// Whether what is executed keeps to the linear law although its feed is none of a spindle any more: what follows is begun
    /// from standstill.
    fn keeps_linear(&self) -> bool {
        matches!(&self.current, Current::Motion(active) if active.linear && is_smoothed(&active.motion))
    }

    /// The feed of what is executed is another one. What moves and is or was paced by a spindle goes by the linear law from here to
    /// its end; what stands is begun from here under the law of its feed.
    pub(super) fn change_law(&mut self) {
        let Current::Motion(active) = &mut self.current else { return };
        let linear = !is_smoothed(&active.motion) || self.speed != 0 && active.linear;
        if linear != active.linear {
            active.linear = linear;
            // the tool goes on from where it is
            self.window.clear();
            self.lead = Lead::at(active.done);
        }
    }

    /// One tick of the lead and the tool.
    // apart from `run`, so that the linear law pays nothing for it
    #[inline(never)]
    pub(super) fn follow(&mut self, out: &mut impl Train) {
        let length = self.lead_on();
        if length == 0 && self.window.is_drained() {
            self.speed = 0;
            return;
        }
        let by = self.window.push(length);
        let known = self.memory.borrow().ahead.len();
        // the tool never passes the lead, so there is a motion for all of it
        let _ = self.walk(by.cast_signed(), out);
        let begun = known.wrapping_sub(self.memory.borrow().ahead.len());
        self.lead.block = self.lead.block.saturating_sub(begun);
        self.speed = if self.window.is_drained() { 0 } else { to_u32(by).max(1) };
    }

    /// Where a block is too late to be planned with, it is begun from standstill: the lead, which keeps to what was planned before
    /// it came, is so near the end of that that the margins of the joint there might not be kept.
    pub(super) fn stand_late(&mut self) {
        if self.keeps_linear() {
            return self.memory.borrow_mut().ahead.stand_at(0);
        }
        let ahead = &self.memory.borrow().ahead;
        let (first, done) = (self.lead.block, self.lead.done);
        let Some(pending) = ahead.pending(first) else { return };
        let Some(here) = ahead_of(&self.current, ahead, first) else { return };
        let last = match pending.checked_sub(1) {
            Some(last) if last >= first => ahead.motion(last),
            _ => Some(here),
        };
        let Some(last) = last else { return };
        let reserve = Margins::reserve(last, self.window.ticks()).longest();
        let (mut left, mut index) = (here.length.saturating_sub(done), first);
        while left < reserve && index < pending {
            let behind = index.wrapping_add(Groups::<N>::SIZE);
            if behind <= pending
                && let Some(group) = ahead.group(index)
            {
                left = left.saturating_add(group.length);
                index = behind;
                continue;
            }
            let Some(motion) = ahead.motion(index) else { return };
            left = left.saturating_add(motion.length);
            index = index.wrapping_add(1);
        }
        if left < reserve {
            self.memory.borrow_mut().ahead.stand_at(pending);
        }
    }

    /// Where the lead is: how many blocks ahead of the one that the tool has begun last, and the squared speed that is left
    /// behind that block where it brakes from here on.
    pub(super) fn lead_brakes(&self) -> (usize, u64) {
        let first = self.lead.block;
        let ahead = &self.memory.borrow().ahead;
        let sheds = ahead_of(&self.current, ahead, first)
            .map_or(0, |motion| shed(motion).saturating_mul(motion.length.saturating_sub(self.lead.done)));
        (first, square(self.lead.speed).saturating_sub(sheds))
    }

    /// The lead's advance in this tick.
    fn lead_on(&mut self) -> u32 {
        let runs = matches!(self.state, State::Running) && !self.memory.borrow().ahead.is_urgent();
        let ticks = self.window.ticks();
        let (mut clock, mut length) = (0_u32, 0_u64);
        while clock < TICK_CLOCKS {
            let lead = &mut self.lead;
            let Memory { ahead, trail } = self.memory.borrow();
            let motion = ahead_of(&self.current, ahead, lead.block);
            let Some(motion) = motion.filter(|motion| lead.done < motion.length) else {
                if !self.pass_joint(runs && length == 0) {
                    break;
                }
                continue;
            };
            let left = motion.length.wrapping_sub(lead.done);
            if lead.paced_at != self.overrides {
                (lead.pace, lead.paced_at) = (pace(motion, self.overrides), self.overrides);
            }
            let target = if runs { self.hands.cap(lead.pace).min(lead.behind.cap()) } else { 0 };
            if lead.speed == 0 {
                if target == 0 {
                    break;
                }
                if left <= u64::from(motion.accel >> 3) {
                    // what rounding left over is nothing to plan with
                    lead.done = motion.length;
                    length = length.wrapping_add(left);
                    break;
                }
            }
            let (exit, margins) = if lead.block == 0 && trail.stands_behind() {
                (0, Margins::EMPTY)
            } else {
                ahead.leave(lead.block, motion, ticks)
            };
            let calm = left.saturating_sub(margins.longest());
            let steady = lead.speed == target && clock == 0;
            let advance = if steady && lead.cruise.holds(target, calm) {
                Advance { length: u64::from(target), clocks: TICK_CLOCKS, speed: target, done: false }
            } else {
                let way = margins.way(motion, left, exit);
                let target = target.min(way.cap);
                let budget = TICK_CLOCKS.wrapping_sub(clock);
                let advance = motion.advance_gently(lead.speed, way.room, way.exit, target, budget);
                if steady && advance.speed == target && !advance.done && way.cap == Speed::MAX {
                    lead.cruise.learn(motion, target, calm);
                }
                advance
            };
            lead.done = lead.done.wrapping_add(advance.length);
            lead.speed = advance.speed;
            lead.behind.pass(advance.length);
            length = length.wrapping_add(advance.length);
            clock = clock.wrapping_add(advance.clocks);
            if lead.speed == 0 {
                break;
            }
        }
        to_u32(length)
    }

    /// Leads the lead from the end of its block into the next one; from standstill only where it `may`, and when the
    /// tool has arrived. False where it stays.
    fn pass_joint(&mut self, may: bool) -> bool {
        let lead = &mut self.lead;
        let Memory { ahead, trail } = self.memory.borrow();
        let before = ahead_of(&self.current, ahead, lead.block);
        let next = ahead.motion(lead.block);
        let stands = ahead.stands(lead.block) || lead.block == 0 && trail.stands_behind();
        if stands || before.is_none() {
            lead.speed = 0;
        }
        let Some(next) = next else { return false };
        lead.behind = match before {
            Some(before) if lead.speed > 0 => {
                // what rounding or a lowered feed left too much is shed behind the joint
                let hard = next.joint.min(before.limit);
                let mut behind = lead.behind;
                if hard < most(next) {
                    behind.keep(hard, self.window.ticks());
                }
                let paced = pace(before, self.overrides);
                if paced < hard.min(pace(next, self.overrides)) {
                    behind.keep(paced, self.window.ticks());
                }
                behind
            }
            _ if !may || !self.window.is_drained() => return false,
            _ => Margins::EMPTY,
        };
        lead.block = lead.block.wrapping_add(1);
        lead.done = 0;
        (lead.pace, lead.paced_at) = (pace(next, self.overrides), self.overrides);
        lead.cruise = Cruise::new();
        true
    }
}
