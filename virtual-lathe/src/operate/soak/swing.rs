//! How far a thread may swing back with its spindle.
//!
//! A thread follows the angle that is foretold of readings by a [filter](interp_core::drive::spindle), a quarter of what is
//! still between them a tick ([geared](interp_core::channel)). Both are linear: what the tool is ahead of a reading is a sum over
//! the counts of all ticks until then, each times a figure, and those figures add up to 7.4 in magnitude (4.7 to plus, 2.7 to
//! minus). So while it is locked the tool is within 7.4 V counts of the reading, with V the most counts a tick, and from one moment to
//! another it goes back by at most lead times B + 14.8 V, with B what the spindle has turned back in between.
//! Where the limits make it let go it goes on beyond that on either side by what braking takes, v²/2a and a tick's advance v, with v
//! the largest speed along the path and a the least acceleration. Hence
//!
//! ```text
//! back <= lead (B + 15 V) + v²/a + 2 v
//! ```
//!
//! B is what the readings have come back from their furthest since the cut began, to plus or to minus, whichever is less: in the sense of the
//! thread that is B, and if it is less in the other one the thread has not come farther than that.

use interp_core::drive::ThreadStage;

/// Counts that the tool may be off, twice, for one count a tick.
const AHEAD: f64 = 15.0;

/// How far a sequence has come back from its furthest.
#[derive(Copy, Clone, Debug, Default)]
struct Comeback {
    furthest: i64,
    most: i64,
}

impl Comeback {
    fn add(&mut self, at: i64) {
        self.furthest = self.furthest.max(at);
        self.most = self.most.max(self.furthest - at);
    }
}

/// A spindle and the thread that it drives, as readings and the display show them.
#[derive(Clone, Debug)]
pub(super) struct Swing {
    /// Path that a count leads at most, nm; nm a tick squared.
    count: f64,
    accel: f64,
    counter: Option<u16>,
    /// Counts since the first reading, and most of a tick.
    turned: i64,
    fastest: i64,
    /// Largest speed along the path, nm a tick.
    speed: f64,
    cutting: bool,
    /// Since the cut began: against either sense.
    back: [Comeback; 2],
}

impl Swing {
    /// `lead`: longest one, nm a turn of `turn` counts; `accel`: least one of the axes, nm a tick squared.
    pub(super) fn new(lead: u32, turn: u32, accel: f64) -> Self {
        let count = f64::from(lead) / f64::from(turn.max(1));
        let back = [Comeback::default(); 2];
        Self { count, accel, counter: None, turned: 0, fastest: 0, speed: 0.0, cutting: false, back }
    }

    /// A tick: the encoder's reading, where the thread is, and the speed along the path, nm a tick.
    pub(super) fn tick(&mut self, counts: Option<u16>, stage: ThreadStage, speed: f64) {
        if let Some(counts) = counts {
            let by = i64::from(counts.wrapping_sub(self.counter.unwrap_or(counts)).cast_signed());
            self.counter = Some(counts);
            self.turned += by;
            self.fastest = self.fastest.max(by.abs());
        }
        let cutting = matches!(stage, ThreadStage::Cutting | ThreadStage::Leaving);
        if cutting && !self.cutting {
            let at = |furthest| Comeback { furthest, most: 0 };
            self.back = [at(self.turned), at(-self.turned)];
        }
        self.cutting = cutting;
        if cutting {
            let [plus, minus] = &mut self.back;
            plus.add(self.turned);
            minus.add(-self.turned);
        }
        if stage != ThreadStage::None {
            self.speed = self.speed.max(speed);
        }
    }

    /// How far the path may be back from its furthest, nm.
    #[expect(clippy::cast_precision_loss, reason = "counts of some hours")]
    pub(super) fn most(&self) -> f64 {
        let [plus, minus] = self.back;
        let turned = plus.most.min(minus.most) as f64;
        self.count * (turned + AHEAD * self.fastest as f64) + self.speed * self.speed / self.accel + 2.0 * self.speed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A micrometre a count, and 10 nm a tick squared.
    fn swing() -> Swing {
        Swing::new(4_096_000, 4_096, 10.0)
    }

    fn run(swing: &mut Swing, readings: &[u16], stage: ThreadStage) {
        readings.iter().for_each(|counts| swing.tick(Some(*counts), stage, 0.0));
    }

    fn is(found: f64, nm: f64) {
        assert!((found - nm).abs() < 1e-6, "{found} {nm}");
    }

    #[test]
    fn a_spindle_that_never_turned_back_grants_what_is_foretold_alone() {
        let mut swing = swing();
        run(&mut swing, &[65_530, 65_535, 4, 9, 14], ThreadStage::Cutting);
        is(swing.most(), 1_000.0 * 15.0 * 5.0);
    }

    #[test]
    fn what_it_turned_back_counts_from_its_furthest_in_either_sense() {
        for sense in [1, -1_i16] {
            let mut swing = swing();
            let counts = [0, 5, 10, 8, 9, 5, 7, 12].map(|at: i16| (at * sense).cast_unsigned());
            run(&mut swing, &counts, ThreadStage::Cutting);
            // from 10 to 5
            is(swing.most(), 1_000.0 * (5.0 + 15.0 * 5.0));
        }
    }

    #[test]
    fn each_cut_has_a_count_of_its_own() {
        let mut swing = swing();
        run(&mut swing, &[0, 4, 8, 4, 0], ThreadStage::Cutting);
        is(swing.most(), 1_000.0 * (8.0 + 15.0 * 4.0));
        run(&mut swing, &[4, 8], ThreadStage::Left);
        run(&mut swing, &[8, 12, 11], ThreadStage::Cutting);
        is(swing.most(), 1_000.0 * (1.0 + 15.0 * 4.0));
    }

    #[test]
    fn braking_goes_beyond() {
        let mut swing = swing();
        run(&mut swing, &[7, 7], ThreadStage::Cutting);
        swing.tick(Some(7), ThreadStage::None, 900.0);
        is(swing.most(), 0.0);
        swing.tick(Some(7), ThreadStage::Cutting, 300.0);
        is(swing.most(), 300.0 * 300.0 / 10.0 + 600.0);
    }

    /// The figures of the filter, of its formulas alone: what a count of one tick does to the tool in all ticks that follow.
    #[test]
    fn a_locked_tool_is_less_than_seven_and_a_half_times_the_counts_of_a_tick_from_the_reading() {
        let r: f64 = 13.0 / 16.0;
        let (alpha, beta, gamma) = (1.0 - r.powi(3), 1.5 * (1.0 - r).powi(2) * (1.0 + r), (1.0 - r).powi(3));
        let (mut angle, mut rate, mut gain) = (0.0, 0.0, 0.0);
        let (mut line, mut ahead, mut sum) = (0.0, 0.0, 0.0);
        for _ in 0..1_000 {
            (angle, rate) = (angle + rate + gain / 2.0, rate + gain);
            let error = 1.0 - angle;
            (angle, rate, gain) = (angle + alpha * error, rate + beta * error, gain + gamma * error);
            let (before, feed) = (line, rate + 1.5 * gain);
            line = angle + 2.0 * (rate + gain);
            ahead = 0.75 * (ahead + feed - (line - before));
            sum += f64::abs(line - 1.0 + ahead);
        }
        assert!(sum > 7.3 && 2.0 * sum < AHEAD, "{sum}");
    }
}
