//! The bar as it stands: radii that are material, in columns of equal width along Z.
//!
//! A column holds the stretches of radius that are material on the line through its middle, exactly; between the lines
//! the surface is straight. A block of columns knows the least and the greatest radius of its material, so that a tool
//! that can't reach them passes over it.

use smallvec::SmallVec;

use crate::geometry::Point;
use crate::sweep::Sweep;

/// Columns of a block.
const BLOCK: usize = 32;
/// Blocks of a span.
const SPAN: usize = 32;
/// Most columns: a bar of a metre has them 4 um wide.
const MOST_COLUMNS: f64 = 262_144.0;
/// Least width of a column, mm.
const FINEST: f64 = 0.004;

/// A bar before it is cut. Lengths in mm.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct BarData {
    /// Radius.
    pub radius: f64,
    /// Radius of its bore; 0 for none.
    pub bore: f64,
    /// Z of its back end.
    pub back: f64,
    /// Z of its front face.
    pub face: f64,
}

type Material = SmallVec<[[f64; 2]; 2]>;

/// The least and the greatest radius of some material.
#[derive(Copy, Clone, Debug)]
struct Reach {
    low: f64,
    high: f64,
}

impl Reach {
    const NONE: Self = Self { low: f64::INFINITY, high: f64::NEG_INFINITY };

    fn meets(self, [low, high]: [f64; 2]) -> bool {
        low < self.high && high > self.low
    }

    fn over(parts: impl Iterator<Item = Self>) -> Self {
        parts.fold(Self::NONE, |all, part| Self { low: all.low.min(part.low), high: all.high.max(part.high) })
    }
}

/// A bar that is cut.
#[derive(Clone, Debug)]
pub struct Bar {
    data: BarData,
    width: f64,
    columns: Vec<Material>,
    reach: Vec<Reach>,
    blocks: Vec<Reach>,
    spans: Vec<Reach>,
}

/// What a sweep took from one column.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Taken {
    /// Which column.
    pub column: usize,
    /// Z of its middle, mm.
    pub z: f64,
    /// Lowest and highest radius taken, mm.
    pub radii: [f64; 2],
    /// Material between them, mm of radius.
    pub thickness: f64,
}

impl Bar {
    /// The bar before the first cut. `data` is finite, with `bore < radius` and `back < face`.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 1 to MOST_COLUMNS")]
    pub fn new(data: BarData) -> Self {
        let length = data.face - data.back;
        let count = (length / FINEST).ceil().clamp(1.0, MOST_COLUMNS);
        let columns = count as usize;
        let whole = Reach { low: data.bore, high: data.radius };
        let blocks = columns.div_ceil(BLOCK);
        Self {
            data,
            width: length / count,
            columns: vec![SmallVec::from_slice(&[[data.bore, data.radius]]); columns],
            reach: vec![whole; columns],
            blocks: vec![whole; blocks],
            spans: vec![whole; blocks.div_ceil(SPAN)],
        }
    }

    /// The bar before it was cut.
    #[must_use]
    pub fn data(&self) -> BarData {
        self.data
    }

    /// Width of a column, mm.
    #[must_use]
    pub fn width(&self) -> f64 {
        self.width
    }

    /// How many columns it has, from the back to the face.
    #[must_use]
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// Whether it has no column; it never is.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// Z of the middle of a column.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "at most MOST_COLUMNS")]
    pub fn z(&self, column: usize) -> f64 {
        self.data.back + (column as f64 + 0.5) * self.width
    }

    /// The column at `z`.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked to lie on the bar")]
    fn column(&self, z: f64) -> Option<usize> {
        let place = (z - self.data.back) / self.width;
        (place >= 0.0 && z <= self.data.face).then(|| (place as usize).min(self.columns.len().saturating_sub(1)))
    }

    /// Stretches of radius that are material in the column, from the axis outward.
    #[must_use]
    pub fn material(&self, column: usize) -> &[[f64; 2]] {
        self.columns.get(column).map_or(&[], SmallVec::as_slice)
    }

    /// Whether there is material at a place; right to half a column along Z.
    #[must_use]
    pub fn is_material(&self, place: Point) -> bool {
        let column = self.column(place.z);
        column.is_some_and(|at| self.material(at).iter().any(|[low, high]| (*low..=*high).contains(&place.x)))
    }

    /// The outermost radius of material in the column; 0 where nothing is left.
    #[must_use]
    pub fn outside(&self, column: usize) -> f64 {
        self.material(column).last().map_or(0.0, |stretch| stretch[1])
    }

    /// Volume of what is left, mm³: between the lines of two columns, cones.
    #[must_use]
    pub fn volume(&self) -> f64 {
        let area = |column: usize| -> f64 {
            self.material(column).iter().map(|[low, high]| std::f64::consts::PI * (high * high - low * low)).sum()
        };
        let mut volume = 0.0;
        let last = self.len().saturating_sub(1);
        for column in 0..last {
            let (a, b) = (self.material(column), self.material(column + 1));
            volume += match (a, b) {
                ([[a0, a1]], [[b0, b1]]) => {
                    let cone = |p: f64, q: f64| std::f64::consts::PI / 3.0 * (p * p + p * q + q * q);
                    cone(*a1, *b1) - cone(*a0, *b0)
                }
                _ => f64::midpoint(area(column), area(column + 1)),
            };
        }
        // half a column at each end
        self.width * (volume + f64::midpoint(area(0), area(last)))
    }

    /// Whether a sweep would take anything away.
    #[must_use]
    pub fn meets(&self, sweep: &Sweep<'_>) -> bool {
        (0..self.spans.len()).any(|span| {
            let (first, end) = (span * SPAN * BLOCK, ((span + 1) * SPAN * BLOCK).min(self.columns.len()));
            self.may_meet(sweep, self.spans.get(span), first, end)
                && (first..end).any(|column| {
                    let covered = sweep.radii(self.z(column));
                    covered.is_some_and(|[low, high]| {
                        self.material(column).iter().any(|[from, to]| low < *to && high > *from)
                    })
                })
        })
    }

    /// Takes away what a sweep passes over; `taken` is told of every column that loses material.
    pub fn cut(&mut self, sweep: &Sweep<'_>, mut taken: impl FnMut(Taken)) {
        for span in 0..self.spans.len() {
            let first = span * SPAN;
            let end = (first + SPAN).min(self.blocks.len());
            if !self.may_meet(sweep, self.spans.get(span), first * BLOCK, end * BLOCK) {
                continue;
            }
            let mut has_changed = false;
            for block in first..end {
                let (low, high) = (block * BLOCK, ((block + 1) * BLOCK).min(self.columns.len()));
                if !self.may_meet(sweep, self.blocks.get(block), low, high) {
                    continue;
                }
                let mut is_cut = false;
                for column in low..high {
                    if let Some(loss) = self.cut_column(sweep, column) {
                        taken(loss);
                        is_cut = true;
                    }
                }
                if is_cut {
                    has_changed = true;
                    let reach = Reach::over(self.reach.get(low..high).into_iter().flatten().copied());
                    if let Some(block) = self.blocks.get_mut(block) {
                        *block = reach;
                    }
                }
            }
            if has_changed {
                let reach = Reach::over(self.blocks.get(first..end).into_iter().flatten().copied());
                if let Some(span) = self.spans.get_mut(span) {
                    *span = reach;
                }
            }
        }
    }

    /// Whether a sweep may reach material of the columns `low..high`, whose reach is given.
    #[inline]
    fn may_meet(&self, sweep: &Sweep<'_>, reach: Option<&Reach>, low: usize, high: usize) -> bool {
        let ends = [self.z(low), self.z(high.saturating_sub(1))];
        reach.is_some_and(|reach| !sweep.misses(ends, [reach.low, reach.high]))
    }

    #[inline]
    fn cut_column(&mut self, sweep: &Sweep<'_>, column: usize) -> Option<Taken> {
        let z = self.z(column);
        let reach = self.reach.get_mut(column)?;
        if sweep.misses([z, z], [reach.low, reach.high]) {
            return None;
        }
        let [low, high] = sweep.radii(z)?;
        if !reach.meets([low, high]) {
            return None;
        }
        let material = self.columns.get_mut(column)?;
        if let [[from, to]] = material.as_mut_slice()
            && *from <= low
            && high >= *to
        {
            // the outside of a solid column: nearly all there is
            let taken = Taken { column, z, radii: [low, *to], thickness: *to - low };
            *to = low;
            reach.high = low;
            return Some(taken);
        }
        let mut taken = Taken { column, z, radii: [f64::INFINITY, f64::NEG_INFINITY], thickness: 0.0 };
        let mut left = Material::new();
        for &[from, to] in material.iter() {
            let (a, b) = (from.max(low), to.min(high));
            if a >= b {
                left.push([from, to]);
                continue;
            }
            taken.thickness += b - a;
            taken.radii = [taken.radii[0].min(a), taken.radii[1].max(b)];
            if from < a {
                left.push([from, a]);
            }
            if b < to {
                left.push([b, to]);
            }
        }
        if taken.thickness <= 0.0 {
            return None;
        }
        *reach = match (left.first(), left.last()) {
            (Some(first), Some(last)) => Reach { low: first[0], high: last[1] },
            _ => Reach::NONE,
        };
        *material = left;
        Some(taken)
    }

    /// The outline of what is left, outside (and bore, where there is one), as polylines of `[z, x]` from the back to
    /// the face, with every point within `tolerance` of them. Material that hangs over is left out.
    #[must_use]
    pub fn outline(&self, tolerance: f64) -> [Vec<[f64; 2]>; 2] {
        let line = |radius: &dyn Fn(usize) -> f64| {
            let mut kept: Vec<[f64; 2]> = Vec::new();
            let points: Vec<[f64; 2]> = (0..self.len()).map(|k| [self.z(k), radius(k)]).collect();
            thin(&points, tolerance, &mut kept);
            kept
        };
        let outside = line(&|column| self.outside(column));
        let inside = line(&|column| self.material(column).first().map_or(0.0, |stretch| stretch[0]));
        [outside, inside]
    }
}

/// Keeps of a polyline what is needed to stay within `tolerance`, measured across Z: the greedy method of a cone of
/// slopes that narrows with each point.
fn thin(points: &[[f64; 2]], tolerance: f64, kept: &mut Vec<[f64; 2]>) {
    let Some((&first, rest)) = points.split_first() else { return };
    kept.push(first);
    let (mut anchor, mut last) = (first, first);
    let mut slopes = [f64::NEG_INFINITY, f64::INFINITY];
    for &point in rest {
        let run = point[0] - anchor[0];
        let slope = (point[1] - anchor[1]) / run;
        if slope < slopes[0] || slope > slopes[1] {
            kept.push(last);
            anchor = last;
            slopes = [f64::NEG_INFINITY, f64::INFINITY];
        }
        let run = point[0] - anchor[0];
        let rise = point[1] - anchor[1];
        slopes = [slopes[0].max((rise - tolerance) / run), slopes[1].min((rise + tolerance) / run)];
        last = point;
    }
    kept.push(last);
}
