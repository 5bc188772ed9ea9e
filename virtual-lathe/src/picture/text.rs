//! The one font, and how wide text is in it.
//!
//! Widths are the advances of the glyphs; kerning and ligatures only make text narrower. A viewer without this font
//! falls back to one that is as wide or narrower.

use std::sync::LazyLock;

use skrifa::MetadataProvider;
use skrifa::instance::{LocationRef, Size};

/// Name of the embedded face.
pub(crate) const FAMILY: &str = "DejaVu Sans";

/// What a viewer of the SVG may use: the face itself, the one it descends from, or any.
pub(crate) const FAMILIES: &str = "DejaVu Sans, Verdana, sans-serif";

/// Above the baseline, the height of a digit; in parts of the size.
pub(crate) const DIGIT_HEIGHT: f64 = 0.73;

/// Stands for the part of a text that had no room.
const ELLIPSIS: &str = "…";

/// Between facts: not worth a place at the end of a line.
const SEPARATORS: [char; 2] = ['·', ' '];

/// The bytes of the embedded face.
pub(crate) fn face() -> &'static [u8] {
    dejavu::sans::regular()
}

static FONT: LazyLock<Option<skrifa::FontRef<'static>>> = LazyLock::new(|| skrifa::FontRef::new(face()).ok());

/// Width of `text` at `size`, in units.
pub(crate) fn width(text: &str, size: f64) -> f64 {
    let Some(font) = FONT.as_ref() else {
        // As wide as the widest letters: the text has room whatever is drawn.
        return text.chars().map(|_| size).sum();
    };
    let letters = font.charmap();
    let metrics = font.glyph_metrics(Size::unscaled(), LocationRef::default());
    let em = f64::from(font.metrics(Size::unscaled(), LocationRef::default()).units_per_em);
    let advance: f64 = text
        .chars()
        .map(|letter| letters.map(letter).and_then(|glyph| metrics.advance_width(glyph)).map_or(em, f64::from))
        .sum();
    advance * size / em
}

/// `text` in one line, shortened to fit `room`.
pub(crate) fn fit(text: &str, size: f64, room: f64) -> String {
    let line = one_line(text);
    if width(&line, size) <= room {
        return line;
    }
    let mut left = room - width(ELLIPSIS, size);
    if left < 0.0 {
        return String::new();
    }
    let mut letters = [0; 4];
    let start: String = line
        .chars()
        .take_while(|letter| {
            left -= width(letter.encode_utf8(&mut letters), size);
            left >= 0.0
        })
        .collect();
    format!("{}{ELLIPSIS}", start.trim_end())
}

/// `text` in at most `most` lines no wider than `room`; line breaks of the text are kept. A dot that separates facts
/// goes where the line is broken.
pub(crate) fn wrap(text: &str, size: f64, room: f64, most: usize) -> Vec<String> {
    let mut lines = Vec::new();
    for given in text.lines() {
        let mut line = String::new();
        for word in given.split_whitespace() {
            let longer = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
            if width(&longer, size) <= room || line.is_empty() {
                line = longer;
            } else {
                lines.push(line.trim_end_matches(SEPARATORS).to_owned());
                line = word.trim_start_matches(SEPARATORS).to_owned();
            }
        }
        if !line.is_empty() {
            lines.push(line);
        }
    }
    if lines.len() > most {
        let rest = lines.split_off(most.saturating_sub(1)).join(" ");
        lines.push(rest);
    }
    lines.into_iter().map(|line| fit(&line, size, room)).collect()
}

/// `text` with line breaks and runs of spaces made one space.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_have_one_width() {
        let one = width("1", 10.0);
        assert!((width("8", 10.0) - one).abs() < 1e-9);
        assert!((6.3..6.5).contains(&one));
    }

    #[test]
    fn long_text_is_shortened_to_fit() {
        let line = fit("a rather long\n  heading", 10.0, 60.0);
        assert!(line.ends_with(ELLIPSIS));
        assert!(width(&line, 10.0) <= 60.0);
        assert_eq!(fit("short", 10.0, 60.0), "short");
    }

    #[test]
    fn text_wraps_at_words_and_keeps_its_breaks() {
        assert_eq!(wrap("one two\nthree", 10.0, 500.0, 4), ["one two", "three"]);
        let lines = wrap("one two three four five", 10.0, 50.0, 2);
        assert_eq!(lines.len(), 2);
        assert!(lines.iter().all(|line| width(line, 10.0) <= 50.0));
        assert!(wrap("", 10.0, 50.0, 2).is_empty());
        assert_eq!(wrap("one · two", 10.0, 35.0, 4), ["one", "two"]);
    }
}
