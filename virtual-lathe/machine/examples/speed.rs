//! How fast the machine plays a train: both axes at 50 kHz for ten minutes of machine time.

use std::time::Instant;

use figures::Figures;
use interp_core::train::{Event, Levels};
use interp_core::units::Axis;
use machine::{Axes, Control, Machine, TABLES};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let control = Control { pulse_nm: Axes { x: 1250.0, z: 1250.0 }, start: Axes { x: 0, z: 0 } };
    let mut figures = Figures::new(TABLES);
    // motors that start at 50 kHz, and a pitch error, which costs a sine a pulse
    let strong = "0:50;10000:50";
    for (name, text) in [
        ("motor.x.holding_nm", "50"),
        ("motor.z.holding_nm", "50"),
        ("motor.x.pull_out", strong),
        ("motor.z.pull_out", strong),
        ("screw.x.periodic_um", "3"),
    ] {
        figures.set(name, text)?;
    }
    let mut machine = Machine::new(&figures, control)?;
    let plus = Levels::LOW.with_plus(Axis::X, true).with_plus(Axis::Z, true);
    let high = plus.with_step(Axis::X, true).with_step(Axis::Z, true);
    let events = [Event::new(high, 60), Event::new(plus, 180)];
    let began = Instant::now();
    let mut sum = 0.0;
    let pulses = 600 * 50_000;
    for _ in 0..pulses {
        for event in events {
            sum += machine.play(event).x_nm;
        }
    }
    let seconds = began.elapsed().as_secs_f64();
    println!("{} million events in {seconds:.2} s; lost {:?}; {sum:e}", 2 * pulses / 1_000_000, machine.lost_pulses());
    Ok(())
}
