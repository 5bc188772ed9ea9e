//! Blocks: one motion with its limits, ready to execute; and the builder that makes them of programmed curves.
//!
//! The builder rounds end points to the lattice, prepares the curve between rounded ends, and works out what the
//! machine allows on it: the speed that no axis's maximum is passed at, the acceleration, and the speed at which the
//! joint with the block before may be taken without an axis jumping by more than its `max_jump`. It runs in the
//! background; a block is all that the foreground gets.

pub(crate) mod again;
#[cfg(feature = "methods")]
mod chain;
#[cfg(feature = "methods")]
mod pieces;
#[cfg(feature = "methods")]
pub use chain::Chain;
#[cfg(feature = "methods")]
pub use pieces::Pieces;
pub mod shoulder;

use crate::config::{FRACTION_BITS, Machine, speed_of};
use crate::curve::arc::{Arc, NO_EXTREMES};
#[cfg(feature = "methods")]
use crate::curve::conic_piece::ConicPiece;
use crate::curve::line::Line;
use crate::curve::method::Method;
use crate::curve::prepare_arc::{Metric, Prepared, Reach, Turn};
use crate::curve::proportion::Proportion;
use crate::drive::gearing::Lead;
use crate::math::{RADIAN_Q30, Wide, root_wide, scale, to_i64, to_u32, to_u64};
use crate::units::{Axis, Feedrate, Lattice, Length, Point, Sense};
use again::Source;
use heapless::Vec;

/// Speed in nanometres a tick, 12 fraction bits.
pub type Speed = u32;

/// How fast a block is to be run.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Pace {
    /// As fast as the limits allow.
    Rapid,
    /// Along the path, times the feed override.
    Feed(Feedrate),
    /// Along the path for each turn of the spindle, times the feed override; without phase.
    PerTurn(Lead),
    /// A thread: the axis that goes farther by the lead a turn, from the index on.
    Thread {
        /// Pitch times starts.
        lead: Lead,
        /// Behind the index, in 2^-16 of a turn: the start of a multiple thread.
        start: u16,
    },
}

/// What sets the speed of a motion.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Feed {
    /// The limits.
    Rapid,
    /// Time: path a tick.
    PerTick(Speed),
    /// The spindle's speed: path a turn.
    PerTurn(Lead),
    /// The spindle's angle: path a turn, and the start of the thread behind the index.
    Thread(Lead, u16),
}

impl Feed {
    /// Whether the path is bound to the spindle's angle.
    pub const fn is_thread(self) -> bool {
        matches!(self, Self::Thread(..))
    }
}

/// A programmed curve, from where the last one ended.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Path {
    /// Straight to the end.
    Line,
    /// About `centre` (X, Z, nm); a full circle where the end is the start.
    Arc {
        /// Centre, X and Z in nm.
        centre: (i64, i64),
        /// Sense of travel.
        sense: Sense,
    },
}

/// Where a block goes.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Curve {
    /// Straight; from length to steps of the major axis, 16 fraction bits.
    Line(Line, Proportion),
    /// Round, by the method that the arc names.
    Arc(Arc),
    /// Straight by a classic method; from length to pulses of the major axis, 16 fraction bits.
    #[cfg(feature = "methods")]
    ClassicLine(Line, Proportion, Method),
    /// A part of an ellipse or a parabola.
    #[cfg(feature = "methods")]
    Conic(ConicPiece),
}

impl Curve {
    /// The end, X then Z, pulses from the start.
    pub const fn end(&self) -> (i32, i32) {
        match self {
            Self::Line(line, _) => line.end(),
            Self::Arc(arc) => arc.end(),
            #[cfg(feature = "methods")]
            Self::ClassicLine(line, ..) => line.end(),
            #[cfg(feature = "methods")]
            Self::Conic(piece) => piece.end(),
        }
    }

    /// The least and the greatest coordinates, X then Z, pulses from the start; a pulse more where an arc passes an extreme.
    pub fn extent(&self) -> ((i32, i32), (i32, i32)) {
        let ((x, z), (least, most)) = (self.end(), self.extremes(0, u64::MAX));
        ((least.0.min(x).min(0), least.1.min(z).min(0)), (most.0.max(x).max(0), most.1.max(z).max(0)))
    }

    /// The extremes that it passes between two lengths: the least and the greatest coordinates, X then Z, pulses from the start,
    /// and a pulse more. Where there is none the least is the largest number, and the greatest the smallest.
    pub(crate) fn extremes(&self, from: u64, until: u64) -> ((i32, i32), (i32, i32)) {
        match self {
            Self::Arc(arc) => arc.extremes(from, until),
            Self::Line(..) => NO_EXTREMES,
            #[cfg(feature = "methods")]
            Self::ClassicLine(..) | Self::Conic(_) => NO_EXTREMES,
        }
    }
}

/// One motion with its limits.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Motion {
    /// Where to.
    pub curve: Curve,
    /// Length of the walked curve, nm with 12 fraction bits, never 0.
    pub length: u64,
    /// What sets its speed.
    pub feed: Feed,
    /// Largest speed on this block, whatever the override.
    pub limit: Speed,
    /// Largest acceleration along the path, nm a tick squared with 12 fraction bits.
    pub accel: u32,
    /// Largest speed over the joint with the block before, where that one is a motion.
    pub joint: Speed,
    /// Speed at which it may begin from standstill.
    pub start: Speed,
    /// Speed at which it may end in standstill.
    pub stop: Speed,
    /// The programmed curve goes on in the next block (an arc of more than half a turn).
    pub continues: bool,
    /// What it can be made of again.
    pub(crate) source: Source,
}

impl Motion {
    /// Sets the feed, but of a thread.
    pub const fn set_feed(&mut self, feed: Feed) {
        if !matches!(self.feed, Feed::Thread(..)) {
            self.feed = feed;
        }
    }
}

/// What the channel executes.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Block {
    /// Line of the program, from 1.
    pub line: u32,
    /// What to do.
    pub work: Work,
}

/// What a block does.
#[expect(clippy::large_enum_variant, reason = "nearly all are motions, and there is no allocation")]
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Work {
    /// Moves.
    Motion(Motion),
    /// Stands still for this many ticks.
    Dwell(u32),
    /// An output changes while all stands still.
    Output(Output),
    /// The program waits for cycle start.
    Stop,
    /// Like `Stop`, where the operator has switched optional stops on.
    OptionalStop,
    /// The program is over.
    End,
}

/// Outputs that a program sets.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Output {
    /// Spindle forward.
    SpindleForward,
    /// Spindle backward.
    SpindleReverse,
    /// Spindle off.
    SpindleStop,
    /// Spindle speed, thousandths of a turn a minute.
    SpindleSpeed(u32),
    /// Tool and offset number.
    Tool(u16, u16),
}

/// A feed that an axis's maximum cut down on a block.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Limited {
    /// The axis whose maximum it was.
    pub axis: Axis,
    /// The speed that is left.
    pub speed: Speed,
}

/// Why an arc can't be walked.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum ArcRefusal {
    /// It leaves the range of [`Length`] between its ends.
    OutOfRange,
    /// Its radius is below three pulses of the coarser axis, and the pulse sizes differ more than fourfold: there is
    /// no lattice point near most of it.
    TooSmall,
    /// It turns by more than half a turn about less than a pulse: nothing would move.
    NoPulse,
}

/// What became of a programmed curve.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Built {
    /// The blocks: none where the ends round to one lattice point.
    pub motions: Vec<Motion, 2>,
    /// Where an axis can't reach the programmed feed.
    pub limited: Option<Limited>,
    /// Why nothing was built; the position is as before then.
    pub refused: Option<ArcRefusal>,
}

/// A direction: X and Z parts of a unit vector, 30 fraction bits.
type Direction = (i64, i64);

/// Makes blocks of programmed curves.
#[derive(Clone, Debug)]
pub struct Builder {
    machine: Machine,
    metric: Metric,
    /// Programmed position.
    at: Point,
    lattice: Lattice,
    /// Direction in which the last motion ended; `None` after a standstill.
    heading: Option<Direction>,
    /// The last motion was part of a thread.
    in_thread: bool,
}

/// Thousandths of its acceleration that an arc's curvature may take: at most sqrt(0.998 a R), so that a sixteenth of the
/// acceleration is always left to brake with.
const CURVATURE_SHARE: u128 = 998;

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

    fn rounded(&self, end: Point) -> Lattice {
        Lattice { x: self.machine.x.pulse.nearest(end.x), z: self.machine.z.pulse.nearest(end.z) }
    }

    /// Displacement of (`x`, `z`) pulses in nm with 12 fraction bits.
    fn span(&self, x: i32, z: i32) -> (i128, i128) {
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
    fn reach(&self, line: Line) -> (i128, i128, u64) {
        let (dx, dz) = self.span(line.end().0, line.end().1);
        let square = dx.squared().saturating_add(dz.squared());
        (dx, dz, root_wide(square.unsigned_abs()).max(1))
    }

    /// What a line that leads so far and the machine make of a motion.
    fn straight(&self, line: Line, (dx, dz, length): (i128, i128, u64)) -> (Curve, Run) {
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
    fn bent(&self, arc: Arc, Bearings { entry, exit, extent }: Bearings) -> (Curve, Run) {
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

    fn speed_limit(&self, heading: Direction) -> (Speed, Axis) {
        Self::least(self.machine.x.speed, self.machine.z.speed, heading)
    }

    /// The speed at which no axis jumps by more than it may where the direction changes.
    fn corner(&self, before: Direction, after: Direction) -> Speed {
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

    fn motion_of(&self, curve: Curve, run: &Run, feed: Feed, joint: Speed, source: Source) -> Motion {
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
    fn chained(&mut self, curve: Curve, run: &Run, pace: Pace, limited: &mut Option<Limited>) -> Option<Motion> {
        let mut built = Built::default();
        self.finish(curve, run, pace, Source::Part, &mut built);
        if built.limited.is_some_and(|new| limited.is_none_or(|known| new.speed < known.speed)) {
            *limited = built.limited;
        }
        built.motions.pop()
    }
}

/// What a curve and the machine make of a motion.
struct Run {
    length: u64,
    /// What the axis that goes farther covers of it: a thread's lead is along that axis.
    reach: u64,
    entry: Direction,
    exit: Direction,
    /// What no axis's maximum is passed at.
    by_axis: (Speed, Axis),
    /// What the curvature allows.
    by_bend: Speed,
    accel: u32,
}

/// Directions of travel on an arc.
#[derive(Copy, Clone, Debug)]
struct Bearings {
    entry: Direction,
    exit: Direction,
    /// The largest part of each axis anywhere.
    extent: Direction,
}

impl Bearings {
    fn of(turn: &Turn) -> Self {
        Self { entry: turn.heading(0), exit: turn.heading(turn.sweep), extent: turn.extent() }
    }
}

/// How an arc is walked.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Split {
    /// In one.
    Whole(Reach),
    /// In two, joined at its half-way point, which lies at the mean of start and end radius and is rounded to the
    /// nanometre, a half toward plus infinity.
    Halves(Point),
    /// Not at all: the half-way point is past the range of [`Length`].
    OutOfRange,
}

/// Splits an arc that turns by more than half a turn (a full circle where the end is the start).
///
/// Split arcs keep the walked circle near the programmed one: moving a centre onto the bisector of two ends that lie
/// close together on a nearly full circle would move it by up to the radius.
pub fn split(start: Point, end: Point, centre: (i64, i64), sense: Sense) -> Split {
    let from = |p: Point| {
        (i128::from(i64::from(p.x.nm()).wrapping_sub(centre.0)), i128::from(i64::from(p.z.nm()).wrapping_sub(centre.1)))
    };
    let ((sx, sz), (ex, ez)) = (from(start), from(end));
    let turn = |cross: i128| match sense {
        Sense::CounterClockwise => cross,
        Sense::Clockwise => cross.wrapping_neg(),
    };
    // positive for less than half a turn, zero for half a turn or none
    let cross = turn(sz.times(ex).wrapping_sub(sx.times(ez)));
    let along = sx.times(ex).wrapping_add(sz.times(ez));
    if cross > 0 || (cross == 0 && along < 0) {
        return Split::Whole(Reach::Short);
    }
    // radii with 16 fraction bits, and both vectors brought to one length, so that the bisector halves the angle
    let (radius_s, radius_e) = (length(sx << 16, sz << 16), length(ex << 16, ez << 16));
    let mean = radius_s.wrapping_add(radius_e) >> 1;
    let (sx, sz) = (sx.times(radius_e), sz.times(radius_e));
    let (ex, ez) = (ex.times(radius_s), ez.times(radius_s));
    // the better conditioned of two ways: against the sum of both, or square to their difference
    let opposite = (sx.wrapping_add(ex).wrapping_neg(), sz.wrapping_add(ez).wrapping_neg());
    let (cx, cz) = (ex.wrapping_sub(sx), ez.wrapping_sub(sz));
    let square = match sense {
        Sense::CounterClockwise => (cz.wrapping_neg(), cx),
        Sense::Clockwise => (cz, cx.wrapping_neg()),
    };
    let (x, z) = if length(opposite.0, opposite.1) > length(square.0, square.1) { opposite } else { square };
    let bits = 128_u32.wrapping_sub(x.unsigned_abs().max(z.unsigned_abs()).leading_zeros());
    let (x, z) = (x.wrapping_shr(bits.saturating_sub(62)), z.wrapping_shr(bits.saturating_sub(62)));
    let reach = length(x, z).max(1) << 16;
    let place = |centre: i64, part: i128| {
        let off = scale(part, mean, reach);
        Length::from_nm(to_i64(i128::from(centre).wrapping_add(off)))
    };
    match (place(centre.0, x), place(centre.1, z)) {
        (Some(x), Some(z)) => Split::Halves(Point { x, z }),
        _ => Split::OutOfRange,
    }
}

fn length(x: i128, z: i128) -> i128 {
    let bits = 128_u32.wrapping_sub(x.unsigned_abs().max(z.unsigned_abs()).leading_zeros());
    let cut = bits.saturating_sub(62);
    let (x, z) = (x.wrapping_shr(cut), z.wrapping_shr(cut));
    let square = x.times(x).wrapping_add(z.times(z));
    i128::from(root_wide(square.unsigned_abs())).wrapping_shl(cut)
}
