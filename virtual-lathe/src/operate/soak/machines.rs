//! Machines at random: parameters that a scenario sets at second 0.

use super::chance::Chance;

/// Parameters of a machine.
pub(super) fn machine(chance: &mut Chance) -> Vec<(String, String)> {
    let mut set: Vec<(String, String)> = Vec::new();
    let mut put = |name: &str, value: String| set.push((name.into(), value));
    let pulses = ["", "", "1984.375", "15875/8", "5000", "10000", "10000/3", "12700/7", "500"];
    for axis in ["x", "z"] {
        let pulse = chance.one_of(&pulses);
        if !pulse.is_empty() {
            put(&format!("{axis}.pulse_nm"), pulse.into());
        }
        if chance.once_in(3) {
            put(&format!("{axis}.max_accel"), format!("{:.0}", chance.spread(60.0, 3_000.0)));
        }
        if chance.once_in(3) {
            put(&format!("{axis}.max_feed"), format!("{:.0}", chance.spread(600.0, 6_000.0)));
        }
        if chance.once_in(4) {
            put(&format!("{axis}.max_jump"), format!("{:.2}", chance.spread(0.3, 8.0)));
        }
        if chance.coin() {
            put(&format!("{axis}.limit_minus_mm"), format!("{:.3}", -chance.spread(2.0, 60.0)));
            put(&format!("{axis}.limit_plus_mm"), format!("{:.3}", chance.spread(2.0, 60.0)));
        }
        if chance.coin() {
            put(&format!("{axis}.hand_minus_mm"), format!("{:.3}", chance.spread(0.05, 20.0)));
            put(&format!("{axis}.hand_plus_mm"), format!("{:.3}", chance.spread(0.05, 20.0)));
        }
        if chance.once_in(3) {
            put(&format!("{axis}.home_toward"), chance.one_of(&["plus", "minus"]).into());
        }
        if chance.once_in(3) {
            put(&format!("{axis}.home_mm"), format!("{:.3}", chance.real(-5.0, 5.0)));
        }
        if chance.once_in(6) {
            put(&format!("{axis}.backlash_um"), format!("{:.1}", chance.spread(1.0, 80.0)));
        }
        put(&format!("{axis}.home_feed"), format!("{:.0}", chance.spread(200.0, 2_000.0)));
    }
    match chance.whole(0, 7) {
        0 => put("accel", "sine".into()),
        1 => put("accel", "parabolic".into()),
        _ => {}
    }
    if chance.once_in(6) {
        put("corner_um", format!("{:.0}", chance.spread(1.0, 300.0)));
    }
    if chance.once_in(8) {
        let methods = ["point-comparison", "dda", "rate-multiplier", "fraction", "time-division"];
        put("method", chance.one_of(&methods).into());
    }
    // as good as none: operators set a feed when they want to go
    put("power_feed", "0.06".into());
    if chance.once_in(3) {
        put("safe_feed", format!("{:.0}", chance.spread(60.0, 3_000.0)));
    }
    if chance.once_in(3) {
        put("dry_feed", format!("{:.0}", chance.spread(100.0, 3_000.0)));
    }
    if chance.once_in(3) {
        put("thread.retract_mm", chance.one_of(&["-1", "0", "0.5", "4"]).into());
    }
    set
}
