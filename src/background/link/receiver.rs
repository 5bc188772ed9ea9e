//! Bytes in, whole lines out, in bounded memory, with one answer due for each line whatever arrives.
//!
//! Bytes wait in a ring. A line that is too long, or that bytes were lost in, leaves a mark instead of its text. When
//! the ring is full the line then arriving is lost, and so is every line behind it until all that came before is
//! answered: so answers keep their order, and no line is ever put together from the pieces of two.

use feature_editor::codes::MAX_LINE;
use heapless::{Deque, Vec};

/// Bytes that may wait, terminators included: the longest line, and as much again so that the sender need not wait.
/// Senders that count characters need 128.
pub const RECEIVE_BUFFER: usize = 512;

/// In place of a line of more than [`MAX_LINE`] bytes. Text has no bytes above 0x7F.
const TOO_LONG: u8 = 0x80;
/// In place of a line that bytes were lost in.
const DAMAGED: u8 = 0x81;

/// The line that is arriving.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Arriving {
    /// So many of its bytes are in the ring.
    Stored(usize),
    /// A mark is in the ring; the rest is skipped.
    Marked,
    /// The ring was full, now or before; true once a byte of this line was skipped.
    Lost(bool),
}

/// A line, or what became of it.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) enum Received {
    /// Its text was stored.
    Line,
    /// Nothing, between a carriage return and its line feed.
    Nothing,
    /// More than [`MAX_LINE`] bytes.
    TooLong,
    /// Bytes were lost in it.
    Damaged,
    /// It found the ring full.
    Lost,
}

/// The ring.
#[derive(Clone, Debug)]
pub(super) struct Receiver {
    bytes: Deque<u8, RECEIVE_BUFFER>,
    /// Terminators in the ring.
    whole: usize,
    arriving: Arriving,
    /// Lines lost behind those in the ring and not yet answered.
    lost: u32,
    /// Bytes lost because the ring was full, ever.
    overflow: u32,
    /// The last line taken ended in a carriage return.
    carriage_return: bool,
}

impl Receiver {
    pub(super) const fn new() -> Self {
        Self {
            bytes: Deque::new(),
            whole: 0,
            arriving: Arriving::Stored(0),
            lost: 0,
            overflow: 0,
            carriage_return: false,
        }
    }

    /// Bytes that fit.
    pub(super) fn room(&self) -> usize {
        RECEIVE_BUFFER.saturating_sub(self.bytes.len())
    }

    /// Bytes that were lost because the ring was full, ever.
    pub(super) const fn overflow(&self) -> u32 {
        self.overflow
    }

    pub(super) fn receive(&mut self, byte: u8) {
        match byte {
            b'\r' | b'\n' => self.terminate(byte),
            0x80.. => {}
            _ => self.text(byte),
        }
    }

    fn text(&mut self, byte: u8) {
        match self.arriving {
            Arriving::Stored(length) if length >= MAX_LINE => {
                self.drop_arriving();
                self.mark(TOO_LONG);
            }
            Arriving::Stored(length) => {
                if self.bytes.push_back(byte).is_ok() {
                    self.arriving = Arriving::Stored(length.saturating_add(1));
                } else {
                    let bytes = u32::try_from(length).unwrap_or(u32::MAX).saturating_add(1);
                    self.overflow = self.overflow.saturating_add(bytes);
                    self.drop_arriving();
                    self.arriving = Arriving::Lost(true);
                }
            }
            Arriving::Marked => {}
            Arriving::Lost(_) => {
                self.overflow = self.overflow.saturating_add(1);
                self.arriving = Arriving::Lost(true);
            }
        }
    }

    fn terminate(&mut self, byte: u8) {
        if matches!(self.arriving, Arriving::Lost(_)) || self.bytes.push_back(byte).is_err() {
            self.drop_arriving();
            self.overflow = self.overflow.saturating_add(1);
            self.lost = self.lost.saturating_add(1);
            self.arriving = Arriving::Lost(false);
        } else {
            self.whole = self.whole.saturating_add(1);
            self.arriving = Arriving::Stored(0);
        }
    }

    /// Takes what the ring has of the arriving line out of it.
    fn drop_arriving(&mut self) {
        let stored = match self.arriving {
            Arriving::Stored(length) => length,
            Arriving::Marked => 1,
            Arriving::Lost(_) => 0,
        };
        for _ in 0..stored {
            self.bytes.pop_back();
        }
    }

    fn mark(&mut self, mark: u8) {
        self.arriving = if self.bytes.push_back(mark).is_ok() { Arriving::Marked } else { Arriving::Lost(true) };
    }

    /// Bytes of the arriving line were lost or garbled on the way here.
    pub(super) fn damage(&mut self) {
        match self.arriving {
            Arriving::Stored(_) => {
                self.drop_arriving();
                self.mark(DAMAGED);
            }
            Arriving::Marked => {}
            Arriving::Lost(_) => self.arriving = Arriving::Lost(true),
        }
    }

    /// Forgets the arriving line: its sender is gone.
    pub(super) fn forget_arriving(&mut self) {
        self.drop_arriving();
        self.arriving = if self.lost > 0 { Arriving::Lost(false) } else { Arriving::Stored(0) };
    }

    /// Forgets all.
    pub(super) fn clear(&mut self) {
        *self = Self { overflow: self.overflow, ..Self::new() };
    }

    /// The next whole line, its text in `line`; `None` where there is none.
    pub(super) fn take(&mut self, line: &mut Vec<u8, MAX_LINE>) -> Option<Received> {
        line.clear();
        if let Some(rest) = self.whole.checked_sub(1) {
            self.whole = rest;
            return Some(self.read(line));
        }
        self.lost = self.lost.checked_sub(1)?;
        if self.lost == 0 && self.arriving == Arriving::Lost(false) {
            // everything before is answered, and nothing of the line to come was skipped
            self.arriving = Arriving::Stored(0);
        }
        self.carriage_return = false;
        Some(Received::Lost)
    }

    fn read(&mut self, line: &mut Vec<u8, MAX_LINE>) -> Received {
        let mut received = Received::Line;
        while let Some(byte) = self.bytes.pop_front() {
            match byte {
                b'\n' if self.carriage_return && line.is_empty() && received == Received::Line => {
                    self.carriage_return = false;
                    return Received::Nothing;
                }
                b'\r' | b'\n' => {
                    self.carriage_return = byte == b'\r';
                    return received;
                }
                TOO_LONG => received = Received::TooLong,
                DAMAGED => received = Received::Damaged,
                // it fits: longer lines were marked when they arrived
                _ => drop(line.push(byte)),
            }
        }
        received
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use std::string::String;
    use std::vec;

    /// All whole lines: text, or what became of it.
    fn take_all(receiver: &mut Receiver) -> std::vec::Vec<(Received, String)> {
        let mut line = Vec::new();
        let mut all = vec![];
        while let Some(received) = receiver.take(&mut line) {
            all.push((received, String::from_utf8(line.to_vec()).unwrap()));
        }
        all
    }

    fn feed(receiver: &mut Receiver, bytes: &[u8]) {
        bytes.iter().for_each(|byte| receiver.receive(*byte));
    }

    #[test]
    fn each_terminator_closes_a_line() {
        let mut receiver = Receiver::new();
        feed(&mut receiver, b"G0\rX1\n\r\n\nhalf");
        let expected = [
            (Received::Line, "G0"),
            (Received::Line, "X1"),
            (Received::Line, ""),
            (Received::Nothing, ""),
            (Received::Line, ""),
        ];
        assert_eq!(take_all(&mut receiver), expected.map(|(what, text)| (what, text.into())));
        feed(&mut receiver, b" line\n");
        assert_eq!(take_all(&mut receiver), [(Received::Line, "half line".into())]);
    }

    #[test]
    fn a_line_of_the_largest_length_is_read_and_a_longer_one_is_marked() {
        let mut receiver = Receiver::new();
        feed(&mut receiver, &[b'x'; MAX_LINE]);
        feed(&mut receiver, b"\n");
        assert_eq!(take_all(&mut receiver), [(Received::Line, "x".repeat(MAX_LINE))]);
        feed(&mut receiver, &[b'y'; MAX_LINE + 1]);
        assert_eq!(receiver.room(), RECEIVE_BUFFER - 1);
        feed(&mut receiver, &[b'y'; 5 * RECEIVE_BUFFER]);
        feed(&mut receiver, b"\nG1\n");
        assert_eq!(take_all(&mut receiver), [(Received::TooLong, String::new()), (Received::Line, "G1".into())]);
        assert_eq!(receiver.overflow(), 0);
    }

    #[test]
    fn a_full_ring_loses_whole_lines_and_keeps_the_order() {
        let mut receiver = Receiver::new();
        for _ in 0..100 {
            feed(&mut receiver, b"G1 X1 Z1\n");
        }
        let kept = RECEIVE_BUFFER / 9;
        feed(&mut receiver, b"G0 part");
        let all = take_all(&mut receiver);
        assert_eq!(all.len(), 100);
        for (at, (received, text)) in all.iter().enumerate() {
            let expected = if at < kept { (Received::Line, "G1 X1 Z1") } else { (Received::Lost, "") };
            assert_eq!((*received, text.as_str()), expected);
        }
        // the line of which a part was skipped is lost, too, and so is one that follows before it is answered
        feed(&mut receiver, b"ial\nG2\n");
        assert_eq!(take_all(&mut receiver), [(Received::Lost, String::new()), (Received::Lost, String::new())]);
        feed(&mut receiver, b"G3\n");
        assert_eq!(take_all(&mut receiver), [(Received::Line, "G3".into())]);
        assert!(receiver.overflow() > 0);
    }

    #[test]
    fn damaged_lines_are_marked_and_forgotten_ones_are_gone() {
        let mut receiver = Receiver::new();
        feed(&mut receiver, b"G1 X");
        receiver.damage();
        feed(&mut receiver, b"5\nG1 X");
        receiver.forget_arriving();
        feed(&mut receiver, b"G0\n");
        assert_eq!(take_all(&mut receiver), [(Received::Damaged, String::new()), (Received::Line, "G0".into())]);
    }
}
