//! Where an arc of more than half a turn is divided.

use super::builder::length;
use crate::curve::prepare_arc::Reach;
use crate::math::{Wide, scale, to_i64};
use crate::units::{Length, Point, Sense};

/// How an arc is walked.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Split {
    /// In one.
    Whole(Reach),
    /// In two, joined at its half-way point, which lies at the mean of start and end radius and is rounded to the
    /// nanometre, a half toward plus infinity.
    Halves(Point),
    /// Not at all: the half-way point is past the range of [`Length`].
    OutOfRange,
}

/// Splits an arc that turns by more than half a turn (a full circle where the end is the start).
///
/// Split arcs keep the walked circle near the programmed one: moving a centre onto the bisector of two ends that lie
/// close together on a nearly full circle would move it by up to the radius.
pub fn split(start: Point, end: Point, centre: (i64, i64), sense: Sense) -> Split {
    let from = |p: Point| {
        (i128::from(i64::from(p.x.nm()).wrapping_sub(centre.0)), i128::from(i64::from(p.z.nm()).wrapping_sub(centre.1)))
    };
    let ((sx, sz), (ex, ez)) = (from(start), from(end));
    let turn = |cross: i128| match sense {
        Sense::CounterClockwise => cross,
        Sense::Clockwise => cross.wrapping_neg(),
    };
    // positive for less than half a turn, zero for half a turn or none
    let cross = turn(sz.times(ex).wrapping_sub(sx.times(ez)));
    let along = sx.times(ex).wrapping_add(sz.times(ez));
    if cross > 0 || (cross == 0 && along < 0) {
        return Split::Whole(Reach::Short);
    }
    // radii with 16 fraction bits, and both vectors brought to one length, so that the bisector halves the angle
    let (radius_s, radius_e) = (length(sx << 16, sz << 16), length(ex << 16, ez << 16));
    let mean = radius_s.wrapping_add(radius_e) >> 1;
    let (sx, sz) = (sx.times(radius_e), sz.times(radius_e));
    let (ex, ez) = (ex.times(radius_s), ez.times(radius_s));
    // the better conditioned of two ways: against the sum of both, or square to their difference
    let opposite = (sx.wrapping_add(ex).wrapping_neg(), sz.wrapping_add(ez).wrapping_neg());
    let (cx, cz) = (ex.wrapping_sub(sx), ez.wrapping_sub(sz));
    let square = match sense {
        Sense::CounterClockwise => (cz.wrapping_neg(), cx),
        Sense::Clockwise => (cz, cx.wrapping_neg()),
    };
    let (x, z) = if length(opposite.0, opposite.1) > length(square.0, square.1) { opposite } else { square };
    let bits = 128_u32.wrapping_sub(x.unsigned_abs().max(z.unsigned_abs()).leading_zeros());
    let (x, z) = (x.wrapping_shr(bits.saturating_sub(62)), z.wrapping_shr(bits.saturating_sub(62)));
    let reach = length(x, z).max(1) << 16;
    let place = |centre: i64, part: i128| {
        let off = scale(part, mean, reach);
        Length::from_nm(to_i64(i128::from(centre).wrapping_add(off)))
    };
    match (place(centre.0, x), place(centre.1, z)) {
        (Some(x), Some(z)) => Split::Halves(Point { x, z }),
        _ => Split::OutOfRange,
    }
}
