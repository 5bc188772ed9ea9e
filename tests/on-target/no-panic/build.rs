//! Tells the linker to keep nothing but what the entry reaches.
fn main() {
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "none") {
        for argument in ["-eentry", "--gc-sections", "--error-limit=5"] {
            println!("cargo:rustc-link-arg-bins={argument}");
        }
    }
}
