//! A spindle that costs little while it stands: the same as that of a scenario, without a machine round it.

use figures::{FigureError, Figures};
use interp_core::block::Output;
use interp_core::drive::spindle::Reading;
use machine::{Angle, Encoder, Spindle as Model};

use crate::operate::noise::Noise;

/// Seconds of a tick.
const TICK: f64 = 1e-3;

/// The spindle, its commands and its encoder.
pub(super) struct Spindle {
    model: Model,
    encoder: Encoder,
    turn: i64,
    /// Turns a minute that the program asks for, and the sense.
    speed: f64,
    sense: f64,
    /// The last command was the operator's: turns a minute.
    by_hand: Option<f64>,
    percent: f64,
    /// Part of the speed, and Hz.
    wobble: (f64, f64),
    wavered: f64,
    noise: Noise,
    disturbed: i64,
    lost_index: bool,
    last: Option<i64>,
    seconds: f64,
    /// It stands, and nothing asks it to turn.
    rests: bool,
}

impl Spindle {
    pub(super) fn new(figures: &Figures, seed: u64) -> Result<Self, FigureError> {
        Ok(Self {
            model: Model::new(figures)?,
            encoder: Encoder::new(figures)?,
            turn: 4 * i64::from(figures.whole("encoder.lines")?),
            speed: 0.0,
            sense: 0.0,
            by_hand: None,
            percent: 1.0,
            wobble: (0.0, 0.0),
            wavered: 0.0,
            noise: Noise::new(seed),
            disturbed: 0,
            lost_index: false,
            last: None,
            seconds: 0.0,
            rests: true,
        })
    }

    /// Counts a turn.
    pub(super) fn turn(&self) -> Option<u32> {
        u32::try_from(self.turn).ok()
    }

    pub(super) fn output(&mut self, output: Output) {
        match output {
            Output::SpindleForward => self.sense = 1.0,
            Output::SpindleReverse => self.sense = -1.0,
            Output::SpindleStop => self.sense = 0.0,
            Output::SpindleSpeed(milli_rpm) => self.speed = f64::from(milli_rpm) / 1e3,
            Output::Tool(..) => return,
        }
        self.by_hand = None;
        self.rests = false;
    }

    pub(super) fn hand(&mut self, rpm: f64) {
        self.by_hand = Some(rpm);
        self.rests = false;
    }

    pub(super) fn percent(&mut self, percent: u16) {
        self.percent = f64::from(percent) / 100.0;
        self.rests = false;
    }

    pub(super) fn off(&mut self) {
        (self.sense, self.by_hand) = (0.0, None);
    }

    pub(super) fn wobble(&mut self, part: f64, hz: f64) {
        self.wobble = (part, hz);
    }

    pub(super) fn lose_index(&mut self, lost: bool) {
        self.lost_index = lost;
    }

    pub(super) fn disturb(&mut self, rate: f64) {
        self.noise.set(rate);
        self.rests = false;
    }

    /// A tick has gone by.
    pub(super) fn tick(&mut self) {
        if self.rests {
            return;
        }
        self.seconds += TICK / 2.0;
        let (part, hz) = self.wobble;
        self.wavered += self.model.rpm() / 60.0 * TICK * part * (std::f64::consts::TAU * hz * self.seconds).sin();
        self.seconds += TICK / 2.0;
        let disturbed = self.noise.counts();
        self.disturbed += i64::from(disturbed);
        let rpm = self.by_hand.unwrap_or(self.sense * self.speed) * self.percent;
        self.model.command(rpm);
        self.model.tick();
        self.rests = disturbed == 0 && rpm.abs() < 1e-9 && self.model.rpm().abs() < 1e-9 && self.noise.is_silent();
    }

    /// What the encoder's counter shows.
    pub(super) fn read(&mut self) -> Reading {
        let angle: Angle = self.model.angle_after(0.0).turned(self.wavered);
        let counts = self.encoder.counts(angle);
        let index = self.last.and_then(|last| self.encoder.index_passed(last, counts)).filter(|_| !self.lost_index);
        self.last = Some(counts);
        Reading { counts: low(counts + self.disturbed), index: index.map(|at| low(at + self.disturbed)) }
    }
}

/// The low 16 bits.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a counter of 16 bits")]
const fn low(counts: i64) -> u16 {
    counts as u16
}
