//! The tests of the crate from without, in one program: what they make of generic code is compiled once. Curves in parts exist with the feature `methods` only.

mod again;
mod arcs;
mod beside;
mod blend;
mod classic;
mod compensation;
mod compensation_amounts;
#[cfg(feature = "methods")]
mod conic_back;
mod crowds;
mod ends_of_range;
mod event_min;
mod fence;
mod follower;
mod from_the_end;
mod group;
mod laws;
#[cfg(feature = "methods")]
mod parts;
mod pieces;
mod rows;
mod short_blocks;
mod shoulder;
mod wide_arcs;
