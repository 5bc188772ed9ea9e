//! Runs a curve by a classic method.
//!
//! On a line the pulses of the major axis are due where the line passes the next lattice line of that axis, and those of the
//! minor axis, where they come by themselves, half-way between. On an arc the methods that step pulse
//! by pulse make as many steps as the arc has pulses of both axes together, whatever their order. So the timeline is that
//! sum: `J(length)`, how many pulses of X and Z a continuous point has made up to a length along the path, and a step is due
//! where J reaches the pulses made with it. The tangential feed is then what was asked, at every direction. J runs on evenly from quadrant to quadrant, `R_a sin(w) + R_b (1 - cos(w))` inside one; the
//! walker turns round where the lattice lets it, a pulse early or late, and is put back on the timeline there.
//!
//! Time division computes the point of the arc at the end of each tick, rounds it to the lattice and walks the chord by
//! minimum deviation. The chord for an advance F leaves an arc of radius R by `F^2 / 8 R`. The feed on an arc is at most
//! `sqrt(a R)`, so that is at most `a T^2 / 8` for the tick T, 0.06 um at 500 mm/s2; a tick whose chord would leave it by more
//! than half a pulse is divided. The chord's ends are rounded, so up to half a diagonal of the lattice off, and its walk is
//! half a pulse off the chord: 1.21 pulses at worst besides the chord's own error.

mod back;

use super::runner::{Sink, share};
use crate::curve::arc::Arc;
use crate::curve::dda::{IntegratedArc, IntegratedLine};
use crate::curve::fraction::FractionLine;
use crate::curve::line::{Line, LineWalker};
use crate::curve::method::Method;
use crate::curve::point_comparison::{ComparedArc, ComparedLine};
use crate::curve::proportion::Proportion;
use crate::curve::rate_multiplier::MultipliedLine;
use crate::curve::round::Round;
use crate::curve::{OneWay, Step, Walker};
use crate::math::{root, to_i32, to_u32};
use crate::times::{PULSE, Stretch};
use crate::train::Train;
use crate::units::Axis;

/// Runs a curve by a classic method.
#[derive(Clone, Debug)]
pub(super) enum ClassicRunner {
    /// Pulse by pulse.
    Pulses(PulseRunner),
    /// Tick by tick.
    Chords(ChordRunner),
}

impl ClassicRunner {
    /// At the start of a line; `steps` gives pulses of the major axis for a length.
    pub(super) fn line(line: Line, steps: Proportion, method: Method) -> Self {
        let (x, z) = line.end();
        let major = if x.unsigned_abs() > z.unsigned_abs() { Axis::X } else { Axis::Z };
        let walker = match method {
            Method::PointComparison => PulseWalker::ComparedLine(ComparedLine::new(line)),
            Method::Dda => PulseWalker::IntegratedLine(IntegratedLine::new(line)),
            Method::RateMultiplier => PulseWalker::MultipliedLine(MultipliedLine::new(line)),
            Method::Fraction => PulseWalker::FractionLine(FractionLine::new(line)),
            Method::MinimumDeviation | Method::TimeDivision => PulseWalker::Line(line.walk()),
        };
        Self::Pulses(PulseRunner::new(walker, Pulses::Line(steps, major)))
    }

    /// At the start of an arc by point comparison.
    pub(super) fn compared(arc: &Arc) -> Self {
        let walker = PulseWalker::ComparedArc(ComparedArc::new(arc));
        Self::Pulses(PulseRunner::new(walker, Pulses::Arc(Round::new(arc))))
    }

    /// At the start of an arc by digital integration.
    pub(super) fn integrated(arc: &Arc) -> Self {
        let walker = PulseWalker::IntegratedArc(IntegratedArc::new(arc));
        Self::Pulses(PulseRunner::new(walker, Pulses::Arc(Round::new(arc))))
    }

    /// Advances evenly to `length` from the start during `stretch`.
    pub(super) fn advance(&mut self, length: u64, stretch: Stretch, sink: &mut Sink<'_, impl Train>) {
        match self {
            Self::Pulses(runner) => runner.advance(length, stretch, sink),
            Self::Chords(runner) => runner.advance(length, stretch, sink),
        }
    }

    /// Makes what is still owed at the end of the curve.
    pub(super) fn finish(&mut self, clock: u32, sink: &mut Sink<'_, impl Train>) {
        match self {
            Self::Pulses(runner) => {
                while let Some(step) = runner.next() {
                    sink.step(clock, step);
                }
            }
            Self::Chords(runner) => runner.chord(runner.end, Stretch { from: clock, clocks: 0 }, sink),
        }
    }
}

/// A walker of a method that steps pulse by pulse.
#[derive(Clone, Debug)]
enum PulseWalker {
    ComparedLine(ComparedLine),
    IntegratedLine(IntegratedLine),
    MultipliedLine(MultipliedLine),
    FractionLine(FractionLine),
    Line(LineWalker),
    ComparedArc(ComparedArc),
    IntegratedArc(IntegratedArc),
}

impl PulseWalker {
    fn next(&mut self) -> Option<Step> {
        match self {
            Self::ComparedLine(walker) => walker.next_step(),
            Self::IntegratedLine(walker) => walker.next_step(),
            Self::MultipliedLine(walker) => walker.next_step(),
            Self::FractionLine(walker) => walker.next_step(),
            Self::Line(walker) => walker.next_step(),
            Self::ComparedArc(walker) => walker.next_step(),
            Self::IntegratedArc(walker) => walker.next_step(),
        }
    }

    /// Quadrants entered since the start of an arc.
    const fn quadrants_entered(&self) -> u8 {
        match self {
            Self::ComparedArc(walker) => walker.quadrants_entered(),
            Self::IntegratedArc(walker) => walker.quadrants_entered(),
            Self::ComparedLine(_)
            | Self::IntegratedLine(_)
            | Self::MultipliedLine(_)
            | Self::FractionLine(_)
            | Self::Line(_) => 0,
        }
    }
}

/// From length to the pulses of a line's major axis, or of both axes of an arc; 16 fraction bits.
#[derive(Clone, Debug)]
enum Pulses {
    Line(Proportion, Axis),
    Arc(Round),
}

impl Pulses {
    fn at(&self, length: u64) -> i64 {
        match self {
            Self::Line(pulses, _) => pulses.of(length).cast_signed(),
            Self::Arc(round) => round.pulses(length),
        }
    }
}

impl Pulses {
    /// Where a step is due after `made`, and what is made with it.
    fn due(&self, made: i64, step: Step) -> (i64, i64) {
        let both = step.x != 0 && step.z != 0;
        let counts = match self {
            Self::Line(_, major) => both || (*major == Axis::X) == (step.x != 0),
            Self::Arc(_) => true,
        };
        let pulses = if both && matches!(self, Self::Arc(_)) { PULSE.wrapping_mul(2) } else { PULSE };
        if counts {
            let due = made.wrapping_add(pulses);
            (due, due)
        } else {
            (made.wrapping_add(PULSE >> 1), made)
        }
    }
}

/// Runs a method that steps pulse by pulse.
#[derive(Clone, Debug)]
pub(super) struct PulseRunner {
    walker: PulseWalker,
    pulses: Pulses,
    /// Pulses reached by the path, and by the steps made; 16 fraction bits.
    at: i64,
    made: i64,
    /// A step that is not due yet.
    waiting: Option<Step>,
    quadrants: u8,
    /// The walker walks the reversed arc.
    back: bool,
}

impl PulseRunner {
    fn new(walker: PulseWalker, pulses: Pulses) -> Self {
        Self { walker, pulses, at: 0, made: 0, waiting: None, quadrants: 0, back: false }
    }

    fn next(&mut self) -> Option<Step> {
        self.waiting.take().or_else(|| self.walker.next())
    }

    fn advance(&mut self, length: u64, stretch: Stretch, sink: &mut Sink<'_, impl Train>) {
        self.face(false);
        if matches!(&self.pulses, Pulses::Arc(round) if length >= round.length) {
            return self.last(stretch, sink);
        }
        let to = self.pulses.at(length);
        let whole = to.wrapping_sub(self.at).max(0).unsigned_abs();
        while self.made <= to {
            let Some(step) = self.next() else { break };
            let (due, counted) = self.pulses.due(self.made, step);
            if due > to {
                self.waiting = Some(step);
                break;
            }
            let part = due.wrapping_sub(self.at).max(0).unsigned_abs();
            sink.step(stretch.from.wrapping_add(share(stretch.clocks, part, whole)), step);
            self.made = counted;
            self.turn_quadrant();
        }
        self.at = to;
    }

    /// Puts an arc's walker back on the timeline where it has changed the quadrant.
    fn turn_quadrant(&mut self) {
        let quadrants = self.walker.quadrants_entered();
        if quadrants != self.quadrants {
            self.quadrants = quadrants;
            if let Pulses::Arc(round) = &self.pulses {
                self.made = round.border(self.made);
            }
        }
    }
}

/// How far a walker may be off its timeline where it changes the quadrant.
const MOST_OFF: i64 = PULSE * 4;

impl Round {
    /// Pulses of both axes from the axis of the circle on.
    fn sum(&self, (quarters, sine, cosine): (i64, i64, i64)) -> i64 {
        let [first, second] = self.radius;
        let (moving, turning) = if quarters & 1 == 0 { (first, second) } else { (second, first) };
        let quarter = first.wrapping_add(second).wrapping_shl(self.cut);
        let risen = turning.wrapping_shl(self.cut).wrapping_sub(self.part(cosine, turning));
        quarters.wrapping_mul(quarter).wrapping_add(self.part(sine, moving)).wrapping_add(risen)
    }

    /// Pulses of both axes up to a length.
    fn pulses(&self, length: u64) -> i64 {
        self.sum(self.turned(length)).wrapping_sub(self.sum(self.turned(0)))
    }

    /// Pulses of both axes up to the change of quadrant that the walker has made after `made`: those up to the nearest
    /// axis of the circle, unless that is further than rounding explains (where the arc begins behind one).
    fn border(&self, made: i64) -> i64 {
        let [first, second] = self.radius;
        let quarter = first.wrapping_add(second).wrapping_shl(self.cut);
        let begun = self.sum(self.turned(0));
        let passed = made.wrapping_add(begun).wrapping_add(quarter >> 1).checked_div_euclid(quarter).unwrap_or(0);
        let border = passed.wrapping_mul(quarter).wrapping_sub(begun);
        let off = border.wrapping_sub(made);
        if (MOST_OFF.wrapping_neg()..=MOST_OFF).contains(&off) { border } else { made }
    }

    /// The lattice point nearest to the one at a length, X and Z, pulses from the start.
    fn place(&self, length: u64) -> (i32, i32) {
        let turned = self.quarters(length);
        let (x, z) = (self.coordinate(Axis::X, turned), self.coordinate(Axis::Z, turned));
        let nearest = |v: i64| to_i32(v.wrapping_add(PULSE >> 1) >> 16);
        (nearest(x), nearest(z))
    }
}

/// Runs an arc chord by chord.
#[derive(Clone, Debug)]
pub(super) struct ChordRunner {
    round: Round,
    /// Longest chord that leaves the arc by at most half a pulse of the finer axis.
    longest: u64,
    length: u64,
    reached: u64,
    at: (i32, i32),
    end: (i32, i32),
}

impl ChordRunner {
    /// At the start of an arc.
    pub(super) fn new(arc: &Arc) -> Self {
        let round = Round::new(arc);
        let timeline = &arc.timeline;
        // F^2 / 8 R = p / 2 gives F = 2 R / sqrt(R / p)
        let [radius_x, radius_z] = timeline.radius_pulses;
        let pulses = u64::from(root(radius_x.max(radius_z))) >> 8;
        let longest = timeline.radius.wrapping_mul(2).checked_div(pulses.wrapping_add(1)).unwrap_or(1);
        Self { round, longest: longest.max(1), length: arc.length(), reached: 0, at: (0, 0), end: arc.end }
    }

    /// Advances or goes back: the points are functions of the length, the chords between them depend on the ticks.
    fn advance(&mut self, length: u64, stretch: Stretch, sink: &mut Sink<'_, impl Train>) {
        let advance = length.abs_diff(self.reached);
        let chords = advance.checked_div(self.longest).unwrap_or(0).wrapping_add(1);
        let mut from = stretch.from;
        let mut chord = 0_u64;
        while chord < chords {
            chord = chord.wrapping_add(1);
            let part = advance.wrapping_mul(chord).checked_div(chords).unwrap_or(advance);
            let to =
                if length < self.reached { self.reached.wrapping_sub(part) } else { self.reached.wrapping_add(part) };
            let until = stretch.from.wrapping_add(share(stretch.clocks, chord, chords));
            let point = match to {
                0 => (0, 0),
                to if to >= self.length => self.end,
                to => self.round.place(to),
            };
            self.chord(point, Stretch { from, clocks: until.wrapping_sub(from) }, sink);
            from = until;
        }
        self.reached = length;
    }

    /// Walks straight to a lattice point.
    fn chord(&mut self, to: (i32, i32), stretch: Stretch, sink: &mut Sink<'_, impl Train>) {
        let Some(line) = Line::new(to.0.wrapping_sub(self.at.0), to.1.wrapping_sub(self.at.1)) else { return };
        let (mut walker, steps, mut step) = (line.walk(), line.steps(), 0_u32);
        while let Some(made) = walker.next_step() {
            step = step.wrapping_add(1);
            let clocks = u64::from(stretch.clocks).wrapping_mul(u64::from(step));
            let clocks = to_u32(clocks.checked_div(u64::from(steps)).unwrap_or(0));
            sink.step(stretch.from.wrapping_add(clocks), made);
        }
        self.at = to;
    }
}
