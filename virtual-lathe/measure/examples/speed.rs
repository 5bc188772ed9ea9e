//! How many events a second the checker reads: circles and lines of many blocks, made beforehand.

use measure::{Checker, Limits, Motion, PerAxis, PulseEquivalent, Setup, Shape};
use std::time::Instant;

/// Half a million blocks of 40 pulses, out and back: first lines, then arcs so wide that the points of the
/// line are on them.
fn main() {
    let limits = Limits {
        max_accel: 1e5,
        max_feed: 1e5,
        max_jump: 1e4,
        pulse_width_ns: 0,
        dir_setup_ns: 0,
        dir_hold_ns: 0,
        min_space_ns: 0,
    };
    let pulse = PulseEquivalent { num: 1_000, den: 1 };
    let setup = Setup {
        pulse_nm: PerAxis { x: pulse, z: pulse },
        start: PerAxis { x: 0, z: 0 },
        start_nm: PerAxis { x: 0, z: 0 },
        limits: PerAxis { x: limits, z: limits },
        event_min_ns: 0,
        uneven: false,
        smoothed_ticks: 0,
    };
    // 20 pulses of Z in a tick, every other one with X; a pulse is two events.
    let tick = |x_plus: u32, z_plus: u32| -> Vec<u32> {
        (0..20_u32)
            .flat_map(|pulse| {
                let level = (x_plus << 1) | (z_plus << 3);
                let step = level | 4 | (pulse % 2);
                [(step << 16) | 300, (level << 16) | 300]
            })
            .collect()
    };
    let (out, back) = (tick(1, 1), tick(0, 0));
    for arcs in [false, true] {
        let mut checker = Checker::new(setup).unwrap_or_else(|error| unreachable!("{error}"));
        let begin = Instant::now();
        let mut events = 0_usize;
        for block in 0..500_000_u32 {
            let end = if block % 2 == 0 { (20_000, 40_000) } else { (0, 0) };
            let shape = if arcs {
                Shape::Arc { centre_nm: PerAxis { x: 4_000_000_000, z: -2_000_000_000 }, clockwise: block % 2 == 1 }
            } else {
                Shape::Line
            };
            checker.motion(Motion {
                line: block,
                shape,
                end_nm: PerAxis { x: end.0, z: end.1 },
                feed_mm_min: Some(1_341.6),
            });
            for _ in 0..2 {
                let tick = if block % 2 == 0 { &out } else { &back };
                checker.tick(tick);
                events += tick.len();
            }
        }
        let report = checker.finish();
        let seconds = begin.elapsed().as_secs_f64();
        println!("{report}");
        println!("arcs {arcs}: {} events in {seconds:.3} s, {:.1} million/s\n", events, events as f64 / seconds / 1e6);
    }
}
