//! Walks an [`Arc`] by minimum deviation, both ways.
//!
//! Inside an octant the major axis steps every time and the minor axis when the half-way point between its two
//! candidates lies on the near side of the curve. `decision` is four times `F` there, with the sign arranged so that
//! it is not negative when the minor axis steps; a half counts upward. All sums are taken modulo 2^64 and are exact,
//! since the true values fit; where they fit 32 bits throughout an octant, rows of steps are made in 32 bits.
//!
//! At an octant's border the walker goes to the first point of the next octant over the joint that was prepared: no
//! step where both octants share the point, one where they are neighbours, and over the in-between point nearest the
//! curve where there is a gap.

mod back;

use super::arc::Arc;
use super::arc_row::{ArcRow, Divisor, Word};
use super::strides::{Strides, Turns};
use super::{Step, Walker};
use crate::math::to_u32;
use crate::units::Axis;

/// Walks an [`Arc`].
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct ArcWalker {
    arc: Arc,
    /// `F` at the point that coordinates count from.
    offset: i64,
    /// Octants entered so far.
    piece: u8,
    octant: u8,
    /// Steps done inside this octant.
    done: u32,
    /// Steps of this octant.
    steps: u32,
    decision: i64,
    /// Change of `decision` with the next step of the major axis, and the change of that.
    major_rise: i64,
    major_curve: i64,
    /// Change of `decision` with a step of the minor axis, and the change of that.
    minor_rise: i64,
    minor_curve: i64,
    /// `major_curve` and `minor_curve` to divide by, where they are wide.
    divisors: [Divisor; 2],
    strides: Strides,
    /// Steps of the minor axis up to the lattice line nearest the centre, beyond which `decision` would see the far
    /// side of the curve. Where travel leads away from the centre, `u32::MAX` less the steps back to that line. So
    /// none may be taken forward at 0 nor backward at `u32::MAX`.
    minors: u32,
    /// Every figure of the recurrence fits 32 bits throughout the octant.
    narrow: bool,
    /// Where the walker is.
    x: i32,
    z: i32,
    /// First point of the octant that a joint leads to; (x, z) outside joints.
    target: (i32, i32),
}

impl Arc {
    /// A walker at the start.
    pub fn walk(&self) -> ArcWalker {
        self.walk_beside(0)
    }

    /// A walker at the start, whose deviation is known: `F` there.
    pub(crate) fn walk_beside(&self, offset: i64) -> ArcWalker {
        let mut walker = ArcWalker {
            arc: *self,
            offset,
            piece: 0,
            octant: self.octant,
            done: 0,
            steps: 0,
            decision: 0,
            major_rise: 0,
            major_curve: 0,
            minor_rise: 0,
            minor_curve: 0,
            divisors: [Divisor::default(); 2],
            strides: Strides::default(),
            minors: 0,
            narrow: false,
            x: 0,
            z: 0,
            target: (0, 0),
        };
        walker.enter(0, self.octant);
        walker
    }

    fn steps_of(&self, piece: u8) -> u32 {
        self.steps.get(usize::from(piece)).copied().unwrap_or(0)
    }

    fn joint_of(&self, piece: u8) -> (i32, i32) {
        let (x, z) = self.joints.get(usize::from(piece)).copied().unwrap_or((0, 0));
        (i32::from(x), i32::from(z))
    }
}

impl ArcWalker {
    /// Where the walker is: X, Z, pulses from the arc's start.
    pub const fn position(&self) -> (i32, i32) {
        (self.x, self.z)
    }

    /// The arc that it walks.
    #[inline]
    pub(crate) const fn arc(&self) -> &Arc {
        &self.arc
    }

    /// The octant that the walker is in.
    pub(crate) const fn octant(&self) -> u8 {
        self.octant
    }

    /// Whether steps of the present zone remain, the end of a joint into it included.
    pub(crate) fn in_zone(&self) -> bool {
        if self.done < self.steps || (self.x, self.z) != self.target {
            return true;
        }
        let (mut piece, mut octant) = (self.piece, self.octant);
        while piece.wrapping_add(1) < self.arc.pieces && !Arc::ends_at_tangent(octant, self.arc.sense) {
            let joint = self.arc.joint_of(piece);
            piece = piece.wrapping_add(1);
            octant = Arc::octant_after(octant, self.arc.sense);
            if joint != (0, 0) || self.arc.steps_of(piece) > 0 {
                return true;
            }
        }
        false
    }

    /// Whether no further zone follows.
    pub(crate) fn last_zone(&self) -> bool {
        let (mut piece, mut octant) = (self.piece, self.octant);
        while piece.wrapping_add(1) < self.arc.pieces {
            if Arc::ends_at_tangent(octant, self.arc.sense) {
                return false;
            }
            piece = piece.wrapping_add(1);
            octant = Arc::octant_after(octant, self.arc.sense);
        }
        true
    }

    /// Steps to the first point of the octant entered last.
    pub(crate) fn gap(&self) -> u32 {
        let (x, z) = (self.target.0.wrapping_sub(self.x), self.target.1.wrapping_sub(self.z));
        x.unsigned_abs().max(z.unsigned_abs())
    }

    /// Leaves a zone whose steps are done; walks nothing. Afterwards the walker is at the near end of the joint.
    /// Returns false where there is no further zone.
    pub(crate) fn enter_next_zone(&mut self) -> bool {
        while self.piece.wrapping_add(1) < self.arc.pieces {
            let crossed = Arc::ends_at_tangent(self.octant, self.arc.sense);
            let joint = self.arc.joint_of(self.piece);
            self.target = (self.x.wrapping_add(joint.0), self.z.wrapping_add(joint.1));
            self.enter(self.piece.wrapping_add(1), Arc::octant_after(self.octant, self.arc.sense));
            if crossed {
                return true;
            }
        }
        false
    }

    /// Octants entered since the start.
    pub(crate) const fn piece(&self) -> u8 {
        self.piece
    }

    /// The first lattice point of the octant entered last: where its joint leads.
    pub(crate) const fn target(&self) -> (i32, i32) {
        self.target
    }

    /// One step toward the joint's far end, or `None` when there.
    pub(crate) fn joint_step(&mut self) -> Option<Step> {
        if (self.x, self.z) == self.target {
            return None;
        }
        let to = self.arc.bridge((self.x, self.z), self.target, self.offset);
        Some(self.go(to))
    }

    fn go(&mut self, to: (i32, i32)) -> Step {
        let sign = |delta: i32| match delta.signum() {
            1 => 1_i8,
            -1 => -1,
            _ => 0,
        };
        let step = Step { x: sign(to.0.wrapping_sub(self.x)), z: sign(to.1.wrapping_sub(self.z)) };
        (self.x, self.z) = to;
        step
    }

    fn shift(&mut self, step: Step) -> Step {
        self.x = self.x.wrapping_add(i32::from(step.x));
        self.z = self.z.wrapping_add(i32::from(step.z));
        step
    }

    /// Sets the recurrence of `octant` up as at its first point, which is `target`.
    fn enter(&mut self, piece: u8, octant: u8) {
        self.piece = piece;
        self.octant = octant;
        self.done = 0;
        self.steps = self.arc.steps_of(piece);
        self.set_up(self.target.0, self.target.1);
    }

    /// Computes the recurrence of the present octant for the point (`x`, `z`).
    fn set_up(&mut self, x: i32, z: i32) {
        let arc = &self.arc;
        let (sign_x, sign_z) = Arc::signs(self.octant, arc.sense);
        let major_x = matches!(Arc::major(self.octant), Axis::X);
        // the minor axis's gradient is positive on its upper half
        let above = if major_x { self.octant.wrapping_add(2) & 7 < 4 } else { self.octant < 4 };
        let (major, minor, sm, sn, am, an, cm, cn) = if major_x {
            (x, z, sign_x, sign_z, arc.a, arc.b, arc.c, arc.d)
        } else {
            (z, x, sign_z, sign_x, arc.b, arc.a, arc.d, arc.c)
        };
        let (sm, sn) = (i64::from(sm), i64::from(sn));
        // the next major coordinate, and twice the half-way minor coordinate
        let m = i64::from(major).wrapping_add(sm);
        let n2 = i64::from(minor).wrapping_mul(2).wrapping_add(sn);
        // not negative when the minor axis steps; growing toward it
        let toward = if above { sn.wrapping_neg() } else { sn };
        let major_part = am.wrapping_mul(m).wrapping_sub(cm).wrapping_mul(m).wrapping_mul(4);
        let minor_part = an.wrapping_mul(n2).wrapping_sub(cn.wrapping_mul(2)).wrapping_mul(n2);
        let four_f = major_part.wrapping_add(minor_part).wrapping_add(self.offset.wrapping_mul(4));
        let half = if sn < 0 { 1 } else { 0 };
        self.decision = toward.wrapping_mul(four_f).wrapping_sub(half);
        // F(m + s) - F(m) = a (2 s m + 1) - c s, fourfold
        let rise =
            am.wrapping_mul(sm.wrapping_mul(m).wrapping_mul(2).wrapping_add(1)).wrapping_sub(cm.wrapping_mul(sm));
        self.major_rise = toward.wrapping_mul(rise).wrapping_mul(4);
        self.major_curve = toward.wrapping_mul(am).wrapping_mul(8);
        // the half-way point moves by s: (n2 + 2 s)^2 - n2^2 = 4 s n2 + 4, with n2 = 2 n + s
        let lift = an
            .wrapping_mul(sn.wrapping_mul(n2).wrapping_mul(4).wrapping_add(4))
            .wrapping_sub(cn.wrapping_mul(sn).wrapping_mul(4));
        self.minor_rise = toward.wrapping_mul(lift);
        self.minor_curve = toward.wrapping_mul(an).wrapping_mul(8);
        let straight = if major_x { Step { x: sign_x, z: 0 } } else { Step { x: 0, z: sign_z } };
        self.strides = Strides::new(straight, Step { x: sign_x, z: sign_z });
        let [centre_x, centre_z] = self.arc.timeline.centre;
        let centre = if major_x { centre_z } else { centre_x };
        let nearest = centre.wrapping_add(1 << 15) >> 16;
        let outward = (sn > 0) == above;
        let room = to_u32(nearest.wrapping_sub(i64::from(minor)).unsigned_abs());
        self.minors = if outward { u32::MAX.wrapping_sub(room) } else { room };
        // the rises change evenly, so they are largest at an end of the octant; between two tests `decision` moves by
        // a few rises at most, so a 16th of the range leaves room enough
        const FITS: u64 = 1 << 27;
        let fits = |rise: i64, curve: i64| {
            let last = rise.wrapping_add(curve.wrapping_mul(i64::from(self.steps)));
            rise.unsigned_abs() < FITS && last.unsigned_abs() < FITS && curve.unsigned_abs() < FITS
        };
        self.narrow = self.decision.unsigned_abs() < FITS
            && fits(self.major_rise, self.major_curve)
            && fits(self.minor_rise, self.minor_curve);
        if !self.narrow {
            self.divisors = [Divisor::new(self.major_curve), Divisor::new(self.minor_curve)];
        }
    }

    /// One step inside the octant; the caller knows that there is one.
    #[inline]
    fn octant_step(&mut self) -> Step {
        let free = self.minors != 0;
        let mut diagonal = false;
        self.row::<i64>(|row| {
            diagonal = row.turns_if(free);
            (1, u32::from(diagonal))
        });
        self.strides.step(diagonal)
    }

    /// Steps that can be made in a row: those of the octant, as long as the minor axis has lines left to step to.
    #[inline]
    pub(crate) fn left_in_row(&self) -> u32 {
        if (self.x, self.z) == self.target { self.steps.wrapping_sub(self.done).min(self.minors) } else { 0 }
    }

    /// How many steps of a row are straight before the next diagonal one, at most `most`.
    pub(crate) fn straight(&self, most: u32) -> u32 {
        let (mut decision, mut rise, mut steps) = (self.decision, self.major_rise, 0_u32);
        while steps < most && decision < 0 {
            decision = decision.wrapping_add(rise);
            rise = rise.wrapping_add(self.major_curve);
            steps = steps.wrapping_add(1);
        }
        steps
    }

    /// Whether a row's recurrence fits 32 bits.
    #[inline]
    pub(crate) const fn is_narrow(&self) -> bool {
        self.narrow
    }

    /// The octant's two kinds of step: the major axis alone, and both.
    #[inline]
    pub(crate) const fn strides(&self) -> Strides {
        self.strides
    }

    /// Makes steps in a row, at most [`left_in_row`](Self::left_in_row): `make` asks the recurrence for each whether it
    /// is diagonal, and tells how many it made and how many of these were diagonal. Returns where they lead, X and Z.
    #[inline(always)]
    pub(crate) fn row<W: Word>(&mut self, make: impl FnOnce(&mut ArcRow<W>) -> (u32, u32)) -> (i32, i32) {
        let mut row = ArcRow {
            decision: W::from_wide(self.decision),
            major_rise: W::from_wide(self.major_rise),
            major_curve: W::from_wide(self.major_curve),
            minor_rise: W::from_wide(self.minor_rise),
            minor_curve: W::from_wide(self.minor_curve),
            before: (W::from_wide(self.major_rise), W::from_wide(self.minor_rise)),
            turned: W::from_wide(self.major_rise),
            divisors: self.divisors,
        };
        let (steps, diagonals) = make(&mut row);
        self.decision = row.decision.wide();
        self.major_rise = row.major_rise.wide();
        self.minor_rise = row.minor_rise.wide();
        self.done = self.done.wrapping_add(steps);
        self.minors = self.minors.wrapping_sub(diagonals);
        let (x, z) = self.strides.lead(steps, diagonals);
        (self.x, self.z) = (self.x.wrapping_add(x), self.z.wrapping_add(z));
        self.target = (self.x, self.z);
        (x, z)
    }

    /// Gives the next steps of the octant, at most [`left_in_row`](Self::left_in_row).
    #[inline(always)]
    fn each_in_row<W: Word>(&mut self, steps: u32, take: &mut impl FnMut(Step)) {
        let [straight, diagonal] = [false, true].map(|diagonal| self.strides.step(diagonal));
        self.row::<W>(|row| {
            let mut diagonals = 0_u32;
            for _ in 0..steps {
                let turns = row.turns();
                diagonals = diagonals.wrapping_add(u32::from(turns));
                take(if turns { diagonal } else { straight });
            }
            (steps, diagonals)
        });
    }

    /// Whether the recurrence's changing figures are all within `most`.
    #[cfg(test)]
    pub(super) fn fits(&self, most: i64) -> bool {
        [self.decision, self.major_rise, self.minor_rise].iter().all(|figure| (-most..=most).contains(figure))
    }
}

impl Walker for ArcWalker {
    #[inline]
    fn next_step(&mut self) -> Option<Step> {
        loop {
            if let Some(step) = self.joint_step() {
                return Some(step);
            }
            if self.done < self.steps {
                return Some(self.octant_step());
            }
            if self.piece.wrapping_add(1) >= self.arc.pieces {
                return None;
            }
            let joint = self.arc.joint_of(self.piece);
            self.target = (self.x.wrapping_add(joint.0), self.z.wrapping_add(joint.1));
            self.enter(self.piece.wrapping_add(1), Arc::octant_after(self.octant, self.arc.sense));
        }
    }

    fn each_step(&mut self, mut take: impl FnMut(Step)) {
        loop {
            let left = self.left_in_row();
            if left == 0 {
                // joints, and what lies behind the lattice line nearest the centre
                let Some(step) = self.next_step() else { break };
                take(step);
            } else if self.narrow {
                self.each_in_row::<i32>(left, &mut take);
            } else {
                self.each_in_row::<i64>(left, &mut take);
            }
        }
    }

    fn previous_step(&mut self) -> Option<Step> {
        loop {
            if self.done > 0 {
                let step = self.octant_back();
                self.target = (self.x, self.z);
                return Some(step);
            }
            // at the first point of an octant, or somewhere on the joint before it
            if self.piece == 0 {
                return None;
            }
            if let Some(step) = self.joint_step_back() {
                return Some(step);
            }
            self.enter_octant_before();
        }
    }
}
