//! Handwheels and switches: edges over time.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    dead_code,
    unreachable_pub,
    missing_docs,
    reason = "tests, and helpers of tests, which may panic"
)]

mod common;

use common::figures;
use machine::{Handwheel, Switch, WheelEdge};
use proptest::prelude::{any, proptest};

/// Counts that a decoder without a filter makes of edges; `None` if both channels change at once.
fn decoded(edges: &[WheelEdge], begin: (bool, bool)) -> Option<i64> {
    let place = |a: bool, b: bool| match (a, b) {
        (false, false) => 0_i64,
        (true, false) => 1,
        (true, true) => 2,
        (false, true) => 3,
    };
    let (mut at, mut counts) = (place(begin.0, begin.1), 0);
    for edge in edges {
        let next = place(edge.a, edge.b);
        counts += match (next - at).rem_euclid(4) {
            0 => 0,
            1 => 1,
            3 => -1,
            _ => return None,
        };
        at = next;
    }
    Some(counts)
}

#[test]
fn a_clean_wheel_has_four_even_edges_a_detent() {
    let mut wheel = Handwheel::new(&figures(&[])).unwrap();
    let edges = wheel.turn(5, 1_000, 20_000);
    let times: Vec<u64> = edges.iter().map(|edge| edge.time_ns).collect();
    assert_eq!(times, (1..=20).map(|n| 1_000 + n * 1_000).collect::<Vec<u64>>());
    assert_eq!(decoded(&edges, (false, false)), Some(20));
    assert_eq!(wheel.detents(), 100);
}

proptest! {
    #[test]
    fn a_bouncing_wheel_settles_at_the_counts_it_was_turned(
        seed in any::<u32>(), turns in proptest::collection::vec((-12_i32..12, 0_u64..20_000_000), 1..8),
    ) {
        let seed = seed.to_string();
        let set = [("bounce.seed", seed.as_str()), ("handwheel.bounce_us", "500"), ("handwheel.counts", "2")];
        let mut wheel = Handwheel::new(&figures(&set)).unwrap();
        let (mut now, mut levels, mut counts) = (0, (false, false), 0);
        for (by, over) in turns {
            let edges = wheel.turn(by, now, over);
            assert!(edges.windows(2).all(|pair| pair[0].time_ns <= pair[1].time_ns));
            assert!(edges.iter().all(|edge| edge.time_ns >= now && edge.time_ns < now + over + 500_001));
            let seen = decoded(&edges, levels).unwrap();
            levels = edges.last().map_or(levels, |edge| (edge.a, edge.b));
            let true_counts = 2 * i64::from(by);
            counts += true_counts;
            assert_eq!(wheel.counts(), counts);
            assert_eq!((seen - true_counts).rem_euclid(4), 0, "not the right levels at last");
            // where one channel has settled before the other one changes, a decoder needs no filter
            if over / true_counts.unsigned_abs().max(1) > 500_000 {
                assert_eq!(seen, true_counts);
            }
            now += over + 1_000_000;
        }
    }

    #[test]
    fn a_switch_settles_within_its_time_at_the_level_it_was_set_to(seed in any::<u32>(), count in 0_u32..40) {
        let texts = (seed.to_string(), count.to_string());
        let mut switch = Switch::new(&figures(&[("bounce.seed", &texts.0), ("switch.bounces", &texts.1)])).unwrap();
        assert!(switch.set(false, 0).is_empty());
        for (n, closed) in [true, false, true].into_iter().enumerate() {
            let at = n as u64 * 10_000_000;
            let edges = switch.set(closed, at);
            assert_eq!(edges.first().map(|edge| (edge.time_ns, edge.high)), Some((at, closed)));
            assert_eq!(edges.last().map(|edge| edge.high), Some(closed));
            assert!(edges.last().unwrap().time_ns < at + 1_500_000);
            assert!(edges.windows(2).all(|pair| pair[0].time_ns < pair[1].time_ns && pair[0].high != pair[1].high));
            assert!(edges.len() as u32 <= 2 * count + 1);
        }
    }
}

#[test]
fn switches_do_bounce_and_do_it_again_the_same_way() {
    let presses = || {
        let mut switch = Switch::new(&figures(&[])).unwrap();
        (0..20).map(|n| switch.set(n % 2 == 0, n * 10_000_000).len()).collect::<Vec<usize>>()
    };
    let lengths = presses();
    assert_eq!(lengths, presses());
    // 1 to 13 edges, and not always as many
    assert!(lengths.iter().all(|length| length % 2 == 1 && *length <= 13), "{lengths:?}");
    assert!(lengths.iter().max() > lengths.iter().min(), "{lengths:?}");
}
