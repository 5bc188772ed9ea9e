//! Round numbers: the ticks of an axis and how numbers are written.

/// True minus sign, as wide as the plus.
const MINUS: char = '\u{2212}';

/// Finest step of an axis, as a power of ten: 1e-7 mm is far below any pulse.
const FINEST_DECIMALS: usize = 7;

/// Round positions on an axis: multiples of 1, 2 or 5 times a power of ten.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ticks {
    /// Distance between labelled ticks.
    pub(crate) step: f64,
    /// Parts of the step that get a small tick.
    pub(crate) parts: u32,
    /// Decimals that show the step in full.
    decimals: usize,
}

impl Ticks {
    /// The finest round step that is at least `least`.
    pub(crate) fn at_least(least: f64) -> Self {
        let mut decade = 1.0;
        let mut decimals = 0;
        while decade > least && decimals < FINEST_DECIMALS {
            decimals += 1;
            decade = 1.0 / 10_f64.powi(i32::try_from(decimals).unwrap_or(0));
        }
        while decade * 10.0 <= least {
            decade *= 10.0;
        }
        for (factor, parts) in [(1.0, 5), (2.0, 4), (5.0, 5)] {
            if decade * factor >= least {
                return Self { step: decade * factor, parts, decimals };
            }
        }
        Self { step: decade * 10.0, parts: 5, decimals: decimals.saturating_sub(1) }
    }

    /// Labelled positions in `low..=high`.
    pub(crate) fn labelled(&self, low: f64, high: f64) -> Vec<f64> {
        multiples(self.step, low, high)
    }

    /// Positions of small ticks in `low..=high`, those of the labelled ones among them.
    pub(crate) fn small(&self, low: f64, high: f64) -> Vec<f64> {
        multiples(self.step / f64::from(self.parts), low, high)
    }

    /// The label of a tick.
    pub(crate) fn label(&self, value: f64) -> String {
        fixed(value, self.decimals)
    }
}

/// Most multiples given, whatever the range.
const MOST_MULTIPLES: usize = 1_000;

/// Multiples of `step` in `low..=high`, at most [`MOST_MULTIPLES`].
pub(crate) fn multiples(step: f64, low: f64, high: f64) -> Vec<f64> {
    let slack = step * 1e-6;
    let first = ((low - slack) / step).ceil();
    (0_u32..)
        .map(|k| (first + f64::from(k)) * step)
        .take_while(|value| *value <= high + slack)
        .take(MOST_MULTIPLES)
        .collect()
}

/// `value` with so many decimals, a true minus sign, and no negative zero.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    let digits = format!("{:.decimals$}", value.abs());
    let is_zero = digits.bytes().all(|byte| matches!(byte, b'0' | b'.'));
    if value < 0.0 && !is_zero { format!("{MINUS}{digits}") } else { digits }
}

/// `value` with at most so many decimals, without trailing zeros.
pub(crate) fn brief(value: f64, decimals: usize) -> String {
    let digits = fixed(value, decimals);
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.').into() } else { digits }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_the_next_round_number() {
        for (least, label) in [
            (0.001, "0.001"),
            (0.0011, "0.002"),
            (0.3, "0.5"),
            (0.51, "1"),
            (1.0, "1"),
            (1.5, "2"),
            (17.0, "20"),
            (21.0, "50"),
            (60.0, "100"),
        ] {
            let ticks = Ticks::at_least(least);
            assert_eq!(ticks.label(ticks.step), label, "at least {least}");
        }
    }

    #[test]
    fn ticks_on_the_ends_are_kept() {
        let ticks = Ticks::at_least(0.1);
        let labels: Vec<_> = ticks.labelled(-0.3, 0.1).into_iter().map(|value| ticks.label(value)).collect();
        assert_eq!(labels, ["−0.3", "−0.2", "−0.1", "0.0", "0.1"]);
    }

    #[test]
    fn numbers_have_no_negative_zero_and_no_idle_decimals() {
        assert_eq!(fixed(-0.000_4, 3), "0.000");
        assert_eq!(brief(2.5, 4), "2.5");
        assert_eq!(brief(1.25, 4), "1.25");
        assert_eq!(brief(100.0, 4), "100");
        assert_eq!(brief(100.0, 0), "100");
    }

    #[test]
    fn a_hostile_range_ends() {
        assert!(multiples(1e-9, 0.0, 1e9).len() <= MOST_MULTIPLES);
        assert!(multiples(0.0, 0.0, 1.0).len() <= MOST_MULTIPLES);
    }
}
