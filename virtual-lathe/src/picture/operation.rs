//! The sheet of a scenario: the tool's path, and over time the mode, X and Z, the wheels, and what went wrong.
//!
//! Where the operator leads the tool off its program, the program is seen beside the tool: dashed in a second colour.

use crate::picture::number::{Ticks, brief};
use crate::picture::pen::{Anchor, GREY, INK, Pen, Point, Stroke};
pub use crate::picture::requests::Request;
use crate::picture::requests::{self, Flag};
use crate::picture::text;
use crate::picture::thin::thinned;
use crate::picture::view::Rect;

/// A moment: where the program and the tool are, `[z, x]` in mm.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Moment {
    /// Seconds.
    pub time: f64,
    /// The program's place.
    pub programmed: [f64; 2],
    /// The tool's.
    pub moved: [f64; 2],
    /// Both were set to other coordinates before this moment: no line leads here.
    pub jumps: bool,
}

impl Moment {
    /// Whether the tool is beside its program.
    fn is_led_off(&self) -> bool {
        self.programmed.iter().zip(self.moved).any(|(program, tool)| (program - tool).abs() > SAME)
    }
}

/// A stretch of time with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    /// From, seconds.
    pub from: f64,
    /// To, seconds.
    pub to: f64,
    /// What is written in it.
    pub name: String,
}

/// A mark.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Seconds.
    pub time: f64,
    /// What it is.
    pub name: String,
    /// An alarm; else a refusal.
    pub is_alarm: bool,
}

/// All that the sheet shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Operation {
    /// Name of the scenario.
    pub title: String,
    /// Facts beside it.
    pub subtitle: String,
    /// In the order of time.
    pub moments: Vec<Moment>,
    /// Modes, in the order of time.
    pub modes: Vec<Stretch>,
    /// What hands do, a row each: its name and when.
    pub hands: Vec<(String, Vec<Stretch>)>,
    /// What else was asked for, in the order of time.
    pub requests: Vec<Request>,
    /// Refusals and alarms.
    pub marks: Vec<Mark>,
}

const TEXT: f64 = 13.0;
const MARGIN: f64 = 16.0;
/// Left of the frames: labels.
const GUTTER: f64 = 78.0;
const TITLE: f64 = 44.0;
/// Heights of the path, a strip of time, a row.
const PATH: [f64; 2] = [150.0, 430.0];
const STRIP: f64 = 130.0;
const ROW: f64 = 22.0;
const HEAD: f64 = 28.0;
const FOOT: f64 = 44.0;
const LEGEND: f64 = 19.0;
/// Least distance of labels, along and up.
const STEPS: [f64; 2] = [80.0, 30.0];
/// Thinning of lines, units.
const FINE: f64 = 0.15;
/// Places that differ by less are one, mm.
const SAME: f64 = 1e-9;
/// Between what is told of two marks.
const BETWEEN: &str = "  \u{b7}  ";
/// Marks that are told by name.
const TOLD: usize = 24;

const PROGRAM: Stroke = Stroke { colour: "#1668b8", width: 1.3, dashes: "6 3" };
const TOOL: Stroke = Stroke::solid(INK, 1.5);
const GRID: Stroke = Stroke::solid("#e6e6e6", 0.8);
const ALARM: &str = "#c0392b";
const REFUSAL: &str = "#b8860b";
/// Of the modes: each has the same in every picture.
const BANDS: [(&str, &str); 8] = [
    ("handwheel", "#e6f0e6"),
    ("power", "#e3eef0"),
    ("linked", "#e8eef5"),
    ("auto", "#f3ecdf"),
    ("mdi", "#efe9f4"),
    ("home", "#f2e6ec"),
    ("retrace", "#f6efc9"),
    ("no power", "#d9d9d9"),
];

impl Operation {
    /// The sheet as an SVG document `width_px` wide.
    #[must_use]
    pub fn svg(&self, width_px: u32) -> String {
        let units = 1_000.0 * (f64::from(width_px.clamp(600, 8_000)) / 1_000.0).powf(0.25);
        let frame_width = units - 3.0 * MARGIN - GUTTER;
        let ([low, high], scale, path_height) = self.window(frame_width);
        let rows = count(self.hands.len());
        let told = self.legend(units - 2.0 * MARGIN - 12.0);
        let strips = MARGIN + TITLE + HEAD + path_height + FOOT;
        let flags = requests::flags(&self.requests, self.span(), frame_width);
        let lane = requests::height(&flags);
        let hands = strips + ROW + 12.0 + lane + 2.0 * (STRIP + HEAD);
        let legend = hands + rows * (ROW + 4.0) + FOOT + 6.0;
        let height = legend + count(told.len()) * LEGEND + MARGIN;
        let mut pen = Pen::sheet(units, height, width_px.max(1));
        pen.open("border", Stroke::solid(INK, 1.4));
        pen.rect([MARGIN / 2.0; 2], [units - MARGIN, height - MARGIN]);
        pen.close();
        self.head(&mut pen, units);
        let at = |y: f64, height: f64| Rect { x: MARGIN + GUTTER, y, width: frame_width, height };
        self.path(&mut pen, at(MARGIN + TITLE + HEAD, path_height), low, high, scale);
        let mut y = strips;
        let mut frames = vec![at(y, ROW)];
        self.bands(&mut pen, at(y, ROW));
        Self::asked(&mut pen, at(y + ROW, lane), &flags);
        y += ROW + 12.0 + lane + HEAD / 2.0;
        for (name, part) in [("X, mm (radius)", 1), ("Z, mm", 0)] {
            self.strip(&mut pen, at(y, STRIP), name, part);
            frames.push(at(y, STRIP));
            y += STRIP + HEAD;
        }
        y -= HEAD / 2.0;
        for (row, (name, turns)) in self.hands.iter().enumerate() {
            let frame = at(y + count(row) * (ROW + 4.0), ROW);
            self.row(&mut pen, frame, name, turns);
            frames.push(frame);
        }
        self.time(&mut pen, at(y, rows * (ROW + 4.0)), &frames);
        for (number, line) in told.iter().enumerate() {
            let at = [MARGIN + 6.0, legend + (count(number) + 0.7) * LEGEND];
            pen.text("legend", at, TEXT, Anchor::Start, INK, line);
        }
        pen.finish()
    }

    fn head(&self, pen: &mut Pen, units: f64) {
        let (left, room) = (MARGIN + 6.0, units - 2.0 * MARGIN);
        let title = text::fit(&self.title, 19.0, 0.62 * room);
        pen.text("title", [left, MARGIN + 24.0], 19.0, Anchor::Start, INK, &title);
        let facts = text::fit(&self.subtitle, TEXT, room - text::width(&title, 19.0) - 40.0);
        pen.text("facts", [units - left, MARGIN + 23.0], TEXT, Anchor::End, GREY, &facts);
    }

    /// What the path's frame shows, mm; units a mm; its height.
    fn window(&self, width: f64) -> ([[f64; 2]; 2], f64, f64) {
        let places = self.moments.iter().flat_map(|moment| [moment.programmed, moment.moved]);
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for [z, x] in places {
            (low, high) = ([low[0].min(z), low[1].min(x)], [high[0].max(z), high[1].max(x)]);
        }
        if low[0] > high[0] {
            (low, high) = ([0.0; 2], [0.0; 2]);
        }
        // a tool that stands still has a window, too
        let span = (high[0] - low[0]).max(high[1] - low[1]).max(0.01);
        let pad = 0.07 * span;
        let [wide, tall] = [high[0] - low[0] + 2.0 * pad, high[1] - low[1] + 2.0 * pad];
        let scale = (width / wide).min((PATH[1]) / tall);
        let height = (tall * scale).clamp(PATH[0], PATH[1]);
        let middle = [f64::midpoint(low[0], high[0]), f64::midpoint(low[1], high[1])];
        let half = [width / scale / 2.0, height / scale / 2.0];
        let window = [[middle[0] - half[0], middle[1] - half[1]], [middle[0] + half[0], middle[1] + half[1]]];
        (window, scale, height)
    }

    fn path(&self, pen: &mut Pen, frame: Rect, low: [f64; 2], high: [f64; 2], scale: f64) {
        let at =
            |[z, x]: [f64; 2]| -> Point { [frame.x + (z - low[0]) * scale, frame.bottom() - (x - low[1]) * scale] };
        let along = Ticks::at_least(STEPS[0] / scale);
        pen.open("grid", GRID);
        for z in along.labelled(low[0], high[0]) {
            pen.line(at([z, low[1]]), at([z, high[1]]));
        }
        for x in along.labelled(low[1], high[1]) {
            pen.line(at([low[0], x]), at([high[0], x]));
        }
        pen.close();
        self.lines(pen, "tool", TOOL, |_| true, |moment| at(moment.moved));
        self.lines(pen, "program", PROGRAM, Moment::is_led_off, |moment| at(moment.programmed));
        let ends = [(self.moments.first(), 6.5, "#ffffff"), (self.moments.last(), 3.5, INK)];
        pen.open("ends", Stroke::solid(INK, 1.4));
        for (moment, radius, fill) in ends {
            if let Some(moment) = moment {
                pen.circle(at(moment.moved), radius, Some(fill));
            }
        }
        pen.close();
        let mut taken: Vec<Point> = Vec::new();
        for (number, mark) in self.marks.iter().enumerate().take(TOLD) {
            let Some(moment) = self.moments.iter().rfind(|moment| moment.time <= mark.time) else { continue };
            let mut place = at(moment.moved);
            place[1] -= 13.0;
            // several at one place stand side by side
            while taken.iter().any(|other| (other[0] - place[0]).abs() < 15.0 && (other[1] - place[1]).abs() < 15.0) {
                place[0] += 16.0;
                if place[0] > frame.right() - 9.0 {
                    place = [at(moment.moved)[0].min(frame.right() - 9.0), place[1] - 16.0];
                }
            }
            taken.push(place);
            balloon(pen, place, number + 1, mark.is_alarm);
        }
        frame_of(pen, frame);
        for z in along.labelled(low[0], high[0]) {
            let [x, _] = at([z, low[1]]);
            pen.text("tick", [x, frame.bottom() + 18.0], TEXT, Anchor::Middle, INK, &along.label(z));
        }
        for x in along.labelled(low[1], high[1]) {
            let [_, y] = at([low[0], x]);
            pen.text("tick", [frame.x - 7.0, y + 0.36 * TEXT], TEXT, Anchor::End, INK, &along.label(x));
        }
        pen.text("axis", [frame.x, frame.y - 9.0], TEXT, Anchor::Start, INK, "X in mm (radius), over Z in mm");
        let mut right = frame.right();
        let lines = [("tool", TOOL), ("program", PROGRAM)];
        let shown = if self.moments.iter().any(Moment::is_led_off) { 2 } else { 1 };
        for (name, stroke) in lines.into_iter().take(shown) {
            pen.text("legend", [right, frame.y - 9.0], TEXT, Anchor::End, INK, name);
            right -= text::width(name, TEXT) + 6.0;
            pen.open("sample", stroke);
            pen.line([right - 34.0, frame.y - 13.5], [right, frame.y - 13.5]);
            pen.close();
            right -= 34.0 + 20.0;
        }
    }

    /// A line through all moments that are `shown`, with gaps where coordinates were set.
    fn lines(
        &self,
        pen: &mut Pen,
        class: &str,
        stroke: Stroke,
        shown: impl Fn(&Moment) -> bool,
        at: impl Fn(&Moment) -> Point,
    ) {
        let mut runs: Vec<Vec<Point>> = Vec::new();
        let mut gap = true;
        for moment in &self.moments {
            if !shown(moment) {
                gap = true;
                continue;
            }
            match runs.last_mut() {
                Some(run) if !moment.jumps && !gap => run.push(at(moment)),
                _ => runs.push(vec![at(moment)]),
            }
            gap = false;
        }
        pen.open(class, stroke);
        pen.path(&runs.iter().map(|run| thinned(run, FINE)).collect::<Vec<_>>());
        pen.close();
    }

    fn span(&self) -> f64 {
        self.moments.last().map_or(1.0, |moment| moment.time).max(1e-3)
    }

    fn bands(&self, pen: &mut Pen, frame: Rect) {
        for band in &self.modes {
            let fill = BANDS.iter().find(|(name, _)| *name == band.name).map_or("#ffffff", |(_, colour)| colour);
            self.boxed(pen, frame, band, fill, 0.0);
        }
        frame_of(pen, frame);
        pen.text("axis", [frame.x - 7.0, frame.y + 15.0], TEXT, Anchor::End, INK, "mode");
    }

    /// What was asked for, under the modes.
    fn asked(pen: &mut Pen, lane: Rect, flags: &[Flag]) {
        if lane.height > 0.0 {
            requests::draw(pen, lane, flags);
            pen.text("axis", [lane.x - 7.0, lane.y + requests::ROW], TEXT, Anchor::End, INK, "asked");
        }
    }

    /// A stretch of a row with its name, where there is room for it inside, or in so many units behind it.
    fn boxed(&self, pen: &mut Pen, frame: Rect, stretch: &Stretch, fill: &str, behind: f64) {
        let x = |time: f64| frame.x + time.min(self.span()) / self.span() * frame.width;
        let (left, right) = (x(stretch.from), x(stretch.to).max(x(stretch.from) + 1.5));
        let (top, bottom) = (frame.y, frame.bottom());
        pen.polygon(&[[left, top], [right, top], [right, bottom], [left, bottom]], fill);
        let width = text::width(&stretch.name, TEXT);
        if width + 6.0 <= right - left {
            pen.text("name", [f64::midpoint(left, right), top + 15.5], TEXT, Anchor::Middle, INK, &stretch.name);
        } else if width + 6.0 <= behind {
            pen.text("name", [right + 3.0, top + 15.5], TEXT, Anchor::Start, INK, &stretch.name);
        }
    }

    fn row(&self, pen: &mut Pen, frame: Rect, name: &str, turns: &[Stretch]) {
        let nexts = turns.iter().skip(1).map(|turn| turn.from).chain([self.span()]);
        for (turn, next) in turns.iter().zip(nexts) {
            let behind = (next - turn.to) / self.span() * frame.width;
            self.boxed(pen, frame, turn, "#cfdcea", behind);
        }
        frame_of(pen, frame);
        pen.text("axis", [frame.x - 7.0, frame.y + 15.0], TEXT, Anchor::End, INK, name);
    }

    /// X or Z over time.
    fn strip(&self, pen: &mut Pen, frame: Rect, name: &str, part: usize) {
        let value = |place: [f64; 2]| place.get(part).copied().unwrap_or(0.0);
        let values = || self.moments.iter().flat_map(|moment| [value(moment.programmed), value(moment.moved)]);
        let (low, high) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        let (low, high) = if low > high { (0.0, 0.0) } else { (low, high) };
        let pad = (0.08 * (high - low)).max(0.005);
        let (low, high) = (low - pad, high + pad);
        let span = self.span();
        let at = |time: f64, value: f64| -> Point {
            [frame.x + time / span * frame.width, frame.bottom() - (value - low) / (high - low) * frame.height]
        };
        let (along, up) =
            (Ticks::at_least(STEPS[0] * span / frame.width), Ticks::at_least(STEPS[1] * (high - low) / frame.height));
        pen.open("grid", GRID);
        for time in along.labelled(0.0, span) {
            pen.line(at(time, low), at(time, high));
        }
        for value in up.labelled(low, high) {
            pen.line(at(0.0, value), at(span, value));
        }
        pen.close();
        self.lines(pen, "tool", TOOL, |_| true, |moment| at(moment.time, value(moment.moved)));
        let led_off = |moment: &Moment| (value(moment.programmed) - value(moment.moved)).abs() > SAME;
        self.lines(pen, "program", PROGRAM, led_off, |moment| at(moment.time, value(moment.programmed)));
        frame_of(pen, frame);
        for value in up.labelled(low, high) {
            let [x, y] = at(0.0, value);
            pen.text("tick", [x - 7.0, y + 0.36 * TEXT], TEXT, Anchor::End, INK, &up.label(value));
        }
        pen.text("axis", [frame.x, frame.y - 6.0], TEXT, Anchor::Start, INK, name);
    }

    /// The labels of time, and the marks over all frames.
    fn time(&self, pen: &mut Pen, last: Rect, frames: &[Rect]) {
        let top = frames.first().map_or(last.y, |frame| frame.y);
        let span = self.span();
        let x = |time: f64| last.x + time / span * last.width;
        let along = Ticks::at_least(STEPS[0] * span / last.width);
        for time in along.labelled(0.0, span) {
            let at = [x(time), last.bottom() + 18.0];
            pen.text("tick", at, TEXT, Anchor::Middle, INK, &along.label(time));
        }
        pen.text("axis", [last.right(), last.bottom() + 36.0], TEXT, Anchor::End, GREY, "time, s");
        let mut right_of = f64::NEG_INFINITY;
        for (number, mark) in self.marks.iter().enumerate().take(TOLD) {
            let place = x(mark.time);
            pen.open("mark", Stroke { colour: colour(mark.is_alarm), width: 1.1, dashes: "3 3" });
            for frame in frames {
                pen.line([place, frame.y], [place, frame.bottom()]);
            }
            pen.close();
            let shown = place.max(right_of + 16.0);
            right_of = shown;
            balloon(pen, [shown, top - 11.0], number + 1, mark.is_alarm);
        }
    }

    /// What the numbers stand for, in lines as wide as there is room.
    fn legend(&self, room: f64) -> Vec<String> {
        let mut lines: Vec<String> = Vec::new();
        for (number, mark) in self.marks.iter().enumerate().take(TOLD) {
            let kind = if mark.is_alarm { "alarm" } else { "refused" };
            let item = format!("{} {kind}: {} at {} s", number + 1, mark.name, brief(mark.time, 3));
            match lines.last_mut() {
                Some(line) if text::width(&format!("{line}{BETWEEN}{item}"), TEXT) <= room => {
                    line.push_str(BETWEEN);
                    line.push_str(&item);
                }
                _ => lines.push(item),
            }
        }
        if self.marks.len() > TOLD {
            lines.push(format!("and {} more", self.marks.len() - TOLD));
        }
        lines
    }
}

const fn colour(is_alarm: bool) -> &'static str {
    if is_alarm { ALARM } else { REFUSAL }
}

/// A number in a circle.
fn balloon(pen: &mut Pen, [x, y]: Point, number: usize, is_alarm: bool) {
    pen.open("balloon", Stroke::solid("#ffffff", 0.8));
    pen.circle([x, y], 8.0, Some(colour(is_alarm)));
    pen.close();
    pen.text("number", [x, y + 3.8], 10.5, Anchor::Middle, "#ffffff", &number.to_string());
}

fn frame_of(pen: &mut Pen, frame: Rect) {
    pen.open("frame", Stroke::solid(INK, 1.0));
    pen.rect([frame.x, frame.y], [frame.width, frame.height]);
    pen.close();
}

#[expect(clippy::cast_precision_loss, reason = "a few rows")]
const fn count(number: usize) -> f64 {
    number as f64
}
