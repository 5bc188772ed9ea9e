//! Animations: drawings one after the other, in shades of grey.

use std::fmt::Display;
use std::ops::Range;

use crate::picture::PictureError;
use crate::picture::raster::{Grey, grey};

/// Time of a drawing, in hundredths of a second.
const DELAY: u16 = 8;
/// The last drawing stands longer.
const LAST_DELAY: u16 = 250;
/// Shades that a GIF gets: the six upper bits of each pixel.
const SHADES: u8 = 64;

impl Grey {
    /// Rows that differ from another picture of the same size; at least one.
    fn changed_rows(&self, before: Option<&Self>) -> Range<usize> {
        let across = usize::try_from(self.width).unwrap_or(1).max(1);
        let all = 0..self.pixels.len() / across;
        let Some(before) = before else { return all };
        let rows = self.pixels.chunks(across).zip(before.pixels.chunks(across));
        let mut changed = rows.enumerate().filter(|(_, (a, b))| a != b).map(|(row, _)| row);
        let first = changed.next().unwrap_or(0);
        first..changed.next_back().unwrap_or(first) + 1
    }
}

/// Kind of file.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Form {
    /// GIF 89a, which repeats for ever.
    Gif,
    /// Animated PNG; a viewer that can't animate shows the first drawing.
    Png,
}

/// An animation in the making.
pub struct Film {
    form: Form,
    frames: Vec<Grey>,
}

impl Film {
    /// Without a drawing yet.
    #[must_use]
    pub fn new(form: Form) -> Self {
        Self { form, frames: Vec::new() }
    }

    /// Adds a drawing, rendered `width_px` wide. All have one size.
    ///
    /// # Errors
    /// Those of [`png`](crate::picture::png), and [`PictureError::Encoding`] for a drawing of another size.
    pub fn add(&mut self, svg: &str, width_px: u32) -> Result<(), PictureError> {
        let frame = grey(svg, width_px)?;
        let is_other = |first: &Grey| (first.width, first.height) != (frame.width, frame.height);
        if self.frames.first().is_some_and(is_other) {
            return Err(PictureError::Encoding);
        }
        self.frames.push(frame);
        Ok(())
    }

    /// The file.
    ///
    /// # Errors
    /// [`PictureError::Encoding`], also where there is no drawing.
    pub fn finish(self) -> Result<Vec<u8>, PictureError> {
        match self.form {
            Form::Gif => self.gif(),
            Form::Png => self.png(),
        }
    }

    /// Each drawing with its time.
    fn timed(&self) -> impl Iterator<Item = (&Grey, u16)> {
        let last = self.frames.len().saturating_sub(1);
        self.frames.iter().enumerate().map(move |(k, frame)| (frame, if k == last { LAST_DELAY } else { DELAY }))
    }

    fn gif(&self) -> Result<Vec<u8>, PictureError> {
        let first = self.frames.first().ok_or(PictureError::Encoding)?;
        let side = |pixels: u32| u16::try_from(pixels).map_err(failed);
        let (width, height) = (side(first.width)?, side(first.height)?);
        let palette: Vec<u8> = (0..SHADES).flat_map(|shade| [shade << 2 | shade >> 4; 3]).collect();
        let mut bytes = Vec::new();
        let mut encoder = gif::Encoder::new(&mut bytes, width, height, &palette).map_err(failed)?;
        encoder.set_repeat(gif::Repeat::Infinite).map_err(failed)?;
        let mut before: Option<&Grey> = None;
        for (frame, delay) in self.timed() {
            // only the rows that have changed: most of a drawing stands still
            let rows = frame.changed_rows(before);
            let across = usize::from(width);
            let part = frame.pixels.get(rows.start * across..rows.end * across).unwrap_or(&frame.pixels);
            let pixels: Vec<u8> = part.iter().map(|pixel| pixel >> 2).collect();
            let tall = u16::try_from(rows.len()).map_err(failed)?;
            let mut image = gif::Frame::from_indexed_pixels(width, tall, pixels, None);
            image.top = u16::try_from(rows.start).map_err(failed)?;
            image.delay = delay;
            encoder.write_frame(&image).map_err(failed)?;
            before = Some(frame);
        }
        drop(encoder);
        Ok(bytes)
    }

    fn png(&self) -> Result<Vec<u8>, PictureError> {
        let first = self.frames.first().ok_or(PictureError::Encoding)?;
        let count = u32::try_from(self.frames.len()).map_err(failed)?;
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, first.width, first.height);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_animated(count, 0).map_err(failed)?;
        let mut writer = encoder.write_header().map_err(failed)?;
        for (frame, delay) in self.timed() {
            writer.set_frame_delay(delay, 100).map_err(failed)?;
            writer.write_image_data(&frame.pixels).map_err(failed)?;
        }
        writer.finish().map_err(failed)?;
        Ok(bytes)
    }
}

/// What an encoder says helps nobody who only asked for a picture.
fn failed(_: impl Display) -> PictureError {
    PictureError::Encoding
}
