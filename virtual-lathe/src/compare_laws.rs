//! The other half of the command `compare-methods`: speed, acceleration and jerk over time under each speed law.
//!
//! The speeds are those that the channel reports, tick by tick.

use std::io::{self, Write};
use std::path::Path;

use handcnc::background::parameters::Parameters;
use interp_core::block::{Block, Builder, Motion, Pace, Path as Way, Work};
use interp_core::channel::{Channel, State};
use interp_core::config::Machine;
use interp_core::law::SpeedLaw;
use interp_core::train::Event;
use interp_core::units::{Feedrate, Lattice, Length, Point};

use crate::output::{Pending, Places};
use crate::picture::{self, LawPanel};

/// Width of the PNG, pixels.
const WIDTH_PX: u32 = 1600;

/// Largest jerk, mm/s3: the default.
const JERK: f64 = 50_000.0;

/// A move to compare on.
struct Sample {
    title: &'static str,
    /// Ends, X and Z in um.
    ends: &'static [(i32, i32)],
    /// Feed, mm/min.
    feed: u64,
    /// From which tick which override.
    change: Option<(usize, u16)>,
}

const SAMPLES: [Sample; 4] = [
    Sample { title: "A long move: 12 mm at F2400", ends: &[(0, 12_000)], feed: 2_400, change: None },
    Sample { title: "A short move: 1.2 mm never reaches F2400", ends: &[(0, 1_200)], feed: 2_400, change: None },
    Sample { title: "Override to 50 % after 60 ms", ends: &[(0, 12_000)], feed: 2_400, change: Some((60, 50)) },
    Sample {
        title: "A corner of 8\u{b0}, passed at its speed",
        ends: &[(0, 5_000), (699, 9_974)],
        feed: 2_400,
        change: None,
    },
];

/// Draws the comparison into `folder`; tells what was written.
///
/// # Errors
/// Those of writing.
pub fn compare(folder: &Path, out: &mut impl Write) -> io::Result<()> {
    let panels: Vec<_> = SAMPLES.iter().map(Sample::panel).collect();
    let svg = picture::laws("Speed laws", JERK, &panels);
    let png = picture::png(&svg, WIDTH_PX).map_err(io::Error::other)?;
    let mut places = Places::default();
    std::fs::create_dir_all(folder)?;
    for (ending, bytes) in [("svg", svg.as_bytes()), ("png", &png)] {
        let path = folder.join("laws").with_extension(ending);
        places.output(&path)?;
        let mut file = Pending::create(&path)?;
        file.writer().write_all(bytes)?;
        file.keep()?;
        writeln!(out, "wrote {}", path.display())?;
    }
    for panel in &panels {
        write!(out, "  {}:", panel.title)?;
        for (law, speeds) in &panel.laws {
            write!(out, " {law} {} ms", speeds.len())?;
        }
        writeln!(out)?;
    }
    Ok(())
}

impl Sample {
    fn panel(&self) -> LawPanel {
        let laws: Vec<_> = SpeedLaw::ALL.into_iter().map(|law| (law, self.speeds(law))).collect();
        let joint = laws.first().and_then(|(_, (_, joint))| *joint);
        LawPanel {
            title: self.title.into(),
            level: joint.map(|speed| (speed, "speed of the joint".into())),
            laws: laws.into_iter().map(|(law, (speeds, _))| (law.name().into(), speeds)).collect(),
        }
    }

    fn motions(&self, machine: &Machine) -> Vec<Motion> {
        let mut builder = Builder::new(machine, Point::default());
        let pace = Feedrate::from_nm_per_min(self.feed * 1_000_000).map_or(Pace::Rapid, Pace::Feed);
        let point = |(x, z): (i32, i32)| {
            let length = |um| Length::from_um(um).unwrap_or_default();
            Point { x: length(x), z: length(z) }
        };
        self.ends.iter().flat_map(|end| builder.motion(Way::Line, point(*end), pace).motions).collect()
    }

    /// The speed in each tick, mm/s, and that of the joint.
    fn speeds(&self, law: SpeedLaw) -> (Vec<f64>, Option<f64>) {
        let machine = machine(law);
        let motions = self.motions(&machine);
        let joint = motions.get(1).map(|motion| f64::from(motion.joint) / 4_096e3);
        let works = motions.into_iter().map(Work::Motion).chain([Work::End]);
        let mut blocks = works.map(|work| Block { line: 1, work });
        let mut channel = Channel::<8>::new(&machine, Lattice::default());
        channel.start();
        let mut speeds = Vec::new();
        while channel.state() != State::Ended {
            if let Some((tick, percent)) = self.change
                && tick == speeds.len()
            {
                channel.set_feed_override(percent);
            }
            let report = channel.tick(&mut || blocks.next(), &mut |_: Event| {});
            if report.in_cycle {
                speeds.push(f64::from(report.speed) / 4_096e3);
            }
        }
        (speeds, joint)
    }
}

fn machine(law: SpeedLaw) -> Machine {
    let mut parameters = Parameters::new();
    // a name and a word of this list are right: a test runs it
    let _ = parameters.set("accel", law.name());
    parameters.machine().unwrap_or_else(|error| unreachable!("{error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pictures_show_the_jerk_that_is_promised_and_the_length_asked_for() {
        for sample in &SAMPLES {
            for (law, speeds) in sample.panel().laws {
                let length: f64 = speeds.iter().sum::<f64>() / 1e3;
                let first = [0, 0];
                let asked: f64 = sample
                    .ends
                    .iter()
                    .fold((0.0, first), |(sum, [x, z]), end| {
                        (sum + f64::from(end.0 - x).hypot(f64::from(end.1 - z)), [end.0, end.1])
                    })
                    .0
                    / 1e3;
                assert!((length - asked).abs() < 0.03 * asked, "{} {law}: {length} of {asked}", sample.title);
                let jerk = speeds.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).abs() * 1e6).fold(0.0, f64::max);
                if law == "linear" {
                    assert!(jerk > 2.0 * JERK);
                } else {
                    assert!(jerk <= 1.01 * JERK, "{} {law}: {jerk}", sample.title);
                }
            }
        }
    }
}
