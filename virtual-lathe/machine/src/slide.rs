//! A slide that its nut pushes: backlash.

/// A slide with play. It stands where the nut is after a move in plus, and by the backlash farther in plus after a
/// move in minus; in between it does not move.
#[derive(Clone, Debug)]
pub struct Slide {
    play: f64,
    at: f64,
}

impl Slide {
    /// A slide at `nut` (nm), which got there in plus, with `play` (nm, 0 or more).
    #[must_use]
    pub const fn new(play: f64, nut: f64) -> Self {
        Self { play, at: nut }
    }

    /// Where the slide is once the nut has got to `nut`; nm.
    #[inline]
    pub fn push(&mut self, nut: f64) -> f64 {
        self.at = self.at.max(nut).min(nut + self.play);
        self.at
    }
}
