#![no_std]
#![forbid(unsafe_code)]
// an overflow would be a panic in the foreground: sums wrap where a proof says they cannot, else saturate
#![cfg_attr(not(test), deny(clippy::arithmetic_side_effects))]
//! The portable half of the firmware: what the desktop runs, too.
//!
//! [`background`] turns program text into blocks and keeps the parameters; [`foreground`] executes the blocks tick
//! by tick. Between the two stand a queue of blocks and a queue of commands ([`queue`]), nothing else. The other half, `main.rs`
//! and `board/`, exists only on a chip.

pub mod background;
pub mod foreground;
pub mod queue;

// what a board writes into registers, against a model of them
#[cfg(test)]
#[path = "board/quadrature.rs"]
mod quadrature;
