//! Reads a scenario: one event a line, `SECONDS WHAT`; all errors of a script are found at once.

use handcnc::foreground::Command;
use handcnc::foreground::mode::Mode;
use interp_core::block::Feed;
use interp_core::config::speed_of;
use interp_core::drive::gearing::Lead;
use interp_core::units::{Axis, Feedrate, Length};

use super::event::{Event, What};
use super::number::{rounded_up, scaled};
use super::words;

/// Longest scenario: 100 hours.
const MOST_TICKS: u64 = 360_000_000;

/// What a script is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Script {
    /// Events in the order of time; those of one time in the order of their lines.
    pub events: Vec<Event>,
}

/// An error of a script.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScriptError {
    /// Line, from 1.
    pub line: u32,
    /// Column of the word in question, from 1, and its length: characters.
    pub span: (u32, u32),
    /// The line.
    pub text: String,
    /// What is wrong.
    pub cause: String,
    /// What to do about it.
    pub remedy: String,
}

/// What is wrong with a word, and what to do about it.
pub(super) type Wrong = (String, String);

/// The words of a line.
pub(super) struct Words<'t> {
    text: &'t str,
    /// Bytes behind the word taken last.
    next: usize,
    /// Where that one is.
    last: (usize, usize),
}

impl<'t> Words<'t> {
    const fn new(text: &'t str) -> Self {
        Self { text, next: 0, last: (0, 0) }
    }

    fn left(&self) -> &'t str {
        self.text.get(self.next..).unwrap_or_default()
    }

    /// The next word, if any.
    pub(super) fn next(&mut self) -> Option<&'t str> {
        let left = self.left();
        let skipped = left.len() - left.trim_start().len();
        let word = left.trim_start().split(char::is_whitespace).next().unwrap_or_default();
        let at = self.next + skipped;
        self.last = (at, at + word.len().max(1));
        self.next = at + word.len();
        (!word.is_empty()).then_some(word)
    }

    /// The next word, which has to be there.
    pub(super) fn need(&mut self, what: &str, remedy: &str) -> Result<&'t str, Wrong> {
        self.next().ok_or_else(|| (format!("{what} is missing"), remedy.into()))
    }

    /// All that is left.
    pub(super) fn rest(&mut self) -> &'t str {
        let left = self.left();
        let rest = left.trim();
        let at = self.next + (left.len() - left.trim_start().len());
        self.last = (at, at + rest.len().max(1));
        self.next = self.text.len();
        rest
    }

    /// One of a list of words.
    pub(super) fn one_of<T: Clone>(&mut self, what: &str, list: &[(&str, T)]) -> Result<T, Wrong> {
        let names: Vec<&str> = list.iter().map(|(name, _)| *name).collect();
        let remedy = format!("write one of {}", names.join(", "));
        let word = self.need(&format!("the {what}"), &remedy)?;
        let found = list.iter().find(|(name, _)| *name == word);
        found.map(|(_, value)| value.clone()).ok_or_else(|| (format!("{word} is no {what}"), remedy))
    }

    /// `on` or `off`.
    pub(super) fn switch(&mut self) -> Result<bool, Wrong> {
        self.one_of("position of a switch", &[("on", true), ("off", false)])
    }

    /// `x` or `z`.
    pub(super) fn axis(&mut self) -> Result<Axis, Wrong> {
        self.one_of("axis", &[("x", Axis::X), ("z", Axis::Z)])
    }

    /// A number times 10^`places` within a range (so scaled), which is told in `unit`.
    pub(super) fn number(&mut self, what: &str, places: u32, range: (i64, i64), unit: &str) -> Result<i64, Wrong> {
        let one = 10_i64.pow(places);
        let remedy = format!("write a number from {} to {}{unit}", range.0 / one, range.1 / one);
        let word = self.need(&format!("the {what}"), &remedy)?;
        let Some(value) = scaled(word, places) else {
            return Err((format!("{word} is no number"), remedy));
        };
        if value < range.0 || value > range.1 {
            return Err((format!("{word} is out of range"), remedy));
        }
        Ok(value)
    }

    /// A length in mm.
    pub(super) fn length(&mut self, what: &str) -> Result<Length, Wrong> {
        let limit = i64::from(Length::LIMIT_NM);
        let nm = self.number(what, 6, (-limit, limit), " mm")?;
        Length::from_nm(nm).ok_or_else(|| (format!("{what} is out of range"), "write at most 2100 mm".into()))
    }
}

/// Reads a script.
///
/// # Errors
/// All that is wrong with it, in the order of its lines.
pub fn parse(text: &str) -> Result<Script, Vec<ScriptError>> {
    let (mut events, mut errors) = (Vec::new(), Vec::new());
    let mut end: Option<(u64, u32)> = None;
    for (line, text) in (1_u32..).zip(text.lines()) {
        let content = without_comment(text);
        if content.trim().is_empty() {
            continue;
        }
        let mut words = Words::new(content);
        match event(&mut words, line, text) {
            Ok(event) => {
                if event.what == What::End {
                    end = end.or(Some((event.tick, line)));
                }
                events.push(event);
            }
            Err((cause, remedy)) => {
                let characters = |bytes: usize| content.get(..bytes).unwrap_or_default().chars().count();
                let (from, to) = (characters(words.last.0), characters(words.last.1.min(content.len())));
                let number = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
                let span = (number(from + 1), number(to.saturating_sub(from).max(1)));
                errors.push(ScriptError { line, span, text: text.into(), cause, remedy });
            }
        }
    }
    if let Some((tick, line)) = end {
        let late = events.iter().filter(|event| event.tick > tick || event.tick == tick && event.line > line);
        errors.extend(late.map(|event| ScriptError {
            line: event.line,
            span: (1, number_of(&event.text)),
            text: event.text.clone(),
            cause: format!("the scenario ends before this, in line {line}"),
            remedy: "give an earlier time, or let it end later".into(),
        }));
        errors.sort_by_key(|error| error.line);
    }
    if errors.is_empty() {
        // a stable sort: what happens at one time keeps the order of its lines
        events.sort_by_key(|event| event.tick);
        Ok(Script { events })
    } else {
        Err(errors)
    }
}

fn number_of(text: &str) -> u32 {
    u32::try_from(text.split_whitespace().next().map_or(1, |word| word.chars().count())).unwrap_or(1)
}

/// A line up to a `#` that begins it or stands behind a blank.
pub(super) fn without_comment(text: &str) -> &str {
    let begins = |(at, _): &(usize, &str)| {
        text.get(..*at).is_none_or(|before| before.is_empty() || before.ends_with(char::is_whitespace))
    };
    text.match_indices('#').find(begins).and_then(|(at, _)| text.get(..at)).unwrap_or(text)
}

/// One event.
fn event(words: &mut Words<'_>, line: u32, text: &str) -> Result<Event, Wrong> {
    let time = words.need("the time", "write SECONDS WHAT")?;
    let remedy = "begin the line with the seconds from the start, such as 1.5";
    let tick = rounded_up(time, 3).ok_or_else(|| (format!("{time} is no time"), remedy.into()))?;
    if tick > MOST_TICKS {
        return Err((format!("{time} is too late"), "a scenario lasts 360000 s at most".into()));
    }
    let what = words::what(words)?;
    if let Some(more) = words.next() {
        return Err((format!("{more} is one word too many"), "leave it out, or put # before a comment".into()));
    }
    Ok(Event { tick, line, text: text.trim_end().into(), what })
}

/// A mode by its name.
pub(super) fn mode(words: &mut Words<'_>) -> Result<Mode, Wrong> {
    words.one_of("mode", &Mode::ALL.map(|mode| (mode.name(), mode)))
}

/// A feed by its number and unit.
pub(super) fn feed_rate(words: &mut Words<'_>) -> Result<Feed, Wrong> {
    let most = i64::try_from(Feedrate::LIMIT_NM_PER_MIN).unwrap_or(i64::MAX);
    let value = words.number("feed", 6, (1, most), "")?;
    let per_turn = words.one_of("unit of a feed", &[("mm/min", false), ("mm/rev", true)])?;
    let nm = value.unsigned_abs();
    let feed = if per_turn {
        Lead::new(nm, 1).map(Feed::PerTurn)
    } else {
        Feedrate::from_nm_per_min(nm).map(|feed| Feed::PerTick(speed_of(feed)))
    };
    let remedy = "write 0.01 to 30000 mm/min, or up to 1000 mm/rev";
    feed.ok_or_else(|| ("the feed is out of range".into(), remedy.into()))
}

/// A request without figures, by its name.
pub(super) fn plain(name: &str) -> Option<What> {
    Some(match name {
        "hold" => What::Command(Command::Hold),
        "reset" => What::Command(Command::Reset),
        "return" => What::Command(Command::Return),
        "keep-offset" => What::Command(Command::KeepOffset),
        "null-offset" => What::Command(Command::NullOffset),
        "book-wear" => What::Command(Command::BookWear),
        "confirm-position" => What::Command(Command::ConfirmPosition),
        "start" => What::Start,
        "estop" => What::EmergencyStop,
        "release" => What::Release,
        "power-fail" => What::PowerFail,
        "power-on" => What::PowerOn,
        "resume" => What::Resume,
        "end" => What::End,
        _ => return None,
    })
}
