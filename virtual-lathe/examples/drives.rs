//! Draws a thread that is cut while the spindle wobbles: the speed that the spindle asks for and the path's, and the phase
//! error of every pulse against the true angle.
//!
//! `cargo run --example drives -- docs/src/pictures/thread-phase.svg`; the ending may be `png`, too.

use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path as FilePath;

use figures::Figures;
use interp_core::block::{Block, Builder, Pace, Path, Work};
use interp_core::channel::Channel;
use interp_core::curve::method::Method;
use interp_core::drive::Inputs;
use interp_core::drive::gearing::Lead;
use interp_core::drive::spindle::Reading;
use interp_core::train::Event;
use interp_core::units::{Axis, Lattice, Length, Point};
use machine::{Angle, Encoder, Spindle, TABLES};
use virtual_lathe::picture::{self, Chart, Look, Series, Strip};
use virtual_lathe::settings::Settings;

/// Lead, mm; thread, mm; counts a turn.
const LEAD: f64 = 2.0;
const LENGTH: f64 = -40.0;
const COUNTS: u16 = 4096;
/// Z pulse, mm.
const PULSE: f64 = 0.0025;
/// Ticks drawn.
const TICKS: u32 = 1_700;

/// Turns a minute at a time in seconds.
fn commanded(time: f64) -> f64 {
    900.0 * (1.0 + 0.2 * (TAU * 2.0 * time).sin())
}

#[expect(clippy::cast_precision_loss, reason = "a few hundred turns")]
fn turns(angle: Angle) -> f64 {
    angle.turns as f64 + angle.part
}

fn blocks(settings: &Settings) -> Option<Vec<Block>> {
    let machine = settings.parameters.machine().ok()?;
    let mut builder = Builder::new(&machine, Point::default());
    let end = Point { x: Length::ZERO, z: Length::from_um(-40_000)? };
    let pace = Pace::Thread { lead: Lead::new(2_000_000, 1)?, start: 0 };
    let built = builder.motion(Path::Line, end, pace);
    let motions = built.motions.iter().map(|motion| Block { line: 1, work: Work::Motion(*motion) });
    Some(motions.chain([Block { line: 2, work: Work::End }]).collect())
}

fn run() -> Result<Chart, Box<dyn Error>> {
    let (settings, machine) = Settings::read(None, &[]).map_err(|refusal| format!("{refusal:?}"))?;
    debug_assert!(machine.method == Method::MinimumDeviation);
    let mut blocks = blocks(&settings).ok_or("the thread is no block")?.into_iter();
    let mut channel = Channel::<64>::new(&machine, Lattice::default());
    channel.set_encoder(Some(u32::from(COUNTS)));
    channel.start();
    let mut figures = Figures::new(TABLES);
    for (name, text) in
        [("spindle.ramp_rpm_s", "100000"), ("spindle.inertia_kgm2", "0.003"), ("spindle.torque_nm", "50")]
    {
        figures.set(name, text).map_err(|error| error.to_string())?;
    }
    let (mut spindle, encoder) = (Spindle::new(&figures)?, Encoder::new(&figures)?);
    spindle.command(commanded(0.0));
    for _ in 0..500 {
        spindle.tick();
    }
    let (mut asked, mut made, mut error) = (Vec::new(), Vec::new(), Vec::new());
    let (mut turn, mut place, mut rises, mut high) = (None, 0_i32, Vec::new(), false);
    for tick in 0..TICKS {
        let now = f64::from(tick) * 1e-3;
        // what was made in the last tick is played in this one
        for (clock, at, locked) in rises.drain(..) {
            let time: f64 = f64::from(clock) / 12e6;
            let line = turns(spindle.angle_after(time)) * LEAD / PULSE;
            let off = line + f64::from(at);
            let off = off - (off / (LEAD / PULSE)).round() * (LEAD / PULSE);
            if locked {
                error.push([now + time, off, off]);
            }
        }
        let counts = encoder.counts(spindle.angle_after(0.0));
        let (low, whole) = (counts.rem_euclid(1 << 16), counts.div_euclid(i64::from(COUNTS)));
        let passed = turn.replace(whole).is_some_and(|before| before != whole);
        let index = (whole * i64::from(COUNTS)).rem_euclid(1 << 16);
        let reading =
            Reading { counts: u16::try_from(low)?, index: if passed { Some(u16::try_from(index)?) } else { None } };
        channel.read(&Inputs { spindle: Some(reading), wheel: 0 });
        let mut clock = 0;
        let mut steps = Vec::new();
        let report = channel.tick(&mut || blocks.next(), &mut |event: Event| {
            let levels = event.levels();
            if levels.step(Axis::Z) && !high {
                place += if levels.plus(Axis::Z) { 1 } else { -1 };
                steps.push((clock, place));
            }
            high = levels.step(Axis::Z);
            clock += event.interval();
        });
        rises.extend(steps.iter().map(|(clock, at)| (*clock, *at, report.driven.locked)));
        let wants = spindle.rpm() / 60.0 * LEAD;
        asked.push([now, wants, wants]);
        let speed = f64::from(report.speed) / 4096.0 * 1e-3;
        made.push([now + 1e-3, speed, speed]);
        spindle.command(commanded(now));
        spindle.tick();
    }
    let worst = error.iter().fold(0.0_f64, |most, [_, off, _]| most.max(off.abs()));
    Ok(Chart {
        title: "A thread under a wobbling spindle".into(),
        subtitle: format!(
            "lead {LEAD} mm, {} mm long, 900/min ± 20 % at 2 Hz, 1024 lines: {worst:.2} pulses at worst",
            LENGTH.abs()
        ),
        along: "s".into(),
        strips: vec![
            Strip {
                name: "Speed, mm/s".into(),
                series: vec![
                    Series { name: "spindle x lead".into(), look: Look::Dashed, values: asked },
                    Series { name: "path".into(), look: Look::Solid, values: made },
                ],
            },
            Strip {
                name: "Phase error of each pulse, Z pulses of 2.5 µm".into(),
                series: vec![Series { name: "in phase".into(), look: Look::Solid, values: error }],
            },
        ],
    })
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("name the picture: thread-phase.svg or .png")?;
    let svg = run()?.svg(1600);
    if FilePath::new(&path).extension().is_some_and(|ending| ending == "png") {
        std::fs::write(&path, picture::png(&svg, 1600)?)?;
    } else {
        std::fs::write(&path, svg)?;
    }
    Ok(())
}
