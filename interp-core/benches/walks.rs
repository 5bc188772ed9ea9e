//! Steps a second of each walk, beside the bare recurrence of the same curve written as a plain loop, in one run.
//!
//! `cargo bench -p interp-core`. Each figure is the best of several rounds; every step's place goes into a sum, so that
//! no step can be left out.
#![allow(clippy::unwrap_used, clippy::arithmetic_side_effects, clippy::cast_precision_loss, reason = "a benchmark")]

use std::hint::black_box;
use std::time::Instant;

use interp_core::curve::conic::{Ellipse, Parabola};
use interp_core::curve::line::Line;
use interp_core::curve::prepare_arc::{Metric, Prepared, Reach};
use interp_core::curve::{Step, Walker};
use interp_core::units::{Axis, Lattice, Length, PulseSize, Sense};

/// Rounds of each walk; the best counts.
const ROUNDS: u32 = 7;

/// Where steps lead, and a sum over all places.
#[derive(Copy, Clone, Default, PartialEq, Eq, Debug)]
struct Places {
    steps: u32,
    x: i32,
    z: i32,
    sum: i32,
}

impl Places {
    #[inline(always)]
    fn take(&mut self, x: i32, z: i32) {
        self.steps += 1;
        self.x += x;
        self.z += z;
        self.sum = self.sum.wrapping_add(self.x ^ self.z);
    }
}

/// Seconds that a walk takes, and where it led.
fn timed(walk: &mut impl FnMut() -> Places) -> (f64, Places) {
    let began = Instant::now();
    let places = black_box(walk());
    (began.elapsed().as_secs_f64(), places)
}

fn walked<W: Walker>(mut walker: W) -> Places {
    let mut places = Places::default();
    walker.each_step(|Step { x, z }| places.take(i32::from(x), i32::from(z)));
    places
}

/// Bresenham's line from (0, 0), |x| <= z.
fn bare_line(x: i32, z: i32) -> Places {
    let mut places = Places::default();
    let mut error = z;
    for _ in 0..z {
        error += 2 * x;
        if error >= 2 * z {
            error -= 2 * z;
            places.take(1, 1);
        } else {
            places.take(0, 1);
        }
    }
    places
}

/// `a x^2 + b z^2 = a r^2` from (r, 0), clockwise through an octant: X falls where the half-way point is not inside.
fn bare_octant(a: i64, b: i64, r: i32, steps: i32) -> Places {
    let mut places = Places::default();
    let r = i64::from(r);
    // 4 F at (x - 1/2, z + 1), and its changes with Z and with X
    let mut decision = a * (2 * r - 1) * (2 * r - 1) + 4 * b - 4 * a * r * r;
    let (mut rise, mut fall) = (12 * b, 8 * a * (1 - r));
    for _ in 0..steps {
        let turns = decision >= 0;
        if turns {
            decision += fall;
            fall += 8 * a;
        }
        decision += rise;
        rise += 8 * b;
        places.take(if turns { -1 } else { 0 }, 1);
    }
    places
}

/// The baseline walks the same octant.
fn assert_alike(mut walker: impl Walker, bare: Places) {
    let mut places = Places::default();
    while places.steps < bare.steps {
        let Step { x, z } = walker.next_step().unwrap();
        places.take(i32::from(x), i32::from(z));
    }
    assert_eq!(places, bare);
}

/// Millions of steps a second of a walk and of its baseline, in turn.
fn row(name: &str, mut walk: impl FnMut() -> Places, mut bare: impl FnMut() -> Places) {
    let (mut best, mut best_bare) = (0.0_f64, 0.0_f64);
    let mut steps = 0;
    for _ in 0..ROUNDS {
        let (seconds, places) = timed(&mut walk);
        best = best.max(f64::from(places.steps) / seconds / 1e6);
        steps = places.steps;
        let (seconds, places) = timed(&mut bare);
        best_bare = best_bare.max(f64::from(places.steps) / seconds / 1e6);
    }
    println!("{name:<34} {best:>8.0} {best_bare:>8.0} {:>8.2}   {steps:>10}", best_bare / best);
}

fn main() {
    println!("{:<34} {:>8} {:>8} {:>8}   {:>10}", "walk", "M/s", "bare M/s", "ratio", "steps");
    let um = PulseSize::ONE_MICROMETRE;
    let steps = 40_000_000;
    let slope = 27_182_818;
    row("line", || walked(black_box(Line::new(slope, steps).unwrap()).walk()), || bare_line(black_box(slope), steps));
    let um_of = |um: i32| Length::from_um(um).unwrap();
    let nm = |um: i32| i64::from(um) * 1000;
    // radii whose recurrence fits 32 bits, and not; a quarter, clockwise from +X to +Z
    for (name, radius) in [("circle, R 20 mm, 32 bits", 20_000), ("circle, R 2 m, 64 bits", 2_000_000)] {
        let metric = Metric::new(um, um);
        let (from, to) = (Lattice { x: 0, z: 0 }, Lattice { x: -radius, z: radius });
        let made = metric.arc(from, to, (-nm(radius), 0), Sense::Clockwise, Reach::Short);
        let Prepared::Arc(arc, _) = made else { unreachable!("an arc") };
        let times = 20_000_000 / radius;
        let octant = f64::from(radius) / f64::sqrt(2.0);
        #[allow(clippy::cast_possible_truncation, reason = "below 2^31")]
        let octant = octant as i32;
        assert_alike(arc.walk(), bare_octant(1, 1, radius, octant));
        row(
            name,
            || repeated(times, || walked(black_box(&arc).walk())),
            || repeated(2 * times, || bare_octant(black_box(1), black_box(1), radius, octant)),
        );
    }
    let ellipse = Ellipse { centre: (-nm(30_000), 0), half_axes: (um_of(30_000), um_of(50_000)) };
    let quarter = Lattice { x: -30_000, z: 50_000 };
    let made = ellipse.arc((um, um), Lattice::default(), quarter, (Sense::Clockwise, Reach::Short)).unwrap();
    assert_alike(made.walk(), bare_octant(25, 9, 30_000, 42_000));
    row(
        "ellipse, 30 x 50 mm",
        || repeated(500, || walked(black_box(&made).walk())),
        || repeated(500, || bare_octant(black_box(25), black_box(9), 30_000, 42_000)),
    );
    let parabola = Parabola { vertex: (0, 0), axis: Axis::Z, parameter: um_of(20_000) };
    let made = parabola.arc((um, um), Lattice::default(), Lattice { x: 40_000, z: 40_000 }).unwrap();
    row(
        "parabola, p 20 mm",
        || repeated(500, || walked(black_box(&made).walk())),
        || repeated(1000, || bare_octant(black_box(1), black_box(1), 30_000, 21_000)),
    );
}

/// The same walk again and again.
fn repeated(times: i32, mut walk: impl FnMut() -> Places) -> Places {
    let mut all = Places::default();
    for _ in 0..times {
        let places = walk();
        all.steps += places.steps;
        all.sum = all.sum.wrapping_add(places.sum);
    }
    all
}
