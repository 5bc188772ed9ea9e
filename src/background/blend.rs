//! Corner blends: between the interpreter's actions and the block builder.
//!
//! Under G64 a feed is held back until the next action. Is that a feed under G64, too, the arc of
//! [`interp_core::blend`] takes the corner's place, and the second one is held back in turn; anything else, and the held
//! feed goes out first, as it was programmed. What goes out is items again: a shortened feed, an arc, a shortened feed.
//! The arc bears the line of the feed that it leads into, and the smaller feed of both. Without G64 every action
//! passes at once.
//!
//! Under G61.1 a motion is followed by a dwell of a tick, so that it ends in standstill. Feeds a turn and threads pass as
//! they are: what follows the spindle has no feed that an arc could be found for.

use feature_editor::codes::{Action, Centre, Distance, Feed, Item, PathControl};
use interp_core::blend::{Allowance, Blend, Corners, Segment};
use interp_core::block::{Block, Builder, Path};
use interp_core::config::{Machine, speed_of};
use interp_core::units::{Feedrate, Length, Point};

use super::compile::{Finding, compile, motion_of};

/// A feed that waits for what comes next.
#[derive(Copy, Clone, Debug)]
struct Held {
    line: u32,
    control: PathControl,
    /// As programmed.
    segment: Segment,
    feed: Feedrate,
    /// How far its corners may be left; `None` as far as the feed needs.
    tolerance: Option<Length>,
}

impl Held {
    fn new(item: &Item, from: Point) -> Option<Self> {
        let PathControl::Blend { tolerance } = item.control else { return None };
        let (path, end, Feed::PerMinute(feed)) = motion_of(&item.action)? else { return None };
        let segment = Segment { start: from, end, path };
        Some(Self { line: item.line, control: item.control, segment, feed, tolerance })
    }

    /// What goes out, up to `end`.
    fn item(&self, end: Point) -> Item {
        Item { line: self.line, action: action(self.segment.path, end, self.feed), control: self.control }
    }
}

fn action(path: Path, end: Point, feed: Feedrate) -> Action {
    let feed = Feed::PerMinute(feed);
    match path {
        Path::Line => Action::Line { end, feed },
        Path::Arc { centre: (x, z), sense } => {
            Action::Arc { end, centre: Centre { x: Distance::from_nm(x), z: Distance::from_nm(z) }, sense, feed }
        }
    }
}

/// A corner about to be blended.
struct Corner {
    first: Item,
    arc: Item,
    second: Held,
}

/// Holds one feed back.
#[derive(Clone, Debug)]
pub(super) struct Blender {
    corners: Corners,
    held: Option<Held>,
}

impl Blender {
    pub(super) fn new(machine: &Machine) -> Self {
        Self { corners: Corners::new(machine), held: None }
    }

    /// Whether a feed waits.
    pub(super) const fn holds(&self) -> bool {
        self.held.is_some()
    }

    /// Forgets the feed that waits.
    pub(super) fn forget(&mut self) {
        self.held = None;
    }

    /// Lets the feed that waits go out.
    pub(super) fn flush(&mut self, builder: &mut Builder, emit: &mut impl FnMut(&Item, &[Block])) {
        if let Some(held) = self.held.take() {
            // what there is to say was said when it came
            let _ = compile(builder, &held.item(held.segment.end), emit);
        }
    }

    /// Takes an action; `from` is where the tool is then, as programmed.
    pub(super) fn take(
        &mut self,
        builder: &mut Builder,
        item: &Item,
        from: Point,
        emit: &mut impl FnMut(&Item, &[Block]),
    ) -> Option<Finding> {
        let next = Held::new(item, from).filter(|next| next.segment.start != next.segment.end || is_arc(next));
        let Some(next) = next else {
            self.flush(builder, emit);
            return pass(builder, item, emit);
        };
        // as programmed: what is wrong with it is told with its own line
        let corner = self.held.and_then(|held| self.corner(&held, &next, builder));
        let second = match corner {
            Some(Corner { first, arc, second }) => {
                let _ = compile(builder, &first, emit);
                let _ = compile(builder, &arc, emit);
                second
            }
            None => {
                self.flush(builder, emit);
                next
            }
        };
        let found = compile(&mut builder.clone(), &second.item(second.segment.end), &mut |_, _| {});
        self.held = (!matches!(found, Some(Finding::Arc { .. }))).then_some(second);
        found
    }

    /// The blend of two feeds, if there is one whose parts can all be built.
    fn corner(&self, held: &Held, next: &Held, builder: &Builder) -> Option<Corner> {
        let feed = held.feed.min(next.feed);
        let allowed = match (held.tolerance, next.tolerance) {
            (Some(one), Some(other)) => Allowance::Within(one.min(other)),
            (Some(one), None) | (None, Some(one)) => Allowance::Within(one),
            (None, None) => Allowance::Keeping(speed_of(feed)),
        };
        let Blend { from, to, centre, sense, paths: [before, behind] } =
            self.corners.blend(&held.segment, &next.segment, allowed)?;
        let first = Held { segment: Segment { path: before, ..held.segment }, ..*held }.item(from);
        let second = Held { segment: Segment { path: behind, ..next.segment }, ..*next };
        let arc = Item { action: action(Path::Arc { centre, sense }, to, feed), ..next.item(to) };
        let mut trial = builder.clone();
        let parts = [first, arc, second.item(second.segment.end)];
        let good =
            parts.iter().all(|part| !matches!(compile(&mut trial, part, &mut |_, _| {}), Some(Finding::Arc { .. })));
        good.then_some(Corner { first, arc, second })
    }
}

const fn is_arc(held: &Held) -> bool {
    matches!(held.segment.path, Path::Arc { .. })
}

/// Compiles an action that nothing blends.
fn pass(builder: &mut Builder, item: &Item, emit: &mut impl FnMut(&Item, &[Block])) -> Option<Finding> {
    // threads that follow one another are one cut
    let stops = motion_of(&item.action).is_some_and(|(_, _, feed)| !matches!(feed, Feed::Thread { .. }));
    if item.control != PathControl::Stop || !stops {
        return compile(builder, item, emit);
    }
    let mut moves = false;
    let found = compile(builder, item, &mut |item, blocks| {
        moves = !blocks.is_empty();
        emit(item, blocks);
    });
    if moves {
        let stand = Item { action: Action::Dwell { ms: 1 }, ..*item };
        let _ = compile(builder, &stand, emit);
    }
    found
}
