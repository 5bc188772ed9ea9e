//! Background: parameters, the job that compiles program text into blocks, and the link that the text comes over.

pub mod compile;
pub mod link;
pub mod parameters;
