//! The preparation of an arc, step by step.
//!
//! In the background it runs through at once. In the foreground, where an arc that was walked once is prepared again to
//! be walked backward, it takes a step a tick: each is a few divisions of 128 bits, not the hundred thousand
//! instructions that the whole takes.

use super::arc::{Arc, Timeline};
use super::octants::{Layout, Octants};
use super::prepare_arc::{Metric, Reach, Turn};
use super::proportion::Proportion;
use crate::math::{HALF_TURN_Q60, Wide, angle_of, root_wide, scale, to_i32, to_i64, to_u64};
use crate::units::{PulseSize, Sense};

/// What an arc is prepared of, besides its end and its sense.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) struct Round {
    /// The programmed centre from the rounded start, X and Z, in nm times the denominators of the pulse sizes.
    pub(crate) about: (i64, i64),
    /// Which of the two ways round.
    pub(crate) reach: Reach,
}

/// What a step led to.
#[derive(Copy, Clone, Debug)]
pub(crate) enum Step {
    /// There is more to do.
    More,
    /// The arc, and how it turns.
    Done(Arc, Turn),
    /// It is so short or so small that it is its chord.
    Fails,
}

/// What the next step is.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Stage {
    Radius,
    Weights,
    Circle,
    Start,
    Stop,
    WalkedRadius,
    Pulses,
    Centre,
    Begin,
    Lay,
}

/// One arc, on the way to an [`Arc`].
#[derive(Clone, Debug)]
pub(crate) struct Preparation {
    round: Round,
    end: (i32, i32),
    sense: Sense,
    stage: Stage,
    /// Of the programmed circle, nm with 12 fraction bits.
    radius: i128,
    /// Of X and of Z.
    weights: (i128, i128),
    octants: Option<Octants>,
    turn: Turn,
    timeline: Timeline,
    layout: Option<Layout>,
}

impl Preparation {
    /// An arc from (0, 0) to `end`, pulses.
    pub(crate) fn new(round: Round, end: (i32, i32), sense: Sense) -> Self {
        Self {
            round,
            end,
            sense,
            stage: Stage::Radius,
            radius: 0,
            weights: (0, 0),
            octants: None,
            turn: Turn { start: 0, sweep: 0, sense },
            timeline: Timeline::default(),
            layout: None,
        }
    }

    /// The first step: the radius of the programmed circle, nm with 12 fraction bits.
    pub(super) fn find_radius(&mut self, metric: &Metric) -> i128 {
        let off = |pulse: PulseSize, about: i64| {
            scale(i128::from(about).wrapping_neg(), 1 << 12, i128::from(pulse.denominator()))
        };
        let (x, z) = (off(metric.x, self.round.about.0), off(metric.z, self.round.about.1));
        let square = x.squared().saturating_add(z.squared());
        self.radius = i128::from(root_wide(square.unsigned_abs()));
        self.stage = Stage::Weights;
        self.radius
    }

    /// The next step.
    pub(crate) fn step(&mut self, metric: &Metric) -> Step {
        match self.advance(metric) {
            None => Step::Fails,
            Some(false) => Step::More,
            Some(true) => match self.layout.and_then(|layout| layout.arc()) {
                Some(arc) => Step::Done(arc, self.turn),
                None => Step::Fails,
            },
        }
    }

    /// True where the arc is done, `None` where there is none.
    fn advance(&mut self, metric: &Metric) -> Option<bool> {
        match self.stage {
            Stage::Radius => {
                self.find_radius(metric);
            }
            Stage::Weights => {
                self.weights = metric.weights(self.radius);
                self.stage = Stage::Circle;
            }
            Stage::Circle => {
                let (a, b) = self.weights;
                // 2 a (centre / pulse - start)
                let about = |pulse: PulseSize, weight: i128, off: i64| {
                    scale(weight.wrapping_mul(2), i128::from(off), i128::from(pulse.numerator()))
                };
                let (x, z) = self.round.about;
                let circle = [a, b, about(metric.x, a, x), about(metric.z, b, z)];
                self.octants = Some(Octants::through(circle, self.end, (self.sense, self.round.reach))?);
                self.stage = Stage::Start;
            }
            Stage::Start => {
                self.turn.start = self.angle(metric, (0, 0))?;
                self.stage = Stage::Stop;
            }
            Stage::Stop => {
                let stop = self.angle(metric, self.end)?;
                self.turn.sweep = self.swept(stop)?;
                self.stage = Stage::WalkedRadius;
            }
            Stage::WalkedRadius => {
                self.walked_radius(metric)?;
                self.stage = Stage::Pulses;
            }
            Stage::Pulses => {
                let radius = i128::from(self.timeline.radius);
                let in_pulses = |pulse: PulseSize| {
                    to_u64(scale(radius, i128::from(pulse.denominator()) << 4, i128::from(pulse.numerator())))
                };
                self.timeline.radius_pulses = [in_pulses(metric.x), in_pulses(metric.z)];
                self.timeline.angle = Proportion::new(1 << 30, self.timeline.radius, self.timeline.length);
                self.stage = Stage::Centre;
            }
            Stage::Centre => {
                self.centre(metric)?;
                self.stage = Stage::Begin;
            }
            Stage::Begin => {
                self.layout = Some(self.octants.as_ref()?.layout(self.timeline)?);
                self.stage = Stage::Lay;
            }
            Stage::Lay => {
                let layout = self.layout.as_mut()?;
                self.octants.as_mut()?.lay(layout)?;
                return Some(layout.is_done());
            }
        }
        Some(false)
    }

    /// Angle of a lattice point's radius vector from the Z axis.
    fn angle(&self, metric: &Metric, at: (i32, i32)) -> Option<i64> {
        // X : Z of the radius vector in mm is (gradient x / pulse x) : (gradient z / pulse z)
        let (x, z) = self.octants.as_ref()?.gradient(at.0, at.1);
        Some(angle_of(z.times(metric.across), x.times(metric.along)))
    }

    /// How far the arc turns to the angle `stop`.
    fn swept(&self, stop: i64) -> Option<i64> {
        let whole = i128::from(HALF_TURN_Q60).wrapping_mul(2);
        let swept = i128::from(stop).wrapping_sub(i128::from(self.turn.start)).times(self.travel());
        let swept = swept.rest(whole)?;
        // a whole turn and a little less or more: the angles alone can't tell
        let lacks = matches!(self.round.reach, Reach::Long) && swept < whole >> 2;
        Some(to_i64(if lacks { swept.wrapping_add(whole) } else { swept }))
    }

    const fn travel(&self) -> i128 {
        match self.sense {
            Sense::CounterClockwise => 1,
            Sense::Clockwise => -1,
        }
    }

    /// Radius and length of the walked arc.
    fn walked_radius(&mut self, metric: &Metric) -> Option<()> {
        let octants = self.octants.as_ref()?;
        let span = |pulse: PulseSize, centre: i128, weight: i128| {
            let den = weight.wrapping_mul(2).times(i128::from(pulse.denominator()));
            scale(centre, i128::from(pulse.numerator()) << 12, den)
        };
        let (x, z) = (span(metric.x, octants.c, octants.a), span(metric.z, octants.d, octants.b));
        let square = x.squared().saturating_add(z.squared());
        let radius = root_wide(square.unsigned_abs());
        self.timeline.radius = radius;
        self.timeline.length = to_u64(i128::from(radius).times(i128::from(self.turn.sweep)) >> 60);
        (radius > 0).then_some(())
    }

    /// The walked centre, and where the arc begins in its zone.
    fn centre(&mut self, metric: &Metric) -> Option<()> {
        let octants = self.octants.as_ref()?;
        let whole = i128::from(HALF_TURN_Q60).wrapping_mul(2);
        let middle = i128::from(octants.first().wrapping_add(1) >> 1 & 3).times(i128::from(HALF_TURN_Q60) >> 1);
        let mut off = i128::from(self.turn.start).wrapping_sub(middle).rest(whole)?;
        if off > i128::from(HALF_TURN_Q60) {
            off = off.wrapping_sub(whole);
        }
        let quarter = HALF_TURN_Q60 >> 1;
        self.timeline.centre = [
            to_i64(scale(octants.c, 1 << 16, octants.a.wrapping_mul(2))),
            to_i64(scale(octants.d, 1 << 16, octants.b.wrapping_mul(2))),
        ];
        self.timeline.start_angle = to_i32(to_i64(off.times(self.travel()) >> 30));
        self.timeline.half_width =
            [to_i32(metric.half_width_x >> 30), to_i32(quarter.wrapping_sub(metric.half_width_x) >> 30)];
        Some(())
    }
}
