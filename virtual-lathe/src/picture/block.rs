//! The title block: what the lines mean on the left, title and facts on the right.

use crate::picture::inset::{DOT, LATTICE, STEPS, TRUE_CURVE};
use crate::picture::layout::{LINE, TEXT};
use crate::picture::main_view::{CENTRE_LINE, stroke};
use crate::picture::pen::{Anchor, GREY, INK, Pen, Stroke};
use crate::picture::view::{Rect, is_drawable};
use crate::picture::{Drawing, Kind, Track, section, text};

/// Size of the title.
const TITLE: f64 = 19.0;
/// Height of a line of the title.
const TITLE_LINE: f64 = 25.0;
/// Most lines of title and of facts.
const MOST_LINES: [usize; 2] = [2, 5];
/// White room inside the cells.
const MARGIN: f64 = 14.0;
/// Part of the width for the legend.
const LEGEND_SHARE: f64 = 0.54;
/// Width of a sample, and from there to its name.
const SAMPLE: [f64; 2] = [38.0, 9.0];
/// Height of an entry of the legend.
const ENTRY: f64 = 21.0;
/// Between columns of the legend.
const COLUMN_GAP: f64 = 18.0;

/// What the legend explains.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Entry {
    Path(Kind),
    CentreLine,
    Section,
    Bar,
    Tool,
    Lattice,
    Visited,
    TrueCurve,
}

impl Entry {
    const fn name(self) -> &'static str {
        match self {
            Self::Path(Kind::Rapid) => "rapid",
            Self::Path(Kind::Feed) => "straight feed",
            Self::Path(Kind::Arc) => "arc feed",
            Self::Path(Kind::Thread) => "thread",
            Self::CentreLine => "centre line",
            Self::Section => "part, in section",
            Self::Bar => "bar before the cut",
            Self::Tool => "tool",
            Self::Lattice => "pulse lattice",
            Self::Visited => "points visited",
            Self::TrueCurve => "true curve",
        }
    }
}

/// The block, laid out for a width.
pub(crate) struct Block {
    title: Vec<String>,
    facts: Vec<String>,
    /// Columns of entries, with their widths.
    columns: Vec<(f64, Vec<Entry>)>,
    width: f64,
}

impl Block {
    /// Explains what `drawing` shows.
    pub(crate) fn new(drawing: &Drawing, shows_centre_line: bool, width: f64) -> Self {
        let is_shown = |kind: &Kind| {
            let mut tracks = drawing.tracks.iter();
            tracks.any(|track| track.kind == *kind && is_drawn(track))
        };
        let mut entries: Vec<Entry> =
            [Kind::Rapid, Kind::Feed, Kind::Arc, Kind::Thread].into_iter().filter(is_shown).map(Entry::Path).collect();
        if shows_centre_line {
            entries.push(Entry::CentreLine);
        }
        if let Some(section) = &drawing.section {
            entries.extend([Entry::Section, Entry::Bar]);
            entries.extend((!section.tool.is_empty()).then_some(Entry::Tool));
        }
        if !drawing.insets.is_empty() {
            entries.extend([Entry::Lattice, Entry::Visited, Entry::TrueCurve]);
        }
        let legend_room = LEGEND_SHARE * width - 2.0 * MARGIN;
        let text_room = (1.0 - LEGEND_SHARE) * width - 2.0 * MARGIN;
        Self {
            title: text::wrap(&drawing.title, TITLE, text_room, MOST_LINES[0]),
            facts: text::wrap(&drawing.subtitle, TEXT, text_room, MOST_LINES[1]),
            columns: columns(&entries, legend_room),
            width,
        }
    }

    /// In units.
    pub(crate) fn height(&self) -> f64 {
        let rows = self.columns.iter().map(|(_, entries)| entries.len()).max();
        let legend = rows.unwrap_or(0) as f64 * ENTRY;
        legend.max(self.text_height()) + 2.0 * MARGIN
    }

    fn text_height(&self) -> f64 {
        self.title.len() as f64 * TITLE_LINE + self.facts.len() as f64 * LINE
    }

    /// Draws it into `frame`.
    pub(crate) fn draw(&self, pen: &mut Pen, frame: Rect) {
        let split = frame.x + LEGEND_SHARE * self.width;
        pen.open("block", Stroke::solid(INK, 1.0));
        pen.line([frame.x, frame.y], [frame.right(), frame.y]);
        pen.line([split, frame.y], [split, frame.bottom()]);
        pen.close();
        let mut left = frame.x + MARGIN;
        for (width, entries) in &self.columns {
            let mut y = frame.y + MARGIN + ENTRY / 2.0;
            for entry in entries {
                sample(pen, *entry, [left, y]);
                let at = [left + SAMPLE[0] + SAMPLE[1], y + 0.36 * TEXT];
                pen.text("legend", at, TEXT, Anchor::Start, INK, entry.name());
                y += ENTRY;
            }
            left += width + COLUMN_GAP;
        }
        let left = split + MARGIN;
        let mut y = frame.y + MARGIN + 0.8 * TITLE;
        for line in &self.title {
            pen.text("title", [left, y], TITLE, Anchor::Start, INK, line);
            y += TITLE_LINE;
        }
        y -= if self.title.is_empty() { 3.0 } else { 1.0 };
        for line in &self.facts {
            pen.text("facts", [left, y], TEXT, Anchor::Start, GREY, line);
            y += LINE;
        }
    }
}

/// Whether anything shows of a track.
fn is_drawn(track: &Track) -> bool {
    let points = track.points.iter();
    points.filter(|point| is_drawable(point)).count() > 1
}

/// Entries in three columns, or fewer if those are too wide.
fn columns(entries: &[Entry], room: f64) -> Vec<(f64, Vec<Entry>)> {
    let mut columns = Vec::new();
    for count in [3, 2, 1] {
        let rows = entries.len().div_ceil(count).max(1);
        columns = entries
            .chunks(rows)
            .map(|chunk| {
                let widest = chunk.iter().map(|entry| text::width(entry.name(), TEXT)).fold(0.0, f64::max);
                (SAMPLE[0] + SAMPLE[1] + widest, chunk.to_vec())
            })
            .collect();
        let gaps = columns.len().saturating_sub(1) as f64 * COLUMN_GAP;
        let width: f64 = columns.iter().map(|(width, _)| width).sum();
        if width + gaps <= room {
            break;
        }
    }
    columns
}

/// A piece of what the entry explains, from `left` on, centred on `y`.
fn sample(pen: &mut Pen, entry: Entry, [left, y]: [f64; 2]) {
    let right = left + SAMPLE[0];
    let line = |pen: &mut Pen, stroke| {
        pen.open("sample", stroke);
        pen.line([left, y], [right, y]);
        pen.close();
    };
    match entry {
        Entry::Path(kind) => line(pen, stroke(kind)),
        Entry::CentreLine => line(pen, CENTRE_LINE),
        Entry::TrueCurve => line(pen, TRUE_CURVE),
        Entry::Bar => line(pen, section::BAR),
        Entry::Section => section::sample(pen, [left, y - 6.0], [SAMPLE[0], 12.0]),
        Entry::Tool => {
            pen.open("sample", section::TOOL);
            pen.shape(&[[left + 4.0, y - 6.0], [left + 16.0, y + 6.0], [left + 32.0, y - 6.0]], section::TOOL_FILL);
            pen.close();
        }
        Entry::Lattice => {
            pen.open("sample", LATTICE);
            for k in 0..4 {
                let x = left + 4.0 + 10.0 * f64::from(k);
                pen.line([x, y - 8.0], [x, y + 8.0]);
            }
            for k in -1..=1 {
                let y = y + 5.0 * f64::from(k);
                pen.line([left, y], [right, y]);
            }
            pen.close();
        }
        Entry::Visited => {
            let points = [[left + 5.0, y + 4.0], [left + 19.0, y + 4.0], [left + 33.0, y - 4.0]];
            pen.open("sample", STEPS);
            pen.path(&[points.to_vec()]);
            pen.dots(&points, 0.8 * DOT, INK);
            pen.close();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_legend_takes_fewer_columns_when_room_is_short() {
        let all = [
            Entry::Path(Kind::Rapid),
            Entry::Path(Kind::Feed),
            Entry::Path(Kind::Arc),
            Entry::CentreLine,
            Entry::Lattice,
            Entry::Visited,
            Entry::TrueCurve,
        ];
        assert_eq!(columns(&all, 600.0).len(), 3);
        assert_eq!(columns(&all, 350.0).len(), 2);
        assert_eq!(columns(&all, 100.0).len(), 1);
        assert!(columns(&[], 100.0).is_empty());
    }
}
