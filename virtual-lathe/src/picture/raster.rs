//! Renders SVG to PNG with the embedded font and no other.

use std::fmt;
use std::sync::{Arc, LazyLock};

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg;
use usvg::fontdb::{Database, Source};

use crate::picture::text;

/// Longest side of an image, in pixels: bounds the memory it takes.
const LONGEST_SIDE: u32 = 16_384;

/// Why there is no image.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum PictureError {
    /// The text is not an SVG document.
    NotSvg,
    /// The image has no size, or is too large.
    Size {
        /// Width asked for, in pixels.
        width: u32,
        /// Largest width and height, in pixels.
        limit: u32,
    },
    /// The encoder of PNG failed.
    Encoding,
}

impl fmt::Display for PictureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotSvg => f.write_str("not an SVG document"),
            Self::Size { width, limit } => {
                write!(f, "no image {width} pixels wide: sides are 1 to {limit}")
            }
            Self::Encoding => f.write_str("the PNG could not be encoded"),
        }
    }
}

impl std::error::Error for PictureError {}

/// The fonts of the renderer: one.
static FONTS: LazyLock<Arc<Database>> = LazyLock::new(|| {
    let mut fonts = Database::new();
    fonts.load_font_source(Source::Binary(Arc::new(text::face())));
    for set_family in [Database::set_serif_family, Database::set_sans_serif_family, Database::set_monospace_family] {
        set_family(&mut fonts, text::FAMILY);
    }
    Arc::new(fonts)
});

/// Renders an SVG document `width_px` wide, as high as its proportions ask, on white, as 8-bit RGB.
///
/// # Errors
///
/// [`PictureError::NotSvg`] if `svg` cannot be parsed; [`PictureError::Size`] if a side would be 0 or more than
/// 16 384 pixels.
pub fn png(svg: &str, width_px: u32) -> Result<Vec<u8>, PictureError> {
    let image = render(svg, width_px)?;
    encode(&image).ok_or(PictureError::Encoding)
}

/// A picture in shades of grey.
pub(crate) struct Grey {
    pub(crate) width: u32,
    pub(crate) height: u32,
    /// A byte a pixel, row by row; 255 is white.
    pub(crate) pixels: Vec<u8>,
}

/// Renders an SVG document in shades of grey.
pub(crate) fn grey(svg: &str, width_px: u32) -> Result<Grey, PictureError> {
    let image = render(svg, width_px)?;
    // luma of ITU-R BT.601, in 1/256
    let luma = |r: u8, g: u8, b: u8| (u32::from(r) * 77 + u32::from(g) * 150 + u32::from(b) * 29) >> 8;
    let shade = |value: u32| u8::try_from(value).unwrap_or(u8::MAX);
    let pixels = image.pixels().iter().map(|pixel| shade(luma(pixel.red(), pixel.green(), pixel.blue()))).collect();
    Ok(Grey { width: image.width(), height: image.height(), pixels })
}

fn render(svg: &str, width_px: u32) -> Result<Pixmap, PictureError> {
    let options =
        usvg::Options { font_family: text::FAMILY.into(), fontdb: Arc::clone(&FONTS), ..usvg::Options::default() };
    let tree = usvg::Tree::from_str(svg, &options).map_err(|_| PictureError::NotSvg)?;
    let size = PictureError::Size { width: width_px, limit: LONGEST_SIDE };
    let whole = tree.size().to_int_size();
    let scaled = whole.scale_to_width(width_px).ok_or(size)?;
    if scaled.width().max(scaled.height()) > LONGEST_SIDE {
        return Err(size);
    }
    let mut image = Pixmap::new(scaled.width(), scaled.height()).ok_or(size)?;
    image.fill(Color::WHITE);
    let scale = scaled.width() as f32 / tree.size().width();
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut image.as_mut());
    Ok(image)
}

/// The image is opaque, so the alpha channel can go.
fn encode(image: &Pixmap) -> Option<Vec<u8>> {
    let rgb: Vec<u8> = image.pixels().iter().flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]).collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, image.width(), image.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header().ok()?;
    writer.write_image_data(&rgb).ok()?;
    writer.finish().ok()?;
    Some(bytes)
}
