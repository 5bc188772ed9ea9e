//! The chip's train against the desktop's: what QEMU logs, event by event, as both come.

use std::fmt::Write as _;
use std::io::BufRead;
use std::sync::mpsc::Receiver;

use handcnc::foreground::state_word;
use interp_core::channel::State;
use interp_core::config::TICK_CLOCKS;
use interp_core::train::{Event, Hash, Levels};
use interp_core::units::Axis;

/// What the chip played, equal to the desktop's train.
#[derive(Debug)]
pub(crate) struct Played {
    /// Events of the cycle.
    pub(crate) events: u64,
    /// Hash up to the last tick that moves.
    pub(crate) hash: u64,
    /// Events and ticks before the cycle.
    pub(crate) events_before: u64,
    pub(crate) ticks_before: u64,
    /// Of each tick of the cycle.
    pub(crate) ticks: Vec<TickCount>,
}

/// What a tick had of each.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct TickCount {
    /// Events.
    pub(crate) events: usize,
    /// Events with a rising edge.
    pub(crate) rising: usize,
    /// Events that a handler played; the others are falls that the hardware makes.
    pub(crate) handled: usize,
}

/// Why a comparison failed.
#[derive(Debug)]
pub(crate) enum Fault {
    /// The chip's train differs.
    Differs(String),
    /// The log ended; the sender may know why.
    Silent(String),
}

impl Fault {
    /// What to say.
    pub(crate) fn text(&self) -> &str {
        match self {
            Self::Differs(text) | Self::Silent(text) => text,
        }
    }
}

const PORT: &str = "GPIOE: unimplemented device write (size 4, offset 0x014, value 0x";
const INTERVAL: &str = "GPIOF: unimplemented device write (size 4, offset 0x014, value 0x";
/// TIM1 makes the falls of pulses: its width less one clock, and its start.
const WIDTH: &str = "timer[1]: unimplemented device write (size 4, offset 0x02c, value 0x";
const START: &str = "timer[1]: unimplemented device write (size 4, offset 0x000, value 0x";
/// One pulse, enabled (RM0090 17.4.1).
const ONCE: u32 = 1 << 3 | 1;
/// DMA2's stream 5 makes of TIM1's update a write of the step port's BSRR (RM0090 10.5.5 to 10.5.9): channel 6, highest
/// priority, words, circular, from memory, on; one item; GPIOE's BSRR.
const STREAM: &str = "DMA2: unimplemented device write (size 4, offset 0x";
const STREAM_SET: [(u32, u32); 3] =
    [(0x88, 6 << 25 | 3 << 16 | 2 << 13 | 2 << 11 | 1 << 8 | 1 << 6 | 1), (0x8C, 1), (0x90, 0x4002_1018)];
/// The interval of a pulse that TIM1 ends.
const FALLS: u32 = 1 << 15;
const STATE: &str = "timer[1]: unimplemented device write (size 4, offset 0x034, value 0x";
const FAULTS: &str = "timer[1]: unimplemented device write (size 4, offset 0x038, value 0x";

/// What the image did.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) enum Logged {
    /// A handler played an event.
    Played(Event),
    /// The hardware did: the fall of a pulse.
    Fell(Event),
    /// The channel's state changed, in the tick behind the one being played.
    State(u32),
    /// It counts faults: underruns in the upper half, lost events in the lower.
    Fault(u32),
}

/// QEMU's log, read as it comes.
pub(crate) struct Log<R> {
    lines: R,
    line: String,
    port: Option<u32>,
    /// Width of pulses.
    width: u32,
    /// Which registers of the stream were set as they must be.
    stream: [bool; 3],
    /// The fall of the pulse that was begun, until TIM1 is started for it.
    fall: Option<Event>,
    /// What else QEMU and the image said.
    said: String,
}

impl<R: BufRead> Log<R> {
    /// A log that begins with these lines.
    pub(crate) const fn new(lines: R) -> Self {
        Self { lines, line: String::new(), port: None, width: 0, stream: [false; 3], fall: None, said: String::new() }
    }

    /// The next that the image did.
    pub(crate) fn next(&mut self) -> Result<Logged, Fault> {
        loop {
            self.line.clear();
            match self.lines.read_line(&mut self.line) {
                Ok(0) | Err(_) => {
                    let colon = if self.said.is_empty() { "" } else { ": " };
                    return Err(Fault::Silent(format!("the emulator ended{colon}{}", self.said.trim())));
                }
                Ok(_) => {}
            }
            let value = |rest: &str| u32::from_str_radix(rest.trim_end().strip_suffix(')')?, 16).ok();
            let after = |start: &str| self.line.strip_prefix(start).and_then(value);
            if let Some(levels) = after(PORT) {
                if self.fall.is_some() {
                    return Err(Fault::Differs("a pulse that nothing ends".into()));
                }
                if self.port.replace(levels).is_some() {
                    return Err(Fault::Differs("two writes of the port without an interval between".into()));
                }
            } else if let Some(interval) = after(INTERVAL) {
                let Some(levels) = self.port.take() else {
                    return Err(Fault::Differs("an interval without a write of the port".into()));
                };
                let falls = interval & FALLS != 0;
                let clocks = interval & !FALLS;
                let rest = clocks.checked_sub(self.width).filter(|rest| *rest > 0);
                let (Ok(levels), true) = (u16::try_from(levels), clocks <= TICK_CLOCKS && (!falls || rest.is_some()))
                else {
                    return Err(Fault::Differs(format!("levels {levels:x} for {interval} clocks are no event")));
                };
                let low = Levels::from_bits(levels & !STEPS);
                self.fall = rest.filter(|_| falls).map(|rest| Event::new(low, rest));
                let clocks = if falls { self.width } else { clocks };
                return Ok(Logged::Played(Event::new(Levels::from_bits(levels), clocks)));
            } else if let Some(word) = after(START) {
                let Some(fall) = self.fall.take().filter(|_| word == ONCE) else {
                    return Err(Fault::Differs(format!("the timer of falls is started by {word:x} for no pulse")));
                };
                if self.stream != [true; 3] {
                    return Err(Fault::Differs("a pulse falls before its DMA is set up".into()));
                }
                return Ok(Logged::Fell(fall));
            } else if let Some(rest) = self.line.strip_prefix(STREAM) {
                let written = rest
                    .split_once(", value 0x")
                    .and_then(|(at, word)| Some((u32::from_str_radix(at, 16).ok()?, value(word)?)));
                for (set, (at, wanted)) in self.stream.iter_mut().zip(STREAM_SET) {
                    *set = written.map_or(*set, |(offset, word)| if offset == at { word == wanted } else { *set });
                }
            } else if let Some(clocks) = after(WIDTH) {
                self.width = clocks.saturating_add(1);
            } else if let Some(word) = after(STATE) {
                return Ok(Logged::State(word));
            } else if let Some(word) = after(FAULTS) {
                return Ok(Logged::Fault(word));
            } else if !self.line.contains("unimplemented device") {
                self.said.push_str(&self.line);
            }
        }
    }
}

/// Step pins of all lathes.
const STEPS: u16 = 0x5555;

/// Compares what the chip did with the expected train, to its end; `expected` gives the events of each tick.
pub(crate) fn compare(
    next: &mut impl FnMut() -> Result<Logged, Fault>,
    expected: &Receiver<Vec<Event>>,
) -> Result<Played, Fault> {
    let mut comparison = Comparison::new(expected);
    while !comparison.done {
        match next() {
            Ok(Logged::Played(event)) => {
                comparison.played(event)?;
                comparison.handled();
            }
            Ok(Logged::Fell(event)) => comparison.played(event)?,
            Ok(Logged::State(word)) => comparison.state(word),
            Ok(Logged::Fault(word)) => {
                let (underruns, lost) = (word >> 16, word & 0xFFFF);
                return Err(Fault::Differs(format!("the image counts faults: underruns {underruns}, lost {lost}")));
            }
            Err(Fault::Silent(text)) => {
                return Err(Fault::Silent(format!("after {} events of the cycle {text}", comparison.events)));
            }
            Err(fault) => return Err(fault),
        }
    }
    Ok(Played {
        events: comparison.events,
        hash: comparison.moved,
        events_before: comparison.events_before,
        ticks_before: comparison.first.unwrap_or(0),
        ticks: comparison.counts,
    })
}

/// Where a comparison has got to.
struct Comparison<'e> {
    expected: &'e Receiver<Vec<Event>>,
    /// Events of the expected tick, and the next of them.
    tick: Vec<Event>,
    next: usize,
    /// Clocks of the chip's present tick, and how many ticks have begun.
    clocks: u32,
    ticks: u64,
    /// The tick that the cycle begins with.
    first: Option<u64>,
    before: Levels,
    events: u64,
    events_before: u64,
    /// Events, and those with a rising edge, of each tick of the cycle.
    counts: Vec<TickCount>,
    hash: Hash,
    moved: u64,
    done: bool,
}

impl<'e> Comparison<'e> {
    fn new(expected: &'e Receiver<Vec<Event>>) -> Self {
        let hash = Hash::new();
        Self {
            expected,
            tick: Vec::new(),
            next: 0,
            clocks: 0,
            ticks: 0,
            first: None,
            before: Levels::LOW,
            events: 0,
            events_before: 0,
            counts: Vec::new(),
            hash,
            moved: hash.value(),
            done: false,
        }
    }

    /// The channel's state changed in the tick behind the one being played. A cycle's ticks begin right after.
    fn state(&mut self, word: u32) {
        if word == state_word(State::Running) && self.first.is_none() {
            self.first = Some(self.ticks.saturating_add(1));
        }
    }

    /// The chip played an event.
    fn played(&mut self, found: Event) -> Result<(), Fault> {
        if self.clocks == 0 {
            self.ticks = self.ticks.saturating_add(1);
        }
        self.clocks = self.clocks.saturating_add(found.interval());
        if self.clocks > TICK_CLOCKS {
            return Err(Fault::Differs(format!("the events of a tick last {} clocks", self.clocks)));
        }
        self.clocks %= TICK_CLOCKS;
        match self.first {
            Some(first) if self.ticks > first => self.compare(found)?,
            _ if found != Event::new(Levels::LOW, TICK_CLOCKS) => {
                let text = format!("no idle tick before the cycle's start: {}", described(found, self.before));
                return Err(Fault::Differs(text));
            }
            _ => self.events_before = self.events_before.saturating_add(1),
        }
        self.before = found.levels();
        Ok(())
    }

    /// The event played last was played by a handler.
    fn handled(&mut self) {
        if let (Some(tick), false) = (self.counts.last_mut(), self.done) {
            tick.handled = tick.handled.saturating_add(1);
        }
    }

    fn compare(&mut self, found: Event) -> Result<(), Fault> {
        if self.next >= self.tick.len() {
            let Ok(tick) = self.expected.recv() else {
                self.done = true;
                return Ok(());
            };
            let mut before = self.before;
            let mut rising = 0_usize;
            for event in &tick {
                let rises = event.levels().bits() & !before.bits() & STEPS != 0;
                rising = rising.saturating_add(usize::from(rises));
                before = event.levels();
            }
            self.counts.push(TickCount { events: tick.len(), rising, handled: 0 });
            if rising > 0 {
                let mut hash = self.hash;
                tick.iter().for_each(|event| hash.event(*event));
                self.moved = hash.value();
            }
            (self.tick, self.next) = (tick, 0);
        }
        let expected = self.tick.get(self.next).copied().unwrap_or(Event::from_word(0));
        if found != expected {
            let mut text = format!("event {} differs", self.events);
            let _ = write!(
                text,
                " (tick {} of the cycle, {} clocks into it): the chip played {}, the desktop {}",
                self.ticks.saturating_sub(self.first.unwrap_or_default()).saturating_sub(1),
                self.tick.iter().take(self.next).map(|event| event.interval()).sum::<u32>(),
                described(found, self.before),
                described(expected, self.before)
            );
            return Err(Fault::Differs(text));
        }
        self.hash.event(found);
        self.events = self.events.saturating_add(1);
        self.next = self.next.saturating_add(1);
        Ok(())
    }
}

/// An event in words: its edges, then how long it lasts.
fn described(event: Event, before: Levels) -> String {
    let mut text = String::new();
    for (axis, name) in [(Axis::X, "X"), (Axis::Z, "Z")] {
        let levels = event.levels();
        match (before.step(axis), levels.step(axis)) {
            (false, true) => text
                .push_str(&format!("a rising edge of {name} {}, ", if levels.plus(axis) { "plus" } else { "minus" })),
            (true, false) => text.push_str(&format!("a falling edge of {name}, ")),
            _ => {}
        }
        if before.plus(axis) != levels.plus(axis) {
            text.push_str(&format!("{name} turning to {}, ", if levels.plus(axis) { "plus" } else { "minus" }));
        }
    }
    if text.is_empty() {
        text.push_str("no edge, ");
    }
    text.push_str(&format!("{} clocks", event.interval()));
    text
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;

    use super::*;

    /// A cycle: steps of X and Z with a tick between, and an idle tick behind. Levels, clocks.
    const TICKS: [&[(u16, u32)]; 4] = [
        &[(0b0011, 60), (0b0010, 11_940)],
        &[(2, 12_000)],
        &[(2, 5_000), (0b1110, 60), (0b1010, 6_940)],
        &[(10, 12_000)],
    ];

    /// QEMU's log of a chip that plays the cycle: two idle ticks, the mark, one more, then the events.
    fn log() -> Vec<String> {
        let play = |(levels, clocks): &(u16, u32)| [format!("{PORT}{levels:x})"), format!("{INTERVAL}{clocks:x})")];
        let idle = || play(&(0, 12_000));
        let mut lines = [idle(), idle()].concat();
        lines.push(format!("{STATE}2)"));
        lines.extend(idle());
        lines.push("RCC: unimplemented device read (size 4, offset 0x000)".into());
        let events: Vec<_> = TICKS.iter().flat_map(|tick| tick.iter()).collect();
        lines.extend(events.iter().take(4).copied().flat_map(play));
        // the third tick's pulse is ended by the hardware
        lines.insert(3, format!("{WIDTH}{:x})", 60 - 1));
        for (number, (at, word)) in (3..).zip(STREAM_SET) {
            lines.insert(number, format!("{STREAM}{at:03x}, value 0x{word:08x})"));
        }
        lines.extend(play(&(0b1110, FALLS | (60 + 6_940))));
        lines.push(format!("{START}{ONCE:x})"));
        lines.extend(events.iter().skip(6).copied().flat_map(play));
        // what tells that the cycle is over
        lines.extend(play(&(10, 12_000)));
        lines
    }

    fn compared(lines: &[String]) -> Result<Played, String> {
        let (give, expected) = channel();
        for tick in TICKS {
            let events = tick.iter().map(|(levels, clocks)| Event::new(Levels::from_bits(*levels), *clocks));
            give.send(events.collect()).unwrap();
        }
        drop(give);
        let text = lines.join("\n");
        let mut log = Log::new(text.as_bytes());
        compare(&mut || log.next(), &expected).map_err(|fault| fault.text().to_owned())
    }

    #[test]
    fn a_train_is_equal_to_itself() {
        let played = compared(&log()).unwrap();
        assert_eq!((played.events, played.events_before, played.ticks_before), (7, 3, 3));
        let counts = played.ticks.iter().map(|tick| (tick.events, tick.rising, tick.handled));
        assert_eq!(counts.collect::<Vec<_>>(), [(2, 1, 2), (1, 0, 1), (3, 1, 2), (1, 0, 1)]);
    }

    #[test]
    fn whatever_line_of_the_chips_log_is_missing_doubled_or_changed_is_found() {
        let good = log();
        let counted = |line: &String| !line.starts_with("RCC");
        // the last event only tells that the cycle is over
        for at in (0..good.len() - 2).filter(|at| counted(&good[*at])) {
            let mut missing = good.clone();
            missing.remove(at);
            let mut doubled = good.clone();
            doubled.insert(at, good[at].clone());
            let mut changed = good.clone();
            let (start, value) = good[at].rsplit_once("0x").unwrap();
            let value = u32::from_str_radix(value.trim_end_matches(')'), 16).unwrap();
            changed[at] = format!("{start}0x{:x})", value ^ 1);
            let idle = good[at].starts_with(INTERVAL) && at < 8;
            assert!(compared(&changed).is_err(), "{at} changed");
            // one idle tick less before the start is no fault; a state or a width may be told twice
            let told = [STATE, WIDTH, STREAM].iter().any(|start| good[at].starts_with(start));
            assert!(compared(&doubled).is_err() || told, "{at} doubled");
            assert!(compared(&missing).is_err() || idle, "{at} missing");
        }
    }

    #[test]
    fn every_fault_that_the_image_counts_is_found() {
        let good = log();
        for at in 0..good.len() - 1 {
            let mut lines = good.clone();
            lines.insert(at, format!("{FAULTS}10000)"));
            assert_eq!(compared(&lines).unwrap_err(), "the image counts faults: underruns 1, lost 0");
        }
    }

    #[test]
    fn an_emulator_that_ends_says_why() {
        let mut lines = log();
        lines.truncate(9);
        lines.push("qemu: fatal: Lockup: can't take terminal exception".into());
        let text = compared(&lines).unwrap_err();
        assert!(text.starts_with("after 0 events of the cycle the emulator ended: qemu: fatal"), "{text}");
    }
}
