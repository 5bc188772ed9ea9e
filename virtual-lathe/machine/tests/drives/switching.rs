//! Switching the drive.

use crate::bench::{Bench, lathe, per_minute, point, program};
use interp_core::block::Path;
use interp_core::channel::State;
use interp_core::curve::method::Method;
use interp_core::drive::gearing::Lead;
use interp_core::drive::wheel::Click;
use interp_core::drive::{Drive, DriveRefusal};

#[test]
fn the_drive_is_switched_at_standstill_only() {
    let machine = lathe(Method::MinimumDeviation);
    let straight = |z: i64| (Path::Line, point(0, z), per_minute(600));
    let blocks = program(&machine, &[straight(-3_000_000), straight(-6_000_000), straight(-9_000_000)]);
    let mut bench = Bench::new(&machine, blocks);
    let wheel = Drive::Wheel(Click::from_nm(100_000).unwrap());
    let lead = Lead::new(1_000_000, 1).unwrap();
    assert_eq!(bench.channel.set_drive(Drive::Spindle(lead)), Err(DriveRefusal::NoEncoder));
    bench.channel.start();
    // into the second block
    bench.rest(500);
    assert!(bench.at.z < -1_300, "{:?}", bench.at);
    assert_eq!(bench.channel.set_drive(wheel), Err(DriveRefusal::Moving));
    assert_eq!(bench.channel.drive(), Drive::Time);
    bench.channel.hold();
    bench.rest(200);
    bench.channel.set_drive(wheel).unwrap();
    bench.channel.start();
    let held = bench.at;
    bench.rest(50);
    assert_eq!(bench.at, held);
    // back over the joint, 30 clicks of 0.1 mm
    for _ in 0..30 {
        bench.wheel(-4);
        bench.rest(20);
    }
    bench.rest(200);
    assert_eq!(bench.at.z, held.z + 30 * 40, "3 mm back");
    assert!(bench.at.z > -1_200, "in the first block");
    // and on by time, to the end
    bench.channel.set_drive(Drive::Time).unwrap();
    bench.rest(1_500);
    assert_eq!((bench.at.z, bench.channel.state()), (-3_600, State::Ended));
}
