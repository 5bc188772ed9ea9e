//! Hold, return and spindle faults in a thread.
//!
//! A path that stops in a groove ruins it. So a hold first pulls X out while the path goes on in step with the spindle, and
//! brakes the path then. At cycle start the tool returns to where the pass began with X out, X goes in, and the pass is
//! run again from the index. A reset and a fault of the spindle leave the thread in the same way; behind a reset X stays
//! out, and the position says so.
//!
//! ```text
//!                        +------------------------------------------------+
//!                        v                                                |
//!   (a thread begins) Waiting -> Cutting -> Leaving -> Left -> Returning -> Entering
//!                        |          |          hold, reset,  cycle            |
//!                        |          |          fault         start     hold: X out again, Left
//!                        +----------+--> (its end)
//! ```
//!
//! A hold acts at the thread's end instead where X is not to be pulled out, where X leads the thread, and where the pass
//! has more blocks than the way back is known for.

mod tend;

use super::Memory;
use super::geared::TURNING;
use super::retract::Retract;
use super::{Active, Channel, Current, State};
use crate::block::{Curve, Speed};
use crate::channel::crank::Crank;
use crate::channel::follower::Pace;
use crate::compensation;
use crate::config::{FRACTION_BITS, Machine};
use crate::drive::spindle::Spindle;
use crate::drive::{Driven, ThreadStage, Trouble};
use crate::math::{scale, to_i64, to_u32};
use crate::threading::Threading;
use crate::units::PulseSize;
use core::borrow::BorrowMut;

/// Ticks that a spindle is waited for that does not turn.
const PATIENCE: u32 = 5_000;

/// Ticks after which a spindle that hardly turns has stopped, and is not about to turn round.
const SLOW: u32 = 100;

/// Share of its largest speed in a cut, as a shift, below which a spindle hardly turns.
const HARDLY: u32 = 4;

/// Blocks of a pass that the way back is certainly known for: the trail holds nothing else, and all of them stand ready.
const MOST_BLOCKS: u32 = 8;
const _: () = assert!((MOST_BLOCKS as usize) < super::trail::WINDOW);

/// What a thread keeps besides its gearing.
#[derive(Clone, Debug)]
pub(super) struct ThreadHold {
    threading: Threading,
    /// Pulses of X and Z.
    pulses: (PulseSize, PulseSize),
    /// Pulses that X goes out by, and how.
    distance: i32,
    pace: Pace,
    stage: ThreadStage,
    /// X is out: the path brakes.
    brakes: bool,
    retract: Retract,
    fault: Option<Trouble>,
    /// Ticks that the spindle was waited for.
    waited: u32,
    /// Ticks that the spindle has hardly turned.
    slow: u32,
    /// Largest rate of the spindle in this cut; its sense is that of the cut.
    peak: i64,
    was_locked: bool,
    /// Blocks begun in this pass.
    blocks: u32,
}

impl ThreadHold {
    pub(super) const fn new() -> Self {
        Self {
            threading: Threading::NONE,
            pulses: (PulseSize::ONE_MICROMETRE, PulseSize::ONE_MICROMETRE),
            distance: 0,
            pace: Pace { speed: 1, accel: 1 },
            stage: ThreadStage::None,
            brakes: false,
            retract: Retract::new(),
            fault: None,
            waited: 0,
            slow: 0,
            peak: 0,
            was_locked: false,
            blocks: 0,
        }
    }

    fn configure(&mut self, machine: &Machine) {
        let pulse = machine.x.pulse;
        self.threading = machine.threading;
        self.pulses = (pulse, machine.z.pulse);
        self.distance = pulse.nearest(machine.threading.retract);
        // a quarter is left for a taper's own motion
        let part = |rate: u32| i128::from(rate.wrapping_sub(rate >> 2));
        let rate = |rate: u32| compensation::pulses(pulse, part(rate), FRACTION_BITS).max(1);
        self.pace = Pace { speed: rate(machine.x.speed), accel: rate(machine.x.accel) };
    }

    /// A block of a thread begins; `goes_on` where it follows another one.
    pub(super) fn begin(&mut self, goes_on: bool, spindle: &mut Option<Spindle>) {
        if goes_on {
            self.blocks = self.blocks.saturating_add(1);
        } else {
            self.blocks = 1;
            self.wait(spindle);
        }
    }

    /// Waits for the spindle at the start. An index in doubt is looked for anew.
    fn wait(&mut self, spindle: &mut Option<Spindle>) {
        self.stage = ThreadStage::Waiting;
        (self.waited, self.slow, self.peak, self.was_locked, self.brakes) = (0, 0, 0, false, false);
        if let Some(spindle) = spindle
            && self.threading.guarded
            && (spindle.is_index_missing() || spindle.lost().is_some())
        {
            spindle.forget_index();
        }
    }

    /// How far a pulse moves Z.
    pub(super) const fn pulse_z(&self) -> PulseSize {
        self.pulses.1
    }

    /// The thread is over.
    pub(super) const fn end(&mut self) {
        self.stage = ThreadStage::None;
        self.fault = None;
    }

    /// A feed a turn begins.
    pub(super) const fn begin_feed(&mut self) {
        self.waited = 0;
    }

    /// Cycle start: what was wrong is over.
    pub(super) const fn go_on(&mut self) {
        self.fault = None;
        self.waited = 0;
    }

    /// Whether faults of the spindle end the cut.
    pub(super) const fn is_guarded(&self) -> bool {
        self.threading.guarded
    }

    pub(super) const fn stage(&self) -> ThreadStage {
        self.stage
    }

    /// The pulses of X to be added in a tick.
    #[inline]
    pub(super) fn pulses(&mut self) -> i32 {
        if self.retract.is_live() { self.retract.tick() } else { 0 }
    }

    /// By how many pulses X is out.
    pub(super) const fn out(&self) -> i32 {
        self.retract.pulses()
    }

    /// Speed of X on its way out or back: nm a tick, 12 fraction bits.
    pub(super) fn speed(&self) -> Speed {
        let numerator = self.pulses.0.numerator().into();
        let nm =
            self.retract.speed().unsigned_abs().saturating_mul(numerator) >> (compensation::FRACTION - FRACTION_BITS);
        to_u32(nm.checked_div(self.pulses.0.denominator().into()).unwrap_or(0))
    }

    /// Pulses that X is pulled out by.
    pub(super) const fn distance(&self) -> i32 {
        self.distance
    }

    /// X stands where it is from now on: by how many pulses that is off the program.
    pub(super) const fn take(&mut self) -> i32 {
        self.retract.take()
    }

    /// Whether the tool is on its way out of a groove, or into one.
    pub(super) const fn is_busy(&self) -> bool {
        matches!(self.stage, ThreadStage::Leaving | ThreadStage::Entering) || self.retract.is_live()
    }

    /// Whether the pass is given up, to be repeated.
    pub(super) const fn is_left(&self) -> bool {
        matches!(self.stage, ThreadStage::Leaving | ThreadStage::Left)
    }

    /// Whether the path brakes, or stands.
    pub(super) const fn is_path_held(&self, state: State) -> bool {
        match self.stage {
            ThreadStage::Leaving => self.brakes,
            ThreadStage::None | ThreadStage::Waiting => matches!(state, State::Holding | State::Resetting),
            // where X can't be pulled out a hold waits for the end
            ThreadStage::Cutting => matches!(state, State::Resetting) || self.fault.is_some(),
            ThreadStage::Left | ThreadStage::Returning | ThreadStage::Entering => true,
        }
    }

    /// The path advanced by `made` with the spindle at `rate`.
    pub(super) fn went(&mut self, made: i64, rate: i64, driven: &Driven) {
        if matches!(self.stage, ThreadStage::Waiting) && made != 0 {
            self.stage = ThreadStage::Cutting;
            self.peak = rate;
        }
        if !matches!(self.stage, ThreadStage::Cutting) {
            return;
        }
        self.was_locked |= driven.locked;
        if self.threading.guarded && self.fault.is_none() && !driven.locked {
            self.fault = match driven.trouble {
                Some(trouble @ Trouble::TooFast { .. }) => Some(trouble),
                Some(trouble @ Trouble::TooHard { .. }) if self.was_locked => Some(trouble),
                _ => None,
            };
        }
    }

    /// What is wrong with the spindle while a groove is cut.
    fn look(&mut self, spindle: &Spindle) -> Option<Trouble> {
        let rate = spindle.foretold().rate;
        let (forward, peak) =
            if self.peak < 0 { (rate.wrapping_neg(), self.peak.wrapping_neg()) } else { (rate, self.peak) };
        let peak = if forward > peak {
            self.peak = rate;
            forward
        } else {
            peak
        };
        let least = (peak >> HARDLY).max(TURNING.cast_signed());
        self.slow = if forward < least { self.slow.saturating_add(1) } else { 0 };
        if forward < least.wrapping_neg() {
            Some(Trouble::Reversed)
        } else if self.slow > SLOW {
            Some(Trouble::Stopped)
        } else if spindle.is_index_missing() {
            Some(Trouble::IndexLost)
        } else {
            spindle.lost().map(|off| Trouble::Index { off })
        }
    }

    /// A tick of waiting at the start: why that has no end.
    fn look_out(&mut self, spindle: &mut Option<Spindle>) -> Option<Trouble> {
        let turns = spindle.as_ref().is_some_and(|spindle| spindle.foretold().rate.unsigned_abs() >= TURNING);
        let Some(spindle) = spindle.as_mut().filter(|_| turns) else {
            self.waited = self.waited.saturating_add(1);
            return (self.waited > PATIENCE).then_some(Trouble::NoSpindle);
        };
        self.waited = 0;
        let lost = spindle.lost().map(|off| Trouble::Index { off });
        let trouble = lost.or((spindle.is_index_missing() && spindle.zero().is_none()).then_some(Trouble::IndexLost));
        if trouble.is_some() || spindle.is_index_missing() {
            // it is looked for anew
            spindle.forget_index();
        }
        trouble
    }

    /// The speed that X is left with beside a motion at a speed.
    fn pace_beside(&self, active: &Active, speed: u32) -> Pace {
        let (x, _) = active.motion.curve.end();
        let length = i128::from(active.motion.length.max(1));
        let speed = i128::from(x.unsigned_abs()).wrapping_mul(i128::from(speed)) << compensation::FRACTION;
        // and what a wobble adds
        let own = to_i64(scale(speed, 5, length.saturating_mul(4)));
        Pace { speed: self.pace.speed.saturating_sub(own).max(self.pace.speed >> 3).max(1), ..self.pace }
    }
}

impl Crank {
    pub(super) fn of(machine: &Machine) -> Self {
        let mut crank = Self::new();
        crank.configure(machine);
        crank
    }

    /// Takes other figures.
    pub(super) fn configure(&mut self, machine: &Machine) {
        if self.thread.threading.encoder != machine.threading.encoder {
            self.spindle = Spindle::new(machine.threading.encoder);
        }
        self.thread.configure(machine);
    }
}

impl<const N: usize, M: BorrowMut<Memory<N>>> Channel<N, M> {
    /// What is wrong with the spindle, where that ended a cut or a wait: from then on until cycle start or reset.
    pub const fn fault(&self) -> Option<Trouble> {
        self.crank.thread.fault
    }

    /// By how many pulses X is pulled out of a thread: that far the tool is off [`position`](Self::position).
    pub const fn retracted(&self) -> i32 {
        self.crank.thread.out()
    }

    /// A feed a turn stands, since the spindle does.
    #[cold]
    pub(super) fn await_spindle(&mut self) {
        let Current::Motion(active) = &self.current else { return };
        let paced = matches!(active.motion.feed, crate::block::Feed::PerTurn(_));
        if paced
            && self.overrides.feed > 0
            && matches!(self.state, State::Running)
            && self.crank.thread.threading.guarded
        {
            self.crank.thread.waited = self.crank.thread.waited.saturating_add(1);
            if self.crank.thread.waited > PATIENCE {
                self.crank.thread.waited = 0;
                self.fail(Trouble::NoSpindle);
            }
        }
    }

    /// Ends a cut or a wait.
    pub(super) fn fail(&mut self, trouble: Trouble) {
        self.crank.thread.fault = Some(trouble);
        if matches!(self.state, State::Running) {
            self.state = State::Holding;
        }
    }

    /// Whether the present block is a line that goes farther along Z.
    pub(super) fn leads_z(&self) -> bool {
        let Current::Motion(active) = &self.current else { return false };
        let ((x, z), (pulse_x, pulse_z)) = (active.motion.curve.end(), self.crank.thread.pulses);
        // both with the same denominator; below 2^31 2^24 2^12
        let nm = |count: i32, pulse: PulseSize, other: PulseSize| {
            let nm = i128::from(count.unsigned_abs()).wrapping_mul(i128::from(pulse.numerator()));
            nm.wrapping_mul(i128::from(other.denominator()))
        };
        !matches!(active.motion.curve, Curve::Arc(_)) && nm(z, pulse_z, pulse_x) >= nm(x, pulse_x, pulse_z)
    }
}
