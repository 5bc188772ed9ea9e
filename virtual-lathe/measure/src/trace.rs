//! The steps of a train as text: `time_ns,x,z`, a line for each event with a rising edge.

use std::io::{self, Write};

/// Writes steps as CSV while the checker reads the train.
///
/// `time_ns` is the time of the event's leading edge, floor(clocks * 250 / 3); `x` and `z` are the
/// position after it, in pulses.
///
/// ```
/// # use measure::Trace;
/// let mut trace = Trace::new(Vec::new())?;
/// trace.step(12_001, 7, -3);
/// assert_eq!(trace.finish()?, b"time_ns,x,z\n1000083,7,-3\n");
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug)]
pub struct Trace<W: Write> {
    out: W,
    state: io::Result<()>,
}

impl<W: Write> Trace<W> {
    /// Writes the heading. A buffered writer is worth it.
    ///
    /// # Errors
    /// What the writer says.
    pub fn new(mut out: W) -> io::Result<Self> {
        out.write_all(b"time_ns,x,z\n")?;
        Ok(Self { out, state: Ok(()) })
    }

    /// Writes a step; made to be called by `Checker::tick_traced`. An error is kept for `finish`, and
    /// nothing is written after it.
    pub fn step(&mut self, clocks: u64, x: i32, z: i32) {
        if self.state.is_ok() {
            self.state = writeln!(self.out, "{},{x},{z}", time_ns(clocks));
        }
    }

    /// Flushes the writer and hands it back.
    ///
    /// # Errors
    /// The first thing that went wrong.
    pub fn finish(mut self) -> io::Result<W> {
        self.state?;
        self.out.flush()?;
        Ok(self.out)
    }
}

/// Time of an edge in ns: floor(`clocks` * 250 / 3).
///
/// ```
/// assert_eq!(measure::time_ns(2), 166);
/// ```
#[must_use]
pub fn time_ns(clocks: u64) -> u64 {
    u64::try_from(u128::from(clocks) * 250 / 3).unwrap_or(u64::MAX)
}
