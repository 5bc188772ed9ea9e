//! Thins a polyline as its points come, within a tolerance and in bounded memory.
//!
//! A *run* is a stretch of points that one segment will stand for, from its *anchor* to the newest point. Every
//! point narrows the *cone* of directions from the anchor whose ray passes it closely enough; a point outside the
//! cone, or one that has come back from the farthest *reach*, ends the run, and its predecessor becomes the next
//! anchor. Lateral distance and overshoot each get 0.7 of the tolerance, so the distance to the segment stays below
//! it (0.7 sqrt 2 = 0.99).
//!
//! When the polyline grows past its capacity, the tolerance is doubled and the kept points are thinned again with
//! the old tolerance: the two errors add up to the new one. Tracks that have become smaller than the error vanish.
//!
//! Source of the cone: Z. Zhao, A. Saalfeld, "Linear-time sleeve-fitting polyline simplification", Auto-Carto 13, 1997.

use crate::picture::{Kind, Track};

/// Share of the tolerance for lateral distance, and the same for overshoot.
const SHARE: f64 = 0.7;

/// Below this the tolerance means nothing in mm.
const LEAST_TOLERANCE: f64 = 1e-9;

/// Two tracks of two points and the newest point have to fit, with room to spare.
const LEAST_CAPACITY: usize = 16;

/// Directions from an anchor, bounded by two unit vectors less than half a turn apart.
#[derive(Copy, Clone, Debug)]
struct Cone {
    right: [f64; 2],
    left: [f64; 2],
}

/// Positive if `b` lies to the left of `a`.
fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    let [z, x] = minus(a, b);
    z.hypot(x)
}

impl Cone {
    /// Rays that pass the tip of `way`, which is `length` long, within `lateral < length`.
    fn towards(way: [f64; 2], length: f64, lateral: f64) -> Self {
        let sine = lateral / length;
        let cosine = (1.0 - sine * sine).sqrt();
        let [z, x] = [way[0] / length, way[1] / length];
        Self {
            right: [z * cosine + x * sine, x * cosine - z * sine],
            left: [z * cosine - x * sine, x * cosine + z * sine],
        }
    }

    fn contains(self, way: [f64; 2]) -> bool {
        cross(self.right, way) >= 0.0 && cross(way, self.left) >= 0.0
    }

    /// What both hold; both contain one direction.
    fn narrowed(self, other: Self) -> Self {
        Self {
            right: if cross(self.right, other.right) > 0.0 { other.right } else { self.right },
            left: if cross(other.left, self.left) > 0.0 { other.left } else { self.left },
        }
    }
}

/// Points that one segment stands for.
#[derive(Copy, Clone, Debug)]
struct Run {
    anchor: [f64; 2],
    newest: [f64; 2],
    reach: f64,
    cone: Option<Cone>,
    /// Whether the tool has left the anchor.
    is_pending: bool,
}

impl Run {
    fn from(anchor: [f64; 2]) -> Self {
        Self { anchor, newest: anchor, reach: 0.0, cone: None, is_pending: false }
    }

    /// Takes a point into the run, or returns false and leaves the run as it is.
    fn take(&mut self, point: [f64; 2], tolerance: f64) -> bool {
        let share = SHARE * tolerance;
        let way = minus(point, self.anchor);
        let length = way[0].hypot(way[1]);
        let has_come_back = length + share < self.reach;
        let is_aside = self.cone.is_some_and(|cone| !cone.contains(way));
        if has_come_back || is_aside {
            return false;
        }
        if length > share {
            let cone = Cone::towards(way, length, share);
            self.cone = Some(self.cone.map_or(cone, |known| known.narrowed(cone)));
        }
        self.reach = self.reach.max(length);
        self.newest = point;
        self.is_pending |= length > 0.0;
        true
    }
}

/// `points` thinned so that each lies within `tolerance` of the segment that stands for it. Ends are kept.
pub(crate) fn thinned(points: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let Some((&first, rest)) = points.split_first() else {
        return Vec::new();
    };
    let mut kept = vec![first];
    let mut run = Run::from(first);
    for &point in rest {
        if !run.take(point, tolerance) {
            kept.push(run.newest);
            run = Run::from(run.newest);
            run.take(point, tolerance);
        }
    }
    if run.is_pending {
        kept.push(run.newest);
    }
    kept
}

/// Keeps the path of a tool as tracks of few points, however many positions it is given.
///
/// ```
/// # use virtual_lathe::picture::{Kind, Thinner};
/// let mut thinner = Thinner::new(0.01, 1_000);
/// for k in 0..=10_000 {
///     thinner.push(Kind::Feed, [f64::from(k) * 0.001, 5.0]);
/// }
/// assert_eq!(thinner.tracks()[0].points, [[0.0, 5.0], [10.0, 5.0]]);
/// ```
#[derive(Clone, Debug)]
pub struct Thinner {
    tolerance: f64,
    capacity: usize,
    tracks: Vec<Track>,
    /// Points in `tracks`.
    stored: usize,
    /// Follows the last point of the last track.
    run: Option<Run>,
}

impl Thinner {
    /// * `tolerance`: how far a position may lie from what is drawn, in mm; at least 1e-9.
    /// * `capacity`: most points kept, over all tracks; at least 16. A point takes 16 bytes, and every track needs
    ///   two, so this should be several times the changes of kind to expect: 20 000 serve most programs.
    #[must_use]
    pub fn new(tolerance: f64, capacity: usize) -> Self {
        Self {
            tolerance: tolerance.max(LEAST_TOLERANCE),
            capacity: capacity.max(LEAST_CAPACITY),
            tracks: Vec::new(),
            stored: 0,
            run: None,
        }
    }

    /// The tool came to `point`, `[z, x]` in mm, by `kind`. The first point is where it stood. A point that is not
    /// finite is left out.
    pub fn push(&mut self, kind: Kind, point: [f64; 2]) {
        if !point.iter().all(|part| part.is_finite()) {
            return;
        }
        let Some(run) = self.run.take() else {
            self.run = Some(self.begin(kind, point));
            return;
        };
        let mut run = self.changed(kind, run);
        if !run.take(point, self.tolerance) {
            self.store(run.newest);
            run = Run::from(run.newest);
            run.take(point, self.tolerance);
        }
        self.run = Some(run);
        while self.len() > self.capacity {
            self.coarsen();
        }
    }

    /// Every position given lies at most this far from the tracks, in mm. It grows when room runs out.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Points kept; never above the capacity.
    #[must_use]
    pub fn len(&self) -> usize {
        self.stored + usize::from(self.run.is_some_and(|run| run.is_pending))
    }

    /// Whether no point has been given.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The path so far. Each track begins where the one before it ended, within the tolerance.
    #[must_use]
    pub fn tracks(&self) -> Vec<Track> {
        let mut tracks = self.tracks.clone();
        if let (Some(run), Some(track)) = (self.run, tracks.last_mut())
            && run.is_pending
        {
            track.points.push(run.newest);
        }
        tracks
    }

    fn begin(&mut self, kind: Kind, point: [f64; 2]) -> Run {
        self.tracks.push(Track { kind, points: vec![point] });
        self.stored += 1;
        Run::from(point)
    }

    /// The run to go on with: a new one, in a new track, if the kind has changed.
    fn changed(&mut self, kind: Kind, run: Run) -> Run {
        let Some(track) = self.tracks.last_mut() else {
            return run;
        };
        if track.kind == kind {
            return run;
        }
        if track.points.len() == 1 && !run.is_pending {
            // Only a place to stand: it belongs to what follows.
            track.kind = kind;
            return run;
        }
        if run.is_pending {
            self.store(run.newest);
        }
        self.begin(kind, run.newest)
    }

    fn store(&mut self, point: [f64; 2]) {
        if let Some(track) = self.tracks.last_mut() {
            track.points.push(point);
            self.stored += 1;
        }
    }

    /// Doubles the tolerance and thins what is kept. The anchor of the run stays the last point of the last track.
    fn coarsen(&mut self) {
        let budget = self.tolerance;
        self.tolerance *= 2.0;
        let mut kept: Vec<Track> = Vec::new();
        let tracks = std::mem::take(&mut self.tracks);
        let last = tracks.len().saturating_sub(1);
        for (index, track) in tracks.into_iter().enumerate() {
            let Some(before) = kept.last_mut() else {
                kept.push(track);
                continue;
            };
            let end = before.points.last().copied().unwrap_or_default();
            if index < last && track.points.iter().all(|p| distance(*p, end) <= budget) {
                continue;
            }
            if before.kind == track.kind {
                before.points.extend(track.points);
            } else {
                kept.push(track);
            }
        }
        for track in &mut kept {
            track.points = thinned(&track.points, budget);
        }
        self.stored = kept.iter().map(|track| track.points.len()).sum();
        self.tracks = kept;
    }
}
