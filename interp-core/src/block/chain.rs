//! A sampled curve as a chain of line motions, one at a time.
//!
//! A [`Chain`] divides the curve into chords ([`Chords`]) and makes a line motion of each. It runs in the background and
//! holds a parameter and one motion, so a curve of any length takes the same memory.
//!
//! * **Where.** A chord leaves the curve by at most 3/8 of a finer pulse: of the finer one, since the other axis's pulses
//!   would show the kinks between longer chords as jumps of its speed. Its ends are rounded, which moves the major
//!   coordinate of a point by up to 1/2 and the minor one, with the walk's own 1/2, by up to 1: sqrt(5)/2 pulses. So the
//!   steps stay within 1.493 coarser pulses of the curve. Chords whose ends round to one lattice point are joined.
//! * **When.** A motion's length is that of the curve between the unrounded ends, not that of the rounded chord. So the
//!   feed along the curve is what was asked, and what rounding does to a chord of a few pulses moves no step by more than
//!   it moves the chord's ends.
//! * **How fast.** Joints are judged by the curve's own tangents on both sides, as a smooth curve has no corner where it is
//!   divided. R is the least radius at five points of a chord, or L / w for a length L that turns by w where that is less.
//!   Turning may take 0.8 of the acceleration, `v^2 = 0.8 a R`, and what it takes at the largest speed, c = v^2 / R, leaves
//!   `sqrt(a^2 - c^2)` for speeding up: 0.6 a at least.
//! * **Tips.** That holds where no point between the five is bent much more sharply. But the tip of a hairpin may be far
//!   narrower than a pulse: on `z = x^2 / 2 p` the radius is p at the tip, and `p / cos^3 f` where the direction has turned
//!   by f. So no chord is so long that its curve leans from it by more than a quarter. What turns by more even within a
//!   190th of a pulse (the sharper it is, the slower it would be run, down to standstill in a cusp) is a corner, and taken
//!   like one: no axis jumps by more than `max_jump`. Chords joined in one lattice point keep the least radius and the
//!   sharpest corner of all of them.
//!
//! The five points at a chord's quarters give length, tangents and radii: with the sums S4 and S2 of four and two chords the
//! length is `S4 + (S4 - S2) / 3` (Richardson), and tangents and radii are those of the quartic through all five
//! ([`quartic`]). A tangent of a parabola through three of them is off by some p / 16 R, p being the pulse: at a small
//! `max_jump` the joints of two chords would seem corners.

use super::builder::{Direction, Run, length};
use super::{Builder, Curve, Limited, Motion, Pace, Speed};
use crate::config::FRACTION_BITS;
use crate::curve::line::Line;
use crate::curve::proportion::Proportion;
use crate::math::{HALF_TURN_Q60, RADIAN_Q30, Wide, angle_of, root, root_wide, scale, to_i64, to_u32, to_u64};
use crate::sampled::{Chords, CurveRefusal, Place, Sampled, WHOLE, distance, quartic};
use crate::units::Point;

/// Tenths of its acceleration that a chord's curvature may take.
const CURVATURE_TENTHS: u128 = 8;

/// A radius on which turning limits no speed.
const STRAIGHT: u64 = 1 << 60;

/// Chords within one lattice point after which a curve is given up: it does not get on.
const MOST_JOINED: u32 = 1 << 16;

/// A sampled curve on its way into motions.
///
/// ```
/// # use interp_core::block::{Builder, Chain, Pace};
/// # use interp_core::config::{AxisConfig, Config};
/// # use interp_core::sampled::curves::SineWave;
/// # use interp_core::units::{Feedrate, Length, Point, PulseSize};
/// # let feed = Feedrate::from_nm_per_min(3_000_000_000).unwrap();
/// # let axis = AxisConfig { pulse: PulseSize::ONE_MICROMETRE, max_feed: feed, max_accel: 500_000, max_jump: 5_000,
/// #     pulse_width_ns: 2_500, dir_setup_ns: 5_000, dir_hold_ns: 5_000, min_space_ns: 2_500 };
/// # let machine = Config { x: axis, z: axis, event_min_ns: 2_000 }.check().unwrap();
/// let um = |um| Length::from_um(um).unwrap();
/// let mut builder = Builder::new(&machine, Point { x: um(20_000), z: um(0) });
/// let wave = SineWave::new((um(20_000), um(0)), um(1_000), um(8_000), 0, um(-30_000)).unwrap();
/// let mut chain = Chain::new(&builder, wave, Pace::Feed(Feedrate::from_nm_per_min(500_000_000).unwrap())).unwrap();
/// while let Some(motion) = chain.next_motion(&mut builder) {
///     let _block = motion.unwrap(); // to the channel
/// }
/// assert_eq!(builder.lattice().z, -30_000);
/// ```
#[derive(Clone, Debug)]
pub struct Chain<C> {
    chords: Chords<C>,
    pace: Pace,
    limited: Option<Limited>,
    /// Chords whose ends round to one lattice point.
    joined: Option<Stretch>,
    count: u32,
    /// The motion made last, given when it is known that another one follows.
    held: Option<Motion>,
    /// What becomes known when `held` is given.
    refused: Option<CurveRefusal>,
    moves: bool,
}

impl<C: Sampled> Chain<C> {
    /// A chain along `curve` from where the builder stands. The motions are walked by minimum deviation, whatever the
    /// machine's method.
    ///
    /// # Errors
    /// [`CurveRefusal::Elsewhere`] where the curve begins further off than a 16th of a coarser pulse, or 2 nm;
    /// [`CurveRefusal::TooFine`].
    pub fn new(builder: &Builder, curve: C, pace: Pace) -> Result<Self, CurveRefusal> {
        let (x, z) = curve.at(0);
        let off = |at: i32, place: i64| (i64::from(at) << FRACTION_BITS).wrapping_sub(place);
        let off = distance(off(builder.at.x.nm(), x), off(builder.at.z.nm(), z));
        let (pulse_x, pulse_z) = builder.span(1, 1);
        let pulse = to_u64(pulse_x.max(pulse_z));
        if off > (pulse >> 4).max(2 << FRACTION_BITS) {
            return Err(CurveRefusal::Elsewhere);
        }
        if curve.longest() < Chords::<C>::SHORTEST {
            return Err(CurveRefusal::TooFine);
        }
        // the ends are whole nm: one is kept for that
        let finer = to_u64(pulse_x.min(pulse_z)) >> FRACTION_BITS;
        let tolerance = to_u32(finer.wrapping_mul(3) / 8).saturating_sub(1);
        Ok(Self {
            chords: Chords::new(curve, tolerance),
            pace,
            limited: None,
            joined: None,
            count: 0,
            held: None,
            refused: None,
            moves: false,
        })
    }

    /// The next motion; `None` behind the last one. After an error the builder stands where the motions given lead.
    ///
    /// # Errors
    /// [`CurveRefusal::OutOfRange`], [`CurveRefusal::TooFine`]; [`CurveRefusal::NoPulse`] where there is none at all.
    pub fn next_motion(&mut self, builder: &mut Builder) -> Option<Result<Motion, CurveRefusal>> {
        if let Some(refused) = self.refused.take() {
            return Some(Err(refused));
        }
        loop {
            let begin = self.chords.parameter();
            let end = match self.chords.next() {
                None => return self.last(),
                Some(Err(refused)) => return Some(self.refuse(refused)),
                Some(Ok(end)) => end,
            };
            let mut stretch = Stretch::new(self.chords.curve(), begin, self.chords.parameter());
            if self.chords.is_corner() {
                stretch.make_corner(builder);
            }
            if let Some(joined) = self.joined.take() {
                stretch = joined.and(stretch, builder);
            }
            match self.motion(stretch, end, builder) {
                Some(motion) => {
                    (self.moves, self.count) = (true, 0);
                    if let Some(before) = self.held.replace(motion) {
                        return Some(Ok(Motion { continues: true, ..before }));
                    }
                }
                None => {
                    self.joined = Some(stretch);
                    self.count = self.count.wrapping_add(1);
                    if self.count > MOST_JOINED {
                        return Some(self.refuse(CurveRefusal::TooFine));
                    }
                }
            }
        }
    }

    /// The feed that an axis's maximum cut down most, on what was made so far.
    pub const fn limited(&self) -> Option<Limited> {
        self.limited
    }

    /// Ends the chain; the motion made last is still given.
    fn refuse(&mut self, refused: CurveRefusal) -> Result<Motion, CurveRefusal> {
        (self.moves, self.joined) = (true, None);
        match self.held.take() {
            Some(before) => {
                self.refused = Some(refused);
                Ok(before)
            }
            None => Err(refused),
        }
    }

    /// What is left at the curve's end.
    fn last(&mut self) -> Option<Result<Motion, CurveRefusal>> {
        let joined = self.joined.take();
        if let Some(mut motion) = self.held.take() {
            // what the curve goes on without a step is part of the last motion
            if let (Some(rest), Curve::Line(line, steps)) = (joined, &mut motion.curve) {
                motion.length = motion.length.wrapping_add(rest.length);
                *steps = proportion(*line, motion.length);
            }
            return Some(Ok(motion));
        }
        let none = !self.moves;
        self.moves = true;
        none.then_some(Err(CurveRefusal::NoPulse))
    }

    /// The motion over a stretch; `None` where it makes no pulse.
    fn motion(&mut self, stretch: Stretch, end: Point, builder: &mut Builder) -> Option<Motion> {
        let to = builder.rounded(end);
        builder.at = end;
        let from = builder.lattice;
        let line = Line::new(to.x.wrapping_sub(from.x), to.z.wrapping_sub(from.z))?;
        builder.lattice = to;
        let chord = || {
            let (x, z) = builder.span(line.end().0, line.end().1);
            unit((x, z)).unwrap_or((0, 0))
        };
        let (entry, exit) = (stretch.entry.unwrap_or_else(chord), stretch.exit.unwrap_or_else(chord));
        let length = stretch.length.max(1);
        let by_axis = builder.speed_limit(stretch.extent);
        let accel = builder.machine.x.accel.min(builder.machine.z.accel);
        let by_bend = bend_limit(accel, stretch.radius).min(stretch.corner);
        let along = accel_beside(accel, by_axis.0.min(by_bend), stretch.radius);
        let run = Run { length, reach: length, entry, exit, by_axis, by_bend, accel: along };
        builder.chained(Curve::Line(line, proportion(line, length)), &run, self.pace, &mut self.limited)
    }
}

/// From a length to steps of the major axis.
fn proportion(line: Line, length: u64) -> Proportion {
    Proportion::new(u64::from(line.steps()) << 16, length, length)
}

/// The largest speed at which turning on a radius takes its share of the acceleration.
fn bend_limit(accel: u32, radius: u64) -> u32 {
    to_u32(root_wide(u128::from(accel).wrapping_mul(u128::from(radius)).wrapping_mul(CURVATURE_TENTHS) / 10))
}

/// What turning at `speed` leaves of an acceleration along the path.
fn accel_beside(accel: u32, speed: u32, radius: u64) -> u32 {
    let across = u64::from(speed).wrapping_mul(u64::from(speed)).checked_div(radius).unwrap_or(u64::MAX);
    let (accel, across) = (u64::from(accel), across.min(u64::from(accel)));
    root(accel.wrapping_mul(accel).wrapping_sub(across.wrapping_mul(across))).max(1)
}

/// A unit vector; `None` for no length.
pub(super) fn unit((x, z): (i128, i128)) -> Option<Direction> {
    // scaled to 62 bits, so that a small one keeps its angle
    let lift = x.unsigned_abs().max(z.unsigned_abs()).leading_zeros().saturating_sub(66);
    let (x, z) = (x.wrapping_shl(lift), z.wrapping_shl(lift));
    let whole = length(x, z);
    let part = |d: i128| to_i64(scale(d, i128::from(RADIAN_Q30), whole));
    (whole > 0).then(|| (part(x), part(z)))
}

/// The angle between two directions, 60 fraction bits.
pub(super) fn angle_between(a: Direction, b: Direction) -> u64 {
    let of = |p: i64, q: i64| i128::from(p).times(i128::from(q));
    let (along, across) = (of(a.0, b.0).wrapping_add(of(a.1, b.1)), of(a.0, b.1).wrapping_sub(of(a.1, b.0)));
    angle_of(along, across).unsigned_abs()
}

/// The largest X part and Z part of a direction that turns from one to the other the short way.
pub(super) fn extent(a: Direction, b: Direction) -> Direction {
    let part = |p: i64, q: i64| p.unsigned_abs().max(q.unsigned_abs()).cast_signed();
    let across = |p: i64, q: i64| (p < 0) != (q < 0);
    // turning past an axis of the plane it has that direction in between
    let x = if across(a.1, b.1) { RADIAN_Q30 } else { part(a.0, b.0) };
    let z = if across(a.0, b.0) { RADIAN_Q30 } else { part(a.1, b.1) };
    (x, z)
}

/// The speed at which a corner may be taken; where the curve stands it may turn back.
fn corner(builder: &Builder, before: Option<Direction>, after: Option<Direction>) -> Speed {
    let before = before.unwrap_or((RADIAN_Q30, RADIAN_Q30));
    builder.corner(before, after.unwrap_or((before.0.wrapping_neg(), before.1.wrapping_neg())))
}

/// What a stretch of a curve is like.
#[derive(Copy, Clone, Debug)]
struct Stretch {
    /// Along the curve, nm with 12 fraction bits.
    length: u64,
    /// Tangents at both ends; `None` where the curve stands.
    entry: Option<Direction>,
    exit: Option<Direction>,
    /// Least radius that it bends on, nm with 12 fraction bits, at most [`STRAIGHT`].
    radius: u64,
    /// The speed at which its sharpest corner may be taken.
    corner: Speed,
    /// Largest parts of its direction.
    extent: Direction,
}

impl Stretch {
    fn new(curve: &impl Sampled, from: u64, to: u64) -> Self {
        let span = to.wrapping_sub(from);
        let at = |quarter: u64| curve.at(from.wrapping_add(span.wrapping_mul(quarter) >> 2).min(WHOLE));
        let p = [at(0), at(1), at(2), at(3), at(4)];
        let [p0, p1, p2, p3, p4] = p;
        let reach = |a: Place, b: Place| distance(b.0.wrapping_sub(a.0), b.1.wrapping_sub(a.1));
        let twice = reach(p0, p2).wrapping_add(reach(p2, p4));
        let fourfold =
            reach(p0, p1).wrapping_add(reach(p1, p2)).wrapping_add(reach(p2, p3)).wrapping_add(reach(p3, p4));
        let length = fourfold.wrapping_add(fourfold.saturating_sub(twice) / 3);
        let (entry, exit) = quartic::ends(&p);
        let direction = |(x, z): (i64, i64)| unit((i128::from(x), i128::from(z)));
        let (entry, exit) = (direction(entry), direction(exit));
        let chord = direction((p4.0.wrapping_sub(p0.0), p4.1.wrapping_sub(p0.1)));
        let (mut turn, mut most) = (0_u64, (0, 0));
        if let (Some(entry), Some(exit)) = (entry, exit) {
            most = extent(entry, exit);
            turn = angle_between(entry, exit);
            if let Some(chord) = chord {
                // a curve that sways inside turns more than its ends tell
                let sway = angle_between(entry, chord).max(angle_between(chord, exit));
                turn = turn.max(sway.saturating_mul(2));
                let (a, b) = (extent(entry, chord), extent(chord, exit));
                most = (a.0.max(b.0), a.1.max(b.1));
            }
            if turn > HALF_TURN_Q60.unsigned_abs() >> 1 {
                most = (RADIAN_Q30, RADIAN_Q30);
            }
        }
        // all of it as sharply as at its sharpest point, or as its turning makes on the average
        let mean = scale(i128::from(length), 1 << 60, i128::from(turn.max(1)));
        let radius = to_u64(mean).min(quartic::least_radius(&p).unwrap_or(STRAIGHT)).min(STRAIGHT);
        Self { length, entry, exit, radius, corner: Speed::MAX, extent: most }
    }

    /// Takes its turning for a corner.
    fn make_corner(&mut self, builder: &Builder) {
        (self.radius, self.corner) = (STRAIGHT, corner(builder, self.entry, self.exit));
    }

    /// This one and the next.
    fn and(self, next: Self, builder: &Builder) -> Self {
        let between = corner(builder, self.exit, next.entry);
        Self {
            length: self.length.wrapping_add(next.length),
            entry: self.entry.or(next.entry),
            exit: next.exit.or(self.exit),
            radius: self.radius.min(next.radius),
            corner: self.corner.min(between).min(next.corner),
            extent: (self.extent.0.max(next.extent.0), self.extent.1.max(next.extent.1)),
        }
    }
}
