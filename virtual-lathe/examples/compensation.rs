//! Draws how far the tool is off a circle, with and without compensation, on a machine with backlash and pitch errors:
//! `cargo run --release -p virtual-lathe --example compensation -- FOLDER`.

use std::io::{self, Write};
use std::path::PathBuf;

use virtual_lathe::picture::{self, Chart, Look, Series, Strip};
use virtual_lathe::pitch_table;
use virtual_lathe::settings::Settings;
use virtual_lathe::slides;

/// Centre (Z, X as a radius) and radius, mm.
const CENTRE: [f64; 2] = [-20.0, 30.0];
const RADIUS: f64 = 10.0;

/// The circle, X as a radius.
const PROGRAM: &str = "G21 G90 G94\nG2 X40 Z-20 I-10 K0 F200\nM30\n";

/// The machine: a play of 20 um, and a screw of Z that is up to 12 um off.
const MACHINE: [(&str, &str); 4] = [
    ("start", "40,-20"),
    ("slide.x.backlash_um", "20"),
    ("slide.z.backlash_um", "20"),
    ("screw.z.error", "-35:9;-30:12;-25:7;-20:0;-15:-8;-10:-12;-5:-6"),
];

/// What the control is told of it.
const CONTROL: [(&str, &str); 3] = [("x.backlash_um", "20"), ("z.backlash_um", "20"), ("z.pitch_table", "true")];
const TABLE: &str = "z -35 9\nz -30 12\nz -25 7\nz -20 0\nz -15 -8\nz -10 -12\nz -5 -6\n";

/// Angle from the start in degrees, and how far the tool is outside the circle, um.
fn off(compensated: bool) -> io::Result<Vec<[f64; 2]>> {
    let mut settings = Settings::default();
    for (name, value) in MACHINE.iter().chain(CONTROL.iter().filter(|_| compensated)) {
        settings.set(name, value).map_err(io::Error::other)?;
    }
    settings.pitch = pitch_table::read("table", TABLE).map_err(|errors| io::Error::other(errors.join("\n")))?;
    let (mut last, mut values) = (0.0_f64, Vec::new());
    for place in slides::follow(PROGRAM, &settings)?.iter().step_by(8) {
        let from = |place: [f64; 2]| [place[0] - CENTRE[0], place[1] - CENTRE[1]];
        let [z, x] = from(place.program);
        let angle = z.atan2(x).to_degrees().rem_euclid(360.0);
        if angle < last {
            break;
        }
        last = angle;
        let [z, x] = from(place.slides);
        values.push([angle, (z.hypot(x) - RADIUS) * 1e3]);
    }
    Ok(values)
}

fn series(name: &str, look: Look, values: &[[f64; 2]]) -> Series {
    Series { name: name.into(), look, values: values.iter().map(|[at, value]| [*at, *value, *value]).collect() }
}

fn most(values: &[[f64; 2]]) -> f64 {
    values.iter().map(|[_, value]| value.abs()).fold(0.0, f64::max)
}

fn main() -> io::Result<()> {
    let folder = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("out"), PathBuf::from);
    let (without, with) = (off(false)?, off(true)?);
    let chart = Chart {
        title: "A circle of radius 10 mm at 200 mm/min".into(),
        subtitle: format!("at most {:.1} um without, {:.1} um with compensation", most(&without), most(&with)),
        along: "degrees from the start, where X turns round".into(),
        strips: vec![
            Strip {
                name: "outside the circle, \u{b5}m".into(),
                series: vec![series("without", Look::Dashed, &without), series("with", Look::Solid, &with)],
            },
            Strip {
                name: "the same with compensation, \u{b5}m".into(),
                series: vec![series("with", Look::Solid, &with)],
            },
        ],
    };
    std::fs::create_dir_all(&folder)?;
    let svg = chart.svg(1_600);
    std::fs::write(folder.join("compensation.svg"), &svg)?;
    std::fs::write(folder.join("compensation.png"), picture::png(&svg, 1_600).map_err(io::Error::other)?)?;
    writeln!(io::stdout(), "{}", chart.subtitle)
}
