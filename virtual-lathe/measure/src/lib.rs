#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod accel;
mod added;
mod checker;
mod deviation;
mod fault;
mod feed;
mod follow;
mod geometry;
mod hash;
mod motion;
mod path;
mod pins;
mod report;
mod setup;
mod trace;

pub use added::Added;
pub use checker::Checker;
pub use deviation::Deviation;
pub use fault::{FAULTS_KEPT, Fault, FaultKind, Faults};
pub use feed::FeedError;
pub use motion::MotorWatch;
pub use path::{Motion, Shape};
pub use report::Report;
pub use setup::{
    Axis, CLOCKS_PER_SECOND, CLOCKS_PER_TICK, Limits, PerAxis, PulseEquivalent, Setup, SetupError, clocks_for,
};
pub use trace::{Trace, time_ns};
