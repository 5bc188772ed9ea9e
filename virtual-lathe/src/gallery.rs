//! The command `examples`: runs the programs that come with the lathe and shows them on one page, with all pictures in
//! it.

use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::examples::{EXAMPLES, Example};
use crate::output::{Pending, Places};
use crate::picture::Form;
use crate::report;
use crate::sheets::Sheets;
use crate::turn::{self, Failure, Finished};

const HEAD: &str = r#"<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>HandCNC: examples</title>
<style>
body { font-family: "DejaVu Sans", Verdana, sans-serif; color: #1a1a1a; max-width: 72rem; margin: 2rem auto; padding: 0 1rem; }
svg, img { width: 100%; height: auto; }
pre { background: #f3f3f3; padding: 0.8rem; overflow-x: auto; font-size: 0.85rem; }
section { margin-bottom: 4rem; }
@media print { section { break-before: page; } img { display: none; } }
</style>
</head>
<body>
<h1>HandCNC: examples</h1>
<p>Programs that come with the virtual lathe, run through the firmware's own code. What is shown is what the pulses cut.</p>
"#;

/// Writes the page; the exit code.
pub fn write(path: &Path) -> u8 {
    match page(path) {
        Ok(()) => turn::DONE,
        Err(failure) => turn::told(failure),
    }
}

fn page(path: &Path) -> Result<(), Failure> {
    let mut places = Places::default();
    places.output(path)?;
    let mut text = HEAD.to_owned();
    for example in &EXAMPLES {
        let finished = turn::run_example(example)?;
        let summary = summary(&finished);
        // told at once, as the next one takes its time
        let _ = io::stdout().lock().write_all(summary.as_bytes());
        section(&mut text, example, &finished, &summary)?;
    }
    text.push_str("</body>\n</html>\n");
    let mut file = Pending::create(path)?;
    file.writer().write_all(text.as_bytes())?;
    let written = file.keep()?;
    let _ = writeln!(io::stdout().lock(), "wrote {}", written.display());
    Ok(())
}

fn summary(finished: &Finished) -> String {
    let Finished { name, watched, run, .. } = finished;
    report::summary(name, &watched.report, &watched.worked, run)
}

fn section(text: &mut String, example: &Example, finished: &Finished, summary: &str) -> Result<(), Failure> {
    let sheets = Sheets::new(finished);
    let film = STANDARD.encode(sheets.animation(Form::Gif, &turn::progress(0))?);
    let program = String::from_utf8_lossy(example.text);
    let set: Vec<String> = example.set.iter().map(|(name, value)| format!("{name}={value}")).collect();
    // writing to a string cannot fail
    let _ = write!(
        text,
        "<section>\n<h2>{}</h2>\n<p>{}</p>\n<p>Run with <code>{}</code>.</p>\n{}<p><img alt=\"the cut of {}\" \
         src=\"data:image/gif;base64,{film}\"></p>\n{}{}<pre>{}</pre>\n<details><summary>The program</summary>\
         <pre>{}</pre></details>\n</section>\n",
        escaped(example.name),
        escaped(example.about),
        escaped(&set.join(" ")),
        sheets.part(),
        escaped(example.name),
        sheets.error(),
        sheets.motion(),
        escaped(summary),
        escaped(&program),
    );
    Ok(())
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
