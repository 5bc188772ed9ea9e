//! Checks the book: every chapter is listed, every link between pages leads to a file.

use std::fs;
use std::path::Path;

/// Checks the README and the book.
pub(crate) fn check() -> Result<(), String> {
    eprintln!("\n== links of the book");
    let book = Path::new("docs/src");
    let mut broken = Vec::new();
    page(Path::new("README.md"), &mut broken);
    let summary =
        fs::read_to_string(book.join("SUMMARY.md")).map_err(|error| format!("docs/src/SUMMARY.md: {error}"))?;
    let entries = fs::read_dir(book).map_err(|error| format!("docs/src: {error}"))?;
    for entry in entries.flatten() {
        let path = entry.path();
        let name = entry.file_name().to_string_lossy().into_owned();
        if !name.ends_with(".md") {
            continue;
        }
        page(&path, &mut broken);
        if name != "SUMMARY.md" && !summary.contains(&format!("({name})")) {
            broken.push(format!("{name} is not listed in SUMMARY.md"));
        }
    }
    if broken.is_empty() { Ok(()) } else { Err(format!("the book:\n  {}", broken.join("\n  "))) }
}

/// Checks the links of one page.
fn page(path: &Path, broken: &mut Vec<String>) {
    let Ok(text) = fs::read_to_string(path) else {
        broken.push(format!("{} can't be read", path.display()));
        return;
    };
    let folder = path.parent().unwrap_or(Path::new("."));
    for part in text.split("](").skip(1) {
        let target = part.split([')', ' ']).next().unwrap_or_default();
        let file = target.split('#').next().unwrap_or_default();
        if !file.is_empty() && !file.contains("://") && !file.starts_with("mailto:") && !folder.join(file).exists() {
            broken.push(format!("{}: {target} leads nowhere", path.display()));
        }
    }
}
