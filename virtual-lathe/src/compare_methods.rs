//! The command `compare-methods`: what each pulse method does on a line and on an arc through several quadrants.
//!
//! A third sheet has every kind of curve. Each method's steps are those that the channel plays, decoded from its train, on pulses so coarse that single steps
//! show.

use std::io::{self, Write};
use std::path::Path;

use handcnc::background::parameters::Parameters;
use interp_core::block::{Block, Builder, Motion, Pace, Path as Way, Work};
use interp_core::channel::{Channel, State};
use interp_core::config::Machine;
use interp_core::curve::method::Method;
use interp_core::train::{Event, Levels};
use interp_core::units::{Axis, Feedrate, Lattice, Length, Point, Sense};

use crate::compare_curves;
use crate::output::{Pending, Places};
use crate::picture::{self, Panel, TrueCurve};

/// Size of a pulse of both axes, um.
const PULSE_UM: i32 = 10;

/// Width of the PNG, pixels.
const WIDTH_PX: u32 = 1600;

/// A curve to compare on, in pulses.
struct Sample {
    name: &'static str,
    title: &'static str,
    /// Start and end: X, Z.
    from: (i32, i32),
    to: (i32, i32),
    /// About (0, 0), counter-clockwise.
    round: bool,
}

const SAMPLES: [Sample; 2] = [
    Sample { name: "methods-line", title: "A line of 21 by 13 pulses", from: (0, 0), to: (13, 21), round: false },
    Sample {
        name: "methods-arc",
        title: "An arc of 270\u{b0}, radius 9.49 pulses",
        from: (3, 9),
        to: (-9, 3),
        round: true,
    },
];

/// Draws all comparisons into `folder`; gives what was written.
///
/// # Errors
/// Those of writing.
pub fn compare(folder: &Path, out: &mut impl Write) -> io::Result<()> {
    let mut places = Places::default();
    std::fs::create_dir_all(folder)?;
    let sheets = SAMPLES.iter().map(|sample| {
        let panels = Method::ALL.into_iter().map(|method| sample.panel(method)).collect();
        (sample.name, sample.title, panels)
    });
    let curves = std::iter::once((compare_curves::NAME, compare_curves::TITLE, compare_curves::panels()));
    for (name, title, panels) in sheets.chain(curves) {
        let svg = picture::methods(title, &panels);
        let png = picture::png(&svg, WIDTH_PX).map_err(io::Error::other)?;
        for (ending, bytes) in [("svg", svg.as_bytes()), ("png", &png)] {
            let path = folder.join(name).with_extension(ending);
            places.output(&path)?;
            let mut file = Pending::create(&path)?;
            file.writer().write_all(bytes)?;
            file.keep()?;
            writeln!(out, "wrote {}", path.display())?;
        }
        for panel in &panels {
            let worst = panel.errors.iter().fold(0.0_f64, |worst, error| worst.max(error.abs()));
            writeln!(out, "  {:<18} {:>3} steps, at most {worst:.3} pulses off", panel.title, panel.steps.len() - 1)?;
        }
    }
    Ok(())
}

impl Sample {
    fn panel(&self, method: Method) -> Panel {
        let falls_back = self.round && !method.serves_arcs();
        let steps = self.steps(method);
        let errors = steps.iter().map(|at| self.error(*at)).collect();
        let place = |(x, z): (i32, i32)| [f64::from(z), f64::from(x)];
        let curve = if self.round {
            TrueCurve::Arc { centre: [0.0, 0.0], from: place(self.from), to: place(self.to), clockwise: false }
        } else {
            TrueCurve::Line { from: place(self.from), to: place(self.to) }
        };
        let title = if falls_back { format!("{} (lines only)", method.name()) } else { method.name().into() };
        Panel { title, curve: picture::polyline(&curve), steps: steps.into_iter().map(place).collect(), errors }
    }

    /// Signed distance from the curve, pulses.
    fn error(&self, (x, z): (i32, i32)) -> f64 {
        let (ex, ez) = (f64::from(self.to.0), f64::from(self.to.1));
        if self.round {
            f64::from(x).hypot(f64::from(z)) - ex.hypot(ez)
        } else {
            (f64::from(x) * ez - f64::from(z) * ex) / ex.hypot(ez)
        }
    }

    /// The lattice points that the channel's train visits: X, Z.
    fn steps(&self, method: Method) -> Vec<(i32, i32)> {
        let machine = machine(method);
        let point = |(x, z): (i32, i32)| Point { x: length(x), z: length(z) };
        let mut builder = Builder::new(&machine, point(self.from));
        let way = if self.round { Way::Arc { centre: (0, 0), sense: Sense::CounterClockwise } } else { Way::Line };
        let pace = Feedrate::from_nm_per_min(60_000_000).map_or(Pace::Rapid, Pace::Feed);
        let built = builder.motion(way, point(self.to), pace);
        play(&machine, Lattice { x: self.from.0, z: self.from.1 }, &built.motions)
    }
}

/// The lattice points that the channel's train visits on these motions: X, Z.
pub(crate) fn play(machine: &Machine, from: Lattice, motions: &[Motion]) -> Vec<(i32, i32)> {
    let work = motions.iter().map(|motion| Work::Motion(*motion)).chain([Work::End]);
    let mut blocks = work.map(|work| Block { line: 1, work });
    let mut channel = Channel::<8>::new(machine, from);
    channel.start();
    let start = (from.x, from.z);
    let (mut at, mut levels, mut steps) = (start, Levels::LOW, vec![start]);
    // the last pulse may be played in the tick behind the end
    let mut behind = 0;
    while behind < 2 {
        behind += u32::from(channel.state() == State::Ended);
        let mut play = |event: Event| {
            let now = event.levels();
            let rises = |axis| now.step(axis) && !levels.step(axis);
            let (x, z) = (rises(Axis::X), rises(Axis::Z));
            let pulse = |axis| if now.plus(axis) { 1 } else { -1 };
            at = (at.0 + if x { pulse(Axis::X) } else { 0 }, at.1 + if z { pulse(Axis::Z) } else { 0 });
            if x || z {
                steps.push(at);
            }
            levels = now;
        };
        channel.tick(&mut || blocks.next(), &mut play);
    }
    steps
}

/// So many pulses.
pub(crate) fn length(pulses: i32) -> Length {
    Length::from_um(pulses * PULSE_UM).unwrap_or_default()
}

/// A machine with coarse pulses.
pub(crate) fn machine(method: Method) -> Machine {
    let mut parameters = Parameters::new();
    for (name, value) in [("x.pulse_nm", "10000"), ("z.pulse_nm", "10000"), ("method", method.name())] {
        // names and values of this list are right: a test runs it
        let _ = parameters.set(name, value);
    }
    parameters.machine().unwrap_or_else(|error| unreachable!("{error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_leads_to_the_end_within_its_bound() {
        for sample in &SAMPLES {
            for method in Method::ALL {
                let steps = sample.steps(method);
                assert_eq!(steps.last(), Some(&sample.to), "{} {}", sample.name, method.name());
                let bound = match method {
                    Method::MinimumDeviation => 0.5,
                    _ if sample.round && !method.serves_arcs() => 0.5,
                    _ => 1.06,
                };
                for at in steps {
                    assert!(sample.error(at).abs() <= bound, "{} {} {at:?}", sample.name, method.name());
                }
            }
        }
    }
}
