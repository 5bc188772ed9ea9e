//! Contacts that bounce: 32 at once, a bit each.
//!
//! A contact counts as made after [`ON`] equal ticks and as open after [`OFF`]. Most contacts ask for a stop (hold, guard,
//! limit) and all of them ask for something, so they are believed soon; three ticks, and not one, because a spark nearby may
//! lie on one reading, or on two where it meets a tick's border. A contact that opens, or is just being made, is open for
//! some ms at a time; eight ticks outlast that. Longer ones would only delay what follows: power feed goes on until its
//! lever is seen to be back.
//!
//! For each contact the ticks in a row are counted in which it differed from what it counts as. The counters stand side by
//! side, each in the same bit of three words: a tick takes the same few instructions for one contact as for 32.

/// Ticks until a contact counts as made.
pub const ON: u32 = 3;

/// Ticks until it counts as open.
pub const OFF: u32 = 8;

/// Up to 32 contacts.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Debounced {
    settled: u32,
    /// Ticks in a row that each contact has differed: ones, twos, fours.
    ticks: [u32; 3],
}

impl Debounced {
    /// Contacts that count as made where a bit is set, until they are read otherwise.
    pub const fn new(settled: u32) -> Self {
        Self { settled, ticks: [0; 3] }
    }

    /// Takes the contacts of a tick, gives what they count as.
    ///
    /// ```
    /// # use handcnc::foreground::debounce::Debounced;
    /// let mut contacts = Debounced::new(0);
    /// let seen = [1, 0, 1, 1, 1, 0, 1].map(|made| contacts.take(made));
    /// assert_eq!(seen, [0, 0, 0, 0, 1, 1, 1]);
    /// ```
    #[inline]
    pub const fn take(&mut self, made: u32) -> u32 {
        let differ = made ^ self.settled;
        let [ones, twos, fours] = self.ticks;
        let carry = ones & twos;
        let eight = carry & fours & differ;
        let (ones, twos, fours) = (!ones & differ, (ones ^ twos) & differ, (fours ^ carry) & differ);
        // one that counts as open is counted to three only
        let three = ones & twos;
        let change = self.settled & eight | !self.settled & three;
        self.settled ^= change;
        self.ticks = [ones & !change, twos & !change, fours & !change];
        self.settled
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::vec::Vec;

    /// What a contact with these readings, the oldest first, counts as in the end: by looking back over all of them.
    fn by_history(begins: bool, readings: &[bool]) -> bool {
        let mut settled = begins;
        let mut since = 0;
        for end in 1..=readings.len() {
            let length = if settled { OFF } else { ON } as usize;
            if end - since >= length && readings[end - length..end].iter().all(|made| *made != settled) {
                settled = !settled;
                since = end;
            }
        }
        settled
    }

    #[test]
    fn every_history_of_twenty_ticks_counts_as_what_its_last_runs_say() {
        const TICKS: usize = 20;
        for begins in [false, true] {
            // 32 histories at a time, one in each bit
            for block in (0_u32..1 << TICKS).step_by(32) {
                let mut contacts = Debounced::new(if begins { u32::MAX } else { 0 });
                let mut last = 0;
                for tick in 0..TICKS {
                    let word = (0..32).fold(0, |word, bit| word | ((block + bit) >> tick & 1) << bit);
                    last = contacts.take(word);
                }
                for bit in 0..32 {
                    let readings: Vec<bool> = (0..TICKS).map(|tick| (block + bit) >> tick & 1 != 0).collect();
                    assert_eq!(last >> bit & 1 != 0, by_history(begins, &readings), "{begins} {readings:?}");
                }
            }
        }
    }

    #[test]
    fn a_contact_is_believed_after_three_ticks_and_let_go_after_eight() {
        let mut contacts = Debounced::new(0);
        let on: Vec<bool> = (0..4).map(|_| contacts.take(1 << 31) != 0).collect();
        assert_eq!(on, [false, false, true, true]);
        let off: Vec<bool> = (0..9).map(|_| contacts.take(0) != 0).collect();
        assert_eq!(off, [true, true, true, true, true, true, true, false, false]);
    }

    #[test]
    fn one_that_bounces_is_made_once() {
        let mut contacts = Debounced::new(0);
        // made with gaps of up to seven ticks, opened with contacts of up to two
        let runs = [(true, 1), (false, 2), (true, 2), (false, 1), (true, 3), (false, 7), (true, 9)];
        let opens = [(false, 3), (true, 2), (false, 7), (true, 1), (false, 20)];
        let (mut changes, mut last) = (0, 0);
        for (made, ticks) in runs.into_iter().chain(opens) {
            for _ in 0..ticks {
                let now = contacts.take(u32::from(made));
                changes += u32::from(now != last);
                last = now;
            }
        }
        assert_eq!((changes, last), (2, 0));
    }
}
