//! The link check: a small image of the portable code links only if no panic can be reached from it.
//!
//! The image calls the foreground, the compile job and the link with values that the compiler cannot know. Its panic
//! handler calls a function that does not exist: if the linker asks for it, some overflow check, index or `unwrap` can
//! fail. `cargo xtask no-panic` then shows the way in the call graph.

use anyhow::{Context as _, Result, bail};

use crate::toolchain::{TARGET, Toolchain};

/// `cargo xtask no-panic`, first half.
pub(crate) fn run() -> Result<()> {
    link(&[]).context("the portable code")?;
    println!("portable code: links without a panic");
    // a check that cannot fail proves nothing
    if link(&["--features", "planted"]).is_ok() {
        bail!("the link check did not find a planted panic");
    }
    println!("a planted panic: found");
    Ok(())
}

fn link(more: &[&str]) -> Result<()> {
    let toolchain = Toolchain::find()?;
    let mut arguments = vec!["build", "--quiet", "--package", "no-panic", "--profile", "firmware"];
    arguments.extend_from_slice(more);
    let output = toolchain.cargo(&arguments).output()?;
    if output.status.success() {
        return Ok(());
    }
    let text = String::from_utf8_lossy(&output.stderr);
    if text.contains("a_panic_can_be_reached") {
        bail!("a panic can be reached");
    }
    bail!("{TARGET}: {text}")
}
