//! When rounds end.

/// Length of a round without the delay, in µs.
pub const ROUND_US: u64 = 1_000_000;
/// How often the field is looked at in each third of a round, and in a round.
pub(crate) const LOOKS_A_THIRD: usize = 2;
/// Looks at the field in a round, evenly apart: two in each third, whose mean is half as noisy in power.
pub const LOOKS: usize = 3 * LOOKS_A_THIRD;
/// Largest delay of an advertising event, in µs.
pub const MAX_DELAY_US: u64 = 10_000;

/// Ends of rounds: a second and a delay by chance of up to 10 ms apart, so that two cards that send at once do not do
/// so for ever.
///
/// The delay is that of the event, and the next round begins with it: rounds and events cannot drift apart.
///
/// # Source
/// Bluetooth Core 5.4, Vol 6, Part B, 4.4.2.2.1: `T_advEvent = advInterval + advDelay`, the delay within 0 to 10 ms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pace {
    next_us: u64,
    chance: u32,
}

impl Pace {
    /// The first round ends a second after `now_us`; `seed` differs from card to card.
    pub fn new(now_us: u64, seed: u32) -> Self {
        // Xorshift must not begin at 0.
        Self { next_us: now_us + ROUND_US, chance: seed.wrapping_mul(0x9E37_79B9) | 1 }
    }

    /// When the open round ends.
    pub fn next_us(&self) -> u64 {
        self.next_us
    }

    /// When the open round's look number `k` at the field is due, 0 to [`LOOKS`] − 1.
    pub fn look_us(&self, k: usize) -> u64 {
        (self.next_us + ROUND_US * (2 * k as u64 + 1) / (2 * LOOKS as u64)).saturating_sub(ROUND_US)
    }

    /// Goes to the next round. Where the card was late by more than a round, it does not catch up.
    pub fn advance(&mut self, now_us: u64) {
        self.chance ^= self.chance << 13;
        self.chance ^= self.chance >> 17;
        self.chance ^= self.chance << 5;
        let delay_us = (u64::from(self.chance) * (MAX_DELAY_US + 1)) >> 32;
        let next_us = self.next_us + ROUND_US + delay_us;
        self.next_us = if next_us <= now_us { now_us + ROUND_US + delay_us } else { next_us };
    }

    /// Begins anew at `now_us`, as after sleep.
    pub fn restart(&mut self, now_us: u64) {
        self.next_us = now_us + ROUND_US;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn delays_fill_their_range_and_differ_from_card_to_card() {
        let delays = |seed: u32| {
            let mut pace = Pace::new(0, seed);
            core::array::from_fn::<u64, 2_000, _>(|_| {
                let before_us = pace.next_us();
                pace.advance(before_us);
                pace.next_us() - before_us - ROUND_US
            })
        };
        let first = delays(1);
        assert!(first.iter().all(|&delay_us| delay_us <= MAX_DELAY_US));
        let mean_us = first.iter().sum::<u64>() / 2_000;
        assert!((4_700..5_300).contains(&mean_us), "{mean_us}");
        assert!(
            first.iter().any(|&delay_us| delay_us < 50) && first.iter().any(|&delay_us| delay_us > 9_950)
        );
        assert_ne!(first, delays(2));
        assert_ne!(delays(0)[..4], [delays(0)[0]; 4]);
    }

    #[test]
    fn a_card_that_is_late_does_not_catch_up() {
        let mut pace = Pace::new(0, 7);
        pace.advance(10_000_000);
        assert!((11_000_000..=11_010_000).contains(&pace.next_us()));
        pace.restart(20_000_000);
        assert_eq!(pace.next_us(), 21_000_000);
        assert_eq!([0, 1, 5].map(|k| pace.look_us(k)), [20_083_333, 20_250_000, 20_916_666]);
    }
}
