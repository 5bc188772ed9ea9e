//! Puts the sheet together.

use crate::picture::block::Block;
use crate::picture::layout::{BORDER, Bounds, Layout};
use crate::picture::pen::{INK, Pen, Stroke};
use crate::picture::view::is_drawable;
use crate::picture::{Drawing, inset, main_view, section};

/// Width in pixels at which a unit is a pixel.
const PLAIN_WIDTH: f64 = 1_000.0;

/// Widths in pixels beyond which the sheet is only magnified.
const WIDTHS: [f64; 2] = [600.0, 8_000.0];

/// How fast the sheet grows in units with its width in pixels.
const GROWTH: f64 = 0.25;

impl Drawing {
    /// The drawing as an SVG document `width_px` wide; its height follows from what it shows.
    ///
    /// Lines and text keep a fixed size in units, of which the sheet has 1000 at 1000 pixels and a little more on
    /// wider ones (1316 at 3000): text grows with the sheet, but slower, and leaves more of it to the path.
    #[must_use]
    pub fn svg(&self, width_px: u32) -> String {
        if !self.insets.iter().all(|inset| is_drawable(&inset.centre)) {
            let mut drawing = self.clone();
            drawing.insets.retain(|inset| is_drawable(&inset.centre));
            return drawing.svg(width_px);
        }
        let width_px = width_px.max(1);
        let width = f64::from(width_px).clamp(WIDTHS[0], WIDTHS[1]);
        let units = PLAIN_WIDTH * (width / PLAIN_WIDTH).powf(GROWTH);
        let tracks = self.tracks.iter().flat_map(|track| &track.points);
        let places = self.insets.iter().map(|inset| &inset.centre);
        let points = tracks.chain(places).chain([&self.start, &self.end]);
        let corners = self.section.iter().flat_map(section::corners);
        let bounds = Bounds::of(points.copied().chain(corners));
        let foot = self.section.as_ref().map_or(0.0, section::foot);
        let is_on_line = bounds.low[1] <= 0.0 && bounds.high[1] >= 0.0;
        let block_width = units - 2.0 * BORDER;
        let mut block = Block::new(self, is_on_line, block_width);
        let mut layout = Layout::new(units, &bounds, self.insets.len(), block.height(), foot);
        if main_view::shows_centre_line(&layout.main) != is_on_line {
            // The margin around the path has brought it into sight.
            block = Block::new(self, !is_on_line, block_width);
            layout = Layout::new(units, &bounds, self.insets.len(), block.height(), foot);
        }
        let mut pen = Pen::sheet(layout.width, layout.height, width_px);
        main_view::draw(&mut pen, self, &layout);
        for ((inset, frame), number) in self.insets.iter().zip(&layout.panels).zip(1..) {
            inset::draw(&mut pen, inset, number, *frame);
        }
        pen.open("border", Stroke::solid(INK, 1.4));
        pen.rect([BORDER, BORDER], [layout.width - 2.0 * BORDER, layout.height - 2.0 * BORDER]);
        pen.close();
        block.draw(&mut pen, layout.block);
        pen.finish()
    }
}
