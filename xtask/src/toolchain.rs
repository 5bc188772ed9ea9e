//! The compiler for the chip, found or set up.
//!
//! 1. rustup's own target, where it is installed: cargo as it is.
//! 2. Debian's `rustc-web`, `cargo-web` and `rust-web-src`: their compiler has no library for the chip, so `core` and
//!    `alloc` are built once into a folder of their own, from the sources that belong to that compiler, and every
//!    build gets `--sysroot`. (Built with each program, as `-Zbuild-std` does, they would be compiled with its
//!    profile and fetch the whole standard library's dependencies.)
//! 3. Neither: as root on Debian the packages are installed, else the two remedies are named.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, bail};

use crate::target;

/// The chip's target.
pub(crate) const TARGET: &str = "thumbv7em-none-eabihf";

const DEBIAN_RUSTC: &str = "/usr/bin/rustc";
const DEBIAN_CARGO: &str = "/usr/bin/cargo";
const DEBIAN_SOURCE: &str = "/usr/lib/rustlib/src/rust/library/core/src/lib.rs";
const DEBIAN_CLIPPY: &str = "/usr/bin/cargo-clippy";
const PACKAGES: [&str; 3] = ["rustc-web", "cargo-web", "rust-web-src"];

/// How to compile for the chip.
pub(crate) enum Toolchain {
    /// rustup has the target.
    Rustup,
    /// Debian's compiler with a library built for it.
    Debian {
        /// Where that library is.
        sysroot: PathBuf,
    },
}

impl Toolchain {
    /// Finds a toolchain, or sets one up.
    pub(crate) fn find() -> Result<Self> {
        if has_target() {
            return Ok(Self::Rustup);
        }
        if !has_debian() {
            install()?;
        }
        let sysroot = target().join("sysroot");
        build_sysroot(&sysroot).context("building `core` for the chip with Debian's compiler")?;
        Ok(Self::Debian { sysroot })
    }

    /// `cargo` for the chip, with a target folder of its own (two compilers evict each other's artefacts).
    pub(crate) fn cargo(&self, arguments: &[&str]) -> Command {
        self.tool(clean("cargo"), arguments)
    }

    /// `cargo clippy` for the chip, of the compiler that builds for it.
    pub(crate) fn clippy(&self, arguments: &[&str]) -> Result<Command> {
        if matches!(self, Self::Rustup) {
            return Ok(self.cargo(arguments));
        }
        if !Path::new(DEBIAN_CLIPPY).exists() {
            apt(&["rust-web-clippy"]).context("no clippy for the chip: apt-get install rust-web-clippy")?;
        }
        let mut clippy = clean(DEBIAN_CLIPPY);
        clippy.env("CARGO", DEBIAN_CARGO);
        Ok(self.tool(clippy, arguments))
    }

    fn tool(&self, mut cargo: Command, arguments: &[&str]) -> Command {
        cargo.current_dir(crate::root());
        if let Self::Debian { sysroot } = self {
            cargo.env("RUSTC", DEBIAN_RUSTC);
            cargo.env("CARGO_TARGET_THUMBV7EM_NONE_EABIHF_RUSTFLAGS", format!("--sysroot={}", sysroot.display()));
        }
        cargo.args(arguments).args(["--target", TARGET, "--target-dir"]).arg(target().join("firmware"));
        cargo
    }
}

/// A command without what cargo set for this program: the toolchain is chosen anew.
fn clean(program: &str) -> Command {
    let mut command = Command::new(program);
    for (name, _) in std::env::vars_os() {
        let text = name.to_string_lossy();
        let ours = text.starts_with("CARGO_PKG_") || text.starts_with("CARGO_MANIFEST_");
        if ours || ["CARGO", "RUSTUP_TOOLCHAIN", "RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS", "RUSTC"].contains(&&*text) {
            command.env_remove(name);
        }
    }
    command
}

fn output(command: &mut Command) -> Option<String> {
    let output = command.output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

/// Whether the compiler that `cargo` uses has a library for the chip.
fn has_target() -> bool {
    output(clean("rustc").args(["--print", "sysroot"])).is_some_and(|sysroot| {
        let lib = Path::new(&sysroot).join("lib/rustlib").join(TARGET).join("lib");
        fs::read_dir(lib).is_ok_and(|mut files| {
            files.any(|file| file.is_ok_and(|file| file.file_name().to_string_lossy().starts_with("libcore-")))
        })
    })
}

fn has_debian() -> bool {
    Path::new(DEBIAN_RUSTC).exists() && Path::new(DEBIAN_CARGO).exists() && Path::new(DEBIAN_SOURCE).exists()
}

/// Installs Debian's packages, where that can be done.
fn install() -> Result<()> {
    let remedies = format!(
        "no compiler for {TARGET}. Install one of:\n  rustup target add {TARGET}\n  apt-get install {}   (Debian 12 with its security updates)",
        PACKAGES.join(" ")
    );
    let root = output(Command::new("id").arg("-u")).is_some_and(|id| id == "0");
    if !root || !Path::new("/usr/bin/apt-get").exists() {
        bail!(remedies);
    }
    apt(&PACKAGES).context(remedies)
}

/// Installs Debian packages as root, saying so.
pub(crate) fn apt(packages: &[&str]) -> Result<()> {
    for arguments in [vec!["update", "-qq"], [&["install", "-y", "-qq", "--no-install-recommends"], packages].concat()]
    {
        eprintln!("apt-get {}", arguments.join(" "));
        let status = Command::new("apt-get")
            .args(&arguments)
            .env("DEBIAN_FRONTEND", "noninteractive")
            .stdout(std::io::stderr())
            .status()?;
        if !status.success() {
            bail!("apt-get {} failed", arguments.join(" "));
        }
    }
    Ok(())
}

/// Builds `core`, `alloc` and `compiler_builtins` for the chip into `sysroot`, unless they are there and belong to
/// the compiler.
fn build_sysroot(sysroot: &Path) -> Result<()> {
    let version = output(Command::new(DEBIAN_RUSTC).arg("-vV")).context("Debian's rustc does not run")?;
    let stamp = sysroot.join("made-for");
    if fs::read_to_string(&stamp).is_ok_and(|made| made == version) {
        return Ok(());
    }
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).context("rustc -vV names no host")?;
    eprintln!("building `core` for {TARGET} with {}", version.lines().next().unwrap_or_default());
    let work = tempfile::tempdir()?;
    fs::create_dir(work.path().join("src"))?;
    fs::write(work.path().join("src/lib.rs"), "#![no_std]\n")?;
    fs::write(
        work.path().join("Cargo.toml"),
        "[package]\nname = \"empty\"\nversion = \"0.0.0\"\nedition = \"2024\"\n[workspace]\n[profile.release]\ncodegen-units = 1\ndebug = false\n",
    )?;
    let built = work.path().join("target");
    let mut cargo = clean(DEBIAN_CARGO);
    cargo
        .args(["build", "--quiet", "--release", "--target", TARGET, "-Zbuild-std=core,alloc", "--manifest-path"])
        .arg(work.path().join("Cargo.toml"))
        .arg("--target-dir")
        .arg(&built)
        .env("RUSTC", DEBIAN_RUSTC)
        .env("RUSTC_BOOTSTRAP", "1")
        // fat LTO needs the bitcode
        .env("CARGO_TARGET_THUMBV7EM_NONE_EABIHF_RUSTFLAGS", "-C embed-bitcode=yes");
    if !cargo.status()?.success() {
        bail!("cargo failed");
    }
    let lib = sysroot.join("lib/rustlib").join(TARGET).join("lib");
    if sysroot.exists() {
        fs::remove_dir_all(sysroot)?;
    }
    fs::create_dir_all(&lib)?;
    for file in fs::read_dir(built.join(TARGET).join("release/deps"))? {
        let file = file?;
        let name = file.file_name().to_string_lossy().into_owned();
        let wanted = ["libcore-", "liballoc-", "libcompiler_builtins-"].iter().any(|lib| name.starts_with(lib));
        if wanted && (name.ends_with(".rlib") || name.ends_with(".rmeta")) {
            fs::copy(file.path(), lib.join(name))?;
        }
    }
    link_linker(sysroot, host)?;
    fs::write(stamp, version)?;
    Ok(())
}

/// Puts a linker where the compiler looks for it: rustup's rust-lld, else Debian's ld.lld.
fn link_linker(sysroot: &Path, host: &str) -> Result<()> {
    let rustup = output(clean("rustc").args(["--print", "sysroot"]))
        .map(|sysroot| Path::new(&sysroot).join("lib/rustlib").join(host).join("bin/rust-lld"));
    let debian = PathBuf::from("/usr/bin/ld.lld");
    let mut found = [rustup, Some(debian.clone())].into_iter().flatten().find(|path| path.exists());
    if found.is_none() {
        apt(&["lld"]).context("no linker for the chip: apt-get install lld")?;
        found = Some(debian);
    }
    let bin = sysroot.join("lib/rustlib").join(host).join("bin");
    fs::create_dir_all(&bin)?;
    if let Some(linker) = found {
        std::os::unix::fs::symlink(fs::canonicalize(linker)?, bin.join("rust-lld"))?;
    }
    Ok(())
}
