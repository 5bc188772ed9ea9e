//! Status: what the foreground publishes after each tick and the link reads.

use super::link::Snapshot;
use crate::foreground::alarm::{Alarm, Faults};
use crate::foreground::published::Published;
use crate::foreground::{Foreground, state_word, word_state};
use core::sync::atomic::Ordering::Relaxed;
use interp_core::channel::Report;
use interp_core::units::Lattice;

/// The foreground's figures as published words.
#[derive(Debug, Default)]
pub struct Status(Published<8>);

impl Status {
    /// Idle at (0, 0).
    pub const fn new() -> Self {
        Self(Published::new())
    }

    /// Publishes what a tick made. From the interpolator only.
    pub fn publish(&self, report: &Report, foreground: &Foreground<'_>, faults: Faults) {
        let position = foreground.overseen();
        self.0.publish(|[state, x, z, speed, line, feed_override, underruns, alarm]| {
            state.store(state_word(report.state), Relaxed);
            x.store(position.x.cast_unsigned(), Relaxed);
            z.store(position.z.cast_unsigned(), Relaxed);
            speed.store(report.speed, Relaxed);
            line.store(report.line, Relaxed);
            feed_override.store(u32::from(foreground.feed_override()), Relaxed);
            underruns.store(faults.underruns, Relaxed);
            alarm.store(foreground.alarm().map_or(0, |alarm| alarm.number().into()), Relaxed);
        });
    }

    /// What was published last.
    pub fn snapshot(&self) -> Snapshot {
        let [state, x, z, speed, line, feed_override, underruns, alarm] = self.0.read();
        Snapshot {
            state: word_state(state),
            position: Lattice { x: x.cast_signed(), z: z.cast_signed() },
            speed,
            line,
            feed_override: u16::try_from(feed_override).unwrap_or(u16::MAX),
            underruns,
            alarm: Alarm::of(alarm),
        }
    }
}
