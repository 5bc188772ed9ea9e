//! Frame, grid, ticks and labels of the main view.

use crate::picture::layout::{LABEL_GAP, Layout, TEXT};
use crate::picture::pen::{Anchor, GREY, INK, Pen, Stroke};
use crate::picture::text::DIGIT_HEIGHT;

/// Length of a labelled and of a small tick.
const TICKS: [f64; 2] = [6.0, 3.0];

/// Lines that help to read a position; drawn before all else.
pub(crate) fn grid(pen: &mut Pen, layout: &Layout) {
    let view = &layout.main;
    let (frame, low, high) = (view.rect, view.low, view.high());
    let [along_z, along_x] = &layout.ticks;
    pen.open("grid", Stroke::solid("#e6e6e6", 0.8));
    for z in along_z.labelled(low[0], high[0]) {
        let [x, _] = view.at([z, low[1]]);
        pen.line([x, frame.y], [x, frame.bottom()]);
    }
    for x in along_x.labelled(low[1], high[1]) {
        let [_, y] = view.at([low[0], x]);
        pen.line([frame.x, y], [frame.right(), y]);
    }
    pen.close();
}

/// The frame with its ticks, labels and names.
pub(crate) fn frame(pen: &mut Pen, layout: &Layout) {
    let view = &layout.main;
    let (frame, low, high) = (view.rect, view.low, view.high());
    let [along_z, along_x] = &layout.ticks;
    pen.open("frame", Stroke::solid(INK, 1.0));
    pen.rect([frame.x, frame.y], [frame.width, frame.height]);
    for (length, at_z, at_x) in [
        (TICKS[0], along_z.labelled(low[0], high[0]), along_x.labelled(low[1], high[1])),
        (TICKS[1], along_z.small(low[0], high[0]), along_x.small(low[1], high[1])),
    ] {
        for z in at_z {
            let [x, y] = view.at([z, low[1]]);
            pen.line([x, y], [x, y + length]);
        }
        for x in at_x {
            let [x, y] = view.at([low[0], x]);
            pen.line([x - length, y], [x, y]);
        }
    }
    pen.close();
    labels(pen, layout);
}

fn labels(pen: &mut Pen, layout: &Layout) {
    let view = &layout.main;
    let (frame, low, high) = (view.rect, view.low, view.high());
    let [along_z, along_x] = &layout.ticks;
    let digits = DIGIT_HEIGHT * TEXT;
    let baseline = frame.bottom() + LABEL_GAP + digits;
    for z in along_z.labelled(low[0], high[0]) {
        let [x, _] = view.at([z, low[1]]);
        let label = along_z.label(z);
        pen.text("tick z", [x, baseline], TEXT, Anchor::Middle, INK, &label);
    }
    for x in along_x.labelled(low[1], high[1]) {
        let [left, y] = view.at([low[0], x]);
        let at = [left - LABEL_GAP, y + digits / 2.0];
        pen.text("tick x", at, TEXT, Anchor::End, INK, &along_x.label(x));
    }
    let below = [frame.right(), baseline + TEXT + 4.0];
    pen.text("axis", below, TEXT, Anchor::End, GREY, "Z in mm");
    let above = [frame.x, frame.y - 10.0];
    pen.text("axis", above, TEXT, Anchor::Start, GREY, "X in mm (radius)");
}
