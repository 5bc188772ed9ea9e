//! What a channel is doing, and what it tells of each tick.

use crate::block::{Output, Speed};
use crate::drive::Driven;

/// What the channel is doing.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum State {
    /// Nothing; waits for cycle start.
    Idle,
    /// Cycle start was given; the look-ahead fills. Also where a program that arrives bit by bit has run dry, for as
    /// long as more may be on its way; then the channel is idle.
    Filling,
    /// Executes blocks.
    Running,
    /// Feed hold: brakes or stands.
    Holding,
    /// Reset: brakes, then forgets all blocks and is idle.
    Resetting,
    /// A programmed stop: waits for cycle start.
    Stopped,
    /// The program is over.
    Ended,
}

/// What a tick did besides its events.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Report {
    /// What the channel is doing after the tick.
    pub state: State,
    /// The tick belongs to a cycle (counted in the train's hash).
    pub in_cycle: bool,
    /// An output that the program set at the end of this tick.
    pub output: Option<Output>,
    /// Line of the block being executed, 0 for none.
    pub line: u32,
    /// Speed along the path at the tick's end.
    pub speed: Speed,
    /// What a drive other than time did.
    pub driven: Driven,
}

impl Report {
    /// Of a channel that does nothing.
    pub const IDLE: Self =
        Self { state: State::Idle, in_cycle: false, output: None, line: 0, speed: 0, driven: Driven::NONE };
}
