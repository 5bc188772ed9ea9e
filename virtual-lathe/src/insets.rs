//! Chooses the places of a path that are shown under magnification, and collects what is seen there.
//!
//! Worth seeing are an oblique place of the longest arc, of the longest oblique line, and of the second longest arc;
//! a flat place shows nothing but a row of dots.

use feature_editor::codes::{Action, Item};
use interp_core::units::{Point, Sense};

use crate::picture::{Inset, TrueCurve};

/// Half the width of an inset, in coarser pulses.
const HALF_WIDTH: f64 = 10.0;
/// How far around its centre an inset collects, in half widths.
const REACH: f64 = 4.0;
/// Points and curves kept of one inset.
const KEPT: usize = 4_000;

fn mm(point: Point) -> [f64; 2] {
    [f64::from(point.z.nm()) * 1e-6, f64::from(point.x.nm()) * 1e-6]
}

/// A place with what makes it worth seeing.
#[derive(Clone, Debug)]
struct Candidate {
    length: f64,
    centre: [f64; 2],
    title: String,
}

/// Follows a program's actions and picks places.
#[derive(Clone, Debug)]
pub struct Chooser {
    at: Point,
    line: Option<Candidate>,
    arcs: [Option<Candidate>; 2],
}

impl Chooser {
    /// Nothing picked; the program begins at `start`.
    pub fn new(start: Point) -> Self {
        Self { at: start, line: None, arcs: [None, None] }
    }

    /// Looks at an action.
    pub fn action(&mut self, item: &Item) {
        match item.action {
            Action::Line { end, feed: _ } => self.straight(item.line, end),
            Action::Arc { end, centre, sense, feed: _ } => {
                #[expect(clippy::cast_precision_loss, reason = "nanometres of at most 6.3 m")]
                let centre = [centre.z.nm() as f64 * 1e-6, centre.x.nm() as f64 * 1e-6];
                self.round(item.line, end, centre, sense);
            }
            _ => {}
        }
    }

    fn straight(&mut self, line: u32, end: Point) {
        let (from, to) = (mm(self.at), mm(end));
        self.at = end;
        let (dz, dx) = (to[0] - from[0], to[1] - from[1]);
        let length = dz.hypot(dx);
        let oblique = dz.abs().min(dx.abs()) > 0.02 * length;
        if length > 0.0 && oblique && self.line.as_ref().is_none_or(|best| length > best.length) {
            let centre = [f64::midpoint(from[0], to[0]), f64::midpoint(from[1], to[1])];
            self.line = Some(Candidate { length, centre, title: format!("Line {line}: straight") });
        }
    }

    fn round(&mut self, line: u32, end: Point, centre: [f64; 2], sense: Sense) {
        let (from, to) = (mm(self.at), mm(end));
        self.at = end;
        let angle = |p: [f64; 2]| (p[1] - centre[1]).atan2(p[0] - centre[0]);
        let radius = (from[0] - centre[0]).hypot(from[1] - centre[1]);
        let turn = match sense {
            Sense::CounterClockwise => 1.0,
            Sense::Clockwise => -1.0,
        };
        let mut sweep = ((angle(to) - angle(from)) * turn).rem_euclid(std::f64::consts::TAU);
        if sweep < 1e-9 {
            sweep = std::f64::consts::TAU;
        }
        let length = radius * sweep;
        // the most oblique of a few places
        let places = [0.5, 0.35, 0.65, 0.2, 0.8].map(|part| angle(from) + turn * sweep * part);
        let Some(place) = places.into_iter().max_by(|a, b| (2.0 * a).sin().abs().total_cmp(&(2.0 * b).sin().abs()))
        else {
            return;
        };
        let candidate = Candidate {
            length,
            centre: [centre[0] + radius * place.cos(), centre[1] + radius * place.sin()],
            title: format!("Line {line}: arc, R {}", short(radius)),
        };
        let [first, second] = &mut self.arcs;
        if first.as_ref().is_none_or(|best| length > best.length) {
            *second = first.take();
            *first = Some(candidate);
        } else if second.as_ref().is_none_or(|best| length > best.length) {
            *second = Some(candidate);
        }
    }

    /// The insets chosen, empty as yet; `pulse` is the size of one pulse, Z and X, in mm.
    pub fn insets(self, pulse: [f64; 2]) -> Vec<Inset> {
        let [first, second] = self.arcs;
        [first, self.line, second]
            .into_iter()
            .flatten()
            .map(|candidate| Inset {
                title: candidate.title,
                centre: candidate.centre,
                half_width: HALF_WIDTH * pulse[0].max(pulse[1]),
                pulse,
                visited: Vec::new(),
                curves: Vec::new(),
            })
            .collect()
    }
}

/// A length in mm without needless decimals.
fn short(mm: f64) -> String {
    let text = format!("{mm:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Adds a lattice point that was visited to the insets that show it.
pub fn visit(insets: &mut [Inset], z: i32, x: i32) {
    for inset in insets {
        let off_z = f64::from(z) * inset.pulse[0] - inset.centre[0];
        let off_x = f64::from(x) * inset.pulse[1] - inset.centre[1];
        // a panel may be higher than wide; what lies outside it does no harm
        let reach = REACH * inset.half_width;
        if off_z.abs() <= reach && off_x.abs() <= reach && inset.visited.len() < KEPT {
            inset.visited.push([z, x]);
        }
    }
}

/// Adds the true curve of an action from `from` to the insets that it may pass.
pub fn curve(insets: &mut [Inset], from: Point, item: &Item) {
    let (curve, low, high) = match item.action {
        Action::Line { end, .. } => {
            let (a, b) = (mm(from), mm(end));
            let low = [a[0].min(b[0]), a[1].min(b[1])];
            let high = [a[0].max(b[0]), a[1].max(b[1])];
            (TrueCurve::Line { from: a, to: b }, low, high)
        }
        Action::Arc { end, centre, sense, .. } => {
            #[expect(clippy::cast_precision_loss, reason = "nanometres of at most 6.3 m")]
            let centre = [centre.z.nm() as f64 * 1e-6, centre.x.nm() as f64 * 1e-6];
            let (a, b) = (mm(from), mm(end));
            let radius = (a[0] - centre[0]).hypot(a[1] - centre[1]);
            let curve = TrueCurve::Arc { centre, from: a, to: b, clockwise: sense == Sense::Clockwise };
            (curve, centre.map(|c| c - radius), centre.map(|c| c + radius))
        }
        _ => return,
    };
    for inset in insets {
        let reach = REACH * inset.half_width;
        let near = (0..2).all(|axis| {
            let (at, low, high) = (inset.centre.get(axis), low.get(axis), high.get(axis));
            matches!((at, low, high), (Some(at), Some(low), Some(high)) if at + reach >= *low && at - reach <= *high)
        });
        if near && inset.curves.len() < KEPT {
            inset.curves.push(curve);
        }
    }
}

/// End of an action that moves.
pub fn end_of(item: &Item) -> Option<Point> {
    match item.action {
        Action::Line { end, .. } | Action::Arc { end, .. } => Some(end),
        _ => None,
    }
}
