//! The panel: levels and counters in, readings and requests out.

use super::*;
use crate::foreground::inputs::Ends;
use crate::foreground::panel::{Contact, Keys, Panel, Turned, Wiring};
use crate::foreground::settings::Fitted;
use interp_core::drive::spindle::Reading;

const NOTHING: Turned =
    Turned { wheels: PerAxis { x: 0, z: 0 }, contour: Some(0), spindle: Reading { counts: 0, index: None } };

/// Bits of the contacts, as far apart as they may be and not in their order.
fn bit(contact: Contact) -> u32 {
    1 << (31 - 2 * u32::from(contact as u8))
}

fn opens(contact: Contact) -> bool {
    contact as u8 >= Contact::XPlusEnd as u8
}

/// Levels when these contacts ask, and what no contact is wired to floats at 1.
fn levels(asking: &[Contact]) -> u32 {
    Contact::ALL.into_iter().fold(u32::MAX, |word, contact| {
        let closed = opens(contact) != asking.contains(&contact);
        if closed { word & !bit(contact) } else { word }
    })
}

fn panel() -> Panel {
    Panel::new(Contact::ALL.into_iter().fold(Wiring::NONE, |wiring, contact| wiring.with(contact, bit(contact))))
}

/// A lathe with a panel that was at rest for long enough.
fn at_rest(set: &[(&str, &str)]) -> (Bench, Panel) {
    let mut with = std::vec![("limit_switches", "true")];
    with.extend(set);
    let (mut bench, mut panel) = (Bench::with(&with), panel());
    serve(&mut bench, &mut panel, &[], 8);
    (bench, panel)
}

/// Ticks of the lathe with these contacts asking; all keys that went down.
fn serve(bench: &mut Bench, panel: &mut Panel, asking: &[Contact], ticks: u32) -> Keys {
    let mut all = Keys::default();
    for _ in 0..ticks {
        let keys = panel.serve(levels(asking), &NOTHING, &mut bench.foreground);
        all = Keys { start: all.start | keys.start, hold: all.hold | keys.hold, reset: all.reset | keys.reset };
        bench.inputs = Inputs { wheels: PerAxis::default(), contour: 0, ..bench.foreground.desk.inputs };
        bench.tick();
    }
    all
}

/// What these contacts say, one by one.
fn said(asking: &[Contact], fitted: Fitted) -> Inputs {
    let is = |contact| asking.contains(&contact);
    let ways = [
        (Contact::JoystickXPlus, Joystick::Axis(Axis::X, true)),
        (Contact::JoystickXMinus, Joystick::Axis(Axis::X, false)),
        (Contact::JoystickZPlus, Joystick::Axis(Axis::Z, true)),
        (Contact::JoystickZMinus, Joystick::Axis(Axis::Z, false)),
    ];
    let pushed: Vec<Joystick> = ways.into_iter().filter(|(contact, _)| is(*contact)).map(|(_, way)| way).collect();
    let end = |contact| fitted.ends && is(contact);
    Inputs {
        joystick: if let [one] = pushed[..] { one } else { Joystick::Off },
        rapid: is(Contact::Rapid),
        guard: fitted.guard && is(Contact::Guard),
        ends: PerAxis {
            x: Ends { plus: end(Contact::XPlusEnd), minus: end(Contact::XMinusEnd) },
            z: Ends { plus: end(Contact::ZPlusEnd), minus: end(Contact::ZMinusEnd) },
        },
        spindle: Some(Reading::default()),
        ..Inputs::NONE
    }
}

#[test]
fn all_sets_of_contacts_read_as_what_each_says() {
    for (guard, ends) in [(false, false), (false, true), (true, false), (true, true)] {
        let parameters = [("guard_switch", guard), ("limit_switches", ends)];
        let set = parameters.map(|(name, on)| (name, if on { "true" } else { "false" }));
        let (mut bench, mut panel) = (Bench::with(&set), panel());
        for set in 0_u32..1 << Contact::ALL.len() {
            let asking: Vec<Contact> =
                Contact::ALL.into_iter().filter(|contact| set >> *contact as u8 & 1 != 0).collect();
            for _ in 0..8 {
                panel.serve(levels(&asking), &NOTHING, &mut bench.foreground);
            }
            assert_eq!(bench.foreground.desk.inputs, said(&asking, Fitted { guard, ends }), "{asking:?}");
            assert_eq!(u32::from(panel.asks()), set);
        }
    }
}

#[test]
fn pins_without_a_wire_ask_for_nothing_but_the_guard() {
    let (mut bench, mut panel) = (Bench::with(&[]), panel());
    for tick in 1..=20 {
        // once it is known that the guard is open, the background is told
        let expected = Keys { hold: tick == 8, ..Keys::default() };
        assert_eq!(panel.serve(u32::MAX, &NOTHING, &mut bench.foreground), expected);
    }
    let nothing = Inputs { spindle: Some(Reading::default()), ..Inputs::NONE };
    assert_eq!(bench.foreground.desk.inputs, Inputs { guard: true, ..nothing });
    assert_eq!((bench.ask(Command::Start), bench.refused()), (Err(Refusal::GuardOpen), None));
    // a machine that has none says so
    bench.parameters.set("guard_switch", "false").unwrap();
    let settings = bench.parameters.operation(&bench.parameters.machine().unwrap());
    bench.ask(Command::Settle(settings)).unwrap();
    panel.serve(u32::MAX, &NOTHING, &mut bench.foreground);
    assert_eq!(bench.foreground.desk.inputs, nothing);
}

#[test]
fn the_background_holds_what_waits_whenever_the_guard_opens_or_closes() {
    let (mut bench, mut panel) = at_rest(&[]);
    let holds = |bench: &mut Bench, panel: &mut Panel, asking: &[Contact]| -> Vec<u32> {
        (1..=20).filter(|_| serve(bench, panel, asking, 1) == Keys { hold: true, ..Keys::default() }).collect()
    };
    assert_eq!(holds(&mut bench, &mut panel, &[]), []);
    assert_eq!(holds(&mut bench, &mut panel, &[Contact::Guard]), [3]);
    assert_eq!(holds(&mut bench, &mut panel, &[]), [8]);
}

#[test]
fn a_board_without_a_pin_for_a_contact_never_has_it_asking() {
    let (mut bench, mut panel) = (Bench::with(&[("limit_switches", "true")]), Panel::new(Wiring::NONE));
    for word in [0, u32::MAX, 0x5555_5555] {
        for _ in 0..9 {
            assert_eq!(panel.serve(word, &NOTHING, &mut bench.foreground), Keys::default());
        }
        assert_eq!((panel.asks(), bench.foreground.desk.inputs), (0, said(&[], Fitted { guard: true, ends: true })));
    }
}

#[test]
fn until_it_is_read_otherwise_the_guard_is_open_and_keys_are_held() {
    let (mut bench, mut panel) = (Bench::with(&[]), panel());
    assert_eq!(serve(&mut bench, &mut panel, &[], 7), Keys::default());
    assert!(bench.foreground.desk.inputs.guard);
    serve(&mut bench, &mut panel, &[], 1);
    assert!(!bench.foreground.desk.inputs.guard);
    // a key that is stuck from power-on
    let (mut bench, mut panel) = (Bench::with(&[]), self::panel());
    assert_eq!(serve(&mut bench, &mut panel, &[Contact::Start, Contact::Reset, Contact::Hold], 50), Keys::default());
    serve(&mut bench, &mut panel, &[], 8);
    assert_eq!(serve(&mut bench, &mut panel, &[Contact::Start], 3), Keys { start: true, ..Keys::default() });
}

#[test]
fn a_key_goes_down_once_and_a_start_waits_for_nobody_to_hold() {
    let (mut bench, mut panel) = at_rest(&[]);
    assert_eq!(serve(&mut bench, &mut panel, &[Contact::Start], 2), Keys::default());
    assert_eq!(serve(&mut bench, &mut panel, &[Contact::Start], 1), Keys { start: true, ..Keys::default() });
    assert_eq!(serve(&mut bench, &mut panel, &[Contact::Start], 100), Keys::default());
    serve(&mut bench, &mut panel, &[], 8);
    let keys = serve(&mut bench, &mut panel, &[Contact::Start, Contact::Hold], 100);
    assert_eq!(keys, Keys { hold: true, ..Keys::default() });
}

#[test]
fn a_hold_and_a_reset_act_in_the_tick_that_believes_them() {
    for (key, state) in [(Contact::Hold, State::Holding), (Contact::Reset, State::Resetting)] {
        let (mut bench, mut panel) = at_rest(&[]);
        bench.load("G1 X20 F600");
        bench.ask(Command::Start).unwrap();
        serve(&mut bench, &mut panel, &[], 300);
        serve(&mut bench, &mut panel, &[key], 2);
        assert_eq!(bench.foreground.state(), State::Running);
        serve(&mut bench, &mut panel, &[key], 1);
        assert_eq!(bench.foreground.state(), state);
        bench.settle();
        bench.keep_limits();
    }
}

#[test]
fn a_guard_that_opens_holds_the_program_and_a_closed_one_lets_it_go_on() {
    let (mut bench, mut panel) = at_rest(&[]);
    bench.load("G1 X5 F600");
    bench.ask(Command::Start).unwrap();
    serve(&mut bench, &mut panel, &[], 300);
    serve(&mut bench, &mut panel, &[Contact::Guard], 3);
    assert_eq!((bench.foreground.state(), bench.refused()), (State::Holding, Some(Refusal::GuardOpen)));
    serve(&mut bench, &mut panel, &[Contact::Guard], 500);
    assert_eq!(bench.ask(Command::Start), Err(Refusal::GuardOpen));
    serve(&mut bench, &mut panel, &[], 8);
    bench.ask(Command::Start).unwrap();
    serve(&mut bench, &mut panel, &[], 2_000);
    assert_eq!((bench.foreground.state(), bench.at.x), (State::Ended, 4_000));
}

#[test]
fn a_limit_switch_that_an_axis_runs_into_is_an_alarm() {
    let (mut bench, mut panel) = at_rest(&[]);
    bench.load("G1 X20 F600");
    bench.ask(Command::Start).unwrap();
    serve(&mut bench, &mut panel, &[], 300);
    // the one behind it is none
    serve(&mut bench, &mut panel, &[Contact::XMinusEnd], 20);
    assert_eq!(bench.foreground.alarm(), None);
    serve(&mut bench, &mut panel, &[Contact::XPlusEnd], 3);
    assert_eq!(bench.foreground.alarm(), Some(Alarm::limit_switch(Axis::X)));
}

#[test]
fn a_lever_that_was_in_at_power_on_has_to_come_out_first() {
    let refused = |bench: &mut Bench| std::iter::from_fn(|| bench.foreground.refused()).collect::<Vec<_>>();
    let (mut bench, mut panel) = (Bench::with(&[]), panel());
    serve(&mut bench, &mut panel, &[Contact::Lever], 50);
    assert_eq!(refused(&mut bench), []);
    serve(&mut bench, &mut panel, &[], 8);
    assert_eq!(refused(&mut bench), []);
    // not the mode for it: the lathe says so, once
    serve(&mut bench, &mut panel, &[Contact::Lever], 50);
    assert_eq!(refused(&mut bench), [Refusal::WrongMode(Mode::Power)]);
}

#[test]
fn counts_of_wheels_are_handed_on_and_those_of_z_lead_a_contour_where_no_wheel_is_left() {
    let turned = Turned { wheels: PerAxis { x: 3, z: -5 }, contour: Some(7), spindle: NOTHING.spindle };
    for (mode, contour, expected) in [
        (Mode::Handwheel, Some(7), (3, -5, 7)),
        (Mode::Handwheel, None, (3, -5, 0)),
        (Mode::Automatic, None, (3, -5, 0)),
        (Mode::Linked, Some(7), (3, -5, 7)),
        (Mode::Linked, None, (3, 0, -5)),
    ] {
        let (mut bench, mut panel) = at_rest(&[]);
        bench.ask(Command::Mode(mode)).unwrap();
        panel.serve(levels(&[]), &Turned { contour, ..turned }, &mut bench.foreground);
        let Inputs { wheels, contour, .. } = bench.foreground.desk.inputs;
        assert_eq!((wheels.x, wheels.z, contour), expected, "{mode:?}");
    }
}

#[test]
fn the_spindles_counter_and_index_are_handed_on() {
    let (mut bench, mut panel) = at_rest(&[]);
    let spindle = Reading { counts: 40_000, index: Some(39_990) };
    panel.serve(levels(&[]), &Turned { spindle, ..NOTHING }, &mut bench.foreground);
    assert_eq!(bench.foreground.desk.inputs.spindle, Some(spindle));
}
