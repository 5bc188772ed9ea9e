//! Runs a curve backward by a classic method.
//!
//! The methods of lines undo their steps one by one, at the same places of the path. On an arc a step of point comparison
//! or of digital integration does not tell where it came from; so backward the reversed arc is walked, over points of its
//! own that end exactly where the arc began. It is walked by point comparison, whichever of the two it was: that holds to
//! the curve from any point, while an integrator that is turned round again and again takes over what its registers were
//! off, and would drift. Having turned round, such an arc goes on by point comparison in both senses.
//!
//! The chords of time division end on points that are functions of the length; so they are divided anew by the ticks.

use super::{ChordRunner, ClassicRunner, PulseRunner, PulseWalker, Pulses, Round};
use crate::channel::runner::{Sink, passed, share};
use crate::curve::arc::Arc;
use crate::curve::dda::IntegratedLine;
use crate::curve::fraction::FractionLine;
use crate::curve::line::Line;
use crate::curve::method::Method;
use crate::curve::point_comparison::{ComparedArc, ComparedLine};
use crate::curve::proportion::Proportion;
use crate::curve::rate_multiplier::MultipliedLine;
use crate::curve::{OneWay, Step, Walker};
use crate::times::{PULSE, Stretch};
use crate::train::Train;

impl ClassicRunner {
    /// At the end of a line of this length.
    pub(in crate::channel) fn at_end_of_line(line: Line, steps: Proportion, length: u64, method: Method) -> Self {
        let Self::Pulses(start) = Self::line(line, steps, method) else { return Self::line(line, steps, method) };
        let walker = match method {
            Method::PointComparison => PulseWalker::ComparedLine(ComparedLine::end_of(line)),
            Method::Dda => PulseWalker::IntegratedLine(IntegratedLine::end_of(line)),
            Method::RateMultiplier => PulseWalker::MultipliedLine(MultipliedLine::end_of(line)),
            Method::Fraction => PulseWalker::FractionLine(FractionLine::end_of(line)),
            Method::MinimumDeviation | Method::TimeDivision => PulseWalker::Line(line.walk_from_end()),
        };
        let made = i64::from(line.steps()) << 16;
        Self::Pulses(PulseRunner { walker, at: start.pulses.at(length), made, ..start })
    }

    /// At the end of an arc by point comparison or digital integration.
    pub(in crate::channel) fn at_end_of_arc(arc: &Arc) -> Self {
        let round = Round::new(arc);
        let at = round.pulses(round.length);
        let walker = PulseWalker::ComparedArc(ComparedArc::end_of(arc));
        let quadrants = walker.quadrants_entered();
        Self::Pulses(PulseRunner { at, made: at, quadrants, ..PulseRunner::new(walker, Pulses::Arc(round)) })
    }

    /// At the end of an arc by time division.
    pub(in crate::channel) fn at_last_chord(arc: &Arc) -> Self {
        let start = ChordRunner::new(arc);
        Self::Chords(ChordRunner { reached: start.length, at: start.end, ..start })
    }

    /// Goes back evenly to `length` from the start during `stretch`.
    pub(in crate::channel) fn retreat(&mut self, length: u64, stretch: Stretch, sink: &mut Sink<'_, impl Train>) {
        match self {
            Self::Pulses(runner) => runner.retreat(length, stretch, sink),
            Self::Chords(runner) => runner.advance(length, stretch, sink),
        }
    }
}

impl PulseWalker {
    /// The step of a line that led here, undone.
    fn previous(&mut self) -> Option<Step> {
        match self {
            Self::ComparedLine(walker) => walker.previous_step(),
            Self::IntegratedLine(walker) => walker.previous_step(),
            Self::MultipliedLine(walker) => walker.previous_step(),
            Self::FractionLine(walker) => walker.previous_step(),
            Self::Line(walker) => walker.previous_step(),
            Self::ComparedArc(_) | Self::IntegratedArc(_) => None,
        }
    }

    /// The reversed arc from here, or from before the step that waits.
    fn turned(&self, waiting: Option<Step>) -> Option<Self> {
        let mut arc = match self {
            Self::ComparedArc(walker) => walker.reversed(),
            Self::IntegratedArc(walker) => walker.compared().reversed(),
            Self::ComparedLine(_)
            | Self::IntegratedLine(_)
            | Self::MultipliedLine(_)
            | Self::FractionLine(_)
            | Self::Line(_) => return None,
        };
        if let Some(step) = waiting {
            arc.take_back(step);
        }
        Some(Self::ComparedArc(arc))
    }
}

impl PulseRunner {
    /// Turns an arc's walker to the sense of travel.
    pub(super) fn face(&mut self, back: bool) {
        if self.back != back
            && let Some(turned) = self.walker.turned(self.waiting)
        {
            self.waiting = None;
            self.walker = turned;
            self.quadrants = self.walker.quadrants_entered();
        }
        self.back = back;
    }

    fn retreat(&mut self, length: u64, stretch: Stretch, sink: &mut Sink<'_, impl Train>) {
        let to = self.pulses.at(length);
        self.face(true);
        match self.pulses {
            Pulses::Line(..) => self.undo(to, stretch, sink),
            Pulses::Arc(_) if length == 0 => {
                self.last(stretch, sink);
                self.made = 0;
            }
            Pulses::Arc(_) => self.walk_back(to, stretch, sink),
        }
        self.at = to;
    }

    /// Undoes the steps of a line that were due after `to`.
    fn undo(&mut self, to: i64, stretch: Stretch, sink: &mut Sink<'_, impl Train>) {
        if self.waiting.take().is_some() {
            self.walker.previous();
        }
        while let Some(step) = self.walker.previous() {
            // what was made before it: the same but for the pulse that it counts
            let (due, counted) = self.pulses.due(self.made, step);
            let (due, before) =
                if counted == self.made { (due, self.made) } else { (self.made, self.made.wrapping_sub(PULSE)) };
            if due <= to {
                // it stays made
                self.walker.next();
                return;
            }
            sink.step(passed(due, self.at, to, stretch), step);
            self.made = before;
        }
    }

    /// Walks the reversed arc to the pulses made up to `to`.
    fn walk_back(&mut self, to: i64, stretch: Stretch, sink: &mut Sink<'_, impl Train>) {
        while self.made > to {
            let Some(step) = self.walker.next() else { return };
            sink.step(passed(self.made, self.at, to, stretch), step);
            self.made = self.made.wrapping_sub(PULSE);
            self.turn_quadrant();
        }
    }

    /// Makes all steps that are left of an arc, evenly: on its last stretch a pulse more or less than the timeline's is
    /// spread over all.
    pub(super) fn last(&mut self, stretch: Stretch, sink: &mut Sink<'_, impl Train>) {
        let mut ahead = self.clone();
        let mut left = 1_u64;
        while ahead.next().is_some() {
            left = left.wrapping_add(1);
        }
        let mut part = 0;
        while let Some(step) = self.next() {
            part = u64::wrapping_add(part, 1);
            sink.step(stretch.from.wrapping_add(share(stretch.clocks, part, left)), step);
        }
    }
}
