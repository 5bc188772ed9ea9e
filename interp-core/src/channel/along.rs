//! The part of a path that the contour wheel may drive: between two lengths along it.
//!
//! They end it as the path's own ends do: the governor brakes for them, what the wheel asks for beyond is dropped and told, and
//! what pulls stands there. So a path has shoulders, and can be led back to a place.

use super::{Channel, Memory};
use core::borrow::BorrowMut;

/// Where the wheel has led, and may lead. Lengths from where the path was when the wheel became its drive, nm with 12 fraction bits,
/// negative behind it.
#[derive(Copy, Clone, Debug)]
pub(super) struct Along {
    at: i64,
    least: i64,
    most: i64,
}

impl Along {
    /// At 0, without ends.
    pub(super) const fn new() -> Self {
        Self { at: 0, least: i64::MIN >> 2, most: i64::MAX >> 2 }
    }

    /// The path went on by so much.
    pub(super) const fn went(&mut self, by: i64) {
        self.at = self.at.wrapping_add(by);
    }

    /// Room in a sense.
    pub(super) const fn room(&self, back: bool) -> u64 {
        let room = if back { self.at.wrapping_sub(self.least) } else { self.most.wrapping_sub(self.at) };
        if room < 0 { 0 } else { room.unsigned_abs() }
    }
}

impl<const N: usize, M: BorrowMut<Memory<N>>> Channel<N, M> {
    /// Where the contour wheel, or what pulls in its place, has led the path: its length from where the wheel became the drive,
    /// nm with 12 fraction bits, negative behind.
    pub const fn along(&self) -> i64 {
        self.crank.along.at
    }

    /// Sets how far the wheel may lead the path, to be called while that stands or with a wider range: lengths like those of [`along`](Self::along), with
    /// the present one between them. Another drive, and another path, have no ends.
    pub const fn set_ends(&mut self, least: i64, most: i64) {
        self.crank.along.least = least;
        self.crank.along.most = most;
    }
}
