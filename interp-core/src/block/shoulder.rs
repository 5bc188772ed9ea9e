//! Shoulders: where travel along a motion has to end, so that an axis does not pass a coordinate.
//!
//! What is made of a curve is a function of the length alone: forward and back, the lattice point at a length is the one at the
//! last lattice line of the major axis. So the place of a shoulder is found once, before anything moves: at the line of the major
//! axis nearest to where the curve itself meets the coordinate. There the axis is on the coordinate to the pulse, since no axis is
//! steeper than the major one. On an arc, whose lines of the major axis are where its angle says, the place lies half-way to the
//! next line: half a pulse to either side is far more than all that is rounded.
//!
//! A curve that only touches the coordinate, or passes it by less than makes a pulse, does not pass it. Where steps
//! may be farther off the curve, by a classic method and on the smallest arcs, shoulders lie that much nearer.

use super::{Curve, Motion};
use crate::curve::arc::Arc;
use crate::curve::line::Line;
#[cfg(feature = "methods")]
use crate::curve::method::Method;
use crate::curve::round::Round;
use crate::math::{QUARTER_Q30, scale, to_u64};
use crate::units::Axis;

/// A coordinate that an axis is not led past.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Shoulder {
    /// The axis.
    pub axis: Axis,
    /// The last place that is led to, pulses from the motion's start.
    pub at: i32,
    /// What lies beyond is to plus, else to minus.
    pub plus: bool,
}

/// Coordinates on an arc have 16 fraction bits: what makes no pulse beyond a place, less a 128th of a pulse for all that is rounded.
const TOUCHES: i64 = (1 << 15) - (1 << 9);

/// Part of a pulse of the major axis from where an arc meets a coordinate to the end of travel: a half, and on the safe side
/// where the slope is one and the minor axis half a pulse off.
const FORWARD: u64 = 32_112;
const BACK: u64 = 33_424;

/// Length that a place on an arc is found to, as a shift of nm with 12 fraction bits: a nm.
const FINE: u64 = 1 << 12;

impl Shoulder {
    /// How far a coordinate of its axis lies beyond.
    const fn beyond(&self, at: i64, shoulder: i64) -> i64 {
        if self.plus { at.wrapping_sub(shoulder) } else { shoulder.wrapping_sub(at) }
    }

    /// How far an arc is beyond at a length, pulses with 16 fraction bits.
    fn of_round(&self, round: &Round, length: u64) -> i64 {
        self.beyond(round.coordinate(self.axis, round.quarters(length)), i64::from(self.at) << 16)
    }
}

/// How far a path may be led to either side of a place on it without passing a shoulder: the least and the greatest length.
///
/// * `motions`: the path's; together not longer than 2^62, nm with 12 fraction bits as all lengths here.
/// * `at`: the place's length; it is not beyond the shoulder.
/// * `shoulder`: counts from where the path begins.
// a call for each axis and side, at a stand
#[inline(never)]
pub fn free<'m>(motions: impl Iterator<Item = &'m Motion>, at: u64, shoulder: Shoulder) -> (u64, u64) {
    let (mut least, mut most) = (0, None);
    let (mut begin, mut shoulder) = (0_u64, shoulder);
    for motion in motions {
        let end = begin.saturating_add(motion.length);
        let within = at.saturating_sub(begin).min(motion.length);
        // the nearest one on either side is the last one before the place, and the first one behind it
        if at > begin
            && let Some(place) = motion.shoulder(within, true, shoulder)
        {
            least = begin.saturating_add(place);
        }
        if at < end && most.is_none() {
            most = motion.shoulder(within, false, shoulder).map(|place| begin.saturating_add(place));
        }
        let by = motion.curve.end();
        let by = if matches!(shoulder.axis, Axis::X) { by.0 } else { by.1 };
        shoulder.at = shoulder.at.wrapping_sub(by);
        begin = end;
    }
    (least, most.unwrap_or(begin))
}

impl Motion {
    /// Where travel from `from` on has to end so that it does not pass a shoulder; `None` where it may go on to the motion's
    /// end, `back` to its start. Lengths along the motion, nm with 12 fraction bits; at `from` it is not beyond the shoulder.
    ///
    /// The place is the motion's nearest one, and its axis is on the coordinate to the pulse; one pulse short where the slope of
    /// an arc is one, up to two on arcs of less than 64 pulses' radius, up to four by classic methods. Parts of ellipses and
    /// parabolas know no shoulders.
    fn shoulder(&self, from: u64, back: bool, shoulder: Shoulder) -> Option<u64> {
        let place = match &self.curve {
            Curve::Line(line, _) => self.on_line(*line, back, shoulder),
            Curve::Arc(arc) => on_arc(arc, from, back, shoulder.of_arc(arc)),
            #[cfg(feature = "methods")]
            Curve::ClassicLine(line, ..) => self.on_line(*line, back, shoulder.nearer(CLASSIC)),
            #[cfg(feature = "methods")]
            Curve::Conic(_) => None,
        }?;
        Some(if back { place.min(from) } else { place.max(from).min(self.length) })
    }

    fn on_line(&self, line: Line, back: bool, shoulder: Shoulder) -> Option<u64> {
        let along = match shoulder.axis {
            Axis::X => line.end().0,
            Axis::Z => line.end().1,
        };
        if shoulder.beyond(if back { 0 } else { i64::from(along) }, i64::from(shoulder.at)) <= 0 {
            return None;
        }
        let steps = i128::from(line.steps());
        // the line of the major axis nearest to the coordinate
        let (at, along) =
            if along < 0 { (shoulder.at.wrapping_neg(), along.wrapping_neg()) } else { (shoulder.at, along) };
        let step = scale(i128::from(at), steps, i128::from(along)).clamp(0, steps);
        Some(to_u64(scale(i128::from(self.length), step, steps)))
    }
}

/// A classic method may be a pulse and a half off the curve.
#[cfg(feature = "methods")]
const CLASSIC: i32 = 2;

/// Radius, pulses, from which an arc is as good as straight from one line of its major axis to the next.
const WIDE: u64 = 64;

impl Shoulder {
    /// So many pulses nearer.
    const fn nearer(self, pulses: i32) -> Self {
        let by = if self.plus { pulses.wrapping_neg() } else { pulses };
        Self { at: self.at.wrapping_add(by), ..self }
    }

    /// As near as it takes so that an arc's steps do not pass it.
    fn of_arc(self, arc: &Arc) -> Self {
        #[cfg(feature = "methods")]
        if !matches!(arc.method, Method::MinimumDeviation | Method::RateMultiplier | Method::Fraction) {
            return self.nearer(CLASSIC);
        }
        let [x, z] = arc.timeline.radius_pulses;
        if x.min(z) < WIDE << 16 { self.nearer(1) } else { self }
    }
}

/// The place on an arc: between two of its extremes an axis goes one way.
fn on_arc(arc: &Arc, from: u64, back: bool, shoulder: Shoulder) -> Option<u64> {
    let round = Round::new(arc);
    let end = if back { 0 } else { round.length };
    let mut quarter = round.quarters(from).0;
    // the last place known that is not beyond
    let mut inside = from;
    // on its coordinate the major axis may be nearly a pulse beyond it
    let mut before = shoulder.of_round(&round, from);
    for _ in 0..QUARTERS {
        if !back {
            quarter = quarter.wrapping_add(1);
        }
        let turned = quarter.wrapping_mul(QUARTER_Q30).wrapping_sub(round.start);
        if back {
            quarter = quarter.wrapping_sub(1);
        }
        let border = to_u64(i128::from(arc.radius()).wrapping_mul(i128::from(turned.max(0))) >> 30);
        let at = if back { border.min(inside) } else { border.max(inside).min(end) };
        let beyond = shoulder.of_round(&round, at);
        if beyond > TOUCHES && beyond > before {
            return Some(last_before(&round, arc, (inside, at), shoulder, back));
        }
        if beyond <= 0 {
            inside = at;
        }
        before = beyond;
        if at == end {
            return None;
        }
    }
    None
}

/// An arc turns by a whole turn at most, so it passes four quarters and begins and ends inside two of them.
const QUARTERS: u8 = 7;

/// The place before the one, between two lengths, where a point on an arc goes beyond.
fn last_before(round: &Round, arc: &Arc, between: (u64, u64), shoulder: Shoulder, back: bool) -> u64 {
    let (mut inside, mut beyond) = between;
    if shoulder.of_round(round, inside) > 0 {
        // it stands on the coordinate already
        return inside;
    }
    while inside.abs_diff(beyond) > FINE {
        let middle = inside.wrapping_add(beyond) >> 1;
        if shoulder.of_round(round, middle) > 0 {
            beyond = middle;
        } else {
            inside = middle;
        }
    }
    let (quarters, sine, cosine) = round.turned(inside);
    let (along, out) = if quarters & 1 == 0 { (cosine, sine) } else { (sine, cosine) };
    let [first, second] = round.radius;
    // pulses of the major axis a radian
    let rate = round.part(along, first).max(round.part(out, second)).max(1).unsigned_abs();
    let part = if back { BACK } else { FORWARD };
    let half = arc.radius().saturating_mul(part).checked_div(rate).unwrap_or(0);
    inside.saturating_add(half)
}
