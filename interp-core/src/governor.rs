//! The feed governor: how far the path advances, and at what speed, before anything is interpolated.
//!
//! Acceleration is planned along the path and therefore never bends it. Speeds are nm a tick, squared speeds
//! nm^2 a tick^2 with 24 fraction bits, lengths nm with 12 fraction bits.
//!
//! On a line the acceleration is constant. On an arc the axes also need `v^2 / R` to turn, so what is left along the
//! path is `sqrt(a^2 - (v^2 / R)^2)`; with `w = v^2` braking then follows `w(s) = a R sin(2 s / R + asin(w_end / a R))`,
//! s being the distance to the end. (Insert it: dw/ds = 2 sqrt(a^2 - (w/R)^2).) So the vector sum of both never
//! passes the axis's acceleration.

use crate::block::{Curve, Motion, Speed};
use crate::config::TICK_CLOCKS;
use crate::curve::proportion::Proportion;
use crate::math::{QUARTER_Q30, RADIAN_Q30, cosine_from_sine, divided, root, sine, to_u32};

/// Clocks of a tick.
const TICK: u64 = TICK_CLOCKS as u64;

/// A squared speed that stands for no limit.
pub const UNLIMITED: u64 = 1 << 62;

/// What the governor decides for a stretch of time.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Advance {
    /// Length of path covered, nm with 12 fraction bits.
    pub length: u64,
    /// Clocks that it takes.
    pub clocks: u32,
    /// Speed at its end.
    pub speed: Speed,
    /// The motion is over.
    pub done: bool,
}

/// The square of a speed.
pub const fn square(speed: Speed) -> u64 {
    (speed as u64).wrapping_mul(speed as u64)
}

/// `value * clocks / TICK_CLOCKS`: what a rate a tick makes of a part of a tick.
const fn part(value: u32, clocks: u32) -> u32 {
    if clocks >= TICK_CLOCKS {
        return value;
    }
    to_u32((value as u64).wrapping_mul(clocks as u64) / TICK)
}

/// What an arc's curvature does to the speed.
#[derive(Copy, Clone)]
struct Bend {
    /// `a R`, the squared speed at which turning takes all acceleration, less so many low bits that it fits.
    full: u64,
    cut: u32,
    /// `R`, nm with 12 fraction bits.
    radius: u64,
    /// From a length to the angle that it turns, 30 fraction bits.
    angle: Proportion,
}

/// Sine and cosine, 30 fraction bits, of the angle whose sine is a squared speed over `a R`: the shares of the
/// acceleration that turning takes, and leaves.
#[derive(Copy, Clone)]
struct Heading {
    sine: i64,
    cosine: i64,
}

impl Bend {
    fn heading(&self, squared: u64) -> Heading {
        let squared = squared.wrapping_shr(self.cut);
        if squared == 0 {
            return Heading { sine: 0, cosine: RADIAN_Q30 };
        }
        let sine = ratio_q30(squared.min(self.full), self.full);
        // below 2^-15 the cosine is one to the last bit
        let cosine = if sine < 1 << 15 { RADIAN_Q30 } else { cosine_from_sine(sine) };
        Heading { sine, cosine }
    }

    /// `a R sin(2 s / R + asin(w_end / a R))`, at most `a R`.
    fn reachable(&self, distance: u64, exit: Heading) -> u64 {
        self.cut_off(distance, exit).min(UNLIMITED.wrapping_shr(self.cut)).wrapping_shl(self.cut)
    }

    /// That, less the bits that are cut off.
    fn cut_off(&self, distance: u64, exit: Heading) -> u64 {
        // a quarter turn of the argument is reached at s = 0.785 R
        if distance >= self.radius {
            return self.full;
        }
        let angle = self.angle.of(distance).wrapping_mul(2).cast_signed();
        if angle >= QUARTER_Q30 {
            return self.full;
        }
        let (s, c) = if angle < SMALL {
            small(angle)
        } else {
            let s = sine(angle);
            (s, cosine_from_sine(s))
        };
        let product = |p: i64, q: i64| p.wrapping_mul(q) >> 30;
        if product(c, exit.cosine) <= product(s, exit.sine) {
            return self.full;
        }
        let sum = product(s, exit.cosine).wrapping_add(product(c, exit.sine)).clamp(0, RADIAN_Q30).unsigned_abs();
        (self.full >> 30).wrapping_mul(sum).saturating_add((self.full & 0x3FFF_FFFF).wrapping_mul(sum) >> 30)
    }
}

/// An angle, 30 fraction bits, below which three terms of the series are exact to the last bits.
const SMALL: i64 = 1 << 25;

/// Sine and cosine of an angle from 0 to [`SMALL`]: what short arcs turn by, and any arc's last ticks.
#[expect(clippy::cast_possible_truncation, reason = "small powers of a small angle")]
const fn small(angle: i64) -> (i64, i64) {
    let square = angle.wrapping_mul(angle) >> 30;
    // below 2^15 and 2^10
    let (cube, fourth) = (angle.wrapping_mul(square) >> 30, square.wrapping_mul(square) >> 30);
    let (cube, fourth) = (cube.cast_unsigned() as u32 / 6, fourth.cast_unsigned() as u32 / 24);
    (angle.wrapping_sub(cube as i64), RADIAN_Q30.wrapping_sub(square / 2).wrapping_add(fourth as i64))
}

impl Motion {
    /// What an arc's curvature does, where that matters: `None` on lines and on arcs so wide that turning takes less
    /// than a 64th of the acceleration at the largest speed.
    #[inline]
    fn bend(&self) -> Option<Bend> {
        let (radius, angle) = match &self.curve {
            Curve::Arc(arc) => (arc.radius(), arc.timeline.angle),
            #[cfg(feature = "methods")]
            Curve::Conic(piece) => (piece.radius, piece.angle),
            Curve::Line(..) => return None,
            #[cfg(feature = "methods")]
            Curve::ClassicLine(..) => return None,
        };
        // more than 64 bits where R is large, as with 1 m and 1 m/s2
        let (accel, mask) = (u64::from(self.accel), u64::from(u32::MAX));
        let low = accel.wrapping_mul(radius & mask);
        let high = accel.wrapping_mul(radius >> 32).wrapping_add(low >> 32);
        let cut = 64_u32.wrapping_sub((high >> 32).leading_zeros());
        let full = high.wrapping_shl(32_u32.wrapping_sub(cut)) | (low & mask).wrapping_shr(cut);
        (full >> 6 < square(self.limit).wrapping_shr(cut)).then_some(Bend { full, cut, radius, angle })
    }

    /// The acceleration along the path where turning takes none, or next to none.
    #[inline]
    const fn straight(&self) -> u32 {
        match self.curve {
            Curve::Line(..) => self.accel,
            #[cfg(feature = "methods")]
            Curve::ClassicLine(..) => self.accel,
            // on wide arcs the 8192th part that turning may take at most
            Curve::Arc(_) => self.accel.wrapping_sub(self.accel >> 12),
            #[cfg(feature = "methods")]
            Curve::Conic(_) => self.accel.wrapping_sub(self.accel >> 12),
        }
    }

    /// Whether turning takes a part of the acceleration that matters.
    pub(crate) fn is_bent(&self) -> bool {
        self.bend().is_some()
    }

    /// An acceleration that it brakes with at least, from any speed to standstill: on an arc turning takes all of it at first and
    /// none at the end, which leaves 2 / pi of it over the way.
    pub(crate) fn brakes(&self) -> u64 {
        if self.bend().is_some() { u64::from(self.accel >> 1) } else { self.straight().into() }
    }

    /// The largest squared speed `distance` before the end from which `exit` (squared) can be met.
    pub fn reachable(&self, distance: u64, exit: u64) -> u64 {
        match self.bend() {
            None => {
                let gain = distance.saturating_mul(u64::from(self.straight()).wrapping_mul(2));
                exit.saturating_add(gain).min(UNLIMITED)
            }
            Some(bend) => bend.reachable(distance, bend.heading(exit)),
        }
    }

    /// Whether it is plain that [`reachable`](Self::reachable) is at least `wanted`, a squared speed within the motion's limit;
    /// where not, only the whole sum tells. A path that turns by 2^-14 gains more from the exit on than the sum is rounded by.
    pub(crate) fn plainly_reaches(&self, distance: u64, exit: u64, wanted: u64) -> bool {
        const TURNED: u64 = 1 << 16;
        let angle = match &self.curve {
            Curve::Arc(arc) => arc.timeline.angle.of(distance),
            #[cfg(feature = "methods")]
            Curve::Conic(piece) => piece.angle.of(distance),
            Curve::Line(..) => TURNED,
            #[cfg(feature = "methods")]
            Curve::ClassicLine(..) => TURNED,
        };
        exit >= wanted && angle >= TURNED && wanted <= square(self.limit)
    }

    /// Acceleration left along the path at a speed.
    fn along(&self, speed: Speed) -> u32 {
        match self.bend() {
            None => self.straight(),
            Some(bend) => {
                let left = bend.heading(square(speed)).cosine.unsigned_abs();
                to_u32(u64::from(self.accel).wrapping_mul(left) >> 30).max(self.accel >> 4).max(1)
            }
        }
    }

    /// Advances from `speed` for at most `clocks` (1 to [`TICK_CLOCKS`]), `left` before the end, toward the speed
    /// `target`, so that the end can be met at the squared speed `exit`.
    #[inline(never)]
    pub fn advance(&self, speed: Speed, left: u64, exit: u64, target: Speed, clocks: u32) -> Advance {
        self.advance_within(speed, left, exit, target, clocks, self.accel)
    }

    /// The same where the exit may be too low, after a change of the override: such a one is approached with what turning
    /// leaves of the acceleration.
    #[inline(never)]
    pub fn advance_gently(&self, speed: Speed, left: u64, exit: u64, target: Speed, clocks: u32) -> Advance {
        let squared = square(speed);
        // what the exit itself allows, less than rounding takes, need not be computed
        let met = if squared <= exit.saturating_add(exit >> 5) { exit } else { self.reachable(left, exit) };
        let hardest = if squared > met.saturating_add(met >> 4) { self.along(speed) } else { self.accel };
        self.advance_within(speed, left, exit, target, clocks, hardest)
    }

    /// Brakes with at most `hardest`.
    #[inline(always)]
    fn advance_within(&self, speed: Speed, left: u64, exit: u64, target: Speed, clocks: u32, hardest: u32) -> Advance {
        // toward the target no harder than turning leaves room for; for the exit as hard as it takes, which the plan
        // keeps within that room except for what a tick rounds
        let wish = if speed == target {
            target
        } else {
            let rise = part(self.along(speed), clocks).max(1);
            target.max(speed.saturating_sub(rise)).min(speed.saturating_add(rise))
        };
        let slowest = speed.saturating_sub(part(hardest, clocks).max(1));
        let ending = self.ending(speed, wish, left, exit, clocks);
        let end = wish.min(ending).max(slowest);
        let length = covered(speed, end, clocks);
        if length < left {
            return Advance { length, clocks, speed: end, done: false };
        }
        // the end lies inside the stretch
        let (before, after) = (square(speed), square(end));
        let reached = if ending < wish && end < speed {
            // braking for the exit: at full rate, as the stretch's own end would lie beyond
            let shed = left.saturating_mul(u64::from(self.accel).wrapping_mul(2));
            before.saturating_sub(shed).max(exit.min(before))
        } else {
            // v^2 changes in proportion to the length
            let share = ratio_q30(left, length.max(1)).unsigned_abs();
            let change = |all: u64| {
                let low = (all & 0x3FFF_FFFF).wrapping_mul(share) >> 30;
                (all >> 30).wrapping_mul(share).wrapping_add(low)
            };
            if after >= before {
                before.saturating_add(change(after.wrapping_sub(before)))
            } else {
                before.saturating_sub(change(before.wrapping_sub(after)))
            }
        };
        let at_end = root(reached).max(1);
        let mean = u64::from(speed).wrapping_add(u64::from(at_end));
        let time = left.saturating_mul(2 * TICK).checked_div(mean).unwrap_or(0);
        Advance { length: left, clocks: to_u32(time).min(clocks), speed: at_end, done: true }
    }

    /// The largest speed at the end of a stretch from which the exit can still be met, where that is below `wish`; else
    /// any from `wish` on.
    fn ending(&self, speed: Speed, wish: Speed, left: u64, exit: u64, clocks: u32) -> Speed {
        match self.bend() {
            None => self.brake_straight(speed, left, exit, part(self.straight(), clocks).max(1)),
            Some(_) if self.plainly_reaches(left.saturating_sub(covered(speed, wish, clocks)), exit, square(wish)) => {
                wish
            }
            Some(bend) => {
                // the speed allowed depends on how far the stretch leads, which depends on the speed: two rounds
                let heading = bend.heading(exit);
                let allowed = |end: Speed| {
                    let covered = covered(speed, end, clocks);
                    root(bend.reachable(left.saturating_sub(covered), heading))
                };
                let first = allowed(wish).min(wish);
                if first == wish {
                    return wish;
                }
                let second = allowed(first).min(wish);
                first.wrapping_add(second.wrapping_sub(first) / 2)
            }
        }
    }

    /// Whether a whole tick at an even `speed`, `left` before the end, leaves room to brake to standstill there.
    pub fn can_keep(&self, speed: Speed, left: u64) -> bool {
        left > u64::from(speed) && self.ending(speed, speed, left, 0, TICK_CLOCKS) >= speed
    }

    /// The end speed of a stretch in which the speed changes by at most `rise`, after which constant braking still
    /// meets the exit: `v1^2 + r v1 <= exit + 2 a s - r v`, from `s - (v + v1) t / 2 >= (v1^2 - exit) / 2 a` with
    /// `r = a t`. Zero where braking all the way ends inside the stretch.
    fn brake_straight(&self, speed: Speed, left: u64, exit: u64, rise: u32) -> Speed {
        let whole = self.reachable(left, exit);
        let taken = u64::from(rise).wrapping_mul(u64::from(speed));
        match whole.checked_sub(taken) {
            Some(bound) => {
                let half = u64::from(rise >> 1);
                root(bound.saturating_add(half.wrapping_mul(half))).saturating_sub(rise >> 1)
            }
            None => 0,
        }
    }
}

/// Length covered while the speed goes evenly from one value to the other.
const fn covered(from: Speed, to: Speed, clocks: u32) -> u64 {
    let twice = (from as u64).wrapping_add(to as u64);
    if clocks >= TICK_CLOCKS {
        return twice / 2;
    }
    twice.wrapping_mul(clocks as u64) / (2 * TICK)
}

/// `part / whole` with 30 fraction bits, for `part <= whole`, both cut to 22 bits: within 2^-20, in three divisions of
/// 32 bits.
const fn ratio_q30(part: u64, whole: u64) -> i64 {
    let bits = 64_u32.wrapping_sub(whole.leading_zeros());
    let cut = bits.saturating_sub(22);
    let (rest, whole) = (to_u32(part.wrapping_shr(cut)), to_u32(whole.wrapping_shr(cut)));
    if rest >= whole {
        return RADIAN_Q30;
    }
    // whole is below 2^22, so is every remainder, and ten bits more fit
    let (high, rest) = divided(rest << 10, whole);
    let (middle, rest) = divided(rest << 10, whole);
    let (low, _) = divided(rest << 10, whole);
    let ratio = high << 20 | middle << 10 | low;
    ratio as i64
}

#[cfg(test)]
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "tests")]
mod tests {
    extern crate std;
    use super::*;
    use crate::block::{Builder, Pace, Path};
    use crate::config::{AxisConfig, Config};
    use crate::units::{Feedrate, Length, Point, PulseSize, Sense};
    use proptest::prelude::*;

    /// An arc of so much of a turn (in 1024ths) with this radius, um, at its largest speed.
    fn arc(radius: i32, part: i32, accel: u32) -> Option<Motion> {
        let axis = AxisConfig {
            pulse: PulseSize::new(1000, 1)?,
            max_feed: Feedrate::from_nm_per_min(5_000_000_000)?,
            max_accel: accel * 1_000,
            max_jump: 2_000,
            pulse_width_ns: 5_000,
            dir_setup_ns: 5_000,
            dir_hold_ns: 5_000,
            min_space_ns: 5_000,
        };
        let machine = Config { x: axis, z: axis, event_min_ns: 2_000 }.check().ok()?;
        let angle = f64::from(part) * core::f64::consts::TAU / 1024.0;
        let at = |angle: f64| (f64::from(radius) * angle.cos(), f64::from(radius) * angle.sin());
        let point =
            |(x, z): (f64, f64)| Some(Point { x: Length::from_um(x as i32 - radius)?, z: Length::from_um(z as i32)? });
        let mut builder = Builder::new(&machine, point(at(0.0))?);
        let path = Path::Arc { centre: (i64::from(radius) * -1_000, 0), sense: Sense::CounterClockwise };
        let pace = Pace::Feed(Feedrate::from_nm_per_min(5_000_000_000)?);
        builder.motion(path, point(at(angle))?, pace).motions.first().copied()
    }

    #[test]
    fn small_angles_have_the_sines_and_cosines_of_f64() {
        for angle in (0..=SMALL).step_by(997) {
            let exact = angle as f64 / RADIAN_Q30 as f64;
            let (s, c) = small(angle);
            let off = |found: i64, exact: f64| (found as f64 - exact * RADIAN_Q30 as f64).abs();
            assert!(off(s, exact.sin()) < 2.0 && off(c, exact.cos()) < 2.0, "{angle}: {s} {c}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        /// What is plain is so: never is less reachable, to the last bit.
        #[test]
        fn what_is_plainly_reached_is_reachable(
            radius in 200_i32..200_000, part in 1_i32..500, accel in 100_u32..10_000,
            exit in 0.0..1.05_f64, wanted in prop_oneof![0.9..1.0_f64, Just(1.0)], way in prop_oneof![0.0..1.0_f64, 0.0..1e-3]
        ) {
            let Some(motion) = arc(radius, part, accel) else { return Ok(()) };
            let exit = (square(motion.limit) as f64 * exit) as u64;
            let wanted = ((exit as f64 * wanted) as u64).min(exit).min(square(motion.limit));
            let distance = (motion.length as f64 * way) as u64;
            if motion.plainly_reaches(distance, exit, wanted) {
                prop_assert!(motion.reachable(distance, exit) >= wanted);
            }
        }
    }
}
