//! The number of a round, over sleep and resets.

use crate::hardware::Retained;

/// How far the number jumps where rounds do not follow each other: after sleep, and after a reset.
///
/// Receivers place a frame by its number and their clock, which they trust to within a few rounds, and bridge five lost
/// rounds at most. Half of all numbers away, a frame is never taken to continue, even where the one that said that the
/// card has just woken was lost.
pub const DISCONTINUITY: u8 = 128;

/// What tells the word from chance after power was lost.
const MARK: u32 = 0xCA4D_0000;

/// Counts rounds; its number is kept where a reset does not reach it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SequenceCounter {
    next: u8,
}

impl SequenceCounter {
    /// Goes on half of all numbers away from where `retained` left off; from 0 where power was lost, which takes a
    /// battery's change: longer than receivers bridge.
    pub fn resumed(retained: &impl Retained) -> Self {
        let word = retained.load();
        let number = word as u8;
        let next = if word == word_of(number) { number.wrapping_add(DISCONTINUITY) } else { 0 };
        Self { next }
    }

    /// The number of the round that is being sent; the one after it is kept.
    pub fn take(&mut self, retained: &mut impl Retained) -> u8 {
        let number = self.next;
        self.next = number.wrapping_add(1);
        retained.store(word_of(self.next));
        number
    }

    /// Rounds were left out.
    pub fn interrupt(&mut self, retained: &mut impl Retained) {
        self.next = self.next.wrapping_add(DISCONTINUITY);
        retained.store(word_of(self.next));
    }
}

fn word_of(number: u8) -> u32 {
    MARK | u32::from(!number) << 8 | u32::from(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Word(u32);

    impl Retained for Word {
        fn load(&self) -> u32 {
            self.0
        }

        fn store(&mut self, word: u32) {
            self.0 = word;
        }
    }

    #[test]
    fn numbers_go_on_over_a_reset_half_of_them_away() {
        let mut word = Word(0xFFFF_FFFF);
        let mut counter = SequenceCounter::resumed(&word);
        let first: [u8; 3] = core::array::from_fn(|_| counter.take(&mut word));
        assert_eq!(first, [0, 1, 2]);
        let mut counter = SequenceCounter::resumed(&word);
        assert_eq!((counter.take(&mut word), counter.take(&mut word)), (131, 132));
        counter.interrupt(&mut word);
        assert_eq!(counter.take(&mut word), 5);
    }

    #[test]
    fn every_number_is_kept_and_chance_is_not_taken_for_one() {
        for number in 0..=u8::MAX {
            let resumed = SequenceCounter::resumed(&Word(word_of(number)));
            assert_eq!(resumed.next, number.wrapping_add(128));
            for bit in 0..32 {
                assert_eq!(SequenceCounter::resumed(&Word(word_of(number) ^ 1 << bit)).next, 0);
            }
        }
    }
}
