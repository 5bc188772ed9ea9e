//! Windows onto the ZX plane: rectangles of the sheet, and the scale that maps mm to units.

use crate::picture::pen::Point;

/// Farthest position that is drawn, in mm: a kilometre.
const FARTHEST: f64 = 1e6;

/// Whether a position in mm is finite and near enough to be drawn.
pub(crate) fn is_drawable(position: &[f64; 2]) -> bool {
    position.iter().all(|part| part.abs() <= FARTHEST)
}

/// A rectangle of the sheet, from its upper left corner.
#[derive(Copy, Clone, Debug, Default, PartialEq)]
pub(crate) struct Rect {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

impl Rect {
    pub(crate) fn right(self) -> f64 {
        self.x + self.width
    }

    pub(crate) fn bottom(self) -> f64 {
        self.y + self.height
    }

    /// Smaller by `margin` on every side, or larger if it is negative.
    pub(crate) fn inset(self, margin: f64) -> Self {
        Self {
            x: self.x + margin,
            y: self.y + margin,
            width: self.width - 2.0 * margin,
            height: self.height - 2.0 * margin,
        }
    }

    pub(crate) fn contains(self, [x, y]: Point) -> bool {
        (self.x..=self.right()).contains(&x) && (self.y..=self.bottom()).contains(&y)
    }

    /// The part of a line inside, if any (Liang and Barsky, ACM Transactions on Graphics 3(1), 1984).
    pub(crate) fn clip(self, from: Point, to: Point) -> Option<[Point; 2]> {
        let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for (change, room) in [
            (-dx, from[0] - self.x),
            (dx, self.right() - from[0]),
            (-dy, from[1] - self.y),
            (dy, self.bottom() - from[1]),
        ] {
            if change < 0.0 {
                enter = enter.max(room / change);
            } else if change > 0.0 {
                leave = leave.min(room / change);
            } else if room < 0.0 {
                return None;
            }
        }
        let at = |part: f64| [from[0] + part * dx, from[1] + part * dy];
        (enter <= leave).then(|| [at(enter), at(leave)])
    }

    /// The parts of a polyline inside.
    pub(crate) fn clip_line(self, line: &[Point]) -> Vec<Vec<Point>> {
        let mut parts: Vec<Vec<Point>> = Vec::new();
        let mut is_open = false;
        for (&from, &to) in line.iter().zip(line.iter().skip(1)) {
            let Some([enter, leave]) = self.clip(from, to) else {
                is_open = false;
                continue;
            };
            match parts.last_mut() {
                Some(part) if is_open && self.contains(from) => part.push(leave),
                _ => parts.push(vec![enter, leave]),
            }
            is_open = true;
        }
        parts
    }
}

/// What part of the ZX plane a rectangle shows.
#[derive(Copy, Clone, Debug, PartialEq)]
pub(crate) struct View {
    /// The rectangle.
    pub(crate) rect: Rect,
    /// Z at its left edge and X at its lower edge, in mm.
    pub(crate) low: [f64; 2],
    /// Units per mm, the same along both axes.
    pub(crate) scale: f64,
}

impl View {
    /// A view with `centre` in the middle.
    pub(crate) fn centred(rect: Rect, centre: [f64; 2], scale: f64) -> Self {
        let [z, x] = centre;
        Self { rect, low: [z - rect.width / scale / 2.0, x - rect.height / scale / 2.0], scale }
    }

    /// Z at the right edge and X at the upper edge, in mm.
    pub(crate) fn high(&self) -> [f64; 2] {
        [self.low[0] + self.rect.width / self.scale, self.low[1] + self.rect.height / self.scale]
    }

    /// Where `[z, x]` in mm lies on the sheet.
    pub(crate) fn at(&self, [z, x]: [f64; 2]) -> Point {
        [self.rect.x + (z - self.low[0]) * self.scale, self.rect.bottom() - (x - self.low[1]) * self.scale]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Rect = Rect { x: 0.0, y: 0.0, width: 10.0, height: 10.0 };

    #[test]
    fn lines_are_cut_at_the_edges() {
        assert_eq!(UNIT.clip([-5.0, 5.0], [15.0, 5.0]), Some([[0.0, 5.0], [10.0, 5.0]]));
        assert_eq!(UNIT.clip([-5.0, 5.0], [5.0, -6.0]), None);
        assert_eq!(UNIT.clip([11.0, 0.0], [11.0, 5.0]), None);
        assert_eq!(UNIT.clip([3.0, 3.0], [3.0, 3.0]), Some([[3.0, 3.0], [3.0, 3.0]]));
    }

    #[test]
    fn a_polyline_that_leaves_comes_back_as_another_part() {
        let line = [[5.0, 5.0], [15.0, 5.0], [15.0, 6.0], [5.0, 6.0], [5.0, 7.0]];
        assert_eq!(UNIT.clip_line(&line), [vec![[5.0, 5.0], [10.0, 5.0]], vec![[10.0, 6.0], [5.0, 6.0], [5.0, 7.0]]]);
    }

    #[test]
    fn x_points_up_and_z_to_the_right() {
        let view = View::centred(UNIT, [100.0, 20.0], 2.0);
        for (found, expected) in
            [(view.at([100.0, 20.0]), [5.0, 5.0]), (view.at([102.0, 22.0]), [9.0, 1.0]), (view.high(), [102.5, 22.5])]
        {
            assert!((found[0] - expected[0]).abs() < 1e-9);
            assert!((found[1] - expected[1]).abs() < 1e-9);
        }
    }
}
