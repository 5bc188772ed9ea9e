//! One lathe: takes blocks, gives a tick of pulse train.
//!
//! A tick is a pure function of the channel's state, the commands given since the last and the blocks taken. Blocks
//! are taken only at a tick's start and only as many as fit, so as long as the source keeps up the train does not
//! depend on when they arrived; should the source lag, the plan ends in standstill and the lag is counted.

mod active;
mod along;
#[cfg(feature = "methods")]
mod classic;
#[cfg(feature = "methods")]
mod conic;
mod crank;
mod cruise;
mod cycle;
mod fence;
pub mod follower;
mod geared;
pub mod groove;
pub mod hand;
mod hands;
mod lead;
pub mod lookahead;
mod margins;
mod memory;
mod report;
mod retract;
mod runner;
mod settings;
mod single;
pub mod superposed;
mod swath;
mod take;
mod thread_hold;
mod trail;
mod walk;
mod wheeled;
mod window;

use crate::block::{Block, Output, Speed, Work};
use crate::compensation::Compensation;
use crate::config::{Machine, TICK_CLOCKS};
use crate::drive::BackEnd;
use crate::governor::Advance;
use crate::governor::square;
use crate::math::root;
use crate::shaper::Shaper;
use crate::times::Stretch;
use crate::train::Train;
use crate::units::Lattice;
use active::{Active, Current};
use core::borrow::BorrowMut;
use crank::Crank;
pub use crank::Pull;
use fence::Fence;
use hands::Hands;
use lead::Lead;
use lookahead::Overrides;
use lookahead::smooth::is_smoothed;
pub use memory::Memory;
pub use report::{Report, State};
use runner::Sink;
use single::Single;
use superposed::Superposed;
use trail::maker::Maker;
use window::Window;

/// What became of the block that came next.
enum Next {
    /// Something was begun, or is over already.
    Goes,
    /// Nothing comes.
    Stands,
    /// An output changes at the end of this tick.
    Output(Output),
}

/// One lathe's interpolator, with a look-ahead of `N` blocks, and with a memory of its own or one that it is lent.
// what each tick needs stands before the memory, whose size would put it out of an instruction's reach
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Channel<const N: usize, M = Memory<N>> {
    state: State,
    optional_stop: bool,
    /// The end block was taken: no more come.
    complete: bool,
    /// No more come once the source has none.
    closed: bool,
    overrides: Overrides,
    single: Single,
    line: u32,
    speed: Speed,
    /// Speed below which any axis may start or stop at once.
    rest: Speed,
    starved: u32,
    /// Ticks of filling since the last block came.
    waited: u32,
    position: Lattice,
    shaper: Shaper,
    superposed: Superposed,
    current: Current,
    compensation: Compensation,
    /// What drives other than time keep.
    crank: Crank,
    hands: Hands,
    fence: Fence,
    lead: Lead,
    window: Window,
    maker: Maker,
    memory: M,
}

impl<const N: usize> Channel<N> {
    /// A channel that stands at `position`.
    pub fn new(machine: &Machine, position: Lattice) -> Self {
        Self::with_memory(machine, position, Memory::new())
    }
}

impl<const N: usize, M: BorrowMut<Memory<N>>> Channel<N, M> {
    /// A channel that stands at `position` and keeps its blocks in `memory`, which it empties first.
    // as a call it would pass over the stack once more
    #[inline(always)]
    pub fn with_memory(machine: &Machine, position: Lattice, mut memory: M) -> Self {
        memory.borrow_mut().clear();
        Self {
            state: State::Idle,
            current: Current::Nothing,
            line: 0,
            speed: 0,
            shaper: Shaper::new(machine),
            superposed: Superposed::new(),
            compensation: Compensation::new(&machine.compensation, position),
            position,
            overrides: Overrides::NONE,
            single: Single::new(),
            optional_stop: false,
            complete: false,
            closed: false,
            rest: machine.x.jump.min(machine.z.jump),
            starved: 0,
            waited: 0,
            crank: Crank::of(machine),
            hands: Hands::new(machine),
            fence: Fence::new(),
            lead: Lead::new(),
            window: Window::new(machine.smoothing),
            maker: Maker::new(machine),
            memory,
        }
    }

    /// Makes one tick: takes blocks from `source`, gives events to `out`.
    pub fn tick(&mut self, source: &mut impl FnMut() -> Option<Block>, out: &mut impl Train) -> Report {
        let in_cycle = matches!(self.state, State::Running | State::Holding | State::Stopped | State::Resetting);
        self.take(source);
        let mut output = None;
        let retract = self.crank.thread.pulses();
        let (x, z) = self.by_hand(retract);
        let x = x.wrapping_add(retract);
        self.fence.forget();
        let moves = in_cycle || !self.hands.at_rest();
        // what the compensation lacks when all has come to rest is made then
        if moves || x != 0 || z != 0 || self.lags() {
            if x != 0 || z != 0 || self.compensation.is_on() {
                self.superpose(x, z, moves);
            }
            if in_cycle {
                self.slide();
                self.keep_inside();
                output = self.run(out);
            }
        }
        if self.superposed.is_live() {
            self.superposed.end(self.speed > 0, &mut self.shaper, out);
        }
        self.shaper.end_tick(out);
        if matches!(self.state, State::Filling) {
            self.fill();
        }
        if matches!(self.state, State::Resetting) && self.speed == 0 && self.settled() {
            self.forget();
        }
        let driven = self.crank.driven;
        // each count is told once
        self.crank.driven.dropped = 0;
        self.crank.driven.back_end = None;
        Report { state: self.state, in_cycle, output, line: self.line, speed: self.speed, driven }
    }

    /// The program's place with what the hands have added, and with what X is out of a thread.
    const fn tool(&self) -> Lattice {
        let (position, offset) = (self.position, self.hands.offset());
        let x = position.x.wrapping_add(offset.x).wrapping_add(self.crank.thread.out());
        Lattice { x, z: position.z.wrapping_add(offset.z) }
    }

    /// Adds so many pulses, and what the compensation gives, to the tick, in which anything else `moves` or may.
    fn superpose(&mut self, x: i32, z: i32, moves: bool) {
        let (mut x, mut z) = (x, z);
        if self.compensation.is_on() {
            let at = self.tool();
            let more = self.compensation.tick(at, moves);
            (x, z) = (x.wrapping_add(more.0), z.wrapping_add(more.1));
        }
        if x != 0 || z != 0 {
            self.superposed.begin(x, z);
        }
    }

    /// A tick's step toward having the motions at hand that were gone back over: before anybody looks where the path leads.
    #[inline]
    fn slide(&mut self) {
        let trail = &mut self.memory.borrow_mut().trail;
        if self.crank.turns || trail.is_behind() {
            trail.slide(self.crank.turns && self.crank.back, &mut self.maker);
        }
    }

    /// Executes for one tick.
    fn run(&mut self, out: &mut impl Train) -> Option<Output> {
        if self.crank.turns {
            return self.turn_crank(out);
        }
        if self.window.ticks() > 0 && !self.memory.borrow().trail.is_behind() && self.follows() {
            if self.window.is_drained() && matches!(self.current, Current::Nothing) && self.stops_single() {
                self.state = State::Stopped;
                self.speed = 0;
                return None;
            }
            self.follow(out);
            return None;
        }
        let mut clock = 0_u32;
        while clock < TICK_CLOCKS && matches!(self.state, State::Running | State::Holding | State::Resetting) {
            let left = TICK_CLOCKS.wrapping_sub(clock);
            match &mut self.current {
                Current::Motion(_) => match self.go(clock, out) {
                    Some(used) => clock = clock.wrapping_add(used),
                    None => break,
                },
                Current::Dwell(_) if !matches!(self.state, State::Running) => break,
                Current::Dwell(clocks) => {
                    let used = crate::math::to_u32((*clocks).min(u64::from(left)));
                    *clocks = clocks.wrapping_sub(u64::from(used));
                    clock = clock.wrapping_add(used);
                    if *clocks == 0 {
                        self.current = Current::Nothing;
                    }
                }
                Current::Nothing => match self.next_block() {
                    Next::Goes if self.crank.turns => break,
                    Next::Goes => {}
                    Next::Stands => break,
                    Next::Output(output) => return Some(output),
                },
            }
        }
        None
    }

    /// Whether all is made that has to be added to the program where it stands.
    fn settled(&self) -> bool {
        let compensated = !self.compensation.is_on() || self.compensation.settled();
        !self.superposed.owes() && compensated && !self.crank.thread.is_busy()
    }

    /// Begins what comes next.
    // apart from `run`, so that a tick inside a block pays nothing for it
    #[inline(never)]
    fn next_block(&mut self) -> Next {
        // a hold brakes on over joints; it ends where the program stands anyway
        if !matches!(self.state, State::Running) && self.speed == 0 {
            return Next::Stands;
        }
        if self.memory.borrow().trail.is_behind() {
            // what is not ready yet is waited for
            let goes = self.memory.borrow_mut().trail.go_on() && self.enter_again();
            // from standstill it begins with the next tick: a stop and a start are two jumps; and an S law's lead sets off there
            return if goes && self.speed > 0 { Next::Goes } else { Next::Stands };
        }
        // the tool is where it should be before the program stands; and only a cycle moves what is added
        let moves = self.memory.borrow().ahead.next().is_some_and(|(block, _)| lookahead::as_motion(block).is_some());
        if !moves && !self.settled() {
            return Next::Stands;
        }
        if self.speed == 0 && self.stops_single() {
            self.state = State::Stopped;
            return Next::Goes;
        }
        let Memory { ahead, trail } = self.memory.borrow_mut();
        let Some((block, entry)) = ahead.next() else {
            self.state = State::Filling;
            return Next::Stands;
        };
        self.line = block.line;
        // a motion is large: it is copied once, from the look-ahead to where it is executed
        match block.work {
            // under an S law it begins with the next tick
            Work::Motion(ref motion) if self.window.ticks() > 0 && is_smoothed(motion) => {
                self.speed = 0;
                return Next::Stands;
            }
            Work::Motion(ref motion) => {
                self.speed = if self.speed == 0 {
                    // planned to be entered at speed, it may come to be begun from a stand: single block, a hold at its joint
                    self.hands.cap(root(entry).min(motion.start))
                } else {
                    // what braking could not shed of a lowered feed goes on; what the machine can't take does not
                    self.speed.min(motion.joint).min(motion.limit)
                };
                self.current = Current::Motion(Active::new(motion, self.overrides, self.position));
                trail.push(block.line, motion);
                ahead.skip();
                self.begun();
                return Next::Goes;
            }
            Work::Dwell(ticks) => {
                self.current = Current::Dwell(u64::from(ticks).wrapping_mul(u64::from(TICK_CLOCKS)));
            }
            Work::Output(output) => {
                trail.clear(BackEnd::Output);
                ahead.skip();
                return Next::Output(output);
            }
            Work::Stop => self.state = State::Stopped,
            Work::OptionalStop if self.optional_stop => self.state = State::Stopped,
            Work::OptionalStop => {}
            Work::End => {
                self.state = State::Ended;
                self.line = 0;
                trail.clear(BackEnd::Start);
            }
        }
        trail.stand();
        ahead.skip();
        Next::Goes
    }

    /// Advances the motion from `clock` on; the clocks used, or `None` where it stands for the rest of the tick.
    fn go(&mut self, clock: u32, out: &mut impl Train) -> Option<u32> {
        let holding = !matches!(self.state, State::Running);
        // an S law takes over where the tool is in the motion begun last, from standstill
        let smooth = self.window.ticks() > 0;
        let Memory { ahead, trail } = self.memory.borrow();
        let Current::Motion(active) = &mut self.current else { return None };
        if active.paced_at != self.overrides {
            active.repace(self.overrides, &self.crank);
        }
        let target = if holding { 0 } else { self.hands.cap(active.pace) };
        if self.speed == 0 {
            if target == 0 {
                self.await_spindle();
                return None;
            }
            self.speed = target.min(self.rest).max(1);
        } else if target == 0 && self.speed <= self.rest {
            self.speed = 0;
            return None;
        }
        // no advance leads past the end
        let left = active.motion.length.wrapping_sub(active.done);
        let steady = self.speed == target && clock == 0;
        let advance = if steady && active.cruise.holds(target, left) {
            Advance { length: u64::from(target), clocks: TICK_CLOCKS, speed: target, done: false }
        } else {
            let exit = if self.single.stops(ahead, self.line) {
                square(active.motion.stop)
            } else {
                trail.exit(ahead, &active.motion, smooth)
            };
            let budget = TICK_CLOCKS.wrapping_sub(clock);
            let advance = active.motion.advance(self.speed, left, exit, target, budget);
            if steady && advance.speed == target && !advance.done {
                active.cruise.learn(&active.motion, target, left);
            }
            advance
        };
        active.done = active.done.wrapping_add(advance.length);
        self.speed = advance.speed;
        let mut sink =
            Sink { shaper: &mut self.shaper, position: &mut self.position, superposed: &mut self.superposed, out };
        let stretch = Stretch { from: clock, clocks: advance.clocks };
        active.runner.advance(active.done, stretch, &mut sink);
        if advance.done {
            active.runner.finish(clock.wrapping_add(advance.clocks), &mut sink);
            let stops = self.single.stops(ahead, self.line) && self.speed <= active.motion.stop;
            let goes_on = trail.runs_on(smooth).unwrap_or_else(|| ahead.continues()) && !stops;
            self.current = Current::Nothing;
            if !goes_on {
                self.speed = 0;
            }
        }
        Some(advance.clocks)
    }
}
