//! Writes SVG: the few shapes of the drawing, and text that is safely escaped.

use std::fmt::Write;

use crate::picture::text;

/// A point of the sheet: right, down, in units.
pub(crate) type Point = [f64; 2];

/// How a line is drawn.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Stroke {
    /// CSS colour.
    pub(crate) colour: &'static str,
    /// In units.
    pub(crate) width: f64,
    /// Lengths of dashes and gaps in units, or empty.
    pub(crate) dashes: &'static str,
}

impl Stroke {
    /// A solid line.
    pub(crate) const fn solid(colour: &'static str, width: f64) -> Self {
        Self { colour, width, dashes: "" }
    }
}

/// Where the given point lies in the text.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    /// At its left end.
    Start,
    /// In its middle.
    Middle,
    /// At its right end.
    End,
}

/// Dark enough for lines and text.
pub(crate) const INK: &str = "#1a1a1a";

/// Text of the second rank.
pub(crate) const GREY: &str = "#555555";

/// A document in the making.
pub(crate) struct Pen {
    out: String,
}

impl Pen {
    /// Opens a white sheet of the given size in units, shown `width_px` wide.
    pub(crate) fn sheet(width: f64, height: f64, width_px: u32) -> Self {
        let height_px = f64::from(width_px) * height / width;
        let mut pen = Self { out: String::new() };
        pen.put(format_args!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width_px}\" height=\"{height_px:.2}\" \
             viewBox=\"0 0 {width:.2} {height:.2}\" font-family=\"{}\">\n\
             <rect width=\"{width:.2}\" height=\"{height:.2}\" fill=\"#ffffff\"/>\n",
            text::FAMILIES
        ));
        pen
    }

    /// Closes the document.
    pub(crate) fn finish(mut self) -> String {
        self.out.push_str("</svg>\n");
        self.out
    }

    /// Writing to a string cannot fail.
    fn put(&mut self, arguments: std::fmt::Arguments<'_>) {
        let written = self.out.write_fmt(arguments);
        debug_assert!(written.is_ok());
    }

    /// Opens a group named `class`, drawn with `stroke`.
    pub(crate) fn open(&mut self, class: &str, stroke: Stroke) {
        let Stroke { colour, width, dashes } = stroke;
        self.put(format_args!(
            "<g class=\"{class}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linejoin=\"round\""
        ));
        if !dashes.is_empty() {
            self.put(format_args!(" stroke-dasharray=\"{dashes}\""));
        }
        self.put(format_args!(">\n"));
    }

    /// Closes the group.
    pub(crate) fn close(&mut self) {
        self.out.push_str("</g>\n");
    }

    /// A straight line.
    pub(crate) fn line(&mut self, from: Point, to: Point) {
        self.path(&[vec![from, to]]);
    }

    /// Polylines as one path; those of fewer than two points are left out.
    pub(crate) fn path(&mut self, lines: &[Vec<Point>]) {
        if lines.iter().all(|line| line.len() < 2) {
            return;
        }
        self.out.push_str("<path d=\"");
        for line in lines.iter().filter(|line| line.len() > 1) {
            let mut command = 'M';
            for [right, down] in line {
                self.put(format_args!("{command}{right:.2} {down:.2}"));
                command = 'L';
            }
        }
        self.out.push_str("\"/>\n");
    }

    /// A rectangle from its upper left corner.
    pub(crate) fn rect(&mut self, corner: Point, size: Point) {
        let ([x, y], [width, height]) = (corner, size);
        self.put(format_args!("<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\"/>\n"));
    }

    /// A circle; `fill` replaces the fill of the group.
    pub(crate) fn circle(&mut self, centre: Point, radius: f64, fill: Option<&str>) {
        let [x, y] = centre;
        self.put(format_args!("<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius:.2}\""));
        if let Some(fill) = fill {
            self.put(format_args!(" fill=\"{fill}\""));
        }
        self.put(format_args!("/>\n"));
    }

    /// Filled circles of one size as one path: thousands of them stay cheap.
    pub(crate) fn dots(&mut self, centres: &[Point], radius: f64, fill: &str) {
        if centres.is_empty() {
            return;
        }
        self.put(format_args!("<path stroke=\"none\" fill=\"{fill}\" d=\""));
        let across = 2.0 * radius;
        for [x, y] in centres {
            self.put(format_args!(
                "M{:.2} {y:.2}a{radius:.2} {radius:.2} 0 1 0 {across:.2} 0a{radius:.2} {radius:.2} 0 1 0 -{across:.2} 0z",
                x - radius
            ));
        }
        self.put(format_args!("\"/>\n"));
    }

    /// A filled polygon without outline.
    pub(crate) fn polygon(&mut self, corners: &[Point], fill: &str) {
        self.put(format_args!("<path stroke=\"none\" fill=\"{fill}\" d=\""));
        let mut command = 'M';
        for [x, y] in corners {
            self.put(format_args!("{command}{x:.2} {y:.2}"));
            command = 'L';
        }
        self.put(format_args!("z\"/>\n"));
    }

    /// Text that runs upward from `at`, which lies in the middle of its height.
    pub(crate) fn upright(&mut self, class: &str, [x, y]: Point, size: f64, anchor: Anchor, content: &str) {
        let baseline = x + 0.36 * size;
        self.put(format_args!("<g transform=\"translate({baseline:.2} {y:.2}) rotate(-90)\">\n"));
        self.text(class, [0.0, 0.0], size, anchor, INK, content);
        self.out.push_str("</g>\n");
    }

    /// A closed shape with the stroke of the group, filled.
    pub(crate) fn shape(&mut self, corners: &[Point], fill: &str) {
        if corners.len() < 3 {
            return;
        }
        self.put(format_args!("<path fill=\"{fill}\" d=\""));
        let mut command = 'M';
        for [x, y] in corners {
            self.put(format_args!("{command}{x:.2} {y:.2}"));
            command = 'L';
        }
        self.put(format_args!("z\"/>\n"));
    }

    /// Text on a baseline at `at`; nothing if it is empty.
    pub(crate) fn text(&mut self, class: &str, at: Point, size: f64, anchor: Anchor, ink: &str, content: &str) {
        if content.is_empty() {
            return;
        }
        let [x, y] = at;
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        self.put(format_args!(
            "<text class=\"{class}\" x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"{size}\" text-anchor=\"{anchor}\" \
             fill=\"{ink}\" stroke=\"none\">"
        ));
        self.escaped(content);
        self.out.push_str("</text>\n");
    }

    /// `content` as character data of XML 1.0, which forbids most control characters even when escaped.
    fn escaped(&mut self, content: &str) {
        for letter in content.chars() {
            match letter {
                '&' => self.out.push_str("&amp;"),
                '<' => self.out.push_str("&lt;"),
                '>' => self.out.push_str("&gt;"),
                '"' => self.out.push_str("&quot;"),
                '\'' => self.out.push_str("&#39;"),
                '\t' | '\n' | '\r' => self.out.push(' '),
                '\u{fffe}' | '\u{ffff}' => self.out.push(char::REPLACEMENT_CHARACTER),
                control if control.is_control() => self.out.push(char::REPLACEMENT_CHARACTER),
                plain => self.out.push(plain),
            }
        }
    }
}
