//! The status report: `<Idle|MPos:1.000,0.000,2.000|Bf:16,512|FS:0,0>`, after Grbl 1.1.
//!
//! State and position are in every report, the offset (always zero: programs have none) and the overrides now and
//! then, as senders expect. X is a radius; Y is there because senders want three axes.

use core::fmt::{self, Write};

use interp_core::block::Speed;
use interp_core::channel::{Report, State};
use interp_core::config::Machine;
use interp_core::units::Lattice;

use crate::foreground::alarm::Alarm;
use crate::foreground::mode::Mode;
use crate::foreground::{self, Foreground};

use super::reply::{micrometres, scaled};

/// What the foreground shows of itself. It is taken after a tick of the foreground and before the link is called.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Snapshot {
    /// What the channel is doing.
    pub state: State,
    /// Where the last pulse planned leads.
    pub position: Lattice,
    /// Speed along the path.
    pub speed: Speed,
    /// Line of the block being executed, 0 for none.
    pub line: u32,
    /// Feed override, percent.
    pub feed_override: u16,
    /// How often the pulse train was found empty.
    pub underruns: u32,
    /// Why the machine is locked.
    pub alarm: Option<Alarm>,
    /// Where the program's last pulse planned leads: without what handwheels and wear add.
    pub programmed: Lattice,
    /// The mode.
    pub mode: Mode,
    /// Why the last request was refused; `None` where it was obeyed.
    pub answer: Option<foreground::refusal::Refusal>,
}

impl Snapshot {
    /// A lathe that stands idle in automatic.
    pub const fn at(position: Lattice) -> Self {
        Self {
            state: State::Idle,
            position,
            speed: 0,
            line: 0,
            feed_override: 100,
            underruns: 0,
            alarm: None,
            programmed: position,
            mode: Mode::Automatic,
            answer: None,
        }
    }

    /// What a tick has made, by a foreground whose train nothing has found empty.
    pub fn of(report: &Report, foreground: &Foreground<'_>) -> Self {
        Self {
            state: report.state,
            position: foreground.position(),
            speed: report.speed,
            line: report.line,
            feed_override: foreground.feed_override(),
            underruns: 0,
            alarm: foreground.alarm(),
            programmed: foreground.programmed(),
            mode: foreground.mode(),
            answer: foreground::answer::refusal(foreground.answered()),
        }
    }
}

/// Reports between two that show the offset, idle and busy, and between two that show the overrides.
const OFFSET_EVERY: (u8, u8) = (10, 30);
const OVERRIDES_EVERY: (u8, u8) = (10, 20);

/// Which of the fields that are only shown now and then are due.
#[derive(Copy, Clone, Debug)]
pub(super) struct Rounds {
    offset: u8,
    overrides: u8,
}

/// What the link knows and the snapshot does not.
#[derive(Copy, Clone, Debug)]
pub(super) struct Known {
    /// The operator holds what has not started.
    pub(super) held: bool,
    /// Blocks were queued that the foreground has not been seen to be done with.
    pub(super) busy: bool,
    /// Blocks that the queue has room for.
    pub(super) blocks: usize,
    /// Bytes that the receive buffer has room for.
    pub(super) bytes: usize,
    /// Programmed spindle speed, thousandths of a turn a minute.
    pub(super) milli_rpm: u32,
    /// Accessories that are on, in letters.
    pub(super) accessories: &'static str,
}

/// The state's name.
const fn name(snapshot: &Snapshot, known: &Known) -> &'static str {
    match snapshot.state {
        State::Idle | State::Ended if known.held => "Hold:0",
        State::Idle | State::Ended if !known.busy => "Idle",
        State::Idle | State::Ended | State::Filling | State::Running => "Run",
        State::Holding if snapshot.speed == 0 => "Hold:0",
        State::Stopped => "Hold:0",
        State::Holding | State::Resetting => "Hold:1",
    }
}

impl Rounds {
    /// As after power-on: the first report shows the offset, the second the overrides.
    pub(super) const fn new() -> Self {
        Self { offset: 0, overrides: 1 }
    }

    /// The next report shows the overrides, unless it shows the offset.
    pub(super) const fn show_overrides(&mut self) {
        self.overrides = 0;
    }

    /// Writes a report.
    pub(super) fn report(
        &mut self,
        machine: &Machine,
        snapshot: &Snapshot,
        known: &Known,
        out: &mut impl Write,
    ) -> fmt::Result {
        let name = name(snapshot, known);
        let x = micrometres(machine.x.pulse, snapshot.position.x);
        let z = micrometres(machine.z.pulse, snapshot.position.z);
        // nm a tick with 12 fraction bits to mm/min: * 60000 / 4096 / 1e6
        let feed = scaled(snapshot.speed.into(), 60, 4_096_000);
        match snapshot.alarm {
            Some(alarm) => write!(out, "<Alarm:{}", alarm.number())?,
            None => write!(out, "<{name}")?,
        }
        write!(out, "|MPos:{x},0.000,{z}|Bf:{},{}", known.blocks, known.bytes)?;
        if snapshot.line > 0 {
            write!(out, "|Ln:{}", snapshot.line)?;
        }
        if !matches!(snapshot.mode, Mode::Automatic) {
            write!(out, "|Mode:{}", snapshot.mode.name())?;
        }
        write!(out, "|FS:{feed},{}", scaled(known.milli_rpm.into(), 1, 1_000))?;
        if snapshot.underruns > 0 {
            write!(out, "|Un:{}", snapshot.underruns)?;
        }
        let idle = name == "Idle";
        let every = |(when_idle, when_busy): (u8, u8)| if idle { when_idle } else { when_busy };
        if let Some(left) = self.offset.checked_sub(1) {
            self.offset = left;
        } else {
            self.offset = every(OFFSET_EVERY).saturating_sub(1);
            self.overrides = self.overrides.max(1);
            out.write_str("|WCO:0.000,0.000,0.000")?;
        }
        if let Some(left) = self.overrides.checked_sub(1) {
            self.overrides = left;
        } else {
            self.overrides = every(OVERRIDES_EVERY).saturating_sub(1);
            write!(out, "|Ov:{},100,100", snapshot.feed_override)?;
            if !known.accessories.is_empty() {
                write!(out, "|A:{}", known.accessories)?;
            }
        }
        out.write_str(">\r\n")
    }
}
