//! Foreground: executes blocks at hardware priority, one tick at a time.
//!
//! It takes commands and blocks out of two single-producer queues and gives a tick of pulse train. It never waits:
//! what is not there at a tick's start is taken at the next.

pub mod alarm;
mod along;
pub mod answer;
mod closed_loop;
pub mod command;
pub mod contour;
pub mod debounce;
mod desk;
pub mod heartbeat;
mod homing;
pub mod inputs;
pub mod kept;
pub mod mode;
mod operate;
pub mod outputs;
pub mod panel;
mod power;
pub mod published;
pub mod refusal;
pub mod rehearsal;
mod requests;
pub mod settings;
pub mod shown;
mod threads;
pub mod train_queue;
mod wheels;

use interp_core::block::{Block, Feed, Output, Speed, Work};
use interp_core::channel::{self, Channel, Report, State};
use interp_core::compensation::pitch::PitchTable;
use interp_core::config::Machine;
use interp_core::train::Train;
use interp_core::units::{Axis, Lattice};

use crate::queue::Consumer;
use alarm::{Alarm, Faults};
pub use command::Command;
use desk::{Desk, Seen};
use inputs::{Inputs, PerAxis};
use outputs::Outputs;
use refusal::Refusal;
use rehearsal::Act;

/// Blocks that a lathe looks ahead. The same on every board and on the desktop, since the pulses depend on it.
pub const LOOKAHEAD: usize = 72;

/// A foreground's blocks, to come and gone.
pub type Memory = channel::Memory<LOOKAHEAD>;

/// Capacity of the queue of blocks: what the background may be ahead of the look-ahead.
pub const BLOCK_QUEUE: usize = 16;

/// Capacity of the queue of commands.
pub const COMMAND_QUEUE: usize = 8;

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
    /// The next tick has something to do on the operator's side: since the last one there was a reading or a request, or what
    /// either has begun still [acts](Desk::acts).
    attended: bool,
    /// What became of the last request that somebody [waits](answer) for.
    answer: u32,
    seen: Seen,
    channel: Channel<LOOKAHEAD, &'q mut Memory>,
    desk: Desk,
}

impl<'q> Foreground<'q> {
    /// A lathe that stands at `position` and takes from these queues. The position counts as known.
    /// The blocks that it knows stand in `memory`.
    // as a call it would pass over the stack once more
    #[inline(always)]
    pub fn new(
        machine: &Machine,
        position: Lattice,
        blocks: Consumer<'q, Block>,
        commands: Consumer<'q, Command>,
        memory: &'q mut Memory,
    ) -> Self {
        let channel = Channel::with_memory(machine, position, memory);
        let (outputs, faults) = (Outputs::REST, Faults::default());
        let (desk, seen) = (Desk::new(machine), Seen::NOWHERE);
        Self {
            blocks,
            commands,
            outputs,
            alarm: None,
            faults,
            open: false,
            attended: true,
            answer: answer::OBEYED,
            seen,
            channel,
            desk,
        }
    }

    /// Makes one tick of train.
    pub fn tick(&mut self, out: &mut impl Train) -> Report {
        while let Some(command) = self.commands.dequeue() {
            self.answer(command);
        }
        if self.alarm.is_some() {
            self.forget();
        }
        self.operate();
        let from = self.channel.position();
        let report = self.run(out);
        self.oversee(&report, from);
        if let Some(trouble) = self.channel.fault() {
            self.raise(Alarm::of_trouble(trouble));
        }
        let ends = matches!(report.state, State::Ended) && matches!(self.desk.mode, mode::Mode::Automatic);
        self.outputs.follow(report.output, ends, self.alarm, self.desk.motors);
        report
    }

    /// A tick of the channel: it takes blocks of the machine's own, else the program's.
    fn run(&mut self, out: &mut impl Train) -> Report {
        let (desk, blocks) = (&mut self.desk, &mut self.blocks);
        let mut source = || {
            let own = desk.own.next();
            own.or_else(|| if desk.takes_programs() { dried(blocks.dequeue(), desk.dry()) } else { None })
        };
        self.channel.tick(&mut source, out)
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

    /// Takes the readings of a tick, to be called before it. Counts of wheels that no tick has taken add up.
    pub fn read(&mut self, inputs: &Inputs) {
        // what lasts is seen by `Desk::acts`
        self.attended |= inputs.is_touched();
        let Inputs { wheels, contour, .. } = self.desk.inputs;
        self.desk.inputs = *inputs;
        let now = &mut self.desk.inputs;
        now.wheels.x = now.wheels.x.saturating_add(wheels.x);
        now.wheels.z = now.wheels.z.saturating_add(wheels.z);
        now.contour = now.contour.saturating_add(contour);
    }

    /// Raises an alarm. An earlier one stays, unless this one is an emergency stop.
    pub fn raise(&mut self, alarm: Alarm) {
        let emergency = matches!(alarm, Alarm::Emergency);
        if matches!(self.alarm, Some(Alarm::Emergency)) || self.alarm.is_some() && !emergency {
            return;
        }
        self.alarm = Some(alarm);
        self.attended = true;
        self.lose_place(alarm);
        if emergency {
            self.channel.abandon();
        } else {
            self.channel.reset();
        }
        self.stand_down();
        self.forget();
    }

    /// Forgets the blocks that wait.
    fn forget(&mut self) {
        while self.blocks.dequeue().is_some() {}
        self.desk.own.clear();
    }

    /// Does what an operator does: a request at once, a turn of the wheels in the tick to come.
    pub fn act(&mut self, act: Act) {
        match act {
            Act::Command(command) => self.obey(command),
            // the spindle is read in every tick, whoever attends
            Act::Spindle(_) => act.read(&mut self.desk.inputs),
            Act::Wheels(..) => {
                self.attended = true;
                act.read(&mut self.desk.inputs);
            }
        }
    }

    /// Obeys a command at once, or notes why it is [refused](Self::refused); the next tick is the first that shows it.
    pub fn obey(&mut self, command: Command) {
        if let Err(refusal) = self.request(command) {
            self.desk.refuse(refusal);
        }
    }

    /// Obeys a command of the queue, and notes what became of it.
    fn answer(&mut self, command: Command) {
        let unasked = answer::is_unasked(&command);
        let result = self.request(command);
        if !unasked {
            self.answer = result.map_or_else(answer::number, |()| answer::OBEYED);
        }
        if let Err(refusal) = result {
            self.desk.refuse(refusal);
        }
    }

    /// What became of the last request out of the queue that somebody waits for: not a hold, a start, a reset or a feed
    /// override. [`answer::refusal`] reads it.
    pub const fn answered(&self) -> u32 {
        self.answer
    }

    /// Obeys a command at once; the next tick is the first that shows it.
    ///
    /// # Errors
    /// Why it is refused: nothing has changed then.
    pub fn request(&mut self, command: Command) -> Result<(), Refusal> {
        self.attended = true;
        match mode::refusal(&command, &self.situation()) {
            Some(refusal) => Err(refusal),
            None => self.carry_out(command),
        }
    }

    /// What was refused and not asked for yet: the oldest of at most 8.
    pub fn refused(&mut self) -> Option<Refusal> {
        self.desk.take_refusal()
    }

    /// Clocks that pulses of a row stay high.
    #[inline]
    pub const fn pulse_width(&self) -> u32 {
        self.channel.pulse_width()
    }

    /// Whether the look-ahead has room for blocks that may still come: a sender that is late now delays the cycle.
    pub fn is_hungry(&self) -> bool {
        self.channel.is_hungry() && !self.blocks.ready()
    }

    /// What the lathe is doing.
    pub const fn state(&self) -> State {
        self.channel.state()
    }

    /// The mode.
    pub const fn mode(&self) -> mode::Mode {
        self.desk.mode
    }

    /// Why the machine is locked.
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

    /// Sets counts a turn of the spindle's encoder, 4 a line; `None` for no encoder. False, and nothing changes, while a
    /// cycle runs or where the number can't be one.
    pub fn set_encoder(&mut self, counts: Option<u32>) -> bool {
        self.channel.set_encoder(counts)
    }

    /// Pulses that the motor of an axis is due beyond the program since its position was made known.
    pub const fn compensation(&self, axis: Axis) -> i32 {
        self.channel.compensation(axis)
    }

    /// By how many pulses X is pulled out of a thread; [`position`](Self::position) has it.
    pub const fn retracted(&self) -> i32 {
        self.channel.retracted()
    }

    /// Where the last pulse planned leads: the program's place, and what the operator has added to it.
    pub const fn position(&self) -> Lattice {
        let at = self.desk.physical(self.channel.position(), self.channel.offset());
        Lattice { x: at.x.wrapping_add(self.channel.retracted()), z: at.z }
    }

    /// The same in the machine's own coordinates.
    const fn place(&self) -> Lattice {
        let (at, datum) = (self.position(), self.desk.datum);
        Lattice { x: at.x.wrapping_add(datum.x), z: at.z.wrapping_add(datum.z) }
    }

    /// [`position`](Self::position) at the end of the last tick, as that has found it.
    #[inline]
    pub const fn overseen(&self) -> Lattice {
        let (at, datum) = (self.seen.place, self.desk.datum);
        Lattice { x: at.x.wrapping_sub(datum.x), z: at.z.wrapping_sub(datum.z) }
    }

    /// Where the program is.
    pub const fn programmed(&self) -> Lattice {
        self.channel.position()
    }

    /// By how much the handwheels have led the tool off the program.
    pub const fn offset(&self) -> Lattice {
        self.channel.offset()
    }

    /// Whether no handwheel's axis moves, nor has to.
    pub const fn hands_rest(&self) -> bool {
        self.channel.hands_rest()
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

/// A block as it is run: dry, with another feed and without outputs of the spindle.
fn dried(block: Option<Block>, dry: Option<Speed>) -> Option<Block> {
    let (Some(mut block), Some(speed)) = (block, dry) else { return block };
    match &mut block.work {
        Work::Motion(motion) if !matches!(motion.feed, Feed::Rapid) => motion.feed = Feed::PerTick(speed),
        Work::Output(Output::SpindleForward | Output::SpindleReverse) => block.work = Work::Dwell(0),
        _ => {}
    }
    Some(block)
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
mod tests;
