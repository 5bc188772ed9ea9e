extern crate std;

use std::vec::Vec;

use super::*;

/// Pins of an encoder in the order of a turn forward: A leads B.
const LINE: [(bool, bool); 4] = [(true, false), (true, true), (false, true), (false, false)];

/// A model of a timer: what RM0090 18.4 says of these registers, and the table in 18.3.12 of the counting direction.
#[derive(Default)]
struct Timer {
    written: Vec<(Register, u32)>,
    cr1: u32,
    smcr: u32,
    sr: u32,
    ccmr1: u32,
    ccmr2: u32,
    ccer: u32,
    arr: u32,
    cnt: u32,
    ccr3: u32,
    pins: (bool, bool, bool),
}

impl Port for Timer {
    fn write(&mut self, register: Register, value: u32) {
        self.written.push((register, value));
        match register {
            Register::Cr1 => self.cr1 = value,
            Register::Smcr => self.smcr = value,
            // flags are cleared by zeros
            Register::Sr => self.sr &= value,
            // CCxS can be written only while the channel is off: CCxE of all four
            Register::Ccmr1 if self.ccer & 0x11 == 0 => self.ccmr1 = value,
            Register::Ccmr2 if self.ccer & 0x1100 == 0 => self.ccmr2 = value,
            Register::Ccmr1 | Register::Ccmr2 => {}
            Register::Ccer => self.ccer = value,
            Register::Arr => self.arr = value,
            Register::Dier | Register::Psc => assert_eq!(value, 0),
            Register::Cnt | Register::Ccr3 => panic!("never written"),
        }
    }

    fn read(&mut self, register: Register) -> u32 {
        match register {
            Register::Cnt => self.cnt,
            Register::Sr => self.sr,
            Register::Ccr3 => {
                self.sr &= !(1 << 3);
                self.ccr3
            }
            other => panic!("{other:?} is never read"),
        }
    }
}

impl Timer {
    fn counting(filter: Filter, index: bool) -> Self {
        let mut timer = Self { arr: 0xFFFF_FFFF, ..Self::default() };
        count_encoder(&mut timer, filter, index);
        timer
    }

    /// New levels of A, B and index, one of which differs.
    fn set(&mut self, a: bool, b: bool, index: bool) {
        let before = core::mem::replace(&mut self.pins, (a, b, index));
        // CEN; encoder mode 3; TI1FP1 and TI2FP2 not inverted, both channels inputs from their own pins
        let counts = self.cr1 & 1 != 0 && self.smcr & 7 == 3 && self.ccer & 0xAA == 0 && self.ccmr1 & 0x0303 == 0x0101;
        if counts {
            // by the level of the other signal: TI1 rising while TI2 is low is up, and so on
            let up = match (before.0 != a, before.1 != b) {
                (true, false) => Some(a != b),
                (false, true) => Some(b == a),
                _ => None,
            };
            self.cnt = match up {
                Some(true) if self.cnt == self.arr => 0,
                Some(true) => self.cnt + 1,
                Some(false) if self.cnt == 0 => self.arr,
                Some(false) => self.cnt - 1,
                None => self.cnt,
            };
        }
        // CC3S = 01, CC3E, rising edge, IC3PSC = 0
        let captures = self.ccmr2 & 0xF == 1 && self.ccer & 0xB00 == 0x100;
        if captures && index && !before.2 {
            (self.ccr3, self.sr) = (self.cnt, self.sr | 1 << 3);
        }
    }

    /// Turns the encoder by a count forward or back, from a place in its line.
    fn turn(&mut self, at: &mut usize, forward: bool) {
        *at = if forward { *at + 1 } else { *at + 3 } % 4;
        let (a, b) = LINE[*at];
        self.set(a, b, self.pins.2);
    }
}

#[test]
fn a_wheels_timer_gets_these_values() {
    // CKD 10 and CEN: bits 9:8 and 0 (18.4.1); CC1S, CC2S 01 and IC1F, IC2F 1111 (18.4.7); SMS 011 (18.4.3)
    let expected = [
        (Register::Cr1, 0x0200),
        (Register::Dier, 0),
        (Register::Psc, 0),
        (Register::Arr, 0xFFFF),
        (Register::Ccmr1, 0xF1F1),
        (Register::Ccmr2, 0),
        (Register::Ccer, 0),
        (Register::Smcr, 0x0003),
        (Register::Cr1, 0x0201),
    ];
    assert_eq!(Timer::counting(Filter::Slow, false).written, expected);
}

#[test]
fn the_spindles_timer_gets_these_values() {
    // CKD 00; ICxF 1100; CC3S 01 with IC3F 1100 (18.4.8); CC3E bit 8, CC3P bit 9, CC3NP bit 11 (18.4.9)
    let expected = [
        (Register::Cr1, 0x0000),
        (Register::Dier, 0),
        (Register::Psc, 0),
        (Register::Arr, 0xFFFF),
        (Register::Ccmr1, 0xC1C1),
        (Register::Ccmr2, 0x00C1),
        (Register::Ccer, 0x0100),
        (Register::Smcr, 0x0003),
        (Register::Cr1, 0x0001),
    ];
    let timer = Timer::counting(Filter::Fast, true);
    assert_eq!(timer.written, expected);
    // the model refuses inputs that are chosen while their channel is on
    assert_eq!((timer.ccmr1, timer.ccmr2), (0xC1C1, 0x00C1));
}

#[test]
fn a_line_is_four_counts_and_a_leading_is_up() {
    let mut timer = Timer::counting(Filter::Slow, false);
    let (mut count, mut at) = (Count::NONE, 3);
    for n in 1..=3 * 65_536 {
        timer.turn(&mut at, true);
        assert_eq!(count.take(counter(&mut timer)), 1);
        assert_eq!(count.total(), n);
    }
    // and back past zero
    for n in (-70_000..3 * 65_536).rev() {
        timer.turn(&mut at, false);
        assert_eq!(count.take(counter(&mut timer)), -1);
        assert_eq!(count.total(), n);
    }
    assert_eq!(index(&mut timer), None);
}

#[test]
fn an_edge_that_bounces_counts_there_and_back() {
    let mut timer = Timer::counting(Filter::Slow, false);
    for _ in 0..5 {
        timer.set(true, false, false);
        timer.set(false, false, false);
    }
    timer.set(true, false, false);
    let mut count = Count::NONE;
    assert_eq!(count.take(counter(&mut timer)), 1);
}

#[test]
fn an_index_is_the_count_where_it_rose_and_is_given_once() {
    let mut timer = Timer::counting(Filter::Fast, true);
    let mut at = 3;
    for _ in 0..1234 {
        timer.turn(&mut at, true);
    }
    let (a, b) = LINE[at];
    timer.set(a, b, true);
    timer.turn(&mut at, true);
    timer.turn(&mut at, true);
    let (a, b) = LINE[at];
    timer.set(a, b, false);
    assert_eq!((counter(&mut timer), index(&mut timer)), (1236, Some(1234)));
    assert_eq!(index(&mut timer), None);
    // backward past zero
    for _ in 0..2000 {
        timer.turn(&mut at, false);
    }
    let (a, b) = LINE[at];
    timer.set(a, b, true);
    assert_eq!(index(&mut timer), Some(1236_u16.wrapping_sub(2000)));
}

#[test]
fn a_wheel_captures_nothing() {
    let mut timer = Timer::counting(Filter::Slow, false);
    timer.set(false, false, true);
    assert_eq!(index(&mut timer), None);
}

#[test]
fn every_counter_and_every_difference_adds_up() {
    // each place of the counter, in each of some laps, with the largest steps and small ones
    for lap in [-0x7FFF_i32, -2, -1, 0, 1, 2, 0x7FFE] {
        for place in 0..=u16::MAX {
            let begins = lap << 16 | i32::from(place);
            for step in [i16::MIN, -1, 0, 1, i16::MAX] {
                let mut count = Count(begins);
                assert_eq!(count.take(place.wrapping_add_signed(step)), step);
                assert_eq!(count.total(), begins + i32::from(step));
            }
        }
    }
    // each step, from some places
    for place in [0, 1, 0x7FFF, 0x8000, 0xFFFF_u16] {
        for step in i16::MIN..=i16::MAX {
            let mut count = Count(i32::from(place));
            assert_eq!(count.take(place.wrapping_add_signed(step)), step);
        }
    }
    // after 2^31 counts it goes round, and differences stay right
    let mut count = Count(i32::MAX);
    assert_eq!((count.take(0), count.total()), (1, i32::MIN));
}
