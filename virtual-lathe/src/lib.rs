#![forbid(unsafe_code)]
//! The lathe on the desk.
//!
//! It runs programs through the firmware's own background and foreground ([`lathe`]), measures the pulse train with
//! an independent checker (the crate `measure`) and draws what the pulses did ([`picture`]). [`turn`] puts that
//! together as the command `turn`. [`serve`] runs the same lathe for a sender at a TCP port.

mod compare_curves;
pub mod compare_laws;
pub mod compare_methods;
pub mod course;
pub mod dimensions;
pub mod examples;
pub mod gallery;
pub mod insets;
pub mod lathe;
pub mod machine_file;
pub mod messages;
pub mod motors;
pub mod operate;
pub mod options;
pub mod output;
pub mod picture;
pub mod pitch_table;
pub mod program;
pub mod report;
pub mod serve;
pub mod settings;
pub mod sheets;
pub mod slides;
pub mod spindle;
pub mod turn;
pub mod watch;
pub mod work;

/// The embedded demo program: a handle, roughed and finished from bar.
pub const DEMO: &[u8] = include_bytes!("demo/handle.nc");
