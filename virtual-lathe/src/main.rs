//! virtual-lathe
fn main() {}
