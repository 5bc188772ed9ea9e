//! The figures of a train.

use crate::deviation::Deviation;
use crate::fault::Faults;
use crate::feed::FeedError;
use crate::setup::PerAxis;
use std::fmt;

/// What the checker found.
#[derive(Clone, Debug)]
pub struct Report {
    /// Events from the first tick to the end of the last tick with a rising edge.
    pub events: u64,
    /// Rising edges of each step pin.
    pub pulses: PerAxis<u64>,
    /// How far the motor is beyond the program at the end, in pulses. 0 without compensation.
    pub beyond: PerAxis<i32>,
    /// Motions completed that made pulses.
    pub motions: u64,
    /// Time of the end of the last tick with a rising edge, in s.
    pub time_s: f64,
    /// FNV-1a 64 over the events counted in `events`, each as `u32`, little endian.
    pub train_hash: u64,
    /// Largest deviation from the walked curve.
    pub walked: Deviation,
    /// Largest deviation from the programmed curve.
    pub programmed: Deviation,
    /// Steps that went back along their curve, by half of the finer pulse equivalent or more. 0 in a
    /// train that walks forward, except on arcs with a radius of about a pulse.
    pub backward_steps: u64,
    /// 12 MHz over the shortest time between successive rising edges of the axis, both with the same
    /// direction, in Hz; 0 without such a pair.
    pub max_rate_hz: PerAxis<f64>,
    /// Greatest acceleration in mm/s² over windows of 8 ticks away from joints, starts and stops, less
    /// the 2 pulses (4 for a minor axis) that rounding to the lattice can fake. Never high; low by up to
    /// twice that over (8 ms)².
    pub max_accel: PerAxis<f64>,
    /// By how much a second difference was above a h² + 2 pulses at most (with n joints, starts or stops
    /// in the window above a h² + n j h + 2), in pulses. Not all of that is a fault:
    /// a minor axis is granted 2 pulses more, and edges may wait.
    pub bend_excess: PerAxis<f64>,
    /// How well the programmed feed was kept; `None` if no window could be judged.
    pub feed_error_percent: Option<FeedError>,
    /// Broken rules.
    pub faults: Faults,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "events            {}", self.events)?;
        writeln!(f, "pulses            X {} Z {}", self.pulses.x, self.pulses.z)?;
        writeln!(f, "motions           {}", self.motions)?;
        writeln!(f, "time              {:.3} s", self.time_s)?;
        writeln!(f, "train hash        {:016x}", self.train_hash)?;
        for (name, worst) in [("walked", self.walked), ("programmed", self.programmed)] {
            writeln!(
                f,
                "off {name:<13} {:.4} pulses, line {}, X {} Z {}, clock {}",
                worst.pulses, worst.line, worst.at.x, worst.at.z, worst.clocks
            )?;
        }
        writeln!(f, "backward steps    {}", self.backward_steps)?;
        let pair = |pair: PerAxis<f64>| format!("X {:.1} Z {:.1}", pair.x, pair.z);
        writeln!(f, "max rate          {} Hz", pair(self.max_rate_hz))?;
        writeln!(f, "max acceleration  {} mm/s2", pair(self.max_accel))?;
        writeln!(f, "bound exceeded by {} pulses", pair(self.bend_excess))?;
        match self.feed_error_percent {
            None => writeln!(f, "feed error        no window judged")?,
            Some(feed) => writeln!(
                f,
                "feed error        mean {:.3} %, max {:.3} % (line {}, clock {}), {} windows, \
                 {} unsteady, {} limited",
                feed.mean, feed.max, feed.line, feed.clocks, feed.windows, feed.unsteady, feed.limited
            )?,
        }
        write!(f, "faults            {}", self.faults.total())?;
        for fault in self.faults.first() {
            write!(f, "\n  {fault}")?;
        }
        Ok(())
    }
}
