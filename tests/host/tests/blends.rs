//! Blended corners in whole programs: against the sharp path in `f64`, and by the checker, which takes the blended path
//! for the programmed one.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::cast_precision_loss,
    missing_docs,
    reason = "tests whose oracle is in f64"
)]

use feature_editor::codes::{Action, Feed, Format, Item};
use handcnc::background::compile::Compiler;
use host_tests::{parameters, run};
use interp_core::block::{Block, Feed as Pace, Motion, Work};
use interp_core::channel::lookahead::{Overrides, pace};
use interp_core::units::{Point, Sense};
use proptest::prelude::*;
use std::fmt::Write;

/// Z and X, mm.
type V = [f64; 2];

fn v(point: Point) -> V {
    [f64::from(point.z.nm()) * 1e-6, f64::from(point.x.nm()) * 1e-6]
}

/// A curve of a program, as points a few micrometres apart; true ones, as only chords between them lie off it.
#[derive(Debug)]
struct Curve {
    line: u32,
    points: Vec<V>,
    feed: bool,
}

fn angle_between(from: V, to: V, sense: Sense) -> f64 {
    let turned = (from[0] * to[1] - from[1] * to[0]).atan2(from[0] * to[0] + from[1] * to[1]);
    let turned = if sense == Sense::CounterClockwise { turned } else { -turned };
    if turned > 1e-12 { turned } else { turned + std::f64::consts::TAU }
}

/// The curves of a program, and where the tool stands at everything else.
fn curves(items: &[Item]) -> (Vec<Curve>, Vec<(Action, Point)>) {
    let (mut at, mut curves, mut stands) = (Point::default(), Vec::new(), Vec::new());
    for item in items {
        let (start, (end, round, feed)) = match item.action {
            Action::Line { end, feed } => (at, (end, None, feed)),
            Action::Arc { end, centre, sense, feed } => (at, (end, Some((centre, sense)), feed)),
            other => {
                stands.push((other, at));
                continue;
            }
        };
        at = end;
        let (a, b) = (v(start), v(end));
        let points = match round {
            None => {
                let count = 200;
                (0..=count)
                    .map(|k| f64::from(k) / f64::from(count))
                    .map(|t| [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t])
                    .collect()
            }
            Some((centre, sense)) => {
                let c = [centre.z.nm() as f64 * 1e-6, centre.x.nm() as f64 * 1e-6];
                let (from, to) = ([a[0] - c[0], a[1] - c[1]], [b[0] - c[0], b[1] - c[1]]);
                let (r0, r1) = (from[0].hypot(from[1]), to[0].hypot(to[1]));
                let sweep = angle_between(from, to, sense) * if sense == Sense::CounterClockwise { 1.0 } else { -1.0 };
                let count = 2_000;
                (0..=count)
                    .map(|k| f64::from(k) / f64::from(count))
                    .map(|t| {
                        let angle = from[1].atan2(from[0]) + sweep * t;
                        let radius = r0 + (r1 - r0) * t;
                        [c[0] + radius * angle.cos(), c[1] + radius * angle.sin()]
                    })
                    .collect()
            }
        };
        curves.push(Curve { line: item.line, points, feed: feed != Feed::Rapid });
    }
    (curves, stands)
}

/// Distance of a point from the chords of a curve.
fn off(curve: &Curve, at: V) -> f64 {
    let chord = |ends: &[V]| {
        let [a, b] = [ends[0], ends[1]];
        let (way, to) = ([b[0] - a[0], b[1] - a[1]], [at[0] - a[0], at[1] - a[1]]);
        let square = way[0] * way[0] + way[1] * way[1];
        let t = if square > 0.0 { ((to[0] * way[0] + to[1] * way[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
        (to[0] - way[0] * t).hypot(to[1] - way[1] * t)
    };
    curve.points.windows(2).map(chord).fold(f64::INFINITY, f64::min)
}

/// Holds a blended program against the sharp one: every point of each is near the other, and all stands are where they
/// were. How many arcs were put in, and the largest distance, mm.
fn compare(sharp: &[Item], blended: &[Item]) -> (usize, f64) {
    let ((sharp, stands), (blended, other_stands)) = (curves(sharp), curves(blended));
    assert_eq!(stands, other_stands);
    let end = |curves: &[Curve]| curves.last().and_then(|curve| curve.points.last().copied()).unwrap_or_default();
    let (one, other) = (end(&sharp), end(&blended));
    assert!((one[0] - other[0]).hypot(one[1] - other[1]) < 1e-9, "{one:?} {other:?}");
    let mut largest = 0.0_f64;
    // an arc bears the line of the feed that it leads into, so the one before may be the nearest
    let near = |curves: &[Curve], line: u32, at: V, steps: usize| {
        let first = curves.iter().position(|curve| curve.line >= line).unwrap_or(curves.len());
        let last = curves.iter().rposition(|curve| curve.line <= line).unwrap_or(0);
        let range = first.saturating_sub(steps)..(last + 1 + steps).min(curves.len());
        curves[range].iter().map(|curve| off(curve, at)).fold(f64::INFINITY, f64::min)
    };
    for curve in &blended {
        for at in curve.points.iter().step_by(50) {
            largest = largest.max(near(&sharp, curve.line, *at, 1));
        }
    }
    for curve in &sharp {
        for at in curve.points.iter().step_by(50) {
            largest = largest.max(near(&blended, curve.line, *at, 1));
        }
        if !curve.feed {
            // rapids stay as they are
            assert!(blended.iter().any(|other| other.line == curve.line && other.points == curve.points));
        }
    }
    (blended.len() - sharp.len(), largest)
}

fn blocks(text: &str, set: &[(&str, &str)]) -> Vec<Block> {
    let parameters = parameters(set);
    let mut compiler = Compiler::new(parameters.settings(), Format::Gcode, &parameters.machine().unwrap());
    let mut blocks = Vec::new();
    for line in text.lines() {
        compiler.line(line.as_bytes(), &mut |_, made| blocks.extend_from_slice(made), &mut |found| {
            assert!(!found.is_error(), "{line}: {found}");
        });
    }
    blocks
}

/// Motions that follow each other without a stand.
fn joints(blocks: &[Block]) -> Vec<(Motion, Motion)> {
    let pair = |pair: &[Block]| match (pair[0].work, pair[1].work) {
        (Work::Motion(before), Work::Motion(behind)) => Some((before, behind)),
        _ => None,
    };
    blocks.windows(2).filter_map(pair).collect()
}

fn zigzag(begin: &str) -> String {
    let mut text = format!("{begin}\n");
    for k in 0..20 {
        writeln!(text, "G1 X{} Z{} F3000", k % 2, -3 * k).unwrap();
    }
    // a line into an arc at an angle, arc into arc, arc into a line
    text.push_str("G2 X8 Z-65 R6\nG2 X8 Z-75 R7\nG3 X2 Z-81 R9\nG1 X10\nM30\n");
    text
}

#[test]
fn a_blended_zigzag_takes_less_time_and_no_joint_slows_it() {
    let times: Vec<f64> = ["0", "5", "50", "500"]
        .map(|corner| {
            let run = run(&zigzag(""), &[("corner_um", corner)]).unwrap();
            assert_eq!(run.report.faults.total(), 0, "{:?}", run.report.faults.first());
            run.report.time_s
        })
        .to_vec();
    assert!(times.is_sorted_by(|a, b| a > b), "{times:?}");
    let slowed = |corner: &str| {
        let blocks = blocks(&zigzag(""), &[("corner_um", corner)]);
        joints(&blocks)
            .iter()
            .filter(|(before, behind)| behind.joint < pace(before, Overrides::NONE).min(pace(behind, Overrides::NONE)))
            .count()
    };
    assert_eq!(slowed("0"), 22);
    assert_eq!(slowed("50"), 0);
}

#[test]
fn blended_programs_lie_within_the_tolerance() {
    let sharp = run(&zigzag(""), &[]).unwrap();
    for (um, text) in [("5", "G21"), ("50", "G21"), ("500", "G21"), ("0", "G64 P0.2")] {
        let blended = run(&zigzag(text), &[("corner_um", um)]).unwrap();
        let tolerance = if um == "0" { 0.2 } else { um.parse::<f64>().unwrap() * 1e-3 };
        let (arcs, largest) = compare(&sharp.items, &blended.items);
        // at 5 um the two sharpest corners would need less than three pulses of radius
        assert_eq!(arcs, if um == "5" { 20 } else { 22 }, "{um}");
        assert!(largest <= tolerance + 1e-6, "{largest} mm, {tolerance} allowed");
        assert!(largest > tolerance * 0.5, "{largest} mm of {tolerance}");
    }
}

#[test]
fn modes_hold_for_both_sides_of_a_corner() {
    let count = |text: &str| {
        let blended = run(text, &[]).unwrap();
        blended.items.iter().filter(|item| matches!(item.action, Action::Arc { .. })).count()
    };
    let path = |a: &str, b: &str, between: &str| format!("G21{a}\nG1 X5 F1000\n{between}{b}\nG1 Z-5\nM30\n");
    let g64 = "\nG64 P0.05";
    assert_eq!(count(&path(g64, "", "")), 1);
    assert_eq!(count(&path("", g64, "")), 0);
    assert_eq!(count(&path(g64, "\nG61", "")), 0);
    assert_eq!(count(&path(g64, "\nG61.1", "")), 0);
    // nothing but a comment may stand between
    assert_eq!(count(&path(g64, "", "(here)\n\nN7\nF900\n")), 1);
    for between in ["G4 P0.1\n", "G4 P0\n", "M3\n", "S500\n", "T1\n", "M0\n", "M1\n", "G0 X5.5\n", "G1 X5\n"] {
        assert_eq!(count(&path(g64, "", between)), 0, "{between}");
    }
    // the smaller tolerance of both, and the smaller feed
    let text = "G64 P0.2\nG1 X5 F1000\nG64 P0.05\nG1 Z-5 F500\nM30\n";
    let (sharp, blended) =
        (run(&text.replace("G64 P0.2", "").replace("G64 P0.05", ""), &[]).unwrap(), run(text, &[]).unwrap());
    let (arcs, largest) = compare(&sharp.items, &blended.items);
    assert!(arcs == 1 && largest <= 0.05 && largest > 0.03, "{largest}");
    let feeds: Vec<u64> = blended
        .items
        .iter()
        .filter_map(|item| match item.action {
            Action::Line { feed: Feed::PerMinute(feed), .. } | Action::Arc { feed: Feed::PerMinute(feed), .. } => {
                Some(feed.nm_per_min() / 1_000_000)
            }
            _ => None,
        })
        .collect();
    assert_eq!(feeds, [1000, 500, 500]);
    let lines: Vec<u32> = blended.items.iter().map(|item| item.line).collect();
    assert_eq!(lines, [2, 4, 4, 5]);
}

#[test]
fn an_exact_stop_stands_at_every_corner_and_straight_joint() {
    let text = "G61.1\nG1 X5 F1000\nX10\nG0 Z-5\nG1 X10\nX4\nM30\n";
    let blocks = blocks(text, &[]);
    assert_eq!(joints(&blocks), []);
    assert_eq!(blocks.iter().filter(|block| block.work == Work::Dwell(1)).count(), 4);
    let (stopped, exact) = (run(text, &[]).unwrap(), run(&text.replace("G61.1", "G61"), &[]).unwrap());
    assert_eq!(stopped.report.faults.total(), 0, "{:?}", stopped.report.faults.first());
    assert!(stopped.report.time_s > exact.report.time_s);
    assert_eq!(stopped.report.pulses, exact.report.pulses);
}

#[test]
fn without_a_tolerance_the_corner_is_left_as_far_as_the_feed_needs() {
    let set: &[(&str, &str)] = &[];
    let text = "G64\nG1 X20 F1200\nZ-20\nM30\n";
    let run = run(text, set).unwrap();
    let Action::Arc { end, centre, .. } = run.items[1].action else { panic!("{:?}", run.items) };
    // 20 mm/s and 0.998 of 500 mm/s2
    let radius =
        (f64::from(end.x.nm()) - centre.x.nm() as f64).hypot(f64::from(end.z.nm()) - centre.z.nm() as f64) * 1e-6;
    assert!((radius - 400.0 / 499.0).abs() < 1e-4, "{radius}");
    let blocks = blocks(text, set);
    let motions = joints(&blocks);
    let Pace::PerTick(feed) = motions[0].0.feed else { panic!("a feed") };
    assert!(
        motions.iter().all(|(before, behind)| before.limit.min(behind.limit).min(behind.joint) >= feed - feed / 1000)
    );
    assert_eq!(run.report.faults.total(), 0, "{:?}", run.report.faults.first());
}

/// A step of a random path: by how much, and whether it is an arc (of what radius) or a rapid, a dwell before it.
fn steps() -> impl Strategy<Value = Vec<(f64, f64, f64, u32)>> {
    let far = prop_oneof![-6.0..6.0_f64, -0.2..0.2_f64];
    prop::collection::vec((far.clone(), far, 0.51..4.0_f64, 0_u32..12), 2..14)
}

fn text(steps: &[(f64, f64, f64, u32)], feed: u32) -> String {
    let mut text = format!("G91 F{feed}\n");
    for (x, z, bend, kind) in steps {
        let (x, z) = ((x * 1e3).round() / 1e3, (z * 1e3).round() / 1e3);
        let chord = x.hypot(z);
        let end = format!("X{x:.3} Z{z:.3}");
        match kind {
            0 => writeln!(text, "G0 {end}").unwrap(),
            1 => writeln!(text, "G4 P0.02\nG1 {end}").unwrap(),
            2..=7 if chord > 0.02 => {
                let sign = if kind % 3 == 0 { "-" } else { "" };
                writeln!(text, "G{} {end} R{sign}{:.4}", 2 + kind % 2, chord * bend + 1e-3).unwrap();
            }
            _ => writeln!(text, "G1 {end}").unwrap(),
        }
    }
    text.push_str("M30\n");
    text
}

fn cases(bounded: u32) -> u32 {
    std::env::var("HANDCNC_CASES").ok().and_then(|text| text.parse().ok()).unwrap_or(bounded)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(100), failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn random_programs_are_blended_within_the_tolerance_and_break_no_rule(
        steps in steps(),
        feed in prop::sample::select(vec![100_u32, 1_000, 5_000]),
        um in prop::sample::select(vec!["2", "20", "200", "1000"]),
        coarse: bool,
    ) {
        let text = text(&steps, feed);
        let pulses: &[(&str, &str)] = if coarse { &[("x.pulse_nm", "5000"), ("z.pulse_nm", "10000")] } else { &[] };
        let sharp = run(&text, pulses);
        prop_assume!(sharp.is_ok());
        let set = [pulses, &[("corner_um", um)]].concat();
        let blended = run(&text, &set).map_err(|errors| TestCaseError::fail(format!("{errors:?}\n{text}")))?;
        let (_, largest) = compare(&sharp.unwrap().items, &blended.items);
        // the samples lie on chords of arcs
        prop_assert!(largest <= um.parse::<f64>().unwrap() * 1e-3 + 1e-5, "{largest} mm\n{text}");
        let report = &blended.report;
        prop_assert_eq!(report.faults.total(), 0, "{:?} {:?}\n{}", report.faults.first(), set, text);
        prop_assert!(report.walked.pulses <= 0.5 + 1e-6, "{:?}\n{}", report.walked, text);
        prop_assert!(report.programmed.pulses <= 1.2697, "{:?}\n{}", report.programmed, text);
    }
}
