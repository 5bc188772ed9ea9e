//! The pulse methods by name: how steps follow a curve.

/// How steps follow a curve.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// The lattice point nearest the curve at each step, eight directions: the production method.
    #[default]
    MinimumDeviation,
    /// [`super::point_comparison`]: one pulse at a time, toward the curve.
    PointComparison,
    /// [`super::dda`]: digital integration.
    Dda,
    /// [`super::rate_multiplier`]; lines only, arcs by minimum deviation.
    RateMultiplier,
    /// [`super::fraction`]; lines only, arcs by minimum deviation.
    Fraction,
    /// A chord for each tick, walked by minimum deviation. A line is its own chord.
    TimeDivision,
}

impl Method {
    /// All, the default first.
    pub const ALL: [Self; 6] = [
        Self::MinimumDeviation,
        Self::PointComparison,
        Self::Dda,
        Self::RateMultiplier,
        Self::Fraction,
        Self::TimeDivision,
    ];

    /// Name, as parameters write it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::MinimumDeviation => "minimum-deviation",
            Self::PointComparison => "point-comparison",
            Self::Dda => "dda",
            Self::RateMultiplier => "rate-multiplier",
            Self::Fraction => "fraction",
            Self::TimeDivision => "time-division",
        }
    }

    /// Whether arcs are walked by it, and not by minimum deviation in its place.
    pub const fn serves_arcs(self) -> bool {
        !matches!(self, Self::RateMultiplier | Self::Fraction)
    }
}
