//! The picture of a scenario.

use interp_core::config::Machine;
use interp_core::units::{Lattice, PulseSize};

use super::chronicle::{Chronicle, Mark};
use super::event::Wheel;
use crate::picture::operation::{self, Moment, Operation, Stretch};

/// Farthest that an axis can go in a tick, mm: beyond it the coordinates were set. 30 m/min are 0.5 mm.
const FARTHEST: f64 = 0.6;

/// The picture of what went on; `facts` stand beside the title.
pub(super) fn sheet(title: &str, facts: String, chronicle: &Chronicle, machine: &Machine) -> Operation {
    let place = |at: Lattice| [mm(machine.z.pulse, at.z), mm(machine.x.pulse, at.x)];
    let mut moments: Vec<Moment> = Vec::new();
    let mut modes: Vec<Stretch> = Vec::new();
    let mut last: Option<&super::chronicle::Moment> = None;
    for moment in chronicle.moments() {
        let (time, moved) = (seconds(moment.tick), place(moment.position));
        let jumps = last.is_some_and(|last| {
            let before = place(last.position);
            let ticks = seconds(moment.tick - last.tick) * 1e3;
            moved.iter().zip(before).any(|(now, before)| (now - before).abs() > FARTHEST * ticks)
        });
        moments.push(Moment { time, programmed: place(moment.programmed), moved, jumps });
        let name = if moment.power { moment.mode.name() } else { "no power" };
        match modes.last_mut() {
            Some(band) if band.name == name => band.to = time,
            _ => {
                if let Some(band) = modes.last_mut() {
                    band.to = time;
                }
                modes.push(Stretch { from: time, to: time, name: name.into() });
            }
        }
        last = Some(moment);
    }
    let hands = [(Wheel::X, "wheel X"), (Wheel::Z, "wheel Z"), (Wheel::Contour, "contour")];
    let hands = hands.map(|(wheel, name)| (name.to_owned(), turns(chronicle, wheel)));
    let marks = chronicle.marks().iter().filter_map(|mark| match mark {
        Mark::Refusal(tick, name) => {
            Some(operation::Mark { time: seconds(*tick), name: name.clone(), is_alarm: false })
        }
        Mark::Alarm(tick, name) => Some(operation::Mark { time: seconds(*tick), name: name.clone(), is_alarm: true }),
        Mark::Turn(..) | Mark::Asked(..) => None,
    });
    Operation {
        title: title.into(),
        subtitle: facts,
        moments,
        modes,
        hands: hands.into_iter().filter(|(_, turns)| !turns.is_empty()).collect(),
        requests: requests(chronicle),
        marks: marks.collect(),
    }
}

/// What was asked for when; what came in one tick stands together.
fn requests(chronicle: &Chronicle) -> Vec<operation::Request> {
    let mut requests: Vec<operation::Request> = Vec::new();
    let mut last = None;
    for mark in chronicle.marks() {
        let Mark::Asked(tick, words) = mark else { continue };
        match requests.last_mut() {
            Some(request) if last == Some(tick) => request.words.push(words.clone()),
            _ => requests.push(operation::Request { time: seconds(*tick), words: vec![words.clone()] }),
        }
        last = Some(tick);
    }
    requests
}

/// When a wheel is turned.
fn turns(chronicle: &Chronicle, wheel: Wheel) -> Vec<Stretch> {
    let of = |mark: &Mark| match *mark {
        Mark::Turn(turned, from, to, detents) if turned == wheel => {
            Some(Stretch { from: seconds(from), to: seconds(to), name: format!("{detents:+}") })
        }
        _ => None,
    };
    chronicle.marks().iter().filter_map(of).collect()
}

fn mm(pulse: PulseSize, pulses: i32) -> f64 {
    f64::from(pulses) * f64::from(pulse.numerator()) / f64::from(pulse.denominator()) * 1e-6
}

#[expect(clippy::cast_precision_loss, reason = "ticks of a scenario")]
fn seconds(ticks: u64) -> f64 {
    ticks as f64 / 1e3
}
