//! Resampling: a new population whose members are copies of the old one's, as often as their weights say.

use serde::{Deserialize, Serialize};

use crate::particle::Particles;

/// How many copies each particle gets, by chance; on average always its share of the weights.
///
/// # Source
/// Systematic: Mass-centred 2019, Alg. 1. The four are compared in Douc, Cappé and Moulines 2005, *Comparison of
/// resampling schemes for particle filtering*.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Resampling {
    /// One random number: targets at equal distances along the cumulative weights. Copies are within one of their share.
    #[default]
    Systematic,
    /// Every copy drawn by itself: the simplest, and the noisiest.
    Multinomial,
    /// One target by chance in each of as many equal parts of the cumulative weights as there are particles. Copies are
    /// within two of their share.
    Stratified,
    /// The whole part of each share for certain, the rest drawn one by one from what is left over.
    Residual,
}

/// Memory that one step needs and the next does not remember.
#[derive(Clone, Debug, Default)]
pub struct ResampleScratch {
    pub(super) ancestors: Vec<u32>,
    gathered: Vec<f32>,
    drawn: Vec<u32>,
}

impl ResampleScratch {
    /// Room for `n` particles with histories of `window` terms.
    pub fn with_capacity(n: usize, window: usize) -> Self {
        Self {
            ancestors: Vec::with_capacity(n),
            gathered: Vec::with_capacity(n * window.max(1)),
            drawn: Vec::with_capacity(n),
        }
    }
}

impl Particles {
    /// Replaces the particles by a sample of `weights` (not necessarily normalised); `bits` gives 32 random bits for
    /// each number below the particles'.
    ///
    /// All log weights become 0. Does nothing when the weights sum to zero.
    pub fn resample(
        &mut self,
        resampling: Resampling,
        weights: &[f32],
        bits: impl Fn(u32) -> u32,
        scratch: &mut ResampleScratch,
    ) {
        let n = self.len();
        let total: f64 = weights.iter().map(|&w| f64::from(w)).sum();
        if n == 0 || weights.len() != n || !(total > 0.0 && total.is_finite()) {
            return;
        }
        let ResampleScratch { ancestors, drawn, .. } = scratch;
        ancestors.clear();
        let step = total / n as f64;
        let weight = |i: usize| f64::from(weights[i]);
        match resampling {
            Resampling::Systematic => {
                let u = share(bits(0));
                walk_up(weight, (0..n).map(|k| step * (k as f64 + u)), n, ancestors);
            }
            Resampling::Stratified => {
                let targets = (0..n).map(|k| step * (k as f64 + share(bits(k as u32))));
                walk_up(weight, targets, n, ancestors);
            }
            Resampling::Multinomial => draw_each(weight, total, n, &bits, drawn, ancestors),
            Resampling::Residual => {
                let mut left = 0.0;
                for i in 0..n {
                    let copies = (weight(i) / step) as usize;
                    left += weight(i) / step - copies as f64;
                    ancestors.extend(core::iter::repeat_n(i as u32, copies.min(n - ancestors.len())));
                }
                let rest = |i: usize| {
                    let copies = weight(i) / step;
                    copies - copies.floor()
                };
                draw_each(rest, left, n, &bits, drawn, ancestors);
            }
        }
        for (_, array) in self.arrays_mut() {
            gather(array, n, scratch);
        }
        self.log_weight.fill(0.0);
    }
}

/// A number in [0, 1) from 32 random bits, of which it uses 24.
fn share(bits: u32) -> f64 {
    f64::from(crate::random::uniform(bits))
}

/// Appends, for each of the rising `targets`, the first of `n` particles at which the cumulative weight reaches it.
fn walk_up(
    weight: impl Fn(usize) -> f64,
    targets: impl Iterator<Item = f64>,
    n: usize,
    ancestors: &mut Vec<u32>,
) {
    let (mut ancestor, mut reached) = (0, weight(0));
    for target in targets {
        while reached < target && ancestor + 1 < n {
            ancestor += 1;
            reached += weight(ancestor);
        }
        ancestors.push(ancestor as u32);
    }
}

/// Fills `ancestors` up to `n` with draws that do not depend on each other; sorted, so that one walk finds them all.
fn draw_each(
    weight: impl Fn(usize) -> f64,
    total: f64,
    n: usize,
    bits: impl Fn(u32) -> u32,
    drawn: &mut Vec<u32>,
    ancestors: &mut Vec<u32>,
) {
    drawn.clear();
    drawn.extend((ancestors.len()..n).map(|k| bits(k as u32)));
    drawn.sort_unstable();
    let unit = total / (f64::from(u32::MAX) + 1.0);
    walk_up(weight, drawn.iter().map(|&bits| unit * (f64::from(bits) + 0.5)), n, ancestors);
}

fn gather(array: &mut [f32], n: usize, scratch: &mut ResampleScratch) {
    let block = array.len() / n;
    match block {
        0 => return,
        1 => {
            scratch.gathered.clear();
            scratch.gathered.extend(scratch.ancestors.iter().map(|&a| array[a as usize]));
        }
        _ => {
            scratch.gathered.clear();
            for &a in &scratch.ancestors {
                scratch.gathered.extend_from_slice(&array[a as usize * block..(a as usize + 1) * block]);
            }
        }
    }
    array.copy_from_slice(&scratch.gathered);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, draw};
    use proptest::prelude::*;

    const ALL: [Resampling; 4] =
        [Resampling::Systematic, Resampling::Multinomial, Resampling::Stratified, Resampling::Residual];

    fn cloud(n: usize) -> Particles {
        Particles {
            x_m: (0..n).map(|i| i as f32).collect(),
            y_m: vec![0.0; n],
            delta_errors_ut: (0..3 * n).map(|i| i as f32).collect(),
            log_weight: vec![-1.0; n],
            ..Particles::default()
        }
    }

    /// Which particles survive when the random numbers are `drawn`, each in [0, 1).
    fn survivors(resampling: Resampling, weights: &[f32], drawn: &[f64]) -> Vec<f32> {
        let mut particles = cloud(weights.len());
        let bits = |k: u32| (drawn[k as usize] * 4_294_967_296.0) as u32;
        particles.resample(resampling, weights, bits, &mut ResampleScratch::default());
        particles.x_m
    }

    /// How many copies each particle gets with random numbers of `seed`.
    fn copies(resampling: Resampling, weights: &[f32], seed: u64) -> Vec<f64> {
        let mut particles = cloud(weights.len());
        let bits = |k: u32| draw(seed, 1, k, Purpose::Resampling)[0];
        particles.resample(resampling, weights, bits, &mut ResampleScratch::default());
        let count = |i: usize| particles.x_m.iter().filter(|&&x| x == i as f32).count();
        (0..weights.len()).map(|i| count(i) as f64).collect()
    }

    #[test]
    fn systematic_resampling_by_hand() {
        let mut particles = cloud(4);
        let mut scratch = ResampleScratch::with_capacity(4, 3);
        // Cumulative 0.1, 0.1, 0.6, 1.0 against targets 0.125, 0.375, 0.625, 0.875.
        let half = |_| 1u32 << 31;
        particles.resample(Resampling::Systematic, &[0.1, 0.0, 0.5, 0.4], half, &mut scratch);
        assert_eq!(particles.x_m, [2.0, 2.0, 3.0, 3.0]);
        assert_eq!(particles.delta_errors_ut[..6], [6.0, 7.0, 8.0, 6.0, 7.0, 8.0]);
        assert_eq!(particles.log_weight, [0.0; 4]);
    }

    #[test]
    fn multinomial_resampling_by_hand() {
        // Cumulative 1, 1, 6, 10 against 9.5, 0.5, 5.5 and 6.5.
        let drawn = [0.95, 0.05, 0.55, 0.65];
        assert_eq!(survivors(Resampling::Multinomial, &[1.0, 0.0, 5.0, 4.0], &drawn), [0.0, 2.0, 3.0, 3.0]);
    }

    #[test]
    fn stratified_resampling_by_hand() {
        // Cumulative 1, 1, 6, 10 against (0 + 0.2)·2.5 = 0.5, 1.5·2.5 = 3.75, 2.2·2.5 = 5.5 and 3.9·2.5 = 9.75.
        let drawn = [0.2, 0.5, 0.2, 0.9];
        assert_eq!(survivors(Resampling::Stratified, &[1.0, 0.0, 5.0, 4.0], &drawn), [0.0, 2.0, 2.0, 3.0]);
    }

    #[test]
    fn residual_resampling_by_hand() {
        // Shares 0.4, 0, 2, 1.6: one copy of the last and two of the third for certain; left over 0.4 and 0.6 of 1, of
        // which 0.3 falls to the first and 0.5 to the last. The draw is the fourth.
        let weights = [1.0, 0.0, 5.0, 4.0];
        let drawn = |last| [0.9, 0.9, 0.9, last];
        assert_eq!(survivors(Resampling::Residual, &weights, &drawn(0.3)), [2.0, 2.0, 3.0, 0.0]);
        assert_eq!(survivors(Resampling::Residual, &weights, &drawn(0.5)), [2.0, 2.0, 3.0, 3.0]);
    }

    #[test]
    fn weights_without_a_sum_change_nothing() {
        for resampling in ALL {
            for weights in [[0.0; 3], [f32::NAN, 1.0, 1.0], [f32::INFINITY, 1.0, 1.0]] {
                assert_eq!(survivors(resampling, &weights, &[0.5; 3]), [0.0, 1.0, 2.0], "{resampling:?}");
            }
        }
    }

    proptest! {
        #[test]
        fn copies_are_proportional_to_the_weights(
            weights in proptest::collection::vec(0.0f32..1.0, 2..30), seed in 0u64..1_000,
        ) {
            let n = weights.len() as f64;
            let total: f64 = weights.iter().map(|&w| f64::from(w)).sum();
            prop_assume!(total > 1e-3);
            const RUNS: u64 = 300;
            for resampling in ALL {
                let mut mean = vec![0.0; weights.len()];
                for run in 0..RUNS {
                    let copies = copies(resampling, &weights, seed * RUNS + run);
                    prop_assert_eq!(copies.iter().sum::<f64>(), n);
                    for (mean, copies) in mean.iter_mut().zip(copies) {
                        *mean += copies / RUNS as f64;
                    }
                }
                for (mean, &weight) in mean.iter().zip(&weights) {
                    let share = n * f64::from(weight) / total;
                    // The multinomial's variance is the largest of the four: at most the share.
                    let sd = (share / RUNS as f64).sqrt();
                    prop_assert!((mean - share).abs() <= 5.5 * sd + 0.02, "{resampling:?}: {mean} {share}");
                }
            }
        }

        #[test]
        fn copies_stay_near_their_share(
            weights in proptest::collection::vec(0.0f32..1.0, 2..40), seed in 0u64..1_000_000,
        ) {
            let n = weights.len() as f64;
            let total: f64 = weights.iter().map(|&w| f64::from(w)).sum();
            prop_assume!(total > 1e-3);
            for (resampling, most) in [(Resampling::Systematic, 1.0), (Resampling::Stratified, 2.0)] {
                for (copies, &weight) in copies(resampling, &weights, seed).iter().zip(&weights) {
                    prop_assert!((copies - n * f64::from(weight) / total).abs() <= most + 1e-4);
                }
            }
            for (copies, &weight) in copies(Resampling::Residual, &weights, seed).iter().zip(&weights) {
                prop_assert!(*copies >= (n * f64::from(weight) / total - 1e-4).floor());
            }
        }
    }
}
