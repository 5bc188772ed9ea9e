//! The three wheels: turned by the script, decoded as a counter with two channels does it, read once a tick.

use std::collections::VecDeque;

use figures::{FigureError, Figures};
use machine::{Handwheel, WheelEdge};

use super::event::Wheel;

/// A wheel and the counts that have not been read yet, with their times.
struct Counter {
    wheel: Handwheel,
    counts: VecDeque<(u64, i16)>,
}

/// The wheels.
pub(super) struct Wheels([Counter; 3]);

impl Wheels {
    /// Wheels at rest.
    pub(super) fn new(figures: &Figures) -> Result<Self, FigureError> {
        let counter = || Ok::<_, FigureError>(Counter { wheel: Handwheel::new(figures)?, counts: VecDeque::new() });
        Ok(Self([counter()?, counter()?, counter()?]))
    }

    fn counter(&mut self, wheel: Wheel) -> &mut Counter {
        let [x, z, contour] = &mut self.0;
        match wheel {
            Wheel::X => x,
            Wheel::Z => z,
            Wheel::Contour => contour,
        }
    }

    /// Turns a wheel by detents, evenly over a time; turns that overlap add up.
    pub(super) fn turn(&mut self, wheel: Wheel, detents: i32, from_ns: u64, over_ns: u64) {
        let counter = self.counter(wheel);
        let begin = counter.wheel.counts();
        let edges = counter.wheel.turn(detents, from_ns, over_ns);
        let mut quarter = begin.rem_euclid(4);
        for edge in edges {
            let now = place(edge);
            let by = match (now - quarter).rem_euclid(4) {
                1 => 1,
                3 => -1,
                // both channels at once: a counter can't tell which way
                _ => 0,
            };
            quarter = now;
            if by != 0 {
                counter.counts.push_back((edge.time_ns, by));
            }
        }
        counter.counts.make_contiguous().sort_by_key(|(time, _)| *time);
    }

    /// A count too many or too few.
    pub(super) fn disturb(&mut self, wheel: Wheel, by: i16, at_ns: u64) {
        self.counter(wheel).counts.push_front((at_ns, by));
    }

    /// Counts of a wheel that came up to a time, and were not read before; what a reading can't hold comes with the next.
    pub(super) fn read(&mut self, wheel: Wheel, until_ns: u64) -> i16 {
        let counter = self.counter(wheel);
        let mut sum = 0_i16;
        while let Some(&(time, by)) = counter.counts.front() {
            let Some(more) = sum.checked_add(by).filter(|_| time <= until_ns) else { break };
            sum = more;
            counter.counts.pop_front();
        }
        sum
    }

    /// Whether all was read.
    pub(super) fn rest(&self) -> bool {
        self.0.iter().all(|counter| counter.counts.is_empty())
    }
}

/// Quarter of the period: 00, 10, 11, 01.
const fn place(edge: WheelEdge) -> i64 {
    match (edge.a, edge.b) {
        (false, false) => 0,
        (true, false) => 1,
        (true, true) => 2,
        (false, true) => 3,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_counts_a_detent_are_read_once_and_turns_that_overlap_add_up() {
        let figures = Figures::new(machine::TABLES);
        let mut wheels = Wheels::new(&figures).unwrap();
        wheels.turn(Wheel::X, 10, 0, 10_000_000);
        wheels.turn(Wheel::X, -3, 5_000_000, 1_000_000);
        let mut sum = 0;
        for tick in 0..=10 {
            sum += wheels.read(Wheel::X, tick * 1_000_000);
        }
        assert_eq!((sum, wheels.rest()), (28, true));
        wheels.turn(Wheel::Contour, -100, 0, 1_000_000);
        assert_eq!((wheels.read(Wheel::Contour, 0), wheels.read(Wheel::Contour, 1_000_000)), (0, -400));
    }
}
