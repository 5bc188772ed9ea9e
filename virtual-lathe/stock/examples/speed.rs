//! How fast a program's pulses are followed: ten roughing passes and a finishing pass over 100 mm, pulse by pulse.

use std::time::Instant;

use stock::{BarData, Contour, Curve, Cutting, Kind, Motion, Point, Setup, Tool, ToolData};

fn main() -> Result<(), stock::ToolError> {
    let tool = Tool::new(ToolData { nose: 0.4, tip: 3, front: 87.0, back: 52.0, edge: 11.0 })?;
    let bar = BarData { radius: 16.0, bore: 0.0, back: -120.0, face: 1.0 };
    let curve = Curve { line: 21, from: Point::new(2.0, 6.0), to: Point::new(-100.0, 8.0), arc: None };
    let began = Instant::now();
    let contour = Contour::new(&[curve], &tool, bar);
    println!("contour of {} samples in {:.2} s", contour.samples().len(), began.elapsed().as_secs_f64());
    let mut cutting = Cutting::new(Setup { bar, tool, jaws: None, contour, tolerance: 0.0025 });
    let (mut steps, mut time_ns) = (0_u64, 0);
    let began = Instant::now();
    for pass in (0..=10).rev() {
        let x = 6e6 + f64::from(pass) * 0.9e6;
        for (kind, from, to) in [(Kind::Feed, 2e6, -100e6), (Kind::Rapid, -100e6, 2e6)] {
            let lift = if kind == Kind::Rapid { 0.5e6 } else { 0.0 };
            for k in 0..40_800_u32 {
                let part = f64::from(k) / 40_799.0;
                let z = from + (to - from) * part;
                // a staircase of pulses along a slight cone
                let rise = ((2e6 - z) / 102e6 * 2e6 / 1250.0).round() * 1250.0;
                time_ns += 1_000_000;
                cutting.follow(Motion { time_ns, x_nm: x + rise + lift, z_nm: z, kind, line: 20 });
                steps += 1;
            }
        }
    }
    let took = began.elapsed().as_secs_f64();
    let outcome = cutting.finish();
    println!(
        "{steps} positions in {took:.2} s, {:.2} us each",
        took * 1e6 / f64::from(u32::try_from(steps).unwrap_or(1))
    );
    println!("{:?}, {} collisions, {:.1} mm3", outcome.surface, outcome.collisions_total, outcome.removed_mm3);
    Ok(())
}
