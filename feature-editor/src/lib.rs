#![no_std]
#![forbid(unsafe_code)]
// tests run with overflow checks, and an oracle should read like its formula
#![cfg_attr(not(test), deny(clippy::arithmetic_side_effects))]
//! What the machinist writes.
//!
//! [`codes`] reads program text, line by line, into motions. The crate runs on the desktop and on the
//! microcontroller alike: it allocates nothing, knows no floating point and cannot panic.
pub mod codes;
