//! The checker: takes the motions and the ticks, and hands each edge to the figures.

use crate::accel::Accel;
use crate::added::{Added, program_setup};
use crate::deviation::Deviation;
use crate::fault::{FaultKind, Faults, Here};
use crate::feed::Feed;
use crate::follow::Follow;
use crate::geometry::Curve;
use crate::hash::Fnv;
use crate::path::{Motion, Scale, Waypoint};
use crate::pins::Port;
use crate::report::Report;
use crate::setup::{CLOCKS_PER_SECOND, CLOCKS_PER_TICK, PerAxis, Setup, SetupError, clocks_for};

/// Reads a pulse train and the motions it should play.
///
/// Call [`motion`](Self::motion) for each programmed motion before the tick that plays its first pulse,
/// [`tick`](Self::tick) for each millisecond, [`finish`](Self::finish) at the end. Memory is bounded by
/// how far the motions run ahead of the ticks.
#[derive(Clone, Debug)]
pub struct Checker {
    event_min: u32,
    setup: Setup,
    /// Where the program is; the motor, too, without compensation.
    here: Here,
    motor: PerAxis<i32>,
    port: Port,
    follow: Follow,
    accel: Accel,
    feed: Feed,
    faults: Faults,
    /// Pulses per nm, of the coarser pulse equivalent.
    per_nm: f64,
    walked: Deviation,
    programmed: Deviation,
    pulses: PerAxis<u64>,
    motions: u64,
    backward: u64,
    /// So far, and at the end of the last tick that moved.
    count: Count,
    moved: Count,
}

/// No step.
const STILL: PerAxis<i32> = PerAxis { x: 0, z: 0 };

#[derive(Copy, Clone, Debug)]
struct Count {
    events: u64,
    hash: Fnv,
    clocks: u64,
}

impl Checker {
    /// A checker for a machine that stands at the start.
    ///
    /// # Errors
    /// A pulse equivalent or a limit that is no number to measure with.
    pub fn new(setup: Setup) -> Result<Self, SetupError> {
        setup.check()?;
        let scale = Scale::new(setup);
        let here = Here { at: setup.start, ..Here::default() };
        let (x, z) = (setup.limits.x, setup.limits.z);
        let smoothed = f64::from(setup.smoothed_ticks) / 1e3;
        let settle = 2.0 * x.max_feed.max(z.max_feed) / 60.0 / x.max_accel.min(z.max_accel) + 2.0 * smoothed;
        let at = setup.start.map(i64::from);
        let mut faults = Faults::default();
        let rounded = scale.nearest(setup.start_nm);
        if rounded != at {
            faults.add(here.fault(FaultKind::StartOffLattice, None, rounded.x, rounded.z));
        }
        let count = Count { events: 0, hash: Fnv::EMPTY, clocks: 0 };
        let from = Waypoint { nm: setup.start_nm, at };
        Ok(Self {
            event_min: u32::try_from(clocks_for(setup.event_min_ns)).unwrap_or(u32::MAX),
            setup,
            here,
            motor: setup.start,
            port: Port::new(setup.limits),
            accel: Accel::new(&setup),
            feed: Feed::new(2.0 * scale.coarser / 1e6, smoothed, whole_clocks(settle)),
            faults,
            per_nm: 1.0 / scale.coarser,
            follow: Follow::new(scale, from),
            walked: Deviation::default(),
            programmed: Deviation::default(),
            pulses: PerAxis::default(),
            motions: 0,
            backward: 0,
            count,
            moved: count,
        })
    }

    /// Tells, before any motion, which axes the control compensates: the program is left 15/16 of their speed and 4/5 of
    /// their acceleration.
    #[must_use]
    pub fn compensated(mut self, axes: PerAxis<bool>) -> Self {
        let start = Waypoint { nm: self.setup.start_nm, at: self.setup.start.map(i64::from) };
        self.follow = Follow::new(Scale::new(program_setup(self.setup, axes)), start);
        self
    }

    /// Tells the next motion.
    pub fn motion(&mut self, motion: Motion) {
        self.follow.motion(motion);
    }

    /// Tells that the axes stand still between the last motion told and the next one.
    pub fn pause(&mut self) {
        self.follow.pause();
    }

    /// The axes stand since the last edge, at the operator's word: one jump led there, one will lead away. A rest of
    /// 20 ms is seen without it; a shorter one only shows in that it was told.
    pub fn rest(&mut self) {
        self.accel.rest();
    }

    /// Tells that from the next tick on the feed is scaled by `percent`.
    pub fn override_percent(&mut self, percent: u32) {
        self.feed.override_percent(percent, self.here.clocks);
    }

    /// Position of the program in pulses after the last tick.
    #[must_use]
    pub fn position(&self) -> PerAxis<i32> {
        self.here.at
    }

    /// Faults found so far.
    #[must_use]
    pub fn faults(&self) -> &Faults {
        &self.faults
    }

    /// Takes a tick of the train: one millisecond of events, low 16 bits the interval in clocks, bits 16
    /// to 19 X step, X plus, Z step, Z plus. Other bits belong to other lathes.
    pub fn tick(&mut self, events: &[u32]) {
        self.tick_traced(events, &mut |_, _, _| {});
    }

    /// As `tick`; calls `on_step` at each event with a rising edge, with its time in train clocks and
    /// the position after it.
    pub fn tick_traced(&mut self, events: &[u32], on_step: &mut impl FnMut(u64, i32, i32)) {
        self.tick_added(events, &[], on_step);
    }

    /// As `tick_traced`, where a control that compensates tells in what its motors differ from the program, in the order
    /// of time. `on_step` gets the program's position; at steps that are the program's alone, too.
    pub fn tick_added(&mut self, events: &[u32], added: &[Added], on_step: &mut impl FnMut(u64, i32, i32)) {
        let mut added = added.iter().peekable();
        let start = self.here.clocks;
        let pulses = self.pulses;
        let mut hash = self.count.hash;
        for &event in events {
            hash.add(event);
            let interval = event & 0xFFFF;
            if interval < self.event_min {
                let (found, bound) = (i64::from(interval), i64::from(self.event_min));
                let kind = FaultKind::EventTooShort;
                self.faults.add(self.here.fault(kind, None, found, bound));
            }
            let moved = self.port.write(event, self.here, &mut self.faults);
            let now = self.here.clocks - start;
            // up to this edge: what the program does by itself, and what the edge is besides it
            let mut program = moved;
            while let Some(next) = added.next_if(|next| u64::from(next.clock) <= now) {
                if next.motor == STILL {
                    self.step(next.program, STILL);
                    on_step(self.here.clocks, self.here.at.x, self.here.at.z);
                } else {
                    if next.motor != moved || u64::from(next.clock) != now {
                        let fault =
                            self.here.fault(FaultKind::NotAdded, None, next.motor.x.into(), next.motor.z.into());
                        self.faults.add(fault);
                    }
                    program = next.program;
                }
            }
            if moved != STILL {
                self.step(program, moved);
                on_step(self.here.clocks, self.here.at.x, self.here.at.z);
            }
            self.here.clocks += u64::from(interval);
        }
        let sum = (self.here.clocks - start).cast_signed();
        let tick = i64::from(CLOCKS_PER_TICK);
        if sum != tick {
            let fault = self.here.fault(FaultKind::TickSum, None, sum, tick);
            self.faults.add(fault);
        }
        for left in added {
            if left.motor != STILL {
                let fault = self.here.fault(FaultKind::NotAdded, None, left.motor.x.into(), left.motor.z.into());
                self.faults.add(fault);
            }
            self.step(left.program, STILL);
            on_step(self.here.clocks, self.here.at.x, self.here.at.z);
        }
        self.accel.boundary(Here { at: self.motor, ..self.here }, &mut self.faults);
        self.count.hash = hash;
        self.count.events += events.len() as u64;
        self.count.clocks = self.here.clocks;
        if self.pulses != pulses {
            self.moved = self.count;
        }
    }

    /// The program moves by `moved`, the motor by `motor`.
    fn step(&mut self, moved: PerAxis<i32>, motor: PerAxis<i32>) {
        self.motor.x = self.motor.x.wrapping_add(motor.x);
        self.motor.z = self.motor.z.wrapping_add(motor.z);
        self.pulses.x += u64::from(motor.x.unsigned_abs());
        self.pulses.z += u64::from(motor.z.unsigned_abs());
        if moved != motor {
            self.accel.added();
        }
        if moved == STILL {
            // an edge all the same, of an axis that nothing is programmed for
            self.accel.edge(motor, false, true);
            return;
        }
        self.here.at.x = self.here.at.x.wrapping_add(moved.x);
        self.here.at.z = self.here.at.z.wrapping_add(moved.z);
        let seen = self.follow.step(self.here, moved, &mut self.faults);
        if seen.entered
            && let Some(path) = self.follow.current()
        {
            self.here.line = path.line;
            self.feed.begin(path);
        }
        self.walked.take(seen.walked * self.per_nm, self.here);
        self.programmed.take(seen.programmed * self.per_nm, self.here);
        self.backward += u64::from(seen.backward);
        let round = self.follow.piece().is_some_and(|piece| matches!(piece.curve, Curve::Arc(_)));
        self.accel.edge(moved, seen.paused, round);
        if self.feed.due(self.here.clocks) {
            self.sample(moved);
        }
        if seen.completed {
            self.motions += 1;
            self.accel.joint();
            self.feed.end();
        }
    }

    /// A sample of the feed is due at this step, if the step is one of the major axis.
    fn sample(&mut self, moved: PerAxis<i32>) {
        let Some(piece) = self.follow.piece() else {
            return;
        };
        let scale = &self.follow.scale;
        let point = scale.place(self.here.at);
        let foot = piece.curve.foot(point, scale.nm_x, scale.nm_z);
        let major = if foot.x_is_major { moved.x } else { moved.z };
        if major != 0 && foot.settled {
            let mm = (piece.before + foot.progress) / 1e6;
            self.feed.sample(self.here.clocks, mm);
        }
    }

    /// Ends the train, which is followed by rest, and gives the figures.
    #[must_use]
    pub fn finish(mut self) -> Report {
        self.port.finish(self.here, &mut self.faults);
        self.accel.finish(Here { at: self.motor, ..self.here }, &mut self.faults);
        let left = self.follow.left();
        if left > 0 {
            let left = i64::try_from(left).unwrap_or(i64::MAX);
            let fault = self.here.fault(FaultKind::MotionsLeft, None, left, 0);
            self.faults.add(fault);
        }
        let end = self.follow.last_end();
        if self.here.at.map(i64::from) != end {
            let fault = self.here.fault(FaultKind::EndMissed, None, end.x, end.z);
            self.faults.add(fault);
        }
        Report {
            events: self.moved.events,
            pulses: self.pulses,
            beyond: PerAxis {
                x: self.motor.x.wrapping_sub(self.here.at.x),
                z: self.motor.z.wrapping_sub(self.here.at.z),
            },
            motions: self.motions,
            time_s: seconds(self.moved.clocks),
            train_hash: self.moved.hash.value(),
            walked: self.walked,
            programmed: self.programmed,
            backward_steps: self.backward,
            max_rate_hz: self.port.max_rate(),
            max_accel: self.accel.max_accel(),
            bend_excess: self.accel.excess(),
            feed_error_percent: self.feed.finish(),
            faults: self.faults,
        }
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates; a time is above zero")]
fn whole_clocks(seconds: f64) -> u64 {
    (seconds * f64::from(CLOCKS_PER_SECOND)).ceil() as u64
}

#[expect(clippy::cast_precision_loss, reason = "below 2^53 clocks, 23 years")]
fn seconds(clocks: u64) -> f64 {
    clocks as f64 / f64::from(CLOCKS_PER_SECOND)
}
