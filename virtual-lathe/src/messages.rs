//! Errors and warnings as a person reads them: place, cause, the line itself with the word marked, remedy.

use std::fmt::Write;

use handcnc::background::compile::Finding;
use handcnc::foreground::alarm::Alarm;

/// Characters of a long line that are shown.
const SHOWN: usize = 100;

/// What to do after an alarm.
pub const fn after(alarm: Alarm) -> &'static str {
    match alarm {
        Alarm::Emergency => "close the emergency input",
        Alarm::Underrun | Alarm::Overrun | Alarm::Late | Alarm::Watchdog => "this is a bug: please report the program",
        Alarm::PowerReturned => "confirm where the tool is, or home",
        Alarm::LimitSwitchX | Alarm::LimitSwitchZ => "move off the limit switch",
        Alarm::Homing | Alarm::FollowingX | Alarm::FollowingZ => "look at the switch, the scale and the motor",
        Alarm::SpindleStopped => "let the spindle turn until the thread has ended, or lighten the cut",
        Alarm::SpindleReversed => "write M3 or M4 before the thread and M5 behind it",
        Alarm::IndexLost => "look at the index of the spindle's encoder and at its cable",
        Alarm::EncoderNoise => "make spindle.encoder_counts 4 times the encoder's lines; look at its cable",
        Alarm::NoSpindle => "write S and M3 or M4 before threads and feeds a turn",
        Alarm::SpindleTooFast => "write a smaller S: lead times speed is more than max_feed of an axis",
        Alarm::SpindleTooRough => "write a smaller S, or raise max_accel, if the machine allows it",
        Alarm::NoWayBack => "write the thread in fewer blocks",
    }
}

/// One finding as text.
pub fn finding(name: &str, finding: &Finding, text: &[u8]) -> String {
    let kind = if finding.is_error() { "error" } else { "warning" };
    let (column, length) = finding.span();
    let line = finding.line();
    let mut message = format!("{kind}: {name}:{line}:{column}: {finding}\n");
    let shown: Vec<char> = String::from_utf8_lossy(text)
        .trim_end_matches(['\r', '\n'])
        .chars()
        .map(|c| if c.is_control() { if c == '\t' { ' ' } else { '\u{b7}' } } else { c })
        .collect();
    if !shown.is_empty() {
        let at = (column.max(1) - 1) as usize;
        let from = if shown.len() > SHOWN { at.saturating_sub(SHOWN / 3) } else { 0 };
        let part: String = shown.iter().skip(from).take(SHOWN).collect();
        let (before, after) = (if from > 0 { "..." } else { "" }, if shown.len() > from + SHOWN { "..." } else { "" });
        let gutter = line.to_string();
        let blank = " ".repeat(gutter.len());
        let mark = "^".repeat((length as usize).clamp(1, SHOWN.saturating_sub(at - from).max(1)));
        let pad = " ".repeat(before.len() + at - from);
        // writing to a string cannot fail
        let _ = write!(message, " {blank} |\n {gutter} | {before}{part}{after}\n {blank} | {pad}{mark}\n");
    }
    let mut remedy = String::new();
    let _ = finding.remedy(&mut remedy);
    if !remedy.is_empty() {
        let _ = writeln!(message, "   = {remedy}");
    }
    message
}
