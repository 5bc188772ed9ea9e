//! What a channel played: every step with its time.

use crate::kinds::Sample;
use interp_core::block::{Block, Motion, Work};
use interp_core::channel::{Channel, State};
use interp_core::config::Machine;
use interp_core::train::{Event, Levels};
use interp_core::units::{Axis, Feedrate, Lattice, PulseSize};

/// Train clocks of a tick.
const TICK: u64 = 12_000;

/// Steps: clock and where they lead, and the place at each tick's border.
pub(crate) struct Played {
    start: (i32, i32),
    steps: Vec<(u64, i32, i32)>,
    ticks: Vec<(i32, i32)>,
    /// Lengths of the motions, nm.
    lengths: Vec<f64>,
}

fn nm(pulse: PulseSize) -> f64 {
    f64::from(pulse.numerator()) / f64::from(pulse.denominator())
}

impl Played {
    pub(crate) fn new(machine: &Machine, from: Lattice, motions: &[Motion]) -> Self {
        let work = motions.iter().map(|motion| Work::Motion(*motion)).chain([Work::End]);
        let mut blocks = work.map(|work| Block { line: 1, work });
        let mut channel = Channel::<64>::new(machine, from);
        channel.start();
        let start = (from.x, from.z);
        let (mut at, mut levels, mut clock) = (start, Levels::LOW, 0_u64);
        let (mut steps, mut ticks) = (Vec::new(), vec![start]);
        // the last pulse may be played in the tick behind the end
        let mut behind = 0;
        while behind < 2 {
            behind += u32::from(channel.state() == State::Ended);
            let mut play = |event: Event| {
                let now = event.levels();
                let pulse = |axis| match (now.step(axis) && !levels.step(axis), now.plus(axis)) {
                    (false, _) => 0,
                    (true, true) => 1,
                    (true, false) => -1,
                };
                let (x, z) = (pulse(Axis::X), pulse(Axis::Z));
                if (x, z) != (0, 0) {
                    at = (at.0 + x, at.1 + z);
                    steps.push((clock, at.0, at.1));
                }
                levels = now;
                clock += u64::from(event.interval());
            };
            channel.tick(&mut || blocks.next(), &mut play);
            ticks.push(at);
            assert!(ticks.len() < 3_000_000, "it ends");
        }
        let lengths = motions.iter().map(|motion| motion.length as f64 / 4096.0).collect();
        Self { start, steps, ticks, lengths }
    }

    pub(crate) fn end(&self) -> Lattice {
        let (x, z) = self.steps.last().map_or(self.start, |step| (step.1, step.2));
        Lattice { x, z }
    }

    /// Largest distances of a step from the curve, coarser pulses: of all, and of those between the first and the last one
    /// that are no further off than `inner`.
    pub(crate) fn farthest(&self, machine: &Machine, sample: &Sample, inner: f64) -> (f64, f64) {
        let coarser = nm(machine.x.pulse).max(nm(machine.z.pulse));
        let offs: Vec<_> = self.along(machine, sample).iter().map(|(_, off)| off / coarser).collect();
        let most = |offs: &[f64]| offs.iter().copied().fold(0.0, f64::max);
        let near = |off: &f64| *off <= inner;
        let first = offs.iter().position(near).unwrap_or(0);
        let last = offs.iter().rposition(near).unwrap_or(0);
        (most(&offs), offs.get(first..=last).map_or(0.0, most))
    }

    /// For each step: the length of the curve up to the nearest point, and the distance from it, nm. Where the curve
    /// comes near again, as beyond the tip of a hairpin, the later of all near places counts: who followed the nearest
    /// one might go back on the branch that leads there.
    fn along(&self, machine: &Machine, sample: &Sample) -> Vec<(f64, f64)> {
        let curve = sample.dense();
        let mut lengths = vec![0.0];
        for pair in curve.windows(2) {
            let side = (pair[1].0 - pair[0].0).hypot(pair[1].1 - pair[0].1);
            lengths.push(lengths[lengths.len() - 1] + side);
        }
        let (px, pz) = (nm(machine.x.pulse), nm(machine.z.pulse));
        let (reach, bound) = (30.0 * px.max(pz), sample.bounds().0 * px.max(pz));
        let mut begin = 0;
        let nearest = |(_, x, z): &(u64, i32, i32)| {
            let (x, z) = (f64::from(*x) * px, f64::from(*z) * pz);
            let (mut best, mut was_near, mut window) = ((0.0, f64::MAX), false, f64::MAX);
            for (k, pair) in curve.windows(2).enumerate().skip(begin) {
                if lengths[k] > window {
                    break;
                }
                let (dx, dz) = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
                let square = dx * dx + dz * dz;
                let t = if square > 0.0 {
                    (((x - pair[0].0) * dx + (z - pair[0].1) * dz) / square).clamp(0.0, 1.0)
                } else {
                    0.0
                };
                let off = (x - pair[0].0 - t * dx).hypot(z - pair[0].1 - t * dz);
                let (is_near, comes_again) = (off <= bound, off <= bound && !was_near);
                if off < best.1 || comes_again {
                    best = (lengths[k] + t * square.sqrt(), off);
                    if off < reach && (comes_again || off > bound) {
                        window = best.0 + reach;
                    }
                }
                was_near = is_near;
            }
            begin = lengths.partition_point(|length| *length < best.0 - reach).min(curve.len() - 2);
            best
        };
        self.steps.iter().map(nearest).collect()
    }

    /// The first limit that is broken: over h ticks an axis moves at most v h + 2 pulses, and its second difference is at
    /// most a h^2 + 4 pulses, and what starting and stopping jump. The 4 are what rounding to the lattice fakes for an axis
    /// that steps only along with the other; where it turns round its lag changes sides, which fakes 2 more.
    pub(crate) fn limits(&self, machine: &Machine) -> Option<String> {
        for (axis, limits) in [(0, machine.x), (1, machine.z)] {
            let place = |k: usize| {
                let at = self.ticks[k.min(self.ticks.len() - 1)];
                f64::from(if axis == 0 { at.0 } else { at.1 })
            };
            let size = nm(limits.pulse) * 4096.0;
            let (speed, accel) = (f64::from(limits.speed) / size, f64::from(limits.accel) / size);
            let jump = f64::from(limits.jump) / size;
            for h in [1_usize, 2, 4, 8, 16, 32, 64, 128, 256] {
                let ticks = h as f64;
                for k in 0..self.ticks.len() {
                    let (a, b, c) = (place(k), place(k + h), place(k + 2 * h));
                    let travel = (b - a).abs();
                    if travel > speed * ticks + 2.0 + 1e-6 {
                        return Some(format!("axis {axis} moves {travel} pulses in {h} ticks at {k}"));
                    }
                    let bend = (a - 2.0 * b + c).abs();
                    let turns = (b - a) * (c - b) < 0.0;
                    let faked = if turns { 6.0 } else { 4.0 };
                    let bound = accel * ticks * ticks + faked + 2.0 * jump * ticks;
                    if bend > bound + 1e-6 {
                        return Some(format!(
                            "axis {axis} bends by {bend} pulses over {h} ticks at {k} of {}: {bound}",
                            self.ticks.len()
                        ));
                    }
                }
            }
        }
        None
    }

    /// How far behind and ahead of the programmed feed the path is at worst over a window of 5 to 80 ms, coarser pulses;
    /// away from both ends, where it speeds up.
    pub(crate) fn feed_error(&self, machine: &Machine, sample: &Sample, feed: Feedrate) -> (f64, f64) {
        let coarser = nm(machine.x.pulse).max(nm(machine.z.pulse));
        let along = self.along(machine, sample);
        let speed = feed.nm_per_min() as f64 / 60.0 / 12e6;
        let (mut behind, mut ahead) = (0.0_f64, 0.0_f64);
        let Some(last) = self.steps.last() else { return (0.0, 0.0) };
        let margin = 20 * TICK;
        let inside = |clock: u64| clock > self.steps[0].0 + margin && clock + margin < last.0;
        for window in [5, 20, 80] {
            let mut to = 0;
            for from in 0..self.steps.len() {
                while to < self.steps.len() && self.steps[to].0 < self.steps[from].0 + window * TICK {
                    to += 1;
                }
                if to >= self.steps.len() || !inside(self.steps[from].0) || !inside(self.steps[to].0) {
                    continue;
                }
                let wanted = speed * (self.steps[to].0 - self.steps[from].0) as f64;
                let off = (along[to].0 - along[from].0 - wanted) / coarser;
                (behind, ahead) = (behind.min(off), ahead.max(off));
            }
        }
        (behind, ahead)
    }

    /// What motions shorter than a tick's way, which take a tick all the same, hold back of that feed: coarser pulses, all of
    /// them together; `accel` in nm a tick squared.
    pub(crate) fn held_back(&self, machine: &Machine, feed: Feedrate, accel: f64) -> f64 {
        let way = feed.nm_per_min() as f64 / 60_000.0;
        // in its own tick, and on both sides of it, where the speed goes down and up again
        let held = self.lengths.iter().map(|length| (way - length).max(0.0)).map(|less| less + less * less / accel);
        held.sum::<f64>() / nm(machine.x.pulse).max(nm(machine.z.pulse))
    }
}
