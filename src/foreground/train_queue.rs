//! The pulse train between the interpolator and the step timer.
//!
//! One side writes whole ticks, the other plays event by event and preempts the first at any instant; neither waits
//! and neither locks. The queue is made of atomic words, so it needs no `unsafe`; both sides run on one core, where
//! the order of a program's own writes is all the order that is needed. The writer publishes a tick at once: it is
//! played whole or not yet.
//!
//! A word is the event with `FIRST` set on the first event of a tick: the player asks for the next tick when it
//! begins one, so a tick is always ready behind the one being played.

use core::sync::atomic::{AtomicU32, Ordering, compiler_fence};

use interp_core::config::TICK_CLOCKS;
use interp_core::train::{Event, Levels};

/// Places in the queue; one stays empty. Two ticks of events 2 us apart, and some to spare.
pub const TRAIN_QUEUE: usize = 1024;

#[expect(clippy::cast_possible_truncation, reason = "1024")]
const MASK: u32 = TRAIN_QUEUE as u32 - 1;
const _: () = assert!(TRAIN_QUEUE.is_power_of_two());

/// Marks the first event of a tick: the interval's top bit, which no interval uses.
const FIRST: u32 = 1 << 15;
const _: () = assert!(TICK_CLOCKS < FIRST);

/// Steps of all lathes; the other levels are directions.
const STEPS: u16 = 0x5555;

/// Events on their way to the pins.
#[derive(Debug)]
pub struct TrainQueue {
    words: [AtomicU32; TRAIN_QUEUE],
    /// Events played, modulo 2^32.
    played: AtomicU32,
    /// Events written, modulo 2^32.
    written: AtomicU32,
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
            words: [const { AtomicU32::new(0) }; TRAIN_QUEUE],
            played: AtomicU32::new(0),
            written: AtomicU32::new(0),
        }
    }

    /// The two sides.
    pub const fn split(&mut self) -> (Writer<'_>, Player<'_>) {
        let queue = &*self;
        (Writer { queue, next: 0, room: 0, first: FIRST, overruns: 0 }, Player { queue, underruns: 0 })
    }

    fn word(&self, at: u32) -> Option<&AtomicU32> {
        self.words.get((at & MASK) as usize)
    }
}

/// The interpolator's side.
#[derive(Debug)]
pub struct Writer<'q> {
    queue: &'q TrainQueue,
    next: u32,
    /// Places known to be free.
    room: u32,
    first: u32,
    overruns: u32,
}

impl Writer<'_> {
    /// Adds an event of the present tick. Where there is no place for it, it is lost and counted.
    #[inline]
    pub fn put(&mut self, event: Event) {
        if self.room == 0 {
            self.room = MASK.wrapping_sub(self.next.wrapping_sub(self.queue.played.load(Ordering::Relaxed)));
            if self.room == 0 {
                self.overruns = self.overruns.saturating_add(1);
                return;
            }
        }
        if let Some(place) = self.queue.word(self.next) {
            place.store(event.word() | self.first, Ordering::Relaxed);
        }
        self.first = 0;
        self.next = self.next.wrapping_add(1);
        self.room = self.room.wrapping_sub(1);
    }

    /// Ends the tick and hands it over.
    #[inline]
    pub fn publish(&mut self) {
        compiler_fence(Ordering::Release);
        self.queue.written.store(self.next, Ordering::Relaxed);
        self.first = FIRST;
    }

    /// Events lost for want of a place: the settings ask for more than the board's queue holds.
    pub const fn overruns(&self) -> u32 {
        self.overruns
    }
}

/// What is to be played now.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Play {
    /// Levels to write.
    pub levels: u16,
    /// Clocks to wait.
    pub interval: u32,
    /// A tick begins here: the next one is wanted.
    pub begins: bool,
}

/// The step timer's side.
#[derive(Debug)]
pub struct Player<'q> {
    queue: &'q TrainQueue,
    underruns: u32,
}

impl Player<'_> {
    /// The next event, or an idle tick where there is none: steps low, directions as they are.
    #[inline]
    pub fn next_or_idle(&mut self) -> Play {
        let next = self.queue.played.load(Ordering::Relaxed);
        if next == self.queue.written.load(Ordering::Relaxed) {
            return self.idle(next);
        }
        compiler_fence(Ordering::Acquire);
        let word = self.queue.word(next).map_or(0, |place| place.load(Ordering::Relaxed));
        self.queue.played.store(next.wrapping_add(1), Ordering::Relaxed);
        Play { levels: levels(word), interval: word & !FIRST & 0xFFFF, begins: word & FIRST != 0 }
    }

    #[cold]
    fn idle(&mut self, next: u32) -> Play {
        self.underruns = self.underruns.saturating_add(1);
        // the last event played is still in its place, which the writer leaves free
        let last = self.queue.word(next.wrapping_sub(1)).map_or(0, |place| place.load(Ordering::Relaxed));
        let levels = Levels::from_bits(levels(last) & !STEPS).bits();
        Play { levels, interval: TICK_CLOCKS, begins: true }
    }

    /// How often the queue was found empty.
    pub const fn underruns(&self) -> u32 {
        self.underruns
    }
}

const fn levels(word: u32) -> u16 {
    (word >> 16) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    fn event(levels: u16, interval: u32) -> Event {
        Event::new(Levels::from_bits(levels), interval)
    }

    #[test]
    fn a_tick_is_played_only_once_it_is_published() {
        let mut queue = TrainQueue::new();
        let (mut writer, mut player) = queue.split();
        writer.put(event(3, 24));
        assert_eq!(player.next_or_idle(), Play { levels: 0, interval: TICK_CLOCKS, begins: true });
        writer.put(event(2, 11_976));
        writer.publish();
        assert_eq!(player.next_or_idle(), Play { levels: 3, interval: 24, begins: true });
        assert_eq!(player.next_or_idle(), Play { levels: 2, interval: 11_976, begins: false });
        assert_eq!(player.underruns(), 1);
    }

    #[test]
    fn an_idle_tick_keeps_directions_and_lowers_steps() {
        let mut queue = TrainQueue::new();
        let (mut writer, mut player) = queue.split();
        writer.put(event(0xFFFF, 12_000));
        writer.publish();
        assert_eq!(player.next_or_idle().levels, 0xFFFF);
        assert_eq!(player.next_or_idle().levels, 0xAAAA);
        writer.put(event(0, 12_000));
        assert_eq!(player.next_or_idle().levels, 0xAAAA);
    }

    #[test]
    fn what_finds_no_place_is_counted_and_nothing_else_is_lost() {
        let mut queue = TrainQueue::new();
        let (mut writer, mut player) = queue.split();
        for _ in 0..3 {
            for n in 0..=1023_u16 {
                writer.put(event(n, 1 + u32::from(n)));
            }
            writer.publish();
            for n in 0..1023_u16 {
                let play = player.next_or_idle();
                assert_eq!((play.levels, play.interval, play.begins), (n, 1 + u32::from(n), n == 0));
            }
        }
        assert_eq!((writer.overruns(), player.underruns()), (3, 0));
    }
}
