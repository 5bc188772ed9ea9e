//! Background: parameters, the job that compiles program text into blocks, and the link with its inbox and status.

mod blend;
pub mod compile;
pub mod inbox;
pub mod keeper;
pub mod keys;
pub mod link;
pub mod parameters;
pub mod status;
pub mod threads;
