//! Trains made by hand: from timed steps to events, and lattice walks by brute force.
#![allow(dead_code, reason = "each test crate uses a part")]
#![allow(unreachable_pub, reason = "a module of test crates has no other users")]

use measure::{CLOCKS_PER_SECOND, Checker, Limits, Motion, PerAxis, PulseEquivalent, Report, Setup, Shape};

pub const X: u32 = 1;
pub const X_PLUS: u32 = 2;
pub const Z: u32 = 4;
pub const Z_PLUS: u32 = 8;

/// A step: time of the rising edge in clocks, and by how much each axis moves.
#[derive(Copy, Clone, Debug)]
pub struct Step {
    pub clocks: u64,
    pub x: i32,
    pub z: i32,
}

/// Pulses of 1 um, 1000 mm/s2, 6 m/min, a jump of 2 mm/s; pins 2 us wide, 2 us apart, set-up and hold
/// 5 us, events at least 2 us apart.
pub fn setup() -> Setup {
    let limits = Limits {
        max_accel: 1_000.0,
        max_feed: 6_000.0,
        max_jump: 2.0,
        pulse_width_ns: 2_000,
        dir_setup_ns: 5_000,
        dir_hold_ns: 5_000,
        min_space_ns: 2_000,
    };
    let pulse = PulseEquivalent { num: 1_000, den: 1 };
    Setup {
        pulse_nm: PerAxis { x: pulse, z: pulse },
        start: PerAxis { x: 0, z: 0 },
        start_nm: PerAxis { x: 0, z: 0 },
        limits: PerAxis { x: limits, z: limits },
        event_min_ns: 2_000,
        uneven: false,
        smoothed_ticks: 0,
    }
}

/// A set-up that forgives every jump, for trains that begin at full speed, and short events: a train
/// made here may have an edge right beside the end of a tick.
pub fn jumpy() -> Setup {
    let mut setup = Setup { event_min_ns: 0, ..setup() };
    setup.limits.x.max_jump = 1e3;
    setup.limits.z.max_jump = 1e3;
    setup
}

pub fn line(x: i64, z: i64, feed: f64) -> Motion {
    Motion { line: 1, shape: Shape::Line, end_nm: PerAxis { x, z }, feed_mm_min: Some(feed) }
}

pub fn arc(centre: (i64, i64), end: (i64, i64), clockwise: bool, feed: f64) -> Motion {
    Motion {
        shape: Shape::Arc { centre_nm: PerAxis { x: centre.0, z: centre.1 }, clockwise },
        ..line(end.0, end.1, feed)
    }
}

/// Changes of the port, in order: time in clocks and the new level.
pub type Changes = Vec<(u64, u32)>;

/// Changes of the port that play `steps`: pulses 3 us wide, direction 10 us ahead of the edge.
pub fn changes(steps: &[Step]) -> Changes {
    let mut toggles: Vec<(u64, u32, bool)> = Vec::new();
    for (step, plus, of) in [(X, X_PLUS, 0), (Z, Z_PLUS, 1)] {
        let mut direction = false;
        for edge in steps {
            let moved = if of == 0 { edge.x } else { edge.z };
            if moved != 0 {
                if direction != (moved > 0) {
                    direction = moved > 0;
                    toggles.push((edge.clocks - 120, plus, direction));
                }
                toggles.push((edge.clocks, step, true));
                toggles.push((edge.clocks + 36, step, false));
            }
        }
    }
    toggles.sort_by_key(|toggle| toggle.0);
    let mut level = 0;
    let mut changes: Changes = Vec::new();
    for (clocks, pin, high) in toggles {
        level = if high { level | pin } else { level & !pin };
        match changes.last_mut() {
            Some(last) if last.0 == clocks => last.1 = level,
            _ => changes.push((clocks, level)),
        }
    }
    changes
}

/// Ticks that play `changes`, with two idle ticks behind.
pub fn ticks(changes: &[(u64, u32)]) -> Vec<Vec<u32>> {
    let last = changes.last().map_or(0, |change| change.0 / 12_000) + 3;
    let mut level = 0;
    let mut rest = changes;
    (0..last)
        .map(|tick| {
            let (start, end) = (tick * 12_000, (tick + 1) * 12_000);
            let here = rest.iter().take_while(|change| change.0 < end).count();
            let (now, later) = rest.split_at(here);
            rest = later;
            let mut marks: Vec<(u64, u32)> = Vec::new();
            if now.first().is_none_or(|first| first.0 != start) {
                marks.push((start, level));
            }
            marks.extend(now);
            level = marks[marks.len() - 1].1;
            let ends = marks[1..].iter().map(|mark| mark.0).chain([end]);
            marks
                .iter()
                .zip(ends)
                .map(|(mark, until)| (mark.1 << 16) | u32::try_from(until - mark.0).unwrap())
                .collect()
        })
        .collect()
}

pub fn check(setup: Setup, motions: &[Motion], ticks: &[Vec<u32>]) -> Report {
    let mut checker = Checker::new(setup).unwrap();
    for motion in motions {
        checker.motion(*motion);
    }
    for tick in ticks {
        checker.tick(tick);
    }
    checker.finish()
}

pub fn play(setup: Setup, motions: &[Motion], steps: &[Step]) -> Report {
    check(setup, motions, &ticks(&changes(steps)))
}

/// Clocks at `seconds`, one tick into the train.
pub fn at(seconds: f64) -> u64 {
    clocks(seconds * f64::from(CLOCKS_PER_SECOND)) + 12_000
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small and positive")]
fn clocks(value: f64) -> u64 {
    value.round() as u64
}

/// Steps of the line from the origin to (x, z), z >= |x|, at `speed` pulses of curve a second, in
/// integers: x is the nearest to z x / z, a half going up.
pub fn line_steps(x: i32, z: i32, speed: f64) -> Vec<Step> {
    let per_pulse = f64::from(x).hypot(f64::from(z)) / f64::from(z) / speed;
    let near = |major: i32| (2 * i64::from(major) * i64::from(x) + i64::from(z)).div_euclid(2 * i64::from(z));
    (1..=z)
        .map(|major| Step {
            clocks: at(per_pulse * f64::from(major)),
            x: i32::try_from(near(major) - near(major - 1)).unwrap(),
            z: 1,
        })
        .collect()
}

/// Lattice points (x, z) of the circle with an integer `radius` about the origin, counter-clockwise
/// from (0, radius) all the way round, by search: every point of the square whose distance from the
/// circle is the least in its row or column, major axis first, ordered by angle.
pub fn circle_points(radius: i32) -> Vec<(i32, i32)> {
    let off = |x: i32, z: i32| (f64::from(x).hypot(f64::from(z)) - f64::from(radius)).abs();
    let mut points: Vec<(i32, i32)> = Vec::new();
    for major in -radius..=radius {
        for side in [-1, 1] {
            // The minor axis is the one farther out: at 45 degrees and beyond the other takes over.
            let minor = (0..=radius + 1)
                .map(|minor| minor * side)
                .min_by(|a, b| off(major, *a).total_cmp(&off(major, *b)))
                .unwrap();
            if major.abs() <= minor.abs() {
                points.push((major, minor));
                points.push((minor, major));
            }
        }
    }
    let angle = |point: &(i32, i32)| {
        let angle = f64::from(point.0).atan2(f64::from(point.1));
        if angle < 0.0 { angle + std::f64::consts::TAU } else { angle }
    };
    points.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    points.dedup();
    points.push((0, radius));
    points
}

/// Steps through `points` about `centre`, from the first, at `speed` pulses of curve a second:
/// each is due when the angle it stands at is reached.
pub fn round_steps(points: &[(i32, i32)], radius: f64, speed: f64) -> Vec<Step> {
    let angle = |point: (i32, i32)| f64::from(point.0).atan2(f64::from(point.1));
    let mut turned = 0.0;
    points
        .windows(2)
        .map(|pair| {
            let turn = angle(pair[1]) - angle(pair[0]);
            turned += turn.sin().atan2(turn.cos());
            Step { clocks: at(f64::abs(turned) * radius / speed), x: pair[1].0 - pair[0].0, z: pair[1].1 - pair[0].1 }
        })
        .collect()
}

/// `steps` of a curve played at constant `speed`, played anew: a step that was due after `s` pulses of
/// curve is due at the time that `time` says for `s`.
pub fn retimed(steps: &[Step], speed: f64, time: impl Fn(f64) -> f64) -> Vec<Step> {
    let second = f64::from(CLOCKS_PER_SECOND);
    steps
        .iter()
        .map(|step| {
            let clocks = u32::try_from(step.clocks - 12_000).unwrap();
            Step { clocks: at(time(f64::from(clocks) / second * speed)), ..*step }
        })
        .collect()
}

/// Time at which a trapezoid from rest to rest over `length` stands at `s`: acceleration `accel`, at
/// most `speed`; any units.
pub fn trapezoid(length: f64, speed: f64, accel: f64) -> impl Fn(f64) -> f64 {
    let ramp = (speed * speed / 2.0 / accel).min(length / 2.0);
    let top = (2.0 * accel * ramp).sqrt();
    let whole = 2.0 * top / accel + (length - 2.0 * ramp) / top;
    move |s| {
        if s < ramp {
            (2.0 * s / accel).sqrt()
        } else if s <= length - ramp {
            top / accel + (s - ramp) / top
        } else {
            whole - (2.0 * (length - s).max(0.0) / accel).sqrt()
        }
    }
}
