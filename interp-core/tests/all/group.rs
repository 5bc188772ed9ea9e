//! A group of lathes: none disturbs another, and the common train obeys each lathe's pins.
#![allow(clippy::unwrap_used, clippy::panic, missing_docs, reason = "tests")]

use interp_core::block::{Block, Builder, Output, Pace, Path, Work};
use interp_core::channel::{Channel, State};
use interp_core::config::{AxisConfig, Config, Machine, TICK_CLOCKS};
use interp_core::group::{Grid, Group, GroupError};
use interp_core::train::{Event, Levels};
use interp_core::units::{Axis, Feedrate, Lattice, Length, Point, PulseSize, Sense};
use proptest::prelude::*;

fn config(pulse_nm: u32, width_ns: u32, event_min_ns: u32) -> Config {
    let axis = |nm: u32| AxisConfig {
        pulse: PulseSize::new(nm, 1).unwrap(),
        max_feed: Feedrate::from_nm_per_min(4_000_000_000).unwrap(),
        max_accel: 800_000,
        max_jump: 3_000,
        pulse_width_ns: width_ns,
        dir_setup_ns: 4_000,
        dir_hold_ns: 7_000,
        min_space_ns: width_ns + 300,
    };
    Config { x: axis(pulse_nm), z: axis(2 * pulse_nm), event_min_ns }
}

/// A lathe's program and what its operator does, and when.
#[derive(Clone, Debug)]
struct Job {
    pulse_nm: u32,
    steps: Vec<(i32, i32, u32)>,
    commands: Vec<(usize, u32)>,
    /// Blocks that ever arrive.
    blocks: usize,
}

fn job() -> impl Strategy<Value = Job> {
    let step = (-3_000_i32..3_000, -3_000_i32..3_000, 0_u32..8);
    let steps = prop::collection::vec(step, 1..12);
    let commands = prop::collection::vec((0_usize..1_500, 0_u32..6), 0..8);
    let pulses = prop::sample::select(vec![1_250_u32, 1_000, 2_500]);
    (pulses, steps, commands, 0_usize..30).prop_map(|(pulse_nm, steps, mut commands, blocks)| {
        commands.sort_unstable();
        commands.push((STOP, 1));
        Job { pulse_nm, steps, commands, blocks }
    })
}

impl Job {
    fn machine(&self, grid: Grid) -> Machine {
        grid.fit(&config(self.pulse_nm, 5_000, 2_000)).check().unwrap()
    }

    fn blocks(&self, grid: Grid) -> Vec<Block> {
        let (mut builder, mut blocks) = (Builder::new(&self.machine(grid), Point::default()), Vec::new());
        let (mut x, mut z) = (0_i32, 0_i32);
        for (line, (dx, dz, kind)) in (1..).zip(&self.steps) {
            let (from_x, from_z) = (x, z);
            (x, z) = ((x + dx).clamp(-20_000, 20_000), (z + dz).clamp(-20_000, 20_000));
            let end = Point { x: Length::from_um(x).unwrap(), z: Length::from_um(z).unwrap() };
            let middle = (i64::from(from_x + x) * 500, i64::from(from_z + z) * 500);
            let feed = Feedrate::from_nm_per_min(u64::from(kind + 1) * 500_000_000).unwrap();
            let (path, pace) = match kind {
                0 => (Path::Line, Pace::Rapid),
                1 | 2 => (Path::Arc { centre: middle, sense: Sense::Clockwise }, Pace::Feed(feed)),
                _ => (Path::Line, Pace::Feed(feed)),
            };
            let built = builder.motion(path, end, pace);
            blocks.extend(built.motions.iter().map(|motion| Block { line, work: Work::Motion(*motion) }));
            if *kind == 7 {
                builder.standstill();
                blocks.push(Block { line, work: Work::Dwell(20) });
                blocks.push(Block { line, work: Work::Output(Output::SpindleForward) });
            }
        }
        blocks.push(Block { line: 99, work: Work::End });
        blocks.truncate(self.blocks.max(1));
        blocks
    }
}

const TICKS: usize = 2_000;
/// Here a random job is reset, so that all pulses planned are played in the end.
const STOP: usize = 1_500;

/// Edges of one lathe: clock from the start, and its levels from then on.
type Edges = Vec<(u64, u16)>;

/// Takes a lathe's levels out of a train.
fn edges(train: &[Vec<Event>], lathe: u32) -> Edges {
    let (mut clock, mut levels, mut edges) = (0_u64, 0, Edges::new());
    for event in train.iter().flatten() {
        let now = event.levels().bits() >> (4 * lathe) & 0xF;
        if now != levels {
            edges.push((clock, now));
            levels = now;
        }
        clock += u64::from(event.interval());
    }
    edges
}

fn obey(tick: usize, job: &Job, mut give: impl FnMut(u32)) {
    job.commands.iter().filter(|(at, _)| *at == tick).for_each(|(_, command)| give(*command));
}

fn grouped<const N: usize>(grid: Grid, jobs: &[Job; N]) -> (Vec<Vec<Event>>, [(State, Lattice); N]) {
    let machines = jobs.clone().map(|job| job.machine(grid));
    let mut group = Group::<N, 16>::new(grid, &machines, &[Lattice::default(); N]).unwrap();
    let mut sources = jobs.clone().map(|job| job.blocks(grid).into_iter());
    let mut train = Vec::new();
    (0..N).for_each(|lathe| assert!(group.start(lathe)));
    for tick in 0..TICKS {
        for (lathe, job) in jobs.iter().enumerate() {
            obey(tick, job, |command| match command {
                0 => drop(group.hold(lathe)),
                1 => group.reset(lathe),
                2 => group.set_feed_override(lathe, 30),
                3 => group.set_feed_override(lathe, 200),
                _ => drop(group.start(lathe)),
            });
        }
        let mut events = Vec::new();
        group.tick(&mut |lathe| sources.get_mut(lathe)?.next(), &mut |event: Event| events.push(event));
        train.push(events);
    }
    (train, std::array::from_fn(|lathe| group.lathe(lathe).map(|c| (c.state(), c.position())).unwrap()))
}

fn alone(grid: Grid, job: &Job) -> (Vec<Vec<Event>>, (State, Lattice)) {
    let mut channel = Channel::<16>::new(&job.machine(grid), Lattice::default());
    let mut source = job.blocks(grid).into_iter();
    assert!(channel.start());
    let mut train = Vec::new();
    for tick in 0..TICKS {
        obey(tick, job, |command| match command {
            0 => drop(channel.hold()),
            1 => channel.reset(),
            2 => channel.set_feed_override(30),
            3 => channel.set_feed_override(200),
            _ => drop(channel.start()),
        });
        let mut events = Vec::new();
        channel.tick(&mut || source.next(), &mut |event: Event| events.push(event));
        train.push(events);
    }
    (train, (channel.state(), channel.position()))
}

/// Every tick is whole, and no two events are closer than the pitch.
fn check_train(train: &[Vec<Event>], grid: Grid) {
    for events in train {
        assert_eq!(events.iter().map(|event| event.interval()).sum::<u32>(), TICK_CLOCKS);
        assert!(events.iter().all(|event| event.interval() >= grid.pitch() && event.interval() % grid.pitch() == 0));
    }
}

/// The pins of a lathe keep the times of its machine; where the pulses lead.
fn check_pins(edges: &Edges, machine: &Machine) -> Lattice {
    let mut at = Lattice::default();
    for (axis, limits) in [(Axis::X, &machine.x), (Axis::Z, &machine.z)] {
        let (mut before, mut rose, mut fell, mut turned) = (Levels::LOW, None::<u64>, None::<u64>, None::<u64>);
        let mut count = 0_i32;
        let apart = |then: Option<u64>, now: u64, least: u32| then.is_none_or(|then| now - then >= u64::from(least));
        for (clock, bits) in edges {
            let now = Levels::from_bits(*bits);
            if now.plus(axis) != before.plus(axis) {
                assert!(apart(rose, *clock, limits.hold), "hold");
                turned = Some(*clock);
            }
            match (before.step(axis), now.step(axis)) {
                (false, true) => {
                    assert!(
                        apart(fell, *clock, limits.space) && apart(turned, *clock, limits.setup),
                        "space or set-up"
                    );
                    rose = Some(*clock);
                    count += if now.plus(axis) { 1 } else { -1 };
                }
                (true, false) => {
                    assert!(apart(rose, *clock, limits.width), "width");
                    fell = Some(*clock);
                }
                _ => {}
            }
            before = now;
        }
        match axis {
            Axis::X => at.x = count,
            Axis::Z => at.z = count,
        }
    }
    at
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_lathe_is_the_same_whatever_the_others_do(a in job(), b in job(), c in job(), d in job(), other in job()) {
        let grid = Grid::new(2_000);
        let (four, ends) = grouped(grid, &[a.clone(), b.clone(), c.clone(), d.clone()]);
        check_train(&four, grid);
        // in other company, in another place, and in a smaller group
        let (mixed, _) = grouped(grid, &[other.clone(), c.clone(), other, a.clone()]);
        let (single, _) = grouped(grid, std::array::from_ref(&a));
        prop_assert_eq!(edges(&four, 0), edges(&mixed, 3));
        prop_assert_eq!(edges(&four, 0), edges(&single, 0));
        prop_assert_eq!(edges(&four, 2), edges(&mixed, 1));
        for (number, job) in (0_u32..).zip([&a, &b, &c, &d]) {
            let (train, end) = alone(grid, job);
            let (grouped, alone) = (edges(&four, number), edges(&train, 0));
            // each edge on the next line of the grid, less than a pitch later
            let pitch = u64::from(grid.pitch());
            let snapped: Edges = alone.iter().map(|(clock, levels)| (clock.div_ceil(pitch) * pitch, *levels)).collect();
            prop_assert_eq!(&grouped, &snapped);
            prop_assert_eq!(ends[number as usize], end);
            prop_assert_eq!(check_pins(&grouped, &job.machine(grid)), end.1);
        }
    }
}

#[test]
fn one_in_hold_one_ended_one_starved_one_reset() {
    let grid = Grid::new(2_000);
    let far = |blocks: usize, commands: Vec<(usize, u32)>| Job {
        pulse_nm: 1_250,
        steps: vec![(3_000, 2_000, 3), (-3_000, 2_000, 3), (3_000, -2_900, 4), (2_000, 2_000, 4), (-2_900, 900, 2)],
        commands,
        blocks,
    };
    let short = Job { steps: vec![(100, 0, 4)], ..far(9, vec![]) };
    let jobs = [far(9, vec![(300, 0)]), short, far(2, vec![]), far(9, vec![(200, 1)])];
    let (train, ends) = grouped(grid, &jobs);
    check_train(&train, grid);
    assert_eq!(ends.map(|end| end.0), [State::Holding, State::Ended, State::Idle, State::Idle]);
    // the one in hold stood from soon after the hold on, and the starved one ran on meanwhile
    let last = |lathe: u32| edges(&train, lathe).last().unwrap().0 / u64::from(TICK_CLOCKS);
    assert!((300..450).contains(&last(0)), "{}", last(0));
    assert!(last(2) > last(3) && last(1) < last(3), "{} {} {}", last(1), last(2), last(3));
}

#[test]
fn a_grid_divides_the_tick_and_rounds_up() {
    for ns in (100..50_000).step_by(7) {
        let grid = Grid::new(ns);
        assert_eq!(TICK_CLOCKS % grid.pitch(), 0);
        assert!(u64::from(grid.pitch()) * 1_000 >= u64::from(ns) * 12 && grid.pitch() >= Grid::FINEST);
        let config = config(2_500, 5_000 + ns % 900, ns);
        let fitted = grid.fit(&config);
        if let (Ok(machine), Ok(before)) = (fitted.check(), config.check()) {
            let times = |m: &Machine| [m.event_min, m.x.width, m.x.space, m.x.setup, m.x.hold, m.z.width];
            for (after, before) in times(&machine).into_iter().zip(times(&before)) {
                assert_eq!(after, before.next_multiple_of(grid.pitch()).max(grid.pitch()), "{ns}");
            }
        }
    }
    assert_eq!(Grid::new(u32::MAX).pitch(), TICK_CLOCKS);
}

#[test]
fn figures_off_the_grid_are_refused() {
    let grid = Grid::new(2_000);
    let (good, bad) =
        (grid.fit(&config(1_250, 5_000, 2_000)).check().unwrap(), config(1_250, 5_000, 2_000).check().unwrap());
    let error = Group::<3, 4>::new(grid, &[good, good, bad], &[Lattice::default(); 3]).unwrap_err();
    assert_eq!(error, GroupError::OffGrid { lathe: 2 });
    let mut group = Group::<1, 4>::new(grid, &[good], &[Lattice::default()]).unwrap();
    assert!(group.configure(0, &good) && !group.configure(0, &bad) && !group.configure(1, &good));
    assert!(!group.start(1) && group.lathe(1).is_none());
}
