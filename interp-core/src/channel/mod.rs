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
mod run;
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

use crate::block::{Block, Speed};
use crate::compensation::Compensation;
use crate::config::Machine;
use crate::shaper::Shaper;
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
pub use memory::Memory;
pub use report::{Report, State};
use single::Single;
use superposed::Superposed;
use trail::maker::Maker;
use window::Window;

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

    /// Whether all is made that has to be added to the program where it stands.
    fn settled(&self) -> bool {
        let compensated = !self.compensation.is_on() || self.compensation.settled();
        !self.superposed.owes() && compensated && !self.crank.thread.is_busy()
    }
}
