//! A tool followed through time: collisions, surface, and what never changes whatever is cut.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, missing_docs, reason = "tests")]

mod common;

use common::{BAR, CENTRE, NEUTRAL, Program, SIDE, at, cut, line};
use proptest::prelude::*;
use stock::{
    Bar, BarData, Contour, ContourError, Curve, Cutting, Jaws, Kind, Motion, Part, Point, Setup, Tool, ToolData,
    ToolError, Touched,
};

/// Turns to radius 14 and to 12 over 20 mm, with rapids between.
fn two_passes() -> Program {
    let pass = |x: f64| (Kind::Feed, vec![at(2.0, x), at(-20.0, x), at(-20.0, x + 1.0)]);
    let back = |x: f64, next: f64| (Kind::Rapid, vec![at(2.0, x + 1.0), at(2.0, next)]);
    Program {
        bar: BAR,
        tool: SIDE,
        moves: vec![(Kind::Rapid, vec![at(5.0, 20.0), at(2.0, 14.0)]), pass(14.0), back(14.0, 12.0), pass(12.0)],
        curves: vec![line(at(2.0, 14.0), at(-20.0, 14.0)), line(at(2.0, 12.0), at(-20.0, 12.0))],
    }
}

#[test]
fn a_good_program_touches_nothing_and_is_exact() {
    let outcome = two_passes().run();
    assert_eq!(outcome.collisions, []);
    let surface = outcome.surface.unwrap();
    assert!(surface.max_um < 1e-3, "{surface:?}");
    let total = std::f64::consts::PI * 256.0 * 60.0;
    assert!((outcome.removed_mm3 + outcome.left_mm3 - total).abs() < 1e-6);
}

#[test]
fn a_rapid_through_stock_is_found_and_only_there() {
    let mut program = two_passes();
    // comes down in front of the face, then behind it
    program.moves[0].1 = vec![at(-5.0, 20.0), at(-5.0, 15.5)];
    let outcome = program.run();
    let [plunge] = outcome.collisions[..] else { panic!("{:?}", outcome.collisions) };
    assert_eq!((plunge.touched, plunge.line, plunge.time_ns), (Touched::Rapid, 1, 1_000_000));
    assert!((plunge.depth - 0.5).abs() < 1e-5, "{plunge:?}");
    assert!((plunge.place.z - -4.6).abs() < 0.5 && (plunge.place.x - 16.0).abs() < 1e-9);
}

#[test]
fn a_rapid_along_a_finished_surface_is_no_collision() {
    let mut program = two_passes();
    program.moves.push((Kind::Rapid, vec![at(-10.0, 12.0), at(2.0, 12.0)]));
    assert_eq!(program.run().collisions, []);
    // nor is one that grazes it by less than a pulse
    program.moves.push((Kind::Rapid, vec![at(2.0, 11.999), at(-10.0, 11.999)]));
    assert_eq!(program.run().collisions, []);
    program.moves.push((Kind::Rapid, vec![at(2.0, 11.99), at(-10.0, 11.99)]));
    assert!(program.run().collisions.iter().any(|found| found.touched == Touched::Rapid));
}

#[test]
fn a_rapid_that_grazes_a_wall_by_less_than_a_pulse_is_no_collision() {
    let graze = |beyond: f64| {
        let mut program = two_passes();
        program.moves.push((Kind::Feed, vec![at(-20.0, 12.0), at(-20.0, 17.0)]));
        let down = vec![at(-20.0 - beyond, 17.0), at(-20.0 - beyond, 12.4)];
        program.moves.push((Kind::Rapid, down));
        program.run().collisions
    };
    // deep along X, in a single column
    assert_eq!(graze(0.002_4), []);
    assert_eq!(graze(0.02).first().map(|first| (first.touched, first.line)), Some((Touched::Rapid, 6)));
}

#[test]
fn the_surface_error_is_what_the_machine_erred() {
    for off in [0.001, -0.001, 0.25, -0.25] {
        let outcome = two_passes().run_with(|place| at(place.z, place.x + off));
        let surface = outcome.surface.unwrap();
        let within = if off > NEAR { 0.01 } else { 1e-3 };
        assert!((surface.max_um - off.abs() * 1e3).abs() < within, "{off}: {surface:?}");
        assert!((surface.mean_um - off.abs() * 1e3).abs() < within, "{off}: {surface:?}");
    }
}

/// Material that stands higher than this is measured on the bar's columns.
const NEAR: f64 = 0.02;

#[test]
fn a_cut_on_the_far_side_of_the_work_leaves_a_wall_alone() {
    // a shoulder, then a groove behind it: the normals of the shoulder go through the work into the groove
    let shoulder = [at(2.0, 12.0), at(-10.0, 12.0), at(-10.0, 17.0)];
    let groove = [at(-30.0, 17.0), at(-30.0, 13.0), at(-30.0, 17.0)];
    let curves = [shoulder, groove].map(|ends| [line(ends[0], ends[1]), line(ends[1], ends[2])]).concat();
    let moves = [(Kind::Rapid, vec![at(2.0, 20.0)]), (Kind::Feed, shoulder.to_vec()), (Kind::Rapid, vec![groove[0]])];
    let moves = moves.into_iter().chain([(Kind::Feed, groove.to_vec())]).collect();
    let tool = ToolData { tip: 3, ..CENTRE };
    let outcome = Program { bar: BAR, tool, moves, curves }.run();
    let on_shoulder = |sample: &&stock::Sample| sample.normal.z < -0.9 && (sample.place.z + 10.0).abs() < 0.1;
    assert!(outcome.contour.samples().iter().filter(on_shoulder).count() > 300);
    assert_eq!(outcome.collisions, []);
    assert!(outcome.surface.unwrap().max_um < 1e-3);
}

#[test]
fn the_error_of_a_slope_is_measured_across_it() {
    let slope = 30.0_f64.to_radians();
    let ends = [at(1.0, 5.0), at(-15.0, 5.0 + 16.0 * slope.tan())];
    let program = Program {
        bar: BAR,
        tool: SIDE,
        moves: vec![(Kind::Rapid, vec![at(1.0, 20.0), ends[0]]), (Kind::Feed, vec![ends[1]])],
        curves: vec![line(ends[0], ends[1])],
    };
    let surface = program.run_with(|place| at(place.z, place.x - 0.002)).surface.unwrap();
    assert!((surface.max_um - 2.0 * slope.cos()).abs() < 1e-3, "{surface:?}");
}

#[test]
fn a_cut_below_the_contour_is_told_with_its_depth() {
    let mut program = two_passes();
    program.moves.push((Kind::Feed, vec![at(-10.0, 13.0), at(-10.0, 11.9), at(-10.0, 13.0)]));
    let collisions = program.run().collisions;
    assert_eq!(collisions.len(), 1, "{collisions:?}");
    let deep = collisions[0];
    assert_eq!((deep.touched, deep.line), (Touched::Deep, 5));
    assert!((deep.depth - 0.1).abs() < 1e-3, "{deep:?}");
}

#[test]
fn the_back_edge_in_the_work_is_told() {
    // down a slope of 30 degrees behind a finished cylinder: the back edge of 5 degrees cuts the cylinder
    let ends = [at(2.0, 15.0), at(-20.0, 15.0), at(-26.0, 15.0 - 6.0 * 0.577)];
    let program = Program {
        bar: BAR,
        tool: SIDE,
        moves: vec![(Kind::Rapid, vec![at(2.0, 20.0), ends[0]]), (Kind::Feed, vec![ends[1], ends[2]])],
        curves: vec![line(ends[0], ends[1])],
    };
    let collisions = program.run().collisions;
    assert!(collisions.iter().any(|found| found.touched == Touched::Edge(Part::Back)), "{collisions:?}");
}

#[test]
fn the_holder_is_what_lies_beyond_the_edges() {
    let plunge = |depth: f64| Program {
        bar: BAR,
        tool: ToolData { edge: 6.0, ..NEUTRAL },
        moves: vec![(Kind::Rapid, vec![at(-30.0, 20.0)]), (Kind::Feed, vec![at(-30.0, 16.0 - depth)])],
        curves: Vec::new(),
    };
    assert_eq!(plunge(5.0).run().collisions, []);
    let collisions = plunge(8.0).run().collisions;
    assert_eq!(collisions.iter().map(|found| found.touched).collect::<Vec<_>>(), [Touched::Holder]);
}

#[test]
fn the_chuck_is_watched() {
    let tool = Tool::new(SIDE).unwrap();
    let mut cutting = Cutting::new(Setup {
        bar: BAR,
        tool,
        jaws: Some(Jaws { z: -40.0, radius: 40.0 }),
        contour: Contour::default(),
        tolerance: 0.0025,
    });
    for (time_ns, z) in [(0, 5), (1, -40), (2, -43), (3, 5)] {
        let [x_nm, z_nm] = [20, z].map(|mm| f64::from(mm) * 1e6);
        cutting.follow(Motion { time_ns, x_nm, z_nm, kind: Kind::Feed, line: 9 });
    }
    let collisions = cutting.finish().collisions;
    assert_eq!(collisions.len(), 1);
    assert_eq!((collisions[0].touched, collisions[0].line, collisions[0].time_ns), (Touched::Chuck, 9, 2));
    assert!((collisions[0].depth - 3.0).abs() < 1e-9, "{collisions:?}");
}

#[test]
fn air_is_no_cutting() {
    let mut program = two_passes();
    let first = program.run().cutting_ns;
    // one millisecond per place: two passes of one cutting move each, the approach being air
    program.moves.push((Kind::Rapid, vec![at(-19.0, 20.0)]));
    program.moves.push((Kind::Feed, vec![at(2.0, 20.0), at(2.0, 12.0), at(-20.0, 12.0)]));
    assert_eq!(program.run().cutting_ns, first);
    assert!(first >= 2_000_000);
}

#[test]
fn tools_that_are_none_are_refused_by_name() {
    for (data, error) in [
        (ToolData { nose: -0.4, ..SIDE }, ToolError::Nose(-0.4)),
        (ToolData { tip: 0, ..SIDE }, ToolError::Tip(0)),
        (ToolData { tip: 10, ..SIDE }, ToolError::Tip(10)),
        (ToolData { front: 5.0, ..SIDE }, ToolError::Wedge { front: 5.0, back: 5.0 }),
        (ToolData { front: 190.0, ..SIDE }, ToolError::Wedge { front: 190.0, back: 5.0 }),
        (ToolData { edge: 0.4, ..SIDE }, ToolError::Edge { edge: 0.4, nose: 0.4 }),
    ] {
        assert_eq!(Tool::new(data), Err(error));
    }
    assert!(matches!(Tool::new(ToolData { nose: f64::NAN, ..SIDE }), Err(ToolError::Nose(_))));
}

fn errors(curves: &[Curve], tool: ToolData, bar: BarData) -> Vec<ContourError> {
    Contour::new(curves, &Tool::new(tool).unwrap(), bar).errors().to_vec()
}

#[test]
fn a_bar_smaller_than_the_part_is_an_error() {
    let found = errors(&[line(at(2.0, 17.0), at(-20.0, 17.0))], SIDE, BAR);
    assert_eq!(found, [ContourError::TooThin { line: 1, needed: 34.0, diameter: 32.0 }]);
    let found = errors(&[line(at(2.0, 12.0), at(-50.0, 12.0)), line(at(-65.0, 12.0), at(-70.0, 12.0))], SIDE, BAR);
    assert!(
        matches!(found[..], [ContourError::TooShort { line: 1, needed, .. }] if (needed - -69.6).abs() < 1e-6),
        "{found:?}"
    );
    let tube = BarData { bore: 12.0, ..BAR };
    let found = errors(&[line(at(2.0, 5.0), at(-20.0, 5.0))], ToolData { tip: 2, ..SIDE }, tube);
    assert_eq!(found, [ContourError::TooHollow { line: 1, needed: 10.0, bore: 24.0 }]);
}

#[test]
fn a_pass_in_the_air_above_the_part_is_no_error() {
    let passes = [line(at(2.0, 17.0), at(-20.0, 17.0)), line(at(2.0, 15.0), at(-21.0, 15.0))];
    assert_eq!(errors(&passes, SIDE, BAR), []);
}

#[test]
fn a_contour_that_runs_out_of_the_bar_is_told_and_no_error() {
    let tool = Tool::new(SIDE).unwrap();
    let contour = Contour::new(&[line(at(2.0, 12.0), at(-30.0, 18.0))], &tool, BAR);
    assert_eq!(contour.errors(), []);
    assert!(contour.leaves().is_some());
    let contour = Contour::new(&[line(at(2.0, 12.0), at(-30.0, 12.0))], &tool, BAR);
    assert_eq!(contour.leaves(), None);
}

#[test]
fn a_slope_behind_the_back_edge_can_not_be_reached() {
    let falling = |degrees: f64| line(at(-10.0, 15.0), at(-15.0, 15.0 - 5.0 * degrees.to_radians().tan()));
    assert_eq!(errors(&[falling(4.9)], SIDE, BAR), []);
    let found = errors(&[falling(6.0)], SIDE, BAR);
    let [ContourError::Unreachable { line: 1, slope, part: Part::Back }] = found[..] else { panic!("{found:?}") };
    assert!((slope - 6.0).abs() < 1e-9);
    // the tool of 52 degrees reaches a ball from its pole to 52 degrees behind its equator, and no farther
    let ball = |degrees: f64| Curve {
        line: 1,
        from: at(0.4, 0.0),
        to: at(-12.0, 0.0) + Point::at_degrees(90.0 + degrees) * 12.4,
        arc: Some((at(-12.0, 0.0), false)),
    };
    assert_eq!(errors(&[ball(51.0)], CENTRE, BAR), []);
    assert_eq!(errors(&[ball(54.0)], CENTRE, BAR).len(), 1);
}

/// Places of a random polyline near the bar.
fn paths() -> impl Strategy<Value = Vec<Point>> {
    prop::collection::vec((-70.0..5.0_f64, 4.0..18.0_f64).prop_map(|(z, x)| at(z, x)), 2..6)
}

fn tools() -> impl Strategy<Value = ToolData> {
    (0.0..1.2_f64, 1..=9_u8, 60.0..130.0_f64, 0.0..55.0_f64).prop_map(|(nose, tip, front, back)| ToolData {
        nose,
        tip,
        front,
        back,
        edge: 11.0,
    })
}

/// Material of every column, as one list of ends.
fn ends(bar: &Bar) -> Vec<Vec<[f64; 2]>> {
    // stretches thinner than rounding come and go
    let solid = |stretch: &&[f64; 2]| stretch[1] - stretch[0] > 1e-9;
    (0..bar.len()).map(|column| bar.material(column).iter().filter(solid).copied().collect()).collect()
}

fn is_same(a: &Bar, b: &Bar) -> bool {
    ends(a).iter().zip(&ends(b)).all(|(a, b)| {
        a.len() == b.len() && a.iter().flatten().zip(b.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-9)
    })
}

/// A short bar.
const STUB: BarData = BarData { radius: 2.0, bore: 0.0, back: -2.0, face: 0.0 };

/// A walk in steps of 4 um through places near the stub, from a place clear of it.
fn walk(places: &[Point]) -> Vec<Point> {
    let mut all = vec![at(3.0, 6.0)];
    for &place in places {
        let from = all[all.len() - 1];
        let count = ((place - from).length() / 0.004).ceil().max(1.0);
        let mut step = 0.0;
        while step < count {
            step += 1.0;
            all.push(from + (place - from) * (step / count));
        }
    }
    all
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn pulse_by_pulse_the_same_is_left_as_move_by_move(
        front in 80.0..120.0_f64,
        back in 0.0..55.0_f64,
        tip in 1..=9_u8,
        places in prop::collection::vec((-2.5..0.8_f64, 0.6..3.0_f64).prop_map(|(z, x)| at(z, x)), 2..5),
    ) {
        // following skips the side of the tool that does not move into the work
        let data = ToolData { nose: 0.4, tip, front, back, edge: 11.0 };
        let places = walk(&places);
        let tool = Tool::new(data).unwrap();
        let contour = Contour::default();
        let mut cutting = Cutting::new(Setup { bar: STUB, tool, jaws: None, contour, tolerance: 0.0025 });
        for (place, time_ns) in places.iter().zip(0..) {
            cutting.follow(Motion { time_ns, x_nm: place.x * 1e6, z_nm: place.z * 1e6, kind: Kind::Feed, line: 1 });
        }
        let whole = cut(STUB, data, &places);
        let (a, b) = (ends(&cutting.finish().bar), ends(&whole));
        let is_clear = !Bar::new(STUB).meets(&stock::Sweep::new(&tool, tool.centre(places[0]), tool.centre(places[0])));
        for (a, b) in a.iter().zip(&b).filter(|_| is_clear) {
            prop_assert_eq!(a.len(), b.len(), "{:?} {:?}", a, b);
            for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
                prop_assert!((a - b).abs() < 1e-9, "{} {}", a, b);
            }
        }
    }

    #[test]
    fn stock_never_grows(tool in tools(), path in paths(), more in paths()) {
        let before = cut(BAR, tool, &path);
        let mut places = path;
        let last = places.len();
        places.extend(more);
        let after = cut(BAR, tool, &places);
        prop_assert!(last > 0);
        prop_assert!(after.volume() <= before.volume() + 1e-9);
        for column in 0..before.len() {
            for [low, high] in after.material(column) {
                let holds = before.material(column).iter().any(|[a, b]| a <= low && high <= b);
                prop_assert!(holds, "{low}..{high} is new");
            }
        }
    }

    #[test]
    fn cutting_twice_changes_nothing(tool in tools(), path in paths()) {
        let once = cut(BAR, tool, &path);
        let mut twice = path.clone();
        twice.extend(path.iter().rev().skip(1));
        prop_assert!(is_same(&once, &cut(BAR, tool, &twice)));
    }

    #[test]
    fn the_order_of_cuts_does_not_matter(tool in tools(), path in paths(), other in paths()) {
        let both = |first: &[Point], second: &[Point]| {
            let checked = Tool::new(tool).unwrap();
            let mut bar = Bar::new(BAR);
            for places in [first, second] {
                for (from, to) in places.iter().zip(places.iter().skip(1)) {
                    bar.cut(&stock::Sweep::new(&checked, checked.centre(*from), checked.centre(*to)), |_| {});
                }
            }
            bar
        };
        prop_assert!(is_same(&both(&path, &other), &both(&other, &path)));
    }
}
