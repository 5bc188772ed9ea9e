//! The spindle of the lathe on the desk: turned by S, M3, M4 and M5 of the program, read by its encoder.

use figures::{FigureError, Figures};
use handcnc::foreground::alarm::Alarm;
use handcnc::foreground::inputs::Inputs;
use interp_core::block::Output;
use interp_core::channel::{Report, State};
use interp_core::drive::spindle::Reading;
use machine::{Encoder, Spindle};

/// A spindle with its encoder.
#[derive(Clone, Debug)]
pub struct Turning {
    spindle: Spindle,
    encoder: Encoder,
    /// At the last reading.
    counts: i64,
    /// Programmed speed, turns a minute.
    rpm: f64,
    /// 1 forward, -1 in reverse, 0 off.
    sense: f64,
}

impl Turning {
    /// The spindle that the figures describe, at rest.
    ///
    /// # Errors
    /// Figures that contradict each other.
    pub fn new(figures: &Figures) -> Result<Self, FigureError> {
        let encoder = Encoder::new(figures)?;
        Ok(Self { spindle: Spindle::new(figures)?, encoder, counts: 0, rpm: 0.0, sense: 0.0 })
    }

    /// The readings at the start of a tick.
    pub fn read(&mut self) -> Inputs {
        let counts = self.encoder.counts(self.spindle.angle_after(0.0));
        let index = self.encoder.index_passed(self.counts, counts);
        self.counts = counts;
        Inputs { spindle: Some(Reading { counts: low_bits(counts), index: index.map(low_bits) }), ..Inputs::NONE }
    }

    /// A tick is over: obeys what the program said in it. An alarm and the end of a program switch the spindle off.
    pub fn tick(&mut self, report: &Report, alarm: Option<Alarm>) {
        match report.output {
            Some(Output::SpindleForward) => self.sense = 1.0,
            Some(Output::SpindleReverse) => self.sense = -1.0,
            Some(Output::SpindleStop) => self.sense = 0.0,
            Some(Output::SpindleSpeed(milli_rpm)) => self.rpm = f64::from(milli_rpm) / 1e3,
            Some(Output::Tool(..)) | None => {}
        }
        if matches!(report.state, State::Ended) || alarm.is_some() {
            self.sense = 0.0;
        }
        self.spindle.command(self.rpm * self.sense);
        self.spindle.tick();
    }

    /// The spindle itself.
    #[must_use]
    pub const fn spindle(&self) -> &Spindle {
        &self.spindle
    }
}

/// What a counter of 16 bits shows.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the low bits are meant")]
const fn low_bits(counts: i64) -> u16 {
    counts as u16
}
