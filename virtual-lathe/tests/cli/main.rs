//! The command line as scripts and newcomers use it: exit codes, messages, files; the built program, in a folder of
//! its own.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    missing_docs,
    reason = "tests, and helpers of tests, which may panic"
)]

mod bad_input;
mod bench;
mod motions;
mod outputs;
mod parameters;
