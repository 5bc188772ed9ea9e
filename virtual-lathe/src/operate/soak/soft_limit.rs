//! An axis's soft limit, and what may be beyond it.
//!
//! Inside, an axis does not pass its limit. One that is beyond already, as the limit was set there, comes back only. Two things
//! bring it a little farther out for a while:
//!
//! * a pulse of what a compensation has just given, if it would turn the axis round, may still be owed, for as long as
//!   [anything may](interp_core::channel::superposed) and until the axis stands;
//! * a path that is beyond goes on for a tick if it can brake from there without leading farther out than it is now: where it turns
//!   round out there it is held, and brakes within where it was when it went on last.

use super::oracle::STANDS;

/// An axis in a tick, in the machine's coordinates.
#[derive(Copy, Clone, Debug)]
pub(super) struct Place {
    pub(super) tick: u64,
    /// Where the pins have led, less what a compensation has given; and that.
    pub(super) own: i32,
    pub(super) given: i32,
    /// Least and greatest place.
    pub(super) limits: (i32, i32),
    /// Nothing has moved for a while.
    pub(super) stands: bool,
    /// The path runs, or stands: it is not braking for a hold.
    pub(super) goes_on: bool,
}

/// The books of an axis.
#[derive(Clone, Debug, Default)]
pub(super) struct SoftLimit {
    /// How far it may be to either side, now and in the tick to come.
    allowed: Option<[(i32, i32); 2]>,
    /// What the compensation has given, and since when.
    given: (i32, u64),
}

impl SoftLimit {
    /// Limits or coordinates are others: where the axis is then, is allowed.
    pub(super) const fn forget(&mut self) {
        self.allowed = None;
    }

    /// Notes what a compensation gives, in every tick.
    pub(super) const fn compensate(&mut self, given: i32, tick: u64) {
        if self.given.0 != given {
            self.given = (given, tick);
        }
    }

    /// Looks at a tick of an axis that is verified. False where it is too far out.
    pub(super) fn tick(&mut self, place: &Place) -> bool {
        let Place { tick, own, limits: (least, most), stands, goes_on, .. } = *place;
        self.compensate(place.given, tick);
        let owed = i32::from(!stands && tick - self.given.1 <= u64::from(STANDS));
        let [now, next] = self.allowed.get_or_insert([(least.min(own), most.max(own)); 2]);
        if own < now.0 - owed || own > now.1 + owed {
            return false;
        }
        if goes_on {
            *now = *next;
        }
        *next = (least.min(own).max(now.0), most.max(own).min(now.1));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AT: Place = Place { tick: 1_000, own: 0, given: 0, limits: (-50, 100), stands: false, goes_on: true };

    /// Runs these places, a tick after the other; the first that is too far out.
    fn run(limit: &mut SoftLimit, from: Place, places: &[i32]) -> Option<usize> {
        let ticks = (from.tick..).zip(places);
        ticks.enumerate().position(|(_, (tick, &own))| !limit.tick(&Place { tick, own, ..from }))
    }

    #[test]
    fn inside_an_axis_goes_to_its_limit_and_not_a_pulse_farther() {
        assert_eq!(run(&mut SoftLimit::default(), AT, &[0, 99, 100, 100, -50, -51]), Some(5));
        assert_eq!(run(&mut SoftLimit::default(), AT, &[0, 99, 100, 101]), Some(3));
    }

    #[test]
    fn beyond_already_it_comes_back_only() {
        // where it is found first, and from then on what it has come back is lost, a tick later
        assert_eq!(run(&mut SoftLimit::default(), AT, &[120, 120, 119, 119, 119, 118, 100, 100, 100]), None);
        assert_eq!(run(&mut SoftLimit::default(), AT, &[120, 121]), Some(1));
        assert_eq!(run(&mut SoftLimit::default(), AT, &[120, 110, 110, 111]), Some(3));
        assert_eq!(run(&mut SoftLimit::default(), AT, &[120, 100, 100, 101]), Some(3));
        assert_eq!(run(&mut SoftLimit::default(), AT, &[-60, -55, -55, -56]), Some(3));
    }

    #[test]
    fn a_compensation_s_pulse_is_owed_for_twenty_ticks_and_no_longer() {
        let from = |after: u64| {
            let mut limit = SoftLimit::default();
            assert_eq!(run(&mut limit, AT, &[100, 100]), None);
            let given = Place { tick: 2_000, given: -7, own: 100, ..AT };
            assert!(limit.tick(&given));
            (limit, Place { tick: 2_000 + after, own: 101, ..given })
        };
        for (after, allowed) in [(1, true), (20, true), (21, false), (500, false)] {
            let (mut limit, place) = from(after);
            assert_eq!(limit.tick(&place), allowed, "{after}");
        }
        // one, while the axis moves, and not where nothing was given
        let (limit, place) = from(1);
        assert!(!limit.clone().tick(&Place { own: 102, ..place }));
        assert!(!limit.clone().tick(&Place { stands: true, ..place }));
        let mut limit = SoftLimit::default();
        assert_eq!(run(&mut limit, AT, &[100, 101]), Some(1));
    }

    #[test]
    fn what_is_owed_does_not_move_the_limit() {
        let mut limit = SoftLimit::default();
        let given = Place { given: 5, ..AT };
        assert_eq!(run(&mut limit, AT, &[100]), None);
        assert_eq!(run(&mut limit, Place { tick: 1_001, ..given }, &[101, 101, 100, 101]), None);
        assert_eq!(run(&mut limit, Place { tick: 1_022, ..given }, &[101]), Some(0));
    }

    #[test]
    fn a_path_held_beyond_its_limit_brakes_within_where_it_went_on_last() {
        // it comes back to 110 and turns round there; held, it may be where it was two ticks before, and no farther out
        let begun = || {
            let mut limit = SoftLimit::default();
            assert_eq!(run(&mut limit, AT, &[120, 114, 111, 110]), None);
            limit
        };
        let held = Place { tick: 1_004, goes_on: false, ..AT };
        assert_eq!(run(&mut begun(), held, &[110, 111, 111, 111]), None);
        assert_eq!(run(&mut begun(), held, &[111, 112]), Some(1));
        // what it has come back in that tick is not lost while it brakes, nor won by braking longer
        assert_eq!(run(&mut begun(), held, &[108, 111, 105, 111]), None);
        // it went on, and is where it was a tick before at most
        let mut limit = begun();
        assert_eq!(run(&mut limit, Place { tick: 1_004, ..AT }, &[110, 111]), Some(1));
    }
}
