//! The spindle drives the path.
//!
//! The *line* is the place that the spindle asks for: its angle, foretold for the end of the tick that is made, times lead
//! per turn. The tool is on the line, or on its way there.
//!
//! **Falling in.** From rest the tool needs `v / a` to reach the line's speed v and covers `v^2 / 2a` in that time, while
//! the line covers `v^2 / a`. So it sets off when the line is still `v^2 / 2a` before it, and the line catches up just as
//! both are equally fast. That is what a [follower](crate::drive::follower) does in the frame of the line: it stands while
//! the line is far, sets off in time, and meets it without passing it. So the place of the thread depends on the angle
//! alone, not on speed or acceleration. Before it begins, the line is put back by whole turns of lead until it is that far
//! before the tool.
//!
//! **Locked** the advance is the line's, and a quarter of what is still between tool and line: what the filter corrects
//! comes over some ticks. Beyond the limits of speed and acceleration the tool lets go of the line, tells it, and falls in
//! again. Where the path ends it brakes for the end and leaves the line there; at its start likewise.

use super::Memory;
use super::{Channel, Current, State};
use crate::block::{Feed, Motion};
use crate::drive::follower::{Bounds, approach, is_far};
use crate::drive::gearing::Gearing;
use crate::drive::spindle::{COUNT, Foretold};
use crate::drive::{Drive, Trouble};
use crate::math::{root, to_u32};
use crate::train::Train;
use core::borrow::BorrowMut;

/// Share of the distance between tool and line that is made up in a tick, as a shift.
const SMOOTH: u32 = 2;

/// Rate of the spindle, from which on its sense is known: 1/16 of a count a tick.
pub(super) const TURNING: u64 = COUNT.unsigned_abs() >> 4;

/// Most turns of lead that the line is put back.
const MOST_TURNS: u32 = 4096;

impl<const N: usize, M: BorrowMut<Memory<N>>> Channel<N, M> {
    /// Enters a motion where none is present. False where none follows.
    pub(super) fn begin_geared(&mut self) -> bool {
        if !matches!(self.state, State::Running) {
            return false;
        }
        // what was a thread has ended
        if self.crank.in_thread {
            self.crank.stand();
            return false;
        }
        // a spindle that turns back drives the path back
        let back = self.crank.spindle.is_some_and(|spindle| spindle.foretold().rate < 0);
        self.enter(back) || matches!(self.current, Current::Motion(_))
    }

    /// A tick of the spindle inside a motion.
    pub(super) fn turn_spindle(&mut self, out: &mut impl Train) {
        let Some(spindle) = self.crank.spindle else { return };
        let foretold = spindle.foretold();
        let Current::Motion(active) = &self.current else { return };
        let bounds = Bounds { speed: active.motion.limit, accel: active.motion.accel };
        if self.crank.gearing.is_none() && self.speed == 0 {
            self.gear(foretold, bounds);
        }
        let Some(gearing) = &mut self.crank.gearing else { return };
        let line = gearing.at(foretold.angle);
        let feed = gearing.travel(foretold.rate);
        let gain = gearing.travel(foretold.acceleration);
        let count = gearing.count();
        let distance = line.wrapping_sub(self.crank.tool);
        let held = if self.crank.in_thread {
            self.crank.thread.is_path_held(self.state)
        } else {
            matches!(self.state, State::Resetting | State::Holding)
        };
        let before = self.crank.follower.advance();
        let advance = if held {
            self.crank.driven.locked = false;
            let accel = i64::from(bounds.accel);
            before.saturating_sub(before.max(accel.wrapping_neg()).min(accel))
        } else {
            self.crank.driven.trouble = trouble(feed, gain, bounds);
            self.toward(distance, feed, bounds, count)
        };
        let advance = self.within_path(advance);
        let advance = self.over_thread_joint(advance);
        let left = self.walk(advance, out);
        let made = advance.wrapping_sub(left);
        self.crank.follower.set(made);
        self.crank.tool = self.crank.tool.wrapping_add(made);
        self.crank.back = made < 0;
        // a thread that ends where the next one begins goes on
        let goes_on = self.crank.in_thread && made > 0 && !held;
        let over = matches!(self.current, Current::Nothing) && !(goes_on && self.enter(false));
        self.speed = to_u32(made.unsigned_abs());
        self.crank.driven.trouble = self.crank.driven.trouble.or(spindle.lost().map(|off| Trouble::Index { off }));
        self.crank.thread.went(made, foretold.rate, &self.crank.driven);
        if over {
            // the end of the path
            self.speed = 0;
            if self.crank.thread.is_left() {
                self.crank.ungear();
            } else {
                self.crank.stand();
            }
        } else if held && made == 0 {
            self.crank.ungear();
        }
    }

    /// The advance toward the line.
    fn toward(&mut self, distance: i64, feed: i64, bounds: Bounds, count: u32) -> i64 {
        let before = self.crank.follower.advance();
        let behind = distance.wrapping_sub(feed);
        if self.crank.driven.locked {
            let speed = i64::from(bounds.speed);
            let wish = feed.saturating_add(behind >> SMOOTH);
            // the filter's corrections are roughness, not acceleration
            let most = i64::from(bounds.accel.saturating_add(count));
            if wish.saturating_sub(before).saturating_abs() <= most && wish.saturating_abs() <= speed {
                return wish;
            }
            self.crank.driven.locked = false;
        }
        let advance = self.crank.follower.follow(distance, feed, bounds, bounds.accel >> 2);
        let near = behind.unsigned_abs() <= u64::from(bounds.accel.max(count));
        let even = feed.saturating_sub(advance).unsigned_abs() <= u64::from(bounds.accel);
        self.crank.driven.locked = near && even;
        advance
    }

    /// The advance where it leads over a joint into a part of the thread with another lead: what lies behind the joint is
    /// made under that one, unless the speed would jump. Then the path falls in with its line as at the start.
    fn over_thread_joint(&mut self, advance: i64) -> i64 {
        let back = advance < 0;
        let room = self.room(back);
        if !self.crank.in_thread || advance.unsigned_abs() <= room {
            return advance;
        }
        let Some(&Motion { feed: Feed::Thread(lead, _), accel, .. }) = self.neighbour(back) else { return advance };
        let Some(gearing) = self.crank.gearing.as_mut().filter(|gearing| gearing.lead() != lead) else {
            return advance;
        };
        let room = if back { room.cast_signed().wrapping_neg() } else { room.cast_signed() };
        let jump = gearing.converted(advance, lead).wrapping_sub(advance);
        let beyond = gearing.converted(advance.wrapping_sub(room), lead);
        gearing.change(lead, self.crank.tool.wrapping_add(room));
        if jump.unsigned_abs() <= u64::from(accel) { room.wrapping_add(beyond) } else { advance }
    }

    /// The advance that the path's ends and joints on either side allow.
    pub(super) fn within_path(&mut self, advance: i64) -> i64 {
        let back = advance < 0;
        let Current::Motion(active) = &self.current else { return advance };
        let motion = &active.motion;
        // a thread is not left at its start
        let start = if back && self.crank.in_thread { self.crank.tool.max(0).unsigned_abs() } else { u64::MAX };
        let room = self.room(back).min(start);
        if is_far(room, advance.unsigned_abs(), motion.accel) {
            return advance;
        }
        let Memory { ahead, trail } = self.memory.borrow();
        let exit = match (back, self.crank.in_thread) {
            (true, true) => 0,
            (true, false) => trail.exit_back(),
            (false, _) => trail.exit(ahead, motion, false),
        };
        let rest = room.saturating_sub(self.crank.follower.advance().unsigned_abs());
        let most = approach(room, motion.accel).max(i64::from(root(motion.reachable(rest, exit))));
        let within = advance.max(most.wrapping_neg()).min(most);
        if within != advance {
            self.crank.driven.locked = false;
            if within == 0 && !self.crank.in_thread {
                self.crank.gearing = None;
            }
        }
        within
    }

    /// Puts the line to the spindle's angle, far enough before the tool to fall in with it.
    #[cold]
    fn gear(&mut self, foretold: Foretold, bounds: Bounds) {
        let Current::Motion(active) = &self.current else { return };
        let Some(spindle) = &self.crank.spindle else { return };
        let thread = match active.motion.feed {
            Feed::Thread(lead, start) => Some((lead, start)),
            Feed::Rapid | Feed::PerTick(_) | Feed::PerTurn(_) => None,
        };
        let mut gearing = match (thread, self.crank.drive) {
            (Some((lead, start)), _) => {
                // until the spindle turns and its index was seen there is no phase
                let Some(zero) = spindle.zero() else { return };
                if foretold.rate.unsigned_abs() < TURNING {
                    return;
                }
                let reverse = foretold.rate < 0;
                let mut gearing = Gearing::new(lead, spindle.turn(), foretold.angle, reverse);
                let behind = self.crank.groove.map_or(0, |groove| {
                    let behind = groove.at(self.position.z, self.crank.thread.pulse_z(), &active.motion, lead);
                    // angles count in the spindle's sense
                    if reverse { behind.wrapping_sub(groove.angle).wrapping_sub(groove.angle) } else { behind }
                });
                gearing.set_phase(zero, start.wrapping_add(behind));
                gearing
            }
            (None, Drive::Spindle(lead)) => Gearing::new(lead, spindle.turn(), foretold.angle, false),
            (None, Drive::Time | Drive::Wheel(_)) => return,
        };
        // what falling in needs, and a little
        let feed = gearing.travel(foretold.rate).unsigned_abs();
        let accel = u64::from(bounds.accel.wrapping_sub(bounds.accel >> 2).max(1));
        if thread.is_some() && feed > u64::from(bounds.speed) && self.crank.thread.is_guarded() {
            return self.fail(Trouble::TooFast { needed: to_u32(feed), limit: bounds.speed });
        }
        let lag = feed.saturating_mul(feed).checked_div(accel.wrapping_mul(2)).unwrap_or(0);
        let lag = lag.saturating_add(feed.wrapping_mul(2)).cast_signed();
        if thread.is_some() {
            let mut turns = 0_u32;
            while gearing.at(foretold.angle) > lag.wrapping_neg() && turns < MOST_TURNS {
                gearing.turn_back();
                turns = turns.wrapping_add(1);
            }
        } else {
            gearing.shift(if gearing.travel(foretold.rate) < 0 { lag } else { lag.wrapping_neg() });
        }
        self.crank.tool = 0;
        self.crank.gearing = Some(gearing);
    }
}

/// What the spindle asks for beyond the limits.
fn trouble(feed: i64, gain: i64, bounds: Bounds) -> Option<Trouble> {
    let (needed, gain) = (to_u32(feed.unsigned_abs()), to_u32(gain.unsigned_abs()));
    // the estimate of the acceleration is rough by less than a 16th of an acceleration that matters
    let most = bounds.accel.saturating_add(bounds.accel >> 4);
    if needed > bounds.speed {
        Some(Trouble::TooFast { needed, limit: bounds.speed })
    } else if gain > most {
        Some(Trouble::TooHard { needed: gain, limit: bounds.accel })
    } else {
        None
    }
}
