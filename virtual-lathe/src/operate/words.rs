//! The words of the language: what may stand behind the time, and what each takes.

use handcnc::foreground::Command;
use handcnc::foreground::command::PickUpStep;
use handcnc::foreground::command::Stop;
use handcnc::foreground::contour::Contour;
use handcnc::foreground::inputs::Joystick;
use interp_core::drive::wheel::Click;
use interp_core::units::{Axis, Length, Point, Sense};

use super::event::{Source, Switch, What, Wheel};
use super::expect::{Expect, Relation};
use super::number::scaled;
use super::script::{Words, Wrong, feed_rate, mode, plain};

/// All words, as the remedy lists them.
const ALL: &str = "load, mode, start, hold, reset, mdi, home, single, dry-run, lock, optional-stop, block-skip, wheel, scale, \
                   joystick, rapid, feed, feed-rate, rapid-override, taper, arc, stop-at, return, repeat, zero, set, spindle, \
                   spindle-wobble, spindle-override, threading-lever, pick-up, keep-offset, null-offset, book-wear, estop, \
                   release, motors, confirm-position, power-fail, power-on, resume, limit, guard, noise, lose-index, expect, end";

/// Time of a detent that is turned at once: as fast as a hand can, a count a tick.
const AT_ONCE_NS: u32 = 4_000_000;

/// Most detents of one turn: 1000 turns of a wheel of 100.
const DETENTS: i64 = 100_000;

/// What happens: the words behind the time.
pub(super) fn what(words: &mut Words<'_>) -> Result<What, Wrong> {
    let remedy = format!("write one of {ALL}");
    let name = words.need("what happens", &remedy)?;
    if let Some(what) = plain(name) {
        return Ok(what);
    }
    let command = |command: Command| Ok(What::Command(command));
    match name {
        "load" => match words.rest() {
            "" => Err(("the program's name is missing".into(), "write load FILE".into())),
            file => Ok(What::Load(file.into())),
        },
        "mdi" => match words.rest() {
            "" => Err(("the line to run is missing".into(), "write mdi TEXT, such as mdi G1 X10 F100".into())),
            text => Ok(What::ManualData(text.into())),
        },
        "mode" => command(Command::Mode(mode(words)?)),
        "home" => command(Command::Home(words.axis()?)),
        "single" => command(Command::SingleBlock(words.switch()?)),
        "dry-run" => command(Command::DryRun(words.switch()?)),
        "lock" => command(Command::MachineLock(words.switch()?)),
        "optional-stop" => command(Command::OptionalStop(words.switch()?)),
        "block-skip" => Ok(What::BlockSkip(words.switch()?)),
        "motors" => command(Command::Motors(words.switch()?)),
        "wheel" => turn(words),
        "scale" => scale(words),
        "joystick" => joystick(words),
        "rapid" => Ok(What::Rapid(words.switch()?)),
        "feed" => command(Command::FeedOverride(percent(words, 200)?)),
        "rapid-override" => command(Command::RapidOverride(percent(words, 100)?)),
        "spindle-override" => command(Command::SpindleOverride(percent(words, 200)?)),
        "feed-rate" => command(Command::FeedRate(feed_rate(words)?)),
        "taper" => command(Command::Contour(Contour::Taper(taper(words)?))),
        "arc" => command(Command::Contour(arc(words)?)),
        "stop-at" => stop_at(words),
        "repeat" => {
            let times = words.number("number of times", 0, (0, 10_000), "")?;
            command(Command::Repeat(u16::try_from(times).unwrap_or(u16::MAX)))
        }
        "zero" => {
            let axis = words.axis()?;
            let place = optional_length(words)?;
            command(Command::Zero(axis, place))
        }
        "set" => {
            let remedy = "write set NAME VALUE; the command parameters lists all names";
            let name = words.need("the parameter's name", remedy)?.to_owned();
            match words.rest() {
                "" => Err(("the parameter's value is missing".into(), remedy.into())),
                value => Ok(What::Set(name, value.into())),
            }
        }
        "spindle" => spindle(words),
        "spindle-wobble" => {
            let percent = words.number("part of the speed", 3, (0, 50_000), " %")?;
            let hz = words.number("frequency", 3, (0, 50_000), " Hz")?;
            Ok(What::Wobble(thousandths(percent), thousandths(hz)))
        }
        "threading-lever" => Ok(What::Lever(words.one_of("position of the lever", &[("in", true), ("out", false)])?)),
        "pick-up" => {
            let steps = [("begin", PickUpStep::Begin), ("capture", PickUpStep::Capture), ("go", PickUpStep::Go)];
            Ok(What::PickUp(words.one_of("step of picking up a thread", &steps)?))
        }
        "limit" => limit(words),
        "guard" => Ok(What::Guard(words.one_of("state of the guard", &[("open", true), ("closed", false)])?)),
        "noise" => {
            let sources = [
                ("wheel-x", Source::Wheel(Wheel::X)),
                ("wheel-z", Source::Wheel(Wheel::Z)),
                ("wheel-contour", Source::Wheel(Wheel::Contour)),
                ("spindle", Source::Spindle),
            ];
            let source = words.one_of("source of noise", &sources)?;
            Ok(What::Noise(source, thousandths(words.number("rate", 3, (0, 1_000_000_000), " a second")?)))
        }
        "lose-index" => Ok(What::LoseIndex(words.switch()?)),
        "expect" => expect(words),
        _ => Err((format!("{name} is nothing that happens"), remedy)),
    }
}

#[expect(clippy::cast_precision_loss, reason = "of at most ten digits")]
fn thousandths(value: i64) -> f64 {
    value as f64 / 1e3
}

fn percent(words: &mut Words<'_>, most: i64) -> Result<u16, Wrong> {
    let value = words.number("percentage", 0, (0, most), " %")?;
    Ok(u16::try_from(value).unwrap_or(u16::MAX))
}

fn turn(words: &mut Words<'_>) -> Result<What, Wrong> {
    let wheel = words.one_of("wheel", &[("x", Wheel::X), ("z", Wheel::Z), ("contour", Wheel::Contour)])?;
    let detents = words.number("number of detents", 0, (-DETENTS, DETENTS), "")?;
    let over = match words.next() {
        None => u64::from(AT_ONCE_NS) * detents.unsigned_abs(),
        Some("over") => words.number("time", 9, (1_000_000, 3_600_000_000_000), " s")?.unsigned_abs(),
        Some(other) => {
            return Err((format!("{other} is no time to turn over"), "write wheel x +-N [over SECONDS]".into()));
        }
    };
    Ok(What::Turn(wheel, i32::try_from(detents).unwrap_or(0), over))
}

fn scale(words: &mut Words<'_>) -> Result<What, Wrong> {
    let [one, ten, hundred] = Click::DECADES;
    let scales = [("1", Some(one)), ("10", Some(ten)), ("100", Some(hundred)), ("speed", None)];
    Ok(What::Command(Command::Scale(words.one_of("scale of the wheels", &scales)?)))
}

/// The four ways along the axes.
const WAYS: [(&str, (Axis, bool)); 4] =
    [("x+", (Axis::X, true)), ("x-", (Axis::X, false)), ("z+", (Axis::Z, true)), ("z-", (Axis::Z, false))];

fn joystick(words: &mut Words<'_>) -> Result<What, Wrong> {
    let ways = WAYS.map(|(name, (axis, plus))| (name, Joystick::Axis(axis, plus)));
    let more = [("path+", Joystick::Path(true)), ("path-", Joystick::Path(false)), ("off", Joystick::Off)];
    let all: Vec<_> = ways.into_iter().chain(more).collect();
    Ok(What::Joystick(words.one_of("way of the joystick", &all)?))
}

fn limit(words: &mut Words<'_>) -> Result<What, Wrong> {
    let (axis, plus) = words.one_of("limit switch", &WAYS)?;
    let remedy = "write on, off, or at and a place in mm";
    let switch = match words.need("state of the switch", remedy)? {
        "on" => Switch::Held(true),
        "off" => Switch::Held(false),
        "at" => Switch::At(f64::from(words.length("place of the switch")?.nm()) * 1e-6),
        other => return Err((format!("{other} is no state of a limit switch"), remedy.into())),
    };
    Ok(What::Limit(axis, plus, switch))
}

fn taper(words: &mut Words<'_>) -> Result<Point, Wrong> {
    Ok(Point { x: words.length("way of X")?, z: words.length("way of Z")? })
}

fn arc(words: &mut Words<'_>) -> Result<Contour, Wrong> {
    let end = Point { x: words.length("end in X")?, z: words.length("end in Z")? };
    let centre = Point { x: words.length("centre in X")?, z: words.length("centre in Z")? };
    let senses = [("cw", Sense::Clockwise), ("ccw", Sense::CounterClockwise)];
    Ok(Contour::Arc { end, centre, sense: words.one_of("sense of an arc", &senses)? })
}

fn stop_at(words: &mut Words<'_>) -> Result<What, Wrong> {
    let axis = words.axis()?;
    let remedy = "write a coordinate in mm, here, or off";
    let stop = match words.need("place of the stop", remedy)? {
        "here" => Stop::Here,
        "off" => Stop::Off,
        number => match scaled(number, 6).and_then(Length::from_nm) {
            Some(at) => Stop::At(at),
            None => return Err((format!("{number} is no place"), remedy.into())),
        },
    };
    Ok(What::Command(Command::StopAt(axis, stop)))
}

fn optional_length(words: &mut Words<'_>) -> Result<Length, Wrong> {
    match words.next() {
        None => Ok(Length::ZERO),
        Some(number) => scaled(number, 6)
            .and_then(Length::from_nm)
            .ok_or_else(|| (format!("{number} is no place"), "write a coordinate in mm, or nothing for 0".into())),
    }
}

fn spindle(words: &mut Words<'_>) -> Result<What, Wrong> {
    let remedy = "write a speed in turns a minute from -100000 to 100000, or stop";
    let word = words.need("the spindle's speed", remedy)?;
    let speed = if word == "stop" { Some(0) } else { scaled(word, 3) };
    let speed = speed.filter(|speed| speed.abs() <= 100_000_000).and_then(|speed| i32::try_from(speed).ok());
    match speed {
        Some(speed) => Ok(What::Command(Command::Spindle(speed))),
        None => Err((format!("{word} is no speed"), remedy.into())),
    }
}

fn expect(words: &mut Words<'_>) -> Result<What, Wrong> {
    let remedy = "write expect KEY OP VALUE, such as expect position.x == 800";
    let key = words.need("the key", remedy)?.to_owned();
    let sign = words.need("the relation", remedy)?;
    let near = sign == "~";
    let Some(mut relation) = Relation::of(sign).or(near.then_some(Relation::Near(0.0))) else {
        return Err((format!("{sign} is no relation"), "write one of == != < <= > >=, or ~ V +- T".into()));
    };
    let value = words.need("the value", remedy)?.trim_matches('"').to_owned();
    let ordered = !matches!(relation, Relation::Equal | Relation::Unequal);
    if ordered && value.parse::<f64>().is_err() {
        return Err((format!("{value} is no number"), "only == and != compare words".into()));
    }
    if near {
        let remedy = "write ~ V +- T";
        let sign = words.need("+-", remedy)?;
        let tolerance = if sign == "+-" { words.need("the tolerance", remedy)? } else { "" };
        let tolerance = tolerance.parse::<f64>().ok().filter(|tolerance| *tolerance >= 0.0);
        relation = Relation::Near(tolerance.ok_or_else(|| ("the tolerance is missing".to_owned(), remedy.to_owned()))?);
    }
    Ok(What::Expect(Expect { key, relation, value }))
}
