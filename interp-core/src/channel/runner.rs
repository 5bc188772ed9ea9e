//! Runs one curve: turns path length into steps and their times.
//!
//! The curve's timeline gives the continuous coordinate of the major axis, in pulses with 16 fraction bits, for a
//! length along the path. Over one stretch of time that coordinate is taken to move evenly; a step is due where it
//! passes the next lattice line. Since the coordinate comes from the length itself and is not summed up, no error
//! grows along the curve; at the end of a zone and of the curve whatever step is still owed is made.

mod back;

#[cfg(feature = "methods")]
pub(super) use back::passed;

#[cfg(feature = "methods")]
use super::classic::{ChordRunner, ClassicRunner};
#[cfg(feature = "methods")]
use super::conic::ConicRunner;
use super::superposed::Superposed;
use crate::block::Curve;
use crate::curve::arc::Arc;
use crate::curve::arc_row::Word;
use crate::curve::arc_walker::ArcWalker;
use crate::curve::line::LineWalker;
#[cfg(feature = "methods")]
use crate::curve::method::Method;
use crate::curve::proportion::Proportion;
use crate::curve::strides::{Strides, Turns};
use crate::curve::{Step, Walker};
use crate::math::{shifted_signed, sine, to_u32};
use crate::shaper::{Made, Shaper};
use crate::times::{PULSE, Stretch, Times};
use crate::train::Train;
use crate::units::{Axis, Lattice};

/// Where steps go: the shaper and the position.
pub(super) struct Sink<'s, O> {
    /// Makes events of them.
    pub(super) shaper: &'s mut Shaper,
    /// Where they lead.
    pub(super) position: &'s mut Lattice,
    /// What is added to them.
    pub(super) superposed: &'s mut Superposed,
    /// Takes the events.
    pub(super) out: &'s mut O,
}

impl<O: Train> Sink<'_, O> {
    /// One step, at a clock or as soon after as the pins allow.
    pub(super) fn step(&mut self, clock: u32, step: Step) {
        if self.superposed.is_live() {
            self.superposed.step(clock, step, self.shaper, self.out);
        } else {
            self.shaper.step(clock, step.x, step.z, self.out);
        }
        self.position.x = self.position.x.wrapping_add(i32::from(step.x));
        self.position.z = self.position.z.wrapping_add(i32::from(step.z));
    }

    /// How many of `count` steps of two kinds, and as which kinds, may be made in a row as far as something is added.
    #[inline(always)]
    fn room(
        &mut self,
        times: &Times,
        count: u32,
        strides: Strides,
        straight: impl FnOnce(u32) -> u32,
    ) -> (u32, Strides) {
        if self.superposed.is_live() {
            self.superposed.room(times, count, &strides, straight, self.shaper, self.out)
        } else {
            (count, strides)
        }
    }

    /// Up to `count` steps of two kinds, as far as they can be made in a row; the position has to be [moved](Self::moved).
    #[inline(always)]
    fn row(&mut self, times: &mut Times, count: u32, strides: &Strides, turns: &mut impl Turns) -> Made {
        if count == 0 {
            return Made { steps: 0, diagonals: 0 };
        }
        self.shaper.run(times, count, strides, turns, !self.superposed.is_live(), self.out)
    }

    /// What a row leads by.
    #[inline(always)]
    fn moved(&mut self, (x, z): (i32, i32)) {
        self.position.x = self.position.x.wrapping_add(x);
        self.position.z = self.position.z.wrapping_add(z);
    }
}

/// Lattice lines from `next` to `to`, `next <= to`.
#[inline]
pub(super) fn lines(next: i64, to: i64) -> u32 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a curve has less than 2^30 steps")]
    let count = (to.wrapping_sub(next) >> 16) as u32;
    count.wrapping_add(1)
}

/// Whether the last step, due a pulse before `next`, is to be undone where the coordinate falls to `to`.
#[inline]
const fn lines_back(next: i64, to: i64) -> bool {
    next.wrapping_sub(PULSE) > to
}

/// The lattice line `count` further.
#[inline]
pub(super) fn further(next: i64, count: u32) -> i64 {
    next.wrapping_add(i64::from(count) << 16)
}

/// Runs a curve from its start to its end.
#[derive(Clone, Debug)]
#[cfg_attr(
    not(feature = "methods"),
    expect(clippy::large_enum_variant, reason = "one exists a channel, and there is no allocation")
)]
pub(super) enum Runner {
    /// A line.
    Line(LineRunner),
    /// An arc.
    Arc(ArcRunner),
    /// A line or an arc by a classic method.
    #[cfg(feature = "methods")]
    Classic(super::classic::ClassicRunner),
    /// A part of an ellipse or a parabola.
    #[cfg(feature = "methods")]
    Conic(ConicRunner),
}

impl Runner {
    /// A runner at the start of `curve`, whose length is `length`.
    pub(super) fn new(curve: &Curve, length: u64) -> Self {
        match curve {
            Curve::Line(line, steps) => {
                Self::Line(LineRunner { walker: line.walk(), steps: *steps, at: 0, next: PULSE })
            }
            #[cfg(feature = "methods")]
            Curve::Arc(arc) => match arc.method {
                Method::MinimumDeviation | Method::RateMultiplier | Method::Fraction => {
                    Self::Arc(ArcRunner::new(arc, length))
                }
                Method::PointComparison => Self::Classic(ClassicRunner::compared(arc)),
                Method::Dda => Self::Classic(ClassicRunner::integrated(arc)),
                Method::TimeDivision => Self::Classic(ClassicRunner::Chords(ChordRunner::new(arc))),
            },
            #[cfg(not(feature = "methods"))]
            Curve::Arc(arc) => Self::Arc(ArcRunner::new(arc, length)),
            #[cfg(feature = "methods")]
            Curve::ClassicLine(line, pulses, method) => Self::Classic(ClassicRunner::line(*line, *pulses, *method)),
            #[cfg(feature = "methods")]
            Curve::Conic(piece) => Self::Conic(ConicRunner::new(piece)),
        }
    }

    /// Advances evenly to `length` from the start during `stretch`; the steps go to `sink`.
    pub(super) fn advance(&mut self, length: u64, stretch: Stretch, sink: &mut Sink<'_, impl Train>) {
        match self {
            Self::Line(runner) => runner.advance(length, stretch, sink),
            Self::Arc(runner) => runner.advance(length, stretch, sink),
            #[cfg(feature = "methods")]
            Self::Classic(runner) => runner.advance(length, stretch, sink),
            #[cfg(feature = "methods")]
            Self::Conic(runner) => runner.advance(length, stretch, sink),
        }
    }

    /// Makes the steps that are still owed at the end of the curve.
    pub(super) fn finish(&mut self, clock: u32, sink: &mut Sink<'_, impl Train>) {
        match self {
            Self::Line(runner) => rest(&mut runner.walker, clock, sink),
            Self::Arc(runner) => rest(&mut runner.walker, clock, sink),
            #[cfg(feature = "methods")]
            Self::Classic(runner) => runner.finish(clock, sink),
            #[cfg(feature = "methods")]
            Self::Conic(runner) => runner.finish(clock, sink),
        }
    }
}

pub(super) fn rest(walker: &mut impl Walker, clock: u32, sink: &mut Sink<'_, impl Train>) {
    while let Some(owed) = walker.next_step() {
        sink.step(clock, owed);
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
    fn advance(&mut self, length: u64, stretch: Stretch, sink: &mut Sink<'_, impl Train>) {
        let to = self.steps.of(length).cast_signed();
        if self.next <= to {
            let mut times = Times::new(self.at, to, self.next, stretch);
            let mut due = lines(self.next, to).min(self.walker.left());
            self.next = further(self.next, due);
            while due > 0 {
                let mut row = Made { steps: 0, diagonals: 0 };
                let walker = &self.walker;
                let (room, strides) = sink.room(&times, due, walker.strides(), |most| walker.straight(most));
                self.walker.row(|turns| {
                    row = sink.row(&mut times, room, &strides, turns);
                    row.steps
                });
                sink.moved(strides.lead(row.steps, row.diagonals));
                let mut made = row.steps;
                if made == 0 {
                    let Some(step) = self.walker.next_step() else { break };
                    sink.step(times.take(), step);
                    made = 1;
                }
                due = due.wrapping_sub(made);
            }
        }
        self.at = to;
    }
}

/// Runs an arc, zone by zone.
#[derive(Clone, Debug)]
pub(super) struct ArcRunner {
    walker: ArcWalker,
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
        let timeline = &self.walker.arc().timeline;
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
        let end = Self::zone_end(self.walker.arc(), from, i64::from(half).wrapping_sub(angle));
        self.zone_to = if self.walker.last_zone() { u64::MAX } else { end };
        self.at = self.coordinate(from);
        let (x, z) = self.walker.target();
        let [centre_x, centre_z] = timeline.centre;
        let (sign_x, sign_z) = Arc::signs(octant, self.walker.arc().sense);
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
        let turned = self.walker.arc().timeline.angle.of(length.wrapping_sub(self.zone_from)).cast_signed();
        let place = sine(self.angle.wrapping_add(turned)).wrapping_mul(self.radius);
        // 30 fraction bits of the sine go; the shift brings the cut-off bits back
        shifted_signed(place, 30_u32.wrapping_sub(self.radius_shift))
    }

    #[inline]
    fn advance(&mut self, length: u64, stretch: Stretch, sink: &mut Sink<'_, impl Train>) {
        let mut rest = stretch;
        loop {
            let crosses = length >= self.zone_to;
            let clocks = if crosses {
                share(rest.clocks, self.zone_to.saturating_sub(self.reached), length.saturating_sub(self.reached))
            } else {
                rest.clocks
            };
            self.to(length.min(self.zone_to), Stretch { from: rest.from, clocks }, sink);
            if !crosses {
                return;
            }
            let border = rest.from.wrapping_add(clocks);
            rest = Stretch { from: border, clocks: rest.clocks.wrapping_sub(clocks) };
            self.cross(border, sink);
        }
    }

    /// Advances inside the zone.
    #[inline(always)]
    fn to(&mut self, length: u64, stretch: Stretch, sink: &mut Sink<'_, impl Train>) {
        let to = self.coordinate(length);
        if self.next <= to {
            let mut times = Times::new(self.at, to, self.next, stretch);
            while self.next <= to {
                let mut made = row(&mut self.walker, lines(self.next, to), &mut times, sink);
                if made == 0 {
                    if !self.walker.in_zone() {
                        break;
                    }
                    let Some(step) = self.walker.next_step() else { break };
                    sink.step(times.take(), step);
                    made = 1;
                }
                self.next = further(self.next, made);
            }
        }
        self.at = to;
        self.reached = length;
    }

    /// Leaves the zone at its end: owed steps, then the way over a gap between the zones but for its last step.
    #[cold]
    fn cross(&mut self, clock: u32, sink: &mut Sink<'_, impl Train>) {
        while self.walker.in_zone() {
            let Some(owed) = self.walker.next_step() else { break };
            sink.step(clock, owed);
        }
        if !self.walker.enter_next_zone() {
            self.zone_to = u64::MAX;
            return;
        }
        while self.walker.gap() > 1 {
            let Some(made) = self.walker.joint_step() else { break };
            sink.step(clock, made);
        }
        // the next zone's major axis is the other one, and its near end lies half its width before its middle
        let [half_x, half_z] = self.walker.arc().timeline.half_width;
        let half = match Arc::major(self.walker.octant()) {
            Axis::X => half_x,
            Axis::Z => half_z,
        };
        self.enter_zone(self.zone_to.min(self.length), i64::from(half).wrapping_neg());
    }
}

/// Makes up to `due` steps of the octant in a row.
#[inline]
pub(super) fn row(walker: &mut ArcWalker, due: u32, times: &mut Times, sink: &mut Sink<'_, impl Train>) -> u32 {
    let due = due.min(walker.left_in_row());
    if due == 0 {
        return 0;
    }
    let (room, strides) = sink.room(times, due, walker.strides(), |most| walker.straight(most));
    if walker.is_narrow() {
        row_in::<i32>(walker, room, &strides, times, sink)
    } else {
        row_in::<i64>(walker, room, &strides, times, sink)
    }
}

/// The same with the recurrence in words of one size.
#[inline(always)]
fn row_in<W: Word>(
    walker: &mut ArcWalker,
    room: u32,
    strides: &Strides,
    times: &mut Times,
    sink: &mut Sink<'_, impl Train>,
) -> u32 {
    let mut steps = 0;
    let lead = walker.row::<W>(|row| {
        let made = sink.row(times, room, strides, row);
        steps = made.steps;
        (made.steps, made.diagonals)
    });
    sink.moved(lead);
    steps
}

/// `clocks * part / whole`, at most `clocks`.
pub(super) fn share(clocks: u32, part: u64, whole: u64) -> u32 {
    let bits = 64_u32.wrapping_sub(whole.leading_zeros()).saturating_sub(48);
    let (part, whole) = (part.wrapping_shr(bits), whole.wrapping_shr(bits).max(1));
    let scaled = u64::from(clocks).wrapping_mul(part).checked_div(whole).unwrap_or(0);
    to_u32(scaled).min(clocks)
}
