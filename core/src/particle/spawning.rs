//! Particles that spawn several each, and how their number is kept.

use serde::{Deserialize, Serialize};

use crate::particle::{Particles, ResampleScratch};

/// How many particles a step makes of one, and which of them die.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpawningParams {
    /// New particles of each at every step; at least 1.
    pub n_children: usize,
    /// A particle that weighs less than this share of the heaviest dies.
    pub kill_below: f32,
}

impl Particles {
    /// Reserves room for `n` particles in every array in use.
    pub(crate) fn reserve(&mut self, n: usize) {
        let n_now = self.len().max(1);
        for (_, array) in self.arrays_mut() {
            let wanted = n * (array.len() / n_now);
            array.reserve_exact(wanted.saturating_sub(array.len()));
        }
    }

    /// Repeats the particles, or leaves the last ones out, until there are `n`.
    pub(crate) fn repeat_to(&mut self, n: usize) {
        let n_now = self.len();
        if n_now == 0 {
            return;
        }
        for (_, array) in self.arrays_mut() {
            let block = array.len() / n_now;
            array.truncate(n * block);
            while array.len() < n * block {
                let missing = n * block - array.len();
                array.extend_from_within(..missing.min(n_now * block));
            }
        }
    }

    /// Forgets what particles remember of the places where they were, and their weights.
    pub(crate) fn forget_places(&mut self) {
        self.strength_ut.fill(f32::NAN);
        self.delta_errors_ut.fill(f32::NAN);
        self.recent_strengths_ut.fill(f32::NAN);
        self.log_weight.fill(0.0);
    }

    /// Makes every particle `n_children` in its place, side by side, its weight inherited by each.
    ///
    /// # Source
    /// iBILL 2017, Eqs 6 and 7: `P_i` is resampled as `P_ij`.
    pub fn spawn(&mut self, n_children: usize) {
        let n = self.len();
        if n == 0 || n_children < 2 {
            return;
        }
        for (_, array) in self.arrays_mut() {
            let block = array.len() / n;
            array.resize(n * n_children * block, 0.0);
            // From the back: a child never lies before its parent, so no parent is overwritten too early.
            for child in (0..n * n_children).rev() {
                let parent = child / n_children;
                array.copy_within(parent * block..(parent + 1) * block, child * block);
            }
        }
    }

    /// Kills what `params` kill, and thins the others to at most `n_max`; their log weights stay, but for those thinned.
    ///
    /// `weights` are what the log weights stand for, on any scale; `u`, in [0, 1), is the offset of the draw.
    ///
    /// Where more than `n_max` are left, those heavier than a threshold `c` stay as they are; of the lighter ones each
    /// stays with the probability `w/c`, and then weighs `c`. That keeps `n_max` and every weight's expectation, so the
    /// number can be capped without a bias to the heaviest.
    ///
    /// # Source
    /// iBILL 2017, §IV: weights are inherited, those of low weight are killed; the cap is Fearnhead and Clifford 2003,
    /// *On-line inference for hidden Markov models via particle filters*, §3.2.
    pub fn thin(
        &mut self,
        params: &SpawningParams,
        n_max: usize,
        weights: &[f32],
        u: f32,
        scratch: &mut ResampleScratch,
    ) {
        let n = self.len();
        let heaviest = weights.iter().fold(0.0f32, |best, &w| if w > best { w } else { best });
        if n == 0 || weights.len() != n || !(heaviest > 0.0 && heaviest.is_finite()) {
            return;
        }
        let is_alive = |w: f32| w > 0.0 && w >= params.kill_below * heaviest;
        let threshold = threshold(weights.iter().copied().filter(|&w| is_alive(w)), n_max.max(1));
        let mut owed = f64::from(u) * threshold;
        scratch.ancestors.clear();
        for (i, &weight) in weights.iter().enumerate() {
            if !is_alive(weight) {
                continue;
            }
            let weight = f64::from(weight);
            if weight < threshold {
                owed -= weight;
                if owed >= 0.0 {
                    continue;
                }
                owed += threshold;
                self.log_weight[i] += libm::log(threshold / weight) as f32;
            }
            if scratch.ancestors.len() < n_max.max(1) {
                scratch.ancestors.push(i as u32);
            }
        }
        for (_, array) in self.arrays_mut() {
            let block = array.len() / n;
            for (kept, &ancestor) in scratch.ancestors.iter().enumerate() {
                let from = ancestor as usize * block;
                array.copy_within(from..from + block, kept * block);
            }
            array.truncate(scratch.ancestors.len() * block);
        }
        let best = self.log_weight.iter().fold(f32::NEG_INFINITY, |best, &w| best.max(w));
        self.log_weight.iter_mut().for_each(|w| *w -= best);
    }
}

/// The `c` for which `Σ min(w/c, 1) = n_max`; 0 when there are no more weights than that.
fn threshold(weights: impl Iterator<Item = f32> + Clone, n_max: usize) -> f64 {
    let (mut total, mut n) = (0.0, 0);
    weights.clone().for_each(|w| (total, n) = (total + f64::from(w), n + 1));
    if n <= n_max {
        return 0.0;
    }
    let (mut threshold, mut n_heavy) = (total / n_max as f64, 0);
    // What is heavier is set aside, and the rest shares what is left: more each time, until none is added.
    loop {
        let (mut aside, mut n_aside) = (0.0, 0);
        for weight in weights.clone().map(f64::from).filter(|&w| w >= threshold) {
            (aside, n_aside) = (aside + weight, n_aside + 1);
        }
        if n_aside <= n_heavy || n_aside >= n_max {
            return threshold;
        }
        n_heavy = n_aside;
        threshold = (total - aside) / (n_max - n_aside) as f64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const PARAMS: SpawningParams = SpawningParams { n_children: 3, kill_below: 1e-3 };

    fn cloud(weights: &[f32]) -> Particles {
        Particles {
            x_m: (0..weights.len()).map(|i| i as f32).collect(),
            y_m: vec![0.0; weights.len()],
            recent_strengths_ut: (0..2 * weights.len()).map(|i| i as f32).collect(),
            log_weight: weights.iter().map(|&w| libm::logf(w)).collect(),
            ..Particles::default()
        }
    }

    #[test]
    fn children_stand_side_by_side_and_inherit() {
        let mut particles = cloud(&[1.0, 0.5]);
        particles.spawn(3);
        assert_eq!(particles.x_m, [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
        assert_eq!(
            particles.recent_strengths_ut,
            [0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 2.0, 3.0, 2.0, 3.0, 2.0, 3.0]
        );
        assert_eq!(particles.log_weight[3..], [libm::logf(0.5); 3]);
        particles.spawn(1);
        assert_eq!(particles.len(), 6);
    }

    #[test]
    fn repeating_keeps_blocks_together() {
        let mut particles = cloud(&[1.0, 0.5]);
        particles.repeat_to(3);
        assert_eq!(particles.x_m, [0.0, 1.0, 0.0]);
        assert_eq!(particles.recent_strengths_ut, [0.0, 1.0, 2.0, 3.0, 0.0, 1.0]);
        particles.repeat_to(1);
        assert_eq!((particles.len(), particles.recent_strengths_ut.len()), (1, 2));
        particles.forget_places();
        assert!(particles.recent_strengths_ut.iter().all(|ut| ut.is_nan()) && particles.log_weight == [0.0]);
    }

    #[test]
    fn thinning_by_hand() {
        let weights = [0.1, 0.5, 0.1, 0.000_1, 0.1, 0.2];
        let mut particles = cloud(&weights);
        // The fourth is killed. Of the others 0.5 is set aside, and 0.5 is left for two: c = 0.25. Owed 0.125, then
        // 0.025, −0.075 → 0.175 (the third stays), 0.075, −0.125 (the last stays).
        particles.thin(&PARAMS, 3, &weights, 0.5, &mut ResampleScratch::with_capacity(6, 2));
        assert_eq!(particles.x_m, [1.0, 2.0, 5.0]);
        assert_eq!(particles.recent_strengths_ut, [2.0, 3.0, 4.0, 5.0, 10.0, 11.0]);
        let expected = [0.0, libm::logf(0.5), libm::logf(0.5)];
        assert!(
            particles.log_weight.iter().zip(expected).all(|(w, e)| (w - e).abs() < 1e-5),
            "{particles:?}"
        );
    }

    #[test]
    fn few_particles_only_die_when_they_are_light() {
        let weights = [1.0, 0.000_5, 0.3];
        let mut particles = cloud(&weights);
        particles.thin(&PARAMS, 10, &weights, 0.0, &mut ResampleScratch::default());
        assert_eq!(particles.x_m, [0.0, 2.0]);
        assert!((particles.log_weight[1] - libm::logf(0.3)).abs() < 1e-6);
    }

    proptest! {
        #[test]
        fn thinning_keeps_the_number_and_the_weight(
            weights in proptest::collection::vec(0.01f32..1.0, 20..60), u in 0.0f32..1.0, n_max in 1usize..20,
        ) {
            let mut particles = cloud(&weights);
            let total: f64 = weights.iter().map(|&w| f64::from(w)).sum();
            let heaviest = weights.iter().fold(0.0f32, |a, &b| a.max(b));
            particles.thin(&PARAMS, n_max, &weights, u, &mut ResampleScratch::default());
            prop_assert!(particles.len() <= n_max && particles.len() + 1 >= n_max, "{}", particles.len());
            prop_assert!(particles.log_weight.iter().all(|&w| w <= 0.0));
            // The heaviest stands for itself or for the threshold, whichever is more.
            let c = threshold(weights.iter().copied(), n_max);
            let scale = f64::from(heaviest).max(c);
            let kept: f64 = particles.log_weight.iter().map(|&w| scale * f64::from(libm::expf(w))).sum();
            prop_assert!((kept - total).abs() <= c * 1.01 + 1e-3 * total, "{kept} {total} {c}");
        }

        #[test]
        fn on_average_every_weight_is_kept(k in 0usize..6) {
            let weights = [0.3f32, 0.05, 0.2, 0.15, 0.1, 0.2];
            let n = 2_000;
            let mut kept = 0.0;
            for draw in 0..n {
                let mut particles = cloud(&weights);
                particles.log_weight.iter_mut().for_each(|w| *w = 0.0);
                let u = (draw as f32 + 0.5) / n as f32;
                particles.thin(&PARAMS, 3, &weights, u, &mut ResampleScratch::default());
                kept += particles.x_m.iter().filter(|&&x| x == k as f32).count() as f64 / f64::from(n);
            }
            // c = 1/3: none is set aside, each stays with the probability w/c.
            prop_assert!((kept - 3.0 * f64::from(weights[k])).abs() < 0.01, "{kept}");
        }
    }
}
