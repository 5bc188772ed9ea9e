//! What is kept of a motion on the way back: 32 bytes, of which it can be made again.
//!
//! | word | bits |
//! | --- | --- |
//! | 0 | line of the program |
//! | 1 | X of the end (30), whether the path stands before it, 0 |
//! | 2 | Z of the end (30), whether the curve goes on, whether it is an arc |
//! | 3 | speed of the joint |
//! | 4 | feed: path a tick, or nm a turn |
//! | 5 to 7 | the centre's X and Z (45 each), sense, reach, kind of feed (2), whether more follows, whether it can be made |
//!
//! Few motions need more, and get a second one: threads, leads that are no whole nanometres, halves of an arc (whose limit
//! is that of both), and centres beyond 45 bits (1 m, where pulses are 4096ths of nanometres, else kilometres).
//!
//! | word | bits |
//! | --- | --- |
//! | 0, 2 | the lead's fraction: numerator, denominator |
//! | 1 | start of the thread (16), 0, 1 |
//! | 3 | limit |
//! | 4 to 7 | the centre's X and Z (64 each) |

use crate::block::Feed;
use crate::block::again::{Outline, Shape};
use crate::curve::preparation::Round;
use crate::curve::prepare_arc::Reach;
use crate::drive::gearing::Lead;
use crate::math::to_u32;
use crate::units::Sense;

/// 32 bytes of the history.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) struct Slot([u32; 8]);

const REST: u32 = 1;
const APART: u32 = 2;
const ARC: u32 = 1;
const CONTINUES: u32 = 2;

/// Flags above the centre.
const CLOCKWISE: u32 = 1 << 26;
const LONG_WAY: u32 = 1 << 27;
const FEED: u32 = 28;
const LONG: u32 = 1 << 30;
const LOST: u32 = 1 << 31;

/// Bits of a centre's coordinate.
const ABOUT: u32 = 45;
/// Of those of Z, the ones that stand beside X.
const SPLIT: u32 = 64 - ABOUT;

/// A motion as it is kept.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) struct Kept {
    /// Line of the program.
    pub(super) line: u32,
    /// The path stands before it.
    pub(super) apart: bool,
    /// What it can be made of; `None` where that is too much.
    pub(super) outline: Option<Outline>,
}

const fn lower(word: u64) -> u32 {
    to_u32(word & 0xFFFF_FFFF)
}

const fn joined(low: u32, high: u32) -> u64 {
    low as u64 | (high as u64) << 32
}

/// The upper 30 bits hold a number with its sign.
const fn number(word: u32) -> i32 {
    word.cast_signed() >> 2
}

/// Extends the sign of a centre's coordinate.
const fn coordinate(bits: u64) -> i64 {
    (bits << (64 - ABOUT)).cast_signed() >> (64 - ABOUT)
}

const fn fits(about: i64) -> bool {
    coordinate(about.cast_unsigned()) == about
}

impl Slot {
    /// Empty.
    pub(super) const NONE: Self = Self([0; 8]);

    /// One slot, or two.
    pub(super) fn pack(kept: &Kept) -> (Self, Option<Self>) {
        let apart = if kept.apart { APART } else { 0 };
        let Some(outline) = &kept.outline else {
            return (Self([kept.line, apart, 0, 0, 0, 0, 0, LOST]), None);
        };
        let (round, arc, clockwise) = match outline.shape {
            Shape::Line => (Round { about: (0, 0), reach: Reach::Short }, 0, 0),
            Shape::Arc(round, Sense::CounterClockwise) => (round, ARC, 0),
            Shape::Arc(round, Sense::Clockwise) => (round, ARC, CLOCKWISE),
        };
        let (kind, feed, (part, per), start) = match outline.feed {
            Feed::Rapid => (0, 0, (0, 1), 0),
            Feed::PerTick(speed) => (1, speed, (0, 1), 0),
            Feed::PerTurn(lead) => {
                let (nm, part, per) = lead.parts();
                (2, nm, (part, per), 0)
            }
            Feed::Thread(lead, start) => {
                let (nm, part, per) = lead.parts();
                (3, nm, (part, per), start)
            }
        };
        let (about_x, about_z) = round.about;
        let usual = (part, per, start, outline.limit) == (0, 1, 0, None) && fits(about_x) && fits(about_z);
        let rest = Self([
            part,
            u32::from(start) << 2 | REST,
            per,
            outline.limit.unwrap_or(u32::MAX),
            lower(about_x.cast_unsigned()),
            lower(about_x.cast_unsigned() >> 32),
            lower(about_z.cast_unsigned()),
            lower(about_z.cast_unsigned() >> 32),
        ]);
        let (x, z) = if usual { (about_x.cast_unsigned(), about_z.cast_unsigned()) } else { (0, 0) };
        let low = x & ((1 << ABOUT) - 1) | z << ABOUT;
        let high = lower(z >> SPLIT) & (CLOCKWISE - 1);
        let long_way = if matches!(round.reach, Reach::Long) { LONG_WAY } else { 0 };
        let flags = clockwise | long_way | kind << FEED | if usual { 0 } else { LONG };
        let main = Self([
            kept.line,
            outline.end.0.cast_unsigned() << 2 | apart,
            outline.end.1.cast_unsigned() << 2 | if outline.continues { CONTINUES } else { 0 } | arc,
            outline.joint,
            feed,
            lower(low),
            lower(low >> 32),
            high | flags,
        ]);
        (main, if usual { None } else { Some(rest) })
    }

    /// The line of the program of the first of two.
    pub(super) const fn line(&self) -> u32 {
        let Self([line, ..]) = *self;
        line
    }

    /// Whether this is the second of two.
    pub(super) const fn is_rest(&self) -> bool {
        let Self([_, word, ..]) = *self;
        word & REST != 0
    }

    /// Whether the motion can be made again.
    pub(super) const fn can_be_made(&self) -> bool {
        let Self([.., word]) = *self;
        word & LOST == 0
    }

    /// The motion of a slot and the one after it.
    pub(super) fn unpack(&self, next: &Self) -> Kept {
        let Self([line, x, z, joint, feed, low, middle, high]) = *self;
        let Self([part, start, per, limit, x_low, x_high, z_low, z_high]) = *next;
        let apart = x & APART != 0;
        if high & LOST != 0 {
            return Kept { line, apart, outline: None };
        }
        let long = high & LONG != 0;
        let about = if long {
            (joined(x_low, x_high).cast_signed(), joined(z_low, z_high).cast_signed())
        } else {
            let low = joined(low, middle);
            (coordinate(low), coordinate(low >> ABOUT | u64::from(high) << SPLIT))
        };
        let (part, per) = if long { (part, per) } else { (0, 1) };
        let lead = Lead::of_parts((feed, part, per));
        let feed = match high >> FEED & 3 {
            0 => Feed::Rapid,
            1 => Feed::PerTick(feed),
            2 => Feed::PerTurn(lead),
            _ => Feed::Thread(lead, u16::try_from(start >> 2).unwrap_or(0)),
        };
        let reach = if high & LONG_WAY != 0 { Reach::Long } else { Reach::Short };
        let sense = if high & CLOCKWISE != 0 { Sense::Clockwise } else { Sense::CounterClockwise };
        let arc = z & ARC != 0;
        let outline = Outline {
            shape: if arc { Shape::Arc(Round { about, reach }, sense) } else { Shape::Line },
            end: (number(x), number(z)),
            feed,
            joint,
            continues: z & CONTINUES != 0,
            limit: (long && arc && limit != u32::MAX).then_some(limit),
        };
        Kept { line, apart, outline: Some(outline) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn feed() -> impl Strategy<Value = Feed> {
        let lead = (1_u32..=1 << 31, prop_oneof![Just((0_u32, 1_u32)), (0_u32..99, 99_u32..=1 << 30)])
            .prop_map(|(nm, (part, per))| Lead::of_parts((nm, part, per)));
        prop_oneof![
            Just(Feed::Rapid),
            any::<u32>().prop_map(Feed::PerTick),
            lead.clone().prop_map(Feed::PerTurn),
            (lead, any::<u16>()).prop_map(|(lead, start)| Feed::Thread(lead, start)),
        ]
    }

    fn shape() -> impl Strategy<Value = Shape> {
        let edge = 1_i64 << (ABOUT - 1);
        let about = prop_oneof![-edge..edge, any::<i64>(), edge - 2..edge + 2, -edge - 2..-edge + 2, -9_i64..9];
        let arc = (about.clone(), about, any::<bool>(), any::<bool>()).prop_map(|(x, z, long, clockwise)| {
            let reach = if long { Reach::Long } else { Reach::Short };
            let sense = if clockwise { Sense::Clockwise } else { Sense::CounterClockwise };
            Shape::Arc(Round { about: (x, z), reach }, sense)
        });
        prop_oneof![Just(Shape::Line), arc]
    }

    proptest! {
        /// Whatever a builder can make: ends of up to 2^29 pulses, feeds and centres in their range.
        #[test]
        fn what_is_kept_comes_back(
            line: u32, apart: bool, continues: bool, joint: u32, shape in shape(), feed in feed(),
            end in (-(1_i32 << 29)..1 << 29, -(1_i32 << 29)..1 << 29),
            limit in prop::option::of(1_u32..u32::MAX), lost in prop::bool::weighted(0.05),
        ) {
            let limit = limit.filter(|_| matches!(shape, Shape::Arc(..)));
            let outline = Outline { shape, end, feed, joint, continues, limit };
            let kept = Kept { line, apart, outline: (!lost).then_some(outline) };
            let (main, rest) = Slot::pack(&kept);
            prop_assert_eq!(main.unpack(&rest.unwrap_or(Slot([u32::MAX; 8]))), kept);
            prop_assert!(!main.is_rest() && main.can_be_made() != lost);
            prop_assert!(rest.is_none_or(|rest| rest.is_rest()));
        }
    }

    #[test]
    fn a_motion_is_32_bytes() {
        assert_eq!(size_of::<Slot>(), 32);
        let about = (-4_200_000_000, 4_200_000_000);
        let outline = Outline {
            shape: Shape::Arc(Round { about, reach: Reach::Long }, Sense::Clockwise),
            end: (-3, 4),
            feed: Feed::PerTurn(Lead::new(200_000, 1).unwrap()),
            joint: 5,
            continues: false,
            limit: None,
        };
        assert_eq!(Slot::pack(&Kept { line: 1, apart: false, outline: Some(outline) }).1, None, "one is enough");
    }
}
