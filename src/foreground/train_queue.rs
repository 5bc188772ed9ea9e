//! The pulse train between the interpolator and the step timer.
//!
//! One side writes whole ticks, the other plays event by event and preempts the first at any instant; neither waits
//! and neither locks. The queue is made of atomic words, so it needs no `unsafe`; both sides run on one core, where
//! the order of a program's own writes is all the order that is needed. The writer publishes a tick at once: it is
//! played whole or not yet.
//!
//! Each tick is led by a header, a word that no event can be; behind the last tick published stands an empty word.
//! The player so learns from the word itself that a tick begins or that there is none, and the writer publishes a
//! tick by putting the header in the place of the empty word, last of all. At a header the player asks for the next
//! tick, so a tick is always ready behind the one being played.
//!
//! A pulse of a row, its rise and its fall, is one word, whose interval leads to the next rise: the board lowers the pins
//! by itself, the row's width later. All other events have a word each.

use core::sync::atomic::{AtomicU32, Ordering, compiler_fence};

use interp_core::config::TICK_CLOCKS;
use interp_core::train::{Event, Levels, Train};

/// Places in the queue; three stay empty. Two ticks of events 2 us apart, and some to spare.
pub const TRAIN_QUEUE: usize = 1024;

#[expect(clippy::cast_possible_truncation, reason = "1024")]
const MASK: u32 = TRAIN_QUEUE as u32 - 1;
const _: () = assert!(TRAIN_QUEUE.is_power_of_two());

/// Nothing here yet.
const EMPTY: u32 = 0;
/// A tick begins behind this word. No event has an interval of 0.
const HEADER: u32 = 1 << 16;

/// Mark of a word that is a whole pulse, above the bits of an interval.
const FALLS: u32 = 1 << 15;
const _: () = assert!(TICK_CLOCKS < FALLS);

/// Steps of all lathes; the other levels are directions.
const STEPS: u16 = 0x5555;

/// Events on their way to the pins.
#[derive(Debug)]
pub struct TrainQueue {
    words: [AtomicU32; TRAIN_QUEUE],
    /// Words played up to the tick being played, modulo 2^32.
    played: AtomicU32,
    /// How often the player found nothing.
    underruns: AtomicU32,
    /// What found no place; never read.
    lost: AtomicU32,
}

impl Default for TrainQueue {
    fn default() -> Self {
        Self::new()
    }
}

impl TrainQueue {
    /// An empty queue.
    pub const fn new() -> Self {
        Self {
            words: [const { AtomicU32::new(EMPTY) }; TRAIN_QUEUE],
            played: AtomicU32::new(0),
            underruns: AtomicU32::new(0),
            lost: AtomicU32::new(0),
        }
    }

    /// The two sides.
    pub const fn split(&mut self) -> (Writer<'_>, Player<'_>) {
        let queue = &*self;
        (Writer { queue, header: 0, next: 1, limit: MASK.wrapping_sub(1), overruns: 0 }, Player { queue, next: 0 })
    }

    #[inline]
    fn get(&self, at: u32) -> u32 {
        self.words.get((at & MASK) as usize).map_or(EMPTY, |place| place.load(Ordering::Relaxed))
    }

    #[inline]
    fn set(&self, at: u32, word: u32) {
        if let Some(place) = self.words.get((at & MASK) as usize) {
            place.store(word, Ordering::Relaxed);
        }
    }
}

/// The interpolator's side.
#[derive(Debug)]
pub struct Writer<'q> {
    queue: &'q TrainQueue,
    /// Where the present tick's header will stand.
    header: u32,
    /// Where the next event will.
    next: u32,
    /// The first place known to be taken: an empty word still goes before it, and the last event played.
    limit: u32,
    overruns: u32,
}

impl Writer<'_> {
    /// Looks for more places. False where there are none.
    #[cold]
    fn more(&mut self) -> bool {
        self.look();
        let room = self.next != self.limit;
        if !room {
            self.overruns = self.overruns.saturating_add(1);
        }
        room
    }

    /// Ends the tick and hands it over. A tick all of whose events were lost is not one: the player idles instead.
    #[inline]
    pub fn publish(&mut self) {
        if self.next != self.header.wrapping_add(1) {
            self.queue.set(self.next, EMPTY);
            compiler_fence(Ordering::Release);
            self.queue.set(self.header, HEADER);
            self.header = self.next;
            self.next = self.next.wrapping_add(1);
        }
        self.look();
    }

    /// Looks how far the player has come.
    #[inline]
    fn look(&mut self) {
        let taken = self.queue.played.load(Ordering::Relaxed).wrapping_add(MASK).wrapping_sub(1);
        // a queue that is full has its limit behind the header, not behind `next`
        self.limit = if taken == self.header { self.next } else { taken };
    }

    /// Events lost for want of a place: the settings ask for more than the board's queue holds.
    pub const fn overruns(&self) -> u32 {
        self.overruns
    }

    /// How often the player found nothing: the interpolator came too late.
    pub fn underruns(&self) -> u32 {
        self.queue.underruns.load(Ordering::Relaxed)
    }
}

impl Train for Writer<'_> {
    /// Adds an event of the present tick. Where there is no place for it, it is lost and counted.
    #[inline]
    fn put(&mut self, event: Event) {
        if self.next == self.limit && !self.more() {
            return;
        }
        self.queue.set(self.next, event.word());
        self.next = self.next.wrapping_add(1);
    }

    #[inline(always)]
    fn pulse(raised: Levels) -> Event {
        Event::from_word(Event::new(raised, FALLS).word())
    }

    #[inline(always)]
    fn put_row(&mut self, pulses: u32, width: u32, _: Levels, mut next: impl FnMut() -> Event) {
        let mut left = pulses;
        while left > 0 {
            let first = self.next & MASK;
            let mut count = left.min(self.limit.wrapping_sub(self.next)).min(MASK.wrapping_add(1).wrapping_sub(first));
            let mut places =
                self.queue.words.get(first as usize..first.wrapping_add(count) as usize).unwrap_or_default();
            let room = !places.is_empty();
            if !room {
                if self.more() {
                    continue;
                }
                // no place: the next one is lost, and counted
                (places, count) = (core::slice::from_ref(&self.queue.lost), 1);
            }
            // asked at one place only, so that what it keeps stays in registers
            let mut last = EMPTY;
            for place in places {
                last = next().word();
                place.store(last, Ordering::Relaxed);
            }
            left = left.wrapping_sub(count);
            if room {
                self.next = self.next.wrapping_add(count);
                if left == 0 {
                    let levels = Event::from_word(last).levels();
                    self.queue.set(self.next.wrapping_sub(1), Event::new(levels, width).word());
                }
            }
        }
    }
}

/// What is played next.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Play(u32);

impl Play {
    /// Levels to write at once.
    #[inline]
    pub const fn levels(self) -> Levels {
        Event::from_word(self.0).levels()
    }

    /// Whether the step pins fall again by themselves, a row's width later.
    #[inline]
    pub const fn falls(self) -> bool {
        self.0 & FALLS != 0
    }

    /// The word as it is queued.
    pub const fn word(self) -> u32 {
        self.0
    }

    /// Clocks until what is played then.
    #[inline]
    pub const fn clocks(self) -> u32 {
        self.0 & FALLS.wrapping_sub(1)
    }
}

/// The step timer's side.
#[derive(Debug)]
pub struct Player<'q> {
    queue: &'q TrainQueue,
    /// What is played next.
    next: u32,
}

impl Player<'_> {
    /// The next event or pulse, or an idle tick where there is none: steps low, directions as they are. `begins` is called
    /// where it is the first of a tick: the next one is wanted.
    #[inline]
    pub fn next_or_idle(&mut self, begins: impl FnOnce()) -> Play {
        let word = self.queue.get(self.next);
        if word & 0xFFFF == 0 {
            begins();
            return Play(self.begin(word).word());
        }
        self.next = self.next.wrapping_add(1);
        Play(word)
    }

    /// The first event of the tick that `word` leads.
    #[cold]
    #[inline(never)]
    fn begin(&mut self, word: u32) -> Event {
        self.queue.played.store(self.next, Ordering::Relaxed);
        if word == EMPTY {
            return self.idle();
        }
        compiler_fence(Ordering::Acquire);
        self.next = self.next.wrapping_add(2);
        Event::from_word(self.queue.get(self.next.wrapping_sub(1)))
    }

    #[cold]
    fn idle(&mut self) -> Event {
        // keeps the optimizer from taking the player apart into single words, whose addresses then cost more
        // instructions in every event than the words do
        core::hint::black_box(&mut *self);
        let underruns = &self.queue.underruns;
        underruns.store(underruns.load(Ordering::Relaxed).saturating_add(1), Ordering::Relaxed);
        // the last event played is still in its place, which the writer leaves free
        let last = Event::from_word(self.queue.get(self.next.wrapping_sub(1))).levels();
        Event::new(Levels::from_bits(last.bits() & !STEPS), TICK_CLOCKS)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::*;

    fn event(levels: u16, interval: u32) -> Event {
        Event::new(Levels::from_bits(levels), interval)
    }

    /// What is played next, and whether a tick begins.
    fn played(player: &mut Player<'_>) -> (u16, u32, bool) {
        let mut begins = false;
        let event = player.next_or_idle(|| begins = true);
        assert!(!event.falls());
        (event.levels().bits(), event.clocks(), begins)
    }

    #[test]
    fn a_tick_is_played_only_once_it_is_published() {
        let mut queue = TrainQueue::new();
        let (mut writer, mut player) = queue.split();
        writer.put(event(3, 24));
        assert_eq!(played(&mut player), (0, TICK_CLOCKS, true));
        writer.put(event(2, 11_976));
        writer.publish();
        assert_eq!(played(&mut player), (3, 24, true));
        assert_eq!(played(&mut player), (2, 11_976, false));
        assert_eq!(writer.underruns(), 1);
    }

    #[test]
    fn an_idle_tick_keeps_directions_and_lowers_steps() {
        let mut queue = TrainQueue::new();
        let (mut writer, mut player) = queue.split();
        writer.put(event(0xFFFF, 12_000));
        writer.publish();
        assert_eq!(played(&mut player), (0xFFFF, 12_000, true));
        assert_eq!(played(&mut player), (0xAAAA, TICK_CLOCKS, true));
        writer.put(event(0, 12_000));
        assert_eq!(played(&mut player), (0xAAAA, TICK_CLOCKS, true));
        assert_eq!(writer.underruns(), 2);
    }

    #[test]
    fn what_finds_no_place_is_counted_and_nothing_else_is_lost() {
        let mut queue = TrainQueue::new();
        let (mut writer, mut player) = queue.split();
        for round in 0..3 {
            for n in 0..=1023_u16 {
                writer.put(event(n, 1 + u32::from(n)));
            }
            writer.publish();
            // a header, an empty word and the last event played take a place each
            for n in 0..1021_u16 {
                assert_eq!(played(&mut player), (n, 1 + u32::from(n), n == 0), "round {round}");
            }
            assert_eq!(played(&mut player), (1020 & 0xAAAA, TICK_CLOCKS, true));
        }
        assert_eq!((writer.overruns(), writer.underruns()), (9, 3));
    }

    /// A tick that finds the queue full behind a long one is lost as a whole; the player goes on behind it.
    #[test]
    fn a_tick_without_any_place_is_no_tick() {
        for length in 1_019..=1_021_u16 {
            let mut queue = TrainQueue::new();
            let (mut writer, mut player) = queue.split();
            let write = |writer: &mut Writer<'_>, length: u16, first: u16| {
                (0..length).for_each(|n| writer.put(event(first + n, 5)));
                writer.publish();
            };
            write(&mut writer, length, 0);
            assert_eq!(played(&mut player), (0, 5, true));
            // as the interpolator does while the first tick is played
            write(&mut writer, 3, 5_000);
            for n in 1..length {
                assert_eq!(played(&mut player), (n, 5, false));
            }
            let kept = 1_021_u16.saturating_sub(length + 1).min(3);
            for n in 0..kept {
                assert_eq!(played(&mut player), (5_000 + n, 5, n == 0), "length {length}");
            }
            let last = if kept > 0 { 4_999 + kept } else { length - 1 };
            assert_eq!(played(&mut player), (last & 0xAAAA, TICK_CLOCKS, true), "length {length}");
            write(&mut writer, 2, 7_000);
            let next = [(); 3].map(|()| played(&mut player));
            assert_eq!(next, [(7_000, 5, true), (7_001, 5, false), (7_001 & 0xAAAA, TICK_CLOCKS, true)]);
            assert_eq!(writer.overruns(), u32::from(3 - kept));
        }
    }

    /// Rows come out as single events would, over the queue's end and where there is no place for all.
    #[test]
    fn a_pulse_of_a_row_is_its_two_events() {
        for odd in 0..2_u16 {
            let mut queue = TrainQueue::new();
            let (mut writer, mut player) = queue.split();
            let (mut lost, mut whole) = (0, 0);
            for tick in 0..40_u16 {
                let pulses = 97 + 90 * (tick % 15);
                let mut expected = Vec::new();
                for n in 0..odd {
                    writer.put(event(n, 7));
                    expected.push((n, 7));
                }
                let mut n = 1;
                let pulse = |n: u16| (n << 2 | 1, 100 + u32::from(n));
                writer.put_row(u32::from(pulses), 60, Levels::from_bits(2), || {
                    n += 1;
                    let (levels, clocks) = pulse(n);
                    Event::from_word(Writer::pulse(Levels::from_bits(levels)).word() + clocks)
                });
                for n in 2..=pulses + 1 {
                    let (levels, clocks) = pulse(n);
                    expected.extend([(levels, 60), (2, clocks - 60)]);
                }
                expected.pop();
                writer.publish();
                // played at once, so that the queue is empty for the next tick
                let mut begins = true;
                let mut found = Vec::new();
                while found.len() < expected.len() {
                    let mut begun = false;
                    let play = player.next_or_idle(|| begun = true);
                    if begun != begins {
                        break;
                    }
                    begins = false;
                    if play.falls() {
                        whole += 1;
                        found.extend([(play.levels().bits(), 60), (2, play.clocks() - 60)]);
                    } else {
                        found.push((play.levels().bits(), play.clocks()));
                    }
                }
                assert_eq!(found, expected[..found.len()], "tick {tick}");
                lost += (expected.len() - found.len()).div_ceil(2);
                while player.next_or_idle(|| ()).clocks() != TICK_CLOCKS {}
            }
            assert_eq!(u32::try_from(lost).unwrap(), writer.overruns());
            assert!(lost > 0 && whole > 20_000);
        }
    }

    /// Ticks of every length up to the queue's, written and played in turn, come out whole and in order.
    #[test]
    fn ticks_of_every_length_come_out_as_they_went_in() {
        let mut queue = TrainQueue::new();
        let (mut writer, mut player) = queue.split();
        for length in (1..=500_u16).chain((1..=500).rev()) {
            for n in 0..length {
                writer.put(event(n, 1 + u32::from(length)));
            }
            writer.publish();
            for n in 0..length {
                assert_eq!(played(&mut player), (n, 1 + u32::from(length), n == 0));
            }
        }
        assert_eq!((writer.overruns(), writer.underruns()), (0, 0));
    }
}
