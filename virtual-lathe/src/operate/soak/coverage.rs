//! What was exercised: how often, so that a person sees what never is.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use handcnc::foreground::alarm::Alarm;
use handcnc::foreground::mode::Mode;
use interp_core::channel::State;

/// Words that can come, so that those that never did are shown with 0.
const REQUESTS: [&str; 42] = [
    "arc",
    "block-skip",
    "book-wear",
    "confirm-position",
    "dry-run",
    "estop",
    "feed",
    "feed-rate",
    "guard",
    "hold",
    "home",
    "joystick",
    "keep-offset",
    "limit",
    "load",
    "lock",
    "lose-index",
    "mdi",
    "mode",
    "motors",
    "noise",
    "null-offset",
    "optional-stop",
    "pick-up",
    "power-fail",
    "power-on",
    "rapid",
    "rapid-override",
    "release",
    "repeat",
    "reset",
    "resume",
    "return",
    "scale",
    "set",
    "single",
    "spindle",
    "spindle-override",
    "spindle-wobble",
    "start",
    "stop-at",
    "taper",
];
const MORE: [&str; 4] = ["threading-lever", "wheel", "zero", "expect"];
const REFUSALS: [&str; 28] = [
    "alarm",
    "bad-contour",
    "contradiction",
    "cycle-under-way",
    "emergency-open",
    "guard-open",
    "in-thread",
    "joystick-latched",
    "limit-x+",
    "limit-x-",
    "limit-z+",
    "limit-z-",
    "motors-off",
    "moving",
    "no-alarm",
    "no-contour",
    "no-index",
    "no-lead",
    "no-power",
    "nothing-to-hold",
    "nothing-to-pick-up",
    "nothing-to-resume",
    "nothing-to-retrace",
    "nothing-to-return-from",
    "running",
    "unverified",
    "wheels-off",
    "wrong-mode",
];
const HAPPENED: [&str; 9] = [
    "cycle ended",
    "cycle reset",
    "offset wound back to zero",
    "path run by a wheel",
    "thread cut",
    "thread left",
    "wheel counted exactly",
    "shoulder met",
    "soft limit reached",
];

/// Counts.
#[derive(Clone, Debug, Default)]
pub(super) struct Coverage {
    /// Ticks in all.
    pub(super) ticks: u64,
    /// Ticks in each mode, and in each state.
    modes: [u64; Mode::ALL.len()],
    states: [u64; 7],
    /// Ticks that an axis moved in.
    pub(super) moving: u64,
    requests: BTreeMap<String, u64>,
    refusals: BTreeMap<String, u64>,
    alarms: BTreeMap<String, u64>,
    happened: BTreeMap<&'static str, u64>,
    /// Sessions.
    pub(super) sessions: u64,
}

impl Coverage {
    pub(super) fn tick(&mut self, mode: Mode, state: State, moved: bool) {
        self.ticks += 1;
        self.moving += u64::from(moved);
        if let Some(count) = self.modes.get_mut(mode as usize) {
            *count += 1;
        }
        if let Some(count) = self.states.get_mut(state as usize) {
            *count += 1;
        }
    }

    pub(super) fn request(&mut self, text: &str) {
        let name = text.split_whitespace().next().unwrap_or_default();
        *self.requests.entry(name.into()).or_default() += 1;
    }

    pub(super) fn refusal(&mut self, name: &str, times: u64) {
        *self.refusals.entry(name.into()).or_default() += times;
    }

    pub(super) fn alarm(&mut self, alarm: Alarm) {
        *self.alarms.entry(alarm.to_string()).or_default() += 1;
    }

    pub(super) fn happened(&mut self, what: &'static str) {
        *self.happened.entry(what).or_default() += 1;
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.ticks += other.ticks;
        self.moving += other.moving;
        self.sessions += other.sessions;
        self.modes.iter_mut().zip(other.modes).for_each(|(sum, more)| *sum += more);
        self.states.iter_mut().zip(other.states).for_each(|(sum, more)| *sum += more);
        for (name, more) in &other.requests {
            *self.requests.entry(name.clone()).or_default() += more;
        }
        for (name, more) in &other.refusals {
            *self.refusals.entry(name.clone()).or_default() += more;
        }
        for (name, more) in &other.alarms {
            *self.alarms.entry(name.clone()).or_default() += more;
        }
        for (name, more) in &other.happened {
            *self.happened.entry(name).or_default() += more;
        }
    }

    /// The table.
    pub(super) fn table(&self) -> String {
        let mut text = String::new();
        let part =
            |ticks: u64| format!("{}.{} %", ticks * 100 / self.ticks.max(1), ticks * 1000 / self.ticks.max(1) % 10);
        let modes = Mode::ALL.iter().zip(self.modes).map(|(mode, ticks)| (mode.name().to_owned(), part(ticks)));
        lines(&mut text, "time in mode", modes);
        let names = ["idle", "filling", "running", "holding", "resetting", "stopped", "ended"];
        let states = names.iter().zip(self.states).map(|(name, ticks)| ((*name).to_owned(), part(ticks)));
        lines(&mut text, "time in state", states.chain([("axes moving".to_owned(), part(self.moving))]));
        let all = |known: &[&str], counts: &BTreeMap<String, u64>| {
            let mut all: BTreeMap<String, u64> = known.iter().map(|name| ((*name).to_owned(), 0)).collect();
            all.extend(counts.clone());
            all.into_iter().map(|(name, count)| (name, count.to_string())).collect::<Vec<_>>()
        };
        lines(&mut text, "asked for", all(&[&REQUESTS[..], &MORE].concat(), &self.requests).into_iter());
        lines(&mut text, "refused", all(&REFUSALS, &self.refusals).into_iter());
        let alarms: Vec<String> = Alarm::ALL.iter().map(ToString::to_string).collect();
        let alarms: Vec<&str> = alarms.iter().map(String::as_str).collect();
        lines(&mut text, "alarms", all(&alarms, &self.alarms).into_iter());
        let happened = self.happened.iter().map(|(name, count)| ((*name).to_owned(), *count)).collect();
        lines(&mut text, "happened", all(&HAPPENED, &happened).into_iter());
        text
    }
}

/// Names and values, as many a line as fit.
fn lines(text: &mut String, title: &str, pairs: impl Iterator<Item = (String, String)>) {
    let _ = writeln!(text, "{title}:");
    let mut line = String::new();
    for (name, value) in pairs {
        let pair = format!("{name} {value}");
        if !line.is_empty() && line.len() + pair.len() > 108 {
            let _ = writeln!(text, "  {line}");
            line.clear();
        }
        if !line.is_empty() {
            line.push_str(" | ");
        }
        line.push_str(&pair);
    }
    let _ = writeln!(text, "  {line}");
}
