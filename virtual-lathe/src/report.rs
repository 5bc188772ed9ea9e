//! What is said about a run: JSON for scripts, a few lines for people, and the list of parameters.

use std::fmt::Write;
use std::time::Duration;

use handcnc::background::parameters::{DEFINITIONS, Kind};
use machine::Axes;
use measure::{PerAxis, Report};
use serde_json::{Map, Value, json};

use crate::settings::TABLES;
use crate::work::{Times, Worked};

/// Collisions that a person is told of; the report has all that are kept.
const COLLISIONS_TOLD: usize = 8;

/// Figures that the checker does not have.
#[derive(Clone, Debug)]
pub struct Run {
    /// Program blocks that move.
    pub blocks: u64,
    /// Time that the computer took.
    pub wall: Duration,
    /// Pulses that the motors did not make.
    pub lost_pulses: Axes<u64>,
    /// Greatest part of its pull-out torque that each motor was asked for.
    pub motor_load: Axes<f64>,
    /// The control compensates an axis.
    pub compensated: bool,
    /// How far the slides were off the program at most: Z and X, mm.
    pub slides_off: [f64; 2],
    /// Warnings, as text.
    pub warnings: Vec<String>,
}

fn axes(values: PerAxis<f64>) -> Value {
    json!({ "x": rounded(values.x, 3), "z": rounded(values.z, 3) })
}

/// A number with so many decimals.
fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10_f64.powi(decimals);
    (value * scale).round() / scale
}

/// The report as JSON, keys in a fixed order.
pub fn json(report: &Report, worked: &Worked, run: &Run) -> String {
    let feed = match &report.feed_error_percent {
        Some(error) => json!({ "mean": rounded(error.mean, 6), "max": rounded(error.max, 6) }),
        None => json!({ "mean": null, "max": null }),
    };
    let mut map = Map::new();
    map.insert("blocks".into(), run.blocks.into());
    map.insert("events".into(), report.events.into());
    map.insert("pulses".into(), json!({ "x": report.pulses.x, "z": report.pulses.z }));
    map.insert("time_s".into(), rounded(report.time_s, 6).into());
    map.insert("train_hash".into(), format!("{:016x}", report.train_hash).into());
    map.insert(
        "deviation_pulses".into(),
        json!({ "walked": rounded(report.walked.pulses, 6), "programmed": rounded(report.programmed.pulses, 6) }),
    );
    map.insert("max_rate_hz".into(), axes(report.max_rate_hz));
    map.insert("max_accel".into(), axes(report.max_accel));
    map.insert("feed_error_percent".into(), feed);
    map.insert("lost_pulses".into(), json!({ "x": run.lost_pulses.x, "z": run.lost_pulses.z }));
    work(&mut map, worked);
    map.insert("warnings".into(), run.warnings.clone().into());
    let mut text = serde_json::to_string_pretty(&Value::Object(map)).unwrap_or_default();
    text.push('\n');
    text
}

/// What was cut, and how.
fn work(map: &mut Map<String, Value>, worked: &Worked) {
    let outcome = worked.outcome.as_ref();
    let collisions: Vec<Value> = outcome
        .iter()
        .flat_map(|outcome| &outcome.collisions)
        .map(|found| {
            json!({
                "what": found.touched.word(),
                "time_s": rounded(nanoseconds(found.time_ns), 6),
                "line": found.line,
                "x_mm": rounded(found.place.x, 4),
                "z_mm": rounded(found.place.z, 4),
                "depth_mm": rounded(found.depth, 4),
            })
        })
        .collect();
    map.insert("collisions".into(), collisions.into());
    let surface = outcome.and_then(|outcome| outcome.surface);
    let figure = |value: Option<f64>| value.map(|value| rounded(value, 4));
    map.insert(
        "surface_error_um".into(),
        json!({ "mean": figure(surface.map(|s| s.mean_um)), "max": figure(surface.map(|s| s.max_um)) }),
    );
    let Times { cut_ms, rapid_ms, idle_ms } = worked.times;
    map.insert(
        "cycle".into(),
        json!({ "cut_s": seconds(cut_ms), "rapid_s": seconds(rapid_ms), "idle_s": seconds(idle_ms) }),
    );
    map.insert("volume_mm3".into(), json!(figure(outcome.map(|outcome| outcome.removed_mm3))));
    map.insert("volume_left_mm3".into(), json!(figure(outcome.map(|outcome| outcome.left_mm3))));
    map.insert("air_cut_percent".into(), json!(figure(air_percent(worked))));
}

#[expect(clippy::cast_precision_loss, reason = "times of a cycle")]
fn seconds(ms: u64) -> f64 {
    ms as f64 / 1e3
}

#[expect(clippy::cast_precision_loss, reason = "times of a cycle")]
fn nanoseconds(ns: u64) -> f64 {
    ns as f64 / 1e9
}

/// Part of the time in feeds in which nothing was cut.
fn air_percent(worked: &Worked) -> Option<f64> {
    let outcome = worked.outcome.as_ref()?;
    let feeds = seconds(worked.times.cut_ms);
    (feeds > 0.0).then(|| (100.0 * (1.0 - nanoseconds(outcome.cutting_ns) / feeds)).clamp(0.0, 100.0))
}

/// Lines about the stock, for a person.
fn cut_summary(text: &mut String, worked: &Worked) {
    let Times { cut_ms, rapid_ms, idle_ms } = worked.times;
    let _ = write!(
        text,
        "  cycle       {} in feeds, {} in rapids, {} standing",
        clock(seconds(cut_ms)),
        clock(seconds(rapid_ms)),
        clock(seconds(idle_ms))
    );
    if let Some(air) = air_percent(worked) {
        let _ = write!(text, "; {air:.1} % of the feeds cut air");
    }
    text.push('\n');
    let Some(outcome) = &worked.outcome else { return };
    let _ = write!(text, "  stock       {:.1} mm3 cut off, {:.1} left", outcome.removed_mm3, outcome.left_mm3);
    if let Some(surface) = outcome.surface {
        let _ = write!(
            text,
            "; surface off the contour by {:.2} um mean, {:.2} um at most",
            surface.mean_um, surface.max_um
        );
    }
    text.push('\n');
    for found in outcome.collisions.iter().take(COLLISIONS_TOLD) {
        let _ = writeln!(
            text,
            "  collision   line {}: {} after {}, Z{:.3} radius {:.3}, {:.3} mm deep",
            found.line,
            found.touched,
            clock(nanoseconds(found.time_ns)),
            found.place.z,
            found.place.x,
            found.depth
        );
    }
    let told = u64::try_from(COLLISIONS_TOLD).unwrap_or(0);
    if outcome.collisions_total > told {
        let _ = writeln!(text, "  collision   {} more", outcome.collisions_total - told);
    }
}

/// The report for a person.
pub fn summary(name: &str, report: &Report, worked: &Worked, run: &Run) -> String {
    let mut text = String::new();
    let wall = run.wall.as_secs_f64().max(1e-9);
    // writing to a string cannot fail
    let _ = writeln!(
        text,
        "{name}: {} blocks, {} machine time, run in {:.2} s ({:.0} times as fast)",
        run.blocks,
        clock(report.time_s),
        wall,
        report.time_s / wall
    );
    let _ = writeln!(
        text,
        "  pulses      X {}, Z {}; {} events, train {:016x}",
        report.pulses.x, report.pulses.z, report.events, report.train_hash
    );
    let _ = writeln!(
        text,
        "  deviation   {:.3} pulses from the walked curve, {:.3} from the programmed one",
        report.walked.pulses, report.programmed.pulses
    );
    let _ = writeln!(
        text,
        "  peaks       X {:.1} kHz and {:.0} mm/s2, Z {:.1} kHz and {:.0} mm/s2",
        report.max_rate_hz.x / 1e3,
        report.max_accel.x,
        report.max_rate_hz.z / 1e3,
        report.max_accel.z
    );
    match &report.feed_error_percent {
        Some(error) => {
            let _ = writeln!(
                text,
                "  feed error  {:.4} % mean, {:.4} % at most, over {} windows of 50 ms",
                error.mean, error.max, error.windows
            );
        }
        None => text.push_str("  feed error  no motion is long enough to tell\n"),
    }
    cut_summary(&mut text, worked);
    let percent = |load: f64| if load > 1.0 { "over 100 %".into() } else { format!("{:.0} %", load * 100.0) };
    let (load, lost) = (run.motor_load, run.lost_pulses);
    let _ = writeln!(
        text,
        "  motors      X {}, Z {} of pull-out at most; lost pulses X {}, Z {}",
        percent(load.x),
        percent(load.z),
        lost.x,
        lost.z
    );
    let [z, x] = run.slides_off.map(|mm| mm * 1e3);
    if run.compensated || x.max(z) >= 0.01 {
        let beyond = if run.compensated {
            format!("; at the end the motors are X {}, Z {} pulses beyond it", report.beyond.x, report.beyond.z)
        } else {
            String::new()
        };
        let _ = writeln!(text, "  slides      off the program by X {x:.2} um, Z {z:.2} um at most{beyond}");
    }
    text
}

/// Seconds as a person reads them.
pub fn clock(seconds: f64) -> String {
    if seconds < 60.0 {
        format!("{seconds:.3} s")
    } else if seconds < 3600.0 {
        let minutes = (seconds / 60.0).floor();
        format!("{minutes:.0} min {:.1} s", seconds - minutes * 60.0)
    } else {
        let hours = (seconds / 3600.0).floor();
        format!("{hours:.0} h {:.1} min", (seconds - hours * 3600.0) / 60.0)
    }
}

/// All parameters as a table.
pub fn parameters() -> String {
    let mut text = String::new();
    for definition in &DEFINITIONS {
        let range = match definition.kind {
            Kind::Number { scale, least, most } => {
                #[expect(clippy::cast_precision_loss, reason = "bounds of at most eleven digits")]
                let shown = |held: i64| held as f64 / f64::from(scale);
                format!("{} to {}", shown(least), shown(most))
            }
            Kind::Pulse => "10 to 1000000, ratio or decimal".into(),
            Kind::Switch => "true, false".into(),
            Kind::Choice(words) => words.join(", "),
            Kind::Place => "X,Z, each -2100 to 2100".into(),
        };
        row(&mut text, [definition.name, definition.default, definition.unit, &range, definition.help]);
    }
    for figure in TABLES.iter().copied().flatten() {
        row(&mut text, [figure.name, figure.default, figure.unit, &figure.range(), figure.help]);
    }
    text
}

/// A row of the table.
fn row(text: &mut String, [name, default, unit, range, help]: [&str; 5]) {
    // writing to a string cannot fail
    let _ = writeln!(text, "{name:<24} {default:<18} {unit:<7} {range:<32} {help}");
}
