//! Keeps account of what part of a rectangle is drawn on, to find free room for labels.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "cell numbers come from distances that are checked to lie inside the rectangle"
)]

use crate::picture::pen::Point;
use crate::picture::view::Rect;

/// Edge of a cell, in units.
const CELL: f64 = 4.0;

/// Cells of a rectangle, taken or free.
pub(crate) struct Room {
    rect: Rect,
    columns: usize,
    taken: Vec<bool>,
}

impl Room {
    /// All free.
    pub(crate) fn new(rect: Rect) -> Self {
        let count = |length: f64| (length / CELL).ceil().max(1.0) as usize;
        let (columns, rows) = (count(rect.width), count(rect.height));
        Self { rect, columns, taken: vec![false; columns * rows] }
    }

    fn cell(&self, point: Point) -> Option<usize> {
        if !self.rect.contains(point) {
            return None;
        }
        let column = ((point[0] - self.rect.x) / CELL) as usize;
        let row = ((point[1] - self.rect.y) / CELL) as usize;
        let index = row * self.columns + column.min(self.columns - 1);
        (index < self.taken.len()).then_some(index)
    }

    fn take(&mut self, point: Point) {
        if let Some(index) = self.cell(point)
            && let Some(cell) = self.taken.get_mut(index)
        {
            *cell = true;
        }
    }

    fn is_taken(&self, point: Point) -> bool {
        self.cell(point).and_then(|index| self.taken.get(index)).is_some_and(|cell| *cell)
    }

    /// Takes the cells under a line.
    pub(crate) fn take_line(&mut self, from: Point, to: Point) {
        if let Some([from, to]) = self.rect.clip(from, to) {
            for point in along(from, to) {
                self.take(point);
            }
        }
    }

    /// Takes the cells under a rectangle.
    pub(crate) fn take_rect(&mut self, rect: Rect) {
        for point in across(rect) {
            self.take(point);
        }
    }

    /// How many samples of a rectangle are taken; `None` if it does not lie inside.
    pub(crate) fn taken_in(&self, rect: Rect) -> Option<usize> {
        let is_inside = self.rect.contains([rect.x, rect.y]) && self.rect.contains([rect.right(), rect.bottom()]);
        is_inside.then(|| across(rect).filter(|point| self.is_taken(*point)).count())
    }

    /// How many samples of a line are taken.
    pub(crate) fn taken_along(&self, from: Point, to: Point) -> usize {
        along(from, to).filter(|point| self.is_taken(*point)).count()
    }
}

/// Points of a line, at most half a cell apart, both ends among them.
fn along(from: Point, to: Point) -> impl Iterator<Item = Point> {
    let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    let parts = (dx.hypot(dy) / (CELL / 2.0)).ceil().max(1.0) as u32;
    (0..=parts).map(move |k| {
        let part = f64::from(k) / f64::from(parts);
        [from[0] + part * dx, from[1] + part * dy]
    })
}

/// Points of a rectangle, at most half a cell apart, its corners among them.
fn across(rect: Rect) -> impl Iterator<Item = Point> {
    along([rect.x, rect.y], [rect.right(), rect.y]).flat_map(move |[x, y]| along([x, y], [x, y + rect.height]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_takes_the_cells_it_crosses() {
        let rect = |x, y, width, height| Rect { x, y, width, height };
        let mut room = Room::new(rect(0.0, 0.0, 100.0, 40.0));
        room.take_line([-50.0, 20.0], [500.0, 20.0]);
        assert_eq!(room.taken_in(rect(2.0, 2.0, 10.0, 10.0)), Some(0));
        assert!(room.taken_in(rect(80.0, 12.0, 18.0, 18.0)).unwrap() > 0);
        assert_eq!(room.taken_in(rect(95.0, 2.0, 10.0, 10.0)), None);
        assert!(room.taken_along([50.0, 1.0], [50.0, 39.0]) > 0);
        room.take_rect(rect(0.0, 0.0, 10.0, 10.0));
        assert!(room.taken_in(rect(8.0, 8.0, 4.0, 4.0)).unwrap() > 0);
    }
}
