//! A group of lathes: up to four channels served in one tick, whose trains become one train.
//!
//! # Independence
//! Every edge of each lathe is put on the next line of one **grid**, counted in clocks from the tick's start; its pitch
//! divides the tick and is no shorter than any lathe's shortest event. So two edges of the common train fall together or
//! a whole pitch apart, whatever lathes they belong to, and none ever waits for another lathe's: the edges of a lathe
//! are the same whatever the others do, and less than a pitch later than if it were alone.
//!
//! Widths, spaces, set-up and hold times are whole pitches ([`Grid::fit`]). Edges that are so many pitches apart are as
//! many apart on the grid, so no rule of the pins is broken by moving them there.
//!
//! A lathe in hold, at its end or without blocks leaves the others alone; each has its own commands, blocks and report.
//! Lathe n owns the levels 4n to 4n + 3 (see [`crate::train`]).

use crate::block::Block;
use crate::channel::{Channel, Report};
use crate::config::{AxisConfig, Config, Machine, TICK_CLOCKS, clocks};
use crate::train::{Event, Levels, Train};
use crate::units::Lattice;

/// Lathes that one step port serves.
pub const MOST_LATHES: usize = 4;
/// Lines of the finest grid in a tick.
const LINES: u32 = 500;
/// Words of a bit for each line, and one for the tick's end.
const WORDS: usize = (LINES + 1).div_ceil(32) as usize;

/// The grid of a group.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Grid {
    /// Clocks, 24 to 12 000, a divisor of 12 000.
    pitch: u32,
}

impl Grid {
    /// The finest pitch, clocks: 2 us.
    pub const FINEST: u32 = TICK_CLOCKS / LINES;

    /// The grid of lathes whose events are at least `event_min_ns` apart: the shortest pitch that is not below that, nor
    /// below [`FINEST`](Self::FINEST), and divides the tick; a whole tick where the time is longer.
    ///
    /// ```
    /// # use interp_core::group::Grid;
    /// assert_eq!(Grid::new(2_000).pitch(), 24);
    /// assert_eq!(Grid::new(2_200).pitch(), 30); // 27 clocks, and 12 000 = 400 * 30
    /// ```
    pub const fn new(event_min_ns: u32) -> Self {
        let least = clocks(event_min_ns);
        let mut pitch = if least > Self::FINEST { least } else { Self::FINEST };
        while pitch < TICK_CLOCKS && !TICK_CLOCKS.is_multiple_of(pitch) {
            pitch = pitch.wrapping_add(1);
        }
        Self { pitch: if pitch > TICK_CLOCKS { TICK_CLOCKS } else { pitch } }
    }

    /// Clocks from one line to the next.
    pub const fn pitch(self) -> u32 {
        self.pitch
    }

    /// A lathe's figures with all times of its pins rounded up to whole pitches. [`Config::check`] then tells whether
    /// the axes' speeds leave room for them.
    #[must_use]
    pub const fn fit(self, config: &Config) -> Config {
        let Config { x, z, .. } = config;
        Config { x: self.fit_axis(x), z: self.fit_axis(z), event_min_ns: self.whole(1) }
    }

    const fn fit_axis(self, axis: &AxisConfig) -> AxisConfig {
        AxisConfig {
            pulse_width_ns: self.rounded(axis.pulse_width_ns),
            dir_setup_ns: self.rounded(axis.dir_setup_ns),
            dir_hold_ns: self.rounded(axis.dir_hold_ns),
            min_space_ns: self.rounded(axis.min_space_ns),
            ..*axis
        }
    }

    const fn rounded(self, ns: u32) -> u32 {
        self.whole(clocks(ns).div_ceil(self.pitch))
    }

    /// Pitches in ns, rounded down; as clocks they are rounded up again.
    const fn whole(self, pitches: u32) -> u32 {
        crate::math::to_u32((self.pitch as u64).saturating_mul(pitches as u64).saturating_mul(250) / 3)
    }

    /// Whether all times of a machine's pins are whole pitches.
    fn fits(self, machine: &Machine) -> bool {
        let (x, z) = (&machine.x, &machine.z);
        let times = [x.width, x.space, x.setup, x.hold, z.width, z.space, z.setup, z.hold, machine.event_min];
        times.iter().all(|time| time.is_multiple_of(self.pitch)) && machine.event_min >= self.pitch
    }
}

/// Why lathes are no group.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum GroupError {
    /// A time of this lathe's pins is no whole number of pitches; see [`Grid::fit`].
    OffGrid {
        /// From 0.
        lathe: usize,
    },
}

impl core::fmt::Display for GroupError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self::OffGrid { lathe } = self;
        write!(f, "a pin time of lathe {lathe} is no multiple of the grid's pitch: fit its figures to the grid first")
    }
}

/// Changes of levels on the lines of a tick.
#[derive(Clone, Debug)]
struct Merge {
    pitch: u32,
    /// Levels at the end of the last tick.
    levels: u16,
    /// Levels that change on a line; the last one is the tick's end, which belongs to the next tick.
    changes: [u16; LINES as usize + 1],
    /// A bit for each line on which any does.
    lines: [u32; WORDS],
}

impl Merge {
    const fn new(grid: Grid) -> Self {
        Self { pitch: grid.pitch, levels: 0, changes: [0; LINES as usize + 1], lines: [0; WORDS] }
    }

    /// Levels that change at a clock, put on the next line.
    fn change(&mut self, clock: u32, change: u16) {
        let line = clock.div_ceil(self.pitch);
        if let (Some(changes), Some(bits)) =
            (self.changes.get_mut(line as usize), self.lines.get_mut(line as usize >> 5))
        {
            *changes ^= change;
            *bits |= 1_u32.wrapping_shl(line & 31);
        }
    }

    /// Hands the tick out and makes ready for the next.
    fn play(&mut self, out: &mut impl Train) {
        let end = TICK_CLOCKS.checked_div(self.pitch).unwrap_or(0);
        let (mut levels, mut began) = (self.levels, 0);
        let mut late = 0;
        for (first, bits) in (0_u32..).step_by(32).zip(&mut self.lines) {
            while *bits != 0 {
                let bit = bits.trailing_zeros();
                *bits &= bits.wrapping_sub(1);
                let line = first.wrapping_add(bit);
                let change = self.changes.get_mut(line as usize).map_or(0, core::mem::take);
                if line >= end {
                    late ^= change;
                } else if change != 0 {
                    if line > began {
                        out.put(Event::new(
                            Levels::from_bits(levels),
                            line.wrapping_sub(began).wrapping_mul(self.pitch),
                        ));
                    }
                    levels ^= change;
                    began = line;
                }
            }
        }
        out.put(Event::new(Levels::from_bits(levels), end.wrapping_sub(began).wrapping_mul(self.pitch)));
        self.levels = levels;
        if late != 0 {
            self.change(0, late);
        }
    }
}

/// `N` lathes, each with a look-ahead of `AHEAD` blocks. A lathe's number is from 0; commands to others change nothing.
#[derive(Clone, Debug)]
pub struct Group<const N: usize, const AHEAD: usize> {
    grid: Grid,
    lathes: [Channel<AHEAD>; N],
    /// Levels of each lathe, on its own four bits.
    levels: [u16; N],
    merge: Merge,
}

impl<const N: usize, const AHEAD: usize> Group<N, AHEAD> {
    /// Lathes that stand at `positions`. More than four, or none, don't compile.
    ///
    /// # Errors
    /// [`GroupError`].
    pub fn new(grid: Grid, machines: &[Machine; N], positions: &[Lattice; N]) -> Result<Self, GroupError> {
        const { assert!(N >= 1 && N <= MOST_LATHES, "a step port serves one to four lathes") };
        if let Some(lathe) = machines.iter().position(|machine| !grid.fits(machine)) {
            return Err(GroupError::OffGrid { lathe });
        }
        let mut all = machines.iter().zip(positions);
        let lathes = core::array::from_fn(|_| {
            // there are as many as asked for
            let (machine, position) = all.next().unwrap_or((&machines[0], &positions[0]));
            Channel::new(machine, *position)
        });
        Ok(Self { grid, lathes, levels: [0; N], merge: Merge::new(grid) })
    }

    /// What a lathe is doing and where it is.
    pub fn lathe(&self, lathe: usize) -> Option<&Channel<AHEAD>> {
        self.lathes.get(lathe)
    }

    /// [`Channel::start`] of a lathe.
    pub fn start(&mut self, lathe: usize) -> bool {
        self.lathes.get_mut(lathe).is_some_and(Channel::start)
    }

    /// [`Channel::hold`] of a lathe.
    pub fn hold(&mut self, lathe: usize) -> bool {
        self.lathes.get_mut(lathe).is_some_and(Channel::hold)
    }

    /// [`Channel::reset`] of a lathe.
    pub fn reset(&mut self, lathe: usize) {
        if let Some(channel) = self.lathes.get_mut(lathe) {
            channel.reset();
        }
    }

    /// [`Channel::abandon`] of a lathe: for an emergency.
    pub fn abandon(&mut self, lathe: usize) {
        if let Some(channel) = self.lathes.get_mut(lathe) {
            channel.abandon();
        }
    }

    /// [`Channel::set_feed_override`] of a lathe.
    pub fn set_feed_override(&mut self, lathe: usize, percent: u16) {
        if let Some(channel) = self.lathes.get_mut(lathe) {
            channel.set_feed_override(percent);
        }
    }

    /// [`Channel::set_optional_stop`] of a lathe.
    pub fn set_optional_stop(&mut self, lathe: usize, on: bool) {
        if let Some(channel) = self.lathes.get_mut(lathe) {
            channel.set_optional_stop(on);
        }
    }

    /// [`Channel::configure`] of a lathe. False, too, where the figures are off the grid.
    pub fn configure(&mut self, lathe: usize, machine: &Machine) -> bool {
        let fits = self.grid.fits(machine);
        self.lathes.get_mut(lathe).is_some_and(|channel| fits && channel.configure(machine))
    }

    /// Makes one tick of all lathes: takes blocks from `source`, which is asked with the lathe's number, gives the
    /// events of the common train to `out`, and each lathe's report.
    pub fn tick(&mut self, source: &mut impl FnMut(usize) -> Option<Block>, out: &mut impl Train) -> [Report; N] {
        let merge = &mut self.merge;
        let numbers = (0_usize..).zip((0_u32..).step_by(4));
        let mut numbered = numbers.zip(self.lathes.iter_mut().zip(&mut self.levels));
        let reports = core::array::from_fn(|_| {
            let ((number, shift), (channel, levels)) = numbered.next()?;
            let mut clock = 0_u32;
            let report = channel.tick(&mut || source(number), &mut |event: Event| {
                let now = event.levels().bits() & 0xF;
                if now != *levels {
                    merge.change(clock, (now ^ *levels).wrapping_shl(shift));
                    *levels = now;
                }
                clock = clock.wrapping_add(event.interval());
            });
            Some(report)
        });
        merge.play(out);
        // there are as many as lathes
        reports.map(|report| report.unwrap_or(Report::IDLE))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use std::vec::Vec;

    /// What a channel's shaper never makes, but a rule of the grid all the same.
    #[test]
    fn an_edge_on_the_tick_s_end_belongs_to_the_next_tick() {
        let mut merge = Merge::new(Grid::new(2_000));
        let mut tick = |changes: &[(u32, u16)]| {
            changes.iter().for_each(|(clock, change)| merge.change(*clock, *change));
            let mut events = Vec::new();
            merge.play(&mut |event: Event| events.push((event.levels().bits(), event.interval())));
            events
        };
        assert_eq!(tick(&[(11_977, 0x10), (1, 1), (24, 0x100)]), [(0, 24), (0x101, 11_976)]);
        assert_eq!(tick(&[(48, 1)]), [(0x111, 48), (0x110, 11_952)]);
        assert_eq!(tick(&[(11_976, 0x110)]), [(0x110, 11_976), (0, 24)]);
        // up and down on one line is no event
        assert_eq!(tick(&[(5, 1), (6, 1)]), [(0, 12_000)]);
    }
}
