//! Makes events of steps: widths, spaces, direction set-up and hold, and the board's minimum between two events.
//!
//! Steps come in the order of their times; each becomes an event that raises its pins, at the first instant that all
//! rules allow, and later an event that lowers them. A direction changes in an event of its own, as early as the
//! last pulse's hold time allows. Events closer than the minimum merge where that breaks no rule (a fall with the
//! next rise of the other axis), else the later one waits.
//!
//! Times are clocks from the start of the present tick. An event that would begin less than the minimum before a
//! tick's border begins on it; one less than the minimum behind it waits: the border itself is always an event, so
//! that every tick is whole. Events may run past the present tick: the next tick then begins with less room.

use crate::config::{Machine, TICK_CLOCKS};
use crate::train::{Event, Levels};
use crate::units::Axis;

/// A time that never comes.
const NEVER: i64 = i64::MAX;

/// What one axis's pins still owe.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
struct Pins {
    width: i64,
    space: i64,
    setup: i64,
    hold: i64,
    /// When the step pin must go low; [`NEVER`] while it is low.
    fall: i64,
    /// Earliest next rise after the last fall.
    ready: i64,
    /// Earliest change of direction after the last rise.
    free: i64,
    /// Earliest rise after the last change of direction.
    settled: i64,
}

/// Long before any tick.
const LONG_AGO: i64 = -(1 << 40);

impl Pins {
    const fn new(width: u32, space: u32, setup: u32, hold: u32) -> Self {
        Self {
            width: width as i64,
            space: space as i64,
            setup: setup as i64,
            hold: hold as i64,
            fall: NEVER,
            ready: LONG_AGO,
            free: LONG_AGO,
            settled: LONG_AGO,
        }
    }

    /// The same figures seen from the next tick.
    const fn next_tick(&mut self) {
        if self.fall != NEVER {
            self.fall = earlier(self.fall);
        }
        self.ready = earlier(self.ready);
        self.free = earlier(self.free);
        self.settled = earlier(self.settled);
    }
}

const fn earlier(time: i64) -> i64 {
    let moved = time.saturating_sub(TICK_CLOCKS as i64);
    if moved < LONG_AGO { LONG_AGO } else { moved }
}

/// Turns timed steps into a train.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Shaper {
    x: Pins,
    z: Pins,
    event_min: i64,
    /// Levels of the last event, not yet handed out.
    levels: Levels,
    /// When it began.
    began: i64,
}

impl Shaper {
    /// A shaper whose pins are all low.
    pub const fn new(machine: &Machine) -> Self {
        let (x, z) = (&machine.x, &machine.z);
        Self {
            x: Pins::new(x.width, x.space, x.setup, x.hold),
            z: Pins::new(z.width, z.space, z.setup, z.hold),
            event_min: machine.event_min as i64,
            levels: Levels::LOW,
            began: 0,
        }
    }

    /// Shapes with other figures from now on. The pins stay as they are; what they owe from before, they owe as before.
    pub const fn configure(&mut self, machine: &Machine) {
        let new = Self::new(machine);
        self.x = Pins { fall: self.x.fall, ready: self.x.ready, free: self.x.free, settled: self.x.settled, ..new.x };
        self.z = Pins { fall: self.z.fall, ready: self.z.ready, free: self.z.free, settled: self.z.settled, ..new.z };
        self.event_min = new.event_min;
    }

    /// How far the train runs past the present tick, clocks.
    pub const fn ahead(&self) -> i64 {
        self.began.saturating_sub(TICK_CLOCKS as i64)
    }

    /// Adds a step at `due` clocks from the start of the tick, or as soon after it as the rules allow. Each of `x`
    /// and `z` is -1, 0 or 1.
    #[inline]
    pub fn step(&mut self, due: u32, x: i8, z: i8, out: &mut impl FnMut(Event)) {
        let mut due = i64::from(due);
        if x != 0 {
            due = self.prepare(Axis::X, x > 0, due, out);
        }
        if z != 0 {
            due = self.prepare(Axis::Z, z > 0, due, out);
        }
        // falls before the step, but not so close that the step would have to wait for them
        self.fall_until(due, out);
        let at = self.placed(due);
        let mut levels = self.lowered(at);
        if x != 0 {
            levels = levels.with_step(Axis::X, true);
            self.x.fall = at.saturating_add(self.x.width);
            self.x.free = at.saturating_add(self.x.hold);
        }
        if z != 0 {
            levels = levels.with_step(Axis::Z, true);
            self.z.fall = at.saturating_add(self.z.width);
            self.z.free = at.saturating_add(self.z.hold);
        }
        self.put(at, levels, out);
    }

    /// Ends the tick: what is left of it is handed out, and times count from the next.
    pub fn end_tick(&mut self, out: &mut impl FnMut(Event)) {
        let border = i64::from(TICK_CLOCKS);
        self.fall_until(border.saturating_add(self.event_min).saturating_sub(1), out);
        if self.began < border {
            out(Event::new(self.levels, clocks(border.saturating_sub(self.began))));
            self.began = border;
        }
        self.began = self.began.saturating_sub(border);
        self.x.next_tick();
        self.z.next_tick();
    }

    /// Whether both step pins are low and nothing runs past the tick.
    pub const fn at_rest(&self) -> bool {
        self.x.fall == NEVER && self.z.fall == NEVER && self.began == 0
    }

    const fn pins(&mut self, axis: Axis) -> &mut Pins {
        match axis {
            Axis::X => &mut self.x,
            Axis::Z => &mut self.z,
        }
    }

    /// Earliest rise of `axis` at or after `due`, its pin low and the direction set.
    #[inline]
    fn prepare(&mut self, axis: Axis, plus: bool, due: i64, out: &mut impl FnMut(Event)) -> i64 {
        // the pin must have fallen, and when it did tells when it may rise: a fall may have had to wait
        while self.pins(axis).fall != NEVER {
            self.fall_next(out);
        }
        if self.levels.plus(axis) != plus {
            self.turn(axis, plus, out);
        }
        let pins = self.pins(axis);
        due.max(pins.ready).max(pins.settled)
    }

    /// Lowers what is due next.
    fn fall_next(&mut self, out: &mut impl FnMut(Event)) {
        let at = self.placed(self.x.fall.min(self.z.fall));
        let levels = self.lowered(at);
        self.put(at, levels, out);
    }

    /// Changes the direction of an axis as early as its last pulse allows.
    #[cold]
    fn turn(&mut self, axis: Axis, plus: bool, out: &mut impl FnMut(Event)) {
        let due = self.pins(axis).free.max(self.began.saturating_add(self.event_min));
        self.fall_until(due, out);
        let at = self.placed(due);
        let levels = self.lowered(at).with_plus(axis, plus);
        self.put(at, levels, out);
        let pins = self.pins(axis);
        pins.settled = at.saturating_add(pins.setup);
    }

    /// Lowers pins that are due long enough before `until` for another event then.
    #[inline]
    fn fall_until(&mut self, until: i64, out: &mut impl FnMut(Event)) {
        loop {
            let next = self.x.fall.min(self.z.fall);
            if next == NEVER {
                return;
            }
            let at = self.placed(next);
            if at.saturating_add(self.event_min) > until {
                return;
            }
            let levels = self.lowered(at);
            self.put(at, levels, out);
        }
    }

    /// The levels with every pin low whose fall is due at `at`.
    #[inline]
    fn lowered(&mut self, at: i64) -> Levels {
        let mut levels = self.levels;
        if self.x.fall <= at {
            levels = levels.with_step(Axis::X, false);
            self.x.fall = NEVER;
            self.x.ready = at.saturating_add(self.x.space);
        }
        if self.z.fall <= at {
            levels = levels.with_step(Axis::Z, false);
            self.z.fall = NEVER;
            self.z.ready = at.saturating_add(self.z.space);
        }
        levels
    }

    /// The first instant at or after `due` at which an event may begin.
    #[inline]
    const fn placed(&self, due: i64) -> i64 {
        let border = TICK_CLOCKS as i64;
        let after = self.began.saturating_add(self.event_min);
        let at = if due > after { due } else { after };
        if at <= border.saturating_sub(self.event_min) || at >= border.saturating_add(self.event_min) {
            at
        } else if at <= border && self.began < border {
            border
        } else {
            border.saturating_add(self.event_min)
        }
    }

    /// Begins an event, handing out the one before it.
    #[inline]
    fn put(&mut self, at: i64, levels: Levels, out: &mut impl FnMut(Event)) {
        let border = i64::from(TICK_CLOCKS);
        if self.began < border && at > border {
            out(Event::new(self.levels, clocks(border.saturating_sub(self.began))));
            self.began = border;
        }
        out(Event::new(self.levels, clocks(at.saturating_sub(self.began))));
        self.levels = levels;
        self.began = at;
    }
}

/// An interval: between 1 and one tick by construction.
const fn clocks(interval: i64) -> u32 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to 0..=65535")]
    if interval < 0 {
        0
    } else if interval > 65_535 {
        65_535
    } else {
        interval as u32
    }
}
