//! Speed and acceleration of a pulse train, over windows of a tick.
//!
//! Counting pulses in a millisecond would see accelerations of a pulse a millisecond squared that are not there. So a
//! window goes from the last pulse of the window before to its own last one, as in the M/T method (T. Ohmae and
//! others, IEEE Transactions on Industrial Electronics 29(3), 1982), and its rate is the slope of the line of least
//! squares through its pulses: edges of a minor axis wait for those of the major one, and that must not look like
//! acceleration either.
//!
//! For pulses that lie on a parabola, the slope of that line is that of the parabola at `t = mean + S3 / (2 S2)`, with
//! `Sn` the sum of (time - mean)^n. With this as the place of the rate an evenly accelerated train has exactly its
//! acceleration, however its pulses lie in the window.

/// A window without pulses for so many clocks is standstill.
const STANDSTILL: f64 = 240_000.0;
/// Clocks of a tick.
const TICK: f64 = 12_000.0;
const CLOCKS_PER_SECOND: f64 = 12e6;

/// Sums over the pulses of a window; times in ticks since its origin, places in pulses.
#[derive(Clone, Debug, Default)]
struct Sums {
    count: f64,
    t: f64,
    t2: f64,
    t3: f64,
    p: f64,
    pt: f64,
}

impl Sums {
    #[inline]
    fn add(&mut self, t: f64, p: f64) {
        self.count += 1.0;
        self.t += t;
        self.t2 += t * t;
        self.t3 += t * t * t;
        self.p += p;
        self.pt += p * t;
    }

    /// Slope in pulses a tick, and the time that it belongs to; `None` for less than two times.
    fn slope(&self) -> Option<(f64, f64)> {
        let n = self.count;
        let mean = self.t / n;
        let s2 = self.t2 - n * mean * mean;
        let s3 = self.t3 - 3.0 * mean * self.t2 + 2.0 * n * mean * mean * mean;
        // two pulses are at least some clocks apart
        (n > 1.0 && s2 > 1e-9).then(|| ((self.pt - mean * self.p) / s2, mean + s3 / (2.0 * s2)))
    }
}

/// Rate of one axis.
#[derive(Clone, Debug, Default)]
pub(crate) struct Meter {
    sums: Sums,
    /// Pulses of the window, with their sign.
    place: f64,
    /// Pulses of the window, without.
    count: u32,
    /// Clock of the last pulse.
    last: f64,
    /// Clock from which the times of the window are told: its first pulse, or the last one before it.
    origin: f64,
    standing: bool,
    /// Pulses a second.
    rate: f64,
    /// Clock that `rate` belongs to.
    middle: f64,
}

impl Meter {
    pub(crate) fn new() -> Self {
        Self { standing: true, ..Self::default() }
    }

    /// A pulse at a time in clocks.
    #[inline]
    pub(crate) fn pulse(&mut self, now: f64, sense: f64) {
        if self.count == 0 {
            self.sums = Sums::default();
            self.place = 0.0;
            // after a standstill the window begins at its first pulse
            self.origin = if self.standing { now } else { self.last };
            if !self.standing {
                self.sums.add(0.0, 0.0);
            }
        }
        self.place += sense;
        self.sums.add((now - self.origin) / TICK, self.place);
        self.last = now;
        self.count += 1;
    }

    /// The last pulse turns out to have been `by` pulses more than was told.
    pub(crate) fn correct(&mut self, by: f64) {
        // behind the end of its window it is the origin of the next one, wherever it went
        if self.count > 0 {
            self.place += by;
            self.sums.p += by;
            self.sums.pt += by * (self.last - self.origin) / TICK;
        }
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
        self.count = 0;
        (rate, acceleration)
    }

    /// Rate of the window, and the clock it belongs to.
    fn window(&mut self, now: f64) -> (f64, f64) {
        if self.count == 0 {
            // slower than a pulse in the time since the last one
            let silence = now - self.last;
            self.standing |= silence >= STANDSTILL;
            let most = if self.standing { 0.0 } else { CLOCKS_PER_SECOND / silence };
            return (self.rate.clamp(-most, most), now - TICK / 2.0);
        }
        self.standing = false;
        match self.sums.slope() {
            Some((slope, at)) => (slope * CLOCKS_PER_SECOND / TICK, self.origin + at * TICK),
            // a lone pulse after a standstill tells nothing of the next yet
            None => (self.place * CLOCKS_PER_SECOND / STANDSTILL, self.last - TICK / 2.0),
        }
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
            meter.pulse(at, 1.0);
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
            meter.pulse(f64::from(n) * 1200.0, 1.0);
        }
        assert!((meter.tick(TICK).0 - 10_000.0).abs() < 1e-6);
        let rates: Vec<f64> = (2..30).map(|n| meter.tick(f64::from(n) * TICK).0).collect();
        assert!(rates.windows(2).all(|pair| pair[1] <= pair[0]));
        assert!(rates.last().unwrap().abs() <= 0.0);
    }
}
