//! Follows the tool through time: cuts the bar, notes what should not have been touched, measures the surface.

use crate::bar::{Bar, BarData, Taken};
use crate::collision::{Collision, Touched};
use crate::contour::{Contour, Sample};
use crate::geometry::Point;
use crate::sweep::Sweep;
use crate::tool::{Part, Tool};

/// Collisions that are kept.
pub(crate) const COLLISIONS_KEPT: usize = 100;
/// The tool is cutting as long as it takes something off at least so often, ns: pulses of one axis may take nothing.
const CUTTING: u64 = 50_000_000;
/// A longer move is followed in pieces of this, mm.
const PIECE: f64 = 0.1;
/// Most pieces of a move.
const MOST_PIECES: f64 = 100_000.0;
/// A cut that takes less than this of a column, mm, is rounding.
const NOTHING: f64 = 1e-7;

/// How the tool is moved.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Fast traverse: must not touch material.
    Rapid,
    /// Straight, circular or threading feed: cuts.
    Feed,
}

/// Where the tool is at a moment, as it really is: from the pulses, or from a model of the machine that follows them.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Motion {
    /// Since the start of the cycle, ns.
    pub time_ns: u64,
    /// The tool's programmed point: radius, nm.
    pub x_nm: f64,
    /// Along the axis, nm.
    pub z_nm: f64,
    /// The motion that brought it there.
    pub kind: Kind,
    /// Line of the program.
    pub line: u32,
}

impl Motion {
    fn place(&self) -> Point {
        Point::new(self.z_nm * 1e-6, self.x_nm * 1e-6)
    }
}

/// Chuck jaws: nothing may come behind their face within their diameter.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Jaws {
    /// Z of their face, mm.
    pub z: f64,
    /// Radius, mm.
    pub radius: f64,
}

/// What is clamped and what cuts it.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The bar.
    pub bar: BarData,
    /// The tool.
    pub tool: Tool,
    /// The chuck, if it is watched.
    pub jaws: Option<Jaws>,
    /// What should come out.
    pub contour: Contour,
    /// Less than this, mm, is not told: as a rule the coarser pulse.
    pub tolerance: f64,
}

/// How far the cut surface is from the contour, along its normals.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct SurfaceError {
    /// Mean of the magnitudes over the contour's length, um.
    pub mean_um: f64,
    /// Greatest magnitude, um.
    pub max_um: f64,
}

/// The outcome.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The bar as cut.
    pub bar: Bar,
    /// The contour with the depths reached.
    pub contour: Contour,
    /// Collisions in the order of time, at most 100.
    pub collisions: Vec<Collision>,
    /// All collisions.
    pub collisions_total: u64,
    /// Against the programmed contour; `None` if the program has none on the bar.
    pub surface: Option<SurfaceError>,
    /// Volume taken off, mm³.
    pub removed_mm3: f64,
    /// Volume left, mm³.
    pub left_mm3: f64,
    /// Time of feed motions in which the tool took something off, ns.
    pub cutting_ns: u64,
}

/// A collision while it lasts.
#[derive(Copy, Clone, Debug)]
struct Open {
    collision: Collision,
    /// Place in the list, once it is deep enough to be told.
    at: Option<usize>,
    /// Columns that it is deep enough in.
    columns: u32,
}

/// A cut in progress.
#[derive(Clone, Debug)]
pub struct Cutting {
    bar: Bar,
    tool: Tool,
    jaws: Option<Jaws>,
    contour: Contour,
    tolerance: f64,
    volume: f64,
    last: Option<Motion>,
    has_moved: bool,
    /// Whether the tool has been clear of the bar: one that begins inside it is not there.
    is_clear: bool,
    /// Number of the motion, counted by its line and kind.
    motion: u32,
    /// What each column lost to the motion that cut it last: its number and the loss, mm.
    losses: Vec<(u32, f32)>,
    /// Collisions of the motion in work.
    open: Vec<Open>,
    collisions: Vec<Collision>,
    total: u64,
    cutting_ns: u64,
    last_cut: Option<u64>,
}

impl Cutting {
    /// Before the first motion.
    #[must_use]
    pub fn new(setup: Setup) -> Self {
        let Setup { bar, tool, jaws, contour, tolerance } = setup;
        let bar = Bar::new(bar);
        Self {
            volume: bar.volume(),
            losses: vec![(0, 0.0); bar.len()],
            bar,
            tool,
            jaws,
            contour,
            tolerance,
            last: None,
            has_moved: false,
            is_clear: true,
            motion: 0,
            open: Vec::new(),
            collisions: Vec::new(),
            total: 0,
            cutting_ns: 0,
            last_cut: None,
        }
    }

    /// The bar as it stands.
    #[must_use]
    pub fn bar(&self) -> &Bar {
        &self.bar
    }

    /// The tool is at a place now, and came there in a straight line. The first call says where it is at the start: a
    /// tool that would stand inside the bar there is followed from when it is first clear of it.
    pub fn follow(&mut self, now: Motion) {
        let Some(last) = self.last.replace(now) else {
            let here = self.tool.centre(now.place());
            self.is_clear = !self.bar.meets(&Sweep::new(&self.tool, here, here));
            return;
        };
        if (last.kind, last.line) != (now.kind, now.line) {
            self.motion = self.motion.wrapping_add(1);
            self.open.clear();
        }
        let tool = self.tool;
        if !self.is_clear {
            let here = tool.centre(now.place());
            self.is_clear = !self.bar.meets(&Sweep::new(&tool, here, here));
            return;
        }
        let [from, to] = [last, now].map(|motion| tool.centre(motion.place()));
        // in pieces, so that what of the tool takes something off is told where the tool then is
        let parts = ((to - from).length() / PIECE).ceil().clamp(1.0, MOST_PIECES);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 1 to MOST_PIECES")]
        let count = parts as u32;
        let mut cut = false;
        let mut begin = from;
        for k in 1..=count {
            let end = if k == count { to } else { from + (to - from) * (f64::from(k) / parts) };
            let sweep = if self.has_moved { Sweep::next(&tool, begin, end) } else { Sweep::new(&tool, begin, end) };
            self.has_moved = true;
            let has_cut = self.cut(&sweep, &now);
            // a feed may reach between two columns what they don't show
            if has_cut || now.kind == Kind::Feed {
                self.mow(&sweep, &now);
            }
            cut |= has_cut;
            begin = end;
        }
        if now.kind == Kind::Feed {
            if cut {
                let since = self.last_cut.unwrap_or(last.time_ns).max(now.time_ns.saturating_sub(CUTTING));
                self.cutting_ns += now.time_ns.saturating_sub(since);
                self.last_cut = Some(now.time_ns);
            }
        } else {
            self.last_cut = None;
        }
        self.watch_chuck(to, &now);
    }

    /// Whether something was taken off.
    fn cut(&mut self, sweep: &Sweep<'_>, now: &Motion) -> bool {
        let (tool, tolerance) = (self.tool, self.tolerance);
        let motion = self.motion;
        let mut any = false;
        let Self { bar, losses, .. } = self;
        let mut found: [Option<(Taken, f64, u32)>; 2] = [None, None];
        bar.cut(sweep, |taken| {
            if taken.thickness < NOTHING {
                return;
            }
            any = true;
            let Some(loss) = losses.get_mut(taken.column) else { return };
            #[expect(clippy::cast_possible_truncation, reason = "a measure of depth; seven digits do")]
            let thickness = taken.thickness as f32;
            let before = if loss.0 == motion { f64::from(loss.1) } else { 0.0 };
            *loss = if loss.0 == motion { (motion, loss.1 + thickness) } else { (motion, thickness) };
            let depth = f64::from(loss.1);
            let is_new = u32::from(depth > tolerance && before <= tolerance);
            let mut find = |index: usize, depth: f64| {
                if let Some(place) = found.get_mut(index) {
                    let (first, most, count) = place.map_or((taken, 0.0, 0), |known| known);
                    *place = Some((first, f64::max(most, depth), count + is_new));
                }
            };
            if now.kind == Kind::Rapid {
                find(0, depth);
            }
            let reach = |x: f64| {
                let from = Point::new(taken.z, x) - sweep.to;
                from.dot(from)
            };
            let reach = reach(taken.radii[0]).max(reach(taken.radii[1]));
            if reach > tool.length * tool.length {
                let beyond = reach.sqrt() - tool.length;
                if beyond > tolerance && depth > tolerance {
                    find(1, beyond);
                }
            }
        });
        // a rapid that grazes a wall by a pulse is deep, but in a column or two only
        let least = (tolerance / self.bar.width()).ceil();
        for (touched, found) in [Touched::Rapid, Touched::Holder].into_iter().zip(found) {
            if let Some((taken, depth, columns)) = found {
                let place = Point::new(taken.z, taken.radii[1]);
                self.touch(touched, now, place, depth, columns, least);
            }
        }
        any
    }

    /// Follows the surface where the contour is.
    fn mow(&mut self, sweep: &Sweep<'_>, now: &Motion) {
        let tolerance = self.tolerance;
        let mut deep: Option<(Sample, Part)> = None;
        self.contour.mow(sweep, |sample, part| {
            if sample.depth > tolerance && deep.is_none_or(|(known, _)| sample.depth > known.depth) {
                deep = Some((*sample, part));
            }
        });
        if let Some((sample, part)) = deep {
            let touched = if part == Part::Nose { Touched::Deep } else { Touched::Edge(part) };
            self.touch(touched, now, sample.place, sample.depth, 1, 0.0);
        }
    }

    fn watch_chuck(&mut self, centre: Point, now: &Motion) {
        let Some(jaws) = self.jaws else { return };
        let tool = self.tool;
        let corners = tool.edges.map(|edge| centre + edge.along * tool.length + edge.normal * tool.nose);
        let nose = [centre - Point::new(tool.nose, 0.0), centre - Point::new(0.0, tool.nose)];
        let deepest = corners
            .into_iter()
            .chain(nose)
            .filter(|place| place.x.abs() < jaws.radius && place.z < jaws.z - self.tolerance)
            .min_by(|a, b| a.z.total_cmp(&b.z));
        if let Some(place) = deepest {
            self.touch(Touched::Chuck, now, place, jaws.z - place.z, 1, 0.0);
        }
    }

    /// Notes a collision, or that it goes on; it is told once it is deeper than the tolerance both ways.
    fn touch(&mut self, touched: Touched, now: &Motion, place: Point, depth: f64, columns: u32, least: f64) {
        let index = match self.open.iter().position(|open| open.collision.touched == touched) {
            Some(index) => index,
            None => {
                let collision = Collision { touched, time_ns: now.time_ns, line: now.line, place, depth };
                self.open.push(Open { collision, at: None, columns: 0 });
                self.open.len() - 1
            }
        };
        let Some(open) = self.open.get_mut(index) else { return };
        open.columns += columns;
        open.collision.depth = open.collision.depth.max(depth);
        if open.collision.depth <= self.tolerance || f64::from(open.columns) <= least {
            return;
        }
        match open.at {
            Some(at) => {
                if let Some(told) = self.collisions.get_mut(at) {
                    told.depth = open.collision.depth;
                }
            }
            None => {
                self.total += 1;
                open.at = Some(self.collisions.len());
                if self.collisions.len() < COLLISIONS_KEPT {
                    self.collisions.push(open.collision);
                }
            }
        }
    }

    /// Ends the cut.
    #[must_use]
    pub fn finish(self) -> Outcome {
        let Self { bar, mut contour, collisions, total, volume, cutting_ns, .. } = self;
        contour.measure_rest(&bar);
        let samples = contour.samples();
        let length: f64 = samples.iter().map(|sample| sample.weight).sum();
        let surface = (length > 0.0).then(|| SurfaceError {
            mean_um: samples.iter().map(|sample| sample.depth.abs() * sample.weight).sum::<f64>() / length * 1e3,
            max_um: samples.iter().map(|sample| sample.depth.abs()).fold(0.0, f64::max) * 1e3,
        });
        let left_mm3 = bar.volume();
        Outcome {
            bar,
            contour,
            collisions,
            collisions_total: total,
            surface,
            removed_mm3: volume - left_mm3,
            left_mm3,
            cutting_ns,
        }
    }
}
