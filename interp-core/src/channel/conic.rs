//! Runs a part of an ellipse or a parabola, both ways.
//!
//! Like an arc's zone: a step is due where the major coordinate of the timeline passes the next lattice line. The steps of
//! a joint, one or two, are due evenly up to the line that it leads to. Backward the last step is undone where the
//! coordinate falls below the line that it was due at.

use super::runner::passed;
use super::runner::{Sink, lines, row};
use crate::curve::Walker;
use crate::curve::arc_walker::ArcWalker;
use crate::curve::conic_piece::ConicPiece;
use crate::times::{Stretch, Times};
use crate::train::Train;

/// Runs a part of a conic.
#[derive(Clone, Debug)]
pub(super) struct ConicRunner {
    piece: ConicPiece,
    walker: ArcWalker,
    /// Steps made, those of the joint among them.
    made: u32,
    /// Coordinate at the start, and from one step of the joint to the next.
    start: i64,
    spacing: i64,
    at: i64,
}

impl ConicRunner {
    /// At the start of a part.
    pub(super) fn new(piece: &ConicPiece) -> Self {
        let start = piece.coordinate(0);
        let way = piece.target().wrapping_sub(start).max(0);
        let spacing = way.checked_div(i64::from(piece.gap())).unwrap_or(0);
        Self { piece: *piece, walker: piece.walk(), made: 0, start, spacing, at: start }
    }

    /// At the end of a part of this length.
    pub(super) fn at_end(piece: &ConicPiece, length: u64) -> Self {
        let (walker, made) = (piece.walk_from_end(), piece.gap().wrapping_add(piece.steps()));
        Self { walker, made, at: piece.coordinate(length), ..Self::new(piece) }
    }

    /// Where the step with this number, from 1, is due.
    fn due(&self, number: u32) -> i64 {
        match number.checked_sub(self.piece.gap()) {
            Some(behind) if behind > 0 => self.piece.target().wrapping_add(i64::from(behind) << 16),
            _ => self.start.wrapping_add(self.spacing.wrapping_mul(i64::from(number))),
        }
    }

    fn next(&self) -> i64 {
        self.due(self.made.wrapping_add(1))
    }

    /// Advances evenly to `length` from the start during `stretch`.
    pub(super) fn advance(&mut self, length: u64, stretch: Stretch, sink: &mut Sink<'_, impl Train>) {
        let to = self.piece.coordinate(length);
        while self.made < self.piece.gap() && self.next() <= to {
            let mut times = Times::new(self.at, to, self.next(), stretch);
            let Some(step) = self.walker.next_step() else { break };
            sink.step(times.take(), step);
            self.made = self.made.wrapping_add(1);
        }
        if self.made >= self.piece.gap() && self.next() <= to {
            let mut times = Times::new(self.at, to, self.next(), stretch);
            while self.next() <= to {
                let due = lines(self.next(), to);
                let mut made = row(&mut self.walker, due, &mut times, sink);
                if made == 0 {
                    let Some(step) = self.walker.next_step() else { break };
                    sink.step(times.take(), step);
                    made = 1;
                }
                self.made = self.made.wrapping_add(made);
            }
        }
        self.at = to;
    }

    /// Goes back evenly to `length` from the start during `stretch`. At 0 all steps are undone.
    pub(super) fn retreat(&mut self, length: u64, stretch: Stretch, sink: &mut Sink<'_, impl Train>) {
        let to = self.piece.coordinate(length);
        while self.made > 0 && (length == 0 || self.due(self.made) > to) {
            let Some(step) = self.walker.previous_step() else { break };
            sink.step(passed(self.due(self.made).max(to), self.at, to, stretch), step);
            self.made = self.made.wrapping_sub(1);
        }
        self.at = to;
    }

    /// Makes the steps that are still owed at the end.
    pub(super) fn finish(&mut self, clock: u32, sink: &mut Sink<'_, impl Train>) {
        while let Some(step) = self.walker.next_step() {
            sink.step(clock, step);
            self.made = self.made.wrapping_add(1);
        }
    }
}
