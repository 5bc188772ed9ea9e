//! Ellipse at any angle, hyperbola, parabola, sine and Archimedean spiral as sampled curves.

use super::{CurveRefusal, Place, Sampled, WHOLE, between, coordinate, sine_cosine};
use crate::math::{HALF_TURN_Q60, Wide, root_wide, scale, to_i64};
use crate::units::Length;

/// A length times a sine (60 fraction bits), as a coordinate.
fn part(length: i128, sine: i64) -> i128 {
    scale(length << super::FRACTION, i128::from(sine), 1 << 60)
}

/// A frame: origin in nm (X, Z), and an angle of its first axis from +Z toward +X.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
struct Frame {
    origin: (i64, i64),
    sine: i64,
    cosine: i64,
}

impl Frame {
    fn new(origin: (i64, i64), tilt: i64) -> Self {
        let (sine, cosine) = sine_cosine(i128::from(tilt));
        Self { origin, sine, cosine }
    }

    /// A point of the frame, coordinates of nm with 12 fraction bits along its first and second axis.
    fn place(&self, first: i128, second: i128) -> Place {
        let (s, c) = (i128::from(self.sine), i128::from(self.cosine));
        let turned =
            |a: i128, p: i128, b: i128, q: i128| a.times(p).wrapping_add(b.times(q)).wrapping_add(1 << 59) >> 60;
        let z = turned(first, c, second, s.wrapping_neg());
        let x = turned(first, s, second, c);
        let (origin_x, origin_z) = self.origin;
        (coordinate(origin_x).wrapping_add(to_i64(x)), coordinate(origin_z).wrapping_add(to_i64(z)))
    }
}

fn positive(length: Length) -> Result<i128, CurveRefusal> {
    if length.nm() > 0 { Ok(i128::from(length.nm())) } else { Err(CurveRefusal::Degenerate) }
}

/// A part of the parameter that spans `part` of `whole`, at most a half.
fn share(part: i128, whole: i128) -> u64 {
    let most = WHOLE >> 1;
    let span = scale(i128::from(WHOLE), part, whole.saturating_abs().max(1));
    u64::try_from(span).unwrap_or(most).clamp(1, most)
}

/// An ellipse with its first axis tilted; a circle where both half axes are the same.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct TiltedEllipse {
    frame: Frame,
    half: (i128, i128),
    from: i64,
    to: i64,
}

impl TiltedEllipse {
    /// About `centre` (X, Z, nm) with half axes along its own first and second axis, the first tilted by `tilt` from +Z
    /// toward +X; from one eccentric angle to another, counter-clockwise where it grows. Radians, 60 fraction bits, so
    /// at most two turns to either side.
    ///
    /// # Errors
    /// [`CurveRefusal::Degenerate`] for half axes that are not positive and no sweep.
    pub fn new(
        centre: (Length, Length),
        half_axes: (Length, Length),
        tilt: i64,
        (from, to): (i64, i64),
    ) -> Result<Self, CurveRefusal> {
        let half = (positive(half_axes.0)?, positive(half_axes.1)?);
        if from == to {
            return Err(CurveRefusal::Degenerate);
        }
        Ok(Self { frame: Frame::new(origin(centre), tilt), half, from, to })
    }
}

fn origin((x, z): (Length, Length)) -> (i64, i64) {
    (i64::from(x.nm()), i64::from(z.nm()))
}

impl Sampled for TiltedEllipse {
    fn at(&self, parameter: u64) -> Place {
        let (sine, cosine) = sine_cosine(between(i128::from(self.from), i128::from(self.to), parameter));
        self.frame.place(part(self.half.0, cosine), part(self.half.1, sine))
    }

    fn longest(&self) -> u64 {
        // an eighth of a turn
        share(i128::from(HALF_TURN_Q60 >> 2), i128::from(self.to).wrapping_sub(i128::from(self.from)))
    }
}

/// One branch of a hyperbola, `u^2 / a^2 - v^2 / b^2 = 1`, u > 0.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Hyperbola {
    frame: Frame,
    half: (i128, i128),
    from: i128,
    to: i128,
}

impl Hyperbola {
    /// About `centre` (X, Z) with half axes a, b; its u axis tilted by `tilt` (radians, 60 fraction bits) from +Z toward
    /// +X; from one v to another.
    ///
    /// # Errors
    /// [`CurveRefusal::Degenerate`] for half axes that are not positive and no way to go.
    pub fn new(
        centre: (Length, Length),
        half_axes: (Length, Length),
        tilt: i64,
        (from, to): (Length, Length),
    ) -> Result<Self, CurveRefusal> {
        let half = (positive(half_axes.0)?, positive(half_axes.1)?);
        if from == to {
            return Err(CurveRefusal::Degenerate);
        }
        let (from, to) = (i128::from(from.nm()) << super::FRACTION, i128::from(to.nm()) << super::FRACTION);
        Ok(Self { frame: Frame::new(origin(centre), tilt), half, from, to })
    }
}

impl Sampled for Hyperbola {
    fn at(&self, parameter: u64) -> Place {
        let v = between(self.from, self.to, parameter);
        // u = a sqrt(b^2 + v^2) / b; with 12 fraction bits in v and in b
        let b = self.half.1 << super::FRACTION;
        let root = i128::from(root_wide(b.times(b).wrapping_add(v.times(v)).unsigned_abs()));
        // past the range the place is refused
        self.frame.place(scale(root, self.half.0, self.half.1).min(1 << 50), v)
    }

    fn longest(&self) -> u64 {
        WHOLE >> 2
    }
}

/// A parabola `v^2 = 2 p u`.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct TiltedParabola {
    frame: Frame,
    twice: i128,
    from: i128,
    to: i128,
}

impl TiltedParabola {
    /// With its vertex at (X, Z), parameter p, its axis tilted by `tilt` (radians, 60 fraction bits) from +Z toward +X;
    /// from one v to another.
    ///
    /// # Errors
    /// [`CurveRefusal::Degenerate`] for a parameter that is not positive and no way to go.
    pub fn new(
        vertex: (Length, Length),
        parameter: Length,
        tilt: i64,
        (from, to): (Length, Length),
    ) -> Result<Self, CurveRefusal> {
        let twice = positive(parameter)?.wrapping_mul(2);
        if from == to {
            return Err(CurveRefusal::Degenerate);
        }
        let (from, to) = (i128::from(from.nm()) << super::FRACTION, i128::from(to.nm()) << super::FRACTION);
        Ok(Self { frame: Frame::new(origin(vertex), tilt), twice, from, to })
    }
}

impl Sampled for TiltedParabola {
    fn at(&self, parameter: u64) -> Place {
        let v = between(self.from, self.to, parameter);
        // v has 12 fraction bits, its square 24; past the range the place saturates and is refused
        let u = scale(v, v, self.twice << super::FRACTION).min(1 << 50);
        self.frame.place(u, v)
    }

    fn longest(&self) -> u64 {
        WHOLE >> 2
    }
}

/// A sine along Z: X swings about a middle.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct SineWave {
    start: (i64, i64),
    amplitude: i128,
    length: i128,
    phase: i64,
    way: i128,
}

impl SineWave {
    /// From `start` (X of the middle, Z) over `way` along Z, with an amplitude and a wave length, beginning at `phase`
    /// (radians, 60 fraction bits).
    ///
    /// # Errors
    /// [`CurveRefusal::Degenerate`] for an amplitude or wave length that is not positive and no way to go.
    pub fn new(
        start: (Length, Length),
        amplitude: Length,
        wave_length: Length,
        phase: i64,
        way: Length,
    ) -> Result<Self, CurveRefusal> {
        let (amplitude, length) = (positive(amplitude)?, positive(wave_length)?);
        if way == Length::ZERO {
            return Err(CurveRefusal::Degenerate);
        }
        Ok(Self { start: origin(start), amplitude, length, phase, way: i128::from(way.nm()) << super::FRACTION })
    }
}

impl Sampled for SineWave {
    fn at(&self, parameter: u64) -> Place {
        let along = between(0, self.way, parameter);
        // whole waves taken away first: what is left times a turn fits 128 bits
        let wave = self.length << super::FRACTION;
        let rest = along.rest(wave).unwrap_or(0);
        let angle = scale(rest, i128::from(HALF_TURN_Q60).wrapping_mul(2), wave).wrapping_add(i128::from(self.phase));
        let (sine, _) = sine_cosine(angle);
        let (x, z) = self.start;
        (coordinate(x).wrapping_add(to_i64(part(self.amplitude, sine))), coordinate(z).wrapping_add(to_i64(along)))
    }

    fn longest(&self) -> u64 {
        // an eighth of a wave
        share(self.length << (super::FRACTION - 3), self.way)
    }
}

/// An Archimedean spiral: the radius grows evenly with the angle.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Spiral {
    centre: (i64, i64),
    radius: (i128, i128),
    from: i128,
    sweep: i128,
}

impl Spiral {
    /// About `centre` (X, Z), from one radius to another, beginning at the angle `from` from +Z toward +X, over `sweep`,
    /// counter-clockwise where positive: radians with 30 fraction bits, so that many turns fit.
    ///
    /// # Errors
    /// [`CurveRefusal::Degenerate`] for a negative radius, both 0, or no sweep.
    pub fn new(
        centre: (Length, Length),
        radius: (Length, Length),
        from: i64,
        sweep: i64,
    ) -> Result<Self, CurveRefusal> {
        if radius.0 < Length::ZERO || radius.1 < Length::ZERO || sweep == 0 || radius == (Length::ZERO, Length::ZERO) {
            return Err(CurveRefusal::Degenerate);
        }
        let nm = |length: Length| i128::from(length.nm()) << super::FRACTION;
        let radius = (nm(radius.0), nm(radius.1));
        Ok(Self { centre: origin(centre), radius, from: i128::from(from) << 30, sweep: i128::from(sweep) << 30 })
    }
}

impl Sampled for Spiral {
    fn at(&self, parameter: u64) -> Place {
        let radius = between(self.radius.0, self.radius.1, parameter);
        // the sweep may be long: its product with the parameter takes 30 bits less first
        let turned = (self.sweep >> 30).times(i128::from(parameter.min(WHOLE))) >> 2;
        let (sine, cosine) = sine_cosine(self.from.wrapping_add(turned));
        let out = |sine: i64| to_i64(radius.times(i128::from(sine)).wrapping_add(1 << 59) >> 60);
        let (x, z) = self.centre;
        (coordinate(x).wrapping_add(out(sine)), coordinate(z).wrapping_add(out(cosine)))
    }

    fn longest(&self) -> u64 {
        share(i128::from(HALF_TURN_Q60 >> 2), self.sweep)
    }
}
