//! Lines of programs: compiled on trial, and taken only whole.

use core::fmt::Write;

use feature_editor::codes::{Action, Item, SpindleCommand};
use heapless::Deque;
use interp_core::block::{Block, Work};
use interp_core::config::Machine;
use interp_core::units::Point;

use super::refusal::{Place, Refusal};
use super::{BLOCKS_PER_LINE, Link, Snapshot, reply};
use crate::background::compile::{Compiler, Finding};

/// Spindle and tool as programmed; what was compiled, not what is executed.
#[derive(Copy, Clone, Debug, Default)]
pub(super) struct Accessories {
    pub(super) spindle: Option<SpindleCommand>,
    pub(super) milli_rpm: u32,
    pub(super) tool: u16,
}

impl Accessories {
    const fn note(&mut self, action: &Action) {
        match action {
            Action::Spindle(command) => self.spindle = Some(*command),
            Action::SpindleSpeed(speed) => self.milli_rpm = speed.milli_rpm(),
            Action::Tool { number, .. } => self.tool = *number,
            Action::Line { .. }
            | Action::Arc { .. }
            | Action::Dwell { .. }
            | Action::Stop
            | Action::OptionalStop
            | Action::End => {}
        }
    }

    /// Letter in the status report.
    pub(super) const fn letters(&self) -> &'static str {
        match self.spindle {
            Some(SpindleCommand::Forward) => "S",
            Some(SpindleCommand::Reverse) => "C",
            Some(SpindleCommand::Stop) | None => "",
        }
    }
}

impl Link {
    /// Compiles a line of a program.
    pub(super) fn program(&mut self, text: &[u8], out: &mut impl Write) -> Result<(), Refusal> {
        let (mut compiler, mut accessories) = (self.compiler.clone(), self.accessories);
        let mut made = Deque::<Block, BLOCKS_PER_LINE>::new();
        let mut found: Option<Finding> = None;
        let mut emit = |item: &Item, blocks: &[Block]| {
            accessories.note(&item.action);
            for block in blocks {
                // cannot fail: room for as many as a line makes at most
                let _ = made.push_back(*block);
            }
        };
        compiler.line(text, &mut emit, &mut |finding| {
            // the first error, or the first warning where there is none
            let key = |finding: &Finding| (!finding.is_error(), finding.span().0);
            if found.as_ref().is_none_or(|known| key(&finding) < key(known)) {
                found = Some(finding);
            }
        });
        if let Some(finding) = found {
            if finding.is_error() {
                // the line counts, but nothing in it: an empty one in its place
                self.compiler.line(b"", &mut |_, _| {}, &mut |_| {});
                return Err(Refusal::Program(finding));
            }
            self.message(out, format_args!("{}", Place(finding)));
        }
        self.begun |= !made.is_empty() || compiler.holds();
        self.busy |= compiler.holds();
        if compiler.is_ended() {
            let ends = made.back().is_some_and(|block| matches!(block.work, Work::End));
            if self.begun && !ends {
                // a closing % ends the program as M30 does; it makes no other block, so there is room
                let _ = made.push_back(Compiler::end_block(0));
            }
            compiler = self.fresh(compiler.programmed());
            self.begun = false;
        }
        self.compiler = compiler;
        self.accessories = accessories;
        self.pending = made;
        self.owes_ok = true;
        Ok(())
    }

    /// Lets the feed go out that the compiler holds back.
    pub(super) fn let_go(&mut self) {
        let pending = &mut self.pending;
        self.compiler.flush(&mut |_, blocks| {
            for block in blocks {
                // cannot fail: it is empty, and a feed makes two blocks at most
                let _ = pending.push_back(*block);
            }
        });
    }

    /// A compiler at the start of a program.
    pub(super) fn fresh(&self, at: Point) -> Compiler {
        let mut settings = self.parameters.settings();
        settings.start = at;
        Compiler::new(settings, self.format, &self.machine)
    }

    /// Where the program's place is, to the nanometre: as programmed, if it is there. What handwheels and wear add to it
    /// stays beside the program.
    pub(super) fn present(&self, machine: &Machine, snapshot: &Snapshot) -> Option<Point> {
        let (at, same) = (snapshot.programmed, *machine == self.machine);
        if same && at == self.compiler.lattice() {
            return Some(self.compiler.programmed());
        }
        Some(Point { x: reply::length(machine.x.pulse, at.x)?, z: reply::length(machine.z.pulse, at.z)? })
    }

    /// Where something else than the program has moved the tool, the program goes on from where it is.
    pub(super) fn follow(&mut self, idle: bool, snapshot: &Snapshot) -> Result<(), Refusal> {
        if self.lost || (idle && snapshot.programmed != self.compiler.lattice()) {
            let mut settings = self.parameters.settings();
            settings.start = self.present(&self.machine, snapshot).ok_or(Refusal::Position)?;
            self.compiler.configure(settings, &self.machine);
            self.lost = false;
        }
        Ok(())
    }
}
