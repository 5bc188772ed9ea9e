//! A motion made again, of the few figures that tell it: for the way back along a path whose motions were forgotten.
//!
//! [`Outline`] is all that is not known from the machine. An [`Again`] makes the motion of it, equal to the first one bit
//! for bit since the very same functions make it, in steps of a few thousand instructions.

use super::builder::Bearings;
use super::{Builder, Curve, Feed, Motion, Speed};
use crate::curve::arc::Arc;
use crate::curve::line::Line;
use crate::curve::preparation::{Preparation, Round, Step};
use crate::units::Sense;

/// What a motion can be made of again.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    /// A line: of its end.
    Line,
    /// An arc.
    Arc {
        /// What it was prepared of.
        round: Round,
        /// Its limit is that of the other part of a programmed arc.
        shared: bool,
    },
    /// A part of a curve that is made part by part: of nothing less than the curve.
    #[cfg_attr(not(feature = "methods"), expect(dead_code, reason = "such curves are a method's"))]
    Part,
}

impl Source {
    /// The same with the other part's limit.
    pub(super) const fn shared(self) -> Self {
        match self {
            Self::Arc { round, .. } => Self::Arc { round, shared: true },
            Self::Line | Self::Part => self,
        }
    }
}

/// The curve of an [`Outline`].
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) enum Shape {
    /// Straight.
    Line,
    /// Round.
    Arc(Round, Sense),
}

/// What tells a motion, besides the machine.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) struct Outline {
    pub(crate) shape: Shape,
    /// Pulses from the start, X and Z.
    pub(crate) end: (i32, i32),
    pub(crate) feed: Feed,
    pub(crate) joint: Speed,
    pub(crate) continues: bool,
    /// The limit, where it is not the motion's own.
    pub(crate) limit: Option<Speed>,
}

impl Outline {
    /// The outline of a motion; `None` where it can't be made again.
    pub(crate) fn of(motion: &Motion) -> Option<Self> {
        let (shape, limit) = match (motion.source, &motion.curve) {
            (Source::Line, _) => (Shape::Line, None),
            (Source::Arc { round, shared }, Curve::Arc(arc)) => {
                (Shape::Arc(round, arc.sense), shared.then_some(motion.limit))
            }
            (Source::Arc { .. } | Source::Part, _) => return None,
        };
        let Motion { feed, joint, continues, .. } = *motion;
        Some(Self { shape, end: motion.curve.end(), feed, joint, continues, limit })
    }
}

/// How far a motion is made.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is no allocation")]
enum Stage {
    Line(Line),
    Reached(Line, (i128, i128, u64)),
    Arc(Preparation),
    Ends(Arc, crate::curve::prepare_arc::Turn),
    Bent(Arc, Bearings),
}

/// A motion on its way to be made again.
#[derive(Clone, Debug)]
pub(crate) struct Again {
    outline: Outline,
    stage: Stage,
}

/// What a step led to.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is no allocation")]
pub(crate) enum Made {
    /// There is more to do.
    More,
    /// The motion.
    Motion(Motion),
    /// Nothing: the outline is of no motion of this machine.
    Nothing,
}

impl Again {
    /// At its beginning; `None` for an outline that leads nowhere.
    pub(crate) fn new(outline: Outline) -> Option<Self> {
        let stage = match outline.shape {
            Shape::Line => Stage::Line(Line::new(outline.end.0, outline.end.1)?),
            Shape::Arc(round, sense) => Stage::Arc(Preparation::new(round, outline.end, sense)),
        };
        Some(Self { outline, stage })
    }

    /// The next step on the builder's machine.
    pub(crate) fn step(&mut self, builder: &Builder) -> Made {
        let (curve, run) = match &mut self.stage {
            Stage::Line(line) => {
                self.stage = Stage::Reached(*line, builder.reach(*line));
                return Made::More;
            }
            Stage::Arc(preparation) => {
                match preparation.step(&builder.metric) {
                    Step::More => {}
                    Step::Done(arc, turn) => self.stage = Stage::Ends(arc, turn),
                    Step::Fails => return Made::Nothing,
                }
                return Made::More;
            }
            Stage::Ends(arc, turn) => {
                self.stage = Stage::Bent(*arc, Bearings::of(turn));
                return Made::More;
            }
            Stage::Reached(line, reach) => builder.straight(*line, *reach),
            Stage::Bent(arc, bearings) => builder.bent(*arc, *bearings),
        };
        let source = match self.outline.shape {
            Shape::Line => Source::Line,
            Shape::Arc(round, _) => Source::Arc { round, shared: self.outline.limit.is_some() },
        };
        let Outline { feed, joint, continues, limit, .. } = self.outline;
        let motion = builder.motion_of(curve, &run, feed, joint, source);
        Made::Motion(Motion { continues, limit: limit.unwrap_or(motion.limit), ..motion })
    }
}
