//! Drives other than time on the channel: the spindle with its threads, and the contour wheel.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    clippy::cast_possible_wrap,
    reason = "a test"
)]

mod bench;
mod follower;
mod hold;
mod parts;
mod retrace;
mod spindle;
mod switching;
mod thread;
mod wheel;
