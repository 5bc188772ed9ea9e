//! What is measured: programs with the parameters that belong to them.

use Program::{Repeated, Text};

/// A case: its name, its program, its parameters.
pub(crate) struct Case(pub(crate) &'static str, Program, &'static [&'static [&'static str]]);

/// A case's program.
enum Program {
    Text(&'static str),
    /// What begins it, and what is repeated so often.
    Repeated(&'static str, &'static str, usize),
}

impl Case {
    /// Its parameters.
    pub(crate) fn parameters(&self) -> Vec<String> {
        self.2.concat().into_iter().map(str::to_owned).collect()
    }

    /// Its program's text.
    pub(crate) fn program(&self) -> String {
        match self.1 {
            Program::Text(text) => text.to_owned(),
            Program::Repeated(begin, again, times) => format!("{begin}{}M2\n", again.repeat(times)),
        }
    }
}

// a space below the default's 5 us, since 100 000 pulses a second and the tick's border need it
const PULSES: [&str; 6] = [
    "x.pulse_nm=1000",
    "z.pulse_nm=1000",
    "x.max_feed=6000",
    "z.max_feed=6000",
    "x.min_space_ns=4500",
    "z.min_space_ns=4500",
];

// pins that are high and low for 2 us: 200 000 pulses a second are 80 % of what they, the events' distance and the
// tick's border allow
const FAST: [&str; 10] = [
    "x.pulse_nm=1000",
    "z.pulse_nm=1000",
    "x.max_feed=12000",
    "z.max_feed=12000",
    "x.max_accel=20000",
    "z.max_accel=20000",
    "x.pulse_width_ns=2000",
    "z.pulse_width_ns=2000",
    "x.min_space_ns=2000",
    "z.min_space_ns=2000",
];

/// Beside [`PULSES`]: an axis's play taken up, expansion followed, and an override.
const COMPENSATED: [&str; 8] = [
    "x.backlash_um=20",
    "z.backlash_um=30",
    "x.backlash_distance_um=200",
    "z.backlash_distance_um=200",
    "x.thermal_um_per_m_k=11.5",
    "z.thermal_um_per_m_k=11.5",
    "temperature_c=35",
    "feed_override=90",
];

/// Beside [`PULSES`]: a spindle of 996 turns a minute.
const SPINDLE: [&str; 1] = ["0:spindle=68*5000"];

const SINE: [&str; 1] = ["accel=sine"];

/// Everything at once: both axes at 100 000 pulses a second, compensated, under the sine law, both handwheels turned.
const EVERYTHING: [&str; 21] = [
    "x.pulse_nm=1000",
    "z.pulse_nm=1000",
    "x.max_feed=9000",
    "z.max_feed=9000",
    "x.max_accel=5000",
    "z.max_accel=5000",
    "x.pulse_width_ns=2500",
    "z.pulse_width_ns=2500",
    "x.min_space_ns=2000",
    "z.min_space_ns=2000",
    "x.backlash_um=20",
    "z.backlash_um=30",
    "x.thermal_um_per_m_k=11.5",
    "z.thermal_um_per_m_k=11.5",
    "temperature_c=35",
    "accel=sine",
    "max_jerk=200000",
    "handwheels=true",
    "60:wheel-x=3*2000",
    "60:wheel-z=-2*2000",
    "200:override=97",
];

/// Beside [`EVERYTHING`]: 75 mm before the soft limits to plus, near enough that every tick asks whether they are kept.
const BEFORE_LIMITS: [&str; 2] = ["x.limit_plus_mm=75", "z.limit_plus_mm=75"];

pub(crate) const CASES: [Case; 20] = [
    Case("line 4:3, X at 80 kHz", Text("G21 G90\nG4 P0.05\nG1 X40 Z30 F6000\nM2\n"), &[&PULSES]),
    Case("arc, R 10 mm, 25 kHz", Text("G21 G90\nG4 P0.05\nG3 X-10 Z-10 I-10 K0 F1500\nM2\n"), &[&PULSES]),
    // its centre lies between the lattice lines, so the walk needs 64 bits
    Case("arc, R 10 mm by R, 25 kHz", Text("G21 G90\nG4 P0.05\nG3 X-12 Z-11 R10 F1500\nM2\n"), &[&PULSES]),
    Case("line 1:1, 71 kHz", Text("G21 G90\nG4 P0.05\nG1 X30 Z30 F6000\nM2\n"), &[&PULSES]),
    Case("line 4:3, X at 200 kHz", Text("G21 G90\nG4 P0.05\nG0 X80 Z60\nM2\n"), &[&FAST]),
    Case("arc, R 50 mm, 200 kHz", Text("G21 G90\nG4 P0.05\nG3 X-50 Z-50 I-50 K0 F12000\nM2\n"), &[&FAST]),
    Case(
        "line 4:3, compensated, override 90 %",
        Text("G21 G90\nG4 P0.05\nG1 X40 Z30 F6000\nM2\n"),
        &[&PULSES, &COMPENSATED],
    ),
    Case(
        "arc, R 10 mm, compensated, override 90 %",
        Text("G21 G90\nG4 P0.05\nG3 X-10 Z-10 I-10 K0 F1500\nM2\n"),
        &[&PULSES, &COMPENSATED],
    ),
    Case("line 4:3, sine law", Text("G21 G90\nG4 P0.05\nG1 X40 Z30 F6000\nM2\n"), &[&PULSES, &SINE]),
    Case(
        "line 4:3, a feed a turn, X at 80 kHz",
        Text("G21 G90\nM3 S1000\nG4 P0.05\nG95 G1 X40 Z30 F6\nM2\n"),
        &[&PULSES, &SPINDLE],
    ),
    Case(
        "thread of 30 mm, lead 4.8 mm, 80 kHz",
        Text("G21 G90\nM3 S1000\nG4 P0.05\nG33 Z30 K4.8\nM2\n"),
        &[&PULSES, &SPINDLE],
    ),
    Case(
        "thread of 120 mm, lead 4.8 mm, 80 kHz",
        Text("G21 G90\nM3 S1000\nG4 P0.05\nG33 Z120 K4.8\nM2\n"),
        &[&PULSES, &SPINDLE],
    ),
    Case("line 1:1, everything, 2 x 100 kHz", Text("G21 G90\nG4 P0.05\nG1 X60 Z60 F8485\nM2\n"), &[&EVERYTHING]),
    Case(
        "arc, R 50 mm, everything, 141 kHz",
        Text("G21 G90\nG4 P0.05\nG3 X-50 Z-50 I-50 K0 F8485\nM2\n"),
        &[&EVERYTHING],
    ),
    Case("arc, R 10 mm, sine law", Text("G21 G90\nG4 P0.05\nG3 X-10 Z-10 I-10 K0 F1500\nM2\n"), &[&PULSES, &SINE]),
    Case("short lines of 0.14 mm, everything", LINES, &[&EVERYTHING]),
    Case("short lines, everything, before a limit", LINES, &[&EVERYTHING, &BEFORE_LIMITS]),
    Case("short lines in a wave, everything", WAVE, &[&EVERYTHING]),
    Case("short arcs, everything", ARCS, &[&EVERYTHING]),
    Case("short lines in a wave, blended, everything, before a limit", BLENDED, &[&EVERYTHING, &BEFORE_LIMITS]),
];

/// Lines of 0.14 mm, one a tick.
const LINES: Program = Repeated("G21 G90\nG4 P0.05\nG91\n", "G1 F8485 X0.1 Z0.1\n", 600);

/// The same, turning by 0.6 degrees there and back.
const WAVE: Program =
    Repeated("G21 G90\nG4 P0.05\nG91\n", "G1 F8485 X0.1 Z0.1\nX0.101 Z0.099\nX0.1 Z0.1\nX0.099 Z0.101\n", 150);

/// Arcs of 0.14 mm that bend there and back.
const ARCS: Program = Repeated("G21 G90\nG4 P0.05\nG91\n", "G2 F8485 X0.1 Z0.1 R20\nG3 X0.1 Z0.1 R20\n", 100);

/// Lines whose corners are blended.
const BLENDED: Program = Repeated("G21 G90\nG4 P0.05\nG64 P0.01\nG91\n", "G1 F8485 X0.15 Z0.1\nX0.1 Z0.15\n", 100);
