//! The figures of the machine: one table, every default that of a real part.
//!
//! Sources are told in the book's page about the machine model.

use figures::Definition;

/// The figures of one axis. The arguments are its letter and the defaults in which the axes differ.
macro_rules! axis {
    ($axis:literal, screw: $screw:literal, mass: $mass:literal, friction: $friction:literal, force: $force:literal,
     drag: $drag:literal) => {
        [
            Definition::number(
                concat!("motor.", $axis, ".holding_nm"),
                "Nm",
                0.01,
                50.0,
                "1.9",
                "holding torque with rated current in both windings",
            ),
            Definition::number(
                concat!("motor.", $axis, ".rated_a"),
                "A",
                0.05,
                20.0,
                "2.8",
                "rated current of a winding",
            ),
            Definition::number(
                concat!("motor.", $axis, ".resistance_ohm"),
                "ohm",
                0.01,
                200.0,
                "1.13",
                "resistance of a winding",
            ),
            Definition::number(
                concat!("motor.", $axis, ".inductance_mh"),
                "mH",
                0.01,
                500.0,
                "5.4",
                "inductance of a winding",
            ),
            Definition::number(
                concat!("motor.", $axis, ".inertia_gcm2"),
                "g cm2",
                1.0,
                20_000.0,
                "440",
                "inertia of the rotor",
            ),
            Definition::number(
                concat!("motor.", $axis, ".detent_nm"),
                "Nm",
                0.0,
                5.0,
                "0.068",
                "detent torque, taken off the pull-out torque at every speed",
            ),
            Definition::whole(
                concat!("motor.", $axis, ".steps"),
                "",
                24,
                1000,
                "200",
                "full steps a turn, a multiple of 4",
            ),
            Definition::pairs(
                concat!("motor.", $axis, ".pull_out"),
                "rpm:Nm",
                (0.0, 20_000.0),
                (0.0, 50.0),
                "measured pull-out curve; none: from the windings",
            ),
            Definition::number(
                concat!("driver.", $axis, ".current_a"),
                "A",
                0.05,
                30.0,
                "3.76",
                "peak current of a winding",
            ),
            Definition::number(concat!("driver.", $axis, ".supply_v"), "V", 5.0, 400.0, "36", "supply voltage"),
            Definition::number(
                concat!("driver.", $axis, ".microsteps"),
                "",
                0.0,
                1024.0,
                "0",
                "pulses a full step; 0: as the pulse size wants it",
            ),
            Definition::number(
                concat!("driver.", $axis, ".pulse_width_ns"),
                "ns",
                0.0,
                200_000.0,
                "2500",
                "a pulse that is shorter is not seen",
            ),
            Definition::number(
                concat!("driver.", $axis, ".min_space_ns"),
                "ns",
                0.0,
                200_000.0,
                "2500",
                "a pulse after a shorter space is not seen",
            ),
            Definition::number(
                concat!("driver.", $axis, ".dir_setup_ns"),
                "ns",
                0.0,
                200_000.0,
                "5000",
                "a pulse sooner after a change of direction goes the old way",
            ),
            Definition::number(
                concat!("driver.", $axis, ".dir_hold_ns"),
                "ns",
                0.0,
                200_000.0,
                "5000",
                "a change of direction sooner after a pulse turns that pulse round",
            ),
            Definition::number(
                concat!("screw.", $axis, ".lead_mm"),
                "mm",
                0.2,
                100.0,
                "5",
                "travel a turn of the motor",
            ),
            Definition::number(
                concat!("screw.", $axis, ".diameter_mm"),
                "mm",
                2.0,
                100.0,
                "16",
                "diameter of the screw, for its inertia",
            ),
            Definition::number(
                concat!("screw.", $axis, ".length_mm"),
                "mm",
                10.0,
                10_000.0,
                $screw,
                "length of the screw, for its inertia",
            ),
            Definition::number(concat!("screw.", $axis, ".efficiency"), "", 0.05, 1.0, "0.9", "of screw and nut"),
            Definition::number(
                concat!("screw.", $axis, ".drag_nm"),
                "Nm",
                0.0,
                20.0,
                $drag,
                "torque of preload and bearings",
            ),
            Definition::number(
                concat!("screw.", $axis, ".periodic_um"),
                "um",
                0.0,
                100.0,
                "0",
                "amplitude of the pitch error that repeats each turn",
            ),
            Definition::pairs(
                concat!("screw.", $axis, ".error"),
                "mm:um",
                (-2100.0, 2100.0),
                (-1000.0, 1000.0),
                "pitch error over the position",
            ),
            Definition::number(
                concat!("slide.", $axis, ".mass_kg"),
                "kg",
                0.0,
                10_000.0,
                $mass,
                "mass that moves along",
            ),
            Definition::number(
                concat!("slide.", $axis, ".friction_n"),
                "N",
                0.0,
                100_000.0,
                $friction,
                "friction of the ways",
            ),
            Definition::number(
                concat!("slide.", $axis, ".force_n"),
                "N",
                0.0,
                100_000.0,
                $force,
                "cutting force, against every motion",
            ),
            Definition::number(
                concat!("slide.", $axis, ".backlash_um"),
                "um",
                0.0,
                5000.0,
                "0",
                "play of screw and nut",
            ),
            Definition::switch(concat!("scale.", $axis, ".fitted"), "false", "a glass scale reads the slide"),
            Definition::number(
                concat!("scale.", $axis, ".resolution_nm"),
                "nm",
                1.0,
                1e6,
                "1000",
                "smallest difference it shows",
            ),
            Definition::number(
                concat!("scale.", $axis, ".period_um"),
                "um",
                0.1,
                10_000.0,
                "20",
                "period of its grating",
            ),
            Definition::number(
                concat!("scale.", $axis, ".error_nm"),
                "nm",
                0.0,
                1e6,
                "200",
                "amplitude of the error that repeats each period",
            ),
        ]
    };
}

/// Figures of one axis.
const PER_AXIS: usize = 30;

/// Figures of the cross slide.
pub static CROSS_SLIDE: [Definition; PER_AXIS] =
    axis!("x", screw: "300", mass: "8", friction: "30", force: "100", drag: "0.05");

/// Figures of the carriage.
pub static CARRIAGE: [Definition; PER_AXIS] =
    axis!("z", screw: "600", mass: "25", friction: "60", force: "150", drag: "0.08");

/// Figures of spindle, encoder, handwheels and switches.
pub static OTHERS: [Definition; 15] = [
    Definition::number("spindle.inertia_kgm2", "kg m2", 1e-5, 100.0, "0.015", "inertia of spindle, chuck and work"),
    Definition::number("spindle.torque_nm", "Nm", 0.01, 10_000.0, "7", "torque of the motor up to its base speed"),
    Definition::number("spindle.base_rpm", "1/min", 1.0, 100_000.0, "1500", "above it the motor has constant power"),
    Definition::number(
        "spindle.max_rpm",
        "1/min",
        1.0,
        100_000.0,
        "3000",
        "greatest speed; a faster command gets this",
    ),
    Definition::number("spindle.ramp_rpm_s", "1/min/s", 1.0, 1e6, "1000", "ramp of the drive's speed command"),
    Definition::number("spindle.drag_nm", "Nm", 0.0, 1000.0, "0.3", "friction of bearings and belt"),
    Definition::number("spindle.load_nm", "Nm", 0.0, 10_000.0, "0", "torque of the cut, against every turn"),
    Definition::whole("encoder.lines", "", 1, 100_000, "1024", "lines of the spindle encoder; 4 counts each"),
    Definition::number("encoder.index_deg", "deg", 0.0, 359.999, "0", "spindle angle of the index pulse"),
    Definition::whole("handwheel.detents", "", 1, 1000, "100", "detents a turn"),
    Definition::whole("handwheel.counts", "", 1, 16, "4", "counts a detent"),
    Definition::number("handwheel.bounce_us", "us", 0.0, 100_000.0, "0", "longest bounce of its contacts; optical: 0"),
    Definition::number("switch.bounce_us", "us", 0.0, 200_000.0, "1500", "longest bounce of a switch"),
    Definition::whole("switch.bounces", "", 0, 100, "6", "most times that a contact opens again"),
    Definition::whole("bounce.seed", "", 0, u32::MAX, "1", "another one, other bounces"),
];
