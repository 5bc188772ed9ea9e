//! Follows the work while a program runs: the stock that is cut, the times of the cycle, the course of the motion, and
//! moments of it for an animation.

use feature_editor::codes::{Action, Feed, Item};
use figures::Figures;
use interp_core::units::{Point, Sense};
use machine::Place;
use stock::{Clamped, Curve, Cutting, Motion, Outcome, SetupError};

use crate::course::Course;
use crate::picture::Kind;

/// Curves of a program whose contour is followed: 16 MB of them.
const CURVES_KEPT: usize = 200_000;
/// Moments that are kept for an animation, at least half of them and at most all.
const MOMENTS: usize = 128;
/// Slides that have moved by less, mm, stand.
const STANDING: f64 = 1e-9;
/// Tolerance of an outline that is drawn, mm.
const OUTLINE: f64 = 0.002;

/// A place in the half plane of the work, mm.
fn place(point: Point) -> stock::Point {
    stock::Point::new(f64::from(point.z.nm()) * 1e-6, f64::from(point.x.nm()) * 1e-6)
}

/// Collects what a program cuts along, while it is checked.
#[derive(Clone, Debug)]
pub struct Curves {
    at: Point,
    curves: Vec<Curve>,
    lost: u64,
}

impl Curves {
    /// The program begins at `start`.
    pub fn new(start: Point) -> Self {
        Self { at: start, curves: Vec::new(), lost: 0 }
    }

    /// Looks at an action.
    pub fn action(&mut self, item: &Item) {
        let (end, arc, feed) = match item.action {
            Action::Line { end, feed } => (end, None, feed),
            Action::Arc { end, centre, sense, feed } => {
                #[expect(clippy::cast_precision_loss, reason = "nanometres of at most 6.3 m")]
                let centre = stock::Point::new(centre.z.nm() as f64 * 1e-6, centre.x.nm() as f64 * 1e-6);
                (end, Some((centre, sense == Sense::Clockwise)), feed)
            }
            _ => return,
        };
        let from = std::mem::replace(&mut self.at, end);
        if feed == Feed::Rapid {
            return;
        }
        if self.curves.len() < CURVES_KEPT {
            self.curves.push(Curve { line: item.line, from: place(from), to: place(end), arc });
        } else {
            self.lost += 1;
        }
    }

    /// Clamps a bar for them; `None` where there is nothing to cut. A program that is too long is cut without a
    /// contour to compare with.
    ///
    /// # Errors
    /// [`SetupError`].
    pub fn clamp(&self, figures: &Figures) -> Result<Option<Clamped>, SetupError> {
        let mut clamped = Clamped::new(figures, &self.curves)?;
        if self.lost > 0
            && let Some(clamped) = &mut clamped
        {
            clamped.contour = stock::Contour::default();
        }
        Ok(clamped)
    }

    /// Whether the program is too long for its contour.
    pub fn is_too_long(&self) -> bool {
        self.lost > 0
    }
}

/// Times of a cycle, ms.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Times {
    /// In feeds.
    pub cut_ms: u64,
    /// In rapids.
    pub rapid_ms: u64,
    /// Standing: dwells, stops, spindle and tool words.
    pub idle_ms: u64,
}

/// A moment of an animation.
#[derive(Clone, Debug)]
pub struct Moment {
    /// Since the start of the cycle, ms.
    pub time_ms: u64,
    /// The tool's programmed point, `[z, x]` in mm.
    pub tool: [f64; 2],
    /// How it moves.
    pub kind: Kind,
    /// Outside and bore of what is left.
    pub outline: [Vec<[f64; 2]>; 2],
}

/// The work in progress.
pub struct Work {
    cutting: Option<Cutting>,
    times: Times,
    course: Course,
    /// Where the slides are, Z and X, mm.
    at: [f64; 2],
    moments: Vec<Moment>,
    /// Ticks between moments; 0 for no animation.
    every: u64,
}

/// What the work left.
pub struct Worked {
    /// The stock, if anything was clamped.
    pub outcome: Option<Outcome>,
    /// Times of the cycle.
    pub times: Times,
    /// Speed, acceleration and pulse rate over time.
    pub course: Course,
    /// Moments of the cut, if they were asked for.
    pub moments: Vec<Moment>,
}

impl Work {
    /// Before the cycle. `pulse` is the size of a pulse, Z and X, in mm; `start` the lattice point it begins at.
    pub fn new(clamped: Option<Clamped>, pulse: [f64; 2], start: [i32; 2], animated: bool) -> Self {
        let at = [f64::from(start[0]) * pulse[0], f64::from(start[1]) * pulse[1]];
        let mut cutting = clamped.map(|Clamped { bar, tool, jaws, contour }| {
            Cutting::new(stock::Setup { bar, tool, jaws, contour, tolerance: pulse[0].max(pulse[1]) })
        });
        if let Some(cutting) = &mut cutting {
            let [z, x] = at;
            cutting.follow(motion(0, [z, x], Kind::Rapid, 0));
        }
        let every = if animated { 64 } else { 0 };
        Self { cutting, times: Times::default(), course: Course::new(pulse), at, moments: Vec::new(), every }
    }

    /// The slides are at a place now.
    #[inline]
    pub fn step(&mut self, place: Place, kind: Kind, line: u32) {
        let at = [place.z_nm * 1e-6, place.x_nm * 1e-6];
        // most events end a pulse and move nothing
        if at.iter().zip(&self.at).all(|(now, before)| (now - before).abs() < STANDING) {
            return;
        }
        self.at = at;
        if let Some(cutting) = &mut self.cutting {
            cutting.follow(motion(measure::time_ns(place.clocks), at, kind, line));
        }
    }

    /// A tick is over, at whose end the axes stand at a lattice point.
    pub fn tick(&mut self, lattice: [i32; 2], kind: Kind, is_standing: bool) {
        let time = match kind {
            _ if is_standing => &mut self.times.idle_ms,
            Kind::Rapid => &mut self.times.rapid_ms,
            Kind::Feed | Kind::Arc | Kind::Thread => &mut self.times.cut_ms,
        };
        *time += 1;
        let time_ms = self.course.tick(lattice);
        if self.every > 0 && time_ms.is_multiple_of(self.every) {
            self.keep(time_ms, kind);
        }
    }

    fn keep(&mut self, time_ms: u64, kind: Kind) {
        let outline = self.cutting.as_ref().map(|cutting| cutting.bar().outline(10.0 * OUTLINE)).unwrap_or_default();
        self.moments.push(Moment { time_ms, tool: self.at, kind, outline });
        if self.moments.len() >= MOMENTS {
            self.every *= 2;
            let every = self.every;
            self.moments.retain(|moment| moment.time_ms.is_multiple_of(every));
        }
    }

    /// Ends the work.
    pub fn finish(mut self) -> Worked {
        if self.every > 0 {
            self.keep(self.course.ticks(), Kind::Rapid);
        }
        let Self { cutting, times, course, moments, .. } = self;
        Worked { outcome: cutting.map(Cutting::finish), times, course, moments }
    }
}

fn motion(time_ns: u64, [z, x]: [f64; 2], kind: Kind, line: u32) -> Motion {
    let kind = if kind == Kind::Rapid { stock::Kind::Rapid } else { stock::Kind::Feed };
    Motion { time_ns, x_nm: x * 1e6, z_nm: z * 1e6, kind, line }
}
