//! Alarms: told once, then the link is locked until `$X`.

use core::fmt::Write;

use super::outbox::Settling;
use super::program::Accessories;
use super::refusal::Refusal;
use super::{Link, Snapshot};

impl Link {
    /// Tells a new alarm. The line whose blocks still waited is refused: what it was to follow is forgotten.
    pub(super) fn tell_alarm(&mut self, snapshot: &Snapshot, out: &mut impl Write) {
        let before = core::mem::replace(&mut self.alarm, snapshot.alarm);
        let Some(alarm) = snapshot.alarm.filter(|alarm| before != Some(*alarm)) else { return };
        self.held = false;
        self.compiler.forget();
        self.outbox.flow = None;
        self.accessories = Accessories::default();
        let doubt = if alarm.keeps_position() { "" } else { "; the position is unverified" };
        self.message(out, format_args!("{alarm}{doubt}"));
        self.say(out, format_args!("ALARM:{}", alarm.number()));
        let waited = !self.pending.is_empty();
        self.pending.clear();
        if self.owes_ok && waited {
            self.owes_ok = false;
            self.refuse(&Refusal::Locked(alarm), out);
        }
    }

    /// `$X`: asks the foreground to leave the alarm; answered by [`unlocked`](Self::unlocked).
    pub(super) fn unlock(&mut self, idle: bool) -> Result<(), Refusal> {
        if self.alarm.is_none() {
            self.owes_ok = true;
            return Ok(());
        }
        if !idle {
            return Err(Refusal::NotIdle);
        }
        self.outbox.unlock = true;
        self.unlocking = true;
        self.settling = Settling::Sent;
        Ok(())
    }

    /// Answers `$X` once the foreground has decided; true if it has.
    pub(super) fn unlocked(&mut self, snapshot: &Snapshot, out: &mut impl Write) -> bool {
        if self.settling != Settling::Settled {
            return false;
        }
        self.unlocking = false;
        if let Some(alarm) = snapshot.alarm {
            self.refuse(&Refusal::Lasting(alarm), out);
            return true;
        }
        self.start_over(snapshot);
        self.message(out, format_args!("Caution: Unlocked"));
        self.owes_ok = true;
        true
    }
}
