//! Heartbeat: whether the watchdog may be fed.
//!
//! The interpolator asks once a tick, and it runs only while the train advances; so a train that stands starves the
//! watchdog by itself. The background checks in, too, but it may take its time, and one that hangs does not disturb a
//! single pulse: the watchdog is starved for it only once the tool stands, when a restart spoils nothing.

use interp_core::block::Speed;

/// Ticks that the background may be silent: a long listing over the serial port takes a tenth of it.
const PATIENCE: u32 = 2_000;

/// Counts the background's silence.
#[derive(Copy, Clone, Debug, Default)]
pub struct Heartbeat {
    silent: u32,
}

impl Heartbeat {
    /// A background that has just checked in.
    pub const fn new() -> Self {
        Self { silent: 0 }
    }

    /// Whether the watchdog may be fed after a tick: `checked_in` tells of the background since the last one, `speed` of
    /// the path.
    pub const fn beat(&mut self, checked_in: bool, speed: Speed) -> bool {
        self.silent = if checked_in { 0 } else { self.silent.saturating_add(1) };
        self.silent < PATIENCE || speed > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_silent_background_starves_the_watchdog_only_at_rest() {
        let mut heartbeat = Heartbeat::new();
        for tick in 1..3 * PATIENCE {
            assert!(heartbeat.beat(tick % (PATIENCE - 1) == 0, 0));
        }
        let mut heartbeat = Heartbeat::new();
        let fed = (1..=2 * PATIENCE).take_while(|_| heartbeat.beat(false, 0)).count();
        assert_eq!(fed, 1_999);
        assert!(heartbeat.beat(false, 1) && !heartbeat.beat(false, 0) && heartbeat.beat(true, 0));
    }
}
