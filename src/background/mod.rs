//! Background: parameters, and the job that compiles program text into blocks.

pub mod compile;
pub mod parameters;
