//! A part of an ellipse or a parabola inside one octant, and the walk of a whole one part by part.
//!
//! All parts walk the same `F`, each with coordinates from its own start. A part in which the walk is led, as the end of
//! the curve is not the point nearest to it, walks a straight line instead: `F` of the line along the major axis, or of
//! the diagonal.

use super::arc::{Arc, MAX_PIECES, Timeline};
use super::arc_walker::ArcWalker;
use super::conic::Conic;
use super::leads::Shape;
use super::method::Method;
use super::{Step, Walker};
use crate::units::{Axis, Sense};

/// Where a part lies, and how it is walked.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct ConicPart {
    /// `F = a x^2 + b z^2 - c x - d z + offset`, coordinates from the part's start.
    pub(crate) conic: [i64; 4],
    pub(crate) offset: i64,
    /// Its centre, X and Z, pulses with 16 fraction bits.
    pub(crate) centre: [i64; 2],
    /// Where it ends, pulses from its start.
    pub(crate) end: (i32, i32),
    /// Steps of the major axis behind the joint.
    pub(crate) steps: u32,
    /// The way from the octant before to the first point of this one.
    pub(crate) joint: (i8, i8),
    pub(crate) octant: u8,
    pub(crate) sense: Sense,
}

impl ConicPart {
    /// A walker at the part's start.
    pub(crate) fn walk(&self) -> ArcWalker {
        self.arc().walk_beside(self.offset)
    }

    /// A walker at the part's end.
    pub(crate) fn walk_from_end(&self) -> ArcWalker {
        self.arc().walk_back_beside(self.offset)
    }

    fn arc(&self) -> Arc {
        let [a, b, c, d] = self.conic;
        let (mut steps, mut joints) = ([0; MAX_PIECES], [(0, 0); MAX_PIECES - 1]);
        // a joint leads from an octant to the next, here from one without steps
        let [first, second, ..] = &mut steps;
        let (octant, pieces) = if self.joint == (0, 0) {
            *first = self.steps;
            (self.octant, 1)
        } else {
            let [joint, ..] = &mut joints;
            (*second, *joint) = (self.steps, self.joint);
            (Arc::octant_before(self.octant, self.sense), 2)
        };
        let timeline = Timeline { centre: self.centre, ..Timeline::default() };
        let (sense, method, end) = (self.sense, Method::MinimumDeviation, self.end);
        Arc { a, b, c, d, steps, joints, octant, pieces, sense, method, timeline, end }
    }
}

/// Parts of a conic at most: its octants, one more at each end that is led, and the joint before the latter.
pub(crate) const MAX_LEGS: usize = MAX_PIECES + 3;

/// A stretch of the walk of one shape inside an octant; points in pulses from the conic's start.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Leg {
    pub(crate) from: (i32, i32),
    pub(crate) joint: (i8, i8),
    pub(crate) octant: u8,
    pub(crate) steps: u32,
    pub(crate) shape: Shape,
}

impl Conic {
    /// The part of a leg that begins at a point of it, behind the joint unless that is given, and is so long.
    pub(crate) fn part(&self, leg: &Leg, from: (i32, i32), (joint, steps): ((i8, i8), u32)) -> ConicPart {
        let (sign_x, sign_z) = Arc::signs(leg.octant, self.sense);
        let (x, z) = (i64::from(sign_x), i64::from(sign_z));
        let major = Arc::major(leg.octant);
        // the minor part of the gradient is positive on the upper or right half, as that of the conic
        let outward = match major {
            Axis::X => leg.octant.wrapping_add(2) & 7 < 4,
            Axis::Z => leg.octant < 4,
        };
        let minor = if outward { -1_i64 } else { 1 };
        let line = |c: i64, d: i64| ([0, 0, c, d], 0, [1 << 46; 2]);
        let (conic, offset, centre) = match (leg.shape, major) {
            (Shape::Near, _) => self.seen_from(from),
            (Shape::Straight, Axis::X) => line(0, minor),
            (Shape::Straight, Axis::Z) => line(minor, 0),
            (Shape::Diagonal, Axis::X) => line(minor.wrapping_mul(x).wrapping_mul(z).wrapping_neg(), minor),
            (Shape::Diagonal, Axis::Z) => line(minor, minor.wrapping_mul(x).wrapping_mul(z).wrapping_neg()),
        };
        let to = self.ahead(leg, from, (joint, steps));
        let end = (to.0.wrapping_sub(from.0), to.1.wrapping_sub(from.1));
        ConicPart { conic, offset, centre, end, steps, joint, octant: leg.octant, sense: self.sense }
    }

    /// A walker at the start.
    pub fn walk(&self) -> ConicWalker {
        ConicWalker { conic: *self, leg: 0, walker: self.whole_leg(0).walk() }
    }

    fn whole_leg(&self, index: usize) -> ConicPart {
        let leg = self.legs().get(index).copied().unwrap_or_default();
        self.part(&leg, leg.from, (leg.joint, leg.steps))
    }
}

/// Walks an ellipse or a parabola.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct ConicWalker {
    conic: Conic,
    leg: usize,
    walker: ArcWalker,
}

impl ConicWalker {
    /// Goes on in the next leg; false where there is none.
    fn enter_next(&mut self) -> bool {
        let next = self.leg.wrapping_add(1);
        if next >= self.conic.legs().len() {
            return false;
        }
        self.leg = next;
        self.walker = self.conic.whole_leg(next).walk();
        true
    }
}

impl Walker for ConicWalker {
    #[inline]
    fn next_step(&mut self) -> Option<Step> {
        loop {
            if let Some(step) = self.walker.next_step() {
                return Some(step);
            }
            if !self.enter_next() {
                return None;
            }
        }
    }

    fn each_step(&mut self, mut take: impl FnMut(Step)) {
        loop {
            self.walker.each_step(&mut take);
            if !self.enter_next() {
                break;
            }
        }
    }

    fn previous_step(&mut self) -> Option<Step> {
        loop {
            if let Some(step) = self.walker.previous_step() {
                return Some(step);
            }
            self.leg = self.leg.checked_sub(1)?;
            self.walker = self.conic.whole_leg(self.leg).walk_from_end();
        }
    }
}
