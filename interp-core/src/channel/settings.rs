//! What is set in a channel, and what it tells of itself.

use super::lead::Lead;
use super::lookahead::Overrides;
use super::trail::maker::Maker;
use super::window::Window;
use super::{Channel, Current, Memory, State};
use crate::block::{Feed, Speed};
use crate::compensation::pitch::PitchTable;
use crate::config::Machine;
use crate::drive::{BackEnd, Drive};
use crate::units::{Axis, Lattice};
use core::borrow::BorrowMut;

impl<const N: usize, M: BorrowMut<Memory<N>>> Channel<N, M> {
    /// Sets the feed override, percent; more than 200 counts as 200.
    pub fn set_feed_override(&mut self, percent: u16) {
        self.overrides.feed = percent.min(200);
    }

    /// Sets the override of rapids, percent; more than 100 counts as 100.
    pub fn set_rapid_override(&mut self, percent: u16) {
        self.overrides.rapid = percent.min(100);
    }

    /// Percent of the largest speed that rapids are made at.
    pub const fn rapid_override(&self) -> u16 {
        self.overrides.rapid
    }

    /// Percent of the programmed feed.
    pub const fn feed_override(&self) -> u16 {
        self.overrides.feed
    }

    /// Makes no pulses from now on, or makes them again: the position alone moves. Where pulses are made again the motors stand
    /// at the position told before. False, and nothing changes, while anything moves.
    pub fn mute(&mut self, muted: bool) -> bool {
        let rests = self.speed == 0 && self.hands.at_rest() && self.settled();
        if rests {
            self.superposed.mute(muted);
            self.compensation.mute(muted, self.tool());
        }
        rests
    }

    /// Says, right after [`start`](Self::start), that no more blocks come once the source has none: the path ends in the last
    /// one, and no end block has to follow.
    pub const fn close(&mut self) {
        self.closed = true;
    }

    /// Sets the feed of the motion that is being executed and of those to come; threads keep theirs, and so do motions that
    /// the wheel has led back over.
    pub fn set_feed(&mut self, feed: Feed) {
        if let Current::Motion(active) = &mut self.current {
            active.motion.set_feed(feed);
            active.paced_at = Overrides::AT_LIMIT;
            if let Feed::PerTurn(lead) = active.motion.feed {
                self.crank.prepare(lead);
            }
        }
        self.lead.repace();
        self.memory.borrow_mut().ahead.set_feed(feed);
        self.change_law();
    }

    /// Calls the tool's place another one; nothing moves, and the screws are where they were. False, and nothing changes, while
    /// anything moves.
    pub fn set_position(&mut self, position: Lattice) -> bool {
        let idle = matches!(self.state, State::Idle | State::Ended) && self.hands.at_rest();
        if idle {
            let before = self.tool();
            self.position = position;
            self.fence.forget();
            self.compensation.rename(before, self.tool());
        }
        idle
    }

    /// Says where an axis stands in the machine's own coordinates, pulses: that is where its screw's errors are looked up from
    /// now on. Its compensation counts as given there. A new channel's position is in the machine's own coordinates.
    pub fn stand_at(&mut self, axis: Axis, place: i32) {
        let tool = self.tool();
        let tool = match axis {
            Axis::X => tool.x,
            Axis::Z => tool.z,
        };
        self.compensation.stand_at(axis, place, tool);
    }

    /// Works with other figures from now on. False, and nothing changes, while a cycle runs.
    pub fn configure(&mut self, machine: &Machine) -> bool {
        let idle = matches!(self.state, State::Idle | State::Ended);
        if idle {
            self.shaper.configure(machine);
            self.hands.configure(machine);
            self.compensation.configure(&machine.compensation, self.tool());
            self.rest = machine.x.jump.min(machine.z.jump);
            self.crank.configure(machine);
            self.window = Window::new(machine.smoothing);
            self.lead = Lead::new();
            self.memory.borrow_mut().trail.clear(BackEnd::Start);
            self.maker = Maker::new(machine);
        }
        idle
    }

    /// Puts a pitch error table in the place of an axis's last one. It acts where the machine's parameters have it in
    /// force; where the tool stands counts as right. False, and nothing changes, while a cycle runs.
    pub fn set_pitch_table(&mut self, axis: Axis, table: &PitchTable) -> bool {
        let idle = matches!(self.state, State::Idle | State::Ended);
        if idle {
            self.compensation.set_pitch_table(axis, table, self.tool());
        }
        idle
    }

    /// Sets the temperature of the screws, thousandths of a degree Celsius. While a cycle runs it acts slowly.
    pub fn set_temperature(&mut self, temperature: i32) {
        let slowly = !matches!(self.state, State::Idle | State::Ended);
        self.compensation.set_temperature(temperature, slowly);
    }

    /// Pulses that the motor of an axis is due beyond the program since the position was made known.
    pub const fn compensation(&self, axis: Axis) -> i32 {
        self.compensation.given(axis)
    }

    /// Whether optional stops stop.
    pub fn set_optional_stop(&mut self, on: bool) {
        self.optional_stop = on;
    }

    /// What the channel is doing.
    pub const fn state(&self) -> State {
        self.state
    }

    /// Line of the block being executed, 0 for none.
    pub const fn line(&self) -> u32 {
        self.line
    }

    /// Speed along the path.
    pub const fn speed(&self) -> Speed {
        self.speed
    }

    /// Where the program's last pulse planned leads.
    pub const fn position(&self) -> Lattice {
        self.position
    }

    /// Whether a wheel has asked for way along the path that is still to come.
    pub const fn wheel_asks(&self) -> bool {
        let runs = matches!(self.state, State::Running | State::Filling) && matches!(self.crank.drive, Drive::Wheel(_));
        runs && (self.crank.counts != 0 || !self.crank.wheel.is_at_rest())
    }

    /// Whether pulses are still to come that are added to a path that stands.
    pub const fn owes(&self) -> bool {
        // a path that a wheel drives may stand as long as it likes
        let wheel = matches!(self.crank.drive, Drive::Wheel(_)) && self.speed == 0;
        let runs = matches!(self.state, State::Running | State::Filling | State::Resetting) && !wheel;
        self.superposed.owes() || self.crank.thread.is_busy() || !runs && self.lags()
    }

    /// Whether the compensation is behind what the place asks for.
    #[inline]
    pub(super) const fn lags(&self) -> bool {
        self.compensation.is_on() && !self.compensation.rests(self.tool())
    }

    /// Whether an axis's motor is still on its way to where its compensation wants it.
    pub const fn is_compensating(&self, axis: Axis) -> bool {
        self.compensation.is_on() && !self.compensation.axis_rests(axis)
    }

    /// Length of the present motion that is left, nm with 12 fraction bits.
    pub const fn to_go(&self) -> u64 {
        self.room(false)
    }

    /// Whether the look-ahead has room for blocks that may still come.
    pub fn is_hungry(&self) -> bool {
        !self.complete && self.memory.borrow().ahead.has_room()
    }

    /// Clocks that pulses of a row stay high.
    #[inline]
    pub const fn pulse_width(&self) -> u32 {
        self.shaper.row_width()
    }

    /// How often a block was wanted and none was there.
    pub const fn starved(&self) -> u32 {
        self.starved
    }
}
