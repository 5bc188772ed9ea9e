//! Status: what the foreground publishes after each tick and the link reads.

use super::link::Snapshot;
use crate::foreground::alarm::{Alarm, Faults};
use crate::foreground::answer;
use crate::foreground::mode::Mode;
use crate::foreground::published::Published;
use crate::foreground::{Foreground, state_word, word_state};
use core::sync::atomic::Ordering::Relaxed;
use interp_core::channel::Report;
use interp_core::units::Lattice;

/// Bits of the mode; the answer to the last request stands above them.
const MODE_BITS: u32 = 4;

/// The foreground's figures as published words.
#[derive(Debug, Default)]
pub struct Status(Published<11>);

impl Status {
    /// Idle at (0, 0).
    pub const fn new() -> Self {
        Self(Published::new())
    }

    /// Publishes what a tick made. From the interpolator only.
    pub fn publish(&self, report: &Report, foreground: &Foreground<'_>, faults: Faults) {
        let (position, programmed) = (foreground.overseen(), foreground.programmed());
        self.0.publish(|[state, x, z, speed, line, feed_override, underruns, alarm, path_x, path_z, desk]| {
            state.store(state_word(report.state), Relaxed);
            x.store(position.x.cast_unsigned(), Relaxed);
            z.store(position.z.cast_unsigned(), Relaxed);
            speed.store(report.speed, Relaxed);
            line.store(report.line, Relaxed);
            feed_override.store(u32::from(foreground.feed_override()), Relaxed);
            underruns.store(faults.underruns, Relaxed);
            alarm.store(foreground.alarm().map_or(0, |alarm| alarm.number().into()), Relaxed);
            path_x.store(programmed.x.cast_unsigned(), Relaxed);
            path_z.store(programmed.z.cast_unsigned(), Relaxed);
            desk.store(foreground.answered() << MODE_BITS | foreground.mode() as u32, Relaxed);
        });
    }

    /// What was published last.
    pub fn snapshot(&self) -> Snapshot {
        let [state, x, z, speed, line, feed_override, underruns, alarm, path_x, path_z, desk] = self.0.read();
        let mode = desk & ((1 << MODE_BITS) - 1);
        Snapshot {
            state: word_state(state),
            position: Lattice { x: x.cast_signed(), z: z.cast_signed() },
            speed,
            line,
            feed_override: u16::try_from(feed_override).unwrap_or(u16::MAX),
            underruns,
            alarm: Alarm::of(alarm),
            programmed: Lattice { x: path_x.cast_signed(), z: path_z.cast_signed() },
            mode: Mode::ALL.into_iter().find(|known| *known as u32 == mode).unwrap_or_default(),
            answer: answer::refusal(desk >> MODE_BITS),
        }
    }
}
