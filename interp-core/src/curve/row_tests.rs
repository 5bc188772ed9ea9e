//! Rows of an arc against its single steps, and the figures of narrow rows against 32 bits.

use super::Walker;
use super::arc_walker::ArcWalker;
use super::line::Line;
use super::prepare_arc::{Metric, Prepared, Reach};
use super::strides::{Turned, Turns};
use crate::units::{Lattice, PulseSize, Sense};
use proptest::prelude::*;

/// Asks for so many steps, and compares what the row says of them; the diagonal ones.
fn ask(row: &mut impl Turns, count: u32) -> u32 {
    let (mut turned, asked) = (Turned::default(), count.min(2047));
    for number in 0..asked {
        if row.turns() {
            turned = Turned { count: turned.count + 1, last: number };
        }
    }
    let said = row.turned(asked);
    assert_eq!(said.count, turned.count);
    assert!(turned.count == 0 || said == turned, "{said:?} {turned:?}");
    turned.count + (asked..count).map(|_| u32::from(row.turns())).sum::<u32>()
}

/// One row of at most `most` steps, in the width that the walker says.
fn row(walker: &mut ArcWalker, most: u32) -> u32 {
    let count = walker.left_in_row().min(most);
    let narrow = walker.is_narrow();
    if count > 0 && narrow {
        walker.row::<i32>(|row| (count, ask(row, count)));
    } else if count > 0 {
        walker.row::<i64>(|row| (count, ask(row, count)));
    }
    count
}

/// Walks an arc both ways at once, and looks at the figures.
fn compare(sizes: [(u32, u32); 2], end: Lattice, centre: (i64, i64), sense: Sense, reach: Reach, most: u32) {
    let [x, z] = sizes.map(|(numerator, denominator)| PulseSize::new(numerator, denominator).unwrap());
    let Prepared::Arc(arc, _) = Metric::new(x, z).arc(Lattice::default(), end, centre, sense, reach) else {
        return;
    };
    let (mut single, mut rows) = (arc.walk(), arc.walk());
    loop {
        let count = row(&mut rows, most);
        let made = if count > 0 { count } else { u32::from(rows.next_step().is_some()) };
        if made == 0 {
            break;
        }
        let (straight, mut diagonal) = (single.straight(made), None);
        for number in 0..made {
            let narrow = single.is_narrow();
            let step = single.next_step().unwrap();
            diagonal = diagonal.or((step.x != 0 && step.z != 0).then_some(number));
            assert!(!narrow || single.fits(i64::from(i32::MAX)), "{single:?}");
        }
        assert!(count == 0 || straight == diagonal.unwrap_or(made));
        assert_eq!(single, rows);
    }
    assert_eq!((single.next_step(), single.position()), (None, (end.x, end.z)));
    let (mut all, mut single) = (arc.walk(), arc.walk());
    assert!(most.is_multiple_of(2) || all.next_step() == single.next_step());
    all.each_step(|step| assert_eq!(Some(step), single.next_step()));
    assert_eq!((all, single.next_step()), (single, None));
}

proptest! {
    /// Any arcs; nearly all of them are too large for 32 bits.
    #[test]
    fn rows_lead_where_single_steps_lead(
        sizes in prop_oneof![
            Just([(1000, 1), (1000, 1)]), Just([(1250, 1), (2500, 1)]), Just([(15_875, 8), (25_400, 20)]),
            Just([(10, 1), (1280, 1)]), Just([(1_000_000, 1), (31_250, 4)]), Just([(10, 1), (10, 1)]),
        ],
        ends in [-20_000_i32..20_000, -20_000_i32..20_000], finer in 0_u32..12, tilt in [-3_i64..=3, -3_i64..=3],
        far in -400_i64..400, clockwise in any::<bool>(), long in any::<bool>(), most in 1_u32..4000,
    ) {
        let end = Lattice { x: ends[0] >> finer, z: ends[1] >> finer };
        let place = |(numerator, denominator): (u32, u32), at: i32| i64::from(at) * i64::from(numerator) / i64::from(denominator);
        let (ex, ez) = (place(sizes[0], end.x), place(sizes[1], end.z));
        // near the bisector, any distance from the chord
        let centre = (ex / 2 - ez * far / 100 + tilt[0], ez / 2 + ex * far / 100 + tilt[1]);
        let sense = if clockwise { Sense::Clockwise } else { Sense::CounterClockwise };
        compare(sizes, end, centre, sense, if long { Reach::Long } else { Reach::Short }, most);
    }

    /// Arcs through mirrored points about a lattice point have the smallest coefficients: the squares of the sizes'
    /// ratio. Their figures come to lie on both sides of what 32 bits hold.
    #[test]
    fn narrow_rows_lead_where_single_steps_lead(
        sizes in [1000_u32..1600, 1000_u32..1600], centre in [-60_000_i32..60_000, -60_000_i32..60_000],
        finer in 0_u32..14, mirror in [any::<bool>(), any::<bool>()], clockwise in any::<bool>(), most in 1_u32..4000,
    ) {
        let [x, z] = centre.map(|at| at >> finer);
        let end = Lattice { x: if mirror[0] { 2 * x } else { 0 }, z: if mirror[1] { 2 * z } else { 0 } };
        let at = (i64::from(x) * i64::from(sizes[0]), i64::from(z) * i64::from(sizes[1]));
        let sense = if clockwise { Sense::Clockwise } else { Sense::CounterClockwise };
        let sizes = sizes.map(|size| (size, 1));
        compare(sizes, end, at, sense, Reach::Long, most);
        compare(sizes, end, at, sense, Reach::Short, most);
    }

    /// What a line's row says of itself.
    #[test]
    fn a_line_s_row_tells_what_turned(x in -3000_i32..3000, z in -3000_i32..3000, most in 1_u32..400) {
        let Some(line) = Line::new(x, z) else { return Ok(()) };
        let mut walker = line.walk();
        while walker.left() > 0 {
            let count = walker.left().min(most);
            let (mut single, straight) = (walker, walker.straight(count));
            let diagonal = (0..count).find(|_| single.next_step().is_some_and(|step| step.x != 0 && step.z != 0));
            assert_eq!(straight, diagonal.unwrap_or(count));
            walker.row(|row| {
                ask(row, count);
                count
            });
        }
    }
}
