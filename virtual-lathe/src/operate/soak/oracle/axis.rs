//! The books of an axis: pulses counted are the place shown, soft limits and bounds are kept, wheels counted.

use handcnc::foreground::mode::Mode;
use interp_core::channel::State;
use interp_core::config::Machine;
use interp_core::units::{Axis, Lattice, PulseSize};

use super::{IN_FLIGHT, Oracle, STANDS, Tick};
use crate::operate::soak::clicks::{Clicks, Turned};
use crate::operate::soak::coverage::Coverage;
use crate::operate::soak::soft_limit::{Place, SoftLimit};
use crate::operate::soak::track::part;

/// What is remembered of an axis.
pub(super) struct AxisBooks {
    pub(super) axis: Axis,
    pub(super) pulse: PulseSize,
    /// The place shown less that of the pins; and the same in the machine's coordinates.
    pub(super) shift: i32,
    pub(super) own: i32,
    pub(super) soft_limit: SoftLimit,
    /// How far its offset may be to either side.
    pub(super) bound: Option<(i32, i32)>,
    pub(super) clicks: Clicks,
    /// The place shown, and ticks since it or the pins moved.
    pub(super) at: i32,
    pub(super) still: u32,
    pub(super) verified: bool,
    /// At its soft limit or beyond, as shown.
    pub(super) at_limit: bool,
}

impl AxisBooks {
    /// Limits and bounds are others, or are not known.
    pub(super) const fn forget_limits(&mut self) {
        self.soft_limit.forget();
        self.bound = None;
    }

    pub(super) fn new(axis: Axis, machine: &Machine) -> Self {
        let pulse = match axis {
            Axis::X => machine.x.pulse,
            Axis::Z => machine.z.pulse,
        };
        let clicks = Clicks::new();
        let (soft_limit, bound, still) = (SoftLimit::default(), None, STANDS);
        Self { axis, pulse, shift: 0, own: 0, soft_limit, bound, clicks, at: 0, still, verified: true, at_limit: false }
    }
}

impl Oracle {
    /// The books of an axis.
    pub(super) fn count(
        &mut self,
        index: usize,
        tick: &Tick<'_>,
        (before, at): (Lattice, Lattice),
        coverage: &mut Coverage,
    ) -> Result<(), (&'static str, String)> {
        let Some(books) = self.axes.get_mut(index) else { return Ok(()) };
        let (axis, shown) = (books.axis, tick.shown);
        let pins = part(at, axis);
        // a pulse that is planned now may be made in the next tick, as the shaper has no room for it before
        let rests = pins == part(before, axis) && part(shown.position, axis) == books.at;
        books.still = if rests { books.still.saturating_add(1) } else { 0 };
        books.at = part(shown.position, axis);
        let plain = pins - *tick.compensation.of(axis);
        let verified = *shown.verified.of(axis);
        let home = verified && !books.verified && shown.mode == Mode::Homing;
        if home {
            self.shoulders.placed(axis, part(shown.programmed, axis));
        }
        if home && !self.locked {
            // home was found: the place is another one, and nothing is beside it
            books.shift = part(shown.position, axis) - plain;
            books.own = books.shift;
            books.clicks.forget();
            if part(shown.offset, axis) != 0 || part(shown.kept, axis) != 0 || part(shown.wear, axis) != 0 {
                return Err(("home", format!("{axis:?} is home with an offset")));
            }
        }
        books.verified = verified;
        let (least, most) = self.operation.axes.of(axis).limits;
        let own = part(shown.position, axis) - books.shift + books.own;
        books.at_limit = self.locked || verified && (own <= least || own >= most);
        if self.locked {
            books.clicks.forget();
            return Ok(());
        }
        let off = part(shown.position, axis) - books.shift - plain;
        let stands = books.still >= STANDS && shown.speed == 0;
        if off.abs() > if stands { 0 } else { IN_FLIGHT } {
            let what = if stands { "at rest" } else { "moving" };
            return Err(("count", format!("{what}, {axis:?} shows {off} pulses more than the pins have counted")));
        }
        let own = plain + books.own;
        let figures = self.operation.axes.of(axis);
        let given = *tick.compensation.of(axis);
        if verified {
            let (least, most) = figures.limits;
            let goes_on = shown.speed == 0 || shown.state == State::Running;
            let place = Place { tick: tick.tick, own, given, limits: figures.limits, stands, goes_on };
            if !books.soft_limit.tick(&place) {
                return Err(("soft-limit", format!("{axis:?} is at {own} of {least} to {most} pulses")));
            }
            if (own == least || own == most) && books.still == 0 {
                coverage.happened("soft limit reached");
            }
        } else {
            books.soft_limit.forget();
            books.soft_limit.compensate(given, tick.tick);
        }
        let (offset, (least, most)) = (part(shown.offset, axis), figures.bounds);
        let bound = books.bound.get_or_insert((least.min(offset), most.max(offset)));
        if offset < bound.0 || offset > bound.1 {
            return Err(("bound", format!("the offset of {axis:?} is {offset} of {least} to {most} pulses")));
        }
        *bound = (least.min(offset), most.max(offset));
        let reach =
            i32::try_from(25_000_000 * u64::from(books.pulse.denominator()) / u64::from(books.pulse.numerator()));
        let reach = reach.unwrap_or(i32::MAX);
        let (folded, free) = match shown.mode {
            Mode::Handwheel => (true, true),
            Mode::Automatic | Mode::ManualData | Mode::Linked | Mode::Retrace => (false, true),
            Mode::Power | Mode::Homing => (true, false),
        };
        let ends = *tick.inputs.ends.of(axis);
        let (low, high) = figures.limits;
        let near = ends.plus || ends.minus || !folded || own - low < reach || high - own < reach;
        let (Some(click), true) = (self.click, free && shown.alarm.is_none()) else {
            books.clicks.forget();
            return Ok(());
        };
        let place = if folded { part(shown.programmed, axis) } else { offset };
        let turned = Turned {
            place,
            counts: *tick.inputs.wheels.of(axis),
            dropped: *shown.dropped.of(axis),
            click,
            near,
            rests: tick.rests,
        };
        match books.clicks.tick(&turned, books.pulse) {
            Ok(true) => coverage.happened("wheel counted exactly"),
            Ok(false) => {}
            Err(text) => return Err(("wheel", format!("{axis:?}: {text}"))),
        }
        Ok(())
    }
}
