//! Speed and acceleration from positions at tick boundaries, and the limits they must keep.
//!
//! * p(t) is the position in pulses at boundary t, after every edge before it.
//! * **Second difference** over h ticks: |p(t) - 2 p(t+h) + p(t+2h)|. With an acceleration of at most a
//!   it is at most a h² + f pulses, where f is what rounding to the lattice fakes.
//! * **Faked pulses**: an axis that steps at every step of a span is at most a pulse's width behind its
//!   ideal place, from 0 to 1, or from -1/2 to 1/2; weighted 1, -2, 1 that fakes less than f = 2. The minor
//!   axis steps only where the major one does: it is behind by a half for its own rounding and by up to one
//!   pulse for the major axis's, and less than f = 4 can be faked. (A walk with minimum deviation along 3:4
//!   does reach 3 where the ideal acceleration is nearly nothing.) So f = 4 for an axis in windows with a
//!   step of the other one alone, else 2; and 4 for both on arcs, where the axes change places.
//!   Where the method's pulses come unevenly, f = 6 always: a half for rounding, a half for the lattice line of the
//!   other axis that tells the time, a half for a step of its own between two of them, four times.
//!   Where an axis turns round, its lag changes sides: at joints, starts and stops f is 2 more.
//! * **Added pulses**, of a handwheel or a compensation, are rounded by themselves, half a pulse to either side, and one that would
//!   turn the axis round may be owed for some ticks. In windows with any f is 5 more:
//!   - Planned, the axis is at u + e: u bends by at most A = a h² (and its jumps), and e is an interval's: of width W = 1 or 2 for the
//!     program's rounding, as above, and 1 for the added one. That fakes less than 2 W: 2 more.
//!   - Where a pulse is owed, the pins are where was planned some ticks ago. So at the ends r < s < t of a window they are above
//!     u + e's interval by g(r) and g(t), and below it by g(s): each at most 1, and at most as far as u has moved since, against the sense
//!     that the axis faces. To be seen is D = u(r) - 2 u(s) + u(t) + g(r) + 2 g(s) + g(t) <= A + 3: 3 more.
//!   - Where a g is 0, it is so. Else the axis has turned round between r and s, and between s and t: what is owed at s and t is owed
//!     since z' > r and t' > s, and g(t) <= u(t') - u(t).
//!   - Where u rises at s, with the speed v: u(r) - u(s) + v h <= A / 2 and u(t') - u(s) - v (t' - s) <= A / 2, and t' - s < h,
//!     so u(r) - 2 u(s) + u(t) + g(t) <= A.
//!   - Where it falls at s: u(t') - u(s) <= A / 2. Since z' it has risen by g(s), so it turned round at a z between r and s:
//!     u(r) - u(z) <= a (z - r)² / 2 and u(z) - u(s) <= a (s - z)² / 2, together at most A / 2. So again <= A.
//!
//!   A motion that fakes 7 in all is in the tests; 6 would not do. Where wheel and compensation both add, nothing is granted for the
//!   third rounding.
//! * **Wait**: an edge may be up to two shortest intervals of an event late, as edges keep clear of each
//!   other and of the tick's border. At the largest speed v that is w = 2 v event_min pulses; the bounds
//!   are wider by 2 w (second difference) and w (distance).
//! * **Mark**: a span of ticks in which a speed may jump. A joint is marked from the tick of the last
//!   edge of one motion to that of the first edge of the next, a tick more on either side. It allows for
//!   one jump; for two (a stop and a start) if a pause was told, or if the axes rest for 20 ms or more. A
//!   rest of 20 ms within a motion is marked likewise. Before the first edge and after the last there is
//!   rest for ever.
//! * Rules, for h = 1, 2, 4 ... 256: in windows without a mark the second difference keeps its bound; in
//!   windows with n jumps it is at most a h² + n j h + f + 2 w (j: pulses per tick at `max_jump`); in any
//!   window |p(t+h) - p(t)| is at most v h + f / 2 + w.
//! * **Greatest acceleration**: over windows of h = 8 without a mark, second difference less f, at least 0,
//!   over h². So it is low by up to 2 f pulses/h² and never high.
//!
//! A rest is seen only when it has lasted, so windows are looked at 22 ticks late.

use crate::fault::{Fault, FaultKind, Faults, Here};
use crate::setup::{Axis, CLOCKS_PER_TICK, Limits, PerAxis, Setup};

const RING: usize = 1024;
const DELTAS: usize = 64;
/// Ticks without an edge that count as rest.
const REST: u64 = 20;
/// How late windows are looked at: a mark may begin REST + 1 ticks back.
const LATE: u64 = REST + 2;
/// The longest window is 2 * 256 ticks.
const REACH: u64 = 512;
/// First boundary: there is rest for a whole reach before it.
const FIRST: u64 = 1024;
/// Pulses that rounding to the lattice fakes in a second difference of an axis that always steps.
const FAKED: i64 = 2;
/// What it fakes beyond that for an axis that steps only along with the other.
const FAKED_MINOR: i64 = 2;
/// What it fakes beyond the two where the method's pulses come unevenly.
const FAKED_UNEVEN: i64 = 4;
/// What it fakes beyond that where an axis may turn round at a joint.
const FAKED_TURNING: i64 = 2;

/// What pulses fake that are added to the program's: their rounding, and that one may be owed for a while.
const FAKED_ADDED: i64 = 2 + 3;

/// What they fake in a distance.
const FARTHER_ADDED: i64 = 1;

/// What holds at a boundary.
#[derive(Copy, Clone, Debug, Default)]
struct Boundary {
    here: Here,
    /// Jumps of marks that began before this boundary, and that ended before it.
    began: u32,
    ended: u32,
    /// Steps of one axis alone before this boundary: X and Z count those that are not theirs.
    without: PerAxis<u32>,
    /// Steps before this boundary in which motor and program differ.
    added: u32,
}

/// Bounds of an axis for windows of `ticks`.
#[derive(Copy, Clone, Debug)]
struct Bounds {
    ticks: u16,
    /// a h² + 2 and j h in pulses.
    bend: f64,
    jump: f64,
    /// floor(v h + 1 + w), floor(a h² + 2).
    travel: i64,
    bend_floor: i64,
}

/// Forgives rounding of the bounds.
const ROUNDING: f64 = 1e-9;

#[expect(clippy::cast_possible_truncation, reason = "saturates: limits beyond 2^63 pulses are none")]
fn floor(bound: f64) -> i64 {
    (bound * (1.0 + ROUNDING)).floor() as i64
}

#[derive(Clone, Debug)]
struct Watch {
    axis: Axis,
    bounds: [Bounds; 9],
    uneven: bool,
    /// How far it goes at most while an edge waits, in pulses.
    wait: f64,
    /// mm/s² of one pulse of second difference over 8 ticks.
    unit: f64,
    /// Greatest second difference over 8 ticks without a mark, less what may be faked.
    greatest: i64,
    /// By how much a second difference was above its bound at most, in pulses.
    excess: f64,
}

impl Watch {
    fn new(axis: Axis, limits: Limits, nm: f64, setup: &Setup) -> Self {
        let mm = nm / 1e6;
        let wait = limits.max_feed / 60.0 / mm * 2.0 * f64::from(setup.event_min_ns) / 1e9;
        let bounds = [1_u16, 2, 4, 8, 16, 32, 64, 128, 256].map(|ticks| {
            let h = f64::from(ticks) / 1e3;
            let bend = limits.max_accel / mm * h * h + 2.0;
            Bounds {
                ticks,
                bend,
                jump: limits.max_jump / mm * h,
                travel: floor(limits.max_feed / 60.0 / mm * h + 1.0 + wait),
                bend_floor: floor(bend),
            }
        });
        Self { axis, bounds, uneven: setup.uneven, wait, unit: mm / (0.008 * 0.008), greatest: 0, excess: 0.0 }
    }

    fn fault(&self, kind: FaultKind, ticks: u16, found: i64, bound: i64, here: Here) -> Fault {
        let axis = Some(self.axis);
        Fault { ticks, ..here.fault(kind, axis, found, bound) }
    }

    /// Looks at the windows that end at `last`; `ring` gives a boundary so many ticks before it, `axis`
    /// the place of the axis at a boundary, and the steps without it before that.
    fn look<'a>(
        &mut self,
        last: &'a Boundary,
        ring: impl Fn(u16) -> &'a Boundary,
        axis: impl Fn(&Boundary) -> (i32, u32),
        faults: &mut Faults,
    ) {
        let (end, without) = axis(last);
        let end = i64::from(end);
        for bounds in self.bounds {
            let (middle, first) = (ring(bounds.ticks), ring(2 * bounds.ticks));
            let (centre, start) = (i64::from(axis(middle).0), axis(first));
            let minor = match (self.uneven, start.1 == without) {
                (true, _) => FAKED_UNEVEN,
                (false, true) => 0,
                (false, false) => FAKED_MINOR,
            };
            let (farther, minor) = match first.added == last.added {
                true => (minor / 2, minor),
                false => (minor / 2 + FARTHER_ADDED, minor + FAKED_ADDED),
            };
            let travel = (end - centre).abs();
            if travel > bounds.travel + farther {
                let (kind, bound) = (FaultKind::Speed, bounds.travel + farther);
                faults.add(self.fault(kind, bounds.ticks, travel, bound, last.here));
            }
            let bend = (end - 2 * centre + i64::from(start.0)).abs();
            let jumps = last.began.wrapping_sub(first.ended);
            if jumps == 0 && bounds.ticks == 8 {
                self.greatest = self.greatest.max(bend - FAKED - minor);
            }
            if bend > bounds.bend_floor {
                self.bent(bounds, bend, jumps, minor, last.here, faults);
            }
        }
    }

    /// A second difference is above the bound for windows without a mark.
    #[cold]
    #[expect(clippy::cast_precision_loss, reason = "far below 2^53 pulses")]
    fn bent(&mut self, bounds: Bounds, bend: i64, jumps: u32, minor: i64, here: Here, faults: &mut Faults) {
        let bound = bounds.bend + f64::from(jumps) * bounds.jump;
        self.excess = self.excess.max(bend as f64 - bound);
        // an axis that turns round lags on one side before and on the other side after
        let turned = if jumps == 0 { 0 } else { FAKED_TURNING };
        let bound = floor(bound + 2.0 * self.wait) + minor + turned;
        if bend <= bound {
            return;
        }
        let kind = if jumps == 0 { FaultKind::Acceleration } else { FaultKind::Jump };
        faults.add(self.fault(kind, bounds.ticks, bend, bound, here));
    }

    #[expect(clippy::cast_precision_loss, reason = "far below 2^53 pulses")]
    fn max_accel(&self) -> f64 {
        self.greatest as f64 * self.unit
    }
}

/// Jumps whose marks begin and end in a tick.
#[derive(Copy, Clone, Debug, Default)]
struct Delta {
    began: u32,
    ended: u32,
}

#[derive(Clone, Debug)]
pub(crate) struct Accel {
    ring: Box<[Boundary; RING]>,
    deltas: [Delta; DELTAS],
    /// The tick in work; its number is that of the boundary it begins at.
    tick: u64,
    last_edge: u64,
    moved: bool,
    /// Jumps of the mark that is open, 0 if none is.
    open: u32,
    /// Sums of the deltas before boundary `tick - LATE`.
    began: u32,
    ended: u32,
    /// Steps of one axis alone, so far.
    without: PerAxis<u32>,
    added: u32,
    x: Watch,
    z: Watch,
}

/// Place in a ring of a power of two.
#[expect(clippy::cast_possible_truncation, reason = "the mask keeps the low bits")]
const fn slot(number: u64, length: usize) -> usize {
    number as usize & (length - 1)
}

impl Accel {
    pub(crate) fn new(setup: &Setup) -> Self {
        let (limits, pulse) = (setup.limits, setup.pulse_nm);
        let rest = Boundary {
            here: Here { at: setup.start, ..Here::default() },
            began: 1,
            ended: 0,
            without: PerAxis::default(),
            added: 0,
        };
        Self {
            ring: Box::new([rest; RING]),
            deltas: [Delta::default(); DELTAS],
            tick: FIRST,
            last_edge: FIRST,
            moved: false,
            open: 1,
            began: 1,
            ended: 0,
            without: PerAxis::default(),
            added: 0,
            x: Watch::new(Axis::X, limits.x, pulse.x.nm(), setup),
            z: Watch::new(Axis::Z, limits.z, pulse.z.nm(), setup),
        }
    }

    #[expect(clippy::indexing_slicing, reason = "the place is masked by the length")]
    fn delta(&mut self, tick: u64) -> &mut Delta {
        &mut self.deltas[slot(tick, DELTAS)]
    }

    fn mark(&mut self, tick: u64, jumps: u32) {
        let began = &mut self.delta(tick).began;
        *began = began.wrapping_add(jumps);
        self.open += jumps;
    }

    /// A step by `moved` in the tick in work; `paused` if a pause was told before it.
    #[inline]
    pub(crate) fn edge(&mut self, moved: PerAxis<i32>, paused: bool, round: bool) {
        self.without.x = self.without.x.wrapping_add(u32::from(round || moved.x == 0));
        self.without.z = self.without.z.wrapping_add(u32::from(round || moved.z == 0));
        if self.open > 0 {
            if paused && self.moved && self.open == 1 {
                self.mark(self.last_edge, 1);
            }
            let open = std::mem::take(&mut self.open);
            let ended = &mut self.delta(self.tick + 1).ended;
            *ended = ended.wrapping_add(open);
        }
        self.last_edge = self.tick;
        self.moved = true;
    }

    /// Motor and program differ in a step.
    pub(crate) fn added(&mut self) {
        self.added = self.added.wrapping_add(1);
    }

    /// The last edge completed a motion.
    pub(crate) fn joint(&mut self) {
        if self.open == 0 {
            self.mark(self.tick - 1, 1);
        }
    }

    /// The axes stand since the last edge: one jump led there, one will lead away.
    pub(crate) fn rest(&mut self) {
        match self.open {
            0 => self.mark(self.last_edge - 1, 2),
            1 => self.mark(self.tick, 1),
            _ => {}
        }
    }

    /// The tick in work ends with the position in `here`.
    pub(crate) fn boundary(&mut self, here: Here, faults: &mut Faults) {
        if self.moved && self.tick - self.last_edge == REST {
            self.rest();
        }
        self.tick += 1;
        if let Some(boundary) = self.ring.get_mut(slot(self.tick, RING)) {
            boundary.here = here;
            boundary.without = self.without;
            boundary.added = self.added;
        }
        let late = self.tick - LATE;
        if let Some(boundary) = self.ring.get_mut(slot(late, RING)) {
            boundary.began = self.began;
            boundary.ended = self.ended;
        }
        // After a whole reach of rest there is nothing to see.
        if self.tick - self.last_edge <= REACH + LATE + 1 {
            self.look(late, faults);
        }
        let delta = std::mem::take(self.delta(late));
        self.began = self.began.wrapping_add(delta.began);
        self.ended = self.ended.wrapping_add(delta.ended);
    }

    fn look(&mut self, late: u64, faults: &mut Faults) {
        let Some(last) = self.ring.get(slot(late, RING)) else {
            return;
        };
        let ring = |back: u16| {
            let place = slot(late - u64::from(back), RING);
            self.ring.get(place).unwrap_or(last)
        };
        let x = |boundary: &Boundary| (boundary.here.at.x, boundary.without.x);
        let z = |boundary: &Boundary| (boundary.here.at.z, boundary.without.z);
        self.x.look(last, ring, x, faults);
        self.z.look(last, ring, z, faults);
    }

    /// Looks at what is left: the train is followed by rest.
    pub(crate) fn finish(&mut self, here: Here, faults: &mut Faults) {
        for tick in 1..=REACH + LATE {
            let clocks = here.clocks + tick * u64::from(CLOCKS_PER_TICK);
            self.boundary(Here { clocks, ..here }, faults);
        }
    }

    /// In mm/s².
    pub(crate) fn max_accel(&self) -> PerAxis<f64> {
        PerAxis { x: self.x.max_accel(), z: self.z.max_accel() }
    }

    /// In pulses.
    pub(crate) fn excess(&self) -> PerAxis<f64> {
        PerAxis { x: self.x.excess, z: self.z.excess }
    }
}
