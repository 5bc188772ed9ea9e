//! Speed and acceleration of a pulse train, over windows of a tick.
//!
//! Counting pulses in a millisecond would see accelerations of a pulse a millisecond squared that are not there. So a
//! window begins and ends at a pulse (the M/T method: T. Ohmae and others, IEEE
//! Transactions on Industrial Electronics 29(3), 1982): the rate is exact for an even train
//! whatever its rate, and for an evenly accelerated one it is that of the window's middle.

/// A window without pulses for so many clocks is standstill.
const STANDSTILL: f64 = 240_000.0;
/// Clocks of a tick.
const TICK: f64 = 12_000.0;
const CLOCKS_PER_SECOND: f64 = 12e6;

/// Rate of one axis.
#[derive(Clone, Debug, Default)]
pub(crate) struct Meter {
    /// First and last pulse of the running window, clocks.
    first: f64,
    last: f64,
    /// Pulses of the window with their sign, and without.
    sum: i32,
    count: u32,
    /// Last pulse of the window before.
    before: f64,
    standing: bool,
    /// Pulses a second.
    rate: f64,
    /// Middle of the window of `rate`.
    middle: f64,
}

impl Meter {
    pub(crate) fn new() -> Self {
        Self { standing: true, ..Self::default() }
    }

    /// A pulse at a time in clocks.
    #[inline]
    pub(crate) fn pulse(&mut self, now: f64, sense: i32) {
        if self.count == 0 {
            self.first = now;
        }
        self.last = now;
        self.sum += sense;
        self.count += 1;
    }

    /// Ends the window; pulses a second, and a second squared.
    pub(crate) fn tick(&mut self, now: f64) -> (f64, f64) {
        let begins = self.standing;
        let (rate, middle) = self.window(now);
        // windows that follow each other have their middles about a tick apart; a start is spread over a whole one
        let least = if begins { TICK } else { TICK / 2.0 };
        let between = (middle - self.middle).max(least) / CLOCKS_PER_SECOND;
        let acceleration = (rate - self.rate) / between;
        (self.rate, self.middle) = (rate, middle);
        if self.count > 0 {
            self.before = self.last;
            self.standing = false;
        }
        (self.sum, self.count) = (0, 0);
        (rate, acceleration)
    }

    /// Rate of the window and its middle.
    fn window(&mut self, now: f64) -> (f64, f64) {
        if self.count == 0 {
            // slower than a pulse in the time since the last one
            let silence = now - self.before;
            self.standing |= silence >= STANDSTILL;
            let most = if self.standing { 0.0 } else { CLOCKS_PER_SECOND / silence };
            return (self.rate.clamp(-most, most), now - TICK / 2.0);
        }
        // after a standstill the window begins at the first pulse; a lone one tells nothing of the next yet
        let (begin, pulses) = match (self.standing, self.count) {
            (false, _) => (self.before, f64::from(self.sum)),
            (true, 1) => {
                return (f64::from(self.sum) * CLOCKS_PER_SECOND / STANDSTILL, self.last - TICK / 2.0);
            }
            (true, count) => (self.first, f64::from(self.sum) * f64::from(count - 1) / f64::from(count)),
        };
        let length = (self.last - begin).max(1.0);
        (pulses / length * CLOCKS_PER_SECOND, (self.last + begin) / 2.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Greatest distance of the measured rate and acceleration from what `pulses` were made with, after a start-up.
    fn worst(pulses: impl Iterator<Item = f64>, rate: impl Fn(f64) -> f64, acceleration: f64) -> (f64, f64) {
        let mut meter = Meter::new();
        let (mut end, mut worst) = (TICK, (0.0_f64, 0.0_f64));
        for at in pulses {
            while at >= end {
                let (got, bend) = meter.tick(end);
                if end > 5.0 * TICK {
                    let middle = meter.middle / CLOCKS_PER_SECOND;
                    worst = (worst.0.max((got - rate(middle)).abs()), worst.1.max((bend - acceleration).abs()));
                }
                end += TICK;
            }
            meter.pulse(at, 1);
        }
        worst
    }

    #[test]
    fn an_even_train_has_its_rate_and_no_acceleration() {
        for rate in [1_300.0, 7_777.7, 99_000.0] {
            let pulses = (0..2000).map(|n| f64::from(n) * CLOCKS_PER_SECOND / rate);
            let (off, bend) = worst(pulses, |_| rate, 0.0);
            assert!(off < 1e-6 && bend < 1e-3, "{off} {bend}");
        }
    }

    #[test]
    fn an_evenly_accelerated_train_has_its_acceleration() {
        // 500 mm/s2 with pulses of 1.25 um, pulse n at sqrt(2 n / a)
        let a = 400_000.0;
        let pulses = (0..8000).map(|n| (2.0 * f64::from(n) / a).sqrt() * CLOCKS_PER_SECOND);
        let (off, bend) = worst(pulses, |time| a * time, a);
        assert!(off < 1e-3 && bend < a * 1e-6, "{off} {bend}");
    }

    #[test]
    fn a_train_that_stops_comes_to_rest() {
        let mut meter = Meter::new();
        for n in 0..10 {
            meter.pulse(f64::from(n) * 1200.0, 1);
        }
        assert!((meter.tick(TICK).0 - 10_000.0).abs() < 1e-6);
        let rates: Vec<f64> = (2..30).map(|n| meter.tick(f64::from(n) * TICK).0).collect();
        assert!(rates.windows(2).all(|pair| pair[1] <= pair[0]));
        assert!(rates.last().unwrap().abs() <= 0.0);
    }
}
