//! Firmware images of the boards.

use std::fs;
use std::path::PathBuf;

use anyhow::{Context as _, Result, bail};
use clap::ValueEnum;

use crate::image::Image;
use crate::target;
use crate::toolchain::{TARGET, Toolchain};

/// A board.
#[derive(Copy, Clone, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Board {
    /// STM32F407 boards.
    F407,
    /// BlackPill.
    F411,
    /// Nucleo-F446RE.
    F446,
    /// The emulator's.
    Qemu,
}

/// One board or all.
#[derive(Copy, Clone, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Choice {
    /// STM32F407 boards.
    F407,
    /// BlackPill.
    F411,
    /// Nucleo-F446RE.
    F446,
    /// The emulator's.
    Qemu,
    /// All.
    All,
}

impl Choice {
    /// The boards chosen.
    pub(crate) fn boards(self) -> Vec<Board> {
        match self {
            Self::F407 => vec![Board::F407],
            Self::F411 => vec![Board::F411],
            Self::F446 => vec![Board::F446],
            Self::Qemu => vec![Board::Qemu],
            Self::All => Board::ALL.to_vec(),
        }
    }
}

impl Board {
    /// All boards.
    pub(crate) const ALL: [Self; 4] = [Self::F407, Self::F411, Self::F446, Self::Qemu];

    /// Its name.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::F407 => "f407",
            Self::F411 => "f411",
            Self::F446 => "f446",
            Self::Qemu => "qemu",
        }
    }

    /// Most bytes of flash and RAM that its image may take. The smallest board sets what is asked of the firmware;
    /// the others have more.
    const fn limits(self) -> Option<(u64, u64)> {
        match self {
            Self::F411 => Some((256 * 1024, 96 * 1024)),
            Self::F407 | Self::F446 | Self::Qemu => None,
        }
    }
}

/// Builds a board's image: the path of its ELF file.
pub(crate) fn build(toolchain: &Toolchain, board: Board) -> Result<PathBuf> {
    build_with(toolchain, board, None)
}

/// Builds a board's image, with one more feature: the path of its ELF file.
pub(crate) fn build_with(toolchain: &Toolchain, board: Board, more: Option<&str>) -> Result<PathBuf> {
    let mut feature = format!("board-{}", board.name());
    let mut name = format!("handcnc-{}", board.name());
    if let Some(more) = more {
        feature = format!("{feature},{more}");
        name = format!("{name}-{more}");
    }
    let arguments = [
        "build",
        "--quiet",
        "--package",
        "handcnc",
        "--bin",
        "firmware",
        "--profile",
        "firmware",
        "--features",
        &feature,
    ];
    if !toolchain.cargo(&arguments).status().context("cargo does not run")?.success() {
        bail!("the firmware of {} does not build", board.name());
    }
    let built = target().join("firmware").join(TARGET).join("firmware/firmware");
    let kept = target().join("firmware").join(format!("{name}.elf"));
    fs::copy(&built, &kept).with_context(|| format!("copying {}", built.display()))?;
    Ok(kept)
}

/// `cargo xtask firmware`.
pub(crate) fn run(boards: &[Board]) -> Result<()> {
    let toolchain = Toolchain::find()?;
    let mut rows = Vec::new();
    let mut excess = Vec::new();
    for board in boards {
        let elf = build(&toolchain, *board)?;
        let image = Image::read(&elf)?;
        fs::write(elf.with_extension("bin"), image.binary()?)?;
        fs::write(elf.with_extension("hex"), image.hex()?)?;
        let (flash, ram) = image.sizes();
        if let Some((flash_limit, ram_limit)) = board.limits() {
            for (what, bytes, limit) in [("flash", flash, flash_limit), ("RAM", ram, ram_limit)] {
                if bytes > limit {
                    excess.push(format!("{} takes {bytes} bytes of {what}, more than its {limit}", board.name()));
                }
            }
        }
        rows.push((board, flash, ram, elf));
    }
    println!("board   flash bytes   RAM bytes   image (.elf .hex .bin)");
    for (board, flash, ram, elf) in rows {
        println!("{:<5} {flash:>13} {ram:>11}   {}", board.name(), elf.with_extension("").display());
    }
    println!("RAM without stacks, which take what is left.");
    if !excess.is_empty() {
        bail!(excess.join("; "));
    }
    Ok(())
}
