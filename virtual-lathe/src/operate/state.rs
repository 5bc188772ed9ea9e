//! The state of the lathe as JSON: what `expect` looks at, and what is printed in the end.

use handcnc::foreground::shown::Shown;
use interp_core::units::{Axis, Lattice};
use serde_json::{Value, json};

use super::bench::Bench;

/// Something that was refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused {
    /// Ticks from the start.
    pub tick: u64,
    /// When it came last.
    pub last: u64,
    /// Line of the script, 0 where no event asked for it.
    pub line: u32,
    /// Its name of one word.
    pub name: String,
    /// What there is to say.
    pub text: String,
    /// How often it came, each time within a second of the one before.
    pub times: u32,
}

/// All that the state is made of.
pub(super) struct View<'v> {
    pub(super) shown: &'v Shown,
    pub(super) bench: &'v Bench,
    pub(super) refused: &'v [Refused],
    pub(super) tick: u64,
    pub(super) train_hash: u64,
    /// Pulses that the pins showed.
    pub(super) played: Lattice,
    pub(super) power: bool,
}

/// The state.
pub(super) fn json(view: &View<'_>) -> Value {
    let View { shown, bench, refused, .. } = view;
    let both = |at: Lattice| json!({"x": at.x, "z": at.z});
    let slides = bench.slides();
    let lost = bench.machine().lost_pulses();
    let spindle = &bench.spindle;
    let alarms: Vec<String> = shown.alarm.iter().map(|alarm| kebab(&format!("{alarm:?}"))).collect();
    let names: Vec<&str> = refused.iter().map(|refused| refused.name.as_str()).collect();
    let details: Vec<Value> = refused.iter().map(detail).collect();
    json!({
        "mode": shown.mode.name(),
        "state": kebab(&format!("{:?}", shown.state)),
        "position": both(shown.position),
        "programmed": both(shown.programmed),
        "offset": both(shown.offset),
        "kept": both(shown.kept),
        "wear": both(shown.wear),
        "dropped": {"x": shown.dropped.x, "z": shown.dropped.z, "contour": shown.dropped_contour},
        "distance_to_go": rounded(nm(shown.distance_to_go) / 1e6),
        // nm a tick with 12 fraction bits
        "feed": rounded(f64::from(shown.speed) / 4096.0 * 60_000.0 / 1e6),
        "alarms": alarms,
        "refusals": names,
        "block": shown.line,
        "interrupted": shown.interrupted,
        "lever": shown.lever,
        "pick_up": shown.pick_up.name(),
        "verified": {"x": shown.verified.x, "z": shown.verified.z},
        "spindle": {
            "rpm": rounded(spindle.rpm(bench.machine())),
            "angle": rounded(spindle.angle(bench.machine()).part * 360.0),
        },
        "outputs": {"motors": shown.outputs.motors, "spindle": shown.outputs.spindle},
        "following": {"x": shown.following.x, "z": shown.following.z},
        "scale": {"x": bench.scale(Axis::X), "z": bench.scale(Axis::Z)},
        "slides": {"x": rounded(slides.x / 1e6), "z": rounded(slides.z / 1e6)},
        "played": both(view.played),
        "lost_pulses": {"x": lost.x, "z": lost.z},
        "power": view.power,
        "tick": view.tick,
        "train_hash": format!("{:016x}", view.train_hash),
        "refused_details": details,
    })
}

fn detail(refused: &Refused) -> Value {
    json!({
        "tick": refused.tick,
        "last": refused.last,
        "line": refused.line,
        "name": refused.name,
        "text": refused.text,
        "times": refused.times,
    })
}

/// A name of several capitals, such as `LimitSwitchX`, as words with hyphens between.
pub(super) fn kebab(name: &str) -> String {
    let mut words = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !words.is_empty() {
            words.push('-');
        }
        words.extend(letter.to_lowercase());
    }
    words
}

/// To six decimals, and no negative zero.
fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6 + 0.0
}

#[expect(clippy::cast_precision_loss, reason = "nm of a path")]
fn nm(value: u64) -> f64 {
    value as f64
}
