//! A spindle encoder: counts, levels and index as functions of the angle alone, so both senses agree.

use figures::{FigureError, Figures};

use crate::spindle::Angle;

/// An incremental encoder, 4 counts a line and an index pulse of one count a turn.
#[derive(Clone, Debug)]
pub struct Encoder {
    /// Counts a turn.
    counts: i64,
    /// The count within a turn at which the index is high.
    index: i64,
}

/// Levels of an encoder's channels.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Channels {
    /// Channel A; leads B forward.
    pub a: bool,
    /// Channel B.
    pub b: bool,
    /// Index.
    pub index: bool,
}

impl Encoder {
    /// The encoder of the spindle.
    ///
    /// # Errors
    /// [`FigureError::Unknown`] without the figures of a machine.
    pub fn new(figures: &Figures) -> Result<Self, FigureError> {
        let counts = 4 * i64::from(figures.whole("encoder.lines")?);
        let turn = Angle::default().turned(figures.number("encoder.index_deg")? / 360.0);
        Ok(Self { counts, index: Self { counts, index: 0 }.counts(turn).rem_euclid(counts) })
    }

    /// Counts since angle 0, rounded down. 4 x lines a turn; a counter of 16 bits shows the low bits of it.
    #[must_use]
    pub fn counts(&self, angle: Angle) -> i64 {
        #[expect(clippy::cast_precision_loss, reason = "counts a turn: at most 400 000")]
        let within = (angle.part * self.counts as f64).floor();
        // just below a whole turn the product may round up to it
        let within = crate::whole(within).min(self.counts - 1);
        angle.turns.saturating_mul(self.counts).saturating_add(within)
    }

    /// The count at the index mark that was passed last on the way from one count to another, in either sense; `None` where
    /// none was.
    #[must_use]
    pub fn index_passed(&self, from: i64, to: i64) -> Option<i64> {
        let turn = |counts: i64| (counts - self.index).div_euclid(self.counts);
        let (before, now) = (turn(from), turn(to));
        if before == now {
            return None;
        }
        // going back the mark is left at its lower edge
        let last = if now > before { now } else { now + 1 };
        Some(last * self.counts + self.index)
    }

    /// Levels of the channels at an angle.
    #[must_use]
    pub fn channels(&self, angle: Angle) -> Channels {
        let counts = self.counts(angle);
        let quarter = counts.rem_euclid(4);
        Channels {
            a: matches!(quarter, 1 | 2),
            b: matches!(quarter, 2 | 3),
            index: counts.rem_euclid(self.counts) == self.index,
        }
    }
}
