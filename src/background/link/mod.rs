//! The link: program lines and commands over a serial port, with the flow of Grbl 1.1.
//!
//! # Flow
//! Each line, ended by a carriage return or a line feed, is answered once and in order: `ok` when its blocks are in the
//! queue (not when they are executed), or `error:N` when nothing of it counts. A message, `[MSG:...]`, comes before
//! `error:N` and names place and cause; it also comes before an `ok` with a warning. A line whose blocks do not fit
//! waits. Real-time bytes ([`realtime`]) act at once, whatever waits, and are not answered.
//!
//! # Commands
//! - `? ! ~` and 0x18: status, feed hold, cycle start, soft reset. 0x90 to 0x94: feed override, 10 to 200 %.
//! - `$`, `$$`, `$G`, `$I`, `$X`: help, parameters, what is modal, version, unlock.
//! - `$name=value` sets a parameter; also `$100 $102 $110 $112 $120 $122`, as Grbl numbers them. `$format=nc1973` and
//!   `$format=gcode` choose how programs are read. Only while idle.
//! - `$mode=handwheel` and the like are the operator's requests.
//! - Anything else is a line of a program. M2, M30 or a closing `%` ends the program; the next begins where the tool is.
//!
//! # Cycles
//! Blocks that wait for an idle channel start it, unless the operator holds; so a program begins by itself and goes on
//! by itself after a pause of its sender. A reset brakes, then forgets all blocks, all lines and all that is modal;
//! programs go on from where the tool then is. Lines that arrive meanwhile wait, and are read after the banner.
//!
//! # Corners
//! Where corners are blended, the compiler holds one feed back until the next line; its line is answered at once. Where no
//! byte comes for 25 ticks and the foreground has taken all blocks, the feed goes out, and the corner stays sharp.
//! Until then the lathe counts as busy.
//!
//! # Alarms
//! The foreground latches them and forgets its blocks. The link tells `ALARM:N` once and refuses program lines until `$X`,
//! as Grbl does; a reset forgets all but the alarm.
//!
//! # Invariants
//! - Answers are one for each terminator, but those that a reset makes pointless.
//! - Nothing of a refused line moves or stays in force.
//! - Blocks are queued only for a foreground that will execute them: none between a reset and the standstill.
//! - "Idle" is believed only of a snapshot taken after all commands were obeyed (`Settling`).
//!
//! # Left out
//! Jogging, probing, offsets of G-code, check mode.

#![cfg_attr(not(test), deny(clippy::arithmetic_side_effects))]

mod alarm;
mod commands;
mod outbox;
mod program;
mod receiver;
mod refusal;
mod reply;
mod requests;
mod status;
#[cfg(test)]
mod tests;

use core::fmt::Write;

use feature_editor::codes::{Format, MAX_LINE};
use heapless::{Deque, Vec};
use interp_core::block::Block;
use interp_core::channel::State;
use interp_core::config::Machine;

use super::compile::Compiler;
use super::parameters::Parameters;
use crate::foreground::Command;
use crate::foreground::alarm::Alarm;
use crate::queue::Producer;
use outbox::{Flow, Outbox, Settling};
use program::Accessories;
use receiver::{Received, Receiver};
use refusal::Refusal;
use requests::Asked;
use status::{Known, Rounds};

pub use receiver::RECEIVE_BUFFER;
pub use status::Snapshot;

/// Blocks that a line makes at most: a held feed in two parts, speed, spindle, tool, dwell, a motion in two parts, the
/// stand of an exact stop, stop or end.
const BLOCKS_PER_LINE: usize = 10;

/// Calls of [`Link::work`] without anything to do (one a tick, where no byte comes) after which a feed that is held back
/// for the corner at its end goes out, if no byte came and the queue of blocks is empty. Half of what a channel waits
/// before it begins with what it has, so that it has all.
const HOLD_PATIENCE: u8 = 25;

/// Least and largest feed override that the link sets, percent.
const OVERRIDES: (u16, u16) = (10, 200);

/// A byte that acts at once.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Realtime {
    /// `?`: status report.
    Status,
    /// `!`: feed hold.
    Hold,
    /// `~`: cycle start.
    Start,
    /// 0x18: soft reset.
    Reset,
    /// 0x90: 100 %.
    FeedOverride100,
    /// 0x91.
    FeedOverridePlus10,
    /// 0x92.
    FeedOverrideMinus10,
    /// 0x93.
    FeedOverridePlus1,
    /// 0x94.
    FeedOverrideMinus1,
}

/// What a byte asks for at once; `None` of a byte that belongs to a line. Any context may call it.
///
/// ```
/// # use handcnc::background::link::{Realtime, realtime};
/// assert_eq!(realtime(b'!'), Some(Realtime::Hold));
/// assert_eq!(realtime(b'G'), None);
/// ```
pub const fn realtime(byte: u8) -> Option<Realtime> {
    Some(match byte {
        b'?' => Realtime::Status,
        b'!' => Realtime::Hold,
        b'~' => Realtime::Start,
        0x18 => Realtime::Reset,
        0x90 => Realtime::FeedOverride100,
        0x91 => Realtime::FeedOverridePlus10,
        0x92 => Realtime::FeedOverrideMinus10,
        0x93 => Realtime::FeedOverridePlus1,
        0x94 => Realtime::FeedOverrideMinus1,
        _ => return None,
    })
}

/// One lathe's link. It is fed with bytes and with snapshots of the foreground, and writes replies and queues.
#[derive(Clone, Debug)]
pub struct Link {
    parameters: Parameters,
    machine: Machine,
    format: Format,
    compiler: Compiler,
    /// The program has made blocks.
    begun: bool,
    accessories: Accessories,
    receiver: Receiver,
    line: Vec<u8, MAX_LINE>,
    /// Blocks of the last line that are not yet in the queue.
    pending: Deque<Block, BLOCKS_PER_LINE>,
    /// The last line gets its `ok` when `pending` is empty.
    owes_ok: bool,
    /// Calls without anything to do while a feed was held back.
    waited: u8,
    /// The parameter that `$$` lists next.
    listing: Option<usize>,
    outbox: Outbox,
    settling: Settling,
    resetting: bool,
    /// The alarm that was told last and still locks.
    alarm: Option<Alarm>,
    /// `$X` waits for its answer.
    unlocking: bool,
    /// A request waits for its answer.
    asked: Option<Asked>,
    /// The operator holds: nothing is started.
    held: bool,
    /// The position is one that no program can start from, so none does.
    lost: bool,
    /// Blocks were queued since the foreground was last seen idle.
    busy: bool,
    /// Override that was asked for and does not show yet.
    percent: Option<u16>,
    /// Room in the queue of blocks when it was last seen.
    room: usize,
    rounds: Rounds,
    /// Replies that the writer refused.
    unsent: u32,
}

impl Link {
    /// A link of a lathe that stands at the parameters' `start`. `machine` is what the parameters make.
    pub fn new(parameters: Parameters, machine: Machine) -> Self {
        let format = Format::Gcode;
        let percent = Some(parameters.feed_override());
        let optional_stop = Some(parameters.optional_stop());
        Self {
            compiler: Compiler::new(parameters.settings(), format, &machine),
            parameters,
            machine,
            format,
            begun: false,
            accessories: Accessories::default(),
            receiver: Receiver::new(),
            line: Vec::new(),
            pending: Deque::new(),
            owes_ok: false,
            waited: 0,
            listing: None,
            outbox: Outbox { percent, optional_stop, ..Outbox::default() },
            settling: Settling::Sent,
            resetting: false,
            alarm: None,
            unlocking: false,
            asked: None,
            held: false,
            lost: false,
            busy: false,
            percent,
            room: 0,
            rounds: Rounds::new(),
            unsent: 0,
        }
    }

    /// Greets: at power-on and when a sender connects. After a reset the link does it by itself.
    pub fn banner(&mut self, out: &mut impl Write) {
        self.rounds = Rounds::new();
        self.write(out, |out| out.write_str("\r\nGrbl 1.1h ['$' for help]\r\n"));
        if self.alarm.is_some() {
            self.message(out, format_args!("'$X' to unlock"));
        }
    }

    /// Takes a byte that is not a real-time one. Bytes must come in the order of the wire; those that came before a
    /// reset must be given before it, or they count as sent after it.
    pub fn receive(&mut self, byte: u8) {
        self.waited = 0;
        self.receiver.receive(byte);
    }

    /// Notes that bytes of the line now arriving were lost or garbled (a break, a framing, parity or overrun flag): it
    /// will be refused.
    pub fn damaged(&mut self) {
        self.receiver.damage();
    }

    /// Notes that the sender is gone: the line now arriving is forgotten, whole ones are executed.
    pub fn disconnected(&mut self) {
        self.receiver.forget_arriving();
    }

    /// Bytes that were lost because the receive buffer was full, ever.
    pub const fn overflow(&self) -> u32 {
        self.receiver.overflow()
    }

    /// Replies that the writer did not take, ever.
    pub const fn unsent(&self) -> u32 {
        self.unsent
    }

    /// Obeys a real-time byte. What finds the queue of commands full is sent by [`work`](Self::work).
    pub fn realtime(
        &mut self,
        what: Realtime,
        commands: &mut Producer<'_, Command>,
        snapshot: &Snapshot,
        out: &mut impl Write,
    ) {
        let percent = self.percent.unwrap_or(snapshot.feed_override);
        match what {
            Realtime::Status => return self.report(snapshot, out),
            Realtime::Hold | Realtime::Start if snapshot.alarm.is_some() => return,
            Realtime::Hold => {
                self.held = true;
                self.outbox.flow = Some(Flow::Hold);
            }
            Realtime::Start => {
                self.held = false;
                // an idle channel is started by its blocks, and a resetting one not at all
                if !self.resetting && !self.is_still(snapshot) {
                    self.outbox.flow = Some(Flow::Start);
                }
            }
            Realtime::Reset => self.reset(),
            Realtime::FeedOverride100 => self.scale_feed(100),
            Realtime::FeedOverridePlus10 => self.scale_feed(percent.saturating_add(10)),
            Realtime::FeedOverrideMinus10 => self.scale_feed(percent.saturating_sub(10)),
            Realtime::FeedOverridePlus1 => self.scale_feed(percent.saturating_add(1)),
            Realtime::FeedOverrideMinus1 => self.scale_feed(percent.saturating_sub(1)),
        }
        self.send(commands);
    }

    /// Does one thing that is due: sends a command, queues a block, answers a line. True if it did one.
    ///
    /// Call it until it is false, then again after a tick or a byte, each time with a fresh snapshot.
    pub fn work(
        &mut self,
        blocks: &mut Producer<'_, Block>,
        commands: &mut Producer<'_, Command>,
        snapshot: &Snapshot,
        out: &mut impl Write,
    ) -> bool {
        self.settle(commands, snapshot);
        if snapshot.alarm != self.alarm {
            self.tell_alarm(snapshot, out);
        }
        self.room = blocks.capacity().saturating_sub(blocks.len());
        let still = self.is_still(snapshot);
        if self.resetting {
            let over = still && blocks.is_empty();
            if over {
                self.begin_anew(snapshot, out);
            }
            return over;
        }
        if self.unlocking {
            return self.unlocked(snapshot, out);
        }
        if let Some(asked) = self.asked {
            return self.answered(asked, blocks.is_empty(), snapshot, out);
        }
        if still && !self.held && !blocks.is_empty() {
            self.outbox.flow = Some(Flow::Start);
            self.send(commands);
            return true;
        }
        if self.owes_ok || !self.pending.is_empty() {
            return self.queue(blocks, out);
        }
        let idle = still && blocks.is_empty() && !self.compiler.holds();
        self.busy &= !idle;
        if idle && snapshot.state == State::Ended {
            // the end of a program stops the spindle
            self.accessories.spindle = None;
        }
        if let Some(at) = self.listing {
            self.list(at, out);
            return true;
        }
        let Some(received) = self.receiver.take(&mut self.line) else { return self.wait(blocks) };
        self.waited = 0;
        let result = match received {
            Received::Line => self.obey(idle, blocks.is_empty(), snapshot, out),
            Received::Nothing => {
                self.owes_ok = true;
                Ok(())
            }
            Received::TooLong => Err(Refusal::TooLong),
            Received::Damaged => Err(Refusal::Damaged),
            Received::Lost => Err(Refusal::Overflow(self.receiver.overflow())),
        };
        match result {
            Ok(()) => drop(self.owes_ok && self.queue(blocks, out)),
            Err(refusal) => self.refuse(&refusal, out),
        }
        true
    }

    /// Nothing is due. True if it was so for long enough that a feed goes out which was held back.
    fn wait(&mut self, blocks: &Producer<'_, Block>) -> bool {
        if !self.compiler.holds() || !blocks.is_empty() {
            return false;
        }
        self.waited = self.waited.saturating_add(1);
        let over = self.waited >= HOLD_PATIENCE;
        if over {
            self.waited = 0;
            self.let_go();
        }
        over
    }

    /// Brings [`Settling`] up to date.
    fn settle(&mut self, commands: &mut Producer<'_, Command>, snapshot: &Snapshot) {
        self.send(commands);
        self.settling = match self.settling {
            Settling::Sent if commands.is_empty() => Settling::Taken,
            Settling::Sent => Settling::Sent,
            Settling::Taken | Settling::Settled => Settling::Settled,
        };
        if self.settling == Settling::Settled {
            self.percent = None;
            // somebody else has started what was held
            self.held &= !matches!(snapshot.state, State::Filling | State::Running);
        }
    }

    fn send(&mut self, commands: &mut Producer<'_, Command>) {
        if self.outbox.send(commands) {
            self.settling = Settling::Sent;
        }
    }

    /// Whether the channel executes nothing and was not asked to.
    fn is_still(&self, snapshot: &Snapshot) -> bool {
        self.settling == Settling::Settled && matches!(snapshot.state, State::Idle | State::Ended)
    }

    /// Puts blocks of the last line into the queue, and answers it when they all are. False where none fitted.
    fn queue(&mut self, blocks: &mut Producer<'_, Block>, out: &mut impl Write) -> bool {
        let mut any = false;
        while blocks.ready()
            && let Some(block) = self.pending.pop_front()
        {
            // cannot fail: it is ready
            let _ = blocks.enqueue(block);
            any = true;
        }
        self.busy |= any;
        if self.owes_ok && self.pending.is_empty() {
            self.owes_ok = false;
            self.say(out, format_args!("ok"));
            any = true;
        }
        any
    }

    /// Obeys the line just taken. Where it has to be answered later, `owes_ok` is set.
    fn obey(&mut self, idle: bool, empty: bool, snapshot: &Snapshot, out: &mut impl Write) -> Result<(), Refusal> {
        let line = core::mem::take(&mut self.line);
        let text = line.trim_ascii();
        let result = match (text.strip_prefix(b"$"), self.alarm) {
            (Some(command), _) => match self.request(command, empty, snapshot) {
                Some(result) => result,
                None => self.command(command, idle && !self.held, snapshot, out),
            },
            (None, Some(alarm)) if !text.is_empty() => Err(Refusal::Locked(alarm)),
            (None, None) if !text.is_empty() && !requests::takes_programs(snapshot) => {
                Err(Refusal::Mode(snapshot.mode))
            }
            (None, _) => self.follow(idle, snapshot).and_then(|()| self.program(&line, out)),
        };
        self.line = line;
        result
    }

    /// Asks for a reset, and forgets all that waits.
    fn reset(&mut self) {
        self.receiver.clear();
        self.pending.clear();
        self.compiler.forget();
        self.owes_ok = false;
        self.listing = None;
        self.unlocking = false;
        self.asked = None;
        self.outbox.unlock = false;
        self.outbox.request = None;
        self.outbox.confirm = false;
        self.held = false;
        self.resetting = true;
        self.outbox.flow = None;
        self.outbox.reset = true;
        // no snapshot before the answer to it counts, be the queue full or not
        self.settling = Settling::Sent;
    }

    /// The reset is over: all is as after power-on, but for the position.
    fn begin_anew(&mut self, snapshot: &Snapshot, out: &mut impl Write) {
        self.resetting = false;
        self.start_over(snapshot);
        self.ask_percent(self.parameters.feed_override());
        self.banner(out);
    }

    /// Forgets what is modal; programs begin where the tool is.
    fn start_over(&mut self, snapshot: &Snapshot) {
        self.busy = false;
        self.begun = false;
        self.accessories = Accessories::default();
        let at = self.present(&self.machine, snapshot);
        self.lost = at.is_none();
        self.compiler = self.fresh(at.unwrap_or_default());
    }

    fn scale_feed(&mut self, percent: u16) {
        let (least, most) = OVERRIDES;
        self.ask_percent(percent.clamp(least, most));
    }

    fn ask_percent(&mut self, percent: u16) {
        self.outbox.percent = Some(percent);
        self.percent = Some(percent);
        self.rounds.show_overrides();
    }

    fn report(&mut self, snapshot: &Snapshot, out: &mut impl Write) {
        let spindle = self.accessories.letters();
        let known = Known {
            held: self.held,
            busy: self.busy,
            blocks: self.room,
            bytes: self.receiver.room(),
            milli_rpm: if spindle.is_empty() { 0 } else { self.accessories.milli_rpm },
            accessories: spindle,
        };
        let (mut rounds, machine) = (self.rounds, self.machine);
        self.write(out, |out| rounds.report(&machine, snapshot, &known, out));
        self.rounds = rounds;
    }

    fn refuse(&mut self, refusal: &Refusal, out: &mut impl Write) {
        self.message(out, format_args!("{refusal}"));
        self.say(out, format_args!("error:{}", refusal.number()));
    }

    fn say(&mut self, out: &mut impl Write, text: core::fmt::Arguments<'_>) {
        self.write(out, |out| reply::line(out, text));
    }

    fn message(&mut self, out: &mut impl Write, text: core::fmt::Arguments<'_>) {
        self.write(out, |out| reply::message(out, text));
    }

    fn write<W: Write>(&mut self, out: &mut W, write: impl FnOnce(&mut W) -> core::fmt::Result) {
        if write(out).is_err() {
            self.unsent = self.unsent.saturating_add(1);
        }
    }
}
