//! The compile job: lines of program text in, blocks out.
//!
//! The interpreter of `feature-editor` makes actions of a line, the block builder of `interp-core` makes blocks of
//! the actions. A line with an error among its findings is refused: its blocks, if any, are not to be run. A stored
//! program is compiled twice: once to check it whole, once to run it.
//!
//! Where corners are blended (see `blend`) one feed is held back until the next action: its blocks come with a later
//! line, or by [`Compiler::flush`].

use core::fmt;

use feature_editor::codes::{
    Action, Diagnostic, Feed, Format, Interpreter, Item, Modal, Settings, Severity, SpindleCommand,
};
use interp_core::block::{ArcRefusal, Block, Builder, Limited, Output, Pace, Path, Work};
use interp_core::config::Machine;
use interp_core::curve::method::Method;
use interp_core::units::{Axis, Lattice, Point};

use super::blend::Blender;
use super::threads::{Doubt, Threads};

/// Something to say about a program.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Finding {
    /// Of the text itself.
    Text(Diagnostic),
    /// A warning: an axis can't reach the programmed feed on this block and holds it back.
    Limited {
        /// Line of the program.
        line: u32,
        /// What is left.
        limited: Limited,
    },
    /// A warning, once a program: the method that the machine asks for knows no arcs.
    NoArcs {
        /// Line of the first arc.
        line: u32,
        /// The method.
        method: Method,
    },
    /// An error: an arc that can't be walked.
    Arc {
        /// Line of the program.
        line: u32,
        /// Why.
        why: ArcRefusal,
    },
    /// Of a thread or a feed a turn.
    Thread {
        /// Line of the program.
        line: u32,
        /// What.
        doubt: Doubt,
    },
}

impl Finding {
    /// Whether the program is refused for it.
    pub fn is_error(&self) -> bool {
        match self {
            Self::Text(diagnostic) => diagnostic.severity() == Severity::Error,
            Self::Limited { .. } | Self::NoArcs { .. } => false,
            Self::Arc { .. } => true,
            Self::Thread { doubt, .. } => doubt.is_error(),
        }
    }

    /// Line of the program, from 1.
    pub const fn line(&self) -> u32 {
        match self {
            Self::Text(diagnostic) => diagnostic.line,
            Self::Limited { line, .. }
            | Self::NoArcs { line, .. }
            | Self::Arc { line, .. }
            | Self::Thread { line, .. } => *line,
        }
    }

    /// Column in the line, from 1, and length: characters. The whole line is (1, 0).
    pub const fn span(&self) -> (u32, u32) {
        match self {
            Self::Text(diagnostic) => (diagnostic.column, diagnostic.length),
            Self::Limited { .. } | Self::NoArcs { .. } | Self::Arc { .. } | Self::Thread { .. } => (1, 0),
        }
    }

    /// Writes what to do about it.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn remedy(&self, f: &mut impl fmt::Write) -> fmt::Result {
        match self {
            Self::Text(diagnostic) => write!(f, "{}", diagnostic.remedy()),
            Self::Limited { limited, .. } => {
                let axis = limited.axis.letter();
                write!(f, "program a lower F or raise {axis}.max_feed, if the machine allows it")
            }
            Self::Thread { doubt, .. } => f.write_str(doubt.remedy()),
            Self::NoArcs { .. } => f.write_str("set method to one that knows arcs, or leave it"),
            Self::Arc { why: ArcRefusal::OutOfRange, .. } => {
                f.write_str("split the arc, or move it nearer to the zero point")
            }
            Self::Arc { why: ArcRefusal::TooSmall, .. } => f.write_str("write a line in its place"),
            Self::Arc { why: ArcRefusal::NoPulse, .. } => f.write_str("correct I and K, or leave the arc out"),
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(diagnostic) => diagnostic.fmt(f),
            Self::Limited { limited, .. } => {
                let axis = match limited.axis {
                    Axis::X => 'X',
                    Axis::Z => 'Z',
                };
                // nm a tick with 12 fraction bits to um/min: 60 000 ticks, 1000 nm
                let um_per_min = u64::from(limited.speed).saturating_mul(60) / 4_096;
                let (whole, part) = (um_per_min / 1_000, um_per_min % 1_000 / 100);
                write!(f, "F is limited to {whole}.{part} mm/min by the {axis} axis in this direction")
            }
            Self::Thread { doubt, .. } => doubt.fmt(f),
            Self::NoArcs { method, .. } => {
                write!(f, "method {} knows lines only: arcs are walked by minimum deviation", method.name())
            }
            Self::Arc { why: ArcRefusal::OutOfRange, .. } => {
                f.write_str("the arc leaves the range of 2.1 m between its ends")
            }
            Self::Arc { why: ArcRefusal::TooSmall, .. } => f.write_str(
                "the arc's radius is below three pulses of the coarser axis, too small for pulses so unequal",
            ),
            Self::Arc { why: ArcRefusal::NoPulse, .. } => {
                f.write_str("an arc of more than half a turn about less than a pulse: nothing would move")
            }
        }
    }
}

/// Compiles a program line by line.
#[derive(Clone, Debug)]
pub struct Compiler {
    interpreter: Interpreter,
    builder: Builder,
    blender: Blender,
    at: Point,
    ended: bool,
    /// It was said that the method knows no arcs.
    told: bool,
    threads: Threads,
}

impl Compiler {
    /// A compiler at the start of a program.
    pub fn new(settings: Settings, format: Format, machine: &Machine) -> Self {
        let builder = Builder::new(machine, settings.start);
        let at = settings.start;
        let blender = Blender::new(machine);
        Self {
            interpreter: Interpreter::new(settings, format),
            builder,
            blender,
            at,
            ended: false,
            told: false,
            threads: Threads::default(),
        }
    }

    /// Goes on under other settings and on another machine, with the tool at rest at the settings' `start`. What is
    /// modal stays in force; a feed that is held back is forgotten.
    pub fn configure(&mut self, settings: Settings, machine: &Machine) {
        self.builder = Builder::new(machine, settings.start);
        self.blender = Blender::new(machine);
        self.at = settings.start;
        self.interpreter.configure(settings);
    }

    /// Where everything compiled so far leads, as it was programmed.
    pub const fn programmed(&self) -> Point {
        self.at
    }

    /// What is in force.
    pub const fn modal(&self) -> Modal {
        self.interpreter.modal()
    }

    /// The lattice point that everything compiled so far leads to, but for a feed that is held back.
    pub const fn lattice(&self) -> Lattice {
        self.builder.lattice()
    }

    /// Whether the program is over.
    pub const fn is_ended(&self) -> bool {
        self.ended
    }

    /// Whether a feed is held back for the corner at its end.
    pub const fn holds(&self) -> bool {
        self.blender.holds()
    }

    /// Lets the feed go out that is held back, as nothing follows for now: its end stays a sharp corner.
    pub fn flush(&mut self, emit: &mut impl FnMut(&Item, &[Block])) {
        self.blender.flush(&mut self.builder, emit);
    }

    /// Forgets the feed that is held back; the program goes on from where the one before it ended.
    pub fn forget(&mut self) {
        if self.blender.holds() {
            self.blender.forget();
            self.at = self.builder.programmed();
        }
    }

    /// Compiles one line, without its terminator. `emit` gets each action and the blocks that it makes, `report` all
    /// that there is to say. Corners come shortened and with their arcs; the last line of a program lets all go out.
    pub fn line(&mut self, text: &[u8], emit: &mut impl FnMut(&Item, &[Block]), report: &mut impl FnMut(Finding)) {
        let (builder, blender) = (&mut self.builder, &mut self.blender);
        let (at, ended) = (&mut self.at, &mut self.ended);
        let mut late = None;
        let (told, mut no_arcs) = (&mut self.told, None);
        let (threads, mut doubt) = (&mut self.threads, None);
        let mut emit = |item: &Item, blocks: &[Block]| {
            let found = threads.see(item, blocks);
            doubt = doubt.or(found.map(|doubt| Finding::Thread { line: item.line, doubt }));
            emit(item, blocks);
        };
        self.interpreter.line(
            text,
            &mut |item| {
                if matches!(item.action, Action::Arc { .. }) && builder.arcs_fall_back() && !*told {
                    *told = true;
                    no_arcs = Some(Finding::NoArcs { line: item.line, method: builder.method() });
                }
                let found = blender.take(builder, &item, *at, &mut emit);
                if let (Action::Line { end, .. } | Action::Arc { end, .. }, None | Some(Finding::Limited { .. })) =
                    (item.action, found)
                {
                    *at = end;
                }
                *ended |= matches!(item.action, Action::End);
                late = late.or(found);
            },
            &mut |diagnostic| report(Finding::Text(diagnostic)),
        );
        *ended |= self.interpreter.is_ended();
        if *ended {
            blender.flush(builder, &mut emit);
        }
        late.into_iter().chain(no_arcs).chain(doubt).for_each(report);
    }

    /// Ends the program: says what only the whole can be blamed for. The caller then lets the held feed
    /// [go out](Self::flush) and adds the end block that [`end_block`](Self::end_block) gives, where the program had
    /// none.
    pub fn finish(&mut self, report: &mut impl FnMut(Finding)) {
        self.interpreter.finish(&mut |diagnostic| report(Finding::Text(diagnostic)));
    }

    /// The block that ends a program of which it is the last line.
    pub const fn end_block(line: u32) -> Block {
        Block { line, work: Work::End }
    }
}

/// The motion of an action.
pub(super) const fn motion_of(action: &Action) -> Option<(Path, Point, Feed)> {
    match *action {
        Action::Line { end, feed } => Some((Path::Line, end, feed)),
        Action::Arc { end, centre, sense, feed } => {
            Some((Path::Arc { centre: (centre.x.nm(), centre.z.nm()), sense }, end, feed))
        }
        _ => None,
    }
}

/// Makes the blocks of one action.
pub(super) fn compile(builder: &mut Builder, item: &Item, emit: &mut impl FnMut(&Item, &[Block])) -> Option<Finding> {
    let line = item.line;
    let (path, end, feed) = match item.action {
        Action::Line { .. } | Action::Arc { .. } => motion_of(&item.action)?,
        Action::Dwell { ms } => return stand(builder, item, Work::Dwell(ms), emit),
        Action::Spindle(command) => {
            let output = match command {
                SpindleCommand::Forward => Output::SpindleForward,
                SpindleCommand::Reverse => Output::SpindleReverse,
                SpindleCommand::Stop => Output::SpindleStop,
            };
            return stand(builder, item, Work::Output(output), emit);
        }
        Action::SpindleSpeed(speed) => {
            return stand(builder, item, Work::Output(Output::SpindleSpeed(speed.milli_rpm())), emit);
        }
        Action::Tool { number, offset } => {
            return stand(builder, item, Work::Output(Output::Tool(number, offset)), emit);
        }
        Action::Stop => return stand(builder, item, Work::Stop, emit),
        Action::OptionalStop => return stand(builder, item, Work::OptionalStop, emit),
        Action::End => return stand(builder, item, Work::End, emit),
    };
    let pace = match feed {
        Feed::Rapid => Pace::Rapid,
        Feed::PerMinute(feed) => Pace::Feed(feed),
        Feed::PerTurn(lead) => Pace::PerTurn(lead),
        Feed::Thread { lead, start } => Pace::Thread { lead, start },
    };
    let built = builder.motion(path, end, pace);
    if let Some(why) = built.refused {
        return Some(Finding::Arc { line, why });
    }
    let mut blocks = heapless::Vec::<Block, 2>::new();
    for motion in &built.motions {
        // at most two motions a curve: the capacity
        let _ = blocks.push(Block { line, work: Work::Motion(*motion) });
    }
    emit(item, &blocks);
    built.limited.map(|limited| Finding::Limited { line, limited })
}

/// A block at which the tool stands.
fn stand(builder: &mut Builder, item: &Item, work: Work, emit: &mut impl FnMut(&Item, &[Block])) -> Option<Finding> {
    builder.standstill();
    emit(item, &[Block { line: item.line, work }]);
    None
}
