//! Sample drawings: contours walked on the lattice of the pulses, as a machine would.
#![allow(
    dead_code,
    unreachable_pub,
    missing_docs,
    clippy::cast_possible_truncation,
    reason = "shared by tests and example; positions are far inside i32"
)]

use std::f64::consts::TAU;

use virtual_lathe::picture::{Drawing, Inset, Kind, Thinner, TrueCurve};

/// Pulse sizes of the sample lathe, z and x, in mm.
pub const PULSE: [f64; 2] = [0.0025, 0.00125];

/// Walks curves on the lattice, and keeps what the drawing needs.
pub struct Walk {
    thinner: Thinner,
    at: [f64; 2],
    pulses: [i32; 2],
    start: [f64; 2],
    visited: Vec<[i32; 2]>,
    curves: Vec<TrueCurve>,
}

impl Walk {
    pub fn from(start: [f64; 2]) -> Self {
        let mut walk = Self {
            thinner: Thinner::new(0.002, 20_000),
            at: start,
            pulses: nearest(start),
            start,
            visited: Vec::new(),
            curves: Vec::new(),
        };
        walk.play(Kind::Rapid);
        walk
    }

    fn play(&mut self, kind: Kind) {
        let [z, x] = self.pulses;
        self.visited.push(self.pulses);
        self.thinner.push(kind, [f64::from(z) * PULSE[0], f64::from(x) * PULSE[1]]);
    }

    /// Steps, one pulse at a time, to the lattice point nearest to `place`.
    fn step_to(&mut self, kind: Kind, place: [f64; 2]) {
        let goal = nearest(place);
        while self.pulses != goal {
            let [z, x] = self.pulses;
            self.pulses = [z + (goal[0] - z).signum(), x + (goal[1] - x).signum()];
            self.play(kind);
        }
    }

    fn line(&mut self, kind: Kind, to: [f64; 2]) -> &mut Self {
        let from = self.at;
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let parts = (length / 0.0005).ceil().max(1.0) as i32;
        for k in 1..=parts {
            let part = f64::from(k) / f64::from(parts);
            self.step_to(kind, [from[0] + part * (to[0] - from[0]), from[1] + part * (to[1] - from[1])]);
        }
        if kind == Kind::Feed {
            self.curves.push(TrueCurve::Line { from, to });
        }
        self.at = to;
        self
    }

    pub fn rapid(&mut self, to: [f64; 2]) -> &mut Self {
        self.line(Kind::Rapid, to)
    }

    pub fn feed(&mut self, to: [f64; 2]) -> &mut Self {
        self.line(Kind::Feed, to)
    }

    pub fn arc(&mut self, centre: [f64; 2], to: [f64; 2], clockwise: bool) -> &mut Self {
        let from = self.at;
        let angle = |p: [f64; 2]| (p[1] - centre[1]).atan2(p[0] - centre[0]);
        let radius = (from[0] - centre[0]).hypot(from[1] - centre[1]);
        let sense = if clockwise { -1.0 } else { 1.0 };
        let turn = ((angle(to) - angle(from)) * sense).rem_euclid(TAU);
        let parts = (turn * radius / 0.0005).ceil().max(1.0) as i32;
        for k in 1..=parts {
            let now = angle(from) + sense * turn * f64::from(k) / f64::from(parts);
            self.step_to(Kind::Arc, [centre[0] + radius * now.cos(), centre[1] + radius * now.sin()]);
        }
        self.curves.push(TrueCurve::Arc { centre, from, to, clockwise });
        self.at = to;
        self
    }

    pub fn inset(&self, title: &str, centre: [f64; 2], half_width: f64) -> Inset {
        let middle = nearest(centre);
        let reach = nearest([half_width, 3.0 * half_width]);
        let visited = self
            .visited
            .iter()
            .filter(|p| (p[0] - middle[0]).abs() <= reach[0] && (p[1] - middle[1]).abs() <= reach[1])
            .copied()
            .collect();
        Inset { title: title.into(), centre, half_width, pulse: PULSE, visited, curves: self.curves.clone() }
    }

    pub fn drawing(&self, title: &str, subtitle: &str, insets: Vec<Inset>) -> Drawing {
        Drawing {
            title: title.into(),
            subtitle: subtitle.into(),
            tracks: self.thinner.tracks(),
            start: self.start,
            end: self.at,
            insets,
            section: None,
        }
    }
}

fn nearest(place: [f64; 2]) -> [i32; 2] {
    [(place[0] / PULSE[0]).round() as i32, (place[1] / PULSE[1]).round() as i32]
}

/// A turned handle: face, ball, neck, taper, groove, fillet, collar.
pub fn handle() -> Drawing {
    let mut walk = Walk::from([5.0, 20.0]);
    walk.rapid([0.0, 13.0]).feed([0.0, 0.0]);
    walk.arc([-7.0, 0.0], [-7.0 - 24.0_f64.sqrt(), 5.0], false)
        .feed([-16.0, 5.0])
        .arc([-22.0, 10.5], [-28.0, 5.0], true)
        .feed([-62.0, 9.5])
        .feed([-66.0, 9.5])
        .feed([-66.0, 7.5])
        .feed([-69.0, 7.5])
        .feed([-69.0, 9.5])
        .feed([-84.0, 9.5])
        .arc([-84.0, 13.5], [-88.0, 13.5], true)
        .feed([-88.0, 15.0])
        .feed([-97.0, 15.0])
        .rapid([-97.0, 20.0])
        .rapid([5.0, 20.0]);
    let insets = vec![
        walk.inset("Ball, near its equator", [-7.0, 7.0], 0.030),
        walk.inset("Taper", [-45.0, 7.25], 0.025),
        walk.inset("Fillet into the shoulder", [-87.6, 11.75], 0.030),
    ];
    walk.drawing(
        "Turned handle, finishing pass",
        "Time 2 min 41.6 s · 78 412 pulses of Z, 53 206 of X · greatest deviation 0.94 µm of 1.40 µm allowed",
        insets,
    )
}

/// Two straights with two half circles.
pub fn stadium() -> Drawing {
    let mut walk = Walk::from([15.0, 25.0]);
    walk.rapid([-20.0, 40.0]).feed([-90.0, 40.0]).arc([-90.0, 20.0], [-90.0, 0.0], false).feed([-20.0, 0.0]).arc(
        [-20.0, 20.0],
        [-20.0, 40.0],
        false,
    );
    let insets = vec![
        walk.inset("Where straight and half circle meet", [-90.0, 40.0], 0.06),
        walk.inset("At 45°", [-20.0 + 200.0_f64.sqrt(), 20.0 + 200.0_f64.sqrt()], 0.025),
    ];
    walk.drawing("Two straights, two half circles", "41.2 s · 102 400 pulses · deviation at most 0.88 µm", insets)
}

/// One feed along Z.
pub fn single_line() -> Drawing {
    let mut walk = Walk::from([2.0, 10.0]);
    walk.feed([-30.0, 10.0]);
    let inset = walk.inset("The end of the line", [-30.0, 10.0], 0.03);
    walk.drawing("Single line", "3.2 s · 12 800 pulses", vec![inset])
}

/// One feed along X, on the way to the axis.
pub fn plunge() -> Drawing {
    let mut walk = Walk::from([-10.0, 12.0]);
    walk.feed([-10.0, 4.0]);
    walk.drawing("Plunge", "", Vec::new())
}

/// Nothing but a place.
pub fn single_point() -> Drawing {
    let walk = Walk::from([3.0, 7.5]);
    let inset = walk.inset("The only point", [3.0, 7.5], 0.02);
    walk.drawing("Single point", "0 pulses", vec![inset])
}

/// A large face with a few grooves.
pub fn tall() -> Drawing {
    let mut walk = Walk::from([4.0, 105.0]);
    walk.rapid([0.0, 102.0])
        .feed([0.0, 70.0])
        .feed([-3.0, 68.0])
        .feed([-3.0, 50.0])
        .arc([-3.0, 46.0], [-3.0, 42.0], false)
        .feed([0.0, 38.0])
        .feed([0.0, 0.0])
        .rapid([4.0, 0.0])
        .rapid([4.0, 105.0]);
    let insets = vec![
        walk.inset("Chamfer", [-1.5, 69.0], 0.02),
        walk.inset("Middle of the rounded groove in the face", [-7.0, 46.0], 0.02),
        walk.inset("Chamfer", [-1.5, 40.0], 0.02),
    ];
    walk.drawing(
        "Face with a groove",
        "Time 58.3 s · 2 404 pulses of Z, 164 000 of X\nGreatest deviation 0.71 µm",
        insets,
    )
}

/// 200 mm long and 5 mm high, with three insets.
pub fn long() -> Drawing {
    let mut walk = Walk::from([2.0, 12.0]);
    walk.rapid([0.0, 7.0])
        .feed([-120.0, 8.0])
        .feed([-120.0, 10.0])
        .feed([-198.0, 10.0])
        .rapid([-198.0, 12.0])
        .rapid([2.0, 12.0]);
    let insets = vec![
        walk.inset("Slow taper, 1 : 120", [-60.0, 7.5], 0.05),
        walk.inset("Corner", [-120.0, 8.0], 0.02),
        walk.inset("Step", [-120.0, 10.0], 0.02),
    ];
    walk.drawing("Long shaft & <taper>", "3 min 2 s", insets)
}

/// As wide as high, roughing in many passes, two insets.
pub fn square() -> Drawing {
    let mut walk = Walk::from([3.0, 55.0]);
    for pass in 1..=12 {
        let x = 52.0 - 3.0 * f64::from(pass);
        walk.rapid([3.0, x])
            .feed([-50.0 + 4.0 * f64::from(pass) - 4.0, x])
            .feed([-50.0 + 4.0 * f64::from(pass) - 3.0, x + 1.0])
            .rapid([3.0, x + 1.0]);
    }
    walk.rapid([3.0, 55.0]);
    let insets = vec![walk.inset("Lift", [-49.5, 49.5], 0.02), walk.inset("Coarse: many pulses", [-20.0, 28.5], 1.0)];
    walk.drawing("Roughing", "Time 4 min 12 s, 12 passes", insets)
}

/// Everything at once that a caller can get wrong, far from the centre line.
pub fn messy() -> Drawing {
    let mut walk = Walk::from([-300.0, 410.0]);
    walk.feed([-300.6, 410.2]).arc([-300.6, 410.5], [-300.9, 410.5], true);
    let mut insets = vec![
        walk.inset(
            "A heading that is far too long for the panel that it stands over, <b>&amp;</b>",
            [-300.3, 410.1],
            0.02,
        ),
        walk.inset("", [-300.3, 410.1], 50.0),
        walk.inset("Nothing\u{0} usable", [-300.81, 410.29], f64::NAN),
    ];
    if let Some(inset) = insets.last_mut() {
        inset.pulse = [0.0, f64::NAN];
    }
    let facts = "Time 1 s · a fact that goes on, ".repeat(30);
    let mut drawing = walk.drawing("\"Quoted\" & 'escaped' ]]> <svg>\u{b}", &facts, insets);
    drawing
        .tracks
        .push(virtual_lathe::picture::Track { kind: Kind::Rapid, points: vec![[f64::NAN, 0.0], [f64::INFINITY, 0.0]] });
    drawing.end = [f64::NAN, f64::NAN];
    drawing
}

/// No track at all.
pub fn nothing() -> Drawing {
    Drawing {
        title: String::new(),
        subtitle: String::new(),
        tracks: Vec::new(),
        start: [f64::NAN; 2],
        end: [f64::NAN; 2],
        insets: Vec::new(),
        section: None,
    }
}

/// All of them, with the names of their files.
pub fn all() -> Vec<(&'static str, Drawing)> {
    vec![
        ("handle", handle()),
        ("stadium", stadium()),
        ("line", single_line()),
        ("plunge", plunge()),
        ("point", single_point()),
        ("tall", tall()),
        ("long", long()),
        ("square", square()),
        ("messy", messy()),
        ("nothing", nothing()),
    ]
}
