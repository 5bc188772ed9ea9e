//! Inbox of the link: sorts the bytes that a serial port receives into ordinary ones and real-time commands.
//!
//! It runs in the receiving interrupt. Real-time commands have a queue of their own, so that they overtake what is
//! waiting. When the queue of bytes is full, bytes are lost: the sender did not wait for its `ok`. The line that lost
//! them gets a byte that no line may contain, so that it is refused and never executed in part.

use super::link::{Realtime, realtime};
use crate::queue::Producer;

/// Stands for bytes that were lost.
pub const LOST: u8 = 0x7F;

/// The receiving side of a link.
pub struct Inbox<'q> {
    bytes: Producer<'q, u8>,
    realtime: Producer<'q, Realtime>,
    /// Bytes were lost since the last one was taken.
    gap: bool,
    lost: u32,
}

impl<'q> Inbox<'q> {
    /// An inbox that fills these queues.
    pub const fn new(bytes: Producer<'q, u8>, realtime: Producer<'q, Realtime>) -> Self {
        Self { bytes, realtime, gap: false, lost: 0 }
    }

    /// Takes one byte.
    pub fn take(&mut self, byte: u8) {
        if let Some(what) = realtime(byte) {
            // nothing else, asked for again and again, may keep out what stops the machine
            let crowded = self.realtime.len() > self.realtime.capacity() / 2;
            let stops = matches!(what, Realtime::Hold | Realtime::Reset);
            if crowded && !stops || self.realtime.enqueue(what).is_err() {
                self.lost = self.lost.saturating_add(1);
            }
            return;
        }
        if self.gap && self.bytes.enqueue(LOST).is_ok() {
            self.gap = false;
        }
        if self.gap || self.bytes.enqueue(byte).is_err() {
            self.gap = true;
            self.lost = self.lost.saturating_add(1);
        }
    }

    /// Bytes and commands lost so far.
    pub const fn lost(&self) -> u32 {
        self.lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::queue::Queue;

    #[test]
    fn lost_bytes_leave_a_mark_that_no_line_may_contain() {
        let (mut bytes, mut realtime) = (Queue::<u8, 4>::new(), Queue::<Realtime, 8>::new());
        let (bytes_in, mut bytes_out) = bytes.split();
        let (realtime_in, _realtime_out) = realtime.split();
        let mut inbox = Inbox::new(bytes_in, realtime_in);
        b"G1 X5".iter().for_each(|byte| inbox.take(*byte));
        assert_eq!([(); 3].map(|()| bytes_out.dequeue()), [Some(b'G'), Some(b'1'), Some(b' ')]);
        inbox.take(b'\n');
        let rest = [(); 4].map(|()| bytes_out.dequeue());
        assert_eq!((rest, inbox.lost()), ([Some(b'X'), Some(LOST), Some(b'\n'), None], 1));
    }

    #[test]
    fn what_stops_the_machine_finds_a_place_behind_a_flood_of_anything_else() {
        for flood in *b"?~\x90\x91\x92\x93\x94" {
            for (byte, wanted) in [(b'!', Realtime::Hold), (0x18, Realtime::Reset)] {
                let (mut bytes, mut realtime) = (Queue::<u8, 4>::new(), Queue::<Realtime, 8>::new());
                let (bytes_in, bytes_out) = bytes.split();
                let (realtime_in, mut realtime_out) = realtime.split();
                let mut inbox = Inbox::new(bytes_in, realtime_in);
                [flood; 17].into_iter().chain([byte]).for_each(|byte| inbox.take(byte));
                let mut last = None;
                while let Some(what) = realtime_out.dequeue() {
                    last = Some(what);
                }
                assert_eq!((last, inbox.lost(), bytes_out.ready()), (Some(wanted), 12, false));
            }
        }
    }
}
