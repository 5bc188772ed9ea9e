//! The spindle behind the control: who commands it, how it wavers, and what its encoder shows.

use figures::{FigureError, Figures};
use interp_core::block::Output;
use interp_core::drive::spindle::Reading;
use machine::{Angle, Encoder, Machine};

use super::noise::Noise;

/// Seconds of a tick.
const TICK: f64 = 1e-3;

/// The spindle's command and its encoder.
pub(super) struct Spindle {
    encoder: Encoder,
    /// Counts a turn, and the count of the index.
    turn: i64,
    index: i64,
    /// Turns a minute that the program asks for, and the sense: 1, 0, -1.
    speed: f64,
    sense: f64,
    /// The last command was the operator's: turns a minute.
    by_hand: Option<f64>,
    /// Part of the speed, and Hz.
    wobble: (f64, f64),
    /// Turns that the wobble has added.
    wavered: f64,
    /// Counts that noise has added.
    noise: i64,
    lost_index: bool,
    last: Option<i64>,
    seconds: f64,
}

impl Spindle {
    /// A spindle that stands.
    pub(super) fn new(figures: &Figures) -> Result<Self, FigureError> {
        let turn = 4 * i64::from(figures.whole("encoder.lines")?);
        let encoder = Encoder::new(figures)?;
        let index = Angle::default().turned(figures.number("encoder.index_deg")? / 360.0);
        Ok(Self {
            index: encoder.counts(index).rem_euclid(turn),
            encoder,
            turn,
            speed: 0.0,
            sense: 0.0,
            by_hand: None,
            wobble: (0.0, 0.0),
            wavered: 0.0,
            noise: 0,
            lost_index: false,
            last: None,
            seconds: 0.0,
        })
    }

    /// An output of the program.
    pub(super) fn output(&mut self, output: Output) {
        match output {
            Output::SpindleForward => self.sense = 1.0,
            Output::SpindleReverse => self.sense = -1.0,
            Output::SpindleStop => self.sense = 0.0,
            Output::SpindleSpeed(milli_rpm) => self.speed = f64::from(milli_rpm) / 1e3,
            Output::Tool(..) => return,
        }
        self.by_hand = None;
    }

    /// A speed by hand, turns a minute.
    pub(super) fn hand(&mut self, rpm: f64) {
        self.by_hand = Some(rpm);
    }

    /// It is switched off.
    pub(super) fn off(&mut self) {
        (self.sense, self.by_hand) = (0.0, None);
    }

    /// It wavers by a part of its speed.
    pub(super) fn wobble(&mut self, part: f64, hz: f64) {
        self.wobble = (part, hz);
    }

    /// The index pulse does not come.
    pub(super) fn lose_index(&mut self, lost: bool) {
        self.lost_index = lost;
    }

    /// Commands the machine, under an override in percent.
    pub(super) fn command(&self, machine: &mut Machine, percent: u16) {
        let rpm = self.by_hand.unwrap_or(self.sense * self.speed);
        machine.spindle_mut().command(rpm * f64::from(percent) / 100.0);
    }

    /// Angle now, with all that it wavers.
    pub(super) fn angle(&self, machine: &Machine) -> Angle {
        machine.spindle_angle().turned(self.wavered)
    }

    /// Speed now, turns a minute.
    pub(super) fn rpm(&self, machine: &Machine) -> f64 {
        machine.spindle().rpm() * (1.0 + self.wave())
    }

    fn wave(&self) -> f64 {
        let (part, hz) = self.wobble;
        part * (std::f64::consts::TAU * hz * self.seconds).sin()
    }

    /// A tick has gone by.
    pub(super) fn tick(&mut self, machine: &Machine, noise: &mut Noise) {
        // turns, at the speed in the middle of the tick
        let half = TICK / 2.0;
        self.seconds += half;
        self.wavered += machine.spindle().rpm() / 60.0 * TICK * self.wave();
        self.seconds += half;
        self.noise += i64::from(noise.counts());
    }

    /// What the encoder's counter shows.
    pub(super) fn read(&mut self, machine: &Machine) -> Reading {
        let counts = self.encoder.counts(self.angle(machine));
        let index = self.last.and_then(|last| self.passed(last, counts)).filter(|_| !self.lost_index);
        self.last = Some(counts);
        Reading { counts: low(counts + self.noise), index: index.map(|at| low(at + self.noise)) }
    }

    /// The last count at which the index came between two readings.
    fn passed(&self, from: i64, to: i64) -> Option<i64> {
        // forward it comes at the count of the index, backward at the same one
        let below = |count: i64| (count - self.index).div_euclid(self.turn) * self.turn + self.index;
        if to > from {
            Some(below(to)).filter(|at| *at > from)
        } else {
            Some(below(to - 1) + self.turn).filter(|at| *at < from)
        }
    }
}

/// The low 16 bits.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a counter of 16 bits")]
const fn low(counts: i64) -> u16 {
    counts as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_index_comes_once_a_turn_either_way() {
        let mut figures = Figures::new(machine::TABLES);
        figures.set("encoder.index_deg", "90").unwrap();
        let spindle = Spindle::new(&figures).unwrap();
        assert_eq!((spindle.turn, spindle.index), (4096, 1024));
        assert_eq!(spindle.passed(1020, 1030), Some(1024));
        assert_eq!(spindle.passed(1024, 1030), None);
        assert_eq!(spindle.passed(1020, 1023), None);
        assert_eq!(spindle.passed(1030, 1020), Some(1024));
        assert_eq!(spindle.passed(1024, 1020), None);
        assert_eq!(spindle.passed(-3070, -3080), Some(-3072));
        assert_eq!(spindle.passed(1030, 1030), None);
        for (from, to) in [(0, 9000), (9000, 0)] {
            let steps = if to > from { 1 } else { -1 };
            let mut at = from;
            let mut found = Vec::new();
            while at != to {
                found.extend(spindle.passed(at, at + steps));
                at += steps;
            }
            found.sort_unstable();
            assert_eq!(found, [1024, 5120]);
        }
    }
}
