//! How many events a second this computer makes for a group of one to four lathes, each on a zigzag at 80 mm/s.
#![allow(clippy::unwrap_used, clippy::print_stdout, clippy::cast_precision_loss, reason = "an example that measures")]

use interp_core::block::{Block, Builder, Pace, Path, Work};
use interp_core::config::{AxisConfig, Config};
use interp_core::group::{Grid, Group};
use interp_core::train::Event;
use interp_core::units::{Feedrate, Lattice, Length, Point, PulseSize};
use std::time::Instant;

fn main() {
    measure::<1>();
    measure::<2>();
    measure::<3>();
    measure::<4>();
}

fn measure<const N: usize>() {
    const TICKS: u32 = 20_000;
    let axis = |nm: u32| AxisConfig {
        pulse: PulseSize::new(nm, 1).unwrap(),
        max_feed: Feedrate::from_nm_per_min(4_800_000_000).unwrap(),
        max_accel: 2_000_000,
        max_jump: 2_000,
        pulse_width_ns: 4_000,
        dir_setup_ns: 4_000,
        dir_hold_ns: 8_000,
        min_space_ns: 4_000,
    };
    let grid = Grid::new(2_000);
    let machine = grid.fit(&Config { x: axis(1_250), z: axis(2_500), event_min_ns: 2_000 }).check().unwrap();
    let mut group = Group::<N, 16>::new(grid, &[machine; N], &[Lattice::default(); N]).unwrap();
    let mut builders = [const { None::<Builder> }; N].map(|_| (Builder::new(&machine, Point::default()), 0_i32));
    let feed = Pace::Feed(Feedrate::from_nm_per_min(4_800_000_000).unwrap());
    let mut source = |lathe: usize| {
        let (builder, count) = builders.get_mut(lathe)?;
        *count += 1;
        let place = |mm: i32| Length::from_um(mm * 1_000).unwrap();
        let step = 20 + i32::try_from(lathe).unwrap();
        let end = Point { x: place(*count % 2 * step), z: place(*count % 3 * step) };
        let built = builder.motion(Path::Line, end, feed);
        built.motions.first().map(|motion| Block { line: 1, work: Work::Motion(*motion) })
    };
    (0..N).for_each(|lathe| assert!(group.start(lathe)));
    let (mut events, began) = (0_u64, Instant::now());
    for _ in 0..TICKS {
        group.tick(&mut source, &mut |_: Event| events += 1);
    }
    let seconds = began.elapsed().as_secs_f64();
    let (made, played) = (events as f64 / seconds / 1e6, events as f64 / f64::from(TICKS) * 1e3);
    println!("{N} lathes: {made:.1} million events a second; the train has {played:.0} in each second of its own time");
}
