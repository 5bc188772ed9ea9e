//! The least time that a program's blocks can take under the machine's limits, in closed form, in `f64`.
//!
//! Every block is a trapezoid of speed over time under a constant acceleration along its path: the axis limits over
//! the parts of its direction for a line, the smaller axis acceleration for an arc, whose speed is at most
//! sqrt(a R). Joints are passed at the speed at which no axis jumps by more than its `max_jump`; starts and stops
//! are joints with standstill. All blocks are known from the first, so this is what unlimited look-ahead would reach.

use feature_editor::codes::{Action, Feed, Item};
use handcnc::background::parameters::Parameters;
use interp_core::units::{Point, PulseSize, Sense};

type Vector = [f64; 2];

struct Block {
    length: f64,
    cap: f64,
    accel: f64,
    entry: Vector,
    exit: Vector,
    /// Stands still before this block.
    fresh: bool,
}

/// Least time in seconds.
#[allow(clippy::cast_precision_loss, reason = "an oracle in f64")]
pub fn seconds(items: &[Item], parameters: &Parameters) -> f64 {
    let config = parameters.config();
    let per_axis = |value: &dyn Fn(&interp_core::config::AxisConfig) -> f64| [value(&config.x), value(&config.z)];
    let speed = per_axis(&|axis| axis.max_feed.nm_per_min() as f64 / 60e6);
    let accel = per_axis(&|axis| f64::from(axis.max_accel) / 1e3);
    let jump = per_axis(&|axis| f64::from(axis.max_jump) / 1e3);
    let size = |pulse: PulseSize| f64::from(pulse.numerator()) / f64::from(pulse.denominator()) * 1e-6;
    let pulse = [size(config.x.pulse), size(config.z.pulse)];
    let snap = |p: Point| {
        let at = [f64::from(p.x.nm()) * 1e-6, f64::from(p.z.nm()) * 1e-6];
        // a half is a half although f64 may miss it
        let near = |at: f64, pulse: f64| (at / pulse + 0.5 + 1e-9).floor() * pulse;
        [near(at[0], pulse[0]), near(at[1], pulse[1])]
    };
    let mut at = snap(parameters.start());
    let mut blocks: Vec<Block> = Vec::new();
    let mut waits = 0.0;
    let mut fresh = true;
    for item in items {
        let (end, feed, round) = match item.action {
            Action::Line { end, feed } => (end, feed, None),
            Action::Arc { end, centre, sense, feed } => (end, feed, Some((centre, sense))),
            Action::Dwell { ms } => {
                waits += f64::from(ms) / 1e3;
                fresh = true;
                continue;
            }
            _ => {
                fresh = true;
                continue;
            }
        };
        let to = snap(end);
        let programmed = match feed {
            // what follows the spindle has no optimum of its own
            Feed::Rapid | Feed::PerTurn(_) | Feed::Thread { .. } => f64::INFINITY,
            Feed::PerMinute(feed) => feed.nm_per_min() as f64 / 60e6 * f64::from(parameters.feed_override()) / 100.0,
        };
        let block = match round {
            None => line(at, to, &speed, &accel, programmed),
            Some((centre, sense)) => {
                let centre = [centre.x.nm() as f64 * 1e-6, centre.z.nm() as f64 * 1e-6];
                arc(at, to, centre, sense, &speed, accel[0].min(accel[1]), programmed)
            }
        };
        at = to;
        if let Some(block) = block {
            blocks.push(Block { fresh, ..block });
            fresh = false;
        }
    }
    waits + pass(&blocks, &jump)
}

fn least(limit: &[f64; 2], direction: Vector) -> f64 {
    let along = |limit: f64, part: f64| if part.abs() < 1e-15 { f64::INFINITY } else { limit / part.abs() };
    along(limit[0], direction[0]).min(along(limit[1], direction[1]))
}

fn line(from: Vector, to: Vector, speed: &[f64; 2], accel: &[f64; 2], feed: f64) -> Option<Block> {
    let (dx, dz) = (to[0] - from[0], to[1] - from[1]);
    let length = dx.hypot(dz);
    if length < 1e-9 {
        return None;
    }
    let u = [dx / length, dz / length];
    Some(Block { length, cap: least(speed, u).min(feed), accel: least(accel, u), entry: u, exit: u, fresh: false })
}

fn arc(
    from: Vector,
    to: Vector,
    centre: Vector,
    sense: Sense,
    speed: &[f64; 2],
    accel: f64,
    feed: f64,
) -> Option<Block> {
    // angles from the Z axis toward X
    let angle = |p: Vector| (p[0] - centre[0]).atan2(p[1] - centre[1]);
    let radius = (from[0] - centre[0]).hypot(from[1] - centre[1]);
    let turn = if sense == Sense::CounterClockwise { 1.0 } else { -1.0 };
    let mut sweep = ((angle(to) - angle(from)) * turn).rem_euclid(std::f64::consts::TAU);
    if sweep < 1e-9 {
        sweep = std::f64::consts::TAU;
    }
    let heading = |angle: f64| [turn * angle.cos(), -turn * angle.sin()];
    let steps = 64;
    let cap = (0..=steps)
        .map(|k| least(speed, heading(angle(from) + turn * sweep * f64::from(k) / f64::from(steps))))
        .fold(f64::INFINITY, f64::min);
    let cap = cap.min((accel * radius).sqrt()).min(feed);
    let (entry, exit) = (heading(angle(from)), heading(angle(from) + turn * sweep));
    Some(Block { length: radius * sweep, cap, accel, entry, exit, fresh: false })
}

/// Entry speeds backward, then times forward.
#[allow(clippy::indexing_slicing, reason = "an oracle over its own list")]
fn pass(blocks: &[Block], jump: &[f64; 2]) -> f64 {
    let count = blocks.len();
    // largest speed at the joint before block k
    let joint = |k: usize| {
        let here = &blocks[k];
        if here.fresh || k == 0 {
            least(jump, here.entry).min(here.cap)
        } else {
            let before = &blocks[k - 1];
            let change = [here.entry[0] - before.exit[0], here.entry[1] - before.exit[1]];
            least(jump, change).min(here.cap).min(before.cap)
        }
    };
    let stop = |k: usize| least(jump, blocks[k].exit).min(blocks[k].cap);
    let mut entries = vec![0.0; count];
    let mut exits = vec![0.0; count];
    for k in (0..count).rev() {
        exits[k] = if k + 1 == count || blocks[k + 1].fresh { stop(k) } else { entries[k + 1] };
        let reach: f64 = exits[k] * exits[k] + 2.0 * blocks[k].accel * blocks[k].length;
        entries[k] = joint(k).min(reach.sqrt());
    }
    let mut time = 0.0;
    let mut speed = 0.0;
    for k in 0..count {
        let block = &blocks[k];
        let entry: f64 = if block.fresh || k == 0 { entries[k] } else { entries[k].min(speed) };
        let exit = exits[k].min((entry * entry + 2.0 * block.accel * block.length).sqrt());
        let peak = f64::midpoint(entry * entry + 2.0 * block.accel * block.length, exit * exit).sqrt().min(block.cap);
        let ramps = (2.0 * peak * peak - entry * entry - exit * exit) / (2.0 * block.accel);
        time += (2.0 * peak - entry - exit) / block.accel + (block.length - ramps).max(0.0) / peak;
        speed = exit;
    }
    time
}
