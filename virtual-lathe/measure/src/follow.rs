//! Which motion a pulse belongs to: the train says nothing of blocks, so positions decide.
//!
//! A piece (see `path`) is **complete** when the train stands on its rounded end. No angle is needed to
//! tell a circle's end from its start: an arc that turns by more than 180 degrees is two pieces with
//! different ends, and no other arc comes near its end before it has passed its middle (one whose radius
//! is about a pulse may get there at once, which is its whole way).
//!
//! The step after that belongs to the next piece, unless it is off that (by more than a pulse) and nearer
//! to the complete one: then it has overrun, and counts as deviation of the complete one until a step is
//! on the next.
//!
//! A step of both axes at once that passes the end without standing on it (it would have stood there
//! between the two) is the fault `EndSkipped`; the following goes on with the next piece.

use crate::fault::{FaultKind, Faults, Here};
use crate::geometry::Vector;
use crate::path::{Motion, Path, Piece, Scale, Waypoint};
use crate::setup::PerAxis;
use std::collections::VecDeque;

/// What was told and is not in work yet. Motions without pulses, and pauses after a pause, leave no trace, so that
/// any number of them may be told ahead.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "pauses are rare")]
enum Told {
    Motion(Path),
    Pause,
}

/// What a step did.
#[derive(Copy, Clone, Debug, Default)]
pub(crate) struct Seen {
    /// It is the first of a motion, which is now the current one.
    pub(crate) entered: bool,
    /// There was a pause before this motion.
    pub(crate) paused: bool,
    /// It completed the current motion.
    pub(crate) completed: bool,
    /// Distance to the walked and to the programmed curve in nm.
    pub(crate) walked: f64,
    pub(crate) programmed: f64,
    /// It went back: against the direction of travel by half a pulse or more.
    pub(crate) backward: bool,
}

#[derive(Clone, Debug)]
pub(crate) struct Follow {
    pub(crate) scale: Scale,
    told: VecDeque<Told>,
    /// Where the last motion told ends.
    from: Waypoint,
    /// The next motion with pulses, if it is known, and whether a pause stands before it.
    next: Option<Path>,
    pause: bool,
    current: Option<Path>,
    in_second: bool,
    /// The end of the current piece was reached.
    complete: bool,
    /// Half of the finer pulse equivalent, in nm.
    back: f64,
}

impl Follow {
    pub(crate) fn new(scale: Scale, from: Waypoint) -> Self {
        Self {
            back: scale.nm_x.min(scale.nm_z) / 2.0,
            scale,
            told: VecDeque::new(),
            from,
            next: None,
            pause: false,
            current: None,
            in_second: false,
            complete: true,
        }
    }

    pub(crate) fn motion(&mut self, motion: Motion) {
        let (path, to) = Path::new(&self.scale, self.from, &motion);
        self.from = to;
        self.told.extend(path.map(Told::Motion));
    }

    pub(crate) fn pause(&mut self) {
        if !matches!(self.told.back(), Some(Told::Pause)) {
            self.told.push_back(Told::Pause);
        }
    }

    /// The motion in work, or the last one.
    pub(crate) fn current(&self) -> Option<&Path> {
        self.current.as_ref()
    }

    /// The piece in work, or the last one.
    pub(crate) fn piece(&self) -> Option<&Piece> {
        self.current.as_ref().map(|path| if self.in_second { path.last() } else { &path.first })
    }

    /// Makes the next motion with pulses ready, if it was told.
    fn fetch(&mut self) {
        while self.next.is_none() {
            match self.told.pop_front() {
                None => return,
                Some(Told::Pause) => self.pause = true,
                Some(Told::Motion(path)) => self.next = Some(path),
            }
        }
    }

    /// Distance from `point` to the piece that follows the current one, if it is known.
    fn next_distance(&mut self, point: Vector) -> Option<f64> {
        if !self.in_second
            && let Some(second) = self.current.as_ref().and_then(|path| path.second.as_ref())
        {
            return Some(second.curve.distance(point));
        }
        self.fetch();
        self.next.as_ref().map(|path| path.first.curve.distance(point))
    }

    /// Goes on to the following piece; it is known.
    fn advance(&mut self, seen: &mut Seen) {
        self.complete = false;
        if !self.in_second && self.current.as_ref().is_some_and(|path| path.second.is_some()) {
            self.in_second = true;
            return;
        }
        self.current = self.next.take();
        self.in_second = false;
        seen.entered = true;
        seen.paused = std::mem::take(&mut self.pause);
    }

    /// Whether a step by `moved` to `here` went past the end of the current piece.
    fn skipped(&self, here: Here, moved: PerAxis<i32>) -> bool {
        let Some(piece) = self.piece() else {
            return false;
        };
        let at = here.at.map(i64::from);
        let end = piece.end;
        let x_first = at.x == end.x && at.z - i64::from(moved.z) == end.z;
        let z_first = at.z == end.z && at.x - i64::from(moved.x) == end.x;
        x_first || z_first
    }

    /// Takes a step by `moved` to the place `here`.
    pub(crate) fn step(&mut self, here: Here, moved: PerAxis<i32>, faults: &mut Faults) -> Seen {
        let mut seen = Seen::default();
        let point = self.scale.place(here.at);
        if !self.complete && moved.x != 0 && moved.z != 0 && self.skipped(here, moved) {
            let within = !self.in_second && self.current().is_some_and(|path| path.second.is_some());
            self.fetch();
            // The end of everything can't be skipped: there is nothing to go on with.
            if within || self.next.is_some() {
                faults.add(here.fault(FaultKind::EndSkipped, None, 0, 0));
                self.complete = true;
            }
        }
        if self.complete {
            let on = self.piece().map(|piece| piece.curve.distance(point));
            match self.next_distance(point) {
                Some(next) => {
                    if next <= self.scale.coarser * 1.000_001 || on.is_none_or(|on| next <= on) {
                        self.advance(&mut seen);
                    }
                }
                None => faults.add(here.fault(FaultKind::PulseWithoutMotion, None, 0, 0)),
            }
        }
        let (Some(path), Some(piece)) = (self.current(), self.piece()) else {
            return seen;
        };
        seen.walked = piece.curve.distance(point);
        seen.programmed = path.programmed_distance(point);
        let step = Vector { z: f64::from(moved.z) * self.scale.nm_z, x: f64::from(moved.x) * self.scale.nm_x };
        seen.backward = piece.curve.goes_back(point, step, self.back);
        if !self.complete && here.at.map(i64::from) == piece.end {
            seen.completed = self.in_second || path.second.is_none();
            self.complete = true;
        }
        seen
    }

    /// At the end: how many motions with pulses are not complete.
    pub(crate) fn left(&mut self) -> u64 {
        let within = self.current.as_ref().is_some_and(|path| path.second.is_some());
        let mut left = u64::from(!self.complete || (within && !self.in_second));
        self.fetch();
        while self.next.take().is_some() {
            left += 1;
            self.fetch();
        }
        left
    }

    /// The rounded end of the last motion told.
    pub(crate) fn last_end(&self) -> PerAxis<i64> {
        self.from.at
    }
}
