//! Look-ahead for the lead of an S law: with margins around the joints, and from rest to rest.

use super::{Lookahead, Overrides, as_motion, linear_entry, pace};
use crate::block::{Feed, Motion, Speed};
use crate::channel::margins::Margins;
use crate::governor::square;

/// The largest speed of a motion under any override.
pub(in crate::channel) fn most(motion: &Motion) -> Speed {
    match motion.feed {
        Feed::Rapid | Feed::PerTurn(_) | Feed::Thread(..) => motion.limit,
        Feed::PerTick(feed) => motion.limit.min(feed.saturating_mul(2)),
    }
}

/// Whether the law is for a motion: not for those that a spindle paces.
pub(in crate::channel) const fn is_smoothed(motion: &Motion) -> bool {
    matches!(motion.feed, Feed::Rapid | Feed::PerTick(_))
}

impl<const N: usize> Lookahead<N> {
    /// A block to come, from 0, where it is a smoothed motion.
    pub(in crate::channel) fn motion(&self, index: usize) -> Option<&Motion> {
        self.blocks.get(index).and_then(|planned| as_motion(&planned.block)).filter(|motion| is_smoothed(motion))
    }

    /// Whether block `index` is a motion that is begun from standstill though it follows one.
    pub(in crate::channel) fn stands(&self, index: usize) -> bool {
        self.motion(index).is_none() || self.blocks.get(index).is_some_and(|planned| planned.stands)
    }

    /// Each line is begun from standstill, after the rest of `line`.
    pub(in crate::channel) fn stand_lines(&mut self, line: u32) {
        let mut before = line;
        for planned in &mut self.blocks {
            planned.stands |= planned.block.line != before;
            before = planned.block.line;
        }
        self.fresh = self.blocks.len();
    }

    /// The block pushed last is begun from standstill: it came too late for anything else.
    pub(in crate::channel) fn stand_last(&mut self) {
        if let Some(last) = self.blocks.back_mut() {
            last.stands = true;
        }
    }

    /// What `motion`, behind which comes block `index`, keeps at its end: a squared speed and margins.
    pub(in crate::channel) fn leave(&self, index: usize, motion: &Motion, ticks: u8) -> (u64, Margins) {
        match self.blocks.get(index) {
            None => (0, Margins::reserve(motion, ticks)),
            Some(next) if !self.stands(index) => (next.entry, next.margins),
            Some(_) => (0, Margins::EMPTY),
        }
    }

    /// Plans anew as far as it changes, as [`plan`](Self::plan) does, for a mean over `ticks`.
    ///
    /// What no override changes, the speeds of joints and the limits of the machine, has margins of its own at any
    /// override: so braking as hard as allowed meets them, whatever the operator does. Those of the programmed feeds come
    /// besides; where an override makes them suddenly lower they are approached gradually.
    pub(in crate::channel) fn plan_smooth(&mut self, active: Option<&Motion>, overrides: Overrides, ticks: u8) {
        let all = overrides != self.overrides;
        if !all && self.fresh == 0 {
            return;
        }
        self.overrides = overrides;
        let known = if all { 0 } else { self.blocks.len().saturating_sub(self.fresh) };
        self.fresh = 0;
        let mut index = self.blocks.len();
        while let Some(here) = index.checked_sub(1) {
            index = here;
            let Some(motion) = self.motion(here) else {
                self.plan_paced(here, active, overrides);
                continue;
            };
            let before = match here.checked_sub(1) {
                Some(before) => self.motion(before),
                None => active.filter(|motion| is_smoothed(motion)),
            };
            let (exit, mut margins) = self.leave(index.wrapping_add(1), motion, ticks);
            let way = margins.way(motion, motion.length, exit);
            margins.pass(motion.length);
            let mut entry = motion.reachable(way.room, way.exit).min(square(way.cap));
            match before {
                Some(before) if !self.stands(here) => {
                    let (hard, own) = (motion.joint.min(motion.limit), pace(motion, overrides));
                    if hard < most(before) {
                        margins.keep(hard, ticks);
                    }
                    let paced = pace(before, overrides);
                    if own < hard.min(paced) {
                        margins.keep(own, ticks);
                    }
                    entry = entry.min(square(hard.min(own).min(paced)));
                }
                _ => (entry, margins) = (0, Margins::EMPTY),
            }
            let Some(planned) = self.blocks.get_mut(here) else { return };
            if here < known && (entry, margins) == (planned.entry, planned.margins) {
                return;
            }
            (planned.entry, planned.margins) = (entry, margins);
        }
    }

    /// Plans block `here` where it is a motion that a spindle paces.
    fn plan_paced(&mut self, here: usize, active: Option<&Motion>, overrides: Overrides) {
        let paced =
            |index: usize| self.blocks.get(index).and_then(|planned| Some((planned.entry, as_motion(&planned.block)?)));
        let Some((_, motion)) = paced(here) else { return };
        let before = match here.checked_sub(1) {
            Some(before) => paced(before).map(|(_, motion)| motion),
            None => active,
        };
        let before = before.filter(|before| !is_smoothed(before));
        let next = paced(here.wrapping_add(1)).filter(|(_, next)| !is_smoothed(next));
        let exit = next.map_or(square(motion.stop), |(entry, _)| entry);
        let entry = linear_entry(before, motion, exit, overrides);
        if let Some(planned) = self.blocks.get_mut(here) {
            planned.entry = entry;
        }
    }
}
