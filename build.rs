//! Tells the linker about the chip's memory; does nothing on the desktop.
fn main() {
    println!("cargo:rerun-if-changed=memory.x");
    println!("cargo:rerun-if-changed=build.rs");
    let on_chip = std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "none");
    if on_chip && let Ok(root) = std::env::var("CARGO_MANIFEST_DIR") {
        println!("cargo:rustc-link-search={root}");
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
        println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    }
}
