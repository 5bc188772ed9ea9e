//! Threads and feeds a turn.

use super::*;
use DiagnosticKind as K;
use interp_core::drive::gearing::Lead;

fn turn(nm: u64) -> Lead {
    Lead::new(nm, 1).unwrap()
}

/// Feeds of the motions of a good program.
fn feeds(program: &str) -> Vec<Feed> {
    let feed = |action| match action {
        Action::Line { feed, .. } | Action::Arc { feed, .. } => Some(feed),
        _ => None,
    };
    actions(program).into_iter().filter_map(feed).collect()
}

#[test]
fn a_thread_has_the_lead_of_the_axis_that_goes_farther() {
    let thread = |nm, start| Feed::Thread { lead: turn(nm), start };
    assert_eq!(actions("G33 Z-20 K1.5"), [Action::Line { end: at(0, -20_000), feed: thread(1_500_000, 0) }]);
    assert_eq!(
        feeds("G33 X-20 I2\nX-10 Z10 I1\nX-9 Z11 K1"),
        [2_000_000, 1_000_000, 1_000_000].map(|nm| thread(nm, 0))
    );
    assert_eq!(feeds("G20 G33 W-1 K0.05"), [thread(1_270_000, 0)]);
    // a diameter is no lead: I stays a radius
    assert_eq!(feeds("G7 G33 X-20 I2"), [thread(2_000_000, 0)]);
}

#[test]
fn the_lead_of_g32_is_f_and_stays_in_force_for_threads_alone() {
    let thread = |nm| Feed::Thread { lead: turn(nm), start: 0 };
    let minute = Feed::PerMinute(per_minute(80));
    assert_eq!(
        feeds("F80 G1 Z1\nG32 Z-5 F1.5\nZ-6 F2\nG1 Z0\nG32 Z-5"),
        [minute, thread(1_500_000), thread(2_000_000), minute, thread(2_000_000)]
    );
}

#[test]
fn q_is_thousandths_of_a_degree_behind_the_index() {
    // 65536 / 360000 of a part, by hand
    for (q, start) in
        [("0", 0), ("180000", 32_768), ("120000", 21_845), ("240000", 43_691), ("360000", 0), ("359999", 0)]
    {
        let program = format!("G33 Z-20 K3 Q{q}");
        assert_eq!(feeds(&program), [Feed::Thread { lead: turn(3_000_000), start }], "{q}");
    }
    // and not modal
    assert_eq!(feeds("G33 Z-20 K3 Q90000\nZ-30 K3")[1], Feed::Thread { lead: turn(3_000_000), start: 0 });
}

#[test]
fn a_feed_a_turn_is_f_under_g95_and_is_forgotten_with_it() {
    let minute = Feed::PerMinute(per_minute(80));
    let per_turn = Feed::PerTurn(turn(250_000));
    assert_eq!(
        feeds("F80 G1 Z1\nG95 F0.25 Z2\nG0 Z3\nG1 Z4\nG2 X5 Z9 R9\nG94 G1 F80 Z3"),
        [minute, per_turn, Feed::Rapid, per_turn, per_turn, minute]
    );
    assert_eq!(feeds("F80\nG94 G1 Z3"), [minute]);
    assert_eq!(feeds("G20 G95 F0.01 G1 Z1"), [Feed::PerTurn(turn(254_000))]);
    let mut interpreter = Interpreter::new(settings(), Format::Gcode);
    interpreter.line(b"G95 F0.25 G1 Z2", &mut |_| {}, &mut |_| {});
    let modal = interpreter.modal();
    assert_eq!((modal.per_turn, modal.feed, modal.feed_per_turn), (true, None, Some(turn(250_000))));
    assert_eq!(one("F80\nG95 G1 Z1"), (5, 2, K::FeedPerTurnMissing(word("G1"))));
    assert_eq!(one("G95 F1 G1 Z1\nG94 Z2"), (5, 2, K::FeedMissing(word("Z2"))));
    assert_eq!(one("G94 G95"), (5, 3, K::SameGroup { first: word("G94"), second: word("G95") }));
}

#[test]
fn a_wrong_lead_is_refused_by_name() {
    assert_eq!(one("G33 Z-5"), (1, 3, K::LeadMissing(word("G33"))));
    assert_eq!(one("G32 Z-5"), (1, 3, K::LeadMissing(word("G32"))));
    // a feed a minute is no lead
    assert_eq!(one("G1 F80 Z1\nG32 Z-5"), (1, 3, K::LeadMissing(word("G32"))));
    assert_eq!(one("G33 Z-5 K1\nZ-6"), (1, 3, K::LeadMissing(word("Z-6"))));
    for text in ["K0", "K-1", "K0.0000001"] {
        assert_eq!(
            one(&format!("G33 Z-5 {text}")),
            (9, u32::try_from(text.len()).unwrap(), K::LeadNotPositive(word(text)))
        );
    }
    assert_eq!(one("G32 Z-5 F0"), (9, 2, K::LeadNotPositive(word("F0"))));
    assert_eq!(one("G95 F-1"), (5, 3, K::LeadNotPositive(word("F-1"))));
    for text in ["K500.000001", "K999999999999999999"] {
        assert_eq!(
            one(&format!("G33 Z-5 {text}")),
            (9, u32::try_from(text.len()).unwrap(), K::LeadTooLarge(word(text)))
        );
    }
    assert_eq!(one("G95 F600"), (5, 4, K::LeadTooLarge(word("F600"))));
    assert_eq!(one("G33 Z-5 I1 K2"), (12, 2, K::LeadTwice { x: word("I1"), z: word("K2") }));
    assert_eq!(one("G33 Z-5 X4 I1"), (12, 2, K::LeadOfOtherAxis { word: word("I1"), axis: Axis::Z }));
    assert_eq!(one("G33 Z-4 X5 K1"), (12, 2, K::LeadOfOtherAxis { word: word("K1"), axis: Axis::X }));
    assert_eq!(one("G32 Z-5 F1 K1"), (12, 2, K::LeadWithG32(word("K1"))));
    assert_eq!(one("G33 Z-5 K1 F80"), (12, 3, K::FeedWithThread(word("F80"))));
}

#[test]
fn a_thread_is_a_line_that_goes_somewhere() {
    assert_eq!(one("G0 Z5\nG33 Z5 K1"), (1, 3, K::ThreadEmpty(word("G33"))));
    assert_eq!(one("G33 K1"), (1, 3, K::EndMissing(word("G33"))));
    assert_eq!(one("G33 Z-5 K1\nK2"), (1, 2, K::EndMissing(word("K2"))));
    assert_eq!(one("G33 Z-5 K1 R9"), (12, 2, K::ArcWordUnused(word("R9"))));
    // an arc is none
    assert_eq!(found("G2 G33 Z-5 K1")[0].3, K::SameGroup { first: word("G2"), second: word("G33") });
}

#[test]
fn a_wrong_start_is_refused_by_name() {
    for text in ["Q-1", "Q360001", "Q180.5", "Q180000."] {
        assert_eq!(
            one(&format!("G33 Z-5 K1 {text}")),
            (12, u32::try_from(text.len()).unwrap(), K::ThreadStart(word(text)))
        );
    }
    assert_eq!(one("G0 Z5 Q1"), (7, 2, K::ThreadStartUnused(word("Q1"))));
    assert_eq!(one("Q90000"), (1, 6, K::ThreadStartUnused(word("Q90000"))));
    let (actions, found) = run_with(settings(), Format::Gcode, "G33 Z-5 K1 Q180\nM2");
    assert_eq!((actions.len(), found), (2, [(1, 12, 4, K::ThreadStartSmall(word("Q180")))].to_vec()));
}
