//! Runs one curve: turns path length into steps and their times.
//!
//! The curve's timeline gives the continuous coordinate of the major axis, in pulses with 16 fraction bits, for a
//! length along the path. Over one stretch of time that coordinate is taken to move evenly; a step is due where it
//! passes the next lattice line. Since the coordinate comes from the length itself and is not summed up, no error
//! grows along the curve; at the end of a zone and of the curve whatever step is still owed is made.

use crate::block::Curve;
use crate::curve::arc::Arc;
use crate::curve::arc_walker::ArcWalker;
use crate::curve::line::LineWalker;
use crate::curve::proportion::Proportion;
use crate::curve::{Step, Walker};
use crate::math::{sine, to_u32, to_u64};
use crate::units::Axis;

/// One pulse in the continuous coordinate.
const PULSE: i64 = 1 << 16;

/// A stretch of time in clocks of the present tick, in which the path advances evenly.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) struct Stretch {
    /// When it begins.
    pub(super) from: u32,
    /// How long it lasts.
    pub(super) clocks: u32,
}

/// Runs a curve from its start to its end.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "one exists a channel, and there is no allocation")]
pub(super) enum Runner {
    /// A line.
    Line(LineRunner),
    /// An arc.
    Arc(ArcRunner),
}

impl Runner {
    /// A runner at the start of `curve`, whose length is `length`.
    pub(super) fn new(curve: &Curve, length: u64) -> Self {
        match curve {
            Curve::Line(line, steps) => {
                Self::Line(LineRunner { walker: line.walk(), steps: *steps, at: 0, next: PULSE })
            }
            Curve::Arc(arc) => Self::Arc(ArcRunner::new(arc, length)),
        }
    }

    /// Advances evenly to `length` from the start during `stretch`; `step` gets the clock and the step.
    pub(super) fn advance(&mut self, length: u64, stretch: Stretch, step: &mut impl FnMut(u32, Step)) {
        match self {
            Self::Line(runner) => runner.advance(length, stretch, step),
            Self::Arc(runner) => runner.advance(length, stretch, step),
        }
    }

    /// Makes the steps that are still owed at the end of the curve.
    pub(super) fn finish(&mut self, clock: u32, step: &mut impl FnMut(u32, Step)) {
        match self {
            Self::Line(runner) => rest(&mut runner.walker, clock, step),
            Self::Arc(runner) => rest(&mut runner.walker, clock, step),
        }
    }
}

fn rest(walker: &mut impl Walker, clock: u32, step: &mut impl FnMut(u32, Step)) {
    while let Some(owed) = walker.next_step() {
        step(clock, owed);
    }
}

/// Times at which an evenly moving coordinate passes lattice lines.
struct Crossings {
    /// Clock of the next crossing, 16 fraction bits.
    time: u64,
    /// Clocks a pulse, 16 fraction bits.
    spacing: u64,
}

impl Crossings {
    /// For a coordinate that goes from `from` to `to` (`to > from`) and passes `next` first.
    #[inline]
    fn new(from: i64, to: i64, next: i64, stretch: Stretch) -> Self {
        let moved = to.wrapping_sub(from).unsigned_abs();
        let spacing = (u64::from(stretch.clocks) << 32).checked_div(moved).unwrap_or(0);
        let first = next.wrapping_sub(from).max(0).unsigned_abs();
        // first <= moved, so the product is at most clocks << 32
        let offset = first.wrapping_mul(spacing) >> 16;
        Self { time: (u64::from(stretch.from) << 16).wrapping_add(offset), spacing }
    }

    #[inline]
    fn next(&mut self) -> u32 {
        #[expect(clippy::cast_possible_truncation, reason = "a clock of one tick, below 2^14")]
        let clock = (self.time >> 16) as u32;
        self.time = self.time.wrapping_add(self.spacing);
        clock
    }
}

/// Runs a line.
#[derive(Clone, Debug)]
pub(super) struct LineRunner {
    walker: LineWalker,
    steps: Proportion,
    /// Continuous coordinate reached.
    at: i64,
    /// Where the next step is due.
    next: i64,
}

impl LineRunner {
    #[inline]
    fn advance(&mut self, length: u64, stretch: Stretch, step: &mut impl FnMut(u32, Step)) {
        let to = self.steps.of(length).cast_signed();
        if self.next <= to {
            let mut crossings = Crossings::new(self.at, to, self.next, stretch);
            while self.next <= to {
                let Some(made) = self.walker.next_step() else { break };
                step(crossings.next(), made);
                self.next = self.next.wrapping_add(PULSE);
            }
        }
        self.at = to;
    }
}

/// Runs an arc, zone by zone.
#[derive(Clone, Debug)]
pub(super) struct ArcRunner {
    walker: ArcWalker,
    arc: Arc,
    length: u64,
    /// Length reached.
    reached: u64,
    /// Length at which the present zone began, and at which it ends.
    zone_from: u64,
    zone_to: u64,
    /// Angle at the zone's start, from the zone's middle, 30 fraction bits.
    angle: i64,
    /// Radius in pulses of the zone's major axis: mantissa and the bits that it lacks of 16 fraction bits.
    radius: i64,
    radius_shift: u32,
    at: i64,
    next: i64,
}

impl ArcRunner {
    fn new(arc: &Arc, length: u64) -> Self {
        let mut runner = Self {
            walker: arc.walk(),
            arc: *arc,
            length,
            reached: 0,
            zone_from: 0,
            zone_to: 0,
            angle: i64::from(arc.timeline.start_angle),
            radius: 0,
            radius_shift: 0,
            at: 0,
            next: 0,
        };
        runner.enter_zone(0, i64::from(arc.timeline.start_angle));
        runner
    }

    /// Sets the zone up that the walker has just entered, `from` along the arc at `angle` from its middle.
    fn enter_zone(&mut self, from: u64, angle: i64) {
        let timeline = &self.arc.timeline;
        let octant = self.walker.octant();
        let [radius_x, radius_z] = timeline.radius_pulses;
        let [half_x, half_z] = timeline.half_width;
        let (radius, half) = match Arc::major(octant) {
            Axis::X => (radius_x, half_x),
            Axis::Z => (radius_z, half_z),
        };
        // keep the product with a sine under 2^63
        let excess = 64_u32.wrapping_sub(radius.leading_zeros()).saturating_sub(32);
        self.radius = radius.wrapping_shr(excess).cast_signed();
        self.radius_shift = excess;
        self.angle = angle;
        self.zone_from = from;
        let span = i64::from(half).wrapping_sub(angle).max(0).unsigned_abs();
        let reach = to_u64((i128::from(timeline.radius)).wrapping_mul(i128::from(span)) >> 30);
        self.zone_to = if self.walker.last_zone() { u64::MAX } else { from.saturating_add(reach) };
        self.at = self.coordinate(from);
        let (x, z) = self.walker.target();
        let [centre_x, centre_z] = timeline.centre;
        let (sign_x, sign_z) = Arc::signs(octant, self.arc.sense);
        let (line, centre, sign) = match Arc::major(octant) {
            Axis::X => (x, centre_x, sign_x),
            Axis::Z => (z, centre_z, sign_z),
        };
        let here = (i64::from(line) << 16).wrapping_sub(centre).wrapping_mul(i64::from(sign));
        let standing = self.walker.position() == self.walker.target();
        self.next = if standing { here.wrapping_add(PULSE) } else { here };
    }

    /// Coordinate of the major axis from the centre in the direction of travel, `length` along the arc.
    fn coordinate(&self, length: u64) -> i64 {
        let turned = self.arc.timeline.angle.of(length.wrapping_sub(self.zone_from)).cast_signed();
        let place = sine(self.angle.wrapping_add(turned)).wrapping_mul(self.radius);
        // 30 fraction bits of the sine go; the shift brings the cut-off bits back
        place.wrapping_shr(30_u32.wrapping_sub(self.radius_shift))
    }

    #[inline]
    fn advance(&mut self, length: u64, stretch: Stretch, step: &mut impl FnMut(u32, Step)) {
        let mut rest = stretch;
        while length >= self.zone_to {
            let clocks =
                share(rest.clocks, self.zone_to.saturating_sub(self.reached), length.saturating_sub(self.reached));
            let part = Stretch { from: rest.from, clocks };
            self.to(self.zone_to, part, step);
            let border = part.from.wrapping_add(clocks);
            rest = Stretch { from: border, clocks: rest.clocks.wrapping_sub(clocks) };
            self.cross(border, step);
        }
        self.to(length, rest, step);
    }

    /// Advances inside the zone.
    #[inline]
    fn to(&mut self, length: u64, stretch: Stretch, step: &mut impl FnMut(u32, Step)) {
        let to = self.coordinate(length);
        if self.next <= to {
            let mut crossings = Crossings::new(self.at, to, self.next, stretch);
            while self.next <= to && self.walker.in_zone() {
                let Some(made) = self.walker.next_step() else { break };
                step(crossings.next(), made);
                self.next = self.next.wrapping_add(PULSE);
            }
        }
        self.at = to;
        self.reached = length;
    }

    /// Leaves the zone at its end: owed steps, then the way over a gap between the zones but for its last step.
    #[cold]
    fn cross(&mut self, clock: u32, step: &mut impl FnMut(u32, Step)) {
        while self.walker.in_zone() {
            let Some(owed) = self.walker.next_step() else { break };
            step(clock, owed);
        }
        if !self.walker.enter_next_zone() {
            self.zone_to = u64::MAX;
            return;
        }
        while self.walker.gap() > 1 {
            let Some(made) = self.walker.joint_step() else { break };
            step(clock, made);
        }
        // the next zone's major axis is the other one, and its near end lies half its width before its middle
        let [half_x, half_z] = self.arc.timeline.half_width;
        let half = match Arc::major(self.walker.octant()) {
            Axis::X => half_x,
            Axis::Z => half_z,
        };
        self.enter_zone(self.zone_to.min(self.length), i64::from(half).wrapping_neg());
    }
}

/// `clocks * part / whole`, at most `clocks`.
fn share(clocks: u32, part: u64, whole: u64) -> u32 {
    let bits = 64_u32.wrapping_sub(whole.leading_zeros()).saturating_sub(48);
    let (part, whole) = (part.wrapping_shr(bits), whole.wrapping_shr(bits).max(1));
    let scaled = u64::from(clocks).wrapping_mul(part).checked_div(whole).unwrap_or(0);
    to_u32(scaled).min(clocks)
}
