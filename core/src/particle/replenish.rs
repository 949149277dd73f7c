//! Replenishment: who dies makes room for newcomers near the best.

use serde::{Deserialize, Serialize};

use crate::particle::Particles;
use crate::random::uniform;

/// Parameters of replenishment.
///
/// # Source
/// Kwak 2018, §5.3.5: as many newcomers as have died, "around the survived particles with top 10% of weights", within
/// 1.5 m. The paper does not give `τ_w`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReplenishParams {
    /// `τ_w`: a particle whose weight is less than this share of the heaviest one's dies.
    pub min_weight: f32,
    /// Newcomers come near this share of the survivors, the heaviest; the paper's is 0.1.
    pub top_share: f32,
    /// They come within this distance of one, uniformly in the circle, in metres; the paper's is 1.5.
    pub radius_m: f32,
}

impl Default for ReplenishParams {
    fn default() -> Self {
        Self { min_weight: 0.01, top_share: 0.1, radius_m: 1.5 }
    }
}

/// Memory that one round needs and the next does not remember.
#[derive(Clone, Debug, Default)]
pub struct ReplenishScratch {
    survivors: Vec<u32>,
    newcomers: Vec<Newcomer>,
}

/// Who comes in whose place, from whom, and where.
#[derive(Clone, Copy, Debug)]
struct Newcomer {
    child: u32,
    parent: u32,
    place_m: [f32; 2],
}

impl ReplenishScratch {
    /// Room for `n` particles.
    pub fn with_capacity(n: usize) -> Self {
        Self { survivors: Vec::with_capacity(n), newcomers: Vec::with_capacity(n) }
    }
}

impl Particles {
    /// Replaces every particle whose weight is too small by a newcomer near one of the heaviest, of which it inherits all
    /// but the place: its history, its heading, its weight. Returns how many were replaced; none when none is left alive.
    ///
    /// `draw` gives a particle its random bits and `may_stand` says whether one may come to a place from another. Where
    /// the drawn place is closed, those a quarter, a half and three quarters of a turn round the parent are tried, which are
    /// as likely; after them, the parent's own.
    pub(crate) fn replenish(
        &mut self,
        params: &ReplenishParams,
        weights: &mut [f32],
        scratch: &mut ReplenishScratch,
        draw: impl Fn(u32) -> [u32; 4],
        may_stand: impl Fn([f32; 2], [f32; 2]) -> bool,
    ) -> usize {
        let heaviest = weights.iter().fold(0.0f32, |best, &w| best.max(w));
        let least = (params.min_weight * heaviest).max(f32::MIN_POSITIVE);
        let ReplenishScratch { survivors, newcomers } = scratch;
        survivors.clear();
        survivors.extend((0..self.len() as u32).filter(|&i| weights[i as usize] >= least));
        if survivors.is_empty() || survivors.len() == self.len() {
            return 0;
        }
        let n_top =
            (libm::roundf(survivors.len() as f32 * params.top_share) as usize).clamp(1, survivors.len());
        // By weight and then by number: an order without ties, so that the same ones are found everywhere.
        survivors.select_nth_unstable_by(n_top - 1, |&a, &b| {
            weights[b as usize].total_cmp(&weights[a as usize]).then(a.cmp(&b))
        });
        let top = &mut survivors[..n_top];
        top.sort_unstable();
        let newcomer = |child: u32| {
            let bits = draw(child);
            let parent = top[((uniform(bits[0]) * n_top as f32) as usize).min(n_top - 1)];
            let from_m = [self.x_m[parent as usize], self.y_m[parent as usize]];
            let radius_m = params.radius_m * uniform(bits[1]).sqrt();
            let (sin, cos) = libm::sincosf(core::f32::consts::TAU * uniform(bits[2]));
            // Left round and right round are as likely, else newcomers would gather on one side.
            let hand = if bits[3] & 1 == 0 { 1.0 } else { -1.0 };
            let turns = [[cos, sin], [-hand * sin, hand * cos], [-cos, -sin], [hand * sin, -hand * cos]];
            let places_m = turns.map(|[x, y]| [from_m[0] + radius_m * x, from_m[1] + radius_m * y]);
            let place_m = places_m.into_iter().find(|&to_m| may_stand(from_m, to_m)).unwrap_or(from_m);
            Newcomer { child, parent, place_m }
        };
        let is_alive = |&i: &u32| weights[i as usize] >= least;
        newcomers.clear();
        newcomers.extend((0..self.len() as u32).filter(|i| !is_alive(i)).map(newcomer));
        self.inherit(newcomers.iter().map(|newcomer| [newcomer.child, newcomer.parent]));
        for &Newcomer { child, parent, place_m } in &*newcomers {
            weights[child as usize] = weights[parent as usize];
            [self.x_m[child as usize], self.y_m[child as usize]] = place_m;
        }
        newcomers.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, draw};

    fn cloud(n: usize) -> Particles {
        Particles {
            x_m: (0..n).map(|i| 10.0 * i as f32).collect(),
            y_m: vec![0.0; n],
            history_ut: (0..2 * n).map(|i| i as f32).collect(),
            log_weight: (0..n).map(|i| i as f32).collect(),
            ..Particles::default()
        }
    }

    fn replenish(
        particles: &mut Particles,
        weights: &mut [f32],
        may_stand: impl Fn([f32; 2], [f32; 2]) -> bool,
    ) -> usize {
        let params = ReplenishParams { min_weight: 0.5, ..ReplenishParams::default() };
        let scratch = &mut ReplenishScratch::default();
        let draws = |i| draw(5, 1, i, Purpose::Replenishing);
        particles.replenish(&params, weights, scratch, draws, may_stand)
    }

    #[test]
    fn the_dead_are_replaced_near_the_best() {
        let mut particles = cloud(40);
        let mut weights = [0.1f32; 40];
        // Twenty survive; the heaviest two are 7 and 23.
        weights[..20].fill(0.6);
        (weights[7], weights[23]) = (1.0, 0.9);
        assert_eq!(replenish(&mut particles, &mut weights, |_, _| true), 19);
        let (mut n_of_7, mut farthest_m) = (0, 0.0f32);
        for i in (20..40).filter(|&i| i != 23) {
            let parent = if weights[i] == 1.0 { 7 } else { 23 };
            n_of_7 += i32::from(parent == 7);
            assert_eq!(
                particles.history_ut[2 * i..2 * i + 2],
                [2.0 * parent as f32, 2.0 * parent as f32 + 1.0]
            );
            assert_eq!(particles.log_weight[i], parent as f32);
            let (dx, dy) = (particles.x_m[i] - 10.0 * parent as f32, particles.y_m[i]);
            let off_m = (dx * dx + dy * dy).sqrt();
            assert!(off_m <= 1.5001, "{off_m}");
            farthest_m = farthest_m.max(off_m);
        }
        assert!((4..16).contains(&n_of_7) && farthest_m > 1.0, "{n_of_7} {farthest_m}");
        // The living stay where they are.
        assert_eq!(particles.x_m[..20], cloud(40).x_m[..20]);
    }

    #[test]
    fn newcomers_come_through_no_wall() {
        let mut particles = cloud(400);
        let mut weights = [0.0f32; 400];
        weights[100] = 1.0;
        replenish(&mut particles, &mut weights, |from_m, to_m| to_m[0] >= from_m[0]);
        assert!(particles.x_m.iter().all(|&x_m| x_m >= 1_000.0));
        let n_left = particles.y_m.iter().filter(|&&y_m| y_m < 0.0).count();
        assert!((150..250).contains(&n_left), "{n_left}");
        replenish(&mut particles, &mut weights, |_, _| false);
        assert!(particles.x_m.iter().all(|&x_m| x_m >= 1_000.0));
    }

    #[test]
    fn none_is_replaced_when_all_live_or_none() {
        for weight in [0.0, 1.0, f32::NAN] {
            let mut particles = cloud(5);
            assert_eq!(replenish(&mut particles, &mut [weight; 5], |_, _| true), 0);
            assert_eq!(particles, cloud(5));
        }
    }
}
