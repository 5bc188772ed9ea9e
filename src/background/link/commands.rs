//! The `$` commands.

use core::fmt::Write;

use feature_editor::codes::{Format, Number, SpindleCommand};
use interp_core::units::{Axis, PulseSize};

use super::refusal::Refusal;
use super::reply::{Thousandths, scaled};
use super::requests::Names;
use super::{Link, RECEIVE_BUFFER, Snapshot};
use crate::background::parameters::{ParameterError, Parameters};
use crate::foreground::BLOCK_QUEUE;

/// Parameters that Grbl has numbers for. 100 to 102 are pulses a millimetre, the others have Grbl's own units.
const NUMBERED: [(&str, &str); 6] = [
    ("100", "x.pulse_nm"),
    ("102", "z.pulse_nm"),
    ("110", "x.max_feed"),
    ("112", "z.max_feed"),
    ("120", "x.max_accel"),
    ("122", "z.max_accel"),
];

/// Names of the formats.
const FORMATS: [(&str, Format); 2] = [("gcode", Format::Gcode), ("nc1973", Format::Nc1973)];

/// Pulses a millimetre.
fn per_millimetre(pulse: PulseSize) -> Thousandths {
    let (numerator, denominator) = (u64::from(pulse.numerator()), i64::from(pulse.denominator()));
    Thousandths(scaled(denominator, 1_000_000_000, numerator))
}

impl Link {
    /// Obeys a command, without its `$`.
    pub(super) fn command(
        &mut self,
        text: &[u8],
        idle: bool,
        snapshot: &Snapshot,
        out: &mut impl Write,
    ) -> Result<(), Refusal> {
        let text = core::str::from_utf8(text).map_err(|_| Refusal::Command)?.trim();
        match text.split_once('=') {
            Some((name, value)) => self.set(name.trim(), value.trim(), idle, snapshot)?,
            None => match text.as_bytes() {
                b"" => {
                    self.say(out, format_args!("[HLP:$$ $G $I $X $name=value $format=gcode ~ ! ? ctrl-x]"));
                    self.say(out, format_args!("[HLP:{}]", Names));
                }
                b"$" => {
                    self.listing = Some(0);
                    return Ok(());
                }
                b"G" | b"g" => self.write_modal(out),
                b"I" | b"i" => {
                    self.say(out, format_args!("[VER:1.1h.20190830:HandCNC {}]", env!("CARGO_PKG_VERSION")));
                    self.say(out, format_args!("[OPT:V,{BLOCK_QUEUE},{RECEIVE_BUFFER}]"));
                }
                b"X" | b"x" => return self.unlock(idle),
                b"H" | b"h" => return Err(Refusal::Homing),
                _ => return Err(Refusal::Command),
            },
        }
        self.owes_ok = true;
        Ok(())
    }

    /// Writes the next line of `$$`, or ends it.
    pub(super) fn list(&mut self, at: usize, out: &mut impl Write) {
        self.listing = Some(at.saturating_add(1));
        let mut parameters = self.parameters.iter();
        if let Some((number, name)) = NUMBERED.get(at) {
            let pulse = match *number {
                "100" => Some(self.machine.x.pulse),
                "102" => Some(self.machine.z.pulse),
                _ => None,
            };
            let shown = parameters.find(|(definition, _)| definition.name == *name).map(|(_, shown)| shown);
            drop(parameters);
            match (pulse, shown) {
                (Some(pulse), _) => self.say(out, format_args!("${number}={}", per_millimetre(pulse))),
                (None, Some(shown)) => self.say(out, format_args!("${number}={shown}")),
                (None, None) => {}
            }
        } else if let Some((definition, shown)) = parameters.nth(at.saturating_sub(NUMBERED.len())) {
            drop(parameters);
            self.say(out, format_args!("${}={shown}", definition.name));
        } else {
            drop(parameters);
            let format = FORMATS.iter().find(|(_, format)| *format == self.format).map_or("", |(name, _)| *name);
            self.say(out, format_args!("$format={format}"));
            self.listing = None;
            self.owes_ok = true;
        }
    }

    /// `$G`.
    fn write_modal(&mut self, out: &mut impl Write) {
        let modal = self.compiler.modal();
        let accessories = self.accessories;
        let spindle = match accessories.spindle {
            Some(SpindleCommand::Forward) => 3,
            Some(SpindleCommand::Reverse) => 4,
            Some(SpindleCommand::Stop) | None => 5,
        };
        // before the first motion code none is in force; senders want one, and a rapid needs no feed
        let motion = modal.motion.unwrap_or(0);
        let diameter = if modal.diameter { 7 } else { 8 };
        let unit = if modal.inch { 20 } else { 21 };
        let distance = if modal.incremental { 91 } else { 90 };
        let per_minute = modal.feed.map_or(0, |feed| i64::try_from(feed.nm_per_min()).unwrap_or(i64::MAX));
        let nm = modal.feed_per_turn.map_or(per_minute, |lead| lead.nm().into());
        let mode = if modal.per_turn { 95 } else { 94 };
        let feed = Thousandths(scaled(nm, 1, if modal.inch { 25_400 } else { 1_000 }));
        let speed = scaled(accessories.milli_rpm.into(), 1, 1_000);
        let tool = accessories.tool;
        self.say(
            out,
            format_args!(
                "[GC:G{motion} G{diameter} G18 G{unit} G{distance} G{mode} M{spindle} T{tool} F{feed} S{speed}]"
            ),
        );
    }

    /// Sets a parameter. What is modal stays in force.
    fn set(&mut self, name: &str, value: &str, idle: bool, snapshot: &Snapshot) -> Result<(), Refusal> {
        let number = NUMBERED.iter().find(|(number, _)| *number == name);
        let name = number.map_or(name, |(_, name)| *name);
        let known = self.parameters.iter().map(|(definition, _)| definition.name);
        let Some(name) = known.chain(["format"]).find(|known| known.eq_ignore_ascii_case(name)) else {
            return Err(Refusal::Parameter(ParameterError::Unknown));
        };
        if !idle {
            return Err(Refusal::NotIdle);
        }
        match name {
            "start" => return Err(Refusal::PowerOn),
            "format" => return self.set_format(value, snapshot),
            _ => {}
        }
        let mut parameters = self.parameters.clone();
        match number {
            Some(("100", _)) => set_pulse(&mut parameters, Axis::X, self.machine.x.pulse, value)?,
            Some(("102", _)) => set_pulse(&mut parameters, Axis::Z, self.machine.z.pulse, value)?,
            _ => parameters.set(name, value).map_err(Refusal::Parameter)?,
        }
        let machine = parameters.machine().map_err(Refusal::Machine)?;
        let same = machine.x.pulse == self.machine.x.pulse && machine.z.pulse == self.machine.z.pulse;
        let at = self.present(if same { &self.machine } else { &machine }, snapshot).ok_or(Refusal::Position)?;
        if machine != self.machine {
            self.outbox.machine = Some(machine);
        }
        let settings = parameters.operation(&machine);
        if settings != self.parameters.operation(&self.machine) {
            self.outbox.settings = Some(settings);
        }
        if name == "feed_override" {
            self.ask_percent(parameters.feed_override());
        }
        if name == "optional_stop" {
            self.outbox.optional_stop = Some(parameters.optional_stop());
        }
        let mut settings = parameters.settings();
        settings.start = at;
        (self.parameters, self.machine) = (parameters, machine);
        self.compiler.configure(settings, &self.machine);
        Ok(())
    }

    /// Sets how programs are read; a new program begins.
    fn set_format(&mut self, value: &str, snapshot: &Snapshot) -> Result<(), Refusal> {
        let format = FORMATS.iter().find(|(name, _)| name.eq_ignore_ascii_case(value)).ok_or(Refusal::Command)?.1;
        let at = self.present(&self.machine, snapshot).ok_or(Refusal::Position)?;
        self.format = format;
        self.compiler = self.fresh(at);
        self.begun = false;
        Ok(())
    }
}

/// Sets a pulse size by pulses a millimetre. The value that [`per_millimetre`] shows of the present size leaves it as
/// it is, so that a list of settings can be sent back.
fn set_pulse(parameters: &mut Parameters, axis: Axis, present: PulseSize, value: &str) -> Result<(), Refusal> {
    let number = Number::parse(value.as_bytes()).map_err(|_| Refusal::Number)?;
    let Thousandths(shown) = per_millimetre(present);
    let millionths = number.scaled(1_000_000).filter(|millionths| *millionths > 0).ok_or(Refusal::Number)?;
    if shown.checked_mul(1_000) == Some(millionths) {
        return Ok(());
    }
    // a million nanometres, by millionths of a pulse
    parameters.set_pulse(axis, 1_000_000_000_000, millionths.unsigned_abs()).map_err(Refusal::Parameter)
}
