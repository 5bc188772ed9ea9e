//! Keys and the guard of a board's panel, with a sender's program under way.

use super::*;
use crate::background::keys::Pressed;
use crate::foreground::panel::{Contact, Panel, Turned, Wiring};

/// A board: contact n is bit n.
struct Board {
    bench: Bench,
    panel: Panel,
    pressed: Pressed,
}

impl Board {
    fn new() -> Self {
        let bit = |contact: Contact| 1 << contact as u8;
        let wiring = Contact::ALL.into_iter().fold(Wiring::NONE, |wiring, contact| wiring.with(contact, bit(contact)));
        Self { bench: Bench::new(), panel: Panel::new(wiring), pressed: Pressed::new() }
    }

    /// Ticks as a board has them, with this contact asking.
    fn ticks(&mut self, asking: Option<Contact>, ticks: u32) {
        let opens = 0b11_1110_0000_0000;
        // contacts that close are low when they ask, those that open are low when they do not
        let levels = !opens ^ asking.map_or(0, |contact| 1 << contact as u8);
        for _ in 0..ticks {
            let keys = self.panel.serve(levels, &Turned::default(), &mut self.bench.foreground);
            self.pressed.mark(keys);
            while let Some(what) = self.pressed.take() {
                let Bench { link, commands, snapshot, out, .. } = &mut self.bench;
                link.realtime(what, commands, snapshot, out);
            }
            self.bench.tick();
        }
    }
}

const TO_Z1: Lattice = Lattice { x: 0, z: 400 };

#[test]
fn a_program_that_came_while_the_guard_was_open_begins_with_a_start_and_not_with_the_guard() {
    let mut board = Board::new();
    board.ticks(Some(Contact::Guard), 50);
    board.bench.send("G1 Z1 F600\nM30\n");
    board.ticks(Some(Contact::Guard), 500);
    board.ticks(None, 1_000);
    assert_eq!(board.bench.counted, Lattice::default());
    board.ticks(Some(Contact::Start), 50);
    board.ticks(None, 1_000);
    assert_eq!(board.bench.counted, TO_Z1);
}

#[test]
fn with_the_guard_closed_all_along_a_program_begins_by_itself() {
    let mut board = Board::new();
    board.bench.send("G1 Z1 F600\nM30\n");
    board.ticks(None, 1_500);
    assert_eq!(board.bench.counted, TO_Z1);
}

#[test]
fn a_held_program_goes_on_with_the_start_key_from_where_it_was() {
    let mut board = Board::new();
    board.bench.send("G1 Z1 F600\nM30\n");
    board.ticks(None, 60);
    board.ticks(Some(Contact::Hold), 20);
    board.ticks(None, 1_000);
    let held = board.bench.counted;
    assert!(held.z > 0 && held.z < TO_Z1.z, "{held:?}");
    assert!(board.bench.status().starts_with("Hold:0"), "{}", board.bench.status());
    board.ticks(Some(Contact::Start), 3);
    board.ticks(None, 1_500);
    assert_eq!(board.bench.counted, TO_Z1);
}

#[test]
fn behind_a_reset_key_nothing_of_the_program_goes_on_and_the_next_one_begins_where_the_tool_is() {
    let mut board = Board::new();
    let lines: String = (1..60).map(|n| std::format!("G1 Z{n} F600\n")).collect();
    board.bench.send(&lines[..500]);
    board.ticks(None, 500);
    assert!(board.bench.counted.z > 0);
    board.ticks(Some(Contact::Reset), 3);
    board.ticks(None, 2_000);
    let stands = board.bench.counted;
    assert!(board.bench.status().starts_with("Idle"), "{}", board.bench.status());
    board.ticks(None, 2_000);
    assert_eq!(board.bench.counted, stands);
    board.bench.send("G91 G1 Z1 F600\nM30\n");
    board.ticks(None, 2_000);
    assert_eq!(board.bench.counted.z, stands.z + TO_Z1.z);
}
