//! Queues between tasks: one side puts in, the other takes out, either may preempt the other at any instant.
//!
//! The length is a power of two and places are found by masking, so that nothing here divides or can panic; the queues
//! of `heapless` take a remainder by a length that the compiler does not know, and keep a panic reachable. No `unsafe`
//! either: each place has a lock that is only ever tried. The counts of what was put in and taken out give a place to
//! one side at a time, so a try never fails.

use core::sync::atomic::{AtomicU32, Ordering};

use heapless::Vec;
use try_lock::TryLock;

/// A place of the queue. Not an `Option`, whose `None` need not be all zeros: an empty queue would take flash.
type Place<T> = TryLock<Vec<T, 1>>;

/// A queue of at most `N` items, `N` a power of two.
#[derive(Debug)]
pub struct Queue<T, const N: usize> {
    places: [Place<T>; N],
    counts: Counts,
}

/// Items put in and taken out, modulo 2^32.
#[derive(Debug)]
struct Counts {
    put: AtomicU32,
    taken: AtomicU32,
}

impl Counts {
    fn len(&self) -> usize {
        // what was taken is read first: the other side can only make it more, and the result too large, never negative
        let taken = self.taken.load(Ordering::Acquire);
        self.put.load(Ordering::Acquire).wrapping_sub(taken) as usize
    }
}

impl<T, const N: usize> Default for Queue<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T, const N: usize> Queue<T, N> {
    /// An empty queue.
    pub const fn new() -> Self {
        const { assert!(N.is_power_of_two() && N < 1 << 16) };
        Self {
            places: [const { TryLock::new(Vec::new()) }; N],
            counts: Counts { put: AtomicU32::new(0), taken: AtomicU32::new(0) },
        }
    }

    /// The two sides.
    pub const fn split(&mut self) -> (Producer<'_, T>, Consumer<'_, T>) {
        let Self { places, counts } = self;
        (Producer { places, counts }, Consumer { places, counts })
    }
}

/// The place of the `count`th item.
fn place<T>(places: &[Place<T>], count: u32) -> Option<&Place<T>> {
    places.get(count as usize & places.len().wrapping_sub(1))
}

/// The side that puts in.
#[derive(Debug)]
pub struct Producer<'q, T> {
    places: &'q [Place<T>],
    counts: &'q Counts,
}

impl<T> Producer<'_, T> {
    /// Puts an item in.
    ///
    /// # Errors
    /// The item, where the queue is full.
    pub fn enqueue(&mut self, item: T) -> Result<(), T> {
        let put = self.counts.put.load(Ordering::Relaxed);
        if self.ready()
            && let Some(mut place) = place(self.places, put).and_then(TryLock::try_lock)
        {
            // it is free, and so empty
            place.push(item)?;
            drop(place);
            self.counts.put.store(put.wrapping_add(1), Ordering::Release);
            return Ok(());
        }
        Err(item)
    }

    /// Whether there is room for an item.
    pub fn ready(&self) -> bool {
        self.len() < self.capacity()
    }

    /// Items in the queue.
    pub fn len(&self) -> usize {
        self.counts.len()
    }

    /// Whether all was taken out.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Items that the queue holds at most.
    pub const fn capacity(&self) -> usize {
        self.places.len()
    }
}

/// The side that takes out.
#[derive(Debug)]
pub struct Consumer<'q, T> {
    places: &'q [Place<T>],
    counts: &'q Counts,
}

impl<T> Consumer<'_, T> {
    /// Takes the item out that was put in first.
    pub fn dequeue(&mut self) -> Option<T> {
        let taken = self.counts.taken.load(Ordering::Relaxed);
        if !self.ready() {
            return None;
        }
        let item = place(self.places, taken)?.try_lock()?.pop();
        self.counts.taken.store(taken.wrapping_add(1), Ordering::Release);
        item
    }

    /// Whether there is an item.
    pub fn ready(&self) -> bool {
        self.counts.len() > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use std::thread;

    #[test]
    fn a_full_queue_gives_the_item_back_and_keeps_the_order_over_the_wrap() {
        let mut queue = Queue::<u32, 4>::new();
        queue.counts = Counts { put: AtomicU32::new(u32::MAX - 5), taken: AtomicU32::new(u32::MAX - 5) };
        let (mut into, mut out) = queue.split();
        for round in 0..10 {
            for n in 0..4 {
                assert_eq!((into.len(), into.enqueue(4 * round + n)), (n as usize, Ok(())));
            }
            assert_eq!((into.ready(), into.capacity(), into.enqueue(99)), (false, 4, Err(99)));
            for n in 0..4 {
                assert_eq!(out.dequeue(), Some(4 * round + n));
            }
            assert_eq!((out.ready(), out.dequeue(), into.is_empty()), (false, None, true));
        }
    }

    #[test]
    fn two_sides_at_once_lose_nothing_and_repeat_nothing() {
        let mut queue = Queue::<std::boxed::Box<u32>, 8>::new();
        let (mut into, mut out) = queue.split();
        thread::scope(|scope| {
            scope.spawn(move || {
                for n in 0..100_000 {
                    while into.enqueue(n.into()).is_err() {
                        thread::yield_now();
                    }
                }
            });
            for n in 0..100_000 {
                let item = loop {
                    match out.dequeue() {
                        Some(item) => break item,
                        None => thread::yield_now(),
                    }
                };
                assert_eq!(*item, n);
            }
        });
    }
}
