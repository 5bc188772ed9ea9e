//! What only a build for the chip shows: lints of the code that the desktop never compiles, and that a build without a
//! board, or with two, fails.

use std::process::Command;

use anyhow::{Context as _, Result, bail};

use crate::toolchain::Toolchain;

/// `cargo clippy` on the firmware of one board, and the builds that must fail.
pub(crate) fn run() -> Result<()> {
    let toolchain = Toolchain::find()?;
    let firmware = ["--quiet", "--package", "handcnc", "--bin", "firmware"];
    let mut clippy =
        toolchain.clippy(&[&["clippy"], &firmware[..], &["--no-deps", "--features", "board-f411"]].concat())?;
    if !clippy.args(["--", "-D", "warnings"]).status().context("clippy does not run")?.success() {
        bail!("clippy on the firmware");
    }
    for (features, cause) in [
        (&[][..], "name a board:"),
        // the HAL refuses by itself
        (&["--features", "board-f407,board-f411"], "Multiple stm32xx"),
    ] {
        let text = failure(&mut toolchain.cargo(&[&["check"], &firmware[..], features].concat()))?;
        if !text.contains(cause) {
            bail!("a build that must fail with `{cause}` fails with:\n{text}");
        }
    }
    println!("firmware: no lint; without a board, and with two, it does not build");
    Ok(())
}

/// What a command that must fail says.
fn failure(command: &mut Command) -> Result<String> {
    let output = command.output()?;
    if output.status.success() {
        bail!("{command:?} must fail, and does not");
    }
    Ok(String::from_utf8_lossy(&output.stderr).into_owned())
}
