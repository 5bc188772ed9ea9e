//! Draws what a motor is asked for against its pull-out torque over time, for a feed and a rapid of the carriage: on
//! the default machine, and on a supply that is too weak.
//!
//! `cargo run --example motor_load -- docs/src/pictures/motor-load.svg`; the ending may be `png`, too.

use std::error::Error;
use std::fmt::Write;
use std::io;
use std::path::Path;

use interp_core::channel::Report;
use interp_core::units::Axis;
use machine::Load;
use virtual_lathe::lathe::{self, Observer};
use virtual_lathe::motors::Motors;
use virtual_lathe::picture;
use virtual_lathe::program::Program;
use virtual_lathe::settings::Settings;

const PROGRAM: &[u8] = b"G21 G90\nG1 Z-5 F1000\nG0 Z-50\nM30\n";
/// The supply that is too weak.
const WEAK: &str = "15";

/// Loads of the carriage's motor, tick by tick.
struct Loads {
    motors: Motors,
    ticks: Vec<Load>,
}

impl Observer for Loads {
    fn tick(&mut self, events: &[u32], report: &Report) -> io::Result<()> {
        self.motors.tick(events, report)?;
        self.ticks.push(self.motors.machine().axis(Axis::Z).load());
        Ok(())
    }
}

fn run(set: &[(String, String)]) -> Result<Loads, Box<dyn Error>> {
    let (settings, machine) = Settings::read(None, set).map_err(|refusal| format!("{refusal:?}"))?;
    let program = Program::Text { name: "move".into(), text: PROGRAM.to_vec() };
    let format = program.detect()?;
    let mut loads = Loads { motors: Motors::new(settings.model(&machine)?), ticks: Vec::new() };
    lathe::run(&program, format, &settings.parameters, &machine, &[], &mut loads)?;
    Ok(loads)
}

/// A panel: its place on the sheet, its scale, its text.
struct Panel {
    top: f64,
    height: f64,
    /// Values at bottom and top.
    range: (f64, f64),
    step: f64,
    decimals: usize,
    title: String,
    unit: &'static str,
}

const LEFT: f64 = 130.0;
const WIDTH: f64 = 1400.0;
const SHEET: (f64, f64) = (1600.0, 1160.0);

impl Panel {
    fn y(&self, value: f64) -> f64 {
        let (least, most) = self.range;
        self.top + self.height * (most - value.clamp(least, most)) / (most - least)
    }

    /// Frame, title, grid.
    fn frame(&self, svg: &mut String, seconds: f64) -> std::fmt::Result {
        let (right, bottom) = (LEFT + WIDTH, self.top + self.height);
        let mut value = (self.range.0 / self.step).ceil() * self.step;
        while value <= self.range.1 + self.step * 1e-6 {
            let y = self.y(value);
            writeln!(svg, r##"<path d="M{LEFT} {y:.1}H{right}" stroke="#d0d0d0" stroke-width="1.5"/>"##)?;
            writeln!(
                svg,
                r##"<text x="{:.1}" y="{:.1}" text-anchor="end">{:.*}</text>"##,
                LEFT - 14.0,
                y + 8.0,
                self.decimals,
                value
            )?;
            value += self.step;
        }
        let mut time = 0.0;
        while time <= seconds {
            let x = LEFT + WIDTH * time / seconds;
            writeln!(svg, r##"<path d="M{x:.1} {:.1}V{bottom:.1}" stroke="#d0d0d0" stroke-width="1.5"/>"##, self.top)?;
            time += 0.1;
        }
        writeln!(
            svg,
            r##"<rect x="{LEFT}" y="{:.1}" width="{WIDTH}" height="{:.1}" fill="none" stroke="#1a1a1a" stroke-width="2"/>"##,
            self.top, self.height
        )?;
        writeln!(svg, r##"<text x="{LEFT}" y="{:.1}" font-weight="bold">{}</text>"##, self.top - 14.0, self.title)?;
        writeln!(svg, r##"<text x="{right}" y="{:.1}" text-anchor="end">{}</text>"##, self.top - 14.0, self.unit)
    }

    fn line(&self, svg: &mut String, values: &[f64], style: &str) -> std::fmt::Result {
        svg.push_str("<polyline fill=\"none\" points=\"");
        let mut x = LEFT;
        let step = WIDTH / f64::from(u32::try_from(values.len()).unwrap_or(u32::MAX).max(1));
        for value in values {
            write!(svg, "{x:.1},{:.1} ", self.y(*value))?;
            x += step;
        }
        writeln!(svg, "\" {style}/>")
    }

    /// Shades the ticks in which the motor had lost the field.
    fn stalls(&self, svg: &mut String, ticks: &[Load]) -> std::fmt::Result {
        let step = WIDTH / f64::from(u32::try_from(ticks.len()).unwrap_or(u32::MAX).max(1));
        let before = |at: Option<usize>| f64::from(u32::try_from(at.unwrap_or(0)).unwrap_or(u32::MAX)) * step + LEFT;
        let (first, last) = (ticks.iter().position(|load| load.stalled), ticks.iter().rposition(|load| load.stalled));
        if first.is_none() {
            return Ok(());
        }
        let (from, to) = (before(first), before(last));
        writeln!(
            svg,
            r##"<rect x="{from:.1}" y="{:.1}" width="{:.1}" height="{:.1}" fill="#808080" fill-opacity="0.16"/>"##,
            self.top,
            to - from,
            self.height
        )?;
        let (middle, y) = ((from + to) / 2.0, self.top + 36.0);
        writeln!(
            svg,
            r##"<text x="{middle:.1}" y="{y:.1}" text-anchor="middle" stroke="#ececec" stroke-width="10" paint-order="stroke">the field runs on alone</text>"##
        )
    }
}

fn draw(sound: &Loads, weak: &Loads) -> Result<String, std::fmt::Error> {
    let seconds = f64::from(u32::try_from(sound.ticks.len()).unwrap_or(u32::MAX)) * 1e-3;
    let mut svg = format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{0}" height="{1}" viewBox="0 0 {0} {1}" font-family="DejaVu Sans, sans-serif" font-size="24" fill="#1a1a1a">
<rect width="{0}" height="{1}" fill="#ffffff"/>
"##,
        SHEET.0, SHEET.1
    );
    let panel = |top, height, range, step, decimals, title: String, unit| Panel {
        top,
        height,
        range,
        step,
        decimals,
        title,
        unit,
    };
    let lost = weak.motors.lost_pulses().z;
    let panels = [
        (panel(60.0, 340.0, (0.0, 2.0), 0.5, 1, "Motor of Z at 36 V: it follows".into(), "Nm"), sound),
        (panel(470.0, 340.0, (0.0, 2.0), 0.5, 1, format!("At {WEAK} V: {lost} pulses are lost"), "Nm"), weak),
    ];
    for (panel, loads) in &panels {
        panel.frame(&mut svg, seconds)?;
        panel.stalls(&mut svg, &loads.ticks)?;
        let asked: Vec<f64> = loads.ticks.iter().map(|load| load.asked * load.speed.signum()).collect();
        let available: Vec<f64> = loads.ticks.iter().map(|load| load.available).collect();
        panel.line(&mut svg, &available, r##"stroke="#0b5394" stroke-width="4" stroke-dasharray="14 8""##)?;
        panel.line(&mut svg, &asked, r##"stroke="#1a1a1a" stroke-width="3""##)?;
    }
    let speed = panel(880.0, 180.0, (0.0, 1200.0), 400.0, 0, "Commanded speed".into(), "1/min");
    speed.frame(&mut svg, seconds)?;
    let rpm: Vec<f64> = sound.ticks.iter().map(|load| load.speed.abs() * 60.0 / std::f64::consts::TAU).collect();
    speed.line(&mut svg, &rpm, r##"stroke="#1a1a1a" stroke-width="3""##)?;
    let mut tenths = 0;
    while f64::from(tenths) * 0.1 <= seconds {
        let x = LEFT + WIDTH * f64::from(tenths) * 0.1 / seconds;
        if tenths % 2 == 0 {
            let time = f64::from(tenths) * 0.1;
            writeln!(svg, r##"<text x="{x:.1}" y="1092" text-anchor="middle">{time:.1}</text>"##)?;
        }
        tenths += 1;
    }
    let right = LEFT + WIDTH;
    writeln!(svg, r##"<text x="{right}" y="1135" text-anchor="end">s</text>"##)?;
    writeln!(svg, r##"<path d="M{LEFT} 1126h70" stroke="#1a1a1a" stroke-width="3"/>"##)?;
    writeln!(svg, r##"<text x="{}" y="1135">asked for, in the direction of motion</text>"##, LEFT + 84.0)?;
    let x = LEFT + 620.0;
    writeln!(svg, r##"<path d="M{x} 1126h70" stroke="#0b5394" stroke-width="4" stroke-dasharray="14 8"/>"##)?;
    writeln!(svg, r##"<text x="{}" y="1135">pull-out at this speed</text>"##, x + 84.0)?;
    svg.push_str("</svg>\n");
    Ok(svg)
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("name the picture: motor-load.svg or .png")?;
    let weak = [("driver.z.supply_v".to_owned(), WEAK.to_owned())];
    let svg = draw(&run(&[])?, &run(&weak)?)?;
    if Path::new(&path).extension().is_some_and(|ending| ending == "png") {
        std::fs::write(&path, picture::png(&svg, 1600)?)?;
    } else {
        std::fs::write(&path, svg)?;
    }
    Ok(())
}
