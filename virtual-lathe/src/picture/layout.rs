//! Where everything goes on the sheet: the main view, the panels of the insets and the title block.
//!
//! The insets stand in rows below the main view or in a column beside it, whichever shows the path at the larger
//! scale for the height it takes. Long paths end up above their insets, tall ones beside them.

use crate::picture::number::Ticks;
use crate::picture::text;
use crate::picture::view::{Rect, View, is_drawable};

/// Size of text, in units.
pub(crate) const TEXT: f64 = 13.0;
/// Height of a line of text.
pub(crate) const LINE: f64 = 18.0;
/// From the edge of the sheet to its border.
pub(crate) const BORDER: f64 = 10.0;
/// From the border to what it holds.
const MARGIN: f64 = 16.0;
/// Above a frame: the name of the X axis, or the heading of a panel.
const HEAD: f64 = 28.0;
/// Below the frame of the main view: labels and the name of the Z axis.
const FOOT: f64 = 42.0;
/// From the frame to a label: tick and gap.
pub(crate) const LABEL_GAP: f64 = 9.0;
/// Between neighbours.
const GAP: f64 = 20.0;
/// Room for half a label of the Z axis.
const OVERHANG: f64 = 14.0;
/// From this width, both captions of a panel stand in one line.
pub(crate) const WIDE_PANEL: f64 = 560.0;
/// Least distance of labels along Z.
const LABEL_STEP: f64 = 72.0;
/// The same along X, where labels stand above each other, if the frame is too low for three labels otherwise.
const LOW_LABEL_STEP: f64 = 36.0;
/// Least height of a frame.
const LEAST_HEIGHT: f64 = 150.0;
/// Panels in a row.
const PER_ROW: usize = 3;
/// Most panels in a column.
const PER_COLUMN: usize = 3;

/// The range of positions to show, in mm.
#[derive(Copy, Clone, Debug, PartialEq)]
pub(crate) struct Bounds {
    pub(crate) low: [f64; 2],
    pub(crate) high: [f64; 2],
}

/// A range narrower than this, in mm, is a point.
const A_POINT: f64 = 1e-6;

impl Bounds {
    /// Around all drawable `points`; the origin if there are none. The centre line belongs to them if it costs
    /// little scale.
    pub(crate) fn of(points: impl Iterator<Item = [f64; 2]>) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for [z, x] in points.filter(is_drawable) {
            low = [low[0].min(z), low[1].min(x)];
            high = [high[0].max(z), high[1].max(x)];
        }
        if low[0] > high[0] {
            (low, high) = ([0.0; 2], [0.0; 2]);
        }
        let [across, up] = [high[0] - low[0], high[1] - low[1]];
        let with_line = high[1].max(0.0) - low[1].min(0.0);
        if with_line <= (2.0 * up).max(0.45 * across) {
            low[1] = low[1].min(0.0);
            high[1] = high[1].max(0.0);
        }
        if across.max(up) < A_POINT {
            let [z, x] = low;
            (low, high) = ([z - 0.5, x - 0.5], [z + 0.5, x + 0.5]);
        }
        Self { low, high }
    }

    fn span(&self) -> [f64; 2] {
        [self.high[0] - self.low[0], self.high[1] - self.low[1]]
    }

    fn middle(&self) -> [f64; 2] {
        [f64::midpoint(self.low[0], self.high[0]), f64::midpoint(self.low[1], self.high[1])]
    }
}

/// A finished layout, in units.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    pub(crate) width: f64,
    pub(crate) height: f64,
    pub(crate) main: View,
    /// Ticks along Z and along X.
    pub(crate) ticks: [Ticks; 2],
    /// Frames of the panels.
    pub(crate) panels: Vec<Rect>,
    pub(crate) block: Rect,
}

/// Height of the captions under a panel.
fn caption(panel_width: f64) -> f64 {
    LINE * if panel_width < WIDE_PANEL { 2.0 } else { 1.0 } + 6.0
}

/// Frames alone, before the title block.
struct Arrangement {
    main: Rect,
    scale: f64,
    panels: Vec<Rect>,
    /// Where the title block may begin.
    bottom: f64,
}

impl Arrangement {
    /// Larger is better: the area of the path per height of the sheet.
    fn merit(&self) -> f64 {
        self.scale * self.scale / self.bottom
    }
}

/// What has to be arranged.
struct Task {
    width: f64,
    span: [f64; 2],
    insets: usize,
    /// Room for the labels of the X axis.
    gutter: f64,
    /// Room for dimensions under the work, inside the frame.
    foot: f64,
}

impl Task {
    /// Free room around the path in the frame: for marks, and for the numbers of insets.
    fn pad(&self) -> f64 {
        if self.insets == 0 { 30.0 } else { 48.0 }
    }

    fn left(&self) -> f64 {
        BORDER + MARGIN + self.gutter
    }

    /// Width of all frames together.
    fn across(&self) -> f64 {
        self.width - self.left() - OVERHANG - MARGIN - BORDER
    }

    /// Scale at which the path fits into a frame.
    fn scale(&self, width: f64, height: f64) -> f64 {
        let pad = 2.0 * self.pad();
        ((width - pad) / self.span[0]).min((height - pad - self.foot) / self.span[1])
    }

    /// Height of a frame around the path.
    fn height(&self, scale: f64) -> f64 {
        (self.span[1] * scale + 2.0 * self.pad() + self.foot).max(LEAST_HEIGHT)
    }

    fn top() -> f64 {
        BORDER + MARGIN + HEAD - 6.0
    }

    /// Panels in rows below the main view.
    fn below(&self) -> Arrangement {
        let across = self.across();
        let tallest = self.width * if self.insets == 0 { 0.75 } else { 0.6 };
        let scale = self.scale(across, tallest);
        let main = Rect { x: self.left(), y: Self::top(), width: across, height: self.height(scale) };
        let mut panels = Vec::new();
        let mut bottom = main.bottom() + FOOT;
        let mut left = self.insets;
        while left > 0 {
            let in_row = left.min(PER_ROW);
            left -= in_row;
            let count = in_row as f64;
            let width = (across - (count - 1.0) * GAP) / count;
            let height = (0.85 * width).min(0.36 * self.width);
            let y = bottom + GAP / 2.0 + HEAD;
            panels.extend((0..in_row).map(|k| Rect { x: main.x + k as f64 * (width + GAP), y, width, height }));
            bottom = y + height + caption(width);
        }
        Arrangement { main, scale, panels, bottom }
    }

    /// Panels in a column to the right of the main view, which they match in height.
    fn beside(&self) -> Arrangement {
        let frames = self.across() - GAP - OVERHANG;
        let count = self.insets.max(1) as f64;
        let scale = self.scale(0.62 * frames, 0.85 * self.width);
        let wanted = self.span[0] * scale + 2.0 * self.pad();
        let width = wanted.clamp(0.4 * frames, 0.62 * frames);
        let panel_width = frames - width;
        let between = HEAD + caption(panel_width) + GAP / 2.0;
        let least = 0.17 * self.width * count + between * (count - 1.0);
        let main = Rect {
            x: self.left(),
            y: Self::top(),
            width,
            height: self.height(scale).max(least).max(0.42 * self.width),
        };
        let height = (main.height - between * (count - 1.0)) / count;
        let panels = (0..self.insets).map(|k| Rect {
            x: main.right() + OVERHANG + GAP,
            y: main.y + k as f64 * (height + between),
            width: panel_width,
            height,
        });
        Arrangement {
            scale: self.scale(main.width, main.height).max(scale),
            panels: panels.collect(),
            bottom: main.bottom() + FOOT.max(caption(panel_width)),
            main,
        }
    }

    fn arranged(&self) -> Arrangement {
        let below = self.below();
        if !(1..=PER_COLUMN).contains(&self.insets) {
            return below;
        }
        let beside = self.beside();
        if beside.merit() > below.merit() { beside } else { below }
    }
}

/// Ticks along Z and along X: the same, unless the frame is low.
fn ticks(main: &View) -> [Ticks; 2] {
    let along_z = Ticks::at_least(LABEL_STEP / main.scale);
    let along_x = if along_z.labelled(main.low[1], main.high()[1]).len() < 3 {
        Ticks::at_least(LOW_LABEL_STEP / main.scale)
    } else {
        along_z.clone()
    };
    [along_z, along_x]
}

impl Layout {
    /// A sheet of the given width for a path within `bounds`; `block_height` is the height of the title block, `foot`
    /// that of what is written under the work.
    pub(crate) fn new(width: f64, bounds: &Bounds, insets: usize, block_height: f64, foot: f64) -> Self {
        let mut task = Task { width, span: bounds.span(), insets, gutter: 0.0, foot };
        // The labels need room, which changes the scale, which changes the labels: the room only grows.
        let (arrangement, main, ticks) = loop {
            let arrangement = task.arranged();
            let mut main = View::centred(arrangement.main, bounds.middle(), arrangement.scale);
            main.low[1] -= foot / 2.0 / arrangement.scale;
            let ticks = ticks(&main);
            let [_, along_x] = &ticks;
            let labels = along_x.labelled(main.low[1], main.high()[1]);
            let widest = labels.into_iter().map(|x| text::width(&along_x.label(x), TEXT)).fold(0.0, f64::max);
            let needed = widest + LABEL_GAP;
            if needed <= task.gutter {
                break (arrangement, main, ticks);
            }
            task.gutter = needed;
        };
        let block =
            Rect { x: BORDER, y: arrangement.bottom + MARGIN / 2.0, width: width - 2.0 * BORDER, height: block_height };
        Self { width, height: block.bottom() + BORDER, main, ticks, panels: arrangement.panels, block }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(across: f64, up: f64, insets: usize) -> Layout {
        let bounds = Bounds::of([[0.0, 0.0], [across, up]].into_iter());
        Layout::new(1_000.0, &bounds, insets, 90.0, 0.0)
    }

    #[test]
    fn long_paths_stand_above_their_insets_and_tall_ones_beside() {
        let long = layout(200.0, 5.0, 3);
        assert!(long.panels.iter().all(|panel| panel.y > long.main.rect.bottom()));
        let tall = layout(5.0, 200.0, 3);
        assert!(tall.panels.iter().all(|panel| panel.x > tall.main.rect.right()));
    }

    #[test]
    fn the_path_fits_and_frames_keep_apart() {
        for (across, up) in [(200.0, 5.0), (50.0, 50.0), (5.0, 200.0), (1.0, 0.0), (0.0, 1.0), (0.0, 0.0)] {
            for insets in 0..=7 {
                let sheet = layout(across, up, insets);
                let frame = sheet.main.rect;
                for point in [[0.0, 0.0], [across, up]] {
                    assert!(frame.inset(20.0).contains(sheet.main.at(point)), "{across} {up} {insets}");
                }
                let mut frames = sheet.panels.clone();
                assert_eq!(frames.len(), insets);
                frames.extend([frame, sheet.block]);
                for (k, a) in frames.iter().enumerate() {
                    assert!(a.width > 100.0 && a.height > 80.0, "{a:?}");
                    for b in frames.iter().skip(k + 1) {
                        let apart = a.right() <= b.x || b.right() <= a.x || a.bottom() <= b.y || b.bottom() <= a.y;
                        assert!(apart, "{a:?} {b:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_far_centre_line_is_left_out_and_a_near_one_is_not() {
        let near = Bounds::of([[0.0, 10.0], [100.0, 12.0]].into_iter());
        assert!(near.low[1].abs() < 1e-12);
        let far = Bounds::of([[0.0, 100.0], [1.0, 101.0]].into_iter());
        assert!((far.low[1] - 100.0).abs() < 1e-12);
    }
}
