//! Drives other than time: which one turns the crank, their inputs, and what they keep from tick to tick.

use super::Memory;
use super::along::Along;
use super::groove::Groove;
use super::lookahead::{Overrides, pace};
use super::thread_hold::ThreadHold;
use super::{Active, Channel, Current, State};
use crate::block::{Feed, Output, Speed, Work};
use crate::config::TICK_CLOCKS;
use crate::curve::proportion::Proportion;
use crate::drive::follower::Follower;
use crate::drive::gearing::{Gearing, Lead};
use crate::drive::spindle::{COUNT, Spindle};
use crate::drive::wheel::{Click, Wheel};
use crate::drive::{BackEnd, Drive, DriveRefusal, Driven, Inputs, ThreadStage};
use crate::math::{percent, to_u32};
use crate::train::Train;
use core::borrow::BorrowMut;

/// The contour is not driven by the wheel's counts but pulled along, back or forth, at a speed.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Pull {
    /// Backward.
    pub back: bool,
    /// nm a tick with 12 fraction bits; at 0 it stands.
    pub speed: Speed,
}

/// What drives other than time keep.
#[derive(Clone, Debug)]
pub(super) struct Crank {
    /// The path is driven by something else than time, now.
    pub(super) turns: bool,
    /// The present motion is part of a thread.
    pub(super) in_thread: bool,
    /// The path goes back.
    pub(super) back: bool,
    pub(super) drive: Drive,
    pub(super) driven: Driven,
    pub(super) counts: i16,
    pub(super) wheel: Wheel,
    pub(super) along: Along,
    pub(super) pull: Option<Pull>,
    pub(super) spindle: Option<Spindle>,
    /// From the spindle's angle to path, while it drives.
    pub(super) gearing: Option<Gearing>,
    /// Path since it began to.
    pub(super) tool: i64,
    pub(super) follower: Follower,
    /// From the spindle's rate to path a tick, for feed a turn.
    feed: Option<Proportion>,
    /// Hold and faults in a thread.
    pub(super) thread: ThreadHold,
    /// The groove that threads meet.
    pub(super) groove: Option<Groove>,
}

impl Crank {
    pub(super) const fn new() -> Self {
        Self {
            turns: false,
            in_thread: false,
            back: false,
            drive: Drive::Time,
            driven: Driven::NONE,
            counts: 0,
            wheel: Wheel::new(),
            along: Along::new(),
            pull: None,
            spindle: None,
            gearing: None,
            tool: 0,
            follower: Follower::new(),
            feed: None,
            thread: ThreadHold::new(),
            groove: None,
        }
    }

    /// What the look-ahead plans with.
    pub(super) const fn planned_with(&self, overrides: Overrides) -> Overrides {
        match self.drive {
            Drive::Time => overrides,
            Drive::Spindle(_) | Drive::Wheel(_) => Overrides::AT_LIMIT,
        }
    }

    /// Forgets all motion.
    pub(super) fn stand(&mut self) {
        self.in_thread = false;
        // another drive goes its own way: forward until it says otherwise
        self.back = false;
        self.thread.end();
        self.driven.stage = ThreadStage::None;
        self.turns = !matches!(self.drive, Drive::Time);
        // what the contour wheel has asked for is dropped, and told
        let counts = i32::from(core::mem::take(&mut self.counts));
        let rest = if let Drive::Wheel(click) = self.drive { self.wheel.stop(click) } else { 0 };
        let pulled = self.pull.is_some();
        let dropped = counts.saturating_add(if pulled { 0 } else { rest });
        self.driven.dropped = self.driven.dropped.saturating_add(dropped);
        self.wheel = Wheel::new();
        self.along = Along::new();
        self.ungear();
    }

    /// Lets go of the spindle.
    pub(super) const fn ungear(&mut self) {
        self.gearing = None;
        self.follower = Follower::new();
        self.driven.locked = false;
    }

    /// Path a tick that the spindle makes of a lead, either sense; 0 without a spindle.
    fn per_turn(&self) -> Speed {
        match (self.spindle, self.feed) {
            (Some(spindle), Some(feed)) => to_u32(feed.of(spindle.foretold().rate.unsigned_abs())),
            _ => 0,
        }
    }

    /// Prepares the ratio of a feed a turn.
    pub(super) fn prepare(&mut self, lead: Lead) {
        self.feed = self.spindle.map(|spindle| {
            let turn = u64::from(spindle.turn()).wrapping_mul(COUNT.unsigned_abs());
            Proportion::new(u64::from(lead.nm()) << 12, turn, turn)
        });
    }
}

impl Active {
    /// Finds the pace anew, under another override or spindle speed.
    #[cold]
    pub(super) fn repace(&mut self, overrides: Overrides, crank: &Crank) {
        if matches!(self.motion.feed, Feed::PerTurn(_)) {
            // the override that it is paced at stays none, so it is found anew in every tick
            self.pace = percent(crank.per_turn(), overrides.feed).min(self.motion.top());
        } else {
            (self.pace, self.paced_at) = (pace(&self.motion, overrides), overrides);
        }
    }
}

impl<const N: usize, M: BorrowMut<Memory<N>>> Channel<N, M> {
    /// Sets counts a turn of the spindle's encoder, 4 a line; `None` for no encoder. False, and nothing changes, while a
    /// cycle runs or where the number is out of [`Spindle::COUNTS`].
    pub fn set_encoder(&mut self, counts: Option<u32>) -> bool {
        let spindle = counts.and_then(Spindle::new);
        let fits = matches!(self.state, State::Idle | State::Ended) && counts.is_some() == spindle.is_some();
        if fits {
            self.crank.spindle = spindle;
        }
        fits
    }

    /// The spindle as it is tracked.
    pub const fn spindle(&self) -> Option<&Spindle> {
        self.crank.spindle.as_ref()
    }

    /// What a detent of the contour wheel is worth from now on, where the wheel is the drive.
    pub const fn set_click(&mut self, click: Click) {
        if let Drive::Wheel(present) = &mut self.crank.drive {
            *present = click;
        }
    }

    /// Whether a thread is being cut.
    pub const fn in_thread(&self) -> bool {
        self.crank.in_thread
    }

    /// Path a tick that a lead makes of the spindle's present speed, either sense; 0 without a spindle.
    pub fn per_turn(&mut self, lead: Lead) -> Speed {
        self.crank.prepare(lead);
        self.crank.per_turn()
    }

    /// The drive.
    pub const fn drive(&self) -> Drive {
        self.crank.drive
    }

    /// Switches the drive. A thread is driven by the spindle, whatever the drive.
    ///
    /// # Errors
    /// Unless the path stands: nothing changes then.
    pub fn set_drive(&mut self, drive: Drive) -> Result<(), DriveRefusal> {
        if self.speed != 0 {
            return Err(DriveRefusal::Moving);
        }
        if self.crank.in_thread {
            return Err(DriveRefusal::InThread);
        }
        if matches!(drive, Drive::Spindle(_)) && self.crank.spindle.is_none() {
            return Err(DriveRefusal::NoEncoder);
        }
        // the tool went on without the lead of an S law
        self.lead = super::lead::Lead::at(match &self.current {
            Current::Motion(active) => active.done,
            Current::Nothing | Current::Dwell(_) => 0,
        });
        self.crank.stand();
        self.crank.drive = drive;
        self.crank.turns = !matches!(drive, Drive::Time);
        self.crank.driven = Driven { dropped: self.crank.driven.dropped, ..Driven::default() };
        Ok(())
    }

    /// Pulls the path along in place of the contour wheel, from the next tick on, while the wheel is the drive; `None` lets it
    /// brake, and leaves it to the wheel when it stands.
    pub const fn pull(&mut self, pull: Option<Pull>) {
        self.crank.pull = match (pull, self.crank.pull) {
            (None, Some(Pull { back, .. })) => Some(Pull { back, speed: 0 }),
            (pull, _) => pull,
        };
    }

    /// Takes the readings of the tick's start, before [`tick`](Self::tick). Counts of the wheel add up until then.
    pub fn read(&mut self, inputs: &Inputs) {
        self.crank.counts = self.crank.counts.saturating_add(inputs.wheel);
        if let (Some(spindle), Some(reading)) = (&mut self.crank.spindle, inputs.spindle) {
            spindle.observe(reading);
        }
    }

    /// A motion has begun.
    pub(super) fn begun(&mut self) {
        let Current::Motion(active) = &mut self.current else { return };
        self.crank.in_thread = match active.motion.feed {
            Feed::Rapid | Feed::PerTick(_) => false,
            Feed::Thread(..) => {
                self.crank.thread.begin(self.crank.in_thread, &mut self.crank.spindle);
                true
            }
            Feed::PerTurn(lead) => {
                self.crank.prepare(lead);
                self.crank.thread.begin_feed();
                active.paced_at = Overrides::AT_LIMIT;
                false
            }
        };
        self.crank.turns = self.crank.in_thread || !matches!(self.crank.drive, Drive::Time);
        if self.crank.in_thread {
            // it waits for its phase
            self.speed = 0;
        }
    }

    /// A tick of a drive other than time.
    #[inline(never)]
    pub(super) fn turn_crank(&mut self, out: &mut impl Train) -> Option<Output> {
        self.crank.driven = Driven { locked: self.crank.driven.locked, ..Driven::NONE };
        let counts = core::mem::take(&mut self.crank.counts);
        if let Current::Dwell(clocks) = &mut self.current {
            if matches!(self.state, State::Running) {
                *clocks = clocks.saturating_sub(u64::from(TICK_CLOCKS));
                if *clocks == 0 {
                    self.current = Current::Nothing;
                }
            }
            self.crank.driven.dropped = i32::from(counts);
            if let Drive::Wheel(click) = self.crank.drive {
                // what was asked for before a dwell does not set off by itself behind it
                self.drop_rest(click);
                if counts < 0 {
                    self.crank.driven.back_end = Some(BackEnd::Dwell);
                }
            }
            return None;
        }
        if let (Drive::Wheel(click), false) = (self.crank.drive, self.crank.in_thread) {
            return self.turn_wheel(click, counts, out);
        }
        self.crank.driven.dropped = i32::from(counts);
        if self.crank.in_thread {
            let done = self.tend_thread(out);
            self.crank.driven.stage = self.crank.thread.stage();
            if done {
                return None;
            }
        }
        if matches!(self.current, Current::Nothing) && !self.begin_geared() {
            return self.other_work();
        }
        self.turn_spindle(out);
        None
    }

    /// Does what stands next in the program and is no motion. By the wheel a program does not end: it could not be gone back
    /// into.
    pub(super) fn other_work(&mut self) -> Option<Output> {
        let wheel = matches!(self.crank.drive, Drive::Wheel(_));
        let other = self.memory.borrow().ahead.next().is_some_and(|(block, _)| match block.work {
            Work::Motion(_) => false,
            Work::End => !wheel,
            Work::Dwell(_) | Work::Output(_) | Work::Stop | Work::OptionalStop => true,
        });
        if other && !self.memory.borrow().trail.is_behind() && matches!(self.state, State::Running) {
            self.crank.ungear();
            if let super::run::Next::Output(output) = self.next_block() {
                return Some(output);
            }
        }
        None
    }
}
