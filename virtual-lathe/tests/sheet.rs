//! What the finished sheet holds, read back from its SVG and its PNG.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic, reason = "helpers of tests, which may panic")]

mod samples;

use std::sync::Arc;

use resvg::usvg;
use roxmltree::{Document, Node};
use virtual_lathe::picture::{Drawing, PictureError, TrueCurve, png};

const WIDTHS: [u32; 3] = [800, 1_200, 3_000];

/// Every sample at every width, as SVG.
fn sheets() -> impl Iterator<Item = (String, Drawing, String)> {
    samples::all().into_iter().flat_map(|(name, drawing)| {
        WIDTHS.map(|width| {
            let svg = drawing.svg(width);
            (format!("{name} at {width}"), drawing.clone(), svg)
        })
    })
}

fn number(node: Node<'_, '_>, name: &str) -> f64 {
    node.attribute(name).unwrap().parse().unwrap()
}

/// Left, top, right and bottom of the rectangle in the only group of a class.
fn frame(document: &Document<'_>, class: &str) -> [f64; 4] {
    let group = of_class(document, class).next().unwrap();
    let rect = group.children().find(|node| node.has_tag_name("rect"));
    let rect = rect.unwrap();
    let [x, y] = [number(rect, "x"), number(rect, "y")];
    [x, y, x + number(rect, "width"), y + number(rect, "height")]
}

fn of_class<'a>(document: &'a Document<'_>, class: &'a str) -> impl Iterator<Item = Node<'a, 'a>> {
    document
        .descendants()
        .filter(move |node| node.attribute("class").is_some_and(|given| given.split(' ').any(|part| part == class)))
}

/// Points of the lines of a path.
fn points(path: &str) -> Vec<[f64; 2]> {
    path.split(['M', 'L'])
        .filter(|part| !part.is_empty())
        .map(|part| {
            let (x, y) = part.split_once(' ').unwrap();
            [x.parse().unwrap(), y.parse().unwrap()]
        })
        .collect()
}

fn is_in([left, top, right, bottom]: [f64; 4], [x, y]: [f64; 2]) -> bool {
    (left..=right).contains(&x) && (top..=bottom).contains(&y)
}

#[test]
fn every_sheet_is_well_formed_and_text_survives() {
    for (name, drawing, svg) in sheets() {
        let document = Document::parse(&svg).unwrap_or_else(|error| panic!("{name}: {error}"));
        let title: String = of_class(&document, "title").filter_map(|node| node.text().map(str::to_owned)).collect();
        let expected = drawing.title.replace('\u{b}', " ");
        let letters = |text: &str| text.replace([' ', '\u{fffd}'], "");
        assert_eq!(letters(&title), letters(&expected), "{name}");
    }
}

#[test]
fn the_path_lies_inside_its_frame() {
    for (name, _, svg) in sheets() {
        let document = Document::parse(&svg).unwrap();
        let frame = frame(&document, "frame");
        for track in of_class(&document, "track") {
            for path in track.children().filter(|node| node.has_tag_name("path")) {
                for point in points(path.attribute("d").unwrap()) {
                    assert!(is_in(frame, point), "{name}: {point:?}");
                }
            }
        }
    }
}

#[test]
fn ticks_are_round_evenly_spaced_and_of_one_scale() {
    for (name, _, svg) in sheets() {
        let document = Document::parse(&svg).unwrap();
        let mut scales = Vec::new();
        for axis in ["x", "z"] {
            let ticks: Vec<(f64, f64)> = of_class(&document, "tick")
                .filter(|node| node.attribute("class").unwrap().ends_with(axis))
                .map(|node| {
                    let value = node.text().unwrap().replace('−', "-").parse().unwrap();
                    (value, number(node, if axis == "x" { "y" } else { "x" }))
                })
                .collect();
            assert!(ticks.len() >= 2, "{name}: {axis} has {ticks:?}");
            let step = ticks[1].0 - ticks[0].0;
            let leading = step / 10_f64.powf((step * 1.000_001).log10().floor());
            let is_round = [1.0, 2.0, 5.0].map(|round| (leading - round).abs() < 1e-6);
            assert!(is_round.contains(&true), "{name}: {step}");
            for pair in ticks.windows(2) {
                assert!((pair[1].0 - pair[0].0 - step).abs() < 1e-6 * step);
                scales.push((pair[1].1 - pair[0].1).abs() / step);
            }
        }
        for scale in &scales {
            assert!((scale / scales[0] - 1.0).abs() < 1e-3, "{name}: {scales:?}");
        }
    }
}

/// Boxes of all texts and of all shapes, as they will be drawn.
fn boxes(group: &usvg::Group, texts: &mut Vec<usvg::Rect>, shapes: &mut Vec<usvg::Rect>) {
    for node in group.children() {
        match node {
            usvg::Node::Group(group) => boxes(group, texts, shapes),
            usvg::Node::Text(text) => texts.push(text.abs_bounding_box()),
            usvg::Node::Path(_) | usvg::Node::Image(_) => {
                shapes.push(node.abs_stroke_bounding_box());
            }
        }
    }
}

#[test]
fn texts_keep_apart_and_all_is_on_the_sheet() {
    let mut fonts = usvg::fontdb::Database::new();
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    let fonts = Arc::new(fonts);
    for (name, _, svg) in sheets() {
        let options =
            usvg::Options { font_family: "DejaVu Sans".into(), fontdb: Arc::clone(&fonts), ..usvg::Options::default() };
        let tree = usvg::Tree::from_str(&svg, &options).unwrap();
        let (mut texts, mut shapes) = (Vec::new(), Vec::new());
        boxes(tree.root(), &mut texts, &mut shapes);
        let size = tree.size();
        for found in texts.iter().chain(&shapes) {
            let is_inside = found.left() > -1.0
                && found.top() > -1.0
                && found.right() < size.width() + 1.0
                && found.bottom() < size.height() + 1.0;
            assert!(is_inside, "{name}: {found:?}");
        }
        for (k, a) in texts.iter().enumerate() {
            for b in &texts[k + 1..] {
                // Boxes of text are as high as the font; its letters are not.
                let apart = a.right() <= b.left()
                    || b.right() <= a.left()
                    || a.bottom() <= b.top() + 0.35 * b.height()
                    || b.bottom() <= a.top() + 0.35 * a.height();
                assert!(apart, "{name}: {a:?} {b:?}");
            }
        }
    }
}

#[test]
fn insets_have_panels_and_rings_and_stay_inside_them() {
    for (name, drawing, svg) in sheets() {
        let document = Document::parse(&svg).unwrap();
        let count = drawing.insets.len();
        assert_eq!(of_class(&document, "panel").count(), count, "{name}");
        assert_eq!(of_class(&document, "ring").count(), count, "{name}");
        assert_eq!(of_class(&document, "balloon").count(), 2 * count, "{name}");
        let panels: Vec<[f64; 4]> = of_class(&document, "panel")
            .map(|group| {
                let rect = group.children().find(|node| node.has_tag_name("rect"));
                let rect = rect.unwrap();
                let [x, y] = [number(rect, "x"), number(rect, "y")];
                [x, y, x + number(rect, "width"), y + number(rect, "height")]
            })
            .collect();
        for class in ["true-curve", "steps"] {
            for group in of_class(&document, class) {
                for path in group.children().filter(|node| node.has_tag_name("path")) {
                    for point in points(path.attribute("d").unwrap()) {
                        let is_inside = panels.iter().any(|panel| is_in(*panel, point));
                        assert!(is_inside, "{name}: {class} {point:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn the_legend_names_only_what_is_drawn() {
    let legend = |drawing: &Drawing| -> Vec<String> {
        let svg = drawing.svg(1_000);
        let document = Document::parse(&svg).unwrap();
        of_class(&document, "legend").filter_map(|node| node.text().map(str::to_owned)).collect()
    };
    assert_eq!(legend(&samples::plunge()), ["straight feed", "centre line"]);
    assert_eq!(legend(&samples::handle()).len(), 7);
    assert!(!legend(&samples::messy()).contains(&"centre line".to_owned()));
}

#[test]
fn numbers_out_of_range_do_not_reach_the_sheet() {
    let hostile = [f64::NAN, f64::INFINITY, -1e300, 1e300, 1e-300, 1e6, 0.0, -1.0];
    for value in hostile {
        let place = [value, 5.0];
        let sample = samples::stadium();
        let with = |change: &dyn Fn(&mut Drawing)| {
            let mut drawing = sample.clone();
            change(&mut drawing);
            let svg = drawing.svg(800);
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{value}");
            assert!(svg.len() < 1_000_000, "{value}");
            Document::parse(&svg).unwrap();
        };
        with(&|drawing| drawing.start = place);
        with(&|drawing| drawing.end = place);
        with(&|drawing| drawing.tracks[0].points.push(place));
        with(&|drawing| drawing.insets[0].centre = place);
        with(&|drawing| drawing.insets[0].half_width = value);
        with(&|drawing| drawing.insets[0].pulse = place);
        with(&|drawing| drawing.insets[0].pulse = [value; 2]);
        with(&|drawing| drawing.insets[0].visited.push([i32::MAX, i32::MIN]));
        with(&|drawing| {
            let [from, to] = [place, [1.0, 2.0]];
            drawing.insets[0].curves.push(TrueCurve::Line { from, to });
            for (centre, from, to) in [(place, to, from), (to, place, to), (to, to, place)] {
                let clockwise = false;
                drawing.insets[0].curves.push(TrueCurve::Arc { centre, from, to, clockwise });
            }
        });
    }
}

#[test]
fn images_have_the_width_asked_for_and_the_proportions_of_the_sheet() {
    let svg = samples::single_line().svg(900);
    let document = Document::parse(&svg).unwrap();
    let root = document.root_element();
    let aspect = number(root, "height") / number(root, "width");
    for width in [300, 900, 1_600] {
        let image = png(&svg, width).unwrap();
        assert_eq!(image[..8], *b"\x89PNG\r\n\x1a\n");
        assert_eq!(image[12..16], *b"IHDR");
        assert_eq!(image[16..20], width.to_be_bytes());
        let height = u32::from_be_bytes(image[20..24].try_into().unwrap());
        assert!((f64::from(height) - aspect * f64::from(width)).abs() <= 2.0);
        assert_eq!(image[image.len() - 8..][..4], *b"IEND");
    }
}

#[test]
fn what_cannot_be_rendered_is_refused() {
    let svg = samples::nothing().svg(800);
    assert_eq!(png("no svg", 800), Err(PictureError::NotSvg));
    for width in [0, 16_385, u32::MAX] {
        let limit = 16_384;
        assert_eq!(png(&svg, width), Err(PictureError::Size { width, limit }));
    }
}

#[test]
fn text_is_drawn_with_the_embedded_font() {
    let image = |text: &str| {
        let svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100\" height=\"30\" font-family=\"No Such Font\">\
             <text x=\"5\" y=\"20\" font-size=\"14\">{text}</text></svg>"
        );
        png(&svg, 100).unwrap()
    };
    assert_ne!(image("12 µm"), image(""));
}
