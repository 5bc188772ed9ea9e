//! The programs that come with the lathe, each with its bar and its tool.

use crate::program::Program;

/// A program with what it is run with.
#[derive(Copy, Clone, Debug)]
pub struct Example {
    /// Name of the program.
    pub name: &'static str,
    /// One line about it.
    pub about: &'static str,
    /// Its text.
    pub text: &'static [u8],
    /// Parameters that it needs, by name.
    pub set: &'static [(&'static str, &'static str)],
}

impl Example {
    /// The program.
    #[must_use]
    pub fn program(&self) -> Program {
        Program::Text { name: self.name.into(), text: self.text.to_vec() }
    }
}

/// All of them; the first is the demo.
pub static EXAMPLES: [Example; 4] = [
    Example {
        name: "handle.nc",
        about: "A handle from a bar of 32 mm: ball, neck, taper, groove and collar.",
        text: crate::DEMO,
        set: &[("stock.diameter_mm", "32"), ("stock.length_mm", "131"), ("stock.face_mm", "1"), ("chuck.z_mm", "-105")],
    },
    Example {
        name: "shaft.nc",
        about: "A stepped shaft from a bar of 30 mm: three seats with chamfers and an undercut for a thread.",
        text: include_bytes!("demo/shaft.nc"),
        set: &[("stock.diameter_mm", "30"), ("stock.length_mm", "110"), ("stock.face_mm", "1"), ("chuck.z_mm", "-82")],
    },
    Example {
        name: "ball.nc",
        about: "A ball of 25 mm on a stem, from a bar of 28 mm.",
        text: include_bytes!("demo/ball.nc"),
        set: &[("stock.diameter_mm", "28"), ("stock.length_mm", "80"), ("stock.face_mm", "1"), ("chuck.z_mm", "-50")],
    },
    Example {
        name: "taper.nc",
        about: "A taper plug, Morse taper 2 by its small end and cone, from a bar of 22 mm.",
        text: include_bytes!("demo/taper.nc"),
        set: &[("stock.diameter_mm", "22"), ("stock.length_mm", "110"), ("stock.face_mm", "1"), ("chuck.z_mm", "-80")],
    },
];
