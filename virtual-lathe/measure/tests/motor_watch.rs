//! The watch without a program: it agrees with the checker on what both see, and finds what breaks a limit.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "helpers of tests may panic as tests do")]

mod common;

use common::{Step, X, X_PLUS, at, changes, jumpy, line, line_steps, setup, ticks};
use measure::{Checker, FaultKind, Faults, MotorWatch, PerAxis};

/// The train of these steps.
fn train(steps: &[Step]) -> Vec<Vec<u32>> {
    ticks(&changes(steps))
}

/// X runs with an even acceleration (mm/s2) for so many ms, then at the speed reached as long, then brakes: pulses of 1 um.
fn ramp(acceleration: f64, ms: f64) -> Vec<Step> {
    let (a, t) = (acceleration * 1e-3, ms);
    let speed = a * t;
    let (first, second) = (a * t * t / 2.0, a * t * t / 2.0 + speed * t);
    let whole = second + first;
    let mut steps = Vec::new();
    let mut pulse = 1.0;
    while pulse <= whole.floor() {
        let time = if pulse <= first {
            (2.0 * pulse / a).sqrt()
        } else if pulse <= second {
            t + (pulse - first) / speed
        } else {
            3.0 * t - (2.0 * (whole - pulse) / a).sqrt()
        };
        steps.push(Step { clocks: at(0.1 + time / 1e3), x: 1, z: 0 });
        pulse += 1.0;
    }
    steps
}

fn watch(steps: &[Step]) -> (Faults, PerAxis<u64>) {
    let mut watch = MotorWatch::new(setup()).unwrap();
    for tick in train(steps) {
        watch.tick(&tick, &mut |_, _, _| {});
    }
    let pulses = watch.pulses();
    (watch.finish(), pulses)
}

#[test]
fn hash_and_pulses_are_the_checkers() {
    let steps = line_steps(30, 50, 60.0);
    let played = train(&steps);
    let (mut checker, mut watch) = (Checker::new(setup()).unwrap(), MotorWatch::new(setup()).unwrap());
    checker.motion(line(30_000, 50_000, 60.0));
    let mut seen = Vec::new();
    for tick in &played {
        checker.tick(tick);
        watch.tick(tick, &mut |_, x, z| seen.push((x, z)));
    }
    assert_eq!((watch.position(), watch.pulses()), (PerAxis { x: 30, z: 50 }, PerAxis { x: 30, z: 50 }));
    assert_eq!(seen.last(), Some(&(30, 50)));
    assert_eq!(watch.train_hash(), checker.finish().train_hash);
}

#[test]
fn the_largest_acceleration_is_no_fault_and_a_larger_one_is() {
    // the bound allows what rounding fakes: 4 pulses over 64 ms are a quarter of a percent of 1000 mm/s2
    let (faults, pulses) = watch(&ramp(1_000.0, 80.0));
    assert_eq!((faults.total(), pulses.x), (0, 12_800), "{:?}", faults.first());
    let (faults, _) = watch(&ramp(1_030.0, 80.0));
    assert!(faults.count(FaultKind::Acceleration) + faults.count(FaultKind::Jump) > 0);
}

/// Faults where X is pulled out of a thread along Z by all of its acceleration, 40 mm/s2 from the 100th tick and a part of it on,
/// while the thread's taper leads it in by `taper` pulses a tick: two ways, each to the nearest pulse of its own, of which the pins
/// show the sum. A pulse that would turn the axis round waits for its opposite, 16 ticks at most.
fn pulled_out(taper: f64, phase: f64, begin: f64, told: bool) -> u64 {
    let mut setup = setup();
    (setup.limits.x.max_accel, setup.limits.z.max_jump, setup.event_min_ns) = (40.0, 1e3, 0);
    #[allow(clippy::cast_possible_truncation, reason = "some hundred pulses")]
    let nearest = |place: f64| (place + 0.5).floor() as i32;
    let (mut steps, mut at, mut sense, mut waited) = (Vec::new(), nearest(phase), 0, 0);
    for tick in 0..250_u32 {
        let start = u64::from(tick) * 12_000;
        steps.extend((0..4).map(|n| Step { clocks: start + 1_000 + 3_000 * n, x: 0, z: 1 }));
        let ticks = f64::from(tick + 1);
        let out = (ticks - 100.0 - begin).max(0.0);
        let by = nearest(phase - taper * ticks) + nearest(0.04 * out * out / 2.0) - at;
        if by.abs() == 1 && by == -sense && waited < 16 {
            waited += 1;
            continue;
        }
        waited = 0;
        if by != 0 {
            sense = by.signum();
        }
        for clocks in (start + 1_500..).step_by(1_000).take(by.unsigned_abs() as usize) {
            steps.push(Step { clocks, x: sense, z: 0 });
        }
        at += by;
    }
    steps.sort_by_key(|step| step.clocks);
    let mut watch = MotorWatch::new(setup).unwrap();
    for tick in train(&steps) {
        if told {
            watch.added();
        }
        watch.tick(&tick, &mut |_, _, _| {});
    }
    watch.cut();
    watch.finish().count(FaultKind::Acceleration)
}

#[test]
fn a_way_that_is_added_to_the_paths_has_a_rounding_of_its_own() {
    let mut seen = 0;
    for taper in 1..30 {
        for phase in 0..20 {
            let (taper, phase, begin) = (f64::from(taper) / 60.0, f64::from(phase) / 20.0, f64::from(phase % 5) / 5.0);
            assert_eq!(pulled_out(taper, phase, begin, true), 0, "{taper} {phase}");
            seen += pulled_out(taper, phase, 0.4, false);
        }
    }
    assert!(seen > 0, "two roundings fake no more than one");
}

#[test]
fn a_speed_above_the_largest_is_a_fault() {
    // 100 mm/s are allowed
    assert_eq!(watch(&ramp(1_000.0, 99.0)).0.count(FaultKind::Speed), 0);
    assert!(watch(&ramp(1_000.0, 103.0)).0.count(FaultKind::Speed) > 0);
}

#[test]
fn pins_are_watched() {
    let faulty = |changes: &[(u64, u32)]| {
        let mut watch = MotorWatch::new(setup()).unwrap();
        for tick in ticks(changes) {
            watch.tick(&tick, &mut |_, _, _| {});
        }
        watch.finish()
    };
    let good = [(12_000, X_PLUS), (12_060, X_PLUS | X), (12_084, X_PLUS)];
    assert_eq!(faulty(&good).total(), 0);
    let narrow = [(12_000, X_PLUS), (12_060, X_PLUS | X), (12_083, X_PLUS)];
    let faults = faulty(&narrow);
    assert_eq!((faults.count(FaultKind::PulseTooShort), faults.count(FaultKind::EventTooShort)), (1, 1));
    let hasty = [(12_000, X_PLUS), (12_059, X_PLUS | X), (12_084, X_PLUS)];
    assert_eq!(faulty(&hasty).count(FaultKind::DirectionSetup), 1);
}

#[test]
fn a_train_that_is_cut_off_at_full_speed_is_no_fault_where_it_is_told() {
    let steps: Vec<Step> = ramp(1_000.0, 80.0).into_iter().take(6_000).collect();
    let run = |cut: bool| {
        let mut watch = MotorWatch::new(setup()).unwrap();
        for tick in train(&steps) {
            watch.tick(&tick, &mut |_, _, _| {});
        }
        if cut {
            watch.cut();
        }
        for _ in 0..50 {
            watch.tick(&[12_000], &mut |_, _, _| {});
        }
        watch.finish().total()
    };
    assert_eq!(run(true), 0);
    assert!(run(false) > 0);
}

/// Pulses a tick squared times the square of 8 ticks.
const BEND: f64 = 10.096_678;

/// Where the pins are at the end of each tick: a program and a wheel move one axis, together with an acceleration of [`BEND`] over
/// 8 ticks to plus, after one to minus until tick 40. Each has its rounding, the program's that of a minor axis; and a pulse that would turn
/// the axis round is owed until its opposite cancels it, a second one comes, or 16 ticks have gone by.
fn superposed() -> Vec<i32> {
    const SLOPE: f64 = 0.859_421_097;
    let a = BEND / 64.0;
    let (mut at, mut plus, mut waited, mut places) = (None, true, 0, Vec::new());
    for part in 0..=56 * 32 {
        let t = f64::from(part) / 32.0 - 40.0;
        let both = -0.579_936_461 - a * 0.319_930_206 * 8.0 * t + if t < 0.0 { -a } else { a } * t * t / 2.0;
        let program = 16.875_597_584 + 0.360_381_474 * t;
        let major = (program / SLOPE + 1_000.0).floor();
        #[expect(clippy::cast_possible_truncation, reason = "some hundred pulses")]
        let planned = ((SLOPE * major + 0.5).floor() + (both - program + 0.5).floor()) as i32;
        let mut pins = *at.get_or_insert(planned);
        let owed = planned - pins;
        if owed != 0 && (owed.abs() > 1 || (owed > 0) == plus) {
            (pins, plus) = (planned, owed > 0);
        }
        if part % 32 == 0 {
            waited = if pins == planned { 0 } else { waited + 1 };
            if waited == 16 {
                (plus, pins, waited) = (planned > pins, planned, 0);
            }
            places.push(pins);
        }
        at = Some(pins);
    }
    places
}

/// What is found wrong, in windows of how many ticks, of pins that are at these places at the ticks' ends.
fn bent(places: &[i32]) -> Vec<(FaultKind, u16, i64)> {
    let mut steps = Vec::new();
    for (tick, pair) in (1_u32..).zip(places.windows(2)) {
        let by = pair[1] - pair[0];
        for pulse in 0..by.abs() {
            let ms = f64::from(tick) + (f64::from(pulse) + 0.5) / f64::from(by.abs());
            steps.push(Step { clocks: at(ms / 1e3), x: by.signum(), z: 0 });
        }
    }
    let mut setup = jumpy();
    setup.limits.x.max_accel = BEND / 64.0 * 1e3;
    let mut watch = MotorWatch::new(setup).unwrap();
    for tick in train(&steps) {
        watch.added();
        watch.tick(&tick, &mut |_, _, _| {});
    }
    let faults = watch.finish();
    faults.first().iter().map(|fault| (fault.kind, fault.ticks, fault.found)).collect()
}

#[test]
fn what_two_roundings_and_an_owed_pulse_fake_is_no_fault_and_no_more_than_that() {
    let mut places = superposed();
    // it goes on evenly
    let (last, before) = (places[56], places[48]);
    places.extend((1..=40).map(|tick| last + (last - before) * tick / 8));
    // 7 more than the acceleration makes
    assert_eq!(places[40] - 2 * places[48] + places[56], 17);
    let bent_by = |more: i32| {
        let mut places = places.clone();
        places[56..].iter_mut().for_each(|place| *place += more);
        bent(&places)
    };
    // less than 9 more is granted
    assert!(bent_by(0).is_empty() && bent_by(2).is_empty());
    assert_eq!(bent_by(3), [(FaultKind::Acceleration, 8, 20)]);
}
