#![no_std]
#![forbid(unsafe_code)]
//! Interpolation on the pulse lattice.
pub mod block;
pub mod channel;
pub mod config;
pub mod curve;
pub mod governor;
pub mod math;
pub mod shaper;
pub mod train;
pub mod units;
