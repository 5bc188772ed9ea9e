//! The operator's panel as a board reads it: levels of pins and counters of timers become readings and requests.
//!
//! A board names the pin of each [`Contact`]; levels of all pins come as one word, which is [debounced](super::debounce).
//! All pins are pulled up and all contacts go to ground, so that a broken wire is an open contact. What asks for something
//! (joystick, keys, lever) closes; what has to be sure (guard, limit switches) is closed until it asks for a stop. So a wire
//! that breaks, or was never there, asks for nothing, or for a stop. A machine without guard or limit switches says so by its
//! [parameters](Fitted).
//!
//! At power-on a key or a lever counts as held, and the guard as open, until it is read otherwise: a key that is stuck starts
//! nothing.

use super::debounce::{Debounced, OFF};
use super::inputs::{Ends, Inputs, Joystick, PerAxis};
use super::mode::Mode;
use super::settings::Fitted;
use super::{Command, Foreground};
use interp_core::drive::spindle::Reading;
use interp_core::units::Axis;

/// A contact of the panel or of the machine.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Contact {
    /// Joystick, X to plus: away from the axis.
    JoystickXPlus,
    /// Joystick, X to minus.
    JoystickXMinus,
    /// Joystick, Z to plus: away from the headstock.
    JoystickZPlus,
    /// Joystick, Z to minus.
    JoystickZMinus,
    /// Rapid, beside the joystick.
    Rapid,
    /// Threading lever.
    Lever,
    /// Cycle start.
    Start,
    /// Feed hold.
    Hold,
    /// Reset.
    Reset,
    /// Limit switch of X at plus.
    XPlusEnd,
    /// Limit switch of X at minus.
    XMinusEnd,
    /// Limit switch of Z at plus.
    ZPlusEnd,
    /// Limit switch of Z at minus.
    ZMinusEnd,
    /// Guard.
    Guard,
}

impl Contact {
    /// All of them, in their order.
    pub const ALL: [Self; 14] = [
        Self::JoystickXPlus,
        Self::JoystickXMinus,
        Self::JoystickZPlus,
        Self::JoystickZMinus,
        Self::Rapid,
        Self::Lever,
        Self::Start,
        Self::Hold,
        Self::Reset,
        Self::XPlusEnd,
        Self::XMinusEnd,
        Self::ZPlusEnd,
        Self::ZMinusEnd,
        Self::Guard,
    ];

    /// Its bit among those that ask.
    const fn bit(self) -> u16 {
        1 << self as u8
    }

    /// Asks for a stop by opening.
    const fn opens(self) -> bool {
        matches!(self, Self::XPlusEnd | Self::XMinusEnd | Self::ZPlusEnd | Self::ZMinusEnd | Self::Guard)
    }

    /// Counts as asking at power-on.
    const fn asks_at_first(self) -> bool {
        !matches!(
            self,
            Self::JoystickXPlus | Self::JoystickXMinus | Self::JoystickZPlus | Self::JoystickZMinus | Self::Rapid
        )
    }
}

/// Counters of a board's encoders, as they are at a tick's start; all wrap at 16 bits, 4 counts a line.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Turned {
    /// Counts of the wheels since the last tick.
    pub wheels: PerAxis<i16>,
    /// Of the contour wheel; `None` where the board has no timer for one.
    pub contour: Option<i16>,
    /// The spindle's counter, and where its index was.
    pub spindle: Reading,
}

/// Keys that went down in a tick and that the background has to know of, too. A guard that is opened or closed is a hold
/// for it: what waits in the background begins only when somebody asks for it once more, never because a guard was closed.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Keys {
    /// Cycle start.
    pub start: bool,
    /// Feed hold.
    pub hold: bool,
    /// Reset.
    pub reset: bool,
}

/// Which bit of a board's word of levels each contact is.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Wiring {
    /// A mask of one bit, or 0 where the board has no pin for the contact; in the order of [`Contact::ALL`].
    masks: [u32; Contact::ALL.len()],
}

impl Wiring {
    /// No contact at all.
    pub const NONE: Self = Self { masks: [0; Contact::ALL.len()] };

    /// Gives a contact a bit of the word.
    #[must_use]
    pub fn with(mut self, contact: Contact, mask: u32) -> Self {
        if let Some(place) = self.masks.get_mut(usize::from(contact as u8)) {
            *place = mask;
        }
        self
    }

    /// Bits of the contacts that `which` picks.
    fn masks(&self, which: impl Fn(Contact) -> bool) -> u32 {
        let of = Contact::ALL.into_iter().zip(self.masks);
        of.fold(0, |all, (contact, mask)| if which(contact) { all | mask } else { all })
    }

    /// Contacts whose bit is set.
    fn contacts(&self, word: u32) -> u16 {
        let of = Contact::ALL.into_iter().zip(self.masks);
        of.fold(0, |all, (contact, mask)| if word & mask != 0 { all | contact.bit() } else { all })
    }
}

/// The panel of a lathe.
#[derive(Clone, Debug)]
pub struct Panel {
    wiring: Wiring,
    /// Bits of contacts that the board has, and of those that ask by closing: by a low level.
    wired: u32,
    low: u32,
    debounced: Debounced,
    /// What the contacts counted as when the readings were made of them, and which switches there were.
    word: u32,
    fitted: Fitted,
    asks: u16,
    /// The readings, but for what counts.
    inputs: Inputs,
    /// Ticks until all contacts have been read since power-on.
    unread: u32,
    /// The background knows that the guard is open.
    told: bool,
}

impl Panel {
    /// A panel that is wired like this.
    pub fn new(wiring: Wiring) -> Self {
        let word = wiring.masks(Contact::asks_at_first);
        let fitted = Fitted { guard: true, ends: true };
        let asks = wiring.contacts(word);
        Self {
            wiring,
            wired: wiring.masks(|_| true),
            low: wiring.masks(|contact| !contact.opens()),
            debounced: Debounced::new(word),
            word,
            fitted,
            asks,
            inputs: readings(asks, fitted),
            unread: OFF,
            told: false,
        }
    }

    /// Takes a tick's levels (a bit is set where a pin is high) and counts, and gives them to the lathe as readings and
    /// requests. To be called before its tick. A hold and a reset act at once, whatever the background does; the
    /// background has to be told, too, or it would go on with its program.
    pub fn serve(&mut self, levels: u32, turned: &Turned, foreground: &mut Foreground<'_>) -> Keys {
        let fitted = foreground.desk.settings.fitted;
        let word = self.debounced.take((levels ^ self.low) & self.wired);
        let mut keys = Keys::default();
        if word != self.word || fitted != self.fitted {
            keys = self.changed(word, fitted, foreground);
        }
        self.unread = self.unread.saturating_sub(1);
        if self.inputs.guard != self.told && self.unread == 0 {
            self.told = self.inputs.guard;
            keys.hold = true;
        }
        let mut inputs = self.inputs;
        inputs.wheels = turned.wheels;
        inputs.contour = match turned.contour {
            Some(counts) => counts,
            // where no timer is left for a contour wheel, that of Z is one while a contour is followed
            None if matches!(foreground.desk.mode, Mode::Linked | Mode::Retrace) => {
                core::mem::take(&mut inputs.wheels.z)
            }
            None => 0,
        };
        inputs.spindle = Some(turned.spindle);
        foreground.read(&inputs);
        keys
    }

    /// Contacts that ask for something, a bit each in the order of [`Contact::ALL`].
    pub const fn asks(&self) -> u16 {
        self.asks
    }

    /// A contact counts as something else.
    #[cold]
    fn changed(&mut self, word: u32, fitted: Fitted, foreground: &mut Foreground<'_>) -> Keys {
        let before = self.asks;
        (self.word, self.fitted) = (word, fitted);
        self.asks = self.wiring.contacts(word);
        self.inputs = readings(self.asks, fitted);
        let asks = |contact: Contact| self.asks & contact.bit() != 0;
        let pressed = |contact: Contact| asks(contact) && before & contact.bit() == 0;
        let stops = asks(Contact::Hold) || asks(Contact::Reset);
        let keys = Keys {
            start: pressed(Contact::Start) && !stops,
            hold: pressed(Contact::Hold),
            reset: pressed(Contact::Reset),
        };
        if keys.reset {
            foreground.obey(Command::Reset);
        } else if keys.hold {
            foreground.obey(Command::Hold);
        }
        if (self.asks ^ before) & Contact::Lever.bit() != 0 {
            foreground.obey(Command::Lever(asks(Contact::Lever)));
        }
        keys
    }
}

/// What contacts say.
const fn readings(asks: u16, fitted: Fitted) -> Inputs {
    const fn is(asks: u16, contact: Contact) -> bool {
        asks & contact.bit() != 0
    }
    // two ways at once are none: a lever has one place
    const JOYSTICK: u16 = Contact::Rapid.bit().wrapping_sub(1);
    const X_PLUS: u16 = Contact::JoystickXPlus.bit();
    const X_MINUS: u16 = Contact::JoystickXMinus.bit();
    const Z_PLUS: u16 = Contact::JoystickZPlus.bit();
    const Z_MINUS: u16 = Contact::JoystickZMinus.bit();
    let joystick = match asks & JOYSTICK {
        X_PLUS => Joystick::Axis(Axis::X, true),
        X_MINUS => Joystick::Axis(Axis::X, false),
        Z_PLUS => Joystick::Axis(Axis::Z, true),
        Z_MINUS => Joystick::Axis(Axis::Z, false),
        _ => Joystick::Off,
    };
    let ends = fitted.ends;
    Inputs {
        joystick,
        rapid: is(asks, Contact::Rapid),
        ends: PerAxis {
            x: Ends { plus: ends && is(asks, Contact::XPlusEnd), minus: ends && is(asks, Contact::XMinusEnd) },
            z: Ends { plus: ends && is(asks, Contact::ZPlusEnd), minus: ends && is(asks, Contact::ZMinusEnd) },
        },
        guard: fitted.guard && is(asks, Contact::Guard),
        ..Inputs::NONE
    }
}
