//! The shape of a turning tool, and where rays leave it.
//!
//! A tool is a wedge between its two cutting edges whose corner is rounded by the nose: every point within the nose
//! radius of a sharp wedge that stands on the nose's centre. It is convex and has no end; what lies farther from the
//! nose than the edges are long is the holder.

use std::fmt;

use crate::geometry::Point;

/// What a tool is made from, as an operator types it.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct ToolData {
    /// Nose radius, mm; 0 is a sharp corner.
    pub nose: f64,
    /// Tip direction, 1 to 9, as lathe controls number it: where the programmed point (the imaginary tip) lies as seen
    /// from the nose's centre. With Z to the right and X upward: 1 right above, 2 left above, 3 left below, 4 right
    /// below, 5 right, 6 above, 7 left, 8 below, 9 the centre itself.
    pub tip: u8,
    /// Direction of the front edge (towards the chuck), degrees counter-clockwise from +Z, for tips 3, 8 and 9; other
    /// tips are that tool mirrored or turned.
    pub front: f64,
    /// Direction of the back edge, likewise; less than `front`.
    pub back: f64,
    /// Usable length of the cutting edges, mm.
    pub edge: f64,
}

/// Why there is no such tool.
#[derive(Copy, Clone, Debug, PartialEq)]
pub enum ToolError {
    /// The nose radius is negative or no number.
    Nose(f64),
    /// The tip direction is not one of 1 to 9.
    Tip(u8),
    /// The edges do not enclose a wedge of 1 to 179 degrees.
    Wedge {
        /// Front edge, degrees.
        front: f64,
        /// Back edge, degrees.
        back: f64,
    },
    /// The edges are shorter than the nose radius.
    Edge {
        /// Their length, mm.
        edge: f64,
        /// Nose radius, mm.
        nose: f64,
    },
}

impl fmt::Display for ToolError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nose(nose) => write!(f, "a nose radius of {nose} mm: it is 0 or more"),
            Self::Tip(tip) => write!(f, "tip direction {tip}: it is 1 to 9"),
            Self::Wedge { front, back } => {
                write!(f, "front edge at {front} and back edge at {back} degrees enclose no tool: ")?;
                f.write_str("the front edge lies 1 to 179 degrees beyond the back edge")
            }
            Self::Edge { edge, nose } => {
                write!(f, "cutting edges of {edge} mm with a nose radius of {nose} mm: they are longer than that")
            }
        }
    }
}

impl std::error::Error for ToolError {}

/// A part of the tool's outline.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Part {
    /// The round corner.
    Nose,
    /// The edge towards the chuck (of an outside tool).
    Front,
    /// The edge that follows.
    Back,
}

/// A cutting edge: a ray from the nose.
#[derive(Copy, Clone, Debug, PartialEq)]
pub(crate) struct Edge {
    pub(crate) along: Point,
    /// Unit vector out of the tool.
    pub(crate) normal: Point,
    pub(crate) part: Part,
    /// One over the normal's X; 0 for an edge across the axis.
    across: f64,
}

impl Edge {
    fn new(along: Point, normal: Point, part: Part) -> Self {
        let across = if normal.x.abs() > 1e-12 { 1.0 / normal.x } else { 0.0 };
        Self { along, normal, part, across }
    }
}

/// A tool that is checked.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Tool {
    pub(crate) nose: f64,
    pub(crate) length: f64,
    /// From the programmed point to the nose's centre.
    pub(crate) offset: Point,
    /// Counter-clockwise of the body, and clockwise of it.
    pub(crate) edges: [Edge; 2],
    /// Whether the nose is its lowest place.
    pub(crate) points_down: bool,
    /// Whether the nose is its highest place.
    pub(crate) points_up: bool,
    tip: u8,
}

/// Below this, in mm, a nose is a sharp corner: far less than a pulse.
const SHARP: f64 = 1e-9;

impl Tool {
    /// Checks the data.
    ///
    /// # Errors
    /// [`ToolError`], which names the value.
    pub fn new(data: ToolData) -> Result<Self, ToolError> {
        let ToolData { nose, tip, front, back, edge } = data;
        if !(nose >= 0.0 && nose.is_finite()) {
            return Err(ToolError::Nose(nose));
        }
        if !(1..=9).contains(&tip) {
            return Err(ToolError::Tip(tip));
        }
        if !(1.0..=179.0).contains(&(front - back)) {
            return Err(ToolError::Wedge { front, back });
        }
        if !(edge > nose && edge.is_finite()) {
            return Err(ToolError::Edge { edge, nose });
        }
        // the tool of tips 3, 8 and 9, then turned or mirrored
        let turn = if matches!(tip, 5 | 7) { -90.0 } else { 0.0 };
        let mirror = |angle: f64| {
            let mut way = Point::at_degrees(angle + turn);
            if matches!(tip, 1 | 4 | 5) {
                way.z = -way.z;
            }
            if matches!(tip, 1 | 2 | 6) {
                way.x = -way.x;
            }
            way
        };
        let (front, back) = (mirror(front), mirror(back));
        let (ccw, cw, parts) = if back.cross(front) > 0.0 {
            (front, back, [Part::Front, Part::Back])
        } else {
            (back, front, [Part::Back, Part::Front])
        };
        let edges = [Edge::new(ccw, ccw.left(), parts[0]), Edge::new(cw, -cw.left(), parts[1])];
        let [z, x] = match tip {
            1 => [1.0, 1.0],
            2 => [-1.0, 1.0],
            3 => [-1.0, -1.0],
            4 => [1.0, -1.0],
            5 => [1.0, 0.0],
            6 => [0.0, 1.0],
            7 => [-1.0, 0.0],
            8 => [0.0, -1.0],
            _ => [0.0, 0.0],
        };
        let offset = Point::new(-z * nose, -x * nose);
        let mut tool = Self { nose, length: edge, offset, edges, points_down: false, points_up: false, tip };
        tool.points_down = tool.touches(Point::new(0.0, -1.0));
        tool.points_up = tool.touches(Point::new(0.0, 1.0));
        Ok(tool)
    }

    /// Nose radius, mm.
    #[must_use]
    pub fn nose(&self) -> f64 {
        self.nose
    }

    /// Centre of the nose while the programmed point is at `place`.
    #[must_use]
    pub fn centre(&self, place: Point) -> Point {
        place + self.offset
    }

    /// Whether it cuts away from the axis, as a boring bar does.
    #[must_use]
    pub fn is_inside(&self) -> bool {
        matches!(self.tip, 1 | 2 | 6)
    }

    /// Whether it cuts along Z only, as a face grooving tool does.
    #[must_use]
    pub fn is_facing(&self) -> bool {
        matches!(self.tip, 5 | 7)
    }

    /// The outline from the end of one edge round the nose to the end of the other, for the centre at `centre`; the
    /// nose in `parts` chords.
    #[must_use]
    pub fn outline(&self, centre: Point, parts: u32) -> Vec<Point> {
        let [ccw, cw] = self.edges;
        let on = |edge: &Edge, far: f64| centre + edge.along * far + edge.normal * self.nose;
        let mut points = vec![on(&ccw, self.length), on(&ccw, 0.0)];
        let (begin, sweep) = self.nose_angles();
        for k in 1..parts {
            let angle = begin + sweep * f64::from(k) / f64::from(parts);
            points.push(centre + Point::at_degrees(angle) * self.nose);
        }
        points.push(on(&cw, 0.0));
        points.push(on(&cw, self.length));
        points
    }

    /// Where the nose's outward normals begin, and how far they turn, in degrees counter-clockwise.
    pub(crate) fn nose_angles(&self) -> (f64, f64) {
        let [ccw, cw] = self.edges;
        let angle = |p: Point| p.x.atan2(p.z).to_degrees();
        let begin = angle(ccw.normal);
        (begin, (angle(cw.normal) - begin).rem_euclid(360.0))
    }

    /// Whether the nose can lie against a surface with the inward normal `normal`: else an edge lies in the work.
    #[must_use]
    pub fn touches(&self, normal: Point) -> bool {
        let [ccw, cw] = self.edges;
        ccw.normal.cross(normal) >= -1e-12 && normal.cross(cw.normal) >= -1e-12
    }

    /// Which edge would be in the work at a surface with this inward normal.
    #[must_use]
    pub fn obstacle(&self, normal: Point) -> Part {
        let [ccw, cw] = self.edges;
        if ccw.normal.dot(normal) > cw.normal.dot(normal) { ccw.part } else { cw.part }
    }

    /// The stretch of the line `place + s * way` that lies in the tool with its nose's centre at `centre`; `way` is a
    /// unit vector. The ends may be infinite.
    pub(crate) fn span(&self, centre: Point, place: Point, way: Point) -> Option<[f64; 2]> {
        let from = place - centre;
        let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
        for edge in &self.edges {
            let slope = way.dot(edge.normal);
            let room = self.nose - from.dot(edge.normal);
            if slope > 1e-15 {
                leave = leave.min(room / slope);
            } else if slope < -1e-15 {
                enter = enter.max(room / slope);
            } else if room < 0.0 {
                return None;
            }
        }
        if enter > leave {
            return None;
        }
        if self.nose > SHARP {
            // an end in the sharp corner that the nose rounds off moves onto the nose
            let at_corner = [enter, leave].map(|s| s.is_finite() && self.is_at_corner(from + way * s));
            if at_corner.contains(&true) {
                let middle = -from.dot(way);
                let aside = from.cross(way);
                let half = (self.nose * self.nose - aside * aside).sqrt();
                if half.is_nan() {
                    return None;
                }
                let [at_enter, at_leave] = at_corner;
                if at_enter {
                    enter = middle - half;
                }
                if at_leave {
                    leave = middle + half;
                }
            }
        }
        (enter <= leave).then_some([enter, leave])
    }

    /// The radii that the tool covers at `z`: [`Tool::span`] of a line across the axis, and most of the work.
    #[inline]
    pub(crate) fn radii(&self, centre: Point, z: f64) -> Option<[f64; 2]> {
        let aside = z - centre.z;
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        for Edge { normal, across, .. } in &self.edges {
            let room = self.nose - aside * normal.z;
            if *across > 0.0 {
                high = high.min(room * across);
            } else if *across < 0.0 {
                low = low.max(room * across);
            } else if room < 0.0 {
                return None;
            }
        }
        if low > high {
            return None;
        }
        let is_at_corner = |x: f64| x.is_finite() && self.is_at_corner(Point::new(aside, x));
        let at_corner = [is_at_corner(low), is_at_corner(high)];
        if self.nose > SHARP && (at_corner[0] || at_corner[1]) {
            let square = self.nose * self.nose - aside * aside;
            if square < 0.0 {
                return None;
            }
            let half = square.sqrt();
            if at_corner[0] {
                low = -half;
            }
            if at_corner[1] {
                high = half;
            }
        }
        Some([centre.x + low, centre.x + high])
    }

    /// Whether a point, as seen from the nose's centre, lies in front of the nose and not of an edge.
    fn is_at_corner(&self, from: Point) -> bool {
        let [ccw, cw] = self.edges;
        // inside the angle between the normals, which the corner has
        from.dot(ccw.along) < 0.0 && from.dot(cw.along) < 0.0
    }

    /// What the tool's outline is at a point of it, as seen from the nose's centre.
    pub(crate) fn part_at(&self, from: Point) -> Part {
        let [ccw, cw] = self.edges;
        let (a, b) = (from.dot(ccw.along), from.dot(cw.along));
        if a <= 0.0 && b <= 0.0 {
            Part::Nose
        } else if (from.dot(ccw.normal) - self.nose).abs() < (from.dot(cw.normal) - self.nose).abs() {
            ccw.part
        } else {
            cw.part
        }
    }
}
