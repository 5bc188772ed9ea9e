//! Definitions of the parameters: names, units, ranges, defaults.

use interp_core::compensation;
use interp_core::config::AxisConfig;
use interp_core::drive::spindle::Spindle;
use interp_core::law::{Smoothing, SpeedLaw};
use interp_core::units::Length;

/// How a parameter is written and held.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A ratio, decimal or whole number of nanometres a pulse.
    Pulse,
    /// A number, held times `scale`, from `least` to `most` (so held).
    Number {
        /// What one unit is held as.
        scale: u32,
        /// Smallest value.
        least: i64,
        /// Largest value.
        most: i64,
    },
    /// `true` or `false`.
    Switch,
    /// One word of a list.
    Choice(&'static [&'static str]),
    /// Two lengths in mm: X (radius) and Z, with a comma between.
    Place,
}

/// One parameter.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Definition {
    /// Name, with the axis's letter in front.
    pub name: &'static str,
    /// Unit, as shown.
    pub unit: &'static str,
    /// How it is written.
    pub kind: Kind,
    /// Default, as an operator would type it.
    pub default: &'static str,
    /// What it is.
    pub help: &'static str,
}

const fn number(scale: u32, least: i64, most: i64) -> Kind {
    Kind::Number { scale, least, most }
}

const FEED: Kind = number(1_000_000, 10_000, 30_000_000_000);
const ACCEL: Kind = number(1_000, AxisConfig::ACCEL_RANGE.0 as i64, AxisConfig::ACCEL_RANGE.1 as i64);
const JUMP: Kind = number(1_000, AxisConfig::JUMP_RANGE.0 as i64, AxisConfig::JUMP_RANGE.1 as i64);
const BACKLASH: Kind = number(1_000, 0, compensation::Config::MAX_BACKLASH_NM as i64);
const EXPANSION: Kind = number(1_000, 0, compensation::Config::MAX_THERMAL as i64);
const POSITION: Kind = number(1_000_000, -(Length::LIMIT_NM as i64), Length::LIMIT_NM as i64);
const BOUND: Kind = number(1_000_000, 0, Length::LIMIT_NM as i64);
const FOLLOWING: Kind = number(1_000, 0, 10_000_000);
const TEMPERATURE: Kind = number(1_000, -50_000, 150_000);
const JERK: Kind = number(1, Smoothing::JERK_RANGE.0 as i64, Smoothing::JERK_RANGE.1 as i64);
const COUNTS: Kind = number(1, 0, Spindle::COUNTS.1 as i64);
const RETRACT: Kind = number(1_000_000, -100_000_000, 100_000_000);
const NANOSECONDS: Kind = number(1, 100, 200_000);

const fn definition(
    name: &'static str,
    unit: &'static str,
    kind: Kind,
    default: &'static str,
    help: &'static str,
) -> Definition {
    Definition { name, unit, kind, default, help }
}

/// Index of a parameter in [`DEFINITIONS`].
pub(super) mod index {
    pub(in super::super) const PULSE: [usize; 2] = [0, 8];
    pub(in super::super) const MAX_FEED: usize = 1;
    pub(in super::super) const MAX_ACCEL: usize = 2;
    pub(in super::super) const MAX_JUMP: usize = 3;
    pub(in super::super) const PULSE_WIDTH: usize = 4;
    pub(in super::super) const DIR_SETUP: usize = 5;
    pub(in super::super) const DIR_HOLD: usize = 6;
    pub(in super::super) const MIN_SPACE: usize = 7;
    pub(in super::super) const AXIS: usize = 8;
    pub(in super::super) const EVENT_MIN: usize = 16;
    pub(in super::super) const FEED_OVERRIDE: usize = 17;
    pub(in super::super) const ARC_TOLERANCE: usize = 18;
    pub(in super::super) const CORNER: usize = 19;
    pub(in super::super) const METHOD: usize = 20;
    pub(in super::super) const TAPE_FEEDS: usize = 21;
    pub(in super::super) const FRONT_POST: usize = 30;
    pub(in super::super) const BLOCK_DELETE: usize = 31;
    pub(in super::super) const START: usize = 32;
    pub(in super::super) const OPTIONAL_STOP: usize = 33;
    /// Of X; those of Z follow.
    pub(in super::super) const COMPENSATION: usize = 34;
    pub(in super::super) const BACKLASH: usize = 0;
    pub(in super::super) const BACKLASH_DISTANCE: usize = 1;
    pub(in super::super) const PITCH_TABLE: usize = 2;
    pub(in super::super) const THERMAL: usize = 3;
    pub(in super::super) const THERMAL_ORIGIN: usize = 4;
    pub(in super::super) const AXIS_COMPENSATION: usize = 5;
    pub(in super::super) const THERMAL_REFERENCE: usize = 44;
    pub(in super::super) const TEMPERATURE: usize = 45;
    pub(in super::super) const LAW: usize = 46;
    pub(in super::super) const MAX_JERK: usize = 47;
    pub(in super::super) const HANDWHEELS: usize = 48;
    pub(in super::super) const SAFE_FEED: usize = 49;
    pub(in super::super) const DRY_FEED: usize = 50;
    /// Of X; those of Z follow.
    pub(in super::super) const OPERATION: usize = 51;
    pub(in super::super) const LIMIT_MINUS: usize = 0;
    pub(in super::super) const LIMIT_PLUS: usize = 1;
    pub(in super::super) const HAND_MINUS: usize = 2;
    pub(in super::super) const HAND_PLUS: usize = 3;
    pub(in super::super) const HOME_TOWARD: usize = 4;
    pub(in super::super) const HOME_FEED: usize = 5;
    pub(in super::super) const HOME: usize = 6;
    pub(in super::super) const FOLLOWING: usize = 7;
    pub(in super::super) const AXIS_OPERATION: usize = 8;
    pub(in super::super) const ENCODER_COUNTS: usize = 67;
    pub(in super::super) const THREAD_RETRACT: usize = 68;
    pub(in super::super) const GUARD_SWITCH: usize = 69;
    pub(in super::super) const LIMIT_SWITCHES: usize = 70;
    pub(in super::super) const POWER_FEED: usize = 71;
    pub(in super::super) const COUNT: usize = 72;
}

/// Methods that this build has, in the order of [`Method::ALL`].
pub(super) const METHODS: &[&str] = if cfg!(feature = "methods") {
    &["minimum-deviation", "point-comparison", "dda", "rate-multiplier", "fraction", "time-division"]
} else {
    &["minimum-deviation"]
};

/// Speed laws in the order of [`SpeedLaw::ALL`].
const LAWS: &[&str] = &[SpeedLaw::ALL[0].name(), SpeedLaw::ALL[1].name(), SpeedLaw::ALL[2].name()];

/// The ends of an axis.
const SIDES: &[&str] = &["plus", "minus"];

/// All parameters.
pub static DEFINITIONS: [Definition; index::COUNT] = [
    definition("x.pulse_nm", "nm", Kind::Pulse, "1250", "how far one pulse moves the cross slide (radius)"),
    definition("x.max_feed", "mm/min", FEED, "5000", "largest speed of the cross slide"),
    definition("x.max_accel", "mm/s2", ACCEL, "500", "largest acceleration of the cross slide"),
    definition("x.max_jump", "mm/s", JUMP, "2", "largest sudden change of speed (start-stop speed)"),
    definition("x.pulse_width_ns", "ns", NANOSECONDS, "5000", "time that the step pin stays high"),
    definition("x.dir_setup_ns", "ns", NANOSECONDS, "5000", "time from a change of direction to the next pulse"),
    definition("x.dir_hold_ns", "ns", NANOSECONDS, "10000", "time from a pulse to a change of direction"),
    definition("x.min_space_ns", "ns", NANOSECONDS, "5000", "time that the step pin stays low"),
    definition("z.pulse_nm", "nm", Kind::Pulse, "2500", "how far one pulse moves the carriage"),
    definition("z.max_feed", "mm/min", FEED, "5000", "largest speed of the carriage"),
    definition("z.max_accel", "mm/s2", ACCEL, "500", "largest acceleration of the carriage"),
    definition("z.max_jump", "mm/s", JUMP, "2", "largest sudden change of speed (start-stop speed)"),
    definition("z.pulse_width_ns", "ns", NANOSECONDS, "5000", "time that the step pin stays high"),
    definition("z.dir_setup_ns", "ns", NANOSECONDS, "5000", "time from a change of direction to the next pulse"),
    definition("z.dir_hold_ns", "ns", NANOSECONDS, "10000", "time from a pulse to a change of direction"),
    definition("z.min_space_ns", "ns", NANOSECONDS, "5000", "time that the step pin stays low"),
    definition("event_min_ns", "ns", number(1, 100, 50_000), "2000", "shortest time between two events of the train"),
    definition("feed_override", "%", number(1, 0, 200), "100", "part of the programmed feed"),
    definition("arc_tolerance_um", "um", number(1_000, 0, 100_000), "10", "how far the two radii of an arc may differ"),
    definition("corner_um", "um", number(1_000, 0, 1_000_000), "0", "how far a blend may leave a corner; 0 for none"),
    definition("method", "", Kind::Choice(METHODS), "minimum-deviation", "how steps follow a curve"),
    definition("f1", "mm/min", FEED, "25", "feed of the tape code F1"),
    definition("f2", "mm/min", FEED, "50", "feed of the tape code F2"),
    definition("f3", "mm/min", FEED, "75", "feed of the tape code F3"),
    definition("f4", "mm/min", FEED, "100", "feed of the tape code F4"),
    definition("f5", "mm/min", FEED, "150", "feed of the tape code F5"),
    definition("f6", "mm/min", FEED, "200", "feed of the tape code F6"),
    definition("f7", "mm/min", FEED, "300", "feed of the tape code F7"),
    definition("f8", "mm/min", FEED, "400", "feed of the tape code F8"),
    definition("f9", "mm/min", FEED, "600", "feed of the tape code F9"),
    definition("front_post", "", Kind::Switch, "false", "the tool post is on the operator's side: G2 and G3 change"),
    definition("block_delete", "", Kind::Switch, "true", "lines that begin with / are skipped"),
    definition("start", "mm", Kind::Place, "0,0", "where the tool is when the program starts: X (radius), Z"),
    definition("optional_stop", "", Kind::Switch, "false", "M1 stops as M0 does"),
    definition("x.backlash_um", "um", BACKLASH, "0", "play of screw and nut that the control takes up (radius)"),
    definition("x.backlash_distance_um", "um", BACKLASH, "5", "travel after a reversal over which it is taken up"),
    definition("x.pitch_table", "", Kind::Switch, "false", "the table of pitch errors is in force"),
    definition("x.thermal_um_per_m_k", "um/m/K", EXPANSION, "0", "how much longer the warm screw gets"),
    definition("x.thermal_origin_mm", "mm", POSITION, "0", "place that stays where it is when the screw gets longer"),
    definition("z.backlash_um", "um", BACKLASH, "0", "play of screw and nut that the control takes up"),
    definition("z.backlash_distance_um", "um", BACKLASH, "5", "travel after a reversal over which it is taken up"),
    definition("z.pitch_table", "", Kind::Switch, "false", "the table of pitch errors is in force"),
    definition("z.thermal_um_per_m_k", "um/m/K", EXPANSION, "0", "how much longer the warm screw gets"),
    definition("z.thermal_origin_mm", "mm", POSITION, "0", "place that stays where it is when the screw gets longer"),
    definition("thermal_reference_c", "C", TEMPERATURE, "20", "temperature at which the screws are right"),
    definition("temperature_c", "C", TEMPERATURE, "20", "temperature of the screws, as measured"),
    definition(
        "accel",
        "",
        Kind::Choice(LAWS),
        "linear",
        "how the speed changes: at once, or S-shaped with limited jerk",
    ),
    definition("max_jerk", "mm/s3", JERK, "50000", "largest jerk along the path under accel=sine and parabolic"),
    definition("handwheels", "", Kind::Switch, "false", "handwheels may be turned while a program moves"),
    definition("safe_feed", "mm/min", FEED, "300", "speed at which offsets are nulled and programs gone back into"),
    definition("dry_feed", "mm/min", FEED, "1000", "feed of a dry run"),
    definition(
        "x.limit_minus_mm",
        "mm",
        POSITION,
        "-2100",
        "soft limit of the cross slide to minus, machine coordinates",
    ),
    definition("x.limit_plus_mm", "mm", POSITION, "2100", "soft limit of the cross slide to plus"),
    definition("x.hand_minus_mm", "mm", BOUND, "10", "how far the handwheel leads off a program to minus"),
    definition("x.hand_plus_mm", "mm", BOUND, "10", "how far the handwheel leads off a program to plus"),
    definition("x.home_toward", "", Kind::Choice(SIDES), "plus", "where the home switch of the cross slide is"),
    definition("x.home_feed", "mm/min", FEED, "600", "speed at which the home switch is looked for"),
    definition("x.home_mm", "mm", POSITION, "0", "machine coordinate where the home switch opens"),
    definition("x.following_um", "um", FOLLOWING, "0", "following error that is an alarm, with a scale; 0 for none"),
    definition("z.limit_minus_mm", "mm", POSITION, "-2100", "soft limit of the carriage to minus, machine coordinates"),
    definition("z.limit_plus_mm", "mm", POSITION, "2100", "soft limit of the carriage to plus"),
    definition("z.hand_minus_mm", "mm", BOUND, "10", "how far the handwheel leads off a program to minus"),
    definition("z.hand_plus_mm", "mm", BOUND, "10", "how far the handwheel leads off a program to plus"),
    definition("z.home_toward", "", Kind::Choice(SIDES), "plus", "where the home switch of the carriage is"),
    definition("z.home_feed", "mm/min", FEED, "600", "speed at which the home switch is looked for"),
    definition("z.home_mm", "mm", POSITION, "0", "machine coordinate where the home switch opens"),
    definition("z.following_um", "um", FOLLOWING, "0", "following error that is an alarm, with a scale; 0 for none"),
    definition(
        "spindle.encoder_counts",
        "",
        COUNTS,
        "4096",
        "counts a turn of the spindle's encoder, 4 a line; 0: none",
    ),
    definition(
        "thread.retract_mm",
        "mm",
        RETRACT,
        "2",
        "how far a hold pulls X out of a thread; below 0 inward; 0: it waits",
    ),
    definition("guard_switch", "", Kind::Switch, "true", "boards: a closed contact tells that the guard is closed"),
    definition("limit_switches", "", Kind::Switch, "false", "boards: limit switches, closed until they are met"),
    definition("power_feed", "mm/min", FEED, "60", "feed of power feed until feed-rate sets another"),
];
