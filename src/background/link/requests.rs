//! What the operator asks for by the link: `$mode=power`, `$zero=x 12.5`, in the words of scenarios.
//!
//! A request goes to the foreground, which alone decides; its line is answered when it has: `ok` if it was obeyed, else
//! an error that names why it was not. What would change where waiting blocks lead is refused here while any wait.

use core::fmt::{self, Write};

use feature_editor::codes::Number;
use interp_core::block::Feed;
use interp_core::channel::State;
use interp_core::config::speed_of;
use interp_core::drive::gearing::Lead;
use interp_core::drive::wheel::Click;
use interp_core::units::{Axis, Feedrate, Length, Point, Sense};

use super::outbox::Settling;
use super::refusal::Refusal;
use super::{Link, Snapshot};
use crate::foreground::Command;
use crate::foreground::command::{PickUpStep, Stop};
use crate::foreground::contour::Contour;
use crate::foreground::mode::Mode;

/// Names of the requests, and what each takes.
const REQUESTS: [(&str, &str); 20] = [
    ("mode", "handwheel, power, linked, auto, mdi, home or retrace"),
    ("scale", "1, 10, 100 or speed"),
    ("feed-rate", "a feed above zero, then mm/min (to 30000) or mm/rev (to 1000)"),
    ("taper", "DX DZ in mm"),
    ("arc", "X Z I K in mm, then cw or ccw"),
    ("home", "x or z"),
    ("zero", "x or z, then a coordinate in mm or nothing for 0"),
    ("stop-at", "x or z, then a coordinate in mm, here or off"),
    ("return", NOTHING),
    ("repeat", "a whole number from 0 to 10000"),
    ("pick-up", "begin, capture or go"),
    ("keep-offset", NOTHING),
    ("null-offset", NOTHING),
    ("book-wear", NOTHING),
    ("single", SWITCH),
    ("dry-run", SWITCH),
    ("lock", SWITCH),
    ("rapid-override", "a whole number of percent from 0 to 100"),
    ("motors", SWITCH),
    ("confirm-position", NOTHING),
];

const NOTHING: &str = "no value";
const SWITCH: &str = "on or off";

/// The names, as `$` lists them.
pub(super) struct Names;

impl fmt::Display for Names {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, (name, takes)) in REQUESTS.iter().enumerate() {
            let gap = if at == 0 { "" } else { " " };
            let value = if core::ptr::eq(*takes, NOTHING) { "" } else { "=" };
            write!(f, "{gap}${name}{value}")?;
        }
        Ok(())
    }
}

/// A request that is written wrong.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) struct Wrong {
    name: &'static str,
    takes: &'static str,
    pub(super) cause: Cause,
}

/// What is wrong with it; words are counted from 1.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) enum Cause {
    /// A word is missing.
    Missing,
    /// A word that is none of those which may stand there.
    Word(u8),
    /// A word that is no number.
    Number(u8),
    /// A number out of its range.
    Range(u8),
    /// There are more words.
    More,
}

impl fmt::Display for Wrong {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "${} takes {}: ", self.name, self.takes)?;
        match self.cause {
            Cause::Missing => f.write_str("a word is missing"),
            Cause::Word(at) => write!(f, "word {at} of the value is another"),
            Cause::Number(at) => write!(f, "word {at} of the value is no such number"),
            Cause::Range(at) => write!(f, "word {at} of the value is out of range"),
            Cause::More => f.write_str("there is a word too many"),
        }
    }
}

/// Words of a value, with blanks or commas between.
struct Words<'t> {
    rest: &'t str,
    /// Words that were taken.
    taken: u8,
}

impl<'t> Words<'t> {
    const BETWEEN: [char; 3] = [' ', '\t', ','];

    fn next(&mut self) -> Option<&'t str> {
        let text = self.rest.trim_start_matches(Self::BETWEEN);
        let (word, rest) = text.split_once(Self::BETWEEN).unwrap_or((text, ""));
        self.rest = rest;
        if word.is_empty() {
            return None;
        }
        self.taken = self.taken.saturating_add(1);
        Some(word)
    }

    fn need(&mut self) -> Result<&'t str, Cause> {
        self.next().ok_or(Cause::Missing)
    }

    fn one_of<T: Copy>(&mut self, known: &[(&str, T)]) -> Result<T, Cause> {
        let word = self.need()?;
        let found = known.iter().find(|(name, _)| name.eq_ignore_ascii_case(word));
        found.map(|(_, value)| *value).ok_or(Cause::Word(self.taken))
    }

    fn axis(&mut self) -> Result<Axis, Cause> {
        self.one_of(&[("x", Axis::X), ("z", Axis::Z)])
    }

    fn switch(&mut self) -> Result<bool, Cause> {
        self.one_of(&[("on", true), ("off", false)])
    }

    /// A whole number up to `most`.
    fn whole(&mut self, most: u16) -> Result<u16, Cause> {
        let number = Number::parse(self.need()?.as_bytes()).map_err(|_| Cause::Number(self.taken))?;
        let value = number.code().and_then(|value| u16::try_from(value).ok()).filter(|value| *value <= most);
        value.ok_or(Cause::Range(self.taken))
    }

    /// Millimetres in nm.
    fn nm(&self, word: &str) -> Result<i64, Cause> {
        let number = Number::parse(word.as_bytes()).map_err(|_| Cause::Number(self.taken))?;
        number.scaled(1_000_000).ok_or(Cause::Range(self.taken))
    }

    fn length_of(&self, word: &str) -> Result<Length, Cause> {
        Length::from_nm(self.nm(word)?).ok_or(Cause::Range(self.taken))
    }

    fn point(&mut self) -> Result<Point, Cause> {
        let x = self.need()?;
        let x = self.length_of(x)?;
        let z = self.need()?;
        Ok(Point { x, z: self.length_of(z)? })
    }

    fn feed(&mut self) -> Result<Feed, Cause> {
        let word = self.need()?;
        let nm = u64::try_from(self.nm(word)?).map_err(|_| Cause::Range(self.taken))?;
        let at = self.taken;
        let feed = if self.one_of(&[("mm/min", false), ("mm/rev", true)])? {
            Lead::new(nm, 1).map(Feed::PerTurn)
        } else {
            Feedrate::from_nm_per_min(nm).map(|feed| Feed::PerTick(speed_of(feed)))
        };
        feed.ok_or(Cause::Range(at))
    }

    fn stop(&mut self) -> Result<Stop, Cause> {
        match self.need()? {
            word if word.eq_ignore_ascii_case("here") => Ok(Stop::Here),
            word if word.eq_ignore_ascii_case("off") => Ok(Stop::Off),
            word => self.length_of(word).map(Stop::At),
        }
    }
}

/// The request of a name; `None` of a name that is no request's.
pub(super) fn command(name: &str, value: &str) -> Option<Result<Command, Wrong>> {
    let (name, takes) = *REQUESTS.iter().find(|(known, _)| known.eq_ignore_ascii_case(name))?;
    let mut words = Words { rest: value, taken: 0 };
    let command = parse(name, &mut words).and_then(|command| match words.next() {
        None => Ok(command),
        Some(_) => Err(Cause::More),
    });
    Some(command.map_err(|cause| Wrong { name, takes, cause }))
}

/// The request of a known name.
fn parse(name: &str, words: &mut Words<'_>) -> Result<Command, Cause> {
    let [one, ten, hundred] = Click::DECADES;
    Ok(match name {
        "mode" => Command::Mode(words.one_of(&Mode::ALL.map(|mode| (mode.name(), mode)))?),
        "scale" => {
            let scales = [("1", Some(one)), ("10", Some(ten)), ("100", Some(hundred)), ("speed", None)];
            Command::Scale(words.one_of(&scales)?)
        }
        "feed-rate" => Command::FeedRate(words.feed()?),
        "taper" => Command::Contour(Contour::Taper(words.point()?)),
        "arc" => {
            let (end, centre) = (words.point()?, words.point()?);
            let sense = words.one_of(&[("cw", Sense::Clockwise), ("ccw", Sense::CounterClockwise)])?;
            Command::Contour(Contour::Arc { end, centre, sense })
        }
        "home" => Command::Home(words.axis()?),
        "zero" => {
            let axis = words.axis()?;
            Command::Zero(axis, words.next().map_or(Ok(Length::ZERO), |word| words.length_of(word))?)
        }
        "stop-at" => Command::StopAt(words.axis()?, words.stop()?),
        "return" => Command::Return,
        "repeat" => Command::Repeat(words.whole(10_000)?),
        "pick-up" => {
            let steps = [("begin", PickUpStep::Begin), ("capture", PickUpStep::Capture), ("go", PickUpStep::Go)];
            Command::PickUp(words.one_of(&steps)?)
        }
        "keep-offset" => Command::KeepOffset,
        "null-offset" => Command::NullOffset,
        "book-wear" => Command::BookWear,
        "single" => Command::SingleBlock(words.switch()?),
        "dry-run" => Command::DryRun(words.switch()?),
        "lock" => Command::MachineLock(words.switch()?),
        "rapid-override" => Command::RapidOverride(words.whole(100)?),
        "motors" => Command::Motors(words.switch()?),
        // the last one that is known
        _ => Command::ConfirmPosition,
    })
}

/// What has to be done once a request was obeyed.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) enum Asked {
    /// Another mode: programs begin anew.
    Mode,
    /// Motors off: what comes waits for a start, and does not begin with the motors.
    Hold,
    /// Nothing.
    Other,
}

/// Whether lines of programs are taken: in automatic and manual data, and on the way back where they belong to the program
/// that is retraced.
pub(super) const fn takes_programs(snapshot: &Snapshot) -> bool {
    match snapshot.mode {
        Mode::Automatic | Mode::ManualData => true,
        Mode::Retrace => !matches!(snapshot.state, State::Idle | State::Ended),
        Mode::Handwheel | Mode::Power | Mode::Linked | Mode::Homing => false,
    }
}

/// Whether blocks that wait would lead elsewhere, or be run in another way, than they were meant to. To retrace and back
/// is a change on the program's way, for which the foreground sees whether it stands.
const fn shifts(command: &Command, mode: Mode) -> bool {
    match command {
        Command::Mode(to) => {
            !matches!((mode, *to), (Mode::Automatic, Mode::Retrace) | (Mode::Retrace, Mode::Automatic))
        }
        Command::Zero(..)
        | Command::Home(_)
        | Command::Contour(_)
        | Command::PickUp(_)
        | Command::DryRun(_)
        | Command::MachineLock(_) => true,
        _ => false,
    }
}

impl Link {
    /// Asks the foreground for what a command, without its `$`, wants; `None` where that is no request.
    pub(super) fn request(&mut self, text: &[u8], empty: bool, snapshot: &Snapshot) -> Option<Result<(), Refusal>> {
        let text = core::str::from_utf8(text).ok()?;
        let (name, value) = text.split_once('=').unwrap_or((text, ""));
        let command = match command(name.trim(), value)? {
            Ok(command) => command,
            Err(wrong) => return Some(Err(Refusal::Wrong(wrong))),
        };
        if shifts(&command, snapshot.mode) && (!empty || self.compiler.holds()) {
            return Some(Err(Refusal::Waiting));
        }
        self.asked = Some(match command {
            Command::Mode(mode) if mode != snapshot.mode => Asked::Mode,
            Command::Motors(false) => Asked::Hold,
            _ => Asked::Other,
        });
        match command {
            // `$X` sends it, too
            Command::ConfirmPosition => self.outbox.confirm = true,
            _ => self.outbox.request = Some(command),
        }
        self.settling = Settling::Sent;
        Some(Ok(()))
    }

    /// Answers a request once the foreground has decided; true if it has.
    pub(super) fn answered(&mut self, asked: Asked, empty: bool, snapshot: &Snapshot, out: &mut impl Write) -> bool {
        if self.settling != Settling::Settled {
            return false;
        }
        self.asked = None;
        if let Some(refusal) = snapshot.answer {
            self.refuse(&Refusal::Request(refusal), out);
            return true;
        }
        match asked {
            // a program that is retraced, or goes on behind that, is not over
            Asked::Mode if empty && self.is_still(snapshot) => self.start_over(snapshot),
            Asked::Hold => self.held = true,
            Asked::Mode | Asked::Other => {}
        }
        self.owes_ok = true;
        true
    }
}
