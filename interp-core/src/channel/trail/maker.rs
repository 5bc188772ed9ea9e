//! Motions of the history are made again, one at a time.

use super::Trod;
use super::history::History;
use super::record::Kept;
use crate::block::Builder;
use crate::block::again::{Again, Made};
use crate::config::Machine;
use crate::units::Point;

/// A motion that is being made again.
#[derive(Clone, Debug)]
struct Work {
    place: u32,
    line: u32,
    apart: bool,
    again: Again,
}

/// Makes motions again on a machine, in steps.
#[derive(Clone, Debug)]
pub(in super::super) struct Maker {
    builder: Builder,
    work: Option<Work>,
}

impl Maker {
    /// For motions of this machine.
    pub(in super::super) fn new(machine: &Machine) -> Self {
        Self { builder: Builder::new(machine, Point::default()), work: None }
    }

    /// A step toward the motion at `place` of the history, which may be another one than that of the last step; the motion
    /// where it is ready.
    pub(super) fn step(&mut self, place: u32, history: &History) -> Option<Trod> {
        if self.work.as_ref().is_none_or(|work| work.place != place) {
            let Kept { line, apart, outline } = history.get(place)?;
            self.work = Some(Work { place, line, apart, again: Again::new(outline?)? });
        }
        let work = self.work.as_mut()?;
        let (line, apart) = (work.line, work.apart);
        let made = work.again.step(&self.builder);
        if matches!(made, Made::More) {
            return None;
        }
        self.work = None;
        match made {
            Made::Motion(motion) => Some(Trod { place, line, apart, motion }),
            // what was made once can be made again
            Made::Nothing | Made::More => None,
        }
    }
}
