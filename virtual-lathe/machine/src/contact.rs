//! A switch.

use figures::{FigureError, Figures};

use crate::bounce::{Dice, bounce};

/// A change of a level.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Edge {
    /// When, in ns.
    pub time_ns: u64,
    /// Level from then on.
    pub high: bool,
}

/// A switch whose contact bounces.
#[derive(Clone, Debug)]
pub struct Switch {
    settle_ns: u64,
    bounces: u32,
    dice: Dice,
    closed: bool,
}

impl Switch {
    /// An open switch.
    ///
    /// # Errors
    /// [`FigureError::Unknown`] without the figures of a machine.
    pub fn new(figures: &Figures) -> Result<Self, FigureError> {
        Ok(Self {
            settle_ns: nanoseconds(figures.number("switch.bounce_us")?),
            bounces: figures.whole("switch.bounces")?,
            dice: Dice::new(figures)?,
            closed: false,
        })
    }

    /// Closes or opens it at a time; the edges that this makes, in order. The last one leaves the new level.
    pub fn set(&mut self, closed: bool, at_ns: u64) -> Vec<Edge> {
        if closed == self.closed {
            return Vec::new();
        }
        self.closed = closed;
        let times = bounce(&mut self.dice, at_ns, self.settle_ns, self.bounces);
        // every second change is the wrong way
        times.iter().zip([closed, !closed].iter().cycle()).map(|(&time_ns, &high)| Edge { time_ns, high }).collect()
    }
}

/// Whole nanoseconds of a figure in microseconds.
pub(crate) fn nanoseconds(us: f64) -> u64 {
    u64::try_from(crate::whole((us * 1e3).round())).unwrap_or(0)
}
