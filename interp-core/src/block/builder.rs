//! The builder: motions of programmed curves.
//!
//! It rounds end points to the lattice, prepares the curve between rounded ends, and works out what the machine allows
//! on it: the speed that no axis's maximum is passed at, the acceleration, and the speed at which the joint with the
//! block before may be taken without an axis jumping by more than its `max_jump`. It runs in the background.

use super::again::Source;
use super::{ArcRefusal, Built, Curve, Feed, Limited, Motion, Pace, Path, Speed, Split, split};
use crate::config::{FRACTION_BITS, Machine, speed_of};
use crate::curve::arc::Arc;
use crate::curve::line::Line;
use crate::curve::method::Method;
use crate::curve::prepare_arc::{Metric, Prepared, Reach, Turn};
use crate::curve::proportion::Proportion;
use crate::math::{RADIAN_Q30, Wide, root_wide, scale, to_i64, to_u32, to_u64};
use crate::units::{Axis, Lattice, Length, Point, Sense};

/// A direction: X and Z parts of a unit vector, 30 fraction bits.
pub(super) type Direction = (i64, i64);

/// Makes blocks of programmed curves.
#[derive(Clone, Debug)]
pub struct Builder {
    pub(super) machine: Machine,
    pub(super) metric: Metric,
    /// Programmed position.
    pub(super) at: Point,
    pub(super) lattice: Lattice,
    /// Direction in which the last motion ended; `None` after a standstill.
    heading: Option<Direction>,
    /// The last motion was part of a thread.
    in_thread: bool,
}

/// Thousandths of its acceleration that an arc's curvature may take: at most sqrt(0.998 a R), so that a sixteenth of the
/// acceleration is always left to brake with.
pub(super) const CURVATURE_SHARE: u128 = 998;

impl Builder {
    /// A builder that stands at `at`.
    pub fn new(machine: &Machine, at: Point) -> Self {
        let lattice = Lattice { x: machine.x.pulse.nearest(at.x), z: machine.z.pulse.nearest(at.z) };
        let metric = Metric::new(machine.x.pulse, machine.z.pulse);
        Self { machine: *machine, metric, at, lattice, heading: None, in_thread: false }
    }

    /// Where the last curve ended, as programmed.
    pub const fn programmed(&self) -> Point {
        self.at
    }

    /// Where the last curve ended, rounded.
    pub const fn lattice(&self) -> Lattice {
        self.lattice
    }

    /// The method that the machine asks for.
    pub const fn method(&self) -> Method {
        self.machine.method
    }

    /// Whether arcs are walked by minimum deviation in place of the method that the machine asks for.
    pub const fn arcs_fall_back(&self) -> bool {
        !self.machine.method.serves_arcs()
    }

    /// Notes that the tool comes to a standstill here.
    pub const fn standstill(&mut self) {
        self.heading = None;
    }

    /// Makes the blocks of one programmed curve.
    pub fn motion(&mut self, path: Path, end: Point, pace: Pace) -> Built {
        let mut built = Built::default();
        if matches!(path, Path::Arc { centre, .. } if self.too_small(centre)) {
            built.refused = Some(ArcRefusal::TooSmall);
            return built;
        }
        let Path::Arc { centre, sense } = path else {
            self.line(end, pace, &mut built);
            return built;
        };
        let (from, split) = (self.at, self.split(end, centre, sense));
        match split {
            Split::Halves(middle) => {
                self.arc(middle, centre, sense, Reach::Short, pace, &mut built);
                self.arc(end, centre, sense, Reach::Short, pace, &mut built);
                if let [first, second] = built.motions.as_mut_slice() {
                    first.continues = true;
                    // one speed for the one curve that was programmed
                    let limit = first.limit.min(second.limit);
                    for half in [first, second] {
                        if half.limit != limit {
                            (half.limit, half.source) = (limit, half.source.shared());
                        }
                    }
                }
            }
            Split::Whole(reach) => self.arc(end, centre, sense, reach, pace, &mut built),
            Split::OutOfRange => built.refused = Some(ArcRefusal::OutOfRange),
        }
        // a short one may round to nothing, as a line may; who programs a turn wants to see one
        if split != Split::Whole(Reach::Short) && built.motions.is_empty() && built.refused.is_none() {
            built.refused = Some(ArcRefusal::NoPulse);
            self.at = from;
        }
        built
    }

    /// Whether an arc from here about `centre` is [`ArcRefusal::TooSmall`].
    fn too_small(&self, centre: (i64, i64)) -> bool {
        let (x, z) = self.span(1, 1);
        let (finer, coarser) = (x.min(z), x.max(z));
        let off = |at: Length, centre: i64| i128::from(i64::from(at.nm()).wrapping_sub(centre)) << FRACTION_BITS;
        let radius = length(off(self.at.x, centre.0), off(self.at.z, centre.1));
        coarser > finer.saturating_mul(4) && radius < coarser.saturating_mul(3)
    }

    pub(super) fn rounded(&self, end: Point) -> Lattice {
        Lattice { x: self.machine.x.pulse.nearest(end.x), z: self.machine.z.pulse.nearest(end.z) }
    }

    /// Displacement of (`x`, `z`) pulses in nm with 12 fraction bits.
    pub(super) fn span(&self, x: i32, z: i32) -> (i128, i128) {
        let place = |pulse: crate::units::PulseSize, n: i32| {
            scale(i128::from(n), i128::from(pulse.numerator()) << FRACTION_BITS, i128::from(pulse.denominator()))
        };
        (place(self.machine.x.pulse, x), place(self.machine.z.pulse, z))
    }

    fn line(&mut self, end: Point, pace: Pace, built: &mut Built) {
        let to = self.rounded(end);
        self.at = end;
        let (x, z) = (to.x.wrapping_sub(self.lattice.x), to.z.wrapping_sub(self.lattice.z));
        let Some(line) = Line::new(x, z) else { return };
        self.lattice = to;
        let (curve, run) = self.straight(line, self.reach(line));
        self.finish(curve, &run, pace, Source::Line, built);
    }

    /// How far a line leads: X and Z in nm with 12 fraction bits, and its length.
    pub(super) fn reach(&self, line: Line) -> (i128, i128, u64) {
        let (dx, dz) = self.span(line.end().0, line.end().1);
        let square = dx.squared().saturating_add(dz.squared());
        (dx, dz, root_wide(square.unsigned_abs()).max(1))
    }

    /// What a line that leads so far and the machine make of a motion.
    pub(super) fn straight(&self, line: Line, (dx, dz, length): (i128, i128, u64)) -> (Curve, Run) {
        let part = |d: i128| to_i64(scale(d, i128::from(RADIAN_Q30), i128::from(length)));
        let heading = (part(dx), part(dz));
        let by_axis = self.speed_limit(heading);
        let accel = Self::least(self.machine.x.accel, self.machine.z.accel, heading).0;
        let steps = Proportion::new(u64::from(line.steps()) << 16, length, length);
        let reach = to_u64(dx.saturating_abs().max(dz.saturating_abs())).max(1);
        let run = Run { length, reach, entry: heading, exit: heading, by_axis, by_bend: Speed::MAX, accel };
        #[cfg(feature = "methods")]
        let curve = match self.machine.method {
            // a line is its own chord
            Method::MinimumDeviation | Method::TimeDivision => Curve::Line(line, steps),
            method => Curve::ClassicLine(line, steps, method),
        };
        #[cfg(not(feature = "methods"))]
        let curve = Curve::Line(line, steps);
        (curve, run)
    }

    /// How an arc to `end` is walked: a long one whole where that moves its centre by at most a 16th of a coarser
    /// pulse, else as two.
    fn split(&self, end: Point, centre: (i64, i64), sense: Sense) -> Split {
        let halves = split(self.at, end, centre, sense);
        if matches!(halves, Split::Whole(_)) {
            return halves;
        }
        let to = self.rounded(end);
        // from the programmed centre to the rounded ends, nm with 12 fraction bits
        let from = |at: Lattice| {
            let (x, z) = self.span(at.x, at.z);
            (x.wrapping_sub(i128::from(centre.0) << 12), z.wrapping_sub(i128::from(centre.1) << 12))
        };
        let ((sx, sz), (ex, ez)) = (from(self.lattice), from(to));
        let (radius_s, radius_e) = (length(sx << 8, sz << 8), length(ex << 8, ez << 8));
        let chord = length(ex.wrapping_sub(sx), ez.wrapping_sub(sz));
        let (px, pz) = self.span(1, 1);
        // the centre moves along the chord by (r1 - r0) R / chord
        let moved = radius_e.wrapping_sub(radius_s).saturating_abs().saturating_mul(radius_s >> 8);
        let allowed = chord.saturating_mul(px.max(pz) << 4);
        if moved <= allowed { Split::Whole(Reach::Long) } else { halves }
    }

    fn arc(&mut self, end: Point, centre: (i64, i64), sense: Sense, reach: Reach, pace: Pace, built: &mut Built) {
        let to = self.rounded(end);
        match self.metric.arc(self.lattice, to, centre, sense, reach) {
            Prepared::Nothing => self.at = end,
            Prepared::Chord => self.line(end, pace, built),
            Prepared::Arc(arc, turn) => {
                let source = Source::Arc { round: self.metric.round(self.lattice, centre, reach), shared: false };
                self.at = end;
                self.lattice = to;
                let (curve, run) = self.bent(arc, Bearings::of(&turn));
                self.finish(curve, &run, pace, source, built);
            }
        }
    }

    /// What an arc and the machine make of a motion.
    pub(super) fn bent(&self, arc: Arc, Bearings { entry, exit, extent }: Bearings) -> (Curve, Run) {
        let by_axis = self.speed_limit(extent);
        let accel = self.machine.x.accel.min(self.machine.z.accel);
        // v^2 = 0.998 a R; both sides with 24 fraction bits
        let square = u128::from(accel).wrapping_mul(u128::from(arc.radius()));
        let by_bend = to_u32(root_wide(square.wrapping_mul(CURVATURE_SHARE) / 1000));
        let length = arc.length().max(1);
        let run = Run { length, reach: length, entry, exit, by_axis, by_bend, accel };
        (Curve::Arc(Arc { method: self.machine.method, ..arc }), run)
    }

    /// The largest value along a direction whose parts stay within `x` and `z`, and the axis that sets it.
    pub(crate) fn least(x: u32, z: u32, (ux, uz): Direction) -> (u32, Axis) {
        let along = |limit: u32, part: i64| {
            let part = part.unsigned_abs();
            (u64::from(limit) << 30).checked_div(part).unwrap_or(u64::MAX)
        };
        let (by_x, by_z) = (along(x, ux), along(z, uz));
        let axis = if by_x < by_z { Axis::X } else { Axis::Z };
        (to_u32(by_x.min(by_z)), axis)
    }

    pub(super) fn speed_limit(&self, heading: Direction) -> (Speed, Axis) {
        Self::least(self.machine.x.speed, self.machine.z.speed, heading)
    }

    /// The speed at which no axis jumps by more than it may where the direction changes.
    pub(super) fn corner(&self, before: Direction, after: Direction) -> Speed {
        let change = (after.0.wrapping_sub(before.0), after.1.wrapping_sub(before.1));
        Self::least(self.machine.x.jump, self.machine.z.jump, change).0
    }

    fn finish(&mut self, curve: Curve, run: &Run, pace: Pace, source: Source, built: &mut Built) {
        let feed = match pace {
            Pace::Rapid => Feed::Rapid,
            Pace::Feed(feed) => Feed::PerTick(speed_of(feed)),
            Pace::PerTurn(lead) => Feed::PerTurn(lead),
            Pace::Thread { lead, start } => Feed::Thread(lead.stretched(run.length, run.reach), start),
        };
        let joint = match self.heading {
            // a thread begins and ends in standstill: its drive is another one
            Some(_) if feed.is_thread() != self.in_thread => 0,
            Some(before) => self.corner(before, run.entry),
            None => Speed::MAX,
        };
        self.in_thread = feed.is_thread();
        let (speed, axis) = run.by_axis;
        if matches!(feed, Feed::PerTick(feed) if feed > speed) && built.limited.is_none() {
            built.limited = Some(Limited { axis, speed });
        }
        self.heading = Some(run.exit);
        // at most two motions a curve: the capacity
        let _ = built.motions.push(self.motion_of(curve, run, feed, joint, source));
    }

    pub(super) fn motion_of(&self, curve: Curve, run: &Run, feed: Feed, joint: Speed, source: Source) -> Motion {
        let (jump_x, jump_z) = (self.machine.x.jump, self.machine.z.jump);
        Motion {
            curve,
            length: run.length,
            feed,
            limit: run.by_axis.0.min(run.by_bend).max(1),
            accel: run.accel,
            joint,
            start: Self::least(jump_x, jump_z, run.entry).0,
            stop: Self::least(jump_x, jump_z, run.exit).0,
            continues: false,
            source,
        }
    }

    /// The motion of one part of a curve that is made part by part; `limited` keeps what cuts its feed down most.
    #[cfg(feature = "methods")]
    pub(super) fn chained(
        &mut self,
        curve: Curve,
        run: &Run,
        pace: Pace,
        limited: &mut Option<Limited>,
    ) -> Option<Motion> {
        let mut built = Built::default();
        self.finish(curve, run, pace, Source::Part, &mut built);
        if built.limited.is_some_and(|new| limited.is_none_or(|known| new.speed < known.speed)) {
            *limited = built.limited;
        }
        built.motions.pop()
    }
}

/// What a curve and the machine make of a motion.
pub(super) struct Run {
    pub(super) length: u64,
    /// What the axis that goes farther covers of it: a thread's lead is along that axis.
    pub(super) reach: u64,
    pub(super) entry: Direction,
    pub(super) exit: Direction,
    /// What no axis's maximum is passed at.
    pub(super) by_axis: (Speed, Axis),
    /// What the curvature allows.
    pub(super) by_bend: Speed,
    pub(super) accel: u32,
}

/// Directions of travel on an arc.
#[derive(Copy, Clone, Debug)]
pub(super) struct Bearings {
    pub(super) entry: Direction,
    pub(super) exit: Direction,
    /// The largest part of each axis anywhere.
    pub(super) extent: Direction,
}

impl Bearings {
    pub(super) fn of(turn: &Turn) -> Self {
        Self { entry: turn.heading(0), exit: turn.heading(turn.sweep), extent: turn.extent() }
    }
}

/// Length of a vector, rounded down to 62 bits.
pub(super) fn length(x: i128, z: i128) -> i128 {
    let bits = 128_u32.wrapping_sub(x.unsigned_abs().max(z.unsigned_abs()).leading_zeros());
    let cut = bits.saturating_sub(62);
    let (x, z) = (x.wrapping_shr(cut), z.wrapping_shr(cut));
    let square = x.times(x).wrapping_add(z.times(z));
    i128::from(root_wide(square.unsigned_abs())).wrapping_shl(cut)
}
