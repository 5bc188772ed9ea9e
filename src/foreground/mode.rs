//! Modes of operation, and what may be asked for in each.
//!
//! [`refusal`] is the whole state machine: a pure function of what is asked for and the [`Situation`]. A request that it
//! refuses changes nothing. The book has it as a table and a drawing.

use super::alarm::Alarm;
use super::command::Command;
use super::refusal::Refusal;
use interp_core::channel::State;

/// Modes of operation.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// The handwheels move the slides.
    Handwheel,
    /// The joystick moves a slide, or both along a contour, at a feed.
    Power,
    /// The contour wheel moves both slides along a contour.
    Linked,
    /// A program runs.
    #[default]
    Automatic,
    /// One line of a program, typed, runs.
    ManualData,
    /// An axis finds its home switch.
    Homing,
    /// The contour wheel runs the program back and forth.
    Retrace,
}

impl Mode {
    /// All modes, in the order of the operator's switch.
    pub const ALL: [Self; 7] =
        [Self::Handwheel, Self::Power, Self::Linked, Self::Automatic, Self::ManualData, Self::Homing, Self::Retrace];

    /// Its name, as scenarios and the panel have it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Handwheel => "handwheel",
            Self::Power => "power",
            Self::Linked => "linked",
            Self::Automatic => "auto",
            Self::ManualData => "mdi",
            Self::Homing => "home",
            Self::Retrace => "retrace",
        }
    }

    /// The mode of a name.
    pub fn of(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|mode| mode.name() == name)
    }

    /// Whether a program's blocks are taken from the background.
    pub(super) const fn runs_programs(self) -> bool {
        matches!(self, Self::Linked | Self::Automatic | Self::ManualData | Self::Retrace)
    }
}

/// What a request meets.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Situation {
    /// The mode.
    pub mode: Mode,
    /// What the channel does.
    pub state: State,
    /// Anything moves, or is about to.
    pub moves: bool,
    /// A handwheel's axis moves, or is about to.
    pub hands: bool,
    /// Cycle start was given and waits for the handwheels.
    pub starting: bool,
    /// A path of the machine's own (a contour, a power feed) is in the channel, not a program.
    pub own_path: bool,
    /// Why the machine is locked.
    pub alarm: Option<Alarm>,
    /// The emergency input is open.
    pub open: bool,
    /// The guard is open, or something else inhibits cycle start.
    pub guard: bool,
    /// The motors' drivers are on.
    pub motors: bool,
    /// Where the tool is, is known: of both axes.
    pub verified: bool,
    /// There is something to return from: a power feed was made.
    pub cut: bool,
    /// That was a thread by lever: the tool may stand in its groove.
    pub threaded: bool,
    /// A shoulder stop is set, or a contour entered, which has an end.
    pub stop: bool,
    /// The position that a re-entry needs was kept.
    pub kept: bool,
    /// A thread is being cut.
    pub thread: bool,
}

impl Situation {
    /// Whether a program is under way: begun and neither ended nor reset.
    pub(super) const fn in_cycle(&self) -> bool {
        !self.own_path && !matches!(self.state, State::Idle | State::Ended)
    }

    /// Whether the program's path stands, so that something else may take it over.
    const fn stands(&self) -> bool {
        !self.moves && matches!(self.state, State::Holding | State::Stopped)
    }
}

/// Why a request is refused; `None` where it is obeyed.
pub fn refusal(command: &Command, now: &Situation) -> Option<Refusal> {
    let Situation { mode, .. } = *now;
    match command {
        Command::Mode(to) => to_mode(*to, now),
        Command::Start => start(now),
        Command::Hold if matches!(now.state, State::Running | State::Filling) => None,
        Command::Hold => Some(Refusal::NothingToHold),
        Command::Unlock if now.alarm.is_none() => Some(Refusal::NoAlarm),
        Command::Unlock if now.open => Some(Refusal::EmergencyOpen),
        Command::Unlock => at_rest(now),
        // these only say how; nothing begins
        Command::Reset
        | Command::FeedOverride(_)
        | Command::RapidOverride(_)
        | Command::SpindleOverride(_)
        | Command::OptionalStop(_)
        | Command::SingleBlock(_)
        | Command::Scale(_)
        | Command::FeedRate(_) => None,
        // a feed under way has the stops that it began with
        Command::StopAt(..) if matches!(mode, Mode::Power | Mode::Linked) => at_rest(now),
        Command::StopAt(..) => None,
        Command::DryRun(_) | Command::MachineLock(_) | Command::Configure(_) | Command::Settle(_) => free(now),
        Command::Zero(..) => free(now).or(locked(now)),
        Command::ConfirmPosition => at_rest(now).or(locked(now)).or(powered(now)),
        Command::Motors(_) => at_rest(now),
        Command::Home(_) if !matches!(mode, Mode::Homing) => Some(Refusal::WrongMode(Mode::Homing)),
        Command::Home(_) => locked(now).or(powered(now)).or(free(now)),
        Command::Contour(_) => free(now),
        Command::Return | Command::Repeat(_) if !matches!(mode, Mode::Power) => Some(Refusal::WrongMode(Mode::Power)),
        Command::Return if now.threaded => Some(Refusal::InGroove),
        Command::Return if !now.cut => Some(Refusal::NothingToReturnFrom),
        Command::Return => locked(now).or(guarded(now)).or(powered(now)).or(at_rest(now)),
        Command::Repeat(1..) if !now.stop => Some(Refusal::NoStop),
        Command::Repeat(_) => at_rest(now),
        Command::KeepOffset | Command::BookWear => now.hands.then_some(Refusal::Moving),
        Command::NullOffset if now.thread => Some(Refusal::InThread),
        // homing moves an axis by the same hand
        Command::NullOffset if matches!(mode, Mode::Homing) => locked(now).or(powered(now)).or(at_rest(now)),
        Command::NullOffset => locked(now).or(powered(now)),
        Command::Lever(false) => None,
        Command::Lever(true) if !matches!(mode, Mode::Power) => Some(Refusal::WrongMode(Mode::Power)),
        Command::Lever(true) => locked(now).or(guarded(now)).or(powered(now)).or(free(now)),
        Command::PickUp(_) => free(now),
        Command::Spindle(speed) if *speed != 0 => locked(now).or(guarded(now)),
        Command::Spindle(_) => None,
        Command::Resume if !now.kept => Some(Refusal::NothingToResume),
        Command::Resume if !matches!(mode, Mode::Automatic) => Some(Refusal::WrongMode(Mode::Automatic)),
        Command::Resume => free(now).or(start(now)),
    }
}

/// A change of mode: at rest, and not away from a program under way but to run it back.
fn to_mode(to: Mode, now: &Situation) -> Option<Refusal> {
    if to == now.mode {
        return None;
    }
    if now.moves {
        return Some(Refusal::Moving);
    }
    let there_and_back = matches!((now.mode, to), (Mode::Automatic, Mode::Retrace) | (Mode::Retrace, Mode::Automatic));
    match (there_and_back, to) {
        // the spindle drives a thread whatever the mode, and goes on with it where the path goes on
        (true, _) if now.thread => Some(Refusal::InThread),
        (true, _) if now.stands() || matches!(now.mode, Mode::Retrace) => None,
        (true, _) | (false, Mode::Retrace) => Some(Refusal::NothingToRetrace),
        (false, _) if now.in_cycle() => Some(Refusal::CycleUnderWay),
        (false, _) => None,
    }
}

/// Cycle start.
fn start(now: &Situation) -> Option<Refusal> {
    let goes_on = matches!(now.state, State::Holding | State::Stopped);
    let mode = match now.mode {
        Mode::Automatic | Mode::ManualData | Mode::Linked => None,
        // an output or a programmed stop on the way
        Mode::Retrace if goes_on => None,
        Mode::Handwheel | Mode::Power | Mode::Homing | Mode::Retrace => Some(Refusal::WrongMode(Mode::Automatic)),
    };
    let runs = matches!(now.state, State::Running | State::Filling | State::Resetting) || now.starting;
    locked(now)
        .or(mode)
        .or(runs.then_some(Refusal::Running))
        .or(guarded(now))
        .or(powered(now))
        .or((!now.verified).then_some(Refusal::Unverified))
}

fn locked(now: &Situation) -> Option<Refusal> {
    now.alarm.map(Refusal::Alarm)
}

fn guarded(now: &Situation) -> Option<Refusal> {
    now.guard.then_some(Refusal::GuardOpen)
}

fn powered(now: &Situation) -> Option<Refusal> {
    (!now.motors).then_some(Refusal::MotorsOff)
}

fn at_rest(now: &Situation) -> Option<Refusal> {
    now.moves.then_some(Refusal::Moving)
}

/// At rest, and no program under way.
fn free(now: &Situation) -> Option<Refusal> {
    at_rest(now).or(now.in_cycle().then_some(Refusal::CycleUnderWay))
}
