//! The pictures of a finished run.

use std::io::{self, Write};
use std::path::Path;

use indicatif::ProgressBar;
use stock::{Point, Sample};

use crate::course::{Bin, Range};
use crate::output::Pending;
use crate::picture::{self, Chart, Drawing, Film, Form, Kind, Look, Section, Series, Strip};
use crate::turn::Finished;
use crate::{dimensions, report};

/// Width of pictures, pixels.
const WIDTH: u32 = 1600;
/// Tolerance of an outline, mm.
const OUTLINE: f64 = 0.002;
/// Width of an animation, pixels.
const FILM_WIDTH: u32 = 800;
/// How many times the error is drawn on the contour.
const MAGNIFIED: f64 = 1_000.0;
/// Stretches of a contour's length that are drawn.
const BINS: f64 = 2_000.0;
/// Samples farther apart than this, mm, are not joined.
const GAP: f64 = 0.1;
/// Chords of a nose as drawn.
const NOSE_PARTS: u32 = 16;
/// How much of the bar behind the part is drawn, in radii.
const BEHIND: f64 = 0.5;

/// Draws what a run left.
pub struct Sheets<'r> {
    run: &'r Finished,
}

impl<'r> Sheets<'r> {
    /// The sheets of a run.
    pub fn new(run: &'r Finished) -> Self {
        Self { run }
    }

    /// The part: half section, path, dimensions, places under magnification; as SVG.
    pub fn part(&self) -> String {
        let watched = &self.run.watched;
        let report = &watched.report;
        let tracks = watched.thinner.tracks();
        let start = tracks.first().and_then(|track| track.points.first()).copied().unwrap_or_default();
        let end = tracks.last().and_then(|track| track.points.last()).copied().unwrap_or(start);
        let drawing = Drawing {
            title: self.run.name.clone(),
            subtitle: format!(
                "machine time {} · X {} and Z {} pulses · {:.3} pulses from the walked curve, {:.3} from the programmed one",
                report::clock(report.time_s),
                report.pulses.x,
                report.pulses.z,
                report.walked.pulses,
                report.programmed.pulses
            ),
            tracks,
            start,
            end,
            insets: watched.insets.clone(),
            section: self.section(end),
        };
        drawing.svg(WIDTH)
    }

    /// The work as cut, with the tool at a place of the programmed point.
    fn section(&self, tool_at: [f64; 2]) -> Option<Section> {
        let outcome = self.run.watched.worked.outcome.as_ref()?;
        let data = outcome.bar.data();
        let samples = outcome.contour.samples();
        // of a long bar, as much as the part needs
        let lowest = samples.iter().map(|sample| sample.place.z).fold(data.face, f64::min);
        let back = data.back.max(lowest - BEHIND * data.radius);
        let [outside, inside] = outcome.bar.outline(OUTLINE).map(|line| from(back, line));
        Some(Section {
            bar_z: [back, data.face],
            bar_x: [data.bore, data.radius],
            outside,
            inside,
            tool: self.tool(tool_at),
            dimensions: dimensions::of(samples),
        })
    }

    /// The surface error, magnified: along the contour, and on it; as SVG.
    pub fn error(&self) -> String {
        let worked = &self.run.watched.worked;
        let samples = worked.outcome.as_ref().map_or(&[][..], |outcome| outcome.contour.samples());
        let mut ordered: Vec<&Sample> = samples.iter().collect();
        ordered.sort_by_key(|sample| sample.order);
        let half = 500.0 * self.run.pulse[0].max(self.run.pulse[1]);
        let length: f64 = ordered.iter().map(|sample| sample.weight).sum();
        let per_bin = (length / BINS).max(f64::MIN_POSITIVE);
        let (mut error, mut surface, mut magnified) = (Vec::new(), Vec::new(), Vec::new());
        let mut walked = 0.0;
        let mut bin: Option<[f64; 3]> = None;
        let mut before: Option<&Sample> = None;
        for sample in ordered {
            if let Some(last) = before
                && (sample.place - last.place).length() > GAP
            {
                error.extend(bin.take());
                error.push([f64::NAN; 3]);
                magnified.push([f64::NAN; 3]);
                surface.push([f64::NAN; 3]);
            }
            walked += sample.weight;
            let um = sample.depth * 1e3;
            bin = match bin {
                Some([place, low, high]) if walked - place < per_bin => Some([place, low.min(um), high.max(um)]),
                full => {
                    error.extend(full);
                    Some([walked, um, um])
                }
            };
            if surface.last().is_none_or(|[place, ..]: &[f64; 3]| place.is_nan() || walked - place >= per_bin) {
                let x = sample.place.x + MAGNIFIED * sample.depth * sample.normal.x.signum();
                surface.push([walked, sample.place.x, sample.place.x]);
                magnified.push([walked, x, x]);
            }
            before = Some(sample);
        }
        error.extend(bin);
        let facts = match worked.outcome.as_ref().and_then(|outcome| outcome.surface) {
            Some(surface) => {
                format!("mean {:.2} µm, at most {:.2} µm; positive is too deep", surface.mean_um, surface.max_um)
            }
            None => "no contour was cut".into(),
        };
        let band = Series {
            name: format!("half a coarser pulse, {half:.2} µm"),
            look: Look::Band,
            values: vec![[0.0, -half, half], [walked, -half, half]],
        };
        let error = Series { name: "cut surface off the contour".into(), look: Look::Solid, values: error };
        let surface = Series { name: "contour".into(), look: Look::Dashed, values: surface };
        let magnified =
            Series { name: format!("cut, its error {MAGNIFIED} times as large"), look: Look::Solid, values: magnified };
        Chart {
            title: format!("{}: surface error", self.run.name),
            subtitle: facts,
            along: "length along the contour, in the order of the program, mm".into(),
            strips: vec![
                Strip { name: "error along the normal, µm".into(), series: vec![band, error] },
                Strip { name: "radius, mm".into(), series: vec![surface, magnified] },
            ],
        }
        .svg(WIDTH)
    }

    /// Speed, acceleration and pulse rate over time; as SVG.
    pub fn motion(&self) -> String {
        let course = &self.run.watched.worked.course;
        let series = |name: &str, look: Look, of: &dyn Fn(&Bin) -> Range, scale: f64| {
            let mut time = 0.0;
            let values = course.bins().iter().map(|bin| {
                let Range { low, high } = of(bin);
                let place = time;
                time += course.bin_s();
                [place, low * scale, high * scale]
            });
            Series { name: name.into(), look, values: values.collect() }
        };
        Chart {
            title: format!("{}: motion", self.run.name),
            subtitle: "over 8 ms each; least and greatest value of each stretch of time".into(),
            along: "time, s".into(),
            strips: vec![
                Strip {
                    name: "speed along the path, mm/min".into(),
                    series: vec![series("", Look::Solid, &|bin| bin.speed, 1.0)],
                },
                Strip {
                    name: "acceleration of X, mm/s²".into(),
                    series: vec![series("", Look::Solid, &|bin| bin.acceleration[1], 1.0)],
                },
                Strip {
                    name: "acceleration of Z, mm/s²".into(),
                    series: vec![series("", Look::Solid, &|bin| bin.acceleration[0], 1.0)],
                },
                Strip {
                    name: "pulses, kHz".into(),
                    series: vec![
                        series("X", Look::Dashed, &|bin| bin.rate[1], 1e-3),
                        series("Z", Look::Solid, &|bin| bin.rate[0], 1e-3),
                    ],
                },
            ],
        }
        .svg(WIDTH)
    }

    /// The cut as an animation.
    ///
    /// # Errors
    /// Those of rendering and encoding.
    pub fn animation(&self, form: Form, bar: &ProgressBar) -> io::Result<Vec<u8>> {
        let moments = &self.run.watched.worked.moments;
        let nothing = || io::Error::other(format!("{}: there is nothing to animate", self.run.name));
        let whole = self.section([f64::NAN; 2]).ok_or_else(nothing)?;
        let back = whole.bar_z[0];
        bar.set_message("drawing");
        bar.set_length(moments.len() as u64);
        let mut film = Film::new(form);
        for moment in moments {
            let [outside, inside] = moment.outline.clone().map(|line| from(back, line));
            let tool = self.tool(moment.tool);
            let section = Section { outside, inside, tool, dimensions: Vec::new(), ..whole.clone() };
            let kind = if moment.kind == Kind::Rapid { "rapid" } else { "feed" };
            let drawing = Drawing {
                title: self.run.name.clone(),
                subtitle: format!("{:.1} s · {kind}", moment.time_ms as f64 / 1e3),
                tracks: Vec::new(),
                start: [f64::NAN; 2],
                end: [f64::NAN; 2],
                insets: Vec::new(),
                section: Some(section),
            };
            film.add(&drawing.svg(FILM_WIDTH), FILM_WIDTH).map_err(io::Error::other)?;
            bar.inc(1);
        }
        bar.finish_and_clear();
        film.finish().map_err(io::Error::other)
    }

    /// The tool's outline with its programmed point at a place.
    fn tool(&self, [z, x]: [f64; 2]) -> Vec<[f64; 2]> {
        let Some(tool) = self.run.tool.filter(|_| z.is_finite() && x.is_finite()) else { return Vec::new() };
        let outline = tool.outline(tool.centre(Point::new(z, x)), NOSE_PARTS);
        outline.iter().map(|point| [point.z, point.x]).collect()
    }

    /// Writes a sheet as its name's ending says.
    ///
    /// # Errors
    /// Those of writing and rendering.
    pub fn write(&self, path: &Path, svg: &str) -> io::Result<Pending> {
        let mut file = Pending::create(path)?;
        if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png")) {
            file.writer().write_all(&picture::png(svg, WIDTH).map_err(io::Error::other)?)?;
        } else {
            file.writer().write_all(svg.as_bytes())?;
        }
        Ok(file)
    }
}

/// The part of an outline in front of `back`.
fn from(back: f64, line: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let behind = line.iter().rev().find(|[z, _]| *z < back).map(|[_, x]| [back, *x]);
    behind.into_iter().chain(line.iter().copied().filter(|[z, _]| *z >= back)).collect()
}
