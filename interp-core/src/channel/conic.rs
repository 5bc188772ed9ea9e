//! Runs a part of an ellipse or a parabola.
//!
//! Like an arc's zone: a step is due where the major coordinate of the timeline passes the next lattice line. The steps of
//! a joint, one or two, are due evenly up to the line that it leads to.

use super::runner::{Sink, further, lines, row};
use crate::curve::Walker;
use crate::curve::arc_walker::ArcWalker;
use crate::curve::conic_piece::ConicPiece;
use crate::times::{PULSE, Stretch, Times};
use crate::train::Train;

/// Runs a part of a conic.
#[derive(Clone, Debug)]
pub(super) struct ConicRunner {
    piece: ConicPiece,
    walker: ArcWalker,
    /// Steps of the joint that are left, and from one to the next.
    joint: u32,
    spacing: i64,
    at: i64,
    next: i64,
}

impl ConicRunner {
    /// At the start of a part.
    pub(super) fn new(piece: &ConicPiece) -> Self {
        let (at, joint) = (piece.coordinate(0), piece.gap());
        let way = piece.target().wrapping_sub(at).max(0);
        let spacing = way.checked_div(i64::from(joint)).unwrap_or(0);
        let next = if joint > 0 { at.wrapping_add(spacing) } else { PULSE };
        Self { piece: *piece, walker: piece.walk(), joint, spacing, at, next }
    }

    /// Advances evenly to `length` from the start during `stretch`.
    pub(super) fn advance(&mut self, length: u64, stretch: Stretch, sink: &mut Sink<'_, impl Train>) {
        let to = self.piece.coordinate(length);
        while self.joint > 0 && self.next <= to {
            let mut times = Times::new(self.at, to, self.next, stretch);
            let Some(step) = self.walker.next_step() else { break };
            sink.step(times.take(), step);
            self.joint = self.joint.wrapping_sub(1);
            self.next =
                if self.joint > 0 { self.next.wrapping_add(self.spacing) } else { further(self.piece.target(), 1) };
        }
        if self.joint == 0 && self.next <= to {
            let mut times = Times::new(self.at, to, self.next, stretch);
            while self.next <= to {
                let mut made = row(&mut self.walker, lines(self.next, to), &mut times, sink);
                if made == 0 {
                    let Some(step) = self.walker.next_step() else { break };
                    sink.step(times.take(), step);
                    made = 1;
                }
                self.next = further(self.next, made);
            }
        }
        self.at = to;
    }

    /// Makes the steps that are still owed at the end.
    pub(super) fn finish(&mut self, clock: u32, sink: &mut Sink<'_, impl Train>) {
        super::runner::rest(&mut self.walker, clock, sink);
    }
}
