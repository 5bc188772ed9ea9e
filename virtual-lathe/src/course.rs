//! Speed, acceleration and pulse rate over time, in bounded memory: bins of time that grow with the length of the run.

/// Most bins.
const BINS: usize = 2_048;
/// Ticks over which a speed is taken: a slow axis has a pulse in few of them.
const WINDOW: usize = 8;
/// A tick, s.
const TICK_S: f64 = 1e-3;

/// The least and the greatest value in a stretch of time.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Range {
    /// Least.
    pub low: f64,
    /// Greatest.
    pub high: f64,
}

impl Range {
    const NONE: Self = Self { low: f64::INFINITY, high: f64::NEG_INFINITY };

    fn add(&mut self, value: f64) {
        self.low = self.low.min(value);
        self.high = self.high.max(value);
    }

    fn with(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }
}

/// A stretch of time.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Bin {
    /// Speed along the path, mm/min.
    pub speed: Range,
    /// Acceleration, Z and X, mm/s².
    pub acceleration: [Range; 2],
    /// Pulses a second, Z and X.
    pub rate: [Range; 2],
}

impl Bin {
    const NONE: Self = Self { speed: Range::NONE, acceleration: [Range::NONE; 2], rate: [Range::NONE; 2] };

    fn with(self, other: Self) -> Self {
        let both = |a: [Range; 2], b: [Range; 2]| [a[0].with(b[0]), a[1].with(b[1])];
        Self {
            speed: self.speed.with(other.speed),
            acceleration: both(self.acceleration, other.acceleration),
            rate: both(self.rate, other.rate),
        }
    }
}

/// The course of a run.
#[derive(Clone, Debug)]
pub struct Course {
    pulse: [f64; 2],
    /// The last lattice points, one a tick, the newest at `ticks % len`.
    recent: [[i32; 2]; 2 * WINDOW + 1],
    ticks: u64,
    bins: Vec<Bin>,
    /// Ticks of a bin.
    per_bin: u64,
}

impl Course {
    /// Nothing yet; `pulse` is the size of a pulse, Z and X, in mm.
    pub fn new(pulse: [f64; 2]) -> Self {
        Self { pulse, recent: [[0; 2]; 2 * WINDOW + 1], ticks: 0, bins: Vec::new(), per_bin: 1 }
    }

    /// The lattice point at the end of a tick; how many ticks there were.
    pub fn tick(&mut self, lattice: [i32; 2]) -> u64 {
        if self.ticks == 0 {
            self.recent = [lattice; 2 * WINDOW + 1];
        }
        self.recent.rotate_right(1);
        if let Some(newest) = self.recent.first_mut() {
            *newest = lattice;
        }
        self.ticks += 1;
        let [now, .., then, before] = [0, WINDOW / 2, WINDOW, 2 * WINDOW].map(|back| {
            let [z, x] = self.recent.get(back).copied().unwrap_or_default();
            [f64::from(z), f64::from(x)]
        });
        #[expect(clippy::cast_precision_loss, reason = "a few ticks")]
        let seconds = WINDOW as f64 * TICK_S;
        let mut bin = Bin::NONE;
        let mut square = 0.0;
        for (axis, pulse) in self.pulse.iter().enumerate() {
            let at = |place: [f64; 2]| place.get(axis).copied().unwrap_or(0.0);
            let rate = (at(now) - at(then)) / seconds;
            let acceleration = (at(now) - 2.0 * at(then) + at(before)) / (seconds * seconds) * pulse;
            square += (rate * pulse) * (rate * pulse);
            if let (Some(rates), Some(accelerations)) = (bin.rate.get_mut(axis), bin.acceleration.get_mut(axis)) {
                rates.add(rate.abs());
                accelerations.add(acceleration);
            }
        }
        bin.speed.add(square.sqrt() * 60.0);
        self.add(bin);
        self.ticks
    }

    fn add(&mut self, bin: Bin) {
        if (self.ticks - 1).is_multiple_of(self.per_bin) {
            if self.bins.len() == BINS {
                self.bins = self.bins.chunks(2).map(|two| two.iter().fold(Bin::NONE, |a, b| a.with(*b))).collect();
                self.per_bin *= 2;
            }
            self.bins.push(bin);
        } else if let Some(last) = self.bins.last_mut() {
            *last = last.with(bin);
        }
    }

    /// Ticks so far.
    pub fn ticks(&self) -> u64 {
        self.ticks
    }

    /// Seconds of a bin.
    pub fn bin_s(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "ticks of a bin")]
        let ticks = self.per_bin as f64;
        ticks * TICK_S
    }

    /// The bins, in order.
    pub fn bins(&self) -> &[Bin] {
        &self.bins
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_steady_feed_has_one_speed_and_rate() {
        let mut course = Course::new([0.0025, 0.00125]);
        for k in 0..10_000 {
            course.tick([-4 * k, 3 * k]);
        }
        // 4 and 3 pulses a tick: 10 and 3.75 mm/s
        let bin = course.bins()[course.bins().len() / 2];
        let speed = 10.0_f64.hypot(3.75) * 60.0;
        assert!((bin.speed.low - speed).abs() < 1e-9 && (bin.speed.high - speed).abs() < 1e-9);
        assert!((bin.rate[0].high - 4_000.0).abs() < 1e-9 && (bin.rate[1].low - 3_000.0).abs() < 1e-9);
        assert!(bin.acceleration.iter().all(|range| range.low.abs() < 1e-6 && range.high.abs() < 1e-6));
        assert!(course.bins().len() <= BINS);
        #[expect(clippy::cast_precision_loss, reason = "a few bins")]
        let covered = course.bins().len() as f64 * course.bin_s();
        assert!((10.0..10.0 + course.bin_s()).contains(&covered));
    }

    #[test]
    fn a_peak_survives_the_growing_of_bins() {
        let mut course = Course::new([0.001, 0.001]);
        let mut z = 0;
        for k in 0..20_000 {
            z += if (500..520).contains(&k) { 50 } else { 0 };
            course.tick([z, 0]);
        }
        let highest = course.bins().iter().map(|bin| bin.rate[0].high).fold(0.0, f64::max);
        assert!((highest - 50_000.0).abs() < 1e-9);
    }
}
