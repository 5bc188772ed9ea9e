//! A handwheel: two channels a quarter of a period apart, detents, contacts that may bounce.

use figures::{FigureError, Figures};

use crate::bounce::{Dice, bounce};
use crate::contact::nanoseconds;

/// Most times that a contact of a handwheel opens again.
const BOUNCES: u32 = 4;

/// A change of a handwheel's channels.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct WheelEdge {
    /// When, in ns.
    pub time_ns: u64,
    /// Channel A from then on; leads B in plus.
    pub a: bool,
    /// Channel B from then on.
    pub b: bool,
}

/// A handwheel.
#[derive(Clone, Debug)]
pub struct Handwheel {
    detents: u32,
    counts_a_detent: u32,
    settle_ns: u64,
    dice: Dice,
    counts: i64,
}

impl Handwheel {
    /// A handwheel in a detent, both channels low.
    ///
    /// # Errors
    /// [`FigureError::Unknown`] without the figures of a machine.
    pub fn new(figures: &Figures) -> Result<Self, FigureError> {
        Ok(Self {
            detents: figures.whole("handwheel.detents")?,
            counts_a_detent: figures.whole("handwheel.counts")?,
            settle_ns: nanoseconds(figures.number("handwheel.bounce_us")?),
            dice: Dice::new(figures)?,
            counts: 0,
        })
    }

    /// Detents a turn.
    #[must_use]
    pub const fn detents(&self) -> u32 {
        self.detents
    }

    /// Counts since the beginning, 4 a period, without bounce.
    #[must_use]
    pub const fn counts(&self) -> i64 {
        self.counts
    }

    /// Turns the wheel by `detents`, evenly over `over_ns` from `from_ns` on; the edges that this makes, in order.
    ///
    /// A contact bounces at most until it changes again, so the last edge leaves the right levels. While both
    /// channels bounce at once, a decoder without a filter may be led round: four counts too many or too few.
    pub fn turn(&mut self, detents: i32, from_ns: u64, over_ns: u64) -> Vec<WheelEdge> {
        let steps = u64::from(detents.unsigned_abs()) * u64::from(self.counts_a_detent);
        let sense = i64::from(detents.signum());
        let begin = levels(self.counts);
        // times at which each channel changes without bounce
        let mut true_edges: [Vec<u64>; 2] = [Vec::new(), Vec::new()];
        for step in 1..=steps {
            let time = from_ns + share(over_ns, step, steps);
            let (before, after) = (levels(self.counts), levels(self.counts + sense));
            self.counts += sense;
            let [a, b] = &mut true_edges;
            if before.0 == after.0 { b.push(time) } else { a.push(time) }
        }
        let [a, b] = true_edges.map(|times| self.bounced(&times));
        let mut changes: Vec<(u64, bool)> =
            a.into_iter().map(|time| (time, true)).chain(b.into_iter().map(|time| (time, false))).collect();
        changes.sort_unstable();
        let mut now = begin;
        changes
            .into_iter()
            .map(|(time_ns, is_a)| {
                let level = if is_a { &mut now.0 } else { &mut now.1 };
                *level = !*level;
                WheelEdge { time_ns, a: now.0, b: now.1 }
            })
            .collect()
    }

    /// All changes of a channel that changes at `times`.
    fn bounced(&mut self, times: &[u64]) -> Vec<u64> {
        let mut all = Vec::new();
        for (at, &time) in times.iter().enumerate() {
            let room = times.get(at + 1).map_or(u64::MAX, |next| next - time);
            all.extend(bounce(&mut self.dice, time, self.settle_ns.min(room), BOUNCES));
        }
        all
    }
}

/// Levels of A and B at a count.
const fn levels(counts: i64) -> (bool, bool) {
    let quarter = counts.rem_euclid(4);
    (quarter == 1 || quarter == 2, quarter == 2 || quarter == 3)
}

/// `over * step / steps`, without overflow.
fn share(over: u64, step: u64, steps: u64) -> u64 {
    let time = u128::from(over) * u128::from(step) / u128::from(steps.max(1));
    u64::try_from(time).unwrap_or(over)
}
