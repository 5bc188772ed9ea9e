#![no_std]
#![forbid(unsafe_code)]
// an overflow would be a panic in the foreground: sums wrap where a proof says they cannot, else saturate
#![cfg_attr(not(test), deny(clippy::arithmetic_side_effects))]
#![doc = include_str!("../README.md")]
pub mod blend;
pub mod block;
pub mod channel;
pub mod compensation;
pub mod config;
pub mod curve;
pub mod drive;
pub mod governor;
pub mod group;
pub mod law;
pub mod math;
pub mod ramp;
pub mod ring;
pub mod sampled;
pub mod shaper;
pub mod threading;
pub mod times;
pub mod train;
pub mod units;
