//! Paths of the machine's own: the contour that power and linked feed follow, and straight feeds to a stop.
//!
//! They are built here, at standstill, of the figures that an operator has entered, and taken by the channel like a program's
//! blocks. A contour begins where the tool stands when it is first driven.

use heapless::Deque;
use interp_core::block::{Block, Builder, Feed, Motion, Pace, Path, Work};
use interp_core::config::Machine;
use interp_core::units::{Lattice, Length, Point, PulseSize, Sense};

/// A contour as entered, from where the tool stands; X as a radius.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Contour {
    /// Straight to this point.
    Taper(Point),
    /// Round to this point; a full circle where it is the start.
    Arc {
        /// The end.
        end: Point,
        /// The centre.
        centre: Point,
        /// Sense of travel.
        sense: Sense,
    },
}

/// Blocks of the machine's own.
#[derive(Clone, Debug, Default)]
pub(super) struct Own {
    blocks: Deque<Block, 4>,
}

impl Own {
    pub(super) const fn new() -> Self {
        Self { blocks: Deque::new() }
    }

    /// The next one.
    pub(super) fn next(&mut self) -> Option<Block> {
        self.blocks.pop_front()
    }

    pub(super) fn clear(&mut self) {
        self.blocks.clear();
    }

    /// Straight from one place to another. False where they are one.
    pub(super) fn line(&mut self, machine: &Machine, from: Lattice, to: Lattice, feed: Feed) -> bool {
        let (Some(start), Some(end)) = (point(machine, from), point(machine, to)) else { return false };
        let built = self.build(machine, start, Path::Line, end);
        for block in &mut self.blocks {
            if let Work::Motion(motion) = &mut block.work {
                motion.set_feed(feed);
            }
        }
        built
    }

    /// A contour from a place on, as fast as the axes allow. False where it can't be followed.
    pub(super) fn contour(&mut self, machine: &Machine, from: Lattice, contour: &Contour) -> bool {
        let Some(start) = point(machine, from) else { return false };
        let (path, end) = match *contour {
            Contour::Taper(end) => (Path::Line, end),
            Contour::Arc { end, centre, sense } => {
                let centre = (along(start.x, centre.x), along(start.z, centre.z));
                (Path::Arc { centre, sense }, end)
            }
        };
        let (Some(x), Some(z)) = (Length::from_nm(along(start.x, end.x)), Length::from_nm(along(start.z, end.z)))
        else {
            return false;
        };
        self.build(machine, start, path, Point { x, z })
    }

    /// Its motions.
    pub(super) fn motions(&self) -> impl Iterator<Item = &Motion> {
        self.blocks.iter().filter_map(|block| if let Work::Motion(motion) = &block.work { Some(motion) } else { None })
    }

    /// Of each block: the least and the greatest place that it leads through, and its end, pulses from its start.
    pub(super) fn extents(&self) -> impl Iterator<Item = (Lattice, Lattice, Lattice)> + '_ {
        let at = |(x, z): (i32, i32)| Lattice { x, z };
        self.motions().map(move |motion| {
            let (least, most) = motion.curve.extent();
            (at(least), at(most), at(motion.curve.end()))
        })
    }

    /// A path as fast as the axes allow.
    fn build(&mut self, machine: &Machine, start: Point, path: Path, end: Point) -> bool {
        self.blocks.clear();
        let built = Builder::new(machine, start).motion(path, end, Pace::Rapid);
        for motion in &built.motions {
            // at most two
            let _ = self.blocks.push_back(Block { line: 0, work: Work::Motion(*motion) });
        }
        built.refused.is_none() && !self.blocks.is_empty()
    }
}

fn along(from: Length, by: Length) -> i64 {
    i64::from(from.nm()).wrapping_add(i64::from(by.nm()))
}

/// A lattice point in nm, rounded; it rounds back to itself. `None` beyond the range of lengths.
pub(super) fn point(machine: &Machine, at: Lattice) -> Option<Point> {
    Some(Point { x: length(machine.x.pulse, at.x)?, z: length(machine.z.pulse, at.z)? })
}

/// So many pulses in nm, rounded.
pub fn length(pulse: PulseSize, pulses: i32) -> Option<Length> {
    let (numerator, denominator) = (i64::from(pulse.numerator()), i64::from(pulse.denominator()));
    let nm = i64::from(pulses).wrapping_mul(numerator).wrapping_add(denominator >> 1);
    Length::from_nm(nm.checked_div_euclid(denominator)?)
}
