//! The cost tables of the book, between two marks of `docs/src/firmware.md`.

use std::fmt::Write as _;
use std::fs;

use anyhow::{Context as _, Result};
use serde_json::Value;

const PAGE: &str = "docs/src/firmware.md";
const BEGIN: &str = "<!-- written by `cargo xtask measure --book` -->\n";
const END: &str = "<!-- end -->\n";

/// A case of another controller, with its instructions and interrupts for each step event.
struct Peer(&'static str, f64, f64);

/// Counted in the same way on the same emulated core: grblHAL f80fc34 with its driver b7bcf17 for STM32F4xx at -O2, and
/// Klipper 84104bb.
const PEERS: [Peer; 5] = [
    Peer("grblHAL, line 4:3, X at 80 kHz", 156.6, 2.0),
    Peer("grblHAL, arcs R 10 mm, 25 kHz (and 1340 a chord in the foreground)", 152.6, 2.0),
    Peer("grblHAL, line 1:1, 71 kHz", 159.5, 2.0),
    Peer("Klipper, two axes, ordinary pulses, for each axis's step (planned on a PC)", 121.3, 2.0),
    Peer("Klipper, drivers that step on both edges, for each axis's step", 57.4, 1.0),
];

/// Step events a second if the chip did nothing else, in thousands, at 1 and at 1.35 clocks an instruction.
fn rates(instructions: f64, interrupts: f64) -> [f64; 2] {
    [1.0, 1.35].map(|clocks| 168e3 / (instructions * clocks + interrupts * 24.0))
}

fn tables(report: &Value) -> Result<String> {
    let number = |value: &Value, path: &str| {
        let found = value.pointer(path).and_then(Value::as_f64);
        found.with_context(|| format!("the report has no {path}"))
    };
    let mut text = String::from(
        "| | pulse | interpolate | all | worst | interrupts | k events/s | at 1.35 | of the chip |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    let cases = report.pointer("/cases").and_then(Value::as_object).context("the report has no cases")?;
    for (name, case) in cases {
        let [pulse, interpolate, all] =
            ["pulse", "interpolate", "all"].map(|part| number(case, &format!("/per_step_event/{part}/mean")));
        let (all, interrupts) = (all?, number(case, "/interrupts_per_step_event")?);
        let [one, more] = rates(all, interrupts);
        writeln!(
            text,
            "| {name} | {:.1} | {:.1} | **{all:.1}** | {:.1} | {interrupts:.1} | {one:.0} | {more:.0} | {:.0} % |",
            pulse?,
            interpolate?,
            number(case, "/per_step_event/all/worst")?,
            number(case, "/percent_of_chip/worst")?
        )?;
    }
    for Peer(name, all, interrupts) in PEERS {
        let [one, more] = rates(all, interrupts);
        writeln!(text, "| {name} | | | **{all:.1}** | | {interrupts:.1} | {one:.0} | {more:.0} | |")?;
    }
    text.push_str(
        "\n| | besides steps, at full speed | mean | worst | idle tick | worst `pulse` | worst `interpolate` |\n",
    );
    text.push_str("| --- | --- | --- | --- | --- | --- | --- |\n");
    for (name, case) in cases {
        writeln!(
            text,
            "| {name} | {:.0} | {:.0} | {:.0} | {:.0} | {:.0} | {:.0} |",
            number(case, "/per_tick_of_interpolate/besides/at_full_speed")?,
            number(case, "/per_tick_of_interpolate/besides/mean")?,
            number(case, "/per_tick_of_interpolate/besides/worst")?,
            number(case, "/per_idle_tick/all/mean")?,
            number(case, "/per_call_of_pulse/worst")?,
            number(case, "/per_tick_of_interpolate/worst")?
        )?;
    }
    text.push_str("\n| image | flash, bytes | RAM without stacks, bytes |\n| --- | --- | --- |\n");
    for (name, board) in report.pointer("/boards").and_then(Value::as_object).context("the report has no boards")? {
        writeln!(text, "| {name} | {} | {} |", number(board, "/flash_bytes")?, number(board, "/ram_bytes")?)?;
    }
    Ok(text)
}

/// Puts the tables of a report into the page.
pub(crate) fn write(report: &Value) -> Result<()> {
    let path = crate::root().join(PAGE);
    let page = fs::read_to_string(&path).with_context(|| format!("reading {PAGE}"))?;
    let parts = page.split_once(BEGIN).and_then(|(before, rest)| Some((before, rest.split_once(END)?.1)));
    let (before, behind) = parts.with_context(|| format!("{PAGE} has no marks for the tables"))?;
    let tables = tables(report)?;
    fs::write(&path, format!("{before}{BEGIN}\n{tables}\n{END}{behind}")).with_context(|| format!("writing {PAGE}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_those_that_were_published_for_the_others() {
        // 821 and 647, 992 and 793 thousand a second
        for (peer, [one, more]) in [(&PEERS[0], [821.1, 647.6]), (&PEERS[3], [992.3, 793.3])] {
            let found = rates(peer.1, peer.2);
            assert!((found[0] - one).abs() < 0.1 && (found[1] - more).abs() < 0.1, "{found:?}");
        }
    }
}
