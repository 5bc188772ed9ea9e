//! Shoulders: a path driven by the wheel ends at the first place where an axis would pass a coordinate, in either sense.
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

use interp_core::block::shoulder::{Shoulder, free};
use interp_core::block::{Block, Builder, Curve, Motion, Pace, Path, Work};
use interp_core::channel::{Channel, Pull};
use interp_core::config::{AxisConfig, Config, Machine};
use interp_core::curve::method::Method;
use interp_core::curve::{Step, Walker};
use interp_core::drive::Drive;
use interp_core::drive::wheel::Click;
use interp_core::law::SpeedLaw;
use interp_core::train::Event;
use interp_core::units::{Axis, Feedrate, Lattice, Length, Point, PulseSize, Sense};
use proptest::prelude::*;

fn machine(x: u32, z: u32, law: SpeedLaw) -> Machine {
    let axis = |nm: u32| AxisConfig {
        pulse: PulseSize::new(nm, 1).unwrap(),
        max_feed: Feedrate::from_nm_per_min(3_000_000_000).unwrap(),
        max_accel: 400_000,
        max_jump: 2_000,
        pulse_width_ns: 5_000,
        dir_setup_ns: 5_000,
        dir_hold_ns: 10_000,
        min_space_ns: 5_000,
    };
    let config = Config { x: axis(x), z: axis(z), event_min_ns: 2_000 };
    config.check().unwrap().with_hands().with_law(law, 50_000).unwrap()
}

fn point(x: i64, z: i64) -> Point {
    Point { x: Length::from_nm(x).unwrap(), z: Length::from_nm(z).unwrap() }
}

/// A curve from (0, 0): a line to an end, or an arc round a centre over an angle; um and degrees.
#[derive(Clone, Debug)]
enum Piece {
    Line(i32, i32),
    Arc(i32, i32, i32),
}

fn motions(machine: &Machine, piece: &Piece) -> Vec<Motion> {
    let nm = |um: i32| i64::from(um) * 1_000;
    let (path, end) = match *piece {
        Piece::Line(x, z) => (Path::Line, point(nm(x), nm(z))),
        Piece::Arc(x, z, degrees) => {
            let (sine, cosine) = f64::from(degrees).to_radians().sin_cos();
            let (x, z) = (f64::from(x) * 1e3, f64::from(z) * 1e3);
            // a positive angle turns from Z to X
            let end = (x - x * cosine - z * sine, z + x * sine - z * cosine);
            let sense = if degrees > 0 { Sense::CounterClockwise } else { Sense::Clockwise };
            #[allow(clippy::cast_possible_truncation, reason = "a sample")]
            (Path::Arc { centre: (x as i64, z as i64), sense }, point(end.0.round() as i64, end.1.round() as i64))
        }
    };
    Builder::new(machine, point(0, 0)).motion(path, end, Pace::Rapid).motions.to_vec()
}

/// All lattice points of motions, in order.
fn enumerated(motions: &[Motion]) -> Vec<Lattice> {
    let mut at = Lattice { x: 0, z: 0 };
    let mut all = vec![at];
    for motion in motions {
        let mut take = |step: Step| {
            at = Lattice { x: at.x + i32::from(step.x), z: at.z + i32::from(step.z) };
            all.push(at);
        };
        match &motion.curve {
            Curve::Line(line, _) => line.walk().each_step(&mut take),
            Curve::Arc(arc) => arc.walk().each_step(&mut take),
            #[cfg(feature = "methods")]
            _ => unreachable!(),
        }
    }
    all
}

/// A channel whose wheel drives motions.
struct Bench {
    channel: Channel<16>,
    blocks: Vec<Block>,
}

impl Bench {
    fn new(machine: &Machine, motions: &[Motion]) -> Self {
        let mut channel = Channel::<16>::new(machine, Lattice { x: 0, z: 0 });
        channel.set_drive(Drive::Wheel(Click::from_nm(100_000).unwrap())).unwrap();
        channel.start();
        channel.close();
        let blocks = motions.iter().rev().map(|motion| Block { line: 1, work: Work::Motion(*motion) }).collect();
        let mut bench = Self { channel, blocks };
        bench.ticks(60, None, |_| {});
        bench
    }

    /// Pulls for so many ticks.
    fn ticks(&mut self, ticks: u32, pull: Option<Pull>, mut look: impl FnMut(Lattice)) {
        for _ in 0..ticks {
            self.channel.pull(pull);
            let blocks = &mut self.blocks;
            self.channel.tick(&mut || blocks.pop(), &mut |_: Event| {});
            look(self.channel.position());
        }
    }

    /// Pulls until it stands, and for some ticks more: within a few nm of an end it may stand for a tick first.
    fn lead_on(&mut self, back: bool, mut look: impl FnMut(Lattice)) {
        let (mut stood, mut ticks) = (0, 0);
        while stood < 10 {
            self.ticks(1, Some(Pull { back, speed: u32::MAX }), &mut look);
            stood = if self.channel.speed() == 0 { stood + 1 } else { 0 };
            ticks += 1;
            assert!(ticks < 100_000, "never stands");
        }
    }
}

fn part(at: Lattice, axis: Axis) -> i32 {
    if axis == Axis::X { at.x } else { at.z }
}

fn pieces() -> impl Strategy<Value = Piece> {
    let far = || prop_oneof![-3_000..3_000_i32, -60..60_i32];
    prop_oneof![
        (far(), far()).prop_map(|(x, z)| Piece::Line(x, z)),
        (far(), far(), prop_oneof![-360..360_i32, Just(360)]).prop_map(|(x, z, degrees)| Piece::Arc(x, z, degrees)),
    ]
}

/// Where the tool is first, along the path; which axis, and how far from there the shoulder is; the sense.
type Case = (f64, bool, i32, bool);

fn cases() -> impl Strategy<Value = Case> {
    (0.0..1.0, any::<bool>(), prop_oneof![-2_000..2_000_i32, -8..8_i32, Just(0)], any::<bool>())
}

/// A tool led to a place on the path stands; then a shoulder, `by` pulses from it, is set and it is led on to the end. Returns the
/// places where it was and is, the shoulder in the path's pulses, and whether the path ends there.
fn led(machine: &Machine, motions: &[Motion], case: Case) -> Result<(Lattice, Lattice, Shoulder, bool), TestCaseError> {
    let (share, x, by, back) = case;
    let axis = if x { Axis::X } else { Axis::Z };
    let length: u64 = motions.iter().map(|motion| motion.length).sum();
    let mut bench = Bench::new(machine, motions);
    #[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "a sample")]
    bench.channel.set_ends(0, (length as f64 * share) as i64);
    bench.lead_on(false, |_| {});
    let from = bench.channel.position();
    let plus = by > 0 || by == 0 && back;
    let shoulder = Shoulder { axis, at: part(from, axis) + by, plus };
    let at = u64::try_from(bench.channel.along()).unwrap();
    let (least, most) = free(motions.iter(), at, shoulder);
    prop_assert!(least <= at && at <= most && most <= length, "{least} {at} {most} {length}");
    bench.channel.set_ends(least.cast_signed(), most.cast_signed());
    let mut passed = None;
    bench.lead_on(back, |at| {
        let off = part(at, axis) - shoulder.at;
        if if plus { off > 0 } else { off < 0 } {
            passed.get_or_insert(at);
        }
    });
    prop_assert_eq!(passed, None, "{:?}", shoulder);
    // the last nm may be too little for an arc's braking to be told from none
    let off = |end: u64| bench.channel.along().abs_diff(end.cast_signed());
    let end = if back { least } else { most };
    prop_assert!(off(end) < 1 << 12, "{} {}", bench.channel.along(), end);
    let ends = off(if back { 0 } else { length }) < 1 << 12;
    Ok((from, bench.channel.position(), shoulder, ends))
}

/// How many pulses a circle leads beyond a shoulder, but for the rounding of its ends.
fn touches(piece: &Piece, shoulder: Shoulder, pulses: (u32, u32)) -> f64 {
    let Piece::Arc(x, z, _) = piece else { return 0.0 };
    let radius = f64::from(*x).hypot(f64::from(*z));
    let (centre, pulse) = if shoulder.axis == Axis::X { (*x, pulses.0) } else { (*z, pulses.1) };
    let side = if shoulder.plus { 1.0 } else { -1.0 };
    side * ((f64::from(centre) + side * radius) * 1e3 / f64::from(pulse) - f64::from(shoulder.at))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3_000))]

    #[test]
    fn travel_ends_on_the_coordinate_that_would_be_passed_first(
        piece in pieces(), case in cases(), pulses in prop::sample::select(vec![(1250, 2500), (1000, 1000), (2500, 800)]),
        smooth: bool
    ) {
        let machine = machine(pulses.0, pulses.1, if smooth { SpeedLaw::Sine } else { SpeedLaw::Linear });
        let motions = motions(&machine, &piece);
        prop_assume!(!motions.is_empty());
        let (from, to, shoulder, ends) = led(&machine, &motions, case)?;
        let mut points = enumerated(&motions);
        // the way from where it was; a full circle passes no point twice but its start
        let first = points.iter().position(|at| *at == from).unwrap();
        let way = if case.3 {
            points.truncate(first + 1);
            points.reverse();
            points
        } else {
            points.split_off(first)
        };
        let way_length = way.len();
        let mut way = way.into_iter();
        let beyond = |at: Lattice| {
            let off = part(at, shoulder.axis) - shoulder.at;
            if shoulder.plus { off > 0 } else { off < 0 }
        };
        // the end of a full circle is its start
        if !ends {
            prop_assert!(way.by_ref().any(|at| at == to), "{to:?} is not on the way");
        }
        // what follows passes it, and until then the axis stays on the coordinate, or as near as small arcs and slopes of one
        // allow; or there is nothing more
        let short = match piece {
            Piece::Line(..) => 0,
            Piece::Arc(x, z, _) if f64::from(x).hypot(f64::from(z)) > 160.0 => 1,
            Piece::Arc(..) => 2,
        };
        let near = |at: Lattice| (part(at, shoulder.axis) - shoulder.at).abs() <= short;
        let rest: Vec<Lattice> = way.take_while(|at| !beyond(*at)).collect();
        if ends {
            prop_assert_eq!(rest.len(), way_length, "{:?} {:?}", to, shoulder);
            return Ok(());
        }
        let off = rest.iter().find(|at| !near(**at)).copied();
        // a curve that leads half a pulse beyond, at its extreme, may end on the shoulder or not
        let past = touches(&piece, shoulder, pulses);
        prop_assert!(near(to) && off.is_none() || (-2.0..1.5).contains(&past), "{:?} {:?} {:?}", to, shoulder, off);
    }

    #[test]
    fn no_classic_method_passes_a_shoulder(piece in pieces(), case in cases(), method in prop::sample::select(Method::ALL.to_vec())) {
        let mut machine = machine(1250, 2500, SpeedLaw::Linear);
        machine.method = method;
        let motions = motions(&machine, &piece);
        prop_assume!(!motions.is_empty());
        // that it is not passed is looked at on the way
        let (_, to, shoulder, ends) = led(&machine, &motions, case)?;
        let short = (shoulder.at - part(to, shoulder.axis)).abs();
        prop_assert!(ends || short <= 4, "{:?} {:?}", to, shoulder);
    }
}

/// Found by chance: the tool stands on the coordinate, and the curve itself is up to a pulse beyond it, going out or coming in.
#[test]
fn a_tool_on_the_coordinate_may_leave_it_and_not_pass_it() {
    for (piece, case, pulses, moves) in [
        (Piece::Arc(800, -1445, 86), (0.627_386_822_675_041_4, false, 0, false), 1000, false),
        (Piece::Arc(-30, 14, 340), (0.458_877_321_870_138_9, false, 0, true), 1250, true),
    ] {
        let machine = machine(pulses, if pulses == 1000 { 1000 } else { 2500 }, SpeedLaw::Linear);
        let (from, to, ..) = led(&machine, &motions(&machine, &piece), case).unwrap();
        assert_eq!(from != to, moves, "{piece:?}");
    }
}
