//! Compensation end to end: the machine's slides, by the machine's own model, with the control compensating or not.
#![allow(clippy::unwrap_used, missing_docs, reason = "a test")]

use virtual_lathe::pitch_table;
use virtual_lathe::settings::Settings;
use virtual_lathe::slides::{self, Place};

/// A circle about X30 (radius) Z-20, radius 10, at a feed of 200 mm/min.
const CIRCLE: &str = "G21 G90 G94\nG2 X40 Z-20 I-10 K0 F200\nM30\n";
const PLAY: [(&str, &str); 2] = [("slide.x.backlash_um", "20"), ("slide.z.backlash_um", "30")];
const SCREW: [(&str, &str); 1] = [("screw.z.error", "-40:8;-30:12;-20:0;-10:-12;0:-5")];
const TAKEN: [(&str, &str); 2] = [("x.backlash_um", "20"), ("z.backlash_um", "30")];
const TABLE: &str = "z -40 8\nz -30 12\nz -20 0\nz -10 -12\nz 0 -5\n";

fn follow(program: &str, sets: &[&[(&str, &str)]], table: bool) -> Vec<Place> {
    let mut settings = Settings::default();
    settings.set("start", "40,-20").unwrap();
    for (name, value) in sets.concat() {
        settings.set(name, value).unwrap();
    }
    if table {
        settings.pitch = pitch_table::read("table", TABLE).unwrap();
        settings.set("z.pitch_table", "true").unwrap();
    }
    slides::follow(program, &settings).unwrap()
}

/// How far the slides are outside the circle: least and greatest, um.
fn roundness(places: &[Place]) -> (f64, f64) {
    let outside = places.iter().map(|place| (place.slides[0] + 20.0).hypot(place.slides[1] - 30.0) * 1e3 - 10_000.0);
    outside.fold((0.0, 0.0), |(least, most): (f64, f64), value| (least.min(value), most.max(value)))
}

#[test]
fn backlash_and_pitch_error_show_on_a_circle_and_compensation_takes_them_away() {
    // half a diagonal of the lattice of 1.25 by 2.5 um, at worst
    let (least, most) = roundness(&follow(CIRCLE, &[], false));
    assert!(least > -1.4 && most < 1.4, "{least} {most}");
    let (least, most) = roundness(&follow(CIRCLE, &[&PLAY, &SCREW], false));
    assert!(most - least > 25.0, "{least} {most}");
    // the play of a quadrant is taken up over 5 um of travel: while it is, the slide stands for 20 * 5 / 25 um
    let (least, most) = roundness(&follow(CIRCLE, &[&PLAY, &SCREW, &TAKEN], true));
    assert!(least > -7.0 && most < 7.0 && most - least < 9.0, "{least} {most}");
    let quick = [("x.backlash_distance_um", "0"), ("z.backlash_distance_um", "0")];
    let (least, most) = roundness(&follow(CIRCLE, &[&PLAY, &SCREW, &TAKEN, &quick], true));
    // over a pulse, 2.5 um of Z: 2.3 um, and the lattice
    assert!(least > -4.4 && most < 4.4, "{least} {most}");
}

#[test]
fn slides_stand_where_the_program_does_once_it_stands() {
    let off = |places: &[Place]| {
        let last = places.last().unwrap();
        [0, 1].map(|axis: usize| (last.slides[axis] - last.program[axis]) * 1e3)
    };
    for program in ["X35 Z-35\n", "X45 Z-35\n", "X35 Z-35\nX45 Z-20\nX35 Z-5\n", "X45 Z-30\nX44 Z-10\nX44.1 Z-10.1\n"] {
        let program = format!("G21 G90 G94 F1000\nG1 Z-20\n{program}M30\n");
        // half a pulse for what is given, half for what the start was rounded to
        let [z, x] = off(&follow(&program, &[&PLAY, &SCREW, &TAKEN], true));
        assert!(z.abs() < 2.6 && x.abs() < 1.3, "{program}: {z} {x}");
        let [z, x] = off(&follow(&program, &[&PLAY, &SCREW], false));
        assert!(z.abs() > 5.0 || x.abs() > 5.0, "{program}: {z} {x}");
    }
}

#[test]
fn a_warm_screw_is_compensated_from_its_origin_on() {
    // 10 K of 11.5 um a metre: a table of the machine that is just that
    let warm = [("screw.z.error", "-1000:-115;1000:115")];
    let told = [("z.thermal_um_per_m_k", "11.5"), ("temperature_c", "30")];
    let program = "G1 Z-300 F1500\nM30\n";
    let end = |sets: &[&[(&str, &str)]]| {
        let last = *follow(program, sets, false).last().unwrap();
        (last.slides[0] - last.program[0]) * 1e3
    };
    // the start, at Z-20, counts as right: 2.3 um of it stay
    let (without, with) = (end(&[&warm]), end(&[&warm, &told]));
    assert!((without + 34.5).abs() < 0.1 && (with + 2.3).abs() < 1.5, "{without} {with}");
}
