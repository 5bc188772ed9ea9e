//! The rules of the pins: widths, spaces, set-up and hold of the direction.
//!
//! Times are differences of whole train clocks and are compared with the least number of clocks that
//! covers the required time. Before its first change a pin counts as having been low for ever.

use crate::fault::{FaultKind, Faults, Here};
use crate::setup::{Axis, CLOCKS_PER_SECOND, Limits, PerAxis, clocks_for};

const STEP: u32 = 1;
const PLUS: u32 = 2;
/// Long before the first event; no required time reaches it.
const LONG_AGO: i64 = i64::MIN / 2;

/// The pins of one axis.
#[derive(Clone, Debug)]
struct Pins {
    axis: Axis,
    width: i64,
    space: i64,
    setup: i64,
    hold: i64,
    rose: i64,
    fell: i64,
    turned: i64,
    /// Time of the last rising edge with the direction it had.
    last_rise: Option<(i64, bool)>,
    /// Shortest time between successive rising edges in one direction.
    shortest: i64,
}

impl Pins {
    fn new(axis: Axis, limits: Limits) -> Self {
        let clocks = |ns| i64::try_from(clocks_for(ns)).unwrap_or(i64::MAX);
        Self {
            axis,
            width: clocks(limits.pulse_width_ns),
            space: clocks(limits.min_space_ns),
            setup: clocks(limits.dir_setup_ns),
            hold: clocks(limits.dir_hold_ns),
            rose: LONG_AGO,
            fell: LONG_AGO,
            turned: LONG_AGO,
            last_rise: None,
            shortest: i64::MAX,
        }
    }

    /// Takes the new level (step, direction) of pins of which `changed` are new. Returns the pulse
    /// that a rising edge makes: -1, 0 or 1.
    #[inline]
    fn change(&mut self, now: i64, level: u32, changed: u32, here: Here, faults: &mut Faults) -> i32 {
        let axis = Some(self.axis);
        let mut at_least = |found: i64, bound: i64, kind: FaultKind| {
            if found < bound {
                faults.add(here.fault(kind, axis, found, bound));
            }
        };
        if changed & PLUS != 0 {
            at_least(now - self.rose, self.hold, FaultKind::DirectionHold);
            self.turned = now;
        }
        if changed & STEP == 0 {
            return 0;
        }
        if level & STEP == 0 {
            at_least(now - self.rose, self.width, FaultKind::PulseTooShort);
            self.fell = now;
            return 0;
        }
        at_least(now - self.fell, self.space, FaultKind::SpaceTooShort);
        at_least(now - self.turned, self.setup, FaultKind::DirectionSetup);
        self.rose = now;
        let plus = level & PLUS != 0;
        if let Some((before, direction)) = self.last_rise
            && direction == plus
        {
            self.shortest = self.shortest.min(now - before);
        }
        self.last_rise = Some((now, plus));
        if plus { 1 } else { -1 }
    }

    /// The highest rate in Hz, 0 without two pulses in one direction.
    fn max_rate(&self) -> f64 {
        match u32::try_from(self.shortest) {
            Ok(clocks) if clocks > 0 => f64::from(CLOCKS_PER_SECOND) / f64::from(clocks),
            Ok(_) => f64::INFINITY,
            // Two pulses six minutes apart: as good as none.
            Err(_) => 0.0,
        }
    }
}

/// The pins of a lathe.
#[derive(Clone, Debug)]
pub(crate) struct Port {
    x: Pins,
    z: Pins,
    level: u32,
}

/// The four pins of lathe 0.
const PORT: u32 = 0xF;

impl Port {
    pub(crate) fn new(limits: PerAxis<Limits>) -> Self {
        Self { x: Pins::new(Axis::X, limits.x), z: Pins::new(Axis::Z, limits.z), level: 0 }
    }

    /// Writes the bits of `event`; returns the pulses that rising edges make.
    #[inline]
    pub(crate) fn write(&mut self, event: u32, here: Here, faults: &mut Faults) -> PerAxis<i32> {
        let level = (event >> 16) & PORT;
        let changed = level ^ self.level;
        if changed == 0 {
            return PerAxis { x: 0, z: 0 };
        }
        self.level = level;
        let now = here.clocks.cast_signed();
        PerAxis {
            x: self.x.change(now, level, changed, here, faults),
            z: self.z.change(now, level >> 2, changed >> 2, here, faults),
        }
    }

    /// At the end of the train no step pin may be high.
    pub(crate) fn finish(&self, here: Here, faults: &mut Faults) {
        for (pins, step) in [(&self.x, STEP), (&self.z, STEP << 2)] {
            if self.level & step != 0 {
                let high = here.clocks.cast_signed() - pins.rose;
                let kind = FaultKind::PulseNotEnded;
                faults.add(here.fault(kind, Some(pins.axis), high, pins.width));
            }
        }
    }

    pub(crate) fn max_rate(&self) -> PerAxis<f64> {
        PerAxis { x: self.x.max_rate(), z: self.z.max_rate() }
    }
}
