//! Look-ahead for the lead of an S law: with margins around the joints, and from rest to rest.

use super::{Lookahead, Overrides, Planned, as_motion, linear_entry, pace};
use crate::block::Work;
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

/// How fast a motion may be run, under any override and under the present one.
#[derive(Copy, Clone, Debug)]
struct Paces {
    most: Speed,
    pace: Speed,
}

impl Paces {
    fn of(motion: &Motion, overrides: Overrides) -> Self {
        Self { most: most(motion), pace: pace(motion, overrides) }
    }
}

impl Planned {
    /// What a smoothed motion before it keeps at its end: a squared speed and margins.
    fn kept(&self) -> (u64, Margins) {
        match as_motion(&self.block) {
            Some(motion) if !self.stands && is_smoothed(motion) => (self.entry, self.margins),
            _ => (0, Margins::EMPTY),
        }
    }
}

impl<const N: usize> Lookahead<N> {
    /// A block to come, from 0, where it is a smoothed motion.
    pub(in crate::channel) fn motion(&self, index: usize) -> Option<&Motion> {
        self.blocks.get(index).and_then(|planned| as_motion(&planned.block)).filter(|motion| is_smoothed(motion))
    }

    /// Whether block `index` is a motion that is begun from standstill though it follows one.
    pub(in crate::channel) fn stands(&self, index: usize) -> bool {
        let goes_on = self.blocks.get(index).is_some_and(|planned| {
            !planned.stands && planned.is_planned() && as_motion(&planned.block).is_some_and(is_smoothed)
        });
        !goes_on
    }

    /// Each line is begun from standstill, after the rest of `line`, as far as there is way to brake in: from the start of block
    /// `first` on where the squared speed `speed` is left there, so much of which that block's way sheds.
    pub(in crate::channel) fn stand_lines(&mut self, line: u32, first: usize, speed: u64) {
        let (mut before, mut speed, mut left) = (line, speed, first);
        for planned in &mut self.blocks {
            if left == 0 {
                planned.stands |= planned.block.line != before && speed == 0;
                speed = speed.saturating_sub(planned.swath.sheds);
            }
            left = left.saturating_sub(1);
            before = planned.block.line;
        }
        self.sweep.again(true);
    }

    /// The block pushed last is begun from standstill: it came too late for anything else.
    pub(in crate::channel) fn stand_last(&mut self) {
        if let Some(last) = self.blocks.back_mut() {
            last.stands = true;
        }
    }

    /// The first block whose plan does not act yet on what leads up to block `next`: the joint before it may have margins that
    /// nobody keeps to so far.
    pub(in crate::channel) fn pending(&self, next: usize) -> Option<usize> {
        let pending = self.sweep.pending(next, self.blocks.len())?;
        let waits = self.blocks.get(pending).is_some_and(|planned| !planned.stands);
        waits.then_some(pending)
    }

    /// Block `index` is begun from standstill: it came too late for anything else.
    pub(in crate::channel) fn stand_at(&mut self, index: usize) {
        if let Some(late) = self.blocks.get_mut(index) {
            late.stands = true;
            if late.is_planned() {
                (late.entry, late.margins) = (0, Margins::EMPTY);
            }
        }
        self.sweep.again_before(index);
    }

    /// What `motion`, behind which comes block `index`, keeps at its end: a squared speed and margins.
    pub(in crate::channel) fn leave(&self, index: usize, motion: &Motion, ticks: u8) -> (u64, Margins) {
        match self.blocks.get(index) {
            Some(next) if next.is_planned() => next.kept(),
            _ => (0, Margins::reserve(motion, ticks)),
        }
    }

    /// Plans anew as far as it changes, as [`plan`](Self::plan) does, for a mean over `ticks`.
    ///
    /// What no override changes, the speeds of joints and the limits of the machine, has margins of its own at any
    /// override: so braking as hard as allowed meets them, whatever the operator does. Those of the programmed feeds come
    /// besides; where an override makes them suddenly lower they are approached gradually.
    pub(in crate::channel) fn plan_smooth(
        &mut self,
        active: Option<&Motion>,
        overrides: Overrides,
        work: u32,
        ticks: u8,
    ) {
        let Some(mut pass) = self.set_out(overrides, work) else { return };
        let overrides = self.overrides;
        let mut of_before: Option<Paces> = None;
        let mut next = self.blocks.get(self.sweep.left()).map(Planned::kept);
        while let Some(here) = self.sweep.next(&mut pass) {
            let before = match here.checked_sub(1) {
                Some(before) => self.blocks.get(before).and_then(|planned| as_motion(&planned.block)),
                None => active,
            };
            let before = before.filter(|motion| is_smoothed(motion)).map(|motion| Paces::of(motion, overrides));
            let own = core::mem::replace(&mut of_before, before);
            let known = self.sweep.knew(here);
            let Some(planned) = self.blocks.get_mut(here) else { return };
            let motion = match &planned.block.work {
                Work::Motion(motion) if is_smoothed(motion) => motion,
                _ => {
                    self.plan_paced(here, active, overrides);
                    next = Some((0, Margins::EMPTY));
                    continue;
                }
            };
            pass.costs(motion);
            let (exit, mut margins) = next.unwrap_or_else(|| (0, Margins::reserve(motion, ticks)));
            let entry = match before {
                Some(before) if !planned.stands => {
                    let own = own.unwrap_or_else(|| Paces::of(motion, overrides));
                    let hard = motion.joint.min(motion.limit);
                    let most = hard.min(own.pace).min(before.pace);
                    let entry = if margins.are_empty() {
                        planned.reachable_up_to(square(most), motion, motion.length, exit)
                    } else {
                        let way = margins.way(motion, motion.length, exit);
                        margins.pass(motion.length);
                        planned.reachable_up_to(square(most.min(way.cap)), motion, way.room, way.exit)
                    };
                    if hard < before.most {
                        margins.keep(hard, ticks);
                    }
                    if own.pace < hard.min(before.pace) {
                        margins.keep(own.pace, ticks);
                    }
                    entry
                }
                _ => {
                    margins = Margins::EMPTY;
                    0
                }
            };
            if known && (entry, margins) == (planned.entry, planned.margins) {
                self.sweep.finish();
                return;
            }
            (planned.entry, planned.margins) = (entry, margins);
            next = Some((entry, margins));
        }
    }

    /// Plans block `here` where it is a motion that a spindle paces.
    fn plan_paced(&mut self, here: usize, active: Option<&Motion>, overrides: Overrides) {
        let paced =
            |index: usize| self.blocks.get(index).and_then(|planned| Some((planned.entry, as_motion(&planned.block)?)));
        let Some((_, motion)) = paced(here) else {
            if let Some(planned) = self.blocks.get_mut(here) {
                planned.entry = 0;
            }
            return;
        };
        let before = match here.checked_sub(1) {
            Some(before) => paced(before).map(|(_, motion)| motion),
            None => active,
        };
        let before = before.filter(|before| !is_smoothed(before)).map(|before| pace(before, overrides));
        let next = paced(here.wrapping_add(1)).filter(|(_, next)| !is_smoothed(next));
        let exit = next.map_or(square(motion.stop), |(entry, _)| entry);
        let entry = linear_entry(before, motion, motion.reachable(motion.length, exit), overrides);
        if let Some(planned) = self.blocks.get_mut(here) {
            planned.entry = entry;
        }
    }
}
