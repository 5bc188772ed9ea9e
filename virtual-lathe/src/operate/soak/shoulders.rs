//! Shoulders: what power and linked feed lead stops at a coordinate and never passes it.
//!
//! Nothing is known here of how a shoulder is found on a curve. Of each axis the books have the coordinate that was set, the side
//! of it that the program's place is on, and whether what moves the place now is a feed: in linked feed all that moves it but a
//! loaded program; in power feed a path's speed, along the axis that the joystick was pushed to when the path set off, along
//! both on the contour and on the way back, along Z under the threading lever. What a feed leads is never on the other side. What
//! anything else moves may be: wheels of slides, programs, homing. On the coordinate it is on the side that it came from.
//!
//! A push along an axis that is over by itself has led to the coordinate: that it stops, and not before.

use handcnc::foreground::inputs::{AXES, Joystick, PerAxis};
use handcnc::foreground::mode::Mode;
use interp_core::channel::State;
use interp_core::units::{Axis, Lattice};

use super::track::part;

/// The shoulder of an axis.
#[derive(Copy, Clone, Debug, Default)]
struct Shoulder {
    /// Its coordinate, in the program's pulses.
    stop: Option<i32>,
    /// Where the program is, and in which sense it moved last, 0 where nobody knows.
    place: i32,
    came: i32,
    /// The side that it is on, or came from: 1 to plus, 0 where nobody knows.
    side: i32,
}

impl Shoulder {
    fn set(&mut self, stop: Option<i32>) {
        self.stop = stop;
        let beyond = stop.map_or(0, |stop| (self.place - stop).signum());
        self.side = if beyond == 0 { -self.came } else { beyond };
    }

    /// The coordinates count from elsewhere: nothing has moved.
    fn shift(&mut self, by: i32) {
        self.place += by;
        self.stop = self.stop.map(|stop| stop + by);
    }

    /// The place is `to` now, led there by a feed or not. True where a feed has met the shoulder.
    fn goes(&mut self, to: i32, led: bool) -> Result<bool, i32> {
        let moved = (to - self.place).signum();
        self.place = to;
        if moved != 0 {
            self.came = moved;
        }
        let Some(stop) = self.stop else { return Ok(false) };
        let beyond = (to - stop).signum();
        if led && self.side != 0 && beyond == -self.side {
            return Err(stop);
        }
        if beyond != 0 {
            self.side = beyond;
        }
        Ok(led && moved != 0 && beyond == 0)
    }
}

/// What a tick shows.
#[derive(Copy, Clone, Debug)]
pub(super) struct Fed {
    pub(super) mode: Mode,
    pub(super) state: State,
    pub(super) joystick: Joystick,
    /// The program's place.
    pub(super) place: Lattice,
    /// Along the path.
    pub(super) speed: u32,
    /// Of the block that runs, 0 where it has none.
    pub(super) line: u32,
    /// The threading lever is in, or a thread is under way.
    pub(super) threads: bool,
    /// Each axis is at a soft limit or beyond.
    pub(super) at_limit: PerAxis<bool>,
}

/// The shoulders of both axes.
#[derive(Clone, Debug)]
pub(super) struct Shoulders {
    axes: PerAxis<Shoulder>,
    /// What the path leads that moves in power feed, and the tick before.
    led: PerAxis<bool>,
    before: (u32, u32, State),
    /// A push along an axis is under way: nothing but its end has stopped it.
    pushed: Option<(Axis, bool)>,
    /// A loaded program was started in linked feed.
    program: bool,
    /// By how much coordinates were set anew under machine lock.
    locked: Option<PerAxis<i32>>,
}

const NONE: PerAxis<bool> = PerAxis { x: false, z: false };
const BOTH: PerAxis<bool> = PerAxis { x: true, z: true };

const fn only(axis: Axis) -> PerAxis<bool> {
    match axis {
        Axis::X => PerAxis { x: true, z: false },
        Axis::Z => PerAxis { x: false, z: true },
    }
}

impl Shoulders {
    /// None is set.
    pub(super) fn new(place: Lattice) -> Self {
        let shoulder = |place| Shoulder { place, ..Shoulder::default() };
        Self {
            axes: PerAxis { x: shoulder(place.x), z: shoulder(place.z) },
            led: NONE,
            before: (0, 0, State::Idle),
            pushed: None,
            program: false,
            locked: None,
        }
    }

    /// A shoulder is set, or none any more.
    pub(super) fn set(&mut self, axis: Axis, stop: Option<i32>) {
        self.axes.of_mut(axis).set(stop);
    }

    /// An axis's coordinates count from elsewhere: it stands, and is at `place` now.
    pub(super) fn placed(&mut self, axis: Axis, place: i32) {
        let shoulder = self.axes.of_mut(axis);
        let by = place - shoulder.place;
        shoulder.shift(by);
        if let Some(locked) = &mut self.locked {
            *locked.of_mut(axis) += by;
        }
    }

    /// Machine lock: when it ends, coordinates are those of before, and the axes where they were left.
    pub(super) fn lock(&mut self, locked: bool, place: Lattice) {
        match (locked, self.locked) {
            (true, None) => self.locked = Some(PerAxis { x: 0, z: 0 }),
            (false, Some(by)) => {
                for axis in AXES {
                    let shoulder = self.axes.of_mut(axis);
                    shoulder.shift(-by.of(axis));
                    (shoulder.place, shoulder.came) = (part(place, axis), 0);
                    shoulder.set(shoulder.stop);
                }
                self.locked = None;
            }
            (true, Some(_)) | (false, None) => {}
        }
    }

    /// A loaded program was started, or what was started is forgotten.
    pub(super) const fn program(&mut self, started: bool) {
        (self.program, self.pushed) = (started, None);
    }

    /// Looks at a tick. True where a feed has met a shoulder.
    pub(super) fn tick(&mut self, fed: &Fed) -> Result<bool, String> {
        let led = self.led(fed);
        let mut met = false;
        for axis in AXES {
            let shoulder = self.axes.of_mut(axis);
            let from = shoulder.place;
            match shoulder.goes(part(fed.place, axis), *led.of(axis)) {
                Ok(meets) => met |= meets,
                Err(stop) => {
                    let to = shoulder.place;
                    return Err(format!("{axis:?} was led from {from} to {to} past its shoulder at {stop}"));
                }
            }
        }
        self.push(fed)?;
        if fed.state != self.before.2 && matches!(fed.state, State::Idle | State::Ended) {
            self.program = false;
        }
        self.before = (fed.speed, fed.line, fed.state);
        Ok(met)
    }

    /// What a feed leads in this tick.
    fn led(&mut self, fed: &Fed) -> PerAxis<bool> {
        match fed.mode {
            Mode::Linked if self.program || fed.line != 0 || self.before.1 != 0 => NONE,
            Mode::Linked => BOTH,
            Mode::Power => {
                if self.before.0 == 0 {
                    self.led = match fed.joystick {
                        _ if fed.speed == 0 => NONE,
                        _ if fed.threads => only(Axis::Z),
                        Joystick::Axis(axis, _) => only(axis),
                        Joystick::Path(_) | Joystick::Off => BOTH,
                    };
                }
                self.led
            }
            Mode::Handwheel | Mode::Automatic | Mode::ManualData | Mode::Homing | Mode::Retrace => NONE,
        }
    }

    /// A push along an axis ends at a shoulder that lies that way, or at a limit before it.
    fn push(&mut self, fed: &Fed) -> Result<(), String> {
        let Joystick::Axis(axis, plus) = fed.joystick else {
            self.pushed = None;
            return Ok(());
        };
        let feeds = fed.mode == Mode::Power && !fed.threads;
        match fed.state {
            State::Running if feeds && self.before.2 != State::Running => self.pushed = Some((axis, plus)),
            State::Running if feeds && self.pushed == Some((axis, plus)) => {}
            State::Ended if feeds && self.pushed == Some((axis, plus)) => {
                self.pushed = None;
                let Shoulder { stop: Some(stop), place, side, .. } = *self.axes.of(axis) else { return Ok(()) };
                let ahead = if plus { side < 0 } else { side > 0 };
                if ahead && place != stop && !fed.at_limit.of(axis) {
                    return Err(format!("{axis:?} was to be led to its shoulder at {stop}, and stopped at {place}"));
                }
            }
            _ => self.pushed = None,
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REST: Fed = Fed {
        mode: Mode::Power,
        state: State::Idle,
        joystick: Joystick::Off,
        place: Lattice { x: 0, z: 0 },
        speed: 0,
        line: 0,
        threads: false,
        at_limit: NONE,
    };

    /// Led along X to plus, a pulse a tick.
    const PUSHED: Fed = Fed { state: State::Running, joystick: Joystick::Axis(Axis::X, true), speed: 1 << 12, ..REST };

    fn at(x: i32) -> Lattice {
        Lattice { x, z: 0 }
    }

    /// Books with a shoulder of X at 3, the axis at `from`.
    fn shoulder(from: i32) -> Shoulders {
        let mut shoulders = Shoulders::new(at(from));
        shoulders.set(Axis::X, Some(3));
        shoulders
    }

    /// Runs these places of X; the tick that is found wrong.
    fn run(shoulders: &mut Shoulders, fed: Fed, places: &[i32]) -> Option<usize> {
        places.iter().position(|&x| shoulders.tick(&Fed { place: at(x), ..fed }).is_err())
    }

    #[test]
    fn a_feed_stands_on_the_shoulder_and_goes_away_from_it_but_not_a_pulse_past_it() {
        for by in [1, -1] {
            let mut shoulders = shoulder(3 - 3 * by);
            let there = [3 - 2 * by, 3 - by, 3, 3];
            assert_eq!(run(&mut shoulders, PUSHED, &there), None);
            assert_eq!(run(&mut shoulders.clone(), PUSHED, &[3 - by, 3 - 5 * by, 3]), None);
            assert_eq!(run(&mut shoulders, PUSHED, &[3 + by]), Some(0));
        }
    }

    #[test]
    fn a_shoulder_that_is_jumped_over_in_a_tick_is_passed() {
        assert_eq!(run(&mut shoulder(0), PUSHED, &[1, 4]), Some(1));
    }

    #[test]
    fn the_first_tick_and_the_last_one_of_a_feed_belong_to_it() {
        let mut shoulders = shoulder(2);
        assert_eq!(run(&mut shoulders.clone(), PUSHED, &[4]), Some(0));
        assert_eq!(run(&mut shoulders, PUSHED, &[3]), None);
        assert_eq!(run(&mut shoulders, Fed { speed: 0, ..PUSHED }, &[4]), Some(0));
    }

    #[test]
    fn on_the_contour_both_axes_are_led_and_along_an_axis_the_other_one_is_the_wheel_s() {
        let place = Lattice { x: 5, z: 1 };
        let along = |joystick| {
            let mut shoulders = shoulder(0);
            shoulders.tick(&Fed { joystick, place, ..PUSHED }).is_err()
        };
        assert!(along(Joystick::Path(true)) && along(Joystick::Path(false)) && along(Joystick::Off));
        assert!(along(Joystick::Axis(Axis::X, true)) && !along(Joystick::Axis(Axis::Z, true)));
    }

    #[test]
    fn braking_behind_a_joystick_that_was_let_go_is_still_the_feed_s() {
        let mut shoulders = shoulder(0);
        assert_eq!(run(&mut shoulders, PUSHED, &[1, 2]), None);
        let other = Fed { joystick: Joystick::Axis(Axis::Z, true), ..PUSHED };
        assert_eq!(run(&mut shoulders, other, &[3, 4]), Some(1));
    }

    #[test]
    fn a_wheel_may_pass_it_and_then_it_is_met_from_the_other_side() {
        let mut shoulders = shoulder(0);
        assert_eq!(run(&mut shoulders, REST, &[2, 5, 8]), None);
        assert_eq!(run(&mut shoulders.clone(), PUSHED, &[9, 3]), None);
        assert_eq!(run(&mut shoulders, PUSHED, &[4, 2]), Some(1));
    }

    #[test]
    fn in_linked_feed_the_contour_is_led_and_a_loaded_program_is_not() {
        let linked = Fed { mode: Mode::Linked, speed: 0, ..PUSHED };
        assert_eq!(run(&mut shoulder(0), linked, &[3, 4]), Some(1));
        assert_eq!(run(&mut shoulder(0), Fed { line: 7, ..linked }, &[3, 4]), None);
        let mut shoulders = shoulder(0);
        shoulders.program(true);
        assert_eq!(run(&mut shoulders, linked, &[3, 4]), None);
        // it ends, and the next is a contour
        assert_eq!(run(&mut shoulders, Fed { state: State::Ended, ..linked }, &[1]), None);
        assert_eq!(run(&mut shoulders, linked, &[4]), Some(0));
        for mode in [Mode::Automatic, Mode::ManualData, Mode::Retrace, Mode::Handwheel, Mode::Homing] {
            assert_eq!(run(&mut shoulder(0), Fed { mode, ..linked }, &[3, 4]), None);
        }
    }

    #[test]
    fn set_where_the_axis_stands_it_is_on_the_side_that_it_came_from() {
        let mut shoulders = Shoulders::new(at(0));
        assert_eq!(run(&mut shoulders, REST, &[1, 2, 3]), None);
        shoulders.set(Axis::X, Some(3));
        assert_eq!(run(&mut shoulders.clone(), PUSHED, &[2, 3]), None);
        assert_eq!(run(&mut shoulders, PUSHED, &[4]), Some(0));
        // nobody knows where one comes from that has not moved
        for by in [1, -1] {
            assert_eq!(run(&mut shoulder(3), PUSHED, &[3 + by, 3]), None);
            assert_eq!(run(&mut shoulder(3), PUSHED, &[3 + by, 3 - by]), Some(1));
        }
    }

    #[test]
    fn coordinates_that_count_from_elsewhere_take_it_along_also_through_machine_lock() {
        let mut shoulders = shoulder(0);
        shoulders.placed(Axis::X, 100);
        assert_eq!(run(&mut shoulders.clone(), PUSHED, &[102, 103, 104]), Some(2));
        shoulders.lock(true, at(100));
        shoulders.placed(Axis::X, 50);
        assert_eq!(run(&mut shoulders.clone(), PUSHED, &[53, 54]), Some(1));
        shoulders.lock(false, at(100));
        assert_eq!(run(&mut shoulders, PUSHED, &[103, 104]), Some(1));
    }

    #[test]
    fn the_lever_leads_the_carriage_alone() {
        let mut shoulders = shoulder(0);
        shoulders.set(Axis::Z, Some(-2));
        let place = Lattice { x: 9, z: -1 };
        let threads = Fed { threads: true, joystick: Joystick::Off, place, ..PUSHED };
        assert_eq!(shoulders.tick(&threads), Ok(false));
        assert!(shoulders.tick(&Fed { place: Lattice { x: 9, z: -3 }, ..threads }).is_err());
    }

    #[test]
    fn a_push_that_is_over_by_itself_has_led_to_the_shoulder() {
        let ended = Fed { state: State::Ended, speed: 0, ..PUSHED };
        for (place, wrong) in [(3, false), (2, true), (0, true)] {
            let mut shoulders = shoulder(0);
            assert_eq!(run(&mut shoulders, PUSHED, &[0]), None);
            assert_eq!(run(&mut shoulders.clone(), ended, &[place]).is_some(), wrong, "{place}");
            let at_limit = PerAxis { x: true, z: false };
            assert_eq!(run(&mut shoulders.clone(), Fed { at_limit, ..ended }, &[place]), None);
            // let go, held, reset, or pushed away from it
            for other in [
                Fed { joystick: Joystick::Off, ..ended },
                Fed { state: State::Holding, ..ended },
                Fed { state: State::Resetting, ..ended },
            ] {
                assert_eq!(run(&mut shoulders.clone(), other, &[place]), None);
            }
            let away = Joystick::Axis(Axis::X, false);
            let mut shoulders = shoulder(0);
            let _ = run(&mut shoulders, Fed { joystick: away, ..PUSHED }, &[-1]);
            assert_eq!(run(&mut shoulders, Fed { joystick: away, ..ended }, &[-9]), None);
        }
    }
}
