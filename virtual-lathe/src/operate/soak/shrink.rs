//! Makes a session that fails as short as it can, within a budget: what is left out in turn is halves, quarters, ... of what
//! was done (delta debugging: A. Zeller, R. Hildebrandt, IEEE Transactions on Software Engineering 28(2), 2002), then
//! parameters; then times come closer together.

use super::oracle::Failure;
use super::session::{Line, Session};

/// A session that fails, and how.
#[derive(Clone, Debug)]
pub(super) struct Found {
    pub(super) session: Session,
    pub(super) failure: Failure,
}

/// Shrinks for as long as `run` has something to say: it gives how a session fails, or `None` where the budget is spent.
pub(super) fn shrink(found: Found, run: &mut impl FnMut(&Session) -> Option<Option<Failure>>) -> Found {
    let mut best = found;
    let rule = best.failure.rule.clone();
    // what comes after the failure has no part in it
    let tick = best.failure.tick;
    let mut cut = best.session.clone();
    cut.lines.retain(|line| line.tick <= tick);
    let mut attempt = |best: &mut Found, session: Session| -> Option<bool> {
        let failure = run(&session)?;
        match failure {
            Some(failure) if failure.rule == rule => {
                *best = Found { session, failure };
                Some(true)
            }
            _ => Some(false),
        }
    };
    let spent = (|| {
        attempt(&mut best, cut)?;
        loop {
            let before = best.session.clone();
            drop_lines(&mut best, &mut attempt)?;
            drop_parameters(&mut best, &mut attempt)?;
            draw_together(&mut best, &mut attempt)?;
            if best.session == before {
                return Some(());
            }
        }
    })();
    // a budget that is spent leaves what was reached
    let _ = spent;
    best
}

/// Leaves out parts of what was done.
fn drop_lines(best: &mut Found, attempt: &mut impl FnMut(&mut Found, Session) -> Option<bool>) -> Option<()> {
    let mut size = best.session.lines.len().div_ceil(2).max(1);
    loop {
        let mut from = 0;
        while from < best.session.lines.len() {
            let mut session = best.session.clone();
            let range = from..from + size;
            let mut at = 0;
            session.lines.retain(|line| {
                let keep = line.fixed || !range.contains(&at);
                at += 1;
                keep
            });
            if session.lines.len() == best.session.lines.len() || !attempt(best, session)? {
                from += size;
            }
        }
        if size == 1 {
            return Some(());
        }
        size = size.div_ceil(2);
    }
}

fn drop_parameters(best: &mut Found, attempt: &mut impl FnMut(&mut Found, Session) -> Option<bool>) -> Option<()> {
    let mut at = 0;
    while at < best.session.set.len() {
        let mut session = best.session.clone();
        session.set.remove(at);
        if !attempt(best, session)? {
            at += 1;
        }
    }
    Some(())
}

/// Brings times closer together, each pause to a quarter or by a little; and the beginning to the start.
fn draw_together(best: &mut Found, attempt: &mut impl FnMut(&mut Found, Session) -> Option<bool>) -> Option<()> {
    for at in 0..best.session.lines.len() {
        let Some(line) = best.session.lines.get(at) else { break };
        if line.fixed {
            continue;
        }
        let before = at.checked_sub(1).and_then(|before| best.session.lines.get(before)).map_or(0, |line| line.tick);
        let pause = line.tick - before;
        for less in [pause, pause * 3 / 4, pause / 2, pause % 1000, pause % 100] {
            if less == 0 {
                continue;
            }
            let mut session = best.session.clone();
            session.lines.iter_mut().skip(at).for_each(|line: &mut Line| line.tick -= less);
            if attempt(best, session)? {
                break;
            }
        }
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_matters_is_left() {
        let line = |tick, text: &str| Line { tick, text: text.into(), fixed: false };
        let lines = (0..100).map(|n| line(n * 50, if n == 17 || n == 60 { "bad" } else { "good" })).collect();
        let set = vec![("a".into(), "1".into()), ("b".into(), "2".into())];
        let session = Session { set, programs: Vec::new(), lines };
        let mut runs = 0;
        let mut run = |session: &Session| {
            runs += 1;
            let bad: Vec<_> = session.lines.iter().filter(|line| line.text == "bad").collect();
            let fails = bad.len() == 2 && session.set.iter().any(|(name, _)| name == "b");
            let tick = bad.last().map_or(0, |line| line.tick);
            Some(fails.then(|| Failure { tick, rule: "rule".into(), text: String::new() }))
        };
        let failure = run(&session).unwrap().unwrap();
        let found = shrink(Found { session, failure }, &mut run);
        let texts: Vec<_> = found.session.lines.iter().map(|line| (line.tick, line.text.as_str())).collect();
        assert_eq!(texts, [(0, "bad"), (0, "bad")]);
        assert_eq!(found.session.set, [("b".to_owned(), "2".to_owned())]);
        assert!(runs < 200, "{runs}");
    }
}
