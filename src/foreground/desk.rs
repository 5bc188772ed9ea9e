//! What the operator has set: mode, switches, coordinates; and what has become of what he asked for.

use super::along::Way;
use super::closed_loop::ClosedLoop;
use super::contour::{Contour, Own};
use super::homing;
use super::inputs::{Inputs, PerAxis};
use super::mode::Mode;
use super::power::Power;
use super::refusal::Refusal;
use super::settings::Settings;
use super::threads::{Lever, PickUp};
use super::wheels::Wheels;
use heapless::Deque;
use interp_core::block::{Feed, Speed};
use interp_core::config::Machine;
use interp_core::drive::Trouble;
use interp_core::drive::gearing::Lead;
use interp_core::units::{Axis, Lattice, Length, PulseSize};

/// The operator's side of a lathe.
#[derive(Clone, Debug)]
pub(super) struct Desk {
    pub(super) mode: Mode,
    pub(super) machine: Machine,
    pub(super) settings: Settings,
    pub(super) inputs: Inputs,
    /// Blocks of the machine's own, and whether such a path is in the channel.
    pub(super) own: Own,
    pub(super) own_path: bool,
    pub(super) contour: Option<Contour>,
    pub(super) way: Option<Way>,
    pub(super) wheels: Wheels,
    pub(super) power: Power,
    pub(super) homing: homing::Phase,
    pub(super) dry_run: bool,
    /// Machine lock: where the axes stand meanwhile.
    pub(super) locked: Option<Locked>,
    /// The motors' drivers are to be on.
    pub(super) motors: bool,
    /// Where the axes are, is known.
    pub(super) verified: PerAxis<bool>,
    /// From the program's coordinates to the machine's, pulses.
    pub(super) datum: Lattice,
    /// Offsets that were kept, and wear that was booked; both are part of where the axes are.
    pub(super) kept: Lattice,
    pub(super) wear: Lattice,
    /// Cycle start was given and waits for the handwheels to come to rest.
    pub(super) starting: bool,
    /// Spindle speed by hand, thousandths of a turn a minute, signed.
    pub(super) spindle: i32,
    pub(super) spindle_override: u16,
    /// Line of the block in which a program was interrupted, 0 for none.
    pub(super) interrupted: u32,
    pub(super) closed_loop: ClosedLoop,
    /// Following errors, nm.
    pub(super) following: PerAxis<i32>,
    /// What the drive could not do in the last tick.
    pub(super) trouble: Option<Trouble>,
    /// Offsets on their way back to zero.
    pub(super) nulling: Nulling,
    /// The thread that is cut by hand.
    pub(super) lever: Lever,
    pub(super) pick_up: PickUp,
    /// Lead of the groove that is cut by hand.
    pub(super) thread_lead: Option<Lead>,
    refused: Deque<Refusal, REFUSALS>,
}

/// What each tick looks at when the channel has made it, in the machine's own coordinates.
#[derive(Copy, Clone, Debug)]
pub(super) struct Seen {
    /// Where the axes were at the end of the last tick.
    pub(super) place: Lattice,
    /// And at the end of the one before.
    pub(super) before: Lattice,
}

impl Seen {
    pub(super) const NOWHERE: Self = {
        let at = Lattice { x: 0, z: 0 };
        Self { place: at, before: at }
    };
}

/// What is under way with offsets.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) enum Nulling {
    /// Nothing.
    No,
    /// They go back to zero when the hands, that move the slides yet, rest.
    Waits,
    /// They go back to zero.
    Goes,
}

/// Refusals that are kept until somebody asks: a tick has few.
const REFUSALS: usize = 8;

/// What machine lock brings back when it ends: all that tells where the axes are.
#[derive(Copy, Clone, Debug)]
pub(super) struct Locked {
    pub(super) position: Lattice,
    pub(super) offset: Lattice,
    pub(super) kept: Lattice,
    pub(super) wear: Lattice,
    pub(super) datum: Lattice,
    pub(super) verified: PerAxis<bool>,
    /// From which side the axes came, and by how much their coordinates were set anew meanwhile.
    pub(super) came: PerAxis<Option<bool>>,
    pub(super) recounted: Lattice,
}

impl Desk {
    pub(super) const fn new(machine: &Machine) -> Self {
        const NOWHERE: Lattice = Lattice { x: 0, z: 0 };
        Self {
            mode: Mode::Automatic,
            machine: *machine,
            settings: Settings::NONE,
            inputs: Inputs::NONE,
            own: Own::new(),
            own_path: false,
            contour: None,
            way: None,
            wheels: Wheels::new(),
            power: Power::new(),
            homing: homing::Phase::Rest,
            dry_run: false,
            locked: None,
            motors: true,
            verified: PerAxis { x: true, z: true },
            datum: NOWHERE,
            kept: NOWHERE,
            wear: NOWHERE,
            starting: false,
            spindle: 0,
            spindle_override: 100,
            interrupted: 0,
            closed_loop: ClosedLoop::new(),
            following: PerAxis { x: 0, z: 0 },
            trouble: None,
            nulling: Nulling::No,
            lever: Lever::Out,
            pick_up: PickUp::None,
            thread_lead: None,
            refused: Deque::new(),
        }
    }

    /// Notes a refusal.
    // many ask for it, and seldom: as a call it is smallest
    #[cold]
    #[inline(never)]
    pub(super) fn refuse(&mut self, refusal: Refusal) {
        if self.refused.is_full() {
            let _ = self.refused.pop_front();
        }
        // there is room now
        let _ = self.refused.push_back(refusal);
    }

    pub(super) fn take_refusal(&mut self) -> Option<Refusal> {
        self.refused.pop_front()
    }

    /// Whether the operator's side has something to do in each tick, but for hands that move.
    pub(super) fn acts(&self) -> bool {
        let moves_by_itself =
            matches!(self.mode, Mode::Power | Mode::Linked | Mode::Retrace) || self.homing.axis().is_some();
        moves_by_itself
            || self.own_path
            || self.starting
            || !matches!(self.nulling, Nulling::No)
            || self.inputs.is_touched()
            || !self.wheels.rest()
    }

    /// How far a pulse moves an axis.
    pub(super) const fn pulse(&self, axis: Axis) -> PulseSize {
        match axis {
            Axis::X => self.machine.x.pulse,
            Axis::Z => self.machine.z.pulse,
        }
    }

    /// A place in the program's pulses, as far as there is a length for it.
    pub(super) const fn representable(&self, axis: Axis, at: i32) -> i32 {
        let (pulse, limit) = (self.pulse(axis), Length::LIMIT_NM as i64);
        let (least, most) = match (Length::from_nm(limit.wrapping_neg()), Length::from_nm(limit)) {
            (Some(least), Some(most)) => (pulse.nearest(least), pulse.nearest(most)),
            _ => (0, 0),
        };
        // half a pulse beyond may be none
        let (least, most) = (least.saturating_add(1), most.saturating_sub(1));
        if at < least {
            least
        } else if at > most {
            most
        } else {
            at
        }
    }

    /// Feed of power feed.
    pub(super) fn feed(&self) -> Feed {
        self.power.feed.unwrap_or(Feed::PerTick(self.settings.power))
    }

    /// Feed of a dry run, in one.
    pub(super) const fn dry(&self) -> Option<Speed> {
        if self.dry_run { Some(self.settings.dry) } else { None }
    }

    /// Whether the channel takes the program's blocks: not while a path of the machine's own is in it.
    pub(super) const fn takes_programs(&self) -> bool {
        self.mode.runs_programs() && !self.own_path
    }

    /// Where the axes are, of the program's place and the offset.
    pub(super) const fn physical(&self, programmed: Lattice, offset: Lattice) -> Lattice {
        let (kept, wear) = (self.kept, self.wear);
        Lattice {
            x: programmed.x.wrapping_add(offset.x).wrapping_add(kept.x).wrapping_add(wear.x),
            z: programmed.z.wrapping_add(offset.z).wrapping_add(kept.z).wrapping_add(wear.z),
        }
    }

    /// How many pulses an axis that is at `at`, in the machine's own coordinates, may go to minus and to plus.
    pub(super) fn room(&self, axis: Axis, at: i32) -> (i32, i32) {
        let (mut least, mut most) = self.switches(axis);
        if *self.verified.of(axis) {
            let limits = self.settings.axes.of(axis).limits;
            // leaving a limit that was passed is free, going on is not
            least = least.max(limits.0.saturating_sub(at).min(0));
            most = most.min(limits.1.saturating_sub(at).max(0));
        }
        (least, most)
    }

    /// How many pulses its limit switches let an axis go to minus and to plus.
    pub(super) const fn switches(&self, axis: Axis) -> (i32, i32) {
        let ends = self.inputs.ends.of(axis);
        (if ends.minus { 0 } else { i32::MIN >> 2 }, if ends.plus { 0 } else { i32::MAX >> 2 })
    }
}

/// The part of an axis.
pub(super) const fn part(at: Lattice, axis: Axis) -> i32 {
    match axis {
        Axis::X => at.x,
        Axis::Z => at.z,
    }
}

/// The part of an axis.
pub(super) const fn part_mut(at: &mut Lattice, axis: Axis) -> &mut i32 {
    match axis {
        Axis::X => &mut at.x,
        Axis::Z => &mut at.z,
    }
}
