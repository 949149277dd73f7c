//! The readings of an open move, thinned so that any number fits.

use serde::{Deserialize, Serialize};

use crate::magnetic::feature::FieldRead;

/// Readings that are kept; at 100 Hz a step of 0.6 s has 60 and is thinned once.
const N_KEPT: usize = 32;

/// Collects readings in a fixed room: when it is full, every second one goes, and from then on every second one comes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FieldTrace {
    kept: [Option<FieldRead>; N_KEPT],
    n_kept: usize,
    /// Thinned so often by two.
    n_halvings: u32,
    n_pushed: u32,
}

impl FieldTrace {
    /// Takes the next reading in.
    pub fn push(&mut self, read: FieldRead) {
        let is_due = self.n_pushed.trailing_zeros() >= self.n_halvings;
        self.n_pushed = self.n_pushed.wrapping_add(1);
        if !is_due {
            return;
        }
        if self.n_kept == N_KEPT {
            for k in 0..N_KEPT / 2 {
                self.kept[k] = self.kept[2 * k];
            }
            self.n_kept = N_KEPT / 2;
            self.n_halvings = (self.n_halvings + 1).min(u32::BITS);
        }
        self.kept[self.n_kept] = Some(read);
        self.n_kept += 1;
    }

    /// The mean of each third of what came, by number; nothing for a third without a reading.
    pub fn thirds(&self) -> [Option<FieldRead>; 3] {
        let n = self.n_kept;
        [0, 1, 2].map(|third| mean(&self.kept[third * n / 3..(third + 1) * n / 3]))
    }
}

fn mean(reads: &[Option<FieldRead>]) -> Option<FieldRead> {
    let (mut strength_ut, mut level_ut, mut n, mut n_level) = (0.0, [0.0; 2], 0u8, 0u8);
    for read in reads.iter().flatten() {
        strength_ut += read.strength_ut;
        n += 1;
        if let Some([horizontal_ut, vertical_ut]) = read.horizontal_vertical_ut {
            level_ut = [level_ut[0] + horizontal_ut, level_ut[1] + vertical_ut];
            n_level += 1;
        }
    }
    let horizontal_vertical_ut = (n_level > 0).then(|| level_ut.map(|sum_ut| sum_ut / f32::from(n_level)));
    (n > 0).then(|| FieldRead { strength_ut: strength_ut / f32::from(n), horizontal_vertical_ut })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn ramp(n: usize) -> FieldTrace {
        let mut trace = FieldTrace::default();
        for k in 0..n {
            let strength_ut = k as f32;
            trace.push(FieldRead { strength_ut, horizontal_vertical_ut: Some([strength_ut, -strength_ut]) });
        }
        trace
    }

    #[test]
    fn thirds_by_hand() {
        let thirds = ramp(6).thirds().map(|read| read.unwrap());
        assert_eq!(thirds.map(|read| read.strength_ut), [0.5, 2.5, 4.5]);
        assert_eq!(thirds[2].horizontal_vertical_ut, Some([4.5, -4.5]));
        assert_eq!(FieldTrace::default().thirds(), [None; 3]);
        // Two readings: of the first and the last third, the last alone has a whole one.
        assert_eq!(ramp(1).thirds().map(|read| read.is_some()), [false, false, true]);
    }

    #[test]
    fn a_strength_alone_stays_alone() {
        let mut trace = FieldTrace::default();
        (0..3).for_each(|_| trace.push(FieldRead { strength_ut: 50.0, horizontal_vertical_ut: None }));
        let expected = FieldRead { strength_ut: 50.0, horizontal_vertical_ut: None };
        assert_eq!(trace.thirds(), [Some(expected); 3]);
    }

    proptest! {
        #[test]
        fn thinning_keeps_the_thirds(n in 90usize..5_000) {
            let last = (n - 1) as f32;
            for (k, read) in ramp(n).thirds().into_iter().enumerate() {
                let share = read.unwrap().strength_ut / last;
                // The room is between half full and full: a third is known to a slot of sixteen.
                prop_assert!((share - (2 * k + 1) as f32 / 6.0).abs() < 0.08, "{k} {share}");
            }
        }
    }
}
