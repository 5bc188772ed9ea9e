//! The motors' limits alone, without a program: what handwheels, joystick and intervention must keep, too.
//!
//! Pins, speed and acceleration are looked at as by the [`Checker`](crate::Checker); there is no curve that could be left.
//! An axis may jump where the caller says that a motion ended or began.

use crate::accel::Accel;
use crate::fault::{FaultKind, Faults, Here};
use crate::hash::Fnv;
use crate::pins::Port;
use crate::setup::{CLOCKS_PER_TICK, PerAxis, Setup, SetupError, clocks_for};

/// Reads a pulse train, and knows no program.
#[derive(Clone, Debug)]
pub struct MotorWatch {
    setup: Setup,
    event_min: u32,
    here: Here,
    port: Port,
    accel: Accel,
    faults: Faults,
    pulses: PerAxis<u64>,
    hash: Fnv,
    /// At the end of the last tick that moved.
    moved: Fnv,
}

impl MotorWatch {
    /// For a machine that stands at the start.
    ///
    /// # Errors
    /// A pulse equivalent or a limit that is no number to measure with.
    pub fn new(setup: Setup) -> Result<Self, SetupError> {
        setup.check()?;
        Ok(Self {
            event_min: shortest(&setup),
            here: Here { at: setup.start, ..Here::default() },
            port: Port::new(setup.limits),
            accel: Accel::new(&setup),
            faults: Faults::default(),
            pulses: PerAxis::default(),
            hash: Fnv::EMPTY,
            moved: Fnv::EMPTY,
            setup,
        })
    }

    /// One jump may have been at the last edge, as a motion ended there and another began.
    pub fn joint(&mut self) {
        self.accel.joint();
    }

    /// In the tick to come pulses are added to the path's, by a handwheel, a compensation or a way out of a thread: they have a rounding
    /// of their own.
    pub fn added(&mut self) {
        self.accel.added();
    }

    /// The axes stand since the last edge: one jump led there, one will lead away.
    pub fn rest(&mut self) {
        self.accel.rest();
    }

    /// The train was cut off: an emergency stop, or power that failed. What was before is not compared with what follows.
    pub fn cut(&mut self) {
        self.port = Port::new(self.setup.limits);
        self.accel = Accel::new(&Setup { start: self.here.at, ..self.setup });
    }

    /// The limits are others from now on; to be called at rest.
    ///
    /// # Errors
    /// As [`new`](Self::new); nothing has changed then.
    pub fn configure(&mut self, setup: Setup) -> Result<(), SetupError> {
        setup.check()?;
        (self.setup, self.event_min) = (setup, shortest(&setup));
        self.cut();
        Ok(())
    }

    /// Takes a tick of the train; `on_step` is called at each event with a rising edge, with its time in train clocks and
    /// the position after it.
    pub fn tick(&mut self, events: &[u32], on_step: &mut impl FnMut(u64, i32, i32)) {
        let (start, pulses) = (self.here.clocks, self.pulses);
        for &event in events {
            self.hash.add(event);
            let interval = event & 0xFFFF;
            if interval < self.event_min {
                let (found, bound) = (i64::from(interval), i64::from(self.event_min));
                self.faults.add(self.here.fault(FaultKind::EventTooShort, None, found, bound));
            }
            let moved = self.port.write(event, self.here, &mut self.faults);
            if moved != PerAxis::default() {
                self.here.at.x = self.here.at.x.wrapping_add(moved.x);
                self.here.at.z = self.here.at.z.wrapping_add(moved.z);
                self.pulses.x += u64::from(moved.x.unsigned_abs());
                self.pulses.z += u64::from(moved.z.unsigned_abs());
                // wheels of both axes are added to whatever the program does: no axis steps along with the other
                self.accel.edge(moved, false, true);
                on_step(self.here.clocks, self.here.at.x, self.here.at.z);
            }
            self.here.clocks += u64::from(interval);
        }
        let sum = (self.here.clocks - start).cast_signed();
        let tick = i64::from(CLOCKS_PER_TICK);
        if sum != tick {
            self.faults.add(self.here.fault(FaultKind::TickSum, None, sum, tick));
        }
        self.accel.boundary(self.here, &mut self.faults);
        if self.pulses != pulses {
            self.moved = self.hash;
        }
    }

    /// The program line that faults name from now on.
    pub fn line(&mut self, line: u32) {
        self.here.line = line;
    }

    /// Position in pulses after the last tick.
    #[must_use]
    pub fn position(&self) -> PerAxis<i32> {
        self.here.at
    }

    /// Pulses of each axis so far.
    #[must_use]
    pub fn pulses(&self) -> PerAxis<u64> {
        self.pulses
    }

    /// Hash of the train up to the end of the last tick with a rising edge.
    #[must_use]
    pub fn train_hash(&self) -> u64 {
        self.moved.value()
    }

    /// Ends the train, which is followed by rest: what was broken.
    #[must_use]
    pub fn finish(mut self) -> Faults {
        self.port.finish(self.here, &mut self.faults);
        self.accel.finish(self.here, &mut self.faults);
        self.faults
    }
}

/// Clocks of the shortest event.
fn shortest(setup: &Setup) -> u32 {
    u32::try_from(clocks_for(setup.event_min_ns)).unwrap_or(u32::MAX)
}
