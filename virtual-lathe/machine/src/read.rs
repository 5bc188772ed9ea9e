//! Names of figures by group and axis, and refusals.

use figures::FigureError;
use interp_core::units::Axis;

/// Figures that contradict each other, as text.
pub(crate) struct Refused(pub(crate) String);

impl From<Refused> for FigureError {
    fn from(refused: Refused) -> Self {
        Self::Contradiction(refused.0)
    }
}

/// `motor.x.holding_nm` of `motor`, X and `holding_nm`.
pub(crate) fn name(group: &str, axis: Axis, what: &str) -> String {
    let letter = match axis {
        Axis::X => 'x',
        Axis::Z => 'z',
    };
    format!("{group}.{letter}.{what}")
}
