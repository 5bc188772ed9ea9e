//! An arc walked backward: the same enumeration, undone.

use super::ArcWalker;
use crate::curve::Step;
use crate::curve::arc::Arc;

impl Arc {
    /// A walker at the end.
    pub fn walk_from_end(&self) -> ArcWalker {
        self.walk_back_beside(0)
    }

    /// A walker at the end, where the start's deviation is known.
    pub(crate) fn walk_back_beside(&self, offset: i64) -> ArcWalker {
        let mut walker = self.walk_beside(offset);
        while walker.piece.wrapping_add(1) < self.pieces {
            walker.piece = walker.piece.wrapping_add(1);
            walker.octant = Self::octant_after(walker.octant, self.sense);
        }
        (walker.x, walker.z) = self.end;
        walker.stand_at_end_of_octant(self.end);
        walker
    }
}

impl ArcWalker {
    /// Whether no step of the present zone is made: of a joint into it only the last step belongs to it.
    pub(crate) fn at_zone_start(&self) -> bool {
        let (mut piece, mut octant, mut done, mut at) = (self.piece, self.octant, self.done, (self.x, self.z));
        let mut first = self.target;
        while done == 0 && piece > 0 {
            piece = piece.wrapping_sub(1);
            octant = Arc::octant_before(octant, self.arc.sense);
            let joint = self.arc.joint_of(piece);
            if Arc::ends_at_tangent(octant, self.arc.sense) {
                return joint == (0, 0) || at != first;
            }
            // a joint between the two octants of the zone
            let last = (first.0.wrapping_sub(joint.0), first.1.wrapping_sub(joint.1));
            if at != last {
                return false;
            }
            (at, first, done) = (last, last, self.arc.steps_of(piece));
        }
        done == 0
    }

    /// Goes back into the octant before, at whose end the walker stands; walks nothing.
    pub(crate) fn enter_octant_before(&mut self) {
        self.piece = self.piece.wrapping_sub(1);
        self.octant = Arc::octant_before(self.octant, self.arc.sense);
        self.stand_at_end_of_octant((self.x, self.z));
    }

    /// Sets the recurrence of the present octant up for its last point.
    fn stand_at_end_of_octant(&mut self, last: (i32, i32)) {
        self.steps = self.arc.steps_of(self.piece);
        self.done = self.steps;
        self.target = last;
        self.set_up(last.0, last.1);
    }

    /// One step back on the joint into the present octant, none of whose own steps is made; `None` at the near end.
    pub(crate) fn joint_step_back(&mut self) -> Option<Step> {
        let joint = self.arc.joint_of(self.piece.wrapping_sub(1));
        let last = (self.target.0.wrapping_sub(joint.0), self.target.1.wrapping_sub(joint.1));
        if (self.x, self.z) == last {
            return None;
        }
        // find the point before this one on the way from `last` to `target`
        let mut point = last;
        loop {
            let next = self.arc.bridge(point, self.target, self.offset);
            if next == (self.x, self.z) || next == point {
                break;
            }
            point = next;
        }
        Some(self.go(point))
    }

    /// Undoes one step inside the octant.
    pub(super) fn octant_back(&mut self) -> Step {
        self.done = self.done.wrapping_sub(1);
        self.major_rise = self.major_rise.wrapping_sub(self.major_curve);
        self.decision = self.decision.wrapping_sub(self.major_rise);
        // had the minor axis stepped? Its half-way point one lower, seen before that step:
        let rise_before = self.minor_rise.wrapping_sub(self.minor_curve);
        let before = self.decision.wrapping_sub(rise_before);
        // the step was diagonal when the point before it is nearest to its own, lower, minor coordinate
        let earlier = before.wrapping_sub(self.major_rise.wrapping_sub(self.major_curve));
        let step = if earlier < 0 && self.minors != u32::MAX {
            self.decision = before;
            self.minor_rise = rise_before;
            self.minors = self.minors.wrapping_add(1);
            self.strides.step(true)
        } else {
            self.strides.step(false)
        };
        self.shift(Step { x: step.x.wrapping_neg(), z: step.z.wrapping_neg() })
    }
}
