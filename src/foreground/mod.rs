//! Foreground: executes blocks at hardware priority, one tick at a time.
//!
//! It takes commands and blocks out of two single-producer queues and gives a tick of pulse train. It never waits:
//! what is not there at a tick's start is taken at the next.

pub mod alarm;
pub mod heartbeat;
pub mod outputs;
pub mod published;
pub mod rehearsal;
pub mod train_queue;

use interp_core::block::Block;
use interp_core::channel::{Channel, Report, State};
use interp_core::compensation::pitch::PitchTable;
use interp_core::config::Machine;
use interp_core::train::Train;
use interp_core::units::{Axis, Lattice};

use crate::queue::Consumer;
use alarm::{Alarm, Faults};
use outputs::Outputs;

/// Blocks that a lathe looks ahead. The same on every board and on the desktop, since the pulses depend on it.
pub const LOOKAHEAD: usize = 64;

/// Capacity of the queue of blocks: what the background may be ahead of the look-ahead.
pub const BLOCK_QUEUE: usize = 16;

/// Capacity of the queue of commands.
pub const COMMAND_QUEUE: usize = 8;

/// What the background, a key or the link asks of the foreground.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Command {
    /// Cycle start; goes on after a hold or a programmed stop.
    Start,
    /// Feed hold.
    Hold,
    /// Brake, then forget all blocks, those in the queue included. The spindle stops at once.
    Reset,
    /// Leave an alarm: the operator has seen to it. Without effect while the tool moves or its cause lasts.
    Unlock,
    /// Feed override, percent, 0 to 200.
    FeedOverride(u16),
    /// Optional stops stop.
    OptionalStop(bool),
    /// Other figures of the machine. Without effect while a cycle runs: the background asks only when all is idle.
    Configure(Machine),
}

/// The foreground of one lathe.
#[repr(C)]
pub struct Foreground<'q> {
    blocks: Consumer<'q, Block>,
    commands: Consumer<'q, Command>,
    outputs: Outputs,
    alarm: Option<Alarm>,
    faults: Faults,
    /// The emergency input is open.
    open: bool,
    channel: Channel<LOOKAHEAD>,
}

impl<'q> Foreground<'q> {
    /// A lathe that stands at `position` and takes from these queues.
    pub fn new(
        machine: &Machine,
        position: Lattice,
        blocks: Consumer<'q, Block>,
        commands: Consumer<'q, Command>,
    ) -> Self {
        let channel = Channel::new(machine, position);
        let (outputs, faults) = (Outputs::REST, Faults::default());
        Self { channel, blocks, commands, outputs, alarm: None, faults, open: false }
    }

    /// Makes one tick of train.
    pub fn tick(&mut self, out: &mut impl Train) -> Report {
        while let Some(command) = self.commands.dequeue() {
            self.obey(command);
        }
        if self.alarm.is_some() {
            self.forget();
        }
        let blocks = &mut self.blocks;
        let report = self.channel.tick(&mut || blocks.dequeue(), out);
        self.outputs.follow(report.output, report.state, self.alarm);
        report
    }

    /// Looks at what the board has counted so far and whether the emergency input is, or has been, open; to be called
    /// before each tick. What is new is an alarm.
    pub fn watch(&mut self, faults: Faults, open: bool) {
        self.open = open;
        if let Some(alarm) = faults.alarm_since(self.faults) {
            self.raise(alarm);
        }
        self.faults = faults;
        if open {
            self.raise(Alarm::Emergency);
        }
    }

    /// Raises an alarm. An earlier one stays, unless this one is an emergency stop.
    pub fn raise(&mut self, alarm: Alarm) {
        let emergency = matches!(alarm, Alarm::Emergency);
        if matches!(self.alarm, Some(Alarm::Emergency)) || self.alarm.is_some() && !emergency {
            return;
        }
        self.alarm = Some(alarm);
        if emergency {
            self.channel.abandon();
        } else {
            self.channel.reset();
        }
        self.forget();
    }

    /// Forgets the blocks that wait.
    fn forget(&mut self) {
        while self.blocks.dequeue().is_some() {}
    }

    /// Obeys a command at once; the next tick is the first that shows it.
    pub fn obey(&mut self, command: Command) {
        match command {
            // a start with nothing to start and a hold of nothing are requests without effect, and harmless
            Command::Start if self.alarm.is_some() => {}
            Command::Start => drop(self.channel.start()),
            Command::Hold => drop(self.channel.hold()),
            Command::Reset => {
                self.channel.reset();
                self.forget();
                self.outputs.spindle = false;
            }
            Command::Unlock => {
                if !self.open && matches!(self.channel.state(), State::Idle | State::Ended) {
                    self.alarm = None;
                }
            }
            Command::FeedOverride(percent) => self.channel.set_feed_override(percent),
            Command::OptionalStop(on) => self.channel.set_optional_stop(on),
            Command::Configure(machine) => drop(self.channel.configure(&machine)),
        }
    }

    /// Clocks that pulses of a row stay high.
    #[inline]
    pub const fn pulse_width(&self) -> u32 {
        self.channel.pulse_width()
    }

    /// Whether the look-ahead has room for blocks that may still come: a sender that is late now delays the cycle.
    pub fn is_hungry(&self) -> bool {
        self.channel.is_hungry()
    }

    /// What the lathe is doing.
    pub const fn state(&self) -> State {
        self.channel.state()
    }

    /// Why the machine is locked. The position is unverified then.
    pub const fn alarm(&self) -> Option<Alarm> {
        self.alarm
    }

    /// What the board's outputs are to be now.
    pub const fn outputs(&self) -> Outputs {
        self.outputs
    }

    /// Puts a pitch error table in the place of an axis's last one. False, and nothing changes, while a cycle runs.
    pub fn set_pitch_table(&mut self, axis: Axis, table: &PitchTable) -> bool {
        self.channel.set_pitch_table(axis, table)
    }

    /// Sets the temperature of the screws, thousandths of a degree Celsius. While a cycle runs it acts slowly.
    pub fn set_temperature(&mut self, temperature: i32) {
        self.channel.set_temperature(temperature);
    }

    /// Pulses that the motor of an axis is due beyond the program since its position was made known.
    pub const fn compensation(&self, axis: Axis) -> i32 {
        self.channel.compensation(axis)
    }

    /// Where the last pulse planned leads.
    pub const fn position(&self) -> Lattice {
        self.channel.position()
    }

    /// Percent of the programmed feed.
    pub const fn feed_override(&self) -> u16 {
        self.channel.feed_override()
    }

    /// How often the look-ahead wanted a block and the queue was empty.
    pub const fn starved(&self) -> u32 {
        self.channel.starved()
    }
}

/// A state as a number, for a [snapshot](published::Published) and for logs.
pub const fn state_word(state: State) -> u32 {
    match state {
        State::Idle => 0,
        State::Filling => 1,
        State::Running => 2,
        State::Holding => 3,
        State::Resetting => 4,
        State::Stopped => 5,
        State::Ended => 6,
    }
}

/// The state of a number; idle for a number of none.
pub const fn word_state(word: u32) -> State {
    match word {
        1 => State::Filling,
        2 => State::Running,
        3 => State::Holding,
        4 => State::Resetting,
        5 => State::Stopped,
        6 => State::Ended,
        _ => State::Idle,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_starts_a_locked_machine_and_its_blocks_are_forgotten() {
        let machine = crate::background::parameters::Parameters::new().machine().unwrap();
        let (mut blocks, mut commands) = (crate::queue::Queue::<_, 2>::new(), crate::queue::Queue::<_, 2>::new());
        let ((mut block_in, block_out), (mut command_in, command_out)) = (blocks.split(), commands.split());
        let mut foreground = Foreground::new(&machine, Lattice::default(), block_out, command_out);
        foreground.raise(Alarm::Watchdog);
        let end = Block { line: 1, work: interp_core::block::Work::End };
        assert!(block_in.enqueue(end).is_ok() && command_in.enqueue(Command::Start).is_ok());
        let report = foreground.tick(&mut |_: interp_core::train::Event| {});
        assert_eq!((report.state, block_in.is_empty()), (State::Idle, true));
        foreground.obey(Command::Unlock);
        foreground.obey(Command::Start);
        assert_eq!((foreground.alarm(), foreground.state()), (None, State::Filling));
    }

    #[test]
    fn every_state_comes_back_from_its_number() {
        let states = [0, 1, 2, 3, 4, 5, 6].map(word_state);
        assert_eq!(states.map(state_word), [0, 1, 2, 3, 4, 5, 6]);
    }
}
