//! A bench for the tests: tools, bars, and cuts along curves.
#![allow(dead_code, unreachable_pub, missing_docs, reason = "shared by tests")]

use stock::{Bar, BarData, Contour, Curve, Cutting, Kind, Motion, Outcome, Point, Setup, Sweep, Tool, ToolData};

/// A right-hand tool of 80 degrees, its front edge 5 degrees beyond the square.
pub const SIDE: ToolData = ToolData { nose: 0.4, tip: 3, front: 85.0, back: 5.0, edge: 11.0 };
/// A neutral tool of 35 degrees.
pub const NEUTRAL: ToolData = ToolData { nose: 0.4, tip: 8, front: 107.5, back: 72.5, edge: 11.0 };
/// A tool of 35 degrees, the centre of its nose programmed.
pub const CENTRE: ToolData = ToolData { nose: 0.4, tip: 9, front: 87.0, back: 52.0, edge: 11.0 };

pub const BAR: BarData = BarData { radius: 16.0, bore: 0.0, back: -60.0, face: 0.0 };

pub fn at(z: f64, x: f64) -> Point {
    Point::new(z, x)
}

pub fn line(from: Point, to: Point) -> Curve {
    Curve { line: 1, from, to, arc: None }
}

/// Cuts a bar along a polyline of places of the programmed point.
pub fn cut(bar: BarData, tool: ToolData, places: &[Point]) -> Bar {
    let tool = Tool::new(tool).unwrap();
    let mut bar = Bar::new(bar);
    for (from, to) in places.iter().zip(places.iter().skip(1)) {
        bar.cut(&Sweep::new(&tool, tool.centre(*from), tool.centre(*to)), |_| {});
    }
    bar
}

/// A program's motions: kind, and the places it goes through. The contour is that of the feeds.
pub struct Program {
    pub bar: BarData,
    pub tool: ToolData,
    pub moves: Vec<(Kind, Vec<Point>)>,
    pub curves: Vec<Curve>,
}

impl Program {
    pub fn run(&self) -> Outcome {
        self.run_with(|point| point)
    }

    /// With each place moved, as a machine that errs would.
    pub fn run_with(&self, actual: impl Fn(Point) -> Point) -> Outcome {
        let tool = Tool::new(self.tool).unwrap();
        let contour = Contour::new(&self.curves, &tool, self.bar);
        assert!(contour.errors().is_empty(), "{:?}", contour.errors());
        let mut cutting = Cutting::new(Setup { bar: self.bar, tool, jaws: None, contour, tolerance: 0.0025 });
        let mut time_ns = 0;
        for ((kind, places), line) in self.moves.iter().zip(1..) {
            for place in places {
                let place = actual(*place);
                let [x_nm, z_nm] = [place.x, place.z].map(|mm| mm * 1e6);
                cutting.follow(Motion { time_ns, x_nm, z_nm, kind: *kind, line });
                time_ns += 1_000_000;
            }
        }
        cutting.finish()
    }
}
