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
//!
//! Steps of one curve come evenly and mostly touch none of these rules: [`Shaper::run`] proves that for a row of them
//! at once and makes them in a short loop, to the same events.

use crate::config::{Machine, TICK_CLOCKS};
use crate::curve::strides::{Strides, Turned, Turns};
use crate::times::{FRACTION, Times};
use crate::train::{Event, Levels, Train};
use crate::units::Axis;

/// A time that never comes.
const NEVER: i32 = i32::MAX;

/// The tick's end.
#[expect(clippy::cast_possible_wrap, reason = "12 000")]
const BORDER: i32 = TICK_CLOCKS as i32;

/// Brings a time's fraction to the top of a word, where it carries.
const TO_TOP: u32 = 32 - FRACTION;

/// Clocks as the shaper holds them; 0.7 s, far more than any width, is the most. Times of a tick are then below 2^25
/// in magnitude but for [`NEVER`], which nothing is added to, so no sum leaves 32 bits.
const fn clamped(clocks: u32) -> i32 {
    const MOST: u32 = 1 << 23;
    #[expect(clippy::cast_possible_wrap, reason = "at most 2^23")]
    if clocks > MOST { MOST as i32 } else { clocks as i32 }
}

/// What one axis's pins still owe.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
struct Pins {
    width: i32,
    space: i32,
    setup: i32,
    hold: i32,
    /// When the step pin must go low; [`NEVER`] while it is low.
    fall: i32,
    /// Earliest next rise: after the last fall and the last change of direction; while the pin is high, what it will
    /// be if it falls in time.
    ready: i32,
    /// Earliest change of direction after the last rise.
    free: i32,
}

impl Pins {
    const fn new(width: u32, space: u32, setup: u32, hold: u32) -> Self {
        Self {
            width: clamped(width),
            space: clamped(space),
            setup: clamped(setup),
            hold: clamped(hold),
            fall: NEVER,
            ready: 0,
            free: 0,
        }
    }

    /// Has made a pulse at `at` that fell `width` later.
    const fn made(&mut self, at: i32, width: i32) {
        self.ready = at.wrapping_add(width).wrapping_add(self.space);
        self.free = at.wrapping_add(self.hold);
    }

    /// The same figures seen from the next tick.
    const fn next_tick(&mut self) {
        if self.fall != NEVER {
            self.fall = self.fall.wrapping_sub(BORDER);
        }
        // nothing is asked of a time before the tick
        self.ready = larger(self.ready.wrapping_sub(BORDER), 0);
        self.free = larger(self.free.wrapping_sub(BORDER), 0);
    }
}

const fn larger(a: i32, b: i32) -> i32 {
    if a > b { a } else { b }
}

/// What [`Shaper::run`] made.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Made {
    /// Steps in all.
    pub steps: u32,
    /// Diagonal ones among them.
    pub diagonals: u32,
}

/// A row of steps that touch no rule.
struct Row {
    count: u32,
    /// Clocks from a step to its fall.
    width: u32,
}

/// Turns timed steps into a train.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Shaper {
    x: Pins,
    z: Pins,
    event_min: i32,
    /// Least clocks from one step to the next at which each step's pulse is over, and so is all it asks for, before
    /// the next is due; [`NEVER`] where the axes' pulses differ in width.
    quiet: i32,
    /// Levels of the last event, not yet handed out.
    levels: Levels,
    /// When it began.
    began: i32,
    /// Events of the next tick that are known already: steps that come in a crowd run past the border.
    early: [Event; EARLY],
    early_count: usize,
}

/// Most events of the next tick that are kept, two a pulse. Where both axes run at their largest speeds hardly a pause is left
/// between events, and what has come in a crowd is caught up slowly: three steps that a curve's end or the joint of two octants
/// owes, and of either axis one that was owed and one each that the program, the hand and the compensation round up.
const EARLY: usize = 24;

impl Shaper {
    /// A shaper whose pins are all low.
    pub const fn new(machine: &Machine) -> Self {
        let (x, z) = (&machine.x, &machine.z);
        let x = Pins::new(x.width, x.space, x.setup, x.hold);
        let z = Pins::new(z.width, z.space, z.setup, z.hold);
        let event_min = clamped(machine.event_min);
        let after = larger(larger(x.space, z.space), event_min);
        Self {
            x,
            z,
            event_min,
            quiet: if x.width == z.width { larger(x.width, event_min).wrapping_add(after) } else { NEVER },
            levels: Levels::LOW,
            began: 0,
            early: [Event::from_word(0); EARLY],
            early_count: 0,
        }
    }

    /// Shapes with other figures from now on. The pins stay as they are; what they owe from before, they owe as before.
    pub const fn configure(&mut self, machine: &Machine) {
        let new = Self::new(machine);
        self.x = Pins { fall: self.x.fall, ready: self.x.ready, free: self.x.free, ..new.x };
        self.z = Pins { fall: self.z.fall, ready: self.z.ready, free: self.z.free, ..new.z };
        self.event_min = new.event_min;
        self.quiet = new.quiet;
    }

    /// Clocks that the pins stay high in a row.
    pub const fn row_width(&self) -> u32 {
        larger(self.x.width, self.event_min).cast_unsigned()
    }

    /// How far the train runs past the present tick, clocks.
    pub const fn ahead(&self) -> i32 {
        self.began.wrapping_sub(BORDER)
    }

    /// When the last event began, clocks from the start of the present tick.
    pub const fn began(&self) -> i32 {
        self.began
    }

    /// Whether the direction pin of an axis says plus.
    pub const fn faces_plus(&self, axis: Axis) -> bool {
        self.levels.plus(axis)
    }

    /// Whether every direction pin is as these steps need it.
    #[inline]
    pub const fn faces(&self, strides: &Strides) -> bool {
        strides.agree(self.levels)
    }

    /// The direction, plus or not, to which these steps would turn an axis round.
    #[inline]
    pub const fn turns(&self, strides: &Strides, axis: Axis) -> Option<bool> {
        strides.turned(axis, self.levels)
    }

    /// Makes up to `count` steps that come evenly: each is straight, or diagonal where `turns` says so. Steps that touch a
    /// rule end the row: where `singly`, the first of those is made, too, by itself, so that at least one step is made;
    /// else it is for [`step`](Self::step), to which all others come out the same.
    ///
    /// Inside a row no rule is touched: pins are low and directions set; the first step is not before either axis is
    /// ready and an event may begin; all are spaced so that whatever one asks for is over before the next; the last
    /// one's fall is early enough before the border.
    #[inline(always)]
    pub fn run(
        &mut self,
        times: &mut Times,
        count: u32,
        strides: &Strides,
        turns: &mut impl Turns,
        singly: bool,
        out: &mut impl Train,
    ) -> Made {
        let mut made = Made { steps: 0, diagonals: 0 };
        self.catch_up(out);
        if !strides.agree(self.levels) {
            self.face(strides, times.clock(), out);
        }
        if let Some(row) = self.row(times, count, strides, out) {
            made = self.make(&row, times, strides, turns, out);
        }
        if singly && made.steps < count {
            let diagonal = turns.turns();
            self.step_of(times.take(), strides, diagonal, out);
            made.steps = made.steps.wrapping_add(1);
            made.diagonals = made.diagonals.wrapping_add(u32::from(diagonal));
        }
        made
    }

    /// Makes one step of two kinds.
    #[inline(never)]
    fn step_of(&mut self, due: u32, strides: &Strides, diagonal: bool, out: &mut impl Train) {
        let step = strides.step(diagonal);
        self.step(due, step.x, step.z, out);
    }

    /// Makes a row.
    #[inline(always)]
    fn make(
        &mut self,
        row: &Row,
        times: &mut Times,
        strides: &Strides,
        turns: &mut impl Turns,
        out: &mut impl Train,
    ) -> Made {
        let low = self.levels;
        let [straight, diagonal] = strides.raised;
        let (first, spacing) = (times.time, times.spacing);
        out.put(Event::new(low, (first >> FRACTION).wrapping_sub(self.began.cast_unsigned())));
        // clocks to the next step are the spacing's whole ones, and one more where the fractions carry: below 2^15
        let up = |raised: Levels| {
            let pulse = pulse_of(out, Levels::from_bits(low.bits() | raised.bits()));
            // kept from being put together anew in every step out of what both kinds have in common
            core::hint::black_box(pulse.wrapping_add(spacing >> FRACTION))
        };
        let (straight_up, diagonal_up) = (up(straight), up(diagonal));
        let more = spacing << TO_TOP;
        let mut fraction = first << TO_TOP;
        out.put_row(row.count, row.width, low, || {
            let pulse = if turns.turns() { diagonal_up } else { straight_up };
            let carry;
            (fraction, carry) = fraction.overflowing_add(more);
            Event::from_word(pulse.wrapping_add(u32::from(carry)))
        });
        let Turned { count: diagonals, last: turned } = turns.turned(row.count);
        let time = |number: u32| first.wrapping_add(spacing.wrapping_mul(number));
        let (at, diagonal_at) = (time(row.count.wrapping_sub(1)) >> FRACTION, time(turned) >> FRACTION);
        times.time = time(row.count);
        let fell = at.wrapping_add(row.width);
        self.began = fell.cast_signed();
        let width = row.width.cast_signed();
        let (straight_at, diagonal_at) = (at.cast_signed(), diagonal_at.cast_signed());
        let any = diagonals != 0;
        if straight.step(Axis::X) {
            self.x.made(straight_at, width);
        } else if any && diagonal.step(Axis::X) {
            self.x.made(diagonal_at, width);
        }
        if straight.step(Axis::Z) {
            self.z.made(straight_at, width);
        } else if any && diagonal.step(Axis::Z) {
            self.z.made(diagonal_at, width);
        }
        Made { steps: row.count, diagonals }
    }

    /// Turns the directions that the steps to come need, as far as there is time before the next one, at `due`: an axis
    /// whose first step comes later then need not wait for the set-up time.
    #[cold]
    pub fn face(&mut self, strides: &Strides, due: i32, out: &mut impl Train) {
        self.catch_up(out);
        for axis in [Axis::X, Axis::Z] {
            let Some(plus) = strides.turned(axis, self.levels) else { continue };
            self.fall_until(due, out);
            let low = self.x.fall == NEVER && self.z.fall == NEVER;
            let free = self.pins(axis).free;
            let at = self.placed(free.max(self.began.wrapping_add(self.event_min)));
            if low && at.wrapping_add(self.event_min) <= due {
                self.turn(axis, plus, out);
            }
        }
    }

    /// How many of the `count` steps due at `times` touch no rule.
    #[inline(always)]
    fn row(&mut self, times: &Times, count: u32, strides: &Strides, out: &mut impl Train) -> Option<Row> {
        let first = times.clock();
        if times.spacing_clocks() < self.quiet || !strides.agree(self.levels) {
            return None;
        }
        // what `step` would do first, too
        self.fall_until(first, out);
        let ready = self.x.ready.max(self.z.ready).max(self.began.wrapping_add(self.event_min));
        let low = self.x.fall == NEVER && self.z.fall == NEVER;
        let width = self.row_width().cast_signed();
        let last = BORDER.wrapping_sub(self.event_min).wrapping_sub(width);
        if !low || first < ready || first > last {
            return None;
        }
        let room = (last.cast_unsigned().wrapping_add(1) << FRACTION).wrapping_sub(times.time).wrapping_sub(1);
        let count = count.min(room.checked_div(times.spacing)?.wrapping_add(1));
        (count > 0).then_some(Row { count, width: width.cast_unsigned() })
    }

    /// Adds a step at `due` clocks from the start of the tick, or as soon after it as the rules allow. Each of `x`
    /// and `z` is -1, 0 or 1.
    #[inline]
    pub fn step(&mut self, due: u32, x: i8, z: i8, out: &mut impl Train) {
        self.catch_up(out);
        let mut due = clamped(due);
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
            self.x.fall = at.wrapping_add(self.x.width);
            self.x.ready = self.x.fall.wrapping_add(self.x.space);
            self.x.free = at.wrapping_add(self.x.hold);
        }
        if z != 0 {
            levels = levels.with_step(Axis::Z, true);
            self.z.fall = at.wrapping_add(self.z.width);
            self.z.ready = self.z.fall.wrapping_add(self.z.space);
            self.z.free = at.wrapping_add(self.z.hold);
        }
        self.put(at, levels, out);
    }

    /// Ends the tick: what is left of it is handed out, and times count from the next.
    pub fn end_tick(&mut self, out: &mut impl Train) {
        self.catch_up(out);
        let border = BORDER;
        self.fall_until(border.wrapping_add(self.event_min).wrapping_sub(1), out);
        if self.began < border {
            out.put(Event::new(self.levels, clocks(border.wrapping_sub(self.began))));
            self.began = border;
        }
        self.began = self.began.wrapping_sub(border);
        self.x.next_tick();
        self.z.next_tick();
    }

    /// Whether both step pins are low and nothing runs past the tick.
    pub const fn at_rest(&self) -> bool {
        self.x.fall == NEVER && self.z.fall == NEVER && self.began == 0 && self.early_count == 0
    }

    const fn pins(&mut self, axis: Axis) -> &mut Pins {
        match axis {
            Axis::X => &mut self.x,
            Axis::Z => &mut self.z,
        }
    }

    /// Earliest rise of `axis` at or after `due`, its pin low and the direction set.
    #[inline]
    fn prepare(&mut self, axis: Axis, plus: bool, due: i32, out: &mut impl Train) -> i32 {
        // the pin must have fallen, and when it did tells when it may rise: a fall may have had to wait
        while self.pins(axis).fall != NEVER {
            self.fall_next(out);
        }
        if self.levels.plus(axis) != plus {
            self.turn(axis, plus, out);
        }
        due.max(self.pins(axis).ready)
    }

    /// Lowers what is due next.
    fn fall_next(&mut self, out: &mut impl Train) {
        let at = self.placed(self.x.fall.min(self.z.fall));
        let levels = self.lowered(at);
        self.put(at, levels, out);
    }

    /// Changes the direction of an axis as early as its last pulse allows.
    #[cold]
    fn turn(&mut self, axis: Axis, plus: bool, out: &mut impl Train) {
        let due = self.pins(axis).free.max(self.began.wrapping_add(self.event_min));
        self.fall_until(due, out);
        let at = self.placed(due);
        let levels = self.lowered(at).with_plus(axis, plus);
        self.put(at, levels, out);
        let pins = self.pins(axis);
        pins.ready = pins.ready.max(at.wrapping_add(pins.setup));
    }

    /// Lowers pins that are due long enough before `until` for another event then.
    #[inline]
    fn fall_until(&mut self, until: i32, out: &mut impl Train) {
        loop {
            let next = self.x.fall.min(self.z.fall);
            if next == NEVER {
                return;
            }
            let at = self.placed(next);
            if at.wrapping_add(self.event_min) > until {
                return;
            }
            let levels = self.lowered(at);
            self.put(at, levels, out);
        }
    }

    /// The levels with every pin low whose fall is due at `at`.
    #[inline]
    fn lowered(&mut self, at: i32) -> Levels {
        let mut levels = self.levels;
        if self.x.fall <= at {
            levels = levels.with_step(Axis::X, false);
            self.x.fall = NEVER;
            self.x.ready = self.x.ready.max(at.wrapping_add(self.x.space));
        }
        if self.z.fall <= at {
            levels = levels.with_step(Axis::Z, false);
            self.z.fall = NEVER;
            self.z.ready = self.z.ready.max(at.wrapping_add(self.z.space));
        }
        levels
    }

    /// The first instant at or after `due` at which an event may begin.
    #[inline]
    const fn placed(&self, due: i32) -> i32 {
        let border = BORDER;
        let after = self.began.wrapping_add(self.event_min);
        let at = if due > after { due } else { after };
        if at <= border.wrapping_sub(self.event_min) || at >= border.wrapping_add(self.event_min) {
            at
        } else if at <= border && self.began < border {
            border
        } else {
            border.wrapping_add(self.event_min)
        }
    }

    /// Hands out what the tick before has found out.
    #[inline]
    fn catch_up(&mut self, out: &mut impl Train) {
        if self.early_count != 0 && self.began < BORDER {
            for event in self.early.iter().take(self.early_count) {
                out.put(*event);
            }
            self.early_count = 0;
        }
    }

    /// Begins an event, handing out the one before it.
    #[inline]
    fn put(&mut self, at: i32, levels: Levels, out: &mut impl Train) {
        if self.began >= BORDER {
            self.put_early(at, levels);
            return;
        }
        if at > BORDER {
            out.put(Event::new(self.levels, clocks(BORDER.wrapping_sub(self.began))));
            self.began = BORDER;
            self.put_early(at, levels);
            return;
        }
        out.put(Event::new(self.levels, clocks(at.wrapping_sub(self.began))));
        self.levels = levels;
        self.began = at;
    }

    /// The same behind the border: what is to be handed out belongs to the next tick.
    #[cold]
    fn put_early(&mut self, at: i32, levels: Levels) {
        if let Some(place) = self.early.get_mut(self.early_count) {
            *place = Event::new(self.levels, clocks(at.wrapping_sub(self.began)));
            self.early_count = self.early_count.wrapping_add(1);
        }
        self.levels = levels;
        self.began = at;
    }
}

/// The word of a pulse of a row of this train.
#[inline(always)]
fn pulse_of<T: Train>(_: &T, raised: Levels) -> u32 {
    T::pulse(raised).word()
}

/// An interval: between 1 and one tick by construction, so it never wraps.
const fn clocks(interval: i32) -> u32 {
    interval.cast_unsigned()
}
