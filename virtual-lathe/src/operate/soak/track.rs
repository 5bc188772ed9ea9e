//! The curve that a program runs along, point by point: whatever an operator does, it is never left.
//!
//! Before a program starts, all its lattice points are enumerated from its blocks, one by one and without a channel. At each
//! tick's end the program's place has to be one of them: in automatic the same or a later one, by a wheel an earlier or a
//! later one. At the program's end it is the last one, and that is the rounded end of the text's last words.

use std::collections::VecDeque;

use handcnc::background::compile::Compiler;
use interp_core::block::{Block, Curve, Work};
use interp_core::channel::State;
use interp_core::config::Machine;
use interp_core::curve::Walker;
use interp_core::curve::method::Method;
use interp_core::units::{Axis, Lattice, PulseSize};

/// Points that a tick may lead along at most: the largest speeds of both axes, with reserve.
const REACH: usize = 1_024;

/// Most points that are enumerated: programs that are longer are followed without.
const MOST: usize = 4_000_000;

/// The curve of a program.
pub(super) struct Track {
    /// Its points in order; empty where they are not known (classic methods, re-entry).
    points: Vec<(i32, i32)>,
    at: usize,
    /// Where it ends.
    end: Option<(i32, i32)>,
    /// The wheel has led back over points that may be several ones of the curve.
    ambiguous: bool,
    /// The cycle has begun: cycle start waits until the handwheels rest.
    begun: bool,
}

/// The nearest pulse, half to plus: the rule of the book, in integers of its own.
fn nearest(nm: i64, pulse: PulseSize) -> i32 {
    let (numerator, denominator) = (i128::from(pulse.numerator()), i128::from(pulse.denominator()));
    let doubled = 2 * i128::from(nm) * denominator + numerator;
    i32::try_from(doubled.div_euclid(2 * numerator)).unwrap_or(i32::MAX)
}

impl Track {
    /// Of blocks that begin at `from`; `end` is where the text says that it ends, nm.
    pub(super) fn new(blocks: &[Block], from: Lattice, end: Option<(i64, i64)>, machine: &Machine) -> Self {
        let end = end.map(|(x, z)| (nearest(x, machine.x.pulse), nearest(z, machine.z.pulse)));
        let mut points = vec![(from.x, from.z)];
        let known = blocks.iter().all(|block| enumerate(block, machine.method, &mut points));
        if !known || points.len() > MOST {
            points.clear();
        }
        Self { points, at: 0, end, ambiguous: false, begun: false }
    }

    /// Only the end is known.
    pub(super) fn only_end(end: Option<(i64, i64)>, machine: &Machine) -> Self {
        Self::new(&[], Lattice::default(), end, machine).without_points()
    }

    fn without_points(mut self) -> Self {
        self.points.clear();
        self
    }

    /// Whether the cycle is still to begin: what is idle or ended until then is another one's.
    pub(super) const fn waits(&mut self, state: State) -> bool {
        self.begun |= !matches!(state, State::Idle | State::Ended);
        !self.begun
    }

    pub(super) const fn has_begun(&self) -> bool {
        self.begun
    }

    /// The program is at `place`; `both` ways are open. False where that is not on the curve.
    pub(super) fn follow(&mut self, place: Lattice, both: bool) -> bool {
        let place = (place.x, place.z);
        let Some(here) = self.points.get(self.at) else { return true };
        if *here == place {
            return true;
        }
        let forward = self.points.iter().skip(self.at).take(REACH).position(|point| *point == place);
        let back = if both {
            self.ambiguous = true;
            self.points.iter().take(self.at).rev().take(REACH).position(|point| *point == place)
        } else {
            None
        };
        self.at = match (forward, back) {
            (Some(forward), Some(back)) if back + 1 < forward => self.at - back - 1,
            (Some(forward), _) => self.at + forward,
            (None, Some(back)) => self.at - back - 1,
            (None, None) => match self.anywhere(place) {
                Some(at) => at,
                None => return false,
            },
        };
        true
    }

    /// Where a curve crosses or covers itself, the nearest point may have been the wrong one.
    fn anywhere(&self, place: (i32, i32)) -> Option<usize> {
        if !self.ambiguous {
            return None;
        }
        self.points.iter().position(|point| *point == place)
    }

    /// After a pass of a thread that is repeated the program is at an earlier point.
    pub(super) fn jumps(&mut self) {
        self.ambiguous = true;
    }

    /// Whether the program ended where it should.
    pub(super) fn ends(&self, place: Lattice) -> Result<(), String> {
        let place = (place.x, place.z);
        let wanted = self.end.into_iter().chain(self.points.last().copied());
        match wanted.into_iter().find(|end| *end != place) {
            None => Ok(()),
            Some((x, z)) => Err(format!("the program ended at X {} Z {}, not at X {x} Z {z}", place.0, place.1)),
        }
    }
}

/// Adds the points of a block. False where it has none to enumerate.
fn enumerate(block: &Block, method: Method, points: &mut Vec<(i32, i32)>) -> bool {
    let Work::Motion(motion) = &block.work else { return true };
    let Some(&(mut x, mut z)) = points.last() else { return false };
    let mut add = |walker: &mut dyn FnMut() -> Option<interp_core::curve::Step>| {
        while let Some(step) = walker() {
            (x, z) = (x + i32::from(step.x), z + i32::from(step.z));
            points.push((x, z));
            if points.len() > MOST {
                return;
            }
        }
    };
    match &motion.curve {
        Curve::Line(line, _) => {
            let mut walker = line.walk();
            add(&mut || walker.next_step());
        }
        Curve::Arc(arc) if matches!(method, Method::MinimumDeviation) => {
            let mut walker = arc.walk();
            add(&mut || walker.next_step());
        }
        Curve::Arc(_) | Curve::ClassicLine(..) | Curve::Conic(_) => return false,
    }
    true
}

/// All blocks of a program.
pub(super) fn compile(text: &str, compiler: &mut Compiler) -> VecDeque<Block> {
    let mut blocks = VecDeque::new();
    for line in text.lines() {
        if compiler.is_ended() {
            break;
        }
        compiler.line(line.as_bytes(), &mut |_, made| blocks.extend(made), &mut |_| {});
    }
    compiler.flush(&mut |_, made| blocks.extend(made));
    blocks
}

/// The part of an axis.
pub(super) const fn part(at: Lattice, axis: Axis) -> i32 {
    match axis {
        Axis::X => at.x,
        Axis::Z => at.z,
    }
}
