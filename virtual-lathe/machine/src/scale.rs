//! A glass scale on a slide.

use figures::{FigureError, Figures};
use interp_core::units::Axis;

use crate::read::{self, Refused};

/// A scale: reads the slide itself, whatever screw and motor did.
#[derive(Clone, Debug)]
pub struct Scale {
    resolution: f64,
    period: f64,
    error: f64,
}

impl Scale {
    /// The scale of an axis; `None` where none is fitted.
    ///
    /// # Errors
    /// Figures that contradict each other.
    pub fn new(figures: &Figures, axis: Axis) -> Result<Option<Self>, FigureError> {
        let name = |what: &str| read::name("scale", axis, what);
        let resolution = figures.number(&name("resolution_nm"))?;
        let period = figures.number(&name("period_um"))? * 1e3;
        let error = figures.number(&name("error_nm"))?;
        if !figures.switch(&name("fitted"))? {
            return Ok(None);
        }
        // four counts a period is what the two channels give without interpolation
        if resolution > period / 4.0 {
            return Err(Refused(format!(
                "{} of {resolution} nm is coarser than a quarter of {} of {} um",
                name("resolution_nm"),
                name("period_um"),
                period / 1e3
            ))
            .into());
        }
        if error > period / 8.0 {
            return Err(Refused(format!(
                "{} of {error} nm is more than an eighth of {} of {} um: the reading would run back",
                name("error_nm"),
                name("period_um"),
                period / 1e3
            ))
            .into());
        }
        Ok(Some(Self { resolution, period, error }))
    }

    /// What the scale shows with the slide at `position` (nm): nm, a multiple of the resolution.
    #[must_use]
    pub fn reading(&self, position: f64) -> f64 {
        let within = std::f64::consts::TAU * (position / self.period).fract();
        ((position + self.error * within.sin()) / self.resolution).round() * self.resolution
    }
}
