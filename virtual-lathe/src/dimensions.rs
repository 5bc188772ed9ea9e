//! The sizes of a part as cut: measured on the stock, not read off the program.

use stock::Sample;

use crate::picture::Dimension;

/// Shorter pieces of the contour get no size, mm.
const SHORTEST: f64 = 0.6;
/// Positions nearer than this are one, mm.
const NEAR: f64 = 0.6;
/// Most sizes of a part.
const MOST: usize = 44;

/// A piece of the contour: the samples of one line of the program.
struct Piece<'s> {
    samples: Vec<&'s Sample>,
}

impl Piece<'_> {
    fn length(&self) -> f64 {
        self.samples.iter().map(|sample| sample.weight).sum()
    }

    fn is_wall(&self) -> bool {
        self.samples.iter().all(|sample| sample.normal.x.abs() < 0.02)
    }

    /// The mean of something.
    #[expect(clippy::cast_precision_loss, reason = "samples of a contour")]
    fn mean(&self, of: impl Fn(&Sample) -> f64) -> f64 {
        self.samples.iter().map(|sample| of(sample)).sum::<f64>() / self.samples.len().max(1) as f64
    }

    fn dimension(&self) -> Option<Dimension> {
        let middle = self.samples.get(self.samples.len() / 2)?;
        let place = [middle.place.z, middle.place.x];
        let text = if let Some(radius) = middle.arc {
            format!("R{:.2}", radius.abs())
        } else if middle.normal.z.abs() < 1e-4 {
            // the surface as cut, where it is
            format!("⌀{:.3}", 2.0 * self.mean(|sample| sample.place.x + sample.depth * sample.normal.x))
        } else if middle.normal.x.abs() < 0.3 {
            return None;
        } else {
            format!("{:.2}°", (middle.normal.z / middle.normal.x).atan().to_degrees().abs())
        };
        Some(Dimension { text, place })
    }
}

/// Diameters, radii, angles, and positions along Z of a contour's pieces.
pub fn of(samples: &[Sample]) -> Vec<Dimension> {
    let mut ordered: Vec<&Sample> = samples.iter().filter(|sample| sample.depth.is_finite()).collect();
    ordered.sort_by_key(|sample| sample.order);
    let mut pieces: Vec<Piece<'_>> = ordered
        .chunk_by(|a, b| a.line == b.line)
        .map(|chunk| Piece { samples: chunk.to_vec() })
        .filter(|piece| piece.length() >= SHORTEST)
        .collect();
    // those of many pieces show the longest
    pieces.sort_by(|a, b| b.length().total_cmp(&a.length()));
    pieces.truncate(MOST / 2);
    let mut dimensions: Vec<Dimension> = pieces.iter().filter_map(Piece::dimension).collect();
    let mut positions: Vec<f64> = Vec::new();
    // walls first: a position is theirs before it is that of a fillet beside them
    pieces.sort_by_key(|piece| !piece.is_wall());
    for piece in &pieces {
        for end in [piece.samples.first(), piece.samples.last()].into_iter().flatten() {
            let z = end.place.z + end.depth * end.normal.z;
            if dimensions.len() < MOST && positions.iter().all(|known| (known - z).abs() > NEAR) {
                positions.push(z);
                dimensions.push(Dimension {
                    text: format!("Z{}{:.2}", if z < -0.005 { "−" } else { "" }, z.abs()),
                    place: [z, end.place.x],
                });
            }
        }
    }
    dimensions
}
