//! A straight move of the tool: the convex hull of the tool at both its ends.
//!
//! Where a ray leaves the hull is told exactly. While the tool moves, the place where the ray leaves it is a concave
//! function of time, since the hull is convex; its greatest value lies where the tool's outline is parallel to the
//! move, or at an end of the move.

use crate::geometry::Point;
use crate::tool::{Part, Tool};

/// A move shorter than this part of the nose is taken as its end: what stays between two places of the nose is
/// `s²/(8 r)` high, here a 50 000th of the nose, 8 nm for 0.4 mm.
const SHORT: f64 = 1.0 / 79.0;

/// What a tool passes over in a straight move; the ends are places of the nose's centre.
#[derive(Copy, Clone, Debug)]
pub struct Sweep<'t> {
    pub(crate) tool: &'t Tool,
    pub(crate) from: Point,
    pub(crate) to: Point,
    /// The side of the hull that the nose draws, if it does: its normal.
    side: Option<Point>,
    is_short: bool,
    /// Where the tool's lower side moves into the work, if only that counts.
    lead: Lead,
}

/// Where along Z the lower side of a tool goes deeper than at the beginning of the move.
#[derive(Copy, Clone, Debug, PartialEq)]
enum Lead {
    Everywhere,
    Nowhere,
    Below(f64),
    Above(f64),
}

/// Where a ray leaves a sweep.
#[derive(Copy, Clone, Debug, PartialEq)]
pub(crate) struct Exit {
    /// Along the ray.
    pub(crate) at: f64,
    /// The nose's centre at that moment.
    pub(crate) centre: Point,
}

impl<'t> Sweep<'t> {
    /// The move of the nose's centre from one place to another.
    #[must_use]
    pub fn new(tool: &'t Tool, from: Point, to: Point) -> Self {
        let way = to - from;
        let length = way.length();
        let is_short = length <= SHORT * tool.nose();
        let side = if length > 0.0 {
            let across = way.left() * (1.0 / length);
            [across, -across].into_iter().find(|side| tool.touches(*side))
        } else {
            None
        };
        Self { tool, from, to, side, is_short, lead: Lead::Everywhere }
    }

    /// The same, where the tool has cut already at the beginning of the move.
    #[must_use]
    pub fn next(tool: &'t Tool, from: Point, to: Point) -> Self {
        let mut sweep = Self::new(tool, from, to);
        if tool.points_down && sweep.is_short {
            let way = to - from;
            sweep.lead = match sweep.side.filter(|side| side.x < 0.0) {
                // the lower side's normals turn from the left to the right of it
                // on, by the move itself, from where it does so at the end to where it did at the beginning
                Some(side) if way.z < 0.0 => Lead::Below(to.z + tool.nose() * side.z + way.length()),
                Some(side) => Lead::Above(to.z + tool.nose() * side.z - way.length()),
                None if way.dot(tool.edges[0].normal) > 0.0 || way.dot(tool.edges[1].normal) > 0.0 => Lead::Everywhere,
                None => Lead::Nowhere,
            };
        }
        sweep
    }

    /// Whether nothing that is material between two radii, at `low <= z <= high`, can be taken away.
    #[inline]
    pub(crate) fn misses(&self, [low, high]: [f64; 2], [bottom, top]: [f64; 2]) -> bool {
        if bottom >= top {
            return true;
        }
        let is_behind = match self.lead {
            Lead::Everywhere => false,
            Lead::Nowhere => true,
            Lead::Below(z) => low > z,
            Lead::Above(z) => high < z,
        };
        // what stands above the nose's centre may hang over the tool
        if is_behind && top <= self.to.x {
            return true;
        }
        let nose = self.tool.nose();
        if self.tool.points_down && self.from.x.min(self.to.x) - nose >= top {
            return true;
        }
        if self.tool.points_up && self.from.x.max(self.to.x) + nose <= bottom {
            return true;
        }
        let (near, far) = if self.from.z < self.to.z { (self.from.z, self.to.z) } else { (self.to.z, self.from.z) };
        // the hull's lower side is convex and its upper side concave: beside the nose, the deepest is at the near end
        let edge = if high < near - nose {
            high
        } else if low > far + nose {
            low
        } else {
            return false;
        };
        match self.radii(edge) {
            None => true,
            Some([low, high]) => (self.tool.points_down && low >= top) || (self.tool.points_up && high <= bottom),
        }
    }

    /// Where the ray from `place` along the unit vector `way` leaves the sweep for good.
    #[inline]
    pub(crate) fn exit(&self, place: Point, way: Point) -> Option<Exit> {
        let end = |centre: Point| self.tool.span(centre, place, way).map(|[_, at]| Exit { at, centre });
        if self.is_short {
            return end(self.to);
        }
        if let Some(side) = self.side {
            let slope = way.dot(side);
            if slope > 1e-12 {
                let at = (self.tool.nose() - (place - self.from).dot(side)) / slope;
                let chord = self.to - self.from;
                let contact = place + way * at - side * self.tool.nose() - self.from;
                let part = contact.dot(chord) / chord.dot(chord);
                if part < 0.0 {
                    return end(self.from);
                }
                if part > 1.0 {
                    return end(self.to);
                }
                return Some(Exit { at, centre: self.from + chord * part });
            }
        }
        match (end(self.from), end(self.to)) {
            (Some(a), Some(b)) => Some(if a.at > b.at { a } else { b }),
            (a, b) => a.or(b),
        }
    }

    /// The radii that the sweep covers at `z`, from the lower to the upper end.
    #[inline]
    pub(crate) fn radii(&self, z: f64) -> Option<[f64; 2]> {
        if self.is_short {
            return self.tool.radii(self.to, z);
        }
        let foot = Point::new(z, 0.0);
        let high = self.exit(foot, Point::new(0.0, 1.0))?;
        let low = self.exit(foot, Point::new(0.0, -1.0))?;
        Some([-low.at, high.at])
    }

    /// What of the tool's outline the ray leaves it by.
    pub(crate) fn part(&self, exit: Exit, place: Point, way: Point) -> Part {
        self.tool.part_at(place + way * exit.at - exit.centre)
    }
}
