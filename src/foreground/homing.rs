//! Homing: an axis runs to its home switch, then slowly off it; where the switch opens is the home coordinate.

use super::desk::{part, part_mut};
use super::{Alarm, Foreground};
use interp_core::units::{Axis, Length};

/// Part of the homing speed at which the switch is left, as a shift.
pub(super) const SLOW: u32 = 3;

/// What homing is doing.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) enum Phase {
    /// Nothing.
    Rest,
    /// To the switch.
    Seek(Axis),
    /// Met it: brakes.
    Met(Axis),
    /// Slowly off it.
    Leave(Axis),
    /// It has opened, at this place of the axis: brakes.
    Opened(Axis, i32),
}

impl Phase {
    /// The axis that is being homed.
    pub(super) const fn axis(self) -> Option<Axis> {
        match self {
            Self::Rest => None,
            Self::Seek(axis) | Self::Met(axis) | Self::Leave(axis) | Self::Opened(axis, _) => Some(axis),
        }
    }
}

impl Foreground<'_> {
    /// Begins to look for the home switch of an axis.
    pub(super) fn seek_home(&mut self, axis: Axis) {
        self.drop_path();
        self.channel.fold_hands(true, true);
        let figures = *self.desk.settings.axes.of(axis);
        *self.desk.verified.of_mut(axis) = false;
        if self.at_switch(axis) {
            return self.leave_switch(axis);
        }
        let way = if figures.home_plus { TRAVEL } else { -TRAVEL };
        self.channel.go_hand(axis, self.pulses(axis, way), figures.home_speed);
        self.desk.homing = Phase::Seek(axis);
    }

    /// A tick of homing.
    pub(super) fn home_on(&mut self) {
        let Some(axis) = self.desk.homing.axis() else { return };
        self.channel.fold_hands(true, true);
        let (met, rests) = (self.at_switch(axis), self.channel.hands_rest());
        match self.desk.homing {
            Phase::Rest => {}
            Phase::Seek(_) if met => {
                self.channel.stop_hand(axis);
                self.desk.homing = Phase::Met(axis);
            }
            Phase::Seek(_) if rests => self.raise(Alarm::Homing),
            Phase::Seek(_) => {}
            Phase::Met(_) if rests => self.leave_switch(axis),
            Phase::Met(_) => {}
            Phase::Leave(_) if !met => {
                self.desk.homing = Phase::Opened(axis, part(self.channel.position(), axis));
                self.channel.stop_hand(axis);
            }
            Phase::Leave(_) if rests => self.raise(Alarm::Homing),
            Phase::Leave(_) => {}
            Phase::Opened(_, at) if rests => self.be_home(axis, at),
            Phase::Opened(..) => {}
        }
    }

    /// The home coordinate is where the switch has opened.
    fn be_home(&mut self, axis: Axis, at: i32) {
        self.desk.homing = Phase::Rest;
        let mut position = self.channel.position();
        let beyond = part(position, axis).wrapping_sub(at);
        let place = self.desk.settings.axes.of(axis).home.wrapping_add(beyond);
        let by = place.wrapping_sub(part(position, axis));
        *part_mut(&mut position, axis) = place;
        // what was kept beside the program ends here: the axis is where the machine says
        let mut offset = self.channel.offset();
        for off in [&mut offset, &mut self.desk.kept, &mut self.desk.wear, &mut self.desk.datum] {
            *part_mut(off, axis) = 0;
        }
        if self.channel.set_position(position) {
            self.channel.set_offset(offset);
            self.channel.stand_at(axis, place);
            self.recount(axis, by);
            *self.desk.verified.of_mut(axis) = true;
            self.desk.closed_loop.forget(axis);
            self.set_limits();
        }
    }

    fn leave_switch(&mut self, axis: Axis) {
        let figures = *self.desk.settings.axes.of(axis);
        let way = if figures.home_plus { -TRAVEL / 10 } else { TRAVEL / 10 };
        self.channel.go_hand(axis, self.pulses(axis, way), figures.home_speed >> SLOW);
        self.desk.homing = Phase::Leave(axis);
    }

    fn at_switch(&self, axis: Axis) -> bool {
        let ends = self.desk.inputs.ends.of(axis);
        if self.desk.settings.axes.of(axis).home_plus { ends.plus } else { ends.minus }
    }

    /// So many nanometres in pulses.
    fn pulses(&self, axis: Axis, nm: i64) -> i32 {
        Length::from_nm(nm).map_or(0, |length| self.desk.pulse(axis).nearest(length))
    }
}

/// As far as an axis looks for its switch, nm; and ten times as far as it goes to leave it.
const TRAVEL: i64 = 1_000_000_000;
