//! The curve that a program runs along, point by point: whatever an operator does, it is never left.
//!
//! Before a program starts, all its lattice points are enumerated from its blocks, one by one and without a channel. At each
//! tick's end the program's place has to be one of them: in automatic the same or a later one, by a wheel an earlier or a
//! later one. At the program's end it is the last one, and that is the rounded end of the text's last words.

use std::collections::VecDeque;

use handcnc::background::compile::Compiler;
use interp_core::block::{Block, Curve, Feed, Motion, Work};
use interp_core::channel::State;
use interp_core::config::Machine;
use interp_core::curve::Walker;
use interp_core::curve::method::Method;
use interp_core::drive::ThreadStage;
use interp_core::units::{Axis, Lattice, PulseSize};

use super::swing::Swing;

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
    /// What drives its threads; and the point that the one which is cut has come to, if any is.
    swing: Swing,
    furthest: Option<usize>,
    /// Size of a pulse, nm.
    pulse: (f64, f64),
}

/// The nearest pulse, half to plus: the rule of the book, in integers of its own.
pub(super) fn nearest(nm: i64, pulse: PulseSize) -> i32 {
    let (numerator, denominator) = (i128::from(pulse.numerator()), i128::from(pulse.denominator()));
    let doubled = 2 * i128::from(nm) * denominator + numerator;
    i32::try_from(doubled.div_euclid(2 * numerator)).unwrap_or(i32::MAX)
}

impl Track {
    /// Of blocks that begin at `from`; `end` is where the text says that it ends, nm; `turn`: the encoder's counts.
    pub(super) fn new(
        blocks: &[Block],
        from: Lattice,
        end: Option<(i64, i64)>,
        machine: &Machine,
        turn: Option<u32>,
    ) -> Self {
        let turn = turn.unwrap_or(1);
        let end = end.map(|(x, z)| (nearest(x, machine.x.pulse), nearest(z, machine.z.pulse)));
        let mut points = vec![(from.x, from.z)];
        let known = blocks.iter().all(|block| enumerate(block, machine.method, &mut points));
        if !known || points.len() > MOST {
            points.clear();
        }
        let nm = |pulse: PulseSize| f64::from(pulse.numerator()) / f64::from(pulse.denominator());
        // nm a tick squared
        let accel = f64::from(machine.x.accel.min(machine.z.accel)) / 4096.0;
        Self {
            points,
            at: 0,
            end,
            ambiguous: false,
            begun: false,
            swing: Swing::new(longest_lead(blocks), turn, accel),
            furthest: None,
            pulse: (nm(machine.x.pulse), nm(machine.z.pulse)),
        }
    }

    /// Only the end is known.
    pub(super) fn only_end(end: Option<(i64, i64)>, machine: &Machine) -> Self {
        Self::new(&[], Lattice::default(), end, machine, None).without_points()
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

    /// The spindle's reading, where its thread is, and the speed along the path, nm a tick.
    pub(super) fn turn(&mut self, counts: Option<u16>, stage: ThreadStage, speed: f64) {
        self.swing.tick(counts, stage, speed);
        self.furthest = match stage {
            ThreadStage::Cutting | ThreadStage::Leaving => Some(self.furthest.map_or(self.at, |at| at.max(self.at))),
            ThreadStage::None | ThreadStage::Waiting | ThreadStage::Left => None,
            ThreadStage::Returning | ThreadStage::Entering => {
                self.jumps();
                None
            }
        };
    }

    /// The program is at `place`: the same or a later point, an earlier one if a `wheel` drives it, or one that a thread has
    /// swung back to with its spindle. Else what that place is.
    pub(super) fn follow(&mut self, place: Lattice, wheel: bool) -> Result<(), &'static str> {
        let place = (place.x, place.z);
        let Some(here) = self.points.get(self.at) else { return Ok(()) };
        if *here == place {
            return Ok(());
        }
        let both = wheel || self.furthest.is_some();
        let forward = self.points.iter().skip(self.at).take(REACH).position(|point| *point == place);
        self.ambiguous |= wheel;
        let back = if both {
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
                None => return Err(OFF),
            },
        };
        if !wheel && self.has_swung_too_far(place) { Err(TOO_FAR) } else { Ok(()) }
    }

    /// Whether a thread is farther back than its spindle explains.
    fn has_swung_too_far(&self, place: (i32, i32)) -> bool {
        let Some((x, z)) = self.furthest.filter(|at| self.at < *at).and_then(|at| self.points.get(at)) else {
            return false;
        };
        let (dx, dz) = (f64::from(x - place.0) * self.pulse.0, f64::from(z - place.1) * self.pulse.1);
        // each place is less than a pulse off the path's
        dx.hypot(dz) > self.swing.most() + 2.0 * self.pulse.0.hypot(self.pulse.1)
    }

    /// Where a curve crosses or covers itself, the nearest point may have been the wrong one.
    fn anywhere(&self, place: (i32, i32)) -> Option<usize> {
        if !self.ambiguous {
            return None;
        }
        self.points.iter().position(|point| *point == place)
    }

    /// After a pass of a thread that is repeated the program is at an earlier point.
    fn jumps(&mut self) {
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

/// What a place is that is found wrong.
const OFF: &str = "no point of the program's curve";
const TOO_FAR: &str = "farther back in the thread than its spindle has turned back";

/// The longest lead of all threads, nm; a micrometre where there are none.
fn longest_lead(blocks: &[Block]) -> u32 {
    let lead = |block: &Block| match &block.work {
        Work::Motion(Motion { feed: Feed::Thread(lead, _), .. }) => Some(lead.nm().saturating_add(1)),
        _ => None,
    };
    blocks.iter().filter_map(lead).max().unwrap_or(1_000)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Along Z to plus, pulses of a micrometre; a micrometre a count of the spindle.
    fn track() -> Track {
        Track {
            points: (0..2_000).map(|z| (0, z)).collect(),
            at: 0,
            end: None,
            ambiguous: false,
            begun: true,
            swing: Swing::new(4_096_000, 4_096, 10.0),
            furthest: None,
            pulse: (1_000.0, 1_000.0),
        }
    }

    fn goes(track: &mut Track, z: i32, counts: u16, stage: ThreadStage) -> Result<(), &'static str> {
        track.turn(Some(counts), stage, 0.0);
        track.follow(Lattice { x: 0, z }, false)
    }

    /// A thread that is cut up to 500, a pulse and a count a tick.
    fn cut() -> Track {
        let mut track = track();
        (0..=500_u16).for_each(|z| assert_eq!(goes(&mut track, i32::from(z), z, ThreadStage::Cutting), Ok(())));
        track
    }

    #[test]
    fn a_thread_swings_back_with_its_spindle_and_not_a_pulse_farther() {
        // what is foretold is 15 counts of a tick, here 15; two places are less than 2.9 pulses off
        let back_by = |turned: u16, pulses: i32| {
            let mut track = cut();
            (1..=turned).for_each(|by| assert_eq!(goes(&mut track, 500, 500 - by, ThreadStage::Cutting), Ok(())));
            goes(&mut track, 500 - pulses, 500 - turned, ThreadStage::Cutting)
        };
        for turned in [0, 1, 100] {
            let most = i32::from(turned) + 17;
            assert_eq!((back_by(turned, most), back_by(turned, most + 1)), (Ok(()), Err(TOO_FAR)), "{turned}");
        }
    }

    #[test]
    fn it_swings_back_from_its_furthest_point_in_many_ticks_as_in_one() {
        let mut track = cut();
        let found: Vec<_> = (1..30).map(|by| goes(&mut track, 500 - by, 500, ThreadStage::Cutting)).collect();
        assert_eq!(found.iter().position(Result::is_err), Some(17));
    }

    #[test]
    fn what_is_no_thread_does_not_go_back_and_a_wheel_leads_anywhere() {
        for stage in [ThreadStage::None, ThreadStage::Waiting, ThreadStage::Left] {
            assert_eq!(goes(&mut cut(), 499, 500, stage), Err(OFF));
        }
        let mut track = cut();
        assert_eq!(track.follow(Lattice { x: 0, z: 10 }, true), Ok(()));
        assert_eq!(track.follow(Lattice { x: 1, z: 10 }, true), Err(OFF));
    }
}
