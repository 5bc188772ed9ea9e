//! How well the train keeps the programmed feed.
//!
//! * **Sample**: a rising edge of the axis that is major at its place, with the length of walked curve up
//!   to the foot in the direction of the minor axis. On a line that makes the progress exact: the foot
//!   has the major axis's own coordinate, and the minor axis's rounding plays no part. On an arc the
//!   points within two pulses of a change of the major axis are no samples, since they may belong to the
//!   other axis's walk.
//! * **Window**: from a sample to the first sample at least 50 ms later, in the same motion; its speed is
//!   the difference of lengths over the difference of times, both exact. Windows follow on each other
//!   from the first sample of a motion. What is left at its end is not a window.
//! * **Reference**: the programmed feed times the override, at most what the axes allow: the largest feed
//!   of each axis in the least favourable direction that the motion meets, and on arcs sqrt(a R).
//! * A window **counts** if one of these holds:
//!   - it is *steady*: the windows before and after it, both in the same motion, have its speed within
//!     0.2 %. Ramps are not. A wrong plateau is, and its whole error shows.
//!   - it is *due*: it begins and ends farther from both ends of the motion than v²/a + 2 pulses, twice
//!     the ramp from standstill to the reference v with the acceleration a that the axes allow along the
//!     path (where the speed is a mean over a time T, both of them 8/7 v²/a + v T, as the mean is taken of a plan with 7/8 of
//!     the acceleration), begins later than 2 v/a + 2 T after a change of override (v: the largest feed of an axis), and
//!     the reference is at most 0.9 of what the axes allow, so that turning leaves them enough to speed up.
//!     There the feed must be kept; so one that wavers, or is never reached, can't hide.
//! * The error of a window is |v / reference - 1| in percent.
//!
//! A hold of the feed within a due window shows as an error; the caller marks it as an override of 0 %,
//! whose windows don't count.

use crate::path::Path;
use crate::setup::CLOCKS_PER_SECOND;

/// Shortest window, 50 ms.
const WINDOW: u64 = CLOCKS_PER_SECOND as u64 / 20;
/// Windows agree within this part of the speed.
const STEADY: f64 = 0.002;

/// Up to this part of what the axes allow the feed is due; nearer to it an arc takes the acceleration
/// that the ramp would need.
const CLEAR: f64 = 0.9;

/// Errors of the feed.
#[derive(Copy, Clone, Debug, Default, PartialEq)]
pub struct FeedError {
    /// Mean of the absolute errors of all windows, in percent.
    pub mean: f64,
    /// Largest absolute error, in percent.
    pub max: f64,
    /// Program line of the largest.
    pub line: u32,
    /// Time of the end of its window, in train clocks.
    pub clocks: u64,
    /// Windows that counted.
    pub windows: u64,
    /// Of these, windows that were due though a neighbour in the motion disagrees.
    pub unsteady: u64,
    /// Of these, windows whose reference was what the axes allow, below the programmed feed.
    pub limited: u64,
}

#[derive(Copy, Clone, Debug)]
struct Sample {
    clocks: u64,
    mm: f64,
}

/// A window in mm/s.
#[derive(Copy, Clone, Debug)]
struct Window {
    speed: f64,
    due: bool,
    end: u64,
}

/// What the feed of a motion is held against, in mm and s.
#[derive(Copy, Clone, Debug)]
struct Target {
    line: u32,
    feed: f64,
    allowed: f64,
    accel: f64,
    length: f64,
}

#[derive(Clone, Debug)]
pub(crate) struct Feed {
    /// Two pulses, in mm, the time of the mean in s, and 2 v/a of the axes and two such times in clocks.
    margin: f64,
    smoothed: f64,
    settle: u64,
    settled: u64,
    percent: f64,
    target: Option<Target>,
    /// Time from which on an edge is the next sample.
    due_at: u64,
    last: Option<Sample>,
    /// The last window but one, if it is of this motion, and the last.
    before: Option<Window>,
    middle: Option<Window>,
    sum: f64,
    error: FeedError,
}

impl Feed {
    /// `margin` in mm, `smoothed` in s, `settle` in clocks.
    pub(crate) fn new(margin: f64, smoothed: f64, settle: u64) -> Self {
        Self {
            margin,
            smoothed,
            settle,
            settled: 0,
            percent: 100.0,
            target: None,
            due_at: u64::MAX,
            last: None,
            before: None,
            middle: None,
            sum: 0.0,
            error: FeedError::default(),
        }
    }

    /// A motion begins; a rapid has no feed to keep.
    pub(crate) fn begin(&mut self, path: &Path) {
        self.end();
        self.target = path.feed.map(|feed| Target {
            line: path.line,
            feed,
            allowed: path.allowed,
            accel: path.accel,
            length: path.length_mm,
        });
        self.due_at = if self.target.is_some() { 0 } else { u64::MAX };
    }

    /// The motion is over.
    pub(crate) fn end(&mut self) {
        self.judge(None);
        self.target = None;
        self.due_at = u64::MAX;
        self.last = None;
        self.before = None;
        self.middle = None;
    }

    /// The override changes now.
    pub(crate) fn override_percent(&mut self, percent: u32, now: u64) {
        self.judge(None);
        self.percent = f64::from(percent);
        self.settled = now.saturating_add(self.settle);
        self.last = None;
        self.before = None;
        self.middle = None;
        if self.target.is_some() {
            self.due_at = now;
        }
    }

    /// Whether an edge at this time would be a sample.
    #[inline]
    pub(crate) fn due(&self, clocks: u64) -> bool {
        clocks >= self.due_at
    }

    fn reference(&self, target: &Target) -> f64 {
        (target.feed * self.percent / 100.0).min(target.allowed)
    }

    /// Takes the sample that was due: `mm` of the motion are done.
    pub(crate) fn sample(&mut self, clocks: u64, mm: f64) {
        self.due_at = clocks.saturating_add(WINDOW);
        let (Some(target), Some(last)) = (self.target, self.last.replace(Sample { clocks, mm })) else {
            return;
        };
        let reference = self.reference(&target);
        let planned = if self.smoothed > 0.0 { 8.0 / 7.0 } else { 1.0 };
        let ramp = planned * reference * reference / target.accel + reference * self.smoothed + self.margin;
        let window = Window {
            speed: (mm - last.mm) / seconds(clocks - last.clocks),
            due: last.mm >= ramp
                && target.length - mm >= ramp
                && last.clocks >= self.settled
                && reference <= CLEAR * target.allowed,
            end: clocks,
        };
        self.judge(Some(window));
        self.before = self.middle.replace(window);
    }

    /// Counts the last window, now that the one after it is known, or that there is none.
    fn judge(&mut self, after: Option<Window>) {
        let (Some(target), Some(window)) = (self.target, self.middle) else {
            return;
        };
        let reference = self.reference(&target);
        let agrees = |other: Window| (other.speed - window.speed).abs() <= STEADY * window.speed.abs();
        let steady = self.before.is_some_and(agrees) && after.is_some_and(agrees);
        let wavers = !(self.before.is_none_or(agrees) && after.is_none_or(agrees));
        if !(steady || window.due) || reference <= 0.0 {
            return;
        }
        let error = (window.speed / reference - 1.0).abs() * 100.0;
        self.sum += error;
        self.error.windows += 1;
        self.error.unsteady += u64::from(wavers);
        self.error.limited += u64::from(target.allowed < target.feed * self.percent / 100.0);
        if error > self.error.max {
            self.error.max = error;
            self.error.line = target.line;
            self.error.clocks = window.end;
        }
    }

    /// The figures; `None` if no window counted.
    #[expect(clippy::cast_precision_loss, reason = "a mean for display")]
    pub(crate) fn finish(mut self) -> Option<FeedError> {
        self.end();
        (self.error.windows > 0).then(|| FeedError { mean: self.sum / self.error.windows as f64, ..self.error })
    }
}

#[expect(clippy::cast_precision_loss, reason = "below 2^53 clocks, 23 years")]
fn seconds(clocks: u64) -> f64 {
    clocks as f64 / f64::from(CLOCKS_PER_SECOND)
}
