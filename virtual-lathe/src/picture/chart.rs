//! Charts: values over a common axis, one strip above the other.

use crate::picture::number::Ticks;
use crate::picture::pen::{Anchor, GREY, INK, Pen, Point, Stroke};
use crate::picture::text;
use crate::picture::view::Rect;

/// Size of text, units.
const TEXT: f64 = 13.0;
/// Margin of the sheet.
const MARGIN: f64 = 16.0;
/// From the border to the frame on the left: labels.
const GUTTER: f64 = 78.0;
/// Above a strip: its name and legend.
const HEAD: f64 = 28.0;
/// Height of the title.
const TITLE: f64 = 50.0;
/// Below the last strip: labels and name of the common axis.
const FOOT: f64 = 46.0;
/// Height of a strip.
const HEIGHT: f64 = 190.0;
/// Least distance of labels, along and up.
const STEPS: [f64; 2] = [80.0, 30.0];

/// How a series is drawn.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Look {
    /// A dark line.
    Solid,
    /// A dashed line of a second colour.
    Dashed,
    /// A grey patch between two limits.
    Band,
}

/// One series of a strip: at each place the least and the greatest value.
#[derive(Clone, Debug)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// How it is drawn.
    pub look: Look,
    /// Place, least, greatest; a gap where a value is not finite.
    pub values: Vec<[f64; 3]>,
}

/// A strip of the chart.
#[derive(Clone, Debug)]
pub struct Strip {
    /// What is shown, with its unit.
    pub name: String,
    /// The series.
    pub series: Vec<Series>,
}

/// A sheet of strips.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Name of the sheet.
    pub title: String,
    /// Facts beside it.
    pub subtitle: String,
    /// Name of the common axis.
    pub along: String,
    /// The strips, from above.
    pub strips: Vec<Strip>,
}

const fn stroke(look: Look) -> Stroke {
    match look {
        Look::Solid => Stroke::solid(INK, 1.2),
        Look::Dashed => Stroke { colour: "#1668b8", width: 1.3, dashes: "7 3" },
        Look::Band => Stroke::solid("#bdbdbd", 1.0),
    }
}

/// The range of finite values.
fn range(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    values.filter(|value| value.is_finite()).fold(None, |known: Option<[f64; 2]>, value| {
        Some(known.map_or([value, value], |[low, high]| [low.min(value), high.max(value)]))
    })
}

impl Chart {
    /// The chart as an SVG document `width_px` wide.
    #[must_use]
    pub fn svg(&self, width_px: u32) -> String {
        // text grows slower than the sheet, as on the other sheets
        let units = 1_000.0 * (f64::from(width_px.clamp(600, 8_000)) / 1_000.0).powf(0.25);
        #[expect(clippy::cast_precision_loss, reason = "a few strips")]
        let height = TITLE + self.strips.len() as f64 * (HEIGHT + HEAD) + FOOT + 2.0 * MARGIN;
        let mut pen = Pen::sheet(units, height, width_px.max(1));
        let places = self.strips.iter().flat_map(|strip| &strip.series).flat_map(|series| &series.values);
        let [low, high] = range(places.map(|[place, ..]| *place)).unwrap_or([0.0, 1.0]);
        let across = [low, if high > low { high } else { low + 1.0 }];
        pen.open("border", Stroke::solid(INK, 1.4));
        pen.rect([MARGIN / 2.0; 2], [units - MARGIN, height - MARGIN]);
        pen.close();
        let room = units - 2.0 * MARGIN;
        let title = text::fit(&self.title, 19.0, 0.5 * room);
        let left = MARGIN + 6.0;
        pen.text("title", [left, MARGIN + 24.0], 19.0, Anchor::Start, INK, &title);
        let facts = text::fit(&self.subtitle, TEXT, room - text::width(&title, 19.0) - 40.0);
        pen.text("facts", [units - left, MARGIN + 23.0], TEXT, Anchor::End, GREY, &facts);
        let mut y = MARGIN + TITLE + HEAD - 8.0;
        let last = self.strips.len().saturating_sub(1);
        for (number, strip) in self.strips.iter().enumerate() {
            let frame = Rect { x: MARGIN + GUTTER, y, width: units - 3.0 * MARGIN - GUTTER, height: HEIGHT };
            draw(&mut pen, strip, frame, across, number == last);
            y += HEIGHT + HEAD;
        }
        let at = [units - 2.0 * MARGIN, y - HEAD + FOOT - 4.0];
        pen.text("axis", at, TEXT, Anchor::End, GREY, &self.along);
        pen.finish()
    }
}

fn draw(pen: &mut Pen, strip: &Strip, frame: Rect, [first, end]: [f64; 2], is_last: bool) {
    let values = strip.series.iter().flat_map(|series| &series.values);
    let [low, high] = range(values.flat_map(|[_, low, high]| [*low, *high])).unwrap_or([0.0, 1.0]);
    let (low, high) = (low.min(0.0), high.max(0.0));
    let pad = 0.06 * if high > low { high - low } else { 1.0 };
    let (low, high) = (if low < 0.0 { low - pad } else { low }, high + pad);
    let at = |place: f64, value: f64| -> Point {
        [
            frame.x + (place - first) / (end - first) * frame.width,
            frame.bottom() - (value - low) / (high - low) * frame.height,
        ]
    };
    let along = Ticks::at_least(STEPS[0] * (end - first) / frame.width);
    let up = Ticks::at_least(STEPS[1] * (high - low) / frame.height);
    pen.open("grid", Stroke::solid("#e6e6e6", 0.8));
    for place in along.labelled(first, end) {
        pen.line(at(place, low), at(place, high));
    }
    for value in up.labelled(low, high) {
        pen.line(at(first, value), at(end, value));
    }
    pen.close();
    for series in &strip.series {
        pen.open("series", stroke(series.look));
        for run in runs(&series.values) {
            curve(pen, run, series.look, &at);
        }
        pen.close();
    }
    pen.open("zero", Stroke::solid(INK, 0.8));
    pen.line(at(first, 0.0), at(end, 0.0));
    pen.close();
    pen.open("frame", Stroke::solid(INK, 1.0));
    pen.rect([frame.x, frame.y], [frame.width, frame.height]);
    pen.close();
    for value in up.labelled(low, high) {
        let [x, y] = at(first, value);
        pen.text("tick", [x - 7.0, y + 0.36 * TEXT], TEXT, Anchor::End, INK, &up.label(value));
    }
    if is_last {
        for place in along.labelled(first, end) {
            let [x, _] = at(place, low);
            pen.text("tick", [x, frame.bottom() + 18.0], TEXT, Anchor::Middle, INK, &along.label(place));
        }
    }
    pen.text("axis", [frame.x, frame.y - 7.0], TEXT, Anchor::Start, INK, &strip.name);
    let mut right = frame.right();
    for series in strip.series.iter().rev() {
        if series.name.is_empty() {
            continue;
        }
        pen.text("legend", [right, frame.y - 7.0], TEXT, Anchor::End, INK, &series.name);
        right -= text::width(&series.name, TEXT) + 6.0;
        let y = frame.y - 7.0 - 0.36 * TEXT;
        match series.look {
            Look::Band => pen.polygon(
                &[[right - 34.0, y - 5.0], [right, y - 5.0], [right, y + 5.0], [right - 34.0, y + 5.0]],
                "#dddddd",
            ),
            look => {
                pen.open("sample", stroke(look));
                pen.line([right - 34.0, y], [right, y]);
                pen.close();
            }
        }
        right -= 34.0 + 20.0;
    }
}

/// Stretches without a gap.
fn runs(values: &[[f64; 3]]) -> impl Iterator<Item = &[[f64; 3]]> {
    let is_there = |value: &[f64; 3]| value.iter().all(|part| part.is_finite());
    values.split(move |value| !is_there(value)).filter(|run| !run.is_empty())
}

fn curve(pen: &mut Pen, run: &[[f64; 3]], look: Look, at: &impl Fn(f64, f64) -> Point) {
    if look == Look::Band {
        let upper = run.iter().map(|[place, _, high]| at(*place, *high));
        let lower = run.iter().rev().map(|[place, low, _]| at(*place, *low));
        let corners: Vec<Point> = upper.chain(lower).collect();
        pen.polygon(&corners, "#dddddd");
        return;
    }
    // up and down between the limits, so that a peak shows however narrow it is
    let mut line = Vec::with_capacity(2 * run.len());
    let mut last = f64::NAN;
    for &[place, low, high] in run {
        let ends = if (high - last).abs() < (low - last).abs() { [high, low] } else { [low, high] };
        line.push(at(place, ends[0]));
        if (ends[1] - ends[0]).abs() > f64::EPSILON {
            line.push(at(place, ends[1]));
        }
        last = ends[1];
    }
    pen.path(&[line]);
}
