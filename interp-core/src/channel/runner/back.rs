//! Runs a curve backward: steps are undone where the path falls below the coordinate that they were due at.
//!
//! Forward a step is made where the continuous coordinate reaches its lattice line. So what is made at a length is a
//! function of that length alone, and going back undoes the last step while the coordinate is below its line: the
//! lattice points come in reverse order, and there and back is home, wherever the sense changes. Zones are left where
//! they were entered. Backward every step is made by itself, without rows.

use super::{ArcRunner, LineRunner, Runner, Sink, lines_back, share};
use crate::block::Curve;
#[cfg(feature = "methods")]
use crate::channel::classic::ClassicRunner;
#[cfg(feature = "methods")]
use crate::channel::conic::ConicRunner;
use crate::curve::Walker;
use crate::curve::arc::Arc;
#[cfg(feature = "methods")]
use crate::curve::method::Method;
use crate::math::to_u64;
use crate::times::{PULSE, Stretch};
use crate::train::Train;
use crate::units::Axis;

impl Runner {
    /// A runner at the end of `curve`, whose length is `length`.
    pub(in crate::channel) fn at_end(curve: &Curve, length: u64) -> Self {
        match curve {
            Curve::Line(line, steps) => {
                let next = i64::from(line.steps().wrapping_add(1)) << 16;
                let at = steps.of(length).cast_signed();
                Self::Line(LineRunner { walker: line.walk_from_end(), steps: *steps, at, next })
            }
            #[cfg(feature = "methods")]
            Curve::Arc(arc) => match arc.method {
                Method::MinimumDeviation | Method::RateMultiplier | Method::Fraction => {
                    Self::Arc(ArcRunner::at_end(arc, length))
                }
                Method::PointComparison | Method::Dda => Self::Classic(ClassicRunner::at_end_of_arc(arc)),
                Method::TimeDivision => Self::Classic(ClassicRunner::at_last_chord(arc)),
            },
            #[cfg(not(feature = "methods"))]
            Curve::Arc(arc) => Self::Arc(ArcRunner::at_end(arc, length)),
            #[cfg(feature = "methods")]
            Curve::ClassicLine(line, pulses, method) => {
                Self::Classic(ClassicRunner::at_end_of_line(*line, *pulses, length, *method))
            }
            #[cfg(feature = "methods")]
            Curve::Conic(piece) => Self::Conic(ConicRunner::at_end(piece, length)),
        }
    }

    /// Goes back evenly to `length` from the start during `stretch`; the steps go to `sink`. At 0 all are undone.
    pub(in crate::channel) fn retreat(&mut self, length: u64, stretch: Stretch, sink: &mut Sink<'_, impl Train>) {
        match self {
            Self::Line(runner) => runner.retreat(length, stretch, sink),
            Self::Arc(runner) => runner.retreat(length, stretch, sink),
            #[cfg(feature = "methods")]
            Self::Classic(runner) => runner.retreat(length, stretch, sink),
            #[cfg(feature = "methods")]
            Self::Conic(runner) => runner.retreat(length, stretch, sink),
        }
    }
}

/// The clock at which a coordinate that falls from `from` to `to` during `stretch` passes `line`.
pub(in crate::channel) fn passed(line: i64, from: i64, to: i64, stretch: Stretch) -> u32 {
    let fallen = |to: i64| from.wrapping_sub(to).max(0).unsigned_abs();
    stretch.from.wrapping_add(share(stretch.clocks, fallen(line), fallen(to)))
}

impl LineRunner {
    fn retreat(&mut self, length: u64, stretch: Stretch, sink: &mut Sink<'_, impl Train>) {
        let to = self.steps.of(length).cast_signed();
        while lines_back(self.next, to) {
            let Some(step) = self.walker.previous_step() else { break };
            self.next = self.next.wrapping_sub(PULSE);
            sink.step(passed(self.next, self.at, to, stretch), step);
        }
        self.at = to;
    }
}

impl ArcRunner {
    fn at_end(arc: &Arc, length: u64) -> Self {
        let mut runner = Self { walker: arc.walk_from_end(), reached: length, ..Self::new(arc, length) };
        runner.enter_from_behind();
        runner.at = runner.coordinate(length);
        runner
    }

    /// Sets the zone up at whose end the walker stands.
    fn enter_from_behind(&mut self) {
        let arc = *self.walker.arc();
        let half = |octant: u8| {
            let [half_x, half_z] = arc.timeline.half_width;
            i64::from(if matches!(Arc::major(octant), Axis::X) { half_x } else { half_z })
        };
        let (mut octant, mut from, mut angle) = (arc.octant, 0_u64, i64::from(arc.timeline.start_angle));
        for _ in 0..self.walker.piece() {
            let after = Arc::octant_after(octant, arc.sense);
            if Arc::ends_at_tangent(octant, arc.sense) {
                from = Self::zone_end(&arc, from, half(octant).wrapping_sub(angle)).min(self.length);
                angle = half(after).wrapping_neg();
            }
            octant = after;
        }
        self.enter_zone(from, angle);
    }

    /// Where a zone ends that begins at `from` and turns by `span`.
    pub(super) fn zone_end(arc: &Arc, from: u64, span: i64) -> u64 {
        let span = span.max(0).unsigned_abs();
        from.saturating_add(to_u64(i128::from(arc.timeline.radius).wrapping_mul(i128::from(span)) >> 30))
    }

    fn retreat(&mut self, length: u64, stretch: Stretch, sink: &mut Sink<'_, impl Train>) {
        let mut rest = stretch;
        while length < self.zone_from {
            let clocks =
                share(rest.clocks, self.reached.saturating_sub(self.zone_from), self.reached.saturating_sub(length));
            let part = Stretch { from: rest.from, clocks };
            self.back_to(self.zone_from, part, sink);
            let border = part.from.wrapping_add(clocks);
            rest = Stretch { from: border, clocks: rest.clocks.wrapping_sub(clocks) };
            self.cross_back(border, sink);
        }
        self.back_to(length, rest, sink);
        if length == 0 {
            let clock = rest.from.wrapping_add(rest.clocks);
            while let Some(owed) = self.walker.previous_step() {
                self.next = self.next.wrapping_sub(PULSE);
                sink.step(clock, owed);
            }
        }
    }

    /// Goes back inside the zone.
    fn back_to(&mut self, length: u64, stretch: Stretch, sink: &mut Sink<'_, impl Train>) {
        let to = self.coordinate(length);
        while lines_back(self.next, to) && !self.walker.at_zone_start() {
            let Some(step) = self.walker.previous_step() else { break };
            self.next = self.next.wrapping_sub(PULSE);
            sink.step(passed(self.next, self.at, to, stretch), step);
        }
        self.at = to;
        self.reached = length;
    }

    /// Leaves the zone at its start: the steps still made in it, then the way over a gap but for its last step.
    fn cross_back(&mut self, clock: u32, sink: &mut Sink<'_, impl Train>) {
        while !self.walker.at_zone_start() {
            let Some(step) = self.walker.previous_step() else { break };
            sink.step(clock, step);
        }
        while let Some(step) = self.walker.joint_step_back() {
            sink.step(clock, step);
        }
        let border = self.zone_from;
        self.walker.enter_octant_before();
        self.enter_from_behind();
        // octants without a step may lie between: the border is that of the zone that was left
        self.at = self.coordinate(border);
        self.reached = border;
    }
}
