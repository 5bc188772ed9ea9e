//! The words of one block, each letter once, with the codes that stop the program or turn the spindle.
//!
//! Both formats gather their lines here; what differs is which letters and G codes they have.

use heapless::Vec;

use super::diagnostic::{Diagnostic, DiagnosticKind, Report};
use super::item::{Action, SpindleCommand};
use super::word::Placed;

/// Letters with a value that a block can have: N O F S T X Z U W I K R P Q.
const LETTERS: usize = 14;
/// Largest N and O.
const MAX_BLOCK_NUMBER: u32 = 99_999_999;

/// Words of a block.
#[derive(Debug, Default)]
pub(crate) struct Words {
    values: Vec<Placed, LETTERS>,
    /// M0, M1, M2, M30.
    pub(crate) stop: Option<(Action, Placed)>,
    /// M3, M4, M5.
    pub(crate) spindle: Option<(Action, Placed)>,
}

impl Words {
    /// Word with this letter.
    pub(crate) fn get(&self, letter: char) -> Option<Placed> {
        self.values.iter().copied().find(|placed| placed.word.letter == letter)
    }

    /// First of these letters that the block has, in the order of `letters`.
    pub(crate) fn first_of(&self, letters: &[char]) -> Option<Placed> {
        letters.iter().find_map(|&letter| self.get(letter))
    }

    /// Keeps a word, unless its letter is there already.
    pub(crate) fn keep(&mut self, placed: Placed, report: &mut Report<'_, impl FnMut(Diagnostic)>) {
        if let Some(first) = self.get(placed.word.letter) {
            let (first, second) = (first.word, placed.word);
            report.tell(placed.span, DiagnosticKind::Repeated { first, second });
        } else {
            // cannot be full: one place for each letter of a format
            let _ = self.values.push(placed);
        }
    }

    /// Keeps an M code.
    pub(crate) fn machine(&mut self, placed: Placed, report: &mut Report<'_, impl FnMut(Diagnostic)>) {
        let (slot, action) = match placed.word.number.code() {
            Some(0) => (&mut self.stop, Action::Stop),
            Some(1) => (&mut self.stop, Action::OptionalStop),
            Some(2 | 30) => (&mut self.stop, Action::End),
            Some(3) => (&mut self.spindle, Action::Spindle(SpindleCommand::Forward)),
            Some(4) => (&mut self.spindle, Action::Spindle(SpindleCommand::Reverse)),
            Some(5) => (&mut self.spindle, Action::Spindle(SpindleCommand::Stop)),
            _ => return report.tell(placed.span, DiagnosticKind::UnknownM(placed.word)),
        };
        match *slot {
            Some((_, first)) => report.tell(placed.span, exclude(first, placed)),
            None => *slot = Some((action, placed)),
        }
    }

    /// Whether this block ends the program.
    pub(crate) fn ends(&self) -> bool {
        matches!(self.stop, Some((Action::End, _)))
    }
}

/// Two codes of one group.
pub(crate) const fn exclude(first: Placed, second: Placed) -> DiagnosticKind {
    DiagnosticKind::SameGroup { first: first.word, second: second.word }
}

/// Checks an N or O word.
pub(crate) fn check_block_number(placed: Placed, report: &mut Report<'_, impl FnMut(Diagnostic)>) {
    if placed.word.number.code().is_none_or(|number| number > MAX_BLOCK_NUMBER) {
        report.tell(placed.span, DiagnosticKind::BlockNumber(placed.word));
    }
}
