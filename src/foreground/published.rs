//! Words that one task publishes and tasks of lower priority read: the snapshot back to the background.
//!
//! The writer never waits. A reader that was preempted by the writer sees that the count of writes has changed, and
//! reads again; it may do so only while a higher priority keeps publishing faster than it can copy the words. No
//! critical section and no `unsafe`: the words are atomic, and writer and readers share one core.

use core::sync::atomic::{AtomicU32, Ordering, compiler_fence};

/// `N` words that belong together.
#[derive(Debug)]
pub struct Published<const N: usize> {
    words: [AtomicU32; N],
    writes: AtomicU32,
}

impl<const N: usize> Default for Published<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Published<N> {
    /// All zero.
    pub const fn new() -> Self {
        Self { words: [const { AtomicU32::new(0) }; N], writes: AtomicU32::new(0) }
    }

    /// Publishes all words, which `write` stores. To be called from one task only, of higher priority than any reader.
    #[inline(always)]
    pub fn publish(&self, write: impl FnOnce(&[AtomicU32; N])) {
        let writes = self.writes.load(Ordering::Relaxed);
        self.writes.store(writes.wrapping_add(1), Ordering::Relaxed);
        compiler_fence(Ordering::SeqCst);
        write(&self.words);
    }

    /// The words as published last, all of one write.
    pub fn read(&self) -> [u32; N] {
        self.read_through(|| {})
    }

    /// `between` runs after the words are copied: tests put the preempting writer there.
    fn read_through(&self, mut between: impl FnMut()) -> [u32; N] {
        loop {
            let before = self.writes.load(Ordering::Relaxed);
            compiler_fence(Ordering::SeqCst);
            let mut words = [0; N];
            for (word, place) in words.iter_mut().zip(&self.words) {
                *word = place.load(Ordering::Relaxed);
                between();
            }
            compiler_fence(Ordering::SeqCst);
            if self.writes.load(Ordering::Relaxed) == before {
                return words;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reader_preempted_anywhere_gets_words_of_one_write() {
        for at in 0..6 {
            let published = Published::<3>::new();
            let write =
                |value| published.publish(|words| words.iter().for_each(|word| word.store(value, Ordering::Relaxed)));
            write(1);
            let mut calls = 0;
            let read = published.read_through(|| {
                if calls == at {
                    write(2);
                }
                calls += 1;
            });
            assert_eq!(read, if at < 3 { [2, 2, 2] } else { [1, 1, 1] });
        }
    }
}
