//! Programs of lines and half circles.
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

use interp_core::block::{Builder, Motion, Pace, Path};
use interp_core::config::Machine;
use interp_core::units::{Feedrate, Length, Point, Sense};

fn point(x_um: i32, z_um: i32) -> Point {
    Point { x: Length::from_um(x_um).unwrap(), z: Length::from_um(z_um).unwrap() }
}

/// A piece of a program: a relative end in um, or a half circle of a radius to either side.
#[derive(Clone, Debug)]
pub(crate) enum Piece {
    Line(i32, i32),
    Half(i32, bool),
}

/// Their motions from the zero point, at so many mm/min.
pub(crate) fn motions(machine: &Machine, pieces: &[Piece], feed: i64) -> Vec<Motion> {
    let (mut builder, mut at) = (Builder::new(machine, point(0, 0)), (0, 0));
    let pace = Pace::Feed(Feedrate::from_nm_per_min(feed.cast_unsigned() * 1_000_000).unwrap());
    let mut motions = Vec::new();
    for piece in pieces {
        let (path, end) = match piece {
            Piece::Line(x, z) => (Path::Line, (at.0 + x, at.1 + z)),
            Piece::Half(radius, left) => {
                let centre = (i64::from(at.0) * 1_000, i64::from(at.1 + radius) * 1_000);
                let sense = if *left { Sense::CounterClockwise } else { Sense::Clockwise };
                (Path::Arc { centre, sense }, (at.0, at.1 + 2 * radius))
            }
        };
        motions.extend(builder.motion(path, point(end.0, end.1), pace).motions.iter().copied());
        at = end;
    }
    motions
}
