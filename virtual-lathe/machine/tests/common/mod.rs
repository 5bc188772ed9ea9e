//! Trains made by hand, without the interpolator.

use figures::Figures;
use interp_core::train::{Event, Levels};
use interp_core::units::Axis;
use machine::{Axes, Control, Machine, TABLES};

pub const CONTROL: Control = Control { pulse_nm: Axes { x: 1250.0, z: 2500.0 }, start: Axes { x: 0, z: 0 } };

pub fn figures(set: &[(&str, &str)]) -> Figures {
    let mut figures = Figures::new(TABLES);
    for (name, text) in set {
        figures.set(name, text).unwrap();
    }
    figures
}

pub fn machine(set: &[(&str, &str)]) -> Machine {
    Machine::new(&figures(set), CONTROL).unwrap()
}

/// Plays pulses of one axis at their times in seconds, ascending and at least 20 us apart, and rests of 50 ms after.
pub fn play(machine: &mut Machine, axis: Axis, plus: bool, times: impl Iterator<Item = f64>) {
    let low = Levels::LOW.with_plus(axis, plus);
    // the direction, long enough before the first pulse
    let mut now = 12_000_u64;
    wait(machine, low, now);
    let begin = now;
    for time in times {
        let at = begin + (time * 12e6).round() as u64;
        wait(machine, low, at.saturating_sub(now));
        machine.play(Event::new(low.with_step(axis, true), 60));
        now = now.max(at) + 60;
    }
    wait(machine, low, 600_000);
}

/// Keeps levels for so many clocks, in events of at most a tick.
pub fn wait(machine: &mut Machine, levels: Levels, clocks: u64) {
    let mut left = clocks;
    while left > 0 {
        let part = left.min(12_000);
        machine.play(Event::new(levels, part as u32));
        left -= part;
    }
}

/// Times of the pulses of a move of `mm`: evenly accelerated by `accel` mm/s2 up to `speed` mm/s, then even, then
/// braked to rest by `brake` mm/s2.
pub fn ramp(mm: f64, pulse_nm: f64, accel: f64, speed: f64, brake: f64) -> Vec<f64> {
    let (up, down) = (speed * speed / 2.0 / accel, speed * speed / 2.0 / brake);
    let count = (mm * 1e6 / pulse_nm).round() as u32;
    let whole = f64::from(count) * pulse_nm * 1e-6;
    let (t_up, t_even) = (speed / accel, (whole - up - down) / speed);
    assert!(t_even >= 0.0, "too short to reach the speed");
    (0..count)
        .map(|n| {
            let s = f64::from(n) * pulse_nm * 1e-6;
            if s < up {
                (2.0 * s / accel).sqrt()
            } else if s < whole - down {
                t_up + (s - up) / speed
            } else {
                t_up + t_even + speed / brake - (2.0 * (whole - s) / brake).sqrt()
            }
        })
        .collect()
}
