//! The thinner against brute force, on random walks.
#![allow(clippy::indexing_slicing, reason = "helpers of tests, which may panic")]

use proptest::prelude::{Strategy, any, prop};
use proptest::{prop_assert, proptest};
use virtual_lathe::picture::{Kind, Thinner, Track};

const KINDS: [Kind; 3] = [Kind::Rapid, Kind::Feed, Kind::Arc];

/// Distance of `p` from the segment `a` to `b`.
fn from_segment(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let way = [b[0] - a[0], b[1] - a[1]];
    let square = way[0] * way[0] + way[1] * way[1];
    let along = (p[0] - a[0]) * way[0] + (p[1] - a[1]) * way[1];
    let part = if square > 0.0 { (along / square).clamp(0.0, 1.0) } else { 0.0 };
    (p[0] - a[0] - part * way[0]).hypot(p[1] - a[1] - part * way[1])
}

/// Distance of `p` from the nearest of `tracks`.
fn from_tracks<'a>(p: [f64; 2], tracks: impl Iterator<Item = &'a Track>) -> f64 {
    tracks
        .flat_map(|track| {
            let ends = track.points.iter().skip(1).chain(track.points.last());
            track.points.iter().zip(ends)
        })
        .map(|(a, b)| from_segment(p, *a, *b))
        .fold(f64::INFINITY, f64::min)
}

/// Whether the points, in order, lie within `tolerance` of the line, in order: a stronger claim than being near it
/// somewhere. For each point, keeps the segments it may belong to.
fn follows(points: &[[f64; 2]], line: &[[f64; 2]], tolerance: f64) -> bool {
    let segments: Vec<_> = line.iter().copied().zip(line.iter().skip(1).chain(line.last()).copied()).collect();
    let mut earliest = 0;
    points.iter().all(|p| {
        let next = (earliest..segments.len()).find(|k| from_segment(*p, segments[*k].0, segments[*k].1) <= tolerance);
        earliest = next.unwrap_or(segments.len());
        next.is_some()
    })
}

/// Strides of a random walk: long and short ones, back and forth, and standing still.
fn walk() -> impl Strategy<Value = Vec<([f64; 2], usize)>> {
    let stride = (-1.0..1.0_f64, -1.0..1.0_f64, 0_u32..4, any::<u8>());
    prop::collection::vec(stride, 1..400).prop_map(|strides| {
        let (mut at, mut kind) = ([0.0; 2], 0);
        strides
            .into_iter()
            .map(|(z, x, size, chance)| {
                let length = [0.0, 0.003, 0.05, 2.0][size as usize];
                let [z, x] = if chance % 5 == 0 { [z, 0.0] } else { [z, x] };
                at = [at[0] + z * length, at[1] + x * length];
                if chance % 16 == 0 {
                    kind = (kind + 1) % 3;
                }
                (at, kind)
            })
            .collect()
    })
}

proptest! {
    #[test]
    fn all_positions_stay_within_the_tolerance_of_their_own_kind(walk in walk()) {
        let mut thinner = Thinner::new(0.02, 100_000);
        for (point, kind) in &walk {
            thinner.push(KINDS[*kind], *point);
        }
        let tracks = thinner.tracks();
        prop_assert!((thinner.tolerance() - 0.02).abs() < 1e-12);
        for (point, kind) in walk.iter().skip(1) {
            let own = tracks.iter().filter(|track| track.kind == KINDS[*kind]);
            // A change of kind without motion leaves no track.
            let same = |other: &[f64; 2]| other.map(f64::to_bits) == point.map(f64::to_bits);
            let is_still = walk.iter().filter(|(other, _)| same(other)).count() > 1;
            prop_assert!(is_still || from_tracks(*point, own) <= 0.02);
        }
    }

    #[test]
    fn the_order_of_positions_is_kept(walk in walk()) {
        let mut thinner = Thinner::new(0.02, 100_000);
        for (point, _) in &walk {
            thinner.push(Kind::Feed, *point);
        }
        let tracks = thinner.tracks();
        prop_assert!(tracks.len() == 1);
        let points: Vec<_> = walk.iter().map(|(point, _)| *point).collect();
        prop_assert!(follows(&points, &tracks[0].points, 0.02));
        prop_assert!(tracks[0].points.first() == points.first());
        prop_assert!(tracks[0].points.last() == points.last());
    }

    #[test]
    fn a_full_store_grows_its_tolerance_and_keeps_to_it(walk in walk(), capacity in 16_usize..60) {
        let mut thinner = Thinner::new(0.001, capacity);
        for (point, kind) in &walk {
            thinner.push(KINDS[*kind], *point);
            prop_assert!(thinner.len() <= capacity);
        }
        let tracks = thinner.tracks();
        let kept: usize = tracks.iter().map(|track| track.points.len()).sum();
        prop_assert!(kept == thinner.len());
        for (point, _) in &walk {
            prop_assert!(from_tracks(*point, tracks.iter()) <= thinner.tolerance());
        }
    }
}

#[test]
fn a_million_positions_fit_into_a_thousand() {
    let mut thinner = Thinner::new(0.000_1, 1_000);
    for k in 0..1_000_000_u32 {
        let turned = f64::from(k) * 1e-4;
        let radius = 5.0 + 0.1 * turned;
        let kind = KINDS[(k as usize / 5_000) % 3];
        thinner.push(kind, [radius * turned.cos(), radius * turned.sin()]);
        assert!(thinner.len() <= 1_000);
    }
    assert!(thinner.tolerance() < 0.2, "{}", thinner.tolerance());
}

#[test]
fn a_stroke_out_and_back_keeps_its_far_end() {
    let mut thinner = Thinner::new(0.01, 100);
    for k in (0..=100).chain((50..100).rev()) {
        thinner.push(Kind::Feed, [0.1 * f64::from(k), 0.0]);
    }
    let tracks = thinner.tracks();
    assert_eq!(tracks.len(), 1);
    assert_eq!(tracks[0].points.len(), 3);
    assert!((tracks[0].points[1][0] - 10.0).abs() <= 0.01);
}

#[test]
fn tracks_join_and_a_place_to_stand_takes_the_kind_that_follows() {
    let mut thinner = Thinner::new(0.01, 100);
    thinner.push(Kind::Rapid, [0.0, 5.0]);
    thinner.push(Kind::Rapid, [0.0, 5.0]);
    thinner.push(Kind::Feed, [-10.0, 5.0]);
    thinner.push(Kind::Feed, [f64::NAN, 5.0]);
    thinner.push(Kind::Arc, [-12.0, 7.0]);
    let expected = [(Kind::Feed, vec![[0.0, 5.0], [-10.0, 5.0]]), (Kind::Arc, vec![[-10.0, 5.0], [-12.0, 7.0]])];
    let expected = expected.map(|(kind, points)| Track { kind, points });
    assert_eq!(thinner.tracks(), expected);
}

#[test]
fn nothing_comes_of_nothing() {
    let thinner = Thinner::new(0.0, 0);
    assert!(thinner.is_empty() && thinner.tracks().is_empty());
}
